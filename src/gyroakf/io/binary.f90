! SPDX-License-Identifier: MIT
!> Rows of binary numbers: interleaved (all columns of a row together) or column after column.
!>
!> A regular file is read by position, in blocks that several threads take and convert; doubles of
!> one column go straight into their place. What comes through a pipe is read in order.
module gyroakf_io_binary
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_binary_block, only : binary_type, fill_rows, place_of, refuse_rest, skip_bytes, &
      take_bytes
   use gyroakf_io_element, only : element_name
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_source, only : source_type
   use gyroakf_io_store, only : add_chunk, chunk_rows, count_rows
   use gyroakf_io_table, only : table_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text
   implicit none (type, external)
   private
   public :: binary_type, read_binary_rows, refuse_rest, skip_bytes

   !> Rows of a chunk that is copied later, so as not to hold all twice; values where from a pipe
   integer(int64), parameter :: part_rows = 1048576
   !> Values between two reports of progress
   integer(int64), parameter :: slice_values = 8388608

contains

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_binary_rows(binary, source, most, table, error, progress)
      !> Its place in the file moves on
      type(binary_type), intent(inout) :: binary
      !> For what comes in order
      type(source_type), intent(inout) :: source
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Its store grows
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: rows, held
      integer :: failed

      do while (.not. table%whole .and. .not. allocated(error))
         held = count_rows(table%store)
         if (held >= most) return
         rows = max(chunk_rows, most - held)
         if (binary%descriptor < 0 .and. .not. binary%by_columns) then
            rows = max(1_int64, min(chunk_rows, part_rows/table%layout%stored))
         end if
         if (table%layout%stored > size(table%chosen) .and. binary%descriptor >= 0) then
            rows = min(rows, part_rows)
         end if
         if (binary%rows >= 0) rows = min(rows, binary%rows - binary%row)
         if (binary%by_columns .and. binary%descriptor < 0 .and. rows < binary%rows) then
            call fatal_error(error, status%no_memory, table%name//": columns that "// &
               "come one after the other, compressed or through a pipe, have to be held as a "// &
               "whole"//new_line("a")//"give the uncompressed file by its name")
            return
         end if
         call add_chunk(table%store, rows, table%layout%stored, failed)
         if (failed /= 0) then
            call fatal_error(error, status%no_memory, table%name//": no memory for "// &
               integer_text(rows)//" rows")
            return
         end if
         call fill_chunk(binary, source, table, error, progress)
      end do
   end subroutine read_binary_rows

   !> Fills the last chunk.
   subroutine fill_chunk(binary, source, table, error, progress)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: got, rows, slice

      associate (chunk => table%store%chunk(table%store%count))
         rows = size(chunk%value, 1, kind=int64)
         slice = rows
         if (present(progress)) slice = max(chunk_rows, slice_values/size(chunk%value, 2))
         if (binary%descriptor < 0) slice = rows
         do while (chunk%rows < rows)
            call report_progress("reading", place_of(binary), source%length, error, progress)
            if (allocated(error)) return
            slice = min(slice, rows - chunk%rows)
            call fill_rows(binary, source, table, chunk%value, chunk%rows, slice, got, error)
            if (allocated(error)) return
            chunk%rows = chunk%rows + got
            binary%row = binary%row + got
            table%rows = table%rows + got
            table%whole = got < slice
            if (table%whole) exit
         end do
      end associate
      if (binary%rows >= 0) then
         if (table%whole) call fatal_error(error, status%parse, table%name// &
            ": the file ends after "//integer_text(binary%row)//" of "// &
            integer_text(binary%rows)//" rows"//new_line("a")// &
            "it was cut off, or it changed while it was read")
         table%whole = binary%row == binary%rows
      end if
      if (table%whole .and. .not. allocated(error)) call finish(binary, source, table, error)
   end subroutine fill_chunk

   !> After the last row: warns of rounded integers; bytes that follow in a pipe are an error.
   subroutine finish(binary, source, table, error)
      type(binary_type), intent(inout) :: binary
      type(source_type), intent(inout) :: source
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: more(1)
      integer(int64) :: got

      if (table%rows == 0) then
         call fatal_error(error, status%parse, table%name//": the file is empty"//new_line("a")// &
                          "check what should have written it")
         return
      end if
      if (binary%rounded > 0) call add_text(table%warnings, integer_text(binary%rounded)// &
         " of the "//trim(element_name(binary%element))// &
         " values are beyond 2^53 and were rounded to 16 digits")
      if (binary%descriptor >= 0 .or. binary%rows < 0) return
      call take_bytes(binary, source, more, got, error)
      if (allocated(error) .or. got == 0) return
      call fatal_error(error, status%parse, table%name//": byte "// &
         integer_text(place_of(binary))//": bytes follow the array of "// &
         integer_text(binary%rows)//" rows that the header promises"//new_line("a")// &
         "give a file that holds one array")
   end subroutine finish

end module gyroakf_io_binary
