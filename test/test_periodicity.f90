! SPDX-License-Identifier: MIT
!> Tests of spectral lines and of the analysis of periodicity.
module test_periodicity
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_simulate_random, only : random_type, seed_random, fill_normal
   use gyroakf_series_lines, only : line_options, line_type, find_lines
   use gyroakf_series_periodicity, only : periodicity_options, periodicity_type, analyse_periodicity, whiten_series, even_length
   use series_library, only : reference_series
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_periodicity

   real(dp), parameter :: turn = 6.28318530717958647693_dp

contains

   subroutine collect_periodicity(testsuite)
      !> Tests of this module
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("reference_sine", test_reference_sine), &
         new_unittest("cramer_rao", test_cramer_rao), &
         new_unittest("coloured", test_coloured), &
         new_unittest("strong_line", test_strong_line), &
         new_unittest("harmonics", test_harmonics), &
         new_unittest("wandering", test_wandering), &
         new_unittest("no_lines", test_no_lines), &
         new_unittest("gaps", test_gaps), &
         new_unittest("invariance", test_invariance), &
         new_unittest("threads", test_threads), &
         new_unittest("middle_part", test_middle_part), &
         new_unittest("perfect_sinusoid", test_perfect), &
         new_unittest("residuals", test_residuals), &
         new_unittest("even_length", test_even_length), &
         new_unittest("failures", test_failures)]
   end subroutine collect_periodicity

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

   !> The reference series with amplitude 0.3 at a twentieth of the rate.
   subroutine test_reference_sine(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem

      call analyse_periodicity(reference_series("sine", 12000), 0.2_dp, periodicity_options(), p, problem)
      call check(error, size(p%line), 1)
      if (allocated(error)) return
      call check(error, p%line(1)%frequency, 0.25_dp, thr=4*p%line(1)%frequency_error)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude, 0.3_dp, thr=4*p%line(1)%amplitude_error)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude_error, sqrt(2/12000.0_dp), thr=0.1_dp*sqrt(2/12000.0_dp))
      if (allocated(error)) return
      call check(error, p%line(1)%share, 0.045_dp/1.045_dp, thr=0.005_dp)
      if (allocated(error)) return
      call check(error, p%line(1)%p_value < 1.0e-50_dp .and. p%line(1)%steady .and. p%line(1)%harmonic == 0)
      if (allocated(error)) return
      call check(error, p%fisher%p_value < 1.0e-100_dp .and. abs(p%fisher%frequency - 0.05_dp) < 1.0e-4_dp)
   end subroutine test_reference_sine

   !> 40 records: errors of frequency and amplitude are as large as stated, which is the Cramer-Rao bound.
   subroutine test_cramer_rao(error)
      type(error_type), allocatable, intent(out) :: error
      type(line_type), allocatable :: line(:)
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      real(dp) :: f, score(2), mean(2)
      integer :: i

      score = 0
      mean = 0
      do i = 1, 40
         f = 0.123_dp + 0.00007_dp*i              ! anywhere between the ordinates
         call make(i, 1000, 0.0_dp, f, 0.5_dp, x)
         call find_lines(x, 1.0_dp, line_options(), line, problem)
         call check(error, size(line), 1)
         if (allocated(error)) return
         score = score + [((line(1)%frequency - f)/line(1)%frequency_error)**2, &
                          ((line(1)%amplitude - 0.5_dp)/line(1)%amplitude_error)**2]
         mean = mean + [line(1)%frequency_error, line(1)%amplitude_error]/40
      end do
      call check(error, all(sqrt(score/40) > 0.7_dp .and. sqrt(score/40) < 1.35_dp))
      if (allocated(error)) return
      call check(error, mean(1), sqrt(24/(0.25_dp*1.0e9_dp))/turn, thr=0.1_dp*mean(1))
      if (allocated(error)) return
      call check(error, mean(2), sqrt(2.0e-3_dp), thr=0.1_dp*mean(2))
   end subroutine test_cramer_rao

   !> In AR(1) noise the amplitude is that of the series, not of the whitened one.
   subroutine test_coloured(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)

      call make(3, 6000, 0.95_dp, 0.02_dp, 1.0_dp, x)
      call analyse_periodicity(x, 0.01_dp, periodicity_options(), p, problem)
      call check(error, size(p%line) == 1 .and. p%order >= 1)
      if (allocated(error)) return
      call check(error, p%line(1)%frequency, 2.0_dp, thr=4*p%line(1)%frequency_error)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude, 1.0_dp, thr=4*p%line(1)%amplitude_error)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude_error < 0.2_dp)
   end subroutine test_coloured

   !> 80 dB over the noise: one line, as exact as the noise allows, the model that of the noise.
   subroutine test_strong_line(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)

      call make(4, 4000, 0.7_dp, 0.21_dp, 1.0e4_dp, x)
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), p, problem)
      call check(error, size(p%line), 1)
      if (allocated(error)) return
      call check(error, p%line(1)%frequency, 0.21_dp, thr=1.0e-9_dp)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude, 1.0e4_dp, thr=0.1_dp)
      if (allocated(error)) return
      call check(error, p%line(1)%amplitude_error < 0.05_dp)
   end subroutine test_strong_line

   !> Two families: 2 x and 3 x of the one, nothing of the other.
   subroutine test_harmonics(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      integer :: t

      call make(5, 8000, 0.3_dp, 0.0701_dp, 1.0_dp, x)
      x = x + [(0.4_dp*cos(turn*0.1402_dp*t) + 0.3_dp*cos(turn*0.2103_dp*t) + 0.3_dp*cos(turn*0.1537_dp*t), t=0, 7999)]
      call analyse_periodicity(x, 0.01_dp, periodicity_options(), p, problem)
      call check(error, size(p%line), 4)
      if (allocated(error)) return
      call check(error, all(p%line%harmonic == [0, 2, 0, 3]))
      if (allocated(error)) return
      call check(error, all(p%line%fundamental == [0, 1, 0, 1]))
      if (allocated(error)) return
      call check(error, all(p%line(2:)%frequency > p%line(:3)%frequency))
   end subroutine test_harmonics

   !> A line whose phase wanders is one line, not many, and not steady; its power is that of the whole.
   subroutine test_wandering(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:), turns(:)
      integer :: t

      call make(6, 12000, 0.0_dp, 0.1_dp, 0.0_dp, x)
      turns = x
      do t = 2, 12000
         turns(t) = turns(t - 1) + 0.02_dp*turns(t)
      end do
      call make(7, 12000, 0.0_dp, 0.1_dp, 0.0_dp, x)
      x = x + [(2*cos(turn*0.2_dp*t + turns(t)), t=1, 12000)]
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), p, problem)
      call check(error, size(p%line) >= 1 .and. size(p%line) <= 2)
      if (allocated(error)) return
      t = maxloc(p%line%amplitude, 1)
      call check(error, .not. p%line(t)%steady .and. p%line(t)%width > 3.0_dp/12000)
      if (allocated(error)) return
      call check(error, p%line(t)%amplitude, 2.0_dp, thr=0.2_dp)
   end subroutine test_wandering

   !> White, coloured, drifting, coarsely quantised noise: nothing is found.
   subroutine test_no_lines(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: names(6) = [character(8) :: "wn", "wn_bm", "rw", "ar1", "ar1_99", "ar2"]
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      integer :: i

      do i = 1, size(names)
         call analyse_periodicity(reference_series(trim(names(i)), 12000), 1.0_dp, periodicity_options(), p, problem)
         call check(error, .not. allocated(problem), names(i))
         if (allocated(error)) return
         call check(error, size(p%line), 0, names(i))
         if (allocated(error)) return
      end do
      call analyse_periodicity(anint(0.4_dp*reference_series("wn", 12000)), 1.0_dp, periodicity_options(), p, problem)
      call check(error, size(p%line), 0, "quantised")
   end subroutine test_no_lines

   !> Through 30 % of missing samples; their values do not matter.
   subroutine test_gaps(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: a, b
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:), uniform(:)
      integer(int8), allocatable :: valid(:)

      call make(8, 6000, 0.5_dp, 0.3333_dp, 0.5_dp, x)
      uniform = reference_series("unif", 6000)
      allocate (valid(6000))
      valid = 1_int8
      where (uniform < 0.3_dp) valid = 0_int8
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), a, problem, valid)
      call check(error, size(a%line), 1)
      if (allocated(error)) return
      call check(error, a%line(1)%frequency, 0.3333_dp, thr=4*a%line(1)%frequency_error)
      if (allocated(error)) return
      call check(error, a%line(1)%amplitude, 0.5_dp, thr=4*a%line(1)%amplitude_error)
      if (allocated(error)) return
      where (valid == 0_int8) x = 1.0e7_dp
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), b, problem, valid)
      call check(error, b%line(1)%amplitude, a%line(1)%amplitude, thr=0.0_dp)
   end subroutine test_gaps

   !> Offset 1e6 under a signal of 1e-3; scale.
   subroutine test_invariance(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: a, b
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)

      call make(9, 3000, 0.5_dp, 0.11_dp, 0.5_dp, x)
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), a, problem)
      call analyse_periodicity(1.0e6_dp + 1.0e-3_dp*x, 1.0_dp, periodicity_options(), b, problem)
      call check(error, size(a%line) == 1 .and. size(b%line) == 1)
      if (allocated(error)) return
      call check(error, b%line(1)%frequency, a%line(1)%frequency, thr=1.0e-9_dp)
      if (allocated(error)) return
      call check(error, b%line(1)%amplitude, 1.0e-3_dp*a%line(1)%amplitude, thr=1.0e-10_dp)
      if (allocated(error)) return
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=1.0e-7_dp)
      if (allocated(error)) return
      call analyse_periodicity(-1024*x, 1.0_dp, periodicity_options(), b, problem)
      call check(error, b%line(1)%amplitude, 1024*a%line(1)%amplitude, thr=1.0e-9_dp)
   end subroutine test_invariance

   !> The same on one thread and on two.
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: a, b
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)
      integer :: before

      call make(11, 150000, 0.5_dp, 0.11_dp, 0.3_dp, x)
      before = thread_count()
      call set_thread_count(1)
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), a, problem)
      call set_thread_count(2)
      if (.not. allocated(problem)) call analyse_periodicity(x, 1.0_dp, periodicity_options(), b, problem)
      call set_thread_count(before)
      call check(error, .not. allocated(problem), "it failed")
      if (allocated(error)) return
      call check(error, size(a%line) == 1 .and. size(b%line) == 1)
      if (allocated(error)) return
      call check(error, b%line(1)%frequency, a%line(1)%frequency, thr=0.0_dp)
      if (allocated(error)) return
      call check(error, b%line(1)%amplitude, a%line(1)%amplitude, thr=0.0_dp)
      if (allocated(error)) return
      call check(error, b%fisher%statistic, a%fisher%statistic, thr=0.0_dp)
   end subroutine test_threads

   !> At most so many samples of the middle.
   subroutine test_middle_part(error)
      type(error_type), allocatable, intent(out) :: error
      type(periodicity_type) :: a, b
      type(periodicity_options) :: options
      type(gyro_error), allocatable :: problem
      real(dp), allocatable :: x(:)

      call make(10, 6000, 0.5_dp, 0.11_dp, 1.0_dp, x)
      options%longest = 1000
      options%ar%order = 1
      call analyse_periodicity(x, 1.0_dp, options, a, problem)
      call check(error, int(a%samples) == 1000 .and. int(a%first) == 2501 .and. a%order == 1 .and. int(a%total) == 6000)
      if (allocated(error)) return
      call check(error, size(a%line), 1)
      if (allocated(error)) return
      x(:2498) = 0
      x(3503:) = 0
      call analyse_periodicity(x, 1.0_dp, options, b, problem)
      call check(error, b%line(1)%frequency, a%line(1)%frequency, thr=1.0e-5_dp)
   end subroutine test_middle_part

   !> Without noise: the line, and not its rounding.
   subroutine test_perfect(error)
      type(error_type), allocatable, intent(out) :: error
      type(line_type), allocatable :: line(:)
      type(periodicity_type) :: p
      type(gyro_error), allocatable :: problem
      real(dp) :: x(1000)
      integer :: t

      x = [(2*cos(turn*0.1234_dp*t), t=0, 999)]
      call find_lines(x, 1.0_dp, line_options(), line, problem)
      call check(error, size(line), 1)
      if (allocated(error)) return
      call check(error, line(1)%frequency, 0.1234_dp, thr=1.0e-12_dp)
      if (allocated(error)) return
      call check(error, line(1)%amplitude, 2.0_dp, thr=1.0e-10_dp)
      if (allocated(error)) return
      call analyse_periodicity(x, 1.0_dp, periodicity_options(), p, problem)
      call check(error, .not. allocated(problem))
      if (allocated(error)) return
      call check(error, maxval(p%line%amplitude), 2.0_dp, thr=1.0e-6_dp)
   end subroutine test_perfect

   !> Residuals by hand; one missing sample takes p + 1 of them.
   subroutine test_residuals(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: e(:)
      integer(int8), allocatable :: here(:)
      type(gyro_error), allocatable :: problem

      call whiten_series([1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem)
      call check(error, all(abs(e - [2.5_dp, 3.5_dp, 5.5_dp]) < 1.0e-15_dp) .and. .not. allocated(here))
      if (allocated(error)) return
      call whiten_series([1.0_dp, 2.0_dp, 4.0_dp, 8.0_dp, 16.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem, &
                         [0_int8, 1_int8, 1_int8, 1_int8, 1_int8])
      call check(error, all(here == [0_int8, 1_int8, 1_int8]) .and. abs(e(2) - 3.5_dp) < 1.0e-15_dp)
      if (allocated(error)) return
      call whiten_series([1.0_dp, 2.0_dp], 1.0_dp, [0.5_dp, 2.0_dp], e, here, problem)
      call check(error, allocated(problem), "nothing left")
      if (allocated(error)) return
      call check(error, problem%code, status%too_few_samples)
   end subroutine test_residuals

   !> Lengths that the transform likes.
   subroutine test_even_length(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, all([even_length(1048577_int64), even_length(100003_int64), even_length(7_int64), even_length(34_int64)] &
                            == [1048576_int64, 100000_int64, 6_int64, 32_int64]))
   end subroutine test_even_length

   !> Too short, constant, options out of range.
   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:), flat(:)

      x = reference_series("wn", 100)
      flat = 0*x + 0.1_dp
      call expect(x(:31), 1.0_dp, line_options(), status%too_few_samples, error)
      if (.not. allocated(error)) call expect(flat, 1.0_dp, line_options(), status%constant_input, error)
      if (.not. allocated(error)) call expect(x, -1.0_dp, line_options(), status%invalid_argument, error)
      if (.not. allocated(error)) call expect(x, 1.0_dp, line_options(most=-1), status%invalid_argument, error)
      if (.not. allocated(error)) call expect(x, 1.0_dp, line_options(false_alarm=0.0_dp), status%invalid_argument, error)
      if (.not. allocated(error)) call expect(x(:32), 1.0_dp, line_options(most=0), status%ok, error)
   end subroutine test_failures

   !> The status of one call.
   subroutine expect(x, dt, options, code, error)
      real(dp), intent(in) :: x(:)
      real(dp), intent(in) :: dt
      type(line_options), intent(in) :: options
      integer, intent(in) :: code
      type(error_type), allocatable, intent(out) :: error
      type(line_type), allocatable :: line(:)
      type(gyro_error), allocatable :: problem
      integer :: got

      call find_lines(x, dt, options, line, problem)
      got = status%ok
      if (allocated(problem)) got = problem%code
      call check(error, got, code)
   end subroutine expect

end module test_periodicity
