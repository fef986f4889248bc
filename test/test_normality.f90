! SPDX-License-Identifier: MIT
!> Tests of normality: Jarque-Bera and the verdict, Anderson-Darling. Reference values: exact or
!> 40-digit arithmetic from the doubles of the series (series_library, 1000 samples each), rounded
!> once; published ones with their source.
module test_normality
   use gyroakf_kinds, only : dp, int64, int8
   use gyroakf_error, only : status
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_channel_tests, only : find_quantization_step, run_distribution
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_normality, only : jarque_bera_type, test_jarque_bera, skewness_error, &
      & kurtosis_error, judge_normality
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   use gyroakf_stats_anderson_darling, only : anderson_darling_options, anderson_darling_type, &
      & test_anderson_darling, anderson_darling_p, rounding_statistic
   implicit none (type, external)
   private
   public :: suite_normality, suite_anderson

   real(dp), parameter :: tolerance = 1.0e-12_dp
   !> In the order of reference_names
   real(dp), parameter :: statistic_of(11) = [ &
      & 0.8158830306718312_dp, 1.0012122337438372_dp, 62.693708432819264_dp, 63.096756418082684_dp, &
      & 1.143737094093957_dp, 39.73873664973366_dp, 11.85394003680525_dp, 3.767092854130486_dp, &
      & 1.2615830621568083_dp, 1.1437370924114114_dp, 1.048592408767007_dp]
   real(dp), parameter :: p_value_of(11) = [ &
      & 0.6650177710260406_dp, 0.6061631426368473_dp, 2.433515903499219e-14_dp, 1.9893602266001574e-14_dp, &
      & 0.564469714453444_dp, 2.3487834472227337e-9_dp, 0.002666549356094504_dp, 0.1520499145165288_dp, &
      & 0.5321704048403791_dp, 0.564469714928317_dp, 0.5919718449805954_dp]
   !> The samples of `offset`, 1e4 + 1e-3 x, hold x to 1e-9 of it; their own statistic is exact again
   real(dp), parameter :: ad_statistic(11) = [ &
      & 0.169615349300928091_dp, 0.258095236416127856_dp, 12.4006143838884692_dp, 22.0897540790117662_dp, &
      & 0.20787216538121209_dp, 5.10524293901722886_dp, 0.763248308095686796_dp, 0.391097224861962969_dp, &
      & 0.22558770550500478_dp, 0.20787216523495121_dp, 0.46973922027826066_dp]
   real(dp), parameter :: ad_p_value(11) = [ &
      & 0.933759066698522707_dp, 0.717171788021517856_dp, 3.76497880538838325e-24_dp, 3.76497880538838325e-24_dp, &
      & 0.865887992989564733_dp, 1.27439945801078137e-12_dp, 0.0470704090634341025_dp, 0.379666393403915059_dp, &
      & 0.819371086006986423_dp, 0.865887993340126267_dp, 0.246895955131459594_dp]

contains

   subroutine suite_normality()
      call test("by_hand", test_by_hand)
      call test("reference", test_reference)
      call test("offset_scale", test_offset_scale)
      call test("failures", test_failures)
      call test("standard_errors", test_standard_errors)
      call test("verdicts", test_verdicts)
      call test("deciding_test", test_deciding)
   end subroutine suite_normality

   subroutine suite_anderson()
      call test("reference", test_reference_anderson)
      call test("published", test_published)
      call test("far_tails", test_far_tails)
      call test("two_valued", test_two_valued)
      call test("p_value", test_p_value)
      call test("offset_scale", test_offset_scale_anderson)
      call test("missing", test_missing)
      call test("thinned", test_thinned)
      call test("rounding", test_rounding)
      call test("failures", test_failures_anderson)
   end subroutine suite_anderson

   !> -1 and 1: skewness 0, kurtosis 1, JB = 4/6 (2^2/4).
   subroutine test_by_hand()
      type(jarque_bera_type) :: jb

      call run([-1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp], jb)
      call check(error, jb%statistic, 2.0_dp/3.0_dp, thr=tolerance)
      call check(error, jb%p_value, exp(-1.0_dp/3.0_dp), thr=tolerance)
      call check(error, jb%kurtosis, 1.0_dp, thr=tolerance)
      call check(error, jb%skewness_error, sqrt(12.0_dp/35.0_dp), thr=tolerance)
      call check(error, jb%kurtosis_error, sqrt(192.0_dp/1575.0_dp), thr=tolerance)
   end subroutine test_by_hand

   !> Moments and test of a series that has both.
   subroutine run(x, jb)
      real(dp), intent(in), contiguous :: x(:)
      type(jarque_bera_type), intent(out) :: jb
      type(moments_type) :: moments

      call compute_moments(x, moments)
      call test_jarque_bera(moments, jb, problem)
      if (allocated(problem)) jb%statistic = -1.0_dp
   end subroutine run

   !> The eleven series; the statistic of a nearly normal series is a small difference.
   subroutine test_reference()
      type(jarque_bera_type) :: jb
      integer :: i

      do i = 1, size(reference_names)
         call run(reference_series(trim(reference_names(i)), 1000), jb)
         call check(error, jb%statistic, statistic_of(i), reference_names(i), thr=tolerance, rel=.true.)
         call check(error, jb%p_value, p_value_of(i), reference_names(i), thr=tolerance*max(1.0_dp, statistic_of(i)), rel=.true.)
      end do
   end subroutine test_reference

   !> Powers of two are exact, and so is the offset for multiples of 1/1024.
   subroutine test_offset_scale()
      type(jarque_bera_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run(x, a)
      call run((x + 1048576.0_dp)*2.0_dp**(-60), b)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call run(-x, b)
      call check(error, b%skewness, -a%skewness, thr=tolerance)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
   end subroutine test_offset_scale

   !> One sample; a constant series; samples whose squares are no numbers.
   subroutine test_failures()
      type(moments_type) :: moments
      type(jarque_bera_type) :: jb

      call compute_moments([1.0_dp], moments)
      call test_jarque_bera(moments, jb, problem)
      call check_refused(problem, status%too_few_samples)
      call compute_moments([0.1_dp, 0.1_dp, 0.1_dp], moments)
      call test_jarque_bera(moments, jb, problem)
      call check_refused(problem, status%constant_input)
      call compute_moments([0.0_dp, 1.0e-160_dp, 3.0e-160_dp], moments)
      call check(error, moments%std > 0.0_dp, "the deviation of tiny samples vanished")
      call test_jarque_bera(moments, jb, problem)
      call check_refused(problem, status%constant_input)
   end subroutine test_failures

   !> n = 8: sqrt(6 6/99) and sqrt(24 8 6 5/(81 11 13)).
   subroutine test_standard_errors()
      call check(error, skewness_error(8_int64), sqrt(36.0_dp/99.0_dp), thr=tolerance, rel=.true.)
      call check(error, kurtosis_error(8_int64), sqrt(5760.0_dp/11583.0_dp), thr=tolerance, rel=.true.)
      call check(error, kurtosis_error(10_int64**12)*sqrt(1.0e12_dp/24.0_dp), 1.0_dp, thr=1.0e-11_dp)
      call check(error, max(skewness_error(0_int64), kurtosis_error(0_int64)), 0.0_dp, thr=tolerance)
   end subroutine test_standard_errors

   !> The table of the verdicts.
   subroutine test_verdicts()
      call check(error, judge_normality(0.05_dp, 3.1_dp, 0.3_dp), "normal   ")
      call check(error, judge_normality(0.05_dp, 2.9_dp, 1.0e-10_dp), "nearly   ")
      call check(error, judge_normality(-0.5_dp, 3.0_dp, 0.3_dp), "undecided")
      call check(error, judge_normality(0.0_dp, 1.8_dp, 1.0e-10_dp), "not      ")
   end subroutine test_verdicts

   !> Three values with the skewness and kurtosis of a normal distribution, -s 0 0 0 0 s with
   !> s = sqrt(3): Jarque-Bera accepts them, Anderson-Darling rejects them. The latter decides where all samples
   !> were tested and are not in coarse steps.
   subroutine test_deciding()
      real(dp) :: x(2000)
      integer :: i

      x = [(sqrt(3.0_dp)*real(merge(1, 0, mod(i, 6) == 5) - merge(1, 0, mod(i, 6) == 0), dp), &
            i=1, size(x))]
      call check_verdict(x + 1.0e-3_dp*reference_series("wn", size(x)), 2000_int64, "nearly")
      call check_verdict(x + 1.0e-3_dp*reference_series("wn", size(x)), 1999_int64, "normal")
      call check_verdict(x, 2000_int64, "normal")
   end subroutine test_deciding

   !> The verdict of the pipeline, with so many samples of the Anderson-Darling test.
   subroutine check_verdict(x, most_samples, expected)
      real(dp), intent(in), contiguous, target :: x(:)
      integer(int64), intent(in) :: most_samples
      character(*), intent(in) :: expected
      type(job_type) :: job
      type(channel_result_type) :: channel

      job%options%anderson_darling%most_samples = most_samples
      job%x => x
      call compute_moments(x, channel%cleaned)
      call test_jarque_bera(channel%cleaned, channel%jarque_bera, problem)
      channel%available%jarque_bera = .not. allocated(problem)
      call find_quantization_step(job, channel, problem)
      if (.not. allocated(problem)) call run_distribution(x, job, channel, problem)
      if (went_wrong(problem)) return
      call check(error, channel%anderson_darling%p_value < 1.0e-20_dp, "normal by Anderson-Darling")
      call check(error, trim(channel%normality), expected)
   end subroutine check_verdict

   !> The test of a series; -1 where it fails.
   subroutine run_anderson(x, result, valid, most)
      real(dp), intent(in), contiguous :: x(:)
      type(anderson_darling_type), intent(out) :: result
      integer(int8), intent(in), optional :: valid(:)
      integer(int64), intent(in), optional :: most
      type(anderson_darling_options) :: options

      if (present(most)) options%most_samples = most
      call test_anderson_darling(x, options, result, problem, valid)
      if (allocated(problem)) result%statistic = -1.0_dp
   end subroutine run_anderson

   !> The eleven series.
   subroutine test_reference_anderson()
      type(anderson_darling_type) :: ad
      integer :: i

      do i = 1, size(reference_names)
         call run_anderson(reference_series(trim(reference_names(i)), 1000), ad)
         call check(error, ad%statistic, ad_statistic(i), reference_names(i), thr=tolerance, &
            & rel=.true.)
         call check(error, ad%modified, ad_statistic(i)*1.00075225_dp, reference_names(i), &
            & thr=tolerance, rel=.true.)
         call check(error, ad%p_value, ad_p_value(i), reference_names(i), thr=1.0e-11_dp, &
            & rel=.true.)
      end do
   end subroutine test_reference_anderson

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

      call run_anderson(chicks, ad)
      call check(error, ad%statistic, 0.214174258231198036_dp, thr=tolerance, rel=.true.)
      call run_anderson(men, ad)
      call check(error, ad%statistic, 0.946771879598887294_dp, thr=tolerance, rel=.true.)
      call run_anderson(real(telephone, dp), ad)
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
      call run_anderson(x, ad)
      call check(error, ad%statistic > 1000.0_dp .and. ad%statistic < 1.0e4_dp, "a far outlier")
      call run_anderson([(0.1_dp*real(i, dp), i=-10, 10), -40.0_dp, 55.0_dp], ad)
      call check(error, ad%statistic, 6.09608264544221385_dp, thr=tolerance, rel=.true.)
   end subroutine test_far_tails

   !> Ties are no trouble.
   subroutine test_two_valued()
      type(anderson_darling_type) :: ad
      integer :: i

      call run_anderson([(real(mod(i, 2), dp), i=1, 20)], ad)
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
   subroutine test_offset_scale_anderson()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run_anderson(x, a)
      call run_anderson((x + 1048576.0_dp)*2.0_dp**(-60), b)
      call check(error, b%statistic, a%statistic, thr=1.0e-11_dp, rel=.true.)
      call run_anderson(-x, b)
      call check(error, b%statistic, a%statistic, thr=1.0e-11_dp, rel=.true.)
      call run_anderson(1.0e6_dp + 1.0e-3_dp*x, b)
      call check(error, b%statistic, a%statistic, thr=1.0e-7_dp, rel=.true.)
   end subroutine test_offset_scale_anderson

   !> Missing samples count as if they were not there, also where the series is thinned.
   subroutine test_missing()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(3000)
      integer :: i

      x = reference_series("wn", 3000)
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 3000)]
      call run_anderson(x, a, valid, 500_int64)
      call run_anderson(pack(x, valid == 1_int8), b, most=500_int64)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, a%stride == 5_int64 .and. a%samples == b%samples .and. a%samples <= 500_int64, "stride and samples")
      where (valid == 0_int8) x = 1.0e30_dp
      call run_anderson(x, b, valid, 500_int64)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
   end subroutine test_missing

   !> Every third sample of 3000, and the same samples alone.
   subroutine test_thinned()
      type(anderson_darling_type) :: a, b
      real(dp), allocatable :: x(:)

      x = reference_series("ar1", 3000)
      call run_anderson(x, a, most=1000_int64)
      call run_anderson(x(::3), b)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      call check(error, a%stride == 3_int64 .and. a%samples == 1000_int64 .and. b%stride == 1_int64, "stride and samples")
      call check(error, a%distance, sqrt(a%statistic/1000.0_dp), thr=tolerance)
   end subroutine test_thinned

   !> Rounding 70,000 normal samples to half a standard deviation gives what the formula says, to a tenth.
   subroutine test_rounding()
      type(anderson_darling_type) :: ad
      real(dp), allocatable :: x(:)

      x = reference_series("wn_bm", 70000)
      call run_anderson(0.5_dp*anint(x/0.5_dp), ad)
      call check(error, ad%statistic, rounding_statistic(0.5_dp, 70000_int64), thr=0.1_dp, rel=.true.)
   end subroutine test_rounding

   !> Seven samples, a constant series, a limit of seven.
   subroutine test_failures_anderson()
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
   end subroutine test_failures_anderson

end module test_normality
