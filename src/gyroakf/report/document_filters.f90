! SPDX-License-Identifier: MIT
!> The filters of a channel and its drift in the JSON document.
module gyroakf_report_document_filters
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_fit, only : drift_candidate_type
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null
   use gyroakf_report_document_correlation, only : put_ljung_box
   use gyroakf_report_document_stated, only : put_known
   implicit none (type, external)
   private
   public :: put_filters, put_drift

contains

   !> "filters".
   subroutine put_filters(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      call open_object(json, "filters")
      associate (is => channel%available)
         call put_filter(json, "kf", channel%kf, channel%kf_figures, is%kf)
         call put_filter(json, "akf", channel%akf, channel%akf_figures, is%akf)
         call put_filter(json, "drift_kf", channel%drift_kf, channel%drift_kf_figures, is%drift_kf)
         call put_filter(json, "drift_akf", channel%drift_akf, channel%drift_akf_figures, is%drift_akf)
         call put_filter(json, "drift_smoother", channel%drift_smoother, channel%drift_smoother_figures, &
                         is%drift_smoother)
      end associate
      call close_object(json)
   end subroutine put_filters

   !> One filter; "forgetting" is null where nothing is adapted. A smoother has no innovations, and no gain of its own.
   subroutine put_filter(json, key, filter, figures, available)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      type(filter_result_type), intent(in) :: filter
      type(filter_figures_type), intent(in) :: figures
      logical, intent(in) :: available
      type(text_type) :: nothing(0)
      logical :: measured

      if (.not. available) then
         call put_null(json, key)
         return
      end if
      measured = filter%nis_high > 0.0_dp
      call open_object(json, key)
      call put_member(json, "mean", filter%mean)
      call put_member(json, "variance", filter%variance)
      call put_known(json, "gain", filter%gain, measured)
      call put_member(json, "dc_gain", filter%dc_gain)
      call put_member(json, "q", filter%q)
      call put_member(json, "r", filter%r)
      call put_known(json, "nis_mean", filter%nis_mean, measured)
      call put_ljung_box(json, "ljung_box", filter%ljung_box, filter%ljung_box%lags > 0)
      if (adapts(filter)) then
         call put_member(json, "forgetting", filter%forgetting)
         call put_member(json, "estimate", filter%estimate)
      else
         call put_null(json, "forgetting")
         call put_member(json, "estimate", nothing)
      end if
      call put_member(json, "clamped", filter%clamped)
      call put_member(json, "gated", filter%gated)
      call put_known(json, "rmse", figures%rmse, figures%rmse_samples > 0)
      if (allocated(filter%warnings)) then
         call put_member(json, "warnings", filter%warnings)
      else
         call put_member(json, "warnings", nothing)
      end if
      call put_known(json, "nis_low", filter%nis_low, measured)
      call put_known(json, "nis_high", filter%nis_high, measured)
      call close_object(json)
   end subroutine put_filter

   !> The filter estimates something.
   pure logical function adapts(filter)
      type(filter_result_type), intent(in) :: filter

      adapts = .false.
      if (allocated(filter%estimate)) adapts = size(filter%estimate) > 0
   end function adapts

   !> "drift": the model, what speaks for it, and what is left of the record without it.
   subroutine put_drift(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%available%drift) then
         call put_null(json, "drift")
         return
      end if
      call open_object(json, "drift")
      associate (drift => channel%drift)
         call put_member(json, "found", drift%found)
         if (allocated(channel%drift_doubt)) then
            call put_member(json, "doubt", channel%drift_doubt)
         else
            call put_null(json, "doubt")
         end if
         call put_member(json, "tau_s", channel%drift_tau)
         call put_member(json, "name", trim(drift%name))
         call put_member(json, "source", trim(drift%source))
         call put_model(json, drift%model)
         call open_array(json, "slow")
         do i = 1, drift%model%count
            call put_member(json, "", drift%slow(i))
         end do
         call close_array(json)
         call put_errors(json, drift%std_error, drift%model%count, drift%errors_known)
         call put_processes(json, channel)
         call put_known(json, "correlation_s", channel%drift_time, drift%found .and. channel%drift_time > 0.0_dp)
         call put_known(json, "drift_std", drift%drift_std, drift%found)
         call put_member(json, "white_std", drift%white_std)
         call put_known(json, "white_std_error", channel%white_std_error, drift%errors_known)
         call put_member(json, "level", channel%level%mean)
         call put_member(json, "level_variance", channel%level%variance)
         call put_member(json, "log_likelihood", drift%log_likelihood)
         call open_array(json, "candidates")
         do i = 1, size(drift%candidate)
            call put_candidate(json, drift%candidate(i), i == drift%chosen)
         end do
         call close_array(json)
         call put_member(json, "samples", drift%samples)
         call put_member(json, "of_samples", drift%of_samples)
         call put_member(json, "block_samples", drift%block)
         call put_known(json, "compensated_mean", channel%compensated%mean, channel%available%drift_smoother)
         call put_known(json, "compensated_variance", channel%compensated%variance, channel%available%drift_smoother)
      end associate
      call close_object(json)
   end subroutine put_drift

   !> Members "phi", "q", "r".
   subroutine put_model(json, model)
      type(json_type), intent(inout) :: json
      type(component_model_type), intent(in) :: model

      call put_member(json, "phi", model%phi(:model%count))
      call put_member(json, "q", model%q(:model%count))
      call put_member(json, "r", model%r)
   end subroutine put_model

   !> Their standard errors, null where they are not known.
   subroutine put_errors(json, std_error, count, known)
      type(json_type), intent(inout) :: json
      type(component_model_type), intent(in) :: std_error
      !> Processes
      integer, intent(in) :: count
      logical, intent(in) :: known

      if (known) then
         call put_member(json, "phi_std_error", std_error%phi(:count))
         call put_member(json, "q_std_error", std_error%q(:count))
         call put_member(json, "r_std_error", std_error%r)
      else
         call put_null(json, "phi_std_error")
         call put_null(json, "q_std_error")
         call put_null(json, "r_std_error")
      end if
   end subroutine put_errors

   !> "processes": each of them as it is stated.
   subroutine put_processes(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel
      integer :: i

      call open_array(json, "processes")
      do i = 1, size(channel%drift_process)
         associate (process => channel%drift_process(i), known => channel%drift%errors_known)
            call open_object(json)
            call put_member(json, "kind", trim(merge("walk", "ar1 ", process%walk)))
            call put_member(json, "drift", process%slow)
            call put_known(json, "correlation_s", process%time, process%time > 0.0_dp)
            call put_known(json, "correlation_s_std_error", process%time_error, known .and. process%time > 0.0_dp)
            call put_member(json, "std", process%std)
            call put_known(json, "k", process%k%value, process%k%detected)
            call put_known(json, "k_std_error", process%k%std_error, known .and. process%k%detected)
            if (process%walk) then
               call put_member(json, "k_unit", process%k%unit)
            else
               call put_null(json, "k_unit")
            end if
            call close_object(json)
         end associate
      end do
      call close_array(json)
   end subroutine put_processes

   !> One candidate.
   subroutine put_candidate(json, candidate, chosen)
      type(json_type), intent(inout) :: json
      type(drift_candidate_type), intent(in) :: candidate
      !> It is the model
      logical, intent(in) :: chosen

      call open_object(json)
      call put_member(json, "name", trim(candidate%name))
      call put_member(json, "chosen", chosen)
      call put_model(json, candidate%model)
      call put_errors(json, candidate%std_error, candidate%model%count, candidate%errors_known)
      call put_member(json, "parameters", candidate%parameters)
      call put_member(json, "log_likelihood", candidate%log_likelihood)
      call put_member(json, "aic", candidate%aic)
      call put_member(json, "bic", candidate%bic)
      call put_member(json, "converged", candidate%converged)
      call close_object(json)
   end subroutine put_candidate

end module gyroakf_report_document_filters
