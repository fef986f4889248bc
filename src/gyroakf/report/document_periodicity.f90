! SPDX-License-Identifier: MIT
!> The members of "tests" that tell what is periodic.
module gyroakf_report_document_periodicity
   use gyroakf_kinds, only : int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_verdicts, only : periodicity_text
   implicit none (type, external)
   private
   public :: put_fisher, put_welch

contains

   !> "fisher_g".
   subroutine put_fisher(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%periodicity) then
         call out%absent("fisher_g")
         return
      end if
      call out%open("fisher_g", "Fisher's g")
      call out%remark(periodicity_text(channel))
      call out%put("statistic", channel%periodicity%fisher%statistic)
      call out%put("p_value", channel%periodicity%fisher%p_value)
      call out%put("frequency_hz", channel%fisher_frequency, unit=trim(channel%frequency_unit))
      call out%put("log_p_value", channel%periodicity%fisher%log_p_value, shown=.false.)
      call out%put("applied_to", trim(channel%whitened))
      call out%put("samples", channel%periodicity%samples)
      call out%put("frequency_unit", trim(channel%frequency_unit), shown=.false.)
      call out%put("of_samples", channel%periodicity%total)
      call out%put("first_sample", channel%periodicity%first, shown=.false.)
      call out%close()
   end subroutine put_fisher

   !> "welch": what spectrum.csv holds.
   subroutine put_welch(out, channel)
      !> The renderer
      class(description_type), intent(inout) :: out
      !> One channel
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%spectrum) then
         call out%absent("welch")
         return
      end if
      call out%open("welch", "Spectrum (Welch)")
      call out%put("window", trim(channel%spectrum%window))
      call out%put("segment_samples", channel%spectrum%segment)
      call out%put("segments", channel%spectrum%used)
      call out%put("segments_left_out", channel%spectrum%segments - channel%spectrum%used)
      call out%put("overlap", channel%spectrum%overlap)
      call out%put("resolution_hz", channel%spectrum%resolution, unit=trim(channel%frequency_unit))
      call out%put("noise_bandwidth_hz", channel%spectrum%noise_bandwidth, &
                   unit=trim(channel%frequency_unit))
      call out%put("degrees_of_freedom", channel%spectrum%degrees_of_freedom)
      call out%put("confidence", channel%spectrum%confidence)
      call out%put("frequencies", size(channel%spectrum%frequency, kind=int64))
      call out%close()
   end subroutine put_welch

end module gyroakf_report_document_periodicity
