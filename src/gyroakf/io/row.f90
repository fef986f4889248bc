! SPDX-License-Identifier: MIT
!> Rows of any kind, one at a time: missing values, quotes, blank fields, comments behind them; and
!> messages about rows that cannot be read.
module gyroakf_io_row
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_date, only : scan_stamp, stamp_kind
   use gyroakf_io_stamp_field, only : kind_of_field
   use gyroakf_io_commas, only : comma_advice, comma_found, decimal_comma
   use gyroakf_io_rows, only : layout_type, problem_type
   use gyroakf_io_number, only : is_missing_field, number, scan_number
   use gyroakf_io_place, only : integer_text, shown_bytes
   use gyroakf_io_text, only : bytes_text, fields_type, has_fields, split, split_line
   implicit none (type, external)
   private
   public :: read_row, split_row, join_fields, agrees, excerpt

   character(*), parameter :: mend = "mend the line"
   integer(int8), parameter :: tab = 9, carriage_return = 13

contains

   !> Reads one row of any kind: missing values, quotes, blank fields, comments behind it.
   !>
   !> Thread-safe where `explain` is false: texts of any length are not, in gfortran.
   subroutine read_row(bytes, first, last, layout, fields, row, problem, explain)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(inout) :: fields
      !> [stored column]; NaN where missing
      real(dp), intent(out) :: row(:)
      type(problem_type), intent(out) :: problem
      !> False leaves out the texts
      logical, intent(in) :: explain
      integer(int64) :: comma_at
      integer :: j, slot
      logical :: other

      row = ieee_value(1.0_dp, ieee_quiet_nan)
      call split_row(bytes, first, last, layout, fields)
      other = layout%strict
      if (other) other = .not. agrees(bytes, fields, layout)
      problem%found = fields%open_quote /= 0 .or. other .or. .not. fits(layout, fields)
      if (problem%found .and. .not. explain) return
      if (other .and. fields%count >= layout%where_column) then
         j = layout%where_column
         call set_problem(problem, fields%first(j), "'"//excerpt(bytes, fields%first(j), &
            fields%last(j))//"' is a record of another kind than '"//excerpt(layout%where_value, &
            1_int64, size(layout%where_value, kind=int64))//"' above", "read one kind")
      else if (fields%open_quote /= 0) then
         call set_problem(problem, fields%open_quote, "a quote that is not closed", mend)
      else if (problem%found) then
         comma_at = decimal_comma(bytes, first, last)
         if (comma_at > 0) call set_problem(problem, comma_at, comma_found, comma_advice)
         if (comma_at == 0) call count_problem(bytes, first, last, layout, fields, problem)
      end if
      if (problem%found) return
      do j = 1, min(layout%columns, fields%count)
         slot = layout%slot(j)
         if (slot > 0) call read_field(bytes, fields%first(j), fields%last(j), layout, j, &
            row(slot), problem%found)
         if (.not. problem%found) cycle
         if (explain) call field_problem(bytes, fields%first(j), fields%last(j), layout, j, problem)
         return
      end do
   end subroutine read_row

   !> Splits a row; each tab parts fields where that makes as many as there are columns.
   pure subroutine split_row(bytes, first, last, layout, fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      !> Its fields, a date and a time of day joined
      type(fields_type), intent(inout) :: fields
      integer, parameter :: ways(3) = [split%mixed, split%tabs, split%mixed]
      integer :: j

      do j = 1, size(ways)
         call split_line(bytes, first, last, ways(j), fields)
         call join_fields(bytes, layout, fields)
         if (fits(layout, fields)) exit
         if (.not. any(bytes(first:last) == tab)) exit
      end do
   end subroutine split_row

   !> Makes one field of a date and the time of day and zone behind it where the layout joins them.
   pure subroutine join_fields(bytes, layout, fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Its `joined` is the column; as many are joined as there are more than `columns`
      type(layout_type), intent(in) :: layout
      !> One or two less where there are some to join
      type(fields_type), intent(inout) :: fields
      integer :: i, j, behind, most

      j = layout%joined
      if (j == 0) return
      most = min(2, fields%count - j)
      if (layout%columns > 0) most = min(most, max(1, fields%count - layout%columns))
      do behind = most, 1, -1
         if (kind_of_field(bytes, fields%first(j), &
            fields%last(j + behind)) /= stamp_kind%moment) cycle
         fields%last(j) = fields%last(j + behind)
         fields%count = fields%count - behind
         do i = j + 1, fields%count
            fields%first(i) = fields%first(i + behind)
            fields%last(i) = fields%last(i + behind)
         end do
         return
      end do
   end subroutine join_fields

   !> True for a row that meets the layout's condition, as text or as a number.
   pure logical function agrees(bytes, fields, layout)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      !> With `where_column` and `where_value`
      type(layout_type), intent(in) :: layout
      integer(int64) :: p
      real(dp) :: x
      integer :: found

      agrees = .false.
      if (fields%count < layout%where_column) return
      associate (from => fields%first(layout%where_column), to => fields%last(layout%where_column))
         if (to - from + 1 == size(layout%where_value)) agrees = &
            all(bytes(from:to) == layout%where_value)
         if (agrees .or. to < from .or. .not. ieee_is_finite(layout%where_number)) return
         p = from
         call scan_number(bytes, p, x, found)
         agrees = found == number%ok .and. p == to + 1 .and. abs(x - layout%where_number) <= 0.0_dp
      end associate
   end function agrees

   pure logical function fits(layout, fields)
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(in) :: fields

      fits = has_fields(fields, layout%columns) .or. &
         (fields%count == layout%columns - 1 .and. layout%last_optional)
   end function fits

   !> The number or stamp in first:last; unchanged where a number is missing, NaN where a stamp is.
   pure subroutine read_field(bytes, first, last, layout, column, value, wrong)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      real(dp), intent(inout) :: value
      logical, intent(out) :: wrong
      integer(int64) :: p
      real(dp) :: x
      integer :: kind, found
      logical :: stamped

      wrong = .false.
      stamped = .false.
      kind = abs(layout%kind(column))
      p = first
      if (last < first) then
         continue
      else if (kind == stamp_kind%number) then
         call scan_number(bytes, p, x, found)
         if (found /= number%none .and. p == last + 1) then
            value = x
            wrong = found == number%overflow
         else
            wrong = .not. is_missing_field(bytes, first, last)
         end if
      else
         if (first > 1) then
            if (bytes(first - 1) == 34 .or. bytes(first - 1) == 39) p = first - 1
         end if
         call scan_stamp(bytes, p, kind, layout%origin, x, stamped)
         if (stamped) stamped = p > last .and. p <= last + 2
         if (.not. stamped .and. kind == stamp_kind%long) then
            p = first
            call scan_number(bytes, p, x, found)
            stamped = found == number%ok .and. p == last + 1
            x = x - real(layout%origin, dp)
         end if
         if (.not. stamped) wrong = .not. is_missing_field(bytes, first, last)
      end if
      if (kind == stamp_kind%number .or. wrong) return
      if (stamped .and. layout%kind(column) < 0) x = value + x
      if (.not. stamped) x = ieee_value(1.0_dp, ieee_quiet_nan)
      value = x
   end subroutine read_field

   subroutine field_problem(bytes, first, last, layout, column, problem)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer, intent(in) :: column
      type(problem_type), intent(inout) :: problem
      character(:), allocatable :: text, what, advice
      integer(int64) :: p
      real(dp) :: x
      integer :: found, kind

      kind = abs(layout%kind(column))
      text = bytes_text(bytes, first, last)
      what = "'"//excerpt(bytes, first, last)//"'"
      advice = mend
      p = first
      call scan_number(bytes, p, x, found)
      if (kind == stamp_kind%clock) then
         what = what//" is not a time of day as in the first row"
      else if (any(kind == [stamp_kind%date, stamp_kind%moment])) then
         what = what//" is not a date as in the first row"
      else if (kind == stamp_kind%number .and. found /= number%none .and. p == last + 1) then
         what = "the number "//what//" is too large (at most 1.8e308)"
      else
         what = what//" is not a number"
         if (kind /= stamp_kind%number) then
            continue
         else if (kind_of_field(bytes, first, last) /= stamp_kind%number) then
            advice = "the first row has a number in this column, not a date or a time of day; "// &
               mend
         else if (has_label(text)) then
            advice = "the labels are not those of the first row; "//mend
         else if (last > first .and. verify(text, "0123456789ABCDEFabcdef") == 0) then
            advice = "hexadecimal digits are not read: decode them into numbers first"
         else if (has_groups(text)) then
            advice = "commas that group digits are not read: take them out"
         else if (index(text, char(226)//char(136)//char(146)) > 0) then                 ! U+2212
            advice = "the minus sign is not that of ASCII: replace it by '-'"
         end if
      end if
      call set_problem(problem, first, what, advice)
   end subroutine field_problem

   !> True for "gx:0.5" and "x=-1".
   pure logical function has_label(text)
      character(*), intent(in) :: text
      integer :: mark

      mark = scan(text, ":=")
      has_label = mark > 1 .and. mark < len(text)
      if (has_label) has_label = verify(text(1:1), "0123456789+-.") > 0 .and. &
         verify(text(mark + 1:), "0123456789+-.eE") == 0
   end function has_label

   !> True for "1,234" and "1,234,567.8".
   pure logical function has_groups(text)
      character(*), intent(in) :: text
      integer :: comma_at

      comma_at = index(text, ",", back=.true.)
      has_groups = comma_at > 1 .and. scan(text//".", ".") == comma_at + 4 .and. &
         verify(text, "+-.,0123456789") == 0
   end function has_groups

   !> How many bytes of a field [[excerpt]] shows: no character is cut.
   pure integer(int64) function shown_length(field) result(length)
      integer(int8), intent(in), contiguous :: field(:)

      length = size(field, kind=int64)
      if (length <= 40) return
      length = 37
      do while (field(length + 1) < -64 .and. length > 33)
         length = length - 1
      end do
   end function shown_length

   !> The start of a field, for a message.
   pure function excerpt(bytes, first, last) result(text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(shown_length(bytes(first:last)) &
         + 3*count([shown_length(bytes(first:last)) < last - first + 1])) :: text

      text = shown_bytes(bytes, first, first + shown_length(bytes(first:last)) - 1)
      if (len(text) > shown_length(bytes(first:last))) text(len(text) - 2:) = "..."
   end function excerpt

   !> Another number of columns: a problem at the first field that is too much or at the end.
   subroutine count_problem(bytes, first, last, layout, fields, problem)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      type(fields_type), intent(in) :: fields
      type(problem_type), intent(inout) :: problem
      character(:), allocatable :: advice
      integer(int64) :: at

      advice = mend
      if (any(bytes(first:last) == carriage_return)) advice = &
         "a carriage return stands within the line: make all line ends the same"
      at = last + 1
      if (fields%count > layout%columns) at = fields%first(layout%columns + 1)
      call set_problem(problem, at, integer_text(fields%count)//trim(merge(" column ", " columns", &
         fields%count == 1)) //" where the rows above have "//integer_text(layout%columns), advice)
   end subroutine count_problem

   pure subroutine set_problem(problem, at, what, advice)
      type(problem_type), intent(inout) :: problem
      integer(int64), intent(in) :: at
      character(*), intent(in) :: what, advice

      problem%found = .true.
      problem%at = at
      problem%what = what
      problem%advice = advice
   end subroutine set_problem

end module gyroakf_io_row
