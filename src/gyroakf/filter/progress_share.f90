! SPDX-License-Identifier: MIT
!> Progress of a part of a job as a share of the whole.
module gyroakf_filter_progress_share
   use gyroakf_kinds, only : dp, int64
   use gyroakf_progress, only : progress_type
   implicit none (type, external)
   private
   public :: progress_share_type

   !> Forwards the progress of a part of a job
   type, extends(progress_type) :: progress_share_type
      !> Progress callback of the whole; none where not associated
      class(progress_type), pointer :: whole => null()
      !> Size of the whole, its share that is done before this part, the share of this part
      integer(int64) :: total = 0
      real(dp) :: before = 0.0_dp, share = 1.0_dp
   contains
      procedure :: advance => advance_share
   end type progress_share_type

contains

   !> Reports the progress of the whole.
   subroutine advance_share(self, stage, done, total, cancel)
      !> Keeps nothing
      class(progress_share_type), intent(inout) :: self
      !> Of this part, as [[gyroakf_progress(module)]]
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel
      real(dp) :: reached

      cancel = .false.
      if (.not. associated(self%whole)) return
      reached = self%before
      if (total > 0) reached = reached + self%share*real(done, dp)/real(total, dp)
      call self%whole%advance(stage, min(self%total, int(reached*real(self%total, dp), int64)), self%total, cancel)
   end subroutine advance_share

end module gyroakf_filter_progress_share
