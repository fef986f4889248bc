! SPDX-License-Identifier: MIT
!> Tests of the polynomial trend.
module test_trend
   use expectations, only : check, check_refused
   use gyroakf_threads, only : thread_count, set_thread_count
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_lapack, only : dgels
   use gyroakf_stats_trend, only : trend_type, evaluate_trend, remove_trend
   use gyroakf_stats_trend_fit, only : fit_trend
   use series_library, only : reference_series
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_trend

   !> Relative to the largest value of the polynomial
   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine collect_trend(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("exact_polynomials", test_exact_polynomials), &
         & new_unittest("powers", test_powers), &
         & new_unittest("least_squares", test_least_squares), &
         & new_unittest("offset_scale", test_offset_scale), &
         & new_unittest("large_offset", test_large_offset), &
         & new_unittest("missing", test_missing), &
         & new_unittest("one_end_present", test_one_end_present), &
         & new_unittest("threads", test_threads), &
         & new_unittest("no_trend", test_no_trend), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_trend

   !> 1 2 4: slope 3/2, 7/3 in the middle.
   subroutine test_by_hand(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp) :: x(3)
      type(gyro_error), allocatable :: problem

      x = [1.0_dp, 2.0_dp, 4.0_dp]
      call fit_trend(x, 1, trend, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, maxval(abs(trend%legendre - [7.0_dp/3.0_dp, 1.5_dp])), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(trend%power - [5.0_dp/6.0_dp, 1.5_dp])), 0.0_dp, thr=tolerance)
      call remove_trend(trend, x)
      call check(error, maxval(abs(x - [1.0_dp, -2.0_dp, 1.0_dp]/6.0_dp)), 0.0_dp, thr=tolerance)
      call check(error, evaluate_trend(trend, 4_int64), 5.0_dp/6.0_dp + 6.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> A polynomial of degree d about 1e6, at some samples; d = 0 .. 9.
   pure real(dp) function polynomial(d, i, n) result(p)
      !> Degree
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
   subroutine test_exact_polynomials(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      real(dp) :: scale
      integer(int64) :: i, n
      integer :: d, j
      type(gyro_error), allocatable :: problem

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
            call check(error, .not. allocated(problem), "it failed")
            if (allocated(error)) return
            call check(error, abs(evaluate_trend(trend, n/3) - x(n/3 + 1))/scale, 0.0_dp, thr=tolerance)
            call remove_trend(trend, x)
            call check(error, maxval(abs(x))/scale, 0.0_dp, thr=tolerance)
         end do
      end do
   end subroutine test_exact_polynomials

   !> Coefficients in powers of the sample index, as large as the trends of the paper.
   subroutine test_powers(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: c(0:3) = [2.0e-2_dp, -3.0e-6_dp, 5.0e-10_dp, -1.0e-14_dp]
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer :: i
      type(gyro_error), allocatable :: problem

      allocate (x(12000))
      do i = 1, size(x)
         x(i) = c(0) + real(i - 1, dp)*(c(1) + real(i - 1, dp)*(c(2) + real(i - 1, dp)*c(3)))
      end do
      call fit_trend(x, 3, trend, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      do i = 0, 3
         call check(error, trend%power(i), c(i), thr=tolerance, rel=.true.)
      end do
   end subroutine test_powers

   !> The same least-squares problem by Householder reflections on the Legendre polynomials.
   subroutine test_least_squares(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: n = 700, d = 6
      real(dp) :: x(n), matrix(n, 0:d), right(n, 1), work(1000), t(n)
      type(trend_type) :: trend
      integer :: i, k, info
      type(gyro_error), allocatable :: problem

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
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, maxval(abs(trend%legendre - right(:d + 1, 1))), 0.0_dp, thr=tolerance)
   end subroutine test_least_squares

   !> Offset 2^40 and scale 2^-50: exact for multiples of 1/1024.
   subroutine test_offset_scale(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: a, b
      real(dp), allocatable :: x(:), y(:)
      type(gyro_error), allocatable :: problem

      x = anint(1024.0_dp*reference_series("rw", 9000))/1024.0_dp
      y = (x + 2.0_dp**40)*2.0_dp**(-50)
      call fit_trend(x, 3, a, problem)
      call fit_trend(y, 3, b, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call remove_trend(a, x)
      call remove_trend(b, y)
      call check(error, maxval(abs(y*2.0_dp**50 - x))/maxval(abs(x)), 0.0_dp, thr=tolerance)
   end subroutine test_offset_scale

   !> 1e6 + 1e-3 noise: what is left has the digits of the noise and the mean 0.
   subroutine test_large_offset(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      type(gyro_error), allocatable :: problem

      x = 1.0e6_dp + 1.0e-3_dp*reference_series("ar1", 20000)
      call fit_trend(x, 2, trend, problem)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call remove_trend(trend, x)
      call check(error, abs(sum(x))/real(size(x), dp), 0.0_dp, thr=1.0e-17_dp)
   end subroutine test_large_offset

   !> With gaps a polynomial is still its own trend, and the residuals of noise are orthogonal to it.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer(int64) :: i, n
      integer :: j
      type(gyro_error), allocatable :: problem

      n = 20000
      do j = 1, 2
         valid = merge(0_int8, 1_int8, reference_series("unif", int(n)) < merge(0.05_dp, 0.8_dp, j == 1))
         valid(5000:9000) = 0_int8
         x = [(merge(polynomial(5, i, n), 1.0e9_dp, valid(i + 1) == 1_int8), i = 0, n - 1)]
         call fit_trend(x, 5, trend, problem, valid)
         call check(error, .not. allocated(problem), "it failed")
         if (allocated(error)) return
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
   subroutine test_one_end_present(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer(int64) :: i, n
      type(gyro_error), allocatable :: problem

      n = 30000
      allocate (valid(n), source=0_int8)
      valid(29701:29990:3) = 1_int8
      x = [(polynomial(3, i, n), i = 0, n - 1)]
      call fit_trend(x, 3, trend, problem, valid)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, evaluate_trend(trend, 29800_int64), x(29801), thr=tolerance, rel=.true.)
   end subroutine test_one_end_present

   !> One and two threads give the same bits.
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before
      type(gyro_error), allocatable :: problem

      x = reference_series("ar1", 70000)
      before = thread_count()
      call set_thread_count(1)
      call fit_trend(x, 3, a, problem)
      call set_thread_count(2)
      call fit_trend(x, 3, b, problem)
      call set_thread_count(before)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, maxval(abs(a%legendre - b%legendre)), 0.0_dp, thr=tiny(x))
   end subroutine test_threads

   !> Degree -1 does nothing; a series of one sample has a mean.
   subroutine test_no_trend(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp) :: x(1)
      type(gyro_error), allocatable :: problem

      x = 5.0_dp
      call fit_trend(x, -1, trend, problem)
      call check(error, .not. allocated(problem), "degree -1 failed")
      if (allocated(error)) return
      call remove_trend(trend, x)
      call check(error, x(1), 5.0_dp, thr=tiny(x))
      call check(error, evaluate_trend(trend, 0_int64), 0.0_dp, thr=tiny(x))
      call fit_trend(x, 0, trend, problem)
      call check(error, .not. allocated(problem), "one sample failed")
      if (allocated(error)) return
      call check(error, trend%power(0), 5.0_dp, thr=tiny(x))
   end subroutine test_no_trend

   !> Each error.
   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error
      type(trend_type) :: trend
      real(dp) :: x(4)
      integer(int8) :: valid(4)
      type(gyro_error), allocatable :: problem

      x = 1.0_dp
      valid = [1_int8, 0_int8, 0_int8, 1_int8]
      call fit_trend(x, 10, trend, problem)
      call check_refused(error, problem, status%invalid_argument)
      call fit_trend(x, -2, trend, problem)
      call check_refused(error, problem, status%invalid_argument)
      call fit_trend(x, 4, trend, problem)
      call check_refused(error, problem, status%too_few_samples)
      call fit_trend(x, 2, trend, problem, valid)
      call check_refused(error, problem, status%too_few_samples)
      call fit_trend(x, 1, trend, problem, valid(:3))
      call check_refused(error, problem, status%invalid_argument)
      x(2) = ieee_value(x(2), ieee_quiet_nan)
      call fit_trend(x, 1, trend, problem)
      call check_refused(error, problem, status%non_finite)
   end subroutine test_failures

end module test_trend
