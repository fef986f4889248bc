! SPDX-License-Identifier: MIT
!> Units of rates, angles and accelerations, and those that the coefficients are stated in.
!>
!> The library computes in the unit of its input; this module alone converts, once, where a result
!> is stated. All factors are one correctly rounded division away from exact numbers.
module gyroakf_units
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_spelling, only : lower, replace_all, nearest_word
   implicit none (type, external)
   private
   public :: unit_type, coefficient_unit_type, quantity, term_names
   public :: parse_unit, parse_units, time_scale, is_integral
   public :: coefficient_unit, density_unit, angle_to_rate_unit, coefficient_definition

   !> The order of the five terms everywhere: quantisation, angle random walk, bias instability, rate random walk, ramp
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

   !> What a coefficient is stated in
   type :: coefficient_unit_type
      !> As in "deg/sqrt(h)"
      character(:), allocatable :: name
      !> As in "rad/sqrt(s)"; of an unknown quantity the same as `name`
      character(:), allocatable :: si_name
      !> value in `name` = value in `si_name` * from_si
      real(dp) :: from_si = 1.0_dp
   end type coefficient_unit_type

   real(dp), parameter :: pi = 3.141592653589793238462643_dp
   real(dp), parameter :: standard_gravity = 9.80665_dp

   !> Angles: name, and how many of it make pi rad (0: `radian` holds its size in rad)
   type :: angle_entry
      character(6) :: name
      real(dp) :: per_half_turn, radian
   end type angle_entry

   type(angle_entry), parameter :: angles(9) = [ &
      angle_entry("rad", 0.0_dp, 1.0_dp), angle_entry("mrad", 0.0_dp, 1.0e-3_dp), angle_entry("urad", 0.0_dp, 1.0e-6_dp), &
      angle_entry("deg", 180.0_dp, 0.0_dp), angle_entry("mdeg", 180.0e3_dp, 0.0_dp), angle_entry("udeg", 180.0e6_dp, 0.0_dp), &
      angle_entry("arcmin", 10800.0_dp, 0.0_dp), angle_entry("arcsec", 648.0e3_dp, 0.0_dp), angle_entry("rev", 0.5_dp, 0.0_dp)]

   character(6), parameter :: accelerations(8) = &
      ["m/s^2 ", "mm/s^2", "cm/s^2", "ft/s^2", "g     ", "mg    ", "ug    ", "mgal  "]
   real(dp), parameter :: acceleration_to_si(8) = &
      [1.0_dp, 1.0e-3_dp, 1.0e-2_dp, 0.3048_dp, standard_gravity, 9.80665e-3_dp, 9.80665e-6_dp, 1.0e-5_dp]

   character(4), parameter :: velocities(4) = ["m/s ", "mm/s", "cm/s", "ft/s"]
   real(dp), parameter :: velocity_to_si(4) = [1.0_dp, 1.0e-3_dp, 1.0e-2_dp, 0.3048_dp]

   !> Other spellings: pairs of what is written and what is meant
   character(12), parameter :: spellings(2, 43) = reshape([character(12) :: &
      "degree", "deg", "degrees", "deg", "degs", "deg", "radian", "rad", "radians", "rad", "rads", "rad", &
      "arcsecond", "arcsec", "arcseconds", "arcsec", "asec", "arcsec", "arcs", "arcsec", '"', "arcsec", &
      "arcminute", "arcmin", "arcminutes", "arcmin", "revolution", "rev", "revolutions", "rev", "turn", "rev", "turns", "rev", &
      "millidegree", "mdeg", "millidegrees", "mdeg", "millirad", "mrad", "microrad", "urad", &
      "dps", "deg/s", "mdps", "mdeg/s", "udps", "udeg/s", "dph", "deg/h", "rps", "rev/s", "rpm", "rev/min", &
      "degps", "deg/s", "degph", "deg/h", "radps", "rad/s", "mradps", "mrad/s", &
      "m/s2", "m/s^2", "m/s/s", "m/s^2", "mps2", "m/s^2", "ms2", "m/s^2", "g-force", "g", &
      "cm/s2", "cm/s^2", "mm/s2", "mm/s^2", "ft/s2", "ft/s^2", &
      "gn", "g", "milli-g", "mg", "micro-g", "ug", "gal", "cm/s^2"], [2, 43])

   !> The unit of time under the stroke, and its spellings
   character(8), parameter :: seconds_names(5) = ["s       ", "sec     ", "secs    ", "second  ", "seconds "]
   character(8), parameter :: minutes_names(4) = ["min     ", "mins    ", "minute  ", "minutes "]
   character(8), parameter :: hours_names(5) = ["h       ", "hr      ", "hrs     ", "hour    ", "hours   "]

   !> What the message for an unknown unit offers
   character(8), parameter :: offered(23) = [character(8) :: &
      "deg/s", "deg/h", "deg/min", "mdps", "dps", "rad/s", "rad/h", "mrad/s", "urad/s", "arcsec/s", "rev/s", "rpm", &
      "m/s^2", "g", "mg", "ug", "mgal", "deg", "rad", "mrad", "urad", "arcsec", "arcmin"]

   !> What the five coefficients are coefficients of
   character(40), parameter :: definitions(5) = [character(40) :: &
      "sigma^2 = 3 Q^2/tau^2", "sigma^2 = N^2/tau, two-sided density N^2", "sigma^2 = (2 ln 2/pi) B^2 = (0.664 B)^2", &
      "sigma^2 = K^2 tau/3", "sigma^2 = R^2 tau^2/2"]

contains

   !> The unit that a text names. Case, blanks and brackets do not matter; `dps`, `deg/s`, `deg s^-1`,
   !> `degrees per second` and the degree sign are the same unit.
   pure subroutine parse_unit(text, unit, error)
      !> As somebody wrote it
      character(*), intent(in) :: text
      !> The unit
      type(unit_type), intent(out) :: unit
      !> Allocated where the text names no known unit: invalid_argument, with the nearest known one
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: word, plain, message
      integer :: i, slash

      word = text
      call make_plain(word)
      plain = meant(word)
      slash = index(plain, "/")
      do i = 1, size(accelerations)
         if (plain /= trim(accelerations(i))) cycle
         call set_unit(unit, plain, quantity%acceleration, acceleration_to_si(i))
         return
      end do
      do i = 1, size(velocities)
         if (plain /= trim(velocities(i))) cycle
         call set_unit(unit, plain, quantity%velocity, velocity_to_si(i))
         return
      end do
      if (slash == 0) call find_angle(plain, "", quantity%angle, unit)
      if (slash > 0) call find_angle(meant(plain(:slash - 1)), plain(slash + 1:), quantity%angular_rate, unit)
      if (unit%quantity /= quantity%unknown) return

      message = "unknown unit '"//trim(adjustl(text))//"'"
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
      !> In that order
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

   !> The text in lower case without blanks, brackets and signs that are not ASCII, with `/s` for `per s` and `s^-1`.
   pure subroutine make_plain(plain)
      character(:), allocatable, intent(inout) :: plain
      character(1), parameter :: dropped(7) = [" ", "_", "[", "]", "(", ")", achar(9)]
      integer :: i

      plain = lower(plain)
      call replace_all(plain, char(194)//char(176), "deg")
      call replace_all(plain, char(194)//char(186), "deg")
      call replace_all(plain, char(194)//char(178), "^2")
      call replace_all(plain, char(194)//char(181), "u")
      call replace_all(plain, char(206)//char(188), "u")
      call replace_all(plain, char(194)//char(183), "")
      call replace_all(plain, char(226)//char(129)//char(187)//char(194)//char(185), "^-1")
      call replace_all(plain, char(226)//char(129)//char(187)//"^2", "^-2")
      call replace_all(plain, char(176), "deg")
      call replace_all(plain, char(178), "^2")
      call replace_all(plain, char(181), "u")
      call replace_all(plain, "**", "^")
      call replace_all(plain, "*", "")
      do i = 1, size(dropped)
         call replace_all(plain, dropped(i), "")
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

   !> Which spelling a text is; 0: none.
   pure integer function spelling_of(text) result(at)
      character(*), intent(in) :: text

      do at = size(spellings, 2), 1, -1
         if (text == spellings(1, at)) return
      end do
   end function spelling_of

   !> The length of `meant`.
   pure integer function meant_length(text)
      character(*), intent(in) :: text

      meant_length = len(text)
      if (spelling_of(text) > 0) meant_length = len_trim(spellings(2, spelling_of(text)))
   end function meant_length

   !> What a spelling means; the text itself where it is none.
   pure function meant(text) result(name)
      character(*), intent(in) :: text
      character(meant_length(text)) :: name

      name = text
      if (spelling_of(text) > 0) name = spellings(2, spelling_of(text))
   end function meant

   !> Fills the unit where `angle` is a known angle and `time` is "" or a known time.
   pure subroutine find_angle(angle, time, what, unit)
      character(*), intent(in) :: angle, time
      integer, intent(in) :: what
      type(unit_type), intent(inout) :: unit
      real(dp) :: seconds
      character(:), allocatable :: name
      integer :: i

      name = ""
      seconds = 1.0_dp
      if (len(time) > 0) then
         seconds = 0.0_dp
         if (any(seconds_names == time)) seconds = 1.0_dp
         if (any(minutes_names == time)) seconds = 60.0_dp
         if (any(hours_names == time)) seconds = 3600.0_dp
         if (seconds < 0.5_dp) return
         name = "/s"
         if (seconds > 30.0_dp) name = "/min"
         if (seconds > 300.0_dp) name = "/h"
      end if
      if (what == quantity%angular_rate .and. len(time) == 0) return
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

   !> Fills the unit.
   pure subroutine set_unit(unit, name, what, to_si)
      type(unit_type), intent(inout) :: unit
      character(*), intent(in) :: name
      integer, intent(in) :: what
      real(dp), intent(in) :: to_si

      unit%name = name
      unit%quantity = what
      unit%to_si = to_si
   end subroutine set_unit

   !> Seconds in a unit of time: s, ms, us, ns, min, h and their spellings, perhaps behind a whole
   !> number (100us); 0 for other words.
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
      time_scale = time_scale*sum([(real(iachar(word(i:i)) - iachar("0"), dp)*10.0_dp**(digits - i), i=1, digits)])
   end function time_scale

   !> True for the units of angles and velocities: what rates and accelerations add up to.
   pure logical function is_integral(unit)
      !> Of increments, angles or rates
      type(unit_type), intent(in) :: unit

      is_integral = unit%quantity == quantity%angle .or. unit%quantity == quantity%velocity
   end function is_integral

   !> The unit of the rate that differences of an angle give, per second: "arcsec" gives "arcsec/s" (deg/h by value); those of a
   !> velocity give an acceleration: "m/s" gives "m/s^2".
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

   !> Length of the definition of a coefficient. (A length that names a private array does not link in a caller with gfortran 12.)
   pure integer function definition_length(term)
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term

      definition_length = len_trim(definitions(max(1, min(term, size(definitions)))))
   end function definition_length

   !> What a coefficient is the coefficient of: the convention that its number has. The same in all units.
   pure function coefficient_definition(term) result(text)
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term
      character(definition_length(term)) :: text

      text = definitions(max(1, min(term, size(definitions))))
   end function coefficient_definition

   !> What a coefficient is stated in, of a record in `unit`.
   !>
   !> Angular rates: arcsec, deg/sqrt(h), deg/h, deg/h^1.5, deg/h^2 (IEEE Std 952). Accelerations: m/s, m/s/sqrt(h), ug,
   !> ug/sqrt(h), ug/h: velocity random walk as data sheets have it, the terms that are accelerations by the standard gravity
   !> 9.80665 m/s^2. SI: rad, rad/sqrt(s), rad/s, rad/s^1.5, rad/s^2 and m/s, m/s/sqrt(s), m/s^2, m/s^2.5, m/s^3.
   !> Where the unit is unknown, or the rate is (`per_sample`), the input's own unit and seconds or samples.
   pure function coefficient_unit(unit, term, per_sample) result(u)
      !> Of the record
      type(unit_type), intent(in) :: unit
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term
      !> True where the sample interval is not known: nothing is converted
      logical, intent(in), optional :: per_sample
      type(coefficient_unit_type) :: u
      character(11), parameter :: angle_name(5) = [character(11) :: "arcsec", "deg/sqrt(h)", "deg/h", "deg/h^1.5", "deg/h^2"]
      character(11), parameter :: angle_si(5) = [character(11) :: "rad", "rad/sqrt(s)", "rad/s", "rad/s^1.5", "rad/s^2"]
      character(11), parameter :: speed_name(5) = [character(11) :: "m/s", "m/s/sqrt(h)", "ug", "ug/sqrt(h)", "ug/h"]
      character(11), parameter :: speed_si(5) = [character(11) :: "m/s", "m/s/sqrt(s)", "m/s^2", "m/s^2.5", "m/s^3"]
      real(dp), parameter :: angle_factor(5) = [648.0e3_dp, 10.8e3_dp, 648.0e3_dp, 38.88e6_dp, 2332.8e6_dp]/pi
      real(dp), parameter :: speed_factor(5) = &
         [1.0_dp, 60.0_dp, 1.0e6_dp/standard_gravity, 60.0e6_dp/standard_gravity, 3600.0e6_dp/standard_gravity]
      integer :: what

      what = unit%quantity
      if (present(per_sample)) then
         if (per_sample) what = quantity%unknown
      end if
      if (what == quantity%angular_rate) then
         u%name = trim(angle_name(term))
         u%si_name = trim(angle_si(term))
         u%from_si = angle_factor(term)
      else if (what == quantity%acceleration) then
         u%name = trim(speed_name(term))
         u%si_name = trim(speed_si(term))
         u%from_si = speed_factor(term)
      else
         u = input_coefficient_unit(unit, term, per_sample)
      end if
   end function coefficient_unit

   !> What N is stated in as a density: deg/s/sqrt(Hz), ug/sqrt(Hz), otherwise the input's own unit per root of a hertz.
   pure function density_unit(unit) result(u)
      !> Of the record
      type(unit_type), intent(in) :: unit
      type(coefficient_unit_type) :: u

      if (unit%quantity == quantity%angular_rate) then
         u%name = "deg/s/sqrt(Hz)"
         u%si_name = "rad/s/sqrt(Hz)"
         u%from_si = 180.0_dp/pi
      else if (unit%quantity == quantity%acceleration) then
         u%name = "ug/sqrt(Hz)"
         u%si_name = "m/s^2/sqrt(Hz)"
         u%from_si = 1.0e6_dp/standard_gravity
      else
         u = input_coefficient_unit(unit, 3)
         u%name = u%name//"/sqrt(Hz)"
         u%si_name = u%name
      end if
   end function density_unit

   !> The coefficient in the unit of the input and seconds, or samples.
   pure function input_coefficient_unit(unit, term, per_sample) result(u)
      type(unit_type), intent(in) :: unit
      integer, intent(in) :: term
      logical, intent(in), optional :: per_sample
      type(coefficient_unit_type) :: u
      character(:), allocatable :: base, step

      base = "input unit"
      if (allocated(unit%name)) then
         if (len(unit%name) > 0) base = unit%name
      end if
      step = "s"
      if (present(per_sample)) then
         if (per_sample) step = "sample"
      end if
      select case (term)
      case (1); u%name = base//"*"//step
      case (2); u%name = base//"*sqrt("//step//")"
      case (4); u%name = base//"/sqrt("//step//")"
      case (5); u%name = base//"/"//step
      case default; u%name = base
      end select
      u%si_name = u%name
      u%from_si = 1.0_dp/unit%to_si
   end function input_coefficient_unit

end module gyroakf_units
