! SPDX-License-Identifier: MIT
!> Values in a file of options: bare words, texts in quotes, lists of them.
module gyroakf_app_config_value
   use gyroakf_record, only : text_type, add_text
   implicit none (type, external)
   private
   public :: read_value, quoted

   character(*), parameter :: white = " "//achar(9)//achar(13)

contains

   !> What stands behind the equals sign.
   subroutine read_value(text, value, problem)
      !> To the end of the line; a comment may follow
      character(*), intent(in) :: text
      !> [1], of a list any number
      type(text_type), allocatable, intent(out) :: value(:)
      !> What is wrong; "" if nothing
      character(:), allocatable, intent(out) :: problem
      integer :: at
      logical :: list

      allocate (value(0))
      problem = ""
      at = 1
      call skip_blanks(text, at)
      list = .false.
      if (at <= len(text)) list = text(at:at) == "["
      if (list) then
         at = at + 1
         call read_list(text, at, value, problem)
      else
         call read_word(text, at, value, problem)
      end if
      if (problem /= "") return
      call skip_blanks(text, at)
      if (at > len(text)) return
      if (text(at:at) /= "#") problem = "something follows the value: '"//text(at:)//"'"
   end subroutine read_value

   !> Values separated by commas, up to the closing bracket.
   subroutine read_list(text, at, value, problem)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      type(text_type), allocatable, intent(inout) :: value(:)
      character(:), allocatable, intent(inout) :: problem

      do
         call skip_blanks(text, at)
         if (at > len(text)) exit
         if (text(at:at) == "]") then
            at = at + 1
            return
         end if
         call read_word(text, at, value, problem)
         if (problem /= "") return
         call skip_blanks(text, at)
         if (at > len(text)) exit
         if (text(at:at) == ",") then
            at = at + 1
         else if (text(at:at) /= "]") then
            exit
         end if
      end do
      problem = "the list does not end with ]"
   end subroutine read_list

   !> A text in quotes, with \" and \\ in it, or a bare word.
   subroutine read_word(text, at, value, problem)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      type(text_type), allocatable, intent(inout) :: value(:)
      character(:), allocatable, intent(inout) :: problem
      character(:), allocatable :: word
      integer :: to

      word = ""
      if (at > len(text)) then
         problem = "there is no value"
      else if (text(at:at) == """") then
         at = at + 1
         do while (at <= len(text))
            if (text(at:at) == """") exit
            if (text(at:at) == "\" .and. at < len(text)) at = at + 1
            word = word//text(at:at)
            at = at + 1
         end do
         if (at > len(text)) problem = "the quotes are not closed"
         at = at + 1
      else
         to = scan(text(at:), white//"#,]""")
         if (to == 0) to = len(text) - at + 2
         word = text(at:at + to - 2)
         at = at + to - 1
         if (word == "") problem = "there is no value"
      end if
      if (problem == "") call add_text(value, word)
   end subroutine read_word

   !> To the next character that is no blank.
   pure subroutine skip_blanks(text, at)
      character(*), intent(in) :: text
      integer, intent(inout) :: at

      do while (at <= len(text))
         if (scan(text(at:at), white) == 0) exit
         at = at + 1
      end do
   end subroutine skip_blanks

   !> A text in quotes.
   pure function quoted(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = """"
      do i = 1, len(text)
         if (scan(text(i:i), """\") > 0) word = word//"\"
         word = word//text(i:i)
      end do
      word = word//""""
   end function quoted

end module gyroakf_app_config_value
