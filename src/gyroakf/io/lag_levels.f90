! SPDX-License-Identifier: MIT
!> Mean stamps of blocks of samples, and how far the lag has to rise from block to block to be a
!> loss: for stamps that are late, jittery, coarse or come in bursts.
module gyroakf_io_lag_levels
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_sort, only : median_of, sorted
   implicit none (type, external)
   private
   public :: find_levels

   !> Samples of a block; blocks of the longest window; positions looked at; samples between levels
   integer, parameter :: block_rows = 16, most_blocks = 64
   integer(int64), parameter :: max_places = 2001, distant = 2048

contains

   !> The levels of blocks as short as the scatter allows (below 0.12 samples), 1024 at most.
   subroutine find_levels(t, cadence, level, rows, step, rise, longest)
      !> s, none missing: [n]
      real(dp), intent(in), contiguous :: t(:)
      type(cadence_type), intent(in) :: cadence
      !> Mean stamps, s: [block]; none where there are fewer than 12 blocks of 16 samples
      real(dp), allocatable, intent(out) :: level(:)
      !> Samples of a block
      integer, intent(out) :: rows
      !> s from sample to sample
      real(dp), intent(out) :: step
      !> Least rise of the lag at a loss, samples: 0.75, 5 times the scatter, more for bursts
      real(dp), intent(out) :: rise
      !> Longest step of most blocks of 16 samples, samples
      real(dp), intent(out) :: longest
      real(dp), allocatable :: mean(:)
      real(dp) :: scatter, height
      integer(int64) :: blocks, b
      integer :: window

      rows = block_rows
      step = 0.0_dp
      rise = 0.0_dp
      longest = 0.0_dp
      blocks = size(t, kind=int64)/block_rows
      if (blocks < 12) blocks = 0
      allocate (mean(blocks))
      do b = 1, blocks
         mean(b) = sum(t((b - 1)*block_rows + 1:b*block_rows) - t(1))/block_rows
      end do
      window = 1
      if (blocks > 0) call choose_window(mean, cadence%step, window, scatter, step)
      if (step <= 0.0_dp) blocks = 0
      rows = window*block_rows
      allocate (level(blocks/window))
      do b = 1, size(level, kind=int64)
         level(b) = sum(mean((b - 1)*window + 1:b*window))/window
      end do
      if (blocks == 0) return
      mean(:) = mean/step - [(real(b*block_rows, dp), b=1, blocks)]
      call measure_blocks(t, step, longest, height)
      rise = max(0.75_dp, 5.0_dp*scatter, beat_bound(cadence, step, window))
      if (height >= 2.0_dp + cadence%resolution/step) rise = max(rise, burst_bound(height, mean))
   end subroutine find_levels

   !> The shortest window whose means scatter by less than 0.12 steps, else the best; the step.
   subroutine choose_window(level, rough, window, scatter, step)
      real(dp), intent(in), contiguous :: level(:)
      real(dp), intent(in) :: rough
      integer, intent(out) :: window
      real(dp), intent(out) :: scatter, step
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
         rise = [((sum(level(b(k) + 1:b(k) + w)) - sum(level(b(k) - w:b(k) - 1)))/w, k=1, size(b))]
         middle = middle_mean(rise)
         rise = sorted(abs(rise - middle))        ! its median, and four fifths, of a normal scatter
         found = max(1.4826_dp*rise((size(rise) + 1)/2), &
            0.7803_dp*rise(max(1, (4*size(rise))/5)))/usual
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
      integer(int64) :: place(min(max_places, last)), k

      place(:) = [(1 + ((k - 1)*(last - 1))/max(size(place) - 1, 1), k=1, size(place, kind=int64))]
   end function spread_over

   !> Mean of the middle three fifths: samples that are delivered together make rises of few
   !> different sizes, and a median jumps from one to the other.
   real(dp) function middle_mean(x)
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))
      integer :: cut

      y = sorted(x)
      cut = size(y)/5
      middle_mean = sum(y(cut + 1:size(y) - cut))/(size(y) - 2*cut)
   end function middle_mean

   !> Where a tick of the clock is about the step or several steps, the two beat: the lag of a clock
   !> that counts in nearly a whole number of steps jumps by one at each beat. Where no window
   !> averages beats, one lost sample is not distinguishable; where a tick holds more than two
   !> samples, losses of less than 1.2 ticks cannot (samples that are delivered together do too).
   pure real(dp) function beat_bound(cadence, step, window)
      type(cadence_type), intent(in) :: cadence
      real(dp), intent(in) :: step
      integer, intent(in) :: window
      real(dp) :: ratio

      beat_bound = 0.0_dp
      ratio = cadence%resolution/step
      if (ratio < 0.7_dp) return
      if (ratio > 2.0_dp) beat_bound = 1.2_dp*ratio
      if (abs(ratio/max(1.0_dp, anint(ratio)) - 1.0_dp)*real(window*block_rows, &
         dp) < 5.0_dp) beat_bound = max(beat_bound, 1.6_dp)
   end function beat_bound

   !> The usual longest step of blocks, and the usual range of the lag of a block, in steps.
   subroutine measure_blocks(t, step, longest, height)
      real(dp), intent(in), contiguous :: t(:)
      real(dp), intent(in) :: step
      real(dp), intent(out) :: longest, height
      real(dp) :: lag(block_rows)
      real(dp), allocatable :: seen(:, :)
      integer(int64), allocatable :: i(:)
      integer :: k, j

      allocate (i, source=(spread_over(size(t, kind=int64)/block_rows) - 1)*block_rows)
      allocate (seen(size(i), 2))
      do k = 1, size(i)
         lag = (t(i(k) + 1:i(k) + block_rows) - t(i(k) + 1))/step - [(real(j, dp), j=1, block_rows)]
         seen(k, :) = [maxval(lag(2:) - lag(:block_rows - 1)) + 1.0_dp, maxval(lag) - minval(lag)]
      end do
      longest = median_of(seen(:, 1))
      height = median_of(seen(:, 2))
   end subroutine measure_blocks

   !> Where samples come in bursts, deliveries are late for seconds and minutes too: a loss has to
   !> be more than the height of a block, and three times the scatter of the levels 2048 samples
   !> apart.
   real(dp) function burst_bound(height, level)
      real(dp), intent(in) :: height
      real(dp), intent(in), contiguous :: level(:)
      real(dp), allocatable :: seen(:)
      integer(int64), allocatable :: b(:)
      integer(int64) :: far

      far = min(distant/block_rows, size(level, kind=int64)/4)
      allocate (b, source=spread_over(size(level, kind=int64) - far))
      seen = level(b + far) - level(b)
      burst_bound = max(height, 3.0_dp*1.4826_dp*median_of(abs(seen - median_of(seen))))
   end function burst_bound

end module gyroakf_io_lag_levels
