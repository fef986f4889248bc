! SPDX-License-Identifier: MIT
!> Monte Carlo of the noise fit: bias, RMSE, stated against true standard errors, which terms are found, what the limits cover; time
!> per fit.
!>
!>     ./run.sh [MIX [RECORDS [TAUS [METHOD [TERMS]]]]]
!>
!> MIX is a name of the list below, or all (default), with as many records as the claim about it needs.
program allan_fit
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, int64, noise_options, &
      & noise_type, record_type, simulate_options, simulate_record
   implicit none (type, external)

   !> A noise whose truth is known; sample interval 1 s, so the coefficients are per sample
   type :: mix_type
      character(10) :: name
      integer :: records
      integer(int64) :: samples
      !> Q N B K R
      real(dp) :: coefficient(5)
      !> Standard deviation and correlation time of a Markov process; amplitude and frequency of a sinusoid; share lost
      real(dp) :: deviation = 0.0_dp, time = 0.0_dp, amplitude = 0.0_dp, frequency = 0.0_dp, lost = 0.0_dp
   end type mix_type

   !> What a fit gives: value, error, limit of each term; Markov q_c and T_c, sinusoid amplitude and frequency with errors
   type :: outcome_type
      real(dp) :: value(5), error(5), limit(5), further(4), further_error(4), chi2, seconds
      logical :: detected(5), left_out, misfit
   end type outcome_type

   !> "six_hours" is 6 h at 10 Hz of N 18, B 6, K 0.1 in deg/h and seconds, "walk" the same with B 2 and K 1
   real(dp), parameter :: t = 0.31622776601683794_dp
   type(mix_type), parameter :: mixes(*) = [ &
      & mix_type("white_1e4", 2000, 10000_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("white_2e5", 2000, 200000_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("six_hours", 600, 216000_int64, [0.0_dp, 18/t, 6.0_dp, 0.1_dp*t, 0.0_dp]), &
      & mix_type("walk", 600, 216000_int64, [0.0_dp, 18/t, 2.0_dp, 1.0_dp*t, 0.0_dp]), &
      & mix_type("lost_5_%", 300, 216000_int64, [0.0_dp, 18/t, 6.0_dp, 0.1_dp*t, 0.0_dp], lost=0.05_dp), &
      & mix_type("short", 300, 10000_int64, [0.0_dp, 1.0_dp, 0.1_dp, 0.01_dp, 0.0_dp]), &
      & mix_type("quantised", 300, 100000_int64, [1.0_dp, 0.5_dp, 0.02_dp, 0.0_dp, 0.0_dp]), &
      & mix_type("ramp", 300, 100000_int64, [0.0_dp, 1.0_dp, 0.02_dp, 0.0_dp, 1.0e-6_dp]), &
      & mix_type("long", 300, 1000000_int64, [0.0_dp, 1.0_dp, 0.02_dp, 2.0e-4_dp, 0.0_dp]), &
      & mix_type("markov", 300, 100000_int64, [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], deviation=0.3_dp, time=100.0_dp), &
      & mix_type("sinusoid", 300, 100000_int64, [0.0_dp, 1.0_dp, 0.05_dp, 0.001_dp, 0.0_dp], amplitude=1.0_dp, &
      & frequency=0.0537_dp)]
   character(1), parameter :: letter(5) = ["Q", "N", "B", "K", "R"]
   character(13), parameter :: further(4) = [character(13) :: "q_c", "T_c", "amplitude", "frequency"]

   type(noise_options) :: fit
   type(allan_options) :: grid
   character(40) :: name, word
   integer :: records, i

   name = "all"
   records = 0
   if (command_argument_count() > 0) call get_command_argument(1, name)
   do i = 2, command_argument_count()
      call get_command_argument(i, word)
      select case (i)
      case (2); read (word, *) records
      case (3); grid%taus = trim(word)
      case (4); fit%method = trim(word)
      case default; fit%terms = trim(word)
      end select
   end do
   if (.not. allocated(grid%taus)) grid%taus = "octave"
   if (name /= "all" .and. .not. any(mixes%name == name)) then
      write (error_unit, "(*(a, 1x))") "mixes: all", (trim(mixes(i)%name), i=1, size(mixes))
      stop 1, quiet=.true.
   end if
   do i = 1, size(mixes)
      if (name == "all" .or. name == mixes(i)%name) call study(mixes(i), merge(records, mixes(i)%records, records > 0))
   end do

contains

   !> Simulates and fits the records of a mix, prints their table.
   subroutine study(mix, records)
      type(mix_type), intent(in) :: mix
      integer, intent(in) :: records
      type(outcome_type) :: outcome(records)
      integer :: i

      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(mix, i, outcome(i))
      end do
      !$omp end parallel do
      call print_table(mix, outcome)
   end subroutine study

   !> Simulates and fits one record.
   subroutine one_record(mix, number, outcome)
      type(mix_type), intent(in) :: mix
      !> Its number, which is its seed
      integer, intent(in) :: number
      type(outcome_type), intent(out) :: outcome
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: failure
      integer(int64) :: begin, finish, rate
      integer :: k

      options%samples = mix%samples
      options%rate_hz = 1
      options%unit = "deg/s"
      options%coefficient = mix%coefficient
      options%missing = mix%lost
      options%seed = number
      if (mix%time > 0) then
         options%ar = [exp(-1/mix%time)]
         options%ar_variance = mix%deviation**2
      end if
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) then
         if (mix%amplitude > 0) record%value(:, 1) = record%value(:, 1) + &
            & [(mix%amplitude*sin(6.283185307179586_dp*mix%frequency*k + number), k=1, int(mix%samples))]
         if (allocated(record%present)) then
            call compute_allan(record%value(:, 1), 1.0_dp, grid, curve, failure, record%present(:, 1))
         else
            call compute_allan(record%value(:, 1), 1.0_dp, grid, curve, failure)
         end if
      end if
      call system_clock(begin)
      if (.not. allocated(failure)) call fit_noise(curve, fit, noise, failure)
      call system_clock(finish, rate)
      if (allocated(failure)) then
         write (error_unit, "(2a, i0, 2a)") trim(mix%name), ", record ", number, ": ", failure%message
         error stop
      end if
      outcome%value = noise%coefficient%value
      outcome%error = noise%coefficient%std_error
      outcome%limit = noise%coefficient%upper_limit
      outcome%detected = noise%coefficient%detected
      outcome%further = [noise%markov%value, noise%correlation_time, noise%sinusoid%value, noise%frequency]
      outcome%further_error = [noise%markov%std_error, noise%correlation_time_error, noise%sinusoid%std_error, &
         & noise%frequency_error]
      outcome%chi2 = noise%chi2_reduced
      outcome%seconds = real(finish - begin, dp)/real(rate, dp)
      outcome%left_out = noise%left_out > 0
      outcome%misfit = noise%misfit > 0
   end subroutine one_record

   !> Prints a line per term. "as stated": a coefficient that is not detected counts as zero.
   subroutine print_table(mix, outcome)
      type(mix_type), intent(in) :: mix
      type(outcome_type), intent(in) :: outcome(:)
      real(dp) :: truth, unit, spread, mean
      integer :: j, n

      n = size(outcome)
      write (output_unit, "(/, 2a, i0, a, i0, 7a)") trim(mix%name), ": ", n, " records of ", mix%samples, " samples, taus ", &
         & grid%taus, ", ", trim(fit%method), " fit, terms ", trim(fit%terms)
      write (output_unit, "(a)") "term      truth  bias %    +-  RMSE %  as stated %  stated/true error  within 2 errors %  "// &
         & "detected %  limit >= truth %"
      do j = 1, 5
         truth = mix%coefficient(j)
         if (truth <= 0) then
            write (output_unit, "(a4, f11.5, a74, f8.1)") letter(j), truth, "", percent(outcome%detected(j))
            cycle
         end if
         unit = truth/100
         mean = sum(outcome%value(j))/n
         spread = sqrt(sum((outcome%value(j) - mean)**2)/(n - 1))
         write (output_unit, "(a4, es11.3, f8.2, f6.2, f8.2, f13.2, f19.2, f19.1, f12.1, f18.1)") letter(j), truth, &
            & (mean - truth)/unit, spread/unit/sqrt(real(n, dp)), sqrt(sum((outcome%value(j) - truth)**2)/n)/unit, &
            & sqrt(sum((merge(outcome%value(j), 0.0_dp, outcome%detected(j)) - truth)**2)/n)/unit, &
            & stated_error(outcome, j)/spread, percent(abs(outcome%value(j) - truth) <= 2*outcome%error(j)), &
            & percent(outcome%detected(j)), percent(outcome%limit(j) >= truth)
      end do
      write (output_unit, "(a, f5.1, a, f5.1, a, f5.2, a, f5.1, a, f5.1)") "not in truth: Q or R ", &
         & percent((outcome%detected(1) .and. mix%coefficient(1) <= 0) .or. (outcome%detected(5) .and. mix%coefficient(5) <= 0)), &
         & " %, any ", percent(spurious(mix, outcome)), " %; chi2_reduced ", sum(outcome%chi2)/n, "; points left out ", &
         & percent(outcome%left_out), " %, misfit ", percent(outcome%misfit)
      write (output_unit, "(a, f8.2, a, f8.2)") "milliseconds per fit: mean ", 1e3_dp*sum(outcome%seconds)/n, ", least ", &
         & 1e3_dp*minval(outcome%seconds)
      do j = 1, 4
         call print_further(further(j), further_truth(mix, j), outcome%further(j), outcome%further_error(j))
      end do
   end subroutine print_table

   !> Root of the mean square of the stated errors, of the records that detect the term where most do.
   pure real(dp) function stated_error(outcome, j)
      type(outcome_type), intent(in) :: outcome(:)
      integer, intent(in) :: j
      logical :: counts(size(outcome))

      counts = outcome%detected(j)
      if (2*count(counts) < size(counts)) counts = .true.
      stated_error = sqrt(sum(outcome%error(j)**2, mask=counts)/count(counts))
   end function stated_error

   !> A line of a parameter of a Markov process or a sinusoid.
   subroutine print_further(name, truth, value, error)
      character(*), intent(in) :: name
      real(dp), intent(in) :: truth, value(:), error(:)
      real(dp), allocatable :: found(:)

      found = pack(value, value > 0)
      if (size(found) == 0) return
      if (truth <= 0) then
         write (output_unit, "(a10, a, f6.1, a)") name, " found in ", percent(value > 0), " %"
      else
         write (output_unit, "(a10, a, es11.4, a, es11.4, a, f6.1, a, f6.1, a)") name, " truth ", truth, ", mean ", &
            & sum(found)/size(found), ", found in ", percent(value > 0), " %, there within 2 errors in ", &
            & percent(pack(abs(value - truth) <= 2*error, value > 0)), " %"
      end if
   end subroutine print_further

   !> True q_c, T_c, amplitude, frequency.
   pure real(dp) function further_truth(mix, j)
      type(mix_type), intent(in) :: mix
      integer, intent(in) :: j
      real(dp) :: parameters(4)

      parameters = [0.0_dp, mix%time, mix%amplitude, mix%frequency]
      if (mix%time > 0) parameters(1) = mix%deviation*sqrt(2/mix%time)
      further_truth = parameters(j)
   end function further_truth

   !> Records that show a term that is not there.
   pure function spurious(mix, outcome) result(any_of)
      type(mix_type), intent(in) :: mix
      type(outcome_type), intent(in) :: outcome(:)
      logical :: any_of(size(outcome))
      integer :: j

      any_of = .false.
      do j = 1, 5
         if (mix%coefficient(j) <= 0) any_of = any_of .or. outcome%detected(j)
      end do
   end function spurious

   !> Share of true values in percent.
   pure real(dp) function percent(flags)
      logical, intent(in) :: flags(:)

      percent = 100*count(flags)/real(size(flags), dp)
   end function percent

end program allan_fit
