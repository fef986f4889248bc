! SPDX-License-Identifier: MIT
!> The filter of a drift model with its steady gain K, over a stretch of samples without a gap, and
!> its derivatives by the parameters of the model.
!>
!> A shift d of the state before the stretch changes the innovations to $ e_k - g_k^T d $ with
!> $ g_k = (L^T)^{k-1} \mathbf 1, L = \Phi (I - K \mathbf 1^T) $: summed are e e, g e and g g.
module gyroakf_filter_steady_filter
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_filter_components, only : component_model_type, most_components
   use gyroakf_filter_derivatives, only : last_lane, product_of, quotient
   use gyroakf_filter_drift_steady, only : steady_covariance, sum_powers
   implicit none (type, external)
   private
   public :: steady_filter_type, stretch_type, make_steady_filter, run_stretch

   !> Below it g is rounding
   real(dp), parameter :: vanished = 1.0e-18_dp

   !> The filter
   type :: steady_filter_type
      !> Processes
      integer :: n = 0
      !> Coefficients, variances of the driving noises, Phi K
      real(dp), dimension(0:last_lane, most_components) :: phi = 0.0_dp, q = 0.0_dp, gain = 0.0_dp
      !> Covariance P of the prediction, and L
      real(dp), dimension(0:last_lane, most_components, most_components) :: p = 0.0_dp, l = 0.0_dp
      !> Variance of the innovation
      real(dp) :: s(0:last_lane) = 0.0_dp
   end type steady_filter_type

   !> A stretch
   type :: stretch_type
      integer(int64) :: samples = 0
      !> Prediction of the next sample, and the next g; whether that is rounding
      real(dp), dimension(0:last_lane, most_components) :: x = 0.0_dp, g = 0.0_dp
      logical :: vanished = .false.
      !> Sums of e e (the derivatives halved), g e and g g (the values doubled)
      real(dp) :: squares(0:last_lane) = 0.0_dp, b(0:last_lane, most_components) = 0.0_dp
      real(dp) :: gram(0:last_lane, most_components, most_components) = 0.0_dp
   end type stretch_type

contains

   !> The filter of a model. The derivatives of P solve $ P' = L P' L^T + R $: by doubling.
   subroutine make_steady_filter(model, filter, error)
      !> Checked
      type(component_model_type), intent(in) :: model
      !> The derivative by q of a random walk without steps, which is infinite, is left out
      type(steady_filter_type), intent(out) :: filter
      !> As steady_covariance
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(most_components, most_components) :: p, l
      real(dp), dimension(0:last_lane, most_components, most_components) :: rest
      real(dp) :: gain(most_components), share(most_components), s
      logical :: walk
      integer :: i, j, n

      call steady_covariance(model, p, error)
      if (allocated(error)) return
      n = model%count
      filter%n = n
      share = sum(p, 1)
      s = model%r + sum(share)
      gain = share/s
      do j = 1, n
         walk = model%phi(j) >= 1.0_dp
         filter%phi(0, j) = model%phi(j)
         if (.not. walk) filter%phi(j, j) = 1.0_dp
         filter%q(0, j) = model%q(j)
         if (.not. walk .or. model%q(j) > 0.0_dp) filter%q(n + j, j) = 1.0_dp
      end do
      rest = 0.0_dp
      l = 0.0_dp
      do j = 1, n
         do i = 1, n
            l(i, j) = model%phi(i)*(merge(1.0_dp, 0.0_dp, i == j) - gain(i))
            rest(:, i, j) = (p(i, j) - gain(i)*share(j))* &
                            (model%phi(i)*filter%phi(:, j) + model%phi(j)*filter%phi(:, i))
            rest(2*n + 1, i, j) = model%phi(i)*gain(i)*model%phi(j)*gain(j)
         end do
         rest(n + j, j, j) = rest(n + j, j, j) + filter%q(n + j, j)
      end do
      call sum_powers(l(:n, :n), rest(:, :n, :n))
      filter%p = rest
      filter%p(0, :, :) = p
      filter%s = sum(sum(filter%p, 3), 2)
      filter%s(0) = s
      filter%s(2*n + 1) = filter%s(2*n + 1) + 1.0_dp
      do i = 1, n
         filter%gain(:, i) = &
            product_of(filter%phi(:, i), quotient(sum(filter%p(:, :, i), 2), filter%s))
         do j = 1, n
            filter%l(:, i, j) = merge(1.0_dp, 0.0_dp, i == j)*filter%phi(:, i) - filter%gain(:, i)
         end do
      end do
   end subroutine make_steady_filter

   !> The filter over the next samples of a stretch.
   pure subroutine run_stretch(filter, z, level, stretch)
      type(steady_filter_type), intent(in) :: filter
      !> Measurements, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Subtracted from them
      real(dp), intent(in) :: level
      !> Goes on
      type(stretch_type), intent(inout) :: stretch

      if (stretch%vanished) then
         select case (filter%n)
         case (1)
            call run_steps(1, .false., filter, z, level, stretch)
         case (2)
            call run_steps(2, .false., filter, z, level, stretch)
         case default
            call run_steps(most_components, .false., filter, z, level, stretch)
         end select
      else
         select case (filter%n)
         case (1)
            call run_steps(1, .true., filter, z, level, stretch)
         case (2)
            call run_steps(2, .true., filter, z, level, stretch)
         case default
            call run_steps(most_components, .true., filter, z, level, stretch)
         end select
         stretch%vanished = maxval(abs(stretch%g(0, :))) < vanished
      end if
      stretch%samples = stretch%samples + size(z, kind=int64)
   end subroutine run_stretch

   !> Hot. A step is $ e = z - \mathbf 1^T x, x \leftarrow \Phi (x + K e), g \leftarrow \Phi g -
   !> \mathbf 1 (\Phi K)^T g $, which keeps the digits of a small K. The values v run ahead of the
   !> vectors.
   pure subroutine run_steps(n, with_g, filter, z, level, stretch)
      !> Processes, whether g has not vanished: known where this is called, for unrolled loops
      integer, value :: n
      logical, value :: with_g
      type(steady_filter_type), intent(in) :: filter
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: level
      type(stretch_type), intent(inout) :: stretch
      integer :: i, j, m
      real(dp), parameter :: unit(0:last_lane) = [1.0_dp, (0.0_dp, m=1, last_lane)]
      real(dp), dimension(0:last_lane, most_components) :: x, g, b, phi_slope, gain_slope
      real(dp) :: gram(0:last_lane, most_components, most_components)
      real(dp), dimension(0:last_lane) :: e, common, squares
      real(dp), dimension(most_components) :: phi, gain, v, w
      real(dp) :: y, value
      integer(int64) :: k

      phi = filter%phi(0, :)
      phi_slope = filter%phi
      phi_slope(0, :) = 0.0_dp
      gain = filter%gain(0, :)
      gain_slope = filter%gain
      gain_slope(0, :) = 0.0_dp
      x = stretch%x
      v = x(0, :)
      g = stretch%g
      b = stretch%b
      gram = stretch%gram
      squares = stretch%squares
      do k = 1, size(z, kind=int64)
         y = z(k) - level
         value = y - sum(v(:n))
         e = unit*y
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               e(m) = e(m) - x(m, i)
            end do
         end do
         !$omp simd
         do m = 0, last_lane
            squares(m) = squares(m) + value*e(m)
         end do
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               x(m, i) = (phi(i)*x(m, i) + (phi_slope(m, i)*v(i) + gain_slope(m, i)*value)) &
                         + gain(i)*e(m)
            end do
         end do
         v(:n) = phi(:n)*v(:n) + gain(:n)*value
         if (.not. with_g) cycle
         w(:n) = g(0, :n)
         common = 0.0_dp
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               b(m, i) = b(m, i) + (value*g(m, i) + w(i)*e(m))
               common(m) = common(m) + (gain(i)*g(m, i) + w(i)*gain_slope(m, i))
            end do
            do j = 1, n
               !$omp simd
               do m = 0, last_lane
                  gram(m, j, i) = gram(m, j, i) + (w(j)*g(m, i) + w(i)*g(m, j))
               end do
            end do
         end do
         do i = 1, n
            !$omp simd
            do m = 0, last_lane
               g(m, i) = (phi(i)*g(m, i) + w(i)*phi_slope(m, i)) - common(m)
            end do
         end do
      end do
      stretch%x = x
      stretch%g = g
      stretch%b = b
      stretch%gram = gram
      stretch%squares = squares
   end subroutine run_steps

end module gyroakf_filter_steady_filter
