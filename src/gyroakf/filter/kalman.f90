! SPDX-License-Identifier: MIT
!> The Kalman filter of an AR(p) state, fixed or adaptive (Sage-Husa): made, stepped, run over a
!> series.
!>
!>     call new_filter(filter, phi, q, r, options, error)
!>     do k = 1, n
!>        call step_filter(filter, z(k), x)   ! no allocation; NaN: no measurement
!>     end do
!>
!> The model is x_k = phi_1 x_{k-1} + ... + phi_p x_{k-p} + w_k, z_k = x_k + v_k, with E(w) = q,
!> Var(w) = Q, E(v) = r, Var(v) = R. Each object carries its whole state: different objects may run
!> in different threads.
!>
!> Source: Kalman, Trans. ASME J. Basic Eng. 82 (1960) 35-45; Sage & Husa, JACC 1969; the gate:
!> Huber's weight on the innovation.
module gyroakf_filter_kalman
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_filter_types, only : drift_filter_type, filter_options, filter_type
   use gyroakf_filter_creation, only : new_filter
   use gyroakf_filter_drift_step, only : run_processes
   use gyroakf_filter_components, only : is_sample, settle_distance
   use gyroakf_filter_sage_husa, only : adapt_noise, gate_inflation, watch_level
   use gyroakf_filter_scalar, only : run_scalar
   use gyroakf_filter_state_space, only : predict_covariance, correct_covariance
   implicit none (type, external)
   private
   public :: drift_filter_type, filter_options, filter_type, new_filter, step_filter, &
      run_filter, freeze_filter, step_vector

contains

   !> One step: prediction, and the correction by the measurement if there is one. Allocates
   !> nothing.
   pure subroutine step_filter(filter, z, x)
      !> The filter; its state goes on
      class(filter_type), intent(inout) :: filter
      !> Measurement in the unit of the variances' root; NaN, infinite or beyond 1e149: missing,
      !> only the prediction
      real(dp), intent(in) :: z
      !> Estimate of the state
      real(dp), intent(out) :: x
      real(dp) :: zs(1), xs(1)

      zs(1) = z
      select type (filter)
      type is (drift_filter_type)
         if (filter%model%count > 1) then
            call run_processes(filter, zs, xs)
         else
            call run_scalar(filter%filter_type, 1_int64, zs, xs, state=filter%state)
         end if
      class default
         if (filter%order > 1) then
            call step_order(filter, z, is_sample(z))
            xs(1) = filter%x(1)
         else
            call run_scalar(filter, 1_int64, zs, xs)
         end if
      end select
      x = xs(1)
   end subroutine step_filter

   !> A whole series, or the next part of one: the same numbers as step by step.
   pure subroutine run_filter(filter, z, x, valid, normalized_innovation)
      !> The filter; its state goes on
      class(filter_type), intent(inout) :: filter
      !> Measurements, [n]; NaN, infinite or beyond 1e149: missing
      real(dp), intent(in), contiguous :: z(:)
      !> Estimates, [n]; not the same array as z
      real(dp), intent(out), contiguous :: x(:)
      !> 1 where the measurement is present, 0 where it is missing, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Innovations over their standard deviations, [n], 0 where missing (not contiguous, as valid:
      !> gfortran 12 reads an absent contiguous array that is passed on)
      real(dp), intent(out), optional :: normalized_innovation(:)
      integer(int64) :: n

      n = size(z, kind=int64)
      select type (filter)
      type is (drift_filter_type)
         if (filter%model%count > 1) then
            call run_processes(filter, z, x, valid, normalized_innovation)
         else
            call run_scalar(filter%filter_type, n, z, x, valid, normalized_innovation, filter%state)
         end if
      class default
         if (filter%order > 1) then
            call run_vector(filter, z, x, valid, normalized_innovation)
         else
            call run_scalar(filter, n, z, x, valid, normalized_innovation)
         end if
      end select
   end subroutine run_filter

   !> No adaptation of q, r, Q, R from here on, or adaptation again; the state goes on either way.
   !>
   !> While the sensor rotates freeze, and give NaN instead of the measurement: the drift is then
   !> predicted.
   pure subroutine freeze_filter(filter, frozen)
      !> The filter
      class(filter_type), intent(inout) :: filter
      !> Whether it is frozen
      logical, intent(in) :: frozen

      filter%frozen = frozen
   end subroutine freeze_filter

   !> The filter of any order over a series.
   pure subroutine run_vector(filter, z, x, valid, normalized_innovation)
      type(filter_type), intent(inout) :: filter
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: x(:)
      integer(int8), intent(in), optional :: valid(:)
      real(dp), intent(out), optional :: normalized_innovation(:)
      integer(int64) :: k
      logical :: here

      do k = 1, size(z, kind=int64)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         call step_order(filter, z(k), here)
         x(k) = filter%x(1)
         if (present(normalized_innovation)) then
            normalized_innovation(k) = 0.0_dp
            if (here) normalized_innovation(k) = filter%innovation/sqrt(filter%innovation_variance)
         end if
      end do
   end subroutine run_vector

   !> One step of any order.
   pure subroutine step_order(filter, z, here)
      type(filter_type), intent(inout), target :: filter
      real(dp), intent(in) :: z
      logical, intent(in) :: here

      call step_vector(filter, filter%order, filter%phi, filter%steady_gain, filter%x, &
         & filter%gain, filter%work, filter%p, z, here)
      if (.not. here) return
      filter%gain_sum = filter%gain_sum + filter%gain
      filter%gain_measurements = filter%gain_measurements + 1
   end subroutine step_order

   !> One step of any order: prediction, and the correction by the measurement if there is one. The
   !> arrays are those of a filter, or of a caller who keeps them; nothing is allocated.
   pure subroutine step_vector(filter, n, phi, steady_gain, x, gain, work, p, z, here)
      !> Its numbers; its arrays are not looked at, and may be those that follow
      type(filter_type), intent(inout), target :: filter
      !> Order
      integer, intent(in) :: n
      !> Coefficients, gain that it settles to: [n]
      real(dp), intent(in) :: phi(n), steady_gain(n)
      !> State, gain, work array: [n]; covariance: [n, n]
      real(dp), intent(inout) :: x(n), gain(n), work(n), p(n, n)
      !> Measurement
      real(dp), intent(in) :: z
      !> Whether there is one
      logical, intent(in) :: here
      real(dp) :: first, prior, inflation, s
      integer :: i

      filter%steps = filter%steps + 1
      first = dot_product(phi, x) + filter%q_mean
      do i = n, 2, -1
         x(i) = x(i - 1)
      end do
      x(1) = first
      if (.not. (here .and. filter%settled)) call predict_covariance(phi, filter%q, p, work)
      if (.not. here) then
         filter%settled = .false.
         return
      end if
      filter%innovation = z - first - filter%r_mean
      if (.not. filter%settled) then
         prior = p(1, 1)
         filter%innovation_variance = prior + filter%r
         inflation = gate_inflation(filter%options%huber, filter%innovation, &
            & filter%innovation_variance)
         call correct_covariance(filter%r*inflation, p, gain, s)
         call watch_level(filter, inflation, p(1, 1))
         if (filter%adaptive .and. .not. filter%frozen) then
            call adapt_noise(filter, filter%innovation, filter%innovation_variance, prior)
         end if
         if (.not. filter%varying) filter%settled = &
            & maxval(abs(gain - steady_gain)) <= settle_distance(maxval(abs(steady_gain)))
      end if
      x = x + gain*filter%innovation
      filter%measurements = filter%measurements + 1
   end subroutine step_vector

end module gyroakf_filter_kalman
