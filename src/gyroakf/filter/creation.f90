! SPDX-License-Identifier: MIT
!> A filter is made: its arguments tested, its state and the limits of its adaptation set.
module gyroakf_filter_creation
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_filter_filter_types, only : filter_options, filter_type
   use gyroakf_filter_state_space, only : predict_covariance, correct_covariance, &
      stationary_covariance, shifted
   use gyroakf_filter_steady_gain, only : long_order, settle_column, steady_state
   use gyroakf_filter_sage_husa, only : consistency_factor
   use gyroakf_filter_components, only : is_sample
   implicit none (type, external)
   private
   public :: new_filter, check_options, set_adaptation, shorten_burn_in, shortest_burn_in, &
      longest_burn_in, burn_in_tolerance

   !> Largest state
   integer, parameter :: largest_order = 1000
   !> b^(k+1) below this no longer changes the weight d_k
   real(dp), parameter :: weight_resolution = 1.0e-17_dp
   !> Automatic burn-in: at least, at most so many measurements; relative distance from the steady
   !> gain
   integer, parameter :: shortest_burn_in = 20, longest_burn_in = 5000
   !> It takes at most one in so many samples of a record
   integer, parameter :: burn_in_share = 10
   real(dp), parameter :: burn_in_tolerance = 1.0e-6_dp
   !> Gates in standard deviations: a smaller one sees nothing else, and R over its weight
   !> overflows; a larger one never acts
   real(dp), parameter :: smallest_gate = 1.0e-3_dp, largest_gate = 1.0e6_dp

contains

   !> Makes a filter from an AR(p) model and the variances of its noises.
   !>
   !> The state starts at zero with the stationary covariance, or with `initial_variance` on the
   !> diagonal. No coefficients at all (a white series) is the model of one coefficient that
   !> is zero: the filter then only scales, x = K z with K = Q/(Q + R); there is nothing to predict.
   subroutine new_filter(filter, phi, q, r, options, error)
      !> The filter
      type(filter_type), intent(out) :: filter
      !> Coefficients, [p], p = 0 ... 1000, of a stationary series (p = 1 and
      !> `initial_variance` > 0: also 1, the random walk)
      real(dp), intent(in) :: phi(:)
      !> Variances Q of the driving and R of the measurement noise, unit of the series squared, >=
      !> 0, not both 0; > 0 where adapted
      real(dp), intent(in) :: q, r
      !> What is adapted, and how
      type(filter_options), intent(in) :: options
      !> invalid_argument, non_finite, unstable, no_memory, not_converged, singular
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: prior(:, :)
      integer :: i, n, stat

      call check_numbers(phi, q, r, options, error)
      if (allocated(error)) return
      n = max(1, size(phi))
      allocate (filter%p(n, n), stat=stat)
      if (stat == 0) allocate (prior(n, n), stat=stat)
      call check_memory(stat, "the state of the filter", error)
      if (allocated(error)) return
      allocate (filter%phi(n), filter%x(n), filter%gain(n), filter%gain_sum(n), &
         filter%steady_gain(n), filter%work(n))
      filter%order = n
      filter%options = options
      filter%phi = 0.0_dp
      filter%phi(:size(phi)) = phi
      filter%x = 0.0_dp
      filter%gain = 0.0_dp
      filter%gain_sum = 0.0_dp
      filter%work = 0.0_dp
      filter%q = q
      filter%r = r
      filter%asked_q = q
      filter%asked_r = r
      call set_adaptation(filter)
      if (n > 1 .or. .not. options%initial_variance > 0.0_dp .or. abs(filter%phi(1)) > 1.0_dp) then
         call stationary_covariance(filter%phi, q, filter%p, error)
         if (allocated(error)) return
      end if
      if (options%initial_variance > 0.0_dp) then
         filter%p = 0.0_dp
         do i = 1, n
            filter%p(i, i) = options%initial_variance
         end do
      end if
      call steady_state(filter%phi, filter%q, filter%r, filter%steady_gain, prior, error)
      if (allocated(error)) return
      if (options%burn_in < 0) call find_burn_in(filter, prior, error)
   end subroutine new_filter

   !> The arguments of new_filter, tested.
   subroutine check_numbers(phi, q, r, options, error)
      real(dp), intent(in) :: phi(:), q, r
      type(filter_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      if (.not. (all(is_sample(phi)) .and. is_sample(q) .and. is_sample(r))) then
         call fatal_error(error, status%non_finite, &
            "a filter's coefficients and variances must be finite numbers")
      else if (size(phi) > largest_order) then
         call fatal_error(error, status%invalid_argument, "the order of a filter is at most 1000")
      else if (q < 0.0_dp .or. r < 0.0_dp .or. .not. q + r > tiny(1.0_dp)) then
         call fatal_error(error, status%invalid_argument, &
            "a filter needs variances Q >= 0 and R >= 0, not both zero")
      else if (options%estimate_process_variance .and. .not. q > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, &
            "Q must start above zero where it is adapted")
      else if (options%estimate_measurement_variance &
         .and. .not. max(r, options%r_scale) > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, &
            "R, or the scale of its bounds, must be above zero where it is adapted")
      else
         call check_options(options, error)
      end if
   end subroutine check_numbers

   !> Options that do not depend on the model.
   subroutine check_options(options, error)
      !> The options
      type(filter_options), intent(in) :: options
      !> invalid_argument, non_finite
      type(error_type), allocatable, intent(out) :: error

      if (.not. (is_sample(options%r_scale) .and. is_sample(options%initial_variance) &
         .and. is_sample(options%forgetting) .and. is_sample(options%huber))) then
         call fatal_error(error, status%non_finite, &
            "the options of a filter must be finite numbers")
      else if (.not. (options%forgetting > 0.0_dp .and. options%forgetting <= 1.0_dp)) then
         call fatal_error(error, status%invalid_argument, &
            "the forgetting factor must lie in 0 < b <= 1")
      else if (options%huber < 0.0_dp .or. options%initial_variance < 0.0_dp &
         .or. options%r_scale < 0.0_dp) then
         call fatal_error(error, status%invalid_argument, &
            "the gate, the initial variance and the scale of R cannot be negative")
      else if (options%huber > 0.0_dp &
         .and. (options%huber < smallest_gate .or. options%huber > largest_gate)) then
         call fatal_error(error, status%invalid_argument, &
            "the gate must be 0 (none) or 0.001 to 1e6 standard deviations")
      else if (.not. (all_ordered(options%q_lower, options%q_upper) &
         .and. all_ordered(options%r_lower, options%r_upper))) then
         call fatal_error(error, status%invalid_argument, &
            "bounds of a variance must satisfy 0 < lower <= upper")
      else if (options%estimate_process_mean .and. options%estimate_measurement_mean &
         .and. .not. options%allow_unobservable) then
         call fatal_error(error, status%invalid_argument, &
            "the means q and r are not identifiable together: a constant offset "// &
                          "may be in either; adapt one of them, or set allow_unobservable")
      else
         select case (options%measurement_form)
         case ("residual", "exact", "biased", "paper")
         case default
            call fatal_error(error, status%invalid_argument, &
               "unknown form of the adaptation of R: " &
                             //trim(options%measurement_form)//" (residual, exact, biased, paper)")
         end select
      end if
   end subroutine check_options

   !> Whether 0 < lower <= upper, both finite.
   pure logical function all_ordered(lower, upper)
      real(dp), intent(in) :: lower, upper

      all_ordered = is_sample(lower) .and. is_sample(upper)
      if (all_ordered) all_ordered = lower > 0.0_dp .and. lower <= upper
   end function all_ordered

   !> Flags, bounds and counters of the adaptation; Q and R that start beyond their bounds start at
   !> them.
   pure subroutine set_adaptation(filter)
      !> Its options, q and r are set
      type(filter_type), intent(inout) :: filter
      real(dp) :: scale, updates

      associate (options => filter%options)
         filter%adaptive = options%estimate_process_mean .or. options%estimate_measurement_mean &
            .or. options%estimate_process_variance .or. options%estimate_measurement_variance
         filter%varying = filter%adaptive .or. options%huber > 0.0_dp
         filter%by_residual = options%measurement_form == "residual" &
            .or. options%measurement_form == "biased"
         filter%by_posterior = options%measurement_form == "paper" &
            .or. options%measurement_form == "biased"
         scale = filter%r
         if (options%r_scale > 0.0_dp) scale = options%r_scale
         filter%q_bounds = filter%q*[options%q_lower, options%q_upper]
         filter%r_bounds = scale*[options%r_lower, options%r_upper]
         if (options%estimate_measurement_variance) filter%r = &
            min(max(filter%r, filter%r_bounds(1)), filter%r_bounds(2))
         filter%weight = 1.0_dp
         filter%weight_updates = huge(1)
         if (options%forgetting < 1.0_dp) then
            updates = log(weight_resolution)/log(options%forgetting)
            if (updates < real(huge(1), dp)) filter%weight_updates = ceiling(updates)
         end if
         filter%wait = max(0, options%burn_in)
         filter%consistency = 1.0_dp
         if (options%huber > 0.0_dp) filter%consistency = consistency_factor(options%huber)
      end associate
   end subroutine set_adaptation

   !> Measurements until the gain is the steady one, with the R that the scale of its
   !> bounds suggests: a wrong R at the start must not prolong the time that it is kept.
   subroutine find_burn_in(filter, p, error)
      type(filter_type), intent(inout) :: filter
      real(dp), intent(inout), contiguous :: p(:, :)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: gain(filter%order), column(filter%order), r, s, steady
      logical :: quick
      integer :: k

      r = filter%r
      if (filter%options%r_scale > 0.0_dp) r = filter%options%r_scale
      call steady_state(filter%phi, filter%q, r, gain, p, error)
      if (allocated(error)) return
      steady = gain(1)
      p = filter%p
      quick = filter%order >= long_order .and. .not. filter%options%initial_variance > 0.0_dp
      column = p(:, 1)
      filter%work = shifted(filter%phi, column)
      do k = 1, longest_burn_in
         if (quick) then                                 ! from the stationary covariance on
            gain(1) = column(1)/(column(1) + r)
            call settle_column(filter%phi, r, -1.0_dp, column, filter%work)
         else
            call predict_covariance(filter%phi, filter%q, p, filter%work)
            call correct_covariance(r, p, gain, s)
         end if
         if (abs(gain(1) - steady) <= burn_in_tolerance*steady) exit
      end do
      filter%work = 0.0_dp
      filter%wait = max(shortest_burn_in, min(k, longest_burn_in))
   end subroutine find_burn_in

   !> Leaves most of a short record to the adaptation.
   pure subroutine shorten_burn_in(filter, samples)
      !> As made
      type(filter_type), intent(inout) :: filter
      !> Samples of the record; 0: not known
      integer(int64), intent(in) :: samples

      if (samples <= 0) return
      filter%wait = int(min(int(filter%wait, int64), samples/burn_in_share))
      ! that of the filter made again: saved, reset
      filter%options%burn_in = filter%wait
   end subroutine shorten_burn_in
end module gyroakf_filter_creation
