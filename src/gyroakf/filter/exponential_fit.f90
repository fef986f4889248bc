! SPDX-License-Identifier: MIT
!> Fit of D psi^k to the autocovariances of a series at the lags k = 1 ... L, in generalised least squares.
!>
!> For drift AR(1) plus white noise r_k = D psi^k for k >= 1, and r_0 = D + R. The errors of the sample
!> autocovariances are correlated; Bartlett's formula gives their covariance for a model,
!> $$ n\,\mathrm{Cov}(r_i, r_j) = C(|i - j|) + C(i + j),\quad C(h) = \sum_m \gamma_m \gamma_{m+h}
!>    = D^2 \psi^h \left(h + \frac{1 + \psi^2}{1 - \psi^2}\right) + 2 D R \psi^h + R^2 \delta_h $$
!> The first round weighs all lags alike, the next ones by this matrix with the values of the round before.
!>
!> Source: Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27-41; the fit to covariances: Odelson, Rajamani & Rawlings,
!> Automatica 42 (2006) 303-308, here for one state.
module gyroakf_filter_exponential_fit
   use gyroakf_kinds, only : dp
   use gyroakf_lapack, only : dpotrf, dtrtrs
   implicit none (type, external)
   private
   public :: exponential_type, fit_exponential

   !> Rounds: one unweighted, the others weighted
   integer, parameter :: rounds = 4
   !> Correlation times tried: from this many lags up to a share of the samples, in a geometric grid, then refined
   real(dp), parameter :: shortest = 0.2_dp, largest_share = 0.3_dp
   integer, parameter :: grid_points = 60, refinements = 40
   !> Share of the unweighted fit's evidence that a weighted one keeps: else, as near a random walk, where the weights
   !> are all but singular, it has gone astray and the round before holds
   real(dp), parameter :: least_agreement = 0.5_dp
   !> White noise that the weights assume at least, relative to r_0: keeps their matrix well conditioned
   real(dp), parameter :: least_white = 1.0e-3_dp

   !> D psi^k
   type :: exponential_type
      !> D, 0 ... r_0
      real(dp) :: amplitude = 0
      !> psi, 0 ... 1
      real(dp) :: ratio = 0
      !> Decrease of chi-square from "no correlation at all" to the fit, had the series been white
      real(dp) :: evidence = 0
   end type exponential_type

contains

   !> The fit.
   subroutine fit_exponential(r, samples, fit)
      !> Biased autocovariances, [0:L], L >= 2, r(0) > 0
      real(dp), intent(in) :: r(0:)
      !> Number of samples behind them
      real(dp), intent(in) :: samples
      !> D, psi and what speaks for them
      type(exponential_type), intent(out) :: fit
      real(dp), allocatable :: factor(:, :), white(:)
      integer :: lags, round, info
      type(exponential_type) :: next

      lags = ubound(r, 1)
      allocate (factor(lags, lags), white(lags))
      do round = 1, rounds
         call weights(r(0), samples, fit, round == 1, factor)
         call dpotrf("L", lags, factor, lags, info)
         if (info /= 0) exit
         white = r(1:)
         call whiten(factor, white)
         call search(factor, white, r(0), samples, next)
         next%evidence = evidence_of(next, r, samples)
         if (round > 1 .and. .not. next%evidence > least_agreement*fit%evidence) exit
         fit = next
         if (.not. fit%amplitude > 0.0_dp) exit
      end do
   end subroutine fit_exponential

   !> Decrease of chi-square from no correlation to a fit, had the series been white.
   pure real(dp) function evidence_of(fit, r, samples)
      type(exponential_type), intent(in) :: fit
      real(dp), intent(in) :: r(0:), samples
      integer :: k

      evidence_of = 0.0_dp
      do k = 1, ubound(r, 1)
         evidence_of = evidence_of + r(k)**2 - (r(k) - fit%amplitude*regressor(fit%ratio, k, samples))**2
      end do
      evidence_of = samples*evidence_of/r(0)**2
   end function evidence_of

   !> Covariance matrix of r(1:L) for a model, lower triangle; the unit matrix in the first round.
   pure subroutine weights(r0, samples, fit, first, v)
      real(dp), intent(in) :: r0, samples
      type(exponential_type), intent(in) :: fit
      logical, intent(in) :: first
      real(dp), intent(out) :: v(:, :)
      real(dp) :: c(0:2*size(v, 1)), d, white, psi
      integer :: h, i, j

      d = fit%amplitude/r0
      psi = fit%ratio
      white = max(1.0_dp - d, least_white)
      do h = 0, ubound(c, 1)
         c(h) = psi**h*(d*d*(h + (1.0_dp + psi**2)/max(1.0_dp - psi**2, 1.0_dp/samples)) + 2.0_dp*d*white)
      end do
      c(0) = c(0) + white**2
      do j = 1, size(v, 1)
         do i = j, size(v, 1)
            v(i, j) = c(i - j) + c(i + j)
            if (first) v(i, j) = merge(1.0_dp, 0.0_dp, i == j)
         end do
      end do
   end subroutine weights

   !> Multiplies by the inverse of the Cholesky factor.
   subroutine whiten(factor, y)
      real(dp), intent(in) :: factor(:, :)
      real(dp), intent(inout) :: y(:)
      real(dp) :: b(size(y), 1)
      integer :: info

      b(:, 1) = y
      call dtrtrs("L", "N", "N", size(y), 1, factor, size(y), b, size(y), info)
      y = b(:, 1)
   end subroutine whiten

   !> The best psi: a geometric grid of correlation times, then a golden section about the best of it.
   subroutine search(factor, white, r0, samples, best)
      real(dp), intent(in) :: factor(:, :), white(:), r0, samples
      type(exponential_type), intent(out) :: best
      real(dp), parameter :: golden = 0.61803398874989485_dp
      real(dp) :: a, b, t, low, step, cost, lowest, inner(2), inner_cost(2)
      integer :: i

      low = log(shortest)
      step = (log(max(1.0_dp, largest_share*samples)) - low)/real(grid_points - 1, dp)
      lowest = huge(1.0_dp)
      a = low
      do i = 1, grid_points
         t = low + step*real(i - 1, dp)
         call misfit(factor, white, r0, samples, t, cost, best)
         if (cost < lowest) then
            lowest = cost
            a = t
         end if
      end do
      b = a + step
      a = a - step
      inner = [b - golden*(b - a), a + golden*(b - a)]
      do i = 1, 2
         call misfit(factor, white, r0, samples, inner(i), inner_cost(i), best)
      end do
      do i = 1, refinements
         if (inner_cost(1) < inner_cost(2)) then
            b = inner(2)
            inner = [b - golden*(b - a), inner(1)]
            inner_cost(2) = inner_cost(1)
            call misfit(factor, white, r0, samples, inner(1), inner_cost(1), best)
         else
            a = inner(1)
            inner = [inner(2), a + golden*(b - a)]
            inner_cost(1) = inner_cost(2)
            call misfit(factor, white, r0, samples, inner(2), inner_cost(2), best)
         end if
      end do
   end subroutine search

   !> Weighted misfit at a correlation time, with the best D between 0 and r_0.
   subroutine misfit(factor, white, r0, samples, log_time, cost, fit)
      real(dp), intent(in) :: factor(:, :), white(:), r0, samples, log_time
      real(dp), intent(out) :: cost
      type(exponential_type), intent(out) :: fit
      real(dp) :: g(size(white))
      integer :: k

      fit%ratio = exp(-exp(-log_time))
      do k = 1, size(white)
         g(k) = regressor(fit%ratio, k, samples)
      end do
      call whiten(factor, g)
      fit%amplitude = min(max(dot_product(g, white)/dot_product(g, g), 0.0_dp), r0)
      cost = sum((white - fit%amplitude*g)**2)
   end subroutine misfit

   !> Expected biased autocovariance at lag k per unit of D: the mean was estimated and removed.
   elemental real(dp) function regressor(psi, k, samples)
      real(dp), intent(in) :: psi
      integer, intent(in) :: k
      real(dp), intent(in) :: samples

      regressor = (1.0_dp - real(k, dp)/samples)*psi**k - min(0.5_dp, (1.0_dp + psi)/((1.0_dp - psi)*samples))
   end function regressor
end module gyroakf_filter_exponential_fit
