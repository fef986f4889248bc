! SPDX-License-Identifier: MIT
!> Tests of the Allan deviation of a streamed record, against the exact one and against direct sums.
module test_allan_stream
   use expectations, only : agree
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_allan_degrees_of_freedom, only : sampling_efficiency
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_stream, only : allan_stream_type, begin_allan_stream, feed_allan_stream, finish_allan_stream
   use allan_series, only : nbs14_long, normal_series, walk_of
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_allan_stream

   !> Rounding of sums that are formed in another order
   real(dp), parameter :: exact = 1.0e-12_dp

contains

   !> The tests of this suite.
   subroutine collect_allan_stream(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("published", test_published), &
         & new_unittest("short_times", test_short_times), &
         & new_unittest("long_times", test_long_times), &
         & new_unittest("direct_sum", test_direct_sum), &
         & new_unittest("ramp", test_ramp), &
         & new_unittest("large_offset", test_large_offset), &
         & new_unittest("pieces", test_pieces), &
         & new_unittest("known_length", test_known_length), &
         & new_unittest("gaps", test_gaps), &
         & new_unittest("late_start", test_late_start), &
         & new_unittest("noise_type", test_noise_type), &
         & new_unittest("efficiency", test_efficiency), &
         & new_unittest("fit", test_fit), &
         & new_unittest("interval_told_later", test_interval), &
         & new_unittest("failures", test_failures), &
         & new_unittest("order_of_calls", test_order)]
   end subroutine collect_allan_stream

   !> The curve of a stream that gets the record in pieces; stops the test on failure.
   subroutine stream_of(error, rate, taus, curve, valid, piece, starts, samples)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> The record, at 1 Hz
      real(dp), intent(in), contiguous :: rate(:)
      character(*), intent(in) :: taus
      !> The result
      type(allan_curve_type), intent(out) :: curve
      !> Missing samples
      integer(int8), intent(in), contiguous, optional :: valid(:)
      !> Samples fed at once, S, and the length that is told
      integer, intent(in), optional :: piece, starts
      integer(int64), intent(in), optional :: samples

      type(allan_stream_type) :: stream
      type(allan_options) :: options
      type(gyro_error), allocatable :: failure
      integer :: i, last, step

      options%taus = taus
      step = size(rate)
      if (present(piece)) step = piece
      call begin_allan_stream(stream, 1.0_dp, options, failure, samples, starts)
      do i = 1, size(rate), step
         if (allocated(failure)) exit
         last = min(i + step - 1, size(rate))
         if (present(valid)) then
            call feed_allan_stream(stream, rate(i:last), failure, valid(i:last))
         else
            call feed_allan_stream(stream, rate(i:last), failure)
         end if
      end do
      if (.not. allocated(failure)) call finish_allan_stream(stream, curve, failure)
      if (allocated(failure)) call check(error, .false., failure%message)
   end subroutine stream_of

   !> The curve of the exact mode; stops the test on failure.
   subroutine exact_curve_of(error, rate, taus, curve, valid)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> The record, at 1 Hz
      real(dp), intent(in), contiguous :: rate(:)
      character(*), intent(in) :: taus
      !> The result
      type(allan_curve_type), intent(out) :: curve
      !> Missing samples
      integer(int8), intent(in), contiguous, optional :: valid(:)

      type(gyro_error), allocatable :: failure
      type(allan_options) :: options

      options%taus = taus
      if (present(valid)) then
         call compute_allan(rate, 1.0_dp, options, curve, failure, valid)
      else
         call compute_allan(rate, 1.0_dp, options, curve, failure)
      end if
      if (allocated(failure)) call check(error, .false., failure%message)
   end subroutine exact_curve_of

   subroutine test_published(error)
      type(error_type), allocatable, intent(out) :: error

      ! NBS14, 1000 points (NIST SP 1065, section 12.4; 16 digits from rational arithmetic); m < 64: every term
      type(allan_curve_type) :: curve

      call stream_of(error, nbs14_long(), "1,2,4,8,10,16,32", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, [0.2922318781067592_dp, 0.2010160421709385_dp, 0.1447913072184378_dp, &
         & 0.1057038500787000_dp, 0.09159953420118654_dp, 0.06191477841874487_dp, 0.04808214262128163_dp], exact, "deviation")
      if (allocated(error)) return
      call check(error, curve%streamed, "the curve does not say that it was streamed")
      if (allocated(error)) return
      call check(error, all(curve%terms == 1001 - 2*curve%m), "terms")
   end subroutine test_published

   subroutine test_short_times(error)
      type(error_type), allocatable, intent(out) :: error

      ! where every term is taken all of the curve is that of the exact mode, in a record of several blocks
      character(*), parameter :: taus = "1,2,3,5,7,16,31,32,47,63"
      type(allan_curve_type) :: streamed, whole
      real(dp) :: rate(50001)

      rate = normal_series(50001_int64, 11_int64)
      call stream_of(error, rate, taus, streamed)
      if (allocated(error)) return
      call exact_curve_of(error, rate, taus, whole)
      if (allocated(error)) return
      call agree(error, streamed%deviation, whole%deviation, exact, "deviation")
      if (allocated(error)) return
      call check(error, all(streamed%terms == whole%terms) .and. all(streamed%alpha == whole%alpha), "terms or noise type")
      if (allocated(error)) return
      call agree(error, streamed%edf, whole%edf, exact, "edf")
      if (allocated(error)) return
      call agree(error, streamed%upper, whole%upper, exact, "limit")
   end subroutine test_short_times

   subroutine test_long_times(error)
      type(error_type), allocatable, intent(out) :: error

      ! the terms left out have the share 1 - f of the degrees of freedom: the variances differ by sqrt(2 (1/f - 1)/edf) of
      ! themselves, one standard deviation
      type(allan_curve_type) :: streamed, whole
      real(dp) :: rate(300000)
      real(dp), allocatable :: spread(:)

      rate = normal_series(300000_int64, 12_int64)
      call stream_of(error, rate, "octave", streamed, starts=16)
      if (allocated(error)) return
      call exact_curve_of(error, rate, "octave", whole)
      if (allocated(error)) return
      call check(error, all(streamed%m == whole%m), "averaging times")
      if (allocated(error)) return
      spread = sqrt(2*(1/streamed%share - 1)/whole%edf)
      call check(error, all(abs((streamed%deviation/whole%deviation)**2 - 1) <= 4*spread + exact), "deviations differ")
      if (allocated(error)) return
      call check(error, all(streamed%share > 0.99_dp) .and. all(streamed%share <= 1), "share of the degrees of freedom")
      if (allocated(error)) return
      call agree(error, streamed%edf, whole%edf*streamed%share, exact, "edf")
   end subroutine test_long_times

   subroutine test_direct_sum(error)
      type(error_type), allocatable, intent(out) :: error

      ! every stride-th term, m no multiple of the stride, by the definition
      integer, parameter :: n = 30000, m = 1003, s = 62
      type(allan_curve_type) :: curve
      real(dp) :: rate(n), total
      integer :: k, terms

      rate = normal_series(int(n, int64), 13_int64)
      total = 0
      terms = 0
      do k = 0, n - 2*m, s
         total = total + ((sum(rate(k + m + 1:k + 2*m)) - sum(rate(k + 1:k + m)))/m)**2
         terms = terms + 1
      end do
      call stream_of(error, rate, "1003", curve, starts=16)
      if (allocated(error)) return
      call check(error, curve%terms(1), int(terms, int64))
      if (allocated(error)) return
      call agree(error, curve%deviation, [sqrt(total/(2*terms))], exact, "deviation")
   end subroutine test_direct_sum

   subroutine test_ramp(error)
      type(error_type), allocatable, intent(out) :: error

      ! w = R i gives R tau/sqrt(2) at every averaging time
      type(allan_curve_type) :: curve
      real(dp) :: rate(200000)
      integer :: i

      rate = [(0.25_dp*i, i=1, size(rate))]
      call stream_of(error, rate, "log:7", curve)
      if (allocated(error)) return
      call agree(error, curve%deviation, 0.25_dp*curve%tau/sqrt(2.0_dp), exact, "deviation")
   end subroutine test_ramp

   subroutine test_large_offset(error)
      type(error_type), allocatable, intent(out) :: error

      ! an offset of 2**20 costs no digits of numbers that are multiples of 2**-30
      type(allan_curve_type) :: plain, shifted
      real(dp) :: rate(100000)

      rate = anint(normal_series(100000_int64, 14_int64)*2.0_dp**30)/2.0_dp**30
      call stream_of(error, rate, "octave", plain)
      if (allocated(error)) return
      rate = rate + 2.0_dp**20
      call stream_of(error, rate, "octave", shifted)
      if (allocated(error)) return
      call agree(error, shifted%deviation, plain%deviation, 1.0e-11_dp, "deviation")
   end subroutine test_large_offset

   subroutine test_pieces(error)
      type(error_type), allocatable, intent(out) :: error

      ! no bit depends on how the record was cut
      integer, parameter :: piece(4) = [1, 13, 8192, 20011]
      type(allan_curve_type) :: whole, cut
      real(dp) :: rate(40000)
      integer :: i

      rate = normal_series(40000_int64, 15_int64)
      call stream_of(error, rate, "decade", whole)
      if (allocated(error)) return
      do i = 1, size(piece)
         call stream_of(error, rate, "decade", cut, piece=piece(i))
         if (allocated(error)) return
         call agree(error, cut%deviation, whole%deviation, 0.0_dp, "deviation")
         if (allocated(error)) return
         call agree(error, cut%edf, whole%edf, 0.0_dp, "edf")
         if (allocated(error)) return
      end do
   end subroutine test_pieces

   subroutine test_known_length(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_curve_type) :: known, unknown
      real(dp) :: rate(12345)

      rate = normal_series(12345_int64, 16_int64)
      call stream_of(error, rate, "log:5", known, samples=12345_int64)
      if (allocated(error)) return
      call stream_of(error, rate, "log:5", unknown)
      if (allocated(error)) return
      call agree(error, unknown%deviation, known%deviation, 0.0_dp, "deviation")
   end subroutine test_known_length

   subroutine test_gaps(error)
      type(error_type), allocatable, intent(out) :: error

      ! 5 % lost one by one and a hole of 1000 samples; short times are those of the exact mode, long ones differ by the terms
      ! that are left out (0.1 % of the degrees of freedom, of which there are few)
      type(allan_curve_type) :: streamed, whole
      real(dp) :: rate(120000), chance(120000)
      integer(int8) :: valid(120000)
      integer :: short

      rate = normal_series(120000_int64, 17_int64)
      chance = normal_series(120000_int64, 18_int64)
      valid = merge(0_int8, 1_int8, chance > 1.645_dp)
      valid(50001:51000) = 0
      where (valid == 0) rate = 1.0e6_dp
      call stream_of(error, rate, "octave", streamed, valid, piece=1001)
      if (allocated(error)) return
      call exact_curve_of(error, rate, "octave", whole, valid)
      if (allocated(error)) return
      short = count(whole%m < 64)
      call agree(error, streamed%deviation(:short), whole%deviation(:short), 1.0e-11_dp, "deviation")
      if (allocated(error)) return
      call check(error, all(streamed%terms(:short) == whole%terms(:short)), "terms")
      if (allocated(error)) return
      call check(error, size(streamed%m), size(whole%m), "averaging times")
      if (allocated(error)) return
      call agree(error, streamed%deviation, whole%deviation, 0.03_dp, "deviation at long times")
      if (allocated(error)) return
      call agree(error, streamed%edf, whole%edf, 0.03_dp, "edf")
   end subroutine test_gaps

   subroutine test_late_start(error)
      type(error_type), allocatable, intent(out) :: error

      ! a record that begins with missing samples, far from 0 afterwards, is the rest of it
      type(allan_curve_type) :: late, plain
      real(dp) :: rate(40000)
      integer(int8) :: valid(40000)

      rate = normal_series(40000_int64, 19_int64) + 1000.0_dp
      valid = 1
      valid(:20000) = 0
      call stream_of(error, rate, "1,10,50", late, valid)
      if (allocated(error)) return
      call stream_of(error, rate(20001:), "1,10,50", plain)
      if (allocated(error)) return
      call agree(error, late%deviation(:1), plain%deviation(:1), 1.0e-11_dp, "deviation")
      if (allocated(error)) return
      call agree(error, late%deviation, plain%deviation, 0.002_dp, "deviation where windows reach into the gap")
   end subroutine test_late_start

   subroutine test_noise_type(error)
      type(error_type), allocatable, intent(out) :: error

      ! white, random walk and differenced white (quantisation) noise, means of up to 100 samples
      type(allan_curve_type) :: curve
      real(dp) :: g(40001), h(40000)

      g = normal_series(40001_int64, 20_int64)
      h = normal_series(40000_int64, 21_int64)
      call stream_of(error, g, "1,10,100", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == 0), "white")
      if (allocated(error)) return
      call stream_of(error, walk_of(g(:40000), h), "1,10,100", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == -2), "random walk")
      if (allocated(error)) return
      call stream_of(error, g(2:) - g(:40000), "1,10,100", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == 2), "quantisation")
      if (allocated(error)) return
      call agree(error, curve%share, [1.0_dp, 1.0_dp, 1/3.0_dp], 0.001_dp, "share of quantisation noise")
      if (allocated(error)) return
      call stream_of(error, walk_of(g(:40000), h)*0.01_dp + g(2:), "1,1000", curve)
      if (allocated(error)) return
      call check(error, all(curve%alpha == [0, -2]), "white, then random walk")
   end subroutine test_noise_type

   subroutine test_efficiency(error)
      type(error_type), allocatable, intent(out) :: error

      ! simulated at N = 1e5, m = 64 .. 4096: white noise 0.928, 0.981, 0.995, 0.999 at S = 4, 8, 16, 32
      integer(int64), parameter :: m = 4096
      integer, parameter :: s(4) = [4, 8, 16, 32]
      real(dp), parameter :: white(4) = [0.928_dp, 0.981_dp, 0.995_dp, 0.999_dp]
      integer :: i

      do i = 1, 4
         call agree(error, [sampling_efficiency(m, m/s(i), 0)], white(i:i), 0.001_dp, "white")
         if (allocated(error)) return
         call check(error, sampling_efficiency(m, m/s(i), -1) > 0.996_dp, "flicker")
         if (allocated(error)) return
         call check(error, sampling_efficiency(m, m/s(i), -2) > 0.9999_dp, "random walk")
         if (allocated(error)) return
      end do
      call agree(error, [sampling_efficiency(m, 128_int64, 2)], [1/128.0_dp], exact, "quantisation")
      if (allocated(error)) return
      call agree(error, [sampling_efficiency(7_int64, 1_int64, 2)], [1.0_dp], exact, "no stride")
   end subroutine test_efficiency

   subroutine test_fit(error)
      type(error_type), allocatable, intent(out) :: error

      ! coefficients and their errors from the two curves
      type(allan_curve_type) :: streamed, whole
      type(noise_type) :: a, b
      type(noise_options) :: options
      type(gyro_error), allocatable :: failure
      real(dp) :: g(200001)

      g = normal_series(200001_int64, 22_int64)
      g(2:) = g(2:) + 0.002_dp*walk_of(g(:200000), g(2:))
      call stream_of(error, g(2:), "log:8", streamed)
      if (allocated(error)) return
      call exact_curve_of(error, g(2:), "log:8", whole)
      if (allocated(error)) return
      options%terms = "NK"
      call fit_noise(streamed, options, a, failure)
      if (.not. allocated(failure)) call fit_noise(whole, options, b, failure)
      call check(error, .not. allocated(failure), "a fit failed")
      if (allocated(error)) return
      call agree(error, a%coefficient([2, 4])%value, b%coefficient([2, 4])%value, 0.01_dp, "value")
      if (allocated(error)) return
      call agree(error, a%coefficient([2, 4])%std_error, b%coefficient([2, 4])%std_error, 0.02_dp, "standard error")
      if (allocated(error)) return
      call agree(error, streamed%edf, whole%edf, 0.01_dp, "edf of the mixture")
   end subroutine test_fit

   subroutine test_interval(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_stream_type) :: stream
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failure

      call begin_allan_stream(stream, 1.0_dp, options, failure)
      if (.not. allocated(failure)) call feed_allan_stream(stream, nbs14_long(), failure)
      if (.not. allocated(failure)) call finish_allan_stream(stream, curve, failure, 0.01_dp)
      call check(error, .not. allocated(failure), "failed")
      if (allocated(error)) return
      call agree(error, curve%tau, 0.01_dp*curve%m, exact, "tau")
      if (allocated(error)) return
      call agree(error, curve%deviation(:1), [0.2922318781067592_dp], exact, "deviation")
   end subroutine test_interval

   !> Fails unless a stream is refused with this code.
   subroutine expect(error, options, code, rate, starts)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      type(allan_options), intent(in) :: options
      integer, intent(in) :: code
      real(dp), intent(in), contiguous :: rate(:)
      integer, intent(in), optional :: starts

      type(allan_stream_type) :: stream
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failure

      call begin_allan_stream(stream, 1.0_dp, options, failure, starts=starts)
      if (.not. allocated(failure)) call feed_allan_stream(stream, rate, failure)
      if (.not. allocated(failure)) call finish_allan_stream(stream, curve, failure)
      call check(error, allocated(failure), "not refused")
      if (allocated(error)) return
      call check(error, failure%code, code, failure%message)
   end subroutine expect

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error

      type(allan_options) :: options
      real(dp), parameter :: two(2) = [1.0_dp, 2.0_dp]

      options%taus = "all"
      call expect(error, options, status%not_supported, two)
      if (allocated(error)) return
      options%taus = "7"
      call expect(error, options, status%too_few_samples, two)
      if (allocated(error)) return
      options%taus = "octave"
      call expect(error, options, status%too_few_samples, two(:1))
      if (allocated(error)) return
      call expect(error, options, status%too_few_samples, two(:0))
      if (allocated(error)) return
      call expect(error, options, status%invalid_argument, two, 3)
      if (allocated(error)) return
      options%kind = "mdev"
      call expect(error, options, status%not_supported, two)
      if (allocated(error)) return
      options%kind = "oadev"
      options%confidence = 1
      call expect(error, options, status%invalid_argument, two)
   end subroutine test_failures

   subroutine test_order(error)
      type(error_type), allocatable, intent(out) :: error

      ! feeding before the beginning and after the end, valid of another length
      type(allan_stream_type) :: stream
      type(allan_curve_type) :: curve
      type(gyro_error), allocatable :: failure

      call feed_allan_stream(stream, [1.0_dp], failure)
      call check(error, allocated(failure), "fed before the beginning")
      if (allocated(error)) return
      call begin_allan_stream(stream, 1.0_dp, allan_options(), failure)
      call feed_allan_stream(stream, [1.0_dp, 2.0_dp], failure, [1_int8])
      call check(error, allocated(failure), "valid is shorter")
      if (allocated(error)) return
      call feed_allan_stream(stream, [1.0_dp, 2.0_dp, 4.0_dp], failure)
      call finish_allan_stream(stream, curve, failure)
      call check(error, .not. allocated(failure), "three samples")
      if (allocated(error)) return
      call finish_allan_stream(stream, curve, failure)
      call check(error, allocated(failure), "finished twice")
   end subroutine test_order

end module test_allan_stream
