! SPDX-License-Identifier: MIT
!> Usual decimal numbers, correctly rounded or not at all: the first paths of [[gyroakf_io_number]].
!>
!> Usual are `[+-] [digits] [. digits] [e|E|d|D [+-] digits]` with up to 15 digits before the point,
!> no more digits than an integer of 64 bits without a sign holds, fewer than 24 behind the point,
!> and an exponent of 1 to 3 digits. Digits are taken eight at a time (as bytes of a word); nothing
!> is allocated, and no branch depends on a sign or on the value of a digit.
module gyroakf_io_quick_number
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_wide_power, only : int128, power, ten
   implicit none (type, external)
   private
   public :: quick_type, quick_number, skip_digits, digits_ahead

   !> A number and where it ends: two words, which a function hands back in registers
   type :: quick_type
      !> The byte after the number; 0 where it is not usual, or not sure to be rounded correctly
      integer(int64) :: next
      real(dp) :: value
   end type quick_type

   !> So many bytes after the last one of the text have to be addressable
   integer, parameter :: digits_ahead = 8

   integer :: i

   !> The powers of ten that are doubles
   real(dp), parameter :: exact_ten(0:22) = [(10.0_dp**i, i=0, 22)]

   !> Bytes of words: the lower and the upper half, "0", 6, ".", six bits and the one above them
   integer(int64), parameter :: nibbles = int(z'0F0F0F0F0F0F0F0F', int64), &
      upper = int(z'F0F0F0F0F0F0F0F0', int64)
   integer(int64), parameter :: zeros = int(z'3030303030303030', int64), &
      sixes = int(z'0606060606060606', int64)
   integer(int64), parameter :: points = int(z'2E2E2E2E2E2E2E2E', int64)
   integer(int64), parameter :: six_bits = int(z'3F3F3F3F3F3F3F3F', int64), &
      above = int(z'4040404040404040', int64)
   integer(int64), parameter :: bytes_even = int(z'00FF00FF00FF00FF', int64), &
      words_even = int(z'0000FFFF0000FFFF', int64)
   integer(int64), parameter :: low32 = 2_int64**32 - 1
   logical, parameter :: little_endian = &
      transfer([1_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8, 0_int8], 0_int64) == 1

   !> The largest number before which eight more digits do not overflow
   integer(int64), parameter :: most_before_eight = 92233720367_int64
   !> With n digits more a number stays in 2^53 up to here
   integer(int64), parameter :: exact_before(0:7) = [9007199254740992_int64, &
      900719925474098_int64, &
      90071992547408_int64, 9007199254739_int64, 900719925473_int64, 90071992546_int64, &
      9007199253_int64, 900719924_int64]
   !> 10^n as half(n) * 2^twos(n), and the largest number of which half(n) times it, and half of n
   !> digits more, does not overflow
   integer, parameter :: twos(0:7) = [0, (1, i=1, 7)]
   integer(int64), parameter :: half(0:7) = [(ten(i)/2**twos(i), i=0, 7)]
   integer(int64), parameter :: most_before(0:7) = [9223372036854775807_int64, &
      1844674407370955160_int64, 184467440737095515_int64, 18446744073709550_int64, &
      1844674407370954_int64, 184467440737094_int64, 18446744073708_int64, 1844674407369_int64]

contains

   !> The number that begins at a byte. What follows it is the caller's business.
   pure function quick_number(bytes, at) result(quick)
      !> The text and `digits_ahead` more bytes, the first of them no digit
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in), value :: at
      !> Its `next` is 0 where another way has to be taken
      type(quick_type) :: quick
      integer(int64) :: m, p, q, word, tail, minus
      integer :: n
      real(dp) :: value

      quick%next = 0
      quick%value = 0.0_dp
      if (.not. little_endian) return
      call take_whole(bytes, at, p, m, minus)
      if (p == 0) return
      q = 0
      n = 0
      tail = 0
      if (bytes(p) == 46) then
         p = p + 1
         word = ieor(transfer(bytes(p:p + 7), word), zeros)
         if (no_digits(word) == 0) call take_eight(bytes, p, m, q, word)
         if (no_digits(word) == 0) call take_eight(bytes, p, m, q, word)
         if (no_digits(word) == 0) return
         if (iand(no_digits(word), 255_int64) == 0) then
            n = shiftr(trailz(no_digits(word)), 3)
            tail = eight_digits(shiftl(word, 64 - 8*n))
            p = p + n
            q = q - n
         end if
      end if
      if (iand(ieor(int(bytes(p)), 69), 222) == 0) call take_exponent(bytes, p, q)
      if (p == 0 .or. m > most_before(n)) return
      if (m <= exact_before(n) .and. abs(q) <= 22) then
         value = real(m*ten(n) + tail, dp)
         if (q <= 0) value = value/exact_ten(-q)
         if (q > 0) value = value*exact_ten(q)
      else
         value = rounded(m*half(n) + shiftr(tail, twos(n)), iand(tail, int(twos(n), int64)), q, &
            twos(n))
         if (value < 0.0_dp) return
      end if
      quick%value = transfer(ieor(transfer(value, m), shiftl(minus, 63)), value)
      quick%next = p
   end function quick_number

   !> Takes the sign and the digits before the point, or all digits where there is none.
   pure subroutine take_whole(bytes, at, p, m, minus)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at
      integer(int64), intent(out) :: p, m, minus
      integer(int64) :: word
      integer :: sign_bits, signed, point

      word = transfer(bytes(at:at + 7), word)
      point = shiftr(trailz(iand(above - iand(ieor(word, points), six_bits), above)), 3)
      sign_bits = int(iand(word, 255_int64)) - 43
      signed = shiftr(iand(sign_bits, 253) - 1, 31)
      minus = iand(shiftr(sign_bits, 1), signed)
      p = at + point
      if (bytes(p) == 46 .and. point == signed + 1) then
         m = bytes(p - 1) - 48
         if (m < 0 .or. m > 9) p = 0
         return
      else if (bytes(p) == 46 .and. point == signed) then
         m = 0
         if (bytes(p + 1) < 48 .or. bytes(p + 1) > 57) p = 0
         return
      else if (bytes(p) == 46 .and. point > signed .and. point < 8) then
         word = shiftl(iand(ieor(word, zeros), not(iand(255_int64, -int(signed, int64)))), &
            64 - 8*point)
         if (no_digits(word) == 0) then
            m = eight_digits(word)
            return
         end if
      end if
      call take_integer(bytes, at + signed, p, m)
   end subroutine take_whole

   !> Takes up to 15 digits that begin at a byte; p is 0 where there are none, or more.
   pure subroutine take_integer(bytes, first, p, m)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first
      integer(int64), intent(out) :: p, m
      integer(int64) :: word
      integer :: n

      p = first
      m = 0
      word = ieor(transfer(bytes(p:p + 7), word), zeros)
      if (no_digits(word) == 0) then
         m = eight_digits(word)
         p = p + 8
         word = ieor(transfer(bytes(p:p + 7), word), zeros)
      end if
      n = shiftr(trailz(no_digits(word)), 3)
      if (n > 0 .and. n < 8) m = m*ten(n) + eight_digits(shiftl(word, 64 - 8*n))
      p = p + n
      if (n == 8 .or. p == first) p = 0
   end subroutine take_integer

   !> Appends the eight digits read at p, and reads the next word; not where m would overflow.
   pure subroutine take_eight(bytes, p, m, q, word)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, m, q, word

      if (m > most_before_eight) return
      m = m*100000000_int64 + eight_digits(word)
      q = q - 8
      p = p + 8
      word = ieor(transfer(bytes(p:p + 7), word), zeros)
   end subroutine take_eight

   !> Adds an exponent, whose letter is at p, to q; p is 0 where it has not 1 to 3 digits.
   pure subroutine take_exponent(bytes, p, q)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, q
      integer :: sign_bits, tens, ones, behind
      logical :: usual

      sign_bits = bytes(p + 1) - 43
      tens = bytes(p + 2) - 48
      ones = bytes(p + 3) - 48
      behind = bytes(p + 4) - 48
      usual = iand(sign_bits, 253) == 0 .and. tens >= 0 .and. tens <= 9 .and. ones >= 0 .and. &
         ones <= 9
      if (behind >= 0 .and. behind <= 9) usual = .false.
      if (usual) then
         p = p + 4
         q = q + (10*tens + ones)*(1 - sign_bits)
      else
         call take_any_exponent(bytes, p, q)
      end if
   end subroutine take_exponent

   pure subroutine take_any_exponent(bytes, p, q)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: p, q
      integer(int64) :: first, last, exponent
      logical :: minus

      minus = bytes(p + 1) == 45
      first = p + 1
      if (minus .or. bytes(first) == 43) first = first + 1
      exponent = 0
      do last = first, first + 3
         if (bytes(last) < 48 .or. bytes(last) > 57) exit
         exponent = 10*exponent + bytes(last) - 48
      end do
      p = merge(last, 0_int64, last > first .and. last <= first + 3)
      q = q + merge(-exponent, exponent, minus)
   end subroutine take_any_exponent

   !> (2^twos * m + odd) * 10^q to nearest; -1 where 63 bits of 10^q do not tell, and for zero.
   !>
   !> The product of `top`, m shifted to 63 bits, and the truncated power falls short of the true
   !> one by less than 3 in its upper half: where all numbers between them round to the same, that
   !> is the result.
   pure real(dp) function rounded(m, odd, q, twos) result(value)
      integer(int64), intent(in), value :: m, odd, q
      integer, intent(in), value :: twos
      integer(int64) :: top, rest, biased
      integer :: shift, drop

      value = -1.0_dp
      if (q < -306 .or. q > 288 .or. m == 0) return
      shift = leadz(m) - 1
      top = ior(shiftl(m, shift), shiftr(shiftl(odd, shift), 1))
      top = int(shiftr(int(top, int128)*int(power(q), int128), 63), int64)
      drop = 11 - leadz(top)
      top = top + shiftl(1_int64, drop - 1)
      rest = iand(top, shiftl(1_int64, drop) - 1)
      if (rest == 0 .or. rest + 3 >= shiftl(1_int64, drop)) return
      biased = drop - shift + twos + shifta(217706*q, 16) + 1 + 52 + 1023
      value = transfer(shiftl(biased - 1, 52) + shiftr(top, drop), value)
   end function rounded

   !> Not 0 in the bytes of a word, from which those of "0" were taken, that were no digits.
   pure integer(int64) function no_digits(word)
      integer(int64), intent(in), value :: word

      no_digits = ior(iand(word, upper), iand(iand(word, nibbles) + sixes, upper))
   end function no_digits

   !> The number that eight bytes of 0 to 9 are, the first of them the lowest.
   pure integer(int64) function eight_digits(word)
      integer(int64), intent(in), value :: word

      eight_digits = iand(word*10 + shiftr(word, 8), bytes_even)
      eight_digits = iand(eight_digits*100 + shiftr(eight_digits, 16), words_even)
      eight_digits = iand(eight_digits*10000 + shiftr(eight_digits, 32), low32)
   end function eight_digits

   !> Moves behind digits, eight at a time.
   pure subroutine skip_digits(bytes, at)
      !> The text and `digits_ahead` more bytes, the first of them no digit
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Any byte; afterwards the next that is no digit
      integer(int64), intent(inout) :: at
      integer(int64) :: word
      integer :: n

      n = 8
      do while (n == 8 .and. little_endian)
         word = ieor(transfer(bytes(at:at + 7), word), zeros)
         n = shiftr(trailz(no_digits(word)), 3)
         at = at + n
      end do
   end subroutine skip_digits

end module gyroakf_io_quick_number
