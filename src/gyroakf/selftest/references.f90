! SPDX-License-Identifier: MIT
!> Statistics of series of a thousand samples, computed in exact arithmetic from the doubles of the series and rounded once.
!>
!> The series come from integers ([[gyroakf_selftest_series]]): nearly normal white noise e_t; ar1, y_t = e_t + 0.7 y_(t-1); and
!> walk, y_t = e_t + y_(t-1).
module gyroakf_selftest_references
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use gyroakf_series_fisher, only : fisher_type, test_fisher_g
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_series_moments, only : compute_moments, moments_type
   use gyroakf_series_normality, only : jarque_bera_type, test_jarque_bera
   use gyroakf_series_stationarity, only : adf_options, adf_type, test_adf
   use gyroakf_series_whiteness, only : ljung_box_type, test_ljung_box
   use gyroakf_selftest_series, only : near_normal, recursion
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_worst, add_failure
   implicit none (type, external)
   private
   public :: check_references

   integer, parameter :: n = 1000
   !> Relative, of sums of a thousand terms. Statistics of a series that is nearly not stationary lose one digit more
   real(dp), parameter :: exact = 1.0e-12_dp, near_unit_root = 1.0e-11_dp

contains

   !> All references.
   subroutine check_references(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result
      real(dp) :: e(n), ar1(n), walk(n)

      call near_normal(e)
      call recursion(e, 0.7_dp, 0.0_dp, ar1)
      call recursion(e, 1.0_dp, 0.0_dp, walk)
      call begin_group(result, "exact values, white noise")
      call check_white(result, e)
      call begin_group(result, "exact values, AR(1)")
      call check_ar1(result, ar1)
      call begin_group(result, "exact values, random walk")
      call check_walk(result, walk)
   end subroutine check_references

   !> Moments, normality, whiteness, periodicity of white noise.
   subroutine check_white(result, x)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      type(moments_type) :: moments
      type(jarque_bera_type) :: jarque_bera
      type(ljung_box_type) :: ljung_box
      type(fisher_type) :: fisher
      type(error_type), allocatable :: error

      call compute_moments(x, moments)
      call add_near(result, "mean", -0.026799447876307864_dp, moments%mean)
      call add_near(result, "variance", 0.9463224002903896_dp, moments%variance)
      call add_near(result, "skewness", 0.06991219991707069_dp, moments%skewness)
      call add_near(result, "kurtosis", 3.0055072631266455_dp, moments%kurtosis)
      call test_jarque_bera(moments, jarque_bera, error)
      call add_or_fail(result, "Jarque-Bera", 0.8158830306718312_dp, jarque_bera%statistic, error)
      call add_or_fail(result, "Jarque-Bera, p", 0.6650177710260406_dp, jarque_bera%p_value, error)
      call test_ljung_box(x, 10, 0, ljung_box, error)
      call add_or_fail(result, "Ljung-Box, 10 lags", 14.79311288288673_dp, ljung_box%statistic, error)
      call add_or_fail(result, "Ljung-Box, 10 lags, p", 0.1397886119827444_dp, ljung_box%p_value, error)
      call test_fisher_g(x, fisher, error)
      call add_or_fail(result, "Fisher's g", 0.013809472937182887_dp, fisher%statistic, error)
      call add_or_fail(result, "Fisher's g, p", 0.39489632455981305_dp, fisher%p_value, error)
      call check_adf(result, x, "c", -13.530028194388949_dp, 6)
      call check_kpss(result, x, "c", 0.02874116848154657_dp, 7_int64)
   end subroutine check_white

   !> Models and tests of AR(1).
   subroutine check_ar1(result, x)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)

      call check_model(result, x, "yw", [0.7110825650005402_dp, -0.035155094816911835_dp], 0.9438591163364932_dp)
      call check_model(result, x, "burg", [0.7111670023214032_dp, -0.03506192739963276_dp], 0.9435131374995934_dp)
      call check_model(result, x, "ols", [0.7110045660283869_dp, -0.03505678703123156_dp], 0.9450511784482113_dp)
      call check_adf(result, x, "c", -11.23935537241675_dp, 5)
      call check_adf(result, x, "ct", -11.23486614424041_dp, 5)
      call check_kpss(result, x, "c", 0.03995536733960086_dp, 14_int64)
      call check_kpss(result, x, "ct", 0.03781483941823974_dp, 14_int64)
   end subroutine check_ar1

   !> Tests of a random walk.
   subroutine check_walk(result, x)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)

      call check_adf(result, x, "c", -1.7073900452671886_dp, 0)
      call check_adf(result, x, "ct", -3.108646539822347_dp, 0)
      call check_kpss(result, x, "c", 3.6749962525187274_dp, 19_int64)
      call check_kpss(result, x, "ct", 0.5739503971100055_dp, 19_int64)
   end subroutine check_walk

   !> An AR(2) model by one method.
   subroutine check_model(result, x, method, coefficient, variance)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      character(*), intent(in) :: method
      real(dp), intent(in) :: coefficient(2), variance
      type(ar_options) :: options
      type(ar_model_type) :: model
      type(error_type), allocatable :: error

      options%method = method
      options%order = 2
      call fit_ar(x, options, model, error)
      if (allocated(error)) then
         call add_failure(result, "AR(2) by "//method, error)
         return
      end if
      call add_worst(result, "AR(2) by "//method//", coefficients", coefficient, model%coefficient, near_unit_root)
      call add_near(result, "AR(2) by "//method//", variance", variance, model%noise_variance)
   end subroutine check_model

   !> The Dickey-Fuller test with the lag that AIC chooses.
   subroutine check_adf(result, x, regression, statistic, lag)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      character(*), intent(in) :: regression
      real(dp), intent(in) :: statistic
      integer, intent(in) :: lag
      type(adf_options) :: options
      type(adf_type) :: adf
      type(error_type), allocatable :: error

      options%regression = regression
      call test_adf(x, options, adf, error)
      if (allocated(error)) then
         call add_failure(result, "ADF, "//regression, error)
         return
      end if
      call add_check(result, "ADF, "//regression//": lag by AIC", real(lag, dp), real(adf%lag, dp), 0.0_dp)
      call add_check(result, "ADF, "//regression//": statistic", statistic, adf%statistic, near_unit_root*abs(statistic))
   end subroutine check_adf

   !> The KPSS test with the bandwidth that the series asks for.
   subroutine check_kpss(result, x, regression, statistic, lags)
      type(selftest_type), intent(inout) :: result
      real(dp), intent(in), contiguous :: x(:)
      character(*), intent(in) :: regression
      real(dp), intent(in) :: statistic
      integer(int64), intent(in) :: lags
      type(kpss_options) :: options
      type(kpss_type) :: kpss
      type(error_type), allocatable :: error

      options%regression = regression
      call test_kpss(x, options, kpss, error)
      if (allocated(error)) then
         call add_failure(result, "KPSS, "//regression, error)
         return
      end if
      call add_check(result, "KPSS, "//regression//": lags", real(lags, dp), real(kpss%lags, dp), 0.0_dp)
      call add_check(result, "KPSS, "//regression//": statistic", statistic, kpss%statistic, near_unit_root*abs(statistic))
   end subroutine check_kpss

   !> A number that is right to rounding.
   subroutine add_near(result, name, expected, got)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: name
      real(dp), intent(in) :: expected, got

      call add_check(result, name, expected, got, exact*abs(expected))
   end subroutine add_near

   !> The same where there may be none.
   subroutine add_or_fail(result, name, expected, got, error)
      type(selftest_type), intent(inout) :: result
      character(*), intent(in) :: name
      real(dp), intent(in) :: expected, got
      type(error_type), allocatable, intent(in) :: error

      if (allocated(error)) then
         call add_failure(result, name, error)
      else
         call add_near(result, name, expected, got)
      end if
   end subroutine add_or_fail

end module gyroakf_selftest_references
