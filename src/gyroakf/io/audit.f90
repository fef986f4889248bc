! SPDX-License-Identifier: MIT
!> The audit of a record: what the time stamps show, and what the values show.
!>
!> Samples are taken as evenly spaced at the mean rate. Stamps that come in bursts (delivered late, several at once) are no
!> gaps: samples were lost only where the lag, elapsed time * rate - count, rises and does not fall back. That is told by its
!> median before and after a long step. Where almost all steps are near their median (regular stamps), one lost sample is
!> seen; where they are not, a loss has to be larger than the bursts. Steps that are multiples of the median are regular too.
module gyroakf_io_audit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_scan, only : scan_extremes
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: gap_type, audit_stamps, audit_values

   !> Samples that were lost
   type :: gap_type
      !> The sample after the gap: [gap]
      integer(int64), allocatable :: before(:)
      !> How many were lost: [gap]
      integer(int64), allocatable :: length(:)
      !> How many gaps
      integer :: count = 0
      !> Jumps of the clock that are too long to be filled
      integer(int64) :: jumps = 0
      !> The sample after the first of them, 0 where there is none
      integer(int64) :: first_jump = 0
   end type gap_type

   !> Stamps looked at for a first idea of the step
   integer, parameter :: looked_at = 4001
   !> Window of the lags, samples; after a long step it is longer, up to most_window
   integer(int64), parameter :: window = 64, most_window = 20000
   !> So many samples may be filled in for one that was read
   integer(int64), parameter :: most_filled = 10

contains

   !> Counts what the stamps show and finds the gaps.
   subroutine audit_stamps(t, audit, gaps)
      !> Stamps in s: [n]; NaN where missing. Afterwards without backward jumps, missing ones interpolated
      real(dp), intent(inout), contiguous :: t(:)
      !> Filled: stamps, rate, duplicates, backward steps, jitter; `line_of_first` holds sample indices
      type(audit_type), intent(inout) :: audit
      !> Where samples were lost
      type(gap_type), intent(out) :: gaps
      integer(int64) :: n, inserted
      integer :: round
      real(dp) :: rate
      logical :: regular

      n = size(t, kind=int64)
      audit%has_stamps = n > 0
      allocate (audit%line_of_first(3))
      audit%line_of_first = 0
      allocate (gaps%before(16), gaps%length(16))
      if (n < 2) return
      call interpolate(t)
      call first_rate(t, rate, regular)
      call count_steps(t, rate, audit)
      if (rate <= 0.0_dp) return
      inserted = 0
      do round = 1, 4
         call find_gaps(t, rate, regular, gaps)
         if (is_beat(gaps)) then
            audit%beats = gaps%count
            gaps%count = 0
         end if
         if (regular .or. sum(gaps%length(:gaps%count)) == inserted) exit
         inserted = sum(gaps%length(:gaps%count))
         rate = real(n - 1 + inserted, dp)/(t(n) - t(1))
      end do
      audit%gaps = gaps%count + gaps%jumps
      audit%jumps = gaps%jumps
      audit%line_of_first(3) = gaps%first_jump
      if (gaps%count > 0) audit%line_of_first(3) = gaps%before(1)
      if (gaps%count > 0 .and. gaps%first_jump > 0) audit%line_of_first(3) = min(gaps%before(1), gaps%first_jump)
      if (t(n) > t(1)) audit%stamp_rate = real(n - 1 + sum(gaps%length(:gaps%count)), dp)/(t(n) - t(1))
      call measure_jitter(t, gaps, audit)
   end subroutine audit_stamps

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

   !> The rate at which samples come where none is lost: from the steps near their median where most steps are there
   !> (regular), else the mean over all forward steps.
   subroutine first_rate(t, rate, regular)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(out) :: rate
      logical, intent(out) :: regular
      real(dp) :: step(looked_at), median, total
      integer(int64) :: i, n, near
      integer :: k, m

      n = size(t, kind=int64)
      m = int(min(int(looked_at, int64), n - 1))
      do k = 1, m
         i = 2 + (int(k - 1, int64)*(n - 2))/max(m - 1, 1)
         step(k) = t(i) - t(i - 1)
      end do
      call sort(step(:m))
      median = step((m + 1)/2)
      regular = is_regular(step(:m), median)
      total = 0.0_dp
      near = 0
      do i = 2, n
         if (t(i) - t(i - 1) < 0.0_dp) cycle
         if (regular .and. (t(i) - t(i - 1) < 0.5_dp*median .or. t(i) - t(i - 1) > 1.5_dp*median)) cycle
         total = total + (t(i) - t(i - 1))
         near = near + 1
      end do
      rate = 0.0_dp
      if (total > 0.0_dp) rate = real(near, dp)/total
   end subroutine first_rate

   !> True where almost all steps are near the median, or most are, none is far below it and almost all are whole multiples of
   !> it: samples of an even grid, some of them lost. (Short steps as well are those of late samples and a coarse clock.)
   pure logical function is_regular(step, median)
      real(dp), intent(in) :: step(:), median
      integer :: k, near, whole

      is_regular = .false.
      if (median <= 0.0_dp) return
      near = 0
      whole = 0
      do k = 1, size(step)
         if (step(k) <= 0.5_dp*median) cycle
         if (step(k) < 1.5_dp*median) near = near + 1
         if (abs(step(k)/median - anint(step(k)/median)) <= 0.25_dp) whole = whole + 1
      end do
      is_regular = 100*near >= 97*size(step) .or. &
                   (100*near >= 80*size(step) .and. 100*whole >= 97*size(step) .and. minval(step) > 0.5_dp*median)
   end function is_regular

   !> Sorts a short list.
   pure subroutine sort(x)
      real(dp), intent(inout) :: x(:)
      integer :: gap, i, j
      real(dp) :: held

      gap = size(x)/2
      do while (gap > 0)
         do i = gap + 1, size(x)
            held = x(i)
            j = i
            do while (j > gap)
               if (x(j - gap) <= held) exit
               x(j) = x(j - gap)
               j = j - gap
            end do
            x(j) = held
         end do
         gap = gap/2
      end do
   end subroutine sort

   !> Counts duplicates and backward steps; a clock that was set back by more than ten samples goes on by one sample.
   subroutine count_steps(t, rate, audit)
      real(dp), intent(inout), contiguous :: t(:)
      real(dp), intent(in) :: rate
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
            if (rate <= 0.0_dp .or. step*rate > -10.0_dp) cycle
            shift = shift - step + 1.0_dp/rate
            t(i) = t(i - 1) + 1.0_dp/rate
         else
            audit%duplicates = audit%duplicates + 1
            if (audit%line_of_first(1) == 0) audit%line_of_first(1) = i
         end if
      end do
   end subroutine count_steps

   !> Finds where samples were lost; jumps that are too long to be filled are taken out of the stamps.
   !>
   !> A loss is no longer than the step of the stamps there, and than the rise of the lag.
   subroutine find_gaps(t, rate, regular, gaps)
      real(dp), intent(inout), contiguous :: t(:)
      real(dp), intent(in) :: rate
      logical, intent(in) :: regular
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: i, n, since, room, after, length
      real(dp) :: rise, enough, shift, step

      n = size(t, kind=int64)
      gaps%count = 0
      enough = 0.75_dp
      if (.not. regular) enough = largest_burst(t, rate)
      since = 1
      room = most_filled*max(n, 10000_int64)
      shift = 0.0_dp
      do i = 2, n
         t(i) = t(i) - shift
         step = (t(i) - t(i - 1))*rate
         if (step < 2.0_dp*enough) cycle
         after = i - 1 + max(window, int(min(4.0_dp*step, real(most_window, dp)), int64))
         if (.not. regular .and. after > n) cycle
         rise = middle_lag(t, rate, i, min(after, n), shift) - middle_lag(t, rate, max(i - window, since), i - 1, 0.0_dp)
         if (rise < enough) cycle
         since = i
         if (rise > real(room, dp)) then
            gaps%jumps = gaps%jumps + 1
            if (gaps%first_jump == 0) gaps%first_jump = i
            shift = shift + (t(i) - t(i - 1)) - 1.0_dp/rate
            t(i) = t(i - 1) + 1.0_dp/rate
         else
            length = max(1_int64, min(nint(rise, int64), nint(step, int64) - 1))
            call add_gap(gaps, i, length)
            room = room - length
         end if
      end do
   end subroutine find_gaps

   !> True where single samples are lost at even distances: the beat of the samples with a clock that counts in nearly their
   !> interval, or a loss that cannot be told from it.
   pure logical function is_beat(gaps)
      type(gap_type), intent(in) :: gaps
      integer(int64) :: distance
      integer :: k, alike

      is_beat = .false.
      if (gaps%count < 4) return
      if (any(gaps%length(:gaps%count) > 1)) return
      distance = (gaps%before(gaps%count) - gaps%before(1))/(gaps%count - 1)
      alike = 0
      do k = 2, gaps%count
         if (abs(gaps%before(k) - gaps%before(k - 1) - distance) <= max(2_int64, distance/10)) alike = alike + 1
      end do
      is_beat = 10*alike >= 9*(gaps%count - 1)
   end function is_beat

   !> Median of the lag t*rate - index over a range (every k-th of a long one); all stamps but the first are still ahead by
   !> `shift`.
   real(dp) function middle_lag(t, rate, from, to, shift)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate, shift
      integer(int64), intent(in) :: from, to
      real(dp) :: lag(2*window)
      integer(int64) :: i, stride
      integer :: k

      stride = 1 + (to - from)/size(lag)
      k = 0
      do i = from, to, stride
         k = k + 1
         lag(k) = (t(i) - merge(0.0_dp, shift, i == from) - t(1))*rate - real(i, dp)
      end do
      call sort(lag(:k))
      middle_lag = lag((k + 1)/2)
   end function middle_lag

   !> Three times the usual difference between the largest and the smallest lag within a window (its upper quartile): a shorter
   !> loss cannot be told from a burst.
   real(dp) function largest_burst(t, rate)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate
      real(dp) :: seen(looked_at), low, high, lag
      integer(int64) :: n, at, i
      integer :: k

      n = size(t, kind=int64)
      k = 0
      do at = 1, n - window + 1, max(window, n/looked_at + 1)
         k = k + 1
         low = (t(at) - t(1))*rate - real(at, dp)
         high = low
         do i = at + 1, at + window - 1
            lag = (t(i) - t(1))*rate - real(i, dp)
            low = min(low, lag)
            high = max(high, lag)
         end do
         seen(k) = high - low
      end do
      largest_burst = huge(largest_burst)/4
      if (k < 4) return
      call sort(seen(:k))
      largest_burst = max(0.75_dp, 3.0_dp*seen((3*k + 3)/4))
   end function largest_burst

   !> Appends a gap.
   subroutine add_gap(gaps, before, length)
      type(gap_type), intent(inout) :: gaps
      integer(int64), intent(in) :: before, length
      integer(int64), allocatable :: longer(:)

      if (gaps%count == size(gaps%before)) then
         allocate (longer(2*gaps%count))
         longer(:gaps%count) = gaps%before
         call move_alloc(longer, gaps%before)
         allocate (longer(2*gaps%count))
         longer(:gaps%count) = gaps%length
         call move_alloc(longer, gaps%length)
      end if
      gaps%count = gaps%count + 1
      gaps%before(gaps%count) = before
      gaps%length(gaps%count) = length
   end subroutine add_gap

   !> The largest distance of a stamp from the even grid between the first and the last.
   subroutine measure_jitter(t, gaps, audit)
      real(dp), intent(in), contiguous :: t(:)
      type(gap_type), intent(in) :: gaps
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i, at
      integer :: next

      if (audit%stamp_rate <= 0.0_dp) return
      next = 1
      at = -1
      do i = 1, size(t, kind=int64)
         at = at + 1
         if (next <= gaps%count) then
            if (gaps%before(next) == i) then
               at = at + gaps%length(next)
               next = next + 1
            end if
         end if
         audit%jitter_max = max(audit%jitter_max, abs(t(i) - t(1) - real(at, dp)/audit%stamp_rate))
      end do
   end subroutine measure_jitter

   !> Counts what is missing; extremes and the smallest non-zero step of every channel.
   subroutine audit_values(value, present_mask, audit)
      !> [sample, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> [sample, channel] 1 present, 0 missing; unallocated where nothing is missing
      integer(int8), allocatable, intent(in) :: present_mask(:, :)
      !> Filled: samples, missing, extremes, quantisation
      type(audit_type), intent(inout) :: audit
      integer :: j, channels

      channels = size(value, 2)
      allocate (audit%minimum(channels), audit%maximum(channels), audit%quantisation(channels))
      audit%samples = size(value, 1, kind=int64)
      audit%missing = 0
      do j = 1, channels
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
