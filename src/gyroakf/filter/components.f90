! SPDX-License-Identifier: MIT
!> The state space of drift and noise: independent processes of first order, their sum measured in
!> white noise.
!>
!> $$ x_{i,k} = \phi_i x_{i,k-1} + w_{i,k}, \quad z_k = \sum_i x_{i,k} + v_k, \quad
!>    \mathrm{Var}\,w_i = q_i, \quad \mathrm{Var}\,v = r $$
!> A process with phi = 1 is a random walk; it begins anywhere: its prior is diffuse, treated
!> exactly (the first measurement sets it), not by a large number. The others begin stationary. A
!> step is O(n^2), n at most 3; the covariance is kept in Joseph's form, symmetric and positive.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 4.3, 5.2;
!> Bucy & Joseph (1968).
module gyroakf_filter_components
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: component_model_type, component_state_type, most_components
   public :: check_components, start_components, predict_components, correct_components
   public :: settle_distance, vanished, is_sample, exponent_mask, exponent_limit

   !> Processes that a model may have
   integer, parameter :: most_components = 3

   !> The model, in the unit u of the series
   type :: component_model_type
      !> Processes, 1 .. most_components
      integer :: count = 0
      !> Coefficients, -1 < phi < 1; one of them may be 1
      real(dp) :: phi(most_components) = 0.0_dp
      !> Variances of the driving noises, u^2, >= 0
      real(dp) :: q(most_components) = 0.0_dp
      !> Variance of the white noise, u^2, >= 0
      real(dp) :: r = 0.0_dp
   end type component_model_type

   !> What is known of the processes
   type :: component_state_type
      !> Estimates and their covariance
      real(dp) :: x(most_components) = 0.0_dp, p(most_components, most_components) = 0.0_dp
      !> Gain, innovation and its variance at the last measurement
      real(dp) :: gain(most_components) = 0.0_dp, innovation = 0.0_dp, variance = 0.0_dp
      !> The random walk, 0 where there is none; false until it met its first measurement
      integer :: walk = 0
      logical :: started = .true.
   end type component_state_type

   !> Relative distance from the steady gain at which the gain is taken as settled ...
   real(dp), parameter :: settle_tolerance = 1.0e-13_dp
   !> ... or, for slow filters, this in absolute terms (the recursion itself does not come nearer),
   !> but never farther than this in relative ones
   real(dp), parameter :: settle_rounding = 4.0_dp*epsilon(1.0_dp), settle_limit = 1.0e-9_dp
   !> Below it a state without measurements is set to zero: no subnormal numbers in a long gap
   real(dp), parameter :: vanished = 1.0e-290_dp
   !> The bits of the exponent of a number, shifted to the right, and the exponent from which on a
   !> square may overflow
   integer(int64), parameter :: exponent_mask = 2047_int64, exponent_limit = 1023_int64 + 495_int64

contains

   !> Whether a value is a measurement: finite and below 1e149 in magnitude, so that its square is
   !> finite too.
   !>
   !> By the exponent's bits: a NaN meets no comparison, so nothing traps.
   elemental logical function is_sample(z)
      !> The value
      real(dp), intent(in) :: z

      is_sample = iand(shiftr(transfer(z, 0_int64), 52), exponent_mask) < exponent_limit
   end function is_sample

   !> Refuses a model that is none.
   subroutine check_components(model, error)
      !> The model
      type(component_model_type), intent(in) :: model
      !> invalid_argument, non_finite, unstable
      type(error_type), allocatable, intent(out) :: error

      if (model%count < 1 .or. model%count > most_components) then
         call fatal_error(error, status%invalid_argument, &
            "a drift model has one to three processes")
         return
      end if
      associate (phi => model%phi(:model%count), q => model%q(:model%count))
         if (.not. (all(is_sample(phi)) .and. all(is_sample(q)) .and. is_sample(model%r))) then
            call fatal_error(error, status%non_finite, &
               "the coefficients and variances of a drift model must be finite numbers")
         else if (any(abs(phi) > 1.0_dp) .or. any(phi <= -1.0_dp)) then
            call fatal_error(error, status%unstable, &
               "a coefficient of a drift model lies outside -1 < phi <= 1")
         else if (count(phi >= 1.0_dp) > 1) then
            call fatal_error(error, status%invalid_argument, &
               "a drift model has at most one random walk: two are not identifiable")
         else if (any(q < 0.0_dp) .or. model%r < 0.0_dp .or. .not. sum(q) + model%r > 0.0_dp) then
            call fatal_error(error, status%invalid_argument, &
               "the variances of a drift model must be >= 0, and not all zero")
         end if
      end associate
   end subroutine check_components

   !> The state before the first sample.
   pure subroutine start_components(model, state)
      !> Checked
      type(component_model_type), intent(in) :: model
      !> Stationary; a random walk is not known
      type(component_state_type), intent(out) :: state
      integer :: i

      do i = 1, model%count
         if (model%phi(i) >= 1.0_dp) then
            state%walk = i
            state%started = .false.
         else
            state%p(i, i) = model%q(i)/((1.0_dp - model%phi(i))*(1.0_dp + model%phi(i)))
         end if
      end do
   end subroutine start_components

   !> Prediction of the state by one sample.
   pure subroutine predict_components(model, state)
      !> Checked
      type(component_model_type), intent(in) :: model
      !> Goes on
      type(component_state_type), intent(inout) :: state
      integer :: i, j

      do j = 1, model%count
         state%x(j) = model%phi(j)*state%x(j)
         do i = 1, model%count
            state%p(i, j) = model%phi(i)*model%phi(j)*state%p(i, j)
         end do
         if (state%started .or. j /= state%walk) state%p(j, j) = state%p(j, j) + model%q(j)
      end do
   end subroutine predict_components

   !> Correction by a measurement.
   !>
   !> $$ c = P \mathbf 1, \; S = \mathbf 1^T c + r, \; K = c/S, \; x \leftarrow x + K e, \;
   !>    P \leftarrow (I - K \mathbf 1^T) P (I - K \mathbf 1^T)^T + r K K^T $$
   !> The first measurement of a random walk is its estimate; it has no innovation (`variance` is
   !> 0).
   pure subroutine correct_components(n, r, z, state)
      !> Processes
      integer, intent(in) :: n
      !> Variance of the white noise at this sample
      real(dp), intent(in) :: r
      !> The measurement
      real(dp), intent(in) :: z
      !> Predicted; goes on
      type(component_state_type), intent(inout) :: state
      real(dp) :: c(most_components), kept(most_components, most_components), rest, total
      integer :: i, j

      do i = 1, n
         c(i) = sum(state%p(:n, i))
      end do
      total = sum(c(:n))
      if (.not. state%started) then
         associate (walk => state%walk)
            state%innovation = 0.0_dp
            state%variance = 0.0_dp
            state%gain(:n) = 0.0_dp
            state%gain(walk) = 1.0_dp
            state%x(walk) = z - (sum(state%x(:n)) - state%x(walk))
            state%p(:n, walk) = -c(:n)
            state%p(walk, :n) = -c(:n)
            state%p(walk, walk) = total + r
            state%started = .true.
         end associate
         return
      end if
      state%innovation = z - sum(state%x(:n))
      state%variance = total + r
      state%gain(:n) = c(:n)/state%variance
      state%x(:n) = state%x(:n) + state%gain(:n)*state%innovation
      do j = 1, n
         do i = 1, n
            kept(i, j) = state%p(i, j) - state%gain(i)*c(j)
         end do
      end do
      do i = 1, n
         rest = sum(kept(i, :n))
         do j = 1, i
            state%p(i, j) = kept(i, j) - rest*state%gain(j) + r*state%gain(i)*state%gain(j)
            state%p(j, i) = state%p(i, j)
         end do
      end do
   end subroutine correct_components

   !> Distance from the steady gain K at which the gain has settled: at most 1e-12 of the
   !> innovations is then seen in the output.
   elemental real(dp) function settle_distance(steady_gain)
      !> K, 0 ... 1
      real(dp), intent(in) :: steady_gain

      settle_distance = &
         max(settle_tolerance*steady_gain, min(settle_rounding, settle_limit*steady_gain))
   end function settle_distance

end module gyroakf_filter_components
