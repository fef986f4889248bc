! SPDX-License-Identifier: MIT
!> The sample interval from time stamps, the resolution of their clock, bursts of samples.
!>
!> All steps are counted in a histogram of 32 bins an octave. Where samples lie on an even grid of
!> interval \(T\), some of them lost and each with a jitter, the steps \(x\) are whole multiples of
!> \(T\) with a scatter, and the coherence $$C(f) = \overline{\cos 2\pi f x}$$ has a maximum at
!> \(f = 1/T\), whatever the pattern of the losses. \(1/T\) lies above the mean rate; of several
!> maxima of about the same height the lowest counts (the others are its harmonics).
module gyroakf_io_cadence
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_record, only : audit_type
   use gyroakf_sort, only : sort_values
   implicit none (type, external)
   private
   public :: cadence_type, steps_type, new_steps, find_cadence, find_sample_interval, count_bursts

   !> How samples come
   type :: cadence_type
      !> s from sample to sample where none is lost; 0 where the stamps do not rise
      real(dp) :: step = 0.0_dp
      !> Smallest difference between two steps, s: the clock's resolution; 0 below 1e-4 of the step
      real(dp) :: resolution = 0.0_dp
      !> Almost all steps are near whole multiples of the interval: single losses have a place
      logical :: regular = .false.
      !> Share of the steps that are shorter than half of the interval, and longer than 1.5 of it
      real(dp) :: short = 0.0_dp, long = 0.0_dp
   end type cadence_type

   !> Steps looked at for the resolution
   integer, parameter :: resolution_steps = 4001
   !> The histogram: 32 bins an octave from 2^-40 s to 2^40 s, the outermost also for the rest
   integer, parameter :: mantissa_bits = 5, octaves = 80, bins = octaves*2**mantissa_bits
   !> Lowest and highest rate tried, in mean rates of the usual steps, and their distance
   real(dp), parameter :: lowest_rate = 0.9_dp, highest_rate = 3.4_dp, rate_distance = 0.02_dp
   !> Least coherence of an even grid; harmonics do not count unless higher by more than this
   real(dp), parameter :: least_coherence = 0.18_dp, harmonic_share = 0.9_dp

   !> Work space, not on the stack of the caller, which may be small
   type :: steps_type
      !> Sum and number of the steps of each bin of the histogram, and some of the steps
      real(dp), allocatable :: total(:), some(:)
      integer(int64), allocatable :: number(:)
   end type steps_type

contains

   !> Work space for any number of calls.
   subroutine new_steps(steps, error)
      type(steps_type), intent(out) :: steps
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      allocate (steps%total(bins), stat=stat)
      if (stat == 0) allocate (steps%number(bins), stat=stat)
      if (stat == 0) allocate (steps%some(resolution_steps), stat=stat)
      call check_memory(stat, "a histogram of time steps", error)
   end subroutine new_steps

   !> The cadence of a series of stamps.
   subroutine find_cadence(t, steps, cadence)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(steps_type), intent(inout) :: steps
      type(cadence_type), intent(out) :: cadence
      type(error_type), allocatable :: failed
      real(dp) :: rounding
      real(dp), parameter :: golden = 0.6180339887498949_dp
      integer(int64) :: i, n
      integer :: k, m

      call find_sample_interval(t, steps, cadence)
      n = size(t, kind=int64)
      if (cadence%step <= 0.0_dp) return
      m = int(min(int(resolution_steps, int64), n - 1))
      do k = 1, m
         i = k + 1
         if (m < n - 1) i = 2 + int(modulo(k*golden, 1.0_dp)*real(n - 1, dp), int64)
         steps%some(k) = t(i) - t(i - 1)
      end do
      associate (step => steps%some(:m))
         call sort_values(step, failed)
         rounding = 1.0e-4_dp*max(step((m + 1)/2), 0.1_dp*cadence%step)
         cadence%resolution = smallest_difference(step, rounding)
      end associate
      if (cadence%resolution <= 0.3_dp*cadence%step) return
      if (min(cadence%short, cadence%long) > 0.002_dp) call use_mean(t, cadence)
   end subroutine find_cadence

   !> The interval alone, and whether the stamps are regular.
   subroutine find_sample_interval(t, steps, cadence)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(steps_type), intent(inout) :: steps
      !> Its resolution stays 0
      type(cadence_type), intent(out) :: cadence
      integer(int64) :: i, flat
      integer :: bin, used
      real(dp) :: step

      steps%total(:) = 0.0_dp
      steps%number(:) = 0
      flat = 0
      do i = 2, size(t, kind=int64)
         step = t(i) - t(i - 1)
         if (step > 0.0_dp) then
            bin = bin_of(step)
            steps%total(bin) = steps%total(bin) + step
            steps%number(bin) = steps%number(bin) + 1
         else
            flat = flat + 1
         end if
      end do
      used = 0
      do bin = 1, bins
         if (steps%number(bin) == 0) cycle
         used = used + 1
         steps%total(used) = steps%total(bin)/real(steps%number(bin), dp)
         steps%number(used) = steps%number(bin)
      end do
      if (used == 0) return
      steps%some(:used) = real(steps%number(:used), dp)
      call choose_sample_interval(steps%total(:used), steps%some(:used), real(flat, dp), cadence)
      if (.not. cadence%regular) call use_mean(t, cadence)
   end subroutine find_sample_interval

   pure integer function bin_of(step)
      real(dp), intent(in) :: step
      integer(int64), parameter :: lowest = shiftl(1023_int64 - octaves/2, mantissa_bits) - 1
      integer(int64) :: bits

      bits = shiftr(transfer(step, bits), 52 - mantissa_bits) - lowest
      bin_of = int(max(1_int64, min(int(bins, int64), bits)))
   end function bin_of

   !> The interval is the mean of the steps that do not go back.
   pure subroutine use_mean(t, cadence)
      real(dp), intent(in), contiguous :: t(:)
      type(cadence_type), intent(inout) :: cadence
      real(dp) :: total
      integer(int64) :: n

      n = size(t, kind=int64)
      total = sum(t(2:) - t(:n - 1), t(2:) >= t(:n - 1))
      cadence%regular = .false.
      cadence%step = 0.0_dp
      if (total > 0.0_dp) cadence%step = total/count(t(2:) >= t(:n - 1), kind=int64)
   end subroutine use_mean

   !> The interval that the steps are whole multiples of, and whether they are.
   !>
   !> Regular are stamps whose steps are near the interval (97 %), or coherent and hardly ever
   !> short. Where most of the time passes in steps of more than 2.5 intervals, samples are
   !> delivered in bursts.
   pure subroutine choose_sample_interval(x, weight, flat, cadence)
      real(dp), intent(in), contiguous :: x(:), weight(:)
      real(dp), intent(in) :: flat
      type(cadence_type), intent(inout) :: cadence
      integer, parameter :: tried = nint((highest_rate - lowest_rate)/rate_distance)
      real(dp) :: coherence(0:tried), usual, interval, all_steps, near, all_time, far_time
      integer :: k, best

      usual = usual_step(x, weight)
      k = count(x <= 4.0_dp*usual)
      call find_coherence(x(:k)/usual, weight(:k), coherence)
      best = maxloc(coherence, dim=1) - 1
      do k = 1, best - 1
         if (coherence(k) < harmonic_share*coherence(best)) cycle
         if (coherence(k) > coherence(k - 1) .and. coherence(k) >= coherence(k + 1)) exit
      end do
      if (best > 0) best = min(k, best)
      interval = usual/(lowest_rate + best*rate_distance)
      do k = 1, 2
         interval = mean_interval(x, weight, interval)
      end do
      if (interval <= 0.0_dp) return
      all_steps = sum(weight) + flat
      near = sum(weight, x > 0.5_dp*interval .and. x < 1.5_dp*interval)
      cadence%short = (sum(weight, x <= 0.5_dp*interval) + flat)/all_steps
      cadence%long = sum(weight, x >= 1.5_dp*interval)/all_steps
      all_time = sum(weight*min(x, 100.0_dp*interval))
      far_time = sum(weight*min(x, 100.0_dp*interval), x > 2.5_dp*interval)
      cadence%step = interval
      cadence%regular = near >= 0.97_dp*all_steps
      if (coherence(best) >= least_coherence .and. near >= 0.3_dp*all_steps) then
         cadence%regular = cadence%regular .or. cadence%short <= 0.06_dp
      end if
      cadence%regular = cadence%regular .and. far_time <= 0.5_dp*all_time
   end subroutine choose_sample_interval

   !> Mean of the steps that are no longer than eight medians.
   pure real(dp) function usual_step(x, weight) result(usual)
      real(dp), intent(in), contiguous :: x(:), weight(:)
      real(dp) :: half
      integer :: k

      half = 0.5_dp*sum(weight)
      do k = 1, size(x) - 1
         half = half - weight(k)
         if (half <= 0.0_dp) exit
      end do
      usual = sum(weight*x, x <= 8.0_dp*x(k))/sum(weight, x <= 8.0_dp*x(k))
   end function usual_step

   !> Mean cosine of the phases that the steps have at all rates that are tried.
   pure subroutine find_coherence(x, weight, coherence)
      real(dp), intent(in), contiguous :: x(:), weight(:)
      real(dp), intent(out) :: coherence(0:)
      real(dp), parameter :: turn = 6.283185307179586_dp
      complex(dp) :: phase(size(x)), change(size(x))
      integer :: k

      phase(:) = exp(cmplx(0.0_dp, turn*lowest_rate*x, dp))*weight/sum(weight)
      change(:) = exp(cmplx(0.0_dp, turn*rate_distance*x, dp))
      do k = 0, ubound(coherence, 1)
         coherence(k) = sum(real(phase))
         phase(:) = phase*change
      end do
   end subroutine find_coherence

   !> Time over intervals of the steps between 0.5 and 4.5 intervals.
   pure real(dp) function mean_interval(x, weight, interval)
      real(dp), intent(in), contiguous :: x(:), weight(:)
      real(dp), intent(in) :: interval
      logical :: near(size(x))

      near = x > 0.5_dp*interval .and. x < 4.5_dp*interval
      mean_interval = interval
      if (any(near)) mean_interval = sum(weight*x, near)/sum(weight*anint(x/interval), near)
   end function mean_interval

   !> The smallest difference between values, or between them and 0, that is more than rounding.
   pure real(dp) function smallest_difference(step, rounding) result(found)
      real(dp), intent(in) :: step(:), rounding
      real(dp) :: last
      integer :: k

      found = huge(1.0_dp)
      last = 0.0_dp
      do k = 1, size(step)
         if (step(k) <= 0.0_dp) cycle
         if (step(k) - last > rounding) found = min(found, step(k) - last)
         last = step(k)
      end do
      if (found >= huge(1.0_dp)) found = 0.0_dp
   end function smallest_difference

   !> Counts bursts: three samples or more at once, with less than 0.3 of the usual step between
   !> them, behind a long step; more of them than a tick of the clock holds.
   subroutine count_bursts(t, cadence, audit)
      !> Stamps, s
      real(dp), intent(in), contiguous :: t(:)
      type(cadence_type), intent(in) :: cadence
      !> Its bursts; `line_of_burst` is a row
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i, n, run, first, least
      logical :: late
      real(dp) :: short, long, step

      if (cadence%step <= 0.0_dp) return
      short = 0.3_dp*cadence%step
      long = 1.5_dp*cadence%step
      least = max(2_int64, ceiling(1.5_dp*min(cadence%resolution/cadence%step, 1.0e6_dp), int64))
      n = size(t, kind=int64)
      run = 0
      late = .false.
      first = 0
      do i = 2, n + 1
         step = huge(step)
         if (i <= n) step = t(i) - t(i - 1)
         if (abs(step) < short) then
            run = run + 1
            cycle
         end if
         if (late .and. run >= least) then
            audit%bursts = audit%bursts + 1
            audit%longest_burst = max(audit%longest_burst, run + 1)
            if (audit%line_of_burst == 0) audit%line_of_burst = first
         end if
         late = step >= long
         first = i
         run = 0
      end do
   end subroutine count_bursts

end module gyroakf_io_cadence
