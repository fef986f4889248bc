! SPDX-License-Identifier: MIT
!> Starting points of the maximum likelihood search for a drift model.
!>
!> Drifts from fast to slow, small and large; for the model of both processes the best models of
!> each alone, with some of the other added. Besides the best models of those that a
!> candidate contains: a random walk is an AR(1) process whose correlation time is long, the model
!> of both processes is that of either with next to nothing of the other. A search never ends above
!> its start: a candidate ends no lower than what it contains, but for the diffuse start of the
!> random walk, as against a mean that is fitted: the deviance -2 ln L of an AR(1) process in white
!> noise, covariance Sigma, of a series of variance 1 is less than that of the same with a level of
!> diffuse prior that never moves by
!> $$ \ln (\mathbf 1^T \Sigma^{-1} \mathbf 1) - \ln 2\pi $$
!> for the first measurement, which has no density, and what is not known of the level.
module gyroakf_filter_drift_starts
   use gyroakf_kinds, only : dp
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_objective, only : likelihood_objective, parameters_of, starting_point
   implicit none (type, external)
   private
   public :: known_type, list_starts, of_all_kinds, from_walk, from_ar

   !> The candidates of a series of variance 1 that were fitted before, where count is not 0
   type :: known_type
      type(component_model_type) :: walk, ar
   end type known_type

   !> Groups of starts: drifts of all kinds, and those beside a process that is known; the random
   !> walk that is known, as what a larger model can be; the AR(1) process that is known, as that
   integer, parameter :: of_all_kinds = 1, from_walk = 2, from_ar = 3

   !> Correlation times, variances of the AR(1) process and of the steps of the random walk that are
   !> tried
   real(dp), parameter :: times(5) = [1.0_dp, 4.0_dp, 30.0_dp, 300.0_dp, 3000.0_dp], shares(2) = &
      [0.3_dp, 0.03_dp]
   real(dp), parameter :: steps(5) = [1.0e-1_dp, 1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp]
   !> Those that are tried beside a process that is known: times and steps
   integer, parameter :: beside_times = 3
   real(dp), parameter :: beside_steps(3) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-7_dp]
   !> Correlation times of an AR(1) process in place of a random walk; the last is as good as that
   real(dp), parameter :: walk_times(4) = [300.0_dp, 1.0e3_dp, 1.0e4_dp, 1.0e6_dp]
   !> Beside a process that is known: AR(1) noise, some (as quantization leaves, of negative phi)
   !> and next to nothing, shares of the white noise; steps of a random walk, next to nothing
   real(dp), parameter :: faint_phis(4) = [-0.4_dp, 0.37_dp, 0.78_dp, 0.97_dp], faint_shares(2) = &
      [0.3_dp, 1.0e-4_dp]
   real(dp), parameter :: faint_steps(2) = [1.0e-9_dp, 1.0e-12_dp]
   !> Least variance of a start: it stands for 0
   real(dp), parameter :: tiniest = 1.0e-20_dp

   !> A start
   type :: start_type
      !> Coefficient and variance of the AR(1) process, variance of the random walk's steps, white
      !> noise
      real(dp) :: phi = 0.0_dp, variance = 0.0_dp, step = 0.0_dp, white = 0.0_dp
      integer :: group = of_all_kinds
   end type start_type

contains

   !> The starts of a candidate.
   pure subroutine list_starts(objective, known, start, group)
      !> Its processes
      type(likelihood_objective), intent(in) :: objective
      type(known_type), intent(in) :: known
      !> [parameter, start]
      real(dp), allocatable, intent(out) :: start(:, :)
      !> of_all_kinds, from_walk or from_ar: [start]
      integer, allocatable, intent(out) :: group(:)
      type(start_type), allocatable :: list(:)
      real(dp) :: phi(size(times))
      integer :: i, j

      phi = exp(-1.0_dp/times)
      associate (walk => known%walk, ar => known%ar)
         if (.not. objective%ar) then
            list = [(start_type(0.0_dp, 1.0_dp, steps(i), 0.5_dp), i=1, size(steps))]
         else if (.not. objective%walk) then
            list = [((start_type(phi(i), shares(j), 1.0_dp, 1.0_dp - shares(j)), i=1, &
               size(times)), j=1, size(shares))]
            if (walk%count > 0) list = &
               [list, (in_place_of(walk, exp(-1.0_dp/walk_times(i))), i=1, size(walk_times))]
         else
            allocate (list(0))
            if (ar%count > 0 .and. ar%phi(1) > 0.0_dp) list = [(start_type(ar%phi(1), &
               variance_of(ar), beside_steps(i), ar%r), i=1, size(beside_steps))]
            if (walk%count > 0) list = [list, ((beside(walk, phi(i), shares(j), of_all_kinds), &
               i=1, beside_times), j=1, size(shares))]
            if (size(list) == 0) list = &
               [start_type(phi(1), shares(1), steps(3), 1.0_dp - shares(1))]
            if (walk%count > 0) list = [list, ((beside(walk, faint_phis(i), faint_shares(j), &
               from_walk), i=1, size(faint_phis)), j=1, size(faint_shares))]
            if (ar%count > 0) list = [list, (start_type(ar%phi(1), variance_of(ar), &
               faint_steps(i), ar%r, from_ar), i=1, size(faint_steps))]
         end if
      end associate
      allocate (start(parameters_of(objective), size(list)))
      group = list%group
      do i = 1, size(list)
         start(:, i) = starting_point(objective, list(i)%phi, max(list(i)%variance, tiniest), &
            max(list(i)%step, tiniest), max(list(i)%white, tiniest))
      end do
   end subroutine list_starts

   !> An AR(1) process in place of a random walk: its steps are as large.
   pure type(start_type) function in_place_of(walk, phi) result(start)
      type(component_model_type), intent(in) :: walk
      real(dp), intent(in) :: phi

      start = start_type(phi, walk%q(1)/((1.0_dp - phi)*(1.0_dp + phi)), 1.0_dp, walk%r, from_walk)
   end function in_place_of

   !> A random walk that is known with an AR(1) process beside it, which takes a share of the white
   !> noise.
   pure type(start_type) function beside(walk, phi, share, group) result(start)
      type(component_model_type), intent(in) :: walk
      !> Of the AR(1) process
      real(dp), intent(in) :: phi, share
      integer, intent(in) :: group

      start = start_type(phi, share*walk%r, walk%q(1), (1.0_dp - share)*walk%r, group)
   end function beside

   !> Variance of the first process, AR(1).
   pure real(dp) function variance_of(model) result(variance)
      type(component_model_type), intent(in) :: model

      variance = model%q(1)/((1.0_dp - model%phi(1))*(1.0_dp + model%phi(1)))
   end function variance_of

end module gyroakf_filter_drift_starts
