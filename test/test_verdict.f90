! SPDX-License-Identifier: MIT
!> Tests of the verdict on drift: the trend in the means of blocks, each verdict on noise that has it, and that no coefficient
!> says what the verdict excludes.
module test_verdict
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use gyroakf_allan_trend_test, only : block_count, block_means, find_trend, record_trend_type, trend_means, trend_test_options, &
      & trend_values
   use gyroakf_pipeline, only : channel_result_type, pipeline_options, pipeline_result_type, run_pipeline
   use expectations, only : failed => problem, test, error, check
   implicit none (type, external)
   private
   public :: suite_verdict

   !> Noise whose verdict is known; at least so many of 8 records have it
   type :: case_type
      character(10) :: name
      real(dp) :: coefficient(5)
      real(dp) :: phi = 0.0_dp, warm_up(2) = 0.0_dp
      integer(int64) :: samples = 10000
      character(21) :: drift(2)
      integer :: least = 6
   end type case_type

   type(case_type), parameter :: cases(*) = [ &
      & case_type("white", [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], drift=[character(21) :: "none", "flicker"]), &
      & case_type("flicker", [0.0_dp, 3.0_dp, 1.0_dp, 0.0_dp, 0.0_dp], drift=[character(21) :: "flicker", "flicker"]), &
      & case_type("AR(1)", spread(0.0_dp, 1, 5), phi=0.95_dp, drift=[character(21) :: "none", "colored"]), &
      & case_type("walk", [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp], &
      &           drift=[character(21) :: "random_walk", "trend_and_random_walk"]), &
      & case_type("N and K", [0.0_dp, 1.0_dp, 0.0_dp, 0.02_dp, 0.0_dp], &
      &           drift=[character(21) :: "random_walk", "trend_and_random_walk"]), &
      & case_type("ramp", [0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 5.0e-5_dp], drift=[character(21) :: "trend", "trend"]), &
      & case_type("warm-up", [0.0_dp, 3.0_dp, 0.3_dp, 0.0_dp, 0.0_dp], warm_up=[5.0_dp, 1000.0_dp], &
      &           drift=[character(21) :: "trend", "trend"])]
   integer, parameter :: records = 8

contains

   subroutine suite_verdict()
      call test("block_means", test_means)
      call test("exact_trend", test_exact)
      call test("stated_errors", test_errors)
      call test("verdicts", test_verdicts)
      call test("own_terms", test_own_terms)
      call test("short_record", test_short)
   end subroutine suite_verdict

   !> Means of 128 blocks of 5; missing samples do not count, and blocks without a sample are bridged.
   subroutine test_means()
      integer, parameter :: n = 5*block_count + 3
      real(dp) :: x(n), mean(block_count)
      integer(int8) :: valid(n)
      logical :: enough
      integer :: i

      x = [(real(i, dp), i=1, n)]
      call block_means(x, mean, enough)
      call check(error, enough .and. all(abs(mean - [(5*i - 2.0_dp, i=1, block_count)]) < 1.0e-12_dp), "complete")
      valid = 1
      valid([1, 2]) = 0
      valid(11:20) = 0
      valid(636:) = 0
      call block_means(x, mean, enough, valid)
      call check(error, enough .and. all(abs(mean(:6) - [4.0_dp, 8.0_dp, 13.0_dp, 18.0_dp, 23.0_dp, 28.0_dp]) < 1.0e-12_dp), &
         "missing")
      call check(error, mean(block_count), mean(block_count - 1), thr=1.0e-12_dp)
      valid(:400) = 0
      call block_means(x, mean, enough, valid)
      call check(error,.not. enough, "more than half of the blocks are empty")
      call block_means(x(:511), mean, enough)
      call check(error,.not. enough, "blocks of three samples")
   end subroutine test_means

   !> Trends under next to no noise: their sizes, and their means.
   subroutine test_exact()
      integer(int64), parameter :: n = 20000
      type(record_trend_type) :: truth, found
      real(dp) :: x(n), mean(block_count)
      integer(int64) :: i
      integer :: k
      logical :: enough

      truth%shape = "ramp"
      truth%size = -3
      do k = 1, 2
         x = trend_values(truth, n, [(i, i=1, n)])
         call block_means(x, mean, enough)
         call check(error, maxval(abs(mean - trend_means(truth, n))) < 1.0e-11_dp, "means of "//truth%shape)
         mean = mean + 1.0e-3_dp*[(sin(real(i, dp)**2), i=1, block_count)]
         call find_trend(mean, n, trend_test_options(), found, failed)
         call check(error, found%shape, truth%shape)
         call check(error, found%size, truth%size, rel=.true., thr=3.0e-3_dp)
         call check(error, found%time_constant, truth%time_constant, rel=k == 2, thr=5.0e-3_dp)
         truth%shape = "warm-up"
         truth%size = 2
         truth%time_constant = 3000
      end do
      mean = 1
      call find_trend(mean, n, trend_test_options(), found, failed)
      call check(error, found%shape, "       ")
   end subroutine test_exact

   !> Stated standard errors of ramps and warm-ups against the scatter of 60 records.
   subroutine test_errors()
      integer, parameter :: trials = 60
      type(simulate_options) :: options
      type(record_type) :: record
      type(record_trend_type) :: trend, truth
      real(dp) :: size_found(trials), stated(trials), mean(block_count), scatter
      integer(int64) :: i
      integer :: k, j
      logical :: enough

      options%samples = 4096
      options%coefficient(2:3) = [1.0_dp, 0.3_dp]
      truth%shape = "ramp"
      truth%size = 3
      do j = 1, 2
         do k = 1, trials
            options%seed = 5000*j + k
            call simulate_record(options, record, failed)
            record%value(:, 1) = record%value(:, 1) + trend_values(truth, options%samples, [(i, i=1, options%samples)])
            call block_means(record%value(:, 1), mean, enough)
            call find_trend(mean, options%samples, trend_test_options(ramp_gain=-1.0e9_dp, warm_up_gain=-1.0e9_dp, &
               & curved_margin=merge(1.0e9_dp, -1.0e9_dp, j == 1)), trend, failed)
            size_found(k) = trend%size
            stated(k) = trend%std_error
         end do
         scatter = sqrt(sum((size_found - truth%size)**2)/trials)
         call check(error, sum(stated)/trials/scatter, 1.0_dp, thr=0.4_dp)
         truth%shape = "warm-up"
         truth%size = 6
         truth%time_constant = 600
      end do
   end subroutine test_errors

   !> The verdict of one record.
   subroutine judge_record(case, seed, channel, terms)
      type(case_type), intent(in) :: case
      integer, intent(in) :: seed
      type(channel_result_type), intent(out) :: channel
      character(*), intent(in) :: terms
      type(simulate_options) :: simulated
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(record_type) :: record
      integer :: i

      simulated%samples = case%samples
      simulated%rate_hz = 1
      simulated%seed = seed
      simulated%coefficient = case%coefficient
      if (abs(case%phi) > 0) then
         simulated%ar = [case%phi]
         simulated%ar_variance = 1
      end if
      call simulate_record(simulated, record, failed)
      if (case%warm_up(1) > 0) record%value(:, 1) = record%value(:, 1) + &
         & case%warm_up(1)*exp(-[(i, i=0, int(case%samples) - 1)]/case%warm_up(2))
      options%do_tests = .false.
      options%do_ar = .false.
      options%do_filter = .false.
      options%clean%method = "none"
      options%clean%degree = -1
      options%noise%terms = terms
      call run_pipeline(record, options, result, failed)
      channel = result%channel(1)
   end subroutine judge_record

   !> Each verdict, and that no coefficient says what it excludes.
   subroutine test_verdicts()
      type(channel_result_type) :: channel
      character(80) :: text
      integer :: k, i, right

      do k = 1, size(cases)
         right = 0
         do i = 1, records
            call judge_record(cases(k), 100*k + i, channel, "auto")
            if (any(channel%verdict%drift == cases(k)%drift)) right = right + 1
            call check_consistent(channel)
         end do
         write (text, "(2a, i0, a, i0)") trim(cases(k)%name), ": ", right, " of ", records
         call check(error, right >= cases(k)%least, trim(text))
      end do
   end subroutine test_verdicts

   !> Statements that exclude each other.
   subroutine check_consistent(channel)
      type(channel_result_type), intent(in) :: channel

      associate (verdict => channel%verdict, k => channel%allan(1)%stated%term(4), r => channel%allan(1)%stated%term(5))
         call check(error, .not. (verdict%stationary .and. verdict%drifts), "both")
         if (.not. allocated(error)) call check(error, verdict%known .and. .not. (verdict%stationary .and. (k%detected .or. &
            & r%detected)), "stationary, and K or R")
         if (.not. allocated(error)) call check(error, verdict%trend%shape == "" .or. .not. (r%fitted .or. verdict%stationary), &
            & "a trend, and R or stationary")
         if (.not. allocated(error)) call check(error, .not. k%detected .or. index(verdict%drift, "random_walk") > 0, &
            & "K, and no random walk: "//verdict%drift)
         if (.not. allocated(error)) call check(error, verdict%drift /= "random_walk" .or. k%detected, "a random walk, and no K")
      end associate
   end subroutine check_consistent

   !> With terms of the user's own the verdict is the same, and does not rest on them.
   subroutine test_own_terms()
      type(channel_result_type) :: channel

      call judge_record(cases(5), 4321, channel, "NB")
      call check(error, channel%verdict%drift, "random_walk          ")
      call check(error, channel%allan(1)%stated%term(4)%state == "", "K was not asked for")
   end subroutine test_own_terms

   !> A record of 500 samples has no verdict.
   subroutine test_short()
      type(channel_result_type) :: channel
      type(case_type) :: case

      case = cases(1)
      case%samples = 500
      call judge_record(case, 1, channel, "auto")
      call check(error, channel%verdict%wanted .and. .not. channel%verdict%known .and. .not. channel%verdict%stationary)
      call check(error, channel%verdict%drift, "undescribed          ")
   end subroutine test_short

end module test_verdict
