! SPDX-License-Identifier: MIT
!> Rows of a dataset of HDF5, read into the store of a table in parts.
module gyroakf_io_hdf5_rows
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_element, only : drop_infinite
   use gyroakf_io_hdf5, only : hdf5_type, open_hdf5, read_hdf5
   use gyroakf_io_opening, only : orient, tell_integer
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_source, only : source_type
   use gyroakf_io_store, only : add_chunk, chunk_rows, count_rows
   use gyroakf_io_table, only : begin_numbers, table_options, table_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_record, only : add_text
   use gyroakf_units, only : parse_unit
   implicit none (type, external)
   private
   public :: begin_hdf5, read_hdf5_rows

   !> Values that are read at once
   integer(int64), parameter :: block_values = 1048576

contains

   !> Opens a dataset and decides on the columns.
   subroutine begin_hdf5(source, path, options, dataset, hdf5, table, error)
      !> Its first block was read: a regular file
      type(source_type), intent(in) :: source
      !> Its path
      character(*), intent(in) :: path
      !> What is wanted
      type(table_options), intent(in) :: options
      !> Path in the file; "": the only one of numbers
      character(*), intent(in) :: dataset
      !> To be closed by [[close_hdf5]], after a failure too
      type(hdf5_type), intent(out) :: hdf5
      !> All but the rows
      type(table_type), intent(out) :: table
      !> Allocated on failure: io, parse, invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rows, columns
      logical :: by_columns, turned

      if (source%length <= 0 .or. associated(source%bytes)) then
         call fatal_error(error, status%not_supported, source%name//": HDF5 has to be in a file"//new_line("a")// &
                          "give the file by its name")
         return
      end if
      call open_hdf5(path, dataset, hdf5, error)
      if (allocated(error)) return
      by_columns = .false.
      call orient(hdf5%rank, hdf5%shape, by_columns, rows, columns, turned)
      if (rows < 1 .or. columns < 1) then
         call fatal_error(error, status%too_few_samples, path//": the dataset "//hdf5%path//" is empty")
         return
      end if
      call begin_numbers(source%name, columns, options, table, error)
      if (allocated(error)) return
      call tell_integer(hdf5%element, table)
      call take_attributes(hdf5, table)
      if (turned) call add_text(table%warnings, "the dataset's shape is ("//integer_text(hdf5%shape(1))//", "// &
         integer_text(hdf5%shape(2))//"): the longer side is taken for the time, the other for the channels")
   end subroutine begin_hdf5

   !> Rate and unit that the file says.
   subroutine take_attributes(hdf5, table)
      type(hdf5_type), intent(in) :: hdf5
      type(table_type), intent(inout) :: table
      type(error_type), allocatable :: unknown

      if (hdf5%rate_hz > 0.0_dp) table%header%rate_hz = hdf5%rate_hz
      if (.not. allocated(hdf5%unit)) return
      call parse_unit(hdf5%unit, table%header%unit, unknown)
      if (allocated(unknown)) call add_text(table%warnings, "the dataset's unit '"//hdf5%unit//"' is not known and is ignored")
   end subroutine take_attributes

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_hdf5_rows(hdf5, most, table, error, progress)
      !> Open
      type(hdf5_type), intent(in) :: hdf5
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Its store grows
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: rows, n
      integer :: failed, side

      rows = maxval(hdf5%shape(:hdf5%rank))
      side = maxloc(hdf5%shape(:hdf5%rank), dim=1)
      do while (.not. table%whole .and. .not. allocated(error))
         n = count_rows(table%store)
         if (n >= most) return
         n = min(rows - table%rows, max(chunk_rows, most - n))
         if (table%layout%stored > size(table%chosen)) n = min(n, 16*chunk_rows)
         call add_chunk(table%store, n, table%layout%stored, failed)
         if (failed /= 0) then
            call fatal_error(error, status%no_memory, table%name//": no memory for "//integer_text(n)//" rows")
            return
         end if
         call fill_chunk(hdf5, side, n, table, rows, error, progress)
         if (allocated(error)) return
         table%rows = table%rows + n
         table%whole = table%rows == rows
      end do
   end subroutine read_hdf5_rows

   !> Fills the last chunk, in blocks of all columns that are wanted where these lie together.
   subroutine fill_chunk(hdf5, side, n, table, rows, error, progress)
      type(hdf5_type), intent(in) :: hdf5
      !> The side that is the time, its part that is read, and its length
      integer, intent(in) :: side
      integer(int64), intent(in) :: n, rows
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: room(:)
      integer(int64) :: at, part, from, to, width
      integer :: j, slot, failed

      from = findloc(table%layout%slot > 0, .true., dim=1)
      to = findloc(table%layout%slot > 0, .true., dim=1, back=.true.)
      width = merge(to - from + 1, 1_int64, side == 1)
      part = max(1_int64, block_values/width)
      allocate (room(width*min(part, n)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, table%name//": no memory for "//integer_text(width)//" columns")
         return
      end if
      associate (chunk => table%store%chunk(table%store%count))
         at = 0
         do while (at < n)
            part = min(part, n - at)
            call tell_progress("reading", table%rows + at, rows, error, progress)
            if (allocated(error)) return
            if (side == 1) call read_hdf5(hdf5, side, table%rows + at + 1, part, from, to, room(:width*part), error)
            do j = 1, table%layout%columns
               if (allocated(error)) return
               slot = table%layout%slot(j)
               if (slot == 0) cycle
               if (side == 1) then
                  chunk%value(at + 1:at + part, slot) = room(j - from + 1:width*part:width)
               else
                  call read_hdf5(hdf5, side, table%rows + at + 1, part, int(j, int64), int(j, int64), &
                                 chunk%value(at + 1:at + part, slot), error)
               end if
               call drop_infinite(chunk%value(at + 1:at + part, slot))
            end do
            at = at + part
         end do
         chunk%rows = n
      end associate
   end subroutine fill_chunk

end module gyroakf_io_hdf5_rows
