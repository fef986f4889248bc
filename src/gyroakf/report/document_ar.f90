! SPDX-License-Identifier: MIT
!> The AR model of a channel, described.
module gyroakf_report_document_ar
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document_tests, only : put_ljung_box
   implicit none (type, external)
   private
   public :: put_ar

contains

   !> "ar".
   subroutine put_ar(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. out%opens("ar", channel%available%ar, "AR model")) return
      associate (model => channel%ar)
         call out%put("method", trim(model%method))
         call out%put("criterion", trim(model%criterion))
         call out%put("order", model%order)
         call out%put("coefficients", model%coefficient, std_errors=model%std_error)
         call out%put("std_errors", model%std_error, shown=.false.)
         call out%put("noise_variance", model%noise_variance)
         call out%put("mean", model%mean, shown=.false.)
         call out%open_list("table", shown=.false.)
         do i = lbound(model%table, 1), ubound(model%table, 1)
            call out%open("")
            call out%put("order", model%table(i)%order)
            call out%put("noise_variance", model%table(i)%noise_variance)
            call out%put("aic", model%table(i)%aic)
            call out%put("aicc", model%table(i)%aicc)
            call out%put("bic", model%table(i)%bic)
            call out%put("hqic", model%table(i)%hqic)
            call out%put("fpe", model%table(i)%fpe)
            call out%put("aic_per_observation", model%table(i)%aic_per_observation)
            call out%close()
         end do
         call out%close()
         call put_ljung_box(out, "residual_ljung_box", "Residuals", model%residual_ljung_box, &
                            model%residual_ljung_box%lags > 0)
         call out%put("stationary", model%stationary, shown=.not. model%stationary)
         call out%open_list("roots", "Roots")
         do i = 1, merge(model%order, 0, allocated(model%root))
            call out%open("")
            call out%put("real", model%root(i)%real_part)
            call out%put("imaginary", model%root(i)%imaginary_part)
            call out%put("modulus", model%root(i)%modulus)
            call out%put("frequency", model%root(i)%frequency)
            call out%put("time_constant_samples", model%root(i)%time_constant)
            call out%put("damping", model%root(i)%damping)
            call out%close()
         end do
         call out%close()
         call out%put("rows", model%rows, shown=.false.)
         call out%put("compared_rows", model%compared_rows, shown=.false.)
         call out%put("intercept", model%intercept, std_error=model%intercept_std_error, &
                      shown=model%method == "ols")
         call out%put("intercept_std_error", model%intercept_std_error, model%method == "ols", &
                      shown=.false.)
         call out%put("unbiased_variance", model%unbiased_variance, shown=.false.)
         call out%put("residual_variance", model%residual_variance, shown=.false.)
         if (out%opens("residual_normality", model%residual_normality%kurtosis > 0.0_dp, &
                       "Jarque-Bera")) then
            call out%put("statistic", model%residual_normality%statistic)
            call out%put("p_value", model%residual_normality%p_value)
            call out%put("skewness", model%residual_normality%skewness)
            call out%put("kurtosis", model%residual_normality%kurtosis)
            call out%close()
         end if
         call out%close()
      end associate
   end subroutine put_ar

end module gyroakf_report_document_ar
