! SPDX-License-Identifier: MIT
!> Decimal numbers of any form, correctly rounded, digit by digit: the paths of [[gyroakf_io_number]] for what is not usual.
module gyroakf_io_any_number
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_library_number, only : library_value
   use gyroakf_io_quick_number, only : exact_limit, exact_ten
   use gyroakf_io_wide_power, only : int128, least_power, power_scale, wide_power
   implicit none (type, external)
   private
   public :: scan_any, number

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

   !> A decimal number in parts: its value lies between mantissa and mantissa + excess, times 10^exponent
   type :: decimal_type
      integer(int64) :: mantissa, excess, exponent
      !> 1 for a minus sign, else 0
      integer(int64) :: minus
   end type decimal_type

   !> 10*m + 9 does not overflow up to here
   integer(int64), parameter :: mantissa_limit = 922337203685477579_int64

   !> Up to this power of ten no mantissa makes a number overflow
   integer, parameter :: most_exponent = 288

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
      type(decimal_type) :: decimal
      integer(int64) :: next
      logical :: sure

      value = 0.0_dp
      call scan_decimal(bytes, at, next, decimal)
      if (next == at) then
         found = number%none
         return
      end if
      found = number%ok
      if (decimal%excess == 0 .and. decimal%mantissa <= exact_limit .and. abs(decimal%exponent) <= 22) then
         value = real(decimal%mantissa, dp)
         if (decimal%exponent < 0) value = value/exact_ten(-decimal%exponent)
         if (decimal%exponent > 0) value = value*exact_ten(decimal%exponent)
      else if (decimal%mantissa > 0) then
         call round_decimal(decimal, value, sure)
         if (.not. sure) then
            call library_value(bytes(at:next - 1), value)
            value = abs(value)
            if (.not. ieee_is_finite(value)) then
               found = number%overflow
               value = huge(1.0_dp)
            end if
         end if
      end if
      value = transfer(ieor(transfer(value, next), shiftl(decimal%minus, 63)), value)
      at = next
   end subroutine scan_any

   !> Takes the number apart; `next` is `at` where there is none.
   pure subroutine scan_decimal(bytes, at, next, decimal)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at
      integer(int64), intent(out) :: next
      type(decimal_type), intent(out) :: decimal
      integer(int64) :: p, first, m, q
      integer :: digit
      logical :: any_digit

      next = at
      call skip_sign(bytes(at), p, decimal%minus, at)
      m = 0
      q = 0
      decimal%excess = 0
      first = p
      do
         digit = bytes(p) - 48
         if (digit < 0 .or. digit > 9) exit
         if (m > mantissa_limit) then
            if (digit > 0) decimal%excess = 1
            q = q + 1
         else
            m = 10*m + digit
         end if
         p = p + 1
      end do
      any_digit = p > first
      if (bytes(p) == 46) then
         p = p + 1
         first = p
         do
            digit = bytes(p) - 48
            if (digit < 0 .or. digit > 9) exit
            if (m > mantissa_limit) then
               if (digit > 0) decimal%excess = 1
            else
               m = 10*m + digit
               q = q - 1
            end if
            p = p + 1
         end do
         any_digit = any_digit .or. p > first
      end if
      if (.not. any_digit) return
      decimal%mantissa = m
      decimal%exponent = q
      next = p
      if (bytes(p) > 44) call scan_exponent(bytes, next, decimal)
      if (next == p) return
      if (next < 0) next = at
   end subroutine scan_decimal

   !> The byte behind one that is + or -, else that one; without a branch, as signs of noise cannot be predicted.
   pure subroutine skip_sign(byte, p, minus, at)
      integer(int8), intent(in) :: byte
      integer(int64), intent(out) :: p, minus
      integer(int64), intent(in) :: at
      integer :: sign_bits, signed

      sign_bits = byte - 43
      signed = shiftr(iand(sign_bits, 253) - 1, 31)
      minus = iand(shiftr(sign_bits, 1), signed)
      p = at + signed
   end subroutine skip_sign

   !> Adds the exponent that may begin at `next`; -1 where its digits are missing.
   pure subroutine scan_exponent(bytes, next, decimal)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: next
      type(decimal_type), intent(inout) :: decimal
      integer(int64) :: p, first, exponent, minus
      integer :: digit, letter

      letter = ior(int(bytes(next)), 32)
      if (letter /= 101 .and. letter /= 100) return
      call skip_sign(bytes(next + 1), p, minus, next + 1)
      first = p
      exponent = 0
      do
         digit = bytes(p) - 48
         if (digit < 0 .or. digit > 9) exit
         if (exponent < 1000000000) exponent = 10*exponent + digit
         p = p + 1
      end do
      next = p
      if (p == first) next = -1
      decimal%exponent = decimal%exponent + merge(-exponent, exponent, minus == 1)
   end subroutine scan_exponent

   !> The number is between product and product + spread, times 2^scale; not sure where these round differently, nor where it is
   !> not normal.
   pure subroutine round_decimal(decimal, value, sure)
      type(decimal_type), intent(in) :: decimal
      real(dp), intent(out) :: value
      logical, intent(out) :: sure
      integer(int128) :: power, top, product, spread, half, rest
      integer :: shift, drop, scale
      integer, parameter :: part = 63

      value = 0.0_dp
      sure = .false.
      if (decimal%exponent < least_power .or. decimal%exponent > most_exponent) return
      call wide_power(int(decimal%exponent), power)
      shift = leadz(decimal%mantissa) - 1
      top = shiftl(decimal%mantissa, shift)
      product = top*shiftr(power, part) + shiftr(top*iand(power, int(huge(1_int64), int128)), part)
      spread = 2 + shiftl(shiftr(power, part) + 1, shift)*decimal%excess
      scale = power_scale(int(decimal%exponent)) + part - shift
      drop = 128 - leadz(product) - 53
      half = shiftl(1_int128, drop - 1)
      rest = iand(product + half, 2*half - 1)
      sure = rest > 0 .and. rest + spread < 2*half
      product = shiftr(product + half, drop)
      value = transfer(shiftl(int(scale + drop + 52 + 1022, int64), 52) + int(product, int64), value)
   end subroutine round_decimal

end module gyroakf_io_any_number
