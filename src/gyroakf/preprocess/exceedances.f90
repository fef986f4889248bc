! SPDX-License-Identifier: MIT
!> Samples whose distance from the running median exceeds a threshold that follows from these
!> distances: steps 1 to 3 of the outlier rule `auto` ([[gyroakf_preprocess_auto_outliers]]).
!>
!> Quantiles and counts are those of a histogram of the residuals, 128 classes an octave: a pass
!> over the record, one over loud blocks and one over blocks with an exceedance.
module gyroakf_preprocess_exceedances
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : threads_from
   use gyroakf_threads, only : thread_count
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_select, only : find_median
   use gyroakf_preprocess_running_residual, only : block_residuals, block_size, window
   implicit none (type, external)
   private
   public :: find_exceedances, exceeds_bit

   !> White normal noise less its running median: median, 90 % point over it, scale of the tail
   real(dp), parameter :: median_residual = 0.6003_dp, tail_ratio = 2.734_dp, tail_scale = 1.0506_dp
   !> Quantiles of the residuals below this many sigma at least: of fewer they shrink to 0
   real(dp), parameter :: least_scale = 2.0_dp
   !> Loudness from which on residuals are divided by it; blocks from which on it is compared
   real(dp), parameter :: loud_from = 1.5_dp
   integer, parameter :: min_blocks = 4
   !> Share of a sample that rounding reaches
   real(dp), parameter :: rounding = 64*epsilon(1.0_dp)
   !> Bits of a residual within a class of the histogram, bits of a class, and classes
   integer, parameter :: fine_bits = 45, class_bits = 18, classes = 2047*2**7
   !> Bit of a mark: the sample exceeds the threshold
   integer(int8), parameter :: exceeds_bit = 2_int8

contains

   !> Marks the samples whose residuals exceed the threshold: steps 1 to 3.
   subroutine find_exceedances(x, z, step, marks, loud, used, error, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Threshold in standard deviations of white normal noise, quantization step (0 for none)
      real(dp), intent(in) :: z, step
      !> `present_bit` is set where present; `exceeds_bit` is set: [n]
      integer(int8), intent(inout), contiguous :: marks(:)
      !> Loudness of each block, 1 where it is not loud: [(n + 255)/256]
      real(dp), allocatable, intent(out) :: loud(:)
      !> T in standard deviations of white normal noise with the same median residual
      real(dp), intent(out) :: used
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64), allocatable :: counts(:, :)
      real(dp), allocatable :: peak(:)
      real(dp) :: limit
      integer(int64) :: n, blocks
      integer :: parts, stat

      n = size(x, kind=int64)
      blocks = (n + block_size - 1)/block_size
      used = z
      parts = merge(thread_count(), 1, n >= threads_from)
      allocate (loud(blocks), stat=stat)
      if (stat == 0) allocate (peak(blocks), stat=stat)
      if (stat == 0) allocate (counts(0:classes, parts), stat=stat)
      call check_memory(stat, "the search for outliers", error)
      if (allocated(error)) return
      call report_progress("looking for outliers", 0_int64, n, error, progress)
      if (allocated(error)) return
      call scan_blocks(x, step, marks, loud, peak, counts)
      call compare_loudness(n, loud, error)
      if (allocated(error)) return
      call report_progress("looking for outliers", n/2, n, error, progress)
      if (allocated(error)) return
      call recount_loud(x, step, marks, loud, peak, counts(:, 1))
      call find_threshold(counts(:, 1), z, limit, used)
      if (step < 0.0_dp) limit = 0.0_dp
      limit = max(limit, 2*step)                        ! one step off the neighbors is no outlier
      call mark_exceedances(x, step, limit, loud, peak, marks)
   end subroutine find_exceedances

   !> Histogram of the residuals; median (-1 where most are missing) and largest of each block.
   subroutine scan_blocks(x, step, marks, middle, peak, counts)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      integer(int8), intent(in), contiguous :: marks(:)
      real(dp), intent(out) :: middle(:), peak(:)
      !> Of each class and thread; afterwards those of all threads stand in the first column
      integer(int64), intent(out), contiguous :: counts(0:, :)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer :: bin(block_size), i, part
      integer(int64) :: block, blocks

      counts = 0
      blocks = size(peak, kind=int64)
      !$omp parallel do num_threads(size(counts, 2)) default(shared) &
      !$omp& private(residual, there, bin, i, block) schedule(static)
      do part = 1, size(counts, 2)
         do block = 1 + (part - 1)*blocks/size(counts, 2), part*blocks/size(counts, 2)
            call block_residuals(x, block, step, marks, residual, there)
            peak(block) = maxval(residual)
            bin = merge(class_of(residual), classes + 1, there)
            do i = 1, block_size
               if (there(i)) counts(bin(i), part) = counts(bin(i), part) + 1
            end do
            middle(block) = -1.0_dp
            if (2*count(there) >= block_size) middle(block) = middle_of(bin, count(there))
         end do
      end do
      !$omp end parallel do
      do part = 2, size(counts, 2)
         counts(:, 1) = counts(:, 1) + counts(:, part)
      end do
   end subroutine scan_blocks

   !> Class of a residual.
   elemental integer function class_of(residual)
      real(dp), intent(in) :: residual

      class_of = int(shiftr(transfer(residual, 0_int64), fine_bits))
   end function class_of

   !> Center of the class of the median among n classes, found bit by bit.
   pure real(dp) function middle_of(bin, n)
      integer, intent(in) :: bin(block_size), n
      integer :: bit, found

      found = 0
      do bit = class_bits - 1, 0, -1
         if (2*count(bin < found + 2**bit) <= n) found = found + 2**bit
      end do
      middle_of = 0.0_dp
      if (found > 0) middle_of = class_center(found)
   end function middle_of

   !> Makes the medians of the blocks their loudness: step 1.
   subroutine compare_loudness(n, loud, error)
      integer(int64), intent(in) :: n
      real(dp), intent(inout), contiguous :: loud(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), allocatable :: known(:)
      real(dp) :: typical, before, own
      integer(int64) :: k, blocks
      integer :: stat

      typical = 0.0_dp
      blocks = size(loud, kind=int64)
      if (mod(n, int(block_size, int64)) /= 0) loud(blocks) = -1.0_dp
      allocate (known(blocks), stat=stat)
      call check_memory(stat, "the loudness of the blocks", error)
      if (allocated(error)) return
      known(:) = merge(1_int8, 0_int8, loud >= 0.0_dp)
      if (count(known == 1_int8, kind=int64) >= min_blocks) call find_median(loud, typical, error, &
         & known)
      if (allocated(error)) return
      before = 0.0_dp
      do k = 1, blocks
         own = loud(k)
         loud(k) = max(before, own, loud(min(k + 1, blocks)))
         before = own
         if (loud(k) <= loud_from*typical .or. .not. typical > 0.0_dp) loud(k) = typical
      end do
      if (typical > 0.0_dp) loud = loud/typical
      if (.not. typical > 0.0_dp) loud = 1.0_dp
   end subroutine compare_loudness

   !> Replaces the residuals of loud blocks by those over their loudness.
   subroutine recount_loud(x, step, marks, loud, peak, counts)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step, loud(:)
      integer(int8), intent(in), contiguous :: marks(:)
      real(dp), intent(inout) :: peak(:)
      integer(int64), intent(inout) :: counts(0:)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer(int64) :: block
      integer :: i, bin, divided

      do block = 1, size(loud, kind=int64)
         if (.not. loud(block) > 1.0_dp) cycle
         call block_residuals(x, block, step, marks, residual, there)
         peak(block) = peak(block)/loud(block)
         do i = 1, block_size
            if (.not. there(i)) cycle
            bin = class_of(residual(i))
            divided = class_of(residual(i)/loud(block))
            counts(bin) = counts(bin) - 1
            counts(divided) = counts(divided) + 1
         end do
      end do
   end subroutine recount_loud

   !> The threshold, of steps 2 and 3.
   pure subroutine find_threshold(counts, z, limit, used)
      !> Residuals of each class; afterwards those of it and of all below
      integer(int64), intent(inout) :: counts(0:)
      real(dp), intent(in) :: z
      !> T, huge where half of the residuals below it are 0; and in standard deviations, then z
      real(dp), intent(out) :: limit, used
      real(dp) :: middle, g, n, kept, old, expected, band
      integer :: bin, round

      do bin = 1, classes
         counts(bin) = counts(bin) + counts(bin - 1)
      end do
      n = real(counts(classes), dp)
      used = z
      limit = huge(limit)
      if (n < window .or. 2*counts(0) > n) return
      kept = n
      g = 1.0_dp
      do round = 1, 30
         middle = quantile(counts, 0.5_dp*kept)
         g = max(1.0_dp, log(quantile(counts, 0.9_dp*kept)/middle)/log(tail_ratio))
         old = kept
         kept = below(counts, middle*(tail_scale/median_residual*max(z, least_scale))**g)
         if (abs(kept - old) < 0.5_dp .or. 2*counts(0) > kept) exit
      end do
      if (2*counts(0) > kept) return
      limit = min(middle*(tail_scale/median_residual*z)**g, huge(limit))
      do
         expected = n*erfc((limit/1.5_dp/middle)**(1/g)*median_residual/tail_scale/sqrt(2.0_dp))
         band = below(counts, limit) - below(counts, limit/1.5_dp)
         if (.not. band - expected - 2*sqrt(expected) > n - below(counts, limit)) exit
         limit = 1.1_dp*limit
      end do
      used = limit/middle*median_residual/tail_scale
   end subroutine find_threshold

   !> Residuals up to a number, each taken at the center of its class.
   pure real(dp) function below(sums, number)
      integer(int64), intent(in) :: sums(0:)
      real(dp), intent(in) :: number
      integer :: bin

      bin = min(class_of(number), classes)
      if (number < class_center(bin)) bin = max(bin - 1, 0)
      below = real(sums(bin), dp)
   end function below

   !> The number that so many residuals are below.
   pure real(dp) function quantile(sums, wanted)
      integer(int64), intent(in) :: sums(0:)
      real(dp), intent(in) :: wanted
      integer :: bin

      bin = count(sums < wanted)
      quantile = class_start(bin)
      if (bin == 0) return
      quantile = quantile + (class_start(bin + 1) - quantile)*(wanted - real(sums(bin - 1), dp)) &
         & /real(sums(bin) - sums(bin - 1), dp)
   end function quantile

   !> The least number of a class; the largest number beyond the last.
   pure real(dp) function class_start(bin)
      integer, intent(in) :: bin

      class_start = huge(class_start)
      if (bin < classes) class_start = transfer(shiftl(int(bin, int64), fine_bits), class_start)
   end function class_start

   pure real(dp) function class_center(bin)
      integer, intent(in) :: bin

      class_center = 0.5_dp*class_start(bin) + 0.5_dp*class_start(bin + 1)
   end function class_center

   !> Marks what exceeds the limit and is no rounding error.
   subroutine mark_exceedances(x, step, limit, loud, peak, marks)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step, limit, loud(:), peak(:)
      integer(int8), intent(inout), contiguous :: marks(:)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer(int64) :: block, k
      integer :: i

      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) &
      !$omp& private(residual, there, i, k) schedule(static)
      do block = 1, size(peak, kind=int64)
         if (.not. peak(block) > limit) cycle
         call block_residuals(x, block, step, marks, residual, there)
         do i = 1, block_size
            k = (block - 1)*block_size + i
            if (.not. there(i)) cycle
            if (residual(i) <= max(limit*loud(block), rounding*abs(x(k)))) cycle
            marks(k) = ior(marks(k), exceeds_bit)
         end do
      end do
      !$omp end parallel do
   end subroutine mark_exceedances

end module gyroakf_preprocess_exceedances
