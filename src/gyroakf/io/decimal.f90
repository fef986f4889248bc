! SPDX-License-Identifier: MIT
!> Numbers as text: correctly rounded, without blanks, the same in every locale.
module gyroakf_io_decimal
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_number, only : parse_number
   use gyroakf_io_power, only : most_exponent, ten, times_power
   implicit none (type, external)
   private
   public :: format_real, real_to_text, longest_real

   !> Characters of the longest number
   integer, parameter :: longest_real = 26

contains

   !> A number with so many significant digits, as C's `%.{digits}g`: 0.25, 12000, 1e-05; "nan", "inf", "-inf".
   pure function format_real(value, digits) result(text)
      !> Any number
      real(dp), intent(in) :: value
      !> 1 to 17; 0: as few as read back to the same number
      integer, intent(in) :: digits
      character(:), allocatable :: text
      character(longest_real) :: room
      integer :: length

      call real_to_text(value, digits, room, length)
      text = room(:length)
   end function format_real

   !> The same into a given room.
   pure subroutine real_to_text(value, digits, text, length)
      !> As those of [[format_real]]
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      !> Filled from the start; at least [[longest_real]] characters
      character(*), intent(inout) :: text
      !> Characters used
      integer, intent(out) :: length
      integer :: n, found
      real(dp) :: back

      if (digits > 0) then
         call with_digits(value, min(digits, 17), text, length)
         return
      end if
      do n = 15, 17
         call with_digits(value, n, text, length)
         if (.not. ieee_is_finite(value)) return
         call parse_number(text(:length), back, found)
         if (abs(back - value) <= 0.0_dp) return
      end do
   end subroutine real_to_text

   !> A number with 1 to 17 digits.
   pure subroutine with_digits(value, digits, text, length)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(*), intent(inout) :: text
      integer, intent(out) :: length
      integer(int64) :: whole
      integer :: exponent
      logical :: sure

      length = 0
      if (ieee_is_nan(value)) then
         call append(text, length, "nan")
         return
      end if
      if (sign(1.0_dp, value) < 0.0_dp) call append(text, length, "-")
      if (.not. ieee_is_finite(value)) then
         call append(text, length, "inf")
      else if (abs(value) <= 0.0_dp) then
         call append(text, length, "0")
      else
         call significant_digits(abs(value), digits, whole, exponent, sure)
         if (.not. sure) call library_digits(abs(value), digits, whole, exponent)
         call lay_out(whole, digits, exponent, text, length)
      end if
   end subroutine with_digits

   !> whole has the number of digits and whole * 10^(exponent - digits + 1) is next to the value; not sure near a tie.
   pure subroutine significant_digits(value, digits, whole, exponent, sure)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      integer(int64), intent(out) :: whole
      integer, intent(out) :: exponent
      logical, intent(out) :: sure
      integer(int64) :: bits, lower, width, scale, rest, half, q
      integer :: biased, try, shift

      whole = 0
      sure = .false.
      bits = transfer(value, bits)
      biased = int(shiftr(bits, 52))
      exponent = shifta((biased - 1023)*19728, 16)
      if (biased == 0) return
      do try = 1, 2
         q = digits - 1 - exponent
         if (abs(q) > most_exponent) return
         lower = shiftl(ior(iand(bits, shiftl(1_int64, 52) - 1), shiftl(1_int64, 52)), 9)
         width = 0
         scale = biased - 1023 - 61
         call times_power(lower, width, scale, q)
         shift = int(-scale)
         if (shift < 1 .or. shift > 61) return
         whole = shiftr(lower, shift)
         if (whole < ten(digits)) exit
         exponent = exponent + 1
      end do
      half = shiftl(1_int64, shift - 1)
      rest = iand(lower, 2*half - 1)
      sure = rest + width < half .or. (rest > half .and. rest + width < 3*half)
      if (rest > half) whole = whole + 1
      if (whole < ten(digits)) return
      whole = whole/10
      exponent = exponent + 1
   end subroutine significant_digits

   !> The same by the Fortran library.
   pure subroutine library_digits(value, digits, whole, exponent)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      integer(int64), intent(out) :: whole
      integer, intent(out) :: exponent
      character(40) :: text
      character(12) :: form
      integer :: i, digit

      write (form, "(a, i0, a)") "(es32.", digits - 1, "e4)"
      write (text, form) value
      whole = 0
      do i = 1, index(text, "E") - 1
         digit = iachar(text(i:i)) - 48
         if (digit >= 0 .and. digit <= 9) whole = 10*whole + digit
      end do
      i = index(text, "E")
      read (text(i + 1:i + 5), "(i5)") exponent
   end subroutine library_digits

   !> Places the point, leaves trailing zeros out.
   pure subroutine lay_out(whole, digits, exponent, text, length)
      integer(int64), intent(in) :: whole
      integer, intent(in) :: digits, exponent
      character(*), intent(inout) :: text
      integer, intent(inout) :: length
      character(17) :: digit
      integer(int64) :: rest
      integer :: i, used

      rest = whole
      do i = digits, 1, -1
         digit(i:i) = achar(48 + int(mod(rest, 10_int64)))
         rest = rest/10
      end do
      used = max(1, verify(digit(:digits), "0", back=.true.))
      if (exponent < -4 .or. exponent >= digits) then
         call append(text, length, digit(1:1))
         if (used > 1) call append(text, length, "."//digit(2:used))
         call append(text, length, "e"//merge("-", "+", exponent < 0))
         if (abs(exponent) > 99) call append(text, length, achar(48 + abs(exponent)/100))
         call append(text, length, achar(48 + mod(abs(exponent)/10, 10))//achar(48 + mod(abs(exponent), 10)))
      else if (exponent < 0) then
         call append(text, length, "0."//"000"(:-exponent - 1)//digit(:used))
      else
         call append(text, length, digit(:exponent + 1))
         if (used > exponent + 1) call append(text, length, "."//digit(exponent + 2:used))
      end if
   end subroutine lay_out

   !> Appends to a text.
   pure subroutine append(text, length, more)
      character(*), intent(inout) :: text
      integer, intent(inout) :: length
      character(*), intent(in) :: more

      text(length + 1:length + len(more)) = more
      length = length + len(more)
   end subroutine append

end module gyroakf_io_decimal
