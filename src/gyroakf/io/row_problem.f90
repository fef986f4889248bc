! SPDX-License-Identifier: MIT
!> Messages about rows that cannot be read: what is wrong, and what to do.
module gyroakf_io_row_problem
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_stamp_field, only : kind_of_field
   use gyroakf_io_layout, only : layout_type, problem_type
   use gyroakf_io_number, only : number, scan_number
   use gyroakf_io_place, only : integer_text, shown_bytes
   use gyroakf_io_text, only : bytes_text, fields_type
   implicit none (type, external)
   private
   public :: count_problem, field_problem, excerpt, set_problem, mend

   !> The minus sign of mathematics, in UTF-8
   character(*), parameter :: dash = char(226)//char(136)//char(146)
   character(*), parameter :: mend = "mend the line"
   integer(int8), parameter :: carriage_return = 13

contains

   !> What is wrong with the field in first:last.
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
         else if (index(text, dash) > 0) then
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

end module gyroakf_io_row_problem
