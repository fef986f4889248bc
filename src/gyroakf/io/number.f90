! SPDX-License-Identifier: MIT
!> Decimal numbers in text, correctly rounded (to nearest, ties to even) whatever the locale is.
!>
!> A number m * 10^q takes the first of three paths that is sure of its result:
!>
!> 1. m <= 2^53 and |q| <= 22: one multiplication or division of two exact numbers
!>    (W. D. Clinger, How to read floating point numbers accurately, 1990);
!> 2. m times the first 63 bits of 10^q, a lower bound; where the upper bound rounds to the same
!>    number, that is the number ([[gyroakf_io_quick_number]]);
!> 3. the C library's `strtod_l` with the C locale: unusual forms, ties, subnormals, very many
!>    digits ([[scan_any]]).
module gyroakf_io_number
   use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: ieee_exceptions, only : ieee_flag_type, ieee_get_flag, ieee_get_halting_mode, &
      ieee_overflow, ieee_set_flag, ieee_set_halting_mode, ieee_underflow
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_quick_number, only : digits_ahead, quick_number, quick_type
   use gyroakf_io_text, only : bytes_text, text_bytes
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: scan_number, scan_any, parse_number, is_missing_word, is_missing_field, number, &
      digits_ahead

   !> What scanning found, reached as `number%ok`
   type :: number_enum
      !> A number
      integer :: ok = 0
      !> Something else
      integer :: none = 1
      !> A number beyond the largest double
      integer :: overflow = 2
   end type number_enum

   !> All outcomes
   type(number_enum), parameter :: number = number_enum()

   interface
      pure function c_strtod_l(text, end, locale) result(value) bind(C, name="strtod_l")
         import :: c_char, c_double, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: text(*)
         type(c_ptr), intent(in), value :: end, locale
         real(c_double) :: value
      end function c_strtod_l

      !> With a null base the categories outside of the mask are those of the C locale
      pure function c_newlocale(mask, name, base) result(locale) bind(C, name="newlocale")
         import :: c_char, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), intent(in), value :: mask
         character(kind=c_char), intent(in) :: name(*)
         type(c_ptr), intent(in), value :: base
         type(c_ptr) :: locale
      end function c_newlocale

      pure subroutine c_freelocale(locale) bind(C, name="freelocale")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), intent(in), value :: locale
      end subroutine c_freelocale
   end interface

contains

   !> The number at a byte: `[+-] digits [. digits] [e|E|d|D [+-] digits]`, one digit at least.
   !>
   !> Whether what follows may follow is the caller's business. Thread-safe.
   pure subroutine scan_number(bytes, at, value, found)
      !> The text and `digits_ahead` more bytes, the first of them no digit
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

   !> The same without the usual forms being tried first.
   pure subroutine scan_any(bytes, at, value, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: at
      real(dp), intent(out) :: value
      integer, intent(out) :: found
      integer(int64) :: next

      value = 0.0_dp
      found = number%none
      next = number_end(bytes, at)
      if (next == at) return
      found = number%ok
      call library_value(bytes(at:next - 1), value)
      if (.not. ieee_is_finite(value)) then
         found = number%overflow
         value = sign(huge(value), value)
      end if
      at = next
   end subroutine scan_any

   !> The byte after the number that begins at a byte; that byte itself where there is none.
   pure integer(int64) function number_end(bytes, at) result(next)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at
      integer(int64) :: first, last, digits

      next = at
      first = at + merge(1, 0, is_sign(bytes(at)))
      last = digits_end(bytes, first)
      digits = last - first
      if (bytes(last) == iachar(".")) then
         first = last + 1
         last = digits_end(bytes, first)
         digits = digits + last - first
      end if
      if (digits == 0) return
      if (any(bytes(last) == iachar(["D", "E", "d", "e"]))) then
         first = last + merge(2, 1, is_sign(bytes(last + 1)))
         last = digits_end(bytes, first)
         if (last == first) return
      end if
      next = last
   end function number_end

   pure logical function is_sign(byte)
      integer(int8), intent(in) :: byte

      is_sign = byte == iachar("+") .or. byte == iachar("-")
   end function is_sign

   pure integer(int64) function digits_end(bytes, first) result(next)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first

      next = first
      do while (bytes(next) >= 48 .and. bytes(next) <= 57)
         next = next + 1
      end do
   end function digits_end

   !> The number that bytes are, infinite on overflow; a host that traps overflow is not disturbed.
   pure subroutine library_value(bytes, value)
      integer(int8), intent(in) :: bytes(:)
      real(dp), intent(out) :: value
      type(ieee_flag_type), parameter :: flags(2) = [ieee_overflow, ieee_underflow]
      character(kind=c_char) :: text(size(bytes, kind=int64) + 1)
      logical :: halting(2), raised(2)
      type(c_ptr) :: locale

      text(:size(bytes, kind=int64)) = achar(bytes)
      text(size(text, kind=int64)) = c_null_char
      where (text == "d" .or. text == "D") text = "e"
      call ieee_get_halting_mode(flags, halting)
      call ieee_get_flag(flags, raised)
      call ieee_set_halting_mode(flags, .false.)
      locale = c_newlocale(2_c_int, "C"//c_null_char, c_null_ptr)
      value = c_strtod_l(text, c_null_ptr, locale)
      call c_freelocale(locale)
      call ieee_set_flag(flags, raised)
      call ieee_set_halting_mode(flags, halting)
   end subroutine library_value

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

      bytes(:len(text)) = text_bytes(text)
      bytes(len(text) + 1:) = 10_int8
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

   !> True for the words that stand for a missing number, in any case; a sign is allowed.
   pure logical function is_missing_word(word)
      !> Without blanks around it
      character(*), intent(in) :: word
      character(9), parameter :: known(9) = [character(9) :: &
         "nan", "na", "n/a", "null", "none", "inf", "infinity", "nan(ind)", "nan(snan)"]
      integer :: first

      is_missing_word = .false.
      if (len(word) == 0 .or. len(word) > 10) return
      first = merge(2, 1, scan(word(1:1), "+-") > 0)
      if (first <= len(word)) is_missing_word = any(known == lower(word(first:)))
   end function is_missing_word

   !> True for bytes that are such a word.
   pure logical function is_missing_field(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last

      is_missing_field = last >= first .and. last - first < 10
      if (is_missing_field) is_missing_field = is_missing_word(bytes_text(bytes, first, last))
   end function is_missing_field

end module gyroakf_io_number
