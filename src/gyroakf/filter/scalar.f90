! SPDX-License-Identifier: MIT
!> The filter of a state of one coefficient over many samples, everything in registers.
!>
!> The same recursion as the general one (gyroakf_filter_kalman, gyroakf_filter_sage_husa), written
!> out because a step of a few nanoseconds is wanted: the numbers of both agree to rounding, and a
!> test says so.
module gyroakf_filter_scalar
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_components, only : component_state_type, exponent_limit, exponent_mask, &
      settle_distance, vanished
   use gyroakf_filter_filter_types, only : filter_type
   use gyroakf_filter_sage_husa, only : longest_run, shift_variance
   implicit none (type, external)
   private
   public :: run_scalar

   !> State and constants of a step: scalars only, so that the compiler keeps a local of this type
   !> in registers. It does so only while no component is an argument of a procedure that is not
   !> inlined (no public one is in position-independent code); else every step goes through memory.
   !> No two components that adaptation changes are neighbors both here and in the filter: a pair
   !> loaded just after its halves were stored stalls store forwarding
   type :: scalar_filter_type
      real(dp) :: phi, phi2, state, p, r_mean, q, weight, r, forgetting, q_mean
      real(dp) :: prior, s, gain, share, innovation, square, clipped
      real(dp) :: gate, inverse_consistency, q_low, q_high, r_low, r_high
      real(dp) :: gain_sum, steady_gain, pole
      integer(int64) :: used, clamped, gated, q_floor, r_floor
      integer :: wait, updates, run
      logical :: adapt, adapt_q_mean, adapt_r_mean, adapt_q, adapt_r, by_residual, by_posterior
      logical :: has_gate, varying, settled, started
   end type scalar_filter_type

contains

   !> What `is_sample` says, private here so that it is inlined in position-independent code too.
   elemental logical function is_number(z)
      real(dp), intent(in) :: z

      is_number = iand(shiftr(transfer(z, 0_int64), 52), exponent_mask) < exponent_limit
   end function is_number

   !> The filter over a series, or the next part of one. A single sample takes this way too:
   !> `advance` is inlined as long as nothing else calls it.
   pure subroutine run_scalar(filter, n, z, x, valid, normalized_innovation, state)
      !> Of order 1; its state goes on
      type(filter_type), intent(inout) :: filter
      !> Samples
      integer(int64), intent(in) :: n
      !> Measurements, and estimates
      real(dp), intent(in) :: z(n)
      real(dp), intent(out) :: x(n)
      !> 1 where the measurement is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Innovations over their standard deviations, [n], 0 where missing
      real(dp), intent(out), optional :: normalized_innovation(:)
      !> Of the process of a drift filter
      type(component_state_type), intent(inout), optional :: state
      type(scalar_filter_type) :: f
      integer(int64) :: k
      logical :: here

      call load(filter, f)
      f%started = .true.
      if (present(state)) f%started = state%started
      do k = 1, n
         here = is_number(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         call advance(f, z(k), here)
         x(k) = f%state
         if (present(normalized_innovation)) then
            normalized_innovation(k) = 0.0_dp
            if (here .and. f%s > 0.0_dp) normalized_innovation(k) = f%innovation/sqrt(f%s)
         end if
      end do
      call store(f, n, filter)
      if (.not. present(state)) return
      state%started = f%started
      state%x(1) = f%state
      state%p(1, 1) = f%p
      state%gain(1) = f%gain
   end subroutine run_scalar

   pure subroutine advance(f, z, here)
      type(scalar_filter_type), intent(inout) :: f
      real(dp), intent(in) :: z
      logical, intent(in) :: here

      if (.not. (f%started .or. here)) return
      if (.not. f%started) then               ! a random walk, diffuse at the start
         f%state = z
         f%p = f%r
         f%gain = 1.0_dp
         f%gain_sum = f%gain_sum + 1.0_dp
         f%used = f%used + 1
         f%started = .true.
      else if (.not. here) then
         call predict(f)
         if (abs(f%state) < vanished) f%state = 0.0_dp
         f%p = f%prior
         f%settled = .false.
      else if (f%varying) then
         call predict(f)
         call compute_gain(f)
         call update(f, z)
         if (f%adapt) call adapt(f)
      else
         call update_fixed(f, z)
      end if
   end subroutine advance

   !> Constant q and r, no gate: once the gain has settled the step is x = phi (1 - K) x + K z.
   pure subroutine update_fixed(f, z)
      type(scalar_filter_type), intent(inout) :: f
      real(dp), intent(in) :: z
      real(dp) :: steady

      if (f%settled) then
         f%innovation = z - f%phi*f%state
         f%state = f%pole*f%state + f%gain*z
      else
         call predict(f)
         call compute_gain(f)
         f%innovation = z - f%state
         f%state = f%state + f%gain*f%innovation
         f%p = f%gain*f%r
         steady = f%steady_gain                                ! a copy: see scalar_filter_type
         f%settled = abs(f%gain - steady) <= settle_distance(steady)
         if (f%settled) f%gain = steady
      end if
      f%gain_sum = f%gain_sum + f%gain
      f%used = f%used + 1
   end subroutine update_fixed

   pure subroutine predict(f)
      type(scalar_filter_type), intent(inout) :: f

      f%state = f%phi*f%state + f%q_mean
      f%prior = f%phi2*f%p + f%q
   end subroutine predict

   !> Variance of the innovation and gain. The gain is the critical path: two
   !> divisions at a time are ready earlier than one reciprocal and its products.
   pure subroutine compute_gain(f)
      type(scalar_filter_type), intent(inout) :: f

      f%s = (f%phi2*f%p + f%r) + f%q          ! Q is last in the dependency chain
      f%gain = f%prior/f%s
      f%share = f%r/f%s
   end subroutine compute_gain

   !> Estimate from the prediction and a measurement, gated.
   pure subroutine update(f, z)
      type(scalar_filter_type), intent(inout) :: f
      real(dp), intent(in) :: z
      real(dp) :: inflated, gain
      logical :: beyond

      f%used = f%used + 1
      f%innovation = z - f%state - f%r_mean
      f%square = f%innovation*f%innovation
      f%clipped = f%innovation
      beyond = .false.
      if (f%has_gate) beyond = f%square > f%gate*f%s
      if (.not. beyond) then
         f%state = f%state + f%gain*f%innovation
         f%p = f%gain*f%r
         f%gain_sum = f%gain_sum + f%gain
         f%run = 0
         return
      end if
      f%square = f%gate*f%s
      f%clipped = sign(sqrt(f%square), f%innovation)
      inflated = f%r*(f%innovation/f%clipped)            ! R over Huber's weight
      gain = f%prior/(f%prior + inflated)
      f%state = f%state + gain*f%innovation
      f%p = gain*inflated
      f%gain_sum = f%gain_sum + gain
      f%gated = f%gated + 1
      if (real(f%run, dp)*f%innovation < 0.0_dp) f%run = 0
      f%run = f%run + merge(1, -1, f%innovation > 0.0_dp)
      if (abs(f%run) > longest_run) then      ! level shift: P is raised
         f%p = f%p + shift_variance*f%r
         f%run = 0
      end if
   end subroutine update

   !> `adapt_noise` of gyroakf_filter_sage_husa.
   pure subroutine adapt(f)
      type(scalar_filter_type), intent(inout) :: f
      real(dp) :: excess, step
      logical :: held

      if (f%wait > 0) then
         f%wait = f%wait - 1
         return
      end if
      if (f%updates > 0) then
         f%updates = f%updates - 1
         f%weight = f%weight/(f%weight + f%forgetting)
      end if
      if (f%adapt_q_mean) f%q_mean = f%q_mean + f%weight*f%gain*f%clipped
      if (f%adapt_r_mean) f%r_mean = f%r_mean + f%weight*f%clipped
      excess = f%square*f%inverse_consistency - f%s
      held = .false.
      if (f%adapt_r) then
         step = f%weight*excess
         if (f%by_residual) step = (f%share*f%share)*step
         f%r = f%r + step
         if (f%by_posterior) f%r = f%r + (f%weight*f%prior)*f%gain
         if (f%r <= f%r_low) then
            f%r = f%r_low
            f%r_floor = f%r_floor + 1
            held = .true.
         else if (f%r > f%r_high) then
            f%r = f%r_high
            held = .true.
         end if
      end if
      if (f%adapt_q) then
         f%q = f%q + (f%weight*excess)*(f%gain*f%gain)
         if (f%q <= f%q_low) then
            f%q = f%q_low
            f%q_floor = f%q_floor + 1
            held = .true.
         else if (f%q > f%q_high) then
            f%q = f%q_high
            held = .true.
         end if
      end if
      if (held) f%clamped = f%clamped + 1
   end subroutine adapt

   !> The numbers of a filter of order 1; those of gate and adaptation only where there is one.
   pure subroutine load(filter, f)
      type(filter_type), intent(in) :: filter
      type(scalar_filter_type), intent(out) :: f

      f%phi = filter%phi(1)
      f%phi2 = filter%phi(1)**2
      f%state = filter%x(1)
      f%p = filter%p(1, 1)
      f%q = filter%q
      f%r = filter%r
      f%q_mean = filter%q_mean
      f%s = filter%innovation_variance
      f%gain = filter%gain(1)
      f%innovation = filter%innovation
      f%varying = filter%varying
      f%settled = filter%settled
      f%gain_sum = 0.0_dp
      f%used = 0
      if (f%varying) then
         call load_adaptation(filter, f)
      else
         f%steady_gain = filter%steady_gain(1)
         f%pole = f%phi*(1.0_dp - f%steady_gain)
      end if
   end subroutine load

   pure subroutine load_adaptation(filter, f)
      type(filter_type), intent(in) :: filter
      type(scalar_filter_type), intent(inout) :: f

      f%r_mean = filter%r_mean
      f%weight = filter%weight
      f%forgetting = filter%options%forgetting
      f%gate = filter%options%huber**2
      f%has_gate = filter%options%huber > 0.0_dp
      f%inverse_consistency = 1.0_dp/filter%consistency
      f%q_low = filter%q_bounds(1)
      f%q_high = filter%q_bounds(2)
      f%r_low = filter%r_bounds(1)
      f%r_high = filter%r_bounds(2)
      f%clamped = 0
      f%gated = 0
      f%q_floor = 0
      f%r_floor = 0
      f%wait = filter%wait
      f%updates = filter%weight_updates
      f%run = filter%run
      f%adapt = filter%adaptive .and. .not. filter%frozen
      f%adapt_q_mean = filter%options%estimate_process_mean
      f%adapt_r_mean = filter%options%estimate_measurement_mean
      f%adapt_q = filter%options%estimate_process_variance
      f%adapt_r = filter%options%estimate_measurement_variance
      f%by_residual = filter%by_residual
      f%by_posterior = filter%by_posterior
   end subroutine load_adaptation

   pure subroutine store(f, steps, filter)
      type(scalar_filter_type), intent(in) :: f
      integer(int64), intent(in) :: steps
      type(filter_type), intent(inout) :: filter

      filter%x(1) = f%state
      filter%p(1, 1) = f%p
      filter%gain(1) = f%gain
      filter%settled = f%settled
      filter%innovation = f%innovation
      filter%innovation_variance = f%s
      filter%gain_sum(1) = filter%gain_sum(1) + f%gain_sum
      filter%gain_measurements = filter%gain_measurements + f%used
      filter%measurements = filter%measurements + f%used
      filter%steps = filter%steps + steps
      if (.not. f%varying) return             ! what is adapted, one by one: see scalar_filter_type
      if (f%adapt_q) filter%q = f%q
      if (f%adapt_r) filter%r = f%r
      if (f%adapt_q_mean) filter%q_mean = f%q_mean
      if (f%adapt_r_mean) filter%r_mean = f%r_mean
      filter%weight = f%weight
      filter%weight_updates = f%updates
      filter%wait = f%wait
      filter%run = f%run
      filter%clamped = filter%clamped + f%clamped
      filter%gated = filter%gated + f%gated
      filter%q_at_floor = filter%q_at_floor + f%q_floor
      filter%r_at_floor = filter%r_at_floor + f%r_floor
   end subroutine store
end module gyroakf_filter_scalar
