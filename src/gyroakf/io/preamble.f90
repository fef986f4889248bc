! SPDX-License-Identifier: MIT
!> What stands above the rows of a table: comments, names, units, settings, rows of other records.
module gyroakf_io_preamble
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : column_names_type, count_names, most_columns
   use gyroakf_io_header, only : read_comment
   use gyroakf_io_heading, only : alike, find_pattern, is_setting, &
      labels_are_names, only_words, suppose_names, suppose_record_names, take_heading
   use gyroakf_io_lines, only : next_line, lines_type, more_lines
   use gyroakf_io_labels, only : name_fields
   use gyroakf_io_marks, only : find_marks, marks_type
   use gyroakf_io_number, only : digits_ahead
   use gyroakf_io_place, only : integer_text, line_error
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_selection, only : is_wanted, set_condition
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text, only : begins_with_semicolon, bytes_text, fields_type, has_fields, &
      is_no_row, split, split_line
   use gyroakf_record, only : add_text
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: read_preamble

contains

   !> Reads comments and names up to the first line of numbers, which stays at hand.
   subroutine read_preamble(lines, options, table, error)
      type(lines_type), intent(inout) :: lines
      type(reader_options), intent(in) :: options
      !> Its header, names and warnings are filled
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, invalid_argument, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: setting
      character(:), allocatable :: word, pattern, above
      type(marks_type) :: marks
      type(fields_type) :: fields
      logical :: named, row                                   ! that begin with a semicolon

      setting = 0
      above = ""
      do
         call more_lines(lines, error)
         if (allocated(error)) return
         if (lines%at > lines%last) exit
         named = begins_with_semicolon(lines%bytes, lines%at, lines%to)
         row = named .and. table%layout%semicolons
         if (named) named = only_words(lines%bytes, lines%at, lines%to)
         if (row .and. .not. named) then
            call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
            row = has_fields(fields, size(table%names%name))
         end if
         if (lines%number <= options%skip) then
            continue
         else if (row .and. .not. named) then                 ! a row whose first field is empty
            return
         else if (is_no_row(lines%bytes, lines%at, lines%to) .and. .not. (named .and. &
            count(lines%bytes(lines%at:lines%to) == iachar(";")) > 1)) then
            call read_comment(lines, table%header, table%warnings)
            call suppose_names(lines, table%supposed)
         else if (verify(bytes_text(lines%bytes, lines%at, lines%to), "-=+*_|~ "// &
            achar(9)) == 0) then
            continue                                            ! a rule
         else
            call find_pattern(lines%bytes, lines%at, lines%to, pattern, marks)
            if (len_trim(pattern) == 0 .and. (len(pattern) == 0 .or. &
               count_names(table%names) /= len(pattern))) then
               continue
            else if ((4*marks%labels <= len(pattern)/2 .or. &
               labels_are_names(lines, pattern)) .and. &
               only_words(lines%bytes, lines%at, lines%to)) then
               word = lower(bytes_text(lines%bytes, lines%at, min(lines%to, lines%at + 3)))
               if (word /= "sep=" .and. .not. names_wanted(options, table%names)) then
                  call take_heading(lines, table%names%line < setting, table%names, table%layout)
               end if
            else if (skipped_by_where(lines, options, table)) then
               continue
            else if (.not. allocated(options%where) .and. is_setting(lines, pattern, marks)) then
               setting = lines%number
               above = pattern
            else
               call check_names(len(pattern), setting, marks%labels > 0 .and. &
                  alike(pattern, above), table, error)
               return
            end if
         end if
         call next_line(lines)
      end do
      if (table%layout%where_column > 0) call fatal_error(error, status%invalid_argument, &
         table%name//": no row agrees with "//options%where)
      if (allocated(error)) return
      call line_error(error, table%name, max(1_int64, lines%number - 1), &
         "the file holds no line of numbers", &
         "give one row of numbers per sample; lines that begin with # % ; // are comments")
   end subroutine read_preamble

   !> A setting between names and rows: words above it are no names; as many as columns: an error.
   subroutine check_names(columns, setting, equal, table, error)
      integer, intent(in) :: columns
      integer(int64), intent(in) :: setting
      logical, intent(in) :: equal
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error

      if (setting == 0) return
      call add_text(table%warnings, "what stands above line "//integer_text(setting + 1)// &
         " is taken for settings", note=.true.)
      if (table%names%line > setting) return
      if (count_names(table%names) == columns .or. equal) call line_error(error, table%name, &
         setting, "the line is neither a row nor names, and stands between both", "mend the line")
      table%names%known = .false.
   end subroutine check_names

   !> True where a name is the value of `options%where`: "IMU,t,gx" names the rows that it selects.
   pure logical function names_wanted(options, names)
      type(reader_options), intent(in) :: options
      type(column_names_type), intent(in) :: names
      integer :: i

      names_wanted = allocated(options%where)
      if (names_wanted) names_wanted = any([(names%name(i)%text == &
         options%where(index(options%where, "=", back=.true.) + 1:), i=1, count_names(names))])
   end function names_wanted

   !> True for a row that `options%where` leaves out; one whose label is the value stays.
   logical function skipped_by_where(lines, options, table) result(skipped)
      type(lines_type), intent(in) :: lines
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(error_type), allocatable :: failed
      type(column_names_type) :: names
      type(fields_type) :: fields
      type(marks_type) :: marks
      integer(int8), allocatable :: line(:)
      integer(int64) :: n
      integer :: array, stat

      skipped = .false.
      if (.not. allocated(options%where)) return
      n = lines%to - lines%at + 1
      allocate (line(n + digits_ahead), source=0_int8, stat=stat)
      if (stat /= 0) return
      line(:n) = lines%bytes(lines%at:lines%to)
      names = table%names
      call find_marks(line, 1_int64, n, .true., marks)
      call split_line(line, 1_int64, n, split%mixed, fields)
      if (marks%labels > 0 .and. fields%count <= most_columns) call name_fields( &
         lines%bytes(lines%at:lines%to), 1_int64, fields, names, array)
      call set_condition(options%where, names, most_columns, table%layout, failed)
      if (allocated(failed)) return
      skipped = .not. is_wanted(line, 1_int64, n, table%layout)
      if (skipped .and. marks%labels > 0 .and. names%known) then
         associate (column => table%layout%where_column, &
            value => options%where(index(options%where, "=", back=.true.) + 1:))
            if (column <= size(names%name)) table%layout%where_label = &
               names%name(column)%text == value .or. names%name(column)%text == value//"[0]"
         end associate
         skipped = .not. table%layout%where_label
      else if (skipped) then
         call suppose_record_names(line, fields, lines%number, table%layout%where_value, &
            table%supposed)
      end if
   end function skipped_by_where

end module gyroakf_io_preamble
