! SPDX-License-Identifier: MIT
!> Columns of dates and times of day: found from the first row of a table, whatever their names are.
!>
!> A date and a time of day may stand in one field, in two columns, or between blanks where the names or other separators count
!> them as one column.
module gyroakf_io_stamp_columns
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_date, only : kind_of_field, is_day_first, is_digit, stamp_kind, stamp_origin
   use gyroakf_io_rows, only : join_fields, layout_type
   use gyroakf_io_text, only : fields_type, first_visible, last_visible
   implicit none (type, external)
   private
   public :: find_joined, find_kinds, pair_stamps, ambiguous_date, date_advice
   public :: comma_mode, seconds_comma, decimal_fields, make_points

   !> What commas are, reached as `comma_mode%decimal`
   type :: comma_mode_enum
      !> They part columns
      integer :: separator = 0
      !> Every comma is a decimal comma
      integer :: decimal = 1
      !> Those behind the seconds of a time of day are decimal commas
      integer :: seconds = 2
   end type comma_mode_enum

   !> All modes
   type(comma_mode_enum), parameter :: comma_mode = comma_mode_enum()

   !> What to do about a date that may be either
   character(*), parameter :: date_advice = "write the year first, as in 2026-05-01, or leave the column out"

   integer(int8), parameter :: tab = 9, blank = 32, quote = 34, apostrophe = 39, comma = 44, point = 46, semicolon = 59, colon = 58

contains

   !> Decides whether a date and a time of day between blanks are one column: where the names count them as one, or, without
   !> names, where other separators part the columns. The fields are joined then.
   pure subroutine find_joined(bytes, first, last, named, layout, fields)
      !> Holds the first row at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> How many names the columns have, 0 where none
      integer, intent(in) :: named
      !> Its `joined` is set
      type(layout_type), intent(inout) :: layout
      !> Of the row
      type(fields_type), intent(inout) :: fields
      integer :: j, count_fields
      logical :: parted

      layout%joined = 0
      count_fields = fields%count - merge(1, 0, fields%trailing)
      if (named > 0 .and. named /= count_fields - 1) return
      parted = named > 0
      do j = 1, count_fields - 1
         if (kind_of_field(bytes, fields%first(j), fields%last(j)) /= stamp_kind%date) cycle
         if (kind_of_field(bytes, fields%first(j + 1), fields%last(j + 1)) /= stamp_kind%clock) cycle
         if (any(bytes(fields%last(j) + 1:fields%first(j + 1) - 1) /= blank)) cycle
         if (.not. parted) parted = any(bytes(first:last) == comma .or. bytes(first:last) == semicolon .or. &
                                        bytes(first:last) == tab)
         if (parted) layout%joined = j
         exit
      end do
      call join_fields(bytes, layout, fields)
   end subroutine find_joined

   !> What each column of the first row holds.
   pure subroutine find_kinds(bytes, fields, columns, layout)
      !> Holds the fields
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Of the first row, joined
      type(fields_type), intent(in) :: fields
      !> Columns of the file
      integer, intent(in) :: columns
      !> Its `kind` is set
      type(layout_type), intent(inout) :: layout
      integer :: j

      if (allocated(layout%kind)) deallocate (layout%kind)
      allocate (layout%kind(columns))
      layout%kind(:) = stamp_kind%number
      do j = 1, min(columns, fields%count)
         layout%kind(j) = kind_of_field(bytes, fields%first(j), fields%last(j))
         if (j == layout%joined) layout%kind(j) = stamp_kind%moment
      end do
   end subroutine find_kinds

   !> The date that belongs to a time of day, or the reverse, and from what the stamps are counted.
   pure subroutine pair_stamps(bytes, fields, time, chosen, fraction, nano, layout, partner)
      !> Holds the fields
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Of the first row
      type(fields_type), intent(in) :: fields
      !> The column of the time, 0 for none
      integer, intent(in) :: time
      !> The columns of the record
      integer, intent(in) :: chosen(:)
      !> The column of fractions of the time's seconds, 0 for none, and whether these are nanoseconds
      integer, intent(in) :: fraction
      logical, intent(in) :: nano
      !> Kinds of other columns than these become those of numbers where they can; `origin` is set
      type(layout_type), intent(inout) :: layout
      !> The other column, 0 for none
      integer, intent(out) :: partner
      integer :: j, wanted

      partner = 0
      do j = 1, size(layout%kind)
         if (layout%kind(j) == stamp_kind%long .and. (j /= time .or. any(chosen == j))) layout%kind(j) = stamp_kind%number
      end do
      if (time == 0) return
      if (fraction > 0 .and. max(time, fraction) <= fields%count .and. .not. any(chosen == time .or. chosen == fraction)) then
         if (all_digits(bytes, fields, time) .and. all_digits(bytes, fields, fraction)) then
            partner = fraction
            layout%kind(time) = stamp_kind%long
            layout%kind(fraction) = merge(stamp_kind%nano, stamp_kind%micro, nano)
         end if
      end if
      wanted = stamp_kind%number
      if (layout%kind(time) == stamp_kind%clock) wanted = stamp_kind%date
      if (layout%kind(time) == stamp_kind%date) wanted = stamp_kind%clock
      if (wanted /= stamp_kind%number) partner = findloc(layout%kind, wanted, dim=1)
      j = time
      if (partner > 0 .and. wanted == stamp_kind%date) j = partner
      if (j <= fields%count) call stamp_origin(bytes, fields%first(j), layout%kind(j), layout%origin)
      if (partner > 0) layout%kind(max(time, partner)) = -layout%kind(max(time, partner))
   end subroutine pair_stamps

   !> True where a field is a whole number.
   pure logical function all_digits(bytes, fields, column)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: column

      associate (first => fields%first(column), last => fields%last(column))
         all_digits = last >= first .and. last - first < 18
         if (all_digits) all_digits = all(bytes(first:last) >= 48 .and. bytes(first:last) <= 57)
      end associate
   end function all_digits

   !> The first field of a row that is a date with the day or the month first, 0 where there is none.
   pure integer function ambiguous_date(bytes, fields) result(column)
      !> Holds the fields
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Of the first row
      type(fields_type), intent(in) :: fields

      do column = 1, fields%count
         if (fields%last(column) < fields%first(column)) cycle
         if (is_day_first(bytes, fields%first(column), fields%last(column))) return
      end do
      column = 0
   end function ambiguous_date

   !> True where a comma stands before the decimals of the seconds, as in `12:00:00,123;1.5`: 3, 6 or 9 digits, perhaps a zone, then
   !> a blank, tab or semicolon; and no comma parts columns.
   pure logical function seconds_comma(bytes, first, last)
      !> Holds the first row at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p, q
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
         do while (in_zone(bytes(q)))
            q = q + 1
         end do
         if (q > last) return
         if (bytes(q) /= blank .and. bytes(q) /= tab .and. bytes(q) /= semicolon) return
         seconds_comma = .true.
      end do
   end function seconds_comma

   !> Columns of a row between semicolons, tabs or blanks where every comma in it may be a decimal comma: between two digits, one
   !> at most in a field, and no decimal points but in dates and times of day; 0 where one cannot be.
   pure integer function decimal_fields(bytes, first, last) result(fields)
      !> Holds the row at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p, from, to
      integer :: commas, points, colons
      integer(int8) :: parts
      logical :: at_end

      fields = 0
      from = first_visible(bytes, first, last)
      to = last_visible(bytes, first, last)
      parts = blank
      if (any(bytes(from:to) == tab)) parts = tab
      if (any(bytes(from:to) == semicolon)) parts = semicolon
      commas = 0
      points = 0
      colons = 0
      do p = from, to + 1
         at_end = p > to
         if (.not. at_end) at_end = bytes(p) == blank .or. bytes(p) == tab .or. bytes(p) == semicolon
         if (at_end) then
            if (points == 2 .and. colons > 0) points = 0                ! of a date before a time of day
            if (commas > 1 .or. (points > 0 .and. commas > 0) .or. (points > 0 .and. colons == 0 .and. points /= 2) .or. &
                (colons > 0 .and. commas > 0 .and. p > to)) then
               fields = 0
               return
            end if
            commas = 0
            points = 0
            colons = 0
            if (p > to) then
               if (bytes(to) /= parts) fields = fields + 1
            else if (bytes(p) == parts .and. (parts /= blank .or. bytes(p + 1) /= blank)) then
               fields = fields + 1
            end if
            cycle
         end if
         if (bytes(p) == point) points = points + 1
         if (bytes(p) == colon) colons = colons + 1
         if (bytes(p) /= comma) cycle
         commas = commas + 1
         if (p > from .and. p < to) then
            if (is_digit(bytes(p - 1)) .and. is_digit(bytes(p + 1))) cycle
         end if
         fields = 0
         return
      end do
   end function decimal_fields

   !> True for a comma behind `:dd` and before a digit.
   pure logical function behind_seconds(bytes, p, first)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, first

      behind_seconds = .false.
      if (p < first + 3) return
      behind_seconds = bytes(p - 3) == colon .and. is_digit(bytes(p - 2)) .and. is_digit(bytes(p - 1)) .and. is_digit(bytes(p + 1))
   end function behind_seconds

   !> True for a byte of a zone behind a time of day: Z, +02:00.
   pure logical function in_zone(byte)
      integer(int8), intent(in) :: byte

      in_zone = is_digit(byte) .or. byte == iachar("Z") .or. byte == iachar("z") .or. byte == iachar("+") .or. &
                byte == iachar("-") .or. byte == colon
   end function in_zone

   !> Writes points for decimal commas; doing it twice does no harm.
   pure subroutine make_points(bytes, first, last, mode)
      !> Lines at first:last, a line feed at last
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> One of the components of [[gyroakf_io_stamp_columns:comma_mode]]
      integer, intent(in) :: mode
      integer(int64) :: i

      if (mode == comma_mode%decimal) then
         do i = first, last
            bytes(i) = merge(point, bytes(i), bytes(i) == comma)
         end do
      else if (mode == comma_mode%seconds) then
         do i = first, last
            if (bytes(i) /= comma) cycle
            if (behind_seconds(bytes, i, first)) bytes(i) = point
         end do
      end if
   end subroutine make_points

end module gyroakf_io_stamp_columns
