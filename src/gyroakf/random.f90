! SPDX-License-Identifier: MIT
!> The library's own random numbers: the same seed gives the same numbers on every machine.
!>
!> Bits come from xoshiro256** (D. Blackman, S. Vigna, Scrambled linear pseudorandom number
!> generators, ACM Trans. Math. Softw. 47 (2021) 36), its state from the seed by splitmix64 (G.
!> Steele, D. Lea, C. Flood, Fast splittable pseudorandom number generators, OOPSLA 2014). All
!> arithmetic modulo 2**64 is written without signed overflow, and normal variates use only
!> operations that IEEE 754 defines to the last bit: no number depends on compiler, options or
!> mathematical library (where multiplications and additions are not fused: -ffp-contract=off).
!>
!>     call seed_random(random, seed=1_int64, stream=2)
!>     call fill_normal(random, x)
module gyroakf_random
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: random_type, seed_random, next_bits, next_uniform, next_normal, next_laplace, &
      & next_t5, fill_normal

   !> A generator; copying it copies the sequence
   type :: random_type
      !> xoshiro256** state, not all zero
      integer(int64) :: state(4) = [1_int64, 2_int64, 3_int64, 4_int64]
      !> The second normal variate of the last pair, if `has_spare`
      real(dp) :: spare = 0
      !> A variate is kept
      logical :: has_spare = .false.
   end type random_type

   integer(int64), parameter :: low_half = int(z'ffffffff', int64)

contains

   !> Starts a generator. Stream k begins k*2**128 draws after stream 0: they never overlap.
   pure subroutine seed_random(random, seed, stream)
      !> The generator
      type(random_type), intent(out) :: random
      !> Any number; every seed gives another sequence
      integer(int64), intent(in) :: seed
      !> Number of the stream, 0 .. a few dozens (each costs one jump); 0 if absent
      integer, intent(in), optional :: stream
      integer(int64) :: counter
      integer :: i

      counter = seed
      do i = 1, 4
         call split_mix(counter, random%state(i))
      end do
      if (present(stream)) then
         do i = 1, stream
            call jump(random)
         end do
      end if
   end subroutine seed_random

   !> The next 64 random bits.
   pure subroutine next_bits(random, bits)
      !> The generator
      type(random_type), intent(inout) :: random
      !> All 64 bits are random, the sign too
      integer(int64), intent(out) :: bits
      integer(int64) :: rolled, shifted

      associate (s => random%state)
         rolled = ishftc(add_64(s(2), shiftl(s(2), 2)), 7)
         bits = add_64(rolled, shiftl(rolled, 3))
         shifted = shiftl(s(2), 17)
         s(3) = ieor(s(3), s(1))
         s(4) = ieor(s(4), s(2))
         s(2) = ieor(s(2), s(3))
         s(1) = ieor(s(1), s(4))
         s(3) = ieor(s(3), shifted)
         s(4) = ishftc(s(4), 45)
      end associate
   end subroutine next_bits

   !> A variate uniform on the multiples of 2**-53 strictly between 0 and 1.
   pure subroutine next_uniform(random, u)
      !> The generator
      type(random_type), intent(inout) :: random
      !> 0 < u < 1, mean exactly 1/2
      real(dp), intent(out) :: u
      integer(int64) :: bits

      do
         call next_bits(random, bits)
         bits = shiftr(bits, 11)
         if (bits /= 0) exit
      end do
      u = real(bits, dp)*2.0_dp**(-53)
   end subroutine next_uniform

   !> A standard normal variate by the polar method, exact up to rounding.
   !>
   !> A point (a, b) uniform in the unit disc, s = a^2 + b^2, gives the two independent variates
   !> $$ a\sqrt{-2\ln s/s}, \quad b\sqrt{-2\ln s/s}; $$
   !> the second is kept for the next call. Source: G. Marsaglia, T. Bray, SIAM Rev. 6 (1964) 260.
   pure subroutine next_normal(random, g)
      !> The generator
      type(random_type), intent(inout) :: random
      !> Mean 0, variance 1
      real(dp), intent(out) :: g
      real(dp) :: a, b, s, factor

      if (random%has_spare) then
         g = random%spare
         random%has_spare = .false.
         return
      end if
      do
         call next_uniform(random, a)
         call next_uniform(random, b)
         a = 2*a - 1
         b = 2*b - 1
         s = a*a + b*b
         if (s < 1 .and. s > 0) exit
      end do
      factor = sqrt(-2*portable_log(s)/s)
      g = a*factor
      random%spare = b*factor
      random%has_spare = .true.
   end subroutine next_normal

   !> A Laplace variate: the difference of two exponential ones.
   pure subroutine next_laplace(random, g)
      !> The generator
      type(random_type), intent(inout) :: random
      !> Mean 0, variance 1, excess kurtosis 3
      real(dp), intent(out) :: g
      real(dp) :: u, v

      call next_uniform(random, u)
      call next_uniform(random, v)
      g = sqrt(0.5_dp)*(portable_log(u) - portable_log(v))
   end subroutine next_laplace

   !> A variate of Student's t distribution with 5 degrees of freedom, scaled to the variance 1.
   pure subroutine next_t5(random, g)
      !> The generator
      type(random_type), intent(inout) :: random
      !> Mean 0, variance 1, excess kurtosis 6
      real(dp), intent(out) :: g
      real(dp) :: normal(6)

      call fill_normal(random, normal)
      g = normal(6)*sqrt(3.0_dp/sum(normal(:5)**2))
   end subroutine next_t5

   !> Standard normal variates, the same that as many calls of [[next_normal]] give.
   pure subroutine fill_normal(random, g)
      !> The generator
      type(random_type), intent(inout) :: random
      !> The variates: [n]
      real(dp), intent(out), contiguous :: g(:)
      integer(int64) :: i

      do i = 1, size(g, kind=int64)
         call next_normal(random, g(i))
      end do
   end subroutine fill_normal

   !> Natural logarithm of x in (0, 1) by basic operations only, right to a few units of the last
   !> place:
   !> $$ \ln x = e \ln 2 + 2\,\mathrm{artanh}\frac{f-1}{f+1}, \quad
   !>    x = 2^e f,\ \sqrt{1/2} \le f < \sqrt 2 $$
   elemental real(dp) function portable_log(x)
      real(dp), intent(in) :: x
      ! 32 bits, so that e*ln_2_high is exact
      real(dp), parameter :: ln_2_high = 6.93147180369123816490e-01_dp
      real(dp), parameter :: ln_2_low = 1.90821492927058770002e-10_dp
      real(dp) :: f, t, t2, series
      integer :: e, k

      e = exponent(x)
      f = fraction(x)
      if (f < 0.70710678118654752440_dp) then
         f = 2*f
         e = e - 1
      end if
      t = (f - 1)/(f + 1)
      t2 = t*t
      ! |t| <= 0.1716: the first term left out, t**24/25, is below 1e-19
      series = 0
      do k = 23, 3, -2
         series = t2*(1.0_dp/k + series)
      end do
      portable_log = e*ln_2_high + (e*ln_2_low + 2*(t + t*series))
   end function portable_log

   !> Advances by 2**128 draws.
   pure subroutine jump(random)
      type(random_type), intent(inout) :: random
      ! the polynomial of Blackman and Vigna, the low half of each word first
      integer(int64), parameter :: polynomial(8) = [int(z'3cfd0aba', int64), &
         int(z'180ec6d3', int64), int(z'f0c9392c', int64), int(z'd5a61266', int64), &
         int(z'e03fc9aa', int64), int(z'a9582618', int64), int(z'29b1661c', int64), &
         int(z'39abdc45', int64)]
      integer(int64) :: total(4), ignored
      integer :: i, bit

      total(:) = 0
      do i = 1, size(polynomial)
         do bit = 0, 31
            if (btest(polynomial(i), bit)) total(:) = ieor(total, random%state)
            call next_bits(random, ignored)
         end do
      end do
      random%state(:) = total
   end subroutine jump

   !> splitmix64: a counter, and the next 64 bits mixed from it.
   pure subroutine split_mix(counter, bits)
      integer(int64), intent(inout) :: counter
      integer(int64), intent(out) :: bits

      counter = add_64(counter, word(int(z'9e3779b9', int64), int(z'7f4a7c15', int64)))
      bits = ieor(counter, shiftr(counter, 30))
      bits = multiply_64(bits, word(int(z'bf58476d', int64), int(z'1ce4e5b9', int64)))
      bits = ieor(bits, shiftr(bits, 27))
      bits = multiply_64(bits, word(int(z'94d049bb', int64), int(z'133111eb', int64)))
      bits = ieor(bits, shiftr(bits, 31))
   end subroutine split_mix

   !> 64 bits from two halves of 32
   elemental integer(int64) function word(high, low)
      integer(int64), intent(in) :: high, low

      word = ior(shiftl(high, 32), low)
   end function word

   !> a + b modulo 2**64
   elemental integer(int64) function add_64(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: low

      low = iand(a, low_half) + iand(b, low_half)
      add_64 = word(shiftr(a, 32) + shiftr(b, 32) + shiftr(low, 32), iand(low, low_half))
   end function add_64

   !> a b modulo 2**64
   elemental integer(int64) function multiply_64(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: cross

      cross = add_64(multiply_32(shiftr(a, 32), iand(b, low_half)), &
         multiply_32(iand(a, low_half), shiftr(b, 32)))
      multiply_64 = add_64(multiply_32(iand(a, low_half), iand(b, low_half)), shiftl(cross, 32))
   end function multiply_64

   !> The 64-bit product of two numbers below 2**32
   elemental integer(int64) function multiply_32(a, b)
      integer(int64), intent(in) :: a, b

      multiply_32 = add_64(shiftl(shiftr(a, 16)*b, 16), iand(a, int(z'ffff', int64))*b)
   end function multiply_32

end module gyroakf_random
