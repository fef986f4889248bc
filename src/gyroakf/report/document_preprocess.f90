! SPDX-License-Identifier: MIT
!> The member of a channel in the JSON document on what was removed.
module gyroakf_report_document_preprocess
   use gyroakf_kinds, only : int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   implicit none (type, external)
   private
   public :: put_preprocess

contains

   !> "preprocess": null where the record was taken as it is.
   subroutine put_preprocess(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: k

      if (.not. out%opens("preprocess", channel%available%preprocess, "Removed")) return
      call out%open("outliers", "Outliers")
      call out%put("method", trim(channel%clean%method))
      call out%put("threshold", channel%clean%threshold, unit="sigma")
      call out%put("passes", channel%clean%passes)
      call out%put("removed", channel%clean%removed)
      call out%put("fraction", channel%clean%fraction)
      call out%put("expected", channel%clean%expected, title="expected in normal noise")
      call out%put("half_width", channel%clean%half_width, channel%clean%half_width > 0)
      call out%put("converged", channel%clean%converged)
      call out%close()
      call out%open_list("motion", "Motion")
      if (allocated(channel%clean%motion)) then
         do k = 1, size(channel%clean%motion, 2, kind=int64)
            call out%open("")
            call out%put("first", channel%clean%motion(1, k), title="from sample")
            call out%put("last", channel%clean%motion(2, k), title="to")
            call out%close()
         end do
      end if
      call out%close()
      call out%open("trend", "Trend")
      call out%put("degree", channel%clean%trend%degree)
      if (allocated(channel%clean%trend%power)) then
         call out%put("coefficients", channel%clean%trend%power, &
                      title="coefficients of i^0, i^1, ...")
      else
         call out%absent("coefficients")
      end if
      call out%close()
      call out%put("mean", channel%clean%mean, shown=.false.)
      call out%put("variance", channel%clean%variance)
      call out%put("corrected_variance", channel%clean%corrected_variance, &
                   channel%clean%corrected_variance > 0)
      call out%close()
   end subroutine put_preprocess

end module gyroakf_report_document_preprocess
