! SPDX-License-Identifier: MIT
!> The regression of the Dickey-Fuller test in the JSON document.
module gyroakf_report_document_adf
   use gyroakf_series_adf, only : adf_type
   use gyroakf_report_description, only : description_type
   implicit none (type, external)
   private
   public :: put_adf_regression

contains

   !> How the lag was found, level, residual variance, and the coefficients where they were asked for.
   subroutine put_adf_regression(out, adf)
      !> The document, in the object "adf"
      class(description_type), intent(inout) :: out
      !> The test
      type(adf_type), intent(in) :: adf
      integer :: i

      if (adf%lag_chosen) then
         call out%put("criterion", trim(adf%criterion))
         call out%put("criterion_value", adf%criterion_value, shown=.false.)
      else
         call out%absent("criterion")
         call out%absent("criterion_value")
      end if
      call out%put("max_lags", adf%max_lags)
      call out%put("wanted_lags", adf%wanted_lags, shown=.false.)
      call out%put("level", adf%level)
      call out%put("noise_variance", adf%noise_variance)
      if (.not. allocated(adf%table)) then
         call out%absent("table")
         return
      end if
      call out%open_list("table", "Regression")
      do i = 1, size(adf%table)
         call out%open("")
         call out%put("name", trim(adf%table(i)%name), title="coefficient")
         call out%put("value", adf%table(i)%value, std_error=adf%table(i)%std_error)
         call out%put("std_error", adf%table(i)%std_error, shown=.false.)
         call out%put("t", adf%table(i)%t)
         call out%close()
      end do
      call out%close()
   end subroutine put_adf_regression

end module gyroakf_report_document_adf
