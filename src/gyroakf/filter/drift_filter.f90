! SPDX-License-Identifier: MIT
!> A filter is made whose output is the drift: a random walk, AR(1) processes, or both, in white
!> noise.
!>
!>     call new_drift_filter(filter, model, slow, options, error)
!>     do k = 1, n
!>        call step_filter(filter, z(k), drift)   ! no allocation; NaN: no measurement
!>     end do
!>
!> $$ x_{i,k} = \phi_i x_{i,k-1} + w_{i,k}, \quad z_k = \sum_i x_{i,k} + v_k, \quad
!>    \mathrm{Var}\,w_i = q_i, \quad \mathrm{Var}\,v = R, \quad b_k = \sum_{i\,slow} x_{i,k} $$
!> What is filtered is the model; what counts as drift is the caller's word: fast processes are
!> noise with a memory. Only R is adapted: of Q and R together the innovations show the sum, and a Q
!> that follows them takes a louder sensor for a faster drift.
module gyroakf_filter_drift_filter
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_components, only : component_model_type, component_state_type, &
      most_components, check_components, start_components, predict_components, correct_components
   use gyroakf_filter_creation, only : check_options, set_adaptation, shortest_burn_in, &
      longest_burn_in, burn_in_tolerance
   use gyroakf_filter_drift_steady, only : steady_drift_gain
   use gyroakf_filter_drift_step, only : show_drift
   use gyroakf_filter_filter_types, only : drift_filter_type, filter_options
   implicit none (type, external)
   private
   public :: new_drift_filter

contains

   !> Makes a drift filter.
   !>
   !> A random walk is not known before its first measurement, which sets it and has no innovation;
   !> the other processes begin stationary. With `initial_variance` all of them, the walk too, begin
   !> at 0 with that variance.
   subroutine new_drift_filter(filter, model, slow, options, error)
      !> The filter; `step_filter`, `run_filter`, `freeze_filter` and `filter_series` work on it
      type(drift_filter_type), intent(out) :: filter
      !> Processes and white noise; r > 0 where it is adapted
      type(component_model_type), intent(in) :: model
      !> Which processes are the drift, [count], one at least
      logical, intent(in) :: slow(:)
      !> Only `estimate_measurement_variance` may be set; forms residual, exact, biased; the bounds
      !> of Q do not count
      type(filter_options), intent(in) :: options
      !> invalid_argument, non_finite, unstable (the model); not_converged, singular (its steady
      !> gain)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call check_components(model, error)
      if (.not. allocated(error)) call check_options(options, error)
      if (.not. allocated(error)) call check_drift_options(model, slow, options, error)
      if (allocated(error)) return
      allocate (filter%phi(1), filter%x(1), filter%p(1, 1), filter%gain(1), &
         filter%gain_sum(model%count), filter%steady_gain(1))
      filter%order = 1
      ! what is beyond the count is anything
      filter%model%count = model%count
      filter%model%phi(:model%count) = model%phi(:model%count)
      filter%model%q(:model%count) = model%q(:model%count)
      filter%model%r = model%r
      filter%slow(:model%count) = slow
      filter%shifted = maxloc(model%phi(:model%count), 1)
      filter%phi(1) = maxval(model%phi(:model%count), mask=slow)
      filter%q = sum(model%q(:model%count), mask=slow)
      filter%r = model%r
      filter%options = options
      ! half the variance of the differences of a series of the model
      if (.not. options%r_scale > 0.0_dp) filter%options%r_scale = model%r &
         + sum(model%q(:model%count)/(1.0_dp + model%phi(:model%count)))
      filter%gain_sum = 0.0_dp
      call set_adaptation(filter%filter_type)
      call start_components(model, filter%state)
      if (options%initial_variance > 0.0_dp) then
         do i = 1, model%count
            filter%state%p(i, i) = options%initial_variance
         end do
         filter%state%started = .true.
      end if
      call show_drift(filter)
      if (.not. (all(ieee_is_finite(filter%state%p)) &
         .and. ieee_is_finite(filter%p(1, 1)))) then
         call fatal_error(error, status%non_finite, &
            "the variances of a drift filter overflow: those of the model, and the "// &
                          "initial one, are too far apart")
         return
      end if
      call find_steady(filter, error)
   end subroutine new_drift_filter

   !> Options and words that a drift filter does not take.
   subroutine check_drift_options(model, slow, options, error)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(filter_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      if (size(slow) /= model%count) then
         call fatal_error(error, status%invalid_argument, &
            "a drift filter needs a word for each process: drift or not")
      else if (.not. any(slow)) then
         call fatal_error(error, status%invalid_argument, &
            "no process of the model counts as drift: there is nothing to filter")
      else if (options%estimate_process_variance .or. options%estimate_process_mean &
         .or. options%estimate_measurement_mean) then
         call fatal_error(error, status%invalid_argument, &
            "a drift filter adapts R only: Q beside it is not identifiable, "// &
                          "and a mean of the noise is the drift")
      else if (options%measurement_form == "paper") then
         call fatal_error(error, status%invalid_argument, &
            "a drift filter adapts R in the forms residual, exact and biased")
      end if
   end subroutine check_drift_options

   !> Steady gain, and the burn-in where it is automatic: with the R that the bounds' scale
   !> suggests, for a wrong R at the start must not prolong the time that it is kept.
   subroutine find_steady(filter, error)
      type(drift_filter_type), intent(inout) :: filter
      type(error_type), allocatable, intent(out) :: error
      type(component_model_type) :: model
      type(component_state_type) :: state
      real(dp) :: gain(most_components)
      integer :: k, n

      n = filter%model%count
      model = filter%model
      model%r = filter%r
      call steady_drift_gain(model, filter%steady_gains, error)
      if (allocated(error)) return
      filter%steady_gain(1) = sum(filter%steady_gains(:n), mask=filter%slow(:n))
      if (filter%options%burn_in >= 0) return
      model%r = filter%options%r_scale
      call steady_drift_gain(model, gain, error)
      if (allocated(error)) return
      state = filter%state
      do k = 1, longest_burn_in
         if (state%started) call predict_components(model, state)
         call correct_components(n, model%r, 0.0_dp, state)
         if (maxval(abs(state%gain(:n) - gain(:n))) <= burn_in_tolerance*maxval(gain(:n))) exit
      end do
      filter%wait = max(shortest_burn_in, min(k, longest_burn_in))
   end subroutine find_steady
end module gyroakf_filter_drift_filter
