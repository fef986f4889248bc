! SPDX-License-Identifier: MIT
!> How uncertain a weighted fit to correlated points is, and whether it fits.
module gyroakf_allan_fit_uncertainty
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dgels, dposv, dsyev
   use gyroakf_allan_nonnegative, only : solve_nonnegative
   use gyroakf_simulate_random, only : fill_normal, random_type, seed_random
   implicit none (type, external)
   private
   public :: sandwich_covariance, generalised_chi_square, draw_estimates

   !> Eigenvalues of a correlation matrix below this share of the largest one carry no information
   real(dp), parameter :: eigenvalue_share = 1e-3_dp

   !> Pairs of draws, of opposite sign
   integer, parameter :: pairs = 250

contains

   !> Estimates as they would come from other records of the same noise.
   !>
   !> The weighted fit is a projection of the points with H = X'WX and the covariance S = X'WCWX of X'We. Draws g of N(0, S)
   !> give estimates that minimise (x - c)' H (x - c)/2 - g'(x - c), x >= 0, around the true unknowns c; how they scatter is what
   !> the estimates are uncertain by, however often an unknown comes out as zero. The draws are the same in every call.
   subroutine draw_estimates(design, weight, covariance, centre, signed, estimates, unbounded)
      !> X: [points, unknowns], columns of length about 1
      real(dp), intent(in) :: design(:, :)
      !> Diagonal of W, > 0: [points]
      real(dp), intent(in) :: weight(:)
      !> C: [points, points]
      real(dp), intent(in) :: covariance(:, :)
      !> True unknowns: [unknowns]
      real(dp), intent(in) :: centre(:)
      !> How many unknowns, the last ones, may be negative
      integer, intent(in) :: signed
      !> With the bounds, and the same without them: [unknowns, draws]; no draws where the columns are not independent
      real(dp), allocatable, intent(out) :: estimates(:, :), unbounded(:, :)

      real(dp), dimension(size(centre), size(centre)) :: square, root, inverse
      real(dp) :: weighted(size(design, 1), size(centre)), value(size(centre)), work(64*size(centre) + 64), x(size(centre))
      real(dp) :: normal(size(centre)), bounded(size(centre), size(centre) + signed), y(size(centre) + signed), target(size(centre))
      type(random_type) :: random
      integer :: i, j, p, info
      logical :: converged

      p = size(centre)
      do j = 1, p
         weighted(:, j) = weight*design(:, j)
      end do
      square = matmul(transpose(design), weighted)
      root = matmul(transpose(weighted), matmul(covariance, weighted))
      call dsyev("V", "U", p, root, p, value, work, size(work), info)
      allocate (estimates(p, 0), unbounded(p, 0))
      if (info /= 0) return
      do j = 1, p
         root(:, j) = root(:, j)*sqrt(max(value(j), 0.0_dp))
      end do
      inverse = root
      bounded(:, :p) = square                               ! from here on S^(1/2) becomes H^(-1) S^(1/2)
      call dposv("U", p, p, bounded(:, :p), p, inverse, p, info)
      if (info /= 0) return
      do j = 1, p                                           ! the factor U of H = U'U
         bounded(j + 1:, j) = 0
      end do
      bounded(:, p + 1:) = -bounded(:, p - signed + 1:p)
      deallocate (estimates, unbounded)
      allocate (estimates(p, 2*pairs), unbounded(p, 2*pairs))
      call seed_random(random, 1_int64)
      do i = 1, pairs
         call fill_normal(random, normal)
         do j = 0, 1
            x = centre + (1 - 2*j)*matmul(inverse, normal)
            unbounded(:, 2*i - 1 + j) = x
            if (any(x(:p - signed) < 0)) then
               target = matmul(bounded(:, :p), x)
               call solve_nonnegative(bounded, target, y, converged)
               if (converged) x = y(:p)
               if (converged) x(p - signed + 1:) = y(p - signed + 1:p) - y(p + 1:)
            end if
            estimates(:, 2*i - 1 + j) = x
         end do
      end do
   end subroutine draw_estimates

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
