! SPDX-License-Identifier: MIT
!> Progress of one channel, its name after the stage: "filtering gx".
module gyroakf_pipeline_channel_progress
   use gyroakf_kinds, only : int64
   use gyroakf_progress, only : progress_type
   implicit none (type, external)
   private
   public :: channel_progress_type

   !> Forwards progress, with the name of a channel after the stage
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
      !> With a listener
      class(channel_progress_type), intent(inout) :: self
      !> What is being done
      character(*), intent(in) :: stage
      !> So much of `total`, 0 where that is not known
      integer(int64), intent(in) :: done, total
      !> The listener wants to end
      logical, intent(out) :: cancel

      call self%listener%advance(stage//" "//self%name, done, total, cancel)
   end subroutine forward_progress

end module gyroakf_pipeline_channel_progress
