! SPDX-License-Identifier: MIT
!> Reads the dictionary of a NumPy file sign by sign; the first thing that is wrong is kept.
module gyroakf_io_npy_cursor
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   implicit none (type, external)
   private
   public :: cursor_type, ahead, expect, read_string, refuse, unsuitable

   !> A header that is being read
   type :: cursor_type
      character(:), allocatable :: text
      integer :: at = 1
      !> Bytes before the text, and the file's name: for messages
      integer(int64) :: before = 0
      character(:), allocatable :: name
      !> What is wrong first; what follows is not looked at
      type(error_type), allocatable :: error
   end type cursor_type

contains

   !> The next character that is not blank, "" at the end.
   function ahead(cursor) result(next)
      type(cursor_type), intent(inout) :: cursor
      character(1) :: next

      next = ""
      do while (cursor%at <= len(cursor%text))
         next = cursor%text(cursor%at:cursor%at)
         if (verify(next, " "//achar(9)//achar(10)//achar(13)) > 0) return
         cursor%at = cursor%at + 1
         next = ""
      end do
   end function ahead

   !> Moves behind a sign that has to come.
   subroutine expect(cursor, sign)
      type(cursor_type), intent(inout) :: cursor
      character(1), intent(in) :: sign

      if (ahead(cursor) /= sign) call refuse(cursor, "'"//sign//"' is expected")
      cursor%at = cursor%at + 1
   end subroutine expect

   !> A text in single or double quotes.
   subroutine read_string(cursor, text)
      type(cursor_type), intent(inout) :: cursor
      character(:), allocatable, intent(out) :: text
      character(1) :: mark
      integer :: last

      mark = ahead(cursor)
      last = 0
      if (mark == "'" .or. mark == '"') last = index(cursor%text(cursor%at + 1:), mark)
      if (last == 0) call refuse(cursor, "a text in quotes is expected")
      text = cursor%text(cursor%at + 1:cursor%at + last - 1)
      cursor%at = cursor%at + last + 1
   end subroutine read_string

   !> A header that cannot be understood, with the byte.
   subroutine refuse(cursor, what)
      type(cursor_type), intent(inout) :: cursor
      character(*), intent(in) :: what

      if (allocated(cursor%error)) return
      call fatal_error(cursor%error, status%parse, cursor%name//": byte "// &
         integer_text(cursor%before + cursor%at - 1)//": in the header of NumPy's format "//what// &
         new_line("a")//"save it again with numpy.save")
   end subroutine refuse

   !> An array that is no table of numbers.
   subroutine unsuitable(cursor, what, advice)
      type(cursor_type), intent(inout) :: cursor
      character(*), intent(in) :: what, advice

      if (allocated(cursor%error)) return
      call fatal_error(cursor%error, status%not_supported, cursor%name//": "//what// &
         new_line("a")//advice)
   end subroutine unsuitable

end module gyroakf_io_npy_cursor
