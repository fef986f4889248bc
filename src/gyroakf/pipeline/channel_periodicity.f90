! SPDX-License-Identifier: MIT
!> Periodicity of a channel: Welch's spectrum of the cleaned series, Fisher's test of its AR
!> residuals.
module gyroakf_pipeline_channel_periodicity
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_ar_periodicity, only : periodicity_options, analyse_periodicity
   use gyroakf_stats_welch, only : welch_options, welch_spectrum
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_periodicity, longest_part, longest_segment

   !> Fisher's test takes so many samples from the middle of a longer record
   integer(int64), parameter :: longest_part = 262144_int64
   !> A longer segment of the spectrum is refused: its memory is not that of the record
   integer(int64), parameter :: longest_segment = 1048576_int64

contains

   !> Spectrum and Fisher's test; failures are noted in the channel.
   subroutine run_periodicity(z, record, options, channel, error, valid, progress)
      !> The cleaned series, in the unit of the record: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> For its sample interval
      type(record_type), intent(in) :: record
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> Its AR model is used where it is there; `spectrum` and `periodicity` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, invalid_argument; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(welch_options) :: welch
      type(periodicity_options) :: choice
      real(dp) :: step

      step = record%sample_interval
      channel%frequency_unit = "cycles/sample"
      if (record%rate_known) channel%frequency_unit = "Hz"
      welch%confidence = options%allan%confidence
      if (options%welch_segment > 0.0_dp) welch%segment = &
         max(2_int64, nint(min(options%welch_segment/step, 1.0e15_dp), int64))
      if (welch%segment > longest_segment) then
         call fatal_error(error, status%invalid_argument, "a segment of the spectrum may have "// &
            integer_text(longest_segment)//" samples here, not "//integer_text(welch%segment)// &
            "; use the Allan deviation for slower processes")
         return
      end if
      call welch_spectrum(z, step, welch, channel%spectrum, error, valid, progress)
      channel%available%spectrum = .not. allocated(error)
      call note_failure(channel, "spectrum", error)
      if (allocated(error)) return
      choice%longest = longest_part
      choice%ar = options%ar
      if (channel%available%ar) then
         call analyse_periodicity(z, choice, channel%periodicity, error, valid, channel%ar, &
                                  progress)
      else
         call analyse_periodicity(z, choice, channel%periodicity, error, valid, progress=progress)
      end if
      channel%available%periodicity = .not. allocated(error)
      call note_failure(channel, "Fisher's test", error)
      if (.not. channel%available%periodicity) return
      associate (found => channel%periodicity)
         channel%fisher_frequency = found%fisher%frequency/step
         if (found%order > 0) channel%whitened = "the residuals of AR("// &
            integer_text(int(found%order, int64))//")"
      end associate
   end subroutine run_periodicity

end module gyroakf_pipeline_channel_periodicity
