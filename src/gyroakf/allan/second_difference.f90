! SPDX-License-Identifier: MIT
!> Sums of squared second differences of the phase: the work of the overlapping Allan variance.
!>
!> The loop over the record runs in blocks that stay in the cache while every averaging factor is
!> applied to them, so that factors share what was fetched (of octaves, three in four streams). Partial sums
!> belong to fixed stretches of the record: the result does not depend on the number of threads.
module gyroakf_allan_second_difference
   use gyroakf_kinds, only : dp, int32, int64
   implicit none (type, external)
   private
   public :: sum_second_differences, sum_gapped_differences, gap_sums_type

   !> Terms of one factor that are summed before the next factor has its turn
   integer(int64), parameter :: block_length = 2048
   !> Stretches of the record at most
   integer(int64), parameter :: stretches_max = 64
   !> Averaging factors that are handled in one pass
   integer, parameter :: batch = 256
   !> Terms times factors below which one thread is quicker
   integer(int64), parameter :: parallel_from = 2000000

   !> What a record with gaps gives for one averaging factor
   type :: gap_sums_type
      !> Sum of the squared differences of neighbouring window means
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
   subroutine sum_second_differences(phase, m, sums)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums: [size(m)]
      real(dp), intent(out) :: sums(:)

      real(dp) :: part(batch, stretches_max)
      integer(int64) :: n, stretches, s
      integer :: first, last, i

      n = ubound(phase, 1, kind=int64)
      stretches = stretch_count(n)
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
         do s = 1, stretches
            call one_stretch(phase, m(first:last), stretch_begin(s, stretches, n), stretch_begin(s + 1, stretches, n), part(:, s))
         end do
         !$omp end parallel do
         do i = first, last
            sums(i) = sum(part(i - first + 1, :stretches))
         end do
      end do
   end subroutine sum_second_differences

   !> All factors over one stretch of the record.
   subroutine one_stretch(phase, m, begin, end_before, part)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> First k of the stretch, and of the next one
      integer(int64), intent(in) :: begin, end_before
      !> Sums: [>= size(m)]
      real(dp), intent(inout) :: part(:)

      integer(int64) :: n, k, terms, done
      integer :: i, step

      n = ubound(phase, 1, kind=int64)
      part = 0
      do k = begin, end_before - 1, block_length
         i = 1
         do while (i <= size(m))
            terms = min(end_before, k + block_length, n - 2*m(i) + 1) - k
            done = 0
            step = 1
            if (i < size(m)) then
               if (m(i + 1) == 2*m(i)) then                  ! an octave shares three of its four streams
                  done = max(0_int64, min(end_before, k + block_length, n - 4*m(i) + 1) - k)
                  call add_octave(phase(k:k + done - 1), phase(k + m(i):k + m(i) + done - 1), &
                     & phase(k + 2*m(i):k + 2*m(i) + done - 1), phase(k + 4*m(i):k + 4*m(i) + done - 1), part(i), part(i + 1))
                  step = 2
               end if
            end if
            if (terms > done) part(i) = part(i) + squares(phase(k + done:k + terms - 1), &
               & phase(k + m(i) + done:k + m(i) + terms - 1), phase(k + 2*m(i) + done:k + 2*m(i) + terms - 1))
            i = i + step
         end do
      end do
   end subroutine one_stretch

   !> Adds the sums of (c - 2 b + a)**2 and (d - 2 c + a)**2, two chains each.
   pure subroutine add_octave(a, b, c, d, sum1, sum2)
      !> Phase at k, k + m, k + 2m, k + 4m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:), d(:)
      !> Sums of the factors m and 2m, to add to
      real(dp), intent(inout) :: sum1, sum2

      integer(int64) :: i, n, q
      real(dp) :: s1, s2, t1, t2, p, r, u, v

      n = size(a, kind=int64)
      q = n/2
      s1 = 0
      s2 = 0
      t1 = 0
      t2 = 0
      !$omp simd reduction(+:s1, s2, t1, t2) private(p, r, u, v)
      do i = 1, q
         p = b(i) - a(i)
         r = c(i) - b(i)
         s1 = s1 + (r - p)**2
         t1 = t1 + ((d(i) - c(i)) - (r + p))**2
         u = b(i + q) - a(i + q)
         v = c(i + q) - b(i + q)
         s2 = s2 + (v - u)**2
         t2 = t2 + ((d(i + q) - c(i + q)) - (v + u))**2
      end do
      do i = 2*q + 1, n
         s1 = s1 + ((c(i) - b(i)) - (b(i) - a(i)))**2
         t1 = t1 + ((d(i) - c(i)) - (c(i) - a(i)))**2
      end do
      sum1 = sum1 + (s1 + s2)
      sum2 = sum2 + (t1 + t2)
   end subroutine add_octave

   !> Sum of (c - 2 b + a)**2 in four chains.
   pure real(dp) function squares(a, b, c)
      !> Phase at k, k + m, k + 2m: [terms]
      real(dp), intent(in), contiguous :: a(:), b(:), c(:)

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
         s1 = s1 + ((c(i) - b(i)) - (b(i) - a(i)))**2
         s2 = s2 + ((c(i + q) - b(i + q)) - (b(i + q) - a(i + q)))**2
         s3 = s3 + ((c(i + 2*q) - b(i + 2*q)) - (b(i + 2*q) - a(i + 2*q)))**2
         s4 = s4 + ((c(i + 3*q) - b(i + 3*q)) - (b(i + 3*q) - a(i + 3*q)))**2
      end do
      do i = 4*q + 1, n
         s1 = s1 + ((c(i) - b(i)) - (b(i) - a(i)))**2
      end do
      squares = (s1 + s2) + (s3 + s4)
   end function squares

   !> The same for a record with missing samples: differences of the means of the present samples of two windows.
   subroutine sum_gapped_differences(phase, missing, m, min_coverage, sums)
      !> Phase, to which missing samples added nothing: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present, > 0, <= 1
      real(dp), intent(in) :: min_coverage
      !> The sums: [size(m)]
      type(gap_sums_type), intent(out) :: sums(:)

      type(gap_sums_type) :: part(batch, stretches_max)
      integer(int64) :: n, stretches, s
      integer :: first, last, i

      n = ubound(phase, 1, kind=int64)
      stretches = stretch_count(n)
      do first = 1, size(m), batch
         last = min(first + batch - 1, size(m))
         !$omp parallel do schedule(dynamic) if (n*(last - first + 1) >= parallel_from)
         do s = 1, stretches
            call one_gapped_stretch(phase, missing, m(first:last), min_coverage, stretch_begin(s, stretches, n), &
               & stretch_begin(s + 1, stretches, n), part(:, s))
         end do
         !$omp end parallel do
         do i = first, last
            sums(i)%squares = sum(part(i - first + 1, :stretches)%squares)
            sums(i)%inflation = sum(part(i - first + 1, :stretches)%inflation)
            sums(i)%terms = sum(part(i - first + 1, :stretches)%terms)
         end do
      end do
   end subroutine sum_gapped_differences

   !> All factors over one stretch of a record with gaps.
   subroutine one_gapped_stretch(phase, missing, m, min_coverage, begin, end_before, part)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Missing samples so far: [0:n]
      integer(int32), intent(in), contiguous :: missing(0:)
      !> Averaging factors
      integer(int64), intent(in) :: m(:)
      !> Share of a window that must be present
      real(dp), intent(in) :: min_coverage
      !> First k of the stretch, and of the next one
      integer(int64), intent(in) :: begin, end_before
      !> Sums: [>= size(m)]
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
            allowed = min(int((1 - min_coverage)*real(m(i), dp) + 1e-9_dp, int64), m(i) - 1, int(huge(0_int32), int64))
            k1 = k + m(i)
            k2 = k1 + m(i)
            last = terms - 1
            call gapped_squares(m(i), int(allowed, int32), phase(k:k + last), phase(k1:k1 + last), phase(k2:k2 + last), &
               & missing(k:k + last), missing(k1:k1 + last), missing(k2:k2 + last), part(i))
         end do
      end do
   end subroutine one_gapped_stretch

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

   !> Stretches into which a record is cut.
   pure integer(int64) function stretch_count(n)
      !> Samples
      integer(int64), intent(in) :: n

      stretch_count = max(1_int64, min(stretches_max, n/(8*block_length)))
   end function stretch_count

   !> First term of a stretch; of the one after the last: n.
   pure integer(int64) function stretch_begin(s, stretches, n)
      !> Its number, from 1
      integer(int64), intent(in) :: s
      !> How many there are
      integer(int64), intent(in) :: stretches
      !> Samples
      integer(int64), intent(in) :: n

      integer(int64) :: blocks

      blocks = (n + block_length - 1)/block_length
      stretch_begin = min(n, block_length*((s - 1)*(blocks/stretches) + min(s - 1, mod(blocks, stretches))))
   end function stretch_begin

end module gyroakf_allan_second_difference
