! SPDX-License-Identifier: MIT
!> Monte Carlo of the noise fit: bias, RMSE, stated over true standard error, coverage of the 68 % and 95 % intervals, false
!> terms, and what the upper limits cover.
!>
!>     ./run.sh [CASE [RECORDS [SEED]]]
!>
!> CASE is a name of the list below, or all (default), of RECORDS records (default 2000, sensors 60), their seeds from SEED on.
!> Coefficients are in deg/h and seconds. "stated" are the records that state a value; bias to 95 % are of these.
!> "limit >= truth" is the share of records whose upper limit holds: of those that do not state the term, and of all.
!> In the case sensors each record has its own filter, LSB and level of noise: there the columns compare with the truth of
!> the record, and the last line tells how many come within 3 % of N and 15 % of B.
program allan_fit
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, int64, noise_options, &
      & noise_type, record_type, simulate_options, simulate_record
   implicit none (type, external)

   !> A noise whose truth is known
   type :: case_type
      character(10) :: name
      real(dp) :: rate
      integer(int64) :: samples
      !> Q N B K R
      real(dp) :: coefficient(5)
      character(7) :: tails = "normal"
      integer :: records = 2000
      !> Share lost at random; each of so many samples lost (0: none); amplitude and time constant of a warm-up
      real(dp) :: lost = 0.0_dp
      integer :: every = 0
      real(dp) :: warm_up(2) = 0.0_dp
   end type case_type

   !> What a fit gives, and the truth
   type :: outcome_type
      real(dp) :: truth(5), value(5), error(5), limit(5)
      logical :: stated(5), limited(5), described
   end type outcome_type

   type(case_type), parameter :: cases(*) = [ &
      & case_type("N", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]), &
      & case_type("NB", 10.0_dp, 216000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp]), &
      & case_type("six_hours", 10.0_dp, 216000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.1_dp, 0.0_dp]), &
      & case_type("NBK", 10.0_dp, 72000_int64, [0.0_dp, 3.0_dp, 3.0_dp, 0.3_dp, 0.0_dp]), &
      & case_type("NK", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 0.0_dp, 0.5_dp, 0.0_dp]), &
      & case_type("QNB", 10.0_dp, 72000_int64, [30.0_dp, 3.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]), &
      & case_type("laplace", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], tails="laplace"), &
      & case_type("t5", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], tails="t5"), &
      & case_type("ten_min", 100.0_dp, 60000_int64, [0.0_dp, 1.0_dp, 0.3_dp, 0.0_dp, 0.0_dp]), &
      & case_type("lost_10_%", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], lost=0.1_dp), &
      & case_type("lost_8th", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], every=8), &
      & case_type("ramp", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.01_dp]), &
      & case_type("warm_up", 10.0_dp, 72000_int64, [0.0_dp, 18.0_dp, 6.0_dp, 0.0_dp, 0.0_dp], warm_up=[300.0_dp, 600.0_dp]), &
      & case_type("sensors", 100.0_dp, 1000000_int64, [0.0_dp, 150.0_dp, 35.0_dp, 0.0_dp, 0.0_dp], records=60)]
   character(1), parameter :: letter(5) = ["Q", "N", "B", "K", "R"]
   character(40) :: name, word
   integer :: records, seed, i

   name = "all"
   records = 0
   seed = 1
   if (command_argument_count() > 0) call get_command_argument(1, name)
   do i = 2, min(3, command_argument_count())
      call get_command_argument(i, word)
      if (i == 2) read (word, *) records
      if (i == 3) read (word, *) seed
   end do
   if (name /= "all" .and. .not. any(cases%name == name)) then
      write (error_unit, "(*(a, 1x))") "cases: all", (trim(cases(i)%name), i=1, size(cases))
      stop 1, quiet=.true.
   end if
   write (output_unit, "(a)") "| case | of | truth | stated % | bias % | +- | RMSE % | stated/true error | "// &
      & "in 68.3 % | in 95 % | limit >= truth %, not stated | of all | false Q B K R, % |", &
      & "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|"
   do i = 1, size(cases)
      if (name == "all" .or. name == cases(i)%name) call study(cases(i), merge(records, cases(i)%records, records > 0), seed)
   end do

contains

   !> Simulates and fits the records of a case, prints their lines.
   subroutine study(case, records, seed)
      type(case_type), intent(in) :: case
      integer, intent(in) :: records, seed
      type(outcome_type) :: outcome(records)
      integer :: i

      !$omp parallel do schedule(dynamic)
      do i = 1, records
         call one_record(case, seed + i - 1, outcome(i))
      end do
      !$omp end parallel do
      call print_lines(case, outcome)
   end subroutine study

   !> Simulates and fits one record.
   subroutine one_record(case, seed, outcome)
      type(case_type), intent(in) :: case
      integer, intent(in) :: seed
      type(outcome_type), intent(out) :: outcome
      type(simulate_options) :: options
      type(record_type) :: record
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(error_type), allocatable :: failure
      real(dp), allocatable :: rate(:)
      integer :: k

      options%samples = case%samples
      options%rate_hz = case%rate
      options%unit = "deg/h"
      options%coefficient = case%coefficient
      options%tails = case%tails
      options%missing = case%lost
      options%seed = seed
      if (case%name == "sensors") call make_sensor(seed, options)
      outcome%truth = options%coefficient
      outcome%truth(2) = sqrt(outcome%truth(2)**2 + options%lsb**2/(12*case%rate))
      call make_rate(case, options, record, rate, failure)
      if (.not. allocated(failure)) then
         if (allocated(record%present)) then
            call compute_allan(rate, 1/case%rate, allan_options(), curve, failure, record%present(:, 1))
         else if (case%every > 0) then
            call compute_allan(rate, 1/case%rate, allan_options(), curve, failure, &
               & [(int(merge(0, 1, mod(k, case%every) == 0), kind=1), k=1, size(rate))])
         else
            call compute_allan(rate, 1/case%rate, allan_options(), curve, failure)
         end if
      end if
      if (.not. allocated(failure)) call fit_noise(curve, noise_options(), noise, failure)
      if (allocated(failure)) then
         write (error_unit, "(2a, i0, 2a)") trim(case%name), ", seed ", seed, ": ", failure%message
         error stop
      end if
      outcome%value = noise%coefficient%value
      outcome%error = noise%coefficient%std_error
      outcome%limit = noise%coefficient%upper_limit
      outcome%stated = noise%coefficient%detected
      outcome%limited = noise%coefficient%fitted .and. .not. noise%coefficient%detected
      outcome%described = noise%described
   end subroutine one_record

   !> The rates of a record: flicker noise is made at four times the rate and averaged, as in fractional differences its Allan
   !> variance is 44 % above the model at one sample, 4 % at four; then warm-up and rounding.
   subroutine make_rate(case, options, record, rate, failure)
      type(case_type), intent(in) :: case
      type(simulate_options), intent(in) :: options
      !> All but the flicker noise, with its missing samples
      type(record_type), intent(out) :: record
      real(dp), allocatable, intent(out) :: rate(:)
      type(error_type), allocatable, intent(out) :: failure
      type(simulate_options) :: part
      type(record_type) :: flicker
      integer :: k

      part = options
      part%coefficient(3) = 0
      part%lsb = 0
      call simulate_record(part, record, failure)
      if (allocated(failure)) return
      rate = record%value(:, 1) + case%warm_up(1)*exp(-[(k, k=0, size(record%value, 1) - 1)]/ &
         & (case%rate*max(case%warm_up(2), 1.0_dp)))
      if (options%coefficient(3) > 0) then
         part = simulate_options(samples=4*options%samples, seed=options%seed + 1000000, rate_hz=4*options%rate_hz, &
            & coefficient=[0.0_dp, 0.0_dp, options%coefficient(3), 0.0_dp, 0.0_dp])
         part%unit = options%unit
         call simulate_record(part, flicker, failure)
         if (allocated(failure)) return
         rate = rate + sum(reshape(flicker%value(:, 1), [4, size(rate)]), dim=1)/4
      end if
      if (options%lsb > 0) rate = options%lsb*anint(rate/options%lsb)
   end subroutine make_rate

   !> A Butterworth low-pass filter or a resonance between a sixth and a quarter of the rate, an LSB of 0.1 to 2 standard deviations
   !> of what it passes, by its equivalent noise bandwidth.
   subroutine make_sensor(seed, options)
      integer, intent(in) :: seed
      type(simulate_options), intent(inout) :: options
      real(dp), parameter :: half_pi = 1.5707963267948966_dp
      real(dp) :: u(4), corner, bandwidth
      integer :: i

      u = [(fraction_of(seed*7919.0_dp + i*104729.0_dp), i=1, 4)]
      corner = options%rate_hz*(1/6.0_dp + u(1)*(1/4.0_dp - 1/6.0_dp))
      if (u(2) < 0.5_dp) then
         options%lowpass_hz = corner
         options%lowpass_order = merge(1, 2, u(2) < 0.25_dp)
         bandwidth = corner*merge(half_pi, 1.11_dp, u(2) < 0.25_dp)
      else
         options%resonance_hz = corner
         options%resonance_q = 1 + 6*(u(2) - 0.5_dp)
         bandwidth = corner*half_pi*options%resonance_q
      end if
      options%coefficient(2) = options%coefficient(2)*(0.8_dp + 0.4_dp*u(4))
      options%lsb = options%coefficient(2)*sqrt(min(options%rate_hz, 2*bandwidth))*0.1_dp*20**u(3)
   end subroutine make_sensor

   !> A number between 0 and 1 that looks random.
   pure real(dp) function fraction_of(x)
      real(dp), intent(in) :: x

      fraction_of = modulo(sin(x)*43758.5453_dp, 1.0_dp)
   end function fraction_of

   !> A line for each term that is there.
   subroutine print_lines(case, outcome)
      type(case_type), intent(in) :: case
      type(outcome_type), intent(in) :: outcome(:)
      real(dp), allocatable :: relative(:), error(:)
      real(dp) :: spread
      logical :: first
      integer :: j, k, n

      first = .true.
      do j = 1, 5
         if (case%coefficient(j) <= 0) cycle
         relative = pack(outcome%value(j)/outcome%truth(j) - 1, outcome%stated(j))
         error = pack(outcome%error(j)/outcome%truth(j), outcome%stated(j))
         n = max(1, size(relative))
         spread = sqrt(sum((relative - sum(relative)/n)**2)/max(1, n - 1))
         write (output_unit, "(4a, f0.3, 9(a, f0.2), *(a))") "| ", merge(case%name, "          ", first), " | ", letter(j)// &
            & " | ", case%coefficient(j), " | ", percent(outcome%stated(j)), " | ", 100*sum(relative)/n, " | ", &
            & 100*spread/sqrt(real(n, dp)), " | ", 100*sqrt(sum(relative**2)/n), " | ", sqrt(sum(error**2)/n)/spread, " | ", &
            & percent(abs(relative) <= error), " | ", percent(abs(relative) <= 1.96_dp*error), " | ", &
            & percent(pack(outcome%limit(j) >= outcome%truth(j), outcome%limited(j))), " | ", percent(outcome%limit(j) >= &
            & outcome%truth(j) .or. .not. (outcome%limited(j) .or. outcome%stated(j))), " |", &
            & (false_text(outcome, first, k), k=1, 5), " |"
         first = .false.
      end do
      if (case%name == "sensors") write (output_unit, "(a, 3(f0.1, a))") "| sensors | N within 3 % in ", &
         & percent(outcome%stated(2) .and. abs(outcome%value(2)/outcome%truth(2) - 1) < 0.03_dp), " %, B within 15 % ", &
         & percent(outcome%stated(3) .and. abs(outcome%value(3)/outcome%truth(3) - 1) < 0.15_dp), " %, described ", &
         & percent(outcome%described), " % of the records |"
      flush (output_unit)
   end subroutine print_lines

   !> How often a term is stated that is not there, "" for N and in further lines of a case; "-" where it is there.
   pure function false_text(outcome, first, j) result(text)
      type(outcome_type), intent(in) :: outcome(:)
      logical, intent(in) :: first
      integer, intent(in) :: j
      character(merge(6, 0, first .and. j /= 2)) :: text

      if (len(text) == 0) return
      text = " -"
      if (outcome(1)%truth(j) <= 0) write (text, "(f6.2)") percent(outcome%stated(j))
   end function false_text

   !> Share of true values in percent, 100 of nothing.
   pure real(dp) function percent(flags)
      logical, intent(in) :: flags(:)

      percent = 100
      if (size(flags) > 0) percent = 100*count(flags)/real(size(flags), dp)
   end function percent

end program allan_fit
