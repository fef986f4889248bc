! SPDX-License-Identifier: MIT
!> Gain and covariance that a filter with constant variances settles to: in closed form, by the
!> Chandrasekhar recursion, and by doubling of the Riccati equation.
module gyroakf_filter_steady_gain
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_lapack, only : dgemm, dgesv
   use gyroakf_filter_state_space, only : companion, correct_covariance, predict_covariance, shifted
   implicit none (type, external)
   private
   public :: steady_state, steady_prior, settle_column, long_order, solve_riccati

   !> Relative change at which an iteration has converged
   real(dp), parameter :: tolerance = 1.0e-15_dp
   !> Standard deviation, relative, that rounding loses from a variance
   real(dp), parameter :: lost = 1.0e-9_dp
   !> Doublings after which they have failed: 2^60 steps of the recursion
   integer, parameter :: max_doublings = 60
   !> Order from which the gain is found by `settle_gain`, and its steps at most
   integer, parameter :: long_order = 50, most_steps = 100000
   !> Growth over the driving noise from which on `settle_gain` does not settle
   real(dp), parameter :: explosive = 1.0e60_dp

contains

   !> Gain and covariance that the filter with constant q and r settles to.
   !>
   !> One coefficient: the closed form
   !> $$ P^- = \tfrac12 \left[ c + \sqrt{c^2 + 4 q r} \right],\quad c = q - r (1 - \phi^2),\quad
   !>    K = P^-/(P^- + r) $$
   !> More: the structure-preserving doubling iteration for the discrete Riccati equation,
   !> quadratically convergent, O(p^3) a round (Chu, Fan, Lin & Wang, Int. J. Control 77, 2004,
   !> 767-788); 50 and more: `settle_gain`, O(p) a step, and doubling only where that does not
   !> settle in 100000 steps.
   subroutine steady_state(phi, q, r, gain, prior, error)
      !> Coefficients, [p], p >= 1
      real(dp), intent(in), contiguous :: phi(:)
      !> Variances of the driving and of the measurement noise, >= 0, one of them > 0
      real(dp), intent(in) :: q, r
      !> Steady gain, [p]
      real(dp), intent(out), contiguous :: gain(:)
      !> Steady covariance of the prediction, [p, p]
      real(dp), intent(out), contiguous :: prior(:, :)
      !> not_converged, singular: the Riccati iteration failed (p > 1); no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: transition(:, :)
      real(dp) :: first(size(phi)), work(size(phi)), s
      logical :: settled
      integer :: i, stat

      prior = 0.0_dp
      settled = .false.
      if (noise_is_lost(phi, q, r)) then
         prior(1, 1) = q
      else if (size(phi) == 1) then
         prior(1, 1) = steady_prior(phi(1), q, r)
      else if (q > 0.0_dp) then
         if (size(phi) >= long_order) call settle_gain(phi, q, r, prior, settled)
         if (.not. settled) then
            allocate (transition(size(phi), size(phi)), stat=stat)
            call check_memory(stat, "the steady gain of the filter", error)
            if (allocated(error)) return
            transition = 0.0_dp
            call companion(phi, transition)
            first = 0.0_dp
            first(1) = 1.0_dp
            prior(1, 1) = q/r
            call solve_riccati(transition, first, prior, error)
            if (allocated(error)) return
            prior = r*prior
         end if
         ! polished by the recursion that the filter itself runs
         do i = 1, 8
            call correct_covariance(r, prior, gain, s)
            call predict_covariance(phi, q, prior, work)
         end do
      end if
      gain = prior(:, 1)/(prior(1, 1) + r)
   end subroutine steady_state

   !> True where r is 0, or so small that the state counts as measured: what r adds to the variance
   !> of the prediction, at most $r (\sum |\phi_j|)^2$, is below the rounding of q.
   pure logical function noise_is_lost(phi, q, r)
      real(dp), intent(in) :: phi(:), q, r

      noise_is_lost = .not. r > 0.0_dp
      if (size(phi) > 1 .and. q > 0.0_dp) noise_is_lost = sqrt(r)*(1.0_dp + sum(abs(phi))) &
         <= lost*sqrt(q)
   end function noise_is_lost

   !> Steady variance of the prediction of a state of one coefficient, in a unit in which products
   !> of variances are numbers:
   !> $$ P^- = \tfrac12 \left[ c + \sqrt{c^2 + 4 q r} \right],\quad c = q - r (1 - \phi^2) $$
   pure real(dp) function steady_prior(phi, q, r) result(prior)
      !> Its coefficient
      real(dp), intent(in) :: phi
      !> Variances of the driving noise, >= 0, and of the measurement noise, > 0
      real(dp), intent(in) :: q, r
      real(dp) :: c, root, scaled_q, scaled_r
      integer :: unit

      unit = exponent(max(q, r))
      scaled_q = scale(q, -unit)
      scaled_r = scale(r, -unit)
      c = scaled_q - scaled_r*(1.0_dp - phi)*(1.0_dp + phi)
      root = sqrt(c*c + 4.0_dp*scaled_q*scaled_r)
      if (c >= 0.0_dp) then
         prior = 0.5_dp*(c + root)
      else
         prior = 2.0_dp*scaled_q*scaled_r/(root - c)
      end if
      prior = scale(prior, unit)
   end function steady_prior

   !> Covariance of the prediction that a filter settles to which knows its state at the start, by
   !> the Chandrasekhar recursion.
   !>
   !> [[settle_column]] from P = 0; then the shift structure of the state gives the other columns:
   !> $ P_{i+1,j+1} = P_{ij} - c_i c_j/S $.
   pure subroutine settle_gain(phi, q, r, p, settled)
      real(dp), intent(in) :: phi(:)
      !> Variances of the driving and of the measurement noise, > 0
      real(dp), intent(in) :: q, r
      real(dp), intent(out) :: p(:, :)
      !> False where it does not settle; `p` is of no use then
      logical, intent(out) :: settled
      real(dp), dimension(size(phi)) :: c, l
      real(dp) :: s
      integer :: i, j, n, step

      n = size(phi)
      settled = .false.
      c = 0.0_dp
      l = 0.0_dp
      l(1) = sqrt(q)
      do step = 1, most_steps
         call settle_column(phi, r, r, c, l)
         settled = maxval(abs(l)) <= tolerance*sqrt(maxval(abs(c)))
         if (settled .or. maxval(abs(l)) > explosive*sqrt(q)) exit
      end do
      if (.not. settled) return
      s = c(1) + r
      p(:, 1) = c
      p(1, :) = c
      do j = 2, n
         do i = 2, n
            p(i, j) = p(i - 1, j - 1) - c(i - 1)*(c(j - 1)/s)
         end do
      end do
   end subroutine settle_gain

   !> One step of the first column c of the covariance of the prediction, by the Chandrasekhar
   !> recursion.
   !>
   !> From P = 0 and from the stationary P on the covariance changes by a matrix of rank one at
   !> each step:
   !> $$ S = c_1 + r, \quad c \leftarrow c + \frac{m}{S}\, l_1 l, \quad
   !>    l \leftarrow \Phi \Big(l - \frac{l_1}{S} c\Big) $$
   !> with the c before the step in the last. Source: Morf, Sidhu & Kailath, IEEE Trans. Autom.
   !> Control 19 (1974) 315-323.
   pure subroutine settle_column(phi, r, m, c, l)
      !> Coefficients, [p]
      real(dp), intent(in) :: phi(:)
      !> Variance of the measurement noise
      real(dp), intent(in) :: r
      !> From P = 0: r; from the stationary P: -1
      real(dp), intent(in) :: m
      !> The column, at the start 0 or that of the stationary P; the gain is c/(c(1) + r), [p]
      real(dp), intent(inout) :: c(:)
      !> At the start $ \sqrt q\, e_1 $ or $ \Phi c $, [p]
      real(dp), intent(inout) :: l(:)
      real(dp) :: growth(size(c)), s

      s = c(1) + r
      growth = (m/s*l(1))*l
      l = shifted(phi, l - (l(1)/s)*c)
      c = c + growth
   end subroutine settle_column

   !> Doubling iteration for the covariance of the prediction where the measurement noise has the
   !> variance 1:
   !> $$ P = \Phi \big( P - P h (1 + h^T P h)^{-1} h^T P \big) \Phi^T + Q $$
   subroutine solve_riccati(transition, measured, p, error)
      !> Phi, [p, p]
      real(dp), intent(in), contiguous :: transition(:, :)
      !> h, [p]
      real(dp), intent(in) :: measured(:)
      !> Q on entry, the solution on return, [p, p]
      real(dp), intent(inout), contiguous :: p(:, :)
      !> not_converged, singular, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :), g(:, :), m(:, :), step(:, :), w(:, :)
      integer :: pivot(size(measured)), i, n, info, round

      n = size(measured)
      allocate (a(n, n), stat=info)
      if (info == 0) allocate (g(n, n), stat=info)
      if (info == 0) allocate (m(n, n), stat=info)
      if (info == 0) allocate (step(n, n), stat=info)
      if (info == 0) allocate (w(n, 2*n), stat=info)
      call check_memory(info, "the steady gain of the filter", error)
      if (allocated(error)) return
      do i = 1, n
         a(:, i) = transition(i, :)
         g(:, i) = measured*measured(i)
      end do
      do round = 1, max_doublings
         call dgemm("N", "N", n, n, n, 1.0_dp, g, n, p, n, 0.0_dp, m, n)
         do i = 1, n
            m(i, i) = m(i, i) + 1.0_dp
         end do
         w(:, :n) = a
         w(:, n + 1:) = g
         call dgesv(n, 2*n, m, n, pivot, w, n, info)
         if (info /= 0) then
            call fatal_error(error, status%singular, &
               "the Riccati equation of the filter is singular")
            return
         end if
         call dgemm("N", "N", n, n, n, 1.0_dp, p, n, w, n, 0.0_dp, m, n)
         call dgemm("T", "N", n, n, n, 1.0_dp, a, n, m, n, 0.0_dp, step, n)
         call dgemm("N", "T", n, n, n, 1.0_dp, w(1, n + 1), n, a, n, 0.0_dp, m, n)
         call dgemm("N", "N", n, n, n, 1.0_dp, a, n, m, n, 1.0_dp, g, n)
         call dgemm("N", "N", n, n, n, 1.0_dp, a, n, w, n, 0.0_dp, m, n)
         a = m
         p = p + 0.5_dp*(step + transpose(step))
         if (maxval(abs(step)) <= tolerance*maxval(abs(p))) return
      end do
      call fatal_error(error, status%not_converged, &
         "the Riccati equation of the filter did not converge")
   end subroutine solve_riccati

end module gyroakf_filter_steady_gain
