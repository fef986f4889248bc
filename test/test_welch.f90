! SPDX-License-Identifier: MIT
!> Tests of Welch's spectrum.
module test_welch
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_stats_welch, only : welch_options, welch_type, welch_spectrum, default_segment
   use series_library, only : reference_series
   use expectations, only : problem, test, error, check, went_wrong
   implicit none (type, external)
   private
   public :: suite_welch

   real(dp), parameter :: turn = 6.28318530717958647693_dp
   !> Sums of some hundred products of doubles
   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_welch()
      call test("direct", test_direct)
      call test("parseval", test_parseval)
      call test("published_freedom", test_freedom)
      call test("sinusoid", test_sinusoid)
      call test("white_level", test_white_level)
      call test("limits", test_limits)
      call test("invariance", test_invariance)
      call test("large_offset", test_large_offset)
      call test("threads", test_threads)
      call test("gaps", test_gaps)
      call test("default_segment", test_default)
      call test("failures", test_failures)
   end subroutine suite_welch

   !> Against transforms by their definition: odd segments, every window.
   subroutine test_direct()
      character(8), parameter :: windows(4) = [character(8) :: "hann", "hamming", "blackman", "none"]
      type(welch_type) :: s
      real(dp), allocatable :: x(:)
      integer :: i, k

      x = 5.0_dp + reference_series("ar1", 100)
      do i = 1, size(windows)
         call welch_spectrum(x, 0.25_dp, welch_options(segment=33, window=windows(i), overlap=0.3_dp), s, problem)
         call check(error, int(s%step), 24)
         do k = 0, 16
            call check(error, s%density(k), direct(x, windows(i), 33, 24, k)*0.25_dp, thr=tolerance*maxval(s%density))
            call check(error, s%frequency(k), real(k, dp)/(33*0.25_dp), thr=tolerance)
            call check(error, s%one_sided(k), merge(1, 2, k == 0)*s%density(k), thr=0.0_dp)
         end do
      end do
   end subroutine test_direct

   !> Mean periodogram at one frequency, by its definition.
   pure real(dp) function direct(x, window, length, step, k)
      real(dp), intent(in) :: x(:)
      character(*), intent(in) :: window
      integer, intent(in) :: length, step, k
      real(dp) :: w(length), part(length)
      complex(dp) :: total
      integer :: first, t, segments

      select case (window)
      case ("hann"); w = [(sin(0.5_dp*turn*t/length)**2, t=0, length - 1)]
      case ("hamming"); w = [(0.54_dp - 0.46_dp*cos(turn*t/length), t=0, length - 1)]
      case ("blackman"); w = [(0.42_dp - 0.5_dp*cos(turn*t/length) + 0.08_dp*cos(2*turn*t/length), t=0, length - 1)]
      case default; w = 1.0_dp
      end select
      direct = 0.0_dp
      segments = 0
      do first = 1, size(x) - length + 1, step
         part = x(first:first + length - 1)
         part = w*(part - sum(part)/length)
         total = sum([(part(t + 1)*exp(cmplx(0.0_dp, -turn*mod(k*t, length)/length, dp)), t=0, length - 1)])
         direct = direct + abs(total)**2/sum(w**2)
         segments = segments + 1
      end do
      direct = direct/segments
   end function direct

   !> An offset forty million times the scatter costs no digit, with missing samples and without: the same samples less the offset,
   !> which no subtraction rounds.
   subroutine test_large_offset()
      real(dp), parameter :: offset = 1.0e6_dp
      type(welch_type) :: s, without
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(1000)
      integer :: round

      x = offset + 0.02_dp*reference_series("ar1", 1000)
      valid = 1
      valid([1, 77, 500]) = 0
      do round = 1, 2
         if (round == 1) then
            call welch_spectrum(x, 1.0_dp, welch_options(segment=128), s, problem)
            call welch_spectrum(x - offset, 1.0_dp, welch_options(segment=128), without, problem)
         else
            call welch_spectrum(x, 1.0_dp, welch_options(segment=128), s, problem, valid)
            call welch_spectrum(x - offset, 1.0_dp, welch_options(segment=128), without, problem, valid)
         end if
         call check(error, all(abs(s%density - without%density) <= tolerance*without%density))
      end do
   end subroutine test_large_offset

   !> One rectangular segment: the density over all frequencies is the variance.
   subroutine test_parseval()
      type(welch_type) :: s
      real(dp), allocatable :: x(:)
      real(dp) :: variance

      x = reference_series("wn", 1000)
      variance = sum((x - sum(x)/1000)**2)/1000
      call welch_spectrum(x, 0.01_dp, welch_options(segment=1000, window="none", overlap=0.0_dp), s, problem)
      call check(error, sum(s%one_sided)*s%resolution, variance, thr=tolerance)
      call check(error, (2*sum(s%density(1:499)) + s%density(0) + s%density(500))*s%resolution, variance, thr=tolerance)
      call check(error, s%degrees_of_freedom, 2.0_dp, thr=tolerance)
      call check(error, s%noise_bandwidth, s%resolution, thr=tolerance)
   end subroutine test_parseval

   !> Hann's window: noise bandwidth 3/2 of a bin; half overlap, K segments: 2 K/(1 + (1/18)(K - 1)/K) degrees of freedom.
   subroutine test_freedom()
      type(welch_type) :: s

      call welch_spectrum(reference_series("wn", 1000), 1.0_dp, welch_options(segment=100), s, problem)
      call check(error, int(s%segments), 19)
      call check(error, s%degrees_of_freedom, 38/(1 + 18.0_dp/(18*19)), thr=tolerance*38)
      call check(error, s%noise_bandwidth, 0.015_dp, thr=tolerance)
      call check(error, s%edf(0), 0.5_dp*s%degrees_of_freedom, thr=tolerance)
      call check(error, s%edf(50), 0.5_dp*s%degrees_of_freedom, thr=tolerance)
   end subroutine test_freedom

   !> A sinusoid of amplitude A in the middle of a bin: one-sided density A^2/2 over the noise bandwidth.
   subroutine test_sinusoid()
      type(welch_type) :: s
      real(dp) :: x(1024)
      integer :: t

      x = [(3*cos(turn*20*t/128 + 0.3_dp), t=0, 1023)]
      call welch_spectrum(x, 0.01_dp, welch_options(segment=128), s, problem)
      call check(error, s%one_sided(20), 4.5_dp/s%noise_bandwidth, thr=tolerance*10)
      call check(error, sum(s%one_sided)*s%resolution, 4.5_dp, thr=tolerance*10)
   end subroutine test_sinusoid

   !> White noise of variance v at interval dt has the two-sided density v dt.
   subroutine test_white_level()
      type(welch_type) :: s

      call welch_spectrum(0.1_dp*reference_series("wn", 12000), 0.005_dp, welch_options(), s, problem)
      call check(error, int(s%segment), 1024)
      call check(error, sum(s%density(1:511))/511, 0.01_dp*0.005_dp, thr=0.03_dp*0.00005_dp)       ! 3/sqrt(12000)
   end subroutine test_white_level

   !> So many densities of white noise have the truth between their limits as the confidence says.
   subroutine test_limits()
      type(welch_type) :: s
      integer :: inside

      call welch_spectrum(reference_series("wn_bm", 12000), 1.0_dp, welch_options(segment=1000, confidence=0.9_dp), s, problem)
      inside = count(s%lower(1:499) <= 1.0_dp .and. s%upper(1:499) >= 1.0_dp)
      call check(error, inside > 425 .and. inside < 475)           ! 449 +- 4 sqrt(45)
      call check(error, all(s%lower < s%density .and. s%upper > s%density))
   end subroutine test_limits

   !> The same on one thread and on two.
   subroutine test_threads()
      type(welch_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: before

      x = reference_series("ar1", 200000)
      before = thread_count()
      call set_thread_count(1)
      call welch_spectrum(x, 1.0_dp, welch_options(segment=1000), a, problem)
      call set_thread_count(2)
      if (.not. allocated(problem)) call welch_spectrum(x, 1.0_dp, welch_options(segment=1000), b, problem)
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(b%density - a%density)) <= 0.0_dp .and. all(a%density > 0.0_dp))
   end subroutine test_threads

   !> Offset and scale.
   subroutine test_invariance()
      type(welch_type) :: a, b
      real(dp), allocatable :: x(:)

      x = reference_series("ar1", 1000)
      call welch_spectrum(x, 1.0_dp, welch_options(segment=128), a, problem)
      call welch_spectrum(1.0e6_dp + 1.0e-3_dp*x, 1.0_dp, welch_options(segment=128), b, problem)
      call check(error, maxval(abs(1.0e6_dp*b%density/a%density - 1)) < 1.0e-6_dp)      ! x is rounded to 1e-7 of itself
      call welch_spectrum(4.0_dp*x, 1.0_dp, welch_options(segment=128), b, problem)
      call check(error, maxval(abs(b%density/a%density/16 - 1)) < tolerance)
   end subroutine test_invariance

   !> Missing samples: their values do not matter, white noise keeps its level, long gaps leave segments out.
   subroutine test_gaps()
      type(welch_type) :: a, b
      real(dp), allocatable :: x(:)
      integer(int8) :: valid(12000)
      integer :: t

      x = reference_series("wn", 12000)
      valid = [(merge(0_int8, 1_int8, mod(t*int(t, int64)*t, 11_int64) < 3), t=1, 12000)]
      call welch_spectrum(x, 1.0_dp, welch_options(segment=256), a, problem, valid)
      call check(error, sum(a%density(1:127))/127, 1.0_dp, thr=0.05_dp)
      where (valid == 0_int8) x = -1.0e9_dp
      call welch_spectrum(x, 1.0_dp, welch_options(segment=256), b, problem, valid)
      call check(error, maxval(abs(a%density - b%density)), 0.0_dp, thr=0.0_dp)
      valid = 1_int8
      valid(1:2560) = 0_int8
      call welch_spectrum(x, 1.0_dp, welch_options(segment=256), b, problem, valid)
      call check(error, int(b%segments - b%used), 19)               ! 19 of the first 20, which begin every 128 samples
      call check(error, b%degrees_of_freedom < a%degrees_of_freedom)
   end subroutine test_gaps

   !> The largest power of two that fits eight times, at most 16384.
   subroutine test_default()
      call check(error, int(default_segment(2_int64)), 2)
      call check(error, int(default_segment(1000_int64)), 64)
      call check(error, int(default_segment(12000_int64)), 1024)
      call check(error, int(default_segment(100000000_int64)), 16384)
   end subroutine test_default

   !> Each option out of range, nothing present, one sample.
   subroutine test_failures()
      real(dp) :: x(20)
      integer(int8) :: nothing(20)

      x = 1.0_dp
      nothing = 0_int8
      call expect(x(:1), 1.0_dp, welch_options(), status%too_few_samples)
      if (.not. allocated(error)) call expect(x, 0.0_dp, welch_options(), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(segment=21), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(segment=1), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(window="hat"), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(overlap=1.0_dp), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(confidence=1.0_dp), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(min_coverage=0.0_dp), status%invalid_argument)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(), status%too_few_samples,  nothing)
      if (.not. allocated(error)) call expect(x, 1.0_dp, welch_options(segment=2), status%ok)
   end subroutine test_failures

   !> The status of one call.
   subroutine expect(x, dt, options, code,  valid)
      real(dp), intent(in) :: x(:), dt
      type(welch_options), intent(in) :: options
      integer, intent(in) :: code
      integer(int8), intent(in), optional :: valid(:)
      type(welch_type) :: s
      integer :: got

      call welch_spectrum(x, dt, options, s, problem, valid)
      got = status%ok
      if (allocated(problem)) got = problem%code
      call check(error, got, code)
   end subroutine expect

end module test_welch
