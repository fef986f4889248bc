! SPDX-License-Identifier: MIT
!> Progress of a long call, reported to the caller, who may cancel it.
!>
!>     type, extends(progress_type) :: bar_type           ! the caller's
!>     contains
!>        procedure :: advance => draw
!>     end type
!>
!> A procedure that may take longer than a tenth of a second has an optional argument `progress` and
!> calls [[report_progress]] several times a second, never from inside a parallel region. Where the
!> caller answers with `cancel`, it frees what it holds and returns the error `cancelled`.
module gyroakf_progress
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: progress_type, report_progress

   !> Progress callback, extended by the caller
   type, abstract :: progress_type
   contains
      procedure(advance_interface), deferred :: advance
   end type progress_type

   abstract interface
      !> Called with what is done so far.
      subroutine advance_interface(self, stage, done, total, cancel)
         import :: int64, progress_type
         implicit none (type, external)
         !> Keeps what it likes from call to call
         class(progress_type), intent(inout) :: self
         !> What is being done: "reading", "filtering", "writing series.csv"
         character(*), intent(in) :: stage
         !> So much of `total`; bytes while reading, else samples (rows while writing)
         integer(int64), intent(in) :: done
         !> 0 where it is not known
         integer(int64), intent(in) :: total
         !> True ends the call
         logical, intent(out) :: cancel
      end subroutine advance_interface
   end interface

contains

   !> Calls the progress callback, where there is one.
   subroutine report_progress(stage, done, total, error, progress)
      !> As those of `advance_interface`
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      !> Allocated where the caller wants no more: cancelled
      type(error_type), allocatable, intent(out) :: error
      !> May be absent
      class(progress_type), intent(inout), optional :: progress
      logical :: cancel

      if (.not. present(progress)) return
      call progress%advance(stage, done, total, cancel)
      if (cancel) call fatal_error(error, status%cancelled, "cancelled while "//stage)
   end subroutine report_progress

end module gyroakf_progress
