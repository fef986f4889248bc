! SPDX-License-Identifier: MIT
!> Starting points of the maximum likelihood search for a drift model.
!>
!> Drifts from fast to slow, small and large; what least squares on the autocovariances found ([[identify_drift]]); for the model of
!> both processes the best models of each alone, with some of the other added. Besides the best models of those that a candidate
!> contains: a random walk is an AR(1) process whose correlation time is long, the model of both processes is that of either with
!> next to nothing of the other. A search never ends above its start: a candidate ends no lower than what it contains, but for the
!> diffuse start of the random walk, as against a mean that is fitted: the deviance -2 ln L of an AR(1) process in white noise,
!> covariance Sigma, of a series of variance 1 is less than that of the same with a level of diffuse prior that never moves by
!> $$ \ln (\mathbf 1^T \Sigma^{-1} \mathbf 1) - \ln 2\pi $$
!> for the first measurement, which has no density, and what is not known of the level.
module gyroakf_filter_drift_starts
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_objective, only : likelihood_objective, starting_point
   use gyroakf_filter_identification, only : drift_model_type, identify_drift
   implicit none (type, external)
   private
   public :: known_type, look_at_autocovariances, list_starts, of_all_kinds, from_walk, from_ar

   !> What is known of a series of variance 1 before a candidate is fitted
   type :: known_type
      !> From the autocovariances
      type(drift_model_type) :: autocovariance
      !> From the likelihood, where count is not 0
      type(component_model_type) :: walk, ar
   end type known_type

   !> Groups of starts: drifts of all kinds, and those beside a process that is known; the random walk that is known, as what a
   !> larger model can be; the AR(1) process that is known, as that
   integer, parameter :: of_all_kinds = 1, from_walk = 2, from_ar = 3

   !> Correlation times, variances of the AR(1) process and of the steps of the random walk that are tried
   real(dp), parameter :: times(5) = [1.0_dp, 4.0_dp, 30.0_dp, 300.0_dp, 3000.0_dp], shares(2) = [0.3_dp, 0.03_dp]
   real(dp), parameter :: steps(4) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp]
   !> Those that are tried beside a process that is known: times and steps
   integer, parameter :: beside_times = 3
   real(dp), parameter :: beside_steps(3) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-7_dp]
   !> Correlation times of an AR(1) process in place of a random walk; the last is as good as that
   real(dp), parameter :: walk_times(4) = [300.0_dp, 1.0e3_dp, 1.0e4_dp, 1.0e6_dp]
   !> Beside a process that is known: AR(1) noise, some (as quantisation leaves, of negative phi) and next to nothing, shares of the
   !> white noise; steps of a random walk, next to nothing
   real(dp), parameter :: faint_phis(4) = [-0.4_dp, 0.37_dp, 0.78_dp, 0.97_dp], faint_shares(2) = [0.3_dp, 1.0e-4_dp]
   real(dp), parameter :: faint_steps(2) = [1.0e-9_dp, 1.0e-12_dp]
   !> Least variance of a start that the autocovariances tell; that stands for 0
   real(dp), parameter :: least = 1.0e-3_dp, tiniest = 1.0e-20_dp
   !> Most starts
   integer, parameter :: most_starts = 40

   !> A start
   type :: start_type
      !> Coefficient and variance of the AR(1) process, variance of the random walk's steps, white noise
      real(dp) :: phi = 0.0_dp, variance = 0.0_dp, step = 0.0_dp, white = 0.0_dp
      integer :: group = of_all_kinds
   end type start_type

contains

   !> What the autocovariances tell.
   subroutine look_at_autocovariances(objective, known)
      !> Its series is looked at
      type(likelihood_objective), intent(in) :: objective
      type(known_type), intent(out) :: known
      type(error_type), allocatable :: failed

      if (allocated(objective%here)) then
         call identify_drift(objective%z, known%autocovariance, failed, objective%here)
      else
         call identify_drift(objective%z, known%autocovariance, failed)
      end if
      if (allocated(failed)) known%autocovariance = drift_model_type()
   end subroutine look_at_autocovariances

   !> The starts of a candidate.
   pure subroutine list_starts(objective, known, start, group)
      !> Its processes
      type(likelihood_objective), intent(in) :: objective
      type(known_type), intent(in) :: known
      !> [parameter, start]
      real(dp), allocatable, intent(out) :: start(:, :)
      !> of_all_kinds, from_walk or from_ar: [start]
      integer, allocatable, intent(out) :: group(:)
      type(start_type) :: list(most_starts)
      integer :: i, j, n

      n = 0
      if (.not. objective%ar) then
         do i = 1, size(steps)
            call add(list, n, start_type(0.0_dp, 1.0_dp, steps(i), 0.5_dp))
         end do
      else if (.not. objective%walk) then
         do j = 1, size(shares)
            do i = 1, size(times)
               call add(list, n, start_type(exp(-1.0_dp/times(i)), shares(j), 1.0_dp, 1.0_dp - shares(j)))
            end do
         end do
         call add_for_walk(known%walk, list, n)
      else
         call add_beside(known, list, n)
         call add_faint(known, list, n)
      end if
      if (known%autocovariance%drift_variance > least) then
         associate (a => known%autocovariance)
            call add(list, n, start_type(a%phi, a%drift_variance, merge(beside_steps(2), a%process_variance, objective%ar), &
                                         max(a%measurement_variance, least)))
         end associate
      end if
      allocate (start(1 + merge(2, 0, objective%ar) + merge(1, 0, objective%walk), n), group(n))
      group(:) = list(:n)%group
      do i = 1, n
         start(:, i) = starting_point(objective, list(i)%phi, list(i)%variance, list(i)%step, list(i)%white)
      end do
   end subroutine list_starts

   !> Starts for an AR(1) process in place of a random walk: its steps are as large.
   pure subroutine add_for_walk(walk, list, n)
      !> count is 0 where it is not known
      type(component_model_type), intent(in) :: walk
      type(start_type), intent(inout) :: list(:)
      integer, intent(inout) :: n
      real(dp) :: phi
      integer :: i

      if (walk%count == 0) return
      do i = 1, size(walk_times)
         phi = exp(-1.0_dp/walk_times(i))
         call add(list, n, start_type(phi, walk%q(1)/((1.0_dp - phi)*(1.0_dp + phi)), 1.0_dp, walk%r, from_walk))
      end do
   end subroutine add_for_walk

   !> Starts for both processes: one that is known, some of the other beside it.
   pure subroutine add_beside(known, list, n)
      type(known_type), intent(in) :: known
      type(start_type), intent(inout) :: list(:)
      integer, intent(inout) :: n
      integer :: i, j

      if (known%ar%count > 0 .and. known%ar%phi(1) > 0.0_dp) then
         do i = 1, size(beside_steps)
            call add(list, n, start_type(known%ar%phi(1), variance_of(known%ar), beside_steps(i), known%ar%r))
         end do
      end if
      if (known%walk%count > 0) then
         do j = 1, size(shares)
            do i = 1, beside_times
               call add(list, n, start_type(exp(-1.0_dp/times(i)), shares(j)*known%walk%r, known%walk%q(1), &
                                            (1.0_dp - shares(j))*known%walk%r))
            end do
         end do
      end if
      if (n == 0) call add(list, n, start_type(exp(-1.0_dp/times(1)), shares(1), steps(2), 1.0_dp - shares(1)))
   end subroutine add_beside

   !> Starts for both processes: one that is known, next to nothing of the other.
   pure subroutine add_faint(known, list, n)
      type(known_type), intent(in) :: known
      type(start_type), intent(inout) :: list(:)
      integer, intent(inout) :: n
      integer :: i, j

      if (known%walk%count > 0) then
         do j = 1, size(faint_shares)
            do i = 1, size(faint_phis)
               call add(list, n, start_type(faint_phis(i), faint_shares(j)*known%walk%r, known%walk%q(1), &
                                            (1.0_dp - faint_shares(j))*known%walk%r, from_walk))
            end do
         end do
      end if
      if (known%ar%count > 0) then
         do i = 1, size(faint_steps)
            call add(list, n, start_type(known%ar%phi(1), variance_of(known%ar), faint_steps(i), known%ar%r, from_ar))
         end do
      end if
   end subroutine add_faint

   !> Variance of the first process, AR(1).
   pure real(dp) function variance_of(model) result(variance)
      type(component_model_type), intent(in) :: model

      variance = model%q(1)/((1.0_dp - model%phi(1))*(1.0_dp + model%phi(1)))
   end function variance_of

   !> Adds a start; none of its variances is 0.
   pure subroutine add(list, n, one)
      type(start_type), intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(start_type), intent(in) :: one

      n = n + 1
      list(n) = one
      list(n)%variance = max(one%variance, tiniest)
      list(n)%step = max(one%step, tiniest)
      list(n)%white = max(one%white, tiniest)
   end subroutine add

end module gyroakf_filter_drift_starts
