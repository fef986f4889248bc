! SPDX-License-Identifier: MIT
!> The member "truth" of a channel in the JSON document: the filters against the true drift.
module gyroakf_report_document_truth
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_score, only : score_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_truth_result, only : score_of, truth_result_type
   use gyroakf_report_json, only : close_array, close_object, json_type, open_array, open_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_truth, put_rmse

contains

   !> The object; null without a truth.
   subroutine put_truth(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%truth%known) then
         call put_null(json, "truth")
         return
      end if
      call open_object(json, "truth")
      call put_member(json, "angle_unit", trim(channel%truth%angle_unit))
      call put_member(json, "average_samples", channel%truth%average_samples)
      call open_array(json, "methods")
      do i = 1, channel%truth%count
         associate (method => channel%truth%method(i))
            call open_object(json)
            call put_member(json, "name", trim(method%name))
            call put_member(json, "offline", method%offline)
            call put_member(json, "decay", method%decay)
            call put_member(json, "samples", method%score%samples)
            call put_member(json, "rmse", method%score%rmse)
            call put_member(json, "bias", method%score%bias)
            call put_attitude(json, method%score)
            call close_object(json)
         end associate
      end do
      call close_array(json)
      call close_object(json)
   end subroutine put_truth

   !> The errors of the angle; null where no window counts.
   subroutine put_attitude(json, score)
      type(json_type), intent(inout) :: json
      type(score_type), intent(in) :: score
      integer :: i

      call open_array(json, "attitude")
      do i = 1, size(score%attitude_seconds)
         call open_object(json)
         call put_member(json, "after_s", score%attitude_seconds(i))
         call put_known(json, "compensated", score%attitude_error(i), score%attitude_windows(i))
         call put_member(json, "compensated_windows", score%attitude_windows(i))
         call put_known(json, "predicted", score%predicted_error(i), score%predicted_windows(i))
         call put_member(json, "predicted_windows", score%predicted_windows(i))
         call close_object(json)
      end do
      call close_array(json)
   end subroutine put_attitude

   !> A number, null where it is of no window.
   subroutine put_known(json, key, value, windows)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      real(dp), intent(in) :: value
      integer(int64), intent(in) :: windows

      if (windows > 0) then
         call put_member(json, key, value)
      else
         call put_null(json, key)
      end if
   end subroutine put_known

   !> The member "rmse" of a filter; null where it was not scored.
   subroutine put_rmse(json, truth, name)
      !> The document
      type(json_type), intent(inout) :: json
      !> The scores of the channel
      type(truth_result_type), intent(in) :: truth
      !> Key of the filter
      character(*), intent(in) :: name
      integer :: i

      i = score_of(truth, name)
      if (i > 0) then
         call put_member(json, "rmse", truth%method(i)%score%rmse)
      else
         call put_null(json, "rmse")
      end if
   end subroutine put_rmse

end module gyroakf_report_document_truth
