! SPDX-License-Identifier: MIT
!> Dates and times of day in text, read as seconds from a day that the caller names.
!>
!> Read are the forms of ISO 8601 that loggers write: `2026-05-01T12:00:00.123456Z`, a blank instead
!> of the T, `/` or `.` between year, month and day, a zone (`Z`, `+02:00`, `-0530`, `+02`), a comma
!> before the decimals within quotes, a colon before three of them; a date or a time of day alone;
!> `01.05.2026`, `20260501120000020`, `20260501_120000.020`, `12-00-00_020`. Days first with `/` or
!> `-` are not read: they may be months.
!>
!> Whole seconds are subtracted as integers before they become a real number, so that the decimals
!> survive: a day after the first stamp a double still resolves 15 ps.
module gyroakf_io_date
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_wide_power, only : ten
   implicit none (type, external)
   private
   public :: stamp_kind, scan_stamp, scan_long, scan_digits, is_digit, day_number

   !> What a column holds, reached as `stamp_kind%clock`
   type :: stamp_kind_enum
      !> A number like any other
      integer :: number = 0
      !> A date and a time of day
      integer :: moment = 1
      !> A date alone
      integer :: date = 2
      !> A time of day alone
      integer :: clock = 3
      !> A number of more digits than a double has: whole part exact, counted from the first
      integer :: long = 4
      !> The whole nanoseconds or microseconds beside a column of whole seconds
      integer :: nano = 5, micro = 6
   end type stamp_kind_enum

   !> All kinds
   type(stamp_kind_enum), parameter :: stamp_kind = stamp_kind_enum()

   integer(int8), parameter :: blank = 32, quote = 34, apostrophe = 39, plus = 43, comma = 44, &
      minus = 45, point = 46, slash = 47, zero = 48, nine = 57, colon = 58, letter_t = 84, &
      underscore = 95

contains

   !> The stamp that begins at a byte.
   !>
   !> Thread-safe, no allocation. Whether what follows may follow is the caller's business.
   pure subroutine scan_stamp(bytes, at, kind, origin, value, found)
      !> The text; a line feed behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of the stamp or its quote; afterwards the byte behind it, unless not found
      integer(int64), intent(inout) :: at
      !> One of the components of [[gyroakf_io_date:stamp_kind]], not `number`
      integer, intent(in) :: kind
      !> Counted from this day (1970-01-01 is 0), or from this whole number
      integer(int64), intent(in) :: origin
      !> s from the beginning of the day `origin`; of a long number what it is above `origin`
      real(dp), intent(out) :: value
      logical, intent(out) :: found
      integer(int64) :: p, whole, day
      integer(int8) :: mark
      real(dp) :: part

      value = 0.0_dp
      p = at
      mark = 0
      whole = 0
      part = 0.0_dp
      if (bytes(p) == quote .or. bytes(p) == apostrophe) then
         mark = bytes(p)
         p = p + 1
      end if
      select case (kind)
      case (stamp_kind%long, stamp_kind%nano, stamp_kind%micro)
         call scan_long(bytes, p, whole, part, found)
         if (kind == stamp_kind%long) whole = whole - origin
      case (stamp_kind%clock)
         call scan_clock(bytes, p, mark /= 0, .false., whole, part, found)
      case default
         call scan_day(bytes, p, day, found)
         if (found .and. kind == stamp_kind%moment) call scan_time_behind(bytes, p, mark /= 0, &
            whole, part, found)
         whole = whole + (day - origin)*86400
      end select
      if (found .and. mark /= 0) then
         found = bytes(p) == mark
         p = p + 1
      end if
      if (.not. found) return
      value = real(whole, dp) + part
      if (kind == stamp_kind%nano) value = 1.0e-9_dp*value
      if (kind == stamp_kind%micro) value = 1.0e-6_dp*value
      at = p
   end subroutine scan_stamp

   !> `Y-M-D`, `Y/M/D`, `Y.M.D`, `D.M.Y`, four digits for Y; YYYYMMDD of 1970 to 2099 and a time.
   pure subroutine scan_day(bytes, p, day, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      integer(int64), intent(out) :: day
      logical, intent(out) :: found
      integer(int64) :: part(3)
      integer :: digits(3), i, first
      integer(int8) :: parts

      parts = minus
      day = 0
      found = .false.
      do i = 1, 3
         call scan_digits(bytes, p, merge(2, 4, i > 1 .and. parts == zero), part(i), digits(i))
         if (digits(i) == 0) return
         if (i == 3) exit
         if (i == 1) parts = merge(zero, bytes(p), is_digit(bytes(p)))
         if (parts == zero) cycle
         if (bytes(p) /= parts .or. all(parts /= [minus, slash, point])) return
         p = p + 1
      end do
      first = 1
      if (digits(1) /= 4) first = 3
      if (first == 3 .and. parts /= point) return
      if (parts == zero) then
         if (part(1) < 1970 .or. part(1) > 2099) return
         if (.not. (is_digit(bytes(p)) .or. any(bytes(p) == [underscore, letter_t]))) return
      end if
      if (digits(first) /= 4 .or. digits(2) > 2 .or. digits(4 - first) > 2) return
      if (part(2) < 1 .or. part(2) > 12 .or. part(4 - first) < 1) return
      day = day_number(int(part(first)), int(part(2)), int(part(4 - first)))
      found = day < day_number(int(part(first)), int(part(2)) + 1, 1)   ! in the month
   end subroutine scan_day

   !> Digits, at most so many.
   pure subroutine scan_digits(bytes, p, most_digits, value, digits)
      !> The text; a line feed behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte; afterwards the byte behind what was read
      integer(int64), intent(inout) :: p
      !> How many are read at most
      integer, intent(in) :: most_digits
      !> The number, and how many digits it has
      integer(int64), intent(out) :: value
      integer, intent(out) :: digits

      value = 0
      digits = 0
      do while (is_digit(bytes(p)) .and. digits < most_digits)
         value = 10*value + (bytes(p) - zero)
         digits = digits + 1
         p = p + 1
      end do
   end subroutine scan_digits

   !> True for 0 to 9.
   pure elemental logical function is_digit(byte)
      integer(int8), intent(in) :: byte

      is_digit = byte >= zero .and. byte <= nine
   end function is_digit

   !> The time behind a date and T, _ or blanks, or digits behind digits; none is midnight.
   pure subroutine scan_time_behind(bytes, p, quoted, whole, part, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      logical, intent(in) :: quoted
      integer(int64), intent(inout) :: whole
      real(dp), intent(inout) :: part
      logical, intent(out) :: found
      integer(int64) :: q

      q = p
      found = .true.
      do while (bytes(q) == blank)
         q = q + 1
      end do
      if (any(bytes(p) == [letter_t, letter_t + 32_int8, underscore])) then
         q = p + 1
      else if (is_digit(bytes(p))) then
         q = p
      else if (q == p .or. (bytes(q + 1) /= colon .and. .not. (is_digit(bytes(q + 1)) .and. &
         bytes(q + 2) == colon))) then
         return
      end if
      p = q
      call scan_clock(bytes, p, quoted, .true., whole, part, found)
   end subroutine scan_time_behind

   !> `h:mm`, `h:mm:ss`, `hh-mm-ss_mmm`, and hhmmss behind a date; decimals of the seconds, a zone.
   pure subroutine scan_clock(bytes, p, quoted, dated, whole, part, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      logical, intent(in) :: quoted, dated
      integer(int64), intent(out) :: whole
      real(dp), intent(out) :: part
      logical, intent(out) :: found
      integer(int64) :: hour, minute, second
      integer(int8) :: parts
      integer :: digits
      logical :: decimals

      whole = 0
      part = 0.0_dp
      found = .false.
      call scan_digits(bytes, p, 2, hour, digits)
      parts = bytes(p)
      if (digits == 0 .or. hour > 24) return
      if (.not. (parts == colon .or. parts == minus .or. (dated .and. is_digit(parts)))) return
      if (.not. is_digit(parts)) p = p + 1
      call scan_digits(bytes, p, 2, minute, digits)
      if (digits /= 2 .or. minute > 59) return
      second = 0
      if (is_digit(parts)) p = p - 1
      if (bytes(p) == parts .or. is_digit(parts)) then
         p = p + 1
         call scan_digits(bytes, p, 2, second, digits)
         if (digits /= 2 .or. second > 60) return
         if (parts == minus .and. .not. dated .and. bytes(p) /= underscore) return
         decimals = any(bytes(p) == [point, underscore]) .or. is_digit(bytes(p)) .or. &
            (quoted .and. bytes(p) == comma)
         if (bytes(p) == colon) decimals = &
            all(is_digit(bytes(p + 1:min(p + 3, size(bytes, kind=int64)))))
         if (is_digit(parts) .and. is_digit(bytes(p))) p = p - 1
         if (decimals) call scan_decimals(bytes, p, part)
      else if (parts == minus) then
         return
      end if
      whole = 3600*hour + 60*minute + second
      call scan_zone(bytes, p, whole, found)
   end subroutine scan_clock

   !> `.123456`: the digits behind a point, the first 18 of them.
   pure subroutine scan_decimals(bytes, p, part)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p
      real(dp), intent(out) :: part
      integer(int64) :: value
      integer :: digits

      p = p + 1
      call scan_digits(bytes, p, 18, value, digits)
      do while (is_digit(bytes(p)))
         p = p + 1
      end do
      part = real(value, dp)/real(ten(digits), dp)
   end subroutine scan_decimals

   !> `Z` or the hours and minutes that the clock is ahead of universal time, behind a blank where a
   !> comma, semicolon or tab follows; none leaves the time as it is.
   pure subroutine scan_zone(bytes, p, whole, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, whole
      logical, intent(out) :: found
      integer(int64) :: hour, minute
      integer(int8), parameter :: tab = 9, semicolon = 59
      integer :: digits, ahead

      found = .true.
      if (bytes(p) == blank .and. p + 6 <= size(bytes, kind=int64)) then
         if (all(bytes(p + 1) /= [plus, minus]) .or. .not. is_digit(bytes(p + 2))) return
         if (.not. all(is_digit(bytes(p + 3:p + 5)))) return
         if (all(bytes(p + 6) /= [comma, semicolon, tab])) return
         p = p + 1
      end if
      if (bytes(p) == iachar("Z") .or. bytes(p) == iachar("z")) p = p + 1
      if (bytes(p) /= plus .and. bytes(p) /= minus) return
      ahead = merge(1, -1, bytes(p) == plus)
      p = p + 1
      call scan_digits(bytes, p, 2, hour, digits)
      found = digits == 2 .and. hour <= 15
      minute = 0
      if (bytes(p) == colon .or. is_digit(bytes(p))) then
         if (bytes(p) == colon) p = p + 1
         call scan_digits(bytes, p, 2, minute, digits)
      end if
      found = found .and. digits == 2 .and. minute <= 59
      whole = whole - ahead*(3600*hour + 60*minute)
   end subroutine scan_zone

   !> A number without an exponent, at most 18 digits before its point, or 19 up to 4.6e18.
   pure subroutine scan_long(bytes, p, whole, part, found)
      !> The text; a line feed behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte; afterwards the byte behind what was read
      integer(int64), intent(inout) :: p
      integer(int64), intent(out) :: whole
      real(dp), intent(out) :: part
      logical, intent(out) :: found
      logical :: below
      integer :: digits

      part = 0.0_dp
      below = bytes(p) == minus
      if (below .or. bytes(p) == plus) p = p + 1
      call scan_digits(bytes, p, 18, whole, digits)
      if (is_digit(bytes(p)) .and. whole < 461168601842738789_int64) then
         whole = 10*whole + (bytes(p) - zero)
         p = p + 1
      end if
      found = digits > 0
      if (.not. found) return
      if (bytes(p) == point) call scan_decimals(bytes, p, part)
      found = .not. (is_digit(bytes(p)) .or. bytes(p) == iachar("e") .or. bytes(p) == iachar("E"))
      part = merge(-part, part, below)
      whole = merge(-whole, whole, below)
   end subroutine scan_long

   !> Days from 1970-01-01, Gregorian: years begin in March and end with the leap day.
   pure integer(int64) function day_number(year, month, day)
      !> Year 0 to 9999, month 1 to 13, day 1 to 31
      integer, intent(in) :: year, month, day
      integer(int64) :: y

      y = year - merge(1, 0, month < 3) + 400
      day_number = 365*y + y/4 - y/100 + y/400 + (153*modulo(month - 3, 12) + 2)/5 + day - 1 &
         - 719468 - 146097
   end function day_number

end module gyroakf_io_date
