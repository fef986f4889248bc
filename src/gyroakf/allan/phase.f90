! SPDX-License-Identifier: MIT
!> The integral of a rate record, from which every Allan statistic is a difference.
!>
!> $$ x_0 = 0, \quad x_k = \sum_{i=1}^{k} (w_i - \bar w) $$
!>
!> The mean is taken out first, so that an offset costs no digits; a straight line in x changes no
!> second difference. The sum runs in the blocks of [[sum_blocks]], within which the partial sums
!> stay small, so that the rounding error of a difference does not grow with the length of the
!> record.
module gyroakf_allan_phase
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_large_pages, only : prefer_large_pages
   use gyroakf_allan_block_sums, only : block_length, block_sums_type, count_non_finite, &
      & parallel_from, present_sample, sum_blocks
   implicit none (type, external)
   private
   public :: integrate_rate, integrate_blocks, integrate_stretch, level_phase

   !> Blocks between two reports of progress, a multiple of four
   integer(int64), parameter :: report_blocks = 512

contains

   !> Integrates a rate record: phase(k) = sum of the first k samples less their mean, in units of
   !> rate times sample.
   !>
   !> Missing and non-finite samples add nothing, and `missing(k)` counts them among the first k; it
   !> is allocated only where there are any. Cost: two passes.
   subroutine integrate_rate(rate, phase, missing, error, valid, progress)
      !> Rate samples: [n], n >= 1
      real(dp), intent(in), contiguous :: rate(:)
      !> The integral: [0:n]
      real(dp), allocatable, intent(out) :: phase(:)
      !> Missing samples so far: [0:n], unallocated when every sample is there
      integer(int32), allocatable, intent(out) :: missing(:)
      !> invalid_argument (lengths differ), too_few_samples (no sample at all), no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(block_sums_type) :: blocks

      call sum_blocks(rate, blocks, error, valid)
      if (.not. allocated(error)) call integrate_blocks(rate, blocks, phase, missing, error, &
         & valid, progress)
   end subroutine integrate_rate

   !> The second pass of [[integrate_rate]].
   subroutine integrate_blocks(rate, blocks, phase, missing, error, valid, progress)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> From [[sum_blocks]]
      type(block_sums_type), intent(in) :: blocks
      !> The integral: [0:n]
      real(dp), allocatable, intent(out) :: phase(:)
      !> Missing samples so far: [0:n], unallocated when every sample is there
      integer(int32), allocatable, intent(out) :: missing(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      integer(int64) :: n, number, from, step, group, b, first, last, lost
      integer :: stat

      n = size(rate, kind=int64)
      number = size(blocks%offset, kind=int64)
      lost = blocks%absent(number + 1)
      stat = merge(1, 0, lost > huge(0_int32))
      if (stat == 0) allocate (phase(0:n), stat=stat)
      if (stat == 0 .and. lost > 0) allocate (missing(0:n), stat=stat)
      call check_memory(stat, "the integral of the record", error)
      if (allocated(error)) return
      call prefer_large_pages(phase)
      phase(0) = 0
      if (allocated(missing)) missing(0) = 0
      step = number
      if (present(progress)) step = report_blocks
      do from = 1, number, step
         call report_progress("Allan deviation", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         !$omp parallel do schedule(static) private(b, first, last) if (n >= parallel_from)
         do group = from, min(from + step - 1, number), 4
            if (.not. allocated(missing)) then
               first = (group - 1)*block_length
               last = min(n, first + 4*block_length)
               call integrate_stretch(rate(first + 1:last), blocks%mean, blocks%offset(group:), &
                  & phase(first + 1:last))
               cycle
            end if
            do b = group, min(group + 3, number)
               first = (b - 1)*block_length
               last = min(n, first + block_length)
               if (blocks%absent(b + 1) == blocks%absent(b)) then
                  call integrate_stretch(rate(first + 1:last), blocks%mean, blocks%offset(b:b), &
                     & phase(first + 1:last))
                  missing(first + 1:last) = int(blocks%absent(b), int32)
               else
                  call integrate_gapped(rate, first + 1, last, blocks%mean, blocks%offset(b), &
                     & blocks%absent(b), phase, missing, valid)
               end if
            end do
         end do
         !$omp end parallel do
      end do
   end subroutine integrate_blocks

   !> Phases without the straight line through the first and the last, in units of rate times
   !> sample.
   subroutine level_phase(angle, sample_interval, phase, error)
      !> Phases: [n + 1], n >= 1
      real(dp), intent(in), contiguous :: angle(:)
      !> Seconds, > 0
      real(dp), intent(in) :: sample_interval
      !> The result: [0:n]
      real(dp), allocatable, intent(out) :: phase(:)
      !> non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error

      integer(int64) :: n, k, bad
      real(dp) :: first, slope, scale
      integer :: stat
      character(20) :: text

      bad = count_non_finite(angle)
      if (bad > 0) then
         write (text, "(i0)") bad
         call fatal_error(error, status%non_finite, &
            & trim(text)//" of the phases are not finite: a lost phase cannot be bridged")
         return
      end if
      n = size(angle, kind=int64) - 1
      allocate (phase(0:n), stat=stat)
      call check_memory(stat, "the phases", error)
      if (allocated(error)) return
      call prefer_large_pages(phase)
      first = angle(1)
      slope = (angle(n + 1) - first)/real(n, dp)
      scale = 1/sample_interval
      !$omp parallel do simd schedule(static) if (parallel: n >= parallel_from)
      do k = 0, n
         phase(k) = ((angle(k + 1) - first) - slope*real(k, dp))*scale
      end do
      !$omp end parallel do simd
   end subroutine level_phase

   !> Neighboring phases of a record without gaps, four complete blocks at a time.
   pure subroutine integrate_stretch(rate, mean, offset, phase)
      !> Samples from the beginning of a block on
      real(dp), intent(in), contiguous :: rate(:)
      !> Taken off each
      real(dp), intent(in) :: mean
      !> Phase before each block
      real(dp), intent(in), contiguous :: offset(:)
      !> The phases: [size(rate)]
      real(dp), intent(inout), contiguous :: phase(:)

      integer(int64) :: first, k, b
      real(dp) :: s

      first = 0
      b = 1
      do while (first < size(rate, kind=int64))
         if (first + 4*block_length <= size(rate, kind=int64)) then
            call integrate_four(rate(first + 1:first + 4*block_length), mean, offset(b:b + 3), &
               & phase(first + 1:first + 4*block_length))
            b = b + 4
            first = first + 4*block_length
         else
            s = 0
            do k = first + 1, min(first + block_length, size(rate, kind=int64))
               s = s + (rate(k) - mean)
               phase(k) = offset(b) + s
            end do
            b = b + 1
            first = first + block_length
         end if
      end do
   end subroutine integrate_stretch

   !> Four blocks side by side, so that the additions of one do not wait for each other.
   pure subroutine integrate_four(rate, mean, offset, phase)
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(in) :: mean, offset(4)
      real(dp), intent(inout), contiguous :: phase(:)
      integer(int64), parameter :: n = block_length
      integer(int64) :: i
      real(dp) :: s1, s2, s3, s4

      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      do i = 1, n
         s1 = s1 + (rate(i) - mean)
         s2 = s2 + (rate(i + n) - mean)
         s3 = s3 + (rate(i + 2*n) - mean)
         s4 = s4 + (rate(i + 3*n) - mean)
         phase(i) = offset(1) + s1
         phase(i + n) = offset(2) + s2
         phase(i + 2*n) = offset(3) + s3
         phase(i + 3*n) = offset(4) + s4
      end do
   end subroutine integrate_four

   !> One block of a record with gaps.
   pure subroutine integrate_gapped(rate, first, last, mean, offset, absent, phase, missing, valid)
      real(dp), intent(in), contiguous :: rate(:)
      !> First and last sample of the block
      integer(int64), intent(in) :: first, last
      !> Taken off each; phase and missing samples before the block
      real(dp), intent(in) :: mean, offset
      integer(int64), intent(in) :: absent
      real(dp), intent(inout), contiguous :: phase(0:)
      integer(int32), intent(inout), contiguous :: missing(0:)
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: i, lost
      real(dp) :: s

      s = 0
      lost = absent
      do i = first, last
         if (present_sample(rate, i, valid)) then
            s = s + (rate(i) - mean)
         else
            lost = lost + 1
         end if
         phase(i) = offset + s
         missing(i) = int(lost, int32)
      end do
   end subroutine integrate_gapped

end module gyroakf_allan_phase
