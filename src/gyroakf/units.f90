! SPDX-License-Identifier: MIT
!> Units of rates, angles, accelerations. Factors are exact, or one division of exact numbers.
module gyroakf_units
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_spelling, only : lower, nearest_word, replace_all
   implicit none (type, external)
   private
   public :: unit_type, quantity, term_names, standard_gravity
   public :: recognize_unit, parse_unit, parse_units, time_scale, is_integral, angle_to_rate_unit

   !> The five terms: quantization, angle random walk, bias instability, rate random walk, ramp
   character(1), parameter :: term_names(5) = ["Q", "N", "B", "K", "R"]

   !> What a unit measures, reached as `quantity%angular_rate`
   type :: quantity_enum
      !> No unit given
      integer :: unknown = 0
      !> SI rad/s
      integer :: angular_rate = 1
      !> SI m/s^2
      integer :: acceleration = 2
      !> SI rad; only of input that holds angles or angle increments
      integer :: angle = 3
      !> SI m/s; only of input that holds velocity increments
      integer :: velocity = 4
   end type quantity_enum

   !> All quantities
   type(quantity_enum), parameter :: quantity = quantity_enum()

   !> A unit of the input
   type :: unit_type
      !> Canonical name as in "deg/s", "" or unallocated where unknown
      character(:), allocatable :: name
      !> One of the components of [[quantity]]
      integer :: quantity = 0
      !> value * to_si is in rad/s, m/s^2, rad or m/s
      real(dp) :: to_si = 1.0_dp
   end type unit_type

   real(dp), parameter :: pi = 3.141592653589793238462643_dp
   !> m/s^2
   real(dp), parameter :: standard_gravity = 9.80665_dp

   !> Angles: name, and how many of it make pi rad (0: `radian` holds its size in rad)
   type :: angle_entry
      character(6) :: name
      real(dp) :: per_half_turn, radian
   end type angle_entry

   type(angle_entry), parameter :: angles(9) = [angle_entry("rad", 0.0_dp, 1.0_dp), &
      angle_entry("mrad", 0.0_dp, 1.0e-3_dp), angle_entry("urad", 0.0_dp, 1.0e-6_dp), &
      angle_entry("deg", 180.0_dp, 0.0_dp), angle_entry("mdeg", 180.0e3_dp, 0.0_dp), &
      angle_entry("udeg", 180.0e6_dp, 0.0_dp), angle_entry("arcmin", 10800.0_dp, 0.0_dp), &
      angle_entry("arcsec", 648.0e3_dp, 0.0_dp), angle_entry("rev", 0.5_dp, 0.0_dp)]

   !> The others
   type :: unit_entry
      character(6) :: name
      integer :: quantity
      real(dp) :: to_si
   end type unit_entry

   type(unit_entry), parameter :: others(12) = &
      [unit_entry("m/s^2", quantity%acceleration, 1.0_dp), unit_entry("mm/s^2", &
      quantity%acceleration, 1.0e-3_dp), unit_entry("cm/s^2", quantity%acceleration, 1.0e-2_dp), &
      unit_entry("ft/s^2", quantity%acceleration, 0.3048_dp), unit_entry("g", &
      quantity%acceleration, standard_gravity), unit_entry("mg", quantity%acceleration, &
      9.80665e-3_dp), unit_entry("ug", quantity%acceleration, 9.80665e-6_dp), &
      unit_entry("mgal", quantity%acceleration, 1.0e-5_dp), unit_entry("m/s", quantity%velocity, &
      1.0_dp), unit_entry("mm/s", quantity%velocity, 1.0e-3_dp), unit_entry("cm/s", &
      quantity%velocity, 1.0e-2_dp), unit_entry("ft/s", quantity%velocity, 0.3048_dp)]

   !> Pairs of what is written and what is meant
   character(12), parameter :: spellings(2, 43) = reshape([character(12) :: "degree", "deg", &
      "degrees", "deg", "degs", "deg", "radian", "rad", "radians", "rad", "rads", "rad", &
      "arcsecond", "arcsec", "arcseconds", "arcsec", "asec", "arcsec", "arcs", "arcsec", '"', &
      "arcsec", "arcminute", "arcmin", "arcminutes", "arcmin", "revolution", "rev", "revolutions", &
      "rev", "turn", "rev", "turns", "rev", "millidegree", "mdeg", "millidegrees", "mdeg", &
      "millirad", "mrad", "microrad", "urad", "dps", "deg/s", "mdps", "mdeg/s", "udps", "udeg/s", &
      "dph", "deg/h", "rps", "rev/s", "rpm", "rev/min", "degps", "deg/s", "degph", "deg/h", &
      "radps", "rad/s", "mradps", "mrad/s", "m/s2", "m/s^2", "m/s/s", "m/s^2", "mps2", "m/s^2", &
      "ms2", "m/s^2", "g-force", "g", "cm/s2", "cm/s^2", "mm/s2", "mm/s^2", "ft/s2", "ft/s^2", &
      "gn", "g", "milli-g", "mg", "micro-g", "ug", "gal", "cm/s^2"], [2, 43])

   !> Signs, in UTF-8 and in Latin-1, and what they become; they are replaced in this order
   character(5), parameter :: signs(2, 13) = reshape([character(5) :: char(194)//char(176), "deg", &
      char(194)//char(186), "deg", char(194)//char(178), "^2", char(194)//char(181), "u", &
      char(206)//char(188), "u", char(194)//char(183), "", char(226)//char(129)//char(187)// &
      char(194)//char(185), "^-1", char(226)//char(129)//char(187)//"^2", "^-2", char(176), "deg", &
      char(178), "^2", char(181), "u", "**", "^", "*", ""], [2, 13])

   !> What the message for an unknown unit offers
   character(8), parameter :: offered(23) = [character(8) :: "deg/s", "deg/h", "deg/min", "mdps", &
      "dps", "rad/s", "rad/h", "mrad/s", "urad/s", "arcsec/s", "rev/s", "rpm", "m/s^2", "g", "mg", &
      "ug", "mgal", "deg", "rad", "mrad", "urad", "arcsec", "arcmin"]

contains

   !> The unit that a text names, of unknown quantity where it names none.
   pure subroutine recognize_unit(text, unit)
      !> As that of [[parse_unit]]
      character(*), intent(in) :: text
      type(unit_type), intent(out) :: unit
      character(:), allocatable :: plain, angle
      integer :: i, slash

      plain = text
      call make_plain(plain)
      call take_meaning(plain)
      do i = 1, size(others)
         if (plain == trim(others(i)%name)) call set_unit(unit, plain, others(i)%quantity, &
            others(i)%to_si)
      end do
      if (unit%quantity /= quantity%unknown) return
      slash = index(plain//"/", "/")
      angle = plain(:slash - 1)
      if (slash <= len(plain)) call take_meaning(angle)
      call find_angle(angle, plain(slash:), unit)
   end subroutine recognize_unit

   !> The unit that a text names. Case, blanks and brackets do not matter; `dps`, `deg/s`, `deg
   !> s^-1`, `degrees per second` and the degree sign are the same unit.
   pure subroutine parse_unit(text, unit, error)
      character(*), intent(in) :: text
      type(unit_type), intent(out) :: unit
      !> Allocated where the text names no known unit: invalid_argument, with the nearest known one
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: plain, message
      integer :: i

      call recognize_unit(text, unit)
      if (unit%quantity /= quantity%unknown) return
      message = "unknown unit '"//trim(adjustl(text))//"'"
      plain = text
      call make_plain(plain)
      call take_meaning(plain)
      i = 0
      if (len(plain) > 0) i = nearest_word(plain, offered)
      if (i > 0) message = message//", perhaps "//trim(offered(i))
      message = message//"; known are"
      do i = 1, size(offered)
         message = message//" "//trim(offered(i))//merge(",", " ", i < size(offered))
      end do
      call fatal_error(error, status%invalid_argument, trim(message))
   end subroutine parse_unit

   !> The units of a list separated by commas: "deg/s", "rad/s,rad/s,m/s^2".
   subroutine parse_units(list, unit, error)
      !> As somebody wrote it; at least one unit
      character(*), intent(in) :: list
      type(unit_type), allocatable, intent(out) :: unit(:)
      !> As that of [[parse_unit]], for the first that is not known
      type(error_type), allocatable, intent(out) :: error
      integer :: i, from, to

      allocate (unit(count([(list(i:i) == ",", i=1, len(list))]) + 1))
      from = 1
      do i = 1, size(unit)
         to = index(list(from:)//",", ",") + from - 2
         call parse_unit(list(from:to), unit(i), error)
         if (allocated(error)) return
         from = to + 2
      end do
   end subroutine parse_units

   !> Fills the unit where `angle` is a known angle and `time` is "" or a stroke and a known time.
   pure subroutine find_angle(angle, time, unit)
      character(*), intent(in) :: angle, time
      type(unit_type), intent(inout) :: unit
      real(dp) :: seconds
      character(:), allocatable :: name
      integer :: i, what

      seconds = 1.0_dp
      select case (time)
      case (""); name = ""
      case ("/s", "/sec", "/secs", "/second", "/seconds"); name = "/s"
      case ("/min", "/mins", "/minute", "/minutes"); name = "/min"
      case ("/h", "/hr", "/hrs", "/hour", "/hours"); name = "/h"
      case default; return
      end select
      if (name == "/min") seconds = 60.0_dp
      if (name == "/h") seconds = 3600.0_dp
      what = merge(quantity%angle, quantity%angular_rate, name == "")
      do i = 1, size(angles)
         if (angle /= trim(angles(i)%name)) cycle
         if (angles(i)%per_half_turn > 0.0_dp) then
            call set_unit(unit, angle//name, what, pi/(angles(i)%per_half_turn*seconds))
         else
            call set_unit(unit, angle//name, what, angles(i)%radian/seconds)
         end if
      end do
      if (unit%quantity == quantity%unknown) return
      if (unit%name == "mdeg/s") unit%name = "mdps"
      if (unit%name == "rev/min") unit%name = "rpm"
   end subroutine find_angle

   pure subroutine set_unit(unit, name, what, to_si)
      type(unit_type), intent(inout) :: unit
      character(*), intent(in) :: name
      integer, intent(in) :: what
      real(dp), intent(in) :: to_si

      unit%name = name
      unit%quantity = what
      unit%to_si = to_si
   end subroutine set_unit

   !> Seconds in a unit of time: s, ms, us, ns, min, h, perhaps behind a whole number (100us), else
   !> 0.
   pure real(dp) function time_scale(word)
      !> In lower case
      character(*), intent(in) :: word
      integer :: i, digits

      digits = verify(word, "0123456789") - 1
      select case (adjustl(word(max(digits, 0) + 1:)))
      case ("s", "sec", "secs", "second", "seconds"); time_scale = 1.0_dp
      case ("ms", "msec", "msecs", "millis", "millisecond", "milliseconds"); time_scale = 1.0e-3_dp
      case ("us", "usec", "usecs", "micros", "microsecond", "microseconds"); time_scale = 1.0e-6_dp
      case (char(194)//char(181)//"s", char(206)//char(188)//"s"); time_scale = 1.0e-6_dp
      case ("ns", "nsec", "nsecs", "nanos", "nanosecond", "nanoseconds"); time_scale = 1.0e-9_dp
      case ("min", "minute", "minutes"); time_scale = 60.0_dp
      case ("h", "hour", "hours"); time_scale = 3600.0_dp
      case default; time_scale = 0.0_dp
      end select
      if (digits <= 0) return
      if (digits > 9) time_scale = 0.0_dp
      time_scale = time_scale*sum([(real(iachar(word(i:i)) - iachar("0"), &
         dp)*10.0_dp**(digits - i), i=1, digits)])
   end function time_scale

   !> True for the units of angles and velocities: what rates and accelerations add up to.
   pure logical function is_integral(unit)
      type(unit_type), intent(in) :: unit

      is_integral = unit%quantity == quantity%angle .or. unit%quantity == quantity%velocity
   end function is_integral

   !> The unit of the rate that differences of an angle give, per second: "arcsec" gives "arcsec/s"
   !> (deg/h by value); those of a velocity give an acceleration: "m/s" gives "m/s^2".
   pure function angle_to_rate_unit(unit) result(rate_unit)
      !> An angle's or a velocity's unit; anything else is returned as it is
      type(unit_type), intent(in) :: unit
      type(unit_type) :: rate_unit

      rate_unit = unit
      if (unit%quantity == quantity%velocity) then
         rate_unit%quantity = quantity%acceleration
         rate_unit%name = unit%name//"^2"
      end if
      if (unit%quantity /= quantity%angle) return
      rate_unit%quantity = quantity%angular_rate
      rate_unit%name = unit%name//"/s"
      if (rate_unit%name == "mdeg/s") rate_unit%name = "mdps"
   end function angle_to_rate_unit

   !> Lower case, no blanks, brackets or signs beyond ASCII, `/s` for `per s` and `s^-1`.
   pure subroutine make_plain(plain)
      character(:), allocatable, intent(inout) :: plain
      character(*), parameter :: dropped = " _[]()"//achar(9)
      integer :: i

      plain = lower(plain)
      do i = 1, size(signs, 2)
         if (index(plain, signs(1, i)(:1)) == 0) cycle
         call replace_all(plain, trim(signs(1, i)), trim(signs(2, i)))
      end do
      do i = 1, len(dropped)
         call replace_all(plain, dropped(i:i), "")
      end do
      call replace_all(plain, "per", "/")
      call invert_power(plain, "-1", "")
      call invert_power(plain, "-2", "^2")
   end subroutine make_plain

   !> `rads^-1` and `rads-1` become `rad/s`.
   pure subroutine invert_power(text, power, positive)
      character(:), allocatable, intent(inout) :: text
      character(*), intent(in) :: power, positive
      integer :: n

      n = len(text) - len(power)
      if (n < 2) return
      if (text(n + 1:) /= power) return
      if (text(n:n) == "^") n = n - 1
      if (n < 2) return
      if (index("sh", text(n:n)) > 0) text = text(:n - 1)//"/"//text(n:n)//positive
   end subroutine invert_power

   !> Takes what a text means where it is one of the spellings.
   pure subroutine take_meaning(text)
      !> In plain form
      character(:), allocatable, intent(inout) :: text
      integer :: at

      at = findloc(spellings(1, :) == text, .true., dim=1)
      if (at > 0) text = trim(spellings(2, at))
   end subroutine take_meaning

end module gyroakf_units
