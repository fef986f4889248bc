! SPDX-License-Identifier: MIT
!> Tests of the polynomial trend.
module test_trend
   use expectations, only : problem, test, error, check, check_refused, went_wrong
   use gyroakf_threads, only : thread_count, set_thread_count
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_lapack, only : dgels
   use gyroakf_stats_trend, only : trend_type, evaluate_trend, remove_trend
   use gyroakf_stats_trend_fit, only : fit_trend
   use series_library, only : reference_series
   implicit none (type, external)
   private
   public :: suite_trend

   !> Relative to the largest value of the polynomial
   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_trend()
      call test("by_hand", test_by_hand)
      call test("exact_polynomials", test_exact_polynomials)
      call test("powers", test_powers)
      call test("least_squares", test_least_squares)
      call test("offset_scale", test_offset_scale)
      call test("large_offset", test_large_offset)
      call test("missing", test_missing)
      call test("one_end_present", test_one_end_present)
      call test("threads", test_threads)
      call test("no_trend", test_no_trend)
      call test("failures", test_failures)
   end subroutine suite_trend

   !> 1 2 4: slope 3/2, 7/3 in the middle.
   subroutine test_by_hand()
      type(trend_type) :: trend
      real(dp) :: x(3)

      x = [1.0_dp, 2.0_dp, 4.0_dp]
      call fit_trend(x, 1, trend, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(trend%legendre - [7.0_dp/3.0_dp, 1.5_dp])), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(trend%power - [5.0_dp/6.0_dp, 1.5_dp])), 0.0_dp, thr=tolerance)
      call remove_trend(trend, x)
      call check(error, maxval(abs(x - [1.0_dp, -2.0_dp, 1.0_dp]/6.0_dp)), 0.0_dp, thr=tolerance)
      call check(error, evaluate_trend(trend, 4_int64), 5.0_dp/6.0_dp + 6.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> A polynomial of degree d about 1e6, at some samples; d = 0 .. 9.
   pure real(dp) function polynomial(d, i, n) result(p)
      integer, intent(in) :: d
      !> Sample, 0-based, and length
      integer(int64), intent(in) :: i, n
      real(dp), parameter :: c(9) = [-3.0_dp, 2.0_dp, 0.5_dp, -1.0_dp, 0.3_dp, 0.2_dp, -0.1_dp, 0.7_dp, -0.4_dp]
      real(dp) :: t
      integer :: k

      t = real(2*i - (n - 1), dp)/real(max(n - 1, 1_int64), dp)
      p = 0.0_dp
      do k = d, 1, -1
         p = (p + 1.0e5_dp*c(k))*t
      end do
      p = 1.0e6_dp + p
   end function polynomial

   !> A polynomial is its own trend, to 1e-12, at 300 000 samples and at degree + 1.
   subroutine test_exact_polynomials()
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      real(dp) :: scale
      integer(int64) :: i, n
      integer :: d, j

      do d = 0, 9
         do j = 1, 2
            n = merge(300000, d + 1, j == 1)
            if (allocated(x)) deallocate (x)
            allocate (x(n))
            do i = 1, n
               x(i) = polynomial(d, i - 1, n)
            end do
            scale = maxval(abs(x))
            call fit_trend(x, d, trend, problem)
            if (went_wrong(problem)) return
            call check(error, abs(evaluate_trend(trend, n/3) - x(n/3 + 1))/scale, 0.0_dp, thr=tolerance)
            call remove_trend(trend, x)
            call check(error, maxval(abs(x))/scale, 0.0_dp, thr=tolerance)
         end do
      end do
   end subroutine test_exact_polynomials

   !> Coefficients in powers of the sample index, as large as the trends of the paper.
   subroutine test_powers()
      real(dp), parameter :: c(0:3) = [2.0e-2_dp, -3.0e-6_dp, 5.0e-10_dp, -1.0e-14_dp]
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer :: i

      allocate (x(12000))
      do i = 1, size(x)
         x(i) = c(0) + real(i - 1, dp)*(c(1) + real(i - 1, dp)*(c(2) + real(i - 1, dp)*c(3)))
      end do
      call fit_trend(x, 3, trend, problem)
      if (went_wrong(problem)) return
      do i = 0, 3
         call check(error, trend%power(i), c(i), thr=tolerance, rel=.true.)
      end do
   end subroutine test_powers

   !> The same least-squares problem by Householder reflections on the Legendre polynomials.
   subroutine test_least_squares()
      integer, parameter :: n = 700, d = 6
      real(dp) :: x(n), matrix(n, 0:d), right(n, 1), work(1000), t(n)
      type(trend_type) :: trend
      integer :: i, k, info

      x = reference_series("rw", n)
      t = [(real(2*i - (n - 1), dp)/real(n - 1, dp), i = 0, n - 1)]
      matrix(:, 0) = 1.0_dp
      matrix(:, 1) = t
      do k = 1, d - 1
         matrix(:, k + 1) = (real(2*k + 1, dp)*t*matrix(:, k) - real(k, dp)*matrix(:, k - 1))/real(k + 1, dp)
      end do
      right(:, 1) = x
      call dgels("N", n, d + 1, 1, matrix, n, right, n, work, size(work), info)
      call check(error, info, 0)
      call fit_trend(x, d, trend, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(trend%legendre - right(:d + 1, 1))), 0.0_dp, thr=tolerance)
   end subroutine test_least_squares

   !> Offset 2^40 and scale 2^-50: exact for multiples of 1/1024.
   subroutine test_offset_scale()
      type(trend_type) :: a, b
      real(dp), allocatable :: x(:), y(:)

      x = anint(1024.0_dp*reference_series("rw", 9000))/1024.0_dp
      y = (x + 2.0_dp**40)*2.0_dp**(-50)
      call fit_trend(x, 3, a, problem)
      call fit_trend(y, 3, b, problem)
      if (went_wrong(problem)) return
      call remove_trend(a, x)
      call remove_trend(b, y)
      call check(error, maxval(abs(y*2.0_dp**50 - x))/maxval(abs(x)), 0.0_dp, thr=tolerance)
   end subroutine test_offset_scale

   !> 1e6 + 1e-3 noise: what is left has the digits of the noise and the mean 0.
   subroutine test_large_offset()
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)

      x = 1.0e6_dp + 1.0e-3_dp*reference_series("ar1", 20000)
      call fit_trend(x, 2, trend, problem)
      if (went_wrong(problem)) return
      call remove_trend(trend, x)
      call check(error, abs(sum(x))/real(size(x), dp), 0.0_dp, thr=1.0e-17_dp)
   end subroutine test_large_offset

   !> With gaps a polynomial is still its own trend, and the residuals of noise are orthogonal to it.
   subroutine test_missing()
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer(int64) :: i, n
      integer :: j

      n = 20000
      do j = 1, 2
         valid = merge(0_int8, 1_int8, reference_series("unif", int(n)) < merge(0.05_dp, 0.8_dp, j == 1))
         valid(5000:9000) = 0_int8
         x = [(merge(polynomial(5, i, n), 1.0e9_dp, valid(i + 1) == 1_int8), i = 0, n - 1)]
         call fit_trend(x, 5, trend, problem, valid)
         if (went_wrong(problem)) return
         call check(error, evaluate_trend(trend, 7000_int64), polynomial(5, 7000_int64, n), thr=tolerance, rel=.true.)
         x = merge(reference_series("rw", int(n)), 0.0_dp, valid == 1_int8)
         call fit_trend(x, 3, trend, problem, valid)
         call remove_trend(trend, x)
         do i = 0, 3
            call check(error, abs(sum(x*[(real(2*j - n, dp)/real(n, dp), j = 0, int(n - 1))]**int(i), mask=valid == 1_int8)), &
               & 0.0_dp, thr=1.0e-9_dp)
         end do
      end do
   end subroutine test_missing

   !> Present only among the last 300 of 30 000 samples: the fit is good there.
   subroutine test_one_end_present()
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer(int64) :: i, n

      n = 30000
      allocate (valid(n), source=0_int8)
      valid(29701:29990:3) = 1_int8
      x = [(polynomial(3, i, n), i = 0, n - 1)]
      call fit_trend(x, 3, trend, problem, valid)
      if (went_wrong(problem)) return
      call check(error, evaluate_trend(trend, 29800_int64), x(29801), thr=tolerance, rel=.true.)
   end subroutine test_one_end_present

   !> One and two threads give the same bits.
   subroutine test_threads()
      type(trend_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before

      x = reference_series("ar1", 70000)
      before = thread_count()
      call set_thread_count(1)
      call fit_trend(x, 3, a, problem)
      call set_thread_count(2)
      call fit_trend(x, 3, b, problem)
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(a%legendre - b%legendre)), 0.0_dp, thr=tiny(x))
   end subroutine test_threads

   !> Degree -1 does nothing; a series of one sample has a mean.
   subroutine test_no_trend()
      type(trend_type) :: trend
      real(dp) :: x(1)

      x = 5.0_dp
      call fit_trend(x, -1, trend, problem)
      if (went_wrong(problem, "degree -1 failed")) return
      call remove_trend(trend, x)
      call check(error, x(1), 5.0_dp, thr=tiny(x))
      call check(error, evaluate_trend(trend, 0_int64), 0.0_dp, thr=tiny(x))
      call fit_trend(x, 0, trend, problem)
      if (went_wrong(problem, "one sample failed")) return
      call check(error, trend%power(0), 5.0_dp, thr=tiny(x))
   end subroutine test_no_trend

   !> Each error.
   subroutine test_failures()
      type(trend_type) :: trend
      real(dp) :: x(4)
      integer(int8) :: valid(4)

      x = 1.0_dp
      valid = [1_int8, 0_int8, 0_int8, 1_int8]
      call fit_trend(x, 10, trend, problem)
      call check_refused(problem, status%invalid_argument)
      call fit_trend(x, -2, trend, problem)
      call check_refused(problem, status%invalid_argument)
      call fit_trend(x, 4, trend, problem)
      call check_refused(problem, status%too_few_samples)
      call fit_trend(x, 2, trend, problem, valid)
      call check_refused(problem, status%too_few_samples)
      call fit_trend(x, 1, trend, problem, valid(:3))
      call check_refused(problem, status%invalid_argument)
      x(2) = ieee_value(x(2), ieee_quiet_nan)
      call fit_trend(x, 1, trend, problem)
      call check_refused(problem, status%non_finite)
   end subroutine test_failures

end module test_trend
