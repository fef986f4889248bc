! SPDX-License-Identifier: MIT
!> Distance of each sample from the running median of eleven, and medians of eleven samples each.
!>
!> $$ r_i = |x_i - \mathrm{median}(x_{i-5}, \ldots, x_{i+5})| $$
!>
!> A median keeps steps, ramps and warm-ups, and five bad samples of eleven do not move it. The
!> record is mirrored at its ends, missing samples are bridged by straight lines. Quantized samples
!> are spread over their step by fixed numbers: else the quantiles of r are 0 or a step.
module gyroakf_preprocess_running_residual
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from
   use gyroakf_select, only : find_median
   use gyroakf_sort, only : sort_values
   implicit none (type, external)
   private
   public :: block_residuals, block_size, find_coarse_step, half, is_present, present_bit, &
      & take_medians, window

   !> Samples on either side of the center of a window, of a window, and of a block
   integer, parameter :: half = 5, window = 2*half + 1, block_size = 256
   !> Bit of a mark: the sample is present
   integer(int8), parameter :: present_bit = 1_int8
   !> Samples searched for a quantization; one in so many is distinct where there is none
   integer(int64), parameter :: step_samples = 100000, distinct_share = 4
   !> Least number of samples off the median for a quantization
   integer, parameter :: min_off_median = 10
   !> Values are distinct that differ by more than this share of the standard deviation
   real(dp), parameter :: distinct = 1.0e-9_dp
   !> Factors and mask of the scrambling of 32 bits
   integer(int64), parameter :: scramble(2) = [int(z'21F0AAAD', int64), int(z'735A2D97', int64)], &
      & mask32 = 2_int64**32 - 1

contains

   elemental logical function is_present(mark)
      integer(int8), intent(in) :: mark

      is_present = iand(mark, present_bit) /= 0_int8
   end function is_present

   !> Residuals of a block of 256 samples.
   pure subroutine block_residuals(x, block, step, marks, residual, there)
      !> Series: [n], finite where present
      real(dp), intent(in), contiguous :: x(:)
      !> 1 .. (n + 255)/256
      integer(int64), intent(in) :: block
      !> Quantization step, 0 for none
      real(dp), intent(in) :: step
      !> `present_bit` is set where present: [n]
      integer(int8), intent(in), contiguous :: marks(:)
      !> r >= 0, 0 where missing or beyond the record: [256]
      real(dp), intent(out) :: residual(block_size)
      !> Samples that are present, in the record: [256]
      logical, intent(out) :: there(block_size)
      real(dp) :: y(block_size + window - 1)
      logical :: around(block_size + window - 1)

      call take_samples(x, (block - 1)*block_size - half, step, marks, y, around)
      there = around(half + 1:half + block_size)
      call find_medians(y, 1, residual)
      residual = merge(abs(y(half + 1:half + block_size) - residual), 0.0_dp, there)
   end subroutine block_residuals

   !> Medians of eleven each, which begin at y(1), y(1 + stride), ...
   pure subroutine find_medians(y, stride, median)
      real(dp), intent(in), contiguous :: y(:)
      integer, intent(in) :: stride
      real(dp), intent(out) :: median(block_size)
      real(dp) :: w(block_size, half + 2)
      integer :: next, columns, j

      columns = size(w, 2)
      do j = 1, columns
         w(:, j) = y(j:j + stride*(block_size - 1):stride)
      end do
      ! the smallest and the largest of those held cannot be the median
      do next = columns + 1, window + 1
         do j = 1, columns - 1
            call order(w(:, j), w(:, j + 1))
         end do
         do j = columns - 1, 2, -1
            call order(w(:, j - 1), w(:, j))
         end do
         if (next > window) exit
         w(:, 1) = y(next:next + stride*(block_size - 1):stride)
         columns = columns - 1
      end do
      median = w(:, 2)
   end subroutine find_medians

   pure subroutine order(a, b)
      real(dp), intent(inout) :: a(block_size), b(block_size)
      real(dp) :: low
      integer :: i

      do i = 1, block_size
         low = min(a(i), b(i))
         b(i) = max(a(i), b(i))
         a(i) = low
      end do
   end subroutine order

   !> Samples from first + 1 on, mirrored, bridged, and spread over their step.
   pure subroutine take_samples(x, first, step, marks, y, there)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: first
      real(dp), intent(in) :: step
      integer(int8), intent(in), contiguous :: marks(:)
      real(dp), intent(out), contiguous :: y(:)
      logical, intent(out), contiguous :: there(:)
      integer(int64) :: n, k, before, after
      integer :: i

      n = size(x, kind=int64)
      before = 0
      after = 0
      do i = 1, size(y)
         k = first + i
         there(i) = k >= 1 .and. k <= n
         if (.not. there(i)) k = min(max(1_int64, merge(1 - k, 2*n + 1 - k, k < 1)), n)
         y(i) = x(k)
         if (.not. is_present(marks(k))) then
            there(i) = .false.
            if (.not. (k > before .and. k < after)) call find_neighbors(marks, k, before, after)
            y(i) = bridge(x, k, before, after)
         end if
         if (step > 0.0_dp) y(i) = y(i) + step*spread_of(k)
      end do
   end subroutine take_samples

   !> Present samples on either side of a missing one; 0 and n + 1 where there are none.
   pure subroutine find_neighbors(marks, k, before, after)
      integer(int8), intent(in) :: marks(:)
      integer(int64), intent(in) :: k
      integer(int64), intent(out) :: before, after

      do before = k - 1, 1, -1
         if (is_present(marks(before))) exit
      end do
      do after = k + 1, size(marks, kind=int64)
         if (is_present(marks(after))) exit
      end do
   end subroutine find_neighbors

   !> Value of the straight line between two samples, one of them where the other does not exist.
   pure real(dp) function bridge(x, k, before, after)
      real(dp), intent(in) :: x(:)
      integer(int64), intent(in) :: k, before, after
      real(dp) :: ends(2)

      ends = 0.0_dp
      if (before >= 1) ends = x(before)
      if (after <= size(x, kind=int64)) ends(2) = x(after)
      if (before < 1) ends(1) = ends(2)
      bridge = ends(1) + (ends(2) - ends(1))*(real(k - before, dp)/real(after - before, dp))
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

   !> Medians of eleven samples in a row each.
   subroutine take_medians(x, step, marks, median, known, error)
      real(dp), intent(in), contiguous :: x(:)
      !> Quantization step, 0 for none
      real(dp), intent(in) :: step
      !> `present_bit` is set where present: [n]
      integer(int8), intent(in), contiguous :: marks(:)
      !> Medians, and `present_bit` where six or more of the samples are present, else 0: [n/11]
      real(dp), allocatable, intent(out) :: median(:)
      integer(int8), allocatable, intent(out) :: known(:)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: y(:)
      logical, allocatable :: there(:)
      real(dp) :: medians(block_size)
      integer(int64) :: k, number
      integer :: j, stat, bad

      number = size(x, kind=int64)/window
      allocate (median(number), stat=stat)
      if (stat == 0) allocate (known(number), stat=stat)
      call check_memory(stat, "the search for motion", error)
      if (allocated(error)) return
      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) &
      !$omp& private(y, there, medians, j, bad) schedule(static) reduction(+:stat)
      do k = 0, number - 1, block_size
         bad = 0
         if (.not. allocated(y)) allocate (y(window*block_size), stat=bad)
         if (bad == 0 .and. .not. allocated(there)) allocate (there(window*block_size), stat=bad)
         stat = stat + bad
         if (bad /= 0) cycle
         call take_samples(x, k*window, step, marks, y, there)
         call find_medians(y, window, medians)
         do j = 1, int(min(number - k, int(block_size, int64)))
            median(k + j) = medians(j)
            known(k + j) = merge(present_bit, 0_int8, 2*count(there((j - 1)*window + 1:j*window)) &
               & > window)
         end do
      end do
      !$omp end parallel do
      call check_memory(stat, "the search for motion", error)
   end subroutine take_medians

   !> Quantization step: the median distance of the distinct values among the first 100,000 samples.
   subroutine find_coarse_step(x, step, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> 0 where a quarter or more are distinct, -1 where fewer than ten samples differ
      real(dp), intent(out) :: step
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: value(:)
      real(dp) :: deviation, distance
      integer :: n, k, i, off_median, stat

      step = 0.0_dp
      n = int(min(size(x, kind=int64), step_samples))
      allocate (value(n), stat=stat)
      call check_memory(stat, "the search of a quantization step", error)
      if (allocated(error)) return
      k = 0
      do i = 1, n
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         k = k + 1
         value(k) = x(i)
      end do
      n = k
      if (n < 2) return
      deviation = sum(value(:n))/n
      deviation = distinct*sqrt(sum((value(:n) - deviation)**2)/n)
      call sort_values(value(:n), error)
      if (allocated(error)) return
      off_median = count(abs(value(:n) - value((n + 1)/2)) > deviation)
      k = 0                                             ! the distances take the place of the values
      do i = 1, n - 1
         distance = value(i + 1) - value(i)
         if (.not. distance > deviation) cycle
         k = k + 1
         value(k) = distance
      end do
      if (k == 0 .or. distinct_share*(k + 1_int64) > n) return
      step = -1.0_dp
      if (off_median >= min_off_median) call find_median(value(:k), step, error)
   end subroutine find_coarse_step

end module gyroakf_preprocess_running_residual
