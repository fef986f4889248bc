! SPDX-License-Identifier: MIT
!> Spectral lines in simulated records: how many noise alone shows, how well they are measured, what they cost.
program periodicity
   use gyroakf, only : dp, int64
   implicit none (type, external)
   integer :: records, samples
   character(16) :: text

   records = 500
   samples = 2000
   call get_command_argument(1, text)
   if (text /= "") read (text, *) records
   call get_command_argument(2, text)
   if (text /= "") read (text, *) samples
   call count_false_alarms(records, samples)
   call measure_errors(records, samples)
   call measure_cost(10000000_int64)

contains

   !> Noise of one of several kinds.
   subroutine make_noise(kind, seed, x)
      use gyroakf, only : random_type, seed_random, fill_normal
      integer, intent(in) :: kind, seed
      real(dp), intent(out), contiguous :: x(:)
      real(dp), parameter :: phi(0:8) = [0.0_dp, 0.7_dp, 0.99_dp, 0.999_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      type(random_type) :: random
      real(dp) :: drift(size(x))
      integer :: t

      call seed_random(random, 7919_int64*(1000*kind + seed))
      call fill_normal(random, x)
      do t = 2, size(x)
         x(t) = x(t) + phi(kind)*x(t - 1)
      end do
      if (kind == 4) x = anint(0.3_dp*x)
      if (kind == 5) x = anint(0.8_dp*x)
      if (kind == 6) then
         call fill_normal(random, drift)
         do t = 2, size(x)
            drift(t) = drift(t - 1) + 0.02_dp*drift(t)
         end do
         x = x + drift
      else if (kind == 7) then
         do t = 3, size(x)
            x(t) = x(t) + 1.2_dp*x(t - 1) - 0.9_dp*x(t - 2)
         end do
      end if
   end subroutine make_noise

   !> Records of noise with a line, where a share of 0.1 and of 0.001 may have one.
   subroutine count_false_alarms(records, samples)
      use gyroakf, only : periodicity_options, periodicity_type, analyse_periodicity, error_type
      integer, intent(in) :: records, samples
      character(24), parameter :: names(0:7) = [character(24) :: "white", "AR(1) 0.7", "AR(1) 0.99", "AR(1) 0.999", &
         "rounded, sigma 0.3 LSB", "rounded, sigma 0.8 LSB", "white and random walk", "resonance, AR(2)"]
      type(periodicity_options) :: options
      type(periodicity_type) :: result
      type(error_type), allocatable :: error
      real(dp), allocatable :: x(:)
      integer :: kind, i, alarms(2), fisher

      allocate (x(samples))
      options%lines%false_alarm = 0.1_dp
      print "(i0, a, i0, a)", records, " records of ", samples, &
         " samples: percent with a line at p < 0.1, at p < 0.001; g at p < 0.1"
      do kind = 0, 7
         alarms = 0
         fisher = 0
         do i = 1, records
            call make_noise(kind, i, x)
            call analyse_periodicity(x, 1.0_dp, options, result, error)
            if (allocated(error)) error stop error%message
            if (size(result%line) > 0) alarms(1) = alarms(1) + 1
            if (any(result%line%p_value < 0.001_dp)) alarms(2) = alarms(2) + 1
            if (result%fisher%p_value < 0.1_dp) fisher = fisher + 1
         end do
         print "(2x, a, 3f9.2)", names(kind), 100.0_dp*alarms/records, 100.0_dp*fisher/records
      end do
   end subroutine count_false_alarms

   !> Root mean square of the errors over the stated ones, and how many lines were found beside the true one.
   subroutine measure_errors(records, samples)
      use gyroakf, only : periodicity_options, periodicity_type, analyse_periodicity, error_type
      integer, intent(in) :: records, samples
      real(dp), parameter :: turn = 6.283185307179586_dp, amplitude(4) = [0.3_dp, 1.0_dp, 30.0_dp, 1.0e4_dp]
      type(periodicity_type) :: result
      type(error_type), allocatable :: error
      real(dp), allocatable :: x(:)
      real(dp) :: f, score(2)
      integer :: a, kind, i, t, best, found, others

      allocate (x(samples))
      print "(a)", &
         "amplitude, noise (0 white, 1 AR(1) 0.7): percent found, others; errors over the stated ones: frequency, amplitude"
      do kind = 0, 1
         do a = 1, size(amplitude)
            score = 0
            found = 0
            others = 0
            do i = 1, records
               call make_noise(kind, i, x)
               f = 0.11_dp + 0.037_dp*i/records
               x = x + [(amplitude(a)*cos(turn*f*t + i), t=1, samples)]
               call analyse_periodicity(x, 1.0_dp, periodicity_options(), result, error)
               if (allocated(error)) error stop error%message
               others = others + size(result%line)
               if (size(result%line) == 0) cycle
               best = minloc(abs(result%line%frequency - f), 1)
               if (abs(result%line(best)%frequency - f) > 2.0_dp/samples) cycle
               found = found + 1
               others = others - 1
               score = score + [(result%line(best)%frequency - f)/result%line(best)%frequency_error, &
                                (result%line(best)%amplitude - amplitude(a))/result%line(best)%amplitude_error]**2
            end do
            print "(2x, f9.1, i4, f9.2, i6, 2f9.3)", amplitude(a), kind, 100.0_dp*found/records, others, sqrt(score/max(found, 1))
         end do
      end do
   end subroutine measure_errors

   !> Seconds of Welch's spectrum, and of lines in the whole series and in its middle.
   subroutine measure_cost(n)
      use gyroakf, only : periodicity_options, periodicity_type, analyse_periodicity, welch_options, welch_type, welch_spectrum, &
         error_type
      integer(int64), intent(in) :: n
      type(periodicity_options) :: options
      type(periodicity_type) :: result
      type(welch_type) :: spectrum
      type(error_type), allocatable :: error
      real(dp), allocatable :: x(:)
      integer(int64) :: from, to, rate

      allocate (x(n))
      call make_long(x)
      call system_clock(from, rate)
      call welch_spectrum(x, 1.0_dp, welch_options(), spectrum, error)
      call system_clock(to)
      print "(i0, a, f7.3, a)", n, " samples: spectrum ", real(to - from, dp)/rate, " s"
      options%longest = 262144
      call system_clock(from)
      call analyse_periodicity(x, 1.0_dp, options, result, error)
      call system_clock(to)
      print "(a, f7.3, a)", "lines of the middle 262144 (and the AR model of all) ", real(to - from, dp)/rate, " s"
      options%longest = 0
      call system_clock(from)
      call analyse_periodicity(x, 1.0_dp, options, result, error)
      call system_clock(to)
      print "(a, f7.3, a)", "lines of all ", real(to - from, dp)/rate, " s"
   end subroutine measure_cost

   !> White noise of any length.
   subroutine make_long(x)
      use gyroakf, only : random_type, seed_random, fill_normal
      real(dp), intent(out), contiguous :: x(:)
      type(random_type) :: random

      call seed_random(random, 1_int64)
      call fill_normal(random, x)
   end subroutine make_long

end program periodicity
