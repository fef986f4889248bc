! SPDX-License-Identifier: MIT
!> The filters of a channel and its drift in the JSON document.
module gyroakf_report_document_filters
   use gyroakf_kinds, only : dp
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document_tests, only : put_ljung_box
   use gyroakf_report_verdicts, only : drift_source_text
   implicit none (type, external)
   private
   public :: put_filters, put_drift

contains

   !> "filters".
   subroutine put_filters(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel

      call out%open("filters", "Filters")
      associate (is => channel%available, of => channel)
         call put_filter(out, "kf", "KF (paper)", of%kf, of%kf_figures, is%kf)
         call put_filter(out, "akf", "AKF (paper)", of%akf, of%akf_figures, is%akf)
         call put_filter(out, "drift_kf", "Drift KF", of%drift_kf, of%drift_kf_figures, is%drift_kf)
         call put_filter(out, "drift_akf", "Drift AKF", of%drift_akf, of%drift_akf_figures, &
                         is%drift_akf)
         call put_filter(out, "drift_smoother", "Smoother", of%drift_smoother, &
                         of%drift_smoother_figures, is%drift_smoother)
      end associate
      call out%close()
   end subroutine put_filters

   !> One filter; "forgetting" is null where nothing is adapted. A smoother has no innovations, and
   !> no gain of its own.
   subroutine put_filter(out, key, title, filter, figures, available)
      class(description_type), intent(inout) :: out
      character(*), intent(in) :: key, title
      type(filter_result_type), intent(in) :: filter
      type(filter_figures_type), intent(in) :: figures
      logical, intent(in) :: available
      logical :: measured, adapts
      character(40) :: rmse_title

      if (.not. out%opens(key, available, title)) return
      measured = filter%nis_high > 0.0_dp
      call out%put("mean", filter%mean, shown=.false.)
      call out%put("variance", filter%variance, shown=.false.)
      call out%put("gain", filter%gain, measured, title="mean gain of the last third")
      call out%put("dc_gain", filter%dc_gain, shown=.false.)
      call out%put("q", filter%q, title="Q")
      call out%put("r", filter%r, title="R")
      call out%put("nis_mean", filter%nis_mean, measured, shown=.false.)
      call put_ljung_box(out, "ljung_box", "Ljung-Box of the innovations", filter%ljung_box, &
                         filter%ljung_box%lags > 0)
      adapts = .false.
      if (allocated(filter%estimate)) adapts = size(filter%estimate) > 0
      call out%put("forgetting", filter%forgetting, adapts)
      call out%put_texts("estimate", filter%estimate, title="adapts")
      call out%put("clamped", filter%clamped, title="steps at a bound")
      call out%put("gated", filter%gated, title="gated steps")
      write (rmse_title, "(a, i0, a)") "RMSE over ", figures%rmse_samples, " samples"
      call out%put("rmse", figures%rmse, figures%rmse_samples > 0, title=trim(rmse_title))
      call out%put_texts("warnings", filter%warnings, title="notes:")
      call out%put("nis_low", filter%nis_low, measured, shown=.false.)
      call out%put("nis_high", filter%nis_high, measured, shown=.false.)
      call out%close()
   end subroutine put_filter

   !> "drift": the model, what speaks for it, and what is left of the record without it.
   subroutine put_drift(out, channel)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. out%opens("drift", channel%available%drift, "Drift model")) return
      associate (drift => channel%drift)
         call out%put("found", drift%found)
         call out%put("doubt", channel%drift_doubt, title="no model describes the record:")
         call out%put("tau_s", channel%drift_tau, title="of processes slower than")
         if (.not. drift%found) call out%remark("nothing slower was found under the noise: "// &
                                                "there is nothing that a filter could follow "// &
                                                "and subtract")
         call out%put("name", trim(drift%name), title="model")
         if (channel%verdict%stationary .and. drift%found) then
            call out%remark("an approximation of the slow part of stationary noise")
         end if
         call out%remark(drift_source_text(channel))
         call put_model(out, drift%model)
         call out%open("slow", shown=.false., list=.true.)
         do i = 1, drift%model%count
            call out%put("", drift%slow(i))
         end do
         call out%close()
         call put_errors(out, drift%std_error, drift%model%count, drift%errors_known)
         call out%open("processes", "Processes", list=.true.)
         do i = 1, size(channel%drift_process)
            associate (process => channel%drift_process(i), known => drift%errors_known)
               call out%open("")
               call out%put("kind", trim(merge("walk", "ar1 ", process%walk)), title="kind")
               call out%put("drift", process%slow)
               call out%put("correlation_s", process%time, process%time > 0.0_dp, &
                            std_error=process%time_error, title="correlation time")
               call out%put("correlation_s_std_error", process%time_error, &
                            known .and. process%time > 0.0_dp, shown=.false.)
               call out%put("std", process%std, title="standard deviation")
               call out%put("k", process%k%value, process%k%detected, process%k%unit, &
                            process%k%std_error, "K")
               call out%put("k_std_error", process%k%std_error, known .and. process%k%detected, &
                            shown=.false.)
               call out%put("k_unit", process%k%unit, process%walk, shown=.false.)
               call out%close()
            end associate
         end do
         call out%close()
         call out%put("correlation_s", channel%drift_time, &
                      drift%found .and. channel%drift_time > 0.0_dp, shown=.false.)
         call out%put("drift_std", drift%drift_std, drift%found, &
                      title="standard deviation of the drift")
         call out%put("white_std", drift%white_std, std_error=channel%white_std_error, &
                      title="standard deviation of the white noise")
         call out%put("white_std_error", channel%white_std_error, drift%errors_known, shown=.false.)
         call out%put("level", channel%level%mean, shown=.false.)
         call out%put("level_variance", channel%level%variance, shown=.false.)
         call out%put("log_likelihood", drift%log_likelihood)
         call out%open("candidates", "Candidates", list=.true.)
         do i = 1, size(drift%candidate)
            associate (tried => drift%candidate(i))
               call out%open("")
               call out%put("name", trim(tried%name), title="model")
               call out%put("chosen", i == drift%chosen)
               call put_model(out, tried%model)
               call put_errors(out, tried%std_error, tried%model%count, tried%errors_known)
               call out%put("parameters", tried%parameters)
               call out%put("log_likelihood", tried%log_likelihood)
               call out%put("aic", tried%aic, title="AIC")
               call out%put("bic", tried%bic, title="BIC")
               call out%put("converged", tried%converged)
               call out%close()
            end associate
         end do
         call out%close()
         call out%put("samples", drift%samples, shown=.false.)
         call out%put("of_samples", drift%of_samples, shown=.false.)
         call out%put("block_samples", drift%block, shown=.false.)
      end associate
      associate (smoothed => channel%available%drift_smoother, left => channel%compensated)
         call out%put("compensated_mean", left%mean, smoothed, shown=.false.)
         call out%put("compensated_variance", left%variance, smoothed, shown=.false.)
      end associate
      call out%close()
   end subroutine put_drift

   !> Members "phi", "q", "r".
   subroutine put_model(out, model)
      class(description_type), intent(inout) :: out
      type(component_model_type), intent(in) :: model

      call out%put("phi", model%phi(:model%count), shown=.false.)
      call out%put("q", model%q(:model%count), shown=.false.)
      call out%put("r", model%r, shown=.false.)
   end subroutine put_model

   !> Their standard errors, null where they are not known.
   subroutine put_errors(out, std_error, count, known)
      class(description_type), intent(inout) :: out
      type(component_model_type), intent(in) :: std_error
      integer, intent(in) :: count
      logical, intent(in) :: known

      call out%put("phi_std_error", std_error%phi(:count), known, shown=.false.)
      call out%put("q_std_error", std_error%q(:count), known, shown=.false.)
      call out%put("r_std_error", std_error%r, known, shown=.false.)
   end subroutine put_errors

end module gyroakf_report_document_filters
