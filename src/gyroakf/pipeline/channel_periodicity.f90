! SPDX-License-Identifier: MIT
!> Periodicity of a channel: Welch's spectrum of the cleaned series, Fisher's test of its AR residuals.
module gyroakf_pipeline_channel_periodicity
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_ar_periodicity, only : periodicity_options, analyse_periodicity
   use gyroakf_stats_welch, only : welch_options, welch_spectrum
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : note_failure, is_fatal
   implicit none (type, external)
   private
   public :: run_periodicity, longest_part, longest_segment

   !> Fisher's test takes so many samples from the middle of a longer record
   integer(int64), parameter :: longest_part = 262144_int64
   !> A longer segment of the spectrum is refused: its memory is not that of the record
   integer(int64), parameter :: longest_segment = 1048576_int64

contains

   !> Spectrum and Fisher's test; failures are noted in the channel.
   subroutine run_periodicity(z, step, rate_known, options, channel, error, valid, progress)
      !> The cleaned series, in the unit of the record: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Sample interval in s, 1 where no rate is known
      real(dp), intent(in) :: step
      !> It is in seconds
      logical, intent(in) :: rate_known
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
      character(100) :: text

      channel%frequency_unit = "cycles/sample"
      if (rate_known) channel%frequency_unit = "Hz"
      welch%confidence = options%allan%confidence
      if (options%welch_segment > 0.0_dp) welch%segment = max(2_int64, nint(min(options%welch_segment/step, 1.0e15_dp), int64))
      if (welch%segment > longest_segment) then
         write (text, '("a segment of the spectrum may have ", i0, " samples here, not ", i0)') longest_segment, welch%segment
         call fatal_error(error, status%invalid_argument, trim(text)//"; use the Allan deviation for slower processes")
         return
      end if
      call welch_spectrum(z, step, welch, channel%spectrum, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%spectrum = .not. allocated(error)
      call note_failure(channel, "spectrum", error)
      choice%longest = longest_part
      choice%ar = options%ar
      if (channel%available%ar) then
         call analyse_periodicity(z, choice, channel%periodicity, error, valid, channel%ar, progress)
      else
         call analyse_periodicity(z, choice, channel%periodicity, error, valid, progress=progress)
      end if
      if (is_fatal(error)) return
      channel%available%periodicity = .not. allocated(error)
      call note_failure(channel, "Fisher's test", error)
      if (channel%available%periodicity) call state(channel, step)
   end subroutine run_periodicity

   !> What the report says beyond the library's results.
   pure subroutine state(channel, step)
      type(channel_result_type), intent(inout) :: channel
      real(dp), intent(in) :: step
      character(24) :: order

      channel%fisher_frequency = channel%periodicity%fisher%frequency/step
      write (order, "(i0)") channel%periodicity%order
      channel%whitened = "the series"
      if (channel%periodicity%order > 0) channel%whitened = "the residuals of AR("//trim(order)//")"
   end subroutine state

end module gyroakf_pipeline_channel_periodicity
