! SPDX-License-Identifier: MIT
!> What happens to a sensor at work: contamination, warm-up, motion, Gauss-Markov processes, vibration.
module test_simulate_disturbance
   use expectations, only : unmet, failure => problem, test, error, check, check_refused
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   implicit none (type, external)
   private
   public :: suite_simulate_disturbance

   real(dp), parameter :: pi = 3.14159265358979323846_dp

contains

   subroutine suite_simulate_disturbance()
      call test("contamination", test_contamination)
      call test("warm-up", test_warm_up)
      call test("motion", test_motion)
      call test("gauss-markov", test_markov)
      call test("vibration", test_vibration)
      call test("truth", test_truth)
      call test("failures", test_failures)
   end subroutine suite_simulate_disturbance

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
      if (allocated(error)) return
      call check(error, sum(x(11:)*x(:399990))/size(x), 0.25_dp*exp(-1.0_dp), thr=0.01_dp)
      if (allocated(error)) return
      options%markov = [0.5_dp, 2.0_dp, 3.0_dp, 0.1_dp]
      y = values(options) - x
      call check(error, sum(y**2)/size(y), 9.0_dp, thr=0.03_dp, rel=.true.)
      if (allocated(error)) return
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
   subroutine test_truth()
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
   end subroutine test_truth

   !> Options out of their range, NaN
   subroutine test_failures()
      type(simulate_options) :: options
      type(record_type) :: record
      real(dp) :: nan
      integer :: k

      nan = ieee_value(nan, ieee_quiet_nan)
      do k = 1, 14
         options = simulate_options(samples=10)
         options%coefficient(2) = 1
         select case (k)
         case (1); options%contamination = [1.1_dp, 5.0_dp]
         case (2); options%contamination = [0.1_dp, -1.0_dp]
         case (3); options%contamination = [nan, 5.0_dp]
         case (4); options%warm_up = [nan, 5.0_dp]
         case (5); options%warm_up = [1.0_dp, 0.0_dp]
         case (6); options%motion = [-1.0_dp, 1.0_dp, 1.0_dp, 0.0_dp]
         case (7); options%motion = [1.5_dp, 1.0_dp, 1.0_dp, 0.0_dp]
         case (8); options%motion = [1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
         case (9); options%motion = [1.0_dp, nan, 1.0_dp, 0.0_dp]
         case (10); options%markov = [1.0_dp, 2.0_dp, 3.0_dp]
         case (11); options%markov = [1.0_dp, -2.0_dp]
         case (12); options%markov = [nan, 2.0_dp]
         case (13); options%vibration = [1.0_dp, 2.0_dp]
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
      allocate (x, source=record%value(:, 1))
   end function values
end module test_simulate_disturbance
