! SPDX-License-Identifier: MIT
!> Numbers as text: correctly rounded, without blanks, the same in every locale.
module gyroakf_io_decimal
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_wide_power, only : int128, power_scale, ten, wide_power
   implicit none (type, external)
   private
   public :: format_real, real_length, real_to_text, shortest_digits, longest_real

   integer(int128), parameter :: low63 = 2_int128**63 - 1
   !> Buffer length for any number, in characters
   integer, parameter :: longest_real = 64

   !> "00" to "99"
   character(200), parameter :: pairs = &
      "00010203040506070809101112131415161718192021222324252627282930313233343536373839"// &
      "40414243444546474849505152535455565758596061626364656667686970717273747576777879"// &
      "8081828384858687888990919293949596979899"

contains

   !> The length of [[format_real]].
   pure integer function real_length(value, digits)
      !> As those of [[format_real]]
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(longest_real) :: buffer

      call real_to_text(value, digits, buffer, real_length)
   end function real_length

   !> A number with so many significant digits, as C's `%.{digits}g`: 0.25, 1e-05; "nan", "-inf".
   pure function format_real(value, digits) result(text)
      real(dp), intent(in) :: value
      !> 1 to 17; 0: as few as read back to the same number, at most 17
      integer, intent(in) :: digits
      character(real_length(value, digits)) :: text
      character(longest_real) :: buffer
      integer :: length

      call real_to_text(value, digits, buffer, length)
      text = buffer(:length)
   end function format_real

   !> As [[format_real]], into a given buffer.
   pure subroutine real_to_text(value, digits, text, length)
      !> As those of [[format_real]]
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      character(longest_real), intent(inout) :: text
      integer, intent(out) :: length
      integer(int64) :: whole
      integer :: exponent, wanted

      if (ieee_is_nan(value)) then
         text(:3) = "nan"
         length = 3
         return
      end if
      length = 0
      if (sign(1.0_dp, value) < 0.0_dp) then
         text(1:1) = "-"
         length = 1
      end if
      if (.not. ieee_is_finite(value)) then
         text(length + 1:length + 3) = "inf"
         length = length + 3
      else if (abs(value) <= 0.0_dp) then
         text(length + 1:length + 1) = "0"
         length = length + 1
      else if (digits > 0) then
         wanted = min(digits, 17)
         call significant_digits(abs(value), wanted, whole, exponent)
         call lay_out(whole*ten(17 - wanted), exponent, wanted, text, length)
      else
         call shortest_digits(abs(value), whole, exponent)
         wanted = count_digits(whole)
         call lay_out(whole*ten(17 - wanted), exponent + wanted - 1, 0, text, length)
      end if
   end subroutine real_to_text

   !> Decimal digits of a positive number below 10^18.
   pure integer function count_digits(whole)
      integer(int64), intent(in) :: whole

      count_digits = shiftr((64 - leadz(whole))*1233, 12)
      if (whole >= ten(count_digits)) count_digits = count_digits + 1
   end function count_digits

   !> whole has the number of digits and whole * 10^(exponent - digits + 1) is next to the value: up
   !> to 15 digits are those of the shortest number that reads back, rounded, except where that is a
   !> tie.
   pure subroutine significant_digits(value, digits, whole, exponent)
      real(dp), intent(in) :: value
      integer, intent(in) :: digits
      integer(int64), intent(out) :: whole
      integer, intent(out) :: exponent
      integer(int64) :: rest
      integer :: excess

      call shortest_digits(value, whole, exponent)
      excess = count_digits(whole) - digits
      exponent = exponent + count_digits(whole) - 1
      rest = 0
      if (excess > 0) rest = mod(whole, ten(excess))
      if (digits > 15 .or. value < tiny(value) .or. (excess > 0 .and. &
         2*rest == ten(max(excess, 0)))) then
         call library_digits(value, digits, whole, exponent)
         return
      end if
      whole = whole*ten(max(-excess, 0))/ten(max(excess, 0))
      if (2*rest > ten(max(excess, 0))) whole = whole + 1
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
      character(32) :: text
      character(12) :: form

      write (form, "(a, i0, a)") "(es32.", digits - 1, "e4)"
      write (text, form) value
      read (text(28:), "(i5)") exponent
      text(26 - digits:) = text(26 - digits:26 - digits)//text(28 - digits:26)
      read (text, *) whole
   end subroutine library_digits

   !> Places the point, leaves trailing zeros out.
   !>
   !> Pieces of constant length are copied, longer than what is used: without a call.
   pure subroutine lay_out(whole, exponent, wanted, text, length)
      integer(int64), intent(in) :: whole
      integer, intent(in) :: exponent, wanted
      character(longest_real), intent(inout) :: text
      integer, intent(inout) :: length
      character(36) :: digit
      integer :: used, most

      call spell(whole, digit, used)
      most = wanted
      if (wanted == 0) most = max(15, used)
      if (exponent < -4 .or. exponent >= most) then
         text(length + 1:length + 1) = digit(1:1)
         text(length + 2:length + 2) = "."
         text(length + 3:length + 18) = digit(2:17)
         length = length + merge(used + 1, 1, used > 1)
         call put_exponent(exponent, text, length)
      else if (exponent < 0) then
         text(length + 1:length + 5) = "0.000"
         length = length + 1 - exponent
         text(length + 1:length + 17) = digit(:17)
         length = length + used
      else
         text(length + 1:length + 17) = digit(:17)
         length = length + exponent + 1
         if (used <= exponent + 1) return
         text(length + 1:length + 1) = "."
         text(length + 2:length + 18) = digit(exponent + 2:exponent + 18)
         length = length + used - exponent
      end if
   end subroutine lay_out

   !> 17 digits as characters, and how many of them are left without the zeros at the end.
   pure subroutine spell(whole, digit, used)
      integer(int64), intent(in) :: whole
      character(36), intent(out) :: digit
      integer, intent(out) :: used
      integer(int64) :: rest
      integer :: i, pair, eight(2)

      digit(18:) = "0000000000000000000"
      eight(2) = int(mod(whole, ten(8)))
      rest = whole/ten(8)
      eight(1) = int(mod(rest, ten(8)))
      digit(1:1) = achar(48 + int(rest/ten(8)))
      do i = 1, 2
         pair = eight(i)/1000000
         digit(8*i - 6:8*i - 5) = pairs(2*pair + 1:2*pair + 2)
         pair = mod(eight(i)/10000, 100)
         digit(8*i - 4:8*i - 3) = pairs(2*pair + 1:2*pair + 2)
         pair = mod(eight(i)/100, 100)
         digit(8*i - 2:8*i - 1) = pairs(2*pair + 1:2*pair + 2)
         pair = mod(eight(i), 100)
         digit(8*i:8*i + 1) = pairs(2*pair + 1:2*pair + 2)
      end do
      used = merge(9, 17, eight(2) == 0)
      do while (digit(used:used) == "0" .and. used > 1)
         used = used - 1
      end do
   end subroutine spell

   !> "e-05"
   pure subroutine put_exponent(exponent, text, length)
      integer, intent(in) :: exponent
      character(longest_real), intent(inout) :: text
      integer, intent(inout) :: length
      integer :: size

      size = abs(exponent)
      text(length + 1:length + 2) = "e"//merge("-", "+", exponent < 0)
      length = length + 2
      if (size > 99) then
         text(length + 1:length + 1) = achar(48 + size/100)
         length = length + 1
      end if
      size = mod(size, 100)
      text(length + 1:length + 2) = pairs(2*size + 1:2*size + 2)
      length = length + 2
   end subroutine put_exponent

   !> The shortest decimal number that reads back as a double, the nearest among those.
   !>
   !> The numbers that read back as v = c 2^q lie within half a step of it (and on the ends where c
   !> is even). With k = floor(log10 of the step) that interval holds at least one multiple of 10^k
   !> and at most one of 10^(k+1): the latter is taken where there is one, else the nearer of the
   !> two multiples of 10^k around v. All comparisons are between numbers that are rounded to odd,
   !> four times the value, from the first 126 bits of 10^-k, which decides every case exactly (R.
   !> Giulietti, The Schubfach way to render doubles, 2020).
   !>
   !> The number is whole * 10^exponent; trailing zeros are not taken out.
   pure subroutine shortest_digits(value, whole, exponent)
      real(dp), intent(in) :: value
      !> 1 to 17 digits
      integer(int64), intent(out) :: whole
      !> Of ten
      integer, intent(out) :: exponent
      integer(int64) :: c, below, at, above, s, t
      integer(int128) :: power
      integer :: q, h, odd
      logical :: narrow, lower_in, upper_in

      call take_apart(value, c, q, narrow)
      odd = int(iand(c, 1_int64))
      exponent = shifta(q*1262611 - merge(524031, 0, narrow), 22)
      h = q + power_scale(-exponent) + 127
      call wide_power(-exponent, power)
      power = power + 1
      at = round_to_odd(power, shiftl(4*c, h))
      below = round_to_odd(power, shiftl(4*c - merge(1, 2, narrow), h))
      above = round_to_odd(power, shiftl(4*c + 2, h))
      s = shiftr(at, 2)
      if (s >= 10) then
         t = s/10
         lower_in = below + odd <= 40*t
         upper_in = 40*(t + 1) + odd <= above
         if (lower_in .neqv. upper_in) then
            whole = merge(t, t + 1, lower_in)
            exponent = exponent + 1
            return
         end if
      end if
      lower_in = below + odd <= 4*s
      upper_in = 4*(s + 1) + odd <= above
      if (lower_in .neqv. upper_in) then
         whole = merge(s, s + 1, lower_in)
      else
         at = at - (4*s + 2)
         whole = merge(s, s + 1, at < 0 .or. (at == 0 .and. iand(s, 1_int64) == 0))
      end if
   end subroutine shortest_digits

   !> value = c * 2^q; narrow where the next smaller double is only half a step away.
   pure subroutine take_apart(value, c, q, narrow)
      real(dp), intent(in) :: value
      integer(int64), intent(out) :: c
      integer, intent(out) :: q
      logical, intent(out) :: narrow
      integer(int64) :: bits

      bits = transfer(value, bits)
      q = int(shiftr(bits, 52))
      c = iand(bits, shiftl(1_int64, 52) - 1)
      narrow = c == 0 .and. q > 1
      if (q > 0) c = c + shiftl(1_int64, 52)
      q = max(q, 1) - 1075
   end subroutine take_apart

   !> power * factor / 2^127, rounded to odd: a fraction makes the last bit 1.
   pure integer(int64) function round_to_odd(power, factor)
      integer(int128), intent(in) :: power
      integer(int64), intent(in) :: factor
      integer(int128) :: sum

      sum = shiftr(shiftr(power, 63)*factor, 1) + shiftr(iand(power, low63)*factor, 64)
      round_to_odd = int(shiftr(sum, 63), int64)
      if (iand(sum, low63) /= 0) round_to_odd = ior(round_to_odd, 1_int64)
   end function round_to_odd

end module gyroakf_io_decimal
