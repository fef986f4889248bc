! SPDX-License-Identifier: MIT
!> AR models by least squares, forward with an intercept (ols, "covariance").
!>
!> The orders are compared on the rows that the largest of them has, from one Gram matrix and one
!> Cholesky factor; the order that is taken is fitted once more to all rows that it has. Its normal
!> equations are solved about the mean, then corrected with the products of the residuals and the
!> lags, which are summed over the data: the digits that forming the matrix costs come back. Source:
!> Bjorck, Numerical Methods for Least Squares Problems (1996), 2.4.7 and 6.6.5.
module gyroakf_ar_least_squares
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri, dpotrs
   use gyroakf_chunks, only : block_length, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_stats_lagged_gram, only : gram_type, shorten_gram
   use gyroakf_stats_lagged_products, only : add_lagged_products, detrended_block, residual_block
   use gyroakf_stats_trend, only : trend_type
   implicit none (type, external)
   private
   public :: compare_orders, fit_order, fitted_order_type

   !> A squared residual of this share of the variance is rounding: the series is predicted exactly
   real(dp), parameter :: rounding = 256.0_dp*epsilon(1.0_dp)

   !> The model of one order
   type :: fitted_order_type
      !> Coefficients; square roots of the diagonal of the inverse normal equations: [p]
      real(dp), allocatable :: phi(:), spread(:)
      !> Constant of the regression of the series about its mean; spread of the series' intercept
      real(dp) :: constant = 0.0_dp, intercept_spread = 0.0_dp
      !> Mean square of the residuals
      real(dp) :: variance = 0.0_dp
      !> Rows
      integer(int64) :: rows = 0
   end type fitted_order_type

   !> Sums over the complete rows: of e_t x_(t-j), j = 0 .. p, of e^2 and of e, e the residuals
   type, extends(chunk_sums_type) :: residual_sums_type
      !> Mean of the series
      type(trend_type) :: level
      real(dp), allocatable :: phi(:)
      real(dp) :: constant = 0.0_dp
   contains
      procedure :: add => add_residuals
   end type residual_sums_type

contains

   !> Mean square of the residuals of every order, on the same rows.
   !>
   !> With R the Cholesky factor of the bordered matrix, x_t last, $$RSS_k = R_{yy}^2 + \sum_{i>k}
   !> R_{iy}^2:$$ summed upward, nothing cancels.
   subroutine compare_orders(gram, variance, error)
      !> Of the largest order; it has rows
      type(gram_type), intent(in) :: gram
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
      if (info > 0) call refuse(min(info, p), error)
      if (allocated(error)) return
      variance(p) = a(p + 1, p + 1)**2
      do i = p, 1, -1
         variance(i - 1) = variance(i) + a(i, p + 1)**2
      end do
      i = findloc(variance > rounding*variance(0), .false., 1) - 1
      if (i >= 0) call refuse(i, error)
      variance = variance*(scale(p + 1)/real(gram%rows, dp)*scale(p + 1))
   end subroutine compare_orders

   !> Matrix of the normal equations, scaled to a unit diagonal: lags 1 .. p, then x_t.
   subroutine normal_matrix(gram, a, scale, error)
      type(gram_type), intent(in) :: gram
      !> Upper triangle: [p+1, p+1]; square roots of its diagonal before: [p+1]
      real(dp), allocatable, intent(out) :: a(:, :), scale(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: j, p, stat

      p = gram%lags
      allocate (a(p + 1, p + 1), stat=stat)
      if (stat == 0) allocate (scale(p + 1), stat=stat)
      call check_memory(stat, "the normal equations of an AR model", error)
      if (allocated(error)) return
      a = 0.0_dp
      do j = 1, p + 1
         a(:j, j) = gram%matrix(2:j + 1, j + 1) &
            & - gram%matrix(1, 2:j + 1)*(gram%matrix(1, j + 1)/real(gram%rows, dp))
         scale(j) = sqrt(max(a(j, j), 0.0_dp))
      end do
      if (.not. all(scale > 0.0_dp)) call fatal_error(error, status%constant_input, &
         & "the series has no variance, no AR model describes it")
      if (allocated(error)) return
      do j = 1, p + 1
         a(:, j) = a(:, j)/scale/scale(j)
      end do
   end subroutine normal_matrix

   !> Fits one order to all its rows.
   subroutine fit_order(x, level, order, gram, fit, error, valid, progress)
      !> Series: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Its mean
      type(trend_type), intent(in) :: level
      !> Order, 0 .. gram%lags
      integer, intent(in) :: order
      !> Of the largest order; of this one afterwards
      type(gram_type), intent(inout) :: gram
      !> The model
      type(fitted_order_type), intent(out) :: fit
      !> constant_input, singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: a(:, :), scale(:)
      integer :: info

      call shorten_gram(x, level, order, gram, error, valid, progress)
      if (.not. allocated(error)) call normal_matrix(gram, a, scale, error)
      if (allocated(error)) return
      fit%rows = gram%rows
      allocate (fit%phi(order), fit%spread(order))
      fit%phi = a(:order, order + 1)
      call dpotrf("U", order, a, order + 1, info)
      if (info > 0) call refuse(info, error)
      if (allocated(error)) return
      call dpotrs("U", order, 1, a, order + 1, fit%phi, max(order, 1), info)
      fit%phi = fit%phi*scale(order + 1)/scale(:order)
      call correct(x, level, gram, a, scale, fit, error, valid, progress)
      if (allocated(error)) return
      call dpotri("U", order, a, order + 1, info)
      call spread_of(gram, a, scale, level%legendre(0) + level%remainder, fit)
   end subroutine fit_order

   !> Corrects the solution by the residuals that it leaves.
   subroutine correct(x, level, gram, factor, scale, fit, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: level
      type(gram_type), intent(in) :: gram
      !> Cholesky factor of the scaled matrix: [p+1, p+1]; the scale: [p+1]
      real(dp), intent(in) :: factor(:, :), scale(:)
      type(fitted_order_type), intent(inout) :: fit
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(residual_sums_type) :: sums
      real(dp), dimension(size(fit%phi)) :: step, gradient, lag_mean
      real(dp) :: total(size(fit%phi) + 3), equations
      integer :: p, info

      p = size(fit%phi)
      equations = real(gram%rows, dp)
      lag_mean = gram%matrix(1, 2:p + 1)/equations
      fit%constant = gram%matrix(1, p + 2)/equations - dot_product(fit%phi, lag_mean)
      sums%level = level
      sums%phi = fit%phi
      sums%constant = fit%constant
      call sum_chunks(sums, x, size(x, kind=int64), "rows of the AR model", total, error, valid, &
         & progress)
      if (allocated(error)) return
      gradient = total(2:p + 1) - total(p + 3)*lag_mean
      step = gradient/scale(:p)
      call dpotrs("U", p, 1, factor, p + 1, step, max(p, 1), info)
      step = step/scale(:p)
      fit%phi = fit%phi + step
      fit%constant = fit%constant + total(p + 3)/equations - dot_product(step, lag_mean)
      fit%variance = max(0.0_dp, &
         & (total(p + 2) - total(p + 3)**2/equations - dot_product(step, gradient))/equations)
   end subroutine correct

   !> The sums over the residuals of a chunk.
   subroutine add_residuals(self, x, n, chunk, total, stat, valid)
      class(residual_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: y(:), here(:)
      real(dp) :: e(block_length), flag(block_length)
      integer(int64) :: begin
      integer :: m, p

      p = size(self%phi)
      allocate (y(1 - p:block_length), stat=stat)
      if (stat == 0) allocate (here(1 - p:block_length), stat=stat)
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         if (stat == 0) call residual_block(x, self%level, self%phi, self%constant, begin, e(:m), &
            & flag(:m), stat, valid)
         if (stat /= 0) return
         call detrended_block(x, self%level, begin - p, y(:m), here(:m), valid)
         call add_lagged_products(e, y, m, p, total(:p + 1))
         total(p + 2) = total(p + 2) + dot_product(e(:m), e(:m))
         total(p + 3) = total(p + 3) + sum(e(:m))
      end do
   end subroutine add_residuals

   !> Standard errors over the standard deviation of the noise.
   pure subroutine spread_of(gram, inverse, scale, mean, fit)
      type(gram_type), intent(in) :: gram
      real(dp), intent(in) :: inverse(:, :), scale(:), mean
      type(fitted_order_type), intent(inout) :: fit
      real(dp) :: u(size(fit%phi)), s
      integer :: j, k

      u = (mean + gram%matrix(1, 2:size(u) + 1)/real(gram%rows, dp))/scale(:size(u))
      s = 1.0_dp/real(gram%rows, dp)
      do j = 1, size(u)
         fit%spread(j) = sqrt(max(inverse(j, j), 0.0_dp))/scale(j)
         s = s + inverse(j, j)*u(j)**2
         do k = 1, j - 1
            s = s + 2.0_dp*inverse(k, j)*u(k)*u(j)
         end do
      end do
      fit%intercept_spread = sqrt(max(s, 0.0_dp))
   end subroutine spread_of

   !> The series is predicted exactly.
   subroutine refuse(order, error)
      integer, intent(in) :: order
      type(error_type), allocatable, intent(out) :: error
      character(160) :: text

      write (text, "(a, i0, 2a)") "AR(", order, ") predicts the series exactly (a line, a ", &
         & "sinusoid, too few different values?): there is no noise to model"
      call fatal_error(error, status%singular, trim(text))
   end subroutine refuse

end module gyroakf_ar_least_squares
