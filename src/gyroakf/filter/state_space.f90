! SPDX-License-Identifier: MIT
!> The AR(p) state space: covariance recursions that use its shift structure, and what a fixed gain
!> does to a series.
!>
!> The state is the companion form of x_k = phi_1 x_{k-1} + ... + phi_p x_{k-p} + w_k, Var(w) = q;
!> the measurement is z_k = x_k + v_k, Var(v) = r. The first row of the transition matrix is phi,
!> the ones below the diagonal only shift: a step costs O(p^2), no matrix product is formed.
module gyroakf_filter_state_space
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: predict_covariance, correct_covariance, stationary_covariance, companion, shifted
   public :: dc_gain, output_variance_ratio

   !> Relative change at which a doubling iteration has converged, doublings after which it failed
   real(dp), parameter :: tolerance = 1.0e-15_dp
   integer, parameter :: max_doublings = 60
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

   !> Gain and posterior covariance, in place:
   !> $$ K = P e_1 / S,\quad P \leftarrow P - K S K^T,\quad S = P_{11} + r $$
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

   !> Stationary covariance of the state: the Toeplitz matrix of the autocovariances of the AR(p)
   !> series,
   !> which solves the Lyapunov equation $$ P = \Phi P \Phi^T + q\, e_1 e_1^T $$
   !>
   !> The coefficients of the lower orders are found by the Levinson recursion run downwards; the
   !> series is stationary exactly when all reflection coefficients are below 1 in magnitude.
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
      call check_memory(stat, "the covariance of the filter", error)
      if (allocated(error)) return
      lower(:, n) = phi
      r(0) = q
      do m = n, 1, -1
         reflection = lower(m, m)
         if (abs(reflection) >= 1.0_dp) then
            call fatal_error(error, status%unstable, &
               "the autoregressive coefficients are not those of a stationary series")
            return
         end if
         r(0) = r(0)/((1.0_dp - reflection)*(1.0_dp + reflection))
         do i = 1, m - 1
            lower(i, m - 1) = (lower(i, m) + reflection*lower(m - i, m))/((1.0_dp &
               - reflection)*(1.0_dp + reflection))
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

   !> Share of a constant true rate that a filter with this constant gain passes.
   !>
   !> One coefficient: $$ \frac{K}{1 - \phi (1 - K)} $$ With $ c_i = K_2 + \dots + K_i $ and
   !> $ g = K_1 + \sum_i \phi_i c_i $ for any order:
   !> $$ \frac{g}{g + (1 - \sum_i \phi_i)(1 - K_1)} $$
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

   !> Variance of the output over the variance of the input, for an input that is the AR(p) series
   !> itself.
   !>
   !> One coefficient, with $ a = \phi (1 - K) $:
   !> $$ \frac{K^2}{1 - a^2} \frac{1 + a \phi}{1 - a \phi} $$
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
      ! estimate = (I - K H) Phi estimate + K H (Phi series + e1 w)
      do i = 1, n
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
      call fatal_error(error, status%unstable, &
         "the series or the filter is not stable: no stationary variance")
   end subroutine output_variance_ratio

   !> The transition matrix.
   pure subroutine companion(phi, a)
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
