! SPDX-License-Identifier: MIT
!> What standard output can show: signs beyond ASCII by the locale, colours by what it is.
module gyroakf_app_terminal
   use, intrinsic :: iso_c_binding, only : c_int
   use gyroakf_io_writer, only : writer_type
   use gyroakf_app_system, only : c_isatty
   implicit none (type, external)
   private
   public :: adapt_writer

contains

   !> Sets what a report on standard output shows.
   subroutine adapt_writer(writer, colour, ascii)
      !> Open on standard output
      type(writer_type), intent(inout) :: writer
      !> "auto": on a terminal, unless NO_COLOR is set or TERM is dumb; "always"; "never"
      character(*), intent(in) :: colour
      !> Whatever the locale is
      logical, intent(in) :: ascii

      writer%unicode = .not. ascii .and. locale_is_utf8()
      select case (colour)
      case ("always"); writer%colour = .true.
      case ("never"); writer%colour = .false.
      case default
         writer%colour = c_isatty(1_c_int) == 1 .and. variable("NO_COLOR") == "" .and. variable("TERM") /= "dumb" .and. &
                         variable("TERM") /= ""
      end select
   end subroutine adapt_writer

   !> The first of the variables that is set names the characters, as POSIX has it.
   logical function locale_is_utf8()
      character(:), allocatable :: name
      integer :: i

      name = variable("LC_ALL")
      if (name == "") name = variable("LC_CTYPE")
      if (name == "") name = variable("LANG")
      do i = 1, len(name)
         if (name(i:i) >= "A" .and. name(i:i) <= "Z") name(i:i) = achar(iachar(name(i:i)) + 32)
      end do
      locale_is_utf8 = index(name, "utf-8") > 0 .or. index(name, "utf8") > 0
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

end module gyroakf_app_terminal
