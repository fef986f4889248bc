! SPDX-License-Identifier: MIT
!> What the stages of one channel share: its samples, the options, the progress callback.
module gyroakf_pipeline_channel_job
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_units, only : unit_type
   use gyroakf_pipeline_result, only : pipeline_options
   implicit none (type, external)
   private
   public :: job_type, channel_progress_type

   !> A channel in work; pointers that are not associated are absent arguments
   type :: job_type
      !> Of the main job
      type(pipeline_options) :: options
      !> Sample interval, s; 1 (per sample) without a rate
      real(dp) :: step = 1.0_dp
      logical :: rate_known = .false.
      !> Of the samples
      type(unit_type) :: unit
      !> The samples as read, finite, and cleaned: [n]; where nothing is cleaned the same
      real(dp), pointer, contiguous :: x(:) => null(), z(:) => null()
      !> 1 present, 0 missing: [n], as read, and with outliers missing too
      integer(int8), pointer, contiguous :: recorded(:) => null(), valid(:) => null()
      !> The true drift, where it was given: [n]; times the factor in the unit of the samples
      real(dp), pointer, contiguous :: true_drift(:) => null()
      real(dp) :: truth_factor = 1.0_dp
      !> 1 where it is known, 0 where it is not: [n]; not associated: known everywhere
      integer(int8), pointer, contiguous :: truth_known(:) => null()
      !> Progress callback; may cancel
      class(progress_type), pointer :: progress => null()
   end type job_type

   !> Forwards progress, with the name of a channel after the stage: "filtering gx"
   type, extends(progress_type) :: channel_progress_type
      !> Progress callback of the whole
      class(progress_type), pointer :: listener => null()
      !> Of the channel
      character(:), allocatable :: name
   contains
      procedure :: advance => forward_progress
   end type channel_progress_type

contains

   !> As `advance_interface`.
   subroutine forward_progress(self, stage, done, total, cancel)
      class(channel_progress_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      call self%listener%advance(stage//" "//self%name, done, total, cancel)
   end subroutine forward_progress

end module gyroakf_pipeline_channel_job
