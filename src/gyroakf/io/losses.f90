! SPDX-License-Identifier: MIT
!> Lost samples in stamps that are late, jittery, coarse or come in bursts: where the level of the lag rises for good.
!>
!> The lag is elapsed time / step - count. Its means over windows before and behind a block of 16 samples tell the rise there; the
!> windows are as short as the scatter of the means allows (below 0.12 samples), 1024 samples at most. A rise counts where it
!>
!> - is more than 0.75 samples and five times that scatter (1.6 samples where a coarse clock beats with the samples),
!> - is local: more than the rises a window further on both sides, so that a rate that drifts is no loss,
!> - does not fall back within the next 2048 samples, or four times its length,
!> - holds a step of the stamps that is long enough.
module gyroakf_io_losses
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type, median_of, sort
   implicit none (type, external)
   private
   public :: gap_type, add_gap, find_losses, lasting

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

   !> Samples of a block; blocks of the longest window; positions looked at for the scatter
   integer, parameter :: block_rows = 16, most_blocks = 64
   integer(int64), parameter :: looked_at = 2001
   !> A rise has to last so many samples, or four times as many as are lost; what is late for less is not lost
   integer(int64), parameter :: lasting = 2048

contains

   !> Finds the losses.
   subroutine find_losses(t, cadence, gaps)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      !> Of the stamps
      type(cadence_type), intent(in) :: cadence
      !> Appended to, in order; none where there are fewer than 12 blocks
      type(gap_type), intent(inout) :: gaps
      real(dp), allocatable :: level(:)
      integer(int64), allocatable :: lost(:)
      real(dp) :: step, scatter, enough, usual
      integer(int64) :: blocks, i, b
      integer :: window, round
      logical :: more

      blocks = size(t, kind=int64)/block_rows
      if (blocks < 12) return
      allocate (level(blocks), lost(blocks))
      lost = 0
      do b = 1, blocks
         i = (b - 1)*block_rows
         level(b) = sum(t(i + 1:i + block_rows) - t(1))/block_rows
      end do
      call choose_window(level, cadence%step, window, scatter, step)
      if (step <= 0.0_dp) return
      level = level/step - [(real(b*block_rows, dp), b=1, blocks)]
      enough = max(0.75_dp, 5.0_dp*scatter, beat_bound(cadence, step, window), burst_bound(t, cadence, step, level))
      usual = usual_longest(t, step)
      do round = 1, 6
         call find_rises(t, level, step, window, enough, usual, lost, more)
         if (.not. more) exit
      end do
      do b = 1, blocks
         if (lost(b) > 0) call add_gap(gaps, longest_step(t, b), lost(b))
      end do
   end subroutine find_losses

   !> The shortest window whose means scatter by less than 0.12 steps, else the one that scatters least; and the step.
   subroutine choose_window(level, rough, window, scatter, step)
      !> s, means of the blocks
      real(dp), intent(in), contiguous :: level(:)
      real(dp), intent(in) :: rough
      integer, intent(out) :: window
      !> Of the difference of two windows, steps
      real(dp), intent(out) :: scatter
      real(dp), intent(out) :: step
      real(dp) :: middle, found, usual
      real(dp), allocatable :: rise(:)
      integer(int64), allocatable :: b(:)
      integer(int64) :: blocks
      integer :: k, w

      blocks = size(level, kind=int64)
      scatter = huge(1.0_dp)
      window = 1
      step = rough
      allocate (b, source=spread_over(blocks - 4))
      usual = middle_mean(level(b + 4) - level(b))/(4*block_rows)
      if (usual <= 0.0_dp) usual = rough
      w = 1
      do while (w <= most_blocks .and. 4*w + 4 <= blocks)
         b = w + spread_over(blocks - 2*w)
         rise = [(mean_of(level, b(k) + 1, b(k) + w) - mean_of(level, b(k) - w, b(k) - 1), k=1, size(b))]
         middle = middle_mean(rise)
         found = spread_of(abs(rise - middle))/usual
         if (found < 0.8_dp*scatter) then
            scatter = found
            window = w
            step = middle/real((w + 1)*block_rows, dp)
         end if
         if (scatter <= 0.12_dp) exit
         w = 2*w
      end do
   end subroutine choose_window

   !> Places from 1 to `last`, evenly spread: so many that they tell a scatter.
   pure function spread_over(last) result(place)
      integer(int64), intent(in) :: last
      integer(int64) :: place(min(looked_at, last)), k

      place(:) = [(1 + ((k - 1)*(last - 1))/max(size(place) - 1, 1), k=1, size(place, kind=int64))]
   end function spread_over

   !> Mean of the middle three fifths: samples that are delivered together make rises of few different sizes, and a median jumps
   !> from one to the other.
   real(dp) function middle_mean(x)
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))
      integer :: cut

      y = x
      call sort(y)
      cut = size(y)/5
      middle_mean = sum(y(cut + 1:size(y) - cut))/(size(y) - 2*cut)
   end function middle_mean

   !> Standard deviation from distances, by their median and by four fifths of them.
   real(dp) function spread_of(distance)
      real(dp), intent(in) :: distance(:)
      real(dp) :: y(size(distance))

      y = distance
      call sort(y)
      spread_of = max(1.4826_dp*y((size(y) + 1)/2), 0.7803_dp*y(max(1, (4*size(y))/5)))
   end function spread_of

   !> Mean of some levels.
   pure real(dp) function mean_of(level, from, to)
      real(dp), intent(in), contiguous :: level(:)
      integer(int64), intent(in) :: from, to

      mean_of = sum(level(from:to))/real(to - from + 1, dp)
   end function mean_of

   !> Where a tick of the clock is about the step or several steps, the two beat: the lag of a clock that counts in nearly a whole
   !> number of steps jumps by one at each beat. Where no window averages beats, one lost sample is not distinguishable from them;
   !> where a tick holds more than two samples, losses of less than 1.2 ticks cannot (samples that are delivered together do too).
   pure real(dp) function beat_bound(cadence, step, window)
      type(cadence_type), intent(in) :: cadence
      real(dp), intent(in) :: step
      integer, intent(in) :: window
      real(dp) :: ratio

      beat_bound = 0.0_dp
      ratio = cadence%resolution/step
      if (ratio < 0.7_dp) return
      if (ratio > 2.0_dp) beat_bound = 1.2_dp*ratio
      if (abs(ratio/max(1.0_dp, anint(ratio)) - 1.0_dp)*real(window*block_rows, dp) < 5.0_dp) beat_bound = max(beat_bound, 1.6_dp)
   end function beat_bound

   !> The longest step of most blocks, in steps.
   real(dp) function usual_longest(t, step)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: step
      real(dp), allocatable :: seen(:)
      integer(int64), allocatable :: i(:)
      integer :: k

      allocate (i, source=(spread_over(size(t, kind=int64)/block_rows) - 1)*block_rows)
      seen = [(maxval(t(i(k) + 2:i(k) + block_rows) - t(i(k) + 1:i(k) + block_rows - 1))/step, k=1, size(i))]
      usual_longest = median_of(seen)
   end function usual_longest

   !> Where samples come in bursts, deliveries are late for seconds and minutes too: a loss has to be more than what usually
   !> lies between the largest and the smallest lag of a block, and three times the scatter of the levels 2048 samples apart.
   real(dp) function burst_bound(t, cadence, step, level)
      real(dp), intent(in), contiguous :: t(:), level(:)
      type(cadence_type), intent(in) :: cadence
      real(dp), intent(in) :: step
      real(dp) :: lag(block_rows), height, middle
      real(dp), allocatable :: seen(:)
      integer(int64), allocatable :: b(:)
      integer(int64) :: far, blocks, i
      integer :: k

      burst_bound = 0.0_dp
      blocks = size(level, kind=int64)
      allocate (b, source=spread_over(blocks))
      allocate (seen(size(b)))
      do k = 1, size(b)
         i = (b(k) - 1)*block_rows
         lag = (t(i + 1:i + block_rows) - t(i + 1))/step - [(real(i, dp), i=1, block_rows)]
         seen(k) = maxval(lag) - minval(lag)
      end do
      height = median_of(seen)
      if (height < 2.0_dp + cadence%resolution/step) return
      far = min(lasting/block_rows, blocks/4)
      b = spread_over(blocks - far)
      seen = level(b + far) - level(b)
      middle = median_of(seen)
      burst_bound = max(height, 3.0_dp*1.4826_dp*median_of(abs(seen - middle)))
   end function burst_bound

   !> One pass over the blocks: the highest rises, at least two windows apart, are taken out of the level.
   subroutine find_rises(t, level, step, window, enough, usual, lost, more)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(inout), contiguous :: level(:)
      real(dp), intent(in) :: step, enough, usual
      integer, intent(in) :: window
      integer(int64), intent(inout) :: lost(:)
      logical, intent(out) :: more
      real(dp), allocatable :: rise(:)
      integer(int64), allocatable :: taken(:)
      real(dp) :: before, behind, length
      integer(int64) :: blocks, b, best, w

      more = .false.
      blocks = size(level, kind=int64)
      w = window
      if (blocks < 2*w + 1) return
      allocate (rise(blocks))
      rise = 0.0_dp
      before = sum(level(1:w))
      behind = sum(level(w + 2:2*w + 1))
      do b = w + 1, blocks - w
         rise(b) = (behind - before)/w
         before = before - level(b - w) + level(b)
         if (b < blocks - w) behind = behind - level(b + 1) + level(b + w + 1)
      end do
      allocate (taken(blocks))
      taken = 0
      b = w + 1
      do while (b <= blocks - w)
         best = b
         if (rise(b) >= enough) then
            best = b - 1 + maxloc(rise(b:min(b + w, blocks - w)), dim=1, kind=int64)
            length = rise(best) - 0.5_dp*(rise(max(best - 2*w - 1, 1_int64)) + rise(min(best + 2*w + 1, blocks)))
            if (length >= enough) then
               if (is_loss(t, level, best, w, length, step, usual)) then
                  taken(best) = nint(length, int64)
                  best = best + 2*w
               end if
            end if
         end if
         b = best + 1
      end do
      more = any(taken > 0)
      lost(:) = lost + taken
      call take_out(t, taken, level)
   end subroutine find_rises

   !> Takes losses out of the levels: of the block that holds one and its neighbors as many samples as stand behind it.
   pure subroutine take_out(t, taken, level)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in), contiguous :: taken(:)
      real(dp), intent(inout), contiguous :: level(:)
      integer(int64) :: b, k, i, shift

      shift = 0
      do b = 1, size(level, kind=int64)
         if (b > 2) shift = shift + taken(max(b - 2, 1_int64))
         level(b) = level(b) - real(shift, dp)
         if (taken(b) == 0) cycle
         i = longest_step(t, b)
         do k = max(b - 1, 1_int64), min(b + 1, size(level, kind=int64))
            level(k) = level(k) - real(taken(b)*min(max(k*block_rows - i + 1, 0_int64), int(block_rows, int64)), dp)/block_rows
         end do
      end do
   end subroutine take_out

   !> True where a rise lasts and holds a long step.
   logical function is_loss(t, level, at, w, length, step, usual)
      real(dp), intent(in), contiguous :: t(:), level(:)
      integer(int64), intent(in) :: at, w
      real(dp), intent(in) :: length, step
      !> Longest step of most blocks: where samples come in bursts, that of a loss has to be longer
      real(dp), intent(in) :: usual
      real(dp) :: start
      integer(int64) :: i, last, b

      is_loss = .false.
      i = longest_step(t, at)
      if (t(i) - t(i - 1) < (0.75_dp*length + 0.5_dp)*step) return
      if (usual > 3.0_dp .and. t(i) - t(i - 1) < (usual + 0.5_dp*length - 0.5_dp)*step) return
      start = mean_of(level, at - w, at - 1)
      last = at + max(lasting, min(int(4.0_dp*min(length, 1.0e6_dp), int64), 20000_int64))/block_rows
      b = at + 1
      do while (b + w - 1 <= min(last, size(level, kind=int64)))
         if (mean_of(level, b, b + w - 1) < start + 0.5_dp*length) return
         b = b + max(w/2, 1_int64)
      end do
      is_loss = .true.
   end function is_loss

   !> The sample behind the longest step in a block and its neighbors' edges.
   pure integer(int64) function longest_step(t, block)
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in) :: block
      integer(int64) :: i

      longest_step = max(2_int64, (block - 1)*block_rows - 1)
      do i = longest_step, min(block*block_rows + 2, size(t, kind=int64))
         if (t(i) - t(i - 1) > t(longest_step) - t(longest_step - 1)) longest_step = i
      end do
   end function longest_step

   !> Appends a gap.
   pure subroutine add_gap(gaps, before, length)
      !> Grows by one
      type(gap_type), intent(inout) :: gaps
      !> Where, and how many samples
      integer(int64), intent(in) :: before, length

      if (gaps%count == size(gaps%before)) then
         gaps%before = [gaps%before, gaps%before]
         gaps%length = [gaps%length, gaps%length]
      end if
      gaps%count = gaps%count + 1
      gaps%before(gaps%count) = before
      gaps%length(gaps%count) = length
   end subroutine add_gap

end module gyroakf_io_losses
