! SPDX-License-Identifier: MIT
!> The JSON document: what only an AR model has.
module gyroakf_report_document_ar
   use gyroakf_kinds, only : dp
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null
   implicit none (type, external)
   private
   public :: put_ar_members

contains

   !> The members that follow the others of "ar".
   subroutine put_ar_members(json, model)
      !> The document, in the object
      type(json_type), intent(inout) :: json
      !> The model
      type(ar_model_type), intent(in) :: model
      integer :: i

      call put_member(json, "stationary", model%stationary)
      call open_array(json, "roots")
      do i = 1, merge(model%order, 0, allocated(model%root))
         call open_object(json)
         call put_member(json, "real", model%root(i)%real_part)
         call put_member(json, "imaginary", model%root(i)%imaginary_part)
         call put_member(json, "modulus", model%root(i)%modulus)
         call put_member(json, "frequency", model%root(i)%frequency)
         call put_member(json, "time_constant_samples", model%root(i)%time_constant)
         call put_member(json, "damping", model%root(i)%damping)
         call close_object(json)
      end do
      call close_array(json)
      call put_member(json, "rows", model%rows)
      call put_member(json, "compared_rows", model%compared_rows)
      call put_member(json, "intercept", model%intercept)
      if (model%method == "ols") then
         call put_member(json, "intercept_std_error", model%intercept_std_error)
      else
         call put_null(json, "intercept_std_error")
      end if
      call put_member(json, "unbiased_variance", model%unbiased_variance)
      call put_member(json, "residual_variance", model%residual_variance)
      if (model%residual_normality%kurtosis > 0.0_dp) then
         call open_object(json, "residual_normality")
         call put_member(json, "statistic", model%residual_normality%statistic)
         call put_member(json, "p_value", model%residual_normality%p_value)
         call put_member(json, "skewness", model%residual_normality%skewness)
         call put_member(json, "kurtosis", model%residual_normality%kurtosis)
         call close_object(json)
      else
         call put_null(json, "residual_normality")
      end if
   end subroutine put_ar_members

end module gyroakf_report_document_ar
