! SPDX-License-Identifier: MIT
!> The member of a channel in the JSON document on what was removed.
module gyroakf_report_document_preprocess
   use gyroakf_kinds, only : int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_json, only : json_type, open_array, open_object, close_array, close_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_preprocess

contains

   !> "preprocess": null where the record was taken as it is.
   subroutine put_preprocess(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: k

      if (.not. channel%available%preprocess) then
         call put_null(json, "preprocess")
         return
      end if
      call open_object(json, "preprocess")
      call open_object(json, "outliers")
      call put_member(json, "method", trim(channel%clean%method))
      call put_member(json, "threshold", channel%clean%threshold)
      call put_member(json, "passes", channel%clean%passes)
      call put_member(json, "removed", channel%clean%removed)
      call put_member(json, "fraction", channel%clean%fraction)
      call put_member(json, "expected", channel%clean%expected)
      if (channel%clean%half_width > 0) then
         call put_member(json, "half_width", channel%clean%half_width)
      else
         call put_null(json, "half_width")
      end if
      call put_member(json, "converged", channel%clean%converged)
      call close_object(json)
      call open_array(json, "motion")
      if (allocated(channel%clean%motion)) then
         do k = 1, size(channel%clean%motion, 2, kind=int64)
            call open_object(json)
            call put_member(json, "first", channel%clean%motion(1, k))
            call put_member(json, "last", channel%clean%motion(2, k))
            call close_object(json)
         end do
      end if
      call close_array(json)
      call open_object(json, "trend")
      call put_member(json, "degree", channel%clean%trend%degree)
      if (allocated(channel%clean%trend%power)) then
         call put_member(json, "coefficients", channel%clean%trend%power)
      else
         call put_null(json, "coefficients")
      end if
      call close_object(json)
      call put_member(json, "mean", channel%clean%mean)
      call put_member(json, "variance", channel%clean%variance)
      if (channel%clean%corrected_variance > 0) then
         call put_member(json, "corrected_variance", channel%clean%corrected_variance)
      else
         call put_null(json, "corrected_variance")
      end if
      call close_object(json)
   end subroutine put_preprocess

end module gyroakf_report_document_preprocess
