! SPDX-License-Identifier: MIT
!> Monte Carlo of the verdict on drift: how often each verdict is given, and B, where it is stated.
!>
!>     ./run.sh [CASE [RECORDS [SEED]]]
!>
!> CASE is a name of the list below, or all (default), of RECORDS records (default 200), their seeds from SEED on. The first cases
!> are of 1,000, 10,000 and 100,000 samples, one a second; a K of 100/n is as large as N = 1 at n/58 samples. The last ones
!> have N 18, B 6 deg/h (and s), 10 Hz, 2 h. `detrended` prints how often the ADF test of the preset paper, of all samples without
!> their cubic, calls a random walk of 12,000 samples stationary.
program verdict
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : apply_preset, channel_result_type, dp, error_type, int64, pipeline_options, pipeline_result_type, &
      & record_type, run_pipeline, simulate_options, simulate_record
   implicit none (type, external)

   !> A record whose truth is known
   type :: case_type
      character(12) :: name
      !> Q N B K R; B is multiplied by 10/sqrt(n), K by 100/n where `scaled`
      real(dp) :: coefficient(5)
      logical :: scaled = .false.
      !> Coefficient of an AR(1) process of variance 1, 0: none
      real(dp) :: phi = 0.0_dp
      !> Amplitude and time constant of a warm-up; the record is of 2 h, else of three lengths
      real(dp) :: warm_up(2) = 0.0_dp
      logical :: hours = .false.
   end type case_type

   type(case_type), parameter :: cases(*) = [ &
      & case_type("walk", [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp]), &
      & case_type("white", [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & case_type("AR_0.4", spread(0.0_dp, 1, 5), phi=0.4_dp), &
      & case_type("AR_0.95", spread(0.0_dp, 1, 5), phi=0.95_dp), &
      & case_type("NB", [0.0_dp, 3.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]), &
      & case_type("NK", [0.0_dp, 1.0_dp, 0.0_dp, 1.0_dp, 0.0_dp], scaled=.true.), &
      & case_type("NBK", [0.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp], scaled=.true.), &
      & case_type("2h_NB", [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], hours=.true.), &
      & case_type("2h_warm_up", [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], warm_up=[300.0_dp, 600.0_dp], hours=.true.), &
      & case_type("2h_ramp", [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.01_dp], hours=.true.), &
      & case_type("2h_K_0.5", [0.0_dp, 18.0_dp, 6.0_dp, 0.5_dp, 0.0_dp], hours=.true.), &
      & case_type("2h_K_1", [0.0_dp, 18.0_dp, 6.0_dp, 1.0_dp, 0.0_dp], hours=.true.), &
      & case_type("2h_K_1_warm", [0.0_dp, 18.0_dp, 6.0_dp, 1.0_dp, 0.0_dp], warm_up=[300.0_dp, 600.0_dp], hours=.true.)]
   integer(int64), parameter :: lengths(3) = [1000_int64, 10000_int64, 100000_int64], samples_2h = 72000_int64
   character(40) :: name, word
   integer :: records, seed, i, j

   name = "all"
   records = 200
   seed = 1
   if (command_argument_count() > 0) call get_command_argument(1, name)
   do i = 2, min(3, command_argument_count())
      call get_command_argument(i, word)
      if (i == 2) read (word, *) records
      if (i == 3) read (word, *) seed
   end do
   if (name == "all" .or. name == "detrended") call study_detrended(12000_int64, records, seed)
   if (name == "detrended") stop
   if (name /= "all" .and. .not. any(cases%name == name)) then
      write (error_unit, "(*(a, 1x))") "cases: all detrended", (trim(cases(i)%name), i=1, size(cases))
      stop 1, quiet=.true.
   end if
   write (output_unit, "(a)") "| case | samples | drifts % | stationary % | not described % | ramp % | warm-up % | "// &
      & "K stated % | B stated % | B within 10 % | B RMSE % | B stated/true error |", &
      & "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
   do i = 1, size(cases)
      if (name /= "all" .and. name /= cases(i)%name) cycle
      if (cases(i)%hours) then
         call study(cases(i), samples_2h, records, seed)
         cycle
      end if
      do j = 1, size(lengths)
         call study(cases(i), lengths(j), records, seed + 10000*j)
      end do
   end do

contains

   !> Simulates and judges the records of a case, prints their line.
   subroutine study(case, samples, records, seed)
      type(case_type), intent(in) :: case
      integer(int64), intent(in) :: samples
      integer, intent(in) :: records, seed
      type(channel_result_type), allocatable :: channel(:)
      real(dp), allocatable :: relative(:), error(:)
      real(dp) :: truth, rmse, ratio
      integer :: i, n

      allocate (channel(records))
      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(case, samples, seed + i - 1, channel(i))
      end do
      !$omp end parallel do
      truth = case%coefficient(3)
      if (case%scaled) truth = truth*10/sqrt(real(samples, dp))
      relative = [real(dp) ::]
      error = relative
      do i = 1, records
         associate (b => channel(i)%allan(1)%noise%coefficient(3))
            if (.not. b%detected .or. truth <= 0) cycle
            relative = [relative, b%value/truth - 1]
            error = [error, b%std_error/truth]
         end associate
      end do
      n = max(1, size(relative))
      rmse = sqrt(sum(relative**2)/n)
      ratio = sqrt(sum(error**2)/n)/max(tiny(rmse), sqrt(sum((relative - sum(relative)/n)**2)/max(1, n - 1)))
      write (output_unit, "(2a, i0, 10(a, f0.2), a)") "| "//case%name, " | ", samples, " | ", &
         & percent(channel%verdict%drifts), " | ", percent(channel%verdict%stationary), " | ", &
         & percent(.not. (channel%verdict%drifts .or. channel%verdict%stationary)), " | ", &
         & percent(channel%verdict%trend%shape == "ramp"), " | ", percent(channel%verdict%trend%shape == "warm-up"), " | ", &
         & percent([(channel(i)%allan(1)%noise%coefficient(4)%detected, i=1, records)]), " | ", &
         & 100*real(size(relative), dp)/records, " | ", 100*count(abs(relative) < 0.1_dp)/real(n, dp), " | ", 100*rmse, " | ", &
         & ratio, " |"
      flush (output_unit)
   end subroutine study

   !> The size of a test for a unit root where a cubic was removed.
   subroutine study_detrended(samples, records, seed)
      integer(int64), intent(in) :: samples
      integer, intent(in) :: records, seed
      type(simulate_options) :: simulated
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(record_type) :: record
      type(error_type), allocatable :: failure
      integer :: i, stationary

      simulated%samples = samples
      simulated%coefficient(4) = 1
      call apply_preset("paper", options, failure)
      options%clean%method = "none"
      options%do_ar = .false.
      options%do_filter = .false.
      options%do_allan = .false.
      stationary = 0
      do i = 1, records
         simulated%seed = seed + i - 1
         call simulate_record(simulated, record, failure)
         if (.not. allocated(failure)) call run_pipeline(record, options, result, failure)
         if (allocated(failure)) error stop "detrended"
         if (result%channel(1)%adf%stationary) stationary = stationary + 1
      end do
      write (output_unit, "(a, i0, a, f0.1, a, /)") "random walks of ", samples, &
         & " samples without their cubic: ADF at 5 % calls ", 100*real(stationary, dp)/records, " % stationary"
   end subroutine study_detrended

   !> Simulates and judges one record.
   subroutine one_record(case, samples, seed, channel)
      type(case_type), intent(in) :: case
      integer(int64), intent(in) :: samples
      integer, intent(in) :: seed
      type(channel_result_type), intent(out) :: channel
      type(simulate_options) :: simulated
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(record_type) :: record
      type(error_type), allocatable :: failure
      integer :: k

      simulated%samples = samples
      simulated%seed = seed
      simulated%unit = "deg/h"
      simulated%rate_hz = merge(10, 1, case%hours)
      simulated%coefficient = case%coefficient
      if (case%scaled) simulated%coefficient(3:4) = case%coefficient(3:4)*[10/sqrt(real(samples, dp)), 100/real(samples, dp)]
      if (abs(case%phi) > 0) then
         simulated%ar = [case%phi]
         simulated%ar_variance = 1
      end if
      call simulate_record(simulated, record, failure)
      if (.not. allocated(failure)) then
         if (case%warm_up(1) > 0) record%value(:, 1) = record%value(:, 1) + case%warm_up(1)* &
            & exp(-[(real(k, dp), k=0, int(samples) - 1)]/(simulated%rate_hz*case%warm_up(2)))
         options%do_tests = .false.
         options%do_ar = .false.
         options%do_filter = .false.
         options%clean%method = "auto"
         options%clean%degree = -1
         call run_pipeline(record, options, result, failure)
      end if
      if (allocated(failure)) then
         write (error_unit, "(2a, i0, 2a)") trim(case%name), ", seed ", seed, ": ", failure%message
         error stop
      end if
      channel = result%channel(1)
   end subroutine one_record

   !> Share of true values in percent.
   pure real(dp) function percent(flags)
      logical, intent(in) :: flags(:)

      percent = 100*count(flags)/real(size(flags), dp)
   end function percent

end program verdict
