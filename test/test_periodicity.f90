! SPDX-License-Identifier: MIT
!> Tests of Fisher's test of a correlated series.
module test_periodicity
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_random, only : random_type, seed_random, fill_normal
   use gyroakf_stats_fisher, only : fisher_type, test_fisher_g
   use gyroakf_ar_periodicity, only : periodicity_options, periodicity_type, analyze_periodicity, &
      whiten_series, even_length
   use series_library, only : reference_series
   use expectations, only : unmet, problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_periodicity

   real(dp), parameter :: turn = 6.28318530717958647693_dp

contains

   subroutine suite_periodicity()
      call test("reference_sine", test_reference_sine)
      call test("correlated", test_correlated)
      call test("dominant", test_dominant)
      call test("nothing_periodic", test_nothing_periodic)
      call test("given_model", test_given_model)
      call test("gaps", test_gaps)
      call test("invariance", test_invariance)
      call test("threads", test_threads)
      call test("middle_part", test_middle_part)
      call test("perfect_sinusoid", test_perfect)
      call test("residuals", test_residuals)
      call test("even_length", test_even_length)
      call test("failures", test_failures)
   end subroutine suite_periodicity

   !> Noise of a seed, of unit variance, through an AR(1), and a sinusoid.
   subroutine make(seed, n, phi, frequency, amplitude, x)
      integer, intent(in) :: seed, n
      real(dp), intent(in) :: phi, frequency, amplitude
      real(dp), allocatable, intent(out) :: x(:)
      type(random_type) :: random
      integer :: t

      allocate (x(n))
      call seed_random(random, int(seed, int64))
      call fill_normal(random, x)
      do t = 2, n
         x(t) = x(t) + phi*x(t - 1)
      end do
      x = x + [(amplitude*cos(turn*frequency*t + 0.1_dp*seed), t=0, n - 1)]
   end subroutine make

   !> The largest ordinate is the nearest or second nearest to a frequency in cycles per sample.
   pure logical function near(p, frequency)
      type(periodicity_type), intent(in) :: p
      real(dp), intent(in) :: frequency

      near = abs(p%fisher%frequency - frequency) < 1.0_dp/real(p%fisher%samples, dp)
   end function near

   !> The reference series with amplitude 0.3 at a twentieth of the rate.
   subroutine test_reference_sine()
      type(periodicity_type) :: p

      call analyze_periodicity(reference_series("sine", 12000), periodicity_options(), p, problem)
      if (went_wrong(problem)) return
      call check(error, p%fisher%p_value < 1.0e-90_dp .and. near(p, 0.05_dp))
   end subroutine test_reference_sine

   !> In AR(1) noise the residuals are tested.
   subroutine test_correlated()
      type(periodicity_type) :: p
      real(dp), allocatable :: x(:)

      call make(3, 6000, 0.95_dp, 0.02_dp, 1.0_dp, x)
      call analyze_periodicity(x, periodicity_options(), p, problem)
      call check(error, p%order >= 1 .and. p%samples == 6000 - p%order .and. p%first == p%order + 1)
      call check(error, p%fisher%p_value < 1.0e-4_dp .and. near(p, 0.02_dp))
   end subroutine test_correlated

   !> A sinusoid 20 to 80 dB over the noise, on an ordinate and half way between two: AR(3) would predict
   !> it.
   subroutine test_dominant()
      real(dp), parameter :: frequency(4) = [0.21_dp, 0.210125_dp, 0.0725_dp, 0.4333_dp]
      type(periodicity_type) :: p
      real(dp), allocatable :: x(:)
      integer :: i, j

      do i = 1, size(frequency)
         do j = 0, 3
            call make(4 + i, 4000, 0.7_dp, frequency(i), 10.0_dp*10**j, x)
            call analyze_periodicity(x, periodicity_options(), p, problem)
            call check(error, p%order == 0 .and. p%samples == 4000 .and. p%fisher%peak > 0.75_dp)
            call check(error, p%fisher%p_value < 1.0e-100_dp .and. near(p, frequency(i)))
         end do
      end do
   end subroutine test_dominant

   !> White, correlated, drifting, coarsely quantized noise: nothing is significant, and the residuals are
   !> tested where the noise is correlated.
   subroutine test_nothing_periodic()
      character(8), parameter :: names(6) = [character(8) :: "wn", "wn_bm", "rw", "ar1", "ar1_99", "ar2"]
      type(periodicity_type) :: p
      real(dp), allocatable :: x(:)
      integer :: i

      do i = 1, size(names)
         x = reference_series(trim(names(i)), 12000)
         call analyze_periodicity(x, periodicity_options(), p, problem)
         if (went_wrong(problem, names(i))) return
         call check(error, p%fisher%p_value > 0.01_dp, names(i))
         call check(error, p%order >= 1 .or. names(i)(:2) == "wn", names(i))
      end do
      x = anint(0.4_dp*reference_series("wn", 12000))
      call analyze_periodicity(x, periodicity_options(), p, problem)
      call check(error, p%fisher%p_value > 0.01_dp, "quantized")
   end subroutine test_nothing_periodic

   !> The test of the residuals of a given model, which is not fitted again.
   subroutine test_given_model()
      type(ar_model_type) :: model
      type(periodicity_type) :: p
      type(fisher_type) :: fisher
      real(dp), allocatable :: x(:), white(:)
      integer(int8), allocatable :: here(:)

      x = reference_series("ar1", 3000)
      model%order = 2
      model%mean = 0.25_dp
      model%coefficient = [0.5_dp, 0.25_dp]
      call analyze_periodicity(x, periodicity_options(), p, problem, model=model)
      call check(error, p%order == 2 .and. p%total == 3000)
      call whiten_series(x, model%mean, model%coefficient, white, here, problem)
      call test_fisher_g(white, fisher, problem)
      call check(error, p%fisher%statistic, fisher%statistic, thr=0.0_dp)
   end subroutine test_given_model

   !> Through 30 % of missing samples; their values do not matter.
   subroutine test_gaps()
      type(periodicity_type) :: a, b
      real(dp), allocatable :: x(:), uniform(:)
      integer(int8), allocatable :: valid(:)

      call make(8, 6000, 0.5_dp, 0.3333_dp, 0.5_dp, x)
      uniform = reference_series("unif", 6000)
      allocate (valid(6000))
      valid = 1_int8
      where (uniform < 0.3_dp) valid = 0_int8
      call analyze_periodicity(x, periodicity_options(), a, problem, valid)
      call check(error, a%order >= 1 .and. a%fisher%p_value < 1.0e-6_dp .and. near(a, 0.3333_dp))
      where (valid == 0_int8) x = 1.0e7_dp
      call analyze_periodicity(x, periodicity_options(), b, problem, valid)
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=0.0_dp)
      call make(8, 6000, 0.5_dp, 0.3333_dp, 1.0e3_dp, x)
      valid(:3000) = 1_int8
      valid(3300:) = 1_int8
      where (valid == 0_int8) x = 1.0e7_dp
      call analyze_periodicity(x, periodicity_options(), a, problem, valid)
      call check(error, a%order == 0 .and. near(a, 0.3333_dp), "a dominant sinusoid")
   end subroutine test_gaps

   !> Offset 1e6 under a signal of 1e-3; scale.
   subroutine test_invariance()
      type(periodicity_type) :: a, b
      real(dp), allocatable :: x(:)

      call make(9, 3000, 0.5_dp, 0.11_dp, 0.5_dp, x)
      call analyze_periodicity(x, periodicity_options(), a, problem)
      call analyze_periodicity(1.0e6_dp + 1.0e-3_dp*x, periodicity_options(), b, problem)
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=1.0e-7_dp)
      call analyze_periodicity(-1024*x, periodicity_options(), b, problem)
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=1.0e-12_dp)
   end subroutine test_invariance

   !> The same on one thread and on two.
   subroutine test_threads()
      type(periodicity_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before

      call make(11, 150000, 0.5_dp, 0.11_dp, 0.3_dp, x)
      before = thread_count()
      call set_thread_count(1)
      call analyze_periodicity(x, periodicity_options(), a, problem)
      call set_thread_count(2)
      if (.not. allocated(problem)) call analyze_periodicity(x, periodicity_options(), b, problem)
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=0.0_dp)
   end subroutine test_threads

   !> At most so many samples of the middle, of the residuals and of the series.
   subroutine test_middle_part()
      type(periodicity_type) :: a, b
      type(periodicity_options) :: options
      real(dp), allocatable :: x(:)

      call make(10, 6000, 0.5_dp, 0.11_dp, 1.0_dp, x)
      options%longest = 1000
      options%ar%order = 1
      call analyze_periodicity(x, options, a, problem)
      call check(error, a%samples == 1000 .and. a%first == 2501 .and. a%order == 1 .and. a%total == 6000)
      call check(error, a%fisher%p_value < 1.0e-20_dp .and. near(a, 0.11_dp))
      call make(10, 6000, 0.5_dp, 0.11_dp, 100.0_dp, x)
      call analyze_periodicity(x, options, a, problem)
      call check(error, a%samples == 1000 .and. a%first == 2501 .and. a%order == 0)
      x(:2500) = 0
      x(3501:) = 0
      call analyze_periodicity(x, options, b, problem)
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=0.0_dp)
   end subroutine test_middle_part

   !> Without noise: the sinusoid, and not its rounding.
   subroutine test_perfect()
      type(periodicity_type) :: p
      real(dp) :: x(1000)
      integer :: t

      x = [(2*cos(turn*0.1234_dp*t), t=0, 999)]
      call analyze_periodicity(x, periodicity_options(), p, problem)
      if (unmet(.not. allocated(problem) .and. p%order == 0)) return
      call check(error, p%fisher%frequency, 0.123_dp, thr=1.0e-12_dp)
   end subroutine test_perfect

   !> Residuals by hand; one missing sample takes p + 1 of them.
   subroutine test_residuals()
      real(dp), allocatable :: e(:)
      integer(int8), allocatable :: here(:)

      call whiten_series([1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem)
      if (unmet(all(abs(e - [2.5_dp, 3.5_dp, 5.5_dp]) < 1.0e-15_dp) .and. .not. allocated(here))) return
      call whiten_series([1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem, &
                         [0_int8, 1_int8, 1_int8, 1_int8, 1_int8])
      call check(error, all(here == [0_int8, 1_int8, 1_int8]) .and. abs(e(2) - 3.5_dp) < 1.0e-15_dp)
      call whiten_series([1.0_dp, 2.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem)
      call check_refused(problem, status%too_few_samples)
   end subroutine test_residuals

   !> Lengths that the transform likes.
   subroutine test_even_length()
      call check(error, all([even_length(1048577_int64), even_length(100003_int64), even_length(7_int64), even_length(34_int64)] &
                            == [1048576_int64, 100000_int64, 6_int64, 32_int64]))
   end subroutine test_even_length

   !> Too short, or the residuals are; constant.
   subroutine test_failures()
      type(periodicity_options) :: options
      real(dp), allocatable :: x(:), flat(:)

      x = reference_series("wn", 100)
      flat = 0*x + 0.1_dp
      options%ar%order = 1
      call expect(x(:31), options, status%too_few_samples)
      if (.not. allocated(error)) call expect(x(:32), options, status%too_few_samples)
      if (.not. allocated(error)) call expect(x(:33), options, status%ok)
      if (.not. allocated(error)) call expect(flat, options, status%constant_input)
   end subroutine test_failures

   !> The status of one call.
   subroutine expect(x, options, code)
      real(dp), intent(in) :: x(:)
      type(periodicity_options), intent(in) :: options
      integer, intent(in) :: code
      type(periodicity_type) :: p
      integer :: got

      call analyze_periodicity(x, options, p, problem)
      got = status%ok
      if (allocated(problem)) got = problem%code
      call check(error, got, code)
   end subroutine expect

end module test_periodicity
