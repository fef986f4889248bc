! SPDX-License-Identifier: MIT
!> Names of columns taken apart: words between signs, and between small letters and capitals.
module gyroakf_name_words
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: split_name, ends_with, join_name, has_word, has_beginning

   character(*), parameter :: signs = "_-. /:[](),"//achar(9)

contains

   !> The words of a name in lower case: "TimeUS", "time_us" and "timeus" are "time" and "us".
   pure subroutine split_name(name, word)
      !> As written
      character(*), intent(in) :: name
      !> None of them is empty
      type(text_type), allocatable, intent(out) :: word(:)
      character(4), parameter :: endings(4) = [character(4) :: "us", "ms", "ns", "fine"]
      character(:), allocatable :: text, ending
      integer :: i, k

      allocate (word(0))
      text = ""
      do i = 1, len(name) + 1
         if (begins_word(name, i)) then
            do k = 1, size(endings)
               ending = trim(endings(k))
               if (.not. (ends_with(text, "time"//ending) .or. ends_with(text, "stamp"//ending))) cycle
               call add_text(word, text(:len(text) - len(ending)))
               text = ending
            end do
            if (len(text) > 0) call add_text(word, text)
            text = ""
         end if
         if (i > len(name)) exit
         if (scan(name(i:i), signs) == 0) text = text//lower(name(i:i))
      end do
   end subroutine split_name

   !> True where a word ends before a character: at a sign, at a capital behind a small letter, and
   !> at the last capital before one.
   pure logical function begins_word(name, i)
      character(*), intent(in) :: name
      integer, intent(in) :: i
      character(*), parameter :: capitals = "ABCDEFGHIJKLMNOPQRSTUVWXYZ", small = "abcdefghijklmnopqrstuvwxyz"

      begins_word = i > len(name)
      if (begins_word) return
      begins_word = scan(name(i:i), signs) > 0
      if (begins_word .or. i == 1 .or. scan(name(i:i), capitals) == 0) return
      begins_word = scan(name(i - 1:i - 1), small) > 0
      if (begins_word .or. i == len(name)) return
      begins_word = scan(name(i - 1:i - 1), capitals) > 0 .and. scan(name(i + 1:i + 1), small) > 0
   end function begins_word

   !> True where the text ends so.
   pure logical function ends_with(text, tail)
      !> Any
      character(*), intent(in) :: text, tail

      ends_with = .false.
      if (len(text) >= len(tail)) ends_with = text(len(text) - len(tail) + 1:) == tail
   end function ends_with

   !> The words without anything between them, and without digits at the end.
   pure subroutine join_name(word, text)
      !> Of [[split_name]]
      type(text_type), intent(in) :: word(:)
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = ""
      do i = 1, size(word)
         text = text//word(i)%text
      end do
      text = text(:verify(text, "0123456789", back=.true.))
   end subroutine join_name

   !> True where one of the words is in a list; digits at its end do not count.
   pure logical function has_word(word, list)
      !> Of [[split_name]]
      type(text_type), intent(in) :: word(:)
      !> In lower case, blank padded
      character(*), intent(in) :: list(:)
      integer :: i, last

      has_word = .false.
      do i = 1, size(word)
         last = verify(word(i)%text, "0123456789", back=.true.)
         if (last > 0) has_word = has_word .or. any(list == word(i)%text(:last))
      end do
   end function has_word

   !> True where one of the words begins with one of a list.
   pure logical function has_beginning(word, list)
      !> Of [[split_name]]
      type(text_type), intent(in) :: word(:)
      !> In lower case, blank padded
      character(*), intent(in) :: list(:)
      integer :: i, k

      has_beginning = .false.
      do i = 1, size(word)
         do k = 1, size(list)
            has_beginning = has_beginning .or. index(word(i)%text, trim(list(k))) == 1
         end do
      end do
   end function has_beginning

end module gyroakf_name_words
