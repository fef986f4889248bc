! SPDX-License-Identifier: MIT
!> Sage-Husa adaptation of the noise means q, r and variances Q, R, and the gate before it.
!>
!> With the innovation e, its variance S = P- + R, the first gain K and the weight
!> $ d_k = (1 - b)/(1 - b^{k+1}) $ the corrected recursion is, exactly (an identity, not an
!> approximation):
!> $$ Q \leftarrow Q + d K^2 (e^2 - S) \qquad q \leftarrow q + d K e \qquad r \leftarrow r + d e $$
!> and for R, by form:
!> $$ \text{exact: } R + d (e^2 - S) \qquad \text{residual: } R + d (R/S)^2 (e^2 - S) $$
!> $$ \text{paper: } R + d (e^2 - S + P^- - P) \qquad
!>    \text{biased: } R + d [(R/S)^2 (e^2 - S) + P^- - P] $$
!>
!> "exact" subtracts H P- H' from e^2; "paper" subtracts the posterior, as eq. (22) of Yi et al.
!> prints it; "residual" adds the posterior to the squared residual z - x - r and cannot turn
!> negative; "biased" adds the prior there. One number, e^2 - S, drives Q and R alike: their sum is
!> identifiable, their ratio is not.
!>
!> For a state of one coefficient [[gyroakf_filter_scalar]] holds an inlined copy of `adapt_noise`;
!> a test compares both.
!>
!> Source: Sage & Husa, Adaptive filtering with unknown prior statistics, JACC 1969, 760-769.
!> Against Yi et al.: eq. (20) with Phi P_{k-1} Phi', eq. (22) with the prior (but for "paper"), d_k
!> with k counted from 1. The identities follow from P = P- - K S K'; a test compares them with the
!> recursion written out.
module gyroakf_filter_sage_husa
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_filter_types, only : filter_type
   implicit none (type, external)
   private
   public :: adapt_noise, gate_inflation, watch_level, consistency_factor, longest_run, &
      shift_variance

   !> Gated innovations of one sign in succession after which the level is taken to have shifted
   integer, parameter :: longest_run = 10
   !> Multiple of R that is then added to the variance of the state
   real(dp), parameter :: shift_variance = 100.0_dp

contains

   !> One adaptation, after the state and its covariance have been corrected; counts the clamped
   !> steps.
   pure subroutine adapt_noise(filter, innovation, s, prior)
      !> Its q, r, q_mean, r_mean, weight and counts change
      type(filter_type), intent(inout) :: filter
      !> Innovation e
      real(dp), intent(in) :: innovation
      !> Its variance S, and the predicted variance P- of the first state
      real(dp), intent(in) :: s, prior
      real(dp) :: clipped, d, excess, gain, share, square, step
      logical :: clamped

      if (filter%wait > 0) then
         filter%wait = filter%wait - 1
         return
      end if
      if (filter%weight_updates > 0) then
         filter%weight_updates = filter%weight_updates - 1
         filter%weight = filter%weight/(filter%weight + filter%options%forgetting)
      end if
      d = filter%weight
      gain = prior/s
      share = filter%r/s
      clipped = innovation
      square = innovation**2
      if (filter%options%huber > 0.0_dp) then
         if (square > filter%options%huber**2*s) then
            square = filter%options%huber**2*s
            clipped = sign(sqrt(square), innovation)
         end if
         square = square/filter%consistency
      end if
      excess = square - s
      clamped = .false.
      if (filter%options%estimate_process_mean) filter%q_mean = filter%q_mean + d*gain*clipped
      if (filter%options%estimate_measurement_mean) filter%r_mean = filter%r_mean + d*clipped
      if (filter%options%estimate_measurement_variance) then
         step = excess
         if (filter%by_residual) step = share*share*excess
         if (filter%by_posterior) step = step + gain*prior          ! P- minus P
         filter%r = filter%r + d*step
         call hold(filter%r, filter%r_bounds, filter%r_at_floor, clamped)
      end if
      if (filter%options%estimate_process_variance) then
         filter%q = filter%q + (d*excess)*(gain*gain)
         call hold(filter%q, filter%q_bounds, filter%q_at_floor, clamped)
      end if
      if (clamped) filter%clamped = filter%clamped + 1
   end subroutine adapt_noise

   !> Holds a variance within its bounds.
   pure subroutine hold(value, bounds, at_floor, clamped)
      real(dp), intent(inout) :: value
      real(dp), intent(in) :: bounds(2)
      !> Counts the times it was at the lower bound
      integer(int64), intent(inout) :: at_floor
      !> Set where it was at or beyond a bound, else left
      logical, intent(inout) :: clamped

      if (value <= bounds(1)) then
         value = bounds(1)
         at_floor = at_floor + 1
         clamped = .true.
      else if (value > bounds(2)) then
         value = bounds(2)
         clamped = .true.
      end if
   end subroutine hold

   !> Factor >= 1 by which Huber's weight inflates R for this innovation: |e|/(c sqrt(S)).
   pure real(dp) function gate_inflation(threshold, innovation, s)
      !> c in standard deviations; 0 or less: no gate
      real(dp), intent(in) :: threshold
      !> Innovation and its variance
      real(dp), intent(in) :: innovation, s

      gate_inflation = 1.0_dp
      if (threshold > 0.0_dp) then
         if (innovation**2 > threshold**2*s) gate_inflation = abs(innovation)/(threshold*sqrt(s))
      end if
   end function gate_inflation

   !> Counts what the gate did; a run of innovations of one sign beyond it is a level that has
   !> shifted: the state may move.
   pure subroutine watch_level(filter, inflation, variance)
      !> Its innovation is set
      type(filter_type), intent(inout) :: filter
      !> Factor on R, 1 where the gate did not act
      real(dp), intent(in) :: inflation
      !> Of the state that a shift is laid upon
      real(dp), intent(inout) :: variance

      if (.not. inflation > 1.0_dp) then
         filter%run = 0
         return
      end if
      filter%gated = filter%gated + 1
      if (real(filter%run, dp)*filter%innovation < 0.0_dp) filter%run = 0
      filter%run = filter%run + merge(1, -1, filter%innovation > 0.0_dp)
      if (abs(filter%run) <= longest_run) return
      variance = variance + shift_variance*filter%r
      filter%run = 0
   end subroutine watch_level

   !> Mean of min(u^2, c^2) for standard normal u, by which the squares are divided under the gate.
   elemental real(dp) function consistency_factor(threshold)
      !> c > 0
      real(dp), intent(in) :: threshold
      real(dp), parameter :: root_half = sqrt(0.5_dp), density = 0.39894228040143267794_dp

      consistency_factor = erf(threshold*root_half) &
         - 2.0_dp*threshold*density*exp(-0.5_dp*threshold**2) &
         + threshold**2*erfc(threshold*root_half)
   end function consistency_factor
end module gyroakf_filter_sage_husa
