! SPDX-License-Identifier: MIT
!> Time columns: fractions of a second in a column of their own, the unit, times of day.
module gyroakf_io_stamps
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_name_words, only : split_name
   use gyroakf_record, only : text_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: fraction_of, named_scale, infer_scale, unpack_clock, unwrap_days

contains

   !> The column of the nanoseconds or microseconds that belong to a column of whole seconds, by
   !> their names: `stamp.secs` and `stamp.nsecs`, `sec` and `nanosec`, `tv_sec` and `tv_usec`.
   pure subroutine fraction_of(names, time, column, nano)
      type(text_type), intent(in) :: names(:)
      integer, intent(in) :: time
      !> 0 where there is none
      integer, intent(out) :: column
      !> True for nanoseconds, false for microseconds
      logical, intent(out) :: nano
      character(:), allocatable :: seconds, part
      integer :: mark, i

      column = 0
      nano = .true.
      seconds = trim(adjustl(lower(names(time)%text)))
      mark = scan(seconds, "_-. ", back=.true.)
      if (.not. any(seconds(mark + 1:) == [character(7) :: "s", "sec", "secs", "seconds"])) return
      do i = 1, size(names)
         part = trim(adjustl(lower(names(i)%text)))
         if (len(part) <= mark) cycle
         if (part(:mark) /= seconds(:mark)) cycle
         select case (part(mark + 1:))
         case ("ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecs", "nanoseconds"); nano = .true.
         case ("us", "usec", "usecs", "micros", "microsec", "microsecs", "microseconds")
            nano = .false.
         case default; cycle
         end select
         column = i
         return
      end do
   end subroutine fraction_of

   !> Seconds in the unit that the name says by its brackets or its end; 0 where it says none.
   !> Xsens' SampleTimeFine counts in 100 us (MTi, MTw), or in us (DOT) where that would be below 2
   !> Hz.
   pure real(dp) function named_scale(name, unit, step)
      !> "time_ms", or "time" with its brackets' content as unit
      character(*), intent(in) :: name, unit
      !> Of the stamps, in their unit
      real(dp), intent(in) :: step
      character(:), allocatable :: words

      named_scale = time_scale(trim(adjustl(lower(unit))))
      if (named_scale > 0.0_dp) return
      call split_name(name, words)
      associate (last => words(index(trim(words), " ", back=.true.) + 1:len_trim(words)))
         named_scale = time_scale(last)
         if (last == "fine") named_scale = merge(1e-4_dp, 1e-6_dp, step < 5.0e3_dp)
      end associate
   end function named_scale

   !> Seconds in the unit that the stamps themselves suggest. A rate that was given decides where it
   !> fits one unit within a factor of 3. Else the size of stamps that count from 1970, else their
   !> mean step: up to 1.5 (1 where stamps are equal) s, below 1000 ms, below 10^6 us, ns. Seconds
   !> with decimals are sure.
   pure subroutine infer_scale(stamps, rate_hz, scale, sure, offset)
      !> As read, NaN where missing: [n]
      real(dp), intent(in), contiguous :: stamps(:)
      !> Hz, 0 where none is given
      real(dp), intent(in) :: rate_hz
      !> s
      real(dp), intent(out) :: scale
      !> True where decimals or the rate that was given settle it
      logical, intent(out) :: sure
      !> What was subtracted from the stamps while they were read, 0 if absent
      real(dp), intent(in), optional :: offset
      real(dp), parameter :: units(4) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]
      real(dp) :: first, last, step, total
      integer(int64) :: i, known, forward
      integer :: k
      logical :: whole, equal

      scale = 1.0_dp
      whole = .true.
      equal = .false.
      known = 0
      forward = 0
      first = 0.0_dp
      last = 0.0_dp
      total = 0.0_dp
      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         if (known == 0) first = stamps(i)
         if (known > 0 .and. stamps(i) >= last) then
            total = total + (stamps(i) - last)
            equal = equal .or. .not. stamps(i) > last
            forward = forward + 1
         end if
         last = stamps(i)
         known = known + 1
         if (whole) whole = abs(stamps(i) - anint(stamps(i))) <= 0.0_dp
      end do
      sure = .not. whole
      if (known < 2) return
      if (present(offset)) first = first + offset
      step = total/real(max(forward, 1_int64), dp)
      if (rate_hz > 0.0_dp) then
         do k = 1, 4
            if (abs(log10(max(step*units(k)*rate_hz, tiny(step)))) > 0.48_dp) cycle
            scale = units(k)
            sure = .true.
            return
         end do
      end if
      sure = .not. whole .and. step <= 1.5_dp .and. abs(first) <= 1.0e11_dp
      if (sure) return
      k = 1 + count(abs(first) > [1.0e11_dp, 1.0e14_dp, 1.0e17_dp])
      if (k == 1 .and. step > merge(1.0_dp, 1.5_dp, equal)) k = 2 + count(step >= [1e3_dp, 1e6_dp])
      scale = units(k)
   end subroutine infer_scale

   !> Turns hhmmss.sss of NMEA into seconds from midnight, where a minute ends in a usual step.
   pure subroutine unpack_clock(stamps, found)
      !> As read, NaN where missing: [n]
      real(dp), intent(inout), contiguous :: stamps(:)
      !> False where they are left as they are
      logical, intent(out) :: found
      real(dp) :: step, usual, before
      integer(int64) :: i

      found = .false.
      before = 0.0_dp
      usual = 0.0_dp
      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         if (stamps(i) < 0.0_dp .or. stamps(i) >= 2.4e5_dp) exit
         if (any(modulo(stamps(i), [1.0e2_dp, 1.0e4_dp]) >= [61.0_dp, 6.0e3_dp])) exit
         step = seconds_of(stamps(i)) - seconds_of(before)
         if (step < -8.0e4_dp) step = step + 8.64e4_dp
         found = found .or. (step > 0.5_dp*usual .and. step < 2.0_dp*usual .and. &
            abs(stamps(i) - before) >= 40.0_dp)
         if (step > 0.0_dp) usual = step
         before = stamps(i)
      end do
      found = found .and. i > size(stamps)
      if (found) stamps(:) = seconds_of(stamps)
   end subroutine unpack_clock

   !> 120030.5 as seconds from midnight.
   pure elemental real(dp) function seconds_of(digits)
      real(dp), intent(in) :: digits

      seconds_of = digits - 40.0_dp*aint(digits/1.0e2_dp) - 2400.0_dp*aint(digits/1.0e4_dp)
   end function seconds_of

   !> Lets a time of day go on behind midnight: it falls by more than half a day there.
   pure subroutine unwrap_days(stamps)
      !> s from midnight, NaN where missing: [n]; afterwards from the first midnight
      real(dp), intent(inout), contiguous :: stamps(:)
      real(dp), parameter :: half_day = 43200.0_dp
      integer(int64) :: i
      integer :: days
      real(dp) :: clock, before

      days = 0
      before = half_day
      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         clock = stamps(i)
         if (clock < before - half_day) days = days + 1
         if (clock > before + half_day .and. days > 0) days = days - 1
         before = clock
         stamps(i) = clock + 2*half_day*days
      end do
   end subroutine unwrap_days

end module gyroakf_io_stamps
