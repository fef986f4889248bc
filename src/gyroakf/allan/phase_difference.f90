! SPDX-License-Identifier: MIT
!> Sums of squared second and third differences of the phase: the work of the overlapping Allan and
!> Hadamard variances.
!>
!> The terms are taken in blocks. Short factors run over the record together: a block stays in the
!> cache while each of them is applied to it. A long factor m visits the blocks k, k + m, k + 2m ...
!> one after the other, so that the phases of a term come from the memory once. Factors that double,
!> as octaves do, are taken four at a time. Partial sums belong to fixed parts of the record: the
!> result does not depend on the number of threads.
module gyroakf_allan_phase_difference
   use gyroakf_threads, only : thread_count
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_allan_window_difference, only : squared_differences
   implicit none (type, external)
   private
   public :: sum_phase_differences

   !> Terms of one factor that are summed before the next factor has its turn
   integer(int64), parameter :: block_length = 2048
   !> Longest factor of which a block and the phases 2m further on stay in the cache together
   integer(int64), parameter :: short_max = 32768
   !> Parts of the record at most
   integer(int64), parameter :: parts_max = 64
   !> Averaging factors that are handled in one pass
   integer, parameter :: batch = 256
   !> Terms times factors below which one thread is quicker
   integer(int64), parameter :: parallel_from = 2000000

contains

   !> For each m the sum over k of (x(k+2m) - 2 x(k+m) + x(k))**2, or of
   !> (x(k+3m) - 3 x(k+2m) + 3 x(k+m) - x(k))**2.
   subroutine sum_phase_differences(phase, m, order, sums, error, progress)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/order: [any number]
      integer(int64), intent(in) :: m(:)
      !> Order of the difference, 2 or 3
      integer, intent(in) :: order
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)
      !> cancelled, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      real(dp), allocatable :: part(:, :)
      integer(int64) :: n, parts, s, group, from
      integer :: first, last, i, stat

      n = ubound(phase, 1, kind=int64)
      parts = max(1_int64, min(parts_max, n/(8*block_length)))
      allocate (part(min(batch, size(m)), parts), stat=stat)
      call check_memory(stat, "the sums of a deviation", error)
      if (allocated(error)) return
      group = parts
      if (present(progress)) group = 2*thread_count()
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         do from = 1, parts, group
            call report_progress("Allan deviation", n*(first - 1) &
               & + (from - 1)*(n/parts)*(last - first + 1), n*size(m), error, progress)
            if (allocated(error)) return
            !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
            do s = from, min(parts, from + group - 1)
               call one_part(phase, m(first:last), order, s, parts, part(:last - first + 1, s))
            end do
            !$omp end parallel do
         end do
         do i = first, last
            sums(i) = sum(part(i - first + 1, :parts))
         end do
      end do
   end subroutine sum_phase_differences

   !> All factors, over one part of the record.
   pure subroutine one_part(phase, m, order, s, parts, sums)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m(:)
      integer, intent(in) :: order
      !> Number of the part, from 1, and how many there are
      integer(int64), intent(in) :: s, parts
      real(dp), intent(out) :: sums(:)

      integer(int64) :: n, k, row, end_before
      integer :: i, next

      n = ubound(phase, 1, kind=int64)
      sums = 0
      next = count(m <= short_max) + 1
      end_before = part_begin(s + 1, parts, n)
      do k = part_begin(s, parts, n), end_before - 1, block_length
         call one_block(phase, m(:next - 1), order, k, min(end_before, k + block_length) - 1, &
            & sums(:next - 1))
      end do
      do while (next <= size(m))
         i = next
         next = i + octave_count(m(i:), n)
         end_before = part_begin(s + 1, parts, m(i))
         do k = part_begin(s, parts, m(i)), end_before - 1, block_length
            do row = 0, n - k, m(i)
               call one_block(phase, m(i:next - 1), order, row + k, row &
                  & + min(end_before, k + block_length) - 1, sums(i:next - 1))
            end do
         end do
      end do
   end subroutine one_part

   !> Adds the terms of one block for every factor.
   pure subroutine one_block(phase, m, order, first, last, sums)
      real(dp), intent(in), contiguous :: phase(0:)
      integer(int64), intent(in) :: m(:)
      integer, intent(in) :: order
      !> First and last k; those of which a factor has no term are left out
      integer(int64), intent(in) :: first, last
      real(dp), intent(inout) :: sums(:)

      integer(int64) :: n, last_term
      integer :: i, octaves

      n = ubound(phase, 1, kind=int64)
      i = 1
      do while (i <= size(m))
         last_term = min(last, n - order*m(i))
         octaves = 1
         if (order == 2) octaves = octave_count(m(i:), n - last_term)
         if (octaves >= 3) then
            call add_octaves(phase, first, last_term, m(i), sums(i:i + octaves - 1))
         else
            octaves = 1
            sums(i) = sums(i) + squared_differences(phase(first:last_term + order*m(i)), m(i), &
               & order)
         end if
         i = i + octaves
      end do
   end subroutine one_block

   !> Leading factors, four at most, of which each is twice the one before and spans no more than
   !> there is; at least one.
   pure integer function octave_count(m, span_max)
      integer(int64), intent(in) :: m(:)
      !> Phases that follow the last term
      integer(int64), intent(in) :: span_max

      octave_count = 1
      do while (octave_count < min(4, size(m)))
         if (m(octave_count + 1) /= 2*m(octave_count) .or. 2*m(octave_count + 1) > span_max) exit
         octave_count = octave_count + 1
      end do
   end function octave_count

   !> Adds the sums over k = first .. last of (x(k+2j) - 2 x(k+j) + x(k))**2 for j = m, 2m, 4m and
   !> 8m.
   !>
   !> Four factors take six streams from the memory instead of twelve, and share the differences to
   !> x(k).
   pure subroutine add_octaves(phase, first, last, m, sums)
      real(dp), intent(in), contiguous :: phase(0:)
      !> First and last term, and the smallest factor
      integer(int64), intent(in) :: first, last, m
      !> Sums to add to: [3 or 4]
      real(dp), intent(inout) :: sums(:)

      integer(int64) :: k, m16
      real(dp) :: p1, p2, p4, p8, p16, s1, s2, s4, s8

      m16 = merge(16*m, 8*m, size(sums) == 4)
      s1 = 0
      s2 = 0
      s4 = 0
      s8 = 0
      !$omp simd reduction(+:s1, s2, s4, s8) private(p1, p2, p4, p8, p16)
      do k = first, last
         p1 = phase(k + m) - phase(k)
         p2 = phase(k + 2*m) - phase(k)
         p4 = phase(k + 4*m) - phase(k)
         p8 = phase(k + 8*m) - phase(k)
         p16 = phase(k + m16) - phase(k)
         s1 = s1 + (p2 - 2*p1)**2
         s2 = s2 + (p4 - 2*p2)**2
         s4 = s4 + (p8 - 2*p4)**2
         s8 = s8 + (p16 - 2*p8)**2
      end do
      sums(:3) = sums(:3) + [s1, s2, s4]
      if (size(sums) == 4) sums(4) = sums(4) + s8
   end subroutine add_octaves

   !> First term of a part; of the one after the last: n.
   pure integer(int64) function part_begin(s, parts, n)
      integer(int64), intent(in) :: s, parts, n

      integer(int64) :: blocks

      blocks = (n + block_length - 1)/block_length
      part_begin = min(n, block_length*((s - 1)*(blocks/parts) + min(s - 1, mod(blocks, parts))))
   end function part_begin

end module gyroakf_allan_phase_difference
