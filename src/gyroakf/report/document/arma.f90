! SPDX-License-Identifier: MIT
!> The ARMA model in the JSON document.
module gyroakf_report_document_arma
   use gyroakf_kinds, only : dp
   use gyroakf_ar_arma_result, only : arma_model_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null
   use gyroakf_report_document_correlation, only : put_ljung_box
   implicit none (type, external)
   private
   public :: put_arma

contains

   !> "arma"; null where it was not asked for, or could not be fitted.
   subroutine put_arma(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%arma) then
         call put_null(json, "arma")
         return
      end if
      associate (model => channel%arma)
         call open_object(json, "arma")
         call put_member(json, "criterion", trim(model%criterion))
         call put_member(json, "p", model%p)
         call put_member(json, "q", model%q)
         call put_member(json, "phi", model%phi)
         call put_errors(json, "phi_std_errors", model%phi_error, model%errors_known)
         call put_member(json, "theta", model%theta)
         call put_errors(json, "theta_std_errors", model%theta_error, model%errors_known)
         call put_member(json, "mean", model%mean)
         call put_error(json, "mean_std_error", model%mean_error, model%errors_known)
         call put_member(json, "noise_variance", model%noise_variance)
         call put_member(json, "log_likelihood", model%fit%log_likelihood)
         call put_member(json, "aic", model%fit%aic)
         call put_member(json, "aicc", model%fit%aicc)
         call put_member(json, "bic", model%fit%bic)
         call put_member(json, "hqic", model%fit%hqic)
         call put_member(json, "fpe", model%fit%fpe)
         call put_member(json, "converged", model%converged)
         call put_member(json, "samples", model%samples)
         call put_member(json, "first_sample", model%first)
         call put_member(json, "length", model%length)
         call put_member(json, "compared_length", model%compared_length)
         call put_table(json, model)
         call put_ljung_box(json, "residual_ljung_box", model%residual_ljung_box, model%residual_ljung_box%lags > 0)
         call put_drift(json, channel)
         call put_member(json, "warnings", model%warnings)
         call close_object(json)
      end associate
   end subroutine put_arma

   !> A standard error, null where it is not known.
   subroutine put_error(json, key, value, known)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      real(dp), intent(in) :: value
      logical, intent(in) :: known

      if (known) then
         call put_member(json, key, value)
      else
         call put_null(json, key)
      end if
   end subroutine put_error

   !> Standard errors, null where they are not known.
   subroutine put_errors(json, key, value, known)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      real(dp), intent(in) :: value(:)
      logical, intent(in) :: known

      if (known) then
         call put_member(json, key, value)
      else
         call put_null(json, key)
      end if
   end subroutine put_errors

   !> "table": the orders that were compared.
   subroutine put_table(json, model)
      type(json_type), intent(inout) :: json
      type(arma_model_type), intent(in) :: model
      integer :: i

      call open_array(json, "table")
      if (allocated(model%table)) then
         do i = 1, size(model%table)
            call open_object(json)
            call put_member(json, "p", model%table(i)%p)
            call put_member(json, "q", model%table(i)%q)
            call put_member(json, "noise_variance", model%table(i)%noise_variance)
            call put_member(json, "log_likelihood", model%table(i)%log_likelihood)
            call put_member(json, "aic", model%table(i)%aic)
            call put_member(json, "aicc", model%table(i)%aicc)
            call put_member(json, "bic", model%table(i)%bic)
            call put_member(json, "hqic", model%table(i)%hqic)
            call put_member(json, "fpe", model%table(i)%fpe)
            call put_member(json, "usable", model%table(i)%usable)
            call close_object(json)
         end do
      end if
      call close_array(json)
   end subroutine put_table

   !> "drift": null where the model is no AR(1) in white noise.
   subroutine put_drift(json, channel)
      type(json_type), intent(inout) :: json
      type(channel_result_type), intent(in) :: channel

      associate (drift => channel%arma%drift, known => channel%arma%errors_known)
         if (.not. drift%found) then
            call put_null(json, "drift")
            return
         end if
         call open_object(json, "drift")
         call put_member(json, "time_constant_s", channel%arma_time)
         call put_error(json, "time_constant_std_error", channel%arma_time_error, known)
         call put_member(json, "std", drift%drift_std)
         call put_error(json, "std_std_error", drift%drift_error, known)
         call put_member(json, "white_std", drift%white_std)
         call put_error(json, "white_std_std_error", drift%white_error, known)
         call close_object(json)
      end associate
   end subroutine put_drift

end module gyroakf_report_document_arma
