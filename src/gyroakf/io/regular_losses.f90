! SPDX-License-Identifier: MIT
!> Losses among regular stamps: the lag, elapsed time * rate - count, rises by a whole number and
!> stays there.
!>
!> Every stamp is given the number of its place on an even grid whose phase follows the stamps
!> slowly. Where a number is left out a gap begins; where stamps come sooner than the grid lets
!> them, as after a late one, the last gap is given back.
module gyroakf_io_regular_losses
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_losses, only : add_gap, gap_type, lasting
   implicit none (type, external)
   private
   public :: find_gaps, loss_pattern, pattern

   !> How the phase follows the stamps, and the longest gap over which it is kept, intervals
   real(dp), parameter :: phase_gain = 1.0_dp/32.0_dp, longest_kept = 50.0_dp
   !> Losses at even distances of so many samples or more are the beat of a clock that counts in
   !> nearly the interval
   integer(int64), parameter :: longest_period = 50

   !> What losses look like, reached as `pattern%beat`
   type :: pattern_enum
      !> Scattered, or none: samples were lost
      integer :: losses = 0
      !> Mostly single samples at exactly even distances: every k-th was lost, or the clock counts
      !> in the interval
      integer :: periodic = 1
      !> Nearly even distances: the beat of the samples with a clock that counts in more than half
      !> of the interval
      integer :: beat = 2
      !> Such beats, and losses among them
      integer :: comb = 3
   end type pattern_enum

   !> All patterns
   type(pattern_enum), parameter :: pattern = pattern_enum()

contains

   !> Finds where samples of regular stamps were lost.
   pure subroutine find_gaps(t, interval, gaps)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> s from sample to sample
      real(dp), intent(in) :: interval
      !> Appended to, in order
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: i, lost, early, early_at
      real(dp) :: rate, phase, x

      rate = 1.0_dp/interval
      phase = 0.0_dp
      early = 0
      early_at = 0
      do i = 2, size(t, kind=int64)
         x = (t(i) - t(i - 1))*rate + phase
         if (x >= 0.5_dp .and. x < 1.5_dp) then
            phase = (1.0_dp - phase_gain)*(x - 1.0_dp)
            cycle
         end if
         lost = nint(min(x, 1.0e15_dp), int64) - 1
         phase = 0.0_dp
         if (x < longest_kept) phase = (1.0_dp - phase_gain)*(x - real(lost + 1, dp))
         if (i - early_at > lasting) early = 0
         if (lost > 0) then
            x = real(lost, dp)
            lost = max(0_int64, lost - early)
            early = max(0_int64, early - int(x, int64))
            if (lost > 0) call add_gap(gaps, i, lost)
         else
            call give_back(i, -lost, gaps, early)
            early_at = i
         end if
      end do
   end subroutine find_gaps

   !> Shortens the last gaps by places that are taken after all.
   pure subroutine give_back(i, places, gaps, early)
      integer(int64), intent(in) :: i, places
      type(gap_type), intent(inout) :: gaps
      !> Places that belong to no gap are added to it
      integer(int64), intent(inout) :: early
      integer(int64) :: left, taken

      left = places
      do while (left > 0 .and. gaps%count > 0)
         associate (before => gaps%before(gaps%count), length => gaps%length(gaps%count))
            if (i - before > max(lasting, 4*length)) exit
            taken = min(left, length)
            length = length - taken
            left = left - taken
            if (length == 0) gaps%count = gaps%count - 1
         end associate
      end do
      early = early + left
   end subroutine give_back

   !> What the losses look like; always losses where the clock counts in less than half of the
   !> interval, and no beat is possible.
   pure subroutine loss_pattern(gaps, cadence, n, found, distance)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      !> Samples
      integer(int64), intent(in) :: n
      !> A component of [[gyroakf_io_regular_losses:pattern]]
      integer, intent(out) :: found
      !> Samples from loss to loss where most are alike, 0 where none are
      integer(int64), intent(out) :: distance
      !> A clock that runs so much fast or slow explains single double steps
      real(dp), parameter :: usual_drift = 3.0e-4_dp
      integer(int64) :: between(max(gaps%count - 1, 0))
      real(dp) :: usual
      integer :: k, m, equal, beside, alike

      found = pattern%losses
      distance = 0
      m = gaps%count - 1
      if (m < 0 .or. cadence%resolution < 0.5_dp*cadence%step) return
      between(:) = gaps%before(2:gaps%count) - gaps%before(:m)
      if (m < 3) then
         if (any(gaps%length(:gaps%count) > 1)) return
         if (real(gaps%count, dp) < usual_drift*real(n, dp)) found = pattern%beat
         return
      end if
      equal = 0
      do k = 1, min(m, 12)
         alike = count(between == between(k))
         if (alike <= equal) cycle
         equal = alike
         distance = between(k)
      end do
      beside = count(abs(between - distance) == 1)
      usual = real(gaps%before(gaps%count) - gaps%before(1), dp)/real(m, dp)
      alike = count(abs(real(between, dp) - usual) <= max(1.0_dp, 0.1_dp*usual))
      if (2*count(gaps%length(:gaps%count) == 1) < gaps%count) return
      if (2*equal >= m .and. 2*beside <= m - equal .and. distance < longest_period) then
         found = pattern%periodic
      else if (10*alike >= 9*m .and. all(gaps%length(:gaps%count) == 1)) then
         found = pattern%beat
      else if (m >= 8 .and. 2*count(abs(between - distance) <= max(2_int64, distance/10)) >= m .and. &
               distance >= longest_period) then
         found = pattern%comb
      end if
   end subroutine loss_pattern

end module gyroakf_io_regular_losses
