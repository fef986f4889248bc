! SPDX-License-Identifier: MIT
!> Tests of the moments. The reference values were computed in exact arithmetic from the doubles of
!> the series (series_library, 1000 samples each) and rounded once.
module test_moments
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_moments, only : moments_type, compute_moments, join_moments
   use series_library, only : reference_series, reference_names
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_moments

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> In the order of reference_names
   real(dp), parameter :: mean_of(11) = [ &
      & -0.026799447876307864_dp, -0.015705583725582305_dp, 0.48977446285950693_dp, -12.848169949609405_dp, &
      & -0.08832106360855939_dp, -2.498029614447351_dp, -0.08889648432288441_dp, 3.972200552123692_dp, &
      & 1.0778459363914406_dp, 9999.999911678937_dp, -0.02679944787630787_dp]
   real(dp), parameter :: variance_of(11) = [ &
      & 0.9463224002903896_dp, 1.0407709685169115_dp, 0.08321284357073382_dp, 72.68428056611991_dp, &
      & 1.7911998046105617_dp, 16.235148472553718_dp, 3.653965429564846_dp, 1.2777269900301986_dp, &
      & 1.8879007235794214_dp, 1.7911998045204664e-6_dp, 0.9837095458337388_dp]
   real(dp), parameter :: skewness_of(11) = [ &
      & 0.06991219991707069_dp, -0.028379873124485783_dp, 0.05802860654562462_dp, -0.441925167503053_dp, &
      & -0.0569382417291755_dp, 0.41558871147616244_dp, 0.12679077523362206_dp, 0.006940385976306047_dp, &
      & -0.08028617493392409_dp, -0.0569382417010841_dp, 0.0701710892097806_dp]
   real(dp), parameter :: kurtosis_of(11) = [ &
      & 3.0055072631266455_dp, 2.85575221036146_dp, 1.778861299574387_dp, 2.1437694589985834_dp, &
      & 3.120340503461698_dp, 3.512712171854677_dp, 3.4692450938965207_dp, 2.6996376310701833_dp, &
      & 3.067041136249923_dp, 3.120340503347084_dp, 3.073961414040432_dp]

contains

   subroutine suite_moments()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("offset_scale", test_offset_scale)
      call test("missing", test_missing)
      call test("long", test_long)
      call test("tiny-huge", test_tiny_huge)
      call test("few", test_few)
   end subroutine suite_moments

   !> 1 2 3 4 10: mean 4, deviations -3 -2 -1 0 6, powers 50, 180, 1394.
   subroutine test_by_hand()
      type(moments_type) :: m

      call compute_moments([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp, 10.0_dp], m)
      call check(error, m%count == 5_int64, "count")
      call check(error, m%mean, 4.0_dp, thr=tolerance)
      call check(error, m%variance, 12.5_dp, thr=tolerance)
      call check(error, m%std, sqrt(12.5_dp), thr=tolerance)
      call check(error, m%minimum, 1.0_dp, thr=tolerance)
      call check(error, m%maximum, 10.0_dp, thr=tolerance)
      call check(error, m%skewness, 36.0_dp/10.0_dp**1.5_dp, thr=tolerance)
      call check(error, m%kurtosis, 278.8_dp/100.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> The eleven series; 1e4 + 1e-3 ar1 among them.
   subroutine test_reference()
      type(moments_type) :: m
      integer :: i

      do i = 1, size(reference_names)
         call compute_moments(reference_series(trim(reference_names(i)), 1000), m)
         call check(error, m%mean, mean_of(i), trim(reference_names(i))//" mean", thr=tolerance, rel=.true.)
         call check(error, m%variance, variance_of(i), trim(reference_names(i))//" variance", thr=tolerance, rel=.true.)
         call check(error, m%skewness, skewness_of(i), trim(reference_names(i))//" skewness", thr=tolerance)
         call check(error, m%kurtosis, kurtosis_of(i), trim(reference_names(i))//" kurtosis", thr=tolerance, rel=.true.)
      end do
   end subroutine test_reference

   !> Adding 2^40 and scaling by 2^-30 are exact for this series of multiples of 1/16.
   subroutine test_offset_scale()
      type(moments_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(16.0_dp*reference_series("ar1", 20000))/16.0_dp
      call compute_moments(x, a)
      call compute_moments((x + 2.0_dp**40)*2.0_dp**(-30), b)
      call check(error, b%mean, (a%mean + 2.0_dp**40)*2.0_dp**(-30), thr=epsilon(x), rel=.true.)
      call check(error, b%variance, a%variance*2.0_dp**(-60), thr=tolerance, rel=.true.)
      call check(error, b%skewness, a%skewness, thr=tolerance)
      call check(error, b%kurtosis, a%kurtosis, thr=tolerance)
   end subroutine test_offset_scale

   !> Missing samples count as if they were not there, whatever their value.
   subroutine test_missing()
      type(moments_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)

      x = reference_series("offset", 10000)
      allocate (valid(size(x)), source=1_int8)
      valid(2::7) = 0_int8
      valid(4000:9000) = 0_int8
      call compute_moments(pack(x, valid == 1_int8), a)
      where (valid == 0_int8) x = 0.0_dp
      call compute_moments(x, b, valid)
      call check(error, b%count == a%count, "count")
      call check(error, b%mean, a%mean, thr=epsilon(x), rel=.true.)
      call check(error, b%variance, a%variance, thr=tolerance, rel=.true.)
      call check(error, b%kurtosis, a%kurtosis, thr=tolerance, rel=.true.)
      call check(error, b%minimum, a%minimum, thr=tolerance, rel=.true.)
      valid = 0_int8
      call compute_moments(x, b, valid)
      call check(error, b%count == 0 .and. abs(b%mean) + b%variance <= 0.0_dp, "nothing is present")
   end subroutine test_missing

   !> A million samples of a known sum: 0, 1, ..., 999 999, threaded.
   subroutine test_long()
      type(moments_type) :: m
      real(dp), allocatable :: x(:)
      real(dp) :: n
      integer :: i

      allocate (x(1000000))
      do i = 1, size(x)
         x(i) = real(i - 1, dp)
      end do
      n = 1.0e6_dp
      call compute_moments(x, m)
      call check(error, m%mean, 0.5_dp*(n - 1.0_dp), thr=1.0e-14_dp, rel=.true.)
      call check(error, m%variance, n*(n + 1.0_dp)/12.0_dp, thr=1.0e-14_dp, rel=.true.)
      call check(error, m%kurtosis, 1.8_dp*(n*n - 7.0_dp/3.0_dp)/(n*n - 1.0_dp), thr=1.0e-14_dp, rel=.true.)
      call check(error, m%skewness, 0.0_dp, thr=1.0e-14_dp)
   end subroutine test_long

   !> No sample, one sample, no variance.
   subroutine test_few()
      type(moments_type) :: m
      real(dp) :: x(3)

      call compute_moments(x(:0), m)
      call check(error, m%count == 0, "no sample")
      x = 0.1_dp
      call compute_moments(x(:1), m)
      call check(error, m%mean, 0.1_dp, thr=tiny(x))
      call check(error, m%variance, 0.0_dp, thr=tiny(x))
      call compute_moments(x, m)
      call check(error, m%variance + abs(m%skewness) + m%kurtosis, 0.0_dp, thr=tiny(x))
   end subroutine test_few

   !> Fourth powers neither vanish nor overflow, of a series or of two that are joined.
   subroutine test_tiny_huge()
      integer, parameter :: powers(*) = [-510, -400, -200, 200, 330, 500]
      type(moments_type) :: expected, moments, next
      real(dp) :: x(5000)
      integer(int8) :: valid(5000)
      integer :: k

      x = [(sin(0.37_dp*k**2) + 1.0e-3_dp*k, k=1, 5000)]
      valid = 1_int8
      valid(40:60) = 0_int8
      call compute_moments(x, expected, valid)
      do k = 1, size(powers)
         call compute_moments(scale(x, powers(k)), moments, valid)
         call same(moments)
         call compute_moments(scale(x(:3000), powers(k)), moments, valid(:3000))
         call compute_moments(scale(x(3001:), powers(k)), next, valid(3001:))
         call join_moments(moments, next)
         call same(moments)
      end do

   contains

      subroutine same(moments)
         type(moments_type), intent(in) :: moments

         call check(error, moments%kurtosis, expected%kurtosis, thr=1.0e-12_dp)
         call check(error, moments%skewness, expected%skewness, thr=1.0e-12_dp)
         call check(error, scale(moments%std, -powers(k)), expected%std, thr=1.0e-12_dp)
         call check(error, scale(moments%mean, -powers(k)), expected%mean, thr=1.0e-12_dp)
         call check(error, scale(moments%maximum, -powers(k)), expected%maximum, thr=1.0e-12_dp)
      end subroutine same

   end subroutine test_tiny_huge

end module test_moments
