! SPDX-License-Identifier: MIT
!> Ctrl-C, a request to end, a reader that goes away.
!>
!> While nothing is written a signal ends the program at once, as it does every program. Under
!> [[guard_files]] it only sets a flag, see [[interrupted]]: what was written aside is then removed
!> before the program ends. The same signal a second time ends it at once.
!> This is the one place of the program that keeps state: a signal handler has no arguments of its
!> own.
module gyroakf_app_interrupt
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_funloc, c_funptr, c_int, &
      c_loc, c_long, c_null_funptr, c_size_t
   use gyroakf_app_system, only : c_raise, c_signal, c_write, ignore_signal, signal_file_size, &
      signal_hangup, signal_interrupt, signal_pipe, signal_terminate
   implicit none (type, external)
   private
   public :: watch_signals, guard_files, interrupted, interrupt_signal, bar_is_shown

   !> The signal that came while files were guarded, 0: none
   integer(c_int), volatile :: caught = 0
   !> A signal does not end the program at once
   logical, volatile :: guarded = .false.
   !> Something stands on the line of the terminal
   logical, volatile :: shown = .false.
   !> Takes a bar away, which is 79 characters wide at most
   character(81, kind=c_char), target :: wiped = " "

contains

   !> From now on signals are caught. A closed pipe and a file larger than allowed are no signals
   !> but writes that fail; a signal that was ignored when the program began (nohup) stays so.
   subroutine watch_signals()
      type(c_funptr) :: before

      wiped(1:1) = achar(13)
      wiped(81:81) = achar(13)
      before = c_signal(signal_pipe, ignore_signal())
      before = c_signal(signal_file_size, ignore_signal())
      call watch(signal_interrupt)
      call watch(signal_terminate)
      call watch(signal_hangup)
   end subroutine watch_signals

   subroutine watch(signal)
      integer(c_int), intent(in) :: signal
      type(c_funptr) :: before

      before = c_signal(signal, c_funloc(on_signal))
      if (c_associated(before, ignore_signal())) before = c_signal(signal, ignore_signal())
   end subroutine watch

   !> The handler. Only calls that are safe inside one.
   subroutine on_signal(signal) bind(C, name="gyroakf_app_on_signal")
      !> Its number
      integer(c_int), intent(in), value :: signal
      type(c_funptr) :: before
      integer(c_long) :: ignored
      integer(c_int) :: failed

      if (guarded .and. caught /= signal) then
         caught = signal
         return
      end if
      if (shown) ignored = c_write(2_c_int, c_loc(wiped), len(wiped, c_size_t))
      before = c_signal(signal, c_null_funptr)
      failed = c_raise(signal)
   end subroutine on_signal

   !> Whether files are written: then a signal waits until all are complete, or none is left.
   subroutine guard_files(yes)
      !> From here on
      logical, intent(in) :: yes

      guarded = yes
   end subroutine guard_files

   !> Whether the user wants the program to end.
   logical function interrupted()
      interrupted = caught /= 0
   end function interrupted

   !> The signal's number, 0 where there was none; the exit code is 128 more.
   integer function interrupt_signal()
      interrupt_signal = int(caught)
   end function interrupt_signal

   !> Informs the handler whether a progress bar has to be removed.
   subroutine bar_is_shown(yes)
      !> It is on the terminal
      logical, intent(in) :: yes

      shown = yes
   end subroutine bar_is_shown

end module gyroakf_app_interrupt
