! SPDX-License-Identifier: MIT
!> The JSON document: what only an AR model has.
module gyroakf_report_document_ar
   use gyroakf_kinds, only : dp
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_report_description, only : description_type
   implicit none (type, external)
   private
   public :: put_ar_members

contains

   !> The members that follow the others of "ar".
   subroutine put_ar_members(out, model)
      !> The document, in the object
      class(description_type), intent(inout) :: out
      !> The model
      type(ar_model_type), intent(in) :: model
      integer :: i

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
      if (model%residual_normality%kurtosis > 0.0_dp) then
         call out%open("residual_normality", "Jarque-Bera")
         call out%put("statistic", model%residual_normality%statistic)
         call out%put("p_value", model%residual_normality%p_value)
         call out%put("skewness", model%residual_normality%skewness)
         call out%put("kurtosis", model%residual_normality%kurtosis)
         call out%close()
      else
         call out%absent("residual_normality")
      end if
   end subroutine put_ar_members

end module gyroakf_report_document_ar
