! SPDX-License-Identifier: MIT
!> What makes a simulated record like a sensor's (filters, LSB, heavy tails), and what happens to a
!> sensor at work: contamination, warm-up, motion, Gauss-Markov processes, vibration.
module test_simulate_sensor
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, &
      & check_refused
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type
   use gyroakf_simulate_sensor_filter, only : section_type, make_section, apply_section, &
      & settling_samples
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   implicit none (type, external)
   private
   public :: suite_simulate_sensor, suite_simulate_disturbance

   real(dp), parameter :: pi = 3.14159265358979323846_dp

contains

   subroutine suite_simulate_sensor()
      call test("response", test_response)
      call test("low-pass-variance", test_variance)
      call test("settled", test_settled)
      call test("offset-and-ramp", test_deterministic)
      call test("after-the-filter", test_after)
      call test("truth", test_truth)
      call test("tails", test_tails)
      call test("tails-of-white-noise", test_tails_of_white)
      call test("failures", test_failures)
   end subroutine suite_simulate_sensor

   subroutine suite_simulate_disturbance()
      call test("contamination", test_contamination)
      call test("warm-up", test_warm_up)
      call test("motion", test_motion)
      call test("gauss-markov", test_markov)
      call test("vibration", test_vibration)
      call test("truth", test_truth_disturbed)
   end subroutine suite_simulate_disturbance

   !> The Fourier transform of the impulse response is the analog response at the warped frequency.
   subroutine test_response()
      real(dp), parameter :: hz = 12.0_dp, rate = 100.0_dp
      real(dp), parameter :: q(4) = [0.0_dp, 0.5_dp, sqrt(0.5_dp), 20.0_dp]
      type(section_type) :: section
      real(dp), allocatable :: x(:)
      complex(dp) :: s, analog, response
      integer :: i, j, k

      do k = 1, size(q)
         section = make_section(hz, rate, q(k))
         allocate (x(0:1 + ceiling(settling_samples(section))), source=0.0_dp)
         x(1) = 1
         call apply_section(section, x)
         do j = 0, 49
            s = cmplx(0.0_dp, tan(pi*j/rate)/tan(pi*hz/rate), dp)
            analog = 1/(1 + s)
            if (k > 1) analog = 1/(s**2 + s/q(k) + 1)
            response = sum([(x(i)*exp(cmplx(0.0_dp, -2*pi*j*(i - 1)/rate, dp)), i=1, ubound(x, 1))])
            call check(error, abs(response - analog) < 1.0e-10_dp)
         end do
         deallocate (x)
      end do
   end subroutine test_response

   !> White noise through y(i) = (1 - 2 b) y(i-1) + b (x(i) + x(i-1)) has b times its variance.
   subroutine test_variance()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      real(dp) :: g

      options%samples = 200000
      options%coefficient(2) = 0.1_dp
      options%lowpass_hz = 0.5_dp
      g = tan(pi*0.1_dp)
      x = values(options)
      call check(error, sum(x**2)/size(x), 0.05_dp*g/(1 + g), thr=0.02_dp, rel=.true.)
   end subroutine test_variance

   !> The first sample of many records has the variance that the impulse response gives.
   subroutine test_settled()
      integer, parameter :: records = 500
      type(simulate_options) :: options
      type(section_type) :: sections(2)
      real(dp) :: x(4000), first(1), total
      integer :: i

      sections = make_section([1.0_dp, 0.5_dp], 5.0_dp, [sqrt(0.5_dp), 10.0_dp])
      x = 0
      x(2) = 1
      do i = 1, 2
         call apply_section(sections(i), x)
      end do
      options%samples = 1
      options%coefficient(2) = sqrt(0.2_dp)
      options%lowpass_hz = 1
      options%lowpass_order = 2
      options%resonance_hz = 0.5_dp
      options%resonance_q = 10
      total = 0
      do i = 1, records
         options%seed = i
         first = values(options)
         total = total + first(1)**2
      end do
      call check(error, total/records, sum(x**2), thr=4.5_dp*sqrt(2.0_dp/records), rel=.true.)
   end subroutine test_settled

   !> A constant passes unchanged, a ramp is late by 1/(2 g) and 1/(2 g Q) samples, from the start.
   subroutine test_deterministic()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      real(dp) :: late
      integer :: i

      options%samples = 100
      options%offset = 7
      options%lowpass_hz = 1
      options%resonance_hz = 0.5_dp
      options%resonance_q = 4
      x = values(options)
      call check(error, maxval(abs(x - 7)) < 1.0e-14_dp, "offset")
      options%coefficient(5) = 0.5_dp                  ! 0.1 a sample
      options%trend = [0.0_dp, 0.2_dp]
      x = values(options)
      late = 1/(2*tan(0.2_dp*pi)) + 1/(8*tan(0.1_dp*pi))
      x = x - [(7.05_dp + 0.3_dp*(i - late), i=0, 99)]
      call check(error, maxval(abs(x)) < 1.0e-9_dp, "ramp")
   end subroutine test_deterministic

   !> Outliers are not smeared by the filter, values are multiples of the LSB.
   subroutine test_after()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:), y(:)

      options%samples = 1000
      options%coefficient(2) = 1
      options%offset = 0.3_dp
      options%lowpass_hz = 0.2_dp
      x = values(options)
      options%outliers = 40
      options%outlier_size = 20
      y = values(options)
      call check(error, count(abs(y - x) > 0), 40)
      x = y
      options%lsb = 0.25_dp
      y = values(options)
      call check(error, all(abs(4*y - anint(4*y)) <= 0) .and. maxval(abs(x - y)) <= 0.125_dp, "LSB")
   end subroutine test_after

   !> The true drift passes the same filters.
   subroutine test_truth()
      type(simulate_options) :: options
      type(record_type) :: record, truth

      options%samples = 500
      options%coefficient(3:5) = [0.01_dp, 1.0e-3_dp, 1.0e-5_dp]
      options%trend = [0.1_dp, -1.0e-6_dp]
      options%lowpass_hz = 1
      call simulate_record(options, record, failure, truth)
      if (went_wrong(failure)) return
      call check(error, maxval(abs(record%value - truth%value)) <= 0)
   end subroutine test_truth

   !> Variance 1, mean absolute values and kurtosis of each distribution; 4.5 standard errors.
   subroutine test_tails()
      character(7), parameter :: tails(4) = [character(7) :: "normal", "laplace", "mixture", "t5"]
      real(dp), parameter :: mean(4) = [sqrt(2/pi), sqrt(0.5_dp), 4.5_dp/sqrt(32.5_dp)*sqrt(2/pi), 4/(pi*sqrt(3.0_dp))]
      real(dp), parameter :: kurtosis(4) = [3.0_dp, 6.0_dp, 3*2048.5_dp/32.5_dp**2, 9.0_dp]
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      integer :: k

      options%samples = 200000
      options%coefficient(2) = sqrt(0.2_dp)
      do k = 1, 4
         options%tails = tails(k)
         x = values(options)
         call check(error, sum(abs(x))/size(x), mean(k), &
                    thr=4.5_dp*sqrt((1 - mean(k)**2)/size(x)), more=tails(k))
         call check(error, sum(x**2)/size(x), 1.0_dp, &
                    thr=4.5_dp*sqrt((kurtosis(k) - 1)/size(x)), more=tails(k))
         if (unmet(abs(sum(x))/size(x) < 4.5_dp/sqrt(real(size(x), dp)), tails(k))) return
         if (k < 4) call check(error, sum(x**4)/size(x), kurtosis(k), thr=0.5_dp, more=tails(k))
      end do
   end subroutine test_tails

   !> Terms other than N stay as they are.
   subroutine test_tails_of_white()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)

      options%samples = 100
      options%coefficient = [0.1_dp, 0.0_dp, 0.1_dp, 0.1_dp, 0.1_dp]
      options%ar = [0.5_dp]
      options%ar_variance = 1
      x = values(options)
      options%tails = "laplace"
      call check(error, maxval(abs(values(options) - x)) <= 0)
   end subroutine test_tails_of_white

   !> Options out of their range, at half the rate, NaN
   subroutine test_failures()
      type(simulate_options) :: options
      type(record_type) :: record
      real(dp) :: nan
      integer :: k

      nan = ieee_value(nan, ieee_quiet_nan)
      do k = 1, 27
         options = simulate_options(samples=10)
         options%coefficient(2) = 1
         if (k <= 13) options = simulate_options(samples=10, lowpass_hz=1.0_dp, resonance_hz=1.0_dp)
         select case (k)
         case (1); options%lowpass_hz = -1
         case (2); options%lowpass_hz = 2.5_dp
         case (3); options%lowpass_hz = nan
         case (4); options%lowpass_hz = 1.0e-12_dp     ! takes too long to settle
         case (5); options%lowpass_hz = tiny(1.0_dp)
         case (6); options%lowpass_order = 0
         case (7); options%lowpass_order = 3
         case (8); options%resonance_hz = -1
         case (9); options%resonance_hz = 2.5_dp
         case (10); options%resonance_q = 0.49_dp
         case (11); options%resonance_q = 101
         case (12); options%resonance_q = nan
         case (13); options%tails = "cauchy"
         case (14); options%contamination = [1.1_dp, 5.0_dp]
         case (15); options%contamination = [0.1_dp, -1.0_dp]
         case (16); options%contamination = [nan, 5.0_dp]
         case (17); options%warm_up = [nan, 5.0_dp]
         case (18); options%warm_up = [1.0_dp, 0.0_dp]
         case (19); options%motion = [-1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp]
         case (20); options%motion = [1.5_dp, 1.0_dp, 1.0_dp, 0.0_dp]
         case (21); options%motion = [1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
         case (22); options%motion = [1.0_dp, nan, 1.0_dp, 0.0_dp]
         case (23); options%markov = [1.0_dp, 2.0_dp, 3.0_dp]
         case (24); options%markov = [1.0_dp, -2.0_dp]
         case (25); options%markov = [nan, 2.0_dp]
         case (26); options%vibration = [1.0_dp, 2.0_dp]
         case default; options%vibration = [1.0_dp, 2.0_dp, 0.0_dp]
         end select
         call simulate_record(options, record, failure)
         call check_refused(failure, status%invalid_argument)
      end do
   end subroutine test_failures

   !> The values of a record
   function values(options) result(x)
      type(simulate_options), intent(in) :: options
      real(dp), allocatable :: x(:)
      type(record_type) :: record

      call simulate_record(options, record, failure)
      x = record%value(:, 1)
   end function values

   !> The share, sizes uniform from 4 to 12 standard deviations, both signs; --outlier-count draws from another stream.
   subroutine test_contamination()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:), y(:)
      real(dp) :: deviation

      options%samples = 20000
      options%coefficient(2) = 1
      x = values(options)
      deviation = sqrt(sum((x - sum(x)/20000)**2)/19999)
      options%contamination = [0.1_dp, 12.0_dp]
      y = (values(options) - x)/deviation
      call check(error, count(abs(y) > 0), 2000)
      call check(error, all(abs(y) <= 0 .or. (abs(y) > 3.999_dp .and. abs(y) < 12.001_dp)), "sizes")
      call check(error, sum(abs(y))/2000, 8.0_dp, thr=4.5_dp*8/sqrt(12*2000.0_dp))
      call check(error, abs(count(y > 0) - 1000) < 4.5_dp*sqrt(500.0_dp), "signs")
   end subroutine test_contamination

   !> A exp(-t/T) from the first sample on, also behind a filter, which had settled at A.
   subroutine test_warm_up()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      integer :: i

      options%samples = 200
      options%warm_up = [-3.0_dp, 8.0_dp]
      x = values(options)
      call check(error, maxval(abs(x + 3*exp(-[(i/40.0_dp, i=0, 199)]))) < 1.0e-13_dp)
      options%lowpass_hz = 1
      x = values(options)
      call check(error, x(1), -3.0_dp, thr=0.05_dp)
   end subroutine test_warm_up

   !> Half sines of the length, before the end that is given; both signs; one that is longer than the record is cut.
   subroutine test_motion()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      integer :: i, first

      options%samples = 1000
      options%motion = [1.0_dp, 2.0_dp, 5.0_dp, 40.0_dp]
      do i = 1, 20
         options%seed = i
         x = values(options)
         first = findloc(abs(x) > 0, .true., dim=1)
         call check(error, first + 24 <= 200 .and. count(abs(x) > 0) == 25, "place and length")
         call check(error, sum(abs(x)), 2/sin(pi/50), thr=1.0e-12_dp, more="half sine")
      end do
      options%motion = [200.0_dp, 2.0_dp, 0.2_dp, 0.0_dp]
      x = values(options)
      call check(error, any(x > 1) .and. any(x < -1) .and. any(abs(x(801:)) > 0), "signs, whole record")
      options%motion = [1.0_dp, 2.0_dp, 1.0e9_dp, 0.0_dp]
      x = values(options)
      call check(error, maxval(abs(x)) < 1.0e-4_dp .and. all(abs(x) > 0), "longer than the record")
   end subroutine test_motion

   !> Autocovariance S^2 exp(-t/T); of two processes the sum, and each its own numbers.
   subroutine test_markov()
      type(simulate_options) :: options
      real(dp), allocatable :: x(:), y(:)

      options%samples = 400000
      options%markov = [0.5_dp, 2.0_dp]
      x = values(options)
      call check(error, sum(x**2)/size(x), 0.25_dp, thr=0.03_dp, rel=.true.)
      call check(error, sum(x(11:)*x(:399990))/size(x), 0.25_dp*exp(-1.0_dp), thr=0.01_dp)
      options%markov = [0.5_dp, 2.0_dp, 3.0_dp, 0.1_dp]
      y = values(options) - x
      call check(error, sum(y**2)/size(y), 9.0_dp, thr=0.03_dp, rel=.true.)
      call check(error, abs(sum(x*y))/size(x) < 0.02_dp, "independent")
   end subroutine test_markov

   !> The power of a sine of the amplitude, half of it within the width about the frequency.
   subroutine test_vibration()
      integer, parameter :: n = 4096, records = 12
      real(dp), parameter :: rate = 100, hz = 20, width = 1
      type(simulate_options) :: options
      real(dp), allocatable :: x(:)
      real(dp) :: power, within, f
      integer :: i, j, k

      options%samples = n
      options%rate_hz = rate
      options%vibration = [2.0_dp, hz, width]
      power = 0
      within = 0
      do k = 1, records
         options%seed = k
         x = values(options)
         power = power + sum(x**2)/n/records
         do j = ceiling((hz - width/2)*n/rate), floor((hz + width/2)*n/rate)
            f = j/real(n, dp)
            within = within + 2*abs(sum([(x(i)*exp(cmplx(0.0_dp, -2*pi*f*i, dp)), i=1, n)]))**2/n/n/records
         end do
      end do
      call check(error, power, 2.0_dp, thr=0.15_dp)
      call check(error, within/power, 0.5_dp, thr=0.06_dp)
   end subroutine test_vibration

   !> Gauss-Markov processes and warm-up are drift, motion, vibration and contamination are not.
   subroutine test_truth_disturbed()
      type(simulate_options) :: options
      type(record_type) :: record, truth

      options%samples = 500
      options%markov = [1.0_dp, 10.0_dp]
      options%warm_up = [2.0_dp, 20.0_dp]
      call simulate_record(options, record, failure, truth)
      call check(error, maxval(abs(record%value - truth%value)) <= 0)
      options%vibration = [1.0_dp, 0.5_dp, 0.1_dp]
      options%motion = [3.0_dp, 5.0_dp, 2.0_dp, 0.0_dp]
      options%contamination = [0.01_dp, 9.0_dp]
      call simulate_record(options, record, failure)
      if (unmet(.not. allocated(failure) .and. count(abs(record%value - truth%value) > 0) == 500)) return
      call simulate_record(options, record, failure, truth)
      options%motion = 0
      options%contamination = 0
      deallocate (options%vibration)
      call simulate_record(options, record, failure)
      call check(error, maxval(abs(record%value - truth%value)) <= 0)
   end subroutine test_truth_disturbed

end module test_simulate_sensor
