! SPDX-License-Identifier: MIT
!> Tests of the cleaning: outliers and trend jointly.
module test_clean
   use expectations, only : unmet, problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_stats_trend, only : evaluate_trend
   use series_library, only : reference_series
   implicit none (type, external)
   private
   public :: suite_clean

   !> Where the drifting record has its outliers, and their size in standard deviations
   integer, parameter :: place(12) = [1, 77, 1500, 1501, 1502, 3333, 5000, 6001, 7777, 9000, 11998, 12000]
   real(dp), parameter :: size_of(12) = [15.0_dp, -8.0_dp, 9.0_dp, 9.0_dp, 8.0_dp, -30.0_dp, 7.0_dp, -7.0_dp, 1.0e4_dp, &
      & 12.0_dp, -9.0_dp, 20.0_dp]
   !> Of the last cleaning
   real(dp), allocatable :: cleaned(:)
   integer(int8), allocatable :: mask(:)
   type(clean_type) :: result

contains

   subroutine suite_clean()
      call test("pauta_reference", test_pauta_reference)
      call test("drifting_record", test_drifting_record)
      call test("masking", test_masking)
      call test("false_alarms", test_false_alarms)
      call test("mark_comes_back", test_mark_comes_back)
      call test("disturbed_stretch", test_disturbed_stretch)
      call test("to_and_fro", test_to_and_fro)
      call test("offset_scale", test_offset_scale)
      call test("quantized", test_quantized)
      call test("constant", test_constant)
      call test("missing", test_missing)
      call test("nothing_removed", test_nothing_removed)
      call test("short", test_short)
      call test("failures", test_failures)
   end subroutine suite_clean

   !> Fails where the cleaning did, or where it marked other samples than these.
   subroutine marks_are(expected)
      integer, intent(in) :: expected(:)

      if (went_wrong(problem)) return
      if (unmet(int(result%removed), size(expected), "number of outliers")) return
      call check(error, all(result%outlier == int(expected, int64)), "other samples")
      call check(error, result%converged, "not converged")
   end subroutine marks_are

   !> White noise with four outliers, 3 sigma, degree 0. In exact arithmetic the first round removes
   !> 101 102 501 778, the second 156 462 621 756, the third none; standard deviation then 0.9553685748064595.
   subroutine test_pauta_reference()
      real(dp), allocatable :: x(:)

      x = reference_series("wn", 1000)
      x([101, 102, 501, 778]) = x([101, 102, 501, 778]) + [8.0_dp, -7.5_dp, 25.0_dp, 5.0_dp]
      call clean_series(x, clean_options(degree=0, method="pauta"), cleaned, mask, result, problem)
      call marks_are([101, 102, 156, 462, 501, 621, 756, 778])
      call check(error, result%passes, 3)
      call check(error, result%trend%power(0), -0.03429698277755966_dp, thr=1.0e-14_dp)
      call check(error, sqrt(result%variance), 0.9553685748064595_dp, thr=1.0e-14_dp)
      call check(error, result%fraction, 0.008_dp, thr=1.0e-15_dp)
      call check(error, count(mask == 0_int8), 8)
   end subroutine test_pauta_reference

   !> Normal noise, within 4.0 of 4.1 standard deviations, on a cubic drift of 200, twelve outliers.
   function drifting_record() result(x)
      real(dp), allocatable :: x(:)
      real(dp) :: t
      integer :: i

      x = reference_series("wn_bm", 12000)
      do i = 1, size(x)
         t = real(i, dp)/6000.0_dp - 1.0_dp
         x(i) = x(i) + 50.0_dp*t - 30.0_dp*t*t + 80.0_dp*t**3
      end do
      x(place) = x(place) + size_of
   end function drifting_record

   !> 12 of 12 and nothing else, by both robust methods.
   subroutine test_drifting_record()
      real(dp), allocatable :: x(:)

      x = drifting_record()
      call clean_series(x, clean_options(), cleaned, mask, result, problem)
      call marks_are(place)
      call check(error, result%variance, 1.0_dp, thr=0.1_dp)
      call check(error, maxval(abs(cleaned(place))), 0.0_dp, thr=tiny(x))
      call check(error, cleaned(100), x(100) - evaluate_trend(result%trend, 99_int64), thr=1.0e-12_dp)
      call clean_series(x, clean_options(method="mad"), cleaned, mask, result, problem)
      call marks_are(place)
   end subroutine test_drifting_record

   !> A spike of 1e9 hides others from a standard deviation; it does not from a median.
   subroutine test_masking()
      real(dp), allocatable :: x(:)

      x = reference_series("wn", 3000)
      x(2990) = 1.0e9_dp
      x(50) = x(50) + 9.0_dp
      x(51) = x(51) - 9.0_dp
      call clean_series(x, clean_options(), cleaned, mask, result, problem)
      call marks_are([50, 51, 2990])
      call clean_series(x, clean_options(degree=-1, method="mad"), cleaned, mask, result, problem)
      call marks_are([50, 51, 2990])
   end subroutine test_masking

   !> Of 1e5 clean normal samples `auto` marks about half a one, 3 sigma about 300.
   subroutine test_false_alarms()
      real(dp), allocatable :: x(:)

      x = reference_series("wn_bm", 100000)
      call clean_series(x, clean_options(), cleaned, mask, result, problem)
      if (went_wrong(problem)) return
      call check(error, result%removed <= 3 .and. result%converged, "auto marks clean samples")
      call clean_series(x, clean_options(method="pauta"), cleaned, mask, result, problem)
      call check(error, abs(result%fraction - 0.0031_dp) < 0.0008_dp, "share that 3 sigma takes")
   end subroutine test_false_alarms

   !> The spike tilts the first trend, and good samples at the ends are marked; they come back.
   subroutine test_mark_comes_back()
      real(dp), allocatable :: x(:)

      x = reference_series("unif", 400)
      x(400) = 1.0e6_dp
      call clean_series(x, clean_options(degree=9, method="mad", max_passes=1), cleaned, mask, result, problem)
      if (went_wrong(problem)) return
      call check(error, result%removed > 1 .and. .not. result%converged, "the first round was right already")
      call clean_series(x, clean_options(degree=9, method="mad"), cleaned, mask, result, problem)
      call marks_are([400])
   end subroutine test_mark_comes_back

   !> A third of the record is ten times as noisy: that is no outlier. A tenth replaced by zeros is.
   subroutine test_disturbed_stretch()
      real(dp), allocatable :: x(:)

      x = reference_series("wn_bm", 9000)
      x(:3600) = 50.0_dp*x(:3600)
      call clean_series(x, clean_options(), cleaned, mask, result, problem)
      if (went_wrong(problem)) return
      call check(error, result%fraction < 0.01_dp .and. result%converged, "the disturbed stretch was removed")
      x = 50.0_dp + reference_series("wn_bm", 9000)
      x(7::10) = 0.0_dp
      call clean_series(x, clean_options(), cleaned, mask, result, problem)
      call check(error, int(result%removed), count(abs(x) < 1.0_dp))
   end subroutine test_disturbed_stretch

   !> Integers with a heavy tail, on which the marks by median and MAD go to and fro, and those of Hampel's filter: the rounds end.
   subroutine test_to_and_fro()
      character(8), parameter :: method(3) = [character(8) :: "auto", "pauta", "mad"]
      integer, parameter :: half_width(3) = [5, 25, 100000]
      real(dp), allocatable :: x(:)
      integer :: i, j

      x = reference_series("wn_bm", 20000)
      do j = 1, 4
         do i = 1, 3
            call clean_series(anint(x**3*real(j, dp)), clean_options(method=method(i)), cleaned, mask, result, problem)
            if (went_wrong(problem)) return
            call check(error, result%converged, "not converged: "//method(i))
         end do
      end do
      do i = 1, 60                            ! short pieces of a few levels, by a window of 11 samples, of 51, and of all
         j = half_width(1 + mod(i, 3))
         call clean_series(0.125_dp*anint(4.0_dp*x(300*i - 299:300*i)), clean_options(method="hampel", half_width=j, &
            & threshold=2.0_dp, max_passes=400), cleaned, mask, result, problem)
         if (went_wrong(problem)) return
         call check(error, result%converged, "not converged: hampel")
      end do
   end subroutine test_to_and_fro

   !> Offset 2^30 and scale 2^-40, exact for multiples of 1/4096, change no mark.
   subroutine test_offset_scale()
      real(dp), allocatable :: x(:), a(:), b(:)

      x = anint(4096.0_dp*drifting_record())/4096.0_dp
      call clean_series(x, clean_options(), a, mask, result, problem)
      call clean_series((x + 2.0_dp**30)*2.0_dp**(-40), clean_options(), b, mask, result, problem)
      call marks_are(place)
      call check(error, maxval(abs(b*2.0_dp**40 - a)), 0.0_dp, thr=1.0e-10_dp)
   end subroutine test_offset_scale

   !> Nine of ten samples on one level: MAD 0. The neighboring levels stay, the spike goes.
   subroutine test_quantized()
      real(dp), allocatable :: x(:)
      integer :: i

      do i = 1, 2
         x = 0.01_dp*anint(0.304_dp*reference_series("wn_bm", 2000))
         x(1000) = 0.5_dp
         call clean_series(x, clean_options(degree=0, method=merge("mad ", "auto", i == 1)), cleaned, mask, result, problem)
         call marks_are([1000])
      end do
   end subroutine test_quantized

   !> A constant series, at any offset and degree, has no outlier; nor has a straight line.
   subroutine test_constant()
      character(8), parameter :: method(3) = [character(8) :: "auto", "pauta", "mad"]
      real(dp) :: x(500)
      integer :: i, j

      do i = 1, 3
         do j = 1, 2
            x = 123456.1_dp
            if (j == 2) x = [(1234.1_dp + 0.1_dp*real(j, dp), j = 1, 500)]
            call clean_series(x, clean_options(method=method(i)), cleaned, mask, result, problem)
            if (went_wrong(problem)) return
            if (unmet(result%removed == 0 .and. .not. allocated(mask), trim(method(i))//" marks rounding errors")) return
         end do
      end do
   end subroutine test_constant

   !> Samples that were missing before stay missing and are no outliers; what they hold does not matter.
   subroutine test_missing()
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)

      x = drifting_record()
      valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 12000), 5000) < 0.05_dp)
      valid(place) = 1_int8
      where (valid == 0_int8) x = 1.0e5_dp
      call clean_series(x, clean_options(), cleaned, mask, result, problem, valid)
      call marks_are(place)
      call check(error, all(mask == 0_int8 .eqv. (valid == 0_int8 .or. mask /= valid)), "the mask")
      call check(error, count(mask == 0_int8), count(valid == 0_int8) + 12)
      call check(error, maxval(abs(cleaned), mask=mask == 0_int8), 0.0_dp, thr=tiny(x))
      call check(error, abs(result%mean) < 0.01_dp .and. abs(result%variance - 1.0_dp) < 0.1_dp, "mean or variance")
      call clean_series(x, clean_options(method="none"), cleaned, mask, result, problem, valid)
      call check(error, count(mask /= valid), 0)
   end subroutine test_missing

   !> Method none and degree -1: the series itself, no mask.
   subroutine test_nothing_removed()
      real(dp), allocatable :: x(:)

      x = reference_series("offset", 1000)
      call clean_series(x, clean_options(degree=-1, method="none"), cleaned, mask, result, problem)
      if (unmet(.not. (allocated(problem) .or. allocated(mask)), "it failed")) return
      call check(error, maxval(abs(cleaned - x)), 0.0_dp, thr=tiny(x))
      if (unmet(result%passes == 0 .and. size(result%outlier) == 0 .and. result%removed == 0, "something was removed")) return
      call check(error, result%mean, 9999.999911678937_dp, thr=1.0e-15_dp, rel=.true.)
   end subroutine test_nothing_removed

   !> Ten samples: 3 standard deviations are out of reach ((n-1)/sqrt(n) = 2.85), eleven suffice.
   subroutine test_short()
      real(dp) :: x(11)

      x = 0.0_dp
      x(5) = 1.0_dp
      call clean_series(x(:10), clean_options(degree=0, method="pauta"), cleaned, mask, result, problem)
      if (unmet(.not. allocated(problem) .and. result%removed == 0, "10 samples")) return
      call clean_series(x, clean_options(degree=0, method="pauta"), cleaned, mask, result, problem)
      call marks_are([5])
   end subroutine test_short

   !> Each error.
   subroutine test_failures()
      real(dp) :: x(4)
      integer(int8) :: valid(4)

      x = [1.0_dp, 2.0_dp, 1.0_dp, 3.0_dp]
      valid = 0_int8
      call refused(x, clean_options(method="hampel", half_width=0), status%invalid_argument)
      call refused(x, clean_options(method="best"), status%invalid_argument)
      call refused(x, clean_options(threshold=-1.0_dp), status%invalid_argument)
      call refused(x, clean_options(max_passes=0), status%invalid_argument)
      call refused(x, clean_options(degree=10), status%invalid_argument)
      call refused(x, clean_options(degree=4), status%too_few_samples)
      call refused(x, clean_options(), status%too_few_samples, valid)
      call refused(x, clean_options(), status%invalid_argument, valid(:2))
   end subroutine test_failures

   !> Fails unless the cleaning is refused with the code.
   subroutine refused(x, options, code, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(clean_options), intent(in) :: options
      integer, intent(in) :: code
      integer(int8), intent(in), optional :: valid(:)

      call clean_series(x, options, cleaned, mask, result, problem, valid)
      call check_refused(problem, code)
   end subroutine refused

end module test_clean
