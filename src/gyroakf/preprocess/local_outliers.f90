! SPDX-License-Identifier: MIT
!> Outliers of a neighborhood: a sample is judged by the median and the MAD of a window around it.
!>
!> The Hampel filter judges every sample, in a window of 2k + 1. A window ends at the ends of the
!> record, as that of MATLAB's `hampel`. Missing samples are skipped; where fewer than k + 1 and
!> fewer than [[least_present]] of a window are present, its sample is not judged. Cost: O(log k)
!> searches and one shift of at most 16k bytes a sample. The threads share stretches of the record;
!> each window is exact, so the marks depend neither on the threads nor on the stretches.
!>
!> Source: Hampel, J. Amer. Stat. Assoc. 69 (1974) 383-393; Pearson et al., EURASIP J. Adv. Signal
!> Process. 2016:87.
module gyroakf_preprocess_local_outliers
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from
   use gyroakf_threads, only : thread_count
   use gyroakf_progress, only : progress_type, report_progress
   implicit none (type, external)
   private
   public :: mark_hampel, set_mark, largest_half_width, least_present, mad_to_sigma

   !> Largest k
   integer, parameter :: largest_half_width = 100000
   !> Samples that a window must have at least; of the Hampel filter k + 1 where that is less
   integer, parameter :: least_present = 11
   !> MAD of a normal distribution times this is its standard deviation: 1/Phi^-1(3/4)
   real(dp), parameter :: mad_to_sigma = 1.4826022185056018_dp
   !> Samples of a stretch, or so many windows where these are longer
   integer(int64), parameter :: stretch_length = 16384, stretch_windows = 8
   !> Work between two calls of progress: a step costs 100 plus the window's length (0.2 ns)
   integer(int64), parameter :: progress_cost = 50000000

   !> Values in ascending order. One that leaves and one that enters cost two binary searches and a
   !> shift of what lies between them; up to some thousand values that is cheaper than any tree.
   type :: window_type
      !> How many there are
      integer :: count = 0
      !> The values, then unused elements: [capacity]; allocated by the caller
      real(dp), allocatable :: value(:)
   end type window_type

contains

   !> Marks the samples that stand out of their neighborhood.
   !>
   !> Marked is $$|x_i - m_i| > t\,\max(1.4826\,\mathrm{MAD}_i, f)$$ with the median m and the MAD
   !> of the window. Outliers among the neighbors do not count as long as they are less than half of
   !> them. Memory: some windows for each thread.
   subroutine mark_hampel(x, half_width, threshold, floor, keep, inlier, changed, removed, error, &
      & valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> k, 1 .. 100,000; about k samples in a row, at most, can be recognized as outliers
      integer, intent(in) :: half_width
      !> t in standard deviations, > 0
      real(dp), intent(in) :: threshold
      !> f, the least scale, >= 0: half a quantization step keeps the neighbor levels
      real(dp), intent(in) :: floor
      !> .true.: a mark stays, whatever the limit
      logical, intent(in) :: keep
      !> 1 inlier, 0 outlier or missing: [n]; that of every present sample is set, the others stay
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Samples whose mark changed, and outliers now
      integer(int64), intent(out) :: changed, removed
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(window_type), allocatable :: window(:)
      integer(int64) :: n, length, stretches, steps, part, first, last, done, judged, stretch
      integer :: k, stat

      changed = 0
      removed = 0
      n = size(x, kind=int64)
      k = int(min(int(half_width, int64), n))                 ! a wider window has no sample more
      length = max(stretch_length, stretch_windows*int(2*k + 1, int64))
      stretches = (n + length - 1)/length
      steps = length + 2*k
      part = max(progress_cost/(100 + 2*k), 1_int64)
      allocate (window(min(stretches, thread_count()*max(part/steps, 1_int64))), stat=stat)
      do first = 1, size(window, kind=int64)
         if (stat == 0) allocate (window(first)%value(2*k + 1), stat=stat)
      end do
      call check_memory(stat, "the windows of the Hampel filter", error)
      if (allocated(error)) return
      do first = 1, stretches, size(window, kind=int64)
         last = min(first + size(window, kind=int64) - 1, stretches)
         do done = 0, steps - 1, part
            judged = (first - 1)*length + (last - first + 1)*max(done - 2*k, 0_int64)
            call report_progress("looking for outliers", min(judged, n), n, error, progress)
            if (allocated(error)) return
            !$omp parallel do if (n >= threads_from) default(shared) schedule(dynamic) &
            !$omp& reduction(+:changed, removed)
            do stretch = first, last
               call judge_stretch(x, (stretch - 1)*length + 1, min(stretch*length, n), done, part, &
                  & int(k, int64), threshold, floor, keep, window(stretch - first + 1), inlier, &
                  & changed, removed, valid)
            end do
            !$omp end parallel do
         end do
      end do
   end subroutine mark_hampel

   !> Some steps of the stretch first:last: in each a sample enters the window, and that in its
   !> middle, if it is of the stretch, is judged. `done` of last - first + 1 + 2k were made before.
   pure subroutine judge_stretch(x, first, last, done, steps, half_width, threshold, floor, keep, &
      & window, inlier, changed, removed, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: first, last, done, steps, half_width
      real(dp), intent(in) :: threshold, floor
      logical, intent(in) :: keep
      type(window_type), intent(inout) :: window
      integer(int8), intent(inout), contiguous :: inlier(:)
      integer(int64), intent(inout) :: changed, removed
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, entering, begin
      logical :: outlier

      if (done == 0) window%count = 0
      begin = max(first - half_width, 1_int64) + done
      do entering = begin, min(begin + steps - 1, last + half_width)
         i = entering - half_width
         call advance(x, merge(i - half_width - 1, 0_int64, i > first), entering, window, valid)
         if (i < first) cycle
         if (.not. is_present(i, valid)) cycle
         outlier = window%count >= min(int(half_width) + 1, least_present)
         if (outlier) outlier = stands_out(window, x(i), threshold, floor)
         call set_mark(outlier, keep, inlier(i), changed, removed)
      end do
   end subroutine judge_stretch

   !> One sample leaves the window, one enters; missing ones and those beyond the record do not.
   pure subroutine advance(x, leaving, entering, window, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: leaving, entering
      type(window_type), intent(inout) :: window
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: old, new
      logical :: out, in

      out = leaving >= 1
      if (out) out = is_present(leaving, valid)
      in = entering <= size(x, kind=int64)
      if (in) in = is_present(entering, valid)
      if (.not. (out .or. in)) return
      old = huge(old)                                  ! stands for a sample that is not there
      new = huge(new)
      if (out) old = x(leaving)
      if (in) new = x(entering)
      if (.not. out) window%count = window%count + 1
      if (.not. out) window%value(window%count) = old
      call replace_value(window, old, new)
      if (.not. in) window%count = window%count - 1
   end subroutine advance

   pure logical function is_present(i, valid)
      integer(int64), intent(in) :: i
      integer(int8), intent(in), optional :: valid(:)

      is_present = .true.
      if (present(valid)) is_present = valid(i) /= 0_int8
   end function is_present

   !> |x - median| > threshold max(1.4826 MAD, floor); the MAD only where the floor is exceeded.
   pure logical function stands_out(window, x, threshold, floor)
      type(window_type), intent(in) :: window
      real(dp), intent(in) :: x, threshold, floor
      real(dp) :: median

      median = window_median(window)
      stands_out = abs(x - median) > threshold*floor
      if (.not. stands_out) return
      stands_out = abs(x - median) > threshold*(mad_to_sigma*window_deviation(window, median))
   end function stands_out

   !> Marks a sample as outlier or inlier, and counts.
   pure subroutine set_mark(outlier, keep, inlier, changed, removed)
      logical, intent(in) :: outlier, keep
      integer(int8), intent(inout) :: inlier
      integer(int64), intent(inout) :: changed, removed
      integer(int8) :: mark

      mark = merge(0_int8, 1_int8, outlier)
      if (keep) mark = min(mark, inlier)
      if (mark == 0_int8) removed = removed + 1
      if (mark /= inlier) changed = changed + 1
      inlier = mark
   end subroutine set_mark

   !> Takes a value out and puts another one in.
   pure subroutine replace_value(window, old, new)
      type(window_type), intent(inout) :: window
      real(dp), intent(in) :: old, new
      integer :: i, from, to

      from = count_below(window, old) + 1
      to = count_below(window, new)
      if (to >= from) then
         do i = from, to - 1
            window%value(i) = window%value(i + 1)
         end do
         window%value(to) = new
      else
         do i = from, to + 2, -1
            window%value(i) = window%value(i - 1)
         end do
         window%value(to + 1) = new
      end if
   end subroutine replace_value

   !> How many values are smaller.
   pure integer function count_below(window, x)
      type(window_type), intent(in) :: window
      real(dp), intent(in) :: x
      integer :: rest, half

      count_below = 0
      rest = window%count
      do while (rest > 0)
         half = (rest + 1)/2
         if (window%value(count_below + half) < x) then
            count_below = count_below + half
            rest = rest - half
         else
            rest = half - 1
         end if
      end do
   end function count_below

   !> Median; the mean of the two middle values for an even number.
   pure real(dp) function window_median(window)
      type(window_type), intent(in) :: window
      integer :: middle

      middle = (window%count + 1)/2
      window_median = window%value(middle)
      if (mod(window%count, 2) == 0) window_median = 0.5_dp*window_median &
         & + 0.5_dp*window%value(middle + 1)
   end function window_median

   !> Median of the distances from the median.
   !>
   !> The distances of the lower half, from the middle outwards, and those of the upper half are two
   !> ascending lists; how many of the smaller half come from the lower list is found by bisection.
   pure real(dp) function window_deviation(window, median)
      type(window_type), intent(in) :: window
      real(dp), intent(in) :: median
      integer :: lower, wanted, least, most, taken
      real(dp) :: next

      lower = (window%count + 1)/2
      wanted = lower
      least = max(0, wanted - (window%count - lower))
      most = wanted
      do while (least < most)
         taken = (least + most)/2
         if (median - window%value(lower - taken) &
            & < window%value(lower + wanted - taken) - median) then
            least = taken + 1
         else
            most = taken
         end if
      end do
      window_deviation = 0.0_dp
      if (least > 0) window_deviation = median - window%value(lower + 1 - least)
      if (wanted > least) window_deviation = max(window_deviation, &
         & window%value(lower + wanted - least) - median)
      if (mod(window%count, 2) == 1) return
      next = huge(next)
      if (least < lower) next = median - window%value(lower - least)
      if (wanted - least < window%count - lower) next = min(next, &
         & window%value(lower + wanted - least + 1) - median)
      window_deviation = 0.5_dp*window_deviation + 0.5_dp*next
   end function window_deviation

end module gyroakf_preprocess_local_outliers
