! SPDX-License-Identifier: MIT
!> Monte Carlo of the noise fit: bias, RMSE and stated against true standard errors over many simulated records.
!>
!>     ./run.sh [RECORDS [SAMPLES [N B K R [TERMS [TAUS [METHOD]]]]]]
!>
!> Defaults: 200 records of 6 h at 10 Hz, N = 18, B = 6, K = 0.1 in deg/h and seconds, all five terms, log:10.
program allan_fit
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, noise_options, noise_type, &
      & record_type, simulate_options, simulate_record
   implicit none (type, external)

   character(1), parameter :: letter(5) = ["Q", "N", "B", "K", "R"]
   type(simulate_options) :: truth
   type(noise_options) :: fit
   type(allan_options) :: grid
   real(dp), allocatable :: value(:, :), error(:, :), limit(:, :), chi2(:)
   logical, allocatable :: detected(:, :)
   character(40) :: word
   integer :: records, i

   records = 200
   truth%samples = 216000
   truth%rate_hz = 10
   truth%unit = "deg/h"
   truth%coefficient = [0.0_dp, 18.0_dp, 6.0_dp, 0.1_dp, 0.0_dp]
   grid%taus = "log:10"
   do i = 1, command_argument_count()
      call get_command_argument(i, word)
      select case (i)
      case (1); read (word, *) records
      case (2); read (word, *) truth%samples
      case (3:6); read (word, *) truth%coefficient(i - 1)
      case (7); fit%terms = trim(word)
      case (8); grid%taus = trim(word)
      case default; fit%method = trim(word)
      end select
   end do
   allocate (value(records, 5), error(records, 5), limit(records, 5), chi2(records), detected(records, 5))
   !$omp parallel do schedule(dynamic)
   do i = 1, records
      call one_record(i)
   end do
   !$omp end parallel do
   call print_table()

contains

   !> Simulates and fits one record.
   subroutine one_record(number)
      !> Its number, which is its seed
      integer, intent(in) :: number

      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: failure

      options = truth
      options%seed = number
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) call compute_allan(record%value(:, 1), 1/truth%rate_hz, grid, curve, failure)
      if (.not. allocated(failure)) call fit_noise(curve, fit, noise, failure)
      if (allocated(failure)) then
         write (error_unit, "(a)") failure%message
         stop 1, quiet=.true.
      end if
      value(number, :) = noise%coefficient%value
      error(number, :) = noise%coefficient%std_error
      limit(number, :) = noise%coefficient%upper_limit
      detected(number, :) = noise%coefficient%detected
      chi2(number) = noise%chi2_reduced
   end subroutine one_record

   !> Prints a line per term.
   subroutine print_table()
      real(dp) :: true_value, unit, spread
      integer :: j

      write (output_unit, "(a, i0, a, i0, 4a)") "records ", records, ", samples ", truth%samples, ", terms ", trim(fit%terms), &
         & ", taus ", grid%taus
      write (output_unit, "(a)") "term      truth   bias %  +-     RMSE %   sd %  stated/sd  zero %  detected %  limit >= truth %"
      do j = 1, 5
         if (index(fit%terms, letter(j)) == 0) cycle
         true_value = truth%coefficient(j)
         unit = merge(true_value, maxval(value(:, j)) + tiny(1.0_dp), true_value > 0)/100
         spread = sqrt(sum((value(:, j) - sum(value(:, j))/records)**2)/(records - 1))
         write (output_unit, "(a4, f11.4, f9.3, f7.3, 2f9.3, f9.3, f10.1, f9.1, f12.1)") letter(j), true_value, &
            & (sum(value(:, j))/records - true_value)/unit, spread/unit/sqrt(real(records, dp)), &
            & sqrt(sum((value(:, j) - true_value)**2)/records)/unit, spread/unit, &
            & sqrt(sum(error(:, j)**2)/records)/max(spread, tiny(1.0_dp)), percent(value(:, j) <= 0), percent(detected(:, j)), &
            & percent(limit(:, j) >= true_value)
      end do
      write (output_unit, "(a, f7.3, a, f7.3)") "chi2_reduced: mean ", sum(chi2)/records, ", largest ", maxval(chi2)
   end subroutine print_table

   !> Share of true values in percent.
   pure real(dp) function percent(flags)
      !> The values
      logical, intent(in) :: flags(:)

      percent = 100*count(flags)/real(size(flags), dp)
   end function percent

end program allan_fit
