! SPDX-License-Identifier: MIT
!> What a drift filter comes to: the gain that it settles to, and what it passes of a constant rate.
module gyroakf_filter_drift_steady
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type, component_state_type, most_components, &
      predict_components, correct_components
   use gyroakf_filter_state_space, only : solve_riccati, steady_prior
   implicit none (type, external)
   private
   public :: steady_drift_gain, drift_dc_gain

   !> Steps of the filter itself that polish the solution
   integer, parameter :: polishing = 8
   !> White noise less than this share of the driving noises is lost in the rounding of the Riccati equation
   real(dp), parameter :: lost = epsilon(1.0_dp)

contains

   !> Gain of each process once the filter with constant variances has settled.
   !>
   !> One process: the closed form
   !> $$ P^- = \tfrac12 \left[ c + \sqrt{c^2 + 4 q r} \right],\quad c = q - r (1 - \phi^2),\quad K = P^-/(P^- + r) $$
   !> More: the Riccati equation by doubling. A process without driving noise is known in the end: its gain is 0.
   subroutine steady_drift_gain(model, gain, error)
      !> Checked (check_components)
      type(component_model_type), intent(in) :: model
      !> Gains; all 0 where r is 0, or nothing beside the driving noises, and there are more processes than one: not known
      real(dp), intent(out) :: gain(most_components)
      !> not_converged, singular: the Riccati iteration failed
      type(error_type), allocatable, intent(out) :: error
      type(component_model_type) :: driven
      real(dp) :: part(most_components)
      integer :: i, n

      gain = 0.0_dp
      n = model%count
      driven%count = count(model%q(:n) > 0.0_dp)
      if (driven%count == 0) return
      driven%phi(:driven%count) = pack(model%phi(:n), model%q(:n) > 0.0_dp)
      driven%q(:driven%count) = pack(model%q(:n), model%q(:n) > 0.0_dp)
      driven%r = model%r
      if (driven%count == 1) then
         part(1) = steady_of_one(driven)
      else if (model%r > lost*sum(driven%q)) then
         call steady_of_many(driven, part, error)
         if (allocated(error)) return
      else
         return
      end if
      driven%count = 0
      do i = 1, n
         if (.not. model%q(i) > 0.0_dp) cycle
         driven%count = driven%count + 1
         gain(i) = part(driven%count)
      end do
   end subroutine steady_drift_gain

   !> The closed form.
   pure real(dp) function steady_of_one(model) result(gain)
      !> One process with driving noise
      type(component_model_type), intent(in) :: model
      real(dp) :: prior

      if (.not. model%r > 0.0_dp) then
         gain = 1.0_dp
         return
      end if
      prior = steady_prior(model%phi(1), model%q(1), model%r)
      gain = prior/(prior + model%r)
   end function steady_of_one

   !> The Riccati equation, in units of r.
   subroutine steady_of_many(model, gain, error)
      !> Two processes or three, all with driving noise, r > 0
      type(component_model_type), intent(in) :: model
      !> Their gains
      real(dp), intent(out) :: gain(most_components)
      !> As solve_riccati
      type(error_type), allocatable, intent(out) :: error
      type(component_state_type) :: state
      type(component_model_type) :: scaled
      real(dp), dimension(model%count, model%count) :: a, g, h
      integer :: i, n

      n = model%count
      scaled = model
      scaled%q = model%q/model%r
      scaled%r = 1.0_dp
      a = 0.0_dp
      g = 1.0_dp
      h = 0.0_dp
      do i = 1, n
         a(i, i) = scaled%phi(i)
         h(i, i) = scaled%q(i)
      end do
      call solve_riccati(a, g, h, error)
      if (allocated(error)) return
      state%p(:n, :n) = h
      do i = 1, polishing
         call correct_components(n, scaled%r, 0.0_dp, state)
         call predict_components(scaled, state)
      end do
      call correct_components(n, scaled%r, 0.0_dp, state)
      gain = state%gain
   end subroutine steady_of_many

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
