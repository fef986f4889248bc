! SPDX-License-Identifier: MIT
!> The outlier rule `auto`: samples that stand apart from white, colored, quantized, drifting or
!> heavy-tailed noise.
!>
!> 1. Residuals are the distances from a running median ([[block_residuals]]), over their loudness:
!>    the median residual of each 256 samples over that of all, the largest of a block and its two
!>    neighbors, where it is above 1.5.
!> 2. The threshold follows from the medians q50 and the 90 % point q90 of the residuals below it,
!>
!> $$ T = q_{50} \left(\frac{1.0506}{0.6003} z\right)^g, \quad
!>    g = \max\left(1, \frac{\ln(q_{90}/q_{50})}{\ln 2.734}\right), \quad 2 n Q(z) = 0.1 $$
!>
!>    (g = 1 for normal noise; heavier tails stretch it), repeated until it stays.
!> 3. Outliers stand apart: while more samples lie between T/1.5 and T (less those that the law of T
!>    expects, plus two of their standard deviations) than beyond T, T rises by 10 %. A heavy tail
!>    has no gap and keeps its samples. Up to here: [[find_exceedances]].
!> 4. An exceedance with 4 more within 5 samples is part of a crowd. Crowds up to 11 samples apart
!>    are one; one longer than 22 samples is motion and left alone with what exceeds within 11
!>    samples of it, and so is every block that is more than three times as loud as the record.
!>    Shorter crowds are outliers.
!> 5. The same on medians of 11, 121, 1331 ... samples finds motion that is longer than a window,
!>    with 0.001 false alarms. It is reported, and nothing is marked.
module gyroakf_preprocess_auto_outliers
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_special, only : normal_quantile
   use gyroakf_preprocess_exceedances, only : find_exceedances, exceeds_bit
   use gyroakf_preprocess_running_residual, only : block_size, find_coarse_step, half, &
      & present_bit, take_medians, window
   implicit none (type, external)
   private
   public :: find_auto_outliers, auto_threshold

   !> Samples of a normal record that exceed the threshold on average; the same of motion
   real(dp), parameter :: false_alarms = 0.1_dp, false_motion = 0.001_dp
   !> Loudness from which on it is motion
   real(dp), parameter :: motion_from = 3.0_dp
   !> Exceedances of a crowd within half a window on either side
   integer, parameter :: crowd = 5
   !> Stretches of motion up to this many samples apart are one
   integer(int64), parameter :: one_stretch = 200
   !> Bit of a mark: the sample is part of motion
   integer(int8), parameter :: motion_bit = 4_int8

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
      !> T in standard deviations of white normal noise with the same median residual; z where half
      !> of the residuals are 0, and nothing is marked
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
      if (allocated(error)) return
      call find_exceedances(x, z, step, inlier, loud, used, error, progress)
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
      integer(int64) :: n

      n = size(marks, kind=int64)
      associate (around => marks(max(1_int64, first - margin):min(n, last + margin)))
         around = iand(around, not(exceeds_bit))
      end associate
      marks(first:min(last, n)) = ior(marks(first:min(last, n)), motion_bit)
   end subroutine set_motion

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

   !> Step 5, but for the five medians at either end.
   subroutine find_long_motion(x, step, marks, error, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      integer(int8), intent(inout), contiguous :: marks(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: y(:), coarser(:), loud(:)
      integer(int8), allocatable :: known(:), known_coarser(:)
      real(dp) :: z, used
      integer(int64) :: length, k

      if (size(x, kind=int64) < 100*window) return
      call take_medians(x, step, marks, y, known, error)
      length = window
      do
         if (allocated(error)) return
         z = -normal_quantile(0.5_dp*false_motion/real(size(y), dp))
         call find_exceedances(y, z, 0.0_dp, known, loud, used, error, progress)
         if (allocated(error)) return
         do k = 1 + half, size(y, kind=int64) - half
            if (iand(known(k), exceeds_bit) == 0) cycle
            associate (moving => marks((k - 1)*length + 1:k*length))
               moving = ior(moving, motion_bit)
            end associate
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
         call check_memory(stat, "the stretches of motion", error)
         if (allocated(error)) return
      end do
      marks = merge(present_bit, 0_int8, iand(marks, ior(present_bit, exceeds_bit)) == present_bit)
   end subroutine list_motion

end module gyroakf_preprocess_auto_outliers
