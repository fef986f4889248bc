! SPDX-License-Identifier: MIT
!> What a field of text is: a date, a time of day, a long number, or a number like any other.
module gyroakf_io_stamp_field
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_date, only : is_digit, scan_digits, scan_long, scan_stamp, stamp_kind
   implicit none (type, external)
   private
   public :: kind_of_field, stamp_origin, is_day_first

   integer(int8), parameter :: blank = 32, quote = 34, apostrophe = 39, minus = 45, slash = 47, &
      zero = 48

contains

   !> What a field is: a stamp, or a number like any other (as which whatever else passes too).
   pure integer function kind_of_field(bytes, first, last) result(kind)
      !> Holds the field at first:last; a separator or line feed behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p, from
      integer :: digits, k
      integer, parameter :: tried(3) = [stamp_kind%clock, stamp_kind%date, stamp_kind%moment]
      real(dp) :: value
      logical :: found

      kind = stamp_kind%number
      if (last < first) return
      if (.not. is_digit(bytes(first))) return
      from = first
      if (first > 1) then
         if (bytes(first - 1) == quote .or. bytes(first - 1) == apostrophe) from = first - 1
      end if
      do k = 1, size(tried)
         p = from
         call scan_stamp(bytes, p, tried(k), 0_int64, value, found)
         if (.not. found .or. p /= last + 1 + (first - from)) cycle
         kind = tried(k)
         return
      end do
      p = first
      call scan_stamp(bytes, p, stamp_kind%long, 0_int64, value, found)
      if (.not. found .or. p /= last + 1) return
      digits = int(count(bytes(first:last) >= zero))
      if (digits > 15) kind = stamp_kind%long
   end function kind_of_field

   !> From what the stamps of a column are counted: the day of its first field, or its whole part.
   pure subroutine stamp_origin(bytes, first, kind, origin)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first
      !> As of [[kind_of_field]]
      integer, intent(in) :: kind
      !> 0 for a time of day
      integer(int64), intent(out) :: origin
      integer(int64) :: p
      real(dp) :: part
      logical :: found

      origin = 0
      p = first
      select case (kind)
      case (stamp_kind%moment, stamp_kind%date)
         call scan_stamp(bytes, p, stamp_kind%date, 0_int64, part, found)
         if (found) origin = nint(part/86400.0_dp, int64)
      case (stamp_kind%long); call scan_long(bytes, p, origin, part, found)
      case default; continue
      end select
   end subroutine stamp_origin

   !> True for `01/05/2026` or `1-5-26`: the order of day and month is ambiguous.
   pure logical function is_day_first(bytes, first, last)
      !> Holds the field at first:last; a separator or line feed behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p
      integer(int64) :: value
      integer :: digits(3), i

      is_day_first = .false.
      p = first
      do i = 1, 3
         if (p > last) return
         call scan_digits(bytes, p, 4, value, digits(i))
         if (digits(i) == 0) return
         if (i == 3) exit
         if (bytes(p) /= slash .and. bytes(p) /= minus) return
         p = p + 1
      end do
      is_day_first = digits(1) <= 2 .and. digits(2) <= 2 .and. &
         (digits(3) == 4 .or. digits(3) == 2) .and. (p == last + 1 .or. &
         bytes(p) == iachar("T") .or. bytes(p) == blank)
   end function is_day_first

end module gyroakf_io_stamp_field
