! SPDX-License-Identifier: MIT
!> Tests of the overlapping Allan deviation alone; what it shares with the other statistics is in allan_statistics.
!>
!> NBS14: NIST SP 1065, section 12.4; the values with 16 digits were computed from the same series in rational arithmetic.
module test_allan_deviation
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan, ieee_positive_inf
   use, intrinsic :: iso_fortran_env, only : qp => real128
   use expectations, only : unmet, failure => problem, test, error, check, agree, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use allan_series, only : no_curve, nbs14_long, nbs14_short, normal_series, walk_of
   implicit none (type, external)
   private
   public :: suite_allan_deviation

   !> Sixteen digits of reference, rounding of a thousand additions
   real(dp), parameter :: exact = 1.0e-12_dp

contains

   subroutine suite_allan_deviation()
      call test("nbs14_factors", test_nbs14_factors)
      call test("constant", test_constant)
      call test("discrete_forms", test_discrete_forms)
      call test("rounding", test_rounding)
      call test("scale", test_scale)
      call test("direct_sum", test_direct_sum)
      call test("quadruple", test_quadruple)
      call test("octave_pairs", test_octave_pairs)
      call test("gaps_quantized", test_gaps_quantized)
      call test("gaps_ramp", test_gaps_ramp)
      call test("gaps_strict", test_gaps_strict)
      call test("non_finite", test_non_finite)
      call test("nothing_missing", test_nothing_missing)
      call test("shortest", test_shortest)
      call test("noise_type", test_noise_type)
      call test("failures", test_failures)
   end subroutine suite_allan_deviation

   subroutine test_nbs14_factors()
      real(dp), parameter :: expected(12) = [0.2010160421709385_dp, 0.1447913072184378_dp, 0.1057038500787000_dp, &
         & 0.06191477841874487_dp, 0.04808214262128163_dp, 0.03623721298570472_dp, 0.02767385582069448_dp, &
         & 0.01028221763903273_dp, 0.008244123626136666_dp, 0.002832505364418703_dp, 0.002158165703661819_dp, 0.0_dp]
      type(allan_curve_type) :: curve

      if (no_curve("oadev", nbs14_long(), "2,4,8,16,32,64,128,256,333,499,500", curve)) return
      call agree(curve%deviation, expected(:11), exact, "deviation")
      call check(error, all(curve%terms == 1001 - 2*curve%m))
   end subroutine test_nbs14_factors

   subroutine test_constant()
      type(allan_curve_type) :: curve
      real(dp) :: rate(1000)

      rate = 0.1_dp
      if (no_curve("oadev", rate, "octave", curve)) return
      call check(error, all(curve%deviation <= 1.0e-15_dp), "a constant has no deviation")
      call check(error, all(curve%lower <= curve%deviation .and. curve%deviation <= curve%upper))
   end subroutine test_constant

   subroutine test_discrete_forms()
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
            if (no_curve("oadev", series(:, kind), "1,2,5,10,50", curve)) return
            found(:, kind) = found(:, kind) + curve%deviation**2/runs
         end do
      end do
      ! at m = 50 the average has 10 x 20000/50 = 4000 degrees of freedom: 5 % is two and a half standard errors
      call agree(reshape(found, [4*factors]), reshape(expected, [4*factors]), 0.06_dp, "mean variance")
   end subroutine test_discrete_forms

   subroutine test_rounding()
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
      if (no_curve("oadev", rate, "1,3,10,30,100", curve)) return
      call agree(curve%deviation(3:4), sqrt(3.0_dp)*step/sqrt(12.0_dp)/curve%tau(3:4), 0.35_dp, "deviation")
   end subroutine test_rounding

   subroutine test_scale()
      type(allan_curve_type) :: plain, scaled

      if (no_curve("oadev", nbs14_long(), "log:8", plain)) return
      if (no_curve("oadev", -1.0e-9_dp*nbs14_long() + 3, "log:8", scaled, interval=0.5_dp)) return
      call agree(scaled%deviation*1.0e9_dp, plain%deviation, 1.0e-5_dp, "deviation")
      call agree(scaled%tau, 0.5_dp*plain%tau, exact, "tau")
      call agree(scaled%edf, plain%edf, exact, "edf")
   end subroutine test_scale

   subroutine test_direct_sum()
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
         if (no_curve("oadev", rate, "3", curve)) return
         expected = 0
         do k = 1, n - 2*m + 1
            expected = expected + (sum(rate(k + m:k + 2*m - 1)) - sum(rate(k:k + m - 1)))**2
         end do
         expected = sqrt(expected/(2.0_dp*m**2*(n - 2*m + 1)))
         call agree(curve%deviation, [expected], exact, "deviation")
      end do
   end subroutine test_direct_sum

   subroutine test_octave_pairs()
      ! octaves are summed two at a time, other factors one at a time
      type(allan_curve_type) :: octaves, odd, even
      real(dp) :: rate(9999)

      rate = normal_series(9999_int64, 404_int64)
      if (no_curve("oadev", rate, "1,2,4,8,16,2048,4096", octaves)) return
      if (no_curve("oadev", rate, "1,4,16,4096", odd)) return
      if (no_curve("oadev", rate, "2,8,2048", even)) return
      call agree(octaves%deviation([1, 3, 5, 7]), odd%deviation, 1.0e-14_dp, "deviation")
      call agree(octaves%deviation([2, 4, 6]), even%deviation, 1.0e-14_dp, "deviation")
   end subroutine test_octave_pairs

   subroutine test_quadruple()
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
      if (no_curve("oadev", rate, taus, curve)) return
      call check(error, all(curve%m == m), "factors")
      do i = 1, size(m)
         if (allocated(error)) return
         associate (x => phase, last => n + 1 - 2*m(i))
            expected = sum((x(1 + 2*m(i):) - 2*x(1 + m(i):last + m(i)) + x(:last))**2)/real(last, dp)
         end associate
         call agree(curve%deviation(i:i), [sqrt(expected/2)/m(i)], exact, "deviation")
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

   !> Marks a share of the samples as missing, at random, and spoils their values.
   subroutine lose(rate, share, seed, valid)
      real(dp), intent(inout) :: rate(:)
      real(dp), intent(in) :: share
      integer, intent(in) :: seed
      integer(int8), intent(out) :: valid(:)

      valid = merge(0_int8, 1_int8, abs(normal_series(size(rate, kind=int64), int(seed, int64))) < share*1.2533_dp)
      where (valid == 0) rate = 1.0e6_dp
   end subroutine lose

   subroutine test_gaps_quantized()
      ! 0.3 % of the samples lost from differenced white noise: at m = 100 the lost samples double the variance
      integer, parameter :: n = 200000
      type(allan_curve_type) :: curve, whole
      real(dp) :: rate(n), g(n)
      integer(int8) :: valid(n)

      g = normal_series(int(n, int64), 5151_int64)
      rate(1) = 0
      rate(2:) = g(2:) - g(:n - 1)
      if (no_curve("oadev", rate, "1,10,50,100", whole)) return
      call lose(rate, 0.003_dp, 77, valid)
      if (no_curve("oadev", rate, "1,10,50,100", curve, valid)) return
      call agree(curve%deviation, whole%deviation, 0.08_dp, "deviation with and without gaps")
   end subroutine test_gaps_quantized

   subroutine test_gaps_ramp()
      ! a deterministic drift is hardly touched by lost samples or their correction
      integer, parameter :: n = 20000
      type(allan_curve_type) :: curve
      real(dp) :: rate(n)
      integer(int8) :: valid(n)
      integer :: i

      rate = [(real(i, dp), i=1, n)]
      call lose(rate, 0.05_dp, 5, valid)
      if (no_curve("oadev", rate, "100,1000,5000", curve, valid)) return
      call agree(curve%deviation, curve%tau/sqrt(2.0_dp), 0.002_dp, "deviation")
   end subroutine test_gaps_ramp

   subroutine test_gaps_strict()
      type(allan_curve_type) :: curve
      type(allan_options) :: options
      integer(int8) :: valid(1000)

      ! complete windows only: every hundredth sample lost leaves no window of 100 and none of 50 beside another
      valid = 1
      valid(100:1000:100) = 0
      options%min_coverage = 1
      options%taus = "1,49,50,100"
      call compute_allan(nbs14_long(), 1.0_dp, options, curve, failure, valid)
      if (went_wrong(failure)) return
      if (unmet(size(curve%m), 2)) return
      call check(error, all(curve%m == [1, 49] .and. curve%terms == [980, 20]))
   end subroutine test_gaps_strict

   subroutine test_non_finite()
      type(allan_curve_type) :: marked, unmarked
      real(dp) :: rate(1000)
      integer(int8) :: valid(1000)

      valid = 1
      valid([5, 600, 999]) = 0
      if (no_curve("oadev", nbs14_long(), "octave", marked, valid)) return
      rate = nbs14_long()
      rate(5) = ieee_value(rate(5), ieee_quiet_nan)
      rate(600) = ieee_value(rate(5), ieee_positive_inf)
      rate(999) = -rate(600)
      if (no_curve("oadev", rate, "octave", unmarked)) return
      call agree(unmarked%deviation, marked%deviation, exact, "deviation")
   end subroutine test_non_finite

   subroutine test_nothing_missing()
      type(allan_curve_type) :: masked, plain
      integer(int8) :: valid(1000)

      valid = 1
      if (no_curve("oadev", nbs14_long(), "all", plain)) return
      if (no_curve("oadev", nbs14_long(), "all", masked, valid)) return
      call agree(masked%deviation, plain%deviation, 0.0_dp, "deviation")
   end subroutine test_nothing_missing

   subroutine test_shortest()
      type(allan_curve_type) :: curve

      if (no_curve("oadev", [1.0_dp, 4.0_dp], "octave", curve, interval=2.0_dp)) return
      call agree(curve%deviation, [3/sqrt(2.0_dp)], exact, "deviation")
      call agree([curve%tau, curve%edf], [2.0_dp, 1.0_dp], exact, "tau and edf")
   end subroutine test_shortest

   subroutine test_noise_type()
      integer, parameter :: n = 20000
      type(allan_curve_type) :: curve
      real(dp) :: g(n), h(n), rate(n)

      g = normal_series(int(n, int64), 11_int64)
      h = normal_series(int(n, int64), 12_int64)
      if (no_curve("oadev", g, "1,10,100,5000", curve)) return
      call check(error, all(curve%alpha == 0), "white rate noise")
      rate(1) = 0
      rate(2:) = g(2:) - g(:n - 1)
      if (no_curve("oadev", rate, "1,10,100", curve)) return
      call check(error, all(curve%alpha == 2), "white phase noise")
      if (no_curve("oadev", walk_of(g, h), "1,10,100,5000", curve)) return
      call check(error, all(curve%alpha == -2), "random walk")
   end subroutine test_noise_type

   subroutine test_failures()
      type(allan_curve_type) :: curve
      type(allan_options) :: options
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
