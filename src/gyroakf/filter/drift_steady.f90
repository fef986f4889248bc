! SPDX-License-Identifier: MIT
!> What a drift filter comes to: the gain that it settles to, and what it passes of a constant rate.
module gyroakf_filter_drift_steady
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type, most_components
   use gyroakf_filter_steady_gain, only : solve_riccati, steady_prior
   implicit none (type, external)
   private
   public :: steady_drift_gain, steady_covariance, sum_powers, drift_dc_gain

   !> Newton's steps of a covariance
   integer, parameter :: newton_steps = 2
   !> Doublings of a sum of powers at most, before an eigenvalue of 1 that is rounded up runs away,
   !> and what is left of L at the last of them
   integer, parameter :: most_doublings = 52
   real(dp), parameter :: left = 1.0e-9_dp

contains

   !> Gain of each process once the filter with constant variances has settled.
   subroutine steady_drift_gain(model, gain, error)
      !> Checked (check_components)
      type(component_model_type), intent(in) :: model
      !> Gains, 0 of a process without driving noise, which is known in the end; all 0 where r is 0,
      !> or nothing beside the driving noises, and there are more processes than one: left open
      real(dp), intent(out) :: gain(most_components)
      !> As steady_covariance
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: p(most_components, most_components)

      gain = 0.0_dp
      if (count(model%q > 0.0_dp) > 1 .and. model%r <= epsilon(1.0_dp)*sum(model%q)) return
      call steady_covariance(model, p, error)
      gain = sum(p, 1)
      if (any(gain > 0.0_dp)) gain = gain/(sum(gain) + model%r)
   end subroutine steady_drift_gain

   !> Covariance of the prediction to which a filter with constant variances settles: of one process
   !> the closed form of [[steady_prior]], of more the Riccati equation by doubling.
   !>
   !> Newton's steps give the small elements the precision of the large ones. It is solved for the
   !> covariance X behind the measurement, $ P = \Phi X \Phi^T + Q $: for that the next measurement
   !> has the noise $ \rho = r + \sum_i q_i $, which is not 0 where r is, correlated with the
   !> driving noise; without the part known from the measurement, the transition is $ \Phi - Q
   !> \mathbf 1 \phi^T/\rho $ and the noise $ Q - Q \mathbf 1 \mathbf 1^T Q/\rho $.
   subroutine steady_covariance(model, p, error)
      !> Checked (check_components)
      type(component_model_type), intent(in) :: model
      !> 0 for a process without driving noise
      real(dp), intent(out) :: p(most_components, most_components)
      !> not_converged, singular: the Riccati iteration failed; no_memory
      type(error_type), allocatable, intent(out) :: error
      type(component_model_type) :: driven
      real(dp), allocatable :: a(:, :), h(:, :)
      integer, allocatable :: at(:)
      real(dp), allocatable :: l(:, :), rest(:, :, :), share(:)
      real(dp) :: rho, s
      integer :: i, j, n, round

      p = 0.0_dp
      at = pack([(i, i=1, model%count)], model%q(:model%count) > 0.0_dp)
      n = size(at)
      driven%count = n
      driven%phi(:n) = model%phi(at)
      rho = sum(model%q(at)) + model%r
      driven%q(:n) = model%q(at)/rho
      driven%r = model%r/rho
      if (n == 1) then
         p(at(1), at(1)) = model%q(at(1))
         if (model%r > 0.0_dp) p(at(1), at(1)) = steady_prior(driven%phi(1), model%q(at(1)), &
            model%r)
      end if
      if (n <= 1) return
      allocate (a(n, n), h(n, n), l(n, n), rest(1, n, n))
      associate (phi => driven%phi(:n), q => driven%q(:n))
         do j = 1, n
            do i = 1, n
               a(i, j) = -q(i)*phi(j)
               h(i, j) = -q(i)*q(j)
            end do
            a(j, j) = (1.0_dp - q(j))*phi(j)
            h(j, j) = q(j)*(driven%r + sum(q(:j - 1)) + sum(q(j + 1:)))
         end do
      end associate
      call solve_riccati(a, driven%phi(:n), h, error)
      if (allocated(error)) return
      a = 0.0_dp
      associate (phi => driven%phi(:n), q => driven%q(:n))
         do j = 1, n
            a(:, j) = h(:, j)*phi*phi(j)
            a(j, j) = a(j, j) + q(j)
         end do
         do round = 1, newton_steps
            share = sum(a, 1)
            s = sum(share) + driven%r
            do j = 1, n
               do i = 1, n
                  l(i, j) = phi(i)*(merge(1.0_dp, 0.0_dp, i == j) - share(i)/s)
                  rest(1, i, j) = (phi(i)*phi(j) - 1.0_dp)*a(i, j) &
                     - phi(i)*phi(j)*share(i)*share(j)/s
               end do
               rest(1, j, j) = rest(1, j, j) + q(j)
            end do
            call sum_powers(l, rest)
            a = a + rest(1, :, :)
         end do
      end associate
      p(at, at) = rho*a
   end subroutine steady_covariance

   !> $ R + L R L^T + L^2 R (L^2)^T + \dots $, by doubling.
   pure subroutine sum_powers(l, rest)
      !> [n, n]; a power of it afterwards
      real(dp), intent(inout) :: l(:, :)
      !> Some R, the sums afterwards: [any, n, n]
      real(dp), intent(inout) :: rest(:, :, :)
      real(dp) :: half(size(rest, 1), size(l, 1), size(l, 1))
      integer :: i, j, n, round

      n = size(l, 1)
      do round = 1, most_doublings
         do j = 1, n
            do i = 1, n
               half(:, i, j) = matmul(rest(:, i, :), l(j, :))
            end do
         end do
         do j = 1, n
            do i = 1, n
               rest(:, i, j) = rest(:, i, j) + matmul(half(:, :, j), l(i, :))
            end do
         end do
         if (maxval(abs(l)) < left) exit
         l = matmul(l, l)
      end do
   end subroutine sum_powers

   !> Share of a constant true rate that a drift filter with constant gains passes.
   !>
   !> $$ \frac{\sum_{i\,slow} K_i m_i}{\prod_i (1 - \phi_i) + \sum_i \phi_i K_i m_i},
   !>    \quad m_i = \prod_{j \ne i} (1 - \phi_j) $$
   !> A random walk that is driven takes all of it in the end.
   pure real(dp) function drift_dc_gain(model, slow, gain)
      !> The model
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift, [count]
      logical, intent(in) :: slow(:)
      !> Gains of the processes, [count]
      real(dp), intent(in) :: gain(:)
      real(dp) :: others, passed, total
      integer :: i, j

      passed = 0.0_dp
      total = 1.0_dp
      do i = 1, model%count
         total = total*(1.0_dp - model%phi(i))
      end do
      do i = 1, model%count
         others = gain(i)
         do j = 1, model%count
            if (j /= i) others = others*(1.0_dp - model%phi(j))
         end do
         if (slow(i)) passed = passed + others
         total = total + model%phi(i)*others
      end do
      drift_dc_gain = 0.0_dp
      if (abs(total) > 0.0_dp) drift_dc_gain = passed/total
   end function drift_dc_gain
end module gyroakf_filter_drift_steady
