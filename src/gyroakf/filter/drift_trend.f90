! SPDX-License-Identifier: MIT
!> A polynomial under the drift: its coefficients by generalised least squares for a given drift model.
!>
!> For a given model the log-likelihood of z - X beta is quadratic in beta,
!> $$ \ln L(\beta) = \ln L(0) + b^T \beta - \tfrac12 \beta^T A \beta, \quad A = X^T \Sigma^{-1} X, \quad b = X^T \Sigma^{-1} z, $$
!> so its values at 0, at the unit vectors, their opposites and their sums give A and b exactly; beta = A^-1 b. The columns of X are
!> Legendre polynomials of the time, -1 .. 1 over the samples, less their means over those that are present: the mean is not theirs.
!> The covariance of beta is A^-1.
!>
!> Source: Harvey, Forecasting, Structural Time Series Models and the Kalman Filter (1989), 3.4.2.
module gyroakf_filter_drift_trend
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dposv
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   implicit none (type, external)
   private
   public :: largest_degree, fit_polynomial, whole_polynomial, rough_polynomial, subtract_polynomial, legendre_sum

   !> Degrees that a polynomial may have; the mean is not among them
   integer, parameter :: largest_degree = 3
   !> Length of the vectors at which the likelihood is looked at: far, so that rounding is small beside the differences
   real(dp), parameter :: far = 100.0_dp

contains

   !> Coefficients by generalised least squares; left as they are where the likelihood cannot tell them.
   subroutine fit_polynomial(model, z, here, coefficient, std_error)
      !> The drift and the white noise; without a process the noise is white
      type(component_model_type), intent(in) :: model
      !> Series of mean 0 and a standard deviation near 1: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> 1 present, 0 missing: [n]; not allocated where all are present
      integer(int8), allocatable, intent(in) :: here(:)
      !> Of the Legendre polynomials of degree 1, 2, ...: [degree]
      real(dp), intent(inout) :: coefficient(:)
      !> Their standard errors, the model being known, [degree]; 0 where the likelihood cannot tell them
      real(dp), intent(out), optional :: std_error(:)
      real(dp) :: a(size(coefficient), size(coefficient)), b(size(coefficient), size(coefficient) + 1)
      real(dp) :: base, both, plus(size(coefficient)), minus(size(coefficient)), point(size(coefficient))
      integer :: i, j, n, info
      logical :: known

      n = size(coefficient)
      if (present(std_error)) std_error = 0.0_dp
      point = 0.0_dp
      known = .true.
      b = 0.0_dp
      call take_value(model, z, here, point, base, known)
      do i = 1, n
         point(i) = far
         call take_value(model, z, here, point, plus(i), known)
         point(i) = -far
         call take_value(model, z, here, point, minus(i), known)
         point(i) = 0.0_dp
         a(i, i) = (2.0_dp*base - plus(i) - minus(i))/far**2
         b(i, 1) = 0.5_dp*(plus(i) - minus(i))/far
         b(i, i + 1) = 1.0_dp
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
      call dposv("L", n, n + 1, a, n, b, n, info)
      if (info /= 0) return
      coefficient = b(:, 1)
      if (present(std_error)) std_error = [(sqrt(max(b(i, i + 1), 0.0_dp)), i=1, n)]
   end subroutine fit_polynomial

   !> Log-likelihood of a series less a polynomial.
   subroutine take_value(model, z, here, coefficient, value, known)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in), contiguous :: z(:)
      integer(int8), allocatable, intent(in) :: here(:)
      real(dp), intent(in) :: coefficient(:)
      !> 0 where there is none; of white noise without what does not depend on the coefficients
      real(dp), intent(out) :: value
      !> False from the first on that there is none
      logical, intent(inout) :: known
      real(dp), allocatable :: rest(:)
      type(error_type), allocatable :: failed
      integer :: stat

      value = 0.0_dp
      if (.not. known) return
      allocate (rest(size(z, kind=int64)), stat=stat)
      known = stat == 0
      if (.not. known) return
      rest(:) = z
      if (allocated(here)) then
         call subtract_polynomial(coefficient, rest, here)
         if (model%count > 0) call component_likelihood(model, rest, value, failed, here)
         if (model%count == 0) value = -0.5_dp*sum(rest**2, mask=here /= 0_int8)/model%r
      else
         call subtract_polynomial(coefficient, rest)
         if (model%count > 0) call component_likelihood(model, rest, value, failed)
         if (model%count == 0) value = -0.5_dp*sum(rest**2)/model%r
      end if
      known = .not. allocated(failed)
   end subroutine take_value

   !> The polynomial under a whole series, for a model that was found in whatever part of it.
   subroutine whole_polynomial(model, z, coefficient, std_error, error, valid)
      !> The drift and the white noise, u being the unit of the series
      type(component_model_type), intent(in) :: model
      !> Series, u: [n], any offset
      real(dp), intent(in), contiguous :: z(:)
      !> Of the Legendre polynomials of degree 1, 2, ... over the series, u: [degree]; 0 where the likelihood cannot tell them
      real(dp), intent(out) :: coefficient(:)
      !> Their standard errors, the model being known, u: [degree]; 0 where they are not known
      real(dp), intent(out) :: std_error(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(component_model_type) :: scaled
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: here(:)
      real(dp) :: scale
      integer :: stat

      coefficient = 0.0_dp
      std_error = 0.0_dp
      if (size(coefficient) == 0) return
      allocate (x(size(z, kind=int64)), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (here(size(z, kind=int64)), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a series less the polynomial under its drift")
         return
      end if
      x(:) = z
      if (present(valid)) then
         here(:) = valid
         where (here == 0_int8) x = 0.0_dp
      end if
      call centre(x, scale, valid)
      if (.not. scale > 0.0_dp) return
      scaled = model
      scaled%q = model%q/scale/scale
      scaled%r = model%r/scale/scale
      if (model%count == 0 .and. .not. scaled%r > 0.0_dp) scaled%r = 1.0_dp
      call rough_polynomial(x, here, coefficient)
      call fit_polynomial(scaled, x, here, coefficient, std_error)
      coefficient = scale*coefficient
      std_error = scale*std_error
   end subroutine whole_polynomial

   !> Takes the mean and divides by the standard deviation.
   pure subroutine centre(x, scale, valid)
      !> 0 where missing, also afterwards
      real(dp), intent(inout), contiguous :: x(:)
      !> The standard deviation; 0 where there is none
      real(dp), intent(out) :: scale
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: n, largest

      scale = 0.0_dp
      n = real(size(x, kind=int64), dp)
      if (present(valid)) n = real(count(valid /= 0_int8, kind=int64), dp)
      largest = maxval(abs(x))
      if (.not. (n > 0.0_dp .and. largest > 0.0_dp)) return
      x = x/largest
      x = x - sum(x)/n
      if (present(valid)) where (valid == 0_int8) x = 0.0_dp
      scale = sqrt(sum(x**2)/n)
      if (scale > 0.0_dp) x = x/scale
      scale = scale*largest
   end subroutine centre

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

   !> Takes a polynomial from a series, less its mean over the samples that are present: theirs stays as it is.
   pure subroutine subtract_polynomial(coefficient, series, valid)
      !> Of the Legendre polynomials of degree 1, 2, ...: [degree]
      real(dp), intent(in) :: coefficient(:)
      !> [n]
      real(dp), intent(inout), contiguous :: series(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: mean
      integer(int64) :: k, n, there

      n = size(series, kind=int64)
      mean = 0.0_dp
      there = 0
      do k = 1, n
         if (present(valid)) then
            if (valid(k) == 0_int8) cycle
         end if
         there = there + 1
         mean = mean + legendre_sum(coefficient, k, n)
      end do
      if (there > 0) mean = mean/real(there, dp)
      do k = 1, n
         series(k) = series(k) - (legendre_sum(coefficient, k, n) - mean)
      end do
   end subroutine subtract_polynomial

   !> A polynomial at a sample.
   pure real(dp) function legendre_sum(coefficient, k, n) result(value)
      !> Of the Legendre polynomials of degree 1, 2, ...: [degree]
      real(dp), intent(in) :: coefficient(:)
      !> Number of the sample, 1 .. n, and that of all: time is -1 at the first, 1 at the last
      integer(int64), intent(in) :: k, n
      real(dp) :: p(largest_degree)

      p = legendre(k, n)
      value = dot_product(coefficient, p(:size(coefficient)))
   end function legendre_sum

   !> The Legendre polynomials of degree 1, 2, 3 at a sample.
   pure function legendre(k, n) result(p)
      !> Its number, and that of all
      integer(int64), intent(in) :: k, n
      real(dp) :: p(largest_degree), t

      t = real(2*k - n - 1, dp)/real(max(n - 1, 1_int64), dp)
      p = [t, 0.5_dp*(3.0_dp*t**2 - 1.0_dp), 0.5_dp*t*(5.0_dp*t**2 - 3.0_dp)]
   end function legendre

end module gyroakf_filter_drift_trend
