! SPDX-License-Identifier: MIT
!> The filter of a state of one coefficient over many samples, everything in registers.
!>
!> The same recursion as the general one (gyroakf_filter_kalman, gyroakf_filter_sage_husa), written
!> out because a step of a few nanoseconds is wanted: the numbers of both agree to rounding, and a
!> test says so.
module gyroakf_filter_scalar
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_components, only : settle_distance, vanished, exponent_mask, exponent_limit
   use gyroakf_filter_filter_types, only : filter_type
   use gyroakf_filter_sage_husa, only : longest_run, shift_variance
   implicit none (type, external)
   private
   public :: run_scalar

   !> State and constants of a step, scalars only, so that the
   !> compiler keeps a local of this type in registers. It does so only while no component is an
   !> argument of a procedure that is not inlined (no public one is in position-independent code):
   !> else every step goes through memory. No two components that adaptation changes
   !> are neighbors both here and in the filter: a pair loaded just after its halves were stored
   !> stalls store forwarding
   type :: lane_type
      real(dp) :: phi, phi2, state, p, r_mean, q, weight, r, forgetting, q_mean
      real(dp) :: prior, s, gain, share, innovation, square, clipped
      real(dp) :: gate, inverse_consistency, q_low, q_high, r_low, r_high
      real(dp) :: gain_sum, steady_gain, pole
      integer(int64) :: used, clamped, gated, q_floor, r_floor
      integer :: wait, updates, run
      logical :: adapt, adapt_q_mean, adapt_r_mean, adapt_q, adapt_r, by_residual, by_posterior
      logical :: has_gate, varying, settled, started
   end type lane_type

contains

   !> What `is_sample` says, private here so that it is inlined in position-independent code too.
   elemental logical function is_number(z)
      real(dp), intent(in) :: z

      is_number = iand(shiftr(transfer(z, 0_int64), 52), exponent_mask) < exponent_limit
   end function is_number

   !> The filter over a series, or the next part of one. A single sample takes this way too:
   !> `advance` is inlined as long as nothing else calls it.
   pure subroutine run_scalar(filter, z, x, valid, normalized_innovation)
      !> Of order 1; its state goes on
      type(filter_type), intent(inout) :: filter
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Estimates, [n]
      real(dp), intent(out), contiguous :: x(:)
      !> 1 where the measurement is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Innovations over their standard deviations, [n], 0 where missing
      real(dp), intent(out), contiguous, optional :: normalized_innovation(:)
      type(lane_type) :: lane
      integer(int64) :: k
      logical :: here

      call load(filter, lane)
      do k = 1, size(z, kind=int64)
         here = is_number(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         call advance(lane, z(k), here)
         x(k) = lane%state
         if (present(normalized_innovation)) then
            normalized_innovation(k) = 0.0_dp
            if (here .and. lane%s > 0.0_dp) normalized_innovation(k) = lane%innovation/sqrt(lane%s)
         end if
      end do
      call store(lane, size(z, kind=int64), filter)
   end subroutine run_scalar

   pure subroutine advance(lane, z, here)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      logical, intent(in) :: here

      if (.not. (lane%started .or. here)) return
      if (.not. lane%started) then               ! the estimate of a random walk that began anywhere
         lane%state = z
         lane%p = lane%r
         lane%gain = 1.0_dp
         lane%gain_sum = lane%gain_sum + 1.0_dp
         lane%used = lane%used + 1
         lane%started = .true.
      else if (.not. here) then
         call predict(lane)
         if (abs(lane%state) < vanished) lane%state = 0.0_dp
         lane%p = lane%prior
         lane%settled = .false.
      else if (lane%varying) then
         call predict(lane)
         call weigh(lane)
         call correct(lane, z)
         if (lane%adapt) call adapt(lane)
      else
         call correct_fixed(lane, z)
      end if
   end subroutine advance

   !> Constant q and r, no gate: once the gain has settled the step is x = phi (1 - K) x + K z.
   pure subroutine correct_fixed(lane, z)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      real(dp) :: steady

      if (lane%settled) then
         lane%innovation = z - lane%phi*lane%state
         lane%state = lane%pole*lane%state + lane%gain*z
      else
         call predict(lane)
         call weigh(lane)
         lane%innovation = z - lane%state
         lane%state = lane%state + lane%gain*lane%innovation
         lane%p = lane%gain*lane%r
         steady = lane%steady_gain                                ! a copy: see lane_type
         lane%settled = abs(lane%gain - steady) <= settle_distance(steady)
         if (lane%settled) lane%gain = steady
      end if
      lane%gain_sum = lane%gain_sum + lane%gain
      lane%used = lane%used + 1
   end subroutine correct_fixed

   pure subroutine predict(lane)
      type(lane_type), intent(inout) :: lane

      lane%state = lane%phi*lane%state + lane%q_mean
      lane%prior = lane%phi2*lane%p + lane%q
   end subroutine predict

   !> Variance of the innovation and gain. Each step waits for the gain of the one before: two
   !> divisions at a time are ready earlier than one reciprocal and its products.
   pure subroutine weigh(lane)
      type(lane_type), intent(inout) :: lane

      ! Q is known last: one addition after it
      lane%s = (lane%phi2*lane%p + lane%r) + lane%q
      lane%gain = lane%prior/lane%s
      lane%share = lane%r/lane%s
   end subroutine weigh

   !> Estimate from the prediction and a measurement, gated.
   pure subroutine correct(lane, z)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      real(dp) :: inflated, gain
      logical :: beyond

      lane%used = lane%used + 1
      lane%innovation = z - lane%state - lane%r_mean
      lane%square = lane%innovation*lane%innovation
      lane%clipped = lane%innovation
      beyond = .false.
      if (lane%has_gate) beyond = lane%square > lane%gate*lane%s
      if (.not. beyond) then
         lane%state = lane%state + lane%gain*lane%innovation
         lane%p = lane%gain*lane%r
         lane%gain_sum = lane%gain_sum + lane%gain
         lane%run = 0
         return
      end if
      lane%square = lane%gate*lane%s
      lane%clipped = sign(sqrt(lane%square), lane%innovation)
      inflated = lane%r*(lane%innovation/lane%clipped)            ! R over Huber's weight
      gain = lane%prior/(lane%prior + inflated)
      lane%state = lane%state + gain*lane%innovation
      lane%p = gain*inflated
      lane%gain_sum = lane%gain_sum + gain
      lane%gated = lane%gated + 1
      if (real(lane%run, dp)*lane%innovation < 0.0_dp) lane%run = 0
      lane%run = lane%run + merge(1, -1, lane%innovation > 0.0_dp)
      ! the level has shifted: believe the measurements
      if (abs(lane%run) > longest_run) then
         lane%p = lane%p + shift_variance*lane%r
         lane%run = 0
      end if
   end subroutine correct

   !> `adapt_noise` of gyroakf_filter_sage_husa.
   pure subroutine adapt(lane)
      type(lane_type), intent(inout) :: lane
      real(dp) :: excess, step
      logical :: held

      if (lane%wait > 0) then
         lane%wait = lane%wait - 1
         return
      end if
      if (lane%updates > 0) then
         lane%updates = lane%updates - 1
         lane%weight = lane%weight/(lane%weight + lane%forgetting)
      end if
      if (lane%adapt_q_mean) lane%q_mean = lane%q_mean + lane%weight*lane%gain*lane%clipped
      if (lane%adapt_r_mean) lane%r_mean = lane%r_mean + lane%weight*lane%clipped
      excess = lane%square*lane%inverse_consistency - lane%s
      held = .false.
      if (lane%adapt_r) then
         step = lane%weight*excess
         if (lane%by_residual) step = (lane%share*lane%share)*step
         lane%r = lane%r + step
         if (lane%by_posterior) lane%r = lane%r + (lane%weight*lane%prior)*lane%gain
         if (lane%r <= lane%r_low) then
            lane%r = lane%r_low
            lane%r_floor = lane%r_floor + 1
            held = .true.
         else if (lane%r > lane%r_high) then
            lane%r = lane%r_high
            held = .true.
         end if
      end if
      if (lane%adapt_q) then
         lane%q = lane%q + (lane%weight*excess)*(lane%gain*lane%gain)
         if (lane%q <= lane%q_low) then
            lane%q = lane%q_low
            lane%q_floor = lane%q_floor + 1
            held = .true.
         else if (lane%q > lane%q_high) then
            lane%q = lane%q_high
            held = .true.
         end if
      end if
      if (held) lane%clamped = lane%clamped + 1
   end subroutine adapt

   !> The numbers of a filter of order 1; those of gate and adaptation only where there is one.
   pure subroutine load(filter, lane)
      type(filter_type), intent(in) :: filter
      type(lane_type), intent(out) :: lane

      lane%phi = filter%phi(1)
      lane%phi2 = filter%phi(1)**2
      lane%state = filter%x(1)
      lane%p = filter%p(1, 1)
      lane%q = filter%q
      lane%r = filter%r
      lane%q_mean = filter%q_mean
      lane%s = filter%innovation_variance
      lane%gain = filter%gain(1)
      lane%innovation = filter%innovation
      lane%varying = filter%varying
      lane%settled = filter%settled
      lane%started = filter%drift_state%started
      lane%gain_sum = 0.0_dp
      lane%used = 0
      if (lane%varying) then
         call load_adaptation(filter, lane)
      else
         lane%steady_gain = filter%steady_gain(1)
         lane%pole = lane%phi*(1.0_dp - lane%steady_gain)
      end if
   end subroutine load

   pure subroutine load_adaptation(filter, lane)
      type(filter_type), intent(in) :: filter
      type(lane_type), intent(inout) :: lane

      lane%r_mean = filter%r_mean
      lane%weight = filter%weight
      lane%forgetting = filter%options%forgetting
      lane%gate = filter%options%huber**2
      lane%has_gate = filter%options%huber > 0.0_dp
      lane%inverse_consistency = 1.0_dp/filter%consistency
      lane%q_low = filter%q_bounds(1)
      lane%q_high = filter%q_bounds(2)
      lane%r_low = filter%r_bounds(1)
      lane%r_high = filter%r_bounds(2)
      lane%clamped = 0
      lane%gated = 0
      lane%q_floor = 0
      lane%r_floor = 0
      lane%wait = filter%wait
      lane%updates = filter%weight_updates
      lane%run = filter%run
      lane%adapt = filter%adaptive .and. .not. filter%frozen
      lane%adapt_q_mean = filter%options%estimate_process_mean
      lane%adapt_r_mean = filter%options%estimate_measurement_mean
      lane%adapt_q = filter%options%estimate_process_variance
      lane%adapt_r = filter%options%estimate_measurement_variance
      lane%by_residual = filter%by_residual
      lane%by_posterior = filter%by_posterior
   end subroutine load_adaptation

   pure subroutine store(lane, steps, filter)
      type(lane_type), intent(in) :: lane
      integer(int64), intent(in) :: steps
      type(filter_type), intent(inout) :: filter

      filter%x(1) = lane%state
      filter%p(1, 1) = lane%p
      filter%gain(1) = lane%gain
      filter%settled = lane%settled
      filter%innovation = lane%innovation
      filter%innovation_variance = lane%s
      filter%gain_sum(1) = filter%gain_sum(1) + lane%gain_sum
      filter%gain_measurements = filter%gain_measurements + lane%used
      filter%measurements = filter%measurements + lane%used
      filter%steps = filter%steps + steps
      if (filter%drift_model%count > 0) then
         filter%drift_state%started = lane%started
         filter%drift_state%x(1) = lane%state
         filter%drift_state%p(1, 1) = lane%p
         filter%drift_state%gain(1) = lane%gain
      end if
      if (.not. lane%varying) return
      ! only what is adapted, and so one by one: see lane_type
      if (lane%adapt_q) filter%q = lane%q
      if (lane%adapt_r) filter%r = lane%r
      if (lane%adapt_q_mean) filter%q_mean = lane%q_mean
      if (lane%adapt_r_mean) filter%r_mean = lane%r_mean
      filter%weight = lane%weight
      filter%weight_updates = lane%updates
      filter%wait = lane%wait
      filter%run = lane%run
      filter%clamped = filter%clamped + lane%clamped
      filter%gated = filter%gated + lane%gated
      filter%q_at_floor = filter%q_at_floor + lane%q_floor
      filter%r_at_floor = filter%r_at_floor + lane%r_floor
   end subroutine store
end module gyroakf_filter_scalar
