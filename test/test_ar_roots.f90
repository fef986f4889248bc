! SPDX-License-Identifier: MIT
!> Tests of the roots and the spectrum of AR models, and of what the fit says of the residuals.
module test_ar_roots
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_ar_roots, only : ar_root_type, find_ar_roots, largest_modulus
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_ar_model, only : ar_model_type, ar_options, ar_spectrum, fit_ar
   use gyroakf_ar_residuals, only : analyze_residuals
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use series_library, only : reference_series
   implicit none (type, external)
   private
   public :: suite_ar_roots, suite_ar_spectrum

   !> Simple roots well apart come to a few units in the last place of the coefficients
   real(dp), parameter :: tolerance = 1.0e-13_dp
   real(dp), parameter :: two_pi = 2.0_dp*acos(-1.0_dp)
   real(dp), parameter :: rounding = 1.0e-12_dp

contains

   subroutine suite_ar_roots()
      call test("by_hand", test_by_hand)
      call test("pair", test_pair)
      call test("known_roots", test_known_roots)
      call test("circle", test_circle)
      call test("scale_of_coefficients", test_wide_range)
      call test("failures", test_failures)
   end subroutine suite_ar_roots

   subroutine suite_ar_spectrum()
      call test("white", test_white)
      call test("integral", test_integral)
      call test("peak", test_peak)
      call test("residuals", test_residuals)
   end subroutine suite_ar_spectrum

   !> One real root, positive, negative, zero and outside the circle; order 0 has none.
   subroutine test_by_hand()
      type(ar_root_type), allocatable :: root(:)

      call find_ar_roots([0.5_dp], root, problem)
      call check(error, abs(root(1)%time_constant - 1.0_dp/log(2.0_dp)) < tolerance .and. root(1)%frequency <= 0.0_dp &
                 & .and. abs(root(1)%damping - 1.0_dp) < tolerance, "0.5")
      call find_ar_roots([-0.5_dp], root, problem)
      call check(error, abs(root(1)%frequency - 0.5_dp) < tolerance .and. abs(root(1)%real_part + 0.5_dp) < tolerance, "-0.5")
      call find_ar_roots([0.0_dp], root, problem)
      call check(error, root(1)%modulus <= 0.0_dp .and. root(1)%time_constant <= 0.0_dp, "0")
      call find_ar_roots([2.0_dp], root, problem)
      call check(error, root(1)%time_constant < 0.0_dp .and. root(1)%damping < 0.0_dp .and. largest_modulus(root) > 1.0_dp, "2")
      call find_ar_roots([real(dp) ::], root, problem)
      call check(error, .not. allocated(problem) .and. size(root) == 0 .and. largest_modulus(root) <= 0.0_dp, "order 0")
   end subroutine test_by_hand

   !> A pair r exp(+-i w): phi = 2 r cos w, -r^2.
   subroutine test_pair()
      real(dp), parameter :: r = 0.99_dp, f = 0.12_dp
      type(ar_root_type), allocatable :: root(:)
      integer :: i

      call find_ar_roots([2.0_dp*r*cos(two_pi*f), -r*r], root, problem)
      do i = 1, 2
         call check(error, root(i)%modulus, r, thr=tolerance)
         call check(error, root(i)%frequency, f, thr=tolerance)
         call check(error, root(i)%damping, -log(r)/sqrt(log(r)**2 + (two_pi*f)**2), thr=tolerance)
      end do
      call check(error, root(1)%imaginary_part > 0.0_dp .and. root(2)%imaginary_part < 0.0_dp, "the order of the pair")
   end subroutine test_pair

   !> The polynomial of given roots: 0.95, -0.8, 0.7 exp(+-i pi/3), 0.3, 0; the largest comes first.
   subroutine test_known_roots()
      complex(dp) :: z(6), polynomial(0:6)
      type(ar_root_type), allocatable :: root(:)
      integer :: i

      z = [(0.95_dp, 0.0_dp), (-0.8_dp, 0.0_dp), 0.7_dp*exp(cmplx(0.0_dp, two_pi/6.0_dp, dp)), &
         & 0.7_dp*exp(cmplx(0.0_dp, -two_pi/6.0_dp, dp)), (0.3_dp, 0.0_dp), (0.0_dp, 0.0_dp)]
      polynomial = (0.0_dp, 0.0_dp)
      polynomial(0) = (1.0_dp, 0.0_dp)
      do i = 1, 6
         polynomial(1:i) = polynomial(1:i) - z(i)*polynomial(0:i - 1)
      end do
      call find_ar_roots(-real(polynomial(1:), dp), root, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(cmplx(root%real_part, root%imaginary_part, dp) - z)), 0.0_dp, thr=tolerance)
   end subroutine test_known_roots

   !> z^12 = 1: twelve roots on the unit circle.
   subroutine test_circle()
      real(dp) :: phi(12)
      type(ar_root_type), allocatable :: root(:)

      phi = 0.0_dp
      phi(12) = 1.0_dp
      call find_ar_roots(phi, root, problem)
      call check(error, maxval(abs(root%modulus - 1.0_dp)), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(12.0_dp*root%frequency - anint(12.0_dp*root%frequency))), 0.0_dp, thr=12.0_dp*tolerance)
   end subroutine test_circle

   !> Roots 1e-3 .. 1e3: balancing keeps the digits of the small ones.
   subroutine test_wide_range()
      real(dp), parameter :: z(4) = [1.0e3_dp, 10.0_dp, 0.1_dp, 1.0e-3_dp]
      real(dp) :: polynomial(0:4)
      type(ar_root_type), allocatable :: root(:)
      integer :: i

      polynomial = 0.0_dp
      polynomial(0) = 1.0_dp
      do i = 1, 4
         polynomial(1:i) = polynomial(1:i) - z(i)*polynomial(0:i - 1)
      end do
      call find_ar_roots(-polynomial(1:), root, problem)
      call check(error, maxval(abs(root%real_part/z - 1.0_dp)), 0.0_dp, thr=1.0e-12_dp)
   end subroutine test_wide_range

   !> A coefficient that is not finite.
   subroutine test_failures()
      type(ar_root_type), allocatable :: root(:)

      call find_ar_roots([0.5_dp, ieee_value(1.0_dp, ieee_quiet_nan)], root, problem)
      call check_refused(problem, status%non_finite)
   end subroutine test_failures

   !> Order 0: the density of white noise, its variance over the bandwidth.
   subroutine test_white()
      type(ar_model_type) :: model

      call fit_ar(reference_series("wn", 200), ar_options(order=0), model, problem)
      if (went_wrong(problem)) return
      call check(error, ar_spectrum(model, 17.0_dp, 0.01_dp), 0.01_dp*model%variance, &
         & thr=rounding, rel=.true.)
   end subroutine test_white

   !> The variance that a Yule-Walker model gives back is r_0; the sum over a period of a smooth function is its integral.
   subroutine test_integral()
      type(ar_model_type) :: model
      integer :: i

      call fit_ar(reference_series("ar2", 3000), ar_options(order=4, max_order=4), model, problem)
      if (went_wrong(problem)) return
      call check(error, sum(ar_spectrum(model, [(0.125_dp*real(i, dp), i=-200, 199)], 0.02_dp))*0.125_dp, model%variance, &
         & thr=rounding, rel=.true.)
      call check(error, ar_spectrum(model, -3.0_dp, 0.02_dp), &
         & ar_spectrum(model, 53.0_dp, 0.02_dp), &
                 thr=rounding, rel=.true.)
   end subroutine test_integral

   !> A sinusoid in noise: the density has its peak there, at the frequency of the largest pair of roots.
   subroutine test_peak()
      type(ar_model_type) :: model
      real(dp) :: density(0:5000)
      integer :: i

      call fit_ar(3.0_dp*[(cos(0.7_dp*real(i, dp)), i=1, 2000)] + reference_series("wn", 2000), &
         & ar_options(method="burg", order=12, max_order=12), model, problem)
      if (went_wrong(problem)) return
      density = ar_spectrum(model, [(1.0e-4_dp*real(i, dp), i=0, 5000)], 1.0_dp)
      call check(error, 1.0e-4_dp*real(maxloc(density, 1) - 1, dp), 0.7_dp/(2.0_dp*acos(-1.0_dp)), thr=2.0e-3_dp)
      call check(error, model%root(1)%frequency, 0.7_dp/(2.0_dp*acos(-1.0_dp)), thr=2.0e-3_dp)
   end subroutine test_peak

   !> One pass against autocovariances and moments of residuals written out, with gaps.
   subroutine test_residuals()
      real(dp), parameter :: phi(2) = [1.1_dp, -0.4_dp]
      real(dp) :: x(20000), e(19998), mean
      integer(int8) :: valid(20000), row(19998)
      real(dp), allocatable :: r(:), expected(:)
      integer(int64), allocatable :: pairs(:), number(:)
      type(moments_type) :: moments, dense

      x = reference_series("ar2", 20000) + 50.0_dp
      valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 20000), 50) < 0.05_dp)
      valid(5000:12000) = 1_int8
      call analyze_residuals(x, 49.0_dp, phi, 0.25_dp, 25, r, pairs, moments, problem, valid)
      if (went_wrong(problem)) return
      row = valid(3:)*valid(2:19999)*valid(:19998)
      e = x(3:) - 49.0_dp - phi(1)*(x(2:19999) - 49.0_dp) - phi(2)*(x(:19998) - 49.0_dp)
      call compute_autocovariance(e, 25, mean, expected, problem, row, number)
      call check(error, maxval(abs(r - expected)), 0.0_dp, thr=rounding)
      call check(error, all(pairs == number), "pairs")
      call compute_moments(e - 0.25_dp, dense, row)
      call check(error, maxval(abs([moments%mean, moments%std, moments%skewness, moments%kurtosis] - &
         & [dense%mean, dense%std, dense%skewness, dense%kurtosis])), 0.0_dp, thr=rounding)
   end subroutine test_residuals

end module test_ar_roots
