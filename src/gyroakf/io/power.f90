! SPDX-License-Identifier: MIT
!> Products with powers of ten in 62-bit integers, with bounds: what numbers are read with.
!>
!> A positive number is held as an interval: it lies between lower and lower + width, times 2^scale, and lower is in
!> [2^61, 2^62). 10^q is a truncated power, or for large |q| the product of an exact power below 10^18 and one of 35 truncated ones.
!> Written with 31-bit halves, so that nothing overflows.
module gyroakf_io_power
   use gyroakf_kinds, only : int64
   use gyroakf_io_wide_power, only : first_word, ten
   implicit none (type, external)
   private
   public :: times_power, most_exponent

   !> The largest |q|
   integer(int64), parameter :: most_exponent = 306

   !> 10^(18 a), a = -17 to 17, truncated to 62 bits: the value is power * 2^(floor(log2(10^(18 a))) - 61)
   integer(int64), parameter :: power(-17:17) = first_word(-17:17)

   !> The same for 10^-64 to 10^63, the powers of most numbers, for which one product has to do
   integer(int64), parameter :: usual(-64:63) = [ &
      3035420144102701673_int64, 3794275180128377091_int64, 2371421987580235682_int64, 2964277484475294602_int64, &
      3705346855594118253_int64, 2315841784746323908_int64, 2894802230932904885_int64, 3618502788666131106_int64, &
      4523128485832663883_int64, 2826955303645414927_int64, 3533694129556768659_int64, 4417117661945960823_int64, &
      2760698538716225514_int64, 3450873173395281893_int64, 4313591466744102367_int64, 2695994666715063979_int64, &
      3369993333393829974_int64, 4212491666742287467_int64, 2632807291713929667_int64, 3291009114642412084_int64, &
      4113761393303015105_int64, 2571100870814384440_int64, 3213876088517980551_int64, 4017345110647475688_int64, &
      2510840694154672305_int64, 3138550867693340381_int64, 3923188584616675477_int64, 2451992865385422173_int64, &
      3064991081731777716_int64, 3831238852164722145_int64, 2394524282602951341_int64, 2993155353253689176_int64, &
      3741444191567111470_int64, 2338402619729444669_int64, 2923003274661805836_int64, 3653754093327257295_int64, &
      4567192616659071619_int64, 2854495385411919762_int64, 3568119231764899702_int64, 4460149039706124628_int64, &
      2787593149816327892_int64, 3484491437270409865_int64, 4355614296588012332_int64, 2722258935367507707_int64, &
      3402823669209384634_int64, 4253529586511730793_int64, 2658455991569831745_int64, 3323069989462289682_int64, &
      4153837486827862102_int64, 2596148429267413814_int64, 3245185536584267267_int64, 4056481920730334084_int64, &
      2535301200456458802_int64, 3169126500570573503_int64, 3961408125713216879_int64, 2475880078570760549_int64, &
      3094850098213450687_int64, 3868562622766813359_int64, 2417851639229258349_int64, 3022314549036572936_int64, &
      3777893186295716170_int64, 2361183241434822606_int64, 2951479051793528258_int64, 3689348814741910323_int64, &
      2305843009213693952_int64, 2882303761517117440_int64, 3602879701896396800_int64, 4503599627370496000_int64, &
      2814749767106560000_int64, 3518437208883200000_int64, 4398046511104000000_int64, 2748779069440000000_int64, &
      3435973836800000000_int64, 4294967296000000000_int64, 2684354560000000000_int64, 3355443200000000000_int64, &
      4194304000000000000_int64, 2621440000000000000_int64, 3276800000000000000_int64, 4096000000000000000_int64, &
      2560000000000000000_int64, 3200000000000000000_int64, 4000000000000000000_int64, 2500000000000000000_int64, &
      3125000000000000000_int64, 3906250000000000000_int64, 2441406250000000000_int64, 3051757812500000000_int64, &
      3814697265625000000_int64, 2384185791015625000_int64, 2980232238769531250_int64, 3725290298461914062_int64, &
      2328306436538696289_int64, 2910383045673370361_int64, 3637978807091712951_int64, 4547473508864641189_int64, &
      2842170943040400743_int64, 3552713678800500929_int64, 4440892098500626161_int64, 2775557561562891351_int64, &
      3469446951953614188_int64, 4336808689942017736_int64, 2710505431213761085_int64, 3388131789017201356_int64, &
      4235164736271501695_int64, 2646977960169688559_int64, 3308722450212110699_int64, 4135903062765138374_int64, &
      2584939414228211483_int64, 3231174267785264354_int64, 4038967834731580443_int64, 2524354896707237777_int64, &
      3155443620884047221_int64, 3944304526105059027_int64, 2465190328815661891_int64, 3081487911019577364_int64, &
      3851859888774471706_int64, 2407412430484044816_int64, 3009265538105056020_int64, 3761581922631320025_int64, &
      2350988701644575015_int64, 2938735877055718769_int64, 3673419846319648462_int64, 4591774807899560578_int64, &
      2869859254937225361_int64, 3587324068671531701_int64, 4484155085839414626_int64, 2802596928649634141_int64]

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

      if (q >= lbound(usual, 1) .and. q <= ubound(usual, 1)) then
         call multiply(lower, width, scale, usual(q), shifta(217706*q, 16) - 61)
         return
      end if
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
      width = width + merge(2, 3, width == 0)
      scale = scale + factor_scale + 62
      if (high < bit61) then
         high = 2*high + iand(shiftr(middle, 30), 1_int64)
         width = 2*width
         scale = scale - 1
      end if
      lower = high
   end subroutine multiply

end module gyroakf_io_power
