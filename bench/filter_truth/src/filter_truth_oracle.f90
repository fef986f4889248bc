! SPDX-License-Identifier: MIT
!> The Kalman filter and the fixed-interval smoother that know everything but the noise itself: parameters, when they change, the
!> cubic, which samples are outliers. Written out with dense matrices, apart from the library's filters that are measured by it.
module filter_truth_oracle
   use gyroakf, only : dp
   use filter_truth_cases, only : world_type
   implicit none (type, external)
   private
   public :: ask_oracle

contains

   !> Drift as the oracle filters and smooths it.
   !>
   !> $$ \hat x_k = x^-_k + P^-_k \rho_{k-1}, \quad \rho_{k-1} = \mathbf 1\,e_k/S_k + (I - K_k \mathbf 1^T)^T \Phi^T \rho_k $$
   subroutine ask_oracle(world, filtered, smoothed)
      type(world_type), intent(in) :: world
      !> [samples]
      real(dp), intent(out), contiguous :: filtered(:), smoothed(:)
      real(dp), allocatable :: x(:, :), p(:, :, :), gain(:, :), e(:), s(:), a(:), c(:, :), rho(:), h(:)
      integer :: i, k, m, n

      n = size(world%z)
      m = size(world%q)
      allocate (x(m, n), p(m, m, n), gain(m, n), e(n), s(n), a(m), c(m, m), rho(m))
      h = merge(1.0_dp, 0.0_dp, world%seen)
      a = 0.0_dp
      c = world%prior
      do k = 1, n
         if (k > 1) then
            a = matmul(world%transition, a)
            c = matmul(world%transition, matmul(c, transpose(world%transition)))
            do i = 1, m
               c(i, i) = c(i, i) + world%q(i)*world%factor(k)
            end do
            c(1, 1) = c(1, 1) + world%jump(k)
         end if
         x(:, k) = a
         p(:, :, k) = c
         gain(:, k) = 0.0_dp
         e(k) = 0.0_dp
         s(k) = 1.0_dp
         if (.not. world%outlier(k)) then
            e(k) = world%z(k) - world%trend(k) - dot_product(h, a)
            s(k) = dot_product(h, matmul(c, h)) + world%r(k)
            gain(:, k) = matmul(c, h)/s(k)
            a = a + gain(:, k)*e(k)
            do i = 1, m
               c(:, i) = c(:, i) - gain(:, k)*(gain(i, k)*s(k))
            end do
         end if
         filtered(k) = world%trend(k) + dot_product(h, a)
      end do
      rho = 0.0_dp
      do k = n, 1, -1
         if (k < n) rho = matmul(transpose(world%transition), rho)
         if (.not. world%outlier(k)) rho = rho + h*(e(k)/s(k) - dot_product(gain(:, k), rho))
         smoothed(k) = world%trend(k) + dot_product(h, x(:, k) + matmul(p(:, :, k), rho))
      end do
      if (world%name == "C0a") then                     ! the cubic alone is the drift
         filtered = world%trend
         smoothed = world%trend
      end if
   end subroutine ask_oracle
end module filter_truth_oracle
