! SPDX-License-Identifier: MIT
!> Coefficients in the JSON document: in the stated unit, in SI, with what they are the coefficients of.
module gyroakf_report_document_stated
   use gyroakf_kinds, only : dp
   use gyroakf_allan_noise_fit, only : noise_type
   use gyroakf_pipeline_result, only : stated_coefficient_type, stated_noise_type
   use gyroakf_report_json, only : json_type, open_object, close_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_stated, put_densities, put_known, put_description, put_unquantized

contains

   !> "density": N as a density in both conventions; null where rate or unit is not known.
   subroutine put_densities(json, stated)
      !> The document
      type(json_type), intent(inout) :: json
      !> The coefficients of one series
      type(stated_noise_type), intent(in) :: stated

      if (.not. stated%in_units) then
         call put_null(json, "density")
         return
      end if
      call open_object(json, "density")
      call put_stated(json, "two_sided", stated%density(1), .true.)
      call put_stated(json, "one_sided", stated%density(2), .true.)
      call close_object(json)
   end subroutine put_densities

   !> A coefficient, or N as a density, in the stated unit and in SI.
   subroutine put_stated(json, key, stated, in_units)
      !> The document
      type(json_type), intent(inout) :: json
      !> Its letter, or the density's convention
      character(*), intent(in) :: key
      !> The numbers; null where the term was not fitted
      type(stated_coefficient_type), intent(in) :: stated
      !> Rate and unit are known; the SI numbers are null otherwise
      logical, intent(in) :: in_units

      call open_object(json, key)
      call put_known(json, "value", stated%value, stated%fitted)
      call put_known(json, "std_error", stated%std_error, stated%fitted)
      call put_known(json, "upper_limit", stated%upper_limit, stated%fitted)
      call put_member(json, "detected", stated%detected)
      call put_member(json, "state", trim(stated%state))
      call put_member(json, "unit", stated%unit)
      call put_known(json, "value_si", stated%value_si, stated%fitted .and. in_units)
      call put_known(json, "std_error_si", stated%std_error_si, stated%fitted .and. in_units)
      call put_known(json, "upper_limit_si", stated%upper_limit_si, stated%fitted .and. in_units)
      if (in_units) then
         call put_member(json, "unit_si", stated%unit_si)
      else
         call put_null(json, "unit_si")
      end if
      call put_member(json, "definition", stated%definition)
      call close_object(json)
   end subroutine put_stated

   !> "N_without_quantization" and "lsb_ratio", null where the step of the samples is of no account.
   subroutine put_unquantized(json, stated)
      !> The document
      type(json_type), intent(inout) :: json
      !> The coefficients of one series
      type(stated_noise_type), intent(in) :: stated

      call put_stated(json, "N_without_quantization", stated%unquantized, stated%in_units)
      call put_known(json, "lsb_ratio", stated%lsb_ratio, stated%unquantized%state /= "")
   end subroutine put_unquantized

   !> "fit": how the terms were fitted.
   subroutine put_description(json, noise)
      !> The document
      type(json_type), intent(inout) :: json
      !> The fit
      type(noise_type), intent(in) :: noise

      call open_object(json, "fit")
      call put_member(json, "described", noise%described)
      call put_member(json, "points", noise%points)
      call put_member(json, "left_out", noise%left_out)
      call put_member(json, "cut_off", noise%cut_off)
      call put_known(json, "tau_first_s", noise%tau_first, noise%described)
      call put_known(json, "tau_last_s", noise%tau_last, noise%described)
      call put_member(json, "chi2_freedom", noise%chi2_freedom)
      call put_member(json, "p_value", noise%chi2_probability)
      call put_member(json, "floor_percent", 50*noise%floor)
      call put_member(json, "kurtosis", noise%kurtosis)
      if (allocated(noise%tau)) then
         call put_member(json, "tau_s", noise%tau)
         call put_member(json, "residual", noise%residual)
      else
         call put_null(json, "tau_s")
         call put_null(json, "residual")
      end if
      call close_object(json)
   end subroutine put_description

   !> A number, or null.
   subroutine put_known(json, key, value, known)
      !> The document
      type(json_type), intent(inout) :: json
      !> Name of the member, "" in an array
      character(*), intent(in) :: key
      !> The number
      real(dp), intent(in) :: value
      !> False gives null
      logical, intent(in) :: known

      if (known) then
         call put_member(json, key, value)
      else
         call put_null(json, key)
      end if
   end subroutine put_known

end module gyroakf_report_document_stated
