! SPDX-License-Identifier: MIT
!> Simulated records: the Allan variance of every term, repeatability, every option, the example record.
module test_simulate
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type, text_type, add_text
   use gyroakf_io_columns_writer, only : write_record
   use gyroakf_random, only : random_type, seed_random
   use gyroakf_simulate_noise, only : add_autoregressive
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, paper_seed
   use scratch_file, only : scratch_path, read_bytes, remove_file
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_overflow, ieee_set_flag, ieee_get_halting_mode, &
      & ieee_set_halting_mode
   implicit none (type, external)
   private
   public :: suite_simulate

   !> Records, their length and the averaging factors of the Monte Carlo tests
   integer, parameter :: records = 60, length = 4096, factors(4) = [1, 2, 8, 64]

   !> Allowed distance of a Monte Carlo mean from its expectation, in its standard errors (the seeds are fixed)
   real(dp), parameter :: errors_allowed = 4.5_dp

contains

   subroutine suite_simulate()
      call test("quantization-noise", test_q)
      call test("angle-random-walk", test_n)
      call test("bias-instability", test_b)
      call test("rate-random-walk", test_k)
      call test("ramp", test_r)
      call test("autoregressive", test_ar)
      call test("autoregressive-start", test_ar_start)
      call test("repeatable", test_repeatable)
      call test("streams", test_streams)
      call test("trend-offset", test_trend)
      call test("outliers", test_outliers)
      call test("lsb", test_lsb)
      call test("missing", test_missing)
      call test("record-fields", test_fields)
      call test("paper-preset", test_paper)
      call test("example-file", test_example)
      call test("failures", test_failures)
      call test("failures-of-lists", test_list_failures)
      call test("truth", test_truth)
      call test("overflow", test_overflow)
   end subroutine suite_simulate

   !> 3 Q^2/tau^2, exact at every m
   subroutine test_q()
      type(simulate_options) :: options

      options%coefficient(1) = 0.3_dp
      call check_avar(options, 3*(0.3_dp*options%rate_hz/factors)**2)
   end subroutine test_q

   !> N^2/tau, exact at every m
   subroutine test_n()
      type(simulate_options) :: options

      options%coefficient(2) = 0.02_dp
      call check_avar(options, 0.02_dp**2*options%rate_hz/factors)
   end subroutine test_n

   !> The exact expectation of the filter that begins with the record; 1.5 % above (2 ln 2/pi) B^2 at m = 8, on it at 64.
   subroutine test_b()
      type(simulate_options) :: options
      real(dp) :: expected(size(factors)), floor_value
      integer :: i

      do i = 1, size(factors)
         expected(i) = 0.05_dp**2*flicker_variance(factors(i))
      end do
      floor_value = (0.6642824702679601_dp*0.05_dp)**2
      call check(error, expected(3), 1.0153_dp*floor_value, thr=1.0e-4_dp, rel=.true.)
      call check(error, expected(4), floor_value, thr=1.0e-3_dp, rel=.true.)
      options%coefficient(3) = 0.05_dp
      call check_avar(options, expected)
   end subroutine test_b

   !> K^2 tau/3 at every m, because rates are means over their intervals (a plain cumulated sum has 1.5 times that at m = 1)
   subroutine test_k()
      type(simulate_options) :: options

      options%coefficient(4) = 0.1_dp
      call check_avar(options, 0.1_dp**2*factors/options%rate_hz/3)
   end subroutine test_k

   !> R^2 tau^2/2 exactly, for either sign; the first rate is the mean over the first interval.
   subroutine test_r()
      type(simulate_options) :: options
      real(dp) :: x(length)
      integer :: i

      options%coefficient(5) = -0.01_dp
      options%samples = length
      call simulate(options, x)
      call check(error, x(1), -0.01_dp*0.1_dp, thr=1.0e-15_dp)
      do i = 1, size(factors)
         call check(error, allan_variance(x, factors(i)), (0.01_dp*factors(i)/5)**2/2, thr=1.0e-9_dp, rel=.true.)
      end do
   end subroutine test_r

   !> s2 (n - 3 p - n p^2 + 4 p^(n+1) - p^(2n+1))/(n^2 (1-p)^2 (1-p^2)), s2 the innovation variance (N. Zhang, Metrologia 2008)
   subroutine test_ar()
      type(simulate_options) :: options
      real(dp), parameter :: p = 0.9_dp, variance = 2.5_dp

      options%ar = [p]
      options%ar_variance = variance
      call check_avar(options, variance*(factors*(1 - p**2) - 3*p + 4*p**(factors + 1) - p**(2*factors + 1)) &
         & /(real(factors, dp)**2*(1 - p)**2))
   end subroutine test_ar

   !> AR(2) is stationary from its first sample: variance and the first two correlations over many starts.
   subroutine test_ar_start()
      integer, parameter :: starts = 4000
      real(dp), parameter :: phi(2) = [1.2_dp, -0.6_dp], rho_1 = 1.2_dp/1.6_dp, rho_2 = 1.2_dp*rho_1 - 0.6_dp
      real(dp), allocatable :: x(:, :)
      type(random_type) :: random
      real(dp) :: bound
      integer :: i, k

      allocate (x(5, starts), source=0.0_dp)
      call seed_random(random, 11_int64)
      do i = 1, starts
         call add_autoregressive(x(:, i), phi, 4.0_dp, random, failure)
      end do
      bound = errors_allowed*4*sqrt(2.0_dp/starts)
      do k = 1, 3
         call check(error, sum(x(k, :)**2)/starts, 4.0_dp, thr=bound)
         call check(error, sum(x(k, :)*x(k + 1, :))/starts, 4*rho_1, thr=bound)
         call check(error, sum(x(k, :)*x(k + 2, :))/starts, 4*rho_2, thr=bound)
      end do
   end subroutine test_ar_start

   subroutine test_repeatable()
      type(simulate_options) :: options
      real(dp) :: x(500), y(500)

      options = everything()
      call simulate(options, x)
      call simulate(options, y)
      call check(error, maxval(abs(x - y)) <= 0, "the same seed")
      options%seed = options%seed + 1
      call simulate(options, y)
      call check(error, count(abs(x - y) > 0) > 450, "another seed")
      options%seed = -huge(1_int64)
      call simulate(options, y)
      call check(error, count(abs(x - y) > 0) > 450, "any number is a seed")
   end subroutine test_repeatable

   !> Each random term alone, added up, is all of them together: no term's draw depends on another's presence.
   subroutine test_streams()
      type(simulate_options) :: options
      real(dp) :: x(500), y(500), total(500)
      integer :: k

      options = everything()
      options%outliers = 0
      options%lsb = 0
      options%missing = 0
      options%trend = [0.0_dp]
      options%offset = 0
      call simulate(options, x)
      total = 0
      do k = 1, 6
         options = only_term(everything(), k)
         call simulate(options, y)
         total = total + y
      end do
      call check(error, maxval(abs(x - total)) < 1.0e-12_dp)
   end subroutine test_streams

   subroutine test_trend()
      type(simulate_options) :: options
      real(dp) :: x(100)
      integer :: i

      options%samples = 100
      options%trend = [1.0_dp, -0.5_dp, 0.25_dp]
      options%offset = 7
      call simulate(options, x)
      do i = 0, 99
         call check(error, x(i + 1), 8 - 0.5_dp*i + 0.25_dp*i**2, thr=1.0e-14_dp, rel=.true.)
      end do
   end subroutine test_trend

   !> As many as asked for, 0.75 .. 1.25 of the size, both signs; all samples may be outliers.
   subroutine test_outliers()
      type(simulate_options) :: options
      real(dp) :: x(1000), y(1000), deviation

      options%samples = 1000
      options%coefficient(2) = 1
      call simulate(options, x)
      deviation = sqrt(sum((x - sum(x)/1000)**2)/999)
      options%outliers = 40
      options%outlier_size = 20
      call simulate(options, y)
      y = (y - x)/deviation
      call check(error, count(abs(y) > 0), 40)
      call check(error, all(abs(y) <= 0 .or. (abs(y) > 14.99_dp .and. abs(y) < 25.01_dp)), "sizes")
      call check(error, count(y > 0) > 8 .and. count(y < 0) > 8, "signs")
      options%outliers = 1000
      call simulate(options, y)
      call check(error, count(abs(y - x) > 0), 1000)
   end subroutine test_outliers

   !> Every value is the nearest multiple of the step, the offset included.
   subroutine test_lsb()
      type(simulate_options) :: options
      real(dp) :: x(1000), y(1000)

      options%samples = 1000
      options%coefficient(2) = 1
      options%offset = 0.3_dp
      call simulate(options, x)
      options%lsb = 0.25_dp
      call simulate(options, y)
      call check(error, all(abs(4*y - anint(4*y)) <= 0))
      call check(error, maxval(abs(x - y)) <= 0.125_dp)
   end subroutine test_lsb

   subroutine test_missing()
      type(simulate_options) :: options
      type(record_type) :: whole, record
      integer :: lost

      options%coefficient(2) = 1
      call simulate_record(options, whole, failure)
      if (unmet(.not. allocated(whole%present))) return
      options%missing = 0.05_dp
      call simulate_record(options, record, failure)
      lost = count(record%present(:, 1) == 0_int8)
      call check(error, abs(lost - 600) < errors_allowed*sqrt(12000*0.05_dp*0.95_dp), "share")
      call check(error, record%audit%missing, int(lost, int64))
      call check(error, maxval(abs(record%value(:, 1) - whole%value(:, 1)*record%present(:, 1))) <= 0, "0 where missing")
   end subroutine test_missing

   subroutine test_fields()
      type(simulate_options) :: options
      type(record_type) :: record

      options%samples = 50
      options%unit = "mdps"
      options%rate_hz = 100
      options%trend = [2.0_dp, 0.5_dp]
      call simulate_record(options, record, failure)
      call check(error, record%unit%name, "mdps")
      call check(error, record%sample_interval, 0.01_dp)
      call check(error, record%rate_known .and. record%rate_source == "option" .and. record%unit_source == "option")
      if (unmet(size(record%channel) == 1 .and. record%channel(1)%text == "gx")) return
      if (unmet(record%audit%samples == 50 .and. size(record%value, 1) == 50)) return
      call check(error, all(abs([record%audit%minimum(1), record%audit%maximum(1), record%audit%quantization(1)] &
         & - [2.0_dp, 26.5_dp, 0.5_dp]) <= 0))
   end subroutine test_fields

   !> Cubic with mean 0 and extremes at 2221 and 7999; noise of the paper's phi and variance; 12 outliers beyond 5 sigma.
   subroutine test_paper()
      type(simulate_options) :: options
      real(dp) :: trend(12000), x(12000), y(12000), variance, phi

      options = paper_preset(paper_seed)
      options%ar = [real(dp) ::]
      options%ar_variance = 0
      options%outliers = 0
      call simulate(options, trend)
      call check(error, abs(sum(trend))/12000 < 1.0e-16_dp, "mean of the trend")
      call check(error, maxloc(trend(:8000), 1) == 2222 .and. minloc(trend(2222:), 1) == 7999 - 2221 + 1, "extremes")
      options = paper_preset(paper_seed)
      call simulate(options, y)
      options%outliers = 0
      call simulate(options, x)
      call check(error, count(abs(y - x) > 0) == 12 .and. all(abs(y - x) <= 0 .or. abs(y - trend) > 5*0.0229_dp), "outliers")
      x = x - trend - sum(x)/12000
      variance = sum(x**2)/12000
      phi = sum(x(2:)*x(:11999))/12000/variance
      call check(error, variance, 5.24e-4_dp, thr=0.02_dp, rel=.true.)
      call check(error, phi, 0.409975_dp, thr=sqrt((1 - 0.409975_dp**2)/12000))
   end subroutine test_paper

   !> The example record is the preset, byte for byte.
   subroutine test_example()
      type(record_type) :: record
      type(text_type), allocatable :: header(:)
      character(:), allocatable :: path, made

      path = scratch_path("example.txt")
      call simulate_record(paper_preset(paper_seed), record, failure)
      call add_text(header, "made by: gyroakf simulate --preset paper --seed 1140")
      call write_record(path, record, header, 9, failure)
      if (went_wrong(failure)) return
      made = read_bytes(path)
      call remove_file(path)
      call check(error, len(made) > 100000 .and. made == read_bytes("example/data/mems_gyro_x.txt"))
   end subroutine test_example

   !> Every scalar option out of its range, NaN included
   subroutine test_failures()
      type(simulate_options) :: options
      real(dp) :: nan
      integer :: k

      nan = ieee_value(nan, ieee_quiet_nan)
      do k = 1, 19
         options = everything()
         select case (k)
         case (1); options%samples = 0
         case (2); options%rate_hz = 0
         case (3); options%rate_hz = nan
         case (4:7); options%coefficient(1 + mod(k, 4)) = -1
         case (8); options%coefficient(5) = nan
         case (9); options%ar_variance = -1
         case (10); options%offset = nan
         case (11); options%outliers = -1
         case (12); options%outliers = options%samples + 1
         case (13); options%outlier_size = -1
         case (14); options%lsb = -1
         case (15); options%missing = 1
         case (16); options%missing = -0.1_dp
         case (17); options%unit = "furlong"
         case (18); options%rate_hz = 1.0e-200_dp
         case default; options%coefficient(2) = 1.0e300_dp
         end select
         call expect(options, status%invalid_argument, k)
      end do
   end subroutine test_failures

   !> Lists, models, combinations, sizes
   subroutine test_list_failures()
      type(simulate_options) :: options
      real(dp) :: nan
      integer :: k

      nan = ieee_value(nan, ieee_quiet_nan)
      do k = 1, 5
         options = everything()
         select case (k)
         case (1); options%ar = [0.5_dp, nan]
         case (2); options%ar = [real(dp) ::]              ! a variance without coefficients
         case (3); options%trend = [1.0_dp, nan]
         case (4); allocate (options%trend(60), source=0.0_dp)
         case default; options = simulate_options(outliers=3, outlier_size=5.0_dp)    ! no noise to measure them with
         end select
         call expect(options, status%invalid_argument, k)
      end do
      options = everything()
      options%ar = [1.0_dp]
      call expect(options, status%unstable, 6)
      options%ar = [0.5_dp, 0.6_dp]
      call expect(options, status%unstable, 7)
      options%samples = 2_int64**62
      call expect(options, status%no_memory, 8)
   end subroutine test_list_failures

   !> Every option is in its range, but outliers of so many standard deviations overflow.
   subroutine test_overflow()
      real(dp), parameter :: white(5) = [0.0_dp, 1.0e130_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      logical :: halts

      call ieee_get_halting_mode(ieee_overflow, halts)
      call ieee_set_halting_mode(ieee_overflow, .false.)
      call expect(simulate_options(samples=100, rate_hz=1.0e139_dp, coefficient=white, outliers=3, &
                                          outlier_size=1.0e139_dp), status%non_finite, 1)
      call ieee_set_flag(ieee_overflow, .false.)
      call ieee_set_halting_mode(ieee_overflow, halts)
   end subroutine test_overflow

   !> Options with everything switched on, 500 samples
   function everything() result(options)
      type(simulate_options) :: options

      options%samples = 500
      options%seed = 5
      options%coefficient = [0.1_dp, 0.2_dp, 0.3_dp, 0.4_dp, 0.01_dp]
      allocate (options%ar(2))
      options%ar(:) = [0.5_dp, 0.2_dp]
      options%ar_variance = 1
      options%outliers = 5
      options%outlier_size = 10
      options%lsb = 1.0e-6_dp
      options%missing = 0.02_dp
   end function everything

   !> The options with one term only: Q N B K R, 6 the autoregressive process
   function only_term(all_terms, k) result(options)
      type(simulate_options), intent(in) :: all_terms
      integer, intent(in) :: k
      type(simulate_options) :: options

      options%samples = all_terms%samples
      options%seed = all_terms%seed
      if (k <= 5) then
         options%coefficient(k) = all_terms%coefficient(k)
      else
         allocate (options%ar, source=all_terms%ar)
         options%ar_variance = all_terms%ar_variance
      end if
   end function only_term

   !> The call fails with this code.
   subroutine expect(options, code, k)
      type(simulate_options), intent(in) :: options
      integer, intent(in) :: code, k
      type(record_type) :: record
      character(8) :: number

      write (number, "(i0)") k
      call simulate_record(options, record, failure)
      if (allocated(failure)) then
         call check(error, failure%code, code, "case "//number//": "//failure%message)
      else
         call check(error, .false., "no error in case "//number)
      end if
   end subroutine expect

   !> The mean Allan variance of many records is the expected one, at each of the factors.
   subroutine check_avar(options, expected)
      type(simulate_options), intent(inout) :: options
      real(dp), intent(in) :: expected(:)
      real(dp) :: x(length), variance(records), mean, spread
      real(dp), allocatable :: all_variances(:, :)
      integer :: i, k

      allocate (all_variances(records, size(factors)))
      options%samples = length
      do i = 1, records
         options%seed = i
         call simulate(options, x)
         do k = 1, size(factors)
            all_variances(i, k) = allan_variance(x, factors(k))
         end do
      end do
      do k = 1, size(factors)
         variance = all_variances(:, k)
         mean = sum(variance)/records
         spread = sqrt(sum((variance - mean)**2)/(records - 1)/records)
         call check(error, mean, expected(k), thr=errors_allowed*spread)
      end do
   end subroutine check_avar

   subroutine simulate(options, x)
      type(simulate_options), intent(in) :: options
      real(dp), intent(out) :: x(:)
      type(record_type) :: record

      x = huge(x)
      call simulate_record(options, record, failure)
      if (.not. allocated(failure)) x = record%value(:, 1)
   end subroutine simulate

   !> Overlapping Allan variance of rates by its definition, with averages of m
   pure real(dp) function allan_variance(x, m)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: m
      real(dp) :: sums(0:size(x))
      integer :: k

      sums(0) = 0
      do k = 1, size(x)
         sums(k) = sums(k - 1) + x(k)
      end do
      allan_variance = 0
      do k = 0, size(x) - 2*m
         allan_variance = allan_variance + (sums(k + 2*m) - 2*sums(k + m) + sums(k))**2
      end do
      allan_variance = allan_variance/(2*real(m, dp)**2*(size(x) - 2*m + 1))
   end function allan_variance

   !> Expectation of that for unit white noise through h_k = h_(k-1) (k - 1/2)/k from the record's start: the variance
   !> of the term that begins at sample k sums the squares of the filtered response over the k + 2 m inputs so far.
   pure real(dp) function flicker_variance(m)
      integer, intent(in) :: m
      real(dp) :: sums(-2*length:length), h, response
      integer :: k, terms

      sums(:0) = 0
      h = 1
      do k = 1, length
         sums(k) = sums(k - 1) + h
         h = h*(k - 0.5_dp)/k
      end do
      terms = length - 2*m + 1
      flicker_variance = 0
      do k = 0, length - 1
         response = sums(k + 1) - 2*sums(k + 1 - m) + sums(k + 1 - 2*m)
         flicker_variance = flicker_variance + response**2*min(terms, length - k)
      end do
      flicker_variance = flicker_variance/(2*real(m, dp)**2*terms)
   end function flicker_variance

   !> The true drift is the record without white noise, quantization, outliers, rounding and losses.
   subroutine test_truth()
      type(simulate_options) :: options
      type(record_type) :: smooth, record, truth

      options%samples = 3000
      options%coefficient(3:5) = [0.01_dp, 1.0e-3_dp, 1.0e-5_dp]
      options%ar = [0.9_dp]
      options%ar_variance = 1.0e-4_dp
      options%trend = [0.1_dp, -1.0e-6_dp]
      options%offset = 0.3_dp
      call simulate_record(options, smooth, failure, truth)
      if (went_wrong(failure)) return
      call check(error, maxval(abs(smooth%value - truth%value)) <= 0, "nothing but drift")
      options%coefficient(:2) = [1.0e-3_dp, 0.02_dp]
      options%outliers = 20
      options%outlier_size = 10
      options%lsb = 1.0e-3_dp
      options%missing = 0.1_dp
      options%unit = "deg/h"
      call simulate_record(options, record, failure, truth)
      if (went_wrong(failure)) return
      call check(error, maxval(abs(smooth%value - truth%value)) <= 0, "what is added is no drift")
      call check(error, maxval(abs(record%value - truth%value)) > 0.1_dp, "it was added")
      if (unmet(.not. allocated(truth%present) .and. allocated(record%present), "known where samples are lost")) return
      call check(error, truth%unit%name == "deg/h" .and. abs(truth%sample_interval - 0.2_dp) <= 0, "its unit and rate")
   end subroutine test_truth

end module test_simulate
