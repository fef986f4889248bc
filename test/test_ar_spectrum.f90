! SPDX-License-Identifier: MIT
!> Tests of the spectrum of AR models, and of what the fit says of the residuals.
module test_ar_spectrum
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_ar_model, only : ar_model_type, ar_options, ar_spectrum, fit_ar
   use gyroakf_ar_residuals, only : analyse_residuals
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use series_library, only : reference_series
   use expectations, only : problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_ar_spectrum

   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_ar_spectrum()
      call test("white", test_white)
      call test("integral", test_integral)
      call test("peak", test_peak)
      call test("residuals", test_residuals)
   end subroutine suite_ar_spectrum

   !> Order 0: the density of white noise, its variance over the bandwidth.
   subroutine test_white()
      type(ar_model_type) :: model

      call fit_ar(reference_series("wn", 200), ar_options(order=0), model, problem)
      if (went_wrong(problem)) return
      call check(error, ar_spectrum(model, 17.0_dp, 0.01_dp), 0.01_dp*model%variance, thr=tolerance, rel=.true.)
   end subroutine test_white

   !> The variance that a Yule-Walker model gives back is r_0; the sum over a period of a smooth function is its integral.
   subroutine test_integral()
      type(ar_model_type) :: model
      integer :: i

      call fit_ar(reference_series("ar2", 3000), ar_options(order=4, max_order=4), model, problem)
      if (went_wrong(problem)) return
      call check(error, sum(ar_spectrum(model, [(0.125_dp*real(i, dp), i=-200, 199)], 0.02_dp))*0.125_dp, model%variance, &
         & thr=tolerance, rel=.true.)
      call check(error, ar_spectrum(model, -3.0_dp, 0.02_dp), ar_spectrum(model, 53.0_dp, 0.02_dp), thr=tolerance, rel=.true.)
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
      call analyse_residuals(x, 49.0_dp, phi, 0.25_dp, 25, r, pairs, moments, problem, valid)
      if (went_wrong(problem)) return
      row = valid(3:)*valid(2:19999)*valid(:19998)
      e = x(3:) - 49.0_dp - phi(1)*(x(2:19999) - 49.0_dp) - phi(2)*(x(:19998) - 49.0_dp)
      call compute_autocovariance(e, 25, mean, expected, problem, row, number)
      call check(error, maxval(abs(r - expected)), 0.0_dp, thr=tolerance)
      call check(error, all(pairs == number), "pairs")
      call compute_moments(e - 0.25_dp, dense, row)
      call check(error, maxval(abs([moments%mean, moments%std, moments%skewness, moments%kurtosis] - &
         & [dense%mean, dense%std, dense%skewness, dense%kurtosis])), 0.0_dp, thr=tolerance)
   end subroutine test_residuals

end module test_ar_spectrum
