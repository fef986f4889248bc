! SPDX-License-Identifier: MIT
!> Days of the Gregorian calendar.
module gyroakf_io_calendar
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: day_number, day_text, month_days

   integer(int64), parameter :: day_seconds = 86400

contains

   !> Days from 1970-01-01 in the Gregorian calendar: years that begin in March have the leap day at their end.
   pure integer(int64) function day_number(year, month, day)
      !> Year 0 to 9999, month 1 to 12, day 1 to 31
      integer, intent(in) :: year, month, day
      integer(int64) :: y, m

      m = modulo(month - 3, 12)
      y = year
      if (month < 3) y = y - 1
      day_number = 365*y + floor_ratio(y, 4) - floor_ratio(y, 100) + floor_ratio(y, 400) + (153*m + 2)/5 + day - 1 - 719468
   end function day_number

   !> Quotient rounded down.
   pure integer(int64) function floor_ratio(y, by)
      integer(int64), intent(in) :: y
      integer, intent(in) :: by

      floor_ratio = (y - modulo(y, int(by, int64)))/by
   end function floor_ratio

   !> Days of a month.
   pure integer function month_days(year, month)
      !> Year 0 to 9999, month 1 to 12
      integer, intent(in) :: year, month
      integer, parameter :: days(12) = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31]

      month_days = days(month)
      if (month == 2 .and. modulo(year, 4) == 0 .and. (modulo(year, 100) /= 0 .or. modulo(year, 400) == 0)) month_days = 29
   end function month_days

   !> "2026-05-01 12:00:00.25": a moment as it is written, in universal time or as it was read.
   pure subroutine day_text(day, seconds, text)
      !> From 1970-01-01
      integer(int64), intent(in) :: day
      !> s from its beginning
      real(dp), intent(in) :: seconds
      !> The text, microseconds at most
      character(26), intent(out) :: text
      integer(int64) :: micros, at, low, high, year
      integer :: month

      micros = nint(seconds*1.0e6_dp, int64)
      at = day + floor_ratio(floor_ratio(micros, 1000000), 86400)
      micros = modulo(micros, 1000000*day_seconds)
      low = -1
      high = 10000
      do while (high - low > 1)
         year = (low + high)/2
         if (day_number(int(year), 1, 1) <= at) low = year
         if (day_number(int(year), 1, 1) > at) high = year
      end do
      year = max(low, 0_int64)
      month = 12
      do while (month > 1 .and. day_number(int(year), month, 1) > at)
         month = month - 1
      end do
      write (text, "(i4.4,'-',i2.2,'-',i2.2,1x,i2.2,':',i2.2,':',i2.2,'.',i6.6)") year, month, &
         at - day_number(int(year), month, 1) + 1, micros/3600000000_int64, mod(micros/60000000_int64, 60_int64), &
         mod(micros/1000000_int64, 60_int64), mod(micros, 1000000_int64)
   end subroutine day_text

end module gyroakf_io_calendar
