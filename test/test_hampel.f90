! SPDX-License-Identifier: MIT
!> Tests of the Hampel filter and of the sorted window beneath it.
module test_hampel
   use expectations, only : problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_preprocess_local_outliers, only : largest_half_width, least_present, mark_hampel
   use gyroakf_preprocess_truncation, only : hampel_share
   use series_library, only : reference_series
   implicit none (type, external)
   private
   public :: suite_hampel

contains

   subroutine suite_hampel()
      call test("by_hand", test_by_hand)
      call test("brute_force", test_brute_force)
      call test("long_windows", test_long_windows)
      call test("gaps", test_gaps)
      call test("few_present", test_few_present)
      call test("level", test_level)
      call test("quantized", test_quantized)
      call test("offset_scale", test_offset_scale)
      call test("false_alarms", test_false_alarms)
      call test("cleaning", test_cleaning)
      call test("failures", test_failures)
   end subroutine suite_hampel

   !> 1.4826 MAD of all present samples i-k .. i+k, by sorting: whether i stands out.
   function stands_out(x, i, k, threshold, floor, valid) result(out)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: i, k
      real(dp), intent(in) :: threshold, floor
      integer(int8), intent(in) :: valid(:)
      logical :: out
      real(dp), allocatable :: w(:)
      real(dp) :: median

      w = pack(x(max(1, i - k):min(size(x), i + k)), valid(max(1, i - k):min(size(x), i + k)) /= 0_int8)
      out = .false.
      if (size(w) < min(k + 1, least_present)) return
      median = middle(w)
      w = abs(w - median)
      out = abs(x(i) - median) > threshold*max(1.4826022185056018_dp*middle(w), floor)
   end function stands_out

   !> Median by sorting.
   function middle(x) result(median)
      real(dp), intent(in) :: x(:)
      real(dp) :: median, w(size(x)), held
      integer :: i, j

      w = x
      do i = 2, size(w)
         held = w(i)
         do j = i - 1, 1, -1
            if (w(j) <= held) exit
            w(j + 1) = w(j)
         end do
         w(j + 1) = held
      end do
      median = w((size(w) + 1)/2)
      if (mod(size(w), 2) == 0) median = 0.5_dp*median + 0.5_dp*w(size(w)/2 + 1)
   end function middle

   !> Fails unless the marks are those of the sorted windows, at every sample.
   subroutine compare(x, k, threshold, floor, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: k
      real(dp), intent(in) :: threshold, floor
      integer(int8), intent(in), contiguous :: valid(:)
      integer(int8) :: mark(size(x))
      integer(int64) :: changed, removed
      integer :: i
      character(40) :: where_it_is

      mark = valid
      call mark_hampel(x, k, threshold, floor, .false., mark, changed, removed, problem, valid)
      if (went_wrong(problem)) return
      do i = 1, size(x)
         if (valid(i) == 0_int8) cycle
         if ((mark(i) == 0_int8) .eqv. stands_out(x, i, k, threshold, floor, valid)) cycle
         write (where_it_is, "(a, i0, a, i0)") "sample ", i, ", half-width ", k
         call check(error, .false., where_it_is)
         return
      end do
      call check(error, removed == count(mark == 0_int8 .and. valid /= 0_int8) .and. removed == changed, "counts")
   end subroutine compare

   !> 1 2 1 9 2 1 2 1 2 8 1, k = 2: the 9 has neighbors 2 1 2 1, median 2, MAD 1; the 8 those of 1 2 8 1, cut at the end.
   subroutine test_by_hand()
      integer(int8) :: mark(11)
      integer(int64) :: changed, removed

      mark = 1_int8
      call mark_hampel([1.0_dp, 2.0_dp, 1.0_dp, 9.0_dp, 2.0_dp, 1.0_dp, 2.0_dp, 1.0_dp, 2.0_dp, 8.0_dp, 1.0_dp], 2, 3.0_dp, &
         & 0.0_dp, .false., mark, changed, removed, problem)
      if (went_wrong(problem)) return
      call check(error, all((mark == 0_int8) .eqv. [.false., .false., .false., .true., .false., .false., .false., .false., &
         & .false., .true., .false.]), "other marks")
      call check(error, changed == 2 .and. removed == 2, "counts")
   end subroutine test_by_hand

   !> Every window of short series, most of them cut at an end, with and without ties.
   subroutine test_brute_force()
      character(4), parameter :: name(3) = [character(4) :: "wn", "ar1", "rw"]
      integer, parameter :: half_width(7) = [1, 2, 3, 6, 10, 33, 200]
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(150)
      integer :: i, j, n

      valid = 1_int8
      do j = 1, size(name)
         x = reference_series(trim(name(j)), 150)
         do i = 1, size(half_width)
            n = merge(150, 7 + 3*i, j < 3)
            call compare(x(:n), half_width(i), 2.0_dp, 0.0_dp, valid(:n))
            call compare(anint(2.0_dp*x(:n)), half_width(i), 2.0_dp, 0.0_dp, valid(:n))
            call compare(anint(x(:n)), half_width(i), 1.0_dp, 0.5_dp, valid(:n))
         end do
      end do
   end subroutine test_brute_force

   !> Beyond a stretch, and threaded: 70,000 samples, compared at some hundred of them, seams of stretches among them.
   subroutine test_long_windows()
      integer, parameter :: n = 70000, half_width(3) = [5, 60, 700]
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: mark(:), valid(:)
      integer(int64) :: changed, removed
      integer :: i, j

      x = reference_series("wn", n)
      x(::50) = 4.0_dp*x(::50)
      allocate (mark(n), source=1_int8)
      allocate (valid(n), source=1_int8)
      do j = 1, size(half_width)
         call mark_hampel(x, half_width(j), 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem)
         do i = 1, n, merge(1000, 10, j == 3)
            call check(error, (mark(i) == 0_int8) .eqv. stands_out(x, i, half_width(j), 3.0_dp, 0.0_dp, valid), "within")
         end do
         do i = 16384 - 3, 16384 + 3
            call check(error, (mark(i) == 0_int8) .eqv. stands_out(x, i, half_width(j), 3.0_dp, 0.0_dp, valid), "at a seam")
         end do
      end do
   end subroutine test_long_windows

   !> Missing samples, also at the ends and whole windows of them; what they hold does not matter.
   subroutine test_gaps()
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: k

      x = reference_series("wn", 400)
      valid = merge(0_int8, 1_int8, reference_series("unif", 400) < -0.2_dp)
      valid(1:3) = 0_int8
      valid(100:140) = 0_int8
      valid(399:400) = 0_int8
      where (valid == 0_int8) x = 1.0e300_dp
      do k = 1, 61, 6
         call compare(x, k, 2.0_dp, 0.0_dp, valid)
      end do
   end subroutine test_gaps

   !> With fewer than 11 present in its window a sample is not judged, however far off it is.
   subroutine test_few_present()
      real(dp) :: x(41)
      integer(int8) :: valid(41), mark(41)
      integer(int64) :: changed, removed

      x = reference_series("wn", 41)
      x(21) = 1.0e6_dp
      valid = 0_int8
      valid(17:26) = 1_int8
      mark = valid
      call mark_hampel(x, 20, 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem, valid)
      call check(error, int(removed), 0, "10 present")
      valid(30) = 1_int8
      mark = valid
      call mark_hampel(x, 20, 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem, valid)
      call check(error, mark(21) == 0_int8, "11 present")
   end subroutine test_few_present

   !> A level: nothing stands out, with MAD 0 anything else does, unless the floor covers it.
   subroutine test_level()
      real(dp) :: x(200)
      integer(int8) :: mark(200)
      integer(int64) :: changed, removed

      x = 17.3_dp
      mark = 1_int8
      call mark_hampel(x, 7, 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem)
      call check(error, int(removed), 0, "a level")
      x(50) = 17.4_dp
      call mark_hampel(x, 7, 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem)
      call check(error, removed == 1 .and. mark(50) == 0_int8, "one off the level")
      call mark_hampel(x, 7, 3.0_dp, 0.05_dp, .false., mark, changed, removed, problem)
      call check(error, removed == 0 .and. changed == 1, "within the floor")
   end subroutine test_level

   !> Counts 0 and 1, one in nine a 1, so that every MAD is 0: none is an outlier, neither by hampel nor by any other rule.
   subroutine test_quantized()
      character(6), parameter :: method(4) = [character(6) :: "hampel", "auto", "pauta", "mad"]
      real(dp), allocatable :: x(:), cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result
      integer :: i, j

      allocate (x(5000), source=0.0_dp)
      do j = 1, 2
         x(9::merge(9, 200, j == 1)) = 1.0_dp
         do i = 1, size(method)
            call clean_series(0.1_dp*x, clean_options(degree=0, method=method(i)), cleaned, mask, result, problem)
            if (went_wrong(problem)) return
            call check(error, int(result%removed), 0, trim(method(i))//" marks counts")
         end do
         x = 0.0_dp
      end do
      x(700) = 1.0_dp
      do i = 1, size(method)
         call clean_series(x, clean_options(degree=0, method=method(i)), cleaned, mask, result, problem)
         call check(error, int(result%removed), 1, trim(method(i))//" misses the only glitch of a dead sensor")
      end do
   end subroutine test_quantized

   !> Offset 1e6 with noise of 1e-3, and a scale of a power of two, change no mark.
   subroutine test_offset_scale()
      real(dp), allocatable :: x(:)
      integer(int8) :: mark(5000, 3)
      integer(int64) :: changed, removed(3)

      x = 2.0_dp**(-30)*anint(2.0_dp**20*reference_series("ar1", 5000))
      mark = 1_int8
      call mark_hampel(x, 25, 3.0_dp, 0.0_dp, .false., mark(:, 1), changed, removed(1), problem)
      call mark_hampel(x + 2.0_dp**20, 25, 3.0_dp, 0.0_dp, .false., mark(:, 2), changed, removed(2), problem)
      call mark_hampel(-2.0_dp**40*x, 25, 3.0_dp, 0.0_dp, .false., mark(:, 3), changed, removed(3), problem)
      call check(error, removed(1) > 10 .and. all(mark(:, 1) == mark(:, 2)), "offset")
      call check(error, all(mark(:, 1) == mark(:, 3)), "scale")
   end subroutine test_offset_scale

   !> The share that is stated against that of 2e5 samples, to 4 of its standard errors and the 5 % that it promises; marks of
   !> neighbors hang together, which doubles the variance.
   subroutine test_false_alarms()
      integer, parameter :: n = 200000, half_width(4) = [2, 3, 10, 25]
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: mark(:)
      integer(int64) :: changed, removed
      real(dp) :: expected
      integer :: i

      x = reference_series("wn_bm", n)
      allocate (mark(n), source=1_int8)
      do i = 1, size(half_width)
         call mark_hampel(x, half_width(i), 3.0_dp, 0.0_dp, .false., mark, changed, removed, problem)
         expected = n*hampel_share(half_width(i), 3.0_dp)
         call check(error, real(removed, dp), expected, thr=0.05_dp*expected + 4.0_dp*sqrt(2.0_dp*expected))
      end do
   end subroutine test_false_alarms

   !> As a method: spikes on a cubic drift whose scatter grows are found where Pauta's rule misses those of the quiet part.
   subroutine test_cleaning()
      integer, parameter :: n = 6000, place(4) = [1, 300, 301, 6000]
      real(dp), allocatable :: x(:), cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result
      integer :: i

      x = reference_series("unif", n)
      do i = 1, n
         x(i) = 1.0e-9_dp*real(i - 3000, dp)**3 + 1.0e-4_dp*real(i, dp)*x(i)
      end do
      x(place) = x(place) + [5.0_dp, -3.0_dp, 3.0_dp, 40.0_dp]
      call clean_series(x, clean_options(method="hampel", threshold=6.0_dp), cleaned, mask, result, problem)
      if (went_wrong(problem)) return
      call check(error, all(mask(place) == 0_int8), "missed")
      call check(error, result%half_width == 25 .and. result%removed <= 8 .and. result%converged, "result")
      call check(error, result%corrected_variance, 0.0_dp, thr=tiny(x))
   end subroutine test_cleaning

   !> Windows out of range.
   subroutine test_failures()
      integer, parameter :: half_width(2) = [0, largest_half_width + 1]
      real(dp), allocatable :: cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(clean_type) :: result
      integer :: i

      do i = 1, 2
         call clean_series(spread(0.0_dp, 1, 9), clean_options(method="hampel", half_width=half_width(i)), cleaned, mask, result, &
            & problem)
         call check_refused(problem, status%invalid_argument)
      end do
   end subroutine test_failures

end module test_hampel
