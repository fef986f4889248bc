! SPDX-License-Identifier: MIT
!> Products with powers of ten in 62-bit integers, with bounds: for reading and writing decimal numbers exactly.
!>
!> A positive number is held as an interval: it lies between lower and lower + width, times 2^scale, and lower is in
!> [2^61, 2^62). 10^q is the product of an exact power below 10^18 and one of 35 truncated ones. Written with 31-bit halves,
!> so that nothing overflows.
module gyroakf_io_power
   use gyroakf_kinds, only : int64
   implicit none (type, external)
   private
   public :: times_power, most_exponent, ten

   !> The largest |q|
   integer(int64), parameter :: most_exponent = 306

   !> 10^0 to 10^18
   integer(int64), parameter :: ten(0:18) = [ &
      1_int64, 10_int64, 100_int64, 1000_int64, 10000_int64, &
      100000_int64, 1000000_int64, 10000000_int64, 100000000_int64, 1000000000_int64, &
      10000000000_int64, 100000000000_int64, 1000000000000_int64, 10000000000000_int64, 100000000000000_int64, &
      1000000000000000_int64, 10000000000000000_int64, 100000000000000000_int64, 1000000000000000000_int64]

   !> 10^(18 a), a = -17 to 17, truncated to 62 bits: the value is power * 2^(floor(log2(10^(18 a))) - 61)
   integer(int64), parameter :: power(-17:17) = [ &
      3238436052916969893_int64, 2808895523222368605_int64, 2436328502849999770_int64, 4226356249085321970_int64, &
      3665779701564795034_int64, 3179557053031851899_int64, 2757826131550993649_int64, 2392032866531905486_int64, &
      4149515568880992958_int64, 3599131035634557106_int64, 3121748550315992231_int64, 2707685248164858261_int64, &
      2348542582773833227_int64, 4074071952668972172_int64, 3533694129556768659_int64, 3064991081731777716_int64, &
      2658455991569831745_int64, 2305843009213693952_int64, 4000000000000000000_int64, 3469446951953614188_int64, &
      3009265538105056020_int64, 2610121787199409810_int64, 4527839539413356183_int64, 3927274772238181242_int64, &
      3406367872006520575_int64, 2954553157691435449_int64, 2562666361834369183_int64, 4445517498970154966_int64, &
      3855871784164614588_int64, 3344435652173466552_int64, 2900835519859557836_int64, 2516073738123880198_int64, &
      4364692180812216115_int64, 3785766995733679075_int64, 3283629441038700999_int64]

   integer(int64), parameter :: low31 = 2_int64**31 - 1
   integer(int64), parameter :: bit61 = 2_int64**61

contains

   !> Multiplies the interval by 10^q.
   pure subroutine times_power(lower, width, scale, q)
      !> The interval, see above
      integer(int64), intent(inout) :: lower, width, scale
      !> -most_exponent to most_exponent
      integer(int64), intent(in) :: q
      integer(int64) :: coarse, fine
      integer :: shift

      coarse = (q + 360)/18 - 20
      fine = q - 18*coarse
      if (fine > 0) then
         shift = leadz(ten(fine)) - 2
         call multiply(lower, width, scale, shiftl(ten(fine), shift), -int(shift, int64))
      end if
      if (coarse /= 0) call multiply(lower, width, scale, power(coarse), shifta(217706*18*coarse, 16) - 61)
   end subroutine times_power

   !> (lower, width, scale) times a factor that lies between factor and factor + 1, times 2^factor_scale; both are in [2^61, 2^62).
   pure subroutine multiply(lower, width, scale, factor, factor_scale)
      integer(int64), intent(inout) :: lower, width, scale
      integer(int64), intent(in) :: factor, factor_scale
      integer(int64) :: a1, a0, b1, b0, middle, low, high

      a1 = shiftr(lower, 31)
      a0 = iand(lower, low31)
      b1 = shiftr(factor, 31)
      b0 = iand(factor, low31)
      low = a0*b0
      middle = a1*b0 + a0*b1
      middle = middle + shiftr(low, 31)
      high = a1*b1 + shiftr(middle, 31)
      width = width + 3
      scale = scale + factor_scale + 62
      if (high < bit61) then
         high = 2*high + iand(shiftr(middle, 30), 1_int64)
         width = 2*width
         scale = scale - 1
      end if
      lower = high
   end subroutine multiply

end module gyroakf_io_power
