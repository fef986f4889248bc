! SPDX-License-Identifier: MIT
!> The first pass over a rate record: its mean, and its integral before each of the blocks that it
!> is cut into.
!>
!> The sums of the blocks are taken about a first guess of the mean and accumulated with
!> compensation. The blocks do not depend on the number of threads, and neither does any bit of the
!> result.
module gyroakf_allan_block_sums
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: block_sums_type, sum_blocks, present_sample, count_non_finite, block_length, &
      & parallel_from

   !> Samples in a block
   integer(int64), parameter :: block_length = 2048
   !> Records shorter than this are not worth a second thread
   integer(int64), parameter :: parallel_from = 200000
   !> Samples that a first guess of the mean looks at
   integer(int64), parameter :: pilot_samples = 1024

   !> What the pass gives
   type :: block_sums_type
      !> The mean of the present samples, as a rounded number
      real(dp) :: mean = 0.0_dp
      !> Integral of the rate less its mean before each block: [blocks]
      real(dp), allocatable :: offset(:)
      !> Missing samples before each block: [blocks + 1], the last one all of them
      integer(int64), allocatable :: absent(:)
   end type block_sums_type

contains

   !> Sums the blocks of a record.
   subroutine sum_blocks(rate, blocks, error, valid)
      !> Rate samples: [n], n >= 1
      real(dp), intent(in), contiguous :: rate(:)
      !> The sums
      type(block_sums_type), intent(out) :: blocks
      !> invalid_argument (lengths differ), too_few_samples (no sample at all), no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]; all present if absent
      integer(int8), intent(in), optional :: valid(:)

      integer(int64) :: n, b, number, first, last
      real(dp) :: pilot
      integer :: stat

      n = size(rate, kind=int64)
      if (present(valid)) then
         if (size(valid, kind=int64) /= n) then
            call fatal_error(error, status%invalid_argument, &
               & "rate and valid have different lengths")
            return
         end if
      end if
      number = (n + block_length - 1)/block_length
      allocate (blocks%offset(number), stat=stat)
      if (stat == 0) allocate (blocks%absent(number + 1), stat=stat)
      call check_memory(stat, "the integral of the record", error)
      if (allocated(error)) return
      call guess_mean(rate, pilot, valid)
      associate (sums => blocks%offset, absent => blocks%absent)
         absent(number + 1) = 0
         !$omp parallel do schedule(static) private(first, last) if (n >= parallel_from)
         do b = 1, number
            first = (b - 1)*block_length + 1
            last = min(n, b*block_length)
            absent(b) = 0
            if (present(valid)) absent(b) = count(valid(first:last) == 0, kind=int64)
            if (absent(b) == 0) absent(b) = non_finite_count(rate(first:last))
            if (absent(b) == 0) then
               sums(b) = plain_sum(rate(first:last), pilot)
            else
               call masked_sum(rate, first, last, pilot, sums(b), absent(b), valid)
            end if
         end do
         !$omp end parallel do
         if (sum(absent) >= n) then
            call fatal_error(error, status%too_few_samples, &
               & "the record has no sample that is present and finite")
            return
         end if
         call accumulate(n, pilot, sums, absent, blocks%mean)
      end associate
   end subroutine sum_blocks

   !> Whether sample i is there: finite, and not marked missing.
   pure logical function present_sample(rate, i, valid)
      real(dp), intent(in), contiguous :: rate(:)
      integer(int64), intent(in) :: i
      integer(int8), intent(in), optional :: valid(:)

      present_sample = ieee_is_finite(rate(i))
      if (present(valid)) present_sample = present_sample .and. valid(i) /= 0
   end function present_sample

   !> The mean of some samples spread over the record, 0 if none of them is present.
   subroutine guess_mean(rate, pilot, valid)
      real(dp), intent(in), contiguous :: rate(:)
      real(dp), intent(out) :: pilot
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i
      real(dp) :: seen

      pilot = 0
      seen = 0
      do i = 1, size(rate, kind=int64), max(1_int64, size(rate, kind=int64)/pilot_samples)
         if (.not. present_sample(rate, i, valid)) cycle
         seen = seen + 1
         pilot = pilot + (rate(i) - pilot)/seen
      end do
   end subroutine guess_mean

   !> Number of values that are NaN or infinite.
   integer(int64) function count_non_finite(x) result(counted)
      !> Values
      real(dp), intent(in), contiguous :: x(:)
      integer(int64) :: first, n

      counted = 0
      n = size(x, kind=int64)
      !$omp parallel do schedule(static) reduction(+:counted) if (n >= parallel_from)
      do first = 1, n, block_length
         counted = counted + non_finite_count(x(first:min(first + block_length - 1, n)))
      end do
      !$omp end parallel do
   end function count_non_finite

   !> The same on one thread, from the bits of the exponent (no floating-point operation).
   pure integer(int64) function non_finite_count(x)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64) :: i

      non_finite_count = 0
      !$omp simd reduction(+:non_finite_count)
      do i = 1, size(x, kind=int64)
         non_finite_count = non_finite_count &
            & + shiftr(iand(shiftr(transfer(x(i), 0_int64), 52), 2047_int64) + 1_int64, 11)
      end do
   end function non_finite_count

   !> Sum of x - shift in four interleaved chains.
   pure real(dp) function plain_sum(x, shift)
      real(dp), intent(in), contiguous :: x(:)
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

   !> Sum of x - shift over the samples of a block that are there, and how many are not.
   pure subroutine masked_sum(rate, first, last, shift, total, absent, valid)
      real(dp), intent(in), contiguous :: rate(:)
      integer(int64), intent(in) :: first, last
      real(dp), intent(in) :: shift
      real(dp), intent(out) :: total
      integer(int64), intent(out) :: absent
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

   !> Finds the mean, and turns sums about the pilot and numbers of missing samples of each block
   !> into those about the mean of all blocks before it.
   pure subroutine accumulate(n, pilot, sums, absent, mean)
      integer(int64), intent(in) :: n
      real(dp), intent(in) :: pilot
      real(dp), intent(inout) :: sums(:)
      integer(int64), intent(inout) :: absent(:)
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
   end subroutine accumulate

   !> Adds a number to a sum of two parts, as computed and what that lost (Neumaier 1974).
   pure subroutine add_compensated(high, low, value)
      real(dp), intent(inout) :: high, low
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

end module gyroakf_allan_block_sums
