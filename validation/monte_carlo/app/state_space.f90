! SPDX-License-Identifier: MIT
!> The filter, the likelihood and the smoother of a drift model on a given series, for comparison with other programs:
!>
!>     state_space SERIES RESULT R PHI Q [PHI Q]
!>
!> SERIES is raw float64, NaN where a sample is missing; RESULT gets, raw, the log-likelihood, and of every sample the filtered
!> drift, the innovation over its deviation, the smoothed drift and its variance.
program state_space
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf, only : component_likelihood, component_model_type, dp, error_type, filter_options, drift_filter_type, int64, &
      & new_drift_filter, run_filter, smooth_drift
   implicit none (type, external)

   type(component_model_type) :: model
   character(400) :: series, result, word
   integer :: i

   call get_command_argument(1, series)
   call get_command_argument(2, result)
   call get_command_argument(3, word)
   read (word, *) model%r
   model%count = (command_argument_count() - 3)/2
   do i = 1, model%count
      call get_command_argument(2 + 2*i, word)
      read (word, *) model%phi(i)
      call get_command_argument(3 + 2*i, word)
      read (word, *) model%q(i)
   end do
   call work(trim(series), trim(result), model)

contains

   !> Reads, filters, smooths, writes.
   subroutine work(series, result, model)
      character(*), intent(in) :: series, result
      type(component_model_type), intent(in) :: model
      type(drift_filter_type) :: filter
      type(error_type), allocatable :: failure
      real(dp), allocatable :: z(:), filtered(:), innovation(:), smoothed(:), variance(:)
      real(dp) :: likelihood
      integer(int64) :: n
      integer :: unit

      open (newunit=unit, file=series, access="stream", form="unformatted", status="old", action="read")
      inquire (unit, size=n)
      n = n/8
      allocate (z(n), filtered(n), innovation(n), smoothed(n), variance(n))
      read (unit) z
      close (unit)
      variance = 0
      call component_likelihood(model, z, likelihood, failure)
      if (.not. allocated(failure)) call new_drift_filter(filter, model, spread(.true., 1, model%count), filter_options(), failure)
      if (.not. allocated(failure)) then
         call run_filter(filter, z, filtered, normalized_innovation=innovation)
         call smooth_drift(model, spread(.true., 1, model%count), z, smoothed, failure, variance=variance)
      end if
      if (allocated(failure)) then
         write (error_unit, "(a)") failure%message
         error stop
      end if
      open (newunit=unit, file=result, access="stream", form="unformatted", status="replace", action="write")
      write (unit) likelihood, filtered, innovation, smoothed, variance
      close (unit)
   end subroutine work

end program state_space
