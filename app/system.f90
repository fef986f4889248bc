! SPDX-License-Identifier: MIT
!> What the program needs of the system (POSIX): signals; what standard output can show: signs
!> beyond ASCII by the locale, colors by what it is.
!>
!> While nothing is written a signal (Ctrl-C, a request to end) ends the program at once, as it does
!> every program. Under [[guard_files]] it only sets a flag, see [[interrupted]]: what was written
!> aside is then removed before the program ends. The same signal a second time ends it at once.
!> This is the one place of the program that keeps state: a signal handler has no arguments of its
!> own.
module gyroakf_app_system
   use, intrinsic :: iso_c_binding, only : c_associated, c_char, c_funloc, c_funptr, c_int, &
      c_intptr_t, c_loc, c_long, c_null_funptr, c_size_t
   use gyroakf_kinds, only : int64
   use gyroakf_io_system, only : c_write, move_bytes
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, discard_writer, open_writer, writer_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: watch_signals, guard_files, interrupted, interrupt_signal, bar_is_shown
   public :: c_isatty, write_bytes, open_report, end_writers

   !> The signal that came while files were guarded, 0: none
   integer(c_int), volatile :: caught = 0
   !> A signal does not end the program at once
   logical, volatile :: guarded = .false.
   !> Something stands on the line of the terminal
   logical, volatile :: shown = .false.
   !> Takes a bar away, which is 79 characters wide at most
   character(81, kind=c_char), target :: wiped = " "

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

   !> Writes a text to a descriptor, in as many calls as it takes; what cannot be written is lost.
   subroutine write_bytes(descriptor, text)
      !> Of the system
      integer(c_int), intent(in) :: descriptor
      !> Any bytes
      character(*, kind=c_char), intent(in), target :: text
      integer(int64) :: written
      logical :: failed

      call move_bytes(descriptor, c_loc(text), len(text, int64), written, failed)
   end subroutine write_bytes

   !> SIG_IGN: the signal does nothing.
   pure type(c_funptr) function ignore_signal()
      ignore_signal = transfer(1_c_intptr_t, c_null_funptr)
   end function ignore_signal

   !> Opens standard output for a report.
   subroutine open_report(writer, color, ascii, error)
      !> Open on standard output
      type(writer_type), intent(out) :: writer
      !> "auto": on a terminal, unless NO_COLOR is set or TERM is dumb; "always"; "never"
      character(*), intent(in) :: color
      !> Whatever the locale is
      logical, intent(in) :: ascii
      !> io
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, "-", error)
      if (allocated(error)) return
      writer%unicode = .not. ascii .and. locale_is_utf8()
      writer%color = color == "always"
      if (color == "auto") writer%color = c_isatty(1_c_int) == 1 .and. &
         variable("NO_COLOR") == "" .and. variable("TERM") /= "dumb" .and. variable("TERM") /= ""
   end subroutine open_report

   !> Lets complete files appear; after an error none of them.
   subroutine end_writers(writer, error)
      !> All are closed
      type(writer_type), intent(inout) :: writer(:)
      !> An earlier error stays; io
      type(error_type), allocatable, intent(inout) :: error
      integer :: i

      do i = 1, size(writer)
         if (allocated(error)) then
            call discard_writer(writer(i))
         else if (writer(i)%complete) then
            call commit_writer(writer(i), error)
         end if
      end do
   end subroutine end_writers

   !> The first of the variables that is set names the characters, as POSIX has it.
   logical function locale_is_utf8()
      character(:), allocatable :: name

      name = variable("LC_ALL")
      if (name == "") name = variable("LC_CTYPE")
      if (name == "") name = variable("LANG")
      locale_is_utf8 = index(lower(name), "utf-8") > 0 .or. index(lower(name), "utf8") > 0
   end function locale_is_utf8

   !> Value of a variable of the environment, "" where it is not set.
   function variable(name) result(value)
      character(*), intent(in) :: name
      character(:), allocatable :: value
      integer :: length

      call get_environment_variable(name, length=length)
      allocate (character(length) :: value)
      if (length > 0) call get_environment_variable(name, value)
   end function variable

end module gyroakf_app_system
