! SPDX-License-Identifier: MIT
!> Units of the noise coefficients, and what these are coefficients of.
!>
!> The library computes in the unit of its input; only here results are converted.
module gyroakf_coefficient_units
   use gyroakf_kinds, only : dp
   use gyroakf_units, only : quantity, standard_gravity, unit_type
   implicit none (type, external)
   private
   public :: coefficient_unit_type, coefficient_unit, density_unit, coefficient_definition

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

   !> What the five coefficients are coefficients of
   character(40), parameter :: definitions(5) = [character(40) :: "sigma^2 = 3 Q^2/tau^2", &
      "sigma^2 = N^2/tau, two-sided density N^2", "sigma^2 = (2 ln 2/pi) B^2 = (0.664 B)^2", &
      "sigma^2 = K^2 tau/3", "sigma^2 = R^2 tau^2/2"]

contains

   !> Length of the definition of a coefficient. (A length that names a private array does not link
   !> in a caller with gfortran 12.)
   pure integer function definition_length(term)
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term

      definition_length = len_trim(definitions(max(1, min(term, size(definitions)))))
   end function definition_length

   !> What a coefficient is the coefficient of: the convention of its number, in all units.
   pure function coefficient_definition(term) result(text)
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term
      character(definition_length(term)) :: text

      text = definitions(max(1, min(term, size(definitions))))
   end function coefficient_definition

   !> The unit of a coefficient of a record in `unit`.
   !>
   !> Angular rates: arcsec, deg/sqrt(h), deg/h, deg/h^1.5, deg/h^2 (IEEE Std 952). Accelerations:
   !> m/s, m/s/sqrt(h), ug, ug/sqrt(h), ug/h: velocity random walk as data sheets have it, the terms
   !> that are accelerations by the standard gravity 9.80665 m/s^2. SI: rad, rad/sqrt(s), rad/s,
   !> rad/s^1.5, rad/s^2 and m/s, m/s/sqrt(s), m/s^2, m/s^2.5, m/s^3. Where the unit is unknown, or
   !> the rate is (`per_sample`), the input's own unit and seconds or samples.
   pure function coefficient_unit(unit, term, per_sample) result(u)
      type(unit_type), intent(in) :: unit
      !> 1 to 5 for Q N B K R
      integer, intent(in) :: term
      !> True where the sample interval is not known: nothing is converted
      logical, intent(in), optional :: per_sample
      type(coefficient_unit_type) :: u
      character(11), parameter :: angle_name(5) = [character(11) :: "arcsec", "deg/sqrt(h)", &
         "deg/h", "deg/h^1.5", "deg/h^2"]
      character(11), parameter :: angle_si(5) = [character(11) :: "rad", "rad/sqrt(s)", "rad/s", &
         "rad/s^1.5", "rad/s^2"]
      character(11), parameter :: speed_name(5) = [character(11) :: "m/s", "m/s/sqrt(h)", "ug", &
         "ug/sqrt(h)", "ug/h"]
      character(11), parameter :: speed_si(5) = [character(11) :: "m/s", "m/s/sqrt(s)", "m/s^2", &
         "m/s^2.5", "m/s^3"]
      real(dp), parameter :: angle_factor(5) = [648.0e3_dp, 10.8e3_dp, 648.0e3_dp, 38.88e6_dp, &
         2332.8e6_dp]/pi
      real(dp), parameter :: speed_factor(5) = [1.0_dp, 60.0_dp, 1.0e6_dp/standard_gravity, &
         60.0e6_dp/standard_gravity, 3600.0e6_dp/standard_gravity]
      character(6) :: step
      integer :: what

      what = unit%quantity
      step = "s"
      if (present(per_sample)) then
         if (per_sample) what = quantity%unknown
         if (per_sample) step = "sample"
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
         u = input_coefficient_unit(unit, term, trim(step))
      end if
   end function coefficient_unit

   !> The unit of N as a density: deg/s/sqrt(Hz), ug/sqrt(Hz), else the input's per root of a hertz.
   pure function density_unit(unit) result(u)
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
         u = input_coefficient_unit(unit, 3, "s")
         u%name = u%name//"/sqrt(Hz)"
         u%si_name = u%name
      end if
   end function density_unit

   pure function input_coefficient_unit(unit, term, step) result(u)
      type(unit_type), intent(in) :: unit
      integer, intent(in) :: term
      character(*), intent(in) :: step
      type(coefficient_unit_type) :: u
      character(:), allocatable :: base

      base = "input unit"
      if (allocated(unit%name)) then
         if (len(unit%name) > 0) base = unit%name
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

end module gyroakf_coefficient_units
