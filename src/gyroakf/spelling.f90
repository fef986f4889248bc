! SPDX-License-Identifier: MIT
!> Lower case, replacing, and the nearest known word: for messages that help.
module gyroakf_spelling
   implicit none (type, external)
   private
   public :: lower, replace_all, nearest_word, edit_distance

contains

   !> The text with A-Z in lower case; other bytes (UTF-8) stay.
   pure function lower(text) result(low)
      character(*), intent(in) :: text
      character(len(text)) :: low
      integer :: i, code

      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= 65 .and. code <= 90) code = code + 32
         low(i:i) = achar(code)
      end do
   end function lower

   !> Replaces every occurrence of `old` in a text by `new`, from left to right.
   pure subroutine replace_all(text, old, new)
      character(:), allocatable, intent(inout) :: text
      !> What is looked for, not empty
      character(*), intent(in) :: old, new
      character(:), allocatable :: changed
      integer :: from, at

      if (len(old) == 0 .or. index(text, old) == 0) return
      changed = ""
      from = 1
      do
         at = index(text(from:), old)
         if (at == 0) exit
         changed = changed//text(from:from + at - 2)//new
         from = from + at - 1 + len(old)
      end do
      text = changed//text(from:)
   end subroutine replace_all

   !> Index of the known word that is nearest to a misspelt one, 0 where none is near.
   !>
   !> Near: at most a third of the longer word's letters, or one, have to be changed.
   pure integer function nearest_word(word, known)
      !> The misspelt word; case does not matter
      character(*), intent(in) :: word
      !> The known words, blank padded
      character(*), intent(in) :: known(:)
      integer :: i, d, best

      nearest_word = 0
      best = huge(best)
      do i = 1, size(known)
         d = edit_distance(lower(trim(word)), lower(trim(known(i))))
         if (d >= best .or. d > max(1, max(len_trim(word), len_trim(known(i)))/3)) cycle
         best = d
         nearest_word = i
      end do
   end function nearest_word

   !> Restricted Damerau-Levenshtein distance: letters to insert, delete, replace or swap.
   pure integer function edit_distance(a, b)
      character(*), intent(in) :: a, b
      integer :: d(-1:len(a), -1:len(b)), i, j, cost

      d(-1, :) = len(a) + len(b)
      d(:, -1) = len(a) + len(b)
      d(0:, 0) = [(i, i=0, len(a))]
      d(0, 0:) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            cost = merge(0, 1, a(i:i) == b(j:j))
            d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
            if (a(i:i) == b(max(j - 1, 1):max(j - 1, 1)) .and. &
               a(max(i - 1, 1):max(i - 1, 1)) == b(j:j)) d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
         end do
      end do
      edit_distance = d(len(a), len(b))
   end function edit_distance

end module gyroakf_spelling
