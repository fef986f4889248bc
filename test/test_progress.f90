! SPDX-License-Identifier: MIT
!> Progress is told, and a caller who cancels gets the error.
module test_progress
   use testdrive, only : check, error_type, new_unittest, unittest_type
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_progress, only : progress_type, tell_progress
   implicit none (type, external)
   private
   public :: collect_progress

   !> Notes what it is told, and cancels when all is done
   type, extends(progress_type) :: witness_type
      character(:), allocatable :: stage
      integer(int64) :: calls = 0, done = -1, total = -1
   contains
      procedure :: advance => note
   end type witness_type

contains

   subroutine collect_progress(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [new_unittest("told_and_cancelled", told_and_cancelled), new_unittest("nobody_listens", nobody_listens)]
   end subroutine collect_progress

   subroutine note(self, stage, done, total, cancel)
      class(witness_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%stage = stage
      self%calls = self%calls + 1
      self%done = done
      self%total = total
      cancel = done == total
   end subroutine note

   subroutine told_and_cancelled(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failed
      type(witness_type) :: witness

      call tell_progress("reading", 3_int64, 4_int64, failed, witness)
      call check(error, .not. allocated(failed), "nobody cancelled")
      if (allocated(error)) return
      call tell_progress("reading", 4_int64, 4_int64, failed, witness)
      call check(error, allocated(failed), "the cancellation is lost")
      if (allocated(error)) return
      call check(error, failed%code, status%cancelled)
      if (allocated(error)) return
      call check(error, failed%message, "cancelled while reading")
      if (allocated(error)) return
      call check(error, witness%stage == "reading" .and. witness%calls == 2 .and. witness%done == 4 .and. witness%total == 4)
   end subroutine told_and_cancelled

   subroutine nobody_listens(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failed

      call tell_progress("reading", 4_int64, 4_int64, failed)
      call check(error, .not. allocated(failed))
   end subroutine nobody_listens

end module test_progress
