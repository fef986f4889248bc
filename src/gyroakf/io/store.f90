! SPDX-License-Identifier: MIT
!> Columns that grow while a file is read: a list of chunks, so that growing copies nothing and the whole is held once.
module gyroakf_io_store
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: chunk_rows, chunk_type, store_type, next_chunk, add_chunk, count_rows, take_columns

   !> Rows of every chunk
   integer(int64), parameter :: chunk_rows = 65536

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
      !> Room for more than are in use
      type(chunk_type), allocatable :: chunk(:)
   end type store_type

contains

   !> Makes the last chunk one that has room for a row.
   subroutine next_chunk(store, columns, failed)
      !> May be fresh
      type(store_type), intent(inout) :: store
      !> Stored columns
      integer, intent(in) :: columns
      !> Not 0 where memory cannot be had
      integer, intent(out) :: failed

      failed = 0
      if (store%count > 0) then
         if (store%chunk(store%count)%rows < chunk_rows) return
      end if
      call add_chunk(store, chunk_rows, columns, failed)
   end subroutine next_chunk

   !> Appends a chunk of any number of rows.
   subroutine add_chunk(store, rows, columns, failed)
      !> May be fresh
      type(store_type), intent(inout) :: store
      !> Room of the chunk
      integer(int64), intent(in) :: rows
      !> Stored columns
      integer, intent(in) :: columns
      !> Not 0 where memory cannot be had
      integer, intent(out) :: failed
      type(chunk_type), allocatable :: longer(:)
      integer :: i

      failed = 0
      if (.not. allocated(store%chunk)) allocate (store%chunk(16))
      if (store%count == size(store%chunk)) then
         allocate (longer(2*store%count), stat=failed)
         if (failed /= 0) return
         do i = 1, store%count
            longer(i)%rows = store%chunk(i)%rows
            call move_alloc(store%chunk(i)%value, longer(i)%value)
         end do
         call move_alloc(longer, store%chunk)
      end if
      store%count = store%count + 1
      allocate (store%chunk(store%count)%value(rows, columns), stat=failed)
      if (failed /= 0) store%count = store%count - 1
   end subroutine add_chunk

   !> Rows in the store.
   pure integer(int64) function count_rows(store)
      !> May be fresh
      type(store_type), intent(in) :: store
      integer :: i

      count_rows = 0
      do i = 1, store%count
         count_rows = count_rows + store%chunk(i)%rows
      end do
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
      !> Not 0 where memory cannot be had
      integer, intent(out) :: failed
      integer(int64) :: at, rows, n
      integer :: i, j

      n = count_rows(store)
      if (is_record(store, n, columns)) then
         allocate (stamps(merge(n, 0_int64, time_slot > 0)), stat=failed)
         if (failed /= 0) return
         if (time_slot > 0) stamps(:) = store%chunk(1)%value(:, time_slot)
         call move_alloc(store%chunk(1)%value, value)
         store%chunk(1)%rows = 0
         store%count = 0
         return
      end if
      allocate (value(n, size(columns)), stat=failed)
      if (failed /= 0) return
      allocate (stamps(merge(n, 0_int64, time_slot > 0)), stat=failed)
      if (failed /= 0) return
      at = 0
      do i = 1, store%count
         rows = store%chunk(i)%rows
         do j = 1, size(columns)
            value(at + 1:at + rows, j) = store%chunk(i)%value(:rows, columns(j))
         end do
         if (time_slot > 0) stamps(at + 1:at + rows) = store%chunk(i)%value(:rows, time_slot)
         at = at + rows
         deallocate (store%chunk(i)%value)
         store%chunk(i)%rows = 0
      end do
      store%count = 0
   end subroutine take_columns

   !> True where a single chunk holds exactly the columns that are wanted.
   pure logical function is_record(store, rows, columns)
      type(store_type), intent(in) :: store
      integer(int64), intent(in) :: rows
      integer, intent(in) :: columns(:)
      integer :: j

      is_record = store%count == 1
      if (is_record) is_record = size(store%chunk(1)%value, 1, kind=int64) == rows &
                                 .and. size(store%chunk(1)%value, 2) == size(columns)
      if (is_record) is_record = all(columns == [(j, j=1, size(columns))])
   end function is_record

end module gyroakf_io_store
