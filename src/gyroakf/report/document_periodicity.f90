! SPDX-License-Identifier: MIT
!> The members of "tests" that tell what is periodic.
module gyroakf_report_document_periodicity
   use gyroakf_kinds, only : int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_json, only : json_type, open_object, close_object, put_member, put_null
   implicit none (type, external)
   private
   public :: put_fisher, put_welch

contains

   !> "fisher_g".
   subroutine put_fisher(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%periodicity) then
         call put_null(json, "fisher_g")
         return
      end if
      call open_object(json, "fisher_g")
      call put_member(json, "statistic", channel%periodicity%fisher%statistic)
      call put_member(json, "p_value", channel%periodicity%fisher%p_value)
      call put_member(json, "frequency_hz", channel%fisher_frequency)
      call put_member(json, "log_p_value", channel%periodicity%fisher%log_p_value)
      call put_member(json, "applied_to", trim(channel%whitened))
      call put_member(json, "samples", channel%periodicity%samples)
      call put_member(json, "frequency_unit", trim(channel%frequency_unit))
      call put_member(json, "of_samples", channel%periodicity%total)
      call put_member(json, "first_sample", channel%periodicity%first)
      call close_object(json)
   end subroutine put_fisher

   !> "welch": what spectrum.csv holds.
   subroutine put_welch(json, channel)
      !> The document
      type(json_type), intent(inout) :: json
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%spectrum) then
         call put_null(json, "welch")
         return
      end if
      call open_object(json, "welch")
      call put_member(json, "window", trim(channel%spectrum%window))
      call put_member(json, "segment_samples", channel%spectrum%segment)
      call put_member(json, "segments", channel%spectrum%used)
      call put_member(json, "segments_left_out", channel%spectrum%segments - channel%spectrum%used)
      call put_member(json, "overlap", channel%spectrum%overlap)
      call put_member(json, "resolution_hz", channel%spectrum%resolution)
      call put_member(json, "noise_bandwidth_hz", channel%spectrum%noise_bandwidth)
      call put_member(json, "degrees_of_freedom", channel%spectrum%degrees_of_freedom)
      call put_member(json, "confidence", channel%spectrum%confidence)
      call put_member(json, "frequencies", size(channel%spectrum%frequency, kind=int64))
      call close_object(json)
   end subroutine put_welch

end module gyroakf_report_document_periodicity
