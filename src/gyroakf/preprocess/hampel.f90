! SPDX-License-Identifier: MIT
!> The Hampel filter: each sample is judged by the median and the MAD of its neighbourhood.
!>
!> The window of sample i is i-k .. i+k as far as the record goes: at its ends the windows are cut off and the samples there are
!> judged like all others (as by MATLAB's `hampel`). Missing samples are skipped: a window has those of its 2k+1 samples that
!> are there. Where these are fewer than k + 1 and fewer than [[least_present]], the sample is not judged.
!>
!> Cost: O(log k) searches and one shift of at most 16k bytes a sample. The record is cut into stretches that the threads
!> share; each sample's window is exact, so the marks depend neither on the threads nor on the stretches.
!>
!> Source: Hampel, J. Amer. Stat. Assoc. 69 (1974) 383-393; Pearson et al., EURASIP J. Adv. Signal Process. 2016:87.
module gyroakf_preprocess_hampel
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_preprocess_window, only : window_type, insert_value, remove_value, replace_value, window_median, window_deviation
   implicit none (type, external)
   private
   public :: mark_hampel, largest_half_width, least_present

   !> Largest k
   integer, parameter :: largest_half_width = 100000
   !> So many samples of a window, or k + 1 where that is less, must be present
   integer, parameter :: least_present = 11
   !> MAD of a normal distribution times this is its standard deviation: 1/Phi^-1(3/4)
   real(dp), parameter :: mad_to_sigma = 1.4826022185056018_dp
   !> Samples of a stretch, or so many windows where these are longer
   integer(int64), parameter :: stretch_length = 16384, stretch_windows = 8
   !> Stretches, and samples, from one call of progress to the next
   integer(int64), parameter :: group_stretches = 32, group_samples = 2000000

contains

   !> Marks the samples that stand out of their neighbourhood.
   !>
   !> Marked is $$|x_i - m_i| > t\,\max(1.4826\,\mathrm{MAD}_i, f)$$ with the median m and the MAD of the window.
   !> Outliers among the neighbours do not count as long as they are less than half of them. Memory: a window a thread.
   subroutine mark_hampel(x, half_width, threshold, floor, inlier, changed, removed, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> k, 1 .. 100,000; about k samples in a row, at most, can be told as outliers
      integer, intent(in) :: half_width
      !> t in standard deviations, > 0
      real(dp), intent(in) :: threshold
      !> f, the least scale, >= 0: half a quantisation step, so that a window on one level does not lose all others
      real(dp), intent(in) :: floor
      !> 1 inlier, 0 outlier or missing: [n]; that of every present sample is set, the others stay
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Samples whose mark changed, and outliers now
      integer(int64), intent(out) :: changed, removed
      !> invalid_argument, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: n, length, stretches, group, first

      changed = 0
      removed = 0
      n = size(x, kind=int64)
      call check_arguments(n, half_width, threshold, floor, size(inlier, kind=int64), error, valid)
      if (allocated(error)) return
      length = max(stretch_length, stretch_windows*int(2*half_width + 1, int64))
      stretches = (n + length - 1)/length
      group = max(group_stretches, group_samples/length)
      do first = 1, stretches, group
         call tell_progress("looking for outliers", (first - 1)*length, n, error, progress)
         if (allocated(error)) return
         call mark_stretches(x, first, min(first + group - 1, stretches), length, half_width, threshold, floor, inlier, changed, &
            & removed, error, valid)
         if (allocated(error)) return
      end do
   end subroutine mark_hampel

   !> Refuses what makes no sense.
   subroutine check_arguments(n, half_width, threshold, floor, marks, error, valid)
      !> Samples, and marks
      integer(int64), intent(in) :: n, marks
      !> As given
      integer, intent(in) :: half_width
      real(dp), intent(in) :: threshold, floor
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text
      logical :: good

      if (half_width < 1 .or. half_width > largest_half_width) then
         write (text, '("the half-width of the window must be 1 .. ", i0, ", it is ", i0)') largest_half_width, half_width
         call fatal_error(error, status%invalid_argument, trim(text))
         return
      end if
      good = ieee_is_finite(threshold) .and. ieee_is_finite(floor)
      if (good) good = threshold > 0.0_dp .and. floor >= 0.0_dp
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, "the outlier threshold must be positive, the least scale not negative")
         return
      end if
      good = marks == n
      if (present(valid)) good = good .and. size(valid, kind=int64) == n
      if (.not. good) call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
   end subroutine check_arguments

   !> Some stretches, shared by the threads.
   subroutine mark_stretches(x, first, last, length, half_width, threshold, floor, inlier, changed, removed, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The first and the last stretch, and samples of each
      integer(int64), intent(in) :: first, last, length
      !> k
      integer, intent(in) :: half_width
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> The marks: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Counted on
      integer(int64), intent(inout) :: changed, removed
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(window_type) :: window
      integer(int64) :: n, stretch
      integer :: bad, failed

      n = size(x, kind=int64)
      failed = 0
      !$omp parallel if (n >= threads_from) default(shared) private(window, bad) reduction(+:changed, removed, failed)
      allocate (window%value(2*half_width + 1), stat=bad)
      failed = failed + abs(bad)
      !$omp do schedule(dynamic)
      do stretch = first, last
         if (bad == 0) call judge_stretch(x, (stretch - 1)*length + 1, min(stretch*length, n), int(half_width, int64), &
            & threshold, floor, window, inlier, changed, removed, valid)
      end do
      !$omp end do
      if (allocated(window%value)) deallocate (window%value)
      !$omp end parallel
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for the window of the Hampel filter")
   end subroutine mark_stretches

   !> One stretch.
   pure subroutine judge_stretch(x, first, last, half_width, threshold, floor, window, inlier, changed, removed, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The first and the last sample, and k
      integer(int64), intent(in) :: first, last, half_width
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> Room for 2k + 1 values
      type(window_type), intent(inout) :: window
      !> The marks: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Counted on
      integer(int64), intent(inout) :: changed, removed
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i
      integer(int8) :: mark
      real(dp) :: median
      logical :: there

      window%count = 0
      do i = max(first - half_width, 1_int64), min(first + half_width, size(x, kind=int64))
         call advance(x, 0_int64, i, window, valid)
      end do
      do i = first, last
         if (i > first) call advance(x, i - half_width - 1, i + half_width, window, valid)
         there = .true.
         if (present(valid)) there = valid(i) /= 0_int8
         if (.not. there) cycle
         mark = 1_int8
         if (window%count >= min(int(half_width) + 1, least_present)) then
            median = window_median(window)
            if (abs(x(i) - median) > threshold*floor) mark = merge(0_int8, 1_int8, abs(x(i) - median) > &
               & threshold*(mad_to_sigma*window_deviation(window, median)))
         end if
         if (mark == 0_int8) removed = removed + 1
         if (mark /= inlier(i)) changed = changed + 1
         inlier(i) = mark
      end do
   end subroutine judge_stretch

   !> One sample leaves the window, one enters; those that are missing or beyond the record do neither.
   pure subroutine advance(x, leaving, entering, window, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The two samples, 1-based; below 1 and above n there is none
      integer(int64), intent(in) :: leaving, entering
      !> The window
      type(window_type), intent(inout) :: window
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      logical :: out, in

      out = leaving >= 1
      in = entering <= size(x, kind=int64)
      if (present(valid)) then
         if (out) out = valid(leaving) /= 0_int8
         if (in) in = valid(entering) /= 0_int8
      end if
      if (out .and. in) then
         call replace_value(window, x(leaving), x(entering))
      else if (out) then
         call remove_value(window, x(leaving))
      else if (in) then
         call insert_value(window, x(entering))
      end if
   end subroutine advance

end module gyroakf_preprocess_hampel
