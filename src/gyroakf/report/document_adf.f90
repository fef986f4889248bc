! SPDX-License-Identifier: MIT
!> The regression of the Dickey-Fuller test in the JSON document.
module gyroakf_report_document_adf
   use gyroakf_series_adf, only : adf_type
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null
   implicit none (type, external)
   private
   public :: put_adf_regression

contains

   !> How the lag was found, level, residual variance, and the coefficients where they were asked for.
   subroutine put_adf_regression(json, adf)
      !> The document, in the object "adf"
      type(json_type), intent(inout) :: json
      !> The test
      type(adf_type), intent(in) :: adf
      integer :: i

      if (adf%lag_chosen) then
         call put_member(json, "criterion", trim(adf%criterion))
         call put_member(json, "criterion_value", adf%criterion_value)
      else
         call put_null(json, "criterion")
         call put_null(json, "criterion_value")
      end if
      call put_member(json, "max_lags", adf%max_lags)
      call put_member(json, "wanted_lags", adf%wanted_lags)
      call put_member(json, "level", adf%level)
      call put_member(json, "noise_variance", adf%noise_variance)
      if (.not. allocated(adf%table)) then
         call put_null(json, "table")
         return
      end if
      call open_array(json, "table")
      do i = 1, size(adf%table)
         call open_object(json)
         call put_member(json, "name", trim(adf%table(i)%name))
         call put_member(json, "value", adf%table(i)%value)
         call put_member(json, "std_error", adf%table(i)%std_error)
         call put_member(json, "t", adf%table(i)%t)
         call close_object(json)
      end do
      call close_array(json)
   end subroutine put_adf_regression

end module gyroakf_report_document_adf
