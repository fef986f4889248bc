! SPDX-License-Identifier: MIT
!> The outlier rule `auto`: samples that stand apart from white, colored, quantized, drifting or heavy-tailed noise.
!>
!> 1. Residuals are the distances from a running median ([[block_residuals]]), over their loudness: the median residual of each
!>    256 samples over that of all, the largest of a block and its two neighbors, where it is above 1.5.
!> 2. The threshold follows from the medians q50 and the 90 % point q90 of the residuals below it,
!>
!> $$ T = q_{50} \left(\frac{1.0506}{0.6003} z\right)^g, \quad g = \max\left(1, \frac{\ln(q_{90}/q_{50})}{\ln 2.734}\right), \quad
!>    2 n Q(z) = 0.1 $$
!>
!>    (g = 1 for normal noise; heavier tails stretch it), repeated until it stays.
!> 3. Outliers stand apart: while more samples lie between T/1.5 and T (less those that the law of T expects, plus two of their
!>    standard deviations) than beyond T, T rises by 10 %. A heavy tail has no gap and keeps its samples.
!> 4. An exceedance with 4 more within 5 samples is part of a crowd. Crowds up to 11 samples apart are one; one longer than 22
!>    samples is motion and left alone with what exceeds within 11 samples of it, and so is every block that is more than three
!>    times as loud as the record. Shorter crowds are outliers.
!> 5. The same on medians of 11, 121, 1331 ... samples finds motion that is longer than a window, with 0.001 false alarms. It is
!>    reported, and nothing is marked.
!>
!> Quantiles and counts are those of a histogram of the residuals, 128 classes an octave: three passes over the record, the second
!> over loud blocks and the third over blocks with an exceedance only.
module gyroakf_preprocess_auto_outliers
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_threads, only : thread_count
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_select, only : find_median
   use gyroakf_special, only : normal_quantile
   use gyroakf_preprocess_running_residual, only : block_residuals, block_size, find_coarse_step, half, present_bit, &
      & take_medians, window
   implicit none (type, external)
   private
   public :: find_auto_outliers, auto_threshold

   !> Of white normal noise less its running median: median residual, 90 % point over it, scale of the tail
   real(dp), parameter :: median_residual = 0.6003_dp, tail_ratio = 2.734_dp, tail_scale = 1.0506_dp
   !> The quantiles are those of the residuals below this many standard deviations at least; of fewer they would shrink to 0
   real(dp), parameter :: least_scale = 2.0_dp
   !> Samples of a normal record that exceed the threshold on average; the same of motion
   real(dp), parameter :: false_alarms = 0.1_dp, false_motion = 0.001_dp
   !> Loudness from which on residuals are divided by it, and from which on it is motion
   real(dp), parameter :: loud_from = 1.5_dp, motion_from = 3.0_dp
   !> Exceedances of a crowd within half a window on either side; blocks from which on loudness is compared
   integer, parameter :: crowd = 5, min_blocks = 4
   !> Stretches of motion up to this many samples apart are one
   integer(int64), parameter :: one_stretch = 200
   !> Share of a sample that rounding reaches
   real(dp), parameter :: rounding = 64*epsilon(1.0_dp)
   !> Bits of a residual within a class of the histogram, bits of a class, and classes
   integer, parameter :: fine_bits = 45, class_bits = 18, classes = 2047*2**7
   !> Bits of a mark: the sample exceeds the threshold, is part of motion
   integer(int8), parameter :: exceeds_bit = 2_int8, motion_bit = 4_int8

contains

   !> The threshold of n samples in standard deviations of white normal noise.
   pure real(dp) function auto_threshold(n)
      !> Present samples, 1 or more
      integer(int64), intent(in) :: n

      auto_threshold = -normal_quantile(0.5_dp*false_alarms/real(max(n, 1_int64), dp))
   end function auto_threshold

   !> Finds outliers and the times of motion.
   subroutine find_auto_outliers(x, z, inlier, used, motion, error, valid, progress)
      !> Series: [n], finite where present
      real(dp), intent(in), contiguous :: x(:)
      !> Threshold in standard deviations of white normal noise, > 0
      real(dp), intent(in) :: z
      !> 1 inlier, 0 outlier or missing: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> T in standard deviations of white normal noise with the same median residual; z where half of the residuals are 0, and
      !> nothing is marked
      real(dp), intent(out) :: used
      !> First and last sample of each stretch of motion, ascending: [2, stretches]
      integer(int64), allocatable, intent(out) :: motion(:, :)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: loud(:)
      real(dp) :: step
      integer(int64) :: k

      inlier = present_bit
      if (present(valid)) inlier = merge(present_bit, 0_int8, valid /= 0_int8)
      used = z
      call find_coarse_step(x, step, error, valid)
      if (.not. allocated(error)) call find_exceedances(x, z, step, inlier, loud, used, error, progress)
      if (allocated(error)) return
      do k = 1, size(loud, kind=int64)
         if (loud(k) > motion_from) call set_motion(inlier, (k - 1)*block_size + 1, k*block_size, 0)
      end do
      call release_crowds(inlier)
      call find_long_motion(x, step, inlier, error, progress)
      if (.not. allocated(error)) call list_motion(inlier, motion, error)
   end subroutine find_auto_outliers

   !> Makes a stretch motion, without exceedances in it and in so many samples on either side.
   pure subroutine set_motion(marks, first, last, margin)
      integer(int8), intent(inout) :: marks(:)
      integer(int64), intent(in) :: first, last
      integer, intent(in) :: margin
      integer(int64) :: i, n

      n = size(marks, kind=int64)
      do i = max(1_int64, first - margin), min(n, last + margin)
         marks(i) = iand(marks(i), not(exceeds_bit))
      end do
      do i = first, min(last, n)
         marks(i) = ior(marks(i), motion_bit)
      end do
   end subroutine set_motion

   !> Marks the samples whose residuals exceed the threshold.
   subroutine find_exceedances(x, z, step, marks, loud, used, error, progress)
      real(dp), intent(in), contiguous :: x(:)
      !> Threshold in standard deviations, quantization step
      real(dp), intent(in) :: z, step
      !> `exceeds_bit` is set
      integer(int8), intent(inout), contiguous :: marks(:)
      !> Loudness of each block, 1 where it is not loud
      real(dp), allocatable, intent(out) :: loud(:)
      real(dp), intent(out) :: used
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer(int64), allocatable :: counts(:, :)
      real(dp), allocatable :: peak(:)
      real(dp) :: limit
      integer(int64) :: n, blocks
      integer :: stat

      n = size(x, kind=int64)
      blocks = (n + block_size - 1)/block_size
      used = z
      allocate (loud(blocks), stat=stat)
      if (stat == 0) allocate (peak(blocks), stat=stat)
      if (stat == 0) allocate (counts(0:classes, merge(thread_count(), 1, n >= threads_from)), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the search for outliers")
         return
      end if
      call report_progress("looking for outliers", 0_int64, n, error, progress)
      if (allocated(error)) return
      call scan_blocks(x, step, marks, loud, peak, counts)
      call compare_loudness(n, loud, error)
      if (.not. allocated(error)) call report_progress("looking for outliers", n/2, n, error, progress)
      if (allocated(error)) return
      call recount_loud(x, step, marks, loud, peak, counts(:, 1))
      call find_threshold(counts(:, 1), z, limit, used)
      if (step < 0.0_dp) limit = 0.0_dp
      call mark_exceedances(x, step, max(limit, 2*step), loud, peak, marks)   ! one step off the neighbors is no outlier
   end subroutine find_exceedances

   !> Histogram of the residuals, their median (-1 where fewer than half are present) and largest in each block.
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
      !$omp parallel do num_threads(size(counts, 2)) default(shared) private(residual, there, bin, i, block) schedule(static)
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
      middle_of = merge(0.5_dp*class_start(found) + 0.5_dp*class_start(found + 1), 0.0_dp, found > 0)
   end function middle_of

   !> Makes the medians of blocks loudness: over their median, the largest of a block and its neighbors, 1 up to 1.5.
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
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the loudness of the blocks")
         return
      end if
      known(:) = merge(1_int8, 0_int8, loud >= 0.0_dp)
      if (count(known == 1_int8, kind=int64) >= min_blocks) call find_median(loud, typical, error, known)
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
      !> Residuals of each class and of all below it
      integer(int64), intent(in) :: sums(0:)
      real(dp), intent(in) :: number
      integer :: bin

      bin = min(class_of(number), classes)
      if (number < 0.5_dp*class_start(bin) + 0.5_dp*class_start(bin + 1)) bin = max(bin - 1, 0)
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

   !> Marks what exceeds the limit and is no rounding error.
   subroutine mark_exceedances(x, step, limit, loud, peak, marks)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step, limit, loud(:), peak(:)
      integer(int8), intent(inout), contiguous :: marks(:)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer(int64) :: block, k
      integer :: i

      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) private(residual, there, i, k) schedule(static)
      do block = 1, size(peak, kind=int64)
         if (.not. peak(block) > limit) cycle
         call block_residuals(x, block, step, marks, residual, there)
         do i = 1, block_size
            k = (block - 1)*block_size + i
            if (.not. there(i)) cycle
            if (residual(i) > max(limit*loud(block), rounding*abs(x(k)))) marks(k) = ior(marks(k), exceeds_bit)
         end do
      end do
      !$omp end parallel do
   end subroutine mark_exceedances

   !> Makes long crowds motion.
   pure subroutine release_crowds(marks)
      integer(int8), intent(inout), contiguous :: marks(:)
      integer(int64) :: i, n, first, last

      n = size(marks, kind=int64)
      first = -window
      last = -window
      do i = 1, n
         if (iand(marks(i), exceeds_bit) == 0) cycle
         associate (near => marks(max(1_int64, i - half):min(n, i + half)))
            if (count(iand(near, exceeds_bit) /= 0) < crowd) cycle
         end associate
         if (i - last > window) then
            if (last - first > 2*window) call set_motion(marks, first, last, window)
            first = i
         end if
         last = i
      end do
      if (last - first > 2*window) call set_motion(marks, first, last, window)
   end subroutine release_crowds

   !> Makes motion what exceeds the threshold among medians of 11, 121, 1331 ... samples, but for the five at either end.
   subroutine find_long_motion(x, step, marks, error, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      integer(int8), intent(inout), contiguous :: marks(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: y(:), coarser(:), loud(:)
      integer(int8), allocatable :: known(:), known_coarser(:)
      real(dp) :: used
      integer(int64) :: length, k

      if (size(x, kind=int64) < 100*window) return
      call take_medians(x, step, marks, y, known, error)
      length = window
      do
         if (allocated(error)) return
         call find_exceedances(y, -normal_quantile(0.5_dp*false_motion/real(size(y), dp)), 0.0_dp, known, loud, used, error, &
            & progress)
         if (allocated(error)) return
         do k = 1 + half, size(y, kind=int64) - half
            if (iand(known(k), exceeds_bit) /= 0) marks((k - 1)*length + 1:k*length) = ior(marks((k - 1)*length + 1:k*length), &
               & motion_bit)
         end do
         if (size(y, kind=int64) < 100*window) return
         call take_medians(y, 0.0_dp, known, coarser, known_coarser, error)
         call move_alloc(coarser, y)
         call move_alloc(known_coarser, known)
         length = length*window
      end do
   end subroutine find_long_motion

   !> Lists the stretches of motion, and leaves in the marks only whether a sample is an inlier.
   subroutine list_motion(marks, motion, error)
      integer(int8), intent(inout) :: marks(:)
      integer(int64), allocatable, intent(out) :: motion(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: i, found, last
      integer :: pass, stat

      do pass = 1, 2                                     ! count, then keep
         found = 0
         last = -one_stretch
         do i = 1, size(marks, kind=int64)
            if (iand(marks(i), motion_bit) == 0) cycle
            if (i - last > one_stretch) found = found + 1
            if (pass == 2 .and. i - last > one_stretch) motion(1, found) = i
            if (pass == 2) motion(2, found) = i
            last = i
         end do
         if (pass == 2) exit
         allocate (motion(2, found), stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for the stretches of motion")
            return
         end if
      end do
      marks = merge(present_bit, 0_int8, iand(marks, ior(present_bit, exceeds_bit)) == present_bit)
   end subroutine list_motion

end module gyroakf_preprocess_auto_outliers
