! SPDX-License-Identifier: MIT
!> Whether the noise of a channel changed during the record.
module gyroakf_pipeline_channel_halves
   use gyroakf_kinds, only : dp, int8
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type
   use gyroakf_allan_halves, only : halves_options, compare_halves
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, stage
   use gyroakf_pipeline_warnings, only : note_failure, is_fatal
   implicit none (type, external)
   private
   public :: run_halves

contains

   !> Compares the two halves of the series as read; a failure is noted in the channel.
   subroutine run_halves(x, step, options, channel, error, valid, progress)
      !> The series, in the unit of the record: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval in s, 1 where no rate is known
      real(dp), intent(in) :: step
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> With the fit of the series as read; its `halves` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(halves_options) :: choice

      if (.not. channel%allan(stage%input)%noise%described) return
      choice%min_coverage = options%allan%min_coverage
      call compare_halves(x, step, channel%allan(stage%input)%noise, choice, channel%halves, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%halves = .not. allocated(error)
      call note_failure(channel, "comparison of the record's halves", error)
   end subroutine run_halves

end module gyroakf_pipeline_channel_halves
