! SPDX-License-Identifier: MIT
!> Noise coefficients in SI, N as a density in both conventions, and which convention each number has.
module gyroakf_pipeline_conventions
   use gyroakf_kinds, only : dp
   use gyroakf_coefficient_units, only : coefficient_definition, coefficient_unit, coefficient_unit_type, &
      density_unit
   use gyroakf_units, only : unit_type
   use gyroakf_allan_noise_fit, only : coefficient_type, noise_type
   use gyroakf_pipeline_result, only : stated_coefficient_type, stated_noise_type
   implicit none (type, external)
   private
   public :: state_conventions

contains

   !> Fills the SI numbers, the definitions and the densities of coefficients that are stated already.
   !>
   !> A two-sided density S of the rate gives \( \sigma^2 = S/\tau \): its root is N. The one-sided density is 2 S, its root
   !> \( \sqrt 2 N \).
   subroutine state_conventions(noise, unit, stated)
      !> In units of the series and s (samples)
      type(noise_type), intent(in) :: noise
      !> Unit of the series
      type(unit_type), intent(in) :: unit
      !> `in_units` is set; where it is false there is no SI and no density
      type(stated_noise_type), intent(inout) :: stated
      type(coefficient_unit_type) :: u
      integer :: term

      do term = 1, size(stated%term)
         u = coefficient_unit(unit, term)
         stated%term(term)%definition = coefficient_definition(term)
         stated%term(term)%unit_si = ""
         if (.not. stated%in_units) cycle
         call state_si(noise%coefficient(term), unit%to_si, u%si_name, stated%term(term))
      end do
      u = coefficient_unit(unit, 2)
      stated%unquantized%definition = "N without the variance of rounding, step^2/12"
      stated%unquantized%unit_si = ""
      if (.not. stated%in_units) return
      call state_si(noise%unquantized, unit%to_si, u%si_name, stated%unquantized)
      call state_density(noise%coefficient(2), unit, 1.0_dp, "two-sided: N", stated%density(1))
      call state_density(noise%coefficient(2), unit, sqrt(2.0_dp), "one-sided: sqrt(2) N", stated%density(2))
   end subroutine state_conventions

   !> The SI numbers of one coefficient.
   subroutine state_si(from, factor, unit_si, to)
      type(coefficient_type), intent(in) :: from
      real(dp), intent(in) :: factor
      character(*), intent(in) :: unit_si
      type(stated_coefficient_type), intent(inout) :: to

      to%value_si = factor*from%value
      to%std_error_si = factor*from%std_error
      to%upper_limit_si = factor*from%upper_limit
      to%unit_si = unit_si
   end subroutine state_si

   !> N as a density.
   subroutine state_density(from, unit, sides, definition, to)
      type(coefficient_type), intent(in) :: from
      type(unit_type), intent(in) :: unit
      real(dp), intent(in) :: sides
      character(*), intent(in) :: definition
      type(stated_coefficient_type), intent(inout) :: to
      type(coefficient_unit_type) :: u
      real(dp) :: factor

      u = density_unit(unit)
      factor = sides*unit%to_si*u%from_si
      to%value = factor*from%value
      to%std_error = factor*from%std_error
      to%upper_limit = factor*from%upper_limit
      to%detected = from%detected
      to%fitted = from%fitted
      to%unit = u%name
      to%definition = definition
      call state_si(from, sides*unit%to_si, u%si_name, to)
   end subroutine state_density

end module gyroakf_pipeline_conventions
