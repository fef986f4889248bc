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
   use gyroakf_threads, only : thread_count
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
   !> A step of the window costs about 100 plus its length in fifths of a nanosecond; so much is done between two calls of progress
   integer(int64), parameter :: told_cost = 50000000

contains

   !> Marks the samples that stand out of their neighbourhood.
   !>
   !> Marked is $$|x_i - m_i| > t\,\max(1.4826\,\mathrm{MAD}_i, f)$$ with the median m and the MAD of the window.
   !> Outliers among the neighbours do not count as long as they are less than half of them. Memory: a window for each of the
   !> stretches that are worked on at the same time, some times the threads.
   subroutine mark_hampel(x, half_width, threshold, floor, inlier, changed, removed, error, valid, progress, keep)
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
      !> .true.: a mark stays, whatever the limit; .false. where it is absent
      logical, intent(in), optional :: keep
      type(window_type), allocatable :: window(:)
      integer(int64) :: n, length, stretches, steps, part, first, last, done, judged
      integer :: k
      logical :: stay

      changed = 0
      removed = 0
      n = size(x, kind=int64)
      call check_arguments(n, half_width, threshold, floor, size(inlier, kind=int64), error, valid)
      if (allocated(error)) return
      stay = .false.
      if (present(keep)) stay = keep
      k = int(min(int(half_width, int64), n))                          ! a wider window has no sample more
      length = max(stretch_length, stretch_windows*int(2*k + 1, int64))
      stretches = (n + length - 1)/length
      steps = length + 2*k
      part = max(told_cost/(100 + 2*k), 1_int64)
      call make_windows(min(stretches, thread_count()*max(part/steps, 1_int64)), k, window, error)
      if (allocated(error)) return
      do first = 1, stretches, size(window, kind=int64)
         last = min(first + size(window, kind=int64) - 1, stretches)
         do done = 0, steps - 1, part
            judged = (first - 1)*length + (last - first + 1)*max(done - 2*k, 0_int64)
            call tell_progress("looking for outliers", min(judged, n), n, error, progress)
            if (allocated(error)) return
            call mark_stretches(x, first, last, length, done, part, k, threshold, floor, stay, window, inlier, changed, &
               & removed, valid)
         end do
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

   !> Room for the windows of the stretches that are worked on at the same time.
   subroutine make_windows(number, half_width, window, error)
      !> Stretches
      integer(int64), intent(in) :: number
      !> k
      integer, intent(in) :: half_width
      !> [number]
      type(window_type), allocatable, intent(out) :: window(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: i
      integer :: stat

      allocate (window(number), stat=stat)
      if (stat == 0) then
         do i = 1, number
            allocate (window(i)%value(2*half_width + 1), stat=stat)
            if (stat /= 0) exit
         end do
      end if
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the windows of the Hampel filter")
   end subroutine make_windows

   !> Some steps of some stretches, shared by the threads.
   subroutine mark_stretches(x, first, last, length, done, steps, half_width, threshold, floor, keep, window, inlier, changed, &
      & removed, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The first and the last stretch, and samples of each
      integer(int64), intent(in) :: first, last, length
      !> Steps made before, and to be made
      integer(int64), intent(in) :: done, steps
      !> k
      integer, intent(in) :: half_width
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> .true.: a mark stays
      logical, intent(in) :: keep
      !> Those of the stretches
      type(window_type), intent(inout) :: window(:)
      !> The marks: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Counted on
      integer(int64), intent(inout) :: changed, removed
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, stretch

      n = size(x, kind=int64)
      !$omp parallel do if (n >= threads_from) default(shared) reduction(+:changed, removed) schedule(dynamic)
      do stretch = first, last
         call judge_stretch(x, (stretch - 1)*length + 1, min(stretch*length, n), done, steps, int(half_width, int64), &
            & threshold, floor, keep, window(stretch - first + 1), inlier, changed, removed, valid)
      end do
      !$omp end parallel do
   end subroutine mark_stretches

   !> Some steps of one stretch: in each a sample enters the window, and that in its middle, if it is of the stretch, is judged.
   pure subroutine judge_stretch(x, first, last, done, steps, half_width, threshold, floor, keep, window, inlier, changed, &
      & removed, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The first and the last sample
      integer(int64), intent(in) :: first, last
      !> Steps made before, and to be made; there are last - first + 1 + 2k at most
      integer(int64), intent(in) :: done, steps
      !> k
      integer(int64), intent(in) :: half_width
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> .true.: a mark stays
      logical, intent(in) :: keep
      !> Room for 2k + 1 values; goes on from step to step
      type(window_type), intent(inout) :: window
      !> The marks: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Counted on
      integer(int64), intent(inout) :: changed, removed
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, entering, begin
      integer(int8) :: mark
      real(dp) :: median
      logical :: there

      if (done == 0) window%count = 0
      begin = max(first - half_width, 1_int64) + done
      do entering = begin, min(begin + steps - 1, last + half_width)
         i = entering - half_width
         call advance(x, merge(i - half_width - 1, 0_int64, i > first), entering, window, valid)
         if (i < first) cycle
         there = .true.
         if (present(valid)) there = valid(i) /= 0_int8
         if (.not. there) cycle
         mark = 1_int8
         if (window%count >= min(int(half_width) + 1, least_present)) then
            median = window_median(window)
            if (abs(x(i) - median) > threshold*floor) mark = merge(0_int8, 1_int8, abs(x(i) - median) > &
               & threshold*(mad_to_sigma*window_deviation(window, median)))
         end if
         if (keep) mark = min(mark, inlier(i))
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
