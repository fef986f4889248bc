! SPDX-License-Identifier: MIT
!> Tests of what a rule does to a record without outliers.
module test_truncation
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_preprocess_outlier_rules, only : default_threshold
   use gyroakf_preprocess_truncation, only : expected_false_alarms, final_cut, hampel_share, &
      & truncated_deviation
   use series_library, only : reference_series
   use expectations, only : problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_truncation

   real(dp), parameter :: tolerance = 1.0e-14_dp

contains

   subroutine suite_truncation()
      call test("deviation", test_deviation)
      call test("cut", test_cut)
      call test("shares", test_shares)
      call test("single_pass", test_single_pass)
      call test("corrected", test_corrected)
      call test("few_samples", test_few_samples)
      call test("invariance", test_invariance)
   end subroutine suite_truncation

   !> sqrt(1 - 2 t phi(t)/(2 Phi(t) - 1)); the published 0.98657839 at 3, its limits t/sqrt(3) and 1, no seam at 1.
   subroutine test_deviation()
      call check(error, truncated_deviation(3.0_dp), 0.98657839_dp, thr=0.5e-8_dp)
      call check(error, truncated_deviation(1.0_dp - 1.0e-14_dp), truncated_deviation(1.0_dp), thr=2.0e-14_dp)
      call check(error, truncated_deviation(1.0e-8_dp)/1.0e-8_dp, 1.0_dp/sqrt(3.0_dp), thr=tolerance)
      call check(error, truncated_deviation(40.0_dp), 1.0_dp, thr=tolerance)
      call check(error, truncated_deviation(0.0_dp), 0.0_dp, thr=tolerance)
   end subroutine test_deviation

   !> The published 0.98484619 and 0.31314 % of repeated passes; the first is single; below sqrt(3) nothing is left.
   subroutine test_cut()
      real(dp) :: t

      t = final_cut(3.0_dp, 0)
      call check(error, truncated_deviation(t), 0.98484619_dp, thr=0.5e-8_dp)
      call check(error, t, 3.0_dp*truncated_deviation(t), thr=tolerance)
      call check(error, erfc(t/sqrt(2.0_dp)), 0.0031314_dp, thr=0.5e-7_dp)
      call check(error, final_cut(3.0_dp, 1), 3.0_dp, thr=tolerance)
      call check(error, final_cut(3.0_dp, 2), 3.0_dp*truncated_deviation(3.0_dp), thr=tolerance)
      call check(error, final_cut(1.7_dp, 0), 0.0_dp, thr=tolerance)
   end subroutine test_cut

   !> 0.26998 % of one pass; a tenth of a sample by the threshold for the length; Hampel's shares as simulated once, to 5 %.
   subroutine test_shares()
      real(dp) :: n

      n = expected_false_alarms("pauta", 3.0_dp, 100000000_int64, 1, 0)
      call check(error, n, 269979.6_dp, thr=0.1_dp)
      n = expected_false_alarms("auto", default_threshold("auto", 12000_int64), 12000_int64, 1, 0)
      call check(error, n, 0.1_dp, thr=1.0e-11_dp)
      call check(error, expected_false_alarms("pauta", 3.0_dp, 10_int64, 1, 0), 0.0_dp, thr=tolerance)
      call check(error, expected_false_alarms("none", 3.0_dp, 1000_int64, 1, 0), 0.0_dp, thr=tolerance)
      call check(error, all(abs(hampel_share([3, 10, 25, 100], 3.0_dp)/[0.04775_dp, 0.01449_dp, 0.0066_dp, 0.0036_dp] - 1.0_dp) &
         & < 0.05_dp), "shares of hampel, 3 sigma")
      call check(error, all(abs(hampel_share([3, 10], 5.0_dp)/[0.01416_dp, 0.00085_dp] - 1.0_dp) < 0.05_dp), "5 sigma")
      call check(error, hampel_share(100000, 3.0_dp), erfc(3.0_dp/sqrt(2.0_dp)), thr=1.0e-6_dp)
   end subroutine test_shares

   !> White noise with four outliers of 8, -7.5, 25 and 5: one pass of 3 sigma about the mean 0.0037005521236921426 with the
   !> standard deviation 1.336484094041568 marks these alone, two passes four more.
   subroutine test_single_pass()
      integer, parameter :: place(8) = [101, 102, 501, 778, 156, 462, 621, 756]
      real(dp), allocatable :: x(:), cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result

      x = reference_series("wn", 1000)
      x(place(:4)) = x(place(:4)) + [8.0_dp, -7.5_dp, 25.0_dp, 5.0_dp]
      call clean_series(x, clean_options(degree=-1, method="pauta", max_passes=1), cleaned, mask, result, problem)
      if (went_wrong(problem)) return
      call check(error, result%removed == 4 .and. all(mask(place(:4)) == 0_int8) .and. result%passes == 1, "the first pass")
      call check(error, result%mean, -0.028025699939714172_dp, thr=tolerance)
      call check(error, sqrt(result%variance), 0.9737937446090932_dp, thr=tolerance)
      call check(error, result%corrected_variance, result%variance/truncated_deviation(3.0_dp)**2, thr=tolerance)
      call clean_series(x, clean_options(degree=-1, method="pauta", max_passes=2), cleaned, mask, result, problem)
      call check(error, result%removed == 8 .and. all(mask(place) == 0_int8) .and. .not. result%converged, "the second pass")
      call check(error, result%mean, -0.03429698277755966_dp, thr=tolerance)
   end subroutine test_single_pass

   !> Of 2e5 normal samples of variance 1 the corrected variance is the whole one's, to 3 of its errors
   !> sqrt(2/n); the plain one is not.
   subroutine test_corrected()
      integer, parameter :: n = 200000, rounds(2) = [1, 20]
      real(dp), parameter :: threshold(2) = [3.0_dp, 2.5_dp], three_errors = 3.0_dp*sqrt(2.0_dp/real(n, dp))
      real(dp), allocatable :: x(:), cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result
      real(dp) :: whole
      integer :: i, j

      x = reference_series("wn_bm", n)
      whole = sum((x - sum(x)/n)**2)/(n - 1)
      do i = 1, size(rounds)
         do j = 1, size(threshold)
            call clean_series(x, clean_options(-1, "pauta", threshold(j), rounds(i)), cleaned, mask, result, problem)
            call check(error, result%corrected_variance, whole, thr=three_errors)
            call check(error, abs(result%variance - whole) > three_errors, "no correction was needed")
            call check(error, real(result%removed, dp), result%expected, thr=4.0_dp*sqrt(result%expected))
         end do
      end do
   end subroutine test_corrected

   !> 3 sigma can reject nothing of ten samples; of eleven it can.
   subroutine test_few_samples()
      real(dp) :: x(11)
      real(dp), allocatable :: cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result
      integer :: n

      x = 0.0_dp
      x(4) = 1.0e9_dp
      do n = 2, 11
         call clean_series(x(:n), clean_options(degree=-1, method="pauta"), cleaned, mask, result, problem)
         if (went_wrong(problem)) return
         call check(error, int(result%removed), merge(1, 0, n == 11), "removed")
      end do
   end subroutine test_few_samples

   !> No rule's marks change with an offset of 2^20 on noise of 2^-10, or with the scale.
   subroutine test_invariance()
      character(6), parameter :: method(4) = [character(6) :: "hampel", "auto", "pauta", "mad"]
      real(dp), allocatable :: x(:), cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: a, b
      integer :: i

      x = reference_series("ar1", 4000)
      x(::500) = 8.0_dp*x(::500)
      x = 2.0_dp**(-30)*anint(2.0_dp**20*x)
      do i = 1, size(method)
         call clean_series(x, clean_options(degree=2, method=method(i)), cleaned, mask, a, problem)
         call clean_series(2.0_dp**10*(x + 2.0_dp**20), clean_options(degree=2, method=method(i)), cleaned, mask, b, problem)
         call check(error, a%removed > 1 .and. a%removed == b%removed, "other numbers: "//method(i))
         call check(error, all(a%outlier == b%outlier), "other samples: "//method(i))
         call check(error, b%corrected_variance, 2.0_dp**20*a%corrected_variance, thr=1.0e-7_dp*b%corrected_variance + tolerance)
      end do
   end subroutine test_invariance

end module test_truncation
