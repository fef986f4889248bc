! SPDX-License-Identifier: MIT
!> Whether the library, as it was built and on this machine, gives the numbers that it should.
!>
!>     type(selftest_type) :: result
!>     call run_selftest(result, error)
!>     if (result%failed > 0) ...                 ! result%check(:result%count)
!>
!> Published test vectors, closed forms, values known exactly, records with known noise identified again, one thread against
!> several. Prints nothing; takes a few seconds.
module gyroakf_selftest
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_selftest_filter_forms, only : check_filter_forms
   use gyroakf_selftest_forms, only : check_forms
   use gyroakf_selftest_references, only : check_references
   use gyroakf_selftest_round_trips, only : check_round_trips
   use gyroakf_selftest_threads, only : check_threads
   use gyroakf_selftest_types, only : selftest_check_type, selftest_type
   use gyroakf_selftest_vectors, only : check_vectors
   implicit none (type, external)
   private
   public :: selftest_check_type, selftest_type, run_selftest

   character(*), parameter :: stage = "testing"
   integer(int64), parameter :: parts = 6

contains

   !> All checks. A check that fails is no error: see `result%failed`.
   subroutine run_selftest(result, error, progress)
      !> The checks, in groups
      type(selftest_type), intent(out) :: result
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told six times how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: part

      do part = 1, parts
         call tell_progress(stage, part - 1, parts, error, progress)
         if (allocated(error)) return
         select case (part)
         case (1); call check_vectors(result)
         case (2); call check_forms(result)
         case (3); call check_filter_forms(result)
         case (4); call check_references(result)
         case (5); call check_round_trips(result)
         case default; call check_threads(result)
         end select
      end do
   end subroutine run_selftest

end module gyroakf_selftest
