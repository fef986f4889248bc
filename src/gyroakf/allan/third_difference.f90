! SPDX-License-Identifier: MIT
!> Sums of squared third differences of the phase: the work of the overlapping Hadamard variance.
!>
!> Blocks stay in the cache while every averaging factor is applied to them; partial sums belong to fixed stretches
!> of the record, so that the result does not depend on the number of threads.
module gyroakf_allan_third_difference
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_threads, only : thread_count
   implicit none (type, external)
   private
   public :: sum_third_differences

   !> Terms of one factor that are summed before the next factor has its turn
   integer(int64), parameter :: block_length = 2048
   !> Blocks of a stretch at least, and stretches at most
   integer(int64), parameter :: blocks_min = 8, stretches_max = 64
   !> Averaging factors that are handled in one pass
   integer, parameter :: batch = 256
   !> Terms times factors below which one thread is quicker
   integer(int64), parameter :: parallel_from = 2000000

contains

   !> For each m the sum over k = 0 .. n - 3m of (x(k+3m) - 3 x(k+2m) + 3 x(k+m) - x(k))**2.
   subroutine sum_third_differences(phase, m, sums, error, progress)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/3: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      real(dp) :: part(batch, stretches_max)
      integer(int64) :: n, stretches, blocks, s, group, from
      integer :: first, last, i

      n = ubound(phase, 1, kind=int64)
      blocks = n/block_length + 1
      stretches = max(1_int64, min(stretches_max, blocks/blocks_min))
      group = stretches
      if (present(progress)) group = 2*thread_count()
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         do from = 1, stretches, group
            call tell_progress("Allan deviation", n*(first - 1) + (from - 1)*(n/stretches)*(last - first + 1), n*size(m), error, &
               & progress)
            if (allocated(error)) return
            !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
            do s = from, min(stretches, from + group - 1)
               call one_stretch(phase, m(first:last), block_length*((s - 1)*blocks/stretches), &
                  & block_length*(s*blocks/stretches), part(:, s))
            end do
            !$omp end parallel do
         end do
         do i = first, last
            sums(i) = sum(part(i - first + 1, :stretches))
         end do
      end do
   end subroutine sum_third_differences

   !> All factors over one stretch of the record.
   pure subroutine one_stretch(phase, m, begin, end_before, part)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> First k of the stretch, and of the next one
      integer(int64), intent(in) :: begin, end_before
      !> Sums, [>= size(m)]
      real(dp), intent(inout) :: part(:)

      integer(int64) :: n, k, last
      integer :: i

      n = ubound(phase, 1, kind=int64)
      part = 0
      do k = begin, end_before - 1, block_length
         do i = 1, size(m)
            last = min(end_before, k + block_length, n - 3*m(i) + 1) - 1
            if (last < k) cycle
            part(i) = part(i) + squares(phase(k:last), phase(k + m(i):last + m(i)), phase(k + 2*m(i):last + 2*m(i)), &
               & phase(k + 3*m(i):last + 3*m(i)))
         end do
      end do
   end subroutine one_stretch

   !> Sum of (d - 3 c + 3 b - a)**2 in four chains.
   pure real(dp) function squares(a, b, c, d)
      !> Phase at k, k + m, k + 2m, k + 3m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:), d(:)

      integer(int64) :: i, n, q
      real(dp) :: s1, s2, s3, s4

      n = size(a, kind=int64)
      q = n/4
      s1 = 0
      s2 = 0
      s3 = 0
      s4 = 0
      !$omp simd reduction(+:s1, s2, s3, s4)
      do i = 1, q
         s1 = s1 + ((d(i) - a(i)) - 3*(c(i) - b(i)))**2
         s2 = s2 + ((d(i + q) - a(i + q)) - 3*(c(i + q) - b(i + q)))**2
         s3 = s3 + ((d(i + 2*q) - a(i + 2*q)) - 3*(c(i + 2*q) - b(i + 2*q)))**2
         s4 = s4 + ((d(i + 3*q) - a(i + 3*q)) - 3*(c(i + 3*q) - b(i + 3*q)))**2
      end do
      do i = 4*q + 1, n
         s1 = s1 + ((d(i) - a(i)) - 3*(c(i) - b(i)))**2
      end do
      squares = (s1 + s2) + (s3 + s4)
   end function squares

end module gyroakf_allan_third_difference
