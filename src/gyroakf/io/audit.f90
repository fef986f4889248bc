! SPDX-License-Identifier: MIT
!> The audit of a record: what the time stamps show, and what the values show.
!>
!> Samples are taken as evenly spaced at the mean rate. Stamps that come in bursts (delivered late, several at once) are no
!> gaps: samples were lost only where the lag, elapsed time * rate - count, rises and does not fall back. Where almost all steps
!> are near their median (regular stamps, [[gyroakf_io_cadence]]), one lost sample is seen at its long step; where they are not, by
!> the levels before and behind it ([[gyroakf_io_losses]]). Parts of different rates are looked at apart.
module gyroakf_io_audit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_extremes, only : scan_extremes
   use gyroakf_io_bursts, only : count_bursts
   use gyroakf_io_cadence, only : cadence_type, find_cadence, find_changes
   use gyroakf_io_losses, only : add_gap, find_losses, gap_type
   use gyroakf_io_regular_losses, only : find_gaps, is_beat, is_comb
   use gyroakf_io_repeats, only : drop_repeats, merge_repeats
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: gap_type, audit_stamps, audit_values

   !> So many samples may be filled in for one that was read
   integer(int64), parameter :: most_filled = 10
   !> Rates that a record may have one after the other
   integer, parameter :: most_changes = 8

contains

   !> Counts what the stamps show and finds the gaps.
   subroutine audit_stamps(t, audit, gaps, value)
      !> Stamps in s: [n]; NaN where missing. Afterwards, in the first n - `audit%repeated`, without backward jumps, repeated rows
      !> and jumps that are not filled, missing ones interpolated
      real(dp), intent(inout), contiguous :: t(:)
      !> Filled: stamps, rate, duplicates, backward steps, bursts, jitter; `line_of_*` hold sample indices
      type(audit_type), intent(inout) :: audit
      !> Where samples were lost, and rows that are none
      type(gap_type), intent(out) :: gaps
      !> The rows, by which repeated ones are told from others of the same stamp: [n, channel]
      real(dp), intent(in), contiguous, optional :: value(:, :)
      type(cadence_type) :: whole
      integer(int64), allocatable :: repeated(:)
      integer(int64) :: n, change(most_changes), lost
      integer :: changes
      real(dp) :: steps(most_changes + 1)

      n = size(t, kind=int64)
      audit%has_stamps = n > 0
      allocate (audit%line_of_first(3))
      audit%line_of_first = 0
      allocate (gaps%before(16), gaps%length(16))
      if (n < 2) return
      call interpolate(t)
      if (present(value)) call drop_repeats(t, value, repeated)
      if (allocated(repeated)) n = n - size(repeated)
      call find_cadence(t(:n), whole)
      call count_steps(t(:n), whole%step, audit)
      if (whole%step > 0.0_dp) then
         audit%resolution = whole%resolution
         call find_changes(t(:n), change, steps, changes)
         call audit_stretches(t(:n), whole, change(:changes), audit, gaps)
         audit%gaps = gaps%count + gaps%jumps
         audit%jumps = gaps%jumps
         call note_changes(change(:changes), steps, audit)
         call note_first_gap(gaps, audit)
         lost = sum(gaps%length(:gaps%count))
         if (t(n) > t(1)) audit%stamp_rate = real(n - 1 + lost, dp)/(t(n) - t(1))
         call measure_jitter(t(:n), gaps, audit)
         call count_bursts(t(:n), whole, audit)
      end if
      if (allocated(repeated)) call merge_repeats(repeated, audit, gaps)
   end subroutine audit_stamps

   !> Finds the losses in each stretch of one rate.
   subroutine audit_stretches(t, whole, change, audit, gaps)
      real(dp), intent(inout), contiguous :: t(:)
      !> Of the whole
      type(cadence_type), intent(in) :: whole
      !> First sample of each further rate
      integer(int64), intent(in) :: change(:)
      !> Its beats are counted
      type(audit_type), intent(inout) :: audit
      type(gap_type), intent(inout) :: gaps
      type(cadence_type) :: cadence
      type(gap_type) :: part
      integer(int64) :: first, last
      integer :: k, g

      do k = 0, size(change)
         first = 1
         last = size(t, kind=int64)
         if (k >= 1) first = change(max(k, 1))
         if (k < size(change)) last = change(k + 1) - 1
         if (last <= first) cycle
         if (size(change) == 0) then
            cadence = whole
         else
            call find_cadence(t(first:last), cadence)
         end if
         call audit_stretch(t(first:), last - first + 1, cadence, part, audit)
         do g = 1, part%count
            call add_gap(gaps, part%before(g) + first - 1, part%length(g))
         end do
         if (part%jumps > 0 .and. gaps%jumps == 0) gaps%first_jump = part%first_jump + first - 1
         gaps%jumps = gaps%jumps + part%jumps
      end do
   end subroutine audit_stretches

   !> The losses in a stretch of one rate; jumps that are too long to be filled are taken out of the stamps.
   subroutine audit_stretch(t, n, cadence, gaps, audit)
      !> From the first sample of the stretch to the last of the record
      real(dp), intent(inout), contiguous :: t(:)
      !> Samples of the stretch
      integer(int64), intent(in) :: n
      type(cadence_type), intent(in) :: cadence
      type(gap_type), intent(out) :: gaps
      type(audit_type), intent(inout) :: audit
      real(dp) :: step

      allocate (gaps%before(16), gaps%length(16))
      if (cadence%step <= 0.0_dp) return
      if (cadence%regular) then
         call find_gaps(t(:n), cadence%step, gaps)
         if (is_beat(gaps, cadence, n)) then
            audit%beats = audit%beats + gaps%count
            gaps%count = 0
         else if (is_comb(gaps, cadence)) then
            gaps%count = 0
            call find_losses(t(:n), cadence, gaps, step)
         end if
      else
         call find_losses(t(:n), cadence, gaps, step)
      end if
      call join_jumps(t, n, cadence%step, gaps)
   end subroutine audit_stretch

   !> Fills missing stamps between their neighbours; at the ends by the mean step.
   subroutine interpolate(t)
      real(dp), intent(inout), contiguous :: t(:)
      integer(int64) :: i, j, first, last, n
      real(dp) :: step

      n = size(t, kind=int64)
      first = 0
      last = 0
      do i = 1, n
         if (ieee_is_nan(t(i))) cycle
         if (first == 0) first = i
         do j = last + 1, i - 1
            if (last > 0) t(j) = t(last) + (t(i) - t(last))*(real(j - last, dp)/real(i - last, dp))
         end do
         last = i
      end do
      step = 1.0_dp
      if (first == 0) then
         first = 1
         last = 1
         t(1) = 0.0_dp
      end if
      if (last > first) step = (t(last) - t(first))/real(last - first, dp)
      do i = 1, n
         if (i < first) t(i) = t(first) - step*real(first - i, dp)
         if (i > last) t(i) = t(last) + step*real(i - last, dp)
      end do
   end subroutine interpolate

   !> The rates before and behind the first change.
   subroutine note_changes(change, steps, audit)
      integer(int64), intent(in) :: change(:)
      real(dp), intent(in) :: steps(:)
      type(audit_type), intent(inout) :: audit

      audit%rate_changes = size(change, kind=int64)
      if (size(change) == 0) return
      audit%line_of_change = change(1)
      audit%rate_before = 1.0_dp/steps(1)
      audit%rate_after = 1.0_dp/steps(2)
   end subroutine note_changes

   !> Where the first samples are lost.
   subroutine note_first_gap(gaps, audit)
      type(gap_type), intent(in) :: gaps
      type(audit_type), intent(inout) :: audit

      audit%line_of_first(3) = gaps%first_jump
      if (gaps%count > 0) audit%line_of_first(3) = gaps%before(1)
      if (gaps%count > 0 .and. gaps%first_jump > 0) audit%line_of_first(3) = min(gaps%before(1), gaps%first_jump)
   end subroutine note_first_gap

   !> Counts duplicates and backward steps; a clock that was set back by more than ten samples goes on by one sample.
   subroutine count_steps(t, interval, audit)
      real(dp), intent(inout), contiguous :: t(:)
      !> Usual, s
      real(dp), intent(in) :: interval
      type(audit_type), intent(inout) :: audit
      real(dp) :: step, shift
      integer(int64) :: i

      shift = 0.0_dp
      do i = 2, size(t, kind=int64)
         t(i) = t(i) + shift
         step = t(i) - t(i - 1)
         if (step > 0.0_dp) cycle
         if (step < 0.0_dp) then
            audit%backward_steps = audit%backward_steps + 1
            if (audit%line_of_first(2) == 0) audit%line_of_first(2) = i
            if (interval <= 0.0_dp .or. step > -10.0_dp*interval) cycle
            shift = shift - step + interval
            t(i) = t(i - 1) + interval
         else
            audit%duplicates = audit%duplicates + 1
            if (audit%line_of_first(1) == 0) audit%line_of_first(1) = i
         end if
      end do
   end subroutine count_steps

   !> Takes jumps that are too long to be filled out of the stamps and of the gaps.
   subroutine join_jumps(t, n, interval, gaps)
      !> From the first sample of the stretch to the last of the record
      real(dp), intent(inout), contiguous :: t(:)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: interval
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: room, i
      integer :: k, kept

      room = most_filled*max(n, 10000_int64)
      kept = 0
      do k = 1, gaps%count
         i = gaps%before(k)
         if (gaps%length(k) > room) then
            gaps%jumps = gaps%jumps + 1
            if (gaps%first_jump == 0) gaps%first_jump = i
            t(i:) = t(i:) - (t(i) - t(i - 1) - interval)
         else
            room = room - gaps%length(k)
            kept = kept + 1
            gaps%before(kept) = i
            gaps%length(kept) = gaps%length(k)
         end if
      end do
      gaps%count = kept
   end subroutine join_jumps

   !> The largest and the usual distance of a stamp from the even grid at the mean rate, and the rates of the halves.
   subroutine measure_jitter(t, gaps, audit)
      real(dp), intent(in), contiguous :: t(:)
      type(gap_type), intent(in) :: gaps
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i, at, n, middle, middle_at
      integer :: next
      real(dp) :: distance, total, squares

      if (audit%stamp_rate <= 0.0_dp) return
      n = size(t, kind=int64)
      next = 1
      at = -1
      total = 0.0_dp
      squares = 0.0_dp
      middle = (n + 1)/2
      middle_at = 0
      do i = 1, n
         at = at + 1
         if (next <= gaps%count) then
            if (gaps%before(next) == i) then
               at = at + gaps%length(next)
               next = next + 1
            end if
         end if
         if (i == middle) middle_at = at
         distance = t(i) - t(1) - real(at, dp)/audit%stamp_rate
         audit%jitter_max = max(audit%jitter_max, abs(distance))
         total = total + distance
         squares = squares + distance*distance
      end do
      audit%jitter_rms = sqrt(max(0.0_dp, squares/n - (total/n)**2))
      if (t(middle) > t(1)) audit%rate_first = real(middle_at, dp)/(t(middle) - t(1))
      if (t(n) > t(middle)) audit%rate_second = real(at - middle_at, dp)/(t(n) - t(middle))
   end subroutine measure_jitter

   !> Counts what is missing; extremes and the smallest non-zero step of every channel.
   subroutine audit_values(value, present_mask, audit, error, progress)
      !> [sample, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> [sample, channel] 1 present, 0 missing; unallocated where nothing is missing
      integer(int8), allocatable, intent(in) :: present_mask(:, :)
      !> Filled: samples, missing, extremes, quantisation
      type(audit_type), intent(inout) :: audit
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told before every channel; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer :: j, channels

      channels = size(value, 2)
      allocate (audit%minimum(channels), audit%maximum(channels), audit%quantisation(channels))
      audit%samples = size(value, 1, kind=int64)
      audit%missing = 0
      do j = 1, channels
         call tell_progress("completing the record", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         if (allocated(present_mask)) then
            audit%missing = audit%missing + audit%samples - sum(int(present_mask(:, j), int64))
            call extremes(value(:, j), audit%minimum(j), audit%maximum(j), audit%quantisation(j), present_mask(:, j))
         else
            call scan_extremes(value(:, j), audit%minimum(j), audit%maximum(j), audit%quantisation(j))
         end if
      end do
   end subroutine audit_values

   !> Extremes and the smallest non-zero step of a series; zeros where it has no sample.
   pure subroutine extremes(x, low, high, step, mask)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(out) :: low, high, step
      integer(int8), intent(in) :: mask(:)
      real(dp) :: change
      integer(int64) :: i, before

      low = huge(low)
      high = -huge(high)
      step = huge(step)
      do i = 1, size(x, kind=int64)
         if (mask(i) == 0) cycle
         low = min(low, x(i))
         high = max(high, x(i))
         before = max(i - 1, 1_int64)
         if (mask(before) == 0) cycle
         change = abs(x(i) - x(before))
         if (change > 0.0_dp) step = min(step, change)
      end do
      if (step >= huge(step)) step = 0.0_dp
      if (low <= high) return
      low = 0.0_dp
      high = 0.0_dp
   end subroutine extremes

end module gyroakf_io_audit
