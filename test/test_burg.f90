! SPDX-License-Identifier: MIT
!> Tests of AR models by Burg's recursion.
module test_burg
   use expectations, only : unmet, problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_autocovariance, only : find_level
   use gyroakf_stats_trend, only : trend_type
   use gyroakf_ar_burg, only : burg_type, compute_burg
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use ar_reference, only : burg_phi, burg_residual, burg_variance
   use series_library, only : reference_series, reference_names
   implicit none (type, external)
   private
   public :: suite_burg

   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_burg()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("long_reference", test_long_reference)
      call test("time_reversal", test_time_reversal)
      call test("gaps_dense", test_gaps_dense)
      call test("near_unit_root", test_near_unit_root)
   end subroutine suite_burg

   !> x = -1 1 -3 3 0 about the mean 2: k_1 = 2 (-1 - 3 - 9 + 0)/(2 (1 + 9 + 9) + 1 + 0) = -26/39; r_0 = 4.
   subroutine test_by_hand()
      type(ar_model_type) :: model

      call fit_ar([1.0_dp, 3.0_dp, -1.0_dp, 5.0_dp, 2.0_dp], ar_options(method="burg", max_order=1, order=1), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%coefficient(1), -26.0_dp/39.0_dp, thr=tolerance)
      call check(error, model%noise_variance, 4.0_dp*(1.0_dp - 4.0_dp/9.0_dp), thr=tolerance)
      call check(error, model%residual_variance, 39.0_dp*(1.0_dp - 4.0_dp/9.0_dp)/8.0_dp, thr=tolerance)
      call check(error, model%unbiased_variance, model%noise_variance*5.0_dp/3.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> Coefficients and both variances of the orders 1 .. 6 of the eleven series.
   subroutine test_reference()
      type(ar_model_type) :: model
      integer :: i, p

      do i = 1, size(reference_names)
         do p = 1, 6
            call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(method="burg", order=p, max_order=6), &
               & model, problem)
            if (went_wrong(problem, reference_names(i))) return
            call check(error, maxval(abs(model%coefficient - burg_phi(p*(p - 1)/2 + 1:p*(p + 1)/2, i))), 0.0_dp, &
               & reference_names(i), thr=tolerance)
            call check(error, model%noise_variance, burg_variance(p, i), reference_names(i), thr=tolerance, rel=.true.)
            call check(error, model%residual_variance, burg_residual(p, i), reference_names(i), thr=tolerance, rel=.true.)
            if (unmet(model%stationary .and. size(model%root) == p, "Burg's models are stationary")) return
         end do
      end do
   end subroutine test_reference

   !> 12,000 samples of AR(2).
   subroutine test_long_reference()
      type(ar_model_type) :: model

      call fit_ar(reference_series("ar2", 12000), ar_options(method="burg", order=3), model, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(model%coefficient - [1.1733820965680746_dp, -0.4524316608865892_dp, &
         & -0.02507647054699809_dp])), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(model%table(2:)%noise_variance/[1.3015167566647547_dp, 0.9989434799248016_dp, &
         & 0.9983153149205658_dp] - 1.0_dp)), 0.0_dp, thr=tolerance)
      call check(error, model%residual_variance, 0.998370294143918_dp, thr=tolerance, rel=.true.)
   end subroutine test_long_reference

   !> Forward and backward residuals change places.
   subroutine test_time_reversal()
      type(ar_model_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: i

      do i = 1, 2
         x = reference_series("trend", merge(500, 30000, i == 1))
         call fit_ar(x, ar_options(method="burg", order=5), a, problem)
         call fit_ar(x(size(x):1:-1), ar_options(method="burg", order=5), b, problem)
         if (went_wrong(problem)) return
         call check(error, maxval(abs(a%coefficient - b%coefficient)), 0.0_dp, thr=tolerance)
      end do
   end subroutine test_time_reversal

   !> Stretches of many lengths against the recursion written out with arrays for each stretch.
   subroutine test_gaps_dense()
      real(dp) :: x(600), f(600), b(600), k(4), n, d, f0, variance
      integer(int8) :: valid(600)
      type(burg_type) :: burg
      type(trend_type) :: level
      integer(int64) :: count
      integer :: m, t

      x = reference_series("ar2", 600) + 5.0_dp
      valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 600), 50) < 0.15_dp)
      where (valid == 0_int8) x = 1.0e6_dp
      call find_level(x, level, count, problem, valid)
      call compute_burg(x, level, 4, burg, problem, valid)
      if (went_wrong(problem)) return
      f = merge((x - level%legendre(0)) - level%remainder, 0.0_dp, valid == 1_int8)
      b = f
      variance = sum(f**2)/real(count, dp)
      do m = 1, 4
         n = 0.0_dp
         d = 0.0_dp
         do t = m + 1, 600
            if (any(valid(t - m:t) == 0_int8)) cycle
            n = n + 2.0_dp*f(t)*b(t - 1)
            d = d + f(t)**2 + b(t - 1)**2
         end do
         k(m) = n/d
         variance = variance*(1.0_dp - k(m)**2)
         do t = 600, m + 1, -1
            f0 = f(t)
            f(t) = f0 - k(m)*b(t - 1)
            b(t) = b(t - 1) - k(m)*f0
         end do
      end do
      call check(error, maxval(abs(burg%reflection - k)), 0.0_dp, thr=tolerance)
      call check(error, burg%variance(4), variance, thr=tolerance, rel=.true.)
      call check(error, burg%rows(4) == sum([(merge(1, 0, all(valid(t - 4:t) == 1_int8)), t=5, 600)]), "rows")
   end subroutine test_gaps_dense

   !> A random walk of 30,000 steps: the model stays stationary, whatever the largest order.
   subroutine test_near_unit_root()
      type(ar_model_type) :: model, short

      call fit_ar(reference_series("rw", 30000), ar_options(method="burg", order=6, max_order=6), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%stationary .and. model%root(1)%modulus > 0.999_dp, "the root near one")
      call check(error, model%residual_variance, 1.0_dp, "the steps have variance 1", thr=0.03_dp)
      call fit_ar(reference_series("rw", 30000), ar_options(method="burg", order=1, max_order=1), short, problem)
      call check(error, short%noise_variance, model%table(2)%noise_variance, thr=1.0e-9_dp, rel=.true.)
   end subroutine test_near_unit_root

end module test_burg
