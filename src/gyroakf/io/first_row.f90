! SPDX-License-Identifier: MIT
!> The first row of a table in text: it decides how rows are split and which columns there are.
module gyroakf_io_first_row
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_io_columns, only : count_names, drop_empty_names, most_columns, refuse_equal_names
   use gyroakf_io_commas, only : choose_commas
   use gyroakf_io_stamp_field, only : is_day_first
   use gyroakf_io_column_choice, only : is_text
   use gyroakf_io_lines, only : lines_type, map_row
   use gyroakf_io_labels, only : name_fields
   use gyroakf_io_marks, only : find_marks, marks_type, strip_lines
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_io_place, only : integer_text, line_error, place_error
   use gyroakf_io_preamble, only : read_preamble
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_row, only : excerpt, join_fields
   use gyroakf_io_selection, only : find_interleaved, find_kinds_of_records, first_rows, &
      set_condition
   use gyroakf_io_stamp_columns, only : find_joined, find_kinds, pair_stamps
   use gyroakf_io_table, only : choose, table_type
   use gyroakf_io_text, only : fields_type, has_fields, line_feed_from, split, split_line
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: begin_table

contains

   !> Reads what stands above the rows of a table in text and decides on the columns.
   subroutine begin_table(lines, options, table, error)
      type(lines_type), intent(inout) :: lines
      type(reader_options), intent(in) :: options
      type(table_type), intent(out) :: table
      !> Allocated on failure: io, parse, invalid_argument, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: as_read(:)
      integer :: failed

      table%name = lines%source%name
      table%layout%bad_lines_missing = options%bad_lines_missing
      call read_preamble(lines, options, table, error)
      if (allocated(error)) return
      allocate (as_read, source=lines%bytes, stat=failed)
      call check_memory(failed, "the first rows of "//table%name, error)
      if (allocated(error)) return
      call lay_out(lines, options, table, error)
      if (table%layout%marked) call move_alloc(as_read, lines%bytes)
      if (.not. allocated(error)) call map_row(table%map, 1_int64, lines%number)
   end subroutine begin_table

   subroutine lay_out(lines, options, table, error)
      type(lines_type), intent(inout) :: lines
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer :: named, i, j, failed
      character(:), allocatable :: word
      logical, allocatable :: texts(:)
      type(text_type), allocatable :: field(:, :)

      call take_marks(lines, table, error)
      if (allocated(error)) return
      call choose_commas(lines, options%decimal_comma, table, error)
      if (allocated(error)) return
      call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
      if (fields%count > most_columns) call place_error(error, table%name, lines%number, &
         lines%bytes, lines%at, lines%to, fields%first(most_columns + 1), &
         integer_text(fields%count)//" columns, there may be "//integer_text(most_columns), &
         "give one row of numbers per sample: have line ends got lost?")
      if (allocated(error)) return
      call refuse_ambiguous_dates(lines, options, fields, table, error)
      if (allocated(error)) return
      if (.not. (allocated(options%columns) .or. table%names%known)) then
         call refuse_long_rows(lines, fields%count, table%name, error)
         if (allocated(error)) return
      end if
      named = count_names(table%names)
      if (named == 0) named = count_names(table%header%names)
      if (named == 0) named = count_names(table%supposed)
      call find_joined(lines%bytes, lines%at, lines%to, named, table%layout, fields)
      if (.not. table%names%known) call take_names(fields, table)
      named = fields%count
      if (table%names%known) then
         if (.not. has_fields(fields, size(table%names%name))) then
            call split_line(lines%bytes, lines%at, lines%to, split%tabs, fields)
            call join_fields(lines%bytes, table%layout, fields)
         end if
         call drop_empty_names(fields%count - merge(1, 0, fields%trailing), table%names)
         named = size(table%names%name)
      end if
      call refuse_equal_names(table%name, table%names, error, options%columns)
      if (allocated(error)) return
      if (.not. has_fields(fields, named)) then
         call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
         call place_error(error, table%name, lines%number, lines%bytes, lines%at, lines%to, &
            fields%last(min(fields%count, named)) + 1, integer_text(fields%count)// &
            " columns where line "//integer_text(table%names%line)//" has "//integer_text(named)// &
            " names", "name every column, or mend the line")
         return
      end if
      table%layout%columns = named
      table%layout%semicolons = any(lines%bytes(lines%at:fields%last(fields%count)) == iachar(";"))
      table%layout%last_optional = fields%trailing
      if (allocated(options%where)) then
         call set_condition(options%where, table%names, table%layout%columns, table%layout, error)
         if (allocated(error)) return
         if (table%layout%where_label) table%layout%where_column = 0
      end if
      call find_kinds(lines%bytes, fields, table%layout)
      call first_rows(lines%bytes, lines%at, lines%last, table%layout, field, failed)
      call check_memory(failed, "the first rows of "//table%name, error)
      if (allocated(error)) return
      texts = [(size(field, 1) > 0 .and. all([(is_text(field(i, j)%text), i=1, size(field, 1))]), &
         j=1, size(field, 2))]
      if (.not. allocated(options%where)) call find_kinds_of_records(field, texts, table)
      call choose(options, texts, rises(field(:, 1)), table, error)
      if (allocated(error)) return
      if (.not. allocated(options%where) .and. &
         (table%time > 0 .or. .not. allocated(options%time_column))) then
         call find_interleaved(field, table, word)
         if (allocated(word)) call place_error(error, table%name, lines%number, lines%bytes, &
            lines%at, lines%to, lines%at, word, "read one of them")
         if (allocated(error)) return
      end if
      call pair_stamps(lines%bytes, fields, table)
   end subroutine lay_out

   !> Whether numbers rise and never fall.
   pure logical function rises(field)
      type(text_type), intent(in) :: field(:)
      real(dp) :: x(size(field))
      integer :: i, found

      rises = .false.
      do i = 1, size(x)
         call parse_number(field(i)%text, x(i), found)
         if (found /= number%ok) return
      end do
      if (size(x) > 1) rises = x(size(x)) > x(1) .and. all(x(2:) >= x(:size(x) - 1))
   end function rises

   !> Labels and brackets of the first row become blanks, as in all rows; the labels, or the names
   !> of cells with arrays, name the fields. They stay where there are as many names as fields.
   subroutine take_marks(lines, table, error)
      type(lines_type), intent(inout) :: lines
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: raw(:)
      type(marks_type) :: marks
      type(fields_type) :: fields
      integer :: array

      call find_marks(lines%bytes, lines%at, lines%to, .false., marks)
      if (marks%labels + marks%brackets == 0) return
      call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
      if (has_fields(fields, count_names(table%names)) .and. marks%brackets == 0) return
      table%layout%marked = .true.
      table%layout%skeleton = marks%skeleton
      raw = lines%bytes(:lines%to)
      call strip_lines(lines%bytes, lines%at, lines%last, table%layout)
      call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
      if (fields%count > most_columns) return
      call name_fields(raw, lines%at, fields, table%names, array)
      if (table%names%line == 0) table%names%line = lines%number
      if (array > 0 .and. lines%to + 1 == lines%filled) array = -array
      if (.not. any(array == [0, 2, 3, 4, 6, 9])) call place_error(error, table%name, &
         lines%number, raw, lines%at, lines%to, lines%at, "an array of "// &
         integer_text(abs(array))//" values in one row: axes, or successive samples?", &
         "write one row of numbers per sample")
   end subroutine take_marks

   !> Dates with an ambiguous order of day and month are an error, unless the columns were chosen.
   subroutine refuse_ambiguous_dates(lines, options, fields, table, error)
      type(lines_type), intent(in) :: lines
      type(reader_options), intent(in) :: options
      type(fields_type), intent(in) :: fields
      type(table_type), intent(in) :: table
      type(error_type), allocatable, intent(out) :: error
      integer :: j

      if (allocated(options%columns) .or. allocated(options%time_column)) return
      do j = 1, fields%count
         if (fields%last(j) < fields%first(j)) cycle
         if (.not. is_day_first(lines%bytes, fields%first(j), fields%last(j))) cycle
         call place_error(error, table%name, lines%number, lines%bytes, lines%at, lines%to, &
            fields%first(j), "'"//excerpt(lines%bytes, fields%first(j), fields%last(j))// &
            "' may have the day or the month first", &
            "write the year first, as in 2026-05-01, or leave the column out")
         return
      end do
   end subroutine refuse_ambiguous_dates

   !> Few rows of many numbers are series side by side: an error.
   subroutine refuse_long_rows(lines, columns, name, error)
      type(lines_type), intent(in) :: lines
      integer, intent(in) :: columns
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer(int64) :: rows, at, to
      character(:), allocatable :: advice

      if (columns < 64 .or. .not. lines%ended) return
      rows = count(lines%bytes(lines%at:lines%last) == 10_int8, kind=int64)
      if (8*rows > columns) return
      advice = "a column for each: python3 -c ""import numpy; numpy.savetxt('columns.txt', "// &
         "numpy.array([r.replace(',', ' ').split() for r in open('"//name// &
         "') if r[0] != '#'], float).T)"""
      at = lines%at
      do while (at <= lines%last)
         to = line_feed_from(lines%bytes, at)
         call split_line(lines%bytes, at, to - 1, split%mixed, fields)
         if (fields%count /= columns) advice = "write a column for each, all of one length"
         at = to + 1
      end do
      call line_error(error, name, lines%number, "the number of rows is "//integer_text(rows)// &
         ", that of columns "//integer_text(columns)//": a series in each row?", advice)
   end subroutine refuse_long_rows

   !> Takes the names of the header's key `columns`, else those that a comment or record may give.
   subroutine take_names(fields, table)
      type(fields_type), intent(in) :: fields
      type(table_type), intent(inout) :: table

      associate (names => table%header%names)
         if (names%known) then
            if (has_fields(fields, size(names%name))) then
               table%names = names
               return
            end if
            call add_text(table%warnings, "line "//integer_text(names%line)// &
               ": the header's columns are "//integer_text(size(names%name))// &
               ", the first row has "//integer_text(fields%count)//"; the names are ignored")
         end if
      end associate
      if (.not. table%supposed%known) return
      if (.not. has_fields(fields, count_names(table%supposed))) return
      table%names = table%supposed
      call add_text(table%warnings, "the names of the columns are taken from line "// &
         integer_text(table%names%line), note=.true.)
   end subroutine take_names

end module gyroakf_io_first_row
