! SPDX-License-Identifier: MIT
!> Tests of the outlier rules and of the order statistics beneath them.
module test_outliers
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_preprocess_outlier_rules, only : check_method, default_threshold, mark_outliers, &
      & robust_center
   use gyroakf_stats_extremes, only : scan_extremes
   use gyroakf_select, only : find_deviation, find_median
   use series_library, only : reference_series
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_outliers

   real(dp), parameter :: tolerance = 1.0e-14_dp

contains

   subroutine suite_outliers()
      call test("median_by_hand", test_median_by_hand)
      call test("median_sorted", test_median_sorted)
      call test("median_missing", test_median_missing)
      call test("median_by_sample", test_median_by_sample)
      call test("deviation", test_deviation)
      call test("thresholds", test_thresholds)
      call test("robust", test_robust)
      call test("step", test_step)
      call test("marks", test_marks)
      call test("failures", test_failures)
   end subroutine suite_outliers

   !> Odd, even, ties, both zeros, all negative, one, huge and tiny.
   subroutine test_median_by_hand()
      call middle_is([3.0_dp, -1.0_dp, 2.0_dp], 2.0_dp)
      call middle_is([3.0_dp, -1.0_dp, 2.0_dp, -0.0_dp], 1.0_dp)
      call middle_is([5.0_dp, 2.0_dp, 2.0_dp, 2.0_dp, 9.0_dp, 1.0_dp], 2.0_dp)
      call middle_is([-0.0_dp, 0.0_dp], 0.0_dp)
      call middle_is([-3.0_dp, -1.0_dp, -2.0_dp, -9.0_dp], -2.5_dp)
      call middle_is([7.0_dp], 7.0_dp)
      call middle_is([huge(1.0_dp), -huge(1.0_dp), tiny(1.0_dp)], tiny(1.0_dp))
      call middle_is([huge(1.0_dp), huge(1.0_dp)], huge(1.0_dp))
   end subroutine test_median_by_hand

   !> Checks one median.
   subroutine middle_is(x, expected)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: expected
      real(dp) :: median

      call find_median(x, median, problem)
      if (went_wrong(problem)) return
      call check(error, median, expected, thr=tiny(median))
   end subroutine middle_is

   !> Rank by counting, for every length to 60 and one that is threaded.
   subroutine test_median_sorted()
      real(dp), allocatable :: x(:)
      real(dp) :: median
      integer :: n, i

      do i = 1, 61
         n = merge(70001, i, i == 61)
         x = reference_series("wn", n)
         if (mod(i, 3) == 0) x = anint(x)
         call find_median(x, median, problem)
         if (went_wrong(problem)) return
         call check(error, 2*count(x < median) <= n .and. 2*count(x > median) <= n, "not in the middle")
         if (mod(n, 2) == 1) then
            call check(error, any(abs(x - median) <= 0.0_dp), "not one of the numbers")
         else
            call check(error, abs(0.5_dp*(minval(x, mask=x >= median) + maxval(x, mask=x <= median)) - median) &
               & <= epsilon(median), "not halfway")
         end if
         if (allocated(error)) return
      end do
   end subroutine test_median_sorted

   !> Missing samples do not count.
   subroutine test_median_missing()
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      real(dp) :: a, b

      x = reference_series("ar1", 5001)
      allocate (valid(size(x)), source=1_int8)
      valid(1::3) = 0_int8
      call find_median(pack(x, valid == 1_int8), a, problem)
      where (valid == 0_int8) x = -1.0e10_dp
      call find_median(x, b, problem, valid)
      call check(error, a, b, thr=tiny(a))
      valid = 0_int8
      call find_median(x, b, problem, valid)
      call check_refused(problem, status%too_few_samples)
   end subroutine test_median_missing

   !> A length at which a sample brackets the middle: uniform, with ties, all but one the same, and with a period that a sample at
   !> even distances would see only one number of; the rank by counting.
   subroutine test_median_by_sample()
      integer, parameter :: n = 600001
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      real(dp) :: median, deviation
      integer :: i, j, half

      allocate (valid(n), source=1_int8)
      do j = 1, 4
         x = reference_series("unif", n)
         if (j == 2) x = anint(3.0_dp*x)
         do i = 1, n
            if (j == 3) x(i) = merge(1.0_dp, 7.0_dp, i == 5)
            if (j == 4) x(i) = 1.0e-6_dp*x(i) + real(mod(i, n/65536), dp)
         end do
         if (j > 2) valid(::3) = 0_int8
         half = count(valid /= 0_int8)/2
         call find_median(x, median, problem, valid)
         if (went_wrong(problem)) return
         call check(error, count(x < median .and. valid == 1) <= half .and. count(x > median .and. valid == 1) <= half, "median")
         call find_deviation(x, median, deviation, problem, valid)
         x = abs(x - median)
         call check(error, count(x < deviation .and. valid == 1) <= half .and. count(x > deviation .and. valid == 1) <= half, &
            & "deviation")
      end do
   end subroutine test_median_by_sample

   !> 1 2 4 7 11 about 4: distances 3 2 0 3 7.
   subroutine test_deviation()
      real(dp) :: deviation

      call find_deviation([1.0_dp, 2.0_dp, 4.0_dp, 7.0_dp, 11.0_dp], 4.0_dp, deviation, problem)
      if (went_wrong(problem)) return
      call check(error, deviation, 3.0_dp, thr=tolerance)
   end subroutine test_deviation

   !> The threshold that a tenth of a sample of n normal ones exceeds on average; the others are constants.
   subroutine test_thresholds()
      call check(error, default_threshold("auto", 1_int64), 1.6448536269514729_dp, thr=tolerance)
      call check(error, default_threshold("auto", 12000_int64), 4.456436336205555_dp, thr=tolerance)
      call check(error, default_threshold("auto", 100000000_int64), 6.1094102048693975_dp, thr=tolerance)
      call check(error, default_threshold("pauta", 5_int64), 3.0_dp, thr=tolerance)
      call check(error, default_threshold("mad", 5_int64), 4.5_dp, thr=tolerance)
      call check(error, default_threshold("none", 5_int64), 0.0_dp, thr=tolerance)
   end subroutine test_thresholds

   !> Of normal noise the scale is the standard deviation, to 3 of its errors 1.17/sqrt(n); 20 % of gross
   !> errors move it by a third, not by 1e6.
   subroutine test_robust()
      real(dp), allocatable :: x(:)
      real(dp) :: center, scale

      x = reference_series("wn_bm", 20000)
      call robust_center(x, center, scale, problem)
      if (went_wrong(problem)) return
      call check(error, scale, 1.0_dp, thr=0.025_dp)
      call check(error, center, 0.0_dp, thr=0.027_dp)
      x(1::5) = 1.0e6_dp
      call robust_center(x, center, scale, problem)
      call check(error, scale, 1.3_dp, thr=0.1_dp)
   end subroutine test_robust

   !> Smallest step between neighbors, not over a gap; 0 for a constant.
   subroutine test_step()
      integer(int8) :: valid(5)
      real(dp) :: x(5), low, high, step

      x = [1.0_dp, 1.0_dp, -8.0_dp, -7.75_dp, -5.0_dp]
      call scan_extremes(x, low, high, step)
      call check(error, step, 0.25_dp, thr=tolerance)
      call check(error, max(abs(low), abs(high)), 8.0_dp, thr=tolerance)
      valid = [1_int8, 1_int8, 0_int8, 1_int8, 1_int8]
      call scan_extremes(x, low, high, step, valid)
      call check(error, step, 2.75_dp, thr=tolerance)
      call check(error, max(abs(low), abs(high)), 7.75_dp, thr=tolerance)
      x = 3.0_dp
      call scan_extremes(x, low, high, step)
      call check(error, step, 0.0_dp, thr=tiny(step))
   end subroutine test_step

   !> Strictly beyond the limit is marked, within is unmarked, missing stays.
   subroutine test_marks()
      integer(int8) :: valid(5), inlier(5)
      integer(int64) :: changed, removed

      valid = [1_int8, 1_int8, 1_int8, 0_int8, 1_int8]
      inlier = [1_int8, 0_int8, 0_int8, 0_int8, 1_int8]
      call mark_outliers([5.0_dp, 4.0_dp, -3.0_dp, 9.0_dp, 1.0_dp], 1.0_dp, 3.0_dp, .false., inlier, changed, &
         & removed, valid)
      call check(error, all(inlier == [0_int8, 1_int8, 0_int8, 0_int8, 1_int8]), "marks")
      call check(error, changed == 2 .and. removed == 2, "counts")
      call mark_outliers([1.0_dp, 4.1_dp, 1.0_dp, 9.0_dp, 1.0_dp], 1.0_dp, 3.0_dp, .true., inlier, changed, removed, valid)
      call check(error, all(inlier == [0_int8, 0_int8, 0_int8, 0_int8, 1_int8]), "marks that stay")
      call check(error, changed == 1 .and. removed == 3, "counts of marks that stay")
   end subroutine test_marks

   !> An unknown method; the message names the others.
   subroutine test_failures()
      call check_method("auto", problem)
      if (went_wrong(problem, "auto was refused")) return
      call check_method("sigma", problem)
      call check_refused(problem, status%invalid_argument)
      call check(error, index(problem%message, "hampel") > 0, problem%message)
   end subroutine test_failures

end module test_outliers
