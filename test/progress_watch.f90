! SPDX-License-Identifier: MIT
!> A progress callback for the tests: records its calls, and cancels at one of them.
module progress_watch
   use gyroakf_kinds, only : int64
   use gyroakf_progress, only : progress_type
   implicit none (type, external)
   private
   public :: watch_type

   type, extends(progress_type) :: watch_type
      !> Cancels at this call, or where so much is done
      integer :: last_call = huge(1)
      integer(int64) :: last_done = huge(1_int64)
      !> Calls so far, and what the last one reported
      integer :: calls = 0
      character(:), allocatable :: stage
      integer(int64) :: done = -1, total = -1
      !> Every call was within its total (0: unknown); and none after one of the same stage went back
      logical :: in_range = .true., ordered = .true.
   contains
      procedure :: advance
   end type watch_type

contains

   subroutine advance(self, stage, done, total, cancel)
      class(watch_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%in_range = self%in_range .and. len(stage) > 0 .and. done >= 0 .and. &
         & (done <= total .or. total == 0)
      self%ordered = self%ordered .and. self%in_range
      if (allocated(self%stage)) then
         if (stage == self%stage) self%ordered = self%ordered .and. done >= self%done
      end if
      self%stage = stage
      self%calls = self%calls + 1
      self%done = done
      self%total = total
      cancel = self%calls >= self%last_call .or. done >= self%last_done
   end subroutine advance

end module progress_watch
