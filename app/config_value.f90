! SPDX-License-Identifier: MIT
!> Values in a file of options: bare words, texts in quotes, lists of them.
module gyroakf_app_config_value
   use gyroakf_record, only : text_type, add_text
   use gyroakf_spelling, only : replace_all
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
      character(:), allocatable :: line
      integer :: at
      logical :: list

      allocate (value(0))
      problem = ""
      line = text//"#"                             ! a comment at the end at least
      at = verify(line, white)
      list = line(at:at) == "["
      if (list) at = at + 1
      do
         at = at - 1 + verify(line(at:), white)
         if (list .and. line(at:at) == "]") exit
         call read_word(line, at, value, problem)
         if (problem /= "") return
         at = at - 1 + verify(line(at:), white)
         if (.not. list .or. line(at:at) == "]") exit
         if (line(at:at) /= ",") then
            problem = "the list does not end with ]"
            return
         end if
         at = at + 1
      end do
      if (list) at = at + verify(line(at + 1:), white)
      if (line(at:at) /= "#") problem = "something follows the value: '"//text(at:)//"'"
   end subroutine read_value

   !> A text in quotes, with \" and \\ in it, or a bare word.
   subroutine read_word(text, at, value, problem)
      !> With # somewhere behind the word
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      type(text_type), allocatable, intent(inout) :: value(:)
      character(:), allocatable, intent(inout) :: problem
      character(:), allocatable :: word
      integer :: to

      word = ""
      if (text(at:at) == """") then
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
         word = text(at:at + to - 2)
         at = at + to - 1
         if (word == "") problem = "there is no value"
      end if
      if (problem == "") call add_text(value, word)
   end subroutine read_word

   !> A text in quotes.
   pure function quoted(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word

      word = text
      call replace_all(word, "\", "\\")
      call replace_all(word, """", "\""")
      word = """"//word//""""
   end function quoted

end module gyroakf_app_config_value
