! SPDX-License-Identifier: MIT
!> The calls of the system (POSIX) that the program needs: signals and the terminal.
module gyroakf_app_system
   use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_intptr_t, c_loc, c_null_funptr
   use gyroakf_kinds, only : int64
   use gyroakf_io_system, only : c_write, write_all
   implicit none (type, external)
   private
   public :: c_isatty, c_raise, c_signal, c_write
   public :: write_bytes, ignore_signal
   public :: signal_hangup, signal_interrupt, signal_pipe, signal_terminate, signal_file_size

   !> Numbers that are the same on every POSIX system
   integer(c_int), parameter :: signal_hangup = 1, signal_interrupt = 2, signal_pipe = 13, &
      signal_terminate = 15, signal_file_size = 25

   interface
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
