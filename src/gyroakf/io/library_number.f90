! SPDX-License-Identifier: MIT
!> Decimal numbers of any form by the C library's `strtod_l`, in the C locale whatever the locale of
!> the process is: the last path of [[gyroakf_io_number]].
module gyroakf_io_library_number
   use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: ieee_exceptions, only : ieee_flag_type, ieee_get_flag, ieee_get_halting_mode, ieee_overflow, ieee_set_flag, &
      ieee_set_halting_mode, ieee_underflow
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: number, scan_any

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

   !> ".", and "D", "E", "d", "e"
   integer(int8), parameter :: point = 46
   integer(int8), parameter :: exponent_letters(4) = [68_int8, 69_int8, 100_int8, 101_int8]

   interface
      !> The number at the start of a C string, in a locale
      pure function c_strtod_l(text, end, locale) result(value) bind(C, name="strtod_l")
         import :: c_char, c_double, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: text(*)
         type(c_ptr), intent(in), value :: end, locale
         real(c_double) :: value
      end function c_strtod_l

      !> A locale object; with a null base the categories outside of the mask are those of the C locale
      pure function c_newlocale(mask, name, base) result(locale) bind(C, name="newlocale")
         import :: c_char, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), intent(in), value :: mask
         character(kind=c_char), intent(in) :: name(*)
         type(c_ptr), intent(in), value :: base
         type(c_ptr) :: locale
      end function c_newlocale

      !> Frees a locale object
      pure subroutine c_freelocale(locale) bind(C, name="freelocale")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), intent(in), value :: locale
      end subroutine c_freelocale
   end interface

contains

   !> The number that begins at a byte: `[+-] digits [. digits] [e|E|d|D [+-] digits]`, one digit at least.
   pure subroutine scan_any(bytes, at, value, found)
      !> The text and a byte behind it that may not follow a number
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of the number; afterwards the byte after it, unchanged where there is no number
      integer(int64), intent(inout) :: at
      !> The number; 0 where there is none, +-huge on overflow
      real(dp), intent(out) :: value
      !> One of the components of [[number]]
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
      integer(int64) :: p, digits, more

      next = at
      p = at
      if (is_sign(bytes(p))) p = p + 1
      digits = digit_count(bytes, p)
      p = p + digits
      if (bytes(p) == point) then
         more = digit_count(bytes, p + 1)
         digits = digits + more
         p = p + 1 + more
      end if
      if (digits == 0) return
      if (any(bytes(p) == exponent_letters)) then
         p = p + 1
         if (is_sign(bytes(p))) p = p + 1
         digits = digit_count(bytes, p)
         if (digits == 0) return
         p = p + digits
      end if
      next = p
   end function number_end

   pure logical function is_sign(byte)
      integer(int8), intent(in) :: byte

      is_sign = byte == 43 .or. byte == 45
   end function is_sign

   !> Digits from a byte on.
   pure integer(int64) function digit_count(bytes, first)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first

      digit_count = 0
      do while (bytes(first + digit_count) >= 48 .and. bytes(first + digit_count) <= 57)
         digit_count = digit_count + 1
      end do
   end function digit_count

   !> The number that bytes are, infinite on overflow; a host that traps overflow or underflow is not disturbed.
   pure subroutine library_value(bytes, value)
      !> A decimal number, nothing else
      integer(int8), intent(in) :: bytes(:)
      !> Correctly rounded
      real(dp), intent(out) :: value
      type(ieee_flag_type), parameter :: flags(2) = [ieee_overflow, ieee_underflow]
      logical :: halting(2), raised(2)

      call ieee_get_halting_mode(flags, halting)
      call ieee_get_flag(flags, raised)
      call ieee_set_halting_mode(flags, .false.)
      call call_strtod(bytes, value)
      call ieee_set_flag(flags, raised)
      call ieee_set_halting_mode(flags, halting)
   end subroutine library_value

   !> The number by the C library, without the fear of a locale.
   pure subroutine call_strtod(bytes, value)
      integer(int8), intent(in) :: bytes(:)
      real(dp), intent(out) :: value
      character(kind=c_char) :: short(128)
      character(kind=c_char), allocatable :: long(:)
      type(c_ptr) :: locale

      locale = c_newlocale(2_c_int, "C"//c_null_char, c_null_ptr)
      if (size(bytes) < size(short)) then
         call copy_number(bytes, short)
         value = c_strtod_l(short, c_null_ptr, locale)
      else
         allocate (long(size(bytes, kind=int64) + 1))
         call copy_number(bytes, long)
         value = c_strtod_l(long, c_null_ptr, locale)
      end if
      call c_freelocale(locale)
   end subroutine call_strtod

   !> Copies a number into a C string, d and D becoming e.
   pure subroutine copy_number(bytes, text)
      integer(int8), intent(in) :: bytes(:)
      character(kind=c_char), intent(out) :: text(:)
      integer(int64) :: i

      do i = 1, size(bytes, kind=int64)
         text(i) = achar(bytes(i))
         if (text(i) == "d" .or. text(i) == "D") text(i) = "e"
      end do
      text(size(bytes, kind=int64) + 1) = c_null_char
   end subroutine copy_number

end module gyroakf_io_library_number
