! SPDX-License-Identifier: MIT
!> Exact Gaussian likelihood of a drift model, and its gradient, in one pass of the filter.
!>
!> $$ \ln L = -\tfrac12 \sum_k \Big( \ln 2\pi + \ln S_k + e_k^2/S_k \Big) $$
!> over the measurements, without the first where there is a random walk (diffuse likelihood: what the others tell of the
!> parameters once the first has set the level). The gradient comes from the recursions for the derivatives of state, covariance
!> and gain by every parameter, not from differences. Once covariance, gain and their derivatives have settled they are kept: a
!> step then costs O(n) for each parameter.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.2, 7.3.
module gyroakf_filter_likelihood
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_components, only : component_model_type, component_state_type, most_components, &
      check_components, start_components, predict_components, correct_components, settling_type, judge_settling
   use gyroakf_filter_scalar, only : is_sample
   implicit none (type, external)
   private
   public :: component_likelihood

   !> phi and q of every process, r
   integer, parameter :: most_parameters = 2*most_components + 1
   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp

   !> Derivatives of the state by every parameter
   type :: derivative_type
      real(dp) :: x(most_components, most_parameters) = 0.0_dp
      real(dp) :: p(most_components, most_components, most_parameters) = 0.0_dp
      real(dp) :: gain(most_components, most_parameters) = 0.0_dp
      real(dp) :: innovation(most_parameters) = 0.0_dp, variance(most_parameters) = 0.0_dp
   end type derivative_type

   !> What the recursion needs to know of the parameters
   type :: lane_type
      type(component_model_type) :: model
      type(component_state_type) :: state
      type(derivative_type) :: d
      !> Parameters that are derived by, their numbers
      integer :: wanted = 0, parameter(most_parameters) = 0
      !> Of gain and S and their derivatives
      type(settling_type) :: settling
      !> Sums over the measurements: ln S, e^2/S, derivatives of the log-likelihood times -2
      real(dp) :: logarithms = 0.0_dp, squares = 0.0_dp, slope(most_parameters) = 0.0_dp
      integer(int64) :: measurements = 0
   end type lane_type

contains

   !> Log-likelihood of a series under a model.
   subroutine component_likelihood(model, z, value, error, valid, gradient)
      !> Checked here
      type(component_model_type), intent(in) :: model
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> The natural logarithm
      real(dp), intent(out) :: value
      !> invalid_argument, non_finite, unstable; too_few_samples (none that counts); singular (S is not positive)
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> By phi of every process (0 for a random walk), q of every process, r: [2 count + 1]
      real(dp), intent(out), optional :: gradient(:)
      type(lane_type) :: lane
      integer(int64) :: k
      logical :: here

      value = 0.0_dp
      if (present(gradient)) gradient = 0.0_dp
      call check_components(model, error)
      if (allocated(error)) return
      call begin(model, present(gradient), lane)
      do k = 1, size(z, kind=int64)
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         if (lane%settling%settled .and. here) then
            call step_settled(lane, z(k))
         else
            call step(lane, z(k), here)
            if (.not. (lane%state%variance > 0.0_dp .or. lane%measurements == 0)) exit
         end if
      end do
      if (lane%measurements < 1) then
         call fatal_error(error, status%too_few_samples, "the likelihood of a drift model needs more samples")
      else if (k <= size(z, kind=int64)) then
         call fatal_error(error, status%singular, "a drift model predicts a measurement without error: it has no likelihood")
      end if
      if (allocated(error)) return
      value = -0.5_dp*(real(lane%measurements, dp)*log_two_pi + lane%logarithms + lane%squares)
      if (present(gradient)) gradient(:2*model%count + 1) = -0.5_dp*lane%slope(:2*model%count + 1)
   end subroutine component_likelihood

   !> State and derivatives before the first sample.
   pure subroutine begin(model, derive, lane)
      type(component_model_type), intent(in) :: model
      !> The gradient is wanted
      logical, intent(in) :: derive
      type(lane_type), intent(out) :: lane
      real(dp) :: rest
      integer :: i, n

      lane%model = model
      n = model%count
      call start_components(model, lane%state)
      if (.not. derive) return
      do i = 1, 2*n + 1
         if (i == lane%state%walk) cycle
         lane%wanted = lane%wanted + 1
         lane%parameter(lane%wanted) = i
      end do
      do i = 1, n
         if (i == lane%state%walk) cycle
         rest = (1.0_dp - model%phi(i))*(1.0_dp + model%phi(i))
         lane%d%p(i, i, i) = 2.0_dp*model%phi(i)*model%q(i)/rest**2
         lane%d%p(i, i, n + i) = 1.0_dp/rest
      end do
   end subroutine begin

   !> A step before everything has settled.
   pure subroutine step(lane, z, here)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      !> There is a measurement
      logical, intent(in) :: here
      type(component_state_type) :: before
      logical :: counts
      integer :: k

      before = lane%state
      call predict_components(lane%model, lane%state)
      do k = 1, lane%wanted
         call derive_prediction(lane%model, before, lane%parameter(k), lane%d)
      end do
      if (.not. here) then
         lane%settling = settling_type()
         return
      end if
      counts = lane%state%started
      before = lane%state
      call correct_components(lane%model%count, lane%model%r, z, lane%state)
      do k = 1, lane%wanted
         call derive_correction(lane%model%count, before, lane%state, lane%parameter(k), lane%d)
      end do
      if (.not. counts) return
      lane%measurements = lane%measurements + 1
      if (.not. lane%state%variance > 0.0_dp) return
      lane%logarithms = lane%logarithms + log(lane%state%variance)
      lane%squares = lane%squares + lane%state%innovation**2/lane%state%variance
      do k = 1, lane%wanted
         call add_slope(lane, lane%parameter(k))
      end do
      call judge(lane)
   end subroutine step

   !> Adds the derivative of ln S + e^2/S.
   pure subroutine add_slope(lane, m)
      type(lane_type), intent(inout) :: lane
      integer, intent(in) :: m

      associate (s => lane%state%variance, e => lane%state%innovation)
         lane%slope(m) = lane%slope(m) + (lane%d%variance(m)*(1.0_dp - e*e/s) + 2.0_dp*e*lane%d%innovation(m))/s
      end associate
   end subroutine add_slope

   !> Derivatives of the prediction by a parameter.
   pure subroutine derive_prediction(model, before, m, d)
      type(component_model_type), intent(in) :: model
      !> The state before it
      type(component_state_type), intent(in) :: before
      !> Number of the parameter
      integer, intent(in) :: m
      type(derivative_type), intent(inout) :: d
      integer :: i, j, n

      n = model%count
      do j = 1, n
         d%x(j, m) = model%phi(j)*d%x(j, m)
         do i = 1, n
            d%p(i, j, m) = model%phi(i)*model%phi(j)*d%p(i, j, m)
         end do
      end do
      if (m <= n) then
         d%x(m, m) = d%x(m, m) + before%x(m)
         do j = 1, n
            d%p(m, j, m) = d%p(m, j, m) + model%phi(j)*before%p(m, j)
            d%p(j, m, m) = d%p(j, m, m) + model%phi(j)*before%p(j, m)
         end do
      else if (m <= 2*n) then
         if (before%started .or. m - n /= before%walk) d%p(m - n, m - n, m) = d%p(m - n, m - n, m) + 1.0_dp
      end if
   end subroutine derive_prediction

   !> Derivatives of the correction by a parameter.
   pure subroutine derive_correction(n, before, state, m, d)
      integer, intent(in) :: n
      !> The prediction, and what became of it
      type(component_state_type), intent(in) :: before, state
      integer, intent(in) :: m
      type(derivative_type), intent(inout) :: d
      real(dp) :: c(n), dc(n), s, ds
      integer :: i, j

      do i = 1, n
         c(i) = sum(before%p(:n, i))
         dc(i) = sum(d%p(:n, i, m))
      end do
      ds = sum(dc)
      if (m == 2*n + 1) ds = ds + 1.0_dp
      if (.not. before%started) then
         associate (walk => before%walk)
            d%x(walk, m) = -(sum(d%x(:n, m)) - d%x(walk, m))
            d%p(:n, walk, m) = -dc
            d%p(walk, :n, m) = -dc
            d%p(walk, walk, m) = ds
         end associate
         return
      end if
      s = state%variance
      if (.not. s > 0.0_dp) return
      d%variance(m) = ds
      d%innovation(m) = -sum(d%x(:n, m))
      d%gain(:n, m) = (dc - state%gain(:n)*ds)/s
      d%x(:n, m) = d%x(:n, m) + d%gain(:n, m)*state%innovation + state%gain(:n)*d%innovation(m)
      do j = 1, n
         do i = 1, n
            d%p(i, j, m) = d%p(i, j, m) - d%gain(i, m)*c(j) - state%gain(i)*dc(j)
         end do
      end do
   end subroutine derive_correction

   !> Whether gain, S and their derivatives have come to rest.
   pure subroutine judge(lane)
      type(lane_type), intent(inout) :: lane
      real(dp) :: numbers(most_components, 0:2*most_parameters + 1)
      integer :: k, n

      n = lane%model%count
      numbers = 0.0_dp
      numbers(:n, 0) = lane%state%gain(:n)
      numbers(1, 1) = lane%state%variance
      do k = 1, lane%wanted
         numbers(:n, 2*k) = lane%d%gain(:n, lane%parameter(k))
         numbers(1, 2*k + 1) = lane%d%variance(lane%parameter(k))
      end do
      call judge_settling(lane%settling, numbers)
   end subroutine judge

   !> A step with the steady gain.
   pure subroutine step_settled(lane, z)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      real(dp) :: e, de, old(most_components), change(most_components)
      integer :: k, m, n

      n = lane%model%count
      associate (x => lane%state%x, d => lane%d, phi => lane%model%phi, s => lane%state%variance)
         old(:n) = x(:n)
         x(:n) = phi(:n)*x(:n)
         e = z - sum(x(:n))
         x(:n) = x(:n) + lane%state%gain(:n)*e
         do k = 1, lane%wanted
            m = lane%parameter(k)
            change(:n) = phi(:n)*d%x(:n, m)
            if (m <= n) change(m) = change(m) + old(m)
            de = -sum(change(:n))
            d%x(:n, m) = change(:n) + d%gain(:n, m)*e + lane%state%gain(:n)*de
            lane%slope(m) = lane%slope(m) + (d%variance(m)*(1.0_dp - e*e/s) + 2.0_dp*e*de)/s
         end do
         lane%logarithms = lane%logarithms + log(s)
         lane%squares = lane%squares + e*e/s
         lane%measurements = lane%measurements + 1
      end associate
   end subroutine step_settled

end module gyroakf_filter_likelihood
