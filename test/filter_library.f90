! SPDX-License-Identifier: MIT
!> Series and reference computations for the tests of the filters: dense, literal, slow.
module filter_library
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dpotrf, dpotrs
   use gyroakf_random, only : random_type, seed_random, fill_normal
   implicit none (type, external)
   private
   public :: fill_noise, make_series, companion_matrix, dense_filter, dense_gaussian, paper_phi

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

   !> AR(1) drift plus white noise as one Gaussian vector: log-likelihood of z, and the mean of the last drift
   !> given z, from the full covariance matrix.
   subroutine dense_gaussian(phi, drift_variance, white_variance, time, z, log_likelihood, last_mean)
      real(dp), intent(in) :: phi, drift_variance, white_variance
      !> Sample indices of z, increasing; the last drift is that of index time(n) itself
      integer, intent(in) :: time(:)
      real(dp), intent(in) :: z(:)
      real(dp), intent(out) :: log_likelihood, last_mean
      real(dp) :: c(size(z), size(z)), y(size(z), 1)
      integer :: i, j, n, info

      n = size(z)
      do j = 1, n
         do i = 1, n
            c(i, j) = drift_variance*phi**abs(time(i) - time(j))
            if (i == j) c(i, j) = c(i, j) + white_variance
         end do
      end do
      y(:, 1) = z
      call dpotrf("L", n, c, n, info)
      call dpotrs("L", n, 1, c, n, y, n, info)
      log_likelihood = -0.5_dp*(n*log(6.283185307179586_dp) + dot_product(z, y(:, 1)))
      last_mean = 0
      do i = 1, n
         log_likelihood = log_likelihood - log(c(i, i))
         last_mean = last_mean + drift_variance*phi**(time(n) - time(i))*y(i, 1)
      end do
   end subroutine dense_gaussian
end module filter_library
