! SPDX-License-Identifier: MIT
!> Names of columns taken apart: words between signs, and between small letters and capitals; the
!> names of times, counters and temperatures.
module gyroakf_name_words
   use gyroakf_kinds, only : dp
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: split_name, ends_with, join_words, drop_digits, is_one_of, has_word, has_beginning
   public :: is_time_name, is_counter, is_temperature, is_temperature_unit

   character(*), parameter :: signs = "_-. /:[](),"//achar(9), digits = "0123456789"
   character(*), parameter :: degree = char(194)//char(176)
   character(*), parameter :: counters = "counter count cnt seq sequence index idx sample "// &
      "samples frame packet row line nr no number id n #"

contains

   !> The words of a name in lower case, with blanks around each: "TimeUS", "time_us" and "timeus"
   !> are " time us "; " " where there are none.
   pure subroutine split_name(name, words)
      character(*), intent(in) :: name
      character(:), allocatable, intent(out) :: words
      integer :: i, n

      allocate (character(2*len(name) + 2) :: words)
      words(1:1) = " "
      n = 1
      do i = 1, len(name)
         if (begins_word(name, i)) call end_word(words, n)
         if (scan(name(i:i), signs) > 0) cycle
         n = n + 1
         words(n:n) = lower(name(i:i))
      end do
      call end_word(words, n)
      words = words(:n)
   end subroutine split_name

   !> True where a word ends before a character: a sign, a capital behind or before a small letter.
   pure logical function begins_word(name, i)
      character(*), intent(in) :: name
      integer, intent(in) :: i
      character(*), parameter :: capitals = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", &
         small = "abcdefghijklmnopqrstuvwxyz"

      begins_word = scan(name(i:i), signs) > 0
      if (begins_word .or. i == 1 .or. scan(name(i:i), capitals) == 0) return
      begins_word = scan(name(i - 1:i - 1), small) > 0
      if (begins_word .or. i == len(name)) return
      begins_word = scan(name(i - 1:i - 1), capitals) > 0 .and. scan(name(i + 1:i + 1), small) > 0
   end function begins_word

   !> Ends the last of n characters with a blank, a unit at the end of a time with another one.
   pure subroutine end_word(words, n)
      character(*), intent(inout) :: words
      integer, intent(inout) :: n
      character(4), parameter :: endings(4) = ["us  ", "ms  ", "ns  ", "fine"]
      integer :: k, length

      if (words(n:n) == " ") return
      do k = 1, size(endings)
         length = len_trim(endings(k))
         if (.not. (ends_with(words(:n), "time"//trim(endings(k))) .or. &
            ends_with(words(:n), "stamp"//trim(endings(k))))) cycle
         words(n - length + 1:n + 1) = " "//trim(endings(k))
         n = n + 1
         exit
      end do
      n = n + 1
      words(n:n) = " "
   end subroutine end_word

   !> True where the text ends so.
   pure logical function ends_with(text, tail)
      character(*), intent(in) :: text, tail

      ends_with = .false.
      if (len(text) >= len(tail)) ends_with = text(len(text) - len(tail) + 1:) == tail
   end function ends_with

   !> The words without anything between them, and without digits at the end.
   pure subroutine join_words(words, text)
      !> Of [[split_name]]
      character(*), intent(in) :: words
      character(:), allocatable, intent(out) :: text
      integer :: i, n

      text = words
      n = 0
      do i = 1, len(words)
         if (words(i:i) == " ") cycle
         n = n + 1
         text(n:n) = words(i:i)
      end do
      text = text(:verify(text(:n), digits, back=.true.))
   end subroutine join_words

   !> The words without the digits at their ends; those of nothing but digits are left out.
   pure subroutine drop_digits(words)
      !> Of [[split_name]]
      character(:), allocatable, intent(inout) :: words
      integer :: i, n

      n = 1
      do i = 2, len(words)
         if (words(i:i) == " ") n = verify(words(:n), digits, back=.true.)
         if (words(i:i) == " " .and. words(n:n) == " ") cycle
         n = n + 1
         words(n:n) = words(i:i)
      end do
      words = words(:n)
   end subroutine drop_digits

   !> True for a word of a list, as in "gx gy gz"; blanks at its end do not count.
   pure logical function is_one_of(word, list)
      character(*), intent(in) :: word, list

      is_one_of = len_trim(word) > 0 .and. index(trim(word), " ") == 0
      if (is_one_of) is_one_of = index(" "//list//" ", " "//trim(word)//" ") > 0
   end function is_one_of

   !> True where one of the words is in a list.
   pure logical function has_word(words, list)
      !> Of [[split_name]], perhaps without digits
      character(*), intent(in) :: words
      !> In lower case, with blanks between its words
      character(*), intent(in) :: list
      character(len(list) + 2) :: parted
      integer :: from, to

      parted = " "//list
      has_word = .false.
      from = 1
      do while (from < len(words) .and. .not. has_word)
         to = from + index(words(from + 1:), " ")
         has_word = index(parted, words(from:to)) > 0
         from = to
      end do
   end function has_word

   !> True where one of the words begins with one of a list.
   pure logical function has_beginning(words, list)
      !> As those of [[has_word]]
      character(*), intent(in) :: words, list
      character(len(list) + 2) :: parted
      integer :: from, to

      parted = " "//list
      has_beginning = .false.
      from = 1
      do while (from < len(parted) .and. .not. has_beginning)
         to = from + index(parted(from + 1:), " ")
         has_beginning = index(words, parted(from:to - 1)) > 0
         from = to
      end do
   end function has_beginning

   !> True for the names that mean a time: t, time_ms, TimeUS, SampleTimeFine, gps_tow_s, epoch,
   !> UTC.
   !>
   !> One of its words, separated by signs or by capitals, means a time, and none that it is a
   !> duration, an error or a state. `T` is a temperature, unless its unit is that of a time.
   pure logical function is_time_name(name, unit)
      character(*), intent(in) :: name
      !> What stood in brackets; "" where nothing did
      character(*), intent(in) :: unit
      character(*), parameter :: times = "times stamps ts tow itow gpst epoch epoc utc unix "// &
         "clock elapsed zeit uhrzeit"
      character(*), parameter :: units = &
         "sec secs seconds millis milliseconds micros microseconds nanos nanoseconds usec msec nsec"
      character(*), parameter :: others = "delta dt diff step interval period constant sync "// &
         "status valid quality accuracy error err offset drift bias exposure latency delay per"
      character(:), allocatable :: words

      is_time_name = .false.
      if (is_temperature_unit(unit)) return
      call split_name(name, words)
      if (index(words, " t ") == 1) then
         if (words == " t ") then
            is_time_name = name /= "T" .or. time_scale(lower(unit)) > 0.0_dp
         else if (index(trim(words(4:)), " ") == 0) then
            is_time_name = time_scale(trim(words(4:))) > 0.0_dp
         end if
         return
      end if
      is_time_name = is_one_of(words(2:index(words(2:), " ")), units) .or. has_word(words, times) &
         .or. index(words, "time ") > 0 .or. index(words, "stamp ") > 0 .or. &
         index(words, " timestamp") > 0
      is_time_name = is_time_name .and. .not. (has_word(words, others) .or. &
         has_beginning(words, "interval constant accuracy exposure"))
   end function is_time_name

   !> True for a temperature: temp, Temperature, gyro_temp, tempC, T, or a unit that is one.
   pure logical function is_temperature(words, name, unit)
      !> Those of the name
      character(*), intent(in) :: words
      character(*), intent(in) :: name, unit
      integer :: at, next

      is_temperature = is_temperature_unit(unit) .or. index(words, "temperature") > 0
      if (name == "T") is_temperature = .not. time_scale(lower(unit)) > 0.0_dp
      if (index(name, "T") == 1 .and. index(words, " t ") == 1) then               ! TAcc, TGyro
         is_temperature = is_temperature .or. has_beginning(words, "acc gyr mag sens")
      end if
      at = 1
      do while (index(words(at:), " temp") > 0)
         at = at + index(words(at:), " temp") + 4
         next = at + index(words(at:), " ") - 1
         is_temperature = is_temperature .or. verify(words(at:next - 1), digits//"cfk") == 0
         at = next
      end do
   end function is_temperature

   !> True for a unit of temperature, as degC.
   pure logical function is_temperature_unit(unit)
      character(*), intent(in) :: unit

      is_temperature_unit = is_one_of(lower(unit), "degc c celsius kelvin k degf "//degree//"c") &
                            .or. any([character(5) :: "deg c", degree//" c"] == lower(unit))
   end function is_temperature_unit

   !> True for words that mean a count of rows: counter, seq, index, sample, packet_id, ...
   pure logical function is_counter(words)
      !> Of [[split_name]]
      character(*), intent(in) :: words
      logical :: single

      single = index(words(2:), " ") == len(words) - 1
      associate (last => words(index(words(:len(words) - 1), " ", back=.true.) + 1:))
         is_counter = is_one_of(last, counters) .and. (single .or. last /= "n")
      end associate
      is_counter = is_counter .or. (single .and. index(words, "counter ") > 0)
   end function is_counter

end module gyroakf_name_words
