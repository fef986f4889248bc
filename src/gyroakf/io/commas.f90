! SPDX-License-Identifier: MIT
!> What the commas of a table are: separators, or decimal commas in every number or in the seconds of dates alone.
module gyroakf_io_commas
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_format, only : comma_advice, comma_found, decimal_comma
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_place, only : place_error
   use gyroakf_io_stamp_columns, only : comma_mode, decimal_fields, make_points, seconds_comma
   use gyroakf_io_text, only : fields_type, first_visible, is_comment, line_feed_from, split, split_line
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: settle_commas

   !> So many lines at the start are looked at for decimal commas
   integer, parameter :: looked_at = 64

contains

   !> Decides what commas are.
   subroutine settle_commas(lines, last, decimal, names, mode, warnings, error)
      !> The first line of numbers is at hand; decimal commas become points
      type(lines_type), intent(inout) :: lines
      !> Last byte of the first line of numbers
      integer(int64), intent(in) :: last
      !> Every comma is a decimal comma
      logical, intent(in) :: decimal
      !> Of the columns, as far as they are known
      type(column_names_type), intent(in) :: names
      !> A component of [[gyroakf_io_stamp_columns:comma_mode]]
      integer, intent(inout) :: mode
      !> Told where decimal commas were recognised
      type(text_type), allocatable, intent(inout) :: warnings(:)
      !> parse (they may be decimal commas, but not surely)
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields

      if (decimal) then
         mode = comma_mode%decimal
      else if (seconds_comma(lines%bytes, lines%at, last)) then
         mode = comma_mode%seconds
      else
         call split_line(lines%bytes, lines%at, last, split%mixed, fields)
         if (names%known) then
            if (size(names%name) == fields%count) return
         end if
         call recognise_commas(lines, names, mode, warnings, error)
         if (allocated(error)) return
      end if
      if (mode /= comma_mode%separator) call make_points(lines%bytes, lines%at, lines%last, mode)
   end subroutine settle_commas

   !> Looks at the first lines for decimal commas: where every line has them or whole numbers between other separators, they are
   !> read; where they are likely but not sure it is an error, for they would be taken for separators.
   subroutine recognise_commas(lines, names, mode, warnings, error)
      type(lines_type), intent(in) :: lines
      type(column_names_type), intent(in) :: names
      integer, intent(inout) :: mode
      type(text_type), allocatable, intent(inout) :: warnings(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: at, last, likely, likely_at, likely_last
      integer :: i, fields, expected, line
      logical :: sure, commas

      at = lines%at
      expected = 0
      if (names%known) expected = size(names%name)
      sure = .true.
      commas = .false.
      likely = 0
      do i = 0, looked_at - 1
         if (at > lines%last) exit
         last = line_feed_from(lines%bytes, at)
         if (.not. is_comment(lines%bytes, at, last - 1) .and. first_visible(lines%bytes, at, last - 1) < last) then
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
         mode = comma_mode%decimal
         call add_text(warnings, "the commas between digits are read as decimal commas")
      else if (likely > 0) then
         call place_error(error, lines%source%name, lines%number + line, lines%bytes, likely_at, likely_last, likely, &
                          comma_found, comma_advice)
      end if
   end subroutine recognise_commas

end module gyroakf_io_commas
