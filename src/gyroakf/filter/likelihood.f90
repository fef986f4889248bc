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
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type, component_state_type, most_components, &
      check_components, start_components, predict_components, correct_components, settling_type, judge_settling
   use gyroakf_filter_measurement, only : is_sample
   implicit none (type, external)
   private
   public :: component_likelihood

   !> phi and q of every process, r: numbered 1 .. n, n + 1 .. 2 n, 2 n + 1; padded to a whole number of vector registers
   integer, parameter :: most_parameters = 2*most_components + 1, padded = 8
   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> Measurements between two tests whether the recursion is stationary
   integer, parameter :: test_interval = 64
   !> Samples between two reports of progress
   integer(int64), parameter :: report_samples = 262144

   !> What changes from step to step
   type :: lane_type
      type(component_model_type) :: model
      type(component_state_type) :: state
      !> The gradient is wanted
      logical :: derive = .false.
      !> Derivatives by every parameter of estimates, covariance (upper triangle), gain, innovation and its variance
      real(dp) :: dx(padded, most_components) = 0.0_dp, dcov(padded, most_components, most_components) = 0.0_dp
      real(dp) :: dgain(padded, most_components) = 0.0_dp, de(padded) = 0.0_dp, ds(padded) = 0.0_dp
      !> Of gain and S and their derivatives
      type(settling_type) :: settling
      integer :: look = 0
      !> Sums over the measurements: ln S, e^2/S, derivatives of the log-likelihood times -2
      real(dp) :: logarithms = 0.0_dp, squares = 0.0_dp, slope(padded) = 0.0_dp
      integer(int64) :: measurements = 0
   end type lane_type

contains

   !> Log-likelihood of a series under a model.
   subroutine component_likelihood(model, z, value, error, valid, gradient, progress)
      !> Checked here
      type(component_model_type), intent(in) :: model
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> The natural logarithm
      real(dp), intent(out) :: value
      !> invalid_argument, non_finite, unstable; too_few_samples (none that counts); singular (S is not positive); cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> By phi of every process (0 for a random walk), q of every process, r: [2 count + 1]
      real(dp), intent(out), optional :: gradient(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(lane_type) :: lane
      integer(int64) :: k, last
      logical :: here

      value = 0.0_dp
      if (present(gradient)) gradient = 0.0_dp
      call check_components(model, error)
      if (allocated(error)) return
      call begin(model, present(gradient), lane)
      k = 1
      last = 0
      do while (k <= size(z, kind=int64))
         if (k > last) then
            call report_progress("identifying", k - 1, size(z, kind=int64), error, progress)
            if (allocated(error)) return
            last = min(k + report_samples - 1, size(z, kind=int64))
         end if
         if (lane%settling%settled) call run_settled(lane, z, last, k, valid)
         if (k > last) cycle
         here = is_sample(z(k))
         if (present(valid)) here = here .and. valid(k) /= 0_int8
         call step(lane, z(k), here)
         if (.not. (lane%state%variance > 0.0_dp .or. lane%measurements == 0)) exit
         k = k + 1
      end do
      if (lane%measurements < 1) then
         call fatal_error(error, status%too_few_samples, "the likelihood of a drift model needs more samples")
      else if (k <= size(z, kind=int64)) then
         call fatal_error(error, status%singular, "a drift model predicts a measurement without error: it has no likelihood")
      end if
      if (allocated(error)) return
      value = -0.5_dp*(real(lane%measurements, dp)*log_two_pi + lane%logarithms + lane%squares)
      if (.not. present(gradient)) return
      gradient(:2*model%count + 1) = -0.5_dp*lane%slope(:2*model%count + 1)
      if (lane%state%walk > 0) gradient(lane%state%walk) = 0.0_dp
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
      lane%derive = derive
      n = model%count
      call start_components(model, lane%state)
      do i = 1, n
         if (i == lane%state%walk) cycle
         rest = (1.0_dp - model%phi(i))*(1.0_dp + model%phi(i))
         lane%dcov(i, i, i) = 2.0_dp*model%phi(i)*model%q(i)/rest**2
         lane%dcov(n + i, i, i) = 1.0_dp/rest
      end do
   end subroutine begin

   !> A step before everything has settled.
   pure subroutine step(lane, z, here)
      type(lane_type), intent(inout) :: lane
      real(dp), intent(in) :: z
      !> There is a measurement
      logical, intent(in) :: here
      real(dp) :: share
      logical :: counts

      if (lane%derive) call derive_prediction(lane%model, lane%state, lane%dx, lane%dcov)
      call predict_components(lane%model, lane%state)
      if (.not. here) then
         if (lane%settling%settled .or. lane%look > 0 .or. allocated(lane%settling%judged)) lane%settling = settling_type()
         lane%look = 0
         return
      end if
      counts = lane%state%started
      if (lane%derive .and. counts) then
         call derive_correction(lane%model, lane%state, z, lane)
      else if (lane%derive) then
         call derive_level(lane%model%count, lane%state%walk, lane%dx, lane%dcov)
      end if
      call correct_components(lane%model%count, lane%model%r, z, lane%state)
      if (.not. counts) return
      lane%measurements = lane%measurements + 1
      associate (s => lane%state%variance, e => lane%state%innovation)
         if (.not. s > 0.0_dp) return
         share = e/s
         lane%logarithms = lane%logarithms + log(s)
         lane%squares = lane%squares + e*share
         if (lane%derive) lane%slope = lane%slope + lane%ds*((1.0_dp - e*share)/s) + (2.0_dp*share)*lane%de
      end associate
      lane%look = lane%look + 1
      if (lane%look == test_interval) call look(lane)
   end subroutine step

   !> Derivatives of the prediction.
   pure subroutine derive_prediction(model, state, dx, dcov)
      type(component_model_type), intent(in) :: model
      !> Before it
      type(component_state_type), intent(in) :: state
      real(dp), intent(inout) :: dx(padded, *), dcov(padded, most_components, *)
      integer :: i, j

      do j = 1, model%count
         do i = 1, j
            dcov(:, i, j) = (model%phi(i)*model%phi(j))*dcov(:, i, j)
            dcov(i, i, j) = dcov(i, i, j) + model%phi(j)*state%p(i, j)
            dcov(j, i, j) = dcov(j, i, j) + model%phi(i)*state%p(i, j)
         end do
         if (state%started .or. j /= state%walk) dcov(model%count + j, j, j) = dcov(model%count + j, j, j) + 1.0_dp
         dx(:, j) = model%phi(j)*dx(:, j)
         dx(j, j) = dx(j, j) + state%x(j)
      end do
   end subroutine derive_prediction

   !> Derivatives of the correction.
   pure subroutine derive_correction(model, state, z, lane)
      type(component_model_type), intent(in) :: model
      !> The prediction
      type(component_state_type), intent(in) :: state
      !> The measurement
      real(dp), intent(in) :: z
      type(lane_type), intent(inout) :: lane
      real(dp), dimension(most_components) :: c, gain
      real(dp) :: dc(padded, most_components), e, s, share
      integer :: i, j, n

      n = model%count
      s = model%r
      e = z
      lane%ds = 0.0_dp
      lane%ds(2*n + 1) = 1.0_dp
      lane%de = 0.0_dp
      do i = 1, n
         c(i) = sum(state%p(:n, i))
         s = s + c(i)
         e = e - state%x(i)
         dc(:, i) = 0.0_dp
         do j = 1, n
            dc(:, i) = dc(:, i) + lane%dcov(:, min(i, j), max(i, j))
         end do
         lane%ds = lane%ds + dc(:, i)
         lane%de = lane%de - lane%dx(:, i)
      end do
      if (.not. s > 0.0_dp) return
      share = 1.0_dp/s
      do j = 1, n
         gain(j) = c(j)*share
         lane%dgain(:, j) = (dc(:, j) - gain(j)*lane%ds)*share
         lane%dx(:, j) = lane%dx(:, j) + lane%dgain(:, j)*e + gain(j)*lane%de
         do i = 1, j
            lane%dcov(:, i, j) = lane%dcov(:, i, j) - lane%dgain(:, i)*c(j) - gain(i)*dc(:, j)
         end do
      end do
   end subroutine derive_correction

   !> Derivatives of the first correction of a random walk: its estimate is what the others leave of the measurement.
   pure subroutine derive_level(n, walk, dx, dcov)
      integer, intent(in) :: n, walk
      real(dp), intent(inout) :: dx(padded, *), dcov(padded, most_components, *)
      real(dp) :: dc(padded, most_components), total(padded)
      integer :: i, j

      total = 0.0_dp
      total(2*n + 1) = 1.0_dp
      do i = 1, n
         dc(:, i) = 0.0_dp
         do j = 1, n
            if (i /= walk .and. j /= walk) dc(:, i) = dc(:, i) + dcov(:, min(i, j), max(i, j))
         end do
         total = total + dc(:, i)
      end do
      dx(:, walk) = 0.0_dp
      do i = 1, n
         if (i == walk) cycle
         dx(:, walk) = dx(:, walk) - dx(:, i)
         dcov(:, min(i, walk), max(i, walk)) = -dc(:, i)
      end do
      dcov(:, walk, walk) = total
   end subroutine derive_level

   !> Whether gain, S and their derivatives have come to rest.
   pure subroutine look(lane)
      type(lane_type), intent(inout) :: lane
      real(dp) :: numbers(most_components, 0:2*padded + 1)
      integer :: k, n

      n = lane%model%count
      numbers = 0.0_dp
      numbers(:n, 0) = lane%state%gain(:n)
      numbers(1, 1) = lane%state%variance
      do k = 1, padded
         numbers(:n, 2*k) = lane%dgain(k, :n)
         numbers(1, 2*k + 1) = lane%ds(k)
      end do
      call judge_settling(lane%settling, numbers)
      lane%look = 0
   end subroutine look

   !> Steps with the steady gain, up to the next missing sample.
   pure subroutine run_settled(lane, z, end, k, valid)
      type(lane_type), intent(inout) :: lane
      !> The series, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> The last sample that may be taken
      integer(int64), intent(in) :: end
      !> The next sample; the first one behind these steps afterwards
      integer(int64), intent(inout) :: k
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: first, last

      first = k
      last = first - 1
      do while (last < end)
         if (.not. is_sample(z(last + 1))) exit
         if (present(valid)) then
            if (valid(last + 1) == 0_int8) exit
         end if
         last = last + 1
      end do
      k = last + 1
      if (last < first) return
      if (lane%derive) then
         call derive_settled(lane, z(first:last))
      else
         call filter_settled(lane, z(first:last))
      end if
   end subroutine run_settled

   !> Steps with the steady gain, without derivatives.
   pure subroutine filter_settled(lane, z)
      type(lane_type), intent(inout) :: lane
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      real(dp) :: x(most_components), phi(most_components), gain(most_components), e, squares
      integer(int64) :: k
      integer :: n

      n = lane%model%count
      x = lane%state%x
      phi = lane%model%phi
      gain = lane%state%gain
      x(n + 1:) = 0.0_dp
      gain(n + 1:) = 0.0_dp
      squares = 0.0_dp
      do k = 1, size(z, kind=int64)
         x = phi*x
         e = z(k) - (x(1) + x(2) + x(3))
         x = x + gain*e
         squares = squares + e*e
      end do
      lane%state%x = x
      call add_settled(lane, size(z, kind=int64), squares)
   end subroutine filter_settled

   !> Steps with the steady gain, with the derivatives.
   pure subroutine derive_settled(lane, z)
      type(lane_type), intent(inout) :: lane
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      real(dp) :: e, before, squares, de(padded), products(padded), dx(padded, most_components)
      integer(int64) :: k
      integer :: j, n

      n = lane%model%count
      squares = 0.0_dp
      products = 0.0_dp
      dx = lane%dx
      associate (x => lane%state%x, phi => lane%model%phi, gain => lane%state%gain, s => lane%state%variance)
         do k = 1, size(z, kind=int64)
            e = z(k)
            de = 0.0_dp
            do j = 1, n
               before = x(j)
               x(j) = phi(j)*before
               e = e - x(j)
               dx(:, j) = phi(j)*dx(:, j)
               dx(j, j) = dx(j, j) + before
               de = de - dx(:, j)
            end do
            do j = 1, n
               x(j) = x(j) + gain(j)*e
               dx(:, j) = dx(:, j) + lane%dgain(:, j)*e + gain(j)*de
            end do
            squares = squares + e*e
            products = products + e*de
         end do
         lane%dx = dx
         lane%slope = lane%slope + (lane%ds*(real(size(z, kind=int64), dp) - squares/s) + 2.0_dp*products)/s
      end associate
      call add_settled(lane, size(z, kind=int64), squares)
   end subroutine derive_settled

   !> Sums of steps with the steady gain.
   pure subroutine add_settled(lane, measurements, squares)
      type(lane_type), intent(inout) :: lane
      integer(int64), intent(in) :: measurements
      !> Of the innovations
      real(dp), intent(in) :: squares

      lane%logarithms = lane%logarithms + real(measurements, dp)*log(lane%state%variance)
      lane%squares = lane%squares + squares/lane%state%variance
      lane%measurements = lane%measurements + measurements
   end subroutine add_settled

end module gyroakf_filter_likelihood
