! SPDX-License-Identifier: MIT
!> Filters as objects: their model, their state and how they adapt. Made by `new_filter`
!> (gyroakf_filter_kalman, which re-exports the types) or `new_drift_filter`; the components are for
!> reading.
module gyroakf_filter_filter_types
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_components, only : component_model_type, component_state_type, most_components
   implicit none (type, external)
   private
   public :: filter_options, filter_type, drift_filter_type

   !> What a filter adapts and within which limits. Fortran does not tell q from Q: "mean" is q or
   !> r, "variance" is Q or R.
   type :: filter_options
      !> Adapt the mean q of the driving noise
      logical :: estimate_process_mean = .false.
      !> Adapt the mean r of the measurement noise
      logical :: estimate_measurement_mean = .false.
      !> Adapt the variance Q of the driving noise
      logical :: estimate_process_variance = .false.
      !> Adapt the variance R of the measurement noise
      logical :: estimate_measurement_variance = .false.
      !> Forgetting factor b, 0 < b <= 1; 1 weighs the whole past alike
      real(dp) :: forgetting = 0.98_dp
      !> How R follows the data: residual, exact, biased, or paper (the printed posterior P_k in eq.
      !> (22))
      character(8) :: measurement_form = "residual"
      !> Measurements without adaptation at the start; -1: until the gain has settled, at least 20
      integer :: burn_in = 0
      !> Innovations beyond so many standard deviations count less, 0.001 .. 1e6; 0: no gate; 2.5
      !> usual
      real(dp) :: huber = 0.0_dp
      !> What the bounds of R are multiples of (half the variance of the differences); 0: r itself,
      !> in a drift filter half the variance of the differences that the model states
      real(dp) :: r_scale = 0.0_dp
      !> Variance of the state at the start, on the diagonal; 0: the stationary covariance, of a
      !> drift's random walk none (diffuse)
      real(dp) :: initial_variance = 0.0_dp
      !> Bounds of Q, multiples of the q given
      real(dp) :: q_lower = 1.0e-3_dp, q_upper = 1.0e3_dp
      !> Bounds of R, multiples of `r_scale`
      real(dp) :: r_lower = 1.0e-2_dp, r_upper = 1.0e2_dp
      !> q and r may be adapted both: a constant offset may then be in either. Else that is refused.
      logical :: allow_unobservable = .false.
   end type filter_options

   !> A filter for an AR(p) state, fixed or adaptive
   type :: filter_type
      !> Size of the state
      integer :: order = 0
      type(filter_options) :: options
      !> Coefficients, [order]
      real(dp), allocatable :: phi(:)
      !> State, [order]; x(1) is the estimate
      real(dp), allocatable :: x(:)
      !> Covariance of the state, [order, order]
      real(dp), allocatable :: p(:, :)
      !> Gain of the last measurement, [order]
      real(dp), allocatable :: gain(:)
      !> Variances Q and R that the next step uses
      real(dp) :: q = 0, r = 0
      !> Q and R that the filter was made with; not set in a drift filter, whose model holds them
      real(dp) :: asked_q = 0, asked_r = 0
      !> Means q and r that the next step uses
      real(dp) :: q_mean = 0, r_mean = 0
      !> Innovation of the last measurement and its variance
      real(dp) :: innovation = 0, innovation_variance = 0
      !> No adaptation while true; the state goes on
      logical :: frozen = .false.
      !> Steps made, missing samples included
      integer(int64) :: steps = 0
      !> Measurements at which Q or R was held at a bound, and at which the gate acted
      integer(int64) :: clamped = 0, gated = 0
      !> Measurements used
      integer(int64) :: measurements = 0
      !> Measurements at which Q was held at its lower bound, R at its lower bound
      integer(int64) :: q_at_floor = 0, r_at_floor = 0
      !> Sum of the gains since `gain_measurements` was set to zero, [order]; of a drift filter that
      !> of the gains of its processes, [model%count]
      real(dp), allocatable :: gain_sum(:)
      !> Measurements in `gain_sum`
      integer(int64) :: gain_measurements = 0
      !> Set by new_filter: something is adapted; the gain is not constant in the end
      logical :: adaptive = .false., varying = .false.
      !> R by residuals (factor (R/S)^2), R with the posterior covariance (term P- minus P)
      logical :: by_residual = .true., by_posterior = .false.
      !> Measurements still to pass before adaptation begins
      integer :: wait = 0
      !> Weight d_k of the newest sample, and the updates of it that still change it
      real(dp) :: weight = 1
      integer :: weight_updates = 0
      !> Bounds of Q and R in the unit of the series squared
      real(dp) :: q_bounds(2) = 0, r_bounds(2) = 0
      !> Expected squared clipped innovation of normal data (1 without a gate)
      real(dp) :: consistency = 1
      !> Successive gated innovations of one sign, signed
      integer :: run = 0
      !> The gain has settled; the gain that it settles to, [order]
      logical :: settled = .false.
      real(dp), allocatable :: steady_gain(:)
      !> Work space, [order]
      real(dp), allocatable :: work(:)
   end type filter_type

   !> A filter for a drift, the sum of some processes of the first order (`slow`)
   !>
   !> Of what it shares with the other filter, `order` is 1, x(1) the drift, p(1,1) its variance
   !> (huge before the first measurement of a random walk), gain(1) its gain, phi(1) the coefficient
   !> of its slowest process, q the sum of its driving variances.
   type, extends(filter_type) :: drift_filter_type
      !> Processes and white noise
      type(component_model_type) :: model
      !> Which processes are the drift
      logical :: slow(most_components) = .false.
      !> Estimates of the processes
      type(component_state_type) :: state
      !> Gains that they settle to
      real(dp) :: steady_gains(most_components) = 0
      !> The process that a shift of the level is laid upon: the random walk, or the slowest
      integer :: shifted = 0
   end type drift_filter_type
end module gyroakf_filter_filter_types
