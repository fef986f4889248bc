! SPDX-License-Identifier: MIT
!> Distance of each sample from the running median of eleven: what outliers are looked for in.
!>
!> $$ r_i = |x_i - \mathrm{median}(x_{i-5}, \ldots, x_{i+5})| $$
!>
!> A median keeps steps, ramps and warm-ups, and five bad samples of eleven do not move it. The record is mirrored at its ends,
!> missing samples are bridged by straight lines. Quantized samples are spread over their step by fixed numbers, evenly
!> distributed: without these the quantiles of r are 0 or a step.
module gyroakf_preprocess_running_residual
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_lapack, only : dlasrt
   implicit none (type, external)
   private
   public :: block_residuals, block_size, coarse_step, small_median, take_medians, window

   !> Samples of a window, on either side of its center, and of a block
   integer, parameter :: window = 11, half = window/2, block_size = 256
   !> Samples that a quantization is looked for in, and the share of them that is distinct where there is none
   integer(int64), parameter :: step_samples = 100000, distinct_share = 4
   !> Samples that differ from the median at least, for a step to be seen
   integer, parameter :: least_off = 10
   !> Values are distinct that differ by more than this share of the standard deviation
   real(dp), parameter :: distinct = 1.0e-9_dp
   !> Factors and mask of the scrambling of 32 bits
   integer(int64), parameter :: scramble(2) = [int(z'21F0AAAD', int64), int(z'735A2D97', int64)], mask32 = 2_int64**32 - 1

contains

   !> Residuals of a block of 256 samples.
   pure subroutine block_residuals(x, block, step, residual, there, valid)
      !> Series: [n], finite where present
      real(dp), intent(in), contiguous :: x(:)
      !> 1 .. (n + 255)/256
      integer(int64), intent(in) :: block
      !> Quantization step, 0 for none
      real(dp), intent(in) :: step
      !> r >= 0: [256]
      real(dp), intent(out) :: residual(block_size)
      !> Samples that are present, in the record: [256]
      logical, intent(out) :: there(block_size)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: y(1 - half:block_size + half), w(block_size, window/2 + 2), low(block_size)
      integer :: next, columns, j

      residual = 0.0_dp
      call take_block(x, block, step, y, there, valid)
      if (.not. any(there)) return
      columns = size(w, 2)
      do j = 1, columns
         w(:, j) = y(j - half:j - half + block_size - 1)
      end do
      do next = columns + 1, window + 1                  ! the least and the largest of those held cannot be the median
         do j = 1, columns - 1
            low = min(w(:, j), w(:, j + 1))
            w(:, j + 1) = max(w(:, j), w(:, j + 1))
            w(:, j) = low
         end do
         do j = columns - 1, 2, -1
            low = min(w(:, j - 1), w(:, j))
            w(:, j) = max(w(:, j - 1), w(:, j))
            w(:, j - 1) = low
         end do
         if (next > window) exit
         w(:, 1) = y(next - half:next - half + block_size - 1)
         columns = columns - 1
      end do
      residual = abs(y(1:block_size) - w(:, 2))
   end subroutine block_residuals

   !> The samples of a block and of five on either side, mirrored, bridged, and spread over their step.
   pure subroutine take_block(x, block, step, y, there, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: block
      real(dp), intent(in) :: step
      real(dp), intent(out) :: y(1 - half:)
      logical, intent(out) :: there(:)
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, first, last, k, before, after
      integer :: i

      n = size(x, kind=int64)
      first = (block - 1)*block_size
      last = min(n, first + block_size)
      there = [(first + i <= n, i=1, block_size)]
      if (present(valid)) there(:last - first) = valid(first + 1:last) /= 0_int8
      y = 0.0_dp
      if (.not. any(there)) return
      before = 0
      after = 0
      do i = 1 - half, block_size + half
         k = first + i
         if (k < 1) k = 1 - k
         if (k > n) k = max(1_int64, 2*n + 1 - k)
         k = min(k, n)
         y(i) = x(k)
         if (present(valid)) then
            if (valid(k) == 0_int8) then
               if (.not. (k > before .and. k < after)) call find_neighbors(valid, k, before, after)
               y(i) = bridge(x, k, before, after)
            end if
         end if
         if (step > 0.0_dp) y(i) = y(i) + step*spread_of(k)
      end do
   end subroutine take_block

   !> Present samples on either side of a missing one; 0 and n + 1 where there are none.
   pure subroutine find_neighbors(valid, k, before, after)
      integer(int8), intent(in) :: valid(:)
      integer(int64), intent(in) :: k
      integer(int64), intent(out) :: before, after

      do before = k - 1, 1, -1
         if (valid(before) /= 0_int8) exit
      end do
      do after = k + 1, size(valid, kind=int64)
         if (valid(after) /= 0_int8) exit
      end do
   end subroutine find_neighbors

   !> Value of the straight line between two samples, one of them where the other does not exist.
   pure real(dp) function bridge(x, k, before, after)
      real(dp), intent(in) :: x(:)
      integer(int64), intent(in) :: k, before, after

      if (before < 1 .and. after > size(x, kind=int64)) then
         bridge = 0.0_dp
      else if (before < 1) then
         bridge = x(after)
      else if (after > size(x, kind=int64)) then
         bridge = x(before)
      else
         bridge = x(before) + (x(after) - x(before))*(real(k - before, dp)/real(after - before, dp))
      end if
   end function bridge

   !> A number between -1/2 and 1/2 that depends on the place of a sample alone.
   elemental real(dp) function spread_of(k)
      integer(int64), intent(in) :: k
      integer(int64) :: h
      integer :: j

      h = iand(k, mask32)
      do j = 1, 2
         h = ieor(h, shiftr(h, 17 - j))
         h = iand(h*scramble(j), mask32)
      end do
      h = ieor(h, shiftr(h, 15))
      spread_of = (real(h, dp) + 0.5_dp)/4294967296.0_dp - 0.5_dp
   end function spread_of

   !> Medians of eleven samples in a row each; missing where fewer than six are present.
   subroutine take_medians(x, step, median, known, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Quantization step, 0 for none
      real(dp), intent(in) :: step
      !> Medians, and 1 where there is one, else 0: [n/11]
      real(dp), allocatable, intent(out) :: median(:)
      integer(int8), allocatable, intent(out) :: known(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: y(window)
      logical :: there(window)
      integer(int64) :: k, first
      integer :: i, stat

      allocate (median(size(x, kind=int64)/window), known(size(x, kind=int64)/window), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the search for motion")
         return
      end if
      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) private(y, there, first, i) schedule(static)
      do k = 1, size(median, kind=int64)
         first = (k - 1)*window
         there = .true.
         if (present(valid)) there = valid(first + 1:first + window) /= 0_int8
         y = x(first + 1:first + window)
         if (step > 0.0_dp) y = y + step*spread_of([(first + i, i=1, window)])
         known(k) = merge(1_int8, 0_int8, 2*count(there) > window)
         median(k) = 0.0_dp
         if (known(k) == 1_int8) median(k) = small_median(pack(y, there))
      end do
      !$omp end parallel do
   end subroutine take_medians

   !> Step of a quantized series: the median distance of the distinct values among its first 100,000; 0 where a quarter of these
   !> or more are distinct, -1 where the series is constant but for fewer than ten samples.
   function coarse_step(x, valid) result(step)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: step, mean, deviation
      real(dp), allocatable :: first(:), distance(:)
      integer :: n, info

      step = 0.0_dp
      n = int(min(size(x, kind=int64), step_samples))
      if (present(valid)) then
         first = pack(x(:n), valid(:n) /= 0_int8)
      else
         first = x(:n)
      end if
      n = size(first)
      if (n < 2) return
      mean = sum(first)/n
      deviation = sqrt(sum((first - mean)**2)/n)
      call dlasrt("I", n, first, info)
      distance = first(2:) - first(:n - 1)
      distance = pack(distance, distance > distinct*deviation)
      if (size(distance) == 0 .or. distinct_share*(size(distance, kind=int64) + 1) > n) return
      step = -1.0_dp
      if (count(abs(first - first((n + 1)/2)) > distinct*deviation) >= least_off) step = small_median(distance)
   end function coarse_step

   !> Median, the mean of the two middle ones for an even number.
   pure real(dp) function small_median(x) result(median)
      !> One value or more; not modified
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x)), pivot, swap
      integer :: low, high, i, j, middle

      y = x
      middle = (size(y) + 1)/2
      low = 1
      high = size(y)
      do while (low < high)                              ! selection by exchange (C. A. R. Hoare, Comm. ACM 4, 1961)
         pivot = y(middle)
         i = low
         j = high
         do while (i <= j)
            do while (y(i) < pivot)
               i = i + 1
            end do
            do while (pivot < y(j))
               j = j - 1
            end do
            if (i > j) exit
            swap = y(i)
            y(i) = y(j)
            y(j) = swap
            i = i + 1
            j = j - 1
         end do
         if (j < middle) low = i
         if (middle < i) high = j
      end do
      median = y(middle)
      if (mod(size(y), 2) == 0) median = 0.5_dp*median + 0.5_dp*minval(y(middle + 1:))
   end function small_median

end module gyroakf_preprocess_running_residual
