! SPDX-License-Identifier: MIT
!> How uncertain a weighted fit to correlated points is, and whether it fits.
module gyroakf_allan_fit_uncertainty
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dgels, dposv, dpotrf, dpotri, dpotrs, dsyev
   use gyroakf_random, only : fill_normal, random_type, seed_random
   implicit none (type, external)
   private
   public :: sandwich_covariance, draw_estimates


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

      real(dp), dimension(size(centre), size(centre)) :: inverse, root
      real(dp) :: weighted(size(design, 1), size(centre)), value(size(centre)), work(64*size(centre) + 64), x(size(centre))
      real(dp) :: normal(size(centre)), pull(size(centre), size(centre), 2**(size(centre) - signed) - 1)
      type(random_type) :: random
      integer :: i, j, p, info

      p = size(centre)
      do j = 1, p
         weighted(:, j) = weight*design(:, j)
      end do
      inverse = matmul(transpose(design), weighted)
      root = matmul(transpose(weighted), matmul(covariance, weighted))
      call dsyev("V", "U", p, root, p, value, work, size(work), info)
      allocate (estimates(p, 0), unbounded(p, 0))
      if (info /= 0) return
      do j = 1, p
         root(:, j) = root(:, j)*sqrt(max(value(j), 0.0_dp))
      end do
      call dpotrf("U", p, inverse, p, info)
      if (info /= 0) return
      call dpotrs("U", p, p, inverse, p, root, p, info)     ! S^(1/2) becomes H^(-1) S^(1/2)
      call dpotri("U", p, inverse, p, info)
      do j = 1, p
         inverse(j, :j) = inverse(:j, j)
      end do
      do j = 1, size(pull, 3)
         call hold_at_zero(inverse, [(btest(j, i - 1), i=1, p)], pull(:, :, j))
      end do
      deallocate (estimates, unbounded)
      allocate (estimates(p, 2*pairs), unbounded(p, 2*pairs))
      call seed_random(random, 1_int64)
      do i = 1, pairs
         call fill_normal(random, normal)
         do j = 0, 1
            x = centre + (1 - 2*j)*matmul(root, normal)
            unbounded(:, 2*i - 1 + j) = x
            if (any(x(:p - signed) < 0)) call move_to_bounds(inverse, pull, p - signed, x)
            estimates(:, 2*i - 1 + j) = x
         end do
      end do
   end subroutine draw_estimates

   !> The forces on unknowns x that hold some of them, A, at 0: -(H^(-1))_AA^(-1) x_A on these.
   subroutine hold_at_zero(inverse, held, pull)
      !> H^(-1): [unknowns, unknowns]
      real(dp), intent(in) :: inverse(:, :)
      !> A: [unknowns]
      logical, intent(in) :: held(:)
      !> Forces per x: [unknowns, unknowns]
      real(dp), intent(out) :: pull(:, :)

      real(dp) :: part(count(held), count(held)), force(count(held), count(held))
      integer :: place(count(held)), j, info

      place = pack([(j, j=1, size(held))], held)
      part = inverse(place, place)
      force = 0
      do j = 1, size(place)
         force(j, j) = -1
      end do
      call dposv("U", size(place), size(place), part, size(place), force, size(place), info)
      pull = 0
      pull(place, place) = force
   end subroutine hold_at_zero

   !> Moves unknowns to the minimum of (y - x)' H (y - x), y >= 0: no unknown is negative, and every force pushes up. Those that are
   !> held are 0, not the rounding of what holds them: roots are taken of them.
   subroutine move_to_bounds(inverse, pull, bounded, x)
      !> H^(-1), and the forces of each set of unknowns (its bits) that is held at 0
      real(dp), intent(in) :: inverse(:, :), pull(:, :, :)
      !> How many unknowns, the first ones, may not be negative
      integer, intent(in) :: bounded
      !> The unknowns
      real(dp), intent(inout) :: x(:)

      real(dp), dimension(size(x)) :: force, y
      real(dp) :: tolerance
      integer :: set, i

      tolerance = 1e-12_dp*norm2(x)
      do set = 1, size(pull, 3)
         force = matmul(pull(:, :, set), x)
         if (any(force < -tolerance)) cycle
         y = x + matmul(inverse, force)
         if (any(y(:bounded) < -tolerance)) cycle
         x = y
         x(:bounded) = merge(0.0_dp, max(y(:bounded), 0.0_dp), [(btest(set, i - 1), i=1, bounded)])
         return
      end do
   end subroutine move_to_bounds

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
      !> False if the columns are not independent, or more than the points
      logical, intent(out) :: converged

      real(dp) :: left(size(design, 1), size(design, 2)), right(size(design, 1), size(design, 1))
      real(dp) :: gain(size(design, 2), size(design, 1)), work(64*(size(design, 1) + size(design, 2)))
      integer :: i, n, p, info

      n = size(design, 1)
      p = size(design, 2)
      converged = p <= n
      result = 0
      if (.not. converged) return
      right = 0
      do i = 1, n
         left(i, :) = sqrt(weight(i))*design(i, :)
         right(i, i) = sqrt(weight(i))
      end do
      call dgels("N", n, p, n, left, n, right, n, work, size(work), info)
      converged = info == 0
      if (.not. converged) return
      gain = right(:p, :)
      result = matmul(gain, matmul(covariance, transpose(gain)))
   end subroutine sandwich_covariance

end module gyroakf_allan_fit_uncertainty
