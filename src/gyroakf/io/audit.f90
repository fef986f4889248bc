! SPDX-License-Identifier: MIT
!> The audit of a record: what the time stamps show, and what the values show.
!>
!> Samples are taken as evenly spaced at the mean rate. Samples were lost only where the lag,
!> elapsed time * rate - count, rises and does not fall back ([[gyroakf_io_losses]]).
module gyroakf_io_audit
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_extremes, only : scan_extremes
   use gyroakf_io_cadence, only : cadence_type, count_bursts, find_cadence, new_steps, steps_type
   use gyroakf_io_losses, only : add_gap, explain_losses, find_losses, gap_type
   use gyroakf_io_rate_changes, only : find_changes
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
   subroutine audit_stamps(t, audit, gaps, error, rate_hz)
      !> s, none missing: [n]; afterwards without backward jumps and jumps that are not filled
      real(dp), intent(inout), contiguous :: t(:)
      !> What the stamps show; `line_of_*` hold sample indices
      type(audit_type), intent(inout) :: audit
      !> Where samples were lost
      type(gap_type), intent(out) :: gaps
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Given sample rate, Hz, for stamps that two rates explain; 0 (also if absent): none
      real(dp), intent(in), optional :: rate_hz
      type(cadence_type) :: whole
      type(steps_type) :: work
      integer(int64) :: n, change(most_changes), lost
      integer :: changes
      real(dp) :: steps(most_changes + 1), given

      given = 0.0_dp
      if (present(rate_hz)) given = rate_hz
      n = size(t, kind=int64)
      audit%has_stamps = n > 0
      allocate (audit%line_of_first(3), source=0_int64)
      allocate (gaps%before(16), gaps%length(16))
      if (n < 2) return
      call new_steps(work, error)
      if (allocated(error)) return
      call find_cadence(t, work, whole)
      call count_steps(t, whole%step, audit)
      if (whole%step <= 0.0_dp) return
      audit%resolution = whole%resolution
      call find_changes(t, work, change, steps, changes)
      call audit_stretches(t, work, whole, change(:changes), given, audit, gaps)
      audit%gaps = gaps%count + gaps%jumps
      audit%jumps = gaps%jumps
      audit%rate_changes = changes
      if (changes > 0) then
         audit%line_of_change = change(1)
         audit%rate_before = 1.0_dp/steps(1)
         audit%rate_after = 1.0_dp/steps(2)
      end if
      audit%line_of_first(3) = gaps%first_jump
      if (gaps%count > 0) audit%line_of_first(3) = gaps%before(1)
      if (gaps%count > 0 .and. gaps%first_jump > 0) then
         audit%line_of_first(3) = min(gaps%before(1), gaps%first_jump)
      end if
      lost = sum(gaps%length(:gaps%count))
      if (t(n) > t(1)) audit%stamp_rate = real(n - 1 + lost, dp)/(t(n) - t(1))
      call measure_jitter(t, gaps, audit)
      call count_bursts(t, whole, audit)
   end subroutine audit_stamps

   !> Finds the losses in each stretch of one rate; takes jumps too long to be filled out.
   subroutine audit_stretches(t, work, whole, change, given, audit, gaps)
      real(dp), intent(inout), contiguous :: t(:)
      type(steps_type), intent(inout) :: work
      type(cadence_type), intent(in) :: whole
      integer(int64), intent(in) :: change(:)
      real(dp), intent(in) :: given
      type(audit_type), intent(inout) :: audit
      type(gap_type), intent(inout) :: gaps
      type(cadence_type) :: cadence
      type(gap_type) :: part
      integer(int64) :: first, last
      integer :: k, g

      allocate (part%before(16), part%length(16))
      do k = 0, size(change)
         first = 1
         last = size(t, kind=int64)
         if (k >= 1) first = change(max(k, 1))
         if (k < size(change)) last = change(k + 1) - 1
         if (last <= first) cycle
         cadence = whole
         if (size(change) > 0) call find_cadence(t(first:last), work, cadence)
         if (cadence%step <= 0.0_dp) cycle
         part%jumps = 0
         part%first_jump = 0
         call find_losses(t(first:last), cadence, cadence%regular, part)
         if (cadence%regular) call explain_losses(t(first:last), cadence, given, part, audit)
         call join_jumps(t(first:), last - first + 1, cadence%step, part)
         do g = 1, part%count
            call add_gap(gaps, part%before(g) + first - 1, part%length(g))
         end do
         if (part%jumps > 0 .and. gaps%jumps == 0) gaps%first_jump = part%first_jump + first - 1
         gaps%jumps = gaps%jumps + part%jumps
      end do
   end subroutine audit_stretches

   !> Counts duplicates, rollovers and backward steps; a clock that starts again is continued, one
   !> that was set back by more than ten samples otherwise goes on by one sample. Up to eight stamps
   !> that are ahead of the next ones by more lie evenly between their neighbors.
   subroutine count_steps(t, interval, audit)
      real(dp), intent(inout), contiguous :: t(:)
      real(dp), intent(in) :: interval
      type(audit_type), intent(inout) :: audit
      real(dp) :: step, shift, period
      integer(int64) :: i
      integer :: j, k

      shift = 0.0_dp
      do i = 2, size(t, kind=int64)
         t(i) = t(i) + shift
         step = t(i) - t(i - 1)
         if (step > 0.0_dp) cycle
         if (step < 0.0_dp) then
            period = rollover_of(step, interval)
            if (period > 0.0_dp) then
               audit%rollovers = audit%rollovers + 1
               audit%rollover_period = period
               if (audit%line_of_rollover == 0) audit%line_of_rollover = i
            else
               audit%backward_steps = audit%backward_steps + 1
               if (audit%line_of_first(2) == 0) audit%line_of_first(2) = i
               if (interval <= 0.0_dp .or. step > -3.0_dp*interval) cycle
               do k = 2, int(min(9_int64, i - 1))
                  if (t(i - k) < t(i)) exit
               end do
               if (k <= min(9_int64, i - 1)) then
                  t(i - k + 1:i - 1) = t(i - k) + [(j, j=1, k - 1)]*(t(i) - t(i - k))/k
               end if
               if (k <= min(9_int64, i - 1) .or. step > -10.0_dp*interval) cycle
               period = interval - step
            end if
            shift = shift + period
            t(i) = t(i) + period
         else
            audit%duplicates = audit%duplicates + 1
            if (audit%line_of_first(1) == 0) audit%line_of_first(1) = i
         end if
      end do
   end subroutine count_steps

   !> The period after which a clock starts again, s; 0 where the stamps would not go on soon.
   pure real(dp) function rollover_of(step, interval) result(period)
      real(dp), intent(in) :: step, interval
      !> Day, GPS week; 16, 24, 31, 32 bits of us, 100 us and ms
      real(dp), parameter :: periods(*) = [86400.0_dp, 604800.0_dp, &
         2.0_dp**[16, 24, 31, 32]*1.0e-6_dp, 2.0_dp**[16, 24, 31, 32]*1.0e-4_dp, &
         2.0_dp**[16, 24, 31, 32]*1.0e-3_dp]
      integer :: k

      do k = 1, size(periods)
         period = periods(k)
         if (period <= 100.0_dp*interval .or. step + period < 0.0_dp) cycle
         if (step + period <= max(20.0_dp*interval, 0.005_dp*period)) return
      end do
      period = 0.0_dp
   end function rollover_of

   !> Takes jumps that are too long to be filled out of the stamps and of the gaps.
   subroutine join_jumps(t, n, interval, gaps)
      real(dp), intent(inout), contiguous :: t(:)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: interval
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: fillable, i
      integer :: k, kept

      fillable = most_filled*max(n, 10000_int64)
      kept = 0
      do k = 1, gaps%count
         i = gaps%before(k)
         if (gaps%length(k) > fillable) then
            gaps%jumps = gaps%jumps + 1
            if (gaps%first_jump == 0) gaps%first_jump = i
            t(i:) = t(i:) - (t(i) - t(i - 1) - interval)
         else
            fillable = fillable - gaps%length(k)
            kept = kept + 1
            gaps%before(kept) = i
            gaps%length(kept) = gaps%length(k)
         end if
      end do
      gaps%count = kept
   end subroutine join_jumps

   !> The jitter, largest and rms distance from the even grid, and the rates of the halves.
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
      !> What they show: samples, missing, extremes, quantization
      type(audit_type), intent(inout) :: audit
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer :: j, channels

      channels = size(value, 2)
      allocate (audit%minimum(channels), audit%maximum(channels), audit%quantization(channels))
      audit%samples = size(value, 1, kind=int64)
      audit%missing = 0
      do j = 1, channels
         call report_progress("completing the record", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         if (allocated(present_mask)) then
            audit%missing = audit%missing + audit%samples - sum(int(present_mask(:, j), int64))
            call scan_extremes(value(:, j), audit%minimum(j), audit%maximum(j), &
               audit%quantization(j), present_mask(:, j))
         else
            call scan_extremes(value(:, j), audit%minimum(j), audit%maximum(j), &
               audit%quantization(j))
         end if
      end do
   end subroutine audit_values

end module gyroakf_io_audit
