! SPDX-License-Identifier: MIT
!> Tests of the names of FORTRAN 77: what they give is what the library gives, INFO says which argument is bad.
module test_legacy
   use, intrinsic :: iso_c_binding, only : c_double, c_int32_t
   use expectations, only : unmet, failed => problem, test, error, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use gyroakf_c_api_legacy, only : gyadev, gyadft, gyarft, gynfit
   use gyroakf_c_api_legacy, only : gyffrz, gyfget, gyfini, gyfrun, gyfstp
   use gyroakf_filter_kalman, only : filter_options, filter_type, freeze_filter, new_filter, step_filter
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_random, only : fill_normal, random_type, seed_random
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   implicit none (type, external)
   private
   public :: suite_legacy

   integer, parameter :: samples = 2000, points = 64
   !> Seconds
   real(dp), parameter :: interval = 0.01_dp

contains

   subroutine suite_legacy()
      call test("gyadev", test_gyadev)
      call test("gynfit", test_gynfit)
      call test("gyadft", test_gyadft)
      call test("gyarft", test_gyarft)
      call test("filter", test_filter)
      call test("filter-adapts", test_adaptive)
      call test("filter-refused", test_refused)
   end subroutine suite_legacy

   !> AR(1) of normal noise, of coefficient phi.
   subroutine make_series(phi, x)
      real(dp), intent(in) :: phi
      real(dp), intent(out) :: x(:)
      type(random_type) :: random
      integer :: k

      call seed_random(random, 77_int64)
      call fill_normal(random, x)
      do k = 2, size(x)
         x(k) = phi*x(k - 1) + x(k)
      end do
   end subroutine make_series

   !> Every kind of deviation, and what is wrong with N, KIND, MAXT, DT.
   subroutine test_gyadev()
      character(6), parameter :: kinds(7) = [character(6) :: "oadev", "adev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(c_double), dimension(points) :: tau, dev, low, high, edf
      real(dp) :: x(samples)
      integer(c_int32_t) :: kind, nt, info

      call make_series(0.5_dp, x)
      do kind = 1, size(kinds)
         options%kind = trim(kinds(kind))
         call compute_allan(x, interval, options, curve, failed)
         if (kind == 1) call fit_noise(curve, noise_options(), noise, failed)
         call gyadev(samples, x, interval, kind, points, nt, tau, dev, low, high, edf, info)
         if (unmet(info == 0 .and. nt == size(curve%tau), kinds(kind))) return
         call check(error, all(abs([tau(:nt), dev(:nt), low(:nt), high(:nt), edf(:nt)] - &
                                   [curve%tau, curve%deviation, curve%lower, curve%upper, curve%edf]) <= 0.0_dp), kinds(kind))
      end do
      call gyadev(1, x, interval, 1, points, nt, tau, dev, low, high, edf, info)
      call check(error, info == -1 .and. nt == 0, "N = 1")
      call gyadev(samples, x, interval, 0, points, nt, tau, dev, low, high, edf, info)
      call check(error, info == -4, "KIND = 0")
      call gyadev(samples, x, interval, 8, points, nt, tau, dev, low, high, edf, info)
      call check(error, info == -4, "KIND = 8")
      call gyadev(samples, x, interval, 1, 2, nt, tau, dev, low, high, edf, info)
      call check(error, info == -5 .and. nt > 2, "MAXT = 2: NT says how many are needed")
      call gyadev(samples, x, -interval, 1, points, nt, tau, dev, low, high, edf, info)
      call check(error, info == status%invalid_argument, "DT < 0")
   end subroutine test_gyadev

   subroutine test_gynfit()
      type(allan_curve_type) :: curve
      type(noise_type) :: noise
      real(c_double) :: coef(5), se(5), upper(5), chi2, x(samples)
      integer(c_int32_t) :: detected(5), info

      call make_series(0.0_dp, x)
      call compute_allan(x, interval, allan_options(), curve, failed)
      call fit_noise(curve, noise_options(), noise, failed)
      call gynfit(samples, x, interval, coef, se, upper, detected, chi2, info)
      call check(error, info, 0)
      associate (c => noise%coefficient)
         call check(error, all(abs([coef, se, upper, chi2] - [c%value, c%std_error, c%upper_limit, noise%chi2_reduced]) <= 0.0_dp) &
                    .and. all((detected /= 0) .eqv. c%detected) .and. detected(2) == 1, "coefficients")
      end associate
      if (allocated(error)) return
      call gynfit(1, x, interval, coef, se, upper, detected, chi2, info)
      call check(error, info == -1, "N = 1")
      x = 1.0_dp
      call gynfit(samples, x, interval, coef, se, upper, detected, chi2, info)
      call check(error, info > 0, "a constant")
   end subroutine test_gynfit

   subroutine test_gyadft()
      type(adf_options) :: options
      type(adf_type) :: result
      real(c_double) :: x(samples), stat, pval, crit(3)
      integer(c_int32_t) :: lag, most, info

      call make_series(0.5_dp, x)
      do most = -1, 3, 4                                    ! chosen, given
         options%max_lags = most
         call test_adf(x, options, result, failed)
         call gyadft(samples, x, most, stat, pval, crit, lag, info)
         call check(error, info == 0 .and. lag == result%lag, "lag")
         call check(error, all(abs([stat, pval, crit] - [result%statistic, result%p_value, result%critical]) <= 0.0_dp), "numbers")
      end do
      call gyadft(0, x, -1, stat, pval, crit, lag, info)
      call check(error, info == -1, "N = 0")
      call gyadft(samples, x, -2, stat, pval, crit, lag, info)
      call check(error, info == -3, "MAXLAG = -2")
      call gyadft(3, x, -1, stat, pval, crit, lag, info)
      call check(error, info == status%too_few_samples, "N = 3")
   end subroutine test_gyadft

   subroutine test_gyarft()
      character(4), parameter :: methods(3) = ["yw  ", "burg", "ols "]
      integer(c_int32_t), parameter :: most = 6
      type(ar_options) :: options
      type(ar_model_type) :: model
      real(c_double) :: x(samples), phi(most), expected(most), var, mean
      integer(c_int32_t) :: order, method, info

      call make_series(0.5_dp, x)
      x = x + 3.0_dp
      do method = 1, size(methods)
         options%method = methods(method)
         options%max_order = most
         call fit_ar(x, options, model, failed)
         call gyarft(samples, x, method, most, order, phi, var, mean, info)
         call check(error, info == 0 .and. order == model%order .and. order > 0, methods(method))
         expected = 0.0_dp
         expected(:order) = model%coefficient
         call check(error, all(abs([phi, var, mean] - [expected, model%noise_variance, model%mean]) <= 0.0_dp), methods(method))
      end do
      call gyarft(0, x, 1, most, order, phi, var, mean, info)
      call check(error, info == -1, "N = 0")
      call gyarft(samples, x, 4, most, order, phi, var, mean, info)
      call check(error, info == -3, "METHOD = 5")
      call gyarft(samples, x, 1, 1001, order, phi, var, mean, info)
      call check(error, info == -4, "MAXP = 1001")
      x = 1.0_dp
      call gyarft(samples, x, 1, most, order, phi, var, mean, info)
      call check(error, info == status%constant_input, "a constant")
   end subroutine test_gyarft

   !> Step by step, at once, and beside the filter of the library; missing measurements, a part without adaptation; what it holds.
   subroutine compare_filter(phi, adapt)
      real(c_double), intent(in) :: phi(:)
      integer(c_int32_t), intent(in) :: adapt(4)
      real(c_double), parameter :: q = 1.0_dp, r = 2.0_dp, forgetting = 0.99_dp
      type(filter_options) :: options
      type(filter_type) :: filter
      real(c_double) :: z(samples), x(samples), all_at_once(samples), expected(samples), length(1), state(9)
      real(c_double), allocatable :: work(:), other(:)
      integer(c_int32_t) :: info, p
      integer :: k

      p = size(phi)
      call make_series(0.5_dp, z)
      z(100:119) = ieee_value(z(1), ieee_quiet_nan)
      call gyfini(p, phi, q, r, adapt, forgetting, length, -1, info)
      call check(error, info == 0 .and. nint(length(1)) == 40 + 5*p + p*p, "GYFINI: the length of WORK")
      allocate (work(nint(length(1))))
      call gyfini(p, phi, q, r, adapt, forgetting, work, size(work), info)
      call check(error, info, 0)
      other = work
      options%estimate_process_mean = adapt(1) /= 0
      options%estimate_measurement_mean = adapt(2) /= 0
      options%estimate_process_variance = adapt(3) /= 0
      options%estimate_measurement_variance = adapt(4) /= 0
      options%allow_unobservable = .true.
      options%forgetting = forgetting
      call new_filter(filter, phi, q, r, options, failed)
      do k = 1, samples
         if (k == 500 .or. k == 700) then
            call gyffrz(work, merge(1, 0, k == 500), info)
            call freeze_filter(filter, k == 500)
         end if
         call gyfstp(work, z(k), x(k), info)
         if (info /= 0) exit
         call step_filter(filter, z(k), expected(k))
      end do
      call check(error, info, 0)
      ! of order 1 the library computes in another order, and keeps a gain that has settled
      call check(error, all(abs(x - expected) <= merge(1.0e-12_dp, 0.0_dp, p == 1)), "GYFSTP beside the filter of the library")
      call gyfget(work, state, info)
      call check(error, info == 0 .and. abs(state(1) - x(samples)) <= 0.0_dp, "GYFGET: the estimate")
      call gyfrun(other, 499, z, all_at_once, info)
      call check(error, info == 0 .and. all(abs(all_at_once(:499) - x(:499)) <= 0.0_dp), "GYFRUN as step by step")
   end subroutine compare_filter

   subroutine test_filter()
      call compare_filter([0.5_dp], [0, 0, 0, 0])
      if (.not. allocated(error)) call compare_filter([0.5_dp, 0.2_dp, 0.1_dp], [0, 0, 0, 0])
   end subroutine test_filter

   subroutine test_adaptive()
      call compare_filter([0.5_dp], [1, 0, 1, 1])
      if (.not. allocated(error)) call compare_filter([0.5_dp, 0.2_dp], [0, 1, 0, 1])
   end subroutine test_adaptive

   !> Arguments that are bad; what is no filter gives the measurement back.
   subroutine test_refused()
      integer(c_int32_t), parameter :: fixed(4) = 0
      real(c_double) :: work(46), z(2), x(2), state(9)
      integer(c_int32_t) :: info

      work = 0.0_dp
      z = [1.5_dp, 2.5_dp]
      call gyfini(-1, [0.5_dp], 1.0_dp, 1.0_dp, fixed, 1.0_dp, work, size(work), info)
      call check(error, info == -1, "GYFINI: IP < 0")
      call gyfini(1, [0.5_dp], 1.0_dp, 1.0_dp, fixed, 1.0_dp, work, 45, info)
      call check(error, info == -8, "GYFINI: LWORK too small")
      call gyfini(1, [2.0_dp], 1.0_dp, 1.0_dp, fixed, 1.0_dp, work, size(work), info)
      call check(error, info == status%unstable, "GYFINI: not stationary")
      call gyfstp(work, z(1), x(1), info)
      call check(error, info == -1 .and. abs(x(1) - z(1)) <= 0.0_dp, "GYFSTP: no filter")
      call gyfrun(work, 2, z, x, info)
      call check(error, info == -1, "GYFRUN: no filter")
      call gyfget(work, state, info)
      call check(error, info == -1 .and. all(abs(state) <= 0.0_dp), "GYFGET: no filter")
      call gyffrz(work, 1, info)
      call check(error, info == -1, "GYFFRZ: no filter")
      call gyfini(1, [0.5_dp], 1.0_dp, 1.0_dp, fixed, 1.0_dp, work, size(work), info)
      call gyfrun(work, -1, z, x, info)
      call check(error, info == -2, "GYFRUN: N < 0")
   end subroutine test_refused

end module test_legacy
