! SPDX-License-Identifier: MIT
!> The integral of a rate record, from which every Allan statistic is a difference.
!>
!> $$ x_0 = 0, \quad x_k = \sum_{i=1}^{k} (w_i - \bar w) $$
!>
!> The mean is taken out first, so that an offset costs no digits; a straight line in x changes no
!> second difference. The sum runs in blocks of fixed length: the sums of the blocks are accumulated with
!> compensation, and within a block the partial sums stay small, so that the rounding error of a
!> difference does not grow with the length of the record. The blocks do not depend on the number of
!> threads, and neither does any bit of the result.
module gyroakf_allan_phase
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int32, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_large_pages, only : prefer_large_pages
   implicit none (type, external)
   private
   public :: integrate_rate, level_phase

   !> Samples in a block
   integer(int64), parameter :: block_length = 2048
   !> Blocks between two reports of progress, a multiple of four
   integer(int64), parameter :: report_blocks = 512
   !> Records shorter than this are not worth a second thread
   integer(int64), parameter :: parallel_from = 200000
   !> Samples that a first guess of the mean looks at
   integer(int64), parameter :: pilot_samples = 1024

contains

   !> Integrates a rate record: phase(k) = sum of the first k samples less their mean, in units of rate times sample.
   !>
   !> Missing and non-finite samples add nothing, and `missing(k)` counts them among the first k; it is
   !> allocated only where there are any. Cost: two passes.
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

      real(dp), allocatable :: sums(:)
      integer(int64), allocatable :: absent(:)
      integer(int64) :: n, blocks, total
      real(dp) :: pilot, mean
      integer :: stat

      n = size(rate, kind=int64)
      if (present(valid)) then
         if (size(valid, kind=int64) /= n) then
            call fatal_error(error, status%invalid_argument, "rate and valid have different lengths")
            return
         end if
      end if
      blocks = (n + block_length - 1)/block_length
      allocate (phase(0:n), stat=stat)
      if (stat == 0) allocate (sums(blocks), stat=stat)
      if (stat == 0) allocate (absent(blocks + 1), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the integral of the record")
         return
      end if
      call prefer_large_pages(phase)
      call sum_blocks(rate, sums, absent, pilot, valid)
      total = sum(absent)
      if (total >= n) then
         call fatal_error(error, status%too_few_samples, "the record has no sample that is present and finite")
         return
      end if
      if (total > 0) then
         if (total > huge(0_int32)) stat = 1
         if (stat == 0) allocate (missing(0:n), stat=stat)
         if (stat /= 0) then
            call fatal_error(error, status%no_memory, "no memory for the count of the missing samples")
            return
         end if
      end if
      call offsets_of_blocks(n, pilot, sums, absent, mean)
      call write_phase(rate, mean, sums, absent, phase, missing, error, valid, progress)
   end subroutine integrate_rate

   !> Phases without the straight line through the first and the last, in units of rate times sample.
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

      bad = non_finite_count(angle)
      if (bad > 0) then
         write (text, "(i0)") bad
         call fatal_error(error, status%non_finite, trim(text)//" of the phases are not finite: a lost phase cannot be bridged")
         return
      end if
      n = size(angle, kind=int64) - 1
      allocate (phase(0:n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the phases")
         return
      end if
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

   !> Whether sample i is there: finite, and not marked missing.
   pure logical function present_sample(rate, i, valid)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> Its number, 1 <= i <= n
      integer(int64), intent(in) :: i
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      present_sample = ieee_is_finite(rate(i))
      if (present(valid)) present_sample = present_sample .and. valid(i) /= 0
   end function present_sample

   !> Sums of the blocks about a first guess of the mean, and how many samples each block lacks.
   subroutine sum_blocks(rate, sums, absent, pilot, valid)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> Sum of the present samples less the pilot: [blocks]
      real(dp), intent(out) :: sums(:)
      !> Missing samples: [blocks + 1], the last is 0
      integer(int64), intent(out) :: absent(:)
      !> A value near the mean
      real(dp), intent(out) :: pilot
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: n, b, first, last

      n = size(rate, kind=int64)
      absent(size(absent)) = 0
      call guess_mean(rate, pilot, valid)
      !$omp parallel do schedule(static) private(first, last) if (n >= parallel_from)
      do b = 1, size(sums, kind=int64)
         first = (b - 1)*block_length + 1
         last = min(n, b*block_length)
         if (present(valid)) then
            absent(b) = zeros(valid, first, last)
         else
            absent(b) = 0
         end if
         if (absent(b) == 0) absent(b) = non_finite_count(rate(first:last))
         if (absent(b) == 0) then
            sums(b) = plain_sum(rate(first:last), pilot)
         else
            call masked_sum(rate, first, last, pilot, sums(b), absent(b), valid)
         end if
      end do
      !$omp end parallel do
   end subroutine sum_blocks

   !> Number of zeros.
   pure integer(int64) function zeros(valid, first, last)
      !> Flags
      integer(int8), intent(in) :: valid(:)
      !> Range looked at
      integer(int64), intent(in) :: first, last

      zeros = count(valid(first:last) == 0, kind=int64)
   end function zeros

   !> The mean of some samples spread over the record.
   subroutine guess_mean(rate, pilot, valid)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> The guess, 0 if none of them is present
      real(dp), intent(out) :: pilot
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: i, step
      real(dp) :: seen

      pilot = 0
      seen = 0
      step = max(1_int64, size(rate, kind=int64)/pilot_samples)
      do i = 1, size(rate, kind=int64), step
         if (.not. present_sample(rate, i, valid)) cycle
         seen = seen + 1
         pilot = pilot + (rate(i) - pilot)/seen
      end do
   end subroutine guess_mean

   !> Number of values that are NaN or infinite, from the bits of the exponent (no floating-point operation).
   pure integer(int64) function non_finite_count(x)
      !> Values
      real(dp), intent(in), contiguous :: x(:)

      integer(int64) :: i

      non_finite_count = 0
      !$omp simd reduction(+:non_finite_count)
      do i = 1, size(x, kind=int64)
         non_finite_count = non_finite_count + shiftr(iand(shiftr(transfer(x(i), 0_int64), 52), 2047_int64) + 1_int64, 11)
      end do
   end function non_finite_count

   !> Sum of x - shift in four interleaved chains.
   pure real(dp) function plain_sum(x, shift)
      !> Values
      real(dp), intent(in), contiguous :: x(:)
      !> Taken off each
      real(dp), intent(in) :: shift

      integer(int64) :: i, quarter
      real(dp) :: s1, s2, s3, s4

      quarter = size(x, kind=int64)/4
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      !$omp simd reduction(+:s1, s2, s3, s4)
      do i = 1, quarter
         s1 = s1 + (x(i) - shift)
         s2 = s2 + (x(i + quarter) - shift)
         s3 = s3 + (x(i + 2*quarter) - shift)
         s4 = s4 + (x(i + 3*quarter) - shift)
      end do
      do i = 4*quarter + 1, size(x, kind=int64)
         s1 = s1 + (x(i) - shift)
      end do
      plain_sum = (s1 + s2) + (s3 + s4)
   end function plain_sum

   !> Sum of x - shift over the samples that are there.
   subroutine masked_sum(rate, first, last, shift, total, absent, valid)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> First and last sample
      integer(int64), intent(in) :: first, last
      !> Taken off each
      real(dp), intent(in) :: shift
      !> The sum
      real(dp), intent(out) :: total
      !> How many are not there
      integer(int64), intent(out) :: absent
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: i

      total = 0
      absent = 0
      do i = first, last
         if (present_sample(rate, i, valid)) then
            total = total + (rate(i) - shift)
         else
            absent = absent + 1
         end if
      end do
   end subroutine masked_sum

   !> Turns the sums of the blocks into the phase at their beginnings, and finds the mean.
   pure subroutine offsets_of_blocks(n, pilot, sums, absent, mean)
      !> Samples
      integer(int64), intent(in) :: n
      !> What was taken off each sample
      real(dp), intent(in) :: pilot
      !> In: sum of each block; out: phase before its first sample
      real(dp), intent(inout) :: sums(:)
      !> In: missing samples of each block; out: those before it: [blocks + 1]
      integer(int64), intent(inout) :: absent(:)
      !> The mean of the present samples, as a rounded number
      real(dp), intent(out) :: mean

      real(dp) :: high, low, rest, increment, before
      integer(int64) :: b, here, lost

      high = 0
      low = 0
      do b = 1, size(sums, kind=int64)
         call add_compensated(high, low, sums(b))
      end do
      mean = pilot + (high + low)/real(n - sum(absent), dp)
      rest = mean - pilot                               ! exactly what the blocks still have to lose
      high = 0
      low = 0
      lost = 0
      do b = 1, size(sums, kind=int64)
         before = high + low
         here = absent(b)
         increment = sums(b) - rest*real(min(n, b*block_length) - (b - 1)*block_length - here, dp)
         call add_compensated(high, low, increment)
         sums(b) = before
         absent(b) = lost
         lost = lost + here
      end do
      absent(size(absent)) = lost
   end subroutine offsets_of_blocks

   !> Adds a number to a sum of two parts (Neumaier 1974).
   pure subroutine add_compensated(high, low, value)
      !> The sum as computed, and what it lost
      real(dp), intent(inout) :: high, low
      !> What to add
      real(dp), intent(in) :: value

      real(dp) :: total

      total = high + value
      if (abs(high) >= abs(value)) then
         low = low + ((high - total) + value)
      else
         low = low + ((value - total) + high)
      end if
      high = total
   end subroutine add_compensated

   !> Writes the phase, four complete blocks at a time where nothing is missing.
   subroutine write_phase(rate, mean, offset, absent, phase, missing, error, valid, progress)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> Taken off each
      real(dp), intent(in) :: mean
      !> Phase before each block
      real(dp), intent(in), contiguous :: offset(:)
      !> Missing samples before each block: [blocks + 1]
      integer(int64), intent(in) :: absent(:)
      !> The result: [0:n]
      real(dp), intent(inout), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), allocatable, intent(inout) :: missing(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      integer(int64) :: n, blocks, from, step, group, b, first, lost

      n = size(rate, kind=int64)
      blocks = size(offset, kind=int64)
      phase(0) = 0
      if (allocated(missing)) missing(0) = 0
      step = max(blocks, 1_int64)
      if (present(progress)) step = report_blocks
      do from = 1, blocks, step
         call report_progress("Allan deviation", 0_int64, 0_int64, error, progress)
         if (allocated(error)) return
         !$omp parallel do schedule(static) private(b, first, lost) if (n >= parallel_from)
         do group = from, min(from + step - 1, blocks), 4
            first = (group - 1)*block_length
            if (first + 4*block_length <= n .and. .not. allocated(missing)) then
               call integrate_four(rate(first + 1:first + 4*block_length), mean, offset(group:group + 3), &
                  & phase(first + 1:first + 4*block_length))
               cycle
            end if
            do b = group, min(group + 3, blocks)
               lost = absent(b)
               call integrate_one(rate, (b - 1)*block_length + 1, min(n, b*block_length), mean, offset(b), lost, &
                  & absent(b + 1) == absent(b), phase, missing, valid)
            end do
         end do
         !$omp end parallel do
      end do
   end subroutine write_phase

   !> Four blocks side by side, so that the additions of one do not wait for each other.
   pure subroutine integrate_four(rate, mean, offset, phase)
      !> Samples of the four blocks
      real(dp), intent(in), contiguous :: rate(:)
      !> Taken off each
      real(dp), intent(in) :: mean
      !> Phase before each block
      real(dp), intent(in) :: offset(4)
      !> The result
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

   !> One block.
   subroutine integrate_one(rate, first, last, mean, offset, lost, complete, phase, missing, valid)
      !> Rate samples: [n]
      real(dp), intent(in), contiguous :: rate(:)
      !> First and last sample of the block
      integer(int64), intent(in) :: first, last
      !> Taken off each
      real(dp), intent(in) :: mean
      !> Phase before the block
      real(dp), intent(in) :: offset
      !> Missing samples before the block; after it on return
      integer(int64), intent(inout) :: lost
      !> Nothing is missing in the block
      logical, intent(in) :: complete
      !> The result: [0:n]
      real(dp), intent(inout), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), allocatable, intent(inout) :: missing(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: i
      real(dp) :: s

      s = 0
      do i = first, last
         if (complete) then
            s = s + (rate(i) - mean)
         else if (present_sample(rate, i, valid)) then
            s = s + (rate(i) - mean)
         else
            lost = lost + 1
         end if
         phase(i) = offset + s
         if (allocated(missing)) missing(i) = int(lost, int32)
      end do
   end subroutine integrate_one

end module gyroakf_allan_phase
