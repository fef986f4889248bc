! SPDX-License-Identifier: MIT
!> Lost samples: where the lag, elapsed time / step - count, rises and does not fall back.
!>
!> The lag is followed from stamp to stamp where they are regular, and from block to block by the
!> mean stamps where they are not ([[gyroakf_io_lag_levels]]). Every rise above a threshold begins a
!> gap, where the stamps fit a step of the lag best; where they come sooner than the grid lets them,
!> as after a late one, the last gap is given back. The pattern of losses among regular stamps
!> distinguishes lost samples from the beat with a coarse clock.
module gyroakf_io_losses
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_lag_levels, only : find_levels
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: gap_type, add_gap, find_losses, explain_losses

   !> Samples that were lost, and rows that are no samples
   type :: gap_type
      !> The sample after the gap: [gap]
      integer(int64), allocatable :: before(:)
      !> How many were lost; -1: the row `before` repeats the one above and is left out: [gap]
      integer(int64), allocatable :: length(:)
      !> How many gaps and repeated rows
      integer :: count = 0
      !> Jumps of the clock that are too long to be filled
      integer(int64) :: jumps = 0
      !> The sample after the first of them, 0 where there is none
      integer(int64) :: first_jump = 0
   end type gap_type

   !> How the phase follows the stamps, and the longest gap over which it is kept, intervals
   real(dp), parameter :: phase_gain = 1.0_dp/32.0_dp, longest_kept = 50.0_dp
   !> A rise has to last so many samples, or four times the samples lost; else it is only late
   integer(int64), parameter :: lasting = 2048
   !> A rise in blocks is looked for so far back, not near an end; its longest step is near
   integer(int64), parameter :: farthest = 160, edge = 4, near = 2

   !> Losses at even distances of so many samples or more are the beat of a clock that counts in
   !> nearly the interval, unless all distances are equal and only the rate with losses is round
   integer(int64), parameter :: longest_period = 50

   !> What losses look like. Scattered, or none: samples were lost. Periodic, mostly single samples
   !> at exactly even distances: every k-th was lost, or the clock counts in the interval. Beating,
   !> at nearly even distances: the samples and a clock that counts in more than half of the
   !> interval. A comb has such beats, and losses among them
   integer, parameter :: scattered = 0, periodic = 1, beating = 2, comb = 3

contains

   !> Finds the losses; again with the interval that follows from them, until it is right.
   subroutine find_losses(t, cadence, regular, gaps)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(cadence_type), intent(in) :: cadence
      !> False: the mean stamps of blocks are followed
      logical, intent(in) :: regular
      !> Emptied first; none among fewer than 192 stamps that are not regular
      type(gap_type), intent(inout) :: gaps
      real(dp), allocatable :: level(:)
      real(dp) :: step, rise, usual
      integer :: rows

      gaps%count = 0
      if (regular) then
         call follow_lag(t, t, 1, cadence%step, 0.5_dp, 0.0_dp, gaps)
         return
      end if
      call find_levels(t, cadence, level, rows, step, rise, usual)
      if (size(level) > 0) call follow_lag(t, level, rows, step, rise, usual, gaps)
   end subroutine find_losses

   !> Finds the gaps with one interval after the other, until it hardly changes.
   pure subroutine follow_lag(t, level, rows, interval, rise, usual, gaps)
      real(dp), intent(in), contiguous :: t(:), level(:)
      integer, intent(in) :: rows
      real(dp), value :: interval
      real(dp), intent(in) :: rise, usual
      type(gap_type), intent(inout) :: gaps
      integer, parameter :: max_iterations = 4
      real(dp), parameter :: tolerance = 5.0e-4_dp
      real(dp) :: found
      integer(int64) :: n
      integer :: k

      n = size(t, kind=int64)
      do k = 1, max_iterations
         gaps%count = 0
         call find_gaps(t, level, rows, interval, rise, usual, gaps)
         if (sum(gaps%length(:gaps%count)) > n) return
         found = (t(n) - t(1))/real(n - 1 + sum(gaps%length(:gaps%count)), dp)
         if (abs(found - interval) <= tolerance*interval) return
         interval = found
      end do
   end subroutine follow_lag

   pure subroutine find_gaps(t, level, rows, interval, rise, usual, gaps)
      !> Stamps, s; means of blocks of so many, or the stamps themselves
      real(dp), intent(in), contiguous :: t(:), level(:)
      integer, intent(in) :: rows
      !> s from sample to sample; least rise at a loss, and longest step of most blocks, samples
      real(dp), intent(in) :: interval, rise, usual
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: b, i, lost, early, early_at, known
      real(dp) :: rate, phase, x

      rate = 1.0_dp/interval
      phase = 0.0_dp
      early = 0
      early_at = 0
      known = 0
      do b = 2, size(level, kind=int64)
         x = (level(b) - level(b - 1))*rate - rows + phase
         if (x >= -rise .and. x < rise) then
            phase = (1.0_dp - phase_gain)*x
            cycle
         end if
         i = b*rows
         lost = nint(min(x, 1.0e15_dp), int64)
         if (rows > 1) then
            if (x > 0.0_dp) call place_rise(t, max(known, i - max(2_int64*rows, farthest)), &
               min(i + rows, size(t, kind=int64)), rate, usual, i, lost)
            if (b < size(level)) lost = min(lost, nint(min(x + (level(b + 1) - level(b))*rate - &
               rows, 1.0e15_dp), int64))
            if (x > 0.0_dp .and. lost < rise) then
               phase = (1.0_dp - phase_gain)*x
               cycle
            end if
         end if
         known = i - 1
         phase = 0.0_dp
         if (rows > 1 .or. x < longest_kept) phase = x - real(lost, dp)
         if (i - early_at > lasting) early = 0
         if (lost > 0) then
            x = real(lost, dp)
            lost = max(0_int64, lost - early)
            early = max(0_int64, early - int(x, int64))
            if (lost > 0) call add_gap(gaps, i, lost)
         else
            call give_back(i, -lost, rise, gaps, early)
            early_at = i
         end if
      end do
   end subroutine find_gaps

   !> Where and by how much the lag rises behind sample `first`: the step of least squares.
   pure subroutine place_rise(t, first, last, rate, usual, before, lost)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: first, last
      real(dp), intent(in) :: rate, usual
      !> The sample behind the longest step near it; 0 samples where that step is too short
      integer(int64), intent(out) :: before, lost
      real(dp) :: total(first:last), weight, height, most, found, step
      integer(int64) :: i

      total(first) = 0.0_dp
      do i = first + 1, last
         total(i) = total(i - 1) + (t(i) - t(first + 1))*rate - real(i - first, dp)
      end do
      most = 0.0_dp
      height = 0.0_dp
      before = first + 2
      do i = first + edge, last - edge
         weight = real(i - first, dp)*real(last - i, dp)/real(last - first, dp)
         found = (total(last)*(real(i - first, dp)/real(last - first, dp)) - total(i))/weight
         if (found <= 0.0_dp .or. found*found*weight <= most) cycle
         most = found*found*weight
         height = found
         before = i + 1
      end do
      i = max(before - near, first + 2)
      before = i - 1 + maxloc(t(i:min(before + near, last)) - &
         t(i - 1:min(before + near, last) - 1), dim=1, kind=int64)
      lost = nint(min(height, 1.0e15_dp), int64)
      step = (t(before) - t(before - 1))*rate
      height = min(real(lost, dp), step)
      if (step < 0.75_dp*height + 0.45_dp) lost = 0
      if (usual > 3.0_dp .and. step < usual + 0.5_dp*height - 0.5_dp) lost = 0
   end subroutine place_rise

   !> Shortens the last gaps by places that are taken after all.
   pure subroutine give_back(i, places, rise, gaps, early)
      integer(int64), intent(in) :: i, places
      real(dp), intent(in) :: rise
      type(gap_type), intent(inout) :: gaps
      integer(int64), intent(inout) :: early
      integer(int64) :: left, taken

      left = places
      do while (left > 0 .and. gaps%count > 0)
         associate (before => gaps%before(gaps%count), length => gaps%length(gaps%count))
            if (i - before > max(lasting, 4*length)) exit
            taken = min(left, length)
            length = length - taken
            left = left - taken
            if (length < rise) gaps%count = gaps%count - 1
         end associate
      end do
      early = early + left
   end subroutine give_back

   !> Appends a gap; one behind the last lengthens it.
   pure subroutine add_gap(gaps, before, length)
      type(gap_type), intent(inout) :: gaps
      integer(int64), intent(in) :: before, length

      if (gaps%count == size(gaps%before)) then
         gaps%before = [gaps%before, gaps%before]
         gaps%length = [gaps%length, gaps%length]
      end if
      if (gaps%count > 0) then
         if (gaps%before(gaps%count) == before) then
            gaps%length(gaps%count) = gaps%length(gaps%count) + length
            return
         end if
      end if
      gaps%count = gaps%count + 1
      gaps%before(gaps%count) = before
      gaps%length(gaps%count) = length
   end subroutine add_gap

   !> Decides whether losses at even distances are losses or the beat of the samples with a coarse
   !> clock: those at exactly even distances below 50 samples are losses, others are not, unless the
   !> given rate is nearer to that of the other explanation.
   subroutine explain_losses(t, cadence, given, gaps, audit)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(cadence_type), intent(in) :: cadence
      !> Sample rate that was given, Hz, 0 for none
      real(dp), intent(in) :: given
      !> Losses of single samples; fewer where they are none
      type(gap_type), intent(inout) :: gaps
      !> Its beats and the other rate are set
      type(audit_type), intent(inout) :: audit
      real(dp) :: grid_rate, beat_rate
      integer(int64) :: distance
      integer :: found
      logical :: beat

      call loss_pattern(gaps, cadence, size(t, kind=int64), found, distance)
      if (found == scattered) return
      grid_rate = 1.0_dp/cadence%step
      if (found == comb) then
         call find_losses(t, cadence, .false., gaps)
         return
      end if
      beat = found == beating
      beat_rate = grid_rate*real(distance, dp)/real(distance + 1, dp)
      if (beat) beat_rate = real(size(t) - 1, dp)/(t(size(t)) - t(1))
      if (given > 0.0_dp) beat = abs(given - beat_rate) < abs(given - grid_rate)
      if (given <= 0.0_dp) audit%other_rate = merge(grid_rate, beat_rate, beat)
      if (.not. beat) return
      audit%beats = audit%beats + gaps%count
      gaps%count = 0
   end subroutine explain_losses

   !> What the losses look like, and the samples from loss to loss where most are alike, else 0.
   !> Where no beat is possible, with a fine clock, samples were lost.
   pure subroutine loss_pattern(gaps, cadence, n, found, distance)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64), intent(in) :: n
      integer, intent(out) :: found
      integer(int64), intent(out) :: distance
      !> A clock that runs so much fast or slow explains up to three double steps, several at even
      !> distances from each other and no farther from the ends
      real(dp), parameter :: usual_drift = 3.0e-4_dp
      integer(int64) :: between(max(gaps%count - 1, 0))
      real(dp) :: usual
      integer :: k, m, equal, beside, alike

      found = scattered
      distance = 0
      m = gaps%count - 1
      if (m < 0 .or. cadence%resolution < 0.5_dp*cadence%step) return
      between(:) = gaps%before(2:gaps%count) - gaps%before(:m)
      if (m < 3) then
         if (any(gaps%length(:gaps%count) > 1)) return
         if (m > 0) distance = maxval(between)
         if (m > 0 .and. (10*minval(between) < 9*distance .or. 10*max(gaps%before(1), &
                          n - gaps%before(gaps%count)) > 11*distance)) return
         if (m > 0) found = periodic
         if (real(gaps%count, dp) < usual_drift*real(n, dp)) found = beating
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
         found = periodic
      else if (equal == m .and. m >= 20 .and. is_round(1.0_dp/cadence%step) .and. &
               .not. is_round(real(distance, dp)/(real(distance + 1, dp)*cadence%step))) then
         found = periodic
      else if (10*alike >= 9*m .and. all(gaps%length(:gaps%count) == 1)) then
         found = beating
      else if (m >= 8 .and. 2*count(abs(between - distance) <= max(2_int64, &
         distance/10)) >= m .and. distance >= longest_period) then
         found = comb
      end if
   end subroutine loss_pattern

   !> True for a rate of three digits.
   pure logical function is_round(rate)
      real(dp), intent(in) :: rate
      real(dp) :: digits

      digits = rate*10.0_dp**(2 - floor(log10(rate)))
      is_round = abs(digits - anint(digits)) <= 1.0e-5_dp*digits
   end function is_round

end module gyroakf_io_losses
