! SPDX-License-Identifier: MIT
!> Coefficients in the JSON document: in the stated unit, in SI, with what they are the coefficients of.
module gyroakf_report_document_stated
   use gyroakf_kinds, only : dp
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_fit, only : noise_type
   use gyroakf_pipeline_result, only : stated_coefficient_type, stated_noise_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_verdicts, only : slopes_text
   implicit none (type, external)
   private
   public :: put_stated, put_densities, put_description, put_unquantized

contains

   !> "density": N as a density in both conventions; null where rate or unit is not known.
   subroutine put_densities(out, stated)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The coefficients of one series
      type(stated_noise_type), intent(in) :: stated

      if (.not. stated%in_units) then
         call out%absent("density")
         return
      end if
      call out%open("density", "Density of N")
      call put_stated(out, "two_sided", stated%density(1), .true.)
      call put_stated(out, "one_sided", stated%density(2), .true.)
      call out%close()
   end subroutine put_densities

   !> A coefficient, or N as a density, in the stated unit and in SI.
   subroutine put_stated(out, key, stated, in_units, title, shown)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> Its letter, or the density's convention
      character(*), intent(in) :: key
      !> The numbers; null where the term was not fitted
      type(stated_coefficient_type), intent(in) :: stated
      !> Rate and unit are known; the SI numbers are null otherwise
      logical, intent(in) :: in_units
      !> What a text calls it (default: its letter)
      character(*), intent(in), optional :: title
      !> A text has it (default: yes)
      logical, intent(in), optional :: shown

      call out%open(key, title, shown)
      call out%put("value", stated%value, stated%fitted, stated%unit, stated%std_error, &
                   "=", stated%detected)
      call out%put("std_error", stated%std_error, stated%fitted, shown=.false.)
      call out%put("upper_limit", stated%upper_limit, stated%fitted, stated%unit, title="<", &
                   shown=.not. stated%detected)
      call out%put("detected", stated%detected, shown=.false.)
      call out%put("state", trim(stated%state), shown=.not. (stated%fitted .or. stated%state == ""))
      call out%put("unit", stated%unit, shown=.false.)
      call out%put("value_si", stated%value_si, stated%fitted .and. in_units, &
                   stated%unit_si, stated%std_error_si, "SI:", stated%detected)
      call out%put("std_error_si", stated%std_error_si, stated%fitted .and. in_units, shown=.false.)
      call out%put("upper_limit_si", stated%upper_limit_si, stated%fitted .and. in_units, &
                   stated%unit_si, title="SI: <", shown=.not. stated%detected)
      if (in_units) then
         call out%put("unit_si", stated%unit_si, shown=.false.)
      else
         call out%absent("unit_si")
      end if
      call out%put("definition", stated%definition)
      call out%close()
   end subroutine put_stated

   !> "N_without_quantization" and "lsb_ratio", null where the step of the samples is of no account.
   subroutine put_unquantized(out, stated)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The coefficients of one series
      type(stated_noise_type), intent(in) :: stated

      call put_stated(out, "N_without_quantization", stated%unquantized, stated%in_units, &
                      "N unquantized", stated%unquantized%state /= "")
      call out%put("lsb_ratio", stated%lsb_ratio, stated%unquantized%state /= "")
   end subroutine put_unquantized

   !> "fit": how the terms were fitted.
   subroutine put_description(out, noise, curve)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The fit
      type(noise_type), intent(in) :: noise
      !> What was fitted
      type(allan_curve_type), intent(in) :: curve

      call out%open("fit", "Fit")
      call out%put("described", noise%described)
      call out%put("points", noise%points, title="octaves")
      call out%put("left_out", noise%left_out, title="octaves excluded at short tau")
      call out%put("cut_off", noise%cut_off, title="at long tau")
      call out%put("tau_first_s", noise%tau_first, noise%described, title="tau from")
      call out%put("tau_last_s", noise%tau_last, noise%described, title="to")
      call out%put("chi2_freedom", noise%chi2_freedom, title="degrees of freedom")
      call out%put("p_value", noise%chi2_probability)
      call out%put("floor_percent", 50*noise%floor, title="misfit allowed for")
      call out%put("kurtosis", noise%kurtosis)
      if (.not. noise%described) call out%remark(slopes_text(curve))
      if (allocated(noise%tau)) then
         call out%put("tau_s", noise%tau, shown=.false.)
         call out%put("residual", noise%residual, shown=.false.)
      else
         call out%absent("tau_s")
         call out%absent("residual")
      end if
      call out%close()
   end subroutine put_description

end module gyroakf_report_document_stated
