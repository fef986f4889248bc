! SPDX-License-Identifier: MIT
!> Decimal numbers in text, read correctly rounded (to nearest, ties to even), always, and whatever the locale is.
!>
!> A number m * 10^q takes the first of three paths that is sure of its result:
!>
!> 1. m <= 2^53 and |q| <= 22: one multiplication or division of two exact numbers
!>    (W. D. Clinger, How to read floating point numbers accurately, 1990);
!> 2. m * 10^q bounded from below and above in 62-bit integers ([[gyroakf_io_power]]); where both bounds round to the
!>    same number, that is the number;
!> 3. the C library's `strtod_l` with the C locale: ties, subnormals, very many digits.
module gyroakf_io_number
   use, intrinsic :: iso_c_binding, only : c_char, c_double, c_int, c_null_char, c_null_ptr, c_ptr
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use, intrinsic :: ieee_exceptions, only : ieee_flag_type, ieee_get_flag, ieee_get_halting_mode, ieee_overflow, ieee_set_flag, &
      ieee_set_halting_mode, ieee_underflow
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_power, only : most_exponent, times_power
   use gyroakf_io_wide_power, only : ten
   implicit none (type, external)
   private
   public :: scan_number, skip_digits, parse_number, is_missing_word, is_missing_field, number, digits_ahead

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

   !> So many bytes after the last one of the text have to be addressable
   integer, parameter :: digits_ahead = 8

   !> A decimal number in parts: its value lies between mantissa and mantissa + excess, times 10^exponent
   type :: decimal_type
      integer(int64) :: mantissa, excess, exponent
      !> 1 for a minus sign, else 0
      integer(int64) :: minus
   end type decimal_type

   real(dp), parameter :: exact_ten(0:22) = [ &
      1.0e0_dp, 1.0e1_dp, 1.0e2_dp, 1.0e3_dp, 1.0e4_dp, 1.0e5_dp, 1.0e6_dp, 1.0e7_dp, &
      1.0e8_dp, 1.0e9_dp, 1.0e10_dp, 1.0e11_dp, 1.0e12_dp, 1.0e13_dp, 1.0e14_dp, 1.0e15_dp, &
      1.0e16_dp, 1.0e17_dp, 1.0e18_dp, 1.0e19_dp, 1.0e20_dp, 1.0e21_dp, 1.0e22_dp]
   !> 10*m + 9 does not overflow up to here
   integer(int64), parameter :: mantissa_limit = 922337203685477579_int64

   integer(int64), parameter :: nibbles = int(z'0F0F0F0F0F0F0F0F', int64), zeros = int(z'3030303030303030', int64)
   integer(int64), parameter :: sixes = int(z'0606060606060606', int64), bytes_even = int(z'00FF00FF00FF00FF', int64)
   integer(int64), parameter :: words_even = int(z'0000FFFF0000FFFF', int64), low32 = 2_int64**32 - 1
   !> The largest number before which n more digits do not overflow
   integer(int64), parameter :: most_before(0:7) = [9223372036854775806_int64, 922337203685477579_int64, &
      92233720368547757_int64, 9223372036854774_int64, 922337203685476_int64, 92233720368546_int64, 9223372036853_int64, &
      922337203684_int64]
   logical, parameter :: little_endian = transfer([1_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8], 0_int64) == 1

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
   !>
   !> Whether what follows may follow is the caller's business. Thread-safe; no allocation but for a number of more than
   !> 120 characters. What most numbers look like is taken eight digits at a time; the rest goes to [[scan_any]].
   pure subroutine scan_number(bytes, at, value, found)
      !> The text; [[digits_ahead]] more bytes than the text, the first of them no digit
      integer(int8), intent(in), contiguous :: bytes(:)
      !> First byte of the number; afterwards the byte after it, unchanged where there is no number
      integer(int64), intent(inout) :: at
      !> The number; 0 where there is none, +-huge on overflow
      real(dp), intent(out) :: value
      !> One of the components of [[number]]
      integer, intent(out) :: found
      integer(int64) :: p, m, word, minus, q, tail
      integer :: n, letter
      logical :: usual

      call skip_sign(bytes(at), p, minus, at)
      word = transfer(bytes(p:p + 7), word)
      n = count_digits(word)
      m = eight_digits(shiftl(word, min(63, 64 - 8*n)))                ! a shift by 63 leaves no digit
      usual = little_endian .and. n > 0 .and. n < 8
      letter = int(iand(shiftr(word, 8*iand(n, 7)), 255_int64))
      p = p + n
      q = 0
      tail = -1
      if (letter == 46 .and. usual) then
         p = p + 1
         word = transfer(bytes(p:p + 7), word)
         n = count_digits(word)
         if (n == 8) call take_eight(bytes, p, m, q, word, n)
         if (n == 8 .and. m < 10000000000_int64) call take_eight(bytes, p, m, q, word, n)
         usual = n < 8
         if (usual .and. n > 0) then
            tail = eight_digits(shiftl(word, 64 - 8*n))
            p = p + n
            q = q - n
            if (m <= most_before(n)) then
               m = m*ten(n) + tail
               tail = -1
            else
               usual = n == 2 .and. m < 368934881474191032_int64
            end if
         end if
         letter = int(iand(shiftr(word, 8*iand(n, 7)), 255_int64))
      end if
      if (usual .and. (ior(letter, 32) == 101 .or. ior(letter, 32) == 100)) call take_exponent(bytes, p, q, usual)
      if (usual) call finish(m, tail, q, value, usual)
      if (.not. usual) then
         call scan_any(bytes, at, value, found)
         return
      end if
      found = number%ok
      value = transfer(ieor(transfer(value, m), shiftl(minus, 63)), value)
      at = p
   end subroutine scan_number

   !> Appends the eight digits of a word that was read at p, and reads the next word.
   pure subroutine take_eight(bytes, p, m, q, word, n)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, m, q, word
      integer, intent(out) :: n

      m = m*100000000_int64 + eight_digits(word)
      q = q - 8
      p = p + 8
      word = transfer(bytes(p:p + 7), word)
      n = count_digits(word)
   end subroutine take_eight

   !> Adds the exponent whose letter is at p to q; not usual where its digits are none or more than four.
   pure subroutine take_exponent(bytes, p, q, usual)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, q
      logical, intent(out) :: usual
      integer(int64) :: first, minus, exponent
      integer :: digit

      call skip_sign(bytes(p + 1), first, minus, p + 1)
      exponent = 0
      do p = first, first + 4
         digit = bytes(p) - 48
         if (digit < 0 .or. digit > 9) exit
         exponent = 10*exponent + digit
      end do
      usual = p > first .and. p < first + 5
      q = q + merge(-exponent, exponent, minus == 1)
   end subroutine take_exponent

   !> m * 10^q, or (100 m + tail) * 10^q where the tail is not negative; the paths 1 and 2, not sure where 3 is needed.
   pure subroutine finish(m, tail, q, value, sure)
      integer(int64), intent(in) :: m, tail, q
      real(dp), intent(out) :: value
      logical, intent(out) :: sure

      sure = .true.
      if (tail >= 0) then
         call round_decimal(decimal_type(25*m + tail/4, min(mod(tail, 4_int64), 1_int64), q, 0_int64), 2_int64, value, sure)
      else if (m <= 2_int64**53 .and. q <= 0 .and. q >= -22) then
         value = real(m, dp)/exact_ten(-q)
      else if (m <= 2_int64**53 .and. q > 0 .and. q <= 22) then
         value = real(m, dp)*exact_ten(q)
      else if (m > 0) then
         call round_decimal(decimal_type(m, 0_int64, q, 0_int64), 0_int64, value, sure)
      else
         value = 0.0_dp
      end if
   end subroutine finish

   !> The same for a number of any form.
   pure subroutine scan_any(bytes, at, value, found)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: at
      real(dp), intent(out) :: value
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
      if (decimal%excess == 0 .and. decimal%mantissa <= 2_int64**53 .and. abs(decimal%exponent) <= 22) then
         value = real(decimal%mantissa, dp)
         if (decimal%exponent < 0) value = value/exact_ten(-decimal%exponent)
         if (decimal%exponent > 0) value = value*exact_ten(decimal%exponent)
      else if (decimal%mantissa > 0) then
         call round_decimal(decimal, 0_int64, value, sure)
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
      integer(int64) :: p, first, m, q, eight
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
         do while (little_endian .and. m < 10000000000_int64)
            eight = transfer(bytes(p:p + 7), eight)
            if (count_digits(eight) < 8) exit
            m = m*100000000_int64 + eight_digits(eight)
            q = q - 8
            p = p + 8
         end do
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

   !> So many of the eight bytes, from the first on, are digits (no lane overflows into the next).
   pure integer function count_digits(word)
      integer(int64), intent(in) :: word
      integer(int64) :: other

      other = ieor(word, zeros)
      other = ior(iand(other, not(nibbles)), iand(iand(other, nibbles) + sixes, not(nibbles)))
      count_digits = shiftr(trailz(other), 3)
   end function count_digits

   !> Moves behind digits, eight at a time.
   pure subroutine skip_digits(bytes, at)
      !> The text; [[digits_ahead]] more bytes than the text, the first of them no digit
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Any byte; afterwards the next that is no digit
      integer(int64), intent(inout) :: at
      integer(int64) :: word
      integer :: n

      n = 8
      do while (n == 8 .and. little_endian)
         word = transfer(bytes(at:at + 7), word)
         n = count_digits(word)
         at = at + n
      end do
   end subroutine skip_digits

   !> The number that eight digits are; bytes of zero count as digits.
   pure integer(int64) function eight_digits(word)
      integer(int64), intent(in) :: word
      integer(int64) :: w

      w = iand(word, nibbles)
      w = iand(w*10 + shiftr(w, 8), bytes_even)
      w = iand(w*100 + shiftr(w, 16), words_even)
      eight_digits = iand(w*10000 + shiftr(w, 32), low32)
   end function eight_digits

   !> Path 2. The number is between lower and lower + width, times 2^scale, all the way; not sure where these round differently.
   pure subroutine round_decimal(decimal, twos, value, sure)
      type(decimal_type), intent(in) :: decimal
      !> The number is to be multiplied by 2^twos
      integer(int64), intent(in) :: twos
      real(dp), intent(out) :: value
      logical, intent(out) :: sure
      integer(int64) :: lower, width, scale, rest, biased
      integer :: shift

      value = 0.0_dp
      sure = .false.
      if (abs(decimal%exponent) > most_exponent) return
      shift = leadz(decimal%mantissa) - 2
      lower = shiftl(decimal%mantissa, max(shift, 0))
      width = shiftl(decimal%excess, max(shift, 0))
      if (shift < 0) then
         lower = shiftr(lower, 1)
         width = width + 1
      end if
      scale = twos - shift
      call times_power(lower, width, scale, decimal%exponent)
      rest = iand(lower, 511_int64)
      sure = rest + width < 256 .or. (rest > 256 .and. rest + width < 768)
      biased = scale + 9 + 52 + 1023
      if (biased < 1 .or. biased > 2045) sure = .false.
      if (.not. sure) return
      lower = shiftr(lower, 9)
      if (rest > 256) lower = lower + 1
      value = transfer(shiftl(biased - 1, 52) + lower, value)
   end subroutine round_decimal

   !> Path 3, infinite on overflow; a host that traps overflow or underflow is not disturbed.
   pure subroutine library_value(bytes, value)
      integer(int8), intent(in) :: bytes(:)
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
