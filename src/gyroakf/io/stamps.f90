! SPDX-License-Identifier: MIT
!> Time columns: which names mean one, and what their unit is.
module gyroakf_io_stamps
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_header, only : time_scale
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: fraction_of, is_time_name, is_temperature_name, is_counter_name, may_hold_time
   public :: named_scale, infer_scale, unwrap_days

contains

   !> True for the names that mean a time: t, time_ms, Timestamp [us], TimeUS, SampleTimeFine,
   !> gps_tow_s, epoch, Elapsed Time, UTC.
   !>
   !> One of its words, parted by signs or by capitals, means a time, and none that it is a
   !> duration, an error or a state. `T` is a temperature, unless its unit is that of a time.
   pure logical function is_time_name(name, unit)
      !> Without brackets
      character(*), intent(in) :: name
      !> What stood in brackets; "" (also if absent) where nothing did
      character(*), intent(in), optional :: unit
      character(7), parameter :: times(17) = [character(7) :: "time", "times", "stamp", "stamps", &
         "tstamp", "ts", "tow", "itow", "gpst", "epoch", "epoc", "utc", "unix", "clock", "elapsed", &
         "zeit", "uhrzeit"]
      character(12), parameter :: units(12) = [character(12) :: "sec", "secs", "seconds", "millis", &
         "milliseconds", "micros", &
         "microseconds", "nanos", "nanoseconds", "usec", "msec", "nsec"]
      character(8), parameter :: others(21) = [character(8) :: "delta", "dt", "diff", "step", &
         "interval", "period", "constant", "sync", "status", "valid", "quality", "accuracy", "error", &
         "err", "offset", "drift", "bias", "exposure", "latency", "delay", "per"]
      type(text_type), allocatable :: word(:)
      logical :: known_unit
      integer :: i

      is_time_name = .false.
      known_unit = .false.
      if (present(unit)) then
         if (is_temperature_unit(unit)) return
         known_unit = time_scale(lower(unit)) > 0.0_dp
      end if
      call split_name(name, word)
      if (size(word) == 0) return
      if (word(1)%text == "t") then
         is_time_name = size(word) == 1 .and. (name /= "T" .or. known_unit)
         if (size(word) == 2) is_time_name = time_scale(word(2)%text) > 0.0_dp
         return
      end if
      is_time_name = any(units == word(1)%text)
      do i = 1, size(word)
         associate (text => word(i)%text)
            if (any(others == text(:min(len(text), 8)))) then
               is_time_name = .false.
               return
            end if
            is_time_name = is_time_name .or. any(times == text) .or. ends_with(text, "time") .or. &
                           ends_with(text, "stamp") .or. index(text, "timestamp") == 1
         end associate
      end do
   end function is_time_name

   !> False for the names of what rises evenly too, but is no time: angles, rates, positions.
   pure logical function may_hold_time(name)
      !> Without brackets
      character(*), intent(in) :: name
      character(4), parameter :: beginnings(24) = [character(4) :: "gyr", "acc", "mag", "rate", "ang", &
         "yaw", "roll", "pitc", "head", "azim", "lat", "lon", "alt", "pos", "vel", "quat", "pres", &
         "baro", "omeg", "phi", "psi", "thet", "volt", "enco"]
      character(2), parameter :: axes(9) = ["gx", "gy", "gz", "wx", "wy", "wz", "ax", "ay", "az"]
      type(text_type), allocatable :: word(:)
      integer :: i, k

      call split_name(name, word)
      may_hold_time = .true.
      do i = 1, size(word)
         if (any(axes == word(i)%text)) may_hold_time = .false.
         do k = 1, size(beginnings)
            if (index(word(i)%text, trim(beginnings(k))) == 1) may_hold_time = .false.
         end do
      end do
   end function may_hold_time

   !> The words of a name in lower case: "TimeUS", "time_us" and "timeus" are "time" and "us".
   pure subroutine split_name(name, word)
      character(*), intent(in) :: name
      type(text_type), allocatable, intent(out) :: word(:)
      character(4), parameter :: endings(4) = [character(4) :: "us", "ms", "ns", "fine"]
      character(:), allocatable :: text, ending
      integer :: i, k

      allocate (word(0))
      text = ""
      do i = 1, len(name) + 1
         if (begins_word(name, i)) then
            do k = 1, size(endings)
               ending = trim(endings(k))
               if (.not. (ends_with(text, "time"//ending) .or. ends_with(text, "stamp"//ending))) cycle
               call add_text(word, text(:len(text) - len(ending)))
               text = ending
            end do
            if (len(text) > 0) call add_text(word, text)
            text = ""
         end if
         if (i > len(name)) exit
         if (scan(name(i:i), "_-. /:"//achar(9)) == 0) text = text//lower(name(i:i))
      end do
   end subroutine split_name

   !> True where a word ends before a character: at a sign, at a capital behind a small letter, and
   !> at the last capital before one.
   pure logical function begins_word(name, i)
      character(*), intent(in) :: name
      integer, intent(in) :: i
      character(*), parameter :: capitals = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", small = "abcdefghijklmnopqrstuvwxyz"

      begins_word = i > len(name)
      if (begins_word) return
      begins_word = scan(name(i:i), "_-. /:"//achar(9)) > 0
      if (begins_word .or. i == 1 .or. scan(name(i:i), capitals) == 0) return
      begins_word = scan(name(i - 1:i - 1), small) > 0
      if (begins_word .or. i == len(name)) return
      begins_word = scan(name(i - 1:i - 1), capitals) > 0 .and. scan(name(i + 1:i + 1), small) > 0
   end function begins_word

   !> True for a temperature: temp, Temperature, gyro_temp, tempC, T, or a unit that is one.
   pure logical function is_temperature_name(name, unit)
      !> Without brackets, and what stood in them
      character(*), intent(in) :: name, unit
      type(text_type), allocatable :: word(:)
      integer :: i

      is_temperature_name = is_temperature_unit(unit)
      if (name == "T") is_temperature_name = .not. time_scale(lower(unit)) > 0.0_dp
      call split_name(name, word)
      do i = 1, size(word)
         associate (text => word(i)%text)
            if (index(text, "temperature") > 0) is_temperature_name = .true.
            if (index(text, "temp") == 1 .and. verify(text(min(5, len(text) + 1):), "0123456789cfk") == 0) then
               is_temperature_name = .true.
            end if
         end associate
      end do
   end function is_temperature_name

   !> True for a unit of temperature.
   pure logical function is_temperature_unit(unit)
      character(*), intent(in) :: unit

      is_temperature_unit = any(lower(unit) == [character(8) :: "degc", "deg c", "c", "celsius", &
         "kelvin", "k", "degf", &
         char(194)//char(176)//"c", char(194)//char(176)//" c"])
   end function is_temperature_unit

   !> True for a name that means a count of rows: counter, count, seq, index, sample, frame,
   !> packet_id, ...
   pure logical function is_counter_name(name)
      !> Without brackets
      character(*), intent(in) :: name
      character(8), parameter :: counters(19) = [character(8) :: "counter", "count", "cnt", "seq", &
         "sequence", "index", "idx", "sample", "samples", "frame", "packet", "row", "line", "nr", "no", &
         "number", "id", "n", "#"]
      type(text_type), allocatable :: word(:)

      call split_name(name, word)
      is_counter_name = .false.
      if (size(word) > 0) is_counter_name = any(counters == word(size(word))%text)
      if (size(word) == 1) is_counter_name = is_counter_name .or. ends_with(word(1)%text, "counter")
   end function is_counter_name

   !> The column of the nanoseconds or microseconds that belong to a column of whole seconds, by
   !> their names: `stamp.secs` and `stamp.nsecs`, `sec` and `nanosec`, `tv_sec` and `tv_usec`.
   pure subroutine fraction_of(names, time, column, nano)
      !> Of all columns
      type(text_type), intent(in) :: names(:)
      !> The column of the seconds
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
         case ("us", "usec", "usecs", "micros", "microsec", "microsecs", "microseconds"); nano = .false.
         case default; cycle
         end select
         column = i
         return
      end do
   end subroutine fraction_of

   !> True where the text ends so.
   pure logical function ends_with(text, tail)
      character(*), intent(in) :: text, tail

      ends_with = .false.
      if (len(text) >= len(tail)) ends_with = text(len(text) - len(tail) + 1:) == tail
   end function ends_with

   !> Seconds in the unit that the name says by its brackets or its end; 0 where it says none.
   !> Xsens' SampleTimeFine counts in 100 us.
   pure real(dp) function named_scale(name, unit)
      !> "time_ms", or "time" with its brackets' content as unit
      character(*), intent(in) :: name, unit
      type(text_type), allocatable :: word(:)

      named_scale = time_scale(trim(adjustl(lower(unit))))
      if (named_scale > 0.0_dp) return
      call split_name(name, word)
      if (size(word) == 0) return
      named_scale = time_scale(word(size(word))%text)
      if (word(size(word))%text == "fine") named_scale = 1.0e-4_dp
   end function named_scale

   !> Seconds in the unit that the stamps themselves suggest.
   !>
   !> A rate that was given decides where it fits one unit within a factor of 3. Else: stamps with
   !> decimals are seconds; whole ones are told by their size where they count from 1970, else by
   !> their mean step: up to 1.5 seconds, below 1000 milliseconds, below 10^6 microseconds,
   !> nanoseconds.
   pure subroutine infer_scale(stamps, rate_hz, scale, sure, offset)
      !> As read, NaN where missing: [n]
      real(dp), intent(in), contiguous :: stamps(:)
      !> Hz, 0 where nobody gave one
      real(dp), intent(in) :: rate_hz
      !> s
      real(dp), intent(out) :: scale
      !> True where decimals or the rate that was given settle it
      logical, intent(out) :: sure
      !> What was subtracted from the stamps while they were read, 0 if absent
      real(dp), intent(in), optional :: offset
      real(dp), parameter :: units(4) = [1.0_dp, 1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp]
      real(dp) :: first, last, step, total
      integer(int64) :: i, count, forward
      integer :: k
      logical :: whole

      scale = 1.0_dp
      whole = .true.
      count = 0
      forward = 0
      first = 0.0_dp
      last = 0.0_dp
      total = 0.0_dp
      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         if (count == 0) first = stamps(i)
         if (count > 0 .and. stamps(i) >= last) then
            total = total + (stamps(i) - last)
            forward = forward + 1
         end if
         last = stamps(i)
         count = count + 1
         if (whole) whole = abs(stamps(i) - anint(stamps(i))) <= 0.0_dp
      end do
      sure = .not. whole
      if (count < 2) return
      step = total/real(max(forward, 1_int64), dp)
      if (rate_hz > 0.0_dp) then
         do k = 1, 4
            if (abs(log10(max(step*units(k)*rate_hz, tiny(step)))) > 0.48_dp) cycle
            scale = units(k)
            sure = .true.
            return
         end do
      end if
      if (.not. whole) return
      if (present(offset)) first = first + offset
      if (abs(first) > 1.0e17_dp) then
         scale = units(4)
      else if (abs(first) > 1.0e14_dp) then
         scale = units(3)
      else if (abs(first) > 1.0e11_dp) then
         scale = units(2)
      else if (abs(first) > 1.0e9_dp .and. step < 10.0_dp) then
         scale = units(1)
      else if (step > 1.5_dp) then
         scale = units(2)
         if (step >= 1.0e3_dp) scale = units(3)
         if (step >= 1.0e6_dp) scale = units(4)
      end if
   end subroutine infer_scale

   !> Lets a time of day go on behind midnight: it falls by more than half a day there.
   pure subroutine unwrap_days(stamps, before, days)
      !> s from midnight, NaN where missing: [n]; afterwards from the first midnight
      real(dp), intent(inout), contiguous :: stamps(:)
      !> The last stamp before these as it was read, NaN where there is none, and the midnights so
      !> far; 0 at first
      real(dp), intent(inout) :: before
      integer, intent(inout) :: days
      real(dp), parameter :: half_day = 43200.0_dp
      integer(int64) :: i
      real(dp) :: clock

      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         clock = stamps(i)
         if (.not. ieee_is_nan(before)) then
            if (clock < before - half_day) days = days + 1
            if (clock > before + half_day .and. days > 0) days = days - 1
         end if
         before = clock
         stamps(i) = clock + 2*half_day*days
      end do
   end subroutine unwrap_days

end module gyroakf_io_stamps
