! SPDX-License-Identifier: MIT
!> Columns of dates and times of day: found from the first row of a table, whatever their names are.
!>
!> A date and a time of day may stand in one field, in two columns, or between blanks where the
!> names or other separators count them as one column.
module gyroakf_io_stamp_columns
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_date, only : is_digit, stamp_kind
   use gyroakf_io_stamp_field, only : kind_of_field, stamp_origin
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_row, only : join_fields
   use gyroakf_io_table, only : set_slots, table_type
   use gyroakf_io_text, only : fields_type
   implicit none (type, external)
   private
   public :: find_joined, find_kinds, pair_stamps

   integer(int8), parameter :: tab = 9, blank = 32, comma = 44, semicolon = 59

contains

   !> Decides whether a date and a time of day between blanks are one column: where the names count
   !> them as one, or, without names, where other separators part the columns. The fields are joined
   !> then.
   pure subroutine find_joined(bytes, first, last, named, layout, fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> How many names the columns have, 0 where none
      integer, intent(in) :: named
      !> Its `joined` is set
      type(layout_type), intent(inout) :: layout
      type(fields_type), intent(inout) :: fields
      integer :: j, count_fields
      logical :: parted

      layout%joined = 0
      count_fields = fields%count - merge(1, 0, fields%trailing)
      if (named > 0 .and. named /= count_fields - 1 .and. named /= count_fields - 2) return
      parted = named > 0
      do j = 1, count_fields - 1
         if (kind_of_field(bytes, fields%first(j), fields%last(j)) /= stamp_kind%date) cycle
         if (any(bytes(fields%last(j) + 1:fields%first(j + 1) - 1) /= blank)) cycle
         if (.not. parted) parted = any(bytes(first:last) == comma .or. &
            bytes(first:last) == semicolon .or. bytes(first:last) == tab)
         if (parted) layout%joined = j
         exit
      end do
      j = fields%count
      call join_fields(bytes, layout, fields)
      if (fields%count == j) layout%joined = 0
   end subroutine find_joined

   !> What each column of the first row holds.
   pure subroutine find_kinds(bytes, fields, layout)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      type(layout_type), intent(inout) :: layout
      integer :: j

      layout%kind = spread(stamp_kind%number, 1, layout%columns)
      do j = 1, min(layout%columns, fields%count)
         layout%kind(j) = kind_of_field(bytes, fields%first(j), fields%last(j))
         if (j == layout%joined) layout%kind(j) = stamp_kind%moment
      end do
   end subroutine find_kinds

   !> Sets where the columns are kept, a date and its time of day together; and the stamps' origin.
   subroutine pair_stamps(bytes, fields, table)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      !> Its columns are chosen; other kinds than the time's become numbers; `origin` is set
      type(table_type), intent(inout) :: table
      integer :: j, wanted, partner

      partner = 0
      associate (kind => table%layout%kind, time => table%time, fraction => table%fraction, &
         chosen => table%chosen)
         do j = 1, size(kind)
            if (kind(j) == stamp_kind%long .and. (j /= time .or. any(chosen == j))) then
               kind(j) = stamp_kind%number
            end if
         end do
         if (time > 0) then
            if (fraction > 0 .and. max(time, fraction) <= fields%count .and. &
               all(chosen /= time .and. chosen /= fraction)) then
               if (all_digits(bytes, fields, time) .and. all_digits(bytes, fields, fraction)) then
                  partner = fraction
                  kind(time) = stamp_kind%long
                  kind(fraction) = merge(stamp_kind%nano, stamp_kind%micro, table%nano)
               end if
            end if
            wanted = stamp_kind%number
            if (kind(time) == stamp_kind%clock) wanted = stamp_kind%date
            if (kind(time) == stamp_kind%date) wanted = stamp_kind%clock
            if (wanted /= stamp_kind%number) partner = findloc(kind, wanted, dim=1)
            j = time
            if (partner > 0 .and. wanted == stamp_kind%date) j = partner
            if (j <= fields%count) call stamp_origin(bytes, fields%first(j), kind(j), &
               table%layout%origin)
            if (partner > 0) kind(max(time, partner)) = -kind(max(time, partner))
         end if
      end associate
      call set_slots(partner, table)
   end subroutine pair_stamps

   pure logical function all_digits(bytes, fields, column)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: column

      associate (first => fields%first(column), last => fields%last(column))
         all_digits = last >= first .and. last - first < 18
         if (all_digits) all_digits = all(is_digit(bytes(first:last)))
      end associate
   end function all_digits

end module gyroakf_io_stamp_columns
