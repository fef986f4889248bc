! SPDX-License-Identifier: MIT
!> Where the search for the largest likelihood of an ARMA(p, q) model begins.
!>
!> Hannan and Rissanen: a long AR model, its order chosen by AIC, gives innovations; the coefficients are the regression of the
!> series on its own past and theirs. All covariances of that regression follow from the autocovariances r_k of the series, with
!> c_0 = 1, c_l = -alpha_l of the long model:
!> $$E\,y_{t+h} e_t = \sum_l c_l r_{h+l}, \quad E\,e_{t+h} e_t = \sum_{k,l} c_k c_l r_{h+l-k},$$
!> so that missing samples are no matter and no residual is formed. Their third step, against the bias, is a step of scoring on the
!> likelihood, which the search begins with anyway. Sources: E. J. Hannan, J. Rissanen, Biometrika 69 (1982) 81-94, 70 (1983) 303;
!> for drift in white noise: C. W. J. Granger, M. J. Morris, J. R. Stat. Soc. A 139 (1976) 246-257.
module gyroakf_ar_arma_start
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_lapack, only : dposv
   use gyroakf_ar_levinson, only : solve_levinson
   implicit none (type, external)
   private
   public :: long_order, regress_on_past, drift_as_arma, arma_as_drift

contains

   !> Largest order of the long AR model.
   pure integer function long_order(n)
      !> Samples
      real(dp), intent(in) :: n

      long_order = int(min(n/10.0_dp, 10.0_dp*log10(max(n, 10.0_dp)), 60.0_dp))
      long_order = max(long_order, 3)
   end function long_order

   !> Coefficients by regression on the past of the series and of the innovations of a long AR model.
   subroutine regress_on_past(r, n, phi, theta)
      !> Autocovariances: [0:long_order + 3]
      real(dp), intent(in) :: r(0:)
      !> Samples
      real(dp), intent(in) :: n
      !> Coefficients, 0 where the regression is singular; not always stationary: [p], p <= 3
      real(dp), intent(out) :: phi(:)
      !> Coefficients, 0 where the regression is singular; not always invertible: [q], q <= 3
      real(dp), intent(out) :: theta(:)
      type(error_type), allocatable :: error
      real(dp), allocatable :: long(:, :), variance(:)
      real(dp) :: c(0:ubound(r, 1)), gram(size(phi) + size(theta), size(phi) + size(theta)), right(size(phi) + size(theta), 1)
      integer :: p, q, m, i, j, info

      phi(:) = 0.0_dp
      theta(:) = 0.0_dp
      p = size(phi)
      q = size(theta)
      if (p + q == 0) return
      call solve_levinson(r(:ubound(r, 1) - 3), long, variance, error)
      if (allocated(error)) return
      m = minloc(n*log(variance) + 2.0_dp*[(real(i, dp), i=0, ubound(variance, 1))], dim=1) - 1
      m = min(max(m, p, q), ubound(variance, 1))
      c(:) = 0.0_dp
      c(0) = 1.0_dp
      c(1:m) = -long(1:m, m)
      do j = 1, p
         right(j, 1) = r(j)
         do i = 1, p
            gram(i, j) = r(abs(i - j))
         end do
      end do
      do j = 1, q
         right(p + j, 1) = with_innovation(r, c(0:m), j)
         do i = 1, p
            gram(i, p + j) = with_innovation(r, c(0:m), j - i)
            gram(p + j, i) = gram(i, p + j)
         end do
         do i = 1, q
            gram(p + i, p + j) = of_innovations(r, c(0:m), i - j)
         end do
      end do
      call dposv("U", p + q, 1, gram, p + q, right, p + q, info)
      if (info /= 0) return
      phi(:) = right(:p, 1)
      theta(:) = right(p + 1:, 1)
   end subroutine regress_on_past

   !> E y_(t+h) e_t.
   pure real(dp) function with_innovation(r, c, h) result(covariance)
      real(dp), intent(in) :: r(0:), c(0:)
      integer, intent(in) :: h
      integer :: l

      covariance = 0.0_dp
      do l = 0, ubound(c, 1)
         covariance = covariance + c(l)*r(abs(h + l))
      end do
   end function with_innovation

   !> E e_(t+h) e_t.
   pure real(dp) function of_innovations(r, c, h) result(covariance)
      real(dp), intent(in) :: r(0:), c(0:)
      integer, intent(in) :: h
      integer :: k

      covariance = 0.0_dp
      do k = 0, ubound(c, 1)
         covariance = covariance + c(k)*with_innovation(r, c, h - k)
      end do
   end function of_innovations

   !> Theta of the ARMA(1, 1) that an AR(1) drift in white noise is: both have the same autocovariances.
   pure real(dp) function drift_as_arma(phi, drift_variance, white_variance) result(theta)
      !> Coefficient of the drift, 0 < phi < 1
      real(dp), intent(in) :: phi
      !> Variance of the drift, > 0
      real(dp), intent(in) :: drift_variance
      !> Variance of the white noise, >= 0
      real(dp), intent(in) :: white_variance
      real(dp) :: b

      theta = 0.0_dp
      if (white_variance <= tiny(b)*1.0e10_dp .or. phi <= 0.0_dp) return
      b = (drift_variance*(1.0_dp - phi)*(1.0_dp + phi) + white_variance*(1.0_dp + phi**2))/(2.0_dp*phi*white_variance)
      theta = -1.0_dp/(b + sqrt(max((b - 1.0_dp)*(b + 1.0_dp), 0.0_dp)))
   end function drift_as_arma

   !> The AR(1) drift in white noise that an ARMA(1, 1) is, in units of sigma^2:
   !> $$R = -\theta/\phi, \quad D = (\phi + \theta)(1 + \phi\theta)/(\phi (1 - \phi^2)), \quad -\phi < \theta \le 0 < \phi < 1.$$
   pure subroutine arma_as_drift(phi, theta, drift_variance, white_variance, drift_slope, white_slope, admissible)
      !> Coefficients
      real(dp), intent(in) :: phi, theta
      !> D and R, per sigma^2; 0 where it is none
      real(dp), intent(out) :: drift_variance, white_variance
      !> Their derivatives by phi and theta
      real(dp), intent(out) :: drift_slope(2), white_slope(2)
      !> The model is one
      logical, intent(out) :: admissible
      real(dp) :: n, n_slope(2), g

      drift_variance = 0.0_dp
      white_variance = 0.0_dp
      drift_slope(:) = 0.0_dp
      white_slope(:) = 0.0_dp
      admissible = phi > 0.0_dp .and. phi < 1.0_dp .and. theta <= 0.0_dp .and. theta > -phi
      if (.not. admissible) return
      n = (phi + theta)*(1.0_dp + phi*theta)
      n_slope(:) = [(1.0_dp + phi*theta) + theta*(phi + theta), (1.0_dp + phi*theta) + phi*(phi + theta)]
      g = phi*(1.0_dp - phi)*(1.0_dp + phi)
      drift_variance = n/g
      drift_slope(:) = [(n_slope(1) - drift_variance*(1.0_dp - 3.0_dp*phi**2))/g, n_slope(2)/g]
      white_variance = abs(theta)/phi
      white_slope(:) = [theta/phi**2, -1.0_dp/phi]
   end subroutine arma_as_drift

end module gyroakf_ar_arma_start
