! SPDX-License-Identifier: MIT
!> Tests of Jarque-Bera and of the verdict on normality. The reference values were computed in exact
!> arithmetic from the doubles of the series (series_library, 1000 samples each) and rounded once.
module test_normality
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : status
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_channel_tests, only : find_step, run_distribution
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_normality, only : jarque_bera_type, test_jarque_bera, skewness_error, &
      & kurtosis_error, judge_normality
   use series_library, only : reference_series, reference_names
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_normality

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
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The test
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
      call find_step(job, channel, problem)
      if (.not. allocated(problem)) call run_distribution(x, job, channel, problem)
      if (went_wrong(problem)) return
      call check(error, channel%anderson_darling%p_value < 1.0e-20_dp, "normal by Anderson-Darling")
      call check(error, trim(channel%normality), expected)
   end subroutine check_verdict

end module test_normality
