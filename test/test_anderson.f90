! SPDX-License-Identifier: MIT
!> Tests of the Anderson-Darling test of normality. Reference values: 40-digit arithmetic from the doubles of the series
!> (series_library, 1000 samples each), rounded once; published ones with their source.
module test_anderson
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_anderson_darling, only : anderson_darling_options, anderson_darling_type, test_anderson_darling, &
      & anderson_darling_p, rounding_statistic
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, check_refused
   implicit none (type, external)
   private
   public :: suite_anderson

   !> A sum of 1000 terms of size 1 gives 0.2: a relative error of 1e-16 sqrt(1000)/0.2 is expected
   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> The samples of `offset`, 1e4 + 1e-3 x, hold x to 1e-9 of it; their own statistic is exact again
   real(dp), parameter :: statistic_of(11) = [ &
      & 0.169615349300928091_dp, 0.258095236416127856_dp, 12.4006143838884692_dp, 22.0897540790117662_dp, &
      & 0.20787216538121209_dp, 5.10524293901722886_dp, 0.763248308095686796_dp, 0.391097224861962969_dp, &
      & 0.22558770550500478_dp, 0.20787216523495121_dp, 0.46973922027826066_dp]
   real(dp), parameter :: p_value_of(11) = [ &
      & 0.933759066698522707_dp, 0.717171788021517856_dp, 3.76497880538838325e-24_dp, 3.76497880538838325e-24_dp, &
      & 0.865887992989564733_dp, 1.27439945801078137e-12_dp, 0.0470704090634341025_dp, 0.379666393403915059_dp, &
      & 0.819371086006986423_dp, 0.865887993340126267_dp, 0.246895955131459594_dp]

contains

   subroutine suite_anderson()
      call test("reference", test_reference)
      call test("published", test_published)
      call test("far_tails", test_far_tails)
      call test("two_valued", test_two_valued)
      call test("p_value", test_p_value)
      call test("offset_scale", test_offset_scale)
      call test("missing", test_missing)
      call test("thinned", test_thinned)
      call test("rounding", test_rounding)
      call test("failures", test_failures)
   end subroutine suite_anderson

   !> The test of a series; -1 where it fails.
   subroutine run(x, result, valid, most)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The test
      type(anderson_darling_type), intent(out) :: result
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Largest number of samples
      integer(int64), intent(in), optional :: most
      type(anderson_darling_options) :: options

      if (present(most)) options%most_samples = most
      call test_anderson_darling(x, options, result, problem, valid)
      if (allocated(problem)) result%statistic = -1.0_dp
   end subroutine run

   !> The eleven series.
   subroutine test_reference()
      type(anderson_darling_type) :: ad
      integer :: i

      do i = 1, size(reference_names)
         call run(reference_series(trim(reference_names(i)), 1000), ad)
         call check(error, ad%statistic, statistic_of(i), reference_names(i), thr=tolerance, rel=.true.)
         call check(error, ad%modified, statistic_of(i)*1.00075225_dp, reference_names(i), thr=tolerance, rel=.true.)
         call check(error, ad%p_value, p_value_of(i), reference_names(i), thr=1.0e-11_dp, rel=.true.)
      end do
   end subroutine test_reference

   !> Weights of 20 Leghorn chicks (Bliss), of 11 men (Snedecor), and 50 numbers of a telephone book (Conover): 0.214 and
   !> 0.947 in Stephens' chapter of D'Agostino & Stephens (1986); A*^2 = 0.339, p = 0.50 in the manual of IMSL's ADNRM.
   subroutine test_published()
      real(dp), parameter :: chicks(20) = [156.0_dp, 162.0_dp, 168.0_dp, 182.0_dp, 186.0_dp, 190.0_dp, 190.0_dp, 196.0_dp, &
         & 202.0_dp, 210.0_dp, 214.0_dp, 220.0_dp, 226.0_dp, 230.0_dp, 230.0_dp, 236.0_dp, 236.0_dp, 242.0_dp, 246.0_dp, 270.0_dp]
      real(dp), parameter :: men(11) = [148.0_dp, 154.0_dp, 158.0_dp, 160.0_dp, 161.0_dp, 162.0_dp, 166.0_dp, 170.0_dp, &
         & 182.0_dp, 195.0_dp, 236.0_dp]
      integer, parameter :: telephone(50) = [23, 36, 54, 61, 73, 23, 37, 54, 61, 73, 24, 40, 56, 62, 74, 27, 42, 57, 63, 75, 29, &
         & 43, 57, 64, 77, 31, 43, 58, 65, 81, 32, 44, 58, 66, 87, 33, 45, 58, 68, 89, 33, 48, 58, 68, 93, 35, 48, 59, 70, 97]
      type(anderson_darling_type) :: ad

      call run(chicks, ad)
      call check(error, ad%statistic, 0.214174258231198036_dp, thr=tolerance, rel=.true.)
      call run(men, ad)
      call check(error, ad%statistic, 0.946771879598887294_dp, thr=tolerance, rel=.true.)
      call run(real(telephone, dp), ad)
      call check(error, ad%modified, 0.339182825254198935_dp, thr=tolerance, rel=.true.)
      call check(error, ad%p_value, 0.502369954201296298_dp, thr=tolerance, rel=.true.)
   end subroutine test_published

   !> A sample 100 standard deviations out: its tail is 1e-2174, its logarithm a number.
   subroutine test_far_tails()
      type(anderson_darling_type) :: ad
      real(dp) :: x(10001)
      integer :: i

      x(:10000) = [(1.0e-3_dp*real(mod(i, 7) - 3, dp), i=1, 10000)]
      x(10001) = 1000.0_dp
      call run(x, ad)
      call check(error, ad%statistic > 1000.0_dp .and. ad%statistic < 1.0e4_dp, "a far outlier")
      call run([(0.1_dp*real(i, dp), i=-10, 10), -40.0_dp, 55.0_dp], ad)
      call check(error, ad%statistic, 6.09608264544221385_dp, thr=tolerance, rel=.true.)
   end subroutine test_far_tails

   !> Ties are no trouble.
   subroutine test_two_valued()
      type(anderson_darling_type) :: ad
      integer :: i

      call run([(real(mod(i, 2), dp), i=1, 20)], ad)
      call check(error, ad%statistic, 3.43127229706746056_dp, thr=tolerance, rel=.true.)
   end subroutine test_two_valued

   !> The four ranges meet nearly; beyond 10 p stays. Upper points of D'Agostino & Stephens (1986), Table 4.7.
   subroutine test_p_value()
      real(dp), parameter :: joint(3) = [0.2_dp, 0.34_dp, 0.6_dp]
      real(dp), parameter :: point(5) = [0.561_dp, 0.631_dp, 0.752_dp, 0.873_dp, 1.035_dp]
      real(dp), parameter :: level(5) = [0.15_dp, 0.10_dp, 0.05_dp, 0.025_dp, 0.01_dp]
      integer :: i

      do i = 1, size(joint)
         call check(error, anderson_darling_p(joint(i)*(1.0_dp - epsilon(1.0_dp))), anderson_darling_p(joint(i)), thr=4.0e-3_dp)
      end do
      do i = 1, size(point)
         call check(error, anderson_darling_p(point(i)), level(i), thr=0.02_dp, rel=.true.)
      end do
      call check(error, anderson_darling_p(1.0e6_dp), anderson_darling_p(10.0_dp), thr=1.0e-30_dp)
      call check(error, anderson_darling_p(0.0_dp), 1.0_dp, thr=1.0e-5_dp)
   end subroutine test_p_value

   !> Powers of two are exact, and so is the offset for multiples of 1/1024; 1e6 + 1e-3 x to what the doubles hold.
   subroutine test_offset_scale()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run(x, a)
      call run((x + 1048576.0_dp)*2.0_dp**(-60), b)
      call check(error, b%statistic, a%statistic, thr=1.0e-11_dp, rel=.true.)
      call run(-x, b)
      call check(error, b%statistic, a%statistic, thr=1.0e-11_dp, rel=.true.)
      call run(1.0e6_dp + 1.0e-3_dp*x, b)
      call check(error, b%statistic, a%statistic, thr=1.0e-7_dp, rel=.true.)
   end subroutine test_offset_scale

   !> Missing samples count as if they were not there, also where the series is thinned.
   subroutine test_missing()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(3000)
      integer :: i

      x = reference_series("wn", 3000)
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 3000)]
      call run(x, a, valid, 500_int64)
      call run(pack(x, valid == 1_int8), b, most=500_int64)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, a%stride == 5_int64 .and. a%samples == b%samples .and. a%samples <= 500_int64, "stride and samples")
      where (valid == 0_int8) x = 1.0e30_dp
      call run(x, b, valid, 500_int64)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
   end subroutine test_missing

   !> Every third sample of 3000, and the same samples alone.
   subroutine test_thinned()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)

      x = reference_series("ar1", 3000)
      call run(x, a, most=1000_int64)
      call run(x(::3), b)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, a%stride == 3_int64 .and. a%samples == 1000_int64 .and. b%stride == 1_int64, "stride and samples")
      call check(error, a%distance, sqrt(a%statistic/1000.0_dp), thr=tolerance)
   end subroutine test_thinned

   !> Rounding 70,000 normal samples to half a standard deviation gives what the formula says, to a tenth.
   subroutine test_rounding()
      type(anderson_darling_type) :: ad
      real(dp), allocatable :: x(:)

      x = reference_series("wn_bm", 70000)
      call run(0.5_dp*anint(x/0.5_dp), ad)
      call check(error, ad%statistic, rounding_statistic(0.5_dp, 70000_int64), thr=0.1_dp, rel=.true.)
   end subroutine test_rounding

   !> Seven samples, a constant series, a limit of seven.
   subroutine test_failures()
      type(anderson_darling_options) :: options
      type(anderson_darling_type) :: ad
      integer :: i

      call test_anderson_darling([(real(i*i, dp), i=1, 7)], options, ad, problem)
      call check_refused(problem, status%too_few_samples)
      call test_anderson_darling([(0.1_dp, i=1, 9)], options, ad, problem)
      call check_refused(problem, status%constant_input)
      options%most_samples = 7
      call test_anderson_darling([(real(i*i, dp), i=1, 20)], options, ad, problem)
      call check_refused(problem, status%invalid_argument)
   end subroutine test_failures

end module test_anderson
