! SPDX-License-Identifier: MIT
!> Outliers that stand out of the record and of their neighbourhood too.
!>
!> A sensor that is disturbed for a second records what it felt: the peaks of the disturbance lie beyond the limit of the quiet
!> record, but not beyond what their neighbours do. They are no errors of measurement, and a record whose sum means something (angle
!> increments) is broken where only the peaks of a motion to and fro are marked: the deviation then leaves its slope of -1.
module gyroakf_preprocess_neighbours
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from, chunk_count, chunk_first, chunk_last
   use gyroakf_preprocess_window, only : window_type, insert_value, window_median, window_deviation
   implicit none (type, external)
   private
   public :: mark_isolated, neighbours, least_neighbours

   !> Samples on either side
   integer(int64), parameter :: neighbours = 25
   !> With fewer around it a sample is judged by the record alone
   integer, parameter :: least_neighbours = 11
   !> MAD of a normal distribution times this is its standard deviation: 1/Phi^-1(3/4)
   real(dp), parameter :: mad_to_sigma = 1.4826022185056018_dp

contains

   !> Marks the samples beyond the limit that are beyond the threshold among their neighbours too, and unmarks the others.
   !>
   !> Marked is $$|x_i - c| > l$$ where also $$|x_i - m_i| > t\,\max(1.4826\,\mathrm{MAD}_i, f)$$ with median and MAD of the
   !> samples i-25 .. i+25 that are there. Cost: one pass, and a sorted window of 51 for each sample beyond the limit.
   subroutine mark_isolated(x, centre, limit, threshold, floor, keep, inlier, changed, removed, error, valid)
      !> Residuals: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> c and l
      real(dp), intent(in) :: centre, limit
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> .true.: a mark stays, whatever the limit
      logical, intent(in) :: keep
      !> 1 inlier, 0 outlier or missing: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Samples whose mark changed, and outliers now
      integer(int64), intent(out) :: changed, removed
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(window_type) :: window
      integer(int64) :: n, i
      integer(int8) :: mark
      integer :: chunk, bad, failed

      n = size(x, kind=int64)
      changed = 0
      removed = 0
      failed = 0
      !$omp parallel if (n >= threads_from) default(shared) private(window, bad, i, mark) reduction(+:changed, removed, failed)
      allocate (window%value(2*neighbours + 1), stat=bad)
      failed = failed + abs(bad)
      !$omp do schedule(dynamic)
      do chunk = 1, chunk_count(n)
         do i = chunk_first(n, chunk), chunk_last(n, chunk)
            if (present(valid)) then
               if (valid(i) == 0_int8) cycle
            end if
            mark = 1_int8
            if (abs(x(i) - centre) > limit .and. bad == 0) then
               if (stands_out(x, i, threshold, floor, window, valid)) mark = 0_int8
            end if
            if (keep) mark = min(mark, inlier(i))
            if (mark == 0_int8) removed = removed + 1
            if (mark /= inlier(i)) changed = changed + 1
            inlier(i) = mark
         end do
      end do
      !$omp end do
      if (allocated(window%value)) deallocate (window%value)
      !$omp end parallel
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for a window of neighbours")
   end subroutine mark_isolated

   !> Whether a sample is an outlier among its neighbours.
   logical function stands_out(x, sample, threshold, floor, window, valid)
      !> Residuals: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Which, 1-based, present
      integer(int64), intent(in) :: sample
      !> t and f
      real(dp), intent(in) :: threshold, floor
      !> Room for 51 values
      type(window_type), intent(inout) :: window
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i
      real(dp) :: median

      window%count = 0
      do i = max(sample - neighbours, 1_int64), min(sample + neighbours, size(x, kind=int64))
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         call insert_value(window, x(i))
      end do
      stands_out = window%count < least_neighbours
      if (stands_out) return
      median = window_median(window)
      stands_out = abs(x(sample) - median) > threshold*max(mad_to_sigma*window_deviation(window, median), floor)
   end function stands_out

end module gyroakf_preprocess_neighbours
