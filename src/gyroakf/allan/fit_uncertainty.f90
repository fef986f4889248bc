! SPDX-License-Identifier: MIT
!> How uncertain a weighted fit to correlated points is, and whether it fits.
module gyroakf_allan_fit_uncertainty
   use gyroakf_kinds, only : dp
   use gyroakf_lapack, only : dgels, dsyev
   implicit none (type, external)
   private
   public :: sandwich_covariance, generalised_chi_square

   !> Eigenvalues of a correlation matrix below this share of the largest one carry no information
   real(dp), parameter :: eigenvalue_share = 1e-3_dp

contains

   !> Covariance of the unknowns of a weighted least-squares fit whose points are correlated.
   !>
   !> $$ G C G', \quad G = (X' W X)^{-1} X' W $$
   subroutine sandwich_covariance(design, weight, covariance, result, converged)
      !> X: [points, unknowns], columns of length about 1
      real(dp), intent(in) :: design(:, :)
      !> Diagonal of W, > 0: [points]
      real(dp), intent(in) :: weight(:)
      !> C: [points, points]
      real(dp), intent(in) :: covariance(:, :)
      !> Covariance of the unknowns: [unknowns, unknowns]
      real(dp), intent(out) :: result(:, :)
      !> False if the columns are not independent
      logical, intent(out) :: converged

      real(dp) :: left(size(design, 1), size(design, 2)), right(size(design, 1), size(design, 1))
      real(dp) :: gain(size(design, 2), size(design, 1)), work(64*(size(design, 1) + size(design, 2)))
      integer :: i, n, p, info

      n = size(design, 1)
      p = size(design, 2)
      right = 0
      do i = 1, n
         left(i, :) = sqrt(weight(i))*design(i, :)
         right(i, i) = sqrt(weight(i))
      end do
      call dgels("N", n, p, n, left, n, right, n, work, size(work), info)
      converged = info == 0
      result = 0
      if (.not. converged) return
      gain = right(:p, :)
      result = matmul(gain, matmul(covariance, transpose(gain)))
   end subroutine sandwich_covariance

   !> Smallest chi-square of residuals over all changes of the unknowns, with the full covariance.
   !>
   !> $$ \min_\delta (e - X \delta)' C^{-1} (e - X \delta) $$
   !> in the space of the eigenvectors of the correlation matrix whose eigenvalues are above 1e-3 of the largest:
   !> neighbouring averaging times say almost the same, and what differs is below the accuracy of the covariance.
   subroutine generalised_chi_square(residual, design, covariance, chi_square, freedom)
      !> e: [points]
      real(dp), intent(in) :: residual(:)
      !> X: [points, unknowns], columns of length about 1
      real(dp), intent(in) :: design(:, :)
      !> C: [points, points], positive diagonal
      real(dp), intent(in) :: covariance(:, :)
      !> The minimum; 0 where no degree of freedom is left
      real(dp), intent(out) :: chi_square
      !> Its degrees of freedom: kept eigenvectors less unknowns
      integer, intent(out) :: freedom

      real(dp) :: vector(size(residual), size(residual)), value(size(residual)), deviation(size(residual))
      real(dp), allocatable :: left(:, :), right(:, :)
      real(dp) :: work(64*size(residual) + 64)
      integer :: i, n, p, kept, info

      n = size(residual)
      p = size(design, 2)
      chi_square = 0
      freedom = 0
      do i = 1, n
         deviation(i) = sqrt(covariance(i, i))
      end do
      do i = 1, n
         vector(:, i) = covariance(:, i)/(deviation*deviation(i))
      end do
      call dsyev("V", "U", n, vector, n, value, work, size(work), info)
      if (info /= 0) return
      kept = count(value > eigenvalue_share*value(n))
      freedom = max(0, kept - p)
      if (freedom == 0) return
      allocate (left(kept, p), right(kept, 1))
      do i = 1, kept                                        ! the last ones: dsyev sorts upwards
         associate (axis => vector(:, n - kept + i)/(deviation*sqrt(value(n - kept + i))))
            left(i, :) = matmul(axis, design)
            right(i, 1) = dot_product(axis, residual)
         end associate
      end do
      if (p > 0) then
         call dgels("N", kept, p, 1, left, kept, right, kept, work, size(work), info)
         if (info /= 0) freedom = 0
         if (info /= 0) return
      end if
      chi_square = sum(right(p + 1:, 1)**2)
   end subroutine generalised_chi_square

end module gyroakf_allan_fit_uncertainty
