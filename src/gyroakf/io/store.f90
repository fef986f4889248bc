! SPDX-License-Identifier: MIT
!> Columns that grow while a file is read: a list of chunks, so that growing copies nothing.
!>
!> A chunk of a long record is so large that the system gives it a mapping of its own, and takes it
!> back as soon as it is freed: while the chunks are joined, no more than one of them is held twice,
!> and no more than some pages of it where the system takes back parts of an array.
module gyroakf_io_store
   use gyroakf_kinds, only : dp, int64
   use gyroakf_large_pages, only : page_values, prefer_large_pages, release_pages, &
      values_before_page
   implicit none (type, external)
   private
   public :: chunk_rows, store_type, next_chunk, add_chunk, count_rows, take_columns

   !> Minimum rows of a chunk where the number of rows to come is unknown
   integer(int64), parameter :: chunk_rows = 65536
   !> Values of a chunk: 40 MB, more than 32 MiB, from which on C libraries have no choice
   integer(int64), parameter :: chunk_values = 5000000
   !> Some rows of all stored columns
   type :: chunk_type
      !> Rows that are filled
      integer(int64) :: rows = 0
      !> [row, stored column]; NaN where missing
      real(dp), allocatable :: value(:, :)
   end type chunk_type

   !> All rows read so far
   type :: store_type
      !> Chunks in use
      integer :: count = 0
      !> More than are in use
      type(chunk_type), allocatable :: chunk(:)
   end type store_type

contains

   !> Provides a last chunk with a given number of free rows.
   subroutine next_chunk(store, columns, failed, rows, expected)
      type(store_type), intent(inout) :: store
      integer, intent(in) :: columns
      integer, intent(out) :: failed
      integer(int64), intent(in) :: rows
      !> So many rows are expected from here on; a new chunk holds them unless it would be too large
      integer(int64), intent(in) :: expected

      failed = 0
      if (store%count > 0) then
         associate (chunk => store%chunk(store%count))
            if (size(chunk%value, 1, kind=int64) - chunk%rows >= rows) return
         end associate
      end if
      call add_chunk(store, max(min(expected, max(1_int64, chunk_values/columns)), rows), &
         columns, failed)
   end subroutine next_chunk

   !> Appends an empty chunk of any number of rows.
   subroutine add_chunk(store, rows, columns, failed)
      type(store_type), intent(inout) :: store
      integer(int64), intent(in) :: rows
      integer, intent(in) :: columns
      integer, intent(out) :: failed
      type(chunk_type), allocatable :: longer(:)
      integer :: i, j

      failed = 0
      if (.not. allocated(store%chunk)) allocate (store%chunk(16), stat=failed)
      if (failed /= 0) return
      if (store%count == size(store%chunk)) then
         allocate (longer(2*store%count), stat=failed)
         if (failed /= 0) return
         do i = 1, store%count
            longer(i)%rows = store%chunk(i)%rows
            call move_alloc(store%chunk(i)%value, longer(i)%value)
         end do
         call move_alloc(longer, store%chunk)
      end if
      associate (chunk => store%chunk(store%count + 1))
         allocate (chunk%value(rows, columns), stat=failed)
         if (failed /= 0) return
         store%count = store%count + 1
         do j = 1, columns
            call prefer_large_pages(chunk%value(:, j))
         end do
      end associate
   end subroutine add_chunk

   !> Rows in the store.
   pure integer(int64) function count_rows(store)
      type(store_type), intent(in) :: store

      count_rows = 0
      if (store%count > 0) count_rows = sum(store%chunk(:store%count)%rows)
   end function count_rows

   !> Moves the columns out into two arrays, freeing the chunks on the way.
   subroutine take_columns(store, time_slot, columns, value, stamps, failed)
      !> Empty afterwards
      type(store_type), intent(inout) :: store
      !> The stored column that goes into `stamps`, 0 for none
      integer, intent(in) :: time_slot
      !> The stored columns that go into `value`, in this order
      integer, intent(in) :: columns(:)
      !> [row, column]; NaN where missing
      real(dp), allocatable, intent(out) :: value(:, :)
      !> [row], of no length without a time column
      real(dp), allocatable, intent(out) :: stamps(:)
      integer, intent(out) :: failed
      integer(int64) :: at, n
      integer :: i, j
      logical :: single

      n = count_rows(store)
      single = store%count == 1                   ! a chunk that holds just the columns wanted
      if (single) single = size(store%chunk(1)%value, 1, kind=int64) == n .and. &
         size(store%chunk(1)%value, 2) == size(columns)
      if (single) single = all(columns == [(j, j=1, size(columns))])
      if (single) then
         allocate (stamps(merge(n, 0_int64, time_slot > 0)), stat=failed)
         if (failed /= 0) return
         if (time_slot > 0) stamps(:) = store%chunk(1)%value(:, time_slot)
         call move_alloc(store%chunk(1)%value, value)
         store%chunk(1)%rows = 0
         store%count = 0
         return
      end if
      allocate (value(n, size(columns)), stat=failed)
      if (failed == 0) allocate (stamps(merge(n, 0_int64, time_slot > 0)), stat=failed)
      if (failed /= 0) return
      do j = 1, size(columns)
         call prefer_large_pages(value(:, j))
      end do
      call prefer_large_pages(stamps)
      at = 0
      do i = 1, store%count
         associate (chunk => store%chunk(i))
            do j = 1, size(columns)
               call move_rows(chunk%value(:chunk%rows, columns(j)), &
                  value(at + 1:at + chunk%rows, j), columns(j) /= time_slot .and. &
                  all(columns(j + 1:) /= columns(j)))
            end do
            if (time_slot > 0) call move_rows(chunk%value(:chunk%rows, time_slot), &
               stamps(at + 1:at + chunk%rows), .true.)
            at = at + chunk%rows
            deallocate (chunk%value)
            chunk%rows = 0
         end associate
      end do
      store%count = 0
   end subroutine take_columns

   !> Copies rows, by several threads: the first touch of the memory takes longer than the copying.
   !> Where they are not needed again, their memory is given back page by page, and what is copied
   !> next may come to lie in it while the caches still hold it.
   subroutine move_rows(from, to, release)
      real(dp), intent(inout), contiguous :: from(:), to(:)
      logical, intent(in) :: release
      integer(int64) :: before, first, last, k, n

      n = size(from, kind=int64)
      before = values_before_page(from)
      !$omp parallel do schedule(static) private(first, last) if(n > page_values)
      do k = 0, (n - before + page_values - 1)/page_values
         first = max(1_int64, before + (k - 1)*page_values + 1)
         last = min(before + k*page_values, n)
         to(first:last) = from(first:last)
         if (release) call release_pages(from(first:last))
      end do
      !$omp end parallel do
   end subroutine move_rows

end module gyroakf_io_store
