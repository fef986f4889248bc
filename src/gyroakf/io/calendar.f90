! SPDX-License-Identifier: MIT
!> Days of the Gregorian calendar.
module gyroakf_io_calendar
   use gyroakf_kinds, only : int64
   implicit none (type, external)
   private
   public :: day_number, month_days

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

end module gyroakf_io_calendar
