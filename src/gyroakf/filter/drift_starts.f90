! SPDX-License-Identifier: MIT
!> Where the search for the largest likelihood of a drift model begins.
!>
!> Drifts from fast to slow, small and large; what least squares on the autocovariances found ([[identify_drift]]); and for the
!> model of both processes the best models of each alone, with some of the other added.
module gyroakf_filter_drift_starts
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_objective, only : likelihood_objective, starting_point
   use gyroakf_filter_identification, only : drift_model_type, identify_drift
   implicit none (type, external)
   private
   public :: known_type, look_at_autocovariances, list_starts

   !> What is known of a series of variance 1 before a candidate is fitted
   type :: known_type
      !> From the autocovariances
      type(drift_model_type) :: autocovariance
      !> From the likelihood, where count is not 0
      type(component_model_type) :: walk, ar
   end type known_type

   !> Correlation times, variances of the AR(1) process and of the steps of the random walk that are tried
   real(dp), parameter :: times(5) = [1.0_dp, 4.0_dp, 30.0_dp, 300.0_dp, 3000.0_dp], shares(2) = [0.3_dp, 0.03_dp]
   real(dp), parameter :: steps(4) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp]
   !> Those that are tried beside a process that is known: times and steps
   integer, parameter :: beside_times = 3
   real(dp), parameter :: beside_steps(3) = [1.0e-3_dp, 1.0e-5_dp, 1.0e-7_dp]
   !> Least variance of a start
   real(dp), parameter :: least = 1.0e-3_dp

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
   pure subroutine list_starts(objective, known, start)
      !> Its processes
      type(likelihood_objective), intent(in) :: objective
      type(known_type), intent(in) :: known
      !> [parameter, start]
      real(dp), allocatable, intent(out) :: start(:, :)
      real(dp) :: list(4, 32)
      integer :: i, j, n

      n = 0
      if (.not. objective%ar) then
         do i = 1, size(steps)
            call add(list, n, [1.0_dp, 1.0_dp, steps(i), 0.5_dp])
         end do
      else if (.not. objective%walk) then
         do j = 1, size(shares)
            do i = 1, size(times)
               call add(list, n, [times(i), shares(j), 1.0_dp, 1.0_dp - shares(j)])
            end do
         end do
      else
         call add_beside(known, list, n)
      end if
      if (known%autocovariance%drift_variance > least) then
         associate (a => known%autocovariance)
            if (objective%ar .neqv. objective%walk) call add(list, n, [a%correlation_samples, a%drift_variance, &
                                                                   a%process_variance, max(a%measurement_variance, least)])
            if (objective%ar .and. objective%walk) call add(list, n, [a%correlation_samples, a%drift_variance, &
                                                                  beside_steps(2), max(a%measurement_variance, least)])
         end associate
      end if
      allocate (start(1 + merge(2, 0, objective%ar) + merge(1, 0, objective%walk), n))
      do i = 1, n
         start(:, i) = starting_point(objective, list(1, i), list(2, i), list(3, i), list(4, i))
      end do
   end subroutine list_starts

   !> Starts for both processes.
   pure subroutine add_beside(known, list, n)
      type(known_type), intent(in) :: known
      real(dp), intent(inout) :: list(:, :)
      integer, intent(inout) :: n
      real(dp) :: variance
      integer :: i, j

      if (known%ar%count > 0 .and. known%ar%phi(1) > 0.0_dp) then
         variance = known%ar%q(1)/((1.0_dp - known%ar%phi(1))*(1.0_dp + known%ar%phi(1)))
         do i = 1, size(beside_steps)
            call add(list, n, [-1.0_dp/log(known%ar%phi(1)), variance, beside_steps(i), known%ar%r])
         end do
      end if
      if (known%walk%count > 0) then
         do j = 1, size(shares)
            do i = 1, beside_times
               call add(list, n, [times(i), shares(j)*known%walk%r, known%walk%q(1), (1.0_dp - shares(j))*known%walk%r])
            end do
         end do
      end if
      if (n == 0) call add(list, n, [times(1), shares(1), steps(2), 1.0_dp - shares(1)])
   end subroutine add_beside

   !> Adds a start: correlation time, variance, variance of the steps, white noise.
   pure subroutine add(list, n, numbers)
      real(dp), intent(inout) :: list(:, :)
      integer, intent(inout) :: n
      real(dp), intent(in) :: numbers(4)

      n = n + 1
      list(:, n) = max(numbers, 1.0e-20_dp)
   end subroutine add

end module gyroakf_filter_drift_starts
