! SPDX-License-Identifier: MIT
!> Sorting of real numbers, in time n log n whatever their order.
!>
!> Runs of 32 numbers are sorted by insertion, then neighbors are merged between the array and a
!> work space of the same length, all pairs of a level by all threads. The sorted array does not
!> depend on the threads.
module gyroakf_sort
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from
   implicit none (type, external)
   private
   public :: sort_values, sorted, median_of

   !> Numbers that are sorted by insertion
   integer(int64), parameter :: run_length = 32
   !> Numbers sorted into runs, or merged, between two reports of progress, a multiple of it
   integer(int64), parameter :: report_numbers = 4194304

contains

   !> Sorts in ascending order: merge sort from the bottom up (Knuth, TAOCP 3, 5.2.4).
   subroutine sort_values(x, error, progress)
      !> Numbers: [n], n >= 0, no NaN; sorted afterwards
      real(dp), intent(inout), contiguous, target :: x(:)
      !> no_memory: n numbers of work space, x is unchanged; cancelled: x is in another order
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable, target :: work(:)
      real(dp), pointer, contiguous :: from(:), to(:), other(:)
      integer(int64) :: n, i, first, width, step
      integer :: stat

      n = size(x, kind=int64)
      if (n > run_length) then
         allocate (work(n), stat=stat)
         call check_memory(stat, "sorting the series", error)
         if (allocated(error)) return
      end if
      do first = 1, n, report_numbers
         if (n > report_numbers) call report_progress("sorting", first - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel do if (n >= threads_from) default(shared) schedule(static)
         do i = first, min(first + report_numbers - 1, n), run_length
            call sort_run(x(i:min(i + run_length - 1, n)))
         end do
         !$omp end parallel do
      end do
      if (n <= run_length) return
      from => x
      to => work
      width = run_length
      do while (width < n)
         step = 2*width*max(report_numbers/(2*width), 1_int64)
         do first = 1, n, step
            call report_progress("sorting", width, n, error, progress)
            if (allocated(error)) return
            call merge_level(from, to, width, first, min(first + step - 1, n))
         end do
         other => from
         from => to
         to => other
         width = 2*width
      end do
      if (.not. associated(from, x)) x(:) = work
   end subroutine sort_values

   !> Sorts a few numbers by insertion.
   pure subroutine sort_run(x)
      real(dp), intent(inout), contiguous :: x(:)
      real(dp) :: value
      integer :: i, j

      do i = 2, size(x)
         value = x(i)
         do j = i - 1, 1, -1
            if (x(j) <= value) exit
            x(j + 1) = x(j)
         end do
         x(j + 1) = value
      end do
   end subroutine sort_run

   !> Merges some pairs of sorted runs.
   subroutine merge_level(from, to, width, begin, end)
      real(dp), intent(in), contiguous :: from(:)
      real(dp), intent(inout), contiguous :: to(:)
      integer(int64), intent(in) :: width, begin, end
      integer(int64) :: first, middle, last

      !$omp parallel do if (end - begin >= threads_from) default(shared) private(middle, last) &
      !$omp& schedule(static)
      do first = begin, end, 2*width
         middle = min(first + width - 1, end)
         last = min(first + 2*width - 1, end)
         call merge_runs(from(first:middle), from(middle + 1:last), to(first:last))
      end do
      !$omp end parallel do
   end subroutine merge_level

   !> Merges two sorted runs.
   pure subroutine merge_runs(a, b, both)
      real(dp), intent(in), contiguous :: a(:), b(:)
      real(dp), intent(inout), contiguous :: both(:)
      integer(int64) :: i, j, k, m, n

      m = size(a, kind=int64)
      n = size(b, kind=int64)
      i = 1
      j = 1
      do k = 1, m + n
         if (i > m .or. j > n) exit
         if (b(j) < a(i)) then
            both(k) = b(j)
            j = j + 1
         else
            both(k) = a(i)
            i = i + 1
         end if
      end do
      if (i <= m) both(k:) = a(i:)
      if (j <= n) both(k:) = b(j:)
   end subroutine merge_runs

   !> The middle value of a short list.
   real(dp) function median_of(x)
      !> At least one
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))

      y = sorted(x)
      median_of = 0.5_dp*(y((size(x) + 1)/2) + y(size(x)/2 + 1))
   end function median_of

   !> A short list in ascending order.
   function sorted(x) result(y)
      !> Any values
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))
      type(error_type), allocatable :: failed

      y(:) = x
      call sort_values(y, failed)
   end function sorted

end module gyroakf_sort
