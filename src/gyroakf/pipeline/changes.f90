! SPDX-License-Identifier: MIT
!> Whether, and where, the noise of a channel changed during the record.
module gyroakf_pipeline_changes
   use gyroakf_kinds, only : dp, int8
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type
   use gyroakf_allan_dynamic, only : dynamic_options, dynamic_allan
   use gyroakf_allan_halves, only : halves_options, compare_halves
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, stage
   use gyroakf_pipeline_warnings, only : note_failure, is_fatal
   implicit none (type, external)
   private
   public :: run_halves, run_dynamic

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
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(halves_options) :: choice

      if (.not. channel%allan(stage%input)%fitted) return
      choice%min_coverage = options%allan%min_coverage
      call compare_halves(x, step, channel%allan(stage%input)%noise, choice, channel%halves, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%halves = .not. allocated(error)
      call note_failure(channel, "comparison of the record's halves", error)
   end subroutine run_halves

   !> The dynamic Allan deviation of the series as read, where it was asked for; a failure is noted in the channel.
   subroutine run_dynamic(x, step, options, channel, error, valid)
      !> The series, in the unit of the record: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval in s, 1 where no rate is known
      real(dp), intent(in) :: step
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> Its `dynamic` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, internal; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(dynamic_options) :: choice

      if (options%dynamic_segments == 0) return
      choice%segments = options%dynamic_segments
      choice%min_coverage = options%allan%min_coverage
      choice%confidence = options%allan%confidence
      if (allocated(options%allan%taus)) choice%taus = options%allan%taus
      call dynamic_allan(x, step, choice, channel%dynamic, error, valid)
      if (is_fatal(error)) return
      channel%available%dynamic = .not. allocated(error)
      call note_failure(channel, "dynamic Allan deviation", error)
   end subroutine run_dynamic

end module gyroakf_pipeline_changes
