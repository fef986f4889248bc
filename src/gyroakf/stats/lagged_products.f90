! SPDX-License-Identifier: MIT
!> Sums of lagged products of one block: the kernel under every autocovariance.
module gyroakf_stats_lagged_products
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: add_lagged_products

contains

   !> Adds $$\sum_{t=1}^{n} a_t b_{t-k}$$ to s_k for k = 0 .. lags; eight lags share the loads of a.
   pure subroutine add_lagged_products(a, b, n, lags, s)
      !> Length and largest lag
      integer, intent(in) :: n, lags
      !> First factor: [n]
      real(dp), intent(in) :: a(n)
      !> Second factor with its past: [1-lags:n]
      real(dp), intent(in) :: b(1 - lags:n)
      !> The sums: [0:lags]
      real(dp), intent(inout) :: s(0:lags)
      real(dp) :: s0, s1, s2, s3, s4, s5, s6, s7
      integer :: k, t

      do k = 0, lags - 7, 8
         s0 = 0.0_dp; s1 = 0.0_dp; s2 = 0.0_dp; s3 = 0.0_dp
         s4 = 0.0_dp; s5 = 0.0_dp; s6 = 0.0_dp; s7 = 0.0_dp
         !$omp simd reduction(+:s0, s1, s2, s3, s4, s5, s6, s7)
         do t = 1, n
            s0 = s0 + a(t)*b(t - k)
            s1 = s1 + a(t)*b(t - k - 1)
            s2 = s2 + a(t)*b(t - k - 2)
            s3 = s3 + a(t)*b(t - k - 3)
            s4 = s4 + a(t)*b(t - k - 4)
            s5 = s5 + a(t)*b(t - k - 5)
            s6 = s6 + a(t)*b(t - k - 6)
            s7 = s7 + a(t)*b(t - k - 7)
         end do
         s(k:k + 7) = s(k:k + 7) + [s0, s1, s2, s3, s4, s5, s6, s7]
      end do
      do k = 8*((lags + 1)/8), lags
         s0 = 0.0_dp
         !$omp simd reduction(+:s0)
         do t = 1, n
            s0 = s0 + a(t)*b(t - k)
         end do
         s(k) = s(k) + s0
      end do
   end subroutine add_lagged_products

end module gyroakf_stats_lagged_products
