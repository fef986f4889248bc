! SPDX-License-Identifier: MIT
!> Names of columns taken apart: words between signs, and between small letters and capitals; the
!> names of times, counters and temperatures.
module gyroakf_name_words
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: split_name, ends_with, join_name, is_one_of, has_word, has_beginning
   public :: is_time_name, is_counter_name, is_temperature_name, is_temperature_unit

   character(*), parameter :: signs = "_-. /:[](),"//achar(9)
   character(*), parameter :: degree = char(194)//char(176)
   character(*), parameter :: counters = "counter count cnt seq sequence index idx sample "// &
      "samples frame packet row line nr no number id n #"

contains

   !> The words of a name in lower case: "TimeUS", "time_us" and "timeus" are "time" and "us".
   pure subroutine split_name(name, word)
      character(*), intent(in) :: name
      !> None of them is empty
      type(text_type), allocatable, intent(out) :: word(:)
      character(4), parameter :: endings(4) = ["us  ", "ms  ", "ns  ", "fine"]
      character(:), allocatable :: text, ending
      integer :: i, k

      allocate (word(0))
      text = ""
      do i = 1, len(name) + 1
         if (begins_word(name, i)) then
            do k = 1, size(endings)
               ending = trim(endings(k))
               if (.not. (ends_with(text, "time"//ending) .or. &
                  ends_with(text, "stamp"//ending))) cycle
               call add_text(word, text(:len(text) - len(ending)))
               text = ending
            end do
            if (len(text) > 0) call add_text(word, text)
            text = ""
         end if
         if (i > len(name)) exit
         if (scan(name(i:i), signs) == 0) text = text//lower(name(i:i))
      end do
   end subroutine split_name

   !> True where a word ends before a character: a sign, a capital behind or before a small letter.
   pure logical function begins_word(name, i)
      character(*), intent(in) :: name
      integer, intent(in) :: i
      character(*), parameter :: capitals = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", &
         small = "abcdefghijklmnopqrstuvwxyz"

      begins_word = i > len(name)
      if (begins_word) return
      begins_word = scan(name(i:i), signs) > 0
      if (begins_word .or. i == 1 .or. scan(name(i:i), capitals) == 0) return
      begins_word = scan(name(i - 1:i - 1), small) > 0
      if (begins_word .or. i == len(name)) return
      begins_word = scan(name(i - 1:i - 1), capitals) > 0 .and. scan(name(i + 1:i + 1), small) > 0
   end function begins_word

   !> True where the text ends so.
   pure logical function ends_with(text, tail)
      character(*), intent(in) :: text, tail

      ends_with = .false.
      if (len(text) >= len(tail)) ends_with = text(len(text) - len(tail) + 1:) == tail
   end function ends_with

   !> The words without anything between them, and without digits at the end.
   pure subroutine join_name(word, text)
      type(text_type), intent(in) :: word(:)
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = ""
      do i = 1, size(word)
         text = text//word(i)%text
      end do
      text = text(:verify(text, "0123456789", back=.true.))
   end subroutine join_name

   !> True for a word of a list, as in "gx gy gz"; blanks at its end do not count.
   pure logical function is_one_of(word, list)
      character(*), intent(in) :: word, list

      is_one_of = len_trim(word) > 0 .and. index(trim(word), " ") == 0
      if (is_one_of) is_one_of = index(" "//list//" ", " "//trim(word)//" ") > 0
   end function is_one_of

   !> True where one of the words is in a list; digits at its end do not count.
   pure logical function has_word(word, list)
      type(text_type), intent(in) :: word(:)
      !> In lower case, with blanks between its words
      character(*), intent(in) :: list
      integer :: i, last

      has_word = .false.
      do i = 1, size(word)
         last = verify(word(i)%text, "0123456789", back=.true.)
         has_word = has_word .or. is_one_of(word(i)%text(:last), list)
      end do
   end function has_word

   !> True where one of the words begins with one of a list.
   pure logical function has_beginning(word, list)
      type(text_type), intent(in) :: word(:)
      !> In lower case, with blanks between the beginnings
      character(*), intent(in) :: list
      integer :: i, n

      has_beginning = .false.
      do i = 1, size(word)
         do n = 1, len(word(i)%text)
            has_beginning = has_beginning .or. is_one_of(word(i)%text(:n), list)
         end do
      end do
   end function has_beginning

   !> True for the names that mean a time: t, time_ms, TimeUS, SampleTimeFine, gps_tow_s, epoch,
   !> UTC.
   !>
   !> One of its words, parted by signs or by capitals, means a time, and none that it is a
   !> duration, an error or a state. `T` is a temperature, unless its unit is that of a time.
   pure logical function is_time_name(name, unit)
      character(*), intent(in) :: name
      !> What stood in brackets; "" (also if absent) where nothing did
      character(*), intent(in), optional :: unit
      character(*), parameter :: times = "times stamps ts tow itow gpst epoch epoc utc unix "// &
         "clock elapsed zeit uhrzeit"
      character(*), parameter :: units = &
         "sec secs seconds millis milliseconds micros microseconds nanos nanoseconds usec msec nsec"
      character(*), parameter :: others = "delta dt diff step interval period constant sync "// &
         "status valid quality accuracy error err offset drift bias exposure latency delay per"
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
      is_time_name = is_one_of(word(1)%text, units)
      do i = 1, size(word)
         associate (text => word(i)%text)
            is_time_name = is_time_name .or. is_one_of(text, times) .or. ends_with(text, &
               "time") .or. ends_with(text, "stamp") .or. index(text, "timestamp") == 1
         end associate
      end do
      do i = 1, size(word)
         if (is_one_of(word(i)%text(:min(len(word(i)%text), 8)), others)) is_time_name = .false.
      end do
   end function is_time_name

   !> True for a temperature: temp, Temperature, gyro_temp, tempC, T, or a unit that is one.
   pure logical function is_temperature_name(name, unit)
      character(*), intent(in) :: name, unit
      type(text_type), allocatable :: word(:)
      integer :: i

      is_temperature_name = is_temperature_unit(unit)
      if (name == "T") is_temperature_name = .not. time_scale(lower(unit)) > 0.0_dp
      call split_name(name, word)
      do i = 1, size(word)
         associate (text => word(i)%text)
            is_temperature_name = is_temperature_name .or. index(text, "temperature") > 0 .or. &
               (index(text, "temp") == 1 .and. &
               verify(text(min(5, len(text) + 1):), "0123456789cfk") == 0)
         end associate
      end do
   end function is_temperature_name

   pure logical function is_temperature_unit(unit)
      character(*), intent(in) :: unit

      is_temperature_unit = is_one_of(lower(unit), "degc c celsius kelvin k degf "//degree//"c") &
                            .or. any([character(5) :: "deg c", degree//" c"] == lower(unit))
   end function is_temperature_unit

   !> True for a name that means a count of rows: counter, seq, index, sample, packet_id, ...
   pure logical function is_counter_name(name)
      character(*), intent(in) :: name
      type(text_type), allocatable :: word(:)

      call split_name(name, word)
      is_counter_name = .false.
      if (size(word) > 0) is_counter_name = is_one_of(word(size(word))%text, counters)
      if (size(word) > 1) is_counter_name = is_counter_name .and. word(size(word))%text /= "n"
      if (size(word) == 1) is_counter_name = is_counter_name .or. ends_with(word(1)%text, "counter")
   end function is_counter_name

end module gyroakf_name_words
