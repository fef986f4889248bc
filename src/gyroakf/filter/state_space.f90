! SPDX-License-Identifier: MIT
!> The AR(p) state space: covariance recursions that use its shift structure, its steady state and
!> what a fixed gain does to a series.
!>
!> The state is the companion form of x_k = phi_1 x_{k-1} + ... + phi_p x_{k-p} + w_k, Var(w) = q; the
!> measurement is z_k = x_k + v_k, Var(v) = r. The first row of the transition matrix is phi, the ones
!> below the diagonal only shift: a step costs O(p^2), no matrix product is formed.
module gyroakf_filter_state_space
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dgemm, dgesv
   implicit none (type, external)
   private
   public :: steady_prior, predict_covariance, correct_covariance, stationary_covariance, steady_state
   public :: settle_column, shifted, long_order, solve_riccati, dc_gain, output_variance_ratio

   !> Relative change at which a doubling iteration has converged
   real(dp), parameter :: tolerance = 1.0e-15_dp
   !> Standard deviation, relative, that rounding loses from a variance
   real(dp), parameter :: lost = 1.0e-9_dp
   !> Doublings after which it has failed: 2^60 steps of the recursion
   integer, parameter :: max_doublings = 60
   !> Order from which the gain is found by `settle_gain`, and its steps at most
   integer, parameter :: long_order = 50, most_steps = 100000
   !> Variance per unit of driving noise that no stationary series has in double precision
   real(dp), parameter :: explosive = 1.0e60_dp

contains

   !> Covariance of the prediction, in place: $$ P \leftarrow \Phi P \Phi^T + q\, e_1 e_1^T $$
   pure subroutine predict_covariance(phi, q, p, work)
      !> Coefficients, [p], p >= 1
      real(dp), intent(in), contiguous :: phi(:)
      !> Variance of the driving noise
      real(dp), intent(in) :: q
      !> Symmetric covariance, [p, p]
      real(dp), intent(inout), contiguous :: p(:, :)
      !> Work space, [p]
      real(dp), intent(inout), contiguous :: work(:)
      integer :: i, j, n

      n = size(phi)
      do j = 1, n
         work(j) = dot_product(p(:, j), phi)
      end do
      do j = n, 2, -1
         do i = n, 2, -1
            p(i, j) = p(i - 1, j - 1)
         end do
      end do
      p(1, 1) = dot_product(phi, work(:n)) + q
      do j = 2, n
         p(1, j) = work(j - 1)
         p(j, 1) = work(j - 1)
      end do
   end subroutine predict_covariance

   !> Gain and posterior covariance, in place: $$ K = P e_1 / S,\quad P \leftarrow P - K S K^T,\quad S = P_{11} + r $$
   !>
   !> The first row is scaled by r/S, so nothing cancels in it; the result is exactly symmetric.
   pure subroutine correct_covariance(r, p, gain, s)
      !> Variance of the measurement noise
      real(dp), intent(in) :: r
      !> Covariance: of the prediction on entry, of the estimate on return, [p, p]
      real(dp), intent(inout), contiguous :: p(:, :)
      !> Gain, [p]
      real(dp), intent(inout), contiguous :: gain(:)
      !> Variance of the innovation
      real(dp), intent(out) :: s
      real(dp) :: share
      integer :: i, j, n

      n = size(p, 1)
      s = p(1, 1) + r
      share = r/s
      gain(:n) = p(:, 1)/s
      do j = 2, n
         p(j, j) = max(0.0_dp, p(j, j) - gain(j)*p(j, 1))
         do i = j + 1, n
            p(i, j) = p(i, j) - gain(i)*p(j, 1)
            p(j, i) = p(i, j)
         end do
      end do
      do j = 1, n
         p(j, 1) = p(j, 1)*share
         p(1, j) = p(j, 1)
      end do
   end subroutine correct_covariance

   !> Stationary covariance of the state: the Toeplitz matrix of the autocovariances of the AR(p) series,
   !> which solves the Lyapunov equation $$ P = \Phi P \Phi^T + q\, e_1 e_1^T $$
   !>
   !> The coefficients of the lower orders are found by the Levinson recursion run downwards; the series is
   !> stationary exactly when all reflection coefficients are below 1 in magnitude.
   pure subroutine stationary_covariance(phi, q, p, error)
      !> Coefficients, [p], p >= 1
      real(dp), intent(in) :: phi(:)
      !> Variance of the driving noise, >= 0
      real(dp), intent(in) :: q
      !> Covariance, [p, p]
      real(dp), intent(out) :: p(:, :)
      !> unstable: the coefficients are not those of a stationary series; no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: lower(:, :)
      real(dp) :: r(0:size(phi)), reflection
      integer :: i, j, m, n, stat

      n = size(phi)
      allocate (lower(n, 0:n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the covariance of the filter")
         return
      end if
      lower(:, n) = phi
      r(0) = q
      do m = n, 1, -1
         reflection = lower(m, m)
         if (abs(reflection) >= 1.0_dp) then
            call fatal_error(error, status%unstable, "the autoregressive coefficients are not those of a stationary series")
            return
         end if
         r(0) = r(0)/((1.0_dp - reflection)*(1.0_dp + reflection))
         do i = 1, m - 1
            lower(i, m - 1) = (lower(i, m) + reflection*lower(m - i, m))/((1.0_dp - reflection)*(1.0_dp + reflection))
         end do
      end do
      do m = 1, n
         r(m) = dot_product(lower(1:m, m), r(m - 1:0:-1))
      end do
      do j = 1, n
         do i = 1, n
            p(i, j) = r(abs(i - j))
         end do
      end do
   end subroutine stationary_covariance

   !> Gain and covariance that the filter with constant q and r settles to.
   !>
   !> One coefficient: the closed form
   !> $$ P^- = \tfrac12 \left[ c + \sqrt{c^2 + 4 q r} \right],\quad c = q - r (1 - \phi^2),\quad K = P^-/(P^- + r) $$
   !> More: the structure-preserving doubling iteration for the discrete Riccati equation, quadratically
   !> convergent, O(p^3) a round (Chu, Fan, Lin & Wang, Int. J. Control 77, 2004, 767-788); 50 and more: `settle_gain`, O(p) a
   !> step, and doubling only where that does not settle in 100000 steps.
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
      real(dp) :: work(size(phi)), s
      logical :: settled
      integer :: i

      prior = 0.0_dp
      settled = .false.
      if (noise_is_lost(phi, q, r)) then
         prior(1, 1) = q
      else if (size(phi) == 1) then
         prior(1, 1) = steady_prior(phi(1), q, r)
      else if (q > 0.0_dp) then
         if (size(phi) >= long_order) call settle_gain(phi, q, r, prior, settled)
         if (.not. settled) then
            call steady_prediction(phi, q/r, prior, error)
            if (allocated(error)) return
            prior = r*prior
         end if
         do i = 1, 8                            ! polished by the recursion that the filter itself runs
            call correct_covariance(r, prior, gain, s)
            call predict_covariance(phi, q, prior, work)
         end do
      end if
      gain = prior(:, 1)/(prior(1, 1) + r)
   end subroutine steady_state

   !> Steady covariance of the prediction by doubling, for r = 1.
   subroutine steady_prediction(phi, q, prior, error)
      !> Coefficients, [p], p >= 2
      real(dp), intent(in) :: phi(:)
      !> Variance of the driving noise
      real(dp), intent(in) :: q
      !> Covariance, [p, p]
      real(dp), intent(out), contiguous :: prior(:, :)
      !> As of solve_riccati
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :), g(:, :)
      integer :: stat

      allocate (a(size(phi), size(phi)), stat=stat)
      if (stat == 0) allocate (g(size(phi), size(phi)), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the steady gain of the filter")
         return
      end if
      a = 0.0_dp
      g = 0.0_dp
      prior = 0.0_dp
      call companion(phi, a)
      g(1, 1) = 1.0_dp
      prior(1, 1) = q
      call solve_riccati(a, g, prior, error)
   end subroutine steady_prediction

   !> True where r is 0, or so small that the state counts as measured: what r adds to the variance of the prediction, at most
   !> $r (\sum |\phi_j|)^2$, is below the rounding of q.
   pure logical function noise_is_lost(phi, q, r)
      !> Coefficients, [p], p >= 1
      real(dp), intent(in) :: phi(:)
      !> Variances of the driving and of the measurement noise, >= 0
      real(dp), intent(in) :: q, r

      noise_is_lost = .not. r > 0.0_dp
      if (size(phi) > 1 .and. q > 0.0_dp) noise_is_lost = sqrt(r)*(1.0_dp + sum(abs(phi))) <= lost*sqrt(q)
   end function noise_is_lost

   !> Steady variance of the prediction of a state of one coefficient, in a unit in which products of variances are numbers:
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

   !> Covariance of the prediction that a filter settles to which knows its state at the start, by the Chandrasekhar recursion.
   !>
   !> [[settle_column]] from P = 0; then the shift structure of the state gives the other columns:
   !> $ P_{i+1,j+1} = P_{ij} - c_i c_j/S $.
   pure subroutine settle_gain(phi, q, r, p, settled)
      !> Coefficients, [p]
      real(dp), intent(in) :: phi(:)
      !> Variances of the driving and of the measurement noise, > 0
      real(dp), intent(in) :: q, r
      !> Covariance of the settled prediction, [p, p]
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

   !> One step of the first column c of the covariance of the prediction, by the Chandrasekhar recursion.
   !>
   !> From P = 0 and from the stationary P on the covariance changes by a matrix of rank one at each step:
   !> $$ S = c_1 + r, \quad c \leftarrow c + \frac{m}{S}\, l_1 l, \quad l \leftarrow \Phi \Big(l - \frac{l_1}{S} c\Big) $$
   !> with the c before the step in the last. Source: Morf, Sidhu & Kailath, IEEE Trans. Autom. Control 19 (1974) 315-323.
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

   !> The state one sample later, without noise: $ \Phi x $
   pure function shifted(phi, x) result(y)
      !> Coefficients, [p]
      real(dp), intent(in) :: phi(:)
      !> State, [p]
      real(dp), intent(in) :: x(:)
      real(dp) :: y(size(x))

      y(1) = dot_product(phi, x)
      y(2:) = x(:size(x) - 1)
   end function shifted

   !> Doubling iteration for the covariance of the prediction where the measurement noise has the variance 1:
   !> $$ P = \Phi \big( P - P h (1 + h^T P h)^{-1} h^T P \big) \Phi^T + Q $$
   subroutine solve_riccati(transition, g, h, error)
      !> Phi, [p, p]
      real(dp), intent(in), contiguous :: transition(:, :)
      !> h h', [p, p]; spent afterwards
      real(dp), intent(inout), contiguous :: g(:, :)
      !> Q on entry, the solution on return, [p, p]
      real(dp), intent(inout), contiguous :: h(:, :)
      !> not_converged, singular, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :), m(:, :), step(:, :), w(:, :)
      integer :: pivot(size(g, 1)), i, n, info, round

      n = size(g, 1)
      allocate (a(n, n), stat=info)
      if (info == 0) allocate (m(n, n), stat=info)
      if (info == 0) allocate (step(n, n), stat=info)
      if (info == 0) allocate (w(n, 2*n), stat=info)
      if (info /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the steady gain of the filter")
         return
      end if
      a = transpose(transition)
      do round = 1, max_doublings
         call dgemm("N", "N", n, n, n, 1.0_dp, g, n, h, n, 0.0_dp, m, n)
         do i = 1, n
            m(i, i) = m(i, i) + 1.0_dp
         end do
         w(:, :n) = a
         w(:, n + 1:) = g
         call dgesv(n, 2*n, m, n, pivot, w, n, info)
         if (info /= 0) then
            call fatal_error(error, status%singular, "the Riccati equation of the filter is singular")
            return
         end if
         call dgemm("N", "N", n, n, n, 1.0_dp, h, n, w, n, 0.0_dp, m, n)
         call dgemm("T", "N", n, n, n, 1.0_dp, a, n, m, n, 0.0_dp, step, n)
         call dgemm("N", "T", n, n, n, 1.0_dp, w(1, n + 1), n, a, n, 0.0_dp, m, n)
         call dgemm("N", "N", n, n, n, 1.0_dp, a, n, m, n, 1.0_dp, g, n)
         call dgemm("N", "N", n, n, n, 1.0_dp, a, n, w, n, 0.0_dp, m, n)
         a = m
         h = h + 0.5_dp*(step + transpose(step))
         if (maxval(abs(step)) <= tolerance*maxval(abs(h))) return
      end do
      call fatal_error(error, status%not_converged, "the Riccati equation of the filter did not converge")
   end subroutine solve_riccati

   !> Share of a constant true rate that a filter with this constant gain passes.
   !>
   !> One coefficient: $$ \frac{K}{1 - \phi (1 - K)} $$ With $ c_i = K_2 + \dots + K_i $ and
   !> $ g = K_1 + \sum_i \phi_i c_i $ for any order: $$ \frac{g}{g + (1 - \sum_i \phi_i)(1 - K_1)} $$
   pure real(dp) function dc_gain(phi, gain)
      !> Coefficients, [p], p >= 1
      real(dp), intent(in) :: phi(:)
      !> Gain, [p]
      real(dp), intent(in) :: gain(:)
      real(dp) :: g, c, rest
      integer :: i

      g = gain(1)
      c = 0.0_dp
      do i = 2, size(phi)
         c = c + gain(i)
         g = g + phi(i)*c
      end do
      rest = (1.0_dp - sum(phi))*(1.0_dp - gain(1))
      dc_gain = 0.0_dp
      if (abs(g + rest) > 0.0_dp) dc_gain = g/(g + rest)
   end function dc_gain

   !> Variance of the output over the variance of the input, for an input that is the AR(p) series itself.
   !>
   !> One coefficient, with $ a = \phi (1 - K) $: $$ \frac{K^2}{1 - a^2} \frac{1 + a \phi}{1 - a \phi} $$
   !> More: the Lyapunov equation of series and estimate together, by doubling.
   subroutine output_variance_ratio(phi, gain, ratio, error)
      !> Coefficients of a stationary series, [p], p >= 1
      real(dp), intent(in), contiguous :: phi(:)
      !> Constant gain, [p]
      real(dp), intent(in), contiguous :: gain(:)
      !> Var(output)/Var(input)
      real(dp), intent(out) :: ratio
      !> unstable: the series or the filter is not stable (p > 1; one coefficient is taken as it is)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(2*size(phi), 2*size(phi)) :: a, x, step
      real(dp) :: pole
      integer :: i, n, round

      ratio = 0.0_dp
      n = size(phi)
      if (n == 1) then
         pole = phi(1)*(1.0_dp - gain(1))
         ratio = gain(1)**2/(1.0_dp - pole**2)*(1.0_dp + pole*phi(1))/(1.0_dp - pole*phi(1))
         return
      end if
      a = 0.0_dp
      x = 0.0_dp
      call companion(phi, a(:n, :n))
      call companion(phi, a(n + 1:, n + 1:))
      x(1, 1) = 1.0_dp
      x(n + 1:, 1) = gain
      x(1, n + 1:) = gain
      do i = 1, n                               ! estimate = (I - K H) Phi estimate + K H (Phi series + e1 w)
         a(n + i, :n) = gain(i)*phi
         a(n + i, n + 1:) = a(n + i, n + 1:) - gain(i)*phi
         x(n + i, n + 1:) = gain(i)*gain
      end do
      do round = 1, max_doublings
         step = matmul(a, matmul(x, transpose(a)))
         if (maxval(abs(step)) > explosive) exit
         x = x + step
         ratio = x(n + 1, n + 1)/x(1, 1)
         if (maxval(abs(step)) <= tolerance*maxval(abs(x))) return
         a = matmul(a, a)
      end do
      call fatal_error(error, status%unstable, "the series or the filter is not stable: no stationary variance")
   end subroutine output_variance_ratio

   !> The transition matrix.
   pure subroutine companion(phi, a)
      !> Coefficients, [p]
      real(dp), intent(in) :: phi(:)
      !> Matrix, [p, p], zero on entry
      real(dp), intent(inout) :: a(:, :)
      integer :: i

      a(1, :) = phi
      do i = 2, size(phi)
         a(i, i - 1) = 1.0_dp
      end do
   end subroutine companion
end module gyroakf_filter_state_space
