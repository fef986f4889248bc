! SPDX-License-Identifier: MIT
!> The shortest decimal number that reads back as a given double, and among those the nearest to it.
!>
!> The numbers that read back as v = c 2^q lie within half a step of it (and on the ends where c is even). With
!> k = floor(log10 of the step) that interval holds at least one multiple of 10^k and at most one of 10^(k+1): the latter is
!> taken where there is one, else the nearer of the two multiples of 10^k around v. All comparisons are between numbers
!> that are rounded to odd, four times the value, from the first 126 bits of 10^-k, which decides every case exactly
!> (R. Giulietti, The Schubfach way to render doubles, 2020).
module gyroakf_io_shortest
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_wide_power, only : int128, power_scale, wide_power
   implicit none (type, external)
   private
   public :: shortest_digits

   integer(int128), parameter :: low63 = 2_int128**63 - 1

contains

   !> whole * 10^exponent, without the trailing zeros being taken out.
   pure subroutine shortest_digits(value, whole, exponent)
      !> Positive and finite
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
      !> In [2^125, 2^126]
      integer(int128), intent(in) :: power
      !> Below 2^62
      integer(int64), intent(in) :: factor
      integer(int128) :: sum

      sum = shiftr(shiftr(power, 63)*factor, 1) + shiftr(iand(power, low63)*factor, 64)
      round_to_odd = int(shiftr(sum, 63), int64)
      if (iand(sum, low63) /= 0) round_to_odd = ior(round_to_odd, 1_int64)
   end function round_to_odd

end module gyroakf_io_shortest
