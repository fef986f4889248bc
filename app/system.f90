! SPDX-License-Identifier: MIT
!> The calls of the system (POSIX) that the program needs: processes, pipes, signals, and of the library's those on descriptors.
module gyroakf_app_system
   use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_intptr_t, c_loc, c_null_funptr, c_short
   use gyroakf_kinds, only : int64
   use gyroakf_io_system, only : c_close, c_poll, c_read, c_write, poll_type, write_all
   implicit none (type, external)
   private
   public :: c_close, c_exit, c_fork, c_isatty, c_kill, c_pipe, c_poll, c_raise, c_read, c_signal, c_waitpid, c_write, poll_type
   public :: write_bytes, ignore_signal
   public :: signal_hangup, signal_interrupt, signal_kill, signal_pipe, signal_terminate, signal_file_size, poll_in

   !> Numbers that are the same on every POSIX system
   integer(c_int), parameter :: signal_hangup = 1, signal_interrupt = 2, signal_kill = 9, signal_pipe = 13, &
      signal_terminate = 15, signal_file_size = 25
   !> Something can be read
   integer(c_short), parameter :: poll_in = 1_c_short

   interface
      function c_fork() result(process) bind(C, name="fork")
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: process
      end function c_fork

      function c_waitpid(process, status, options) result(ended) bind(C, name="waitpid")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: process
         integer(c_int), intent(out) :: status
         integer(c_int), intent(in), value :: options
         integer(c_int) :: ended
      end function c_waitpid

      !> Ends the process at once: nothing of the Fortran run-time library is flushed or closed
      subroutine c_exit(code) bind(C, name="_exit")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: code
      end subroutine c_exit

      function c_kill(process, signal) result(failed) bind(C, name="kill")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: process, signal
         integer(c_int) :: failed
      end function c_kill

      function c_raise(signal) result(failed) bind(C, name="raise")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: signal
         integer(c_int) :: failed
      end function c_raise

      function c_signal(signal, handler) result(before) bind(C, name="signal")
         import :: c_funptr, c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: signal
         type(c_funptr), intent(in), value :: handler
         type(c_funptr) :: before
      end function c_signal

      function c_pipe(ends) result(failed) bind(C, name="pipe")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(out) :: ends(2)
         integer(c_int) :: failed
      end function c_pipe

      function c_isatty(descriptor) result(terminal) bind(C, name="isatty")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: terminal
      end function c_isatty
   end interface

contains

   !> Writes a text to a descriptor, in as many calls as it takes; what cannot be written is lost.
   subroutine write_bytes(descriptor, text)
      !> Of the system
      integer(c_int), intent(in) :: descriptor
      !> Any bytes
      character(*, kind=c_char), intent(in), target :: text
      logical :: failed

      call write_all(descriptor, c_loc(text), len(text, int64), failed)
   end subroutine write_bytes

   !> SIG_IGN: the signal does nothing.
   pure type(c_funptr) function ignore_signal()
      ignore_signal = transfer(1_c_intptr_t, c_null_funptr)
   end function ignore_signal

end module gyroakf_app_system
