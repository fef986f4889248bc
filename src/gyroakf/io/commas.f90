! SPDX-License-Identifier: MIT
!> What the commas of a table are: separators, decimal commas, or those of seconds in dates alone.
module gyroakf_io_commas
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_io_columns, only : count_names
   use gyroakf_io_date, only : is_digit
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_place, only : place_error
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, is_no_row, last_visible, &
      line_feed_from, split, split_line
   use gyroakf_record, only : add_text
   implicit none (type, external)
   private
   public :: choose_commas, decimal_comma, decimal_fields, seconds_comma, make_points, &
      comma_found, comma_advice

   !> The message for a decimal comma
   character(*), parameter :: comma_found = &
      "this looks like a decimal comma, and a comma separates columns"
   character(*), parameter :: comma_advice = "write decimal points"

   !> What commas are where they do not part columns: all decimal commas, or those behind seconds
   integer, parameter :: decimal_commas = 1, seconds_commas = 2

   !> So many lines at the start are looked at for decimal commas
   integer, parameter :: max_lines = 64
   !> What parts words of a line besides commas
   character(*), parameter :: parting = " ;"//achar(9), digits = "0123456789"
   integer(int8), parameter :: tab = 9, blank = 32, quote = 34, apostrophe = 39, comma = 44, &
      point = 46, semicolon = 59, colon = 58

contains

   !> Decides what commas are.
   subroutine choose_commas(lines, decimal, table, error)
      !> The first line of numbers is at hand; decimal commas become points
      type(lines_type), intent(inout) :: lines
      logical, intent(in) :: decimal
      !> Its names are used as far as they are known; `layout%commas` is set
      type(table_type), intent(inout) :: table
      !> parse (they may be decimal commas, but not surely)
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields

      if (decimal) then
         table%layout%commas = decimal_commas
      else if (seconds_comma(lines%bytes, lines%at, lines%to)) then
         table%layout%commas = seconds_commas
      else
         call split_line(lines%bytes, lines%at, lines%to, split%mixed, fields)
         if (count_names(table%names) == fields%count) return
         call find_decimal_commas(lines, table, error)
         if (allocated(error)) return
      end if
      call make_points(lines%bytes, lines%at, lines%last, table%layout%commas)
   end subroutine choose_commas

   !> Looks at the first lines for decimal commas: where every line has them or whole numbers
   !> between other separators, they are read; where they are likely but not sure it is an error,
   !> for they would be taken for separators.
   subroutine find_decimal_commas(lines, table, error)
      type(lines_type), intent(in) :: lines
      type(table_type), intent(inout) :: table
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: at, last, likely, likely_at, likely_last
      integer :: i, fields, expected, line
      logical :: sure, commas

      at = lines%at
      expected = count_names(table%names)
      sure = .true.
      commas = .false.
      likely = 0
      do i = 0, max_lines - 1
         if (at > lines%last) exit
         last = line_feed_from(lines%bytes, at)
         if (.not. is_no_row(lines%bytes, at, last - 1)) then
            fields = decimal_fields(lines%bytes, at, last - 1)
            if (expected == 0) expected = fields
            sure = sure .and. fields > 1 .and. fields == expected
            commas = commas .or. any(lines%bytes(at:last - 1) == iachar(","))
            if (likely == 0) then
               likely = decimal_comma(lines%bytes, at, last - 1)
               likely_at = at
               likely_last = last - 1
               line = i
            end if
         end if
         at = last + 1
      end do
      if (sure .and. commas) then
         table%layout%commas = decimal_commas
         call add_text(table%warnings, "the commas between digits are read as decimal commas", &
            note=.true.)
      else if (likely > 0) then
         call place_error(error, lines%source%name, lines%number + line, lines%bytes, likely_at, &
            likely_last, likely, comma_found, comma_advice)
      end if
   end subroutine find_decimal_commas

   !> The byte of a comma that is a decimal comma, 0 where none is recognized.
   !>
   !> It is recognized in a line without decimal points where each comma stands between two digits
   !> and either other separators part fields of one comma at most (`1,5;2,3`), or the line has one
   !> comma with a leading zero behind it (`1,05`) or `-0` before it. `12:00:00,5` has none.
   pure integer(int64) function decimal_comma(bytes, first, last) result(at)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      integer :: comma_at, clock

      at = 0
      call find_commas(bytes, first, last, text, comma_at, clock)
      if (comma_at <= 0 .or. clock > 0 .or. scan(text, ".'""") > 0) return
      if (scan(text, parting) == len(text) .and. text(:comma_at) /= "-0,") then
         if (scan(text(comma_at + 1:comma_at + 1), "0") &
            + scan(text(comma_at + 2:comma_at + 2), digits) < 2) return
      end if
      at = first_visible(bytes, first, last) + comma_at - 1
   end function decimal_comma

   !> Columns of a row between semicolons, tabs or blanks where every comma in it may be a decimal
   !> comma: between two digits, one at most in a field, and no decimal points but in dates and
   !> times of day; 0 where one cannot be.
   pure integer function decimal_fields(bytes, first, last) result(fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      character(1) :: parts
      integer :: i, comma_at, clock

      fields = 0
      call find_commas(bytes, first, last, text, comma_at, clock)
      if (comma_at < 0 .or. (clock > 0 .and. clock == len(text) - 1)) return
      parts = " "
      if (index(text, achar(9)) > 0) parts = achar(9)
      if (index(text, ";") > 0) parts = ";"
      do i = 1, len(text) - 1
         if (text(i:i) == parts .and. text(i:i + 1) /= "  ") fields = fields + 1
      end do
      if (text(len(text) - 1:len(text) - 1) /= parts) fields = fields + 1
   end function decimal_fields

   !> The visible text of a line and a blank; its first comma, 0 for none, -1 where one is not or a
   !> point is decimal; and the end of the last word with a comma and a colon, 0 for none.
   pure subroutine find_commas(bytes, first, last, text, comma_at, clock)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable, intent(out) :: text
      integer, intent(out) :: comma_at, clock
      integer :: from, to, found

      text = bytes_text(bytes, first_visible(bytes, first, last), &
         last_visible(bytes, first, last))//" "
      comma_at = 0
      clock = 0
      from = 1
      do while (from < len(text))
         to = from + scan(text(from:), parting) - 2
         found = comma_of(text(from:to))
         if (found < 0) comma_at = -1
         if (found < 0) return
         if (found > 0 .and. comma_at == 0) comma_at = from + found - 1
         if (found > 0 .and. index(text(from:to), ":") > 0) clock = to
         from = to + 2
      end do
   end subroutine find_commas

   !> The comma of a word, 0 for none; -1 where it is not the only one, not between two digits, or
   !> beside points, and where points are not those of a date or a time of day.
   pure integer function comma_of(word) result(at)
      character(*), intent(in) :: word
      integer :: i, points
      logical :: colon

      at = index(word, ",")
      colon = index(word, ":") > 0
      points = count([(word(i:i) == ".", i=1, len(word))])
      if (at == 0) then
         if (points > 0 .and. points /= 2 .and. .not. colon) at = -1
      else if ((points > 0 .and. .not. (points == 2 .and. colon)) .or. at == 1 .or. &
         at == len(word)) then
         at = -1
      else if (verify(word(at - 1:at - 1)//word(at + 1:at + 1), digits) > 0 .or. &
         index(word, ",", back=.true.) > at) then
         at = -1
      end if
   end function comma_of

   !> True where a comma stands before the decimals of the seconds, as in `12:00:00,123;1.5`: 3, 6
   !> or 9 digits, perhaps a zone, then a blank, tab or semicolon; and no comma parts columns.
   pure logical function seconds_comma(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p, q
      integer(int8), parameter :: zone(5) = iachar(["+", "-", ":", "Z", "z"], int8)
      logical :: quoted

      seconds_comma = .false.
      quoted = .false.
      do p = first, last
         if (bytes(p) == quote .or. bytes(p) == apostrophe) quoted = .not. quoted
         if (bytes(p) /= comma .or. quoted) cycle
         if (.not. behind_seconds(bytes, p, first)) then
            seconds_comma = .false.
            return
         end if
         q = p + 1
         do while (is_digit(bytes(q)))
            q = q + 1
         end do
         if (mod(q - p - 1, 3_int64) /= 0 .or. q - p > 10) return
         do while (is_digit(bytes(q)) .or. any(bytes(q) == zone))
            q = q + 1
         end do
         if (q > last) return
         if (bytes(q) /= blank .and. bytes(q) /= tab .and. bytes(q) /= semicolon) return
         seconds_comma = .true.
      end do
   end function seconds_comma

   !> True for a comma behind `:dd` and before a digit.
   pure logical function behind_seconds(bytes, p, first)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, first

      behind_seconds = .false.
      if (p < first + 3) return
      behind_seconds = bytes(p - 3) == colon .and. is_digit(bytes(p - 2)) .and. &
         is_digit(bytes(p - 1)) .and. is_digit(bytes(p + 1))
   end function behind_seconds

   !> Writes points for decimal commas; doing it twice does no harm.
   pure subroutine make_points(bytes, first, last, mode)
      !> Lines at first:last, a line feed at last
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> As `layout%commas`
      integer, intent(in) :: mode
      integer(int64) :: i

      if (mode == decimal_commas) then
         where (bytes(first:last) == comma) bytes(first:last) = point
      else if (mode == seconds_commas) then
         do i = first, last
            if (bytes(i) /= comma) cycle
            if (behind_seconds(bytes, i, first)) bytes(i) = point
         end do
      end if
   end subroutine make_points

end module gyroakf_io_commas
