! SPDX-License-Identifier: MIT
!> AR models by least squares, forward with an intercept (ols, "covariance").
!>
!> The orders are compared on the rows that the largest of them has, from one Gram matrix and one Cholesky factor; the order that
!> is taken is fitted once more to all rows that it has. Its normal equations are solved about the mean, then corrected
!> with the products of the residuals and the lags, which are summed over the data: the digits that forming the matrix
!> costs come back. Source: Bjorck, Numerical Methods for Least Squares Problems (1996), 2.4.7 and 6.6.5.
module gyroakf_ar_least_squares
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri, dpotrs
   use gyroakf_ar_complete_rows, only : row_gram_type, build_row_gram
   use gyroakf_ar_row_residuals, only : residual_sums_type, sum_residuals
   implicit none (type, external)
   private
   public :: compare_orders, fit_order, fitted_order_type

   !> A squared residual of this share of the variance is rounding: the series is predicted exactly
   real(dp), parameter :: rounding = 256.0_dp*epsilon(1.0_dp)

   !> The model of one order
   type :: fitted_order_type
      !> Coefficients, and the square roots of the diagonal of the inverse of the matrix of the normal equations: [p]
      real(dp), allocatable :: phi(:), spread(:)
      !> Constant of the regression of the series about its mean; its spread; that of the intercept of the series itself
      real(dp) :: constant = 0.0_dp, constant_spread = 0.0_dp, intercept_spread = 0.0_dp
      !> Mean square of the residuals
      real(dp) :: variance = 0.0_dp
      !> Rows
      integer(int64) :: rows = 0
   end type fitted_order_type

contains

   !> Mean square of the residuals of every order, on the same rows.
   !>
   !> With R the Cholesky factor of the bordered matrix, x_t last, $$RSS_k = R_{yy}^2 + \sum_{i>k} R_{iy}^2:$$ summed upward,
   !> nothing cancels.
   subroutine compare_orders(gram, variance, error)
      !> Of the largest order; it has rows
      type(row_gram_type), intent(in) :: gram
      !> Of the orders 0 .. gram%lags
      real(dp), allocatable, intent(out) :: variance(:)
      !> constant_input, singular, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :), scale(:)
      integer :: p, i, info

      p = gram%lags
      allocate (variance(0:p))
      variance = 0.0_dp
      call normal_matrix(gram, a, scale, error)
      if (allocated(error)) return
      call dpotrf("U", p + 1, a, p + 1, info)
      if (info > 0) then
         call refuse(min(info, p), error)
         return
      end if
      variance(p) = a(p + 1, p + 1)**2
      do i = p, 1, -1
         variance(i - 1) = variance(i) + a(i, p + 1)**2
      end do
      do i = 0, p
         if (variance(i) > rounding*variance(0)) cycle
         call refuse(i, error)
         return
      end do
      variance = variance*(scale(p + 1)/real(gram%rows, dp)*scale(p + 1))
   end subroutine compare_orders

   !> The matrix of the normal equations, scaled to a diagonal of ones: lags 1 .. p, then x_t itself.
   subroutine normal_matrix(gram, a, scale, error)
      !> Sums over the rows
      type(row_gram_type), intent(in) :: gram
      !> Both triangles: [p+1, p+1]; square roots of its diagonal before: [p+1]
      real(dp), allocatable, intent(out) :: a(:, :), scale(:)
      !> constant_input, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j, k, l, p, stat

      p = gram%lags
      allocate (a(p + 1, p + 1), stat=stat)
      if (stat == 0) allocate (scale(p + 1), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the normal equations of an AR model")
         return
      end if
      do j = 1, p + 1
         l = mod(j, p + 1)
         do i = 1, p + 1
            k = mod(i, p + 1)
            a(i, j) = gram%matrix(k, l) - gram%total(k)*(gram%total(l)/real(gram%rows, dp))
         end do
      end do
      do i = 1, p + 1
         scale(i) = sqrt(max(a(i, i), 0.0_dp))
      end do
      if (.not. all(scale > 0.0_dp)) then
         call fatal_error(error, status%constant_input, "the series has no variance, no AR model describes it")
         return
      end if
      do j = 1, p + 1
         a(:, j) = a(:, j)/scale/scale(j)
      end do
   end subroutine normal_matrix

   !> Fits one order to all its rows.
   subroutine fit_order(x, shift, rest, order, fit, error, valid, progress)
      !> Series: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean, in two parts
      real(dp), intent(in) :: shift, rest
      !> Order, >= 0
      integer, intent(in) :: order
      !> The model
      type(fitted_order_type), intent(out) :: fit
      !> constant_input, singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(row_gram_type) :: gram
      real(dp), allocatable :: a(:, :), scale(:)
      integer :: info

      call build_row_gram(x, shift, rest, order, gram, error, valid, progress)
      if (.not. allocated(error)) call normal_matrix(gram, a, scale, error)
      if (allocated(error)) return
      fit%rows = gram%rows
      allocate (fit%phi(order), fit%spread(order))
      fit%phi = a(:order, order + 1)
      call dpotrf("U", order, a, order + 1, info)
      if (info > 0) then
         call refuse(info, error)
         return
      end if
      call dpotrs("U", order, 1, a, order + 1, fit%phi, max(order, 1), info)
      fit%phi = fit%phi*scale(order + 1)/scale(:order)
      call correct(x, shift, rest, gram, a, scale, fit, error, valid, progress)
      if (allocated(error)) return
      call dpotri("U", order, a, order + 1, info)
      call spread_of(gram, a, scale, rest + shift, fit)
   end subroutine fit_order

   !> Corrects the solution by the residuals that it leaves.
   subroutine correct(x, shift, rest, gram, factor, scale, fit, error, valid, progress)
      !> Series, its mean
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> Sums over the rows
      type(row_gram_type), intent(in) :: gram
      !> Cholesky factor of the scaled matrix: [p+1, p+1]; the scale: [p+1]
      real(dp), intent(in) :: factor(:, :), scale(:)
      !> Coefficients, then constant and variance too
      type(fitted_order_type), intent(inout) :: fit
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(residual_sums_type) :: sums
      real(dp) :: step(size(fit%phi)), gradient(size(fit%phi)), equations
      integer :: p, info

      p = size(fit%phi)
      equations = real(gram%rows, dp)
      fit%constant = (gram%total(0) - dot_product(fit%phi, gram%total(1:)))/equations
      call sum_residuals(x, shift, rest, fit%phi, fit%constant, sums, error, valid, progress)
      if (allocated(error)) return
      gradient = sums%product(1:) - sums%total*(gram%total(1:)/equations)
      step = gradient/scale(:p)
      call dpotrs("U", p, 1, factor, p + 1, step, max(p, 1), info)
      step = step/scale(:p)
      fit%phi = fit%phi + step
      fit%constant = fit%constant + sums%total/equations - dot_product(step, gram%total(1:))/equations
      fit%variance = (sums%square - sums%total**2/equations - dot_product(step, gradient))/equations
      fit%variance = max(fit%variance, 0.0_dp)
   end subroutine correct

   !> Standard errors over the standard deviation of the noise.
   pure subroutine spread_of(gram, inverse, scale, mean, fit)
      !> Sums over the rows
      type(row_gram_type), intent(in) :: gram
      !> Inverse of the scaled matrix, upper triangle, and the scale
      real(dp), intent(in) :: inverse(:, :), scale(:)
      !> Mean of the series
      real(dp), intent(in) :: mean
      !> Its spreads are filled
      type(fitted_order_type), intent(inout) :: fit
      integer :: i

      do i = 1, size(fit%phi)
         fit%spread(i) = sqrt(max(inverse(i, i), 0.0_dp))/scale(i)
      end do
      fit%constant_spread = about(0.0_dp)
      fit%intercept_spread = about(mean)
   contains
      !> Spread of the constant of the series less a number.
      pure real(dp) function about(offset)
         !> The number
         real(dp), intent(in) :: offset
         real(dp) :: u(size(fit%phi)), s
         integer :: j, k

         u = (offset + gram%total(1:)/real(gram%rows, dp))/scale(:size(u))
         s = 1.0_dp/real(gram%rows, dp)
         do j = 1, size(u)
            s = s + inverse(j, j)*u(j)**2
            do k = 1, j - 1
               s = s + 2.0_dp*inverse(k, j)*u(k)*u(j)
            end do
         end do
         about = sqrt(max(s, 0.0_dp))
      end function about
   end subroutine spread_of

   !> The series is predicted exactly.
   subroutine refuse(order, error)
      !> The order from which on it is
      integer, intent(in) :: order
      !> singular
      type(error_type), allocatable, intent(out) :: error
      character(160) :: text

      write (text, '("AR(", i0, ") predicts the series exactly (a line, a sinusoid, too few different values?): ", a)') order, &
         & "there is no noise to model"
      call fatal_error(error, status%singular, trim(text))
   end subroutine refuse

end module gyroakf_ar_least_squares
