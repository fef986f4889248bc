! SPDX-License-Identifier: MIT
!> Looks at every value of a record once, in blocks that several threads take.
module gyroakf_stats_extremes
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: all_sound, scan_extremes

   !> Values of a block
   integer(int64), parameter :: block_values = 65536
   !> Values for which it pays to wake other threads
   integer(int64), parameter :: threads_from = 524288
   !> Values that are looked at side by side
   integer, parameter :: lanes = 8

contains

   !> True where no value is NaN, infinite or too large; raises no floating-point exception.
   logical function all_sound(value, largest)
      !> Any
      real(dp), intent(in), contiguous :: value(:)
      !> Finite, not negative
      real(dp), intent(in) :: largest
      integer(int64) :: k, blocks, limit, top, n

      n = size(value, kind=int64)
      limit = transfer(largest, limit)
      blocks = (n + block_values - 1)/block_values
      top = 0
      !$omp parallel do schedule(static) reduction(max:top) if (n > threads_from)
      do k = 0, blocks - 1
         top = max(top, largest_bits(value(k*block_values + 1:min(n, (k + 1)*block_values))))
      end do
      !$omp end parallel do
      all_sound = top <= limit
   end function all_sound

   !> Largest bits without signs: in the order of the magnitudes, NaN and infinity at the top.
   pure integer(int64) function largest_bits(value) result(top)
      real(dp), intent(in), contiguous :: value(:)
      integer(int64) :: i, bits

      top = 0
      !$omp simd reduction(max:top) private(bits)
      do i = 1, size(value, kind=int64)
         bits = iand(transfer(value(i), bits), huge(bits))
         top = max(top, bits)
      end do
   end function largest_bits

   !> Extremes and the smallest non-zero step between successive values.
   subroutine scan_extremes(x, low, high, step, mask)
      !> Finite
      real(dp), intent(in), contiguous :: x(:)
      !> Of all that are present; 0 where none is
      real(dp), intent(out) :: low, high
      !> 0 where all are equal
      real(dp), intent(out) :: step
      !> 1 present, 0 missing: [n]; all are present if absent
      integer(int8), intent(in), optional :: mask(:)
      integer(int64) :: k, blocks, n, first, last

      n = size(x, kind=int64)
      blocks = (n + block_values - 1)/block_values
      low = 0.0_dp
      high = 0.0_dp
      step = 0.0_dp
      if (n == 0) return
      low = huge(low)
      high = -huge(high)
      step = huge(step)
      !$omp parallel do schedule(static) private(first, last) reduction(min:low, step) &
      !$omp& reduction(max:high) if (n > threads_from)
      do k = 0, blocks - 1
         first = max(1_int64, k*block_values)
         last = min(n, (k + 1)*block_values)
         if (present(mask)) then
            call scan_runs(x(first:last), mask(first:last), low, high, step)
         else
            call scan_block(x(first:last), low, high, step)
         end if
      end do
      !$omp end parallel do
      if (step >= huge(step)) step = 0.0_dp
      if (low <= high) return
      low = 0.0_dp
      high = 0.0_dp
   end subroutine scan_extremes

   !> Those of the runs of values that are present in a block.
   pure subroutine scan_runs(x, mask, low, high, step)
      real(dp), intent(in), contiguous :: x(:)
      integer(int8), intent(in) :: mask(:)
      real(dp), intent(inout) :: low, high, step
      integer(int64) :: i, first

      first = 0
      do i = 1, size(x, kind=int64)
         if (mask(i) /= 0 .and. first == 0) first = i
         if (mask(i) == 0 .and. first > 0) call scan_block(x(first:i - 1), low, high, step)
         if (mask(i) == 0) first = 0
      end do
      if (first > 0) call scan_block(x(first:), low, high, step)
   end subroutine scan_runs

   !> The same of a block, whose first value is the last of the block before.
   pure subroutine scan_block(x, low, high, step)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(inout) :: low, high, step
      real(dp) :: lows(lanes), highs(lanes), steps(lanes), change
      integer(int64) :: i, n
      integer :: j

      n = size(x, kind=int64)
      lows = x(1)
      highs = x(1)
      steps = huge(step)
      do i = 2, n - lanes + 1, lanes
         !$omp simd private(change)
         do j = 1, lanes
            change = abs(x(i + j - 1) - x(i + j - 2))
            lows(j) = merge(x(i + j - 1), lows(j), x(i + j - 1) < lows(j))
            highs(j) = merge(x(i + j - 1), highs(j), x(i + j - 1) > highs(j))
            steps(j) = merge(change, steps(j), change > 0.0_dp .and. change < steps(j))
         end do
      end do
      do i = n - modulo(n - 1, int(lanes, int64)) + 1, n
         change = abs(x(i) - x(i - 1))
         lows(1) = min(lows(1), x(i))
         highs(1) = max(highs(1), x(i))
         if (change > 0.0_dp .and. change < steps(1)) steps(1) = change
      end do
      low = min(low, minval(lows))
      high = max(high, maxval(highs))
      step = min(step, minval(steps))
   end subroutine scan_block

end module gyroakf_stats_extremes
