! SPDX-License-Identifier: MIT
!> Tests of the overlapping Allan deviation.
!>
!> NBS14: NIST SP 1065, section 12.4 (published to seven digits); the values with 16 digits were computed from
!> the same series in rational arithmetic. PHASE.DAT: results of Stable32 1.60 for the integral of the same series.
module test_allan_deviation
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_positive_inf
   use, intrinsic :: iso_fortran_env, only : qp => real128
   use expectations, only : check, agree
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use allan_series, only : nbs14_long, nbs14_short, normal_series, walk_of
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_deviation

   !> Sixteen digits of reference, rounding of a thousand additions
   real(dp), parameter :: exact = 1.0e-12_dp

contains

   subroutine collect_allan_deviation(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("nbs14_short", test_nbs14_short), &
         & new_unittest("nbs14_long", test_nbs14_long), &
         & new_unittest("nbs14_factors", test_nbs14_factors), &
         & new_unittest("phase_dat_limits", test_phase_dat_limits), &
         & new_unittest("ramp", test_ramp), &
         & new_unittest("constant", test_constant), &
         & new_unittest("discrete_forms", test_discrete_forms), &
         & new_unittest("rounding", test_rounding), &
         & new_unittest("large_offset", test_large_offset), &
         & new_unittest("scale", test_scale), &
         & new_unittest("threads", test_threads), &
         & new_unittest("direct_sum", test_direct_sum), &
         & new_unittest("quadruple", test_quadruple), &
         & new_unittest("octave_pairs", test_octave_pairs), &
         & new_unittest("gaps_direct_sum", test_gaps_direct_sum), &
         & new_unittest("gaps_white", test_gaps_white), &
         & new_unittest("gaps_quantised", test_gaps_quantised), &
         & new_unittest("gaps_ramp", test_gaps_ramp), &
         & new_unittest("gaps_strict", test_gaps_strict), &
         & new_unittest("non_finite", test_non_finite), &
         & new_unittest("nothing_missing", test_nothing_missing), &
         & new_unittest("shortest", test_shortest), &
         & new_unittest("noise_type", test_noise_type), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_allan_deviation

   !> The curve at these averaging times; stops the test on failure.
   subroutine curve_of(error, rate, interval, taus, curve, valid)
      type(error_type), allocatable, intent(out) :: error
      !> The record
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(in) :: interval
      character(*), intent(in) :: taus
      !> The result
      type(allan_curve_type), intent(out) :: curve
      !> Missing samples
      integer(int8), intent(in), contiguous, optional :: valid(:)

      type(gyro_error), allocatable :: failure
      type(allan_options) :: options

      options%taus = taus
      if (present(valid)) then
         call compute_allan(rate, interval, options, curve, failure, valid)
      else
         call compute_allan(rate, interval, options, curve, failure)
      end if
      if (allocated(failure)) call check(error, .false., failure%message)
   end subroutine curve_of

   subroutine test_nbs14_short(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      character(8) :: text

      call curve_of(error, nbs14_short(), 1.0_dp, "1,2", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, [91.22944974074983_dp, 85.95286983768101_dp], exact, "deviation")
      if (allocated(error)) return
      write (text, "(f8.5)") curve%deviation(1)
      call check(error, text, "91.22945")
      if (allocated(error)) return
      write (text, "(f8.5)") curve%deviation(2)
      call check(error, text, "85.95287")
      call check(error, all(curve%terms == [8, 6]))
   end subroutine test_nbs14_short

   subroutine test_nbs14_long(error)
      type(error_type), allocatable, intent(out) :: error

      character(*), parameter :: published(3) = ["2.922319E-01", "9.159953E-02", "3.241343E-02"]
      type(allan_curve_type) :: curve
      character(12) :: text
      integer :: i

      call curve_of(error, nbs14_long(), 1.0_dp, "1,10,100", curve)
      if (allocated(error)) return
      do i = 1, 3
         write (text, "(es12.6)") curve%deviation(i)
         call check(error, text, published(i))
         if (allocated(error)) return
      end do
      call agree(error, curve%deviation, [0.2922318781067592_dp, 0.09159953420118654_dp, 0.03241343026056984_dp], exact, "dev")
   end subroutine test_nbs14_long

   subroutine test_nbs14_factors(error)
      type(error_type), allocatable, intent(out) :: error

      real(dp), parameter :: expected(12) = [0.2010160421709385_dp, 0.1447913072184378_dp, 0.1057038500787000_dp, &
         & 0.06191477841874487_dp, 0.04808214262128163_dp, 0.03623721298570472_dp, 0.02767385582069448_dp, &
         & 0.01028221763903273_dp, 0.008244123626136666_dp, 0.002832505364418703_dp, 0.002158165703661819_dp, 0.0_dp]
      type(allan_curve_type) :: curve

      call curve_of(error, nbs14_long(), 1.0_dp, "2,4,8,16,32,64,128,256,333,499,500", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, expected(:11), exact, "deviation")
      call check(error, all(curve%terms == 1001 - 2*curve%m))
   end subroutine test_nbs14_factors

   subroutine test_phase_dat_limits(error)
      type(error_type), allocatable, intent(out) :: error

      real(dp), parameter :: lower(8) = [0.28515_dp, 0.19520_dp, 0.13931_dp, 0.10038_dp, 0.057696_dp, 0.043654_dp, &
         & 0.031755_dp, 0.023045_dp]
      real(dp), parameter :: middle(8) = [0.29223_dp, 0.20102_dp, 0.14479_dp, 0.10570_dp, 0.061915_dp, 0.048082_dp, &
         & 0.036237_dp, 0.027674_dp]
      real(dp), parameter :: upper(8) = [0.29987_dp, 0.20738_dp, 0.15098_dp, 0.11198_dp, 0.067217_dp, 0.054202_dp, &
         & 0.043377_dp, 0.037027_dp]
      type(allan_curve_type) :: curve

      ! five printed digits: 5e-5; the limits of the program are good to 6e-4
      call curve_of(error, nbs14_long(), 1.0_dp, "1,2,4,8,16,32,64,128", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == 0), "the noise is white")
      call agree(error, curve%deviation, middle, 5.0e-5_dp, "deviation")
      call agree(error, curve%lower, lower, 1.0e-3_dp, "lower limit")
      call agree(error, curve%upper, upper, 1.0e-3_dp, "upper limit")
   end subroutine test_phase_dat_limits

   subroutine test_ramp(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      real(dp) :: rate(5000)
      integer :: i

      ! w = R t gives R tau/sqrt(2) exactly
      rate = [(3.0_dp*0.01_dp*i, i=1, size(rate))]
      call curve_of(error, rate, 0.01_dp, "octave", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, 3.0_dp*curve%tau/sqrt(2.0_dp), 1.0e-11_dp, "deviation")
   end subroutine test_ramp

   subroutine test_constant(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      real(dp) :: rate(1000)

      rate = 0.1_dp
      call curve_of(error, rate, 1.0_dp, "octave", curve)
      if (allocated(error)) return
      call check(error, all(curve%deviation <= 1.0e-15_dp), "a constant has no deviation")
      call check(error, all(curve%lower <= curve%deviation .and. curve%deviation <= curve%upper))
   end subroutine test_constant

   subroutine test_discrete_forms(error)
      type(error_type), allocatable, intent(out) :: error

      ! white: 1/m; sum of steps: (2 m^2 + 1)/(6 m); first differences: 3/m^2; AR(1) with phi = 0.5 below
      integer, parameter :: n = 20000, runs = 10, factors = 5
      real(dp), parameter :: phi = 0.5_dp
      real(dp) :: g(n), series(n, 4), m(factors), found(factors, 4), expected(factors, 4)
      type(allan_curve_type) :: curve
      integer :: run, i, kind

      m = [1.0_dp, 2.0_dp, 5.0_dp, 10.0_dp, 50.0_dp]
      expected(:, 1) = 1/m
      expected(:, 2) = (2*m**2 + 1)/(6*m)
      expected(:, 3) = 3/m**2
      expected(:, 4) = (m - 3*phi - m*phi**2 + 4*phi**(m + 1) - phi**(2*m + 1))/(m**2*(1 - phi)**2*(1 - phi**2))
      found = 0
      do run = 1, runs
         g = normal_series(int(n, int64), int(7919*run, int64))
         series(1, :) = [g(1), g(1), 0.0_dp, g(1)/sqrt(1 - phi**2)]
         do i = 2, n
            series(i, :) = [g(i), series(i - 1, 2) + g(i), g(i) - g(i - 1), phi*series(i - 1, 4) + g(i)]
         end do
         do kind = 1, 4
            call curve_of(error, series(:, kind), 1.0_dp, "1,2,5,10,50", curve)
            if (allocated(error)) return
            found(:, kind) = found(:, kind) + curve%deviation**2/runs
         end do
      end do
      ! at m = 50 the average has 10 x 20000/50 = 4000 degrees of freedom: 5 % is two and a half standard errors
      call agree(error, reshape(found, [4*factors]), reshape(expected, [4*factors]), 0.06_dp, "mean variance")
   end subroutine test_discrete_forms

   subroutine test_rounding(error)
      type(error_type), allocatable, intent(out) :: error

      ! angle increments rounded to a step of 0.5: Q = step/sqrt(12), variance 3 Q^2/tau^2 plus that of the input
      integer, parameter :: n = 20000
      real(dp), parameter :: step = 0.5_dp
      type(allan_curve_type) :: curve
      real(dp) :: rate(n), angle, before
      integer :: i

      angle = 0
      before = 0
      do i = 1, n
         angle = angle + 0.3141592653589793_dp
         rate(i) = step*anint(angle/step) - before
         before = step*anint(angle/step)
      end do
      call curve_of(error, rate, 1.0_dp, "1,3,10,30,100", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation(3:4), sqrt(3.0_dp)*step/sqrt(12.0_dp)/curve%tau(3:4), 0.35_dp, "deviation")
   end subroutine test_rounding

   subroutine test_large_offset(error)
      type(error_type), allocatable, intent(out) :: error

      ! the offset costs six of the sixteen digits of the input itself; the same rounded input without it must agree
      integer, parameter :: n = 100000
      type(allan_curve_type) :: plain, shifted
      real(dp) :: rate(n), moved(n)

      rate = normal_series(int(n, int64), 4242_int64)
      moved = rate + 1.0e6_dp
      rate = moved - 1.0e6_dp
      call curve_of(error, rate, 1.0_dp, "octave", plain)
      if (allocated(error)) return
      call curve_of(error, moved, 1.0_dp, "octave", shifted)
      if (allocated(error)) return
      call agree(error, shifted%deviation, plain%deviation, 1.0e-11_dp, "deviation")
   end subroutine test_large_offset

   subroutine test_scale(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: plain, scaled

      call curve_of(error, nbs14_long(), 1.0_dp, "log:8", plain)
      if (allocated(error)) return
      call curve_of(error, -1.0e-9_dp*nbs14_long() + 3, 0.5_dp, "log:8", scaled)
      if (allocated(error)) return
      call agree(error, scaled%deviation*1.0e9_dp, plain%deviation, 1.0e-5_dp, "deviation")
      call agree(error, scaled%tau, 0.5_dp*plain%tau, exact, "tau")
      call agree(error, scaled%edf, plain%edf, exact, "edf")
   end subroutine test_scale

   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error

      integer(int64), parameter :: n = 600000
      type(allan_curve_type) :: one, two
      real(dp), allocatable :: rate(:)
      integer(int8), allocatable :: valid(:)
      integer :: threads

      allocate (rate, source=normal_series(n, 99_int64))
      allocate (valid(n))
      valid = 1
      valid(1000:n:777) = 0
      threads = thread_count()
      call set_thread_count(1)
      call curve_of(error, rate, 1.0_dp, "octave", one)
      call set_thread_count(2)
      if (.not. allocated(error)) call curve_of(error, rate, 1.0_dp, "octave", two)
      if (.not. allocated(error)) call agree(error, two%deviation, one%deviation, 0.0_dp, "two threads")
      call set_thread_count(1)
      if (.not. allocated(error)) call curve_of(error, rate, 1.0_dp, "octave", one, valid)
      call set_thread_count(2)
      if (.not. allocated(error)) call curve_of(error, rate, 1.0_dp, "octave", two, valid)
      if (.not. allocated(error)) call agree(error, two%deviation, one%deviation, 0.0_dp, "two threads, gaps")
      call set_thread_count(threads)
   end subroutine test_threads

   subroutine test_direct_sum(error)
      type(error_type), allocatable, intent(out) :: error

      ! lengths around the blocks of the prefix sum and of the terms
      integer, parameter :: lengths(6) = [2047, 2048, 2049, 8192, 16385, 70001]
      integer, parameter :: m = 3
      type(allan_curve_type) :: curve
      real(dp), allocatable :: rate(:)
      real(dp) :: expected
      integer :: i, k, n

      do i = 1, size(lengths)
         n = lengths(i)
         rate = normal_series(int(n, int64), 17_int64)
         call curve_of(error, rate, 1.0_dp, "3", curve)
         if (allocated(error)) return
         expected = 0
         do k = 1, n - 2*m + 1
            expected = expected + (sum(rate(k + m:k + 2*m - 1)) - sum(rate(k:k + m - 1)))**2
         end do
         expected = sqrt(expected/(2.0_dp*m**2*(n - 2*m + 1)))
         call agree(error, curve%deviation, [expected], exact, "deviation")
         if (allocated(error)) return
      end do
   end subroutine test_direct_sum

   subroutine test_octave_pairs(error)
      type(error_type), allocatable, intent(out) :: error

      ! octaves are summed two at a time, other factors one at a time
      type(allan_curve_type) :: octaves, odd, even
      real(dp) :: rate(9999)

      rate = normal_series(9999_int64, 404_int64)
      call curve_of(error, rate, 1.0_dp, "1,2,4,8,16,2048,4096", octaves)
      if (allocated(error)) return
      call curve_of(error, rate, 1.0_dp, "1,4,16,4096", odd)
      if (allocated(error)) return
      call curve_of(error, rate, 1.0_dp, "2,8,2048", even)
      if (allocated(error)) return
      call agree(error, octaves%deviation([1, 3, 5, 7]), odd%deviation, 1.0e-14_dp, "deviation")
      call agree(error, octaves%deviation([2, 4, 6]), even%deviation, 1.0e-14_dp, "deviation")
   end subroutine test_octave_pairs

   subroutine test_quadruple(error)
      type(error_type), allocatable, intent(out) :: error

      ! an offset of a million standard deviations; short and long factors, alone, in twos, threes and fours of octaves
      integer, parameter :: n = 560000
      integer(int64), parameter :: m(13) = [integer(int64) :: 1, 2, 4, 8, 16, 32, 100, 3000, 33000, 66000, 132000, 264000, 280000]
      character(*), parameter :: taus = "1,2,4,8,16,32,100,3000,33000,66000,132000,264000,280000"
      type(allan_curve_type) :: curve
      real(dp), allocatable :: rate(:), phase(:)
      real(dp) :: expected
      integer :: i

      rate = normal_series(int(n, int64), 18_int64) + 1.0e6_dp
      phase = exact_phase(rate)
      call curve_of(error, rate, 1.0_dp, taus, curve)
      if (allocated(error)) return
      call check(error, all(curve%m == m), "factors")
      do i = 1, size(m)
         if (allocated(error)) return
         associate (x => phase, last => n + 1 - 2*m(i))
            expected = sum((x(1 + 2*m(i):) - 2*x(1 + m(i):last + m(i)) + x(:last))**2)/real(last, dp)
         end associate
         call agree(error, curve%deviation(i:i), [sqrt(expected/2)/m(i)], exact, "deviation")
      end do
   end subroutine test_quadruple

   !> The integral of a rate less its mean, summed in quadruple precision.
   pure function exact_phase(rate) result(phase)
      real(dp), intent(in) :: rate(:)
      real(dp) :: phase(size(rate) + 1)

      real(qp) :: x, mean
      integer :: i

      mean = 0
      do i = 1, size(rate)
         mean = mean + rate(i)
      end do
      mean = mean/size(rate)
      x = 0
      phase(1) = 0
      do i = 1, size(rate)
         x = x + (rate(i) - mean)
         phase(i + 1) = real(x, dp)
      end do
   end function exact_phase

   subroutine test_gaps_direct_sum(error)
      type(error_type), allocatable, intent(out) :: error

      ! m = 4 with full windows: the plain mean over the terms without a missing sample
      integer, parameter :: n = 5000, m = 4
      type(allan_curve_type) :: curve
      integer(int8) :: valid(n)
      real(dp) :: rate(n), expected
      integer :: k, terms

      rate = normal_series(int(n, int64), 31_int64)
      valid = 1
      valid([1, 700, 701, 702, 2048, 2049, 4990]) = 0
      rate([1, 700, 701, 702, 2048, 2049, 4990]) = 1.0e30_dp
      call curve_of(error, rate, 1.0_dp, "4", curve, valid)
      if (allocated(error)) return
      expected = 0
      terms = 0
      do k = 1, n - 2*m + 1
         if (any(valid(k:k + 2*m - 1) == 0)) cycle
         terms = terms + 1
         expected = expected + (sum(rate(k + m:k + 2*m - 1)) - sum(rate(k:k + m - 1)))**2
      end do
      call check(error, curve%terms(1) == terms)
      call agree(error, curve%deviation, [sqrt(expected/(2.0_dp*m**2*terms))], exact, "deviation")
   end subroutine test_gaps_direct_sum

   !> Marks a share of the samples as missing, at random, and spoils their values.
   subroutine lose(rate, share, seed, valid)
      !> The record
      real(dp), intent(inout) :: rate(:)
      real(dp), intent(in) :: share
      integer, intent(in) :: seed
      !> 1 present, 0 missing
      integer(int8), intent(out) :: valid(:)

      valid = merge(0_int8, 1_int8, abs(normal_series(size(rate, kind=int64), int(seed, int64))) < share*1.2533_dp)
      where (valid == 0) rate = 1.0e6_dp
   end subroutine lose

   subroutine test_gaps_white(error)
      type(error_type), allocatable, intent(out) :: error

      ! 5 % lost: without the correction the variance is 5 % too large at long times
      integer, parameter :: n = 100000, runs = 6
      type(allan_curve_type) :: curve, whole
      real(dp) :: rate(n), ratio(3)
      integer(int8) :: valid(n)
      integer :: run

      ratio = 0
      do run = 1, runs
         rate = normal_series(int(n, int64), int(1000 + run, int64))
         call curve_of(error, rate, 1.0_dp, "10,40,100", whole)
         if (allocated(error)) return
         call lose(rate, 0.05_dp, 31*run, valid)
         call curve_of(error, rate, 1.0_dp, "10,40,100", curve, valid)
         if (allocated(error)) return
         ratio = ratio + (curve%deviation/whole%deviation)**2/runs
      end do
      call agree(error, ratio, [1.0_dp, 1.0_dp, 1.0_dp], 0.015_dp, "variance with and without gaps")
   end subroutine test_gaps_white

   subroutine test_gaps_quantised(error)
      type(error_type), allocatable, intent(out) :: error

      ! 0.3 % of the samples lost from differenced white noise: at m = 100 the lost samples double the variance
      integer, parameter :: n = 200000
      type(allan_curve_type) :: curve, whole
      real(dp) :: rate(n), g(n)
      integer(int8) :: valid(n)

      g = normal_series(int(n, int64), 5151_int64)
      rate(1) = 0
      rate(2:) = g(2:) - g(:n - 1)
      call curve_of(error, rate, 1.0_dp, "1,10,50,100", whole)
      if (allocated(error)) return
      call lose(rate, 0.003_dp, 77, valid)
      call curve_of(error, rate, 1.0_dp, "1,10,50,100", curve, valid)
      if (allocated(error)) return
      call agree(error, curve%deviation, whole%deviation, 0.08_dp, "deviation with and without gaps")
   end subroutine test_gaps_quantised

   subroutine test_gaps_ramp(error)
      type(error_type), allocatable, intent(out) :: error

      ! a deterministic drift is hardly touched by lost samples or their correction
      integer, parameter :: n = 20000
      type(allan_curve_type) :: curve
      real(dp) :: rate(n)
      integer(int8) :: valid(n)
      integer :: i

      rate = [(real(i, dp), i=1, n)]
      call lose(rate, 0.05_dp, 5, valid)
      call curve_of(error, rate, 1.0_dp, "100,1000,5000", curve, valid)
      if (allocated(error)) return
      call agree(error, curve%deviation, curve%tau/sqrt(2.0_dp), 0.002_dp, "deviation")
   end subroutine test_gaps_ramp

   subroutine test_gaps_strict(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      type(allan_options) :: options
      type(gyro_error), allocatable :: failure
      integer(int8) :: valid(1000)

      ! complete windows only: every hundredth sample lost leaves no window of 100 and none of 50 beside another
      valid = 1
      valid(100:1000:100) = 0
      options%min_coverage = 1
      options%taus = "1,49,50,100"
      call compute_allan(nbs14_long(), 1.0_dp, options, curve, failure, valid)
      call check(error, .not. allocated(failure))
      if (allocated(error)) return
      call check(error, size(curve%m), 2)
      if (allocated(error)) return
      call check(error, all(curve%m == [1, 49] .and. curve%terms == [980, 20]))
   end subroutine test_gaps_strict

   subroutine test_non_finite(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: marked, unmarked
      real(dp) :: rate(1000)
      integer(int8) :: valid(1000)

      valid = 1
      valid([5, 600, 999]) = 0
      call curve_of(error, nbs14_long(), 1.0_dp, "octave", marked, valid)
      if (allocated(error)) return
      rate = nbs14_long()
      rate(5) = ieee_value(rate(5), ieee_quiet_nan)
      rate(600) = ieee_value(rate(5), ieee_positive_inf)
      rate(999) = -rate(600)
      call curve_of(error, rate, 1.0_dp, "octave", unmarked)
      if (allocated(error)) return
      call agree(error, unmarked%deviation, marked%deviation, exact, "deviation")
   end subroutine test_non_finite

   subroutine test_nothing_missing(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: masked, plain
      integer(int8) :: valid(1000)

      valid = 1
      call curve_of(error, nbs14_long(), 1.0_dp, "all", plain)
      if (allocated(error)) return
      call curve_of(error, nbs14_long(), 1.0_dp, "all", masked, valid)
      if (allocated(error)) return
      call agree(error, masked%deviation, plain%deviation, 0.0_dp, "deviation")
   end subroutine test_nothing_missing

   subroutine test_shortest(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve

      call curve_of(error, [1.0_dp, 4.0_dp], 2.0_dp, "octave", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, [3/sqrt(2.0_dp)], exact, "deviation")
      call agree(error, [curve%tau, curve%edf], [2.0_dp, 1.0_dp], exact, "tau and edf")
   end subroutine test_shortest

   subroutine test_noise_type(error)
      type(error_type), allocatable, intent(out) :: error

      integer, parameter :: n = 20000
      type(allan_curve_type) :: curve
      real(dp) :: g(n), h(n), rate(n)

      g = normal_series(int(n, int64), 11_int64)
      h = normal_series(int(n, int64), 12_int64)
      call curve_of(error, g, 1.0_dp, "1,10,100,5000", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == 0), "white rate noise")
      if (allocated(error)) return
      rate(1) = 0
      rate(2:) = g(2:) - g(:n - 1)
      call curve_of(error, rate, 1.0_dp, "1,10,100", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == 2), "white phase noise")
      if (allocated(error)) return
      call curve_of(error, walk_of(g, h), 1.0_dp, "1,10,100,5000", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == -2), "random walk")
   end subroutine test_noise_type

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: curve
      type(allan_options) :: options
      type(gyro_error), allocatable :: failure
      integer(int8) :: valid(9)
      integer :: codes(7)

      valid = 0
      call compute_allan(nbs14_short(), 0.0_dp, options, curve, failure)
      codes(1) = failure%code
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure, valid(:3))
      codes(2) = failure%code
      options%confidence = 1
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure)
      codes(3) = failure%code
      options%confidence = 0.9_dp
      options%min_coverage = 1.1_dp
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure)
      codes(4) = failure%code
      options%min_coverage = 0.9_dp
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure, valid)
      codes(5) = failure%code
      call compute_allan([1.0_dp], 1.0_dp, options, curve, failure)
      codes(6) = failure%code
      options%kind = "adv2"
      call compute_allan(nbs14_short(), 1.0_dp, options, curve, failure)
      codes(7) = failure%code
      call check(error, all(codes(:4) == status%invalid_argument), "invalid arguments")
      call check(error, all(codes(5:6) == status%too_few_samples), "too few samples")
      call check(error, codes(7), status%not_supported, "kind")
   end subroutine test_failures

end module test_allan_deviation
