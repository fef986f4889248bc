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
   use gyroakf_io_scan, only : scan_extremes
   use gyroakf_io_cadence, only : cadence_type, find_cadence, find_changes, sort
   use gyroakf_io_losses, only : add_gap, find_losses, gap_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: gap_type, burst_type, audit_stamps, audit_values, join_windows, count_bursts, end_bursts, same_row

   !> What is remembered of the last steps while bursts are counted
   type :: burst_type
      !> Short steps so far, behind a long one
      integer(int64) :: run = 0
      logical :: late = .false.
      !> The row of the first sample of the run
      integer(int64) :: first = 0
      !> Short steps that the clock explains
      integer(int64) :: least = 2
   end type burst_type

   !> Window of the lags, samples; after a long step it is longer, up to most_window
   integer(int64), parameter :: window = 64, most_window = 20000
   !> So many samples may be filled in for one that was read
   integer(int64), parameter :: most_filled = 10
   !> Rates that a record may have one after the other
   integer, parameter :: most_changes = 8

contains

   !> Counts what the stamps show and finds the gaps.
   subroutine audit_stamps(t, audit, gaps, value, cadence)
      !> Stamps in s: [n]; NaN where missing. Afterwards, in the first n - `audit%repeated`, without backward jumps, repeated rows
      !> and jumps that are not filled, missing ones interpolated
      real(dp), intent(inout), contiguous :: t(:)
      !> Filled: stamps, rate, duplicates, backward steps, bursts, jitter; `line_of_*` hold sample indices
      type(audit_type), intent(inout) :: audit
      !> Where samples were lost, and rows that are none
      type(gap_type), intent(out) :: gaps
      !> The rows, by which repeated ones are told from others of the same stamp: [n, channel]
      real(dp), intent(in), contiguous, optional :: value(:, :)
      !> For a window of a longer record, whose bursts are counted elsewhere; if absent they are counted here
      type(cadence_type), intent(out), optional :: cadence
      type(cadence_type) :: whole
      type(burst_type) :: burst
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
         if (.not. present(cadence)) then
            call count_bursts(t(:n), whole, burst, audit)
            call end_bursts(burst, audit)
         end if
      end if
      if (allocated(repeated)) call merge_repeats(repeated, audit, gaps)
      if (present(cadence)) cadence = whole
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

   !> Takes rows out that repeat the one above: the same stamp and the same values.
   !>
   !> Where neighbours of different stamps are as often alike, it is chance (a coarse clock and coarse values), and they stay.
   subroutine drop_repeats(t, value, repeated)
      !> Afterwards the remaining ones stand first
      real(dp), intent(inout), contiguous :: t(:)
      !> [n, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> The rows that were taken out, in order; unallocated where there are none
      integer(int64), allocatable, intent(out) :: repeated(:)
      integer(int64) :: i, n, equal, alike, chance, others, stride, kept

      n = size(t, kind=int64)
      equal = 0
      alike = 0
      do i = 2, n
         if (abs(t(i) - t(i - 1)) > 0.0_dp) cycle
         equal = equal + 1
         if (same_row(value, i)) alike = alike + 1
      end do
      if (alike == 0) return
      chance = 0
      others = 0
      stride = 1 + n/100000
      do i = 2, n, stride
         if (abs(t(i) - t(i - 1)) <= 0.0_dp) cycle
         others = others + 1
         if (same_row(value, i)) chance = chance + 1
      end do
      if (real(alike, dp) <= 10.0_dp*real(equal, dp)*real(chance, dp)/real(max(others, 1_int64), dp)) return
      allocate (repeated(alike))
      kept = 1
      alike = 0
      do i = 2, n
         if (abs(t(i) - t(kept)) <= 0.0_dp) then
            if (same_row(value, i)) then
               alike = alike + 1
               repeated(alike) = i
               cycle
            end if
         end if
         kept = kept + 1
         t(kept) = t(i)
      end do
      t(kept + 1:) = t(kept)
   end subroutine drop_repeats

   !> True where a row has the values of the one above.
   pure logical function same_row(value, i)
      !> [row, channel]
      real(dp), intent(in), contiguous :: value(:, :)
      !> Not the first
      integer(int64), intent(in) :: i
      integer :: j

      same_row = .false.
      do j = 1, size(value, 2)
         if (ieee_is_nan(value(i, j)) .or. ieee_is_nan(value(i - 1, j))) return
         if (abs(value(i, j) - value(i - 1, j)) > 0.0_dp) return
      end do
      same_row = .true.
   end function same_row

   !> Puts the rows that were taken out among the gaps, and lets all indices count them.
   subroutine merge_repeats(repeated, audit, gaps)
      integer(int64), intent(in) :: repeated(:)
      type(audit_type), intent(inout) :: audit
      type(gap_type), intent(inout) :: gaps
      type(gap_type) :: all
      integer(int64) :: next, at
      integer :: k

      allocate (all%before(gaps%count + size(repeated)), all%length(gaps%count + size(repeated)))
      next = 1
      do k = 1, gaps%count
         at = gaps%before(k) + next - 1
         do while (next <= size(repeated))
            if (repeated(next) > at) exit
            call add_gap(all, repeated(next), -1_int64)
            next = next + 1
            at = at + 1
         end do
         call add_gap(all, at, gaps%length(k))
      end do
      do next = next, size(repeated)
         call add_gap(all, repeated(next), -1_int64)
      end do
      call move_alloc(all%before, gaps%before)
      call move_alloc(all%length, gaps%length)
      gaps%count = all%count
      gaps%first_jump = place_with(repeated, gaps%first_jump)
      do k = 1, 3
         audit%line_of_first(k) = place_with(repeated, audit%line_of_first(k))
      end do
      audit%line_of_burst = place_with(repeated, audit%line_of_burst)
      audit%line_of_change = place_with(repeated, audit%line_of_change)
      audit%repeated = size(repeated, kind=int64)
      audit%line_of_repeat = repeated(1)
   end subroutine merge_repeats

   !> The index of a sample among all rows; 0 stays 0.
   pure integer(int64) function place_with(repeated, i) result(place)
      integer(int64), intent(in) :: repeated(:), i
      integer(int64) :: k

      place = i
      if (i == 0) return
      do k = 1, size(repeated, kind=int64)
         if (repeated(k) > place) exit
         place = place + 1
      end do
   end function place_with

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

   !> Finds where samples of regular stamps were lost: a long step behind which the lag stays higher.
   !>
   !> A loss is no longer than the step of the stamps there, and than the rise of the lag.
   subroutine find_gaps(t, interval, gaps)
      real(dp), intent(in), contiguous :: t(:)
      !> s from sample to sample
      real(dp), intent(in) :: interval
      type(gap_type), intent(inout) :: gaps
      integer(int64) :: i, n, since, after
      real(dp) :: rise, rate, step
      real(dp), parameter :: enough = 0.75_dp

      n = size(t, kind=int64)
      rate = 1.0_dp/interval
      since = 1
      do i = 2, n
         step = (t(i) - t(i - 1))*rate
         if (step < 2.0_dp*enough) cycle
         rise = step - 1.0_dp
         if (rise < enough .or. .not. even_around(t, i, max(i - window, since), min(i + window, n), interval)) then
            after = min(i - 1 + max(window, int(min(4.0_dp*step, real(most_window, dp)), int64)), n)
            rise = middle_lag(t, rate, i, after) - middle_lag(t, rate, max(i - window, since), i - 1)
         end if
         if (rise < enough) cycle
         if (falls_back(t, rate, i, rise)) cycle
         since = i
         call add_gap(gaps, i, max(1_int64, min(whole(rise), whole(step) - 1)))
      end do
   end subroutine find_gaps

   !> The nearest whole number, as far as there is one.
   pure integer(int64) function whole(x)
      real(dp), intent(in) :: x

      whole = nint(min(x, 1.0e15_dp), int64)
   end function whole

   !> True where all steps but that before sample i are near the interval.
   pure logical function even_around(t, i, first, last, interval)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: i, first, last
      real(dp), intent(in) :: interval
      integer(int64) :: k

      even_around = .false.
      do k = first + 1, last
         if (k /= i .and. abs(t(k) - t(k - 1) - interval) > 0.3_dp*interval) return
      end do
      even_around = abs(t(last) - t(i) - real(last - i, dp)*interval) <= 0.3_dp*interval .and. &
                    abs(t(i - 1) - t(first) - real(i - 1 - first, dp)*interval) <= 0.3_dp*interval
   end function even_around

   !> True where the lag has lost half of a rise again after 512, 1024 or 2048 samples.
   pure logical function falls_back(t, rate, i, rise)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate, rise
      integer(int64), intent(in) :: i
      integer(int64) :: ahead
      integer :: k

      falls_back = .false.
      ahead = 512
      do k = 1, 3
         if (i + ahead > size(t, kind=int64)) return
         if ((t(i + ahead) - t(i - 1))*rate - real(ahead + 1, dp) < 0.5_dp*rise - 0.25_dp) falls_back = .true.
         ahead = 2*ahead
      end do
   end function falls_back

   !> True where the double steps of single samples are the beat of the samples with a clock that counts in more than half of
   !> their interval, or cannot be told from it: at even distances, or so few (0.03 %) that a clock explains them.
   pure logical function is_beat(gaps, cadence, n)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64), intent(in) :: n
      real(dp), parameter :: usual_drift = 3.0e-4_dp
      integer(int64) :: distance
      integer :: k, alike

      is_beat = .false.
      if (gaps%count == 0 .or. cadence%resolution < 0.5_dp*cadence%step) return
      if (any(gaps%length(:gaps%count) > 1)) return
      if (gaps%count < 4) then
         is_beat = real(gaps%count, dp) < usual_drift*real(n, dp)
         return
      end if
      distance = (gaps%before(gaps%count) - gaps%before(1))/(gaps%count - 1)
      alike = 0
      do k = 2, gaps%count
         if (abs(gaps%before(k) - gaps%before(k - 1) - distance) <= max(2_int64, distance/10)) alike = alike + 1
      end do
      is_beat = 10*alike >= 9*(gaps%count - 1)
   end function is_beat

   !> True where half of the double steps are at even distances: beats of a coarse clock and losses among them.
   pure logical function is_comb(gaps, cadence)
      type(gap_type), intent(in) :: gaps
      type(cadence_type), intent(in) :: cadence
      integer(int64) :: distance
      integer :: k, j, alike, most

      is_comb = .false.
      if (count(gaps%length(:gaps%count) == 1) < 8 .or. cadence%resolution < 0.5_dp*cadence%step) return
      most = 0
      do j = 2, min(gaps%count, 12)
         distance = gaps%before(j) - gaps%before(j - 1)
         if (distance < 50) cycle
         alike = 0
         do k = 2, gaps%count
            if (gaps%length(k) /= 1) cycle
            if (abs(gaps%before(k) - gaps%before(k - 1) - distance) <= max(2_int64, distance/10)) alike = alike + 1
         end do
         most = max(most, alike)
      end do
      is_comb = 2*most >= gaps%count - 1
   end function is_comb

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

   !> Median of the lag t*rate - index over a range (every k-th of a long one).
   real(dp) function middle_lag(t, rate, from, to)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: rate
      integer(int64), intent(in) :: from, to
      real(dp) :: lag(2*window)
      integer(int64) :: i, stride
      integer :: k

      stride = 1 + (to - from)/size(lag)
      k = 0
      do i = from, to, stride
         k = k + 1
         lag(k) = (t(i) - t(1))*rate - real(i, dp)
      end do
      call sort(lag(:k))
      middle_lag = lag((k + 1)/2)
   end function middle_lag

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

   !> Counts bursts: three samples or more at once, with less than 0.3 of the usual step between them, behind a long step; more
   !> of them than a tick of the clock holds.
   subroutine count_bursts(t, cadence, burst, audit, number)
      !> The last stamp of the part before, if there is one, and those of this part, s
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> From part to part
      type(burst_type), intent(inout) :: burst
      !> Its bursts; `line_of_burst` is a row
      type(audit_type), intent(inout) :: audit
      !> Which rows they are, counted from 1 if absent
      integer(int64), intent(in), contiguous, optional :: number(:)
      integer(int64) :: i
      real(dp) :: short, long, step

      if (cadence%step <= 0.0_dp) return
      short = 0.3_dp*cadence%step
      long = 1.5_dp*cadence%step
      burst%least = max(2_int64, ceiling(1.5_dp*min(cadence%resolution/cadence%step, 1.0e6_dp), int64))
      do i = 2, size(t, kind=int64)
         step = t(i) - t(i - 1)
         if (abs(step) < short) then
            burst%run = burst%run + 1
            cycle
         end if
         if (burst%run >= burst%least) call end_bursts(burst, audit)
         burst%late = step >= long
         burst%first = i
         if (present(number)) burst%first = number(i)
         burst%run = 0
      end do
   end subroutine count_bursts

   !> Counts the burst that goes on, if there is one.
   pure subroutine end_bursts(burst, audit)
      !> None goes on afterwards
      type(burst_type), intent(inout) :: burst
      !> Its bursts
      type(audit_type), intent(inout) :: audit

      if (burst%late .and. burst%run >= burst%least) then
         audit%bursts = audit%bursts + 1
         audit%longest_burst = max(audit%longest_burst, burst%run + 1)
         if (audit%line_of_burst == 0) audit%line_of_burst = burst%first
      end if
      burst%run = 0
      burst%late = .false.
   end subroutine end_bursts

   !> Adds what a window of a longer record shows of its clock and its rates.
   pure subroutine join_windows(part, before, last_change, audit)
      !> Of the window
      type(audit_type), intent(in) :: part
      !> Rows before the window
      integer(int64), intent(in) :: before
      !> Row of the last change of the rate, 0 at first: windows overlap, the same change is found again
      integer(int64), intent(inout) :: last_change
      !> Of the record; `line_of_change` is a row
      type(audit_type), intent(inout) :: audit
      integer(int64) :: row

      if (part%resolution > 0.0_dp .and. (audit%resolution <= 0.0_dp .or. part%resolution < audit%resolution)) then
         audit%resolution = part%resolution
      end if
      audit%jitter_rms = max(audit%jitter_rms, part%jitter_rms)
      if (part%rate_changes == 0) return
      row = before + part%line_of_change
      if (last_change > 0 .and. row <= last_change + 2048) return
      if (audit%rate_changes == 0) then
         audit%line_of_change = row
         audit%rate_before = part%rate_before
         audit%rate_after = part%rate_after
      end if
      audit%rate_changes = audit%rate_changes + part%rate_changes
      last_change = row
   end subroutine join_windows

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
