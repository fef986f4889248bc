! SPDX-License-Identifier: MIT
!> Lines of words above the rows of a table: names of the columns and their units.
module gyroakf_io_heading
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_io_columns, only : column_names_type, names_way, read_names, take_brackets_off
   use gyroakf_io_header, only : time_scale
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, last_visible, split_line
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : parse_unit, unit_type
   implicit none (type, external)
   private
   public :: keep_heading, only_words, take_units

contains

   !> Keeps the bytes of the line of names.
   subroutine keep_heading(lines, last, layout)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(layout_type), intent(inout) :: layout
      integer(int64) :: from, to

      from = first_visible(lines%bytes, lines%at, last)
      to = last_visible(lines%bytes, lines%at, last)
      allocate (layout%heading(to - from + 1))
      layout%heading(:) = lines%bytes(from:to)
   end subroutine keep_heading

   !> True for a line that holds words and nothing like a number: names of columns.
   logical function only_words(lines, last)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(fields_type) :: fields
      integer :: i, words

      only_words = .false.
      words = 0
      call split_line(lines%bytes, lines%at, last, names_way(lines%bytes, lines%at, last), fields)
      do i = 1, fields%count
         if (fields%last(i) < fields%first(i)) cycle
         if (begins_like_number(lines%bytes, fields%first(i))) return
         if (.not. is_missing_word(bytes_text(lines%bytes, fields%first(i), fields%last(i)))) words = words + 1
      end do
      only_words = words > 0
   end function only_words

   !> True for a byte that a name does not begin with, and for the minus sign of mathematics (U+2212): what begins so is a number,
   !> right or wrong.
   pure logical function begins_like_number(bytes, at)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at

      begins_like_number = (bytes(at) >= 48 .and. bytes(at) <= 57) .or. bytes(at) == 43 .or. bytes(at) == 45 .or. bytes(at) == 46
      if (bytes(at) == -30_int8) begins_like_number = bytes(at + 1) == -120_int8 .and. bytes(at + 2) == -110_int8
   end function begins_like_number

   !> Takes in a line of units below the names, in brackets or not; not taken where no word of it is a unit.
   subroutine take_units(lines, last, names, taken)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(column_names_type), intent(inout) :: names
      logical, intent(out) :: taken
      type(column_names_type) :: words
      type(unit_type) :: unit
      type(error_type), allocatable :: failed
      integer :: i

      call read_names(lines%bytes, lines%at, last, lines%number, words)
      taken = words%known
      if (taken) taken = size(words%name) == size(names%name)
      if (.not. taken) return
      taken = .false.
      do i = 1, size(words%name)
         if (scan(words%name(i)%text, "[(") == 1) call take_brackets_off(words%name(i)%text)
         call parse_unit(words%name(i)%text, unit, failed)
         taken = taken .or. .not. allocated(failed) .or. time_scale(lower(words%name(i)%text)) > 0.0_dp
      end do
      if (taken) names%unit = words%name
   end subroutine take_units

end module gyroakf_io_heading
