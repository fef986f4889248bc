! SPDX-License-Identifier: MIT
!> Autocovariances of a series that arrives in blocks, exact across the borders, missing samples
!> left out.
module gyroakf_filter_lag_sums
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_lagged_products, only : add_lagged_products
   implicit none (type, external)
   private
   public :: lag_sums_type, start_lag_sums, add_block, autocovariance_of, longest_lag

   !> Lags that are summed
   integer, parameter :: longest_lag = 20

   !> Sums over the pairs (t, t - k) of which both samples are present
   type :: lag_sums_type
      !> Values are taken about it: the mean of the first block
      real(dp) :: shift = 0
      !> Samples, and those present
      integer(int64) :: samples = 0, present = 0
      !> Sum of the shifted values and of the squares of the values themselves
      real(dp) :: total = 0, squares = 0
      !> Pairs at lag k, their products, the sums of their later and of their earlier members,
      !> [0:longest_lag]
      real(dp) :: pairs(0:longest_lag) = 0, products(0:longest_lag) = 0
      real(dp) :: later(0:longest_lag) = 0, earlier(0:longest_lag) = 0
      !> Shifted values and their presence (1 or 0): the last ones of the block before, then the
      !> block
      real(dp), allocatable :: value(:), here(:)
   end type lag_sums_type

contains

   !> Ready for blocks of up to so many samples.
   subroutine start_lag_sums(sums, block, stat)
      !> The sums, zero
      type(lag_sums_type), intent(out) :: sums
      !> Largest block
      integer, intent(in) :: block
      !> Not 0: no memory
      integer, intent(out) :: stat

      allocate (sums%value(1 - longest_lag:block), stat=stat)
      if (stat == 0) allocate (sums%here(1 - longest_lag:block), stat=stat)
      if (stat /= 0) return
      sums%value = 0.0_dp
      sums%here = 0.0_dp
   end subroutine start_lag_sums

   !> Adds the next block.
   subroutine add_block(sums, x, valid)
      !> The sums
      type(lag_sums_type), intent(inout) :: sums
      !> Next samples, [n], 1 <= n <= the largest block
      real(dp), intent(in), contiguous :: x(:)
      !> 1 where a sample is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: block_total, count, edge
      integer :: k, n

      n = size(x)
      sums%here(1:n) = 1.0_dp
      if (present(valid)) sums%here(1:n) = merge(1.0_dp, 0.0_dp, valid /= 0_int8)
      count = total(sums%here(1:n))
      if (sums%present == 0 .and. count > 0.0_dp) sums%shift = total(x*sums%here(1:n))/count
      sums%squares = sums%squares + total(sums%here(1:n)*x**2)
      sums%value(1:n) = (x - sums%shift)*sums%here(1:n)
      sums%samples = sums%samples + n
      sums%present = sums%present + nint(count, int64)
      block_total = total(sums%value(1:n))
      sums%total = sums%total + block_total
      call add_lagged_products(sums%value(1:), sums%value, n, longest_lag, sums%products)
      if (total(sums%here(:n)) > real(n + longest_lag, dp) - 0.5_dp) then
         ! nothing is missing here nor in the last samples before
         edge = 0.0_dp
         do k = 0, longest_lag
            if (k > 0) edge = edge + sums%value(1 - k) - sums%value(n - k + 1)
            sums%pairs(k) = sums%pairs(k) + count
            sums%later(k) = sums%later(k) + block_total
            sums%earlier(k) = sums%earlier(k) + (block_total + edge)
         end do
      else
         call add_lagged_products(sums%here(1:), sums%here, n, longest_lag, sums%pairs)
         call add_lagged_products(sums%value(1:), sums%here, n, longest_lag, sums%later)
         call add_lagged_products(sums%here(1:), sums%value, n, longest_lag, sums%earlier)
      end if
      do k = 1 - longest_lag, 0
         sums%value(k) = sums%value(n + k)
         sums%here(k) = sums%here(n + k)
      end do
   end subroutine add_block

   !> Sum of a vector.
   pure real(dp) function total(a)
      !> The vector, [n]
      real(dp), intent(in), contiguous :: a(:)
      integer :: i

      total = 0.0_dp
      !$omp simd reduction(+:total)
      do i = 1, size(a)
         total = total + a(i)
      end do
   end function total

   !> Autocovariances about the mean: per lag the mean over the present pairs times (n - k)/n, which
   !> without gaps is the biased estimate with divisor n.
   pure subroutine autocovariance_of(sums, r)
      !> The sums
      type(lag_sums_type), intent(in) :: sums
      !> r(0), ..., r(longest_lag); 0 at a lag without pairs
      real(dp), intent(out) :: r(0:)
      real(dp) :: mean, n
      integer :: k

      r = 0.0_dp
      if (sums%present == 0) return
      n = real(sums%samples, dp)
      mean = sums%total/real(sums%present, dp)
      do k = 0, longest_lag
         if (sums%pairs(k) < 0.5_dp) cycle
         r(k) = sums%products(k) - mean*(sums%later(k) + sums%earlier(k)) + sums%pairs(k)*mean**2
         r(k) = r(k)/sums%pairs(k)*(n - real(k, dp))/n
      end do
   end subroutine autocovariance_of
end module gyroakf_filter_lag_sums
