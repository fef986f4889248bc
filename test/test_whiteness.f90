! SPDX-License-Identifier: MIT
!> Tests of the Ljung-Box test, and of autocorrelation and partial autocorrelation at many lags. The
!> statistics were computed in exact arithmetic from the doubles of the series (series_library, 1000
!> samples each) and rounded once.
module test_whiteness
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box, ljung_box_of
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation, correlation_of
   implicit none (type, external)
   private
   public :: suite_whiteness, suite_correlation

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> 1, 10 and 20 lags in the order of reference_names
   integer, parameter :: lags_of(3) = [1, 10, 20]
   real(dp), parameter :: statistic_of(3,11) = reshape([ &
      & 0.1394540120215431_dp, 14.79311288288673_dp, 25.35254198479461_dp, 0.42207698720593434_dp, &
      & 11.494483108101397_dp, 13.791433499381332_dp, 0.7127903200187425_dp, 10.01074383529652_dp, &
      & 21.34074490375695_dp, 985.3565119371316_dp, 9185.55233308164_dp, 17169.2404783144_dp, 473.2944872544328_dp, &
      & 797.130895252274_dp, 812.8440726338339_dp, 944.7762308581127_dp, 7307.461495611169_dp, &
      & 11600.802622627683_dp, 642.2594066669759_dp, 1074.3896230553232_dp, 1105.262463164637_dp, &
      & 71.35331231527326_dp, 585.5846825571614_dp, 1185.342613102351_dp, 495.49729282487345_dp, &
      & 887.5344894280644_dp, 899.1371737352689_dp, 473.29448725834925_dp, 797.1308952355012_dp, &
      & 812.8440726147462_dp, 2.2543422119164505_dp, 26.84206946831816_dp, 39.585056126243416_dp], [3, 11])
   !> p-values with 20 lags, exp(-Q/2) times the sum of ten terms, 40 digits
   real(dp), parameter :: p_value_of(11) = [ &
      & 0.18827502643423524_dp, 0.8409112919907766_dp, 0.3773262476364291_dp, 0.0_dp, 2.6539038312741094e-159_dp, &
      & 0.0_dp, 1.3322300934205683e-221_dp, 1.0193379456230724e-238_dp, 1.1995171418806822e-177_dp, &
      & 2.653903856043061e-159_dp, 0.005634438034208173_dp]

contains

   subroutine suite_whiteness()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("offset_scale", test_offset_scale)
      call test("missing", test_missing)
      call test("fitted", test_fitted)
      call test("failures", test_failures)
   end subroutine suite_whiteness

   subroutine suite_correlation()
      call test("by_hand", test_by_hand_correlation)
      call test("every_lag", test_every_lag)
      call test("partial", test_partial)
      call test("limits", test_limits)
      call test("all_lags", test_all_lags)
      call test("offset_scale", test_offset_scale_correlation)
      call test("missing", test_missing_correlation)
      call test("failures", test_failures_correlation)
   end subroutine suite_correlation

   !> 1 2 3 4: rho = 1/4, -3/10; Q = 4 6 (1/48 + 9/200).
   subroutine test_by_hand()
      type(ljung_box_type) :: lb

      call test_ljung_box([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], 2, 0, lb, problem)
      if (went_wrong(problem)) return
      call check(error, lb%statistic, 24.0_dp*(1.0_dp/48.0_dp + 0.045_dp), thr=tolerance)
      call check(error, lb%p_value, exp(-12.0_dp*(1.0_dp/48.0_dp + 0.045_dp)), thr=tolerance)
      call check(error, lb%largest_rho, 0.3_dp, thr=tolerance)
      call check(error, lb%lags, 2)
   end subroutine test_by_hand

   !> The eleven series; a p-value moves by Q/2 times the rounding of Q.
   subroutine test_reference()
      type(ljung_box_type) :: lb
      integer :: i, j

      do i = 1, size(reference_names)
         do j = 1, size(lags_of)
            call test_ljung_box(reference_series(trim(reference_names(i)), 1000), lags_of(j), 0, lb, problem)
            if (went_wrong(problem)) return
            call check(error, lb%statistic, statistic_of(j, i), reference_names(i), thr=tolerance, rel=.true.)
         end do
         call check(error, abs(lb%p_value - p_value_of(i)) <= tolerance*max(1.0_dp, lb%statistic)*p_value_of(i), &
            & "p-value of "//reference_names(i))
      end do
   end subroutine test_reference

   !> An offset of 2^40 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024.
   subroutine test_offset_scale()
      type(ljung_box_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("wn", 9000))/1024.0_dp
      call test_ljung_box(x, 15, 0, a, problem)
      call test_ljung_box((x + 2.0_dp**40)*2.0_dp**(-50), 15, 0, b, problem)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, b%largest_rho, a%largest_rho, thr=tolerance, rel=.true.)
   end subroutine test_offset_scale

   !> An all-present mask changes nothing; white noise with 5 % and 40 % lost stays white, and AR(1)
   !> noise does not become it.
   subroutine test_missing()
      type(ljung_box_type) :: a, b
      real(dp), allocatable :: x(:), u(:)
      integer(int8), allocatable :: valid(:)

      x = reference_series("wn_bm", 5000)
      u = reference_series("unif", 5000)
      allocate (valid(size(x)), source=1_int8)
      call test_ljung_box(x, 20, 0, a, problem)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      valid = merge(0_int8, 1_int8, cshift(u, 2500) < 0.05_dp)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%p_value > 0.001_dp, "5 % lost: white noise was rejected")
      valid = merge(0_int8, 1_int8, cshift(u, 2500) < 0.4_dp)
      call test_ljung_box(x, 20, 0, b, problem, valid)
      call check(error, b%p_value > 0.001_dp .and. b%statistic > 5.0_dp, "40 % lost: not chi-square with 20 degrees")
      call test_ljung_box(reference_series("ar1", 5000), 20, 0, b, problem, valid)
      call check(error, b%p_value < 1.0e-10_dp, "40 % lost: AR(1) was accepted")
   end subroutine test_missing

   !> Fitted parameters cost degrees of freedom: with 4 lags and 2 parameters p = exp(-Q/2).
   subroutine test_fitted()
      type(ljung_box_type) :: lb
      real(dp), allocatable :: r(:)
      real(dp) :: mean
      integer :: k

      call compute_autocovariance(reference_series("wn", 1000), 4, mean, r, problem)
      call ljung_box_of(r, 1000_int64, 2, lb, problem, [(int(1000 - k, int64), k=0, 4)])
      call check(error, lb%p_value, exp(-0.5_dp*lb%statistic), thr=tolerance)
      call check(error, lb%fitted, 2)
   end subroutine test_fitted

   !> Each error.
   subroutine test_failures()
      type(ljung_box_type) :: lb
      real(dp) :: x(5)

      x = 0.1_dp
      call test_ljung_box(x, 3, 3, lb, problem)
      call check_refused(problem, status%invalid_argument)
      call test_ljung_box(x, 5, 0, lb, problem)
      call check_refused(problem, status%too_few_samples)
      call test_ljung_box(x, 2, 0, lb, problem)
      call check_refused(problem, status%constant_input)
   end subroutine test_failures

   !> 1 2 3 4: rho = 1/4, -3/10; pacf_2 = (-3/10 - 1/16)/(1 - 1/16).
   subroutine test_by_hand_correlation()
      type(correlation_type) :: c

      call compute_correlation([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], 2, 0, c, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(c%acf - [1.0_dp, 0.25_dp, -0.3_dp])) < tolerance, "acf")
      call check(error, maxval(abs(c%pacf - [1.0_dp, 0.25_dp, -0.3625_dp/0.9375_dp])) < tolerance, "pacf")
      call check(error, c%ljung_box(2), 24.0_dp*(1.0_dp/48.0_dp + 0.045_dp), thr=tolerance)
      call check(error, c%largest_lag == 2 .and. abs(c%largest_rho - 0.3_dp) < tolerance, "largest")
      call check(error, c%mean, 2.5_dp, thr=tolerance)
   end subroutine test_by_hand_correlation

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
      call correlation_of([1.0_dp, 1.0_dp, 1.0_dp], 1000_int64, 0, c, problem, [1000_int64, 999_int64, 998_int64])
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

   !> As many lags as samples: the autocorrelations of a centered series sum up to -1/2.
   subroutine test_all_lags()
      type(correlation_type) :: c

      call compute_correlation(reference_series("ar1", 3000), 2999, 0, c, problem)
      if (went_wrong(problem)) return
      call check(error, sum(c%acf(1:)), -0.5_dp, thr=1.0e-11_dp)
      call check(error, c%partial_lags == 2999 .and. maxval(abs(c%pacf)) <= 1.0_dp, "pacf")
   end subroutine test_all_lags

   !> An offset of 2^30 and a scale of 2^-50 lose nothing, as the values are multiples of 1/1024; few lags and many.
   subroutine test_offset_scale_correlation()
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
   end subroutine test_offset_scale_correlation

   !> Gaps: rho over present pairs; a mask of ones changes nothing.
   subroutine test_missing_correlation()
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
   end subroutine test_missing_correlation

   !> What has no correlation.
   subroutine test_failures_correlation()
      real(dp) :: x(1000)

      x = 3.7_dp
      call expect(x, 5, 0, status%constant_input)
      x(::2) = 4.0_dp
      call expect(x, 1000, 0, status%too_few_samples)
      call expect(x(:5), 5, 0, status%too_few_samples)
      call expect(x, 0, 0, status%invalid_argument)
      call expect(x, -1, 0, status%invalid_argument)
      call expect(x, 3, 3, status%invalid_argument)
   end subroutine test_failures_correlation

   !> The call fails with this code.
   subroutine expect(x, lags, fitted, code)
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: lags, fitted, code
      type(correlation_type) :: c

      call compute_correlation(x, lags, fitted, c, problem)
      call check_refused(problem, code)
   end subroutine expect

end module test_whiteness
