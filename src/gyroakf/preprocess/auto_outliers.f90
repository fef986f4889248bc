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
!>    samples is motion, and so is what is more than three times as loud as the record: it is left alone. Shorter crowds are
!>    outliers.
!> 5. The same on medians of 11, 121, 1331 ... samples finds motion that is longer than a window, with 0.001 false alarms. It is
!>    told, and nothing is marked.
!>
!> Counts in a histogram of the residuals, 128 classes an octave, decide: three passes, the last one only where something exceeds.
module gyroakf_preprocess_auto_outliers
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_select, only : find_median
   use gyroakf_special, only : normal_quantile
   use gyroakf_preprocess_running_residual, only : block_residuals, block_size, coarse_step, small_median, take_medians, window
   implicit none (type, external)
   private
   public :: find_auto_outliers, auto_threshold

   !> Of white normal noise less its running median: median residual, 90 % point over it, scale of the tail
   real(dp), parameter :: median_residual = 0.6003_dp, tail_ratio = 2.734_dp, tail_scale = 1.0506_dp
   !> Samples of a normal record that exceed the threshold on average; the same of motion
   real(dp), parameter :: false_alarms = 0.1_dp, false_motion = 0.001_dp
   !> Loudness from which on residuals are divided by it, and from which on it is motion
   real(dp), parameter :: loud_from = 1.5_dp, motion_from = 3.0_dp
   !> Exceedances of a crowd within half a window on either side; stretches of motion less than this apart are one
   integer, parameter :: crowd = 5
   integer(int64), parameter :: one_stretch = 200
   !> Share of the largest sample that rounding reaches
   real(dp), parameter :: rounding = 64*epsilon(1.0_dp)
   !> Bits of a residual that a class of the histogram does not tell, and classes
   integer, parameter :: fine_bits = 45, classes = 2047*2**7
   !> Bits of a mark: an inlier, motion
   integer(int8), parameter :: inlier_bit = 1_int8, motion_bit = 2_int8

contains

   !> The threshold of n samples in standard deviations of white normal noise.
   pure real(dp) function auto_threshold(n)
      !> Present samples, 1 or more
      integer(int64), intent(in) :: n

      auto_threshold = -normal_quantile(0.5_dp*false_alarms/real(max(n, 1_int64), dp))
   end function auto_threshold

   !> Marks outliers, and tells where the record moves.
   subroutine find_auto_outliers(x, least, inlier, used, motion, error, valid, progress)
      !> Series: [n], finite where present
      real(dp), intent(in), contiguous :: x(:)
      !> z in standard deviations of white normal noise, > 0
      real(dp), intent(in), value :: least
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
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: loud(:)
      integer(int64), allocatable :: over(:)
      real(dp) :: step
      integer(int64) :: k

      inlier = inlier_bit
      if (present(valid)) inlier = merge(inlier_bit, 0_int8, valid /= 0_int8)
      step = coarse_step(x, valid)
      call find_exceedances(x, least, step, over, loud, used, error, valid, progress)
      if (allocated(error)) return
      do k = 1, size(loud, kind=int64)
         if (loud(k) > motion_from) call paint(inlier, (k - 1)*block_size + 1, k*block_size)
      end do
      do k = 1, size(over, kind=int64)
         inlier(over(k)) = iand(inlier(over(k)), not(inlier_bit))
      end do
      call release_crowds(over, loud, inlier)
      call find_long_motion(x, step, inlier, error, valid, progress)
      if (.not. allocated(error)) call list_motion(inlier, motion, error)
   end subroutine find_auto_outliers

   !> Marks a stretch as motion.
   pure subroutine paint(marks, first, last)
      integer(int8), intent(inout) :: marks(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: i

      do i = first, min(last, size(marks, kind=int64))
         marks(i) = ior(marks(i), motion_bit)
      end do
   end subroutine paint

   !> Samples whose residuals exceed the threshold.
   subroutine find_exceedances(x, z, step, over, loud, used, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      !> Threshold in standard deviations, quantization step
      real(dp), intent(in) :: z, step
      !> The samples, ascending
      integer(int64), allocatable, intent(out) :: over(:)
      !> Loudness of each block, 1 where it is not loud
      real(dp), allocatable, intent(out) :: loud(:)
      real(dp), intent(out) :: used
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64), allocatable :: counts(:)
      real(dp), allocatable :: peak(:)
      real(dp) :: limit
      integer(int64) :: n, blocks
      integer :: stat

      n = size(x, kind=int64)
      blocks = (n + block_size - 1)/block_size
      used = z
      allocate (loud(blocks), peak(blocks), counts(0:classes), over(0), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the search for outliers")
         return
      end if
      call tell_progress("looking for outliers", 0_int64, n, error, progress)
      if (.not. allocated(error)) call find_loudness(x, step, loud, error, valid)
      if (.not. allocated(error)) call tell_progress("looking for outliers", n/2, n, error, progress)
      if (allocated(error)) return
      call count_residuals(x, step, loud, counts, peak, valid)
      call find_threshold(counts, z, limit, used)
      ! neither one step off the neighbors, spread as they are, is an outlier nor what rounding makes
      if (step < 0.0_dp) limit = 0.0_dp
      limit = max(limit, 2*step, rounding*largest(x, valid))
      call gather(x, step, loud, peak, limit, over, valid)
   end subroutine find_exceedances

   !> The largest |x|, 0 where nothing is present.
   pure real(dp) function largest(x, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer(int8), intent(in), optional :: valid(:)

      if (present(valid)) then
         largest = max(0.0_dp, maxval(abs(x), mask=valid /= 0_int8))
      else
         largest = maxval(abs(x))
      end if
   end function largest

   !> Median residual of each block over that of all blocks.
   subroutine find_loudness(x, step, loud, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      real(dp), intent(out) :: loud(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: residual(block_size), before, here, typical
      logical :: there(block_size)
      integer(int8), allocatable :: known(:)
      integer(int64) :: block, blocks, whole

      blocks = size(loud, kind=int64)
      whole = size(x, kind=int64)/block_size
      loud = 1.0_dp
      if (whole < 4) return
      allocate (known(whole), source=1_int8)
      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) private(residual, there) schedule(static)
      do block = 1, whole
         call block_residuals(x, block, step, residual, there, valid)
         if (2*count(there) < block_size) then
            known(block) = 0_int8
         else
            loud(block) = small_median(pack(residual, there))
         end if
      end do
      !$omp end parallel do
      typical = 0.0_dp
      if (any(known /= 0_int8)) call find_median(loud(:whole), typical, error, known)
      if (allocated(error)) return
      if (.not. typical > 0.0_dp) then
         loud = 1.0_dp
         return
      end if
      loud(:whole) = merge(loud(:whole)/typical, 1.0_dp, known /= 0_int8)
      before = 0.0_dp
      do block = 1, whole
         here = loud(block)
         loud(block) = max(before, here)
         if (block < whole) loud(block) = max(loud(block), loud(block + 1))
         before = here
      end do
      where (loud <= loud_from) loud = 1.0_dp
      loud(whole + 1:) = loud(whole)
   end subroutine find_loudness

   !> Counts the residuals over their loudness in classes, and finds the largest of each block.
   subroutine count_residuals(x, step, loud, counts, peak, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step, loud(:)
      integer(int64), intent(out) :: counts(0:)
      real(dp), intent(out) :: peak(:)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer(int64) :: block, class
      integer :: i

      counts = 0
      !$omp parallel do if (size(x, kind=int64) >= threads_from) default(shared) private(residual, there, class, i) &
      !$omp& reduction(+:counts) schedule(static)
      do block = 1, size(peak, kind=int64)
         call block_residuals(x, block, step, residual, there, valid)
         residual = residual/loud(block)
         peak(block) = maxval(residual, mask=there)
         do i = 1, block_size
            class = shiftr(transfer(residual(i), class), fine_bits)
            if (there(i)) counts(class) = counts(class) + 1
         end do
      end do
      !$omp end parallel do
   end subroutine count_residuals

   !> The threshold, of steps 2 and 3.
   pure subroutine find_threshold(counts, z, limit, used)
      !> Residuals of each class; afterwards those of it and of all below
      integer(int64), intent(inout) :: counts(0:)
      real(dp), intent(in) :: z
      !> T, huge where half of the residuals are 0; and in standard deviations, then z
      real(dp), intent(out) :: limit, used
      real(dp) :: middle, g, n, kept, old, expected, band
      integer :: class, round

      do class = 1, ubound(counts, 1)
         counts(class) = counts(class) + counts(class - 1)
      end do
      n = real(counts(ubound(counts, 1)), dp)
      used = z
      limit = huge(limit)
      if (n < window .or. 2*counts(0) > n) return
      kept = n
      g = 1.0_dp
      do round = 1, 30
         middle = quantile(counts, 0.5_dp*kept)
         g = max(1.0_dp, log(quantile(counts, 0.9_dp*kept)/middle)/log(tail_ratio))
         limit = middle*(tail_scale/median_residual*z)**g
         old = kept
         kept = below(counts, limit)
         if (abs(kept - old) < 0.5_dp) exit
      end do
      do
         expected = n*erfc((limit/1.5_dp/middle)**(1/g)*median_residual/tail_scale/sqrt(2.0_dp))
         band = below(counts, limit) - below(counts, limit/1.5_dp)
         if (band - expected - 2*sqrt(expected) <= n - below(counts, limit)) exit
         limit = 1.1_dp*limit
      end do
      used = limit/middle*median_residual/tail_scale
   end subroutine find_threshold

   !> Residuals up to a number, each taken at the middle of its class.
   pure real(dp) function below(sums, number)
      !> Residuals of each class and of all below it
      integer(int64), intent(in) :: sums(0:)
      real(dp), intent(in) :: number
      integer(int64) :: class

      class = min(shiftr(transfer(number, class), fine_bits), ubound(sums, 1, kind=int64))
      if (2*number < class_start(class) + class_start(class + 1)) class = max(class - 1, 0_int64)
      below = real(sums(class), dp)
   end function below

   !> The number that so many residuals are below.
   pure real(dp) function quantile(sums, wanted)
      integer(int64), intent(in) :: sums(0:)
      real(dp), intent(in) :: wanted
      integer(int64) :: low, high, middle

      low = 0
      high = ubound(sums, 1, kind=int64)
      do while (low < high)
         middle = (low + high)/2
         if (real(sums(middle), dp) < wanted) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      quantile = class_start(low)
      if (low == 0) return
      quantile = quantile + (class_start(low + 1) - quantile)*(wanted - real(sums(low - 1), dp)) &
         & /real(max(sums(low) - sums(low - 1), 1_int64), dp)
   end function quantile

   !> The least number of a class.
   pure real(dp) function class_start(class)
      integer(int64), intent(in) :: class

      class_start = transfer(shiftl(class, fine_bits), class_start)
   end function class_start

   !> The samples that exceed the limit.
   subroutine gather(x, step, loud, peak, limit, over, valid)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step, loud(:), peak(:), limit
      integer(int64), allocatable, intent(inout) :: over(:)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: residual(block_size)
      logical :: there(block_size)
      integer(int64) :: block, found
      integer :: i, pass

      do pass = 1, 2                                     ! count, then keep
         found = 0
         do block = 1, size(peak, kind=int64)
            if (.not. peak(block) > limit) cycle
            call block_residuals(x, block, step, residual, there, valid)
            do i = 1, block_size
               if (.not. (there(i) .and. residual(i)/loud(block) > limit)) cycle
               found = found + 1
               if (pass == 2) over(found) = (block - 1)*block_size + i
            end do
         end do
         if (pass == 2) exit
         deallocate (over)
         allocate (over(found))
      end do
   end subroutine gather

   !> Takes the marks of long crowds, and of crowds in loud stretches, back: they are motion.
   pure subroutine release_crowds(over, loud, marks)
      integer(int64), intent(in) :: over(:)
      real(dp), intent(in) :: loud(:)
      integer(int8), intent(inout) :: marks(:)
      logical :: member(size(over))
      integer :: k, low, high, first, last

      low = 1
      high = 0
      do k = 1, size(over)
         do while (over(low) < over(k) - window/2)
            low = low + 1
         end do
         do while (high < size(over))
            if (over(high + 1) > over(k) + window/2) exit
            high = high + 1
         end do
         member(k) = high - low + 1 >= crowd
      end do
      first = 1
      do while (first <= size(over))
         last = first                                    ! a crowd is over(first) to over(last)
         do k = first + 1, merge(size(over), first, member(first))
            if (over(k) - over(last) > window) exit
            if (member(k)) last = k
         end do
         if (over(last) - over(first) > 2*window) call paint(marks, over(first), over(last))
         do k = first, last
            if (.not. member(k)) cycle
            if (iand(marks(over(k)), motion_bit) /= 0) marks(over(k)) = ior(marks(over(k)), inlier_bit)
         end do
         first = last + 1
      end do
   end subroutine release_crowds

   !> Marks as motion what exceeds the threshold among medians of 11, 121, 1331 ... samples, but for the five at either end.
   subroutine find_long_motion(x, step, marks, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      integer(int8), intent(inout) :: marks(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: y(:), coarser(:), loud(:)
      integer(int8), allocatable :: known(:), known_coarser(:)
      integer(int64), allocatable :: over(:)
      real(dp) :: used
      integer(int64) :: length, k

      if (size(x, kind=int64) < 100*window) return
      call take_medians(x, step, y, known, error, valid)
      length = window
      do
         if (allocated(error)) return
         call find_exceedances(y, -normal_quantile(0.5_dp*false_motion/real(size(y), dp)), 0.0_dp, over, loud, used, error, &
            & known, progress)
         if (allocated(error)) return
         do k = 1, size(over, kind=int64)
            if (over(k) > window/2 .and. over(k) <= size(y) - window/2) &
               & call paint(marks, (over(k) - 1)*length + 1, over(k)*length)
         end do
         if (size(y, kind=int64) < 100*window) return
         call take_medians(y, 0.0_dp, coarser, known_coarser, error, known)
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
      do i = 1, size(marks, kind=int64)
         marks(i) = iand(marks(i), inlier_bit)
      end do
   end subroutine list_motion

end module gyroakf_preprocess_auto_outliers
