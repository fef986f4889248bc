! SPDX-License-Identifier: MIT
!> A polynomial under the drift: its coefficients by generalised least squares for a given drift model.
!>
!> For a given model the log-likelihood of z - X beta is quadratic in beta,
!> $$ \ln L(\beta) = \ln L(0) + b^T \beta - \tfrac12 \beta^T A \beta, \quad A = X^T \Sigma^{-1} X, \quad b = X^T \Sigma^{-1} z, $$
!> so its values at 0, at the unit vectors, their opposites and their sums give A and b exactly; beta = A^-1 b. The columns of X are
!> Legendre polynomials of the time, -1 .. 1 over the samples.
!>
!> Source: Harvey, Forecasting, Structural Time Series Models and the Kalman Filter (1989), 3.4.2.
module gyroakf_filter_drift_trend
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_lapack, only : dposv
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   implicit none (type, external)
   private
   public :: largest_degree, fit_polynomial, rough_polynomial, subtract_polynomial

   !> Degrees that a polynomial may have; the mean is not among them
   integer, parameter :: largest_degree = 3
   !> Length of the vectors at which the likelihood is looked at: far, so that rounding is small beside the differences
   real(dp), parameter :: far = 100.0_dp

contains

   !> Coefficients by generalised least squares; left as they are where the likelihood cannot tell them.
   subroutine fit_polynomial(model, z, here, coefficient)
      !> The drift and the white noise
      type(component_model_type), intent(in) :: model
      !> Series, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> 1 present, 0 missing: [n]; not allocated where all are present
      integer(int8), allocatable, intent(in) :: here(:)
      !> Of the Legendre polynomials of degree 1, 2, ...: [degree]
      real(dp), intent(inout) :: coefficient(:)
      real(dp) :: a(size(coefficient), size(coefficient)), b(size(coefficient), 1)
      real(dp) :: base, both, plus(size(coefficient)), minus(size(coefficient)), point(size(coefficient))
      integer :: i, j, n, info
      logical :: known

      n = size(coefficient)
      point = 0.0_dp
      known = .true.
      call take_value(model, z, here, point, base, known)
      do i = 1, n
         point(i) = far
         call take_value(model, z, here, point, plus(i), known)
         point(i) = -far
         call take_value(model, z, here, point, minus(i), known)
         point(i) = 0.0_dp
         a(i, i) = (2.0_dp*base - plus(i) - minus(i))/far**2
         b(i, 1) = 0.5_dp*(plus(i) - minus(i))/far
      end do
      do j = 2, n
         do i = 1, j - 1
            point = 0.0_dp
            point([i, j]) = far
            call take_value(model, z, here, point, both, known)
            a(i, j) = (plus(i) + plus(j) - base - both)/far**2
            a(j, i) = a(i, j)
         end do
      end do
      if (.not. known) return
      call dposv("L", n, 1, a, n, b, n, info)
      if (info == 0) coefficient = b(:, 1)
   end subroutine fit_polynomial

   !> Log-likelihood of a series less a polynomial.
   subroutine take_value(model, z, here, coefficient, value, known)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in), contiguous :: z(:)
      integer(int8), allocatable, intent(in) :: here(:)
      real(dp), intent(in) :: coefficient(:)
      !> 0 where there is none
      real(dp), intent(out) :: value
      !> False from the first on that there is none
      logical, intent(inout) :: known
      real(dp), allocatable :: rest(:)
      type(error_type), allocatable :: failed

      value = 0.0_dp
      if (.not. known) return
      rest = z
      call subtract_polynomial(coefficient, rest)
      if (allocated(here)) then
         call component_likelihood(model, rest, value, failed, here)
      else
         call component_likelihood(model, rest, value, failed)
      end if
      known = .not. allocated(failed)
   end subroutine take_value

   !> Coefficients as if the polynomials were orthogonal and the noise white: where a search begins.
   pure subroutine rough_polynomial(z, here, coefficient)
      !> Series of mean 0, 0 where samples are missing: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> 1 present, 0 missing: [n]; not allocated where all are present
      integer(int8), allocatable, intent(in) :: here(:)
      !> [degree]
      real(dp), intent(out) :: coefficient(:)
      real(dp) :: p(largest_degree), squares(size(coefficient))
      integer(int64) :: k

      coefficient = 0.0_dp
      squares = 0.0_dp
      do k = 1, size(z, kind=int64)
         if (allocated(here)) then
            if (here(k) == 0_int8) cycle
         end if
         p = legendre(k, size(z, kind=int64))
         coefficient = coefficient + z(k)*p(:size(coefficient))
         squares = squares + p(:size(coefficient))**2
      end do
      where (squares > 0.0_dp) coefficient = coefficient/squares
   end subroutine rough_polynomial

   !> Takes a polynomial from a series.
   pure subroutine subtract_polynomial(coefficient, series)
      !> Of the Legendre polynomials of degree 1, 2, ...: [degree]
      real(dp), intent(in) :: coefficient(:)
      !> [n]
      real(dp), intent(inout), contiguous :: series(:)
      real(dp) :: p(largest_degree)
      integer(int64) :: k

      do k = 1, size(series, kind=int64)
         p = legendre(k, size(series, kind=int64))
         series(k) = series(k) - dot_product(coefficient, p(:size(coefficient)))
      end do
   end subroutine subtract_polynomial

   !> The Legendre polynomials of degree 1, 2, 3 at a sample.
   pure function legendre(k, n) result(p)
      !> Its number, and that of all
      integer(int64), intent(in) :: k, n
      real(dp) :: p(largest_degree), t

      t = real(2*k - n - 1, dp)/real(max(n - 1, 1_int64), dp)
      p = [t, 0.5_dp*(3.0_dp*t**2 - 1.0_dp), 0.5_dp*t*(5.0_dp*t**2 - 3.0_dp)]
   end function legendre

end module gyroakf_filter_drift_trend
