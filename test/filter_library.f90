! SPDX-License-Identifier: MIT
!> Models, series and reference computations for the tests of the filters: dense, literal, slow.
module filter_library
   use gyroakf_kinds, only : dp, int64
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options
   use gyroakf_lapack, only : dpotrf, dpotrs
   use gyroakf_random, only : random_type, seed_random, fill_normal
   use expectations, only : failure => problem, went_wrong
   implicit none (type, external)
   private
   public :: fill_noise, make_series, add_walk, companion_matrix, dense_filter, dense_drift, &
      & dense_likelihood
   public :: some_model, adaptive, not_made, make_data, rounding, paper_phi

   !> The same numbers in another order of operations
   real(dp), parameter :: rounding = 1.0e-12_dp
   !> Coefficient of the paper's AR(1) model
   real(dp), parameter :: paper_phi = 0.409975_dp

contains

   !> Normal numbers of the library's own generator.
   subroutine fill_noise(seed, x)
      integer, intent(in) :: seed
      real(dp), intent(out), contiguous :: x(:)
      type(random_type) :: random

      call seed_random(random, int(seed, int64))
      call fill_normal(random, x)
   end subroutine fill_noise

   !> A stationary AR(1) drift of this variance, plus white noise; z is their sum.
   subroutine make_series(seed, phi, drift_variance, white_variance, z, drift)
      integer, intent(in) :: seed
      real(dp), intent(in) :: phi, drift_variance, white_variance
      real(dp), intent(out), contiguous :: z(:)
      real(dp), intent(out), optional :: drift(:)
      real(dp), allocatable :: w(:)
      real(dp) :: state
      integer :: i

      allocate (w(size(z)))
      call fill_noise(seed, w)
      call fill_noise(seed + 100000, z)
      z = sqrt(white_variance)*z
      state = sqrt(drift_variance)*w(1)
      do i = 1, size(z)
         if (i > 1) state = phi*state + sqrt(drift_variance*(1 - phi**2))*w(i)
         if (present(drift)) drift(i) = state
         z(i) = z(i) + state
      end do
   end subroutine make_series

   !> Adds a random walk of this standard deviation per step.
   subroutine add_walk(seed, step, z)
      integer, intent(in) :: seed
      real(dp), intent(in) :: step
      real(dp), intent(inout), contiguous :: z(:)
      real(dp), allocatable :: w(:)
      real(dp) :: level
      integer :: i

      allocate (w(size(z)))
      call fill_noise(seed, w)
      level = 0.0_dp
      do i = 1, size(z)
         level = level + step*w(i)
         z(i) = z(i) + level
      end do
   end subroutine add_walk

   !> The transition matrix of an AR(p) state.
   pure function companion_matrix(phi) result(a)
      real(dp), intent(in) :: phi(:)
      real(dp) :: a(size(phi), size(phi))
      integer :: i

      a = 0
      a(1, :) = phi
      do i = 2, size(phi)
         a(i, i - 1) = 1
      end do
   end function companion_matrix

   !> The Kalman filter in matrices, Joseph form, measurements where here is true.
   pure subroutine dense_filter(phi, q, r, p0, z, here, x, gain)
      real(dp), intent(in) :: phi(:), q, r, p0(:, :), z(:)
      logical, intent(in) :: here(:)
      real(dp), intent(out) :: x(:), gain(:)
      real(dp), dimension(size(phi), size(phi)) :: a, p, keep
      real(dp) :: state(size(phi)), s
      integer :: i, k

      a = companion_matrix(phi)
      p = p0
      state = 0
      gain = 0
      do k = 1, size(z)
         state = matmul(a, state)
         p = matmul(a, matmul(p, transpose(a)))
         p(1, 1) = p(1, 1) + q
         if (here(k)) then
            s = p(1, 1) + r
            gain = p(:, 1)/s
            state = state + gain*(z(k) - state(1))
            keep = 0
            do i = 1, size(phi)
               keep(i, i) = 1
            end do
            keep(:, 1) = keep(:, 1) - gain
            p = matmul(keep, matmul(p, transpose(keep))) + r*spread(gain, 2, size(phi))*spread(gain, 1, size(phi))
         end if
         x(k) = state(1)
      end do
   end subroutine dense_filter

   !> Mean and variance of the drift given the present samples, by covariance matrices; the level of a random walk by generalised
   !> least squares.
   subroutine dense_drift(model, slow, z, here, white, drift, variance)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:), here(:)
      real(dp), intent(in) :: z(:), white(:)
      real(dp), intent(out) :: drift(:), variance(:)
      real(dp), allocatable :: a(:, :), solved(:, :), cross(:), right(:, :)
      integer, allocatable :: at(:)
      real(dp) :: own, level, weight, share
      integer :: i, k, n, info, t
      logical :: walk, any_walk

      at = pack([(i, i=1, size(z))], here)
      n = size(at)
      allocate (a(n, n), solved(n, 2), cross(n), right(n, 1))
      a = covariances(model, at, white(at))
      call dpotrf("L", n, a, n, info)
      solved(:, 1) = z(at)
      solved(:, 2) = 1.0_dp
      call dpotrs("L", n, 2, a, n, solved, n, info)
      any_walk = any(model%phi(:model%count) >= 1.0_dp)
      walk = any(slow .and. model%phi(:model%count) >= 1.0_dp)
      level = 0.0_dp
      weight = sum(solved(:, 2))
      if (any_walk) level = sum(solved(:, 1))/weight
      do t = 1, size(z)
         cross = 0.0_dp
         own = 0.0_dp
         do k = 1, model%count
            if (.not. slow(k)) cycle
            cross = cross + [(covariance(model, k, t, at(i), at(1)), i=1, n)]
            own = own + covariance(model, k, t, t, at(1))
         end do
         drift(t) = dot_product(cross, solved(:, 1) - level*solved(:, 2)) + merge(level, 0.0_dp, walk)
         right(:, 1) = cross
         call dpotrs("L", n, 1, a, n, right, n, info)
         variance(t) = own - dot_product(cross, right(:, 1))
         share = merge(1.0_dp, 0.0_dp, walk) - dot_product(cross, solved(:, 2))
         if (any_walk) variance(t) = variance(t) + share**2/weight
      end do
   end subroutine dense_drift

   !> Log-likelihood of the present samples by a factorisation of their covariance; with a random walk of their differences,
   !> to which the first one adds nothing.
   real(dp) function dense_likelihood(model, z, here) result(value)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in) :: z(:)
      logical, intent(in) :: here(:)
      real(dp), allocatable :: a(:, :), y(:), d(:, :)
      integer, allocatable :: at(:)
      integer :: i, j, n, info

      at = pack([(i, i=1, size(z))], here)
      n = size(at)
      allocate (a(n, n))
      a = covariances(model, at, spread(model%r, 1, n))
      y = z(at)
      ! z_i - z_1: a unit matrix after a column of -1
      if (any(model%phi(:model%count) >= 1.0_dp)) then
         d = a(2:, 2:)
         do j = 2, n
            do i = 2, n
               d(i - 1, j - 1) = a(i, j) - a(1, j) - a(i, 1) + a(1, 1)
            end do
         end do
         y = y(2:) - y(1)
         call move_alloc(d, a)
         n = n - 1
      end if
      call dpotrf("L", n, a, n, info)
      value = -0.5_dp*n*log(8*atan(1.0_dp))
      do i = 1, n
         y(i) = (y(i) - dot_product(a(i, :i - 1), y(:i - 1)))/a(i, i)
         value = value - log(a(i, i)) - 0.5_dp*y(i)**2
      end do
   end function dense_likelihood

   !> Covariances of the present samples, with the variances of their white noise.
   pure function covariances(model, at, white) result(a)
      type(component_model_type), intent(in) :: model
      integer, intent(in) :: at(:)
      real(dp), intent(in) :: white(:)
      real(dp) :: a(size(at), size(at))
      integer :: i, j, k

      do j = 1, size(at)
         do i = 1, size(at)
            a(i, j) = sum([(covariance(model, k, at(i), at(j), at(1)), k=1, model%count)])
         end do
         a(j, j) = a(j, j) + white(j)
      end do
   end function covariances

   !> Covariance of a process at two samples; of a random walk of its distances from the level at the first present sample.
   pure real(dp) function covariance(model, k, i, j, first)
      type(component_model_type), intent(in) :: model
      integer, intent(in) :: k, i, j, first

      if (model%phi(k) < 1.0_dp) then
         covariance = model%q(k)/(1.0_dp - model%phi(k)**2)*model%phi(k)**abs(i - j)
      else if ((i - first)*(j - first) <= 0) then
         covariance = 0.0_dp
      else
         covariance = model%q(k)*min(abs(i - first), abs(j - first))
      end if
   end function covariance

   !> So many processes of a model with a walk, an AR(1) process and a faster one.
   pure function some_model(processes) result(model)
      integer, intent(in) :: processes
      type(component_model_type) :: model

      model%count = processes
      model%phi = [0.98_dp, 1.0_dp, 0.5_dp]
      model%q = [0.04_dp, 1.0e-3_dp, 0.3_dp]
      model%r = 2.0_dp
   end function some_model

   !> What adapts in most tests: R, gated.
   pure function adaptive() result(options)
      type(filter_options) :: options

      options%estimate_measurement_variance = .true.
      options%forgetting = 0.99_dp
      options%huber = 2.5_dp
      options%burn_in = 20
   end function adaptive

   !> A filter that must come about.
   logical function not_made(filter, model, slow, options)
      type(drift_filter_type), intent(out) :: filter
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(filter_options), intent(in) :: options

      call new_drift_filter(filter, model, slow, options, failure)
      not_made = went_wrong(failure)
   end function not_made

   !> A series of the model, with a level.
   subroutine make_data(seed, model, z, drift)
      integer, intent(in) :: seed
      type(component_model_type), intent(in) :: model
      real(dp), intent(out), contiguous :: z(:)
      real(dp), intent(out), optional :: drift(:)
      real(dp) :: w(size(z)), state
      integer :: i, k

      call fill_noise(seed, z)
      z = sqrt(model%r)*z
      if (present(drift)) drift = 0
      do i = 1, model%count
         call fill_noise(1000*i + seed, w)
         state = 0
         if (model%phi(i) < 1) state = w(1)*sqrt(model%q(i)/(1 - model%phi(i)**2))
         do k = 1, size(z)
            if (k > 1) state = model%phi(i)*state + sqrt(model%q(i))*w(k)
            z(k) = z(k) + state
            if (present(drift)) drift(k) = drift(k) + state
         end do
      end do
   end subroutine make_data

end module filter_library
