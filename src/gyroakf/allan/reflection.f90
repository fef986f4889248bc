! SPDX-License-Identifier: MIT
!> The terms that the total variance adds to the overlapping Allan variance.
!>
!> The phase is continued beyond both ends by odd reflection, x(-j) = 2 x(0) - x(j) and x(n+j) = 2 x(n) - x(n-j). The second
!> differences inside the record are those of the overlapping variance; only the m - 1 at each end see the reflection, and
!> they are found by index arithmetic, without the extended series.
!> Source: C. A. Greenhall, D. A. Howe, D. B. Percival, "Total variance, an estimator of long-term frequency
!> stability", IEEE Trans. UFFC 46 (1999) 1183-1191.
module gyroakf_allan_reflection
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: add_reflected_differences

   !> Terms of a partial sum, and how many of these run in a batch
   integer(int64), parameter :: block_length = 16384, batch = 256
   !> Terms below which one thread is quicker
   integer(int64), parameter :: parallel_from = 500000

contains

   !> Adds to the sums of squared second differences those whose centre is less than m from an end.
   subroutine add_reflected_differences(phase, m, sums)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factors, 1 <= m <= n/2: [any number]
      integer(int64), intent(in) :: m(:)
      !> The sums to add to: [size(m)]
      real(dp), intent(inout) :: sums(:)

      real(dp) :: part(batch)
      integer(int64) :: blocks, b, first, last
      integer :: i

      do i = 1, size(m)
         blocks = (m(i) + block_length - 2)/block_length
         do first = 1, blocks, batch
            last = min(first + batch - 1, blocks)
            !$omp parallel do schedule(static) if (m(i) >= parallel_from)
            do b = first, last
               part(b - first + 1) = edge_squares(phase, m(i), (b - 1)*block_length + 1, min(b*block_length, m(i) - 1))
            end do
            !$omp end parallel do
            sums(i) = sums(i) + sum(part(:last - first + 1))
         end do
      end do
   end subroutine add_reflected_differences

   !> Both ends: centres j and n - j.
   pure real(dp) function edge_squares(phase, m, first, last)
      !> Phase: [0:n]
      real(dp), intent(in), contiguous :: phase(0:)
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> First and last j, within 1 .. m - 1
      integer(int64), intent(in) :: first, last

      integer(int64) :: n, j
      real(dp) :: s1, s2, begin, finish

      n = ubound(phase, 1, kind=int64)
      begin = phase(0)
      finish = phase(n)
      s1 = 0
      s2 = 0
      !$omp simd reduction(+:s1, s2)
      do j = first, last
         s1 = s1 + ((phase(j + m) - phase(j)) - (phase(j) - begin) - (phase(m - j) - begin))**2
         s2 = s2 + ((phase(n - j - m) - phase(n - j)) - (phase(n - j) - finish) - (phase(n - m + j) - finish))**2
      end do
      edge_squares = s1 + s2
   end function edge_squares

end module gyroakf_allan_reflection
