! SPDX-License-Identifier: MIT
!> Powers of ten, exactly truncated: to 126 bits for writing numbers, to 63 for reading most.
!>
!> 10^k is the product of one of 36 powers 10^(18 a), held truncated to 186 bits, and of an exact
!> one below 10^18. The product differs from the true power by less than 2^-60 of the last of 126
!> bits; that these are the exact ones for every k is tested against integers of any length.
module gyroakf_io_wide_power
   use gyroakf_kinds, only : int64
   implicit none (type, external)
   private
   public :: wide_power, power_scale, power, ten, int128, least_power, most_power

   !> Integers for products of two 64-bit numbers
   integer, parameter :: int128 = selected_int_kind(38)

   integer :: a, b

   !> The smallest and the largest k
   integer, parameter :: least_power = -300, most_power = 340

   !> 10^0 to 10^18
   integer(int64), parameter :: ten(0:18) = [(10_int64**a, a=0, 18)]

   !> 10^(18 a), a = -17 to 18, truncated to 186 bits, as three words of 62 bits, the highest first
   integer(int64), parameter :: word(3, -17:18) = reshape([ &
      3238436052916969893_int64, 2951135700252586374_int64, 3512598003106333702_int64, &
      2808895523222368605_int64, 3814045856004353731_int64, 791483310311251818_int64, &
      2436328502849999770_int64, 407422154330622505_int64, 518151140261242459_int64, &
      4226356249085321970_int64, 3775671641826925741_int64, 3470080277855536252_int64, &
      3665779701564795034_int64, 763715235557662672_int64, 2781374398896771382_int64, &
      3179557053031851899_int64, 853669163689487611_int64, 1150756115805100304_int64, &
      2757826131550993649_int64, 1680332842721399236_int64, 3064051470662689852_int64, &
      2392032866531905486_int64, 3647578832074186247_int64, 997167427153055289_int64, &
      4149515568880992958_int64, 2363064180716774673_int64, 760780161916109326_int64, &
      3599131035634557106_int64, 1145684875262998780_int64, 229592460858185628_int64, &
      3121748550315992231_int64, 1759806609307768124_int64, 1766417686140793407_int64, &
      2707685248164858261_int64, 1415995602546790278_int64, 4585826314940258215_int64, &
      2348542582773833227_int64, 4102005231875834508_int64, 2529889441326119149_int64, &
      4074071952668972172_int64, 2475974455889288731_int64, 25181610059132998_int64, &
      3533694129556768659_int64, 768283839092124552_int64, 1898848571680919510_int64, &
      3064991081731777716_int64, 3305167949708200862_int64, 2858651230996492116_int64, &
      2658455991569831745_int64, 3724462748074260988_int64, 4380700396915675587_int64, &
      2305843009213693952_int64, 0_int64, 0_int64, &
      4000000000000000000_int64, 0_int64, 0_int64, &
      3469446951953614188_int64, 3799332742966018048_int64, 0_int64, &
      3009265538105056020_int64, 1844515466944871826_int64, 1152921504606846976_int64, &
      2610121787199409810_int64, 3154935772422857500_int64, 3980509001229271040_int64, &
      4527839539413356183_int64, 3479792166963141746_int64, 1123986060929754849_int64, &
      3927274772238181242_int64, 2198010555985086793_int64, 1683553148770125667_int64, &
      3406367872006520575_int64, 4279842803073957257_int64, 2401257132719866988_int64, &
      2954553157691435449_int64, 3886995734691979418_int64, 1794451070422400577_int64, &
      2562666361834369183_int64, 1244551441711384368_int64, 2057852183829217291_int64, &
      4445517498970154966_int64, 4083310525523588052_int64, 1457226907713929575_int64, &
      3855871784164614588_int64, 1776421710431337223_int64, 1384411963642675300_int64, &
      3344435652173466552_int64, 1646439372086670185_int64, 730637296640655919_int64, &
      2900835519859557836_int64, 802994669370814337_int64, 4497089733895447854_int64, &
      2516073738123880198_int64, 2426605237850568008_int64, 4077761944003090872_int64, &
      4364692180812216115_int64, 4307186940042791118_int64, 3528131685394471493_int64, &
      3785766995733679075_int64, 520221758083560209_int64, 542835706698237062_int64, &
      3283629441038700999_int64, 2162066463385423509_int64, 682215723853208251_int64, &
      2848094538889217770_int64, 1639444594408567917_int64, 370723880999011195_int64], [3, 36])

   integer(int64), parameter :: low62 = 2_int64**62 - 1

   !> 10^0 to 10^17, with the highest bit moved to the place of 2^61
   integer(int64), parameter :: fine(0:17) = [(shiftl(ten(b), leadz(ten(b)) - 2), b=0, 17)]

   !> 10^(18 a + b): the first 124 bits of 10^(18 a), 62 by their upper half only, times 10^b
   integer(int128), parameter :: product(-306:305) = [((int(word(1, a), &
      int128)*fine(b) + shiftr(int(word(2, a), int128)*fine(b), 62), b=0, 17), a=-17, 16)]

   !> 10^-306 to 10^305: 10^k is between power and power + 1, times 2^(floor(log2(10^k)) - 62);
   !> power is in [2^62, 2^63)
   integer(int64), parameter :: power(-306:305) = &
      [(int(shiftr(product(a), 65 - leadz(product(a))), int64), a=-306, 305)]

contains

   !> 10^k is between bits and bits + 1, times 2^[[power_scale]]; bits is in [2^125, 2^126).
   pure subroutine wide_power(k, bits)
      !> least_power to most_power
      integer, intent(in) :: k
      integer(int128), intent(out) :: bits
      integer(int128) :: factor, low, middle, high
      integer :: coarse, shift

      coarse = (k + 360)/18 - 20
      factor = fine(k - 18*coarse)
      low = word(3, coarse)*factor
      middle = word(2, coarse)*factor + shiftr(low, 62)
      high = word(1, coarse)*factor + shiftr(middle, 62)
      shift = merge(2, 3, shiftr(high, 123) > 0)
      bits = ior(shiftl(high, shift), shiftr(iand(middle, int(low62, int128)), 62 - shift))
   end subroutine wide_power

   !> The exponent of two that belongs to [[wide_power]]: floor(log2(10^k)) - 125.
   elemental integer function power_scale(k)
      !> least_power to most_power
      integer, intent(in) :: k

      power_scale = shifta(217706*k, 16) - 125
   end function power_scale

end module gyroakf_io_wide_power
