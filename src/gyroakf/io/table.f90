! SPDX-License-Identifier: MIT
!> A table of numbers in text: header, names, rows. What the numbers mean is the reader's business.
module gyroakf_io_table
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : column_class, is_time_name
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : choose_columns, column_names_type, drop_empty_names, find_column, label_of, &
      most_columns, refuse_equal_names
   use gyroakf_io_commas, only : settle_commas
   use gyroakf_io_header, only : header_type, read_comment
   use gyroakf_io_heading, only : alike, begins_with_names, find_pattern, is_setting, only_words, suppose_names, &
      & suppose_record_names, take_heading
   use gyroakf_io_leave_out, only : analyzed_columns, classes_of, find_texts, in_order
   use gyroakf_io_lines, only : line_end, line_map_type, next_line, lines_type, map_row, more_lines
   use gyroakf_io_marks, only : find_marks, marks_type, name_fields, strip_lines
   use gyroakf_io_place, only : integer_text, place_error
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_rows, only : excerpt, join_fields, layout_type
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_stamp_columns, only : ambiguous_date, date_advice, find_joined, find_kinds, pair_stamps
   use gyroakf_io_stamps, only : fraction_of
   use gyroakf_io_store, only : store_type
   use gyroakf_io_selection, only : find_interleaved, find_kinds_of_records, first_rows, is_wanted, set_condition
   use gyroakf_io_text, only : begins_with_semicolon, bytes_text, fields_type, first_visible, is_comment, split, split_line
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: table_type, begin_table, begin_numbers

   !> A table as it was read
   type :: table_type
      !> For messages: the path or `<stdin>`
      character(:), allocatable :: name
      !> What the comment lines say
      type(header_type) :: header
      !> Names of all columns
      type(column_names_type) :: names
      !> The last comment that may be names: it is where its words are as many as the columns
      type(column_names_type) :: supposed
      !> All columns of the file, and which are kept
      type(layout_type) :: layout
      !> The columns that hold the record, in the order wanted; and the one that holds the time, 0 where there is none
      integer, allocatable :: chosen(:)
      integer :: time = 0
      !> What each column measures, one of the components of column_class: [column]
      integer, allocatable :: class(:)
      !> True where the columns were asked for
      logical :: asked = .false.
      !> The rows that are at hand
      type(store_type) :: store
      !> How many were read so far, and whether these are all
      integer(int64) :: rows = 0
      logical :: whole = .false.
      !> Where the rows stood
      type(line_map_type) :: map
      !> Lines that could not be read
      integer(int64) :: bad_lines = 0, first_bad_line = 0
      !> Lines that repeat the names of the columns
      integer(int64) :: headings = 0, first_heading = 0
      !> The stored integer type of every value: 8, 16, 32 or 64 bits; 0 for text and floating point
      integer :: integer_bits = 0
      !> COLUMN=VALUE of each of several sensors, for --where; unallocated where there are none
      type(text_type), allocatable :: kinds(:)
      !> What the user should know
      type(text_type), allocatable :: warnings(:)
   end type table_type

contains

   !> Reads what stands above the rows of a table in text and decides on the columns.
   subroutine begin_table(lines, options, table, error)
      !> Open
      type(lines_type), intent(inout) :: lines
      !> What is wanted
      type(reader_options), intent(in) :: options
      !> All but the rows
      type(table_type), intent(out) :: table
      !> Allocated on failure: io, parse, invalid_argument, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: as_read(:)

      table%name = lines%source%name
      call read_preamble(lines, options, table, error)
      if (allocated(error)) return
      as_read = lines%bytes
      call lay_out(lines, options, table, error)
      if (table%layout%marked) call move_alloc(as_read, lines%bytes)
      if (.not. allocated(error)) call map_row(table%map, 1_int64, lines%number)
   end subroutine begin_table

   !> Decides on the columns of a table without text: they have no names.
   subroutine begin_numbers(name, columns, options, table, error)
      !> Of the file, for messages
      character(*), intent(in) :: name
      !> How many there are
      integer(int64), intent(in) :: columns
      !> What is wanted
      type(reader_options), intent(in) :: options
      !> All but the rows
      type(table_type), intent(out) :: table
      !> Allocated on failure: invalid_argument, parse
      type(error_type), allocatable, intent(out) :: error
      integer :: fraction
      logical :: nano

      table%name = name
      if (columns < 1 .or. columns > most_columns) then
         call fatal_error(error, status%parse, name//": "//integer_text(columns)//" columns are not from 1 to "// &
                          integer_text(int(most_columns, int64)))
         return
      end if
      table%layout%columns = int(columns)
      allocate (table%layout%kind(columns), source=stamp_kind%number)
      call choose(options, [logical ::], table, fraction, nano, error)
      if (.not. allocated(error)) call set_slots(0, table)
   end subroutine begin_numbers

   !> Reads comments and names up to the first line of numbers, which stays at hand.
   subroutine read_preamble(lines, options, table, error)
      type(lines_type), intent(inout) :: lines
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: last, setting
      character(:), allocatable :: word, pattern, above
      type(marks_type) :: marks

      setting = 0
      above = ""
      do
         call more_lines(lines, error)
         if (allocated(error)) return
         if (lines%at > lines%last) exit
         last = line_end(lines)
         if (lines%number <= options%skip) then
            continue
         else if (lacks_first(lines, last, table)) then
            return
         else if (is_comment(lines%bytes, lines%at, last) .and. .not. begins_with_names(lines, last)) then
            call read_comment(lines%bytes, lines%at, last, lines%number, table%header, table%warnings)
            call suppose_names(lines%bytes, lines%at, last, lines%number, table%supposed)
         else if (first_visible(lines%bytes, lines%at, last) <= last) then
            call find_pattern(lines%bytes, lines%at, last, pattern, marks)
            if (len_trim(pattern) == 0 .and. .not. named(table%names, len(pattern))) then
               continue
            else if (4*marks%labels <= len(pattern)/2 .and. only_words(lines, last)) then
               word = lower(bytes_text(lines%bytes, lines%at, min(last, lines%at + 3)))
               if (word /= "sep=" .and. .not. names_wanted(options, table%names)) then
                  call take_heading(lines, last, table%names%line < setting, table%names, table%layout)
               end if
            else if (skipped_by_where(lines, last, options, table)) then
               continue
            else if (.not. allocated(options%where) .and. is_setting(lines, last, pattern, marks)) then
               setting = lines%number
               above = pattern
            else
               call check_names(len(pattern), setting, marks%labels > 0 .and. alike(pattern, above), table, error)
               return
            end if
         end if
         call next_line(lines)
      end do
      if (table%layout%where_column > 0) then
         call fatal_error(error, status%invalid_argument, table%name//": no row agrees with "//options%where)
         return
      end if
      call fatal_error(error, status%parse, table%name//":"//integer_text(max(1_int64, lines%number - 1))// &
                       ":1: the file holds no line of numbers"//new_line("a")// &
                       "give one row of numbers per sample; lines that begin with # % ; // are comments")
   end subroutine read_preamble

   !> True where there is a name for every column.
   pure logical function named(names, columns)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: columns

      named = names%known
      if (named) named = size(names%name) == columns
   end function named

   !> A setting between names and rows: words above it are no names, unless there are as many of them as columns, which is an error.
   subroutine check_names(columns, setting, equal, table, error)
      integer, intent(in) :: columns
      integer(int64), intent(in) :: setting
      logical, intent(in) :: equal
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error

      if (setting == 0) return
      call add_text(table%warnings, "what stands above line "//integer_text(setting + 1)//" is taken for settings", note=.true.)
      if (table%names%line > setting) return
      if (named(table%names, columns) .or. equal) call fatal_error(error, status%parse, table%name//":"//integer_text(setting)// &
         ":1: the line is neither a row nor names, and stands between both"//new_line("a")//"mend the line")
      table%names%known = .false.
   end subroutine check_names

   !> True where a name is the value of `options%where`: "IMU,t,gx" names the rows that it selects.
   pure logical function names_wanted(options, names)
      type(reader_options), intent(in) :: options
      type(column_names_type), intent(in) :: names
      integer :: i

      names_wanted = allocated(options%where) .and. names%known
      if (names_wanted) names_wanted = any([(names%name(i)%text == &
                                           options%where(index(options%where, "=", back=.true.) + 1:), i=1, size(names%name))])
   end function names_wanted

   !> True for a row that `options%where` leaves out, where its column is known; a row whose label is the value is not left out.
   logical function skipped_by_where(lines, last, options, table) result(skipped)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(error_type), allocatable :: failed
      type(column_names_type) :: names
      type(fields_type) :: fields
      type(marks_type) :: marks
      integer(int8) :: line(last)
      integer :: array

      skipped = .false.
      if (.not. allocated(options%where)) return
      line(:) = lines%bytes(:last)
      names = table%names
      call find_marks(line, lines%at, last, .true., marks)
      call split_line(line, lines%at, last, split%mixed, fields)
      if (marks%labels > 0) call name_fields(lines%bytes, lines%at, fields, names, array)
      call set_condition(options%where, names, most_columns, table%layout, failed)
      if (allocated(failed)) return
      skipped = .not. is_wanted(line, lines%at, last, table%layout)
      if (skipped .and. marks%labels > 0 .and. names%known) then
         associate (column => table%layout%where_column, value => options%where(index(options%where, "=", back=.true.) + 1:))
            if (column <= size(names%name)) table%layout%where_label = names%name(column)%text == value .or. &
               names%name(column)%text == value//"[0]"
         end associate
         skipped = .not. table%layout%where_label
      else if (skipped) then
         call suppose_record_names(line, fields, lines%number, table%layout%where_value, table%supposed)
      end if
   end function skipped_by_where

   !> True for a row below names between semicolons whose first field is empty: not a comment.
   logical function lacks_first(lines, last, table)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(table_type), intent(in) :: table
      type(fields_type) :: fields

      lacks_first = table%layout%semicolons .and. begins_with_semicolon(lines%bytes, lines%at, last)
      if (lacks_first) lacks_first = .not. only_words(lines, last)
      if (.not. lacks_first) return
      call split_line(lines%bytes, lines%at, last, split%mixed, fields)
      lacks_first = fits_names(fields, size(table%names%name))
   end function lacks_first

   !> Decides on the columns from the first line of numbers.
   subroutine lay_out(lines, options, table, error)
      type(lines_type), intent(inout) :: lines
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      integer(int64) :: last
      integer :: named, partner, fraction
      character(:), allocatable :: word
      logical, allocatable :: texts(:)
      type(text_type), allocatable :: field(:, :)
      logical :: nano, by_number

      last = line_end(lines)
      call take_marks(lines, last, table, error)
      if (allocated(error)) return
      call settle_commas(lines, last, options%decimal_comma, table%names, table%layout%commas, table%warnings, error)
      if (allocated(error)) return
      call split_line(lines%bytes, lines%at, last, split%mixed, fields)
      if (fields%count > most_columns) then
         call place_error(error, table%name, lines%number, lines%bytes, lines%at, last, fields%first(most_columns + 1), &
            integer_text(int(fields%count, int64))//" columns, there may be "//integer_text(int(most_columns, int64)), &
            "give one row of numbers per sample: have line ends got lost?")
         return
      end if
      call refuse_ambiguous_dates(lines, last, options, fields, table, error)
      if (allocated(error)) return
      if (.not. (allocated(options%columns) .or. table%names%known)) then
         call refuse_long_rows(lines, fields%count, table%name, error)
         if (allocated(error)) return
      end if
      call find_joined(lines%bytes, lines%at, last, names_at_hand(table), table%layout, fields)
      if (.not. table%names%known) call take_names(fields, table)
      named = fields%count
      if (table%names%known) then
         if (.not. fits_names(fields, size(table%names%name))) then
            call split_line(lines%bytes, lines%at, last, split%tabs, fields)
            call join_fields(lines%bytes, table%layout, fields)
         end if
         call drop_empty_names(fields%count - merge(1, 0, fields%trailing), table%names)
         named = size(table%names%name)
      end if
      by_number = allocated(options%columns)
      if (by_number) by_number = verify(options%columns, "0123456789, ") == 0
      call refuse_equal_names(by_number, table%name, table%names, error)
      if (allocated(error)) return
      if (.not. fits_names(fields, named)) then
         call split_line(lines%bytes, lines%at, last, split%mixed, fields)
         call place_error(error, table%name, lines%number, lines%bytes, lines%at, last, &
            fields%last(min(fields%count, named)) + 1, integer_text(int(fields%count, int64))//" columns where line "// &
            integer_text(table%names%line)//" has "//integer_text(int(named, int64))//" names", &
            "name every column, or mend the line")
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
      call find_kinds(lines%bytes, fields, table%layout%columns, table%layout)
      call first_rows(lines%bytes, lines%at, lines%last, table%layout, field)
      call find_texts(field, texts)
      if (.not. allocated(options%where)) call find_kinds_of_records(field, table%names, texts, table%layout)
      call choose(options, texts, table, fraction, nano, error)
      if (allocated(error)) return
      if (.not. allocated(options%where) .and. (table%time > 0 .or. .not. allocated(options%time_column))) then
         call find_interleaved(field, table%names, table%time, table%class, table%kinds, word)
         if (allocated(table%kinds)) call place_error(error, table%name, lines%number, lines%bytes, lines%at, last, lines%at, &
                                                      word, "read one of them")
         if (allocated(error)) return
      end if
      call pair_stamps(lines%bytes, fields, table%time, table%chosen, fraction, nano, table%layout, partner)
      call set_slots(partner, table)
   end subroutine lay_out

   !> Labels and brackets of the first row become blanks, as in all rows; the labels, or the names of cells with arrays, name the
   !> fields. They stay where the names are as many as the fields without that.
   subroutine take_marks(lines, last, table, error)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: last
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: raw(:)
      type(marks_type) :: marks
      type(fields_type) :: fields
      integer :: array

      call find_marks(lines%bytes, lines%at, last, .false., marks)
      if (marks%labels + marks%brackets == 0) return
      call split_line(lines%bytes, lines%at, last, split%mixed, fields)
      if (table%names%known) then
         if (fits_names(fields, size(table%names%name)) .and. marks%brackets == 0) return
      end if
      table%layout%marked = .true.
      table%layout%skeleton = marks%skeleton
      raw = lines%bytes(:last)
      call strip_lines(lines%bytes, lines%at, lines%last, table%layout)
      call split_line(lines%bytes, lines%at, last, split%mixed, fields)
      call name_fields(raw, lines%at, fields, table%names, array)
      if (table%names%line == 0) table%names%line = lines%number
      if (array > 0 .and. last + 1 == lines%filled) array = -array
      if (.not. any(array == [0, 2, 3, 4, 6, 9])) call place_error(error, table%name, lines%number, raw, lines%at, last, &
         lines%at, "an array of "//integer_text(int(abs(array), int64))//" values in one row: axes, or successive samples?", &
         "write one row of numbers per sample")
   end subroutine take_marks

   !> How many names the columns have, wherever they stand.
   pure integer function names_at_hand(table)
      type(table_type), intent(in) :: table

      names_at_hand = 0
      if (table%supposed%known) names_at_hand = size(table%supposed%name)
      if (table%header%names%known) names_at_hand = size(table%header%names%name)
      if (table%names%known) names_at_hand = size(table%names%name)
   end function names_at_hand

   !> Dates with an ambiguous order of day and month are an error, unless the columns were chosen.
   subroutine refuse_ambiguous_dates(lines, last, options, fields, table, error)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(reader_options), intent(in) :: options
      type(fields_type), intent(in) :: fields
      type(table_type), intent(in) :: table
      type(error_type), allocatable, intent(out) :: error
      integer :: column

      if (allocated(options%columns) .or. allocated(options%time_column)) return
      column = ambiguous_date(lines%bytes, fields)
      if (column == 0) return
      call place_error(error, table%name, lines%number, lines%bytes, lines%at, last, fields%first(column), "'"// &
         excerpt(lines%bytes, fields%first(column), fields%last(column))//"' may have the day or the month first", date_advice)
   end subroutine refuse_ambiguous_dates

   !> Few rows of many numbers are series side by side: an error.
   subroutine refuse_long_rows(lines, columns, name, error)
      type(lines_type), intent(in) :: lines
      integer, intent(in) :: columns
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rows

      if (columns < 256 .or. .not. lines%ended) return
      rows = count(lines%bytes(lines%at:lines%last) == 10_int8, kind=int64)
      if (16*rows > columns) return
      call fatal_error(error, status%parse, name//":"//integer_text(lines%number)//":1: the number of rows is "// &
         integer_text(rows)//", that of columns "//integer_text(int(columns, int64))//": a series in each row?"//new_line("a")// &
         "a column for each: python3 -c ""import numpy; numpy.savetxt('columns.txt', numpy.array([r.replace(',', ' ').split() "// &
         "for r in open('"//name//"') if r[0] != '#'], float).T)""")
   end subroutine refuse_long_rows

   !> True where the line has a field for every name.
   pure logical function fits_names(fields, named)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: named

      fits_names = fields%count == named .or. (fields%count == named + 1 .and. fields%trailing)
   end function fits_names

   !> Takes the names of the header's key `columns`, else the words of a comment or of the definition of a record, where their
   !> number is right.
   subroutine take_names(fields, table)
      type(fields_type), intent(in) :: fields
      type(table_type), intent(inout) :: table

      associate (names => table%header%names)
         if (names%known) then
            if (fits_names(fields, size(names%name))) then
               table%names = names
               return
            end if
            call add_text(table%warnings, "line "//integer_text(names%line)//": the header's columns are "// &
               integer_text(size(names%name, kind=int64))//", the first row has "// &
               integer_text(int(fields%count, int64))//"; the names are ignored")
         end if
      end associate
      if (.not. table%supposed%known) return
      if (.not. fits_names(fields, size(table%supposed%name))) return
      table%names = table%supposed
      call add_text(table%warnings, "the names of the columns are taken from line "//integer_text(table%names%line), note=.true.)
   end subroutine take_names

   !> The columns that are kept.
   subroutine choose(options, texts, table, fraction, nano, error)
      type(reader_options), intent(in) :: options
      logical, intent(in) :: texts(:)
      type(table_type), intent(inout) :: table
      integer, intent(out) :: fraction
      logical, intent(out) :: nano
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: word
      integer :: i, n

      n = table%layout%columns
      if (allocated(options%time_column)) then
         if (options%time_column /= "none") call find_column(options%time_column, table%names, n, table%time, error)
      else if (table%names%known) then
         do i = n, 1, -1
            if (is_time_name(table%names%name(i)%text, table%names%unit(i)%text)) table%time = i
         end do
      end if
      if (allocated(error)) return
      if (table%time == 0 .and. .not. allocated(options%time_column)) table%time = first_stamps(table%layout)
      fraction = 0
      nano = .true.
      if (table%time > 0 .and. table%names%known) call fraction_of(table%names%name, table%time, fraction, nano)
      if (.not. allocated(table%header%units)) allocate (table%header%units(0))
      table%class = classes_of(table%names, table%header%units, texts, n)
      if (fraction > 0) table%class(fraction) = column_class%time
      i = table%layout%where_column
      if (i > 0 .and. .not. table%layout%strict) table%class(i) = max(table%class(i), column_class%flag)
      table%asked = allocated(options%columns)
      if (table%asked) then
         call choose_columns(options%columns, table%names, n, table%chosen, error)
         if (allocated(error)) return
         i = findloc(is_stamp(table%layout%kind(table%chosen)), .true., dim=1)
         if (i > 0) call fatal_error(error, status%invalid_argument, label_of(table%names, table%chosen(i))// &
                                     " holds dates or times of day, not values")
      else
         call choose_by_class(options, fraction, table)
      end if
      if (allocated(error)) return
      if (size(table%chosen) > 0) return
      word = "every column holds dates or times of day"
      if (table%time > 0) word = "there is no column besides the time in "//label_of(table%names, table%time)
      call fatal_error(error, status%parse, table%name//":"//integer_text(table%names%line)//":1: "//word//new_line("a")// &
                       "a record needs a column of numbers besides the time")
   end subroutine choose

   !> The columns that are kept where none was asked for: those that are analyzed; and where the time is not known, what may be it
   !> or a counter.
   subroutine choose_by_class(options, fraction, table)
      type(reader_options), intent(in) :: options
      integer, intent(in) :: fraction
      type(table_type), intent(inout) :: table
      logical :: number(table%layout%columns), kept(table%layout%columns)
      integer :: i

      number = [(i /= table%time .and. i /= fraction, i=1, size(number))] .and. .not. is_stamp(table%layout%kind)
      kept(:) = .false.
      kept(pack([(i, i=1, size(kept))], number)) = analyzed_columns(pack(table%class, number), options%input /= "rate")
      associate (class => table%class)
         if (options%survey) then
            kept = number .and. class /= column_class%text .and. class /= column_class%time
         else if (table%time == 0 .and. .not. allocated(options%time_column)) then
            kept = kept .or. (number .and. (class == column_class%unknown .or. class == column_class%counter))
            if (table%names%known) kept = kept .or. (number .and. [(table%names%name(i)%text == "T", i=1, size(kept))])
         else if (.not. any(class == column_class%rate)) then
            kept = kept .or. (number .and. class == column_class%counter)
         end if
         table%chosen = pack([(i, i=1, size(kept))], kept)
         table%chosen = table%chosen(in_order(class(table%chosen)))
      end associate
   end subroutine choose_by_class

   !> The column without a name for a time that holds dates or times of day: a date and time together before others.
   pure integer function first_stamps(layout)
      type(layout_type), intent(in) :: layout

      first_stamps = findloc(layout%kind, stamp_kind%moment, dim=1)
      if (first_stamps == 0) first_stamps = findloc(layout%kind, stamp_kind%clock, dim=1)
      if (first_stamps == 0) first_stamps = findloc(layout%kind, stamp_kind%date, dim=1)
   end function first_stamps

   !> True for a column of dates or times of day.
   elemental logical function is_stamp(kind)
      integer, intent(in) :: kind

      is_stamp = kind /= stamp_kind%number .and. kind /= stamp_kind%long
   end function is_stamp

   !> Where the columns are kept: the chosen ones in their order, then the time, unless it is one of them. A date and a time of day
   !> in two columns are kept in one place.
   subroutine set_slots(partner, table)
      integer, intent(in) :: partner
      type(table_type), intent(inout) :: table
      integer :: i

      allocate (table%layout%slot(table%layout%columns))
      table%layout%slot(:) = 0
      do i = 1, size(table%chosen)
         table%layout%slot(table%chosen(i)) = i
      end do
      table%layout%stored = size(table%chosen)
      if (table%time == 0) return
      if (table%layout%slot(table%time) > 0) return
      table%layout%stored = table%layout%stored + 1
      table%layout%slot(table%time) = table%layout%stored
      if (partner > 0) table%layout%slot(partner) = table%layout%stored
   end subroutine set_slots

end module gyroakf_io_table
