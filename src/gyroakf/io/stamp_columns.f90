! SPDX-License-Identifier: MIT
!> Columns of dates and times of day: found from the first row of a table, whatever their names are.
!>
!> A date and a time of day may stand in one field, in two columns, or between blanks where the names or other separators count
!> them as one column.
module gyroakf_io_stamp_columns
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_date, only : kind_of_field, is_day_first, is_digit, stamp_kind, stamp_origin
   use gyroakf_io_rows, only : join_fields, layout_type
   use gyroakf_io_text, only : fields_type
   implicit none (type, external)
   private
   public :: find_joined, find_kinds, pair_stamps, ambiguous_date, date_advice

   !> What to do about a date that may be either
   character(*), parameter :: date_advice = "write the year first, as in 2026-05-01, or leave the column out"

   integer(int8), parameter :: tab = 9, blank = 32, comma = 44, semicolon = 59

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

      layout%kind = spread(stamp_kind%number, 1, columns)
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
         if (all_digits) all_digits = all(is_digit(bytes(first:last)))
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

end module gyroakf_io_stamp_columns
