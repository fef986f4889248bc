! SPDX-License-Identifier: MIT
!> Variance of the differences of successive samples: that of white noise, whatever drifts.
module gyroakf_stats_differences
   use gyroakf_kinds, only : dp, int8, int64
   implicit none (type, external)
   private
   public :: difference_variance

   !> Samples of one partial sum; the sums do not depend on the number of threads
   integer(int64), parameter :: block_size = 65536_int64

contains

   !> Variance (ddof 1) of x(i+1) - x(i) over the present pairs; 0 below two pairs.
   real(dp) function difference_variance(x, valid) result(variance)
      !> The series, without a large trend: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, blocks, b, first, last
      integer(int64), allocatable :: pairs(:)
      real(dp), allocatable :: sums(:), squares(:)
      real(dp) :: count

      variance = 0.0_dp
      n = size(x, kind=int64)
      if (n < 3) return
      blocks = (n - 1 + block_size - 1)/block_size
      allocate (pairs(blocks), sums(blocks), squares(blocks))
      !$omp parallel do default(none) shared(x, valid, n, blocks, pairs, sums, squares) &
      !$omp& private(first, last) schedule(static)
      do b = 1, blocks
         first = (b - 1)*block_size + 1
         last = min(b*block_size, n - 1) + 1
         if (present(valid)) then
            call sum_block(x(first:last), pairs(b), sums(b), squares(b), valid(first:last))
         else
            call sum_block(x(first:last), pairs(b), sums(b), squares(b))
         end if
      end do
      count = real(sum(pairs), dp)
      if (count > 1.5_dp) variance = max(0.0_dp, sum(squares) - sum(sums)**2/count)/(count - 1.0_dp)
   end function difference_variance

   !> Sums over the pairs of one block.
   pure subroutine sum_block(x, pairs, total, squares, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(out) :: pairs
      real(dp), intent(out) :: total, squares
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i
      real(dp) :: d

      total = 0.0_dp
      squares = 0.0_dp
      pairs = size(x, kind=int64) - 1
      if (.not. present(valid)) then
         !$omp simd reduction(+:total, squares) private(d)
         do i = 1, size(x, kind=int64) - 1
            d = x(i + 1) - x(i)
            total = total + d
            squares = squares + d*d
         end do
      else
         pairs = 0
         do i = 1, size(x, kind=int64) - 1
            if (valid(i) == 0 .or. valid(i + 1) == 0) cycle
            d = x(i + 1) - x(i)
            total = total + d
            squares = squares + d*d
            pairs = pairs + 1
         end do
      end if
   end subroutine sum_block

end module gyroakf_stats_differences
