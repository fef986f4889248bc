! SPDX-License-Identifier: MIT
!> Tests of autocorrelation and partial autocorrelation at many lags, and of the tests of whiteness at every lag.
module test_correlation
   use expectations, only : problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation, correlation_of
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   use series_library, only : reference_series
   implicit none (type, external)
   private
   public :: suite_correlation

   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_correlation()
      call test("by_hand", test_by_hand)
      call test("every_lag", test_every_lag)
      call test("partial", test_partial)
      call test("limits", test_limits)
      call test("all_lags", test_all_lags)
      call test("offset_scale", test_offset_scale)
      call test("missing", test_missing)
      call test("failures", test_failures)
   end subroutine suite_correlation

   !> 1 2 3 4: rho = 1/4, -3/10; pacf_2 = (-3/10 - 1/16)/(1 - 1/16).
   subroutine test_by_hand()
      type(correlation_type) :: c

      call compute_correlation([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], 2, 0, c, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(c%acf - [1.0_dp, 0.25_dp, -0.3_dp])) < tolerance, "acf")
      call check(error, maxval(abs(c%pacf - [1.0_dp, 0.25_dp, -0.3625_dp/0.9375_dp])) < tolerance, "pacf")
      call check(error, c%ljung_box(2), 24.0_dp*(1.0_dp/48.0_dp + 0.045_dp), thr=tolerance)
      call check(error, c%largest_lag == 2 .and. abs(c%largest_rho - 0.3_dp) < tolerance, "largest")
      call check(error, c%mean, 2.5_dp, thr=tolerance)
   end subroutine test_by_hand

   !> The statistic at every lag is that of a test with so many lags; fitted parameters take degrees of freedom.
   subroutine test_every_lag()
      type(correlation_type) :: c
      type(ljung_box_type) :: lb
      real(dp), allocatable :: x(:)
      integer :: k

      x = reference_series("sine", 1000)
      call compute_correlation(x, 30, 2, c, problem)
      do k = 3, 30
         call test_ljung_box(x, k, 2, lb, problem)
         call check(error, c%ljung_box(k), lb%statistic, thr=tolerance, rel=.true.)
         call check(error, c%ljung_box_p(k), lb%p_value, thr=1.0e-11_dp, rel=.true.)
      end do
      call check(error, all(c%ljung_box_p(:2) >= 1.0_dp), "no degree of freedom")
      call check(error, lb%largest_lag == c%largest_lag .and. abs(c%acf(c%largest_lag)) >= maxval(abs(c%acf(1:))), "largest")
   end subroutine test_every_lag

   !> The last coefficient of every model; of an AR(2) process nothing is left from lag 3 on.
   subroutine test_partial()
      type(correlation_type) :: c
      real(dp), allocatable :: x(:), r(:), phi(:, :), variance(:)
      real(dp) :: mean
      integer :: k

      x = reference_series("ar2", 12000)
      call compute_correlation(x, 40, 0, c, problem)
      call compute_autocovariance(x, 40, mean, r, problem)
      call solve_levinson(r, phi, variance, problem)
      do k = 1, 40
         call check(error, c%pacf(k), phi(k, k), thr=tolerance)
      end do
      call check(error, c%pacf(2), -0.48181643820724285_dp, thr=tolerance)
      call check(error, maxval(abs(c%pacf(3:))) < 0.04_dp .and. c%partial_lags == 40, "beyond the order")
      call correlation_of([1.0_dp, 1.0_dp, 1.0_dp], 1000_int64, 0, c, problem)
      call check(error, c%partial_lags == 0 .and. all(abs(c%pacf(1:)) <= 0.0_dp), "perfectly predicted")
   end subroutine test_partial

   !> White noise stays within its limits at 95 % of the lags, a random walk does not; Bartlett's are wider.
   subroutine test_limits()
      type(correlation_type) :: c
      integer :: outside

      call compute_correlation(reference_series("wn", 12000), 399, 0, c, problem)
      call check(error, c%limit(7), 1.9599639845400542_dp/sqrt(12000.0_dp), thr=tolerance, rel=.true.)
      outside = count(abs(c%acf(1:)) > c%limit(1:))
      call check(error, outside >= 8 .and. outside <= 36, "5 % of 399 lags are outside")
      call compute_correlation(reference_series("ar1", 12000), 60, 0, c, problem)
      call check(error, c%bartlett(3), c%limit(3)*sqrt(1.0_dp + 2.0_dp*(c%acf(1)**2 + c%acf(2)**2)), thr=tolerance, rel=.true.)
      call check(error, c%bartlett(1), c%limit(1), thr=tolerance, rel=.true.)
   end subroutine test_limits

   !> As many lags as samples: the autocorrelations of a centred series sum up to -1/2.
   subroutine test_all_lags()
      type(correlation_type) :: c

      call compute_correlation(reference_series("ar1", 3000), 2999, 0, c, problem)
      if (went_wrong(problem)) return
      call check(error, sum(c%acf(1:)), -0.5_dp, thr=1.0e-11_dp)
      call check(error, c%partial_lags == 2999 .and. maxval(abs(c%pacf)) <= 1.0_dp, "pacf")
   end subroutine test_all_lags

   !> An offset of 2^30 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024; few lags and many.
   subroutine test_offset_scale()
      type(correlation_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: lags

      x = anint(1024.0_dp*reference_series("ar1", 5000))/1024.0_dp
      do lags = 20, 320, 300
         call compute_correlation(x, lags, 0, a, problem)
         call compute_correlation(2.0_dp**(-50)*(x + 2.0_dp**30), lags, 0, b, problem)
         call check(error, maxval(abs(a%acf - b%acf)) < tolerance .and. maxval(abs(a%pacf - b%pacf)) < tolerance, "correlation")
         call check(error, b%ljung_box(lags), a%ljung_box(lags), thr=tolerance, rel=.true.)
      end do
   end subroutine test_offset_scale

   !> Gaps: rho over present pairs; a mask of ones changes nothing.
   subroutine test_missing()
      type(correlation_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar1", 12000)
      allocate (valid(size(x)))
      valid = 1_int8
      call compute_correlation(x, 20, 0, a, problem)
      call compute_correlation(x, 20, 0, b, problem, valid)
      call check(error, b%ljung_box(20), a%ljung_box(20), thr=tolerance, rel=.true.)
      call check(error, b%limit(20), a%limit(20), thr=tolerance, rel=.true.)
      do i = 1, size(x), 3
         valid(i) = 0_int8
         x(i) = -1.0e9_dp
      end do
      call compute_correlation(x, 20, 0, b, problem, valid)
      call check(error, b%observations == 8000 .and. b%pairs(3) == 7998 .and. b%pairs(1) == 4000, "pairs")
      call check(error, maxval(abs(a%acf - b%acf)) < 0.05_dp, "they estimate the same")
      call check(error, b%limit(1), 1.9599639845400542_dp*sqrt(11999.0_dp/12000.0_dp/4000.0_dp), thr=tolerance, rel=.true.)
   end subroutine test_missing

   !> What has no correlation.
   subroutine test_failures()
      real(dp) :: x(1000)

      x = 3.7_dp
      call expect(x, 5, 0, status%constant_input)
      x(::2) = 4.0_dp
      call expect(x, 1000, 0, status%too_few_samples)
      call expect(x(:5), 5, 0, status%too_few_samples)
      call expect(x, 0, 0, status%invalid_argument)
      call expect(x, -1, 0, status%invalid_argument)
      call expect(x, 3, 3, status%invalid_argument)
   end subroutine test_failures

   !> The call fails with this code.
   subroutine expect(x, lags, fitted, code)
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: lags, fitted, code
      type(correlation_type) :: c

      call compute_correlation(x, lags, fitted, c, problem)
      call check_refused(problem, code)
   end subroutine expect

end module test_correlation
