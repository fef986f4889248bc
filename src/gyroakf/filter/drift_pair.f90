! SPDX-License-Identifier: MIT
!> The drift filter of two processes over many samples, everything in registers.
!>
!> With the determinant $ D = p_{11} p_{22} - p_{12}^2 $ carried along nothing cancels, and the covariance stays positive by
!> itself (equal to Joseph's form, at a third of its work; D in units of a variance of the model, so that it cannot overflow):
!> $$ D^- = \phi_1^2 \phi_2^2 D + \phi_1^2 q_2\,p_{11} + \phi_2^2 q_1\,p_{22} + q_1 q_2, \quad
!>    S = p^-_{11} + 2 p^-_{12} + p^-_{22} + R $$
!> $$ p_{11} = \frac{D^- + R\,p^-_{11}}{S}, \quad p_{22} = \frac{D^- + R\,p^-_{22}}{S}, \quad
!>    p_{12} = \frac{R\,p^-_{12} - D^-}{S}, \quad D = \frac{R D^-}{S} $$
!> These follow from P = P- - K S K'; a test compares them with the form of any number of processes (gyroakf_filter_drift_step).
module gyroakf_filter_drift_pair
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_filter_measurement, only : exponent_mask, exponent_limit
   use gyroakf_filter_sage_husa, only : longest_run, shift_variance
   use gyroakf_filter_scalar, only : settle_distance, vanished
   use gyroakf_filter_filter_types, only : filter_type
   implicit none (type, external)
   private
   public :: run_pair

   !> What changes from step to step, and what a step needs to know: plain numbers, for the registers
   type :: pair_type
      real(dp) :: phi1, phi2, phi11, phi12, phi22, q1, q2, det_det, det_p11, det_p22, det_new, unit
      real(dp) :: x1, x2, p11, p12, p22, det, r, gain1, gain2, steady1, steady2, near
      real(dp) :: s, total, share, innovation, square, gate, inverse_consistency
      real(dp) :: weight, forgetting, r_low, r_high, sum1, sum2
      integer(int64) :: used, clamped, gated, floor
      integer :: wait, updates, run, walk, shifted
      logical :: slow1, slow2, adapt, by_residual, by_posterior, has_gate, varying, settled, started
   end type pair_type

contains

   !> The filter over a series, or the next part of one.
   pure subroutine run_pair(filter, z, x, valid, normalised_innovation)
      !> Of a drift of two processes; its state goes on
      type(filter_type), intent(inout) :: filter
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Estimates, [n]
      real(dp), intent(out), contiguous :: x(:)
      !> 1 where the measurement is present, [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Innovations over their standard deviations, [n], 0 where there is none
      real(dp), intent(out), contiguous, optional :: normalised_innovation(:)
      type(pair_type) :: pair
      integer(int64) :: k
      logical :: here, counts

      call load(filter, pair)
      do k = 1, size(z, kind=int64)
         here = is_number(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         counts = here .and. pair%started
         call advance(pair, z(k), here)
         x(k) = drift_of(pair)
         if (present(normalised_innovation)) then
            normalised_innovation(k) = 0.0_dp
            if (counts) normalised_innovation(k) = pair%innovation/sqrt(pair%s)
         end if
      end do
      call store(pair, size(z, kind=int64), filter)
   end subroutine run_pair

   !> What `is_sample` says, private here so that it is inlined in position-independent code too.
   elemental logical function is_number(z)
      !> The value
      real(dp), intent(in) :: z

      is_number = iand(shiftr(transfer(z, 0_int64), 52), exponent_mask) < exponent_limit
   end function is_number

   !> One step.
   pure subroutine advance(pair, z, here)
      type(pair_type), intent(inout) :: pair
      !> The measurement
      real(dp), intent(in) :: z
      !> Whether there is one
      logical, intent(in) :: here

      if (.not. pair%started) then
         if (here) call begin_walk(pair, z)
      else if (.not. here) then
         call predict(pair)
         call skip(pair)
      else if (pair%settled) then
         call correct_fixed(pair, z)
      else
         call predict(pair)
         call correct(pair, z)
         if (pair%adapt) call adapt(pair)
         if (.not. pair%varying) call settle(pair)
      end if
   end subroutine advance

   !> The sum of the processes that are the drift.
   pure real(dp) function drift_of(pair) result(drift)
      type(pair_type), intent(in) :: pair

      drift = 0.0_dp
      if (pair%slow1) drift = pair%x1
      if (pair%slow2) drift = drift + pair%x2
   end function drift_of

   !> Prediction of the processes and their covariance.
   pure subroutine predict(pair)
      type(pair_type), intent(inout) :: pair

      pair%x1 = pair%phi1*pair%x1
      pair%x2 = pair%phi2*pair%x2
      pair%det = pair%det_det*pair%det + (pair%det_p11*pair%p11 + (pair%det_p22*pair%p22 + pair%det_new))
      pair%p11 = pair%phi11*pair%p11 + pair%q1
      pair%p12 = pair%phi12*pair%p12
      pair%p22 = pair%phi22*pair%p22 + pair%q2
   end subroutine predict

   !> A step without a measurement, after the prediction: no subnormal numbers in a long gap.
   pure subroutine skip(pair)
      type(pair_type), intent(inout) :: pair

      if (abs(pair%x1) < vanished) pair%x1 = 0.0_dp
      if (abs(pair%x2) < vanished) pair%x2 = 0.0_dp
      if (abs(pair%p12) < vanished) pair%p12 = 0.0_dp
      pair%settled = .false.
   end subroutine skip

   !> The first measurement of a random walk: with the other process, which is as it always was, it is the estimate.
   pure subroutine begin_walk(pair, z)
      type(pair_type), intent(inout) :: pair
      !> The measurement
      real(dp), intent(in) :: z

      if (pair%walk == 1) then
         pair%x1 = z - pair%x2
         pair%p11 = pair%p22 + pair%r
         pair%p12 = -pair%p22
         pair%det = pair%p22*(pair%r/pair%unit)
         pair%gain1 = 1.0_dp
         pair%gain2 = 0.0_dp
      else
         pair%x2 = z - pair%x1
         pair%p22 = pair%p11 + pair%r
         pair%p12 = -pair%p11
         pair%det = pair%p11*(pair%r/pair%unit)
         pair%gain1 = 0.0_dp
         pair%gain2 = 1.0_dp
      end if
      pair%started = .true.
      call count_gains(pair)
   end subroutine begin_walk

   !> A measurement, with the gain that has settled.
   pure subroutine correct_fixed(pair, z)
      type(pair_type), intent(inout) :: pair
      !> The measurement
      real(dp), intent(in) :: z

      pair%innovation = z - (pair%phi1*pair%x1 + pair%phi2*pair%x2)
      pair%x1 = pair%phi1*pair%x1 + pair%gain1*pair%innovation
      pair%x2 = pair%phi2*pair%x2 + pair%gain2*pair%innovation
      call count_gains(pair)
   end subroutine correct_fixed

   !> Estimate and covariance from the prediction and a measurement, gated.
   pure subroutine correct(pair, z)
      type(pair_type), intent(inout) :: pair
      !> The measurement
      real(dp), intent(in) :: z
      real(dp) :: c1, c2, from_det, inverse, share
      logical :: beyond

      c1 = pair%p11 + pair%p12
      c2 = pair%p22 + pair%p12
      pair%total = c1 + c2
      pair%s = pair%total + pair%r
      pair%innovation = z - (pair%x1 + pair%x2)
      pair%square = pair%innovation*pair%innovation
      inverse = 1.0_dp/pair%s
      pair%share = pair%r*inverse
      share = pair%share
      beyond = .false.
      if (pair%has_gate) beyond = pair%square > pair%gate*pair%s
      if (beyond) then
         pair%square = pair%gate*pair%s
         share = pair%r*(abs(pair%innovation)/sqrt(pair%square))    ! R over Huber's weight
         inverse = 1.0_dp/(pair%total + share)
         share = share*inverse
      end if
      from_det = pair%det*(pair%unit*inverse)
      pair%gain1 = c1*inverse
      pair%gain2 = c2*inverse
      pair%x1 = pair%x1 + pair%gain1*pair%innovation
      pair%x2 = pair%x2 + pair%gain2*pair%innovation
      pair%p11 = share*pair%p11 + from_det
      pair%p22 = share*pair%p22 + from_det
      pair%p12 = share*pair%p12 - from_det
      pair%det = share*pair%det
      call count_gains(pair)
      if (beyond) then
         call watch_level(pair)
      else
         pair%run = 0
      end if
   end subroutine correct

   !> Sums of the gains.
   pure subroutine count_gains(pair)
      type(pair_type), intent(inout) :: pair

      pair%sum1 = pair%sum1 + pair%gain1
      pair%sum2 = pair%sum2 + pair%gain2
      pair%used = pair%used + 1
   end subroutine count_gains

   !> The gate acted; a run of one sign is a level that has shifted: believe the measurements.
   pure subroutine watch_level(pair)
      type(pair_type), intent(inout) :: pair
      real(dp) :: more

      pair%gated = pair%gated + 1
      if (real(pair%run, dp)*pair%innovation < 0.0_dp) pair%run = 0
      pair%run = pair%run + merge(1, -1, pair%innovation > 0.0_dp)
      if (abs(pair%run) <= longest_run) return
      pair%run = 0
      more = shift_variance*pair%r
      if (pair%shifted == 1) then
         pair%p11 = pair%p11 + more
         pair%det = pair%det + (more/pair%unit)*pair%p22
      else
         pair%p22 = pair%p22 + more
         pair%det = pair%det + (more/pair%unit)*pair%p11
      end if
   end subroutine watch_level

   !> Adaptation of R: `adapt_noise` of gyroakf_filter_sage_husa.
   pure subroutine adapt(pair)
      type(pair_type), intent(inout) :: pair
      real(dp) :: step

      if (pair%wait > 0) then
         pair%wait = pair%wait - 1
         return
      end if
      if (pair%updates > 0) then
         pair%updates = pair%updates - 1
         pair%weight = pair%weight/(pair%weight + pair%forgetting)
      end if
      step = pair%square*pair%inverse_consistency - pair%s
      if (pair%by_residual) step = (pair%share*pair%share)*step
      if (pair%by_posterior) step = step + pair%total*(pair%total/pair%s)
      pair%r = pair%r + pair%weight*step
      if (pair%r <= pair%r_low) then
         pair%r = pair%r_low
         pair%floor = pair%floor + 1
         pair%clamped = pair%clamped + 1
      else if (pair%r > pair%r_high) then
         pair%r = pair%r_high
         pair%clamped = pair%clamped + 1
      end if
   end subroutine adapt

   !> Whether the gain is as good as the one that it settles to; it is kept then.
   pure subroutine settle(pair)
      type(pair_type), intent(inout) :: pair

      pair%settled = abs(pair%gain1 - pair%steady1) <= pair%near .and. abs(pair%gain2 - pair%steady2) <= pair%near
      if (.not. pair%settled) return
      pair%gain1 = pair%steady1
      pair%gain2 = pair%steady2
   end subroutine settle

   !> The numbers of a filter of two processes.
   pure subroutine load(filter, pair)
      type(filter_type), intent(in) :: filter
      type(pair_type), intent(out) :: pair

      associate (model => filter%drift_model, state => filter%drift_state)
         pair%phi1 = model%phi(1)
         pair%phi2 = model%phi(2)
         pair%q1 = model%q(1)
         pair%q2 = model%q(2)
         pair%x1 = state%x(1)
         pair%x2 = state%x(2)
         pair%p11 = state%p(1, 1)
         pair%p12 = state%p(1, 2)
         pair%p22 = state%p(2, 2)
         pair%gain1 = state%gain(1)
         pair%gain2 = state%gain(2)
         pair%walk = state%walk
         pair%started = state%started
      end associate
      pair%phi11 = pair%phi1*pair%phi1
      pair%phi12 = pair%phi1*pair%phi2
      pair%phi22 = pair%phi2*pair%phi2
      pair%unit = filter%drift_unit
      pair%det_det = pair%phi11*pair%phi22
      pair%det_p11 = pair%phi11*(pair%q2/pair%unit)
      pair%det_p22 = pair%phi22*(pair%q1/pair%unit)
      pair%det_new = pair%q1*(pair%q2/pair%unit)
      pair%det = filter%drift_determinant
      pair%r = filter%r
      pair%s = filter%innovation_variance
      pair%innovation = filter%innovation
      pair%sum1 = 0.0_dp
      pair%sum2 = 0.0_dp
      pair%used = 0
      pair%slow1 = filter%slow(1)
      pair%slow2 = filter%slow(2)
      pair%has_gate = .false.
      pair%adapt = .false.
      pair%varying = filter%varying
      pair%settled = filter%settled
      if (pair%varying) then
         call load_adaptation(filter, pair)
      else
         pair%steady1 = filter%drift_steady(1)
         pair%steady2 = filter%drift_steady(2)
         pair%near = settle_distance(max(abs(pair%steady1), abs(pair%steady2)))
      end if
   end subroutine load

   !> The numbers of gate and adaptation.
   pure subroutine load_adaptation(filter, pair)
      type(filter_type), intent(in) :: filter
      type(pair_type), intent(inout) :: pair

      pair%gate = filter%options%huber**2
      pair%has_gate = filter%options%huber > 0.0_dp
      pair%inverse_consistency = 1.0_dp/filter%consistency
      pair%weight = filter%weight
      pair%forgetting = filter%options%forgetting
      pair%r_low = filter%r_bounds(1)
      pair%r_high = filter%r_bounds(2)
      pair%clamped = 0
      pair%gated = 0
      pair%floor = 0
      pair%wait = filter%wait
      pair%updates = filter%weight_updates
      pair%run = filter%run
      pair%shifted = filter%drift_shifted
      pair%adapt = filter%adaptive .and. .not. filter%frozen
      pair%by_residual = filter%by_residual
      pair%by_posterior = filter%by_posterior
   end subroutine load_adaptation

   !> The numbers back into the filter after so many steps.
   pure subroutine store(pair, steps, filter)
      type(pair_type), intent(in) :: pair
      integer(int64), intent(in) :: steps
      type(filter_type), intent(inout) :: filter

      associate (state => filter%drift_state)
         state%x(1) = pair%x1
         state%x(2) = pair%x2
         state%p(1, 1) = pair%p11
         state%p(1, 2) = pair%p12
         state%p(2, 1) = pair%p12
         state%p(2, 2) = pair%p22
         state%gain(1) = pair%gain1
         state%gain(2) = pair%gain2
         state%started = pair%started
      end associate
      filter%drift_determinant = pair%det
      filter%innovation_variance = pair%s
      filter%innovation = pair%innovation
      filter%drift_gain_sum(1) = filter%drift_gain_sum(1) + pair%sum1
      filter%drift_gain_sum(2) = filter%drift_gain_sum(2) + pair%sum2
      if (pair%slow1) filter%gain_sum(1) = filter%gain_sum(1) + pair%sum1
      if (pair%slow2) filter%gain_sum(1) = filter%gain_sum(1) + pair%sum2
      filter%gain_measurements = filter%gain_measurements + pair%used
      filter%measurements = filter%measurements + pair%used
      filter%steps = filter%steps + steps
      filter%settled = pair%settled
      call show(pair, filter)
      if (.not. pair%varying) return
      filter%r = pair%r
      filter%weight = pair%weight
      filter%clamped = filter%clamped + pair%clamped
      filter%gated = filter%gated + pair%gated
      filter%r_at_floor = filter%r_at_floor + pair%floor
      filter%wait = pair%wait
      filter%weight_updates = pair%updates
      filter%run = pair%run
   end subroutine store

   !> The drift out of the processes: x(1), p(1,1), gain(1).
   pure subroutine show(pair, filter)
      type(pair_type), intent(in) :: pair
      type(filter_type), intent(inout) :: filter

      filter%x(1) = drift_of(pair)
      if (pair%slow1 .and. pair%slow2) then
         filter%gain(1) = pair%gain1 + pair%gain2
         filter%p(1, 1) = (pair%p11 + pair%p12) + (pair%p22 + pair%p12)
      else if (pair%slow1) then
         filter%gain(1) = pair%gain1
         filter%p(1, 1) = pair%p11
      else
         filter%gain(1) = pair%gain2
         filter%p(1, 1) = pair%p22
      end if
      if (.not. pair%started) filter%p(1, 1) = huge(1.0_dp)
   end subroutine show
end module gyroakf_filter_drift_pair
