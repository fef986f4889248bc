! SPDX-License-Identifier: MIT
!> Tests of the comparison of a record's halves.
module test_allan_halves
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_special, only : chi_square_survival, digamma, trigamma
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_halves, only : compare_halves, halves_options, halves_type
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use allan_series, only : normal_series, walk_of
   use expectations, only : unmet, failed => problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_allan_halves

contains

   subroutine suite_allan_halves()
      call test("single_tau", test_single_tau)
      call test("gain", test_gain)
      call test("curves_of_the_halves", test_curves)
      call test("reversal", test_reversal)
      call test("units", test_units)
      call test("uniform_p_values", test_uniform)
      call test("scattered_losses", test_scattered)
      call test("outliers", test_outliers)
      call test("gaps", test_gaps)
      call test("unequal_halves", test_unequal)
      call test("failures", test_failures)
   end subroutine suite_allan_halves

   !> White noise with N = n per sample.
   subroutine white_model(n, noise)
      real(dp), intent(in) :: n
      type(noise_type), intent(out) :: noise

      noise%squares(2) = n**2
   end subroutine white_model

   !> At a single averaging time the statistic is the square of the
   !> logarithm of the ratio of the variances over 2 trigamma(nu/2). For a half of 500 white samples, by the sum of its lags,
   !> R(0) = 2, R(1) = -1 for z = w2 - w1 (sum over 499 terms), so nu = (499*2)^2/(499*4 + 2*498*1);
   !> excess kurtosis adds to 2/nu.
   subroutine test_single_tau()
      type(noise_type) :: noise
      type(halves_options) :: options
      type(halves_type) :: halves
      real(dp) :: x(1000), change, nu, z1(499), z2(499), kurtosis

      call white_model(1.0_dp, noise)
      x = normal_series(1000_int64, 11_int64)
      x(501:) = 1.1_dp*x(501:)
      options%taus = "1"
      call compare_halves(x, 1.0_dp, noise, options, halves, failed)
      if (unmet(.not. allocated(failed) .and. halves%freedom == 1 .and. size(halves%tau) == 1)) return
      change = log(sum((x(502:) - x(501:999))**2)/sum((x(2:500) - x(1:499))**2))
      nu = 499.0_dp**2*4/(499*4 + 2*498*1)
      call check(error, halves%ratio(1), exp(change/2), thr=1e-12_dp)
      z1 = x(2:500) - x(1:499)
      z2 = x(502:) - x(501:999)
      kurtosis = excess(z1) + excess(z2)
      call check(error, halves%statistic, change**2/(2*trigamma(1/(2/nu + kurtosis/500))), thr=1e-8_dp)
      call check(error, halves%p_value, chi_square_survival(halves%statistic, 1.0_dp), thr=1e-14_dp)
   end subroutine test_single_tau

   !> Excess kurtosis of a few numbers.
   pure real(dp) function excess(z)
      real(dp), intent(in) :: z(:)
      real(dp) :: d(size(z))

      d = z - sum(z)/size(z)
      excess = size(z)*sum(d**4)/sum(d**2)**2 - 3
   end function excess

   !> The second half is the first times 1.25: that is the ratio at every averaging time, and it is far beyond chance.
   subroutine test_gain()
      type(noise_type) :: noise
      type(halves_type) :: halves
      real(dp) :: x(8192)

      call white_model(1.0_dp, noise)
      x(:4096) = normal_series(4096_int64, 3_int64)
      x(4097:) = 1.25_dp*x(:4096) + 1e3_dp
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      if (went_wrong(failed)) return
      call check(error, maxval(abs(halves%ratio - 1.25_dp)), 0.0_dp, thr=1e-10_dp)
      call check(error, halves%changed .and. halves%p_value < 1e-10_dp .and. halves%lower(1) > 1.15_dp)
   end subroutine test_gain

   !> The ratios are those of the curves of the halves by themselves; an odd sample in the middle belongs to none.
   subroutine test_curves()
      type(noise_type) :: noise
      type(halves_type) :: halves
      type(allan_curve_type) :: first, second
      real(dp) :: x(4001)
      integer :: k

      call white_model(1.0_dp, noise)
      x = normal_series(4001_int64, 21_int64) &
         & + 0.05_dp*walk_of(normal_series(4001_int64, 22_int64), normal_series(4001_int64, 23_int64))
      x(2001) = 1e9_dp
      call compute_allan(x(:2000), 0.5_dp, allan_options(), first, failed)
      call compute_allan(x(2002:), 0.5_dp, allan_options(), second, failed)
      x(2001) = 0
      call compare_halves(x, 0.5_dp, noise, halves_options(), halves, failed)
      k = size(halves%tau)
      call check(error, maxval(abs(halves%tau - first%tau(:k))), 0.0_dp, thr=1e-12_dp)
      call check(error, maxval(abs(halves%ratio - second%deviation(:k)/first%deviation(:k))), 0.0_dp, thr=1e-10_dp)
   end subroutine test_curves

   !> Backwards, the ratios are their reciprocals and the statistic is the same.
   subroutine test_reversal()
      type(noise_type) :: noise
      type(halves_type) :: halves, backwards
      real(dp) :: x(3000)

      call white_model(1.0_dp, noise)
      x = normal_series(3000_int64, 31_int64)
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      call compare_halves(x(3000:1:-1), 1.0_dp, noise, halves_options(), backwards, failed)
      call check(error, maxval(abs(halves%ratio*backwards%ratio - 1)), 0.0_dp, thr=1e-10_dp)
      call check(error, halves%statistic, backwards%statistic, thr=1e-9_dp)
   end subroutine test_reversal

   !> Neither the unit of the rate nor that of the time matters, when the coefficients are in the same.
   subroutine test_units()
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      type(halves_type) :: halves, scaled
      real(dp) :: x(3000)

      x = normal_series(3000_int64, 41_int64) &
         & + 0.02_dp*walk_of(normal_series(3000_int64, 42_int64), normal_series(3000_int64, 43_int64))
      call compute_allan(x, 1.0_dp, allan_options(), curve, failed)
      call fit_noise(curve, noise_options(), noise, failed)
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      call compute_allan(1e-3_dp*x, 0.01_dp, allan_options(), curve, failed)
      call fit_noise(curve, noise_options(), noise, failed)
      call compare_halves(1e-3_dp*x, 0.01_dp, noise, halves_options(), scaled, failed)
      call check(error, scaled%statistic/halves%statistic, 1.0_dp, thr=1e-6_dp)
      call check(error, maxval(abs(scaled%lower/halves%lower - 1)), 0.0_dp, thr=1e-6_dp)
   end subroutine test_units

   !> Of 200 white records the p-values are uniform: mean 1/2 and share below 0.2 within three standard errors.
   subroutine test_uniform()
      integer, parameter :: records = 200
      type(noise_type) :: noise
      type(halves_type) :: halves
      real(dp) :: p_value(records)
      integer :: i

      call white_model(1.0_dp, noise)
      do i = 1, records
         call compare_halves(normal_series(1024_int64, int(i*7919, int64)), 1.0_dp, noise, halves_options(), halves, failed)
         p_value(i) = halves%p_value
      end do
      call check(error, sum(p_value)/records, 0.5_dp, thr=3*sqrt(1/(12.0_dp*records)))
      call check(error, real(count(p_value < 0.2_dp), dp)/records, 0.2_dp, thr=3*sqrt(0.16_dp/records))
   end subroutine test_uniform

   !> Of 200 white records that lack a fifth of their samples, here and there, p-values below 0.05 are as many as they should be,
   !> within three standard errors.
   subroutine test_scattered()
      integer, parameter :: records = 200
      type(noise_type) :: noise
      type(halves_type) :: halves
      real(dp) :: p_value(records), x(2048)
      integer :: i

      call white_model(1.0_dp, noise)
      do i = 1, records
         x = normal_series(2048_int64, int(i*104729, int64))
         where (normal_series(2048_int64, int(i*1548587, int64)) > 0.8416_dp) x = ieee_value(1.0_dp, ieee_quiet_nan)
         call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
         p_value(i) = halves%p_value
      end do
      call check(error, real(count(p_value < 0.05_dp), dp)/records, 0.05_dp, thr=3*sqrt(0.0475_dp/records))
   end subroutine test_scattered

   !> Eight outliers of 15 standard deviations in the second half, a fifth more variance, are no change of the noise; the same rise
   !> spread over all samples is.
   subroutine test_outliers()
      type(noise_type) :: noise
      type(halves_type) :: halves
      real(dp) :: x(20000)
      integer :: i

      call white_model(1.0_dp, noise)
      x = normal_series(20000_int64, 77_int64)
      do i = 1, 8
         x(10000 + 1001*i) = merge(15.0_dp, -15.0_dp, mod(i, 3) == 0)
      end do
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      call check(error, halves%ratio(1) > 1.06_dp .and. .not. halves%changed)
      x = normal_series(20000_int64, 77_int64)
      x(10001:) = x(10001:)*halves%ratio(1)
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      call check(error, halves%changed)
   end subroutine test_outliers

   !> Missing samples, marked or not finite, do not count whatever stands there; fewer terms make wider limits.
   subroutine test_gaps()
      type(noise_type) :: noise
      type(halves_type) :: halves, marked, not_finite
      real(dp) :: x(6000)
      integer(int8) :: valid(6000)

      call white_model(1.0_dp, noise)
      x = normal_series(6000_int64, 51_int64)
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      valid = 1
      valid(1000:1499) = 0
      valid(4500:5000:7) = 0
      x = merge(x, 1e6_dp, valid == 1)
      call compare_halves(x, 1.0_dp, noise, halves_options(), marked, failed, valid)
      x = merge(x, ieee_value(1.0_dp, ieee_quiet_nan), valid == 1)
      call compare_halves(x, 1.0_dp, noise, halves_options(), not_finite, failed)
      call check(error, maxval(abs(marked%ratio - not_finite%ratio)), 0.0_dp, thr=1e-14_dp)
      call check(error, all(abs(marked%ratio(:5) - halves%ratio(:5)) < halves%upper(:5) - halves%lower(:5)))
      call check(error, all(marked%upper(:5)/marked%lower(:5) > halves%upper(:5)/halves%lower(:5)) .and. marked%p_value > 1e-4_dp)
   end subroutine test_gaps

   !> Halves that lack different shares have logarithms of different bias: psi(nu/2) - ln(nu/2) each, which is taken off. nu as
   !> in single_tau, of 40 samples, 19 of the second half's 39 differences left.
   subroutine test_unequal()
      type(noise_type) :: noise
      type(halves_options) :: options
      type(halves_type) :: halves
      real(dp) :: x(80), z1(39), z2(19), half_nu(2), expected
      integer(int8) :: valid(80)

      call white_model(1.0_dp, noise)
      x(:40) = normal_series(40_int64, 71_int64)
      x(41:) = x(:40)
      valid = 1
      valid(61:) = 0
      options%taus = "1"
      options%least_edf = 1
      call compare_halves(x, 1.0_dp, noise, options, halves, failed, valid)
      if (unmet(.not. allocated(failed) .and. size(halves%tau) == 1)) return
      z1 = x(2:40) - x(1:39)
      z2 = x(42:60) - x(41:59)
      half_nu = 1/((39*4 + 2*38*1)/(39.0_dp**2*2) + (excess(z1) + excess(z2))/40)
      half_nu(2) = half_nu(2)*19/39
      expected = log((sum(z2**2)/19)/(sum(z1**2)/39)) - (digamma(half_nu(2)) - log(half_nu(2))) &
         & + (digamma(half_nu(1)) - log(half_nu(1)))
      call check(error, 2*log(halves%ratio(1)), expected, thr=1e-8_dp)
   end subroutine test_unequal

   subroutine test_failures()
      type(noise_type) :: noise, nothing
      type(halves_options) :: options
      type(halves_type) :: halves
      real(dp) :: x(1000)

      call white_model(1.0_dp, noise)
      x = normal_series(1000_int64, 61_int64)
      call compare_halves(x, 1.0_dp, nothing, options, halves, failed)
      call check(error, failed%code, status%invalid_argument)
      call compare_halves(x, 0.0_dp, noise, options, halves, failed)
      call check(error, failed%code, status%invalid_argument)
      call compare_halves(x(:7), 1.0_dp, noise, options, halves, failed)
      call check(error, failed%code, status%too_few_samples)
      options%taus = "all"
      call compare_halves(x, 1.0_dp, noise, options, halves, failed)
      call check(error, failed%code, status%invalid_argument)
      options%taus = "200"
      call compare_halves(x, 1.0_dp, noise, options, halves, failed)
      call check(error, failed%code, status%too_few_samples)
      x(:500) = 3
      call compare_halves(x, 1.0_dp, noise, halves_options(), halves, failed)
      call check(error, failed%code, status%constant_input)
   end subroutine test_failures

end module test_allan_halves
