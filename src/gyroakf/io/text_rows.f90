! SPDX-License-Identifier: MIT
!> The rows of a table in text, read into its store.
module gyroakf_io_text_rows
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_lines, only : line_end, lines_type, map_row, more_lines, next_line
   use gyroakf_io_place, only : integer_text, place_error
   use gyroakf_io_rows, only : parse_rows, problem_type, read_row
   use gyroakf_io_stamp_columns, only : make_points
   use gyroakf_io_store, only : count_rows, next_chunk
   use gyroakf_io_table, only : table_options, table_type
   use gyroakf_io_text, only : fields_type, first_visible, is_comment
   implicit none (type, external)
   private
   public :: read_rows

contains

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_rows(lines, options, most, table, error)
      !> Of [[begin_table]]
      type(lines_type), intent(inout) :: lines
      !> What is wanted
      type(table_options), intent(in) :: options
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Its store grows
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer(int64) :: rows
      integer :: failed
      logical :: odd

      do while (count_rows(table%store) < most)
         call more_lines(lines, error)
         if (allocated(error)) return
         table%whole = lines%at > lines%last
         if (table%whole) exit
         if (table%layout%commas /= 0) call make_points(lines%bytes, lines%at, lines%last, table%layout%commas)
         call next_chunk(table%store, table%layout%stored, failed)
         if (failed /= 0) then
            call fatal_error(error, status%no_memory, table%name//": no memory for more than "//integer_text(table%rows)//" rows")
            return
         end if
         associate (chunk => table%store%chunk(table%store%count))
            rows = chunk%rows
            call parse_rows(lines%bytes, lines%at, lines%last, table%layout, chunk%value, chunk%rows, odd)
            lines%number = lines%number + chunk%rows - rows
            table%rows = table%rows + chunk%rows - rows
         end associate
         if (odd) call take_odd_line(lines, options, table, fields, error)
         if (allocated(error)) return
      end do
   end subroutine read_rows

   !> Reads the line at hand, whatever it is.
   subroutine take_odd_line(lines, options, table, fields, error)
      type(lines_type), intent(inout) :: lines
      type(table_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(fields_type), intent(inout) :: fields
      type(error_type), allocatable, intent(out) :: error
      type(problem_type) :: problem
      real(dp) :: row(table%layout%stored)
      integer(int64) :: last

      last = line_end(lines)
      if (first_visible(lines%bytes, lines%at, last) > last .or. is_comment(lines%bytes, lines%at, last)) then
         call map_row(table%map, table%rows + 1, lines%number + 1)
      else
         call read_row(lines%bytes, lines%at, last, table%layout, fields, row, problem)
         if (problem%found .and. .not. options%bad_lines_missing) then
            call place_error(error, table%name, lines%number, lines%bytes, lines%at, last, problem%at, problem%what, problem%advice)
            return
         end if
         if (problem%found) then
            row = ieee_value(1.0_dp, ieee_quiet_nan)
            table%bad_lines = table%bad_lines + 1
            if (table%first_bad_line == 0) table%first_bad_line = lines%number
         end if
         associate (chunk => table%store%chunk(table%store%count))
            chunk%rows = chunk%rows + 1
            chunk%value(chunk%rows, :) = row
         end associate
         table%rows = table%rows + 1
      end if
      call next_line(lines)
   end subroutine take_odd_line

end module gyroakf_io_text_rows
