! SPDX-License-Identifier: MIT
!> Sums of squared second differences of the phase: the work of the overlapping Allan variance.
!>
!> The terms are taken in blocks. Short factors run over the record together: a block stays in the cache while each of
!> them is applied to it. A long factor m visits the blocks k, k + m, k + 2m ... one after the other, so that the three phases
!> of a term come from the memory once instead of three times. Factors that double, as octaves do, are taken four at a time.
!> Partial sums belong to fixed parts of the record: the result does not depend on the number of threads.
module gyroakf_allan_second_difference
   use gyroakf_threads, only : thread_count
   use gyroakf_kinds, only : dp, int32, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   implicit none (type, external)
   private
   public :: sum_second_differences, sum_gapped_differences, gap_sums_type

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

   !> What a record with gaps gives for one averaging factor
   type :: gap_sums_type
      !> Sum of the squared differences of neighboring window means
      real(dp) :: squares = 0.0_dp
      !> Sum over the terms of 1/c_1 + 1/c_2 - 2/m, c the present samples of each window
      real(dp) :: inflation = 0.0_dp
      !> Terms whose two windows are complete enough
      integer(int64) :: terms = 0
      !> Total variance: their expectations in white noise, relative to that of a term that sees no end of the record
      real(dp) :: weight = 0.0_dp
   end type gap_sums_type

contains

   !> For each m the sum over k = 0 .. n - 2m of (x(k+2m) - 2 x(k+m) + x(k))**2.
   subroutine sum_second_differences(phase, m, sums, error, progress)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out), optional :: error
      !> Progress callback, only together with `error`; may cancel
      class(progress_type), intent(inout), optional :: progress

      real(dp) :: part(batch, parts_max)
      type(error_type), allocatable :: cancelled
      integer(int64) :: n, parts, s, group, from
      integer :: first, last, i

      n = ubound(phase, 1, kind=int64)
      parts = part_count(n)
      group = parts
      if (present(progress)) group = 2*thread_count()
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         do from = 1, parts, group
            call report(from, parts, n, m, first, last, cancelled, progress)
            if (allocated(cancelled)) then
               call move_alloc(cancelled, error)
               return
            end if
            !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
            do s = from, min(parts, from + group - 1)
               call one_part(phase, m(first:last), s, parts, part(:last - first + 1, s))
            end do
            !$omp end parallel do
         end do
         do i = first, last
            sums(i) = sum(part(i - first + 1, :parts))
         end do
      end do
   end subroutine sum_second_differences

   !> Reports progress: some parts of some factors are done.
   subroutine report(from, parts, n, m, first, last, error, progress)
      !> Next part, all parts, samples
      integer(int64), intent(in) :: from, parts, n
      !> All factors
      integer(int64), intent(in) :: m(:)
      !> Those that are worked on
      integer, intent(in) :: first, last
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      call tell_progress("Allan deviation", n*(first - 1) + (from - 1)*(n/parts)*(last - first + 1), n*size(m), error, progress)
   end subroutine report

   !> All factors, over one part of the record.
   pure subroutine one_part(phase, m, s, parts, sums)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Number of the part, from 1, and how many there are
      integer(int64), intent(in) :: s, parts
      !> Sums, [size(m)]
      real(dp), intent(out) :: sums(:)

      integer(int64) :: n, k, row, end_before
      integer :: i, next

      n = ubound(phase, 1, kind=int64)
      sums = 0
      next = count(m <= short_max) + 1
      end_before = part_begin(s + 1, parts, n)
      do k = part_begin(s, parts, n), end_before - 1, block_length
         call one_block(phase, m(:next - 1), k, min(end_before, k + block_length) - 1, sums(:next - 1))
      end do
      do while (next <= size(m))
         i = next
         next = i + octave_count(m(i:), n)
         end_before = part_begin(s + 1, parts, m(i))
         do k = part_begin(s, parts, m(i)), end_before - 1, block_length
            do row = 0, n - k, m(i)
               call one_block(phase, m(i:next - 1), row + k, row + min(end_before, k + block_length) - 1, sums(i:next - 1))
            end do
         end do
      end do
   end subroutine one_part

   !> Adds the terms of one block for every factor.
   pure subroutine one_block(phase, m, first, last, sums)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> First and last k; those of which a factor has no term are left out
      integer(int64), intent(in) :: first, last
      !> Sums to add to: [size(m)]
      real(dp), intent(inout) :: sums(:)

      integer(int64) :: n, last_term
      integer :: i, octaves

      n = ubound(phase, 1, kind=int64)
      i = 1
      do while (i <= size(m))
         last_term = min(last, n - 2*m(i))
         octaves = octave_count(m(i:), n - last_term)
         if (octaves >= 3) then
            call add_octaves(phase, first, last_term, m(i), sums(i:i + octaves - 1))
         else
            octaves = 1
            sums(i) = sums(i) + squares(phase, first, last_term, m(i))
         end if
         i = i + octaves
      end do
   end subroutine one_block

   !> Leading factors, four at most, of which each is twice the one before and spans no more than there is; at least one.
   pure integer function octave_count(m, span_max)
      !> Averaging factors: [>= 1]
      integer(int64), intent(in) :: m(:)
      !> Phases that follow the last term
      integer(int64), intent(in) :: span_max

      octave_count = 1
      do while (octave_count < min(4, size(m)))
         if (m(octave_count + 1) /= 2*m(octave_count) .or. 2*m(octave_count + 1) > span_max) exit
         octave_count = octave_count + 1
      end do
   end function octave_count

   !> Adds the sums over k = first .. last of (x(k+2j) - 2 x(k+j) + x(k))**2 for j = m, 2m, 4m and 8m.
   !>
   !> Four factors take six streams from the memory instead of twelve, and share the differences to x(k).
   pure subroutine add_octaves(phase, first, last, m, sums)
      !> Phase: [0:n]
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

   !> The sum over k = first .. last of (x(k+2m) - 2 x(k+m) + x(k))**2, 0 without terms.
   pure real(dp) function squares(phase, first, last, m)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> First and last term, and the factor
      integer(int64), intent(in) :: first, last, m

      integer(int64) :: k

      squares = 0
      !$omp simd reduction(+:squares)
      do k = first, last
         squares = squares + ((phase(k + 2*m) - phase(k + m)) - (phase(k + m) - phase(k)))**2
      end do
   end function squares

   !> The same for a record with missing samples: differences of the means of the present samples of two windows.
   subroutine sum_gapped_differences(phase, missing, m, coverage, sums, error, progress)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present, > 0, <= 1: [size(m)]
      real(dp), intent(in) :: coverage(:)
      !> The sums: [size(m)]
      type(gap_sums_type), intent(out) :: sums(:)
      !> cancelled
      type(error_type), allocatable, intent(out), optional :: error
      !> Progress callback, only together with `error`; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(gap_sums_type) :: part(batch, parts_max)
      type(error_type), allocatable :: cancelled
      integer(int64) :: n, parts, s, group, from
      integer :: first, last, i

      n = ubound(phase, 1, kind=int64)
      parts = part_count(n)
      group = parts
      if (present(progress)) group = 2*thread_count()
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         do from = 1, parts, group
            call report(from, parts, n, m, first, last, cancelled, progress)
            if (allocated(cancelled)) then
               call move_alloc(cancelled, error)
               return
            end if
            !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
            do s = from, min(parts, from + group - 1)
               call one_gapped_part(phase, missing, m(first:last), coverage(first:last), part_begin(s, parts, n), &
                  & part_begin(s + 1, parts, n), part(:, s))
            end do
            !$omp end parallel do
         end do
         do i = first, last
            sums(i)%squares = sum(part(i - first + 1, :parts)%squares)
            sums(i)%inflation = sum(part(i - first + 1, :parts)%inflation)
            sums(i)%terms = sum(part(i - first + 1, :parts)%terms)
         end do
      end do
   end subroutine sum_gapped_differences

   !> All factors over one part of a record with gaps.
   subroutine one_gapped_part(phase, missing, m, coverage, begin, end_before, part)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present: [size(m)]
      real(dp), intent(in) :: coverage(:)
      !> First k of the part, and of the next one
      integer(int64), intent(in) :: begin, end_before
      !> Sums, [>= size(m)]
      type(gap_sums_type), intent(inout) :: part(:)

      integer(int64) :: n, k, k1, k2, terms, last, allowed
      integer :: i

      n = ubound(phase, 1, kind=int64)
      do i = 1, size(part)
         part(i) = gap_sums_type()
      end do
      do k = begin, end_before - 1, block_length
         do i = 1, size(m)
            terms = min(end_before, k + block_length, n - 2*m(i) + 1) - k
            if (terms <= 0) cycle
            allowed = min(int((1 - coverage(i))*real(m(i), dp) + 1e-9_dp, int64), m(i) - 1, int(huge(0_int32), int64))
            k1 = k + m(i)
            k2 = k1 + m(i)
            last = terms - 1
            call gapped_squares(m(i), int(allowed, int32), phase(k:k + last), phase(k1:k1 + last), phase(k2:k2 + last), &
               & missing(k:k + last), missing(k1:k1 + last), missing(k2:k2 + last), part(i))
         end do
      end do
   end subroutine one_gapped_part

   !> Adds the terms whose two windows lack at most `allowed` samples each.
   pure subroutine gapped_squares(m, allowed, a, b, c, ga, gb, gc, sums)
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Missing samples that a window may have, < m
      integer(int32), intent(in) :: allowed
      !> Phase at k, k + m, k + 2m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:)
      !> Missing samples up to there: [terms]
      integer(int32), intent(in), contiguous :: ga(:), gb(:), gc(:)
      !> Sums to add to
      type(gap_sums_type), intent(inout) :: sums

      integer(int64) :: i
      integer(int32) :: lost1, lost2, terms
      real(dp) :: length, counts, both, n1, n2, squares, inverse, z

      length = real(m, dp)
      squares = 0
      inverse = 0
      terms = 0
      !$omp simd reduction(+:squares, inverse, terms) private(lost1, lost2, n1, n2, both, z, counts)
      do i = 1, size(a, kind=int64)
         lost1 = gb(i) - ga(i)
         lost2 = gc(i) - gb(i)
         counts = merge(1.0_dp, 0.0_dp, max(lost1, lost2) <= allowed)
         n1 = length - min(lost1, allowed)
         n2 = length - min(lost2, allowed)
         both = counts/(n1*n2)
         z = ((c(i) - b(i))*n1 - (b(i) - a(i))*n2)*both
         squares = squares + z**2
         inverse = inverse + (n1 + n2)*both
         terms = terms + merge(1_int32, 0_int32, max(lost1, lost2) <= allowed)
      end do
      sums%squares = sums%squares + squares
      sums%terms = sums%terms + terms
      sums%inflation = sums%inflation + (inverse - 2*real(terms, dp)/length)
   end subroutine gapped_squares

   !> Parts into which a record is cut.
   pure integer(int64) function part_count(n)
      !> Samples
      integer(int64), intent(in) :: n

      part_count = max(1_int64, min(parts_max, n/(8*block_length)))
   end function part_count

   !> First term of a part; of the one after the last: n.
   pure integer(int64) function part_begin(s, parts, n)
      !> Its number, from 1
      integer(int64), intent(in) :: s
      !> How many there are
      integer(int64), intent(in) :: parts
      !> Samples
      integer(int64), intent(in) :: n

      integer(int64) :: blocks

      blocks = (n + block_length - 1)/block_length
      part_begin = min(n, block_length*((s - 1)*(blocks/parts) + min(s - 1, mod(blocks, parts))))
   end function part_begin

end module gyroakf_allan_second_difference
