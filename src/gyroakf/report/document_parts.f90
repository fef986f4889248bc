! SPDX-License-Identifier: MIT
!> The members of a channel in the JSON document.
module gyroakf_report_document_parts
   use gyroakf_kinds, only : dp
   use gyroakf_units, only : term_names
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_pipeline_result, only : channel_result_type, allan_result_type, stated_read_off_type, stage, stage_names
   use gyroakf_report_document_ar, only : put_ar_members
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document_distribution, only : put_distribution
   use gyroakf_report_document_periodicity, only : put_fisher, put_welch
   use gyroakf_report_document_stated, only : put_stated, put_densities, put_description, put_unquantized
   use gyroakf_report_document_adf, only : put_adf_regression
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_document_correlation, only : put_kpss, put_ljung_box
   use gyroakf_report_verdicts, only : correlation_caution, normality_text, rejection_text, verdict_text
   implicit none (type, external)
   private
   public :: put_verdict, put_tests, put_ar, put_allan, put_halves, put_coefficients, put_noise

contains

   !> "verdict": null where none was looked for.
   subroutine put_verdict(out, record, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> For the units
      type(record_type), intent(in) :: record
      !> One channel
      type(channel_result_type), intent(in) :: channel
      type(text_type), allocatable :: reasons(:)

      if (.not. channel%verdict%wanted) then
         call out%absent("verdict")
         return
      end if
      allocate (reasons(0))
      if (allocated(channel%verdict%reasons)) reasons = channel%verdict%reasons
      associate (verdict => channel%verdict)
         call out%open("verdict", "Verdict")
         call out%remark(verdict_text(channel))
         call out%put("stationary", verdict%stationary, verdict%stationary .or. verdict%drifts, shown=.false.)
         call out%put("drift", trim(verdict%drift), shown=.false.)
         if (verdict%trend%shape == "") then
            call out%absent("trend")
         else
            call out%open("trend")
            call out%put("shape", trim(merge("ramp   ", "warm_up", verdict%trend%shape == "ramp")))
            call out%put("size", verdict%trend%size, std_error=verdict%trend%std_error)
            call out%put("std_error", verdict%trend%std_error, shown=.false.)
            call out%put("time_constant_s", verdict%trend%time_constant*record%sample_interval, &
                           verdict%trend%shape /= "ramp" .and. record%rate_known)
            call out%put("gain", verdict%trend%gain)
            call out%close()
         end if
         call out%put("reasons", reasons)
         call out%close()
      end associate
   end subroutine put_verdict

   !> "tests".
   subroutine put_tests(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel

      call out%open("tests", "Tests")
      call out%put("series", trim(channel%tested), title="of the")
      call put_adf(out, channel)
      call put_kpss(out, channel)
      if (channel%available%jarque_bera) then
         call out%open("jarque_bera", "Jarque-Bera")
         call out%remark(normality_text(channel))
         call out%put("statistic", channel%jarque_bera%statistic)
         call out%put("p_value", channel%jarque_bera%p_value)
         call out%put("skewness", channel%jarque_bera%skewness, &
                      std_error=channel%jarque_bera%skewness_error)
         call out%put("kurtosis", channel%jarque_bera%kurtosis, &
                      std_error=channel%jarque_bera%kurtosis_error)
         call out%put("skewness_std_error", channel%jarque_bera%skewness_error, shown=.false.)
         call out%put("kurtosis_std_error", channel%jarque_bera%kurtosis_error, shown=.false.)
         call out%remark(correlation_caution(channel))
         call out%close()
      else
         call out%absent("jarque_bera")
      end if
      call put_ljung_box(out, "ljung_box", "Ljung-Box", channel%ljung_box, channel%available%ljung_box)
      call put_fisher(out, channel)
      call put_distribution(out, channel)
      call put_welch(out, channel)
      call out%close()
   end subroutine put_tests

   !> "adf".
   subroutine put_adf(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%adf) then
         call out%absent("adf")
         return
      end if
      call out%open("adf", "ADF")
      call out%remark(rejection_text("unit root", channel%adf%stationary))
      call out%put("statistic", channel%adf%statistic)
      call out%put("p_value", channel%adf%p_value)
      call out%put("lag", channel%adf%lag)
      call out%put("observations", channel%adf%observations)
      call out%put("regression", trim(channel%adf%regression))
      call out%open("critical", "critical values")
      call out%put("1%", channel%adf%critical(1))
      call out%put("5%", channel%adf%critical(2))
      call out%put("10%", channel%adf%critical(3))
      call out%close()
      call out%put("stationary", channel%adf%stationary, shown=.false.)
      call put_adf_regression(out, channel%adf)
      call out%close()
   end subroutine put_adf

   !> "ar".
   subroutine put_ar(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%available%ar) then
         call out%absent("ar")
         return
      end if
      call out%open("ar", "AR model")
      call out%put("method", trim(channel%ar%method))
      call out%put("criterion", trim(channel%ar%criterion))
      call out%put("order", channel%ar%order)
      call out%put("coefficients", channel%ar%coefficient, std_errors=channel%ar%std_error)
      call out%put("std_errors", channel%ar%std_error, shown=.false.)
      call out%put("noise_variance", channel%ar%noise_variance)
      call out%put("mean", channel%ar%mean, shown=.false.)
      call out%open_list("table", shown=.false.)
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         call out%open("")
         call out%put("order", channel%ar%table(i)%order)
         call out%put("noise_variance", channel%ar%table(i)%noise_variance)
         call out%put("aic", channel%ar%table(i)%aic)
         call out%put("aicc", channel%ar%table(i)%aicc)
         call out%put("bic", channel%ar%table(i)%bic)
         call out%put("hqic", channel%ar%table(i)%hqic)
         call out%put("fpe", channel%ar%table(i)%fpe)
         call out%put("aic_per_observation", channel%ar%table(i)%aic_per_observation)
         call out%close()
      end do
      call out%close()
      call put_ljung_box(out, "residual_ljung_box", "Residuals", channel%ar%residual_ljung_box, &
                         channel%ar%residual_ljung_box%lags > 0)
      call put_ar_members(out, channel%ar)
      call out%close()
   end subroutine put_ar

   !> "allan".
   subroutine put_allan(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: which

      call out%open("allan")
      do which = stage%input, stage%compensated
         associate (allan => channel%allan(which))
            if (.not. allan%available) then
               call out%absent(trim(stage_names(which)))
               cycle
            end if
            call out%open(trim(stage_names(which)))
            call put_curve(out, allan%curve)
            if (allocated(allan%other)) then
               call put_other_kinds(out, allan%other)
            else
               call out%absent("other_kinds")
            end if
            call out%close()
         end associate
      end do
      call put_halves(out, channel)
      call out%close()
   end subroutine put_allan

   !> "halves": the second half of the record against the first.
   subroutine put_halves(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%halves) then
         call out%absent("halves")
         return
      end if
      associate (halves => channel%halves)
         call out%open("halves", "Second half against the first")
         call out%put("statistic", halves%statistic, title="chi-square")
         call out%put("freedom", halves%freedom, title="degrees of freedom")
         call out%put("p_value", halves%p_value)
         call out%put("tau_s", halves%tau, shown=.false.)
         call out%put("ratio", halves%ratio, shown=.false.)
         call out%put("lower", halves%lower, shown=.false.)
         call out%put("upper", halves%upper, shown=.false.)
         call out%close()
      end associate
   end subroutine put_halves

   !> Members of a curve.
   subroutine put_curve(out, curve)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The curve
      type(allan_curve_type), intent(in) :: curve

      call out%put("kind", trim(curve%kind))
      call out%put("tau_s", curve%tau)
      call out%put("deviation", curve%deviation)
      call out%put("lower", curve%lower)
      call out%put("upper", curve%upper)
      call out%put("edf", curve%edf)
      call out%put("terms", real(curve%terms, dp))
   end subroutine put_curve

   !> "other_kinds": the curves of the further kinds, each under its name.
   subroutine put_other_kinds(out, curves)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The curves; those that could not be computed are left out
      type(allan_curve_type), intent(in) :: curves(:)
      integer :: i

      call out%open("other_kinds")
      do i = 1, size(curves)
         if (.not. allocated(curves(i)%tau)) cycle
         call out%open(trim(curves(i)%kind))
         call put_curve(out, curves(i))
         call out%absent("other_kinds")
         call out%close()
      end do
      call out%close()
   end subroutine put_other_kinds

   !> "coefficients".
   subroutine put_coefficients(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
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

   !> The coefficients of one series; the numbers of a term that was not fitted are null.
   subroutine put_noise(out, key, title, allan)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> The series, and what a text calls its coefficients
      character(*), intent(in) :: key, title
      !> Absent where nothing was fitted
      type(allan_result_type), intent(in) :: allan
      integer :: term

      if (.not. allan%fitted) then
         call out%absent(key)
         return
      end if
      call out%open(key, title)
      do term = 1, 5
         call put_stated(out, term_names(term), allan%stated%term(term), allan%stated%in_units)
      end do
      call put_unquantized(out, allan%stated)
      call out%put("chi2_reduced", allan%noise%chi2_reduced, shown=.false.)
      call put_read_off(out, allan%read_off)
      call put_densities(out, allan%stated)
      call put_description(out, allan%noise, allan%curve)
      call out%close()
   end subroutine put_noise

   !> "read_off": what the curve alone says, null where there is no segment.
   subroutine put_read_off(out, read_off)
      class(description_type), intent(inout) :: out
      type(stated_read_off_type), intent(in) :: read_off
      integer :: term

      call out%open("read_off", "Read off")
      do term = 1, 5
         call out%put(term_names(term), read_off%value(term), read_off%found(term))
      end do
      call out%put("minimum", read_off%minimum, read_off%known)
      call out%put("minimum_tau_s", read_off%minimum_tau, read_off%known, title="at tau =")
      call out%put("falling", read_off%falling, title="falling at the end")
      call out%close()
   end subroutine put_read_off

end module gyroakf_report_document_parts
