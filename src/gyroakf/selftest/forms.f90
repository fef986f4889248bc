! SPDX-License-Identifier: MIT
!> Values that a formula gives, where the library takes another way to them.
module gyroakf_selftest_forms
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_fft, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward
   use gyroakf_preprocess_trend, only : trend_type, fit_trend
   use gyroakf_series_stationarity, only : adf_options, adf_type, test_adf
   use gyroakf_special, only : chi_square_quantile, digamma, normal_quantile
   use gyroakf_units, only : coefficient_unit, coefficient_unit_type, parse_unit, unit_type
   use gyroakf_selftest_types, only : selftest_type, begin_group, add_check, add_worst, add_failure
   implicit none (type, external)
   private
   public :: check_forms

   !> Rounding
   real(dp), parameter :: exact = 1.0e-12_dp
   real(dp), parameter :: pi = 3.141592653589793_dp

contains

   !> All forms.
   subroutine check_forms(result)
      !> The checks are added
      type(selftest_type), intent(inout) :: result

      call begin_group(result, "closed forms")
      call check_ramp(result)
      call check_sinusoid(result)
      call check_regression(result)
      call check_trend(result)
      call check_transform(result)
      call check_functions(result)
      call check_units(result)
   end subroutine check_forms

   !> A straight line: sigma = R tau/sqrt(2) at every averaging time; its Hadamard deviation is 0.
   subroutine check_ramp(result)
      type(selftest_type), intent(inout) :: result
      integer, parameter :: n = 5000
      real(dp), parameter :: slope = 3.0_dp, interval = 0.01_dp
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: error
      real(dp) :: rate(n)
      integer :: i

      rate = [(slope*interval*i, i=1, n)]
      call compute_allan(rate, interval, options, curve, error)
      if (allocated(error)) then
         call add_failure(result, "oadev of a ramp", error)
         return
      end if
      ! the sums of 5000 rates lose four digits
      call add_worst(result, "oadev of a ramp R tau/sqrt(2)", slope*curve%tau/sqrt(2.0_dp), curve%deviation, 1.0e-11_dp)
      options%kind = "ohdev"
      call compute_allan(rate, interval, options, curve, error)
      if (allocated(error)) then
         call add_failure(result, "ohdev of a ramp", error)
      else
         call add_check(result, "ohdev of a ramp", 0.0_dp, maxval(curve%deviation), slope*interval*n*1.0e-12_dp)
      end if
   end subroutine check_ramp

   !> A sinusoid of whole periods, all phases: $$ \sigma^2 = W^2 \frac{\sin^4 \pi f m}{m^2 \sin^2 \pi f} $$
   subroutine check_sinusoid(result)
      type(selftest_type), intent(inout) :: result
      ! the terms of m = 5 are n - 2 m + 1, whole periods of 32 samples
      integer, parameter :: n = 32*100 + 9, m = 5
      real(dp), parameter :: amplitude = 2.0_dp, f = 1.0_dp/32.0_dp
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(error_type), allocatable :: error
      real(dp) :: rate(n)
      integer :: i

      rate = [(amplitude*sin(2.0_dp*pi*real(mod(i, 32), dp)*f), i=1, n)]
      options%taus = "5"
      call compute_allan(rate, 1.0_dp, options, curve, error)
      if (allocated(error)) then
         call add_failure(result, "oadev of a sinusoid", error)
      else
         call add_worst(result, "oadev of a sinusoid", [amplitude*sin(pi*f*m)**2/(m*sin(pi*f))], curve%deviation, exact)
      end if
   end subroutine check_sinusoid

   !> Dickey-Fuller regressions of twenty small integers, worked out in fractions: rho is -7/5 without, -131/89 with a constant.
   subroutine check_regression(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: x(20) = real([1, -1, 2, 0, 1, -2, 1, 0, 2, -1, 1, 1, -2, 0, 1, 2, -1, 0, 1, -1], dp)
      character(1), parameter :: terms(2) = ["n", "c"]
      real(dp), parameter :: level(2) = [-7.0_dp/5.0_dp, -131.0_dp/89.0_dp]
      real(dp), parameter :: tau(2) = [-6.48074069840786023_dp, -6.72345482553983114_dp]
      type(adf_options) :: options
      type(adf_type) :: adf
      type(error_type), allocatable :: error
      integer :: i

      options%lags = 0
      do i = 1, 2
         options%regression = terms(i)
         call test_adf(x, options, adf, error)
         if (allocated(error)) then
            call add_failure(result, "ADF by hand, "//terms(i), error)
         else
            call add_check(result, "ADF by hand, "//terms(i)//": rho", level(i), adf%level, exact)
            call add_check(result, "ADF by hand, "//terms(i)//": tau", tau(i), adf%statistic, 10*exact)
         end if
      end do
   end subroutine check_regression

   !> A cubic comes back with its coefficients.
   subroutine check_trend(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: power(0:3) = [2.0_dp, -3.0e-2_dp, 5.0e-5_dp, -7.0e-8_dp]
      type(trend_type) :: trend
      type(error_type), allocatable :: error
      real(dp) :: x(1000), t
      integer :: i

      do i = 1, size(x)
         t = real(i - 1, dp)
         x(i) = power(0) + t*(power(1) + t*(power(2) + t*power(3)))
      end do
      call fit_trend(x, 3, trend, error)
      if (allocated(error)) then
         call add_failure(result, "coefficients of a cubic", error)
      else
         ! the conversion to powers of the index loses two or three digits
         call add_worst(result, "coefficients of a cubic", power, trend%power, 1.0e-10_dp)
      end if
   end subroutine check_trend

   !> The Fourier transform of a cosine of k periods is n/2 at k and 0 elsewhere; a prime number of samples.
   subroutine check_transform(result)
      type(selftest_type), intent(inout) :: result
      integer, parameter :: n = 1009, k = 7
      type(real_fft_plan_type) :: plan
      type(error_type), allocatable :: error
      real(dp) :: x(n)
      complex(dp) :: spectrum((n + 1)/2)
      integer :: i

      x = [(cos(2.0_dp*pi*real(mod(k*i, n), dp)/n), i=0, n - 1)]
      call new_real_fft_plan(plan, int(n, int64), error)
      if (.not. allocated(error)) call real_fft_forward(plan, x, spectrum, error)
      if (allocated(error)) then
         call add_failure(result, "Fourier transform of a cosine", error)
         return
      end if
      call add_check(result, "Fourier transform, its line", 0.5_dp*n, real(spectrum(k + 1)), exact*n)
      spectrum(k + 1) = 0.0_dp
      call add_check(result, "Fourier transform, the rest", 0.0_dp, maxval(abs(spectrum)), 1.0e-10_dp)
   end subroutine check_transform

   !> Constants that tables have.
   subroutine check_functions(result)
      type(selftest_type), intent(inout) :: result
      real(dp), parameter :: euler_gamma = 0.57721566490153286_dp

      call add_check(result, "normal quantile of 0.975", 1.95996398454005423_dp, normal_quantile(0.975_dp), exact)
      call add_check(result, "chi-square quantile, 2, 0.95", -2.0_dp*log(0.05_dp), chi_square_quantile(0.95_dp, 2.0_dp), exact)
      call add_check(result, "chi-square quantile, 10, 0.95", 18.3070380532751457_dp, chi_square_quantile(0.95_dp, 10.0_dp), &
                     20*exact)
      call add_check(result, "digamma of 1/2", -euler_gamma - 2.0_dp*log(2.0_dp), digamma(0.5_dp), exact)
   end subroutine check_functions

   !> N of 1 deg/s/sqrt(Hz) is 60 deg/sqrt(h); B of 1 rad/s is 648000/pi deg/h.
   subroutine check_units(result)
      type(selftest_type), intent(inout) :: result
      type(unit_type) :: unit
      type(coefficient_unit_type) :: stated
      type(error_type), allocatable :: error

      call parse_unit("deg/s", unit, error)
      if (.not. allocated(error)) then
         stated = coefficient_unit(unit, 2, .false.)
         call add_check(result, "deg/s/sqrt(Hz) in deg/sqrt(h)", 60.0_dp, unit%to_si*stated%from_si, 60*exact)
         call parse_unit("rad/s", unit, error)
      end if
      if (.not. allocated(error)) then
         stated = coefficient_unit(unit, 3, .false.)
         call add_check(result, "rad/s in deg/h", 648000.0_dp/pi, unit%to_si*stated%from_si, 648000.0_dp/pi*exact)
         return
      end if
      call add_failure(result, "units", error)
   end subroutine check_units

end module gyroakf_selftest_forms
