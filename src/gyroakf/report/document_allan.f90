! SPDX-License-Identifier: MIT
!> Allan deviations and noise coefficients of a channel, described: coefficients in the stated unit,
!> in SI, with what they are the coefficients of.
module gyroakf_report_document_allan
   use gyroakf_units, only : term_names
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_fit, only : noise_type
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, stage, stage_names, &
      stated_coefficient_type, stated_read_off_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_verdicts, only : slopes_text
   implicit none (type, external)
   private
   public :: put_allan, put_halves, put_coefficients, put_noise

contains

   !> "allan".
   subroutine put_allan(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      integer :: which, i

      call out%open("allan")
      do which = stage%input, stage%compensated
         associate (allan => channel%allan(which))
            if (.not. out%opens(trim(stage_names(which)), allan%available)) cycle
            call put_curve(out, allan%curve)
            if (out%opens("other_kinds", allocated(allan%other))) then
               do i = 1, size(allan%other)
                  if (.not. allocated(allan%other(i)%tau)) cycle     ! it could not be computed
                  call out%open(trim(allan%other(i)%kind))
                  call put_curve(out, allan%other(i))
                  call out%put("other_kinds")
                  call out%close()
               end do
               call out%close()
            end if
            call out%close()
         end associate
      end do
      call put_halves(out, channel)
      call out%close()
   end subroutine put_allan

   !> "halves": the second half of the record against the first.
   subroutine put_halves(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      if (.not. out%opens("halves", channel%available%halves, &
                          "Second half against the first")) return
      call out%put("statistic", channel%halves%statistic, title="chi-square")
      call out%put("freedom", channel%halves%freedom, title="degrees of freedom")
      call out%put("p_value", channel%halves%p_value)
      call out%put("tau_s", channel%halves%tau, shown=.false.)
      call out%put("ratio", channel%halves%ratio, shown=.false.)
      call out%put("lower", channel%halves%lower, shown=.false.)
      call out%put("upper", channel%halves%upper, shown=.false.)
      call out%close()
   end subroutine put_halves

   !> Members of a curve.
   subroutine put_curve(out, curve)
      class(description_type), intent(inout) :: out
      type(allan_curve_type), intent(in) :: curve

      call out%put("kind", trim(curve%kind))
      call out%put("tau_s", curve%tau)
      call out%put("deviation", curve%deviation)
      call out%put("lower", curve%lower)
      call out%put("upper", curve%upper)
      call out%put("edf", curve%edf)
      call out%put("terms", curve%terms)
   end subroutine put_curve

   !> "coefficients".
   subroutine put_coefficients(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      integer :: which, term

      call out%open("coefficients")
      do which = stage%input, stage%compensated
         call put_noise(out, trim(stage_names(which)), "Noise coefficients", channel%allan(which))
      end do
      call out%open("reduction_percent")
      do term = 1, 5
         call out%put(term_names(term), channel%reduction_percent(term), &
                      channel%reduction_known(term))
      end do
      call out%close()
      call out%close()
   end subroutine put_coefficients

   !> The coefficients of one series; the numbers of a term that was not fitted are null,
   !> "lsb_ratio" where the step of the samples is of no account, "density" (N in both conventions)
   !> where rate or unit is not known.
   subroutine put_noise(out, key, title, allan)
      class(description_type), intent(inout) :: out
      !> The series, and what a text calls its coefficients
      character(*), intent(in) :: key, title
      !> Absent where nothing was fitted
      type(allan_result_type), intent(in) :: allan
      integer :: term

      if (.not. out%opens(key, allan%fitted, title)) return
      associate (stated => allan%stated, plain => allan%stated%unquantized, read => allan%read_off)
         do term = 1, 5
            call put_stated(out, term_names(term), stated%term(term), stated%in_units)
         end do
         call put_stated(out, "N_without_quantization", plain, stated%in_units, "N unquantized", &
                         plain%state /= "")
         call out%put("lsb_ratio", stated%lsb_ratio, plain%state /= "" .and. &
                      stated%lsb_ratio < huge(stated%lsb_ratio))
         call out%put("chi2_reduced", allan%noise%chi2_reduced, shown=.false.)
         call out%open("read_off", "Read off")
         do term = 1, 5
            call out%put(term_names(term), read%value(term), read%found(term))
         end do
         call out%put("minimum", read%minimum, read%known)
         call out%put("minimum_tau_s", read%minimum_tau, read%known, title="at tau =")
         call out%put("falling", read%falling, title="falling at the end")
         call out%close()
         if (out%opens("density", stated%in_units, "Density of N")) then
            call put_stated(out, "two_sided", stated%density(1), .true.)
            call put_stated(out, "one_sided", stated%density(2), .true.)
            call out%close()
         end if
      end associate
      call out%open("fit", "Fit")
      call out%put("described", allan%noise%described)
      call out%put("points", allan%noise%points, title="octaves")
      call out%put("left_out", allan%noise%left_out, title="octaves excluded at short tau")
      call out%put("cut_off", allan%noise%cut_off, title="at long tau")
      call out%put("tau_first_s", allan%noise%tau_first, allan%noise%described, title="tau from")
      call out%put("tau_last_s", allan%noise%tau_last, allan%noise%described, title="to")
      call out%put("chi2_freedom", allan%noise%chi2_freedom, title="degrees of freedom")
      call out%put("p_value", allan%noise%chi2_probability)
      call out%put("floor_percent", 50*allan%noise%floor, title="misfit allowed for")
      call out%put("kurtosis", allan%noise%kurtosis)
      if (.not. allan%noise%described) call out%remark(slopes_text(allan%curve))
      if (allocated(allan%noise%tau)) then
         call out%put("tau_s", allan%noise%tau, shown=.false.)
         call out%put("residual", allan%noise%residual, shown=.false.)
      else
         call out%put("tau_s")
         call out%put("residual")
      end if
      call out%close()
      call out%close()
   end subroutine put_noise

   !> A coefficient, or N as a density, in the stated unit and in SI.
   subroutine put_stated(out, key, stated, in_units, title, shown)
      class(description_type), intent(inout) :: out
      character(*), intent(in) :: key
      type(stated_coefficient_type), intent(in) :: stated
      !> Rate and unit are known; the SI numbers are null otherwise
      logical, intent(in) :: in_units
      character(*), intent(in), optional :: title
      logical, intent(in), optional :: shown
      logical :: known

      call out%open(key, title, shown)
      call out%put("value", stated%value, stated%fitted, stated%unit, stated%std_error, &
                   "=", stated%detected)
      call out%put("std_error", stated%std_error, stated%fitted, shown=.false.)
      call out%put("upper_limit", stated%upper_limit, stated%fitted, stated%unit, title="<", &
                   shown=.not. stated%detected)
      call out%put("detected", stated%detected, shown=.false.)
      call out%put("state", trim(stated%state), shown=.not. (stated%fitted .or. stated%state == ""))
      call out%put("unit", stated%unit, shown=.false.)
      known = stated%fitted .and. in_units
      call out%put("value_si", stated%value_si, known, stated%unit_si, stated%std_error_si, "SI:", &
                   stated%detected)
      call out%put("std_error_si", stated%std_error_si, known, shown=.false.)
      call out%put("upper_limit_si", stated%upper_limit_si, known, stated%unit_si, title="SI: <", &
                   shown=.not. stated%detected)
      call out%put("unit_si", stated%unit_si, in_units, shown=.false.)
      call out%put("definition", stated%definition)
      call out%close()
   end subroutine put_stated

end module gyroakf_report_document_allan
