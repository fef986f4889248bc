! SPDX-License-Identifier: MIT
!> What the program needs of the system (POSIX): signals, and what standard output can show: signs
!> beyond ASCII by the locale, colours by what it is.
module gyroakf_app_system
   use, intrinsic :: iso_c_binding, only : c_char, c_funptr, c_int, c_intptr_t, c_loc, c_null_funptr
   use gyroakf_kinds, only : int64
   use gyroakf_io_system, only : c_write, move_bytes
   use gyroakf_error, only : error_type
   use gyroakf_io_writer, only : commit_writer, discard_writer, open_writer, writer_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: c_isatty, c_raise, c_signal, c_write
   public :: write_bytes, ignore_signal, open_report, end_writers
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
      integer(int64) :: written
      logical :: failed

      call move_bytes(descriptor, c_loc(text), len(text, int64), written, failed)
   end subroutine write_bytes

   !> SIG_IGN: the signal does nothing.
   pure type(c_funptr) function ignore_signal()
      ignore_signal = transfer(1_c_intptr_t, c_null_funptr)
   end function ignore_signal

   !> Opens standard output for a report.
   subroutine open_report(writer, colour, ascii, error)
      !> Open on standard output
      type(writer_type), intent(out) :: writer
      !> "auto": on a terminal, unless NO_COLOR is set or TERM is dumb; "always"; "never"
      character(*), intent(in) :: colour
      !> Whatever the locale is
      logical, intent(in) :: ascii
      !> io
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, "-", error)
      if (allocated(error)) return
      writer%unicode = .not. ascii .and. locale_is_utf8()
      writer%colour = colour == "always"
      if (colour == "auto") writer%colour = c_isatty(1_c_int) == 1 .and. &
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
