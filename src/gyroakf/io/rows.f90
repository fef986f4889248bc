! SPDX-License-Identifier: MIT
!> Rows of numbers: the fast way through the lines that hold numbers only, the careful way through the rest.
!>
!> Both work on a block of whole lines and know nothing of files, so that blocks can be given to several threads.
module gyroakf_io_rows
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_date, only : kind_of_field, scan_stamp, stamp_kind
   use gyroakf_io_format, only : comma_advice, comma_found, decimal_comma
   use gyroakf_io_number, only : is_missing_field, number, scan_number, skip_digits
   use gyroakf_io_place, only : integer_text, shown_bytes
   use gyroakf_io_text, only : bytes_text, fields_type, split, split_line
   implicit none (type, external)
   private
   public :: layout_type, problem_type, parse_rows, read_row, join_fields, excerpt

   !> Which columns a file has, and which of them are kept
   type :: layout_type
      !> Columns of every row
      integer :: columns = 0
      !> Columns that are kept
      integer :: stored = 0
      !> Where a column is kept, 0 where it is not: [column]
      integer, allocatable :: slot(:)
      !> The last column may be left away: the row that it was counted in ended with a separator
      logical :: last_optional = .false.
      !> Columns of dates and times of day: one of the components of stamp_kind, negative where it is added to what another column
      !> of the same slot gave: [column]; unallocated where all are numbers
      integer, allocatable :: kind(:)
      !> Stamps are counted from this day or whole number
      integer(int64) :: origin = 0
      !> The column that is a date and a time of day with blanks between them, 0 where there is none
      integer :: joined = 0
      !> What commas are, a component of comma_mode
      integer :: commas = 0
      !> The line of the names, from its first visible byte to the last: where it is met again it is no row; unallocated where
      !> there is none
      integer(int8), allocatable :: heading(:)
      !> Semicolons part the columns: a line that begins with one may be a row whose first field is empty
      logical :: semicolons = .false.
   end type layout_type

   !> What is wrong with a row
   type :: problem_type
      !> False where nothing is
      logical :: found = .false.
      !> The byte
      integer(int64) :: at = 0
      !> What is wrong, and what to do; unallocated where nobody wants to know
      character(:), allocatable :: what, advice
   end type problem_type

   !> The minus sign of mathematics, in UTF-8
   character(*), parameter :: dash = char(226)//char(136)//char(146)
   character(*), parameter :: mend = "mend the line, or let such lines count as missing samples with --bad-lines missing"
   !> Bytes of a word that may stand for a missing number, and the bytes behind a field
   integer(int64), parameter :: longest_word = 11
   integer(int8), parameter :: ends(6) = [9_int8, 10_int8, 13_int8, 32_int8, 44_int8, 59_int8]
   integer(int8), parameter :: tab = 9, line_feed = 10, carriage_return = 13, blank = 32, comma = 44, semicolon = 59

contains

   !> Reads rows until one is not made of plain numbers, the lines end, or the room does.
   pure subroutine parse_rows(bytes, at, last, layout, value, rows, odd)
      !> Holds whole lines up to `last`, a line feed, and more bytes behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of a line; afterwards that of the first line that was not read
      integer(int64), intent(inout) :: at
      !> The last line feed
      integer(int64), intent(in) :: last
      !> The columns
      type(layout_type), intent(in) :: layout
      !> [row, stored column]
      real(dp), intent(inout), contiguous :: value(:, :)
      !> Rows of `value` that are filled
      integer(int64), intent(inout) :: rows
      !> True where the line at `at` needs [[read_row]]
      logical, intent(out) :: odd
      integer(int64) :: p, room
      integer :: j, slot, found
      logical :: stamped

      odd = .false.
      stamped = allocated(layout%kind)
      room = size(value, 1, kind=int64)
      do while (at <= last .and. rows < room)
         p = at
         do j = 1, layout%columns
            do while (bytes(p) == blank .or. bytes(p) == tab)
               p = p + 1
            end do
            slot = layout%slot(j)
            if (stamped) then
               if (layout%kind(j) /= stamp_kind%number) then
                  call scan_time(bytes, p, layout, j, value(rows + 1, :), odd)
                  slot = -1
               end if
            end if
            if (slot == 0) then
               call skip_field(bytes, p, odd)
            else if (slot > 0) then
               call scan_number(bytes, p, value(rows + 1, slot), found)
               odd = found /= number%ok
               if (found == number%none) call scan_missing(bytes, p, value(rows + 1, slot), odd)
            end if
            if (odd) return
            if (bytes(p) == line_feed .and. j == layout%columns) then
               exit
            else if (bytes(p) == blank .or. bytes(p) == tab .or. bytes(p) == carriage_return) then
               do while (bytes(p) == blank .or. bytes(p) == tab .or. bytes(p) == carriage_return)
                  p = p + 1
               end do
               if (bytes(p) == comma .or. bytes(p) == semicolon) p = p + 1
            else if (bytes(p) == comma .or. bytes(p) == semicolon) then
               p = p + 1
            else
               odd = .true.
               return
            end if
         end do
         odd = bytes(p) /= line_feed
         if (odd) return
         rows = rows + 1
         at = p + 1
      end do
   end subroutine parse_rows

   !> Reads a field of a date or a time of day, wanted or not.
   pure subroutine scan_time(bytes, p, layout, column, row, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      real(dp), intent(inout) :: row(:)
      logical, intent(out) :: odd
      real(dp) :: x
      integer :: slot
      logical :: found

      call scan_stamp(bytes, p, abs(layout%kind(column)), layout%origin, x, found)
      odd = .not. found
      slot = layout%slot(column)
      if (odd .or. slot == 0) return
      if (layout%kind(column) < 0) x = x + row(slot)
      row(slot) = x
   end subroutine scan_time

   !> NaN for a field before a comma that is empty, and for a word that stands for a missing number; odd where it is neither.
   pure subroutine scan_missing(bytes, p, value, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      real(dp), intent(out) :: value
      logical, intent(out) :: odd
      integer(int64) :: first

      value = ieee_value(1.0_dp, ieee_quiet_nan)
      first = p
      odd = bytes(p) == line_feed
      if (odd .or. bytes(p) == comma) return
      do while (p < first + longest_word .and. .not. any(bytes(p) == ends))
         p = p + 1
      end do
      odd = .not. is_nan(bytes, first, p)
      if (odd) odd = .not. is_missing_field(bytes, first, p - 1)
      if (odd) p = first
   end subroutine scan_missing

   !> True for the word that is met most, in any case, before a byte.
   pure logical function is_nan(bytes, first, behind)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, behind

      is_nan = behind == first + 3
      if (is_nan) is_nan = ior(int(bytes(first)), 32) == 110 .and. ior(int(bytes(first + 1)), 32) == 97 &
                           .and. ior(int(bytes(first + 2)), 32) == 110
   end function is_nan

   !> Moves behind a field that is not wanted; odd where it is empty, quoted or the start of a comment.
   pure subroutine skip_field(bytes, p, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      logical, intent(out) :: odd
      integer(int64) :: first

      first = p
      odd = .true.
      if (any(bytes(p) == [34_int8, 35_int8, 37_int8, 39_int8, 47_int8])) return
      do
         call skip_digits(bytes, p)
         select case (bytes(p))
         case (tab, line_feed, carriage_return, blank, comma, semicolon); exit
         case default; p = p + 1
         end select
      end do
      odd = p == first .and. bytes(p) /= comma
   end subroutine skip_field

   !> Reads one row of any kind: missing values, quotes, blank fields, comments behind it.
   !>
   !> Thread-safe where `explain` is false: texts of any length are not, in gfortran.
   subroutine read_row(bytes, first, last, layout, fields, row, problem, explain)
      !> Holds the line at first:last, without its end
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> The columns
      type(layout_type), intent(in) :: layout
      !> Room, reused
      type(fields_type), intent(inout) :: fields
      !> [stored column]; NaN where missing
      real(dp), intent(out) :: row(:)
      !> What is wrong
      type(problem_type), intent(out) :: problem
      !> False leaves out the texts
      logical, intent(in) :: explain
      integer(int64) :: comma_at
      integer :: j, slot

      row = ieee_value(1.0_dp, ieee_quiet_nan)
      call split_row(bytes, first, last, split%mixed, layout, fields)
      if (.not. fits(layout, fields) .and. any(bytes(first:last) == tab)) then
         call split_row(bytes, first, last, split%tabs, layout, fields)
         if (.not. fits(layout, fields)) call split_row(bytes, first, last, split%mixed, layout, fields)
      end if
      problem%found = fields%open_quote /= 0 .or. .not. fits(layout, fields)
      if (problem%found .and. .not. explain) return
      if (fields%open_quote /= 0) then
         call set_problem(problem, fields%open_quote, "a quote that is not closed", mend)
      else if (problem%found) then
         comma_at = decimal_comma(bytes, first, last)
         if (comma_at > 0) call set_problem(problem, comma_at, comma_found, comma_advice)
         if (comma_at == 0) call count_problem(bytes, first, last, layout, fields, problem)
      end if
      if (problem%found) return
      do j = 1, min(layout%columns, fields%count)
         slot = layout%slot(j)
         if (slot > 0) call read_field(bytes, fields%first(j), fields%last(j), layout, j, row(slot), problem%found)
         if (.not. problem%found) cycle
         if (explain) call field_problem(bytes, fields%first(j), fields%last(j), layout, j, problem)
         return
      end do
   end subroutine read_row

   !> Splits a row; a date and a time of day that are one column are one field.
   pure subroutine split_row(bytes, first, last, way, layout, fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer, intent(in) :: way
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(inout) :: fields

      call split_line(bytes, first, last, way, fields)
      call join_fields(bytes, layout, fields)
   end subroutine split_row

   !> Makes one field of a date and the time of day behind it, where the layout says that they are one column.
   pure subroutine join_fields(bytes, layout, fields)
      !> Holds the fields
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Its `joined` tells the column
      type(layout_type), intent(in) :: layout
      !> One less where there are two to join
      type(fields_type), intent(inout) :: fields
      integer :: i, j

      j = layout%joined
      if (j == 0 .or. fields%count <= j) return
      if (kind_of_field(bytes, fields%first(j), fields%last(j)) /= stamp_kind%date) return
      if (kind_of_field(bytes, fields%first(j + 1), fields%last(j + 1)) /= stamp_kind%clock) return
      fields%last(j) = fields%last(j + 1)
      fields%count = fields%count - 1
      do i = j + 1, fields%count
         fields%first(i) = fields%first(i + 1)
         fields%last(i) = fields%last(i + 1)
      end do
   end subroutine join_fields

   !> True where the line has the columns of the file.
   pure logical function fits(layout, fields)
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(in) :: fields

      fits = fields%count == layout%columns .or. (fields%count == layout%columns + 1 .and. fields%trailing) &
             .or. (fields%count == layout%columns - 1 .and. layout%last_optional)
   end function fits

   !> The number or stamp in first:last; unchanged where a number is missing, NaN where a stamp is.
   pure subroutine read_field(bytes, first, last, layout, column, value, wrong)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      real(dp), intent(inout) :: value
      !> True where it is no number, or one that is too large
      logical, intent(out) :: wrong
      integer(int64) :: p
      real(dp) :: x
      integer :: found

      wrong = .false.
      if (kind_of(layout, column) /= stamp_kind%number) then
         call read_stamp(bytes, first, last, layout, column, value, wrong)
         return
      end if
      if (last < first) return
      p = first
      call scan_number(bytes, p, x, found)
      if (found /= number%none .and. p == last + 1) then
         value = x
         wrong = found == number%overflow
      else
         wrong = .not. is_missing_field(bytes, first, last)
      end if
   end subroutine read_field

   !> What is expected in a column, a component of stamp_kind.
   pure integer function kind_of(layout, column)
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column

      kind_of = stamp_kind%number
      if (allocated(layout%kind)) kind_of = abs(layout%kind(column))
   end function kind_of

   !> The stamp in first:last, NaN where it is missing.
   pure subroutine read_stamp(bytes, first, last, layout, column, value, wrong)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      real(dp), intent(inout) :: value
      logical, intent(out) :: wrong
      integer(int64) :: p
      integer :: kind, plain
      real(dp) :: x
      logical :: found

      wrong = .false.
      kind = kind_of(layout, column)
      found = .false.
      if (last >= first) then
         p = first
         if (first > 1) then
            if (bytes(first - 1) == 34 .or. bytes(first - 1) == 39) p = first - 1
         end if
         call scan_stamp(bytes, p, kind, layout%origin, x, found)
         if (found) found = p > last .and. p <= last + 2
         if (.not. found .and. kind == stamp_kind%long) then
            p = first
            call scan_number(bytes, p, x, plain)
            found = plain == number%ok .and. p == last + 1
            x = x - real(layout%origin, dp)
         end if
         if (.not. found) wrong = .not. is_missing_field(bytes, first, last)
      end if
      if (found .and. layout%kind(column) < 0) x = value + x
      if (.not. found) x = ieee_value(1.0_dp, ieee_quiet_nan)
      if (.not. wrong) value = x
   end subroutine read_stamp

   !> What is wrong with the field in first:last.
   subroutine field_problem(bytes, first, last, layout, column, problem)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      type(problem_type), intent(inout) :: problem
      character(:), allocatable :: advice
      integer(int64) :: p
      real(dp) :: x
      integer :: found, kind

      kind = kind_of(layout, column)
      if (kind == stamp_kind%long .or. kind == stamp_kind%nano .or. kind == stamp_kind%micro) then
         call set_problem(problem, first, "'"//excerpt(bytes, first, last)//"' is not a number", mend)
         return
      else if (kind /= stamp_kind%number) then
         call set_problem(problem, first, "'"//excerpt(bytes, first, last)//"' is not "//trim(merge("a time of day", &
            "a date       ", kind == stamp_kind%clock))//" as in the first row", mend)
         return
      end if
      p = first
      call scan_number(bytes, p, x, found)
      if (found /= number%none .and. p == last + 1) then
         call set_problem(problem, first, "the number '"//excerpt(bytes, first, last)//"' is too large (at most 1.8e308)", mend)
         return
      end if
      advice = mend//"; --column chooses columns"
      if (index(bytes_text(bytes, first, last), dash) > 0) advice = "the minus sign is not that of ASCII: replace it by '-'"
      if (has_groups(bytes, first, last)) advice = "commas that group digits are not read: take them out"
      if (has_label(bytes, first, last)) advice = "numbers behind labels are not read; take the labels out: "// &
         "sed 's/[A-Za-z_]*[:=]//g' FILE | gyroakf inspect -"
      if (kind_of_field(bytes, first, last) /= stamp_kind%number) advice = "the first row has a number in this column, not a "// &
         "date or a time of day; "//mend
      call set_problem(problem, first, "'"//excerpt(bytes, first, last)//"' is not a number", advice)
   end subroutine field_problem

   !> True for "gx:0.5" and "x=-1".
   pure logical function has_label(bytes, first, last)
      !> The field in first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      integer :: mark

      text = bytes_text(bytes, first, last)
      mark = scan(text, ":=")
      has_label = mark > 1 .and. mark < len(text)
      if (has_label) has_label = verify(text(1:1), "0123456789+-.") > 0 .and. verify(text(mark + 1:), "0123456789+-.eE") == 0
   end function has_label

   !> True for "1,234" and "1,234,567.8".
   pure logical function has_groups(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      integer :: comma_at, whole

      text = bytes_text(bytes, first, last)
      comma_at = index(text, ",", back=.true.)
      whole = scan(text//".", ".") - 1
      has_groups = comma_at > 1 .and. whole == comma_at + 3 .and. verify(text, "+-.,0123456789") == 0
   end function has_groups

   !> The start of a field, for a message.
   pure function excerpt(bytes, first, last) result(text)
      !> The field in first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      integer(int64) :: to

      to = last
      if (last - first >= 40) then
         to = first + 36
         do while (bytes(to + 1) < -64 .and. to > first + 32)
            to = to - 1
         end do
      end if
      text = shown_bytes(bytes, first, to)
      if (to < last) text = text//"..."
   end function excerpt

   !> The problem of a row with another number of columns, at the first field that is too much or at the end.
   subroutine count_problem(bytes, first, last, layout, fields, problem)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(in) :: fields
      type(problem_type), intent(inout) :: problem
      character(:), allocatable :: advice
      integer(int64) :: at

      advice = mend
      if (any(bytes(first:last) == carriage_return)) advice = "a carriage return stands within the line: make all line "// &
                                                              "ends the same, as with tr '\r' '\n'"
      at = last + 1
      if (fields%count > layout%columns) at = fields%first(layout%columns + 1)
      call set_problem(problem, at, integer_text(int(fields%count, int64))//trim(merge(" column ", " columns", fields%count == 1)) &
                       //" where the rows above have "//integer_text(int(layout%columns, int64)), advice)
   end subroutine count_problem

   !> Fills the problem.
   pure subroutine set_problem(problem, at, what, advice)
      type(problem_type), intent(inout) :: problem
      integer(int64), intent(in) :: at
      character(*), intent(in) :: what, advice

      problem%found = .true.
      problem%at = at
      problem%what = what
      problem%advice = advice
   end subroutine set_problem

end module gyroakf_io_rows
