! SPDX-License-Identifier: MIT
!> Tests of Jarque-Bera and D'Agostino's K2. The reference values were computed in exact or 40-digit arithmetic from the
!> doubles of the series (series_library, 1000 samples each) and rounded once.
module test_normality
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_series_moments, only : moments_type, compute_moments
   use gyroakf_series_normality, only : jarque_bera_type, test_jarque_bera, dagostino_type, test_dagostino, skewness_error, &
      & kurtosis_error, judge_normality
   use series_library, only : reference_series, reference_names
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_normality

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
   real(dp), parameter :: k2_of(11) = [ &
      & 0.847171481843767668_dp, 0.943697562345059357_dp, 877.617707603460085_dp, 135.944461944790441_dp, &
      & 1.27951783676877206_dp, 34.9115835676280989_dp, 9.55641034651998473_dp, 4.81159519987908916_dp, &
      & 1.3756280662020835_dp, 1.27951783508676922_dp, 1.16678420768932254_dp]
   real(dp), parameter :: z_skewness_of(11) = [ &
      & 0.908130008071456329_dp, -0.369009572671646953_dp, 0.754046135286259774_dp, -5.50317063491807383_dp, &
      & -0.739900108789912732_dp, 5.19920768750874359_dp, 1.64250990753726991_dp, 0.090259136031653846_dp, &
      & -1.04248877432822968_dp, -0.739900108425447744_dp, 0.911484831639930182_dp]
   real(dp), parameter :: z_kurtosis_of(11) = [ &
      & 0.149904537235883323_dp, -0.898626450546470318_dp, -29.61501514484367_dp, -10.2790843418937781_dp, &
      & 0.855608360046491929_dp, 2.80710224070625575_dp, 2.61888746420343419_dp, -2.19167709488462478_dp, &
      & 0.537443226398574027_dp, 0.855608359378740466_dp, 0.579637480999676788_dp]

contains

   !> The tests of this suite.
   subroutine collect_normality(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("by_hand", test_by_hand), &
         & new_unittest("reference", test_reference), &
         & new_unittest("offset_scale", test_offset_scale), &
         & new_unittest("failures", test_failures), &
         & new_unittest("k2_reference", test_k2_reference), &
         & new_unittest("k2_long", test_k2_long), &
         & new_unittest("k2_small", test_k2_small), &
         & new_unittest("k2_two_valued", test_two_valued), &
         & new_unittest("k2_offset_scale", test_k2_offset_scale), &
         & new_unittest("k2_missing", test_k2_missing), &
         & new_unittest("k2_failures", test_k2_failures), &
         & new_unittest("standard_errors", test_standard_errors), &
         & new_unittest("verdicts", test_verdicts)]
   end subroutine collect_normality

   !> -1 and 1: skewness 0, kurtosis 1, JB = 4/6 (2^2/4).
   subroutine test_by_hand(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(jarque_bera_type) :: jb

      call run([-1.0_dp, 1.0_dp, -1.0_dp, 1.0_dp], jb)
      call check(error, jb%statistic, 2.0_dp/3.0_dp, thr=tolerance)
      if (allocated(error)) return
      call check(error, jb%p_value, exp(-1.0_dp/3.0_dp), thr=tolerance)
      if (allocated(error)) return
      call check(error, jb%kurtosis, 1.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> Moments and test of a series that has both.
   subroutine run(x, jb)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The test
      type(jarque_bera_type), intent(out) :: jb
      type(moments_type) :: moments
      type(gyro_error), allocatable :: problem

      call compute_moments(x, moments)
      call test_jarque_bera(moments, jb, problem)
      if (allocated(problem)) jb%statistic = -1.0_dp
   end subroutine run

   !> The eleven series; the statistic of a nearly normal series is a small difference.
   subroutine test_reference(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(jarque_bera_type) :: jb
      integer :: i

      do i = 1, size(reference_names)
         call run(reference_series(trim(reference_names(i)), 1000), jb)
         call check(error, jb%statistic, statistic_of(i), reference_names(i), thr=tolerance, rel=.true.)
         if (allocated(error)) return
         call check(error, jb%p_value, p_value_of(i), reference_names(i), thr=tolerance*max(1.0_dp, statistic_of(i)), rel=.true.)
         if (allocated(error)) return
      end do
   end subroutine test_reference

   !> Powers of two are exact, and so is the offset for multiples of 1/1024.
   subroutine test_offset_scale(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(jarque_bera_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run(x, a)
      call run((x + 1048576.0_dp)*2.0_dp**(-60), b)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call run(-x, b)
      call check(error, b%skewness, -a%skewness, thr=tolerance)
      if (allocated(error)) return
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
   end subroutine test_offset_scale

   !> One sample; a constant series; samples whose squares are no numbers.
   subroutine test_failures(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments
      type(jarque_bera_type) :: jb
      type(gyro_error), allocatable :: problem

      call compute_moments([1.0_dp], moments)
      call test_jarque_bera(moments, jb, problem)
      call check(error, allocated(problem), "one sample was accepted")
      if (allocated(error)) return
      call check(error, problem%code, status%too_few_samples)
      if (allocated(error)) return
      call compute_moments([0.1_dp, 0.1_dp, 0.1_dp], moments)
      call test_jarque_bera(moments, jb, problem)
      call check(error, allocated(problem), "a constant series was accepted")
      if (allocated(error)) return
      call check(error, problem%code, status%constant_input)
      if (allocated(error)) return
      call compute_moments([0.0_dp, 1.0e-160_dp, 3.0e-160_dp], moments)
      call check(error, moments%std > 0.0_dp, "the deviation of tiny samples vanished")
      if (allocated(error)) return
      call test_jarque_bera(moments, jb, problem)
      call check(error, allocated(problem), "a variance that vanishes was accepted")
      if (allocated(error)) return
      call check(error, problem%code, status%constant_input)
   end subroutine test_failures

   !> K2 of a series; -1 where it fails.
   subroutine run_k2(x, k2, valid)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The test
      type(dagostino_type), intent(out) :: k2
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      type(moments_type) :: moments
      type(gyro_error), allocatable :: problem

      call compute_moments(x, moments, valid)
      call test_dagostino(moments, k2, problem)
      if (allocated(problem)) k2%statistic = -1.0_dp
   end subroutine run_k2

   !> The eleven series. A deviate carries the relative error of its skewness or excess kurtosis, which is small for some: the
   !> tolerance is absolute below 1.
   subroutine test_k2_reference(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: k2
      integer :: i

      do i = 1, size(reference_names)
         call run_k2(reference_series(trim(reference_names(i)), 1000), k2)
         call check(error, k2%statistic, k2_of(i), reference_names(i), thr=tolerance, rel=.true.)
         if (allocated(error)) return
         call check(error, k2%p_value, exp(-0.5_dp*k2_of(i)), reference_names(i), thr=tolerance*max(1.0_dp, k2_of(i)), rel=.true.)
         if (allocated(error)) return
         call check(error, k2%z_skewness, z_skewness_of(i), reference_names(i), thr=tolerance*max(1.0_dp, abs(z_skewness_of(i))))
         if (allocated(error)) return
         call check(error, k2%z_kurtosis, z_kurtosis_of(i), reference_names(i), thr=tolerance*max(1.0_dp, abs(z_kurtosis_of(i))))
         if (allocated(error)) return
      end do
   end subroutine test_k2_reference

   !> 12,000 samples; and 1e8 of chosen moments, where a plain evaluation loses six digits.
   subroutine test_k2_long(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: k2
      type(moments_type) :: moments
      type(gyro_error), allocatable :: problem

      call run_k2(reference_series("unif", 12000), k2)
      call check(error, k2%statistic, 10578.8226248008515_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call run_k2(reference_series("wn_bm", 12000), k2)
      call check(error, k2%statistic, 2.54864434770878346_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      moments%count = 100000000_int64
      moments%skewness = 2.0e-4_dp
      moments%kurtosis = 3.0007_dp
      call test_dagostino(moments, k2, problem)
      call check(error, .not. allocated(problem), "1e8 samples failed")
      if (allocated(error)) return
      call check(error, k2%z_skewness, 0.816496633999994224_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, k2%z_kurtosis, 1.42873669008312472_dp, thr=1.0e-11_dp, rel=.true.)
   end subroutine test_k2_long

   !> Weights of 11 men and of 20 chicks, in 40-digit arithmetic.
   subroutine test_k2_small(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: k2

      call run_k2([148.0_dp, 154.0_dp, 158.0_dp, 160.0_dp, 161.0_dp, 162.0_dp, 166.0_dp, 170.0_dp, &
         & 182.0_dp, 195.0_dp, 236.0_dp], k2)
      call check(error, k2%statistic, 13.0342631211925817_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, k2%p_value, 0.00147790230131001735_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call run_k2([156.0_dp, 162.0_dp, 168.0_dp, 182.0_dp, 186.0_dp, 190.0_dp, 190.0_dp, 196.0_dp, 202.0_dp, 210.0_dp, &
         & 214.0_dp, 220.0_dp, 226.0_dp, 230.0_dp, 230.0_dp, 236.0_dp, 236.0_dp, 242.0_dp, 246.0_dp, 270.0_dp], k2)
      call check(error, k2%statistic, 0.416943878944972571_dp, thr=tolerance, rel=.true.)
   end subroutine test_k2_small

   !> Two values have the smallest kurtosis there is, 1: the deviate stays negative beyond the pole of the cube root.
   subroutine test_two_valued(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: k2
      integer :: i

      call run_k2([(real(mod(i, 2), dp), i=1, 20)], k2)
      call check(error, k2%statistic, 51.5959953000960441_dp, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, k2%z_kurtosis < -7.0_dp, "the kurtosis of two values is not called low")
      if (allocated(error)) return
      call run_k2([(real(mod(i, 2), dp), i=1, 1000)], k2)
      call check(error, k2%z_kurtosis < -7.0_dp, "the kurtosis of two values is not called low beyond the pole")
   end subroutine test_two_valued

   !> As the Jarque-Bera test: exact under powers of two and multiples of 1/1024; 1e6 + 1e-3 x to what the doubles hold.
   subroutine test_k2_offset_scale(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 5000))/1024.0_dp
      call run_k2(x, a)
      call run_k2((x + 1048576.0_dp)*2.0_dp**(-60), b)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call run_k2(1.0e6_dp + 1.0e-3_dp*x, b)
      call check(error, b%statistic, a%statistic, thr=1.0e-7_dp, rel=.true.)
      if (allocated(error)) return
      call run_k2(-x, b)
      call check(error, b%z_skewness, -a%z_skewness, thr=tolerance)
   end subroutine test_k2_offset_scale

   !> Missing samples count as if they were not there.
   subroutine test_k2_missing(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(dagostino_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(3000)
      integer :: i

      x = reference_series("wn", 3000)
      valid = [(merge(0_int8, 1_int8, mod(i*i, 7) == 2), i=1, 3000)]
      call run_k2(pack(x, valid == 1_int8), a)
      where (valid == 0_int8) x = 1.0e30_dp
      call run_k2(x, b, valid)
      call check(error, b%statistic, a%statistic, thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, b%samples == a%samples, "samples")
   end subroutine test_k2_missing

   !> Seven samples; a constant series.
   subroutine test_k2_failures(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments
      type(dagostino_type) :: k2
      type(gyro_error), allocatable :: problem
      integer :: i

      call compute_moments([(real(i*i, dp), i=1, 7)], moments)
      call test_dagostino(moments, k2, problem)
      call check(error, allocated(problem), "seven samples were accepted")
      if (allocated(error)) return
      call check(error, problem%code, status%too_few_samples)
      if (allocated(error)) return
      call compute_moments([(0.1_dp, i=1, 9)], moments)
      call test_dagostino(moments, k2, problem)
      call check(error, allocated(problem), "a constant series was accepted")
      if (allocated(error)) return
      call check(error, problem%code, status%constant_input)
   end subroutine test_k2_failures

   !> n = 8: sqrt(6 6/99) and sqrt(24 8 6 5/(81 11 13)).
   subroutine test_standard_errors(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error

      call check(error, skewness_error(8_int64), sqrt(36.0_dp/99.0_dp), thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, kurtosis_error(8_int64), sqrt(5760.0_dp/11583.0_dp), thr=tolerance, rel=.true.)
      if (allocated(error)) return
      call check(error, kurtosis_error(10_int64**12)*sqrt(1.0e12_dp/24.0_dp), 1.0_dp, thr=1.0e-11_dp)
      if (allocated(error)) return
      call check(error, max(skewness_error(0_int64), kurtosis_error(0_int64)), 0.0_dp, thr=tolerance)
   end subroutine test_standard_errors

   !> The table of the verdicts.
   subroutine test_verdicts(error)
      !> Failure
      type(error_type), allocatable, intent(out) :: error

      call check(error, judge_normality(0.05_dp, 3.1_dp, 0.3_dp), "normal   ")
      if (allocated(error)) return
      call check(error, judge_normality(0.05_dp, 2.9_dp, 1.0e-10_dp), "nearly   ")
      if (allocated(error)) return
      call check(error, judge_normality(-0.5_dp, 3.0_dp, 0.3_dp), "undecided")
      if (allocated(error)) return
      call check(error, judge_normality(0.0_dp, 1.8_dp, 1.0e-10_dp), "not      ")
   end subroutine test_verdicts

end module test_normality
