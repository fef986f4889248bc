! SPDX-License-Identifier: MIT
!> Free parameters for the coefficients of a stationary AR, or an invertible MA, polynomial of low order.
!>
!> Any numbers u_m give partial autocorrelations $$k_m = \tanh u_m$$ inside (-1, 1), and these by the Durbin-Levinson recursion
!> $$\phi_{m,m} = k_m, \quad \phi_{m,j} = \phi_{m-1,j} - k_m \phi_{m-1,m-j}$$ the coefficients of a stationary AR(p), every one of
!> them once. An MA polynomial 1 + theta_1 B + ... takes the coefficients with the sign turned. Source: J. F. Monahan,
!> Biometrika 71 (1984) 403-404; O. Barndorff-Nielsen, G. Schou, J. Multivariate Anal. 3 (1973) 408-419.
module gyroakf_ar_arma_transform
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: coefficients_of, free_of, shrink, farthest

   !> Free parameters beyond it are not distinguished from the unit circle: 1 - k = 2e-13
   real(dp), parameter :: farthest = 15.0_dp

contains

   !> Coefficients of free parameters and their derivatives.
   pure subroutine coefficients_of(u, phi, jacobian)
      !> Free parameters: [p], |u| <= farthest
      real(dp), intent(in) :: u(:)
      !> Coefficients of a stationary AR(p): [p]
      real(dp), intent(out) :: phi(:)
      !> Derivative of phi_i by u_j in (i, j): [p, p]
      real(dp), intent(out) :: jacobian(:, :)
      real(dp) :: old(size(u)), old_jacobian(size(u), size(u)), k
      integer :: m, j

      phi(:) = 0.0_dp
      jacobian(:, :) = 0.0_dp
      do m = 1, size(u)
         k = tanh(u(m))
         old(:) = phi
         old_jacobian(:, :) = jacobian
         do j = 1, m - 1
            phi(j) = old(j) - k*old(m - j)
            jacobian(j, :) = old_jacobian(j, :) - k*old_jacobian(m - j, :)
            jacobian(j, m) = -old(m - j)/cosh(u(m))**2
         end do
         phi(m) = k
         jacobian(m, m) = 1.0_dp/cosh(u(m))**2
      end do
   end subroutine coefficients_of

   !> Free parameters of coefficients, by the recursion backwards.
   pure subroutine free_of(phi, u, stationary)
      !> Coefficients: [p]
      real(dp), intent(in) :: phi(:)
      !> Free parameters: [p]; 0 where not stationary
      real(dp), intent(out) :: u(:)
      !> All partial autocorrelations are inside (-1, 1), and within [[gyroakf_ar_arma_transform:farthest]]
      logical, intent(out) :: stationary
      real(dp) :: a(size(phi)), old(size(phi)), k
      integer :: m, j

      a(:) = phi
      u(:) = 0.0_dp
      stationary = .false.
      do m = size(phi), 1, -1
         k = a(m)
         if (.not. abs(k) < tanh(farthest)) then
            u(:) = 0.0_dp
            return
         end if
         u(m) = atanh(k)
         old(:) = a
         do j = 1, m - 1
            a(j) = (old(j) + k*old(m - j))/((1.0_dp - k)*(1.0_dp + k))
         end do
      end do
      stationary = .true.
   end subroutine free_of

   !> Draws the roots of a polynomial towards zero until it is stationary with a margin: phi_i becomes c^i phi_i.
   pure subroutine shrink(phi)
      !> Coefficients: [p], finite; all 0 where nothing else helps
      real(dp), intent(inout) :: phi(:)
      !> Largest partial autocorrelation of a starting point, as a free parameter
      real(dp), parameter :: margin = 9.0_dp
      real(dp) :: u(size(phi))
      logical :: stationary
      integer :: i, attempt

      do attempt = 1, 200
         call free_of(phi, u, stationary)
         if (stationary) then
            if (all(abs(u) < margin)) return
         end if
         do i = 1, size(phi)
            phi(i) = phi(i)*(1.0_dp - 0.001_dp*real(attempt, dp))**i
         end do
      end do
      phi(:) = 0.0_dp
   end subroutine shrink

end module gyroakf_ar_arma_transform
