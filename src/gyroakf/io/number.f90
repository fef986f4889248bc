! SPDX-License-Identifier: MIT
!> Decimal numbers in text, read correctly rounded (to nearest, ties to even), always, and whatever the locale is.
!>
!> A number m * 10^q takes the first of three paths that is sure of its result:
!>
!> 1. m <= 2^53 and |q| <= 22: one multiplication or division of two exact numbers
!>    (W. D. Clinger, How to read floating point numbers accurately, 1990);
!> 2. m times the first 63 bits of 10^q, a lower bound; where the upper bound rounds to the same number, that is the number
!>    ([[gyroakf_io_quick_number]]);
!> 3. the C library's `strtod_l` with the C locale: unusual forms, ties, subnormals, very many digits
!>    ([[gyroakf_io_library_number]]).
module gyroakf_io_number
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_library_number, only : number, scan_any
   use gyroakf_io_quick_number, only : digits_ahead, quick_number, quick_type, skip_digits
   implicit none (type, external)
   private
   public :: scan_number, skip_digits, parse_number, is_missing_word, is_missing_field, number, digits_ahead

contains

   !> The number that begins at a byte: `[+-] digits [. digits] [e|E|d|D [+-] digits]`, one digit at least.
   !>
   !> Whether what follows may follow is the caller's business. Thread-safe; no allocation but for a number of more than
   !> 120 characters.
   pure subroutine scan_number(bytes, at, value, found)
      !> The text; [[gyroakf_io_quick_number:digits_ahead]] more bytes than the text, the first of them no digit
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of the number; afterwards the byte after it, unchanged where there is no number
      integer(int64), intent(inout) :: at
      !> The number; 0 where there is none, +-huge on overflow
      real(dp), intent(out) :: value
      !> One of the components of [[number]]
      integer, intent(out) :: found
      type(quick_type) :: quick

      quick = quick_number(bytes, at)
      if (quick%next > 0) then
         value = quick%value
         at = quick%next
         found = number%ok
      else
         call scan_any(bytes, at, value, found)
      end if
   end subroutine scan_number

   !> The number that a text is; blanks around it are allowed.
   pure subroutine parse_number(text, value, found)
      !> As an option or a header gives it
      character(*), intent(in) :: text
      !> The number; 0 where there is none
      real(dp), intent(out) :: value
      !> One of the components of [[number]]
      integer, intent(out) :: found
      integer(int8) :: bytes(len(text) + digits_ahead + 1)
      integer(int64) :: at, last
      integer :: i

      bytes = 10_int8
      do i = 1, len(text)
         bytes(i) = int(iachar(text(i:i)) - merge(256, 0, iachar(text(i:i)) > 127), int8)
      end do
      at = verify(text, " ")
      last = len_trim(text)
      value = 0.0_dp
      found = number%none
      if (at == 0) return
      call scan_number(bytes, at, value, found)
      if (at == last + 1) return
      found = number%none
      value = 0.0_dp
   end subroutine parse_number

   !> True for the words that stand for a missing number: nan, NA, n/a, null, none, inf, infinity; any case, a sign allowed.
   pure logical function is_missing_word(word)
      !> Without blanks around it
      character(*), intent(in) :: word
      character(9), parameter :: known(9) = [character(9) :: &
         "nan", "na", "n/a", "null", "none", "inf", "infinity", "nan(ind)", "nan(snan)"]
      character(len(word)) :: low
      integer :: i, first

      is_missing_word = .false.
      if (len(word) == 0 .or. len(word) > 10) return
      do i = 1, len(word)
         low(i:i) = word(i:i)
         if (word(i:i) >= "A" .and. word(i:i) <= "Z") low(i:i) = achar(iachar(word(i:i)) + 32)
      end do
      first = 1
      if (low(1:1) == "-" .or. low(1:1) == "+") first = 2
      if (first > len(word)) return
      is_missing_word = any(known == low(first:))
   end function is_missing_word

   !> True for bytes that are such a word.
   pure logical function is_missing_field(bytes, first, last)
      !> Holds it at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(10) :: word
      integer(int64) :: i

      is_missing_field = .false.
      if (last < first .or. last - first >= len(word)) return
      do i = first, last
         word(i - first + 1:i - first + 1) = achar(iand(int(bytes(i)), 255))
      end do
      is_missing_field = is_missing_word(word(:last - first + 1))
   end function is_missing_field

end module gyroakf_io_number
