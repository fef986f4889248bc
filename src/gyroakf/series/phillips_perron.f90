! SPDX-License-Identifier: MIT
!> Unit root of a series: the test of Phillips and Perron.
module gyroakf_series_phillips_perron
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_lapack, only : dpotrf, dtrtrs
   use gyroakf_series_residuals, only : residual_type, fit_residuals, load_residuals, residual_count, rounding_variance
   use gyroakf_series_long_run, only : sum_bartlett, schwert_lags
   use gyroakf_series_mackinnon, only : regression_number, critical_values, p_value
   implicit none (type, external)
   private
   public :: phillips_perron_options, phillips_perron_type, test_phillips_perron

   !> How the test is made
   type :: phillips_perron_options
      !> Deterministic part: n nothing, c constant, ct line
      character(2) :: regression = "c"
      !> Bandwidth of the long-run variance; -1: ceiling(12 (n/100)^(1/4))
      integer(int64) :: lags = -1
   end type phillips_perron_options

   !> Result of the test
   type :: phillips_perron_type
      !> Z_tau, distributed as the Dickey-Fuller statistic
      real(dp) :: statistic = 0.0_dp
      !> Asymptotic probability of a smaller Z_tau where there is a unit root
      real(dp) :: p_value = 1.0_dp
      !> Z_rho; its distribution is not tabulated here, Z_tau decides
      real(dp) :: rho_statistic = 0.0_dp
      !> Bandwidth used
      integer(int64) :: lags = 0
      !> Rows of the regression
      integer(int64) :: observations = 0
      !> What was used
      character(2) :: regression = "c"
      !> Critical values of Z_tau at 1 %, 5 %, 10 % for this number of rows
      real(dp) :: critical(3) = 0.0_dp
      !> statistic < critical(2): the unit root is rejected at 5 %
      logical :: stationary = .false.
      !> rho of the first-order regression and its standard error
      real(dp) :: coefficient = 0.0_dp, std_error = 0.0_dp
      !> Variance of the residuals and their long-run variance, divisor: rows
      real(dp) :: variance = 0.0_dp, long_run_variance = 0.0_dp
   end type phillips_perron_type

   !> Most columns: constant, line, level, difference
   integer, parameter :: most = 4
   !> A diagonal element of the factor of the scaled matrix below this has lost half of its digits
   real(dp), parameter :: smallest_pivot = 1.0e-7_dp

contains

   !> Phillips-Perron test.
   !>
   !> $$y_t = \text{deterministic} + \rho y_{t-1} + u_t, \quad
   !>   Z_\tau = \sqrt{\frac{\gamma_0}{\lambda^2}}\, \frac{\hat\rho - 1}{\hat\sigma_\rho}
   !>     - \frac{\lambda^2 - \gamma_0}{2\lambda}\, \frac{N \hat\sigma_\rho}{s}, \quad
   !>   Z_\rho = N(\hat\rho - 1) - \frac{\lambda^2 - \gamma_0}{2}\, \frac{N^2 \hat\sigma_\rho^2}{s^2}$$
   !> on N rows with k regressors: gamma_0 = RSS/N, s^2 = RSS/(N - k), and lambda^2 the long-run variance of the residuals with
   !> Bartlett's weights (Newey & West) and divisor N. One pass for the regression after that for the mean (two for a line), one
   !> for lambda^2; memory O(1). With missing samples the rows are those whose two samples are present and the products those
   !> of present pairs of residuals. Sources: Phillips & Perron, Biometrika 75 (1988) 335-346; gyroakf_series_mackinnon.
   subroutine test_phillips_perron(x, options, result, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(phillips_perron_options), intent(in) :: options
      !> The test
      type(phillips_perron_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input (also a perfect line with ct), singular (the series is predicted
      !> perfectly by its last value), non_finite, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(residual_type) :: residual
      real(dp) :: gram(most, most)
      real(dp) :: critical(3)
      integer(int64) :: rows
      integer :: terms

      call check_options(options, size(x, kind=int64), terms, error)
      if (allocated(error)) return
      call tell_progress("unit-root test", 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call fit_residuals(x, terms, residual, error, valid)
      if (allocated(error)) return
      result%regression = options%regression
      result%lags = options%lags
      if (options%lags < 0) result%lags = schwert_lags(size(x, kind=int64), .true.)
      call sum_rows(residual, x, terms, gram, result%observations, error, valid, progress)
      if (allocated(error)) return
      call check_rows(result%observations, terms, residual, gram(terms + 2, terms + 2), error)
      if (allocated(error)) return
      result%lags = min(result%lags, size(x, kind=int64) - 2)
      call regress(gram, terms, residual, result, error)
      if (allocated(error)) return
      call sum_bartlett(residual, x, result%lags, result%long_run_variance, error, valid, progress)
      if (allocated(error)) return
      result%long_run_variance = result%long_run_variance/real(result%observations, dp)
      call correct(result, terms + 1, error)
      if (allocated(error)) return
      rows = result%observations
      critical = critical_values(terms + 1, rows)
      result%critical = critical
      result%p_value = p_value(result%statistic, terms + 1)
      result%stationary = result%statistic < result%critical(2)
   end subroutine test_phillips_perron

   !> Refuses options that mean nothing.
   subroutine check_options(options, n, terms, error)
      type(phillips_perron_options), intent(in) :: options
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Deterministic terms
      integer, intent(out) :: terms
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      terms = regression_number(trim(options%regression)) - 1
      if (terms < 0 .or. terms > 2) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown regression '"//trim(options%regression)//"' of the Phillips-Perron test; there are n, c, ct")
      else if (options%lags < -1) then
         call fatal_error(error, status%invalid_argument, &
            & "the lags of the Phillips-Perron test must not be negative; -1 chooses them")
      else if (n < int(terms, int64) + 4 .or. options%lags >= n - 1) then
         write (text, '("the Phillips-Perron test needs more than ", i0, " samples, there are ", i0)') &
            & max(min(options%lags, huge(n) - 1) + 1, int(terms, int64) + 3), n
         call fatal_error(error, status%too_few_samples, trim(text))
      end if
   end subroutine check_options

   !> Refuses too few rows and differences that do not vary.
   subroutine check_rows(rows, terms, residual, squares, error)
      integer(int64), intent(in) :: rows
      integer, intent(in) :: terms
      type(residual_type), intent(in) :: residual
      !> Sum of the squared differences
      real(dp), intent(in) :: squares
      !> too_few_samples, constant_input
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      if (rows < int(terms, int64) + 3) then
         write (text, '("the Phillips-Perron test needs at least ", i0, " complete rows, there are ", i0)') terms + 3, rows
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (.not. squares > 4.0_dp*real(rows, dp)*rounding_variance(residual)) then
         call fatal_error(error, status%constant_input, &
            & "the series is constant, or a line with ct, to rounding: there is nothing to test for a unit root")
      end if
   end subroutine check_rows

   !> Sums of products of constant, line, level and difference over the complete rows.
   subroutine sum_rows(residual, x, terms, gram, rows, error, valid, progress)
      !> Level or line that is subtracted first
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      !> 0, 1, 2
      integer, intent(in) :: terms
      !> Upper triangle: [terms + 2, terms + 2] is used
      real(dp), intent(out) :: gram(most, most)
      !> Complete rows
      integer(int64), intent(out) :: rows
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(most, most, chunk_count(residual%samples - 1))
      type(residual_type) :: difference
      integer(int64) :: n, first
      integer :: chunk, from, group

      n = residual%samples - 1
      gram = 0.0_dp
      rows = 0
      difference = residual
      difference%differences = .true.
      group = chunk_group(chunk_count(n), present(progress))
      do from = 1, chunk_count(n), group
         call tell_progress("unit-root test", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel do if (n >= threads_from) default(shared) private(first) schedule(dynamic)
         do chunk = from, min(from + group - 1, chunk_count(n))
            part(:, :, chunk) = 0.0_dp
            do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
               call add_rows(difference, x, first, int(min(block_length, chunk_last(n, chunk) - first + 1)), part(:, :, chunk), &
                  & valid)
            end do
         end do
         !$omp end parallel do
      end do
      gram = sum(part, 3)
      rows = nint(gram(1, 1), int64)
      if (terms == 2) return
      if (terms == 1) gram(2:3, 2:3) = gram(3:4, 3:4)
      if (terms == 1) gram(1, 2:3) = gram(1, 3:4)
      if (terms == 0) gram(1:2, 1:2) = gram(3:4, 3:4)
   end subroutine sum_rows

   !> Adds the rows of a block.
   pure subroutine add_rows(difference, x, first, length, gram, valid)
      type(residual_type), intent(in) :: difference
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: first
      integer, intent(in) :: length
      real(dp), intent(inout) :: gram(most, most)
      integer(int8), intent(in), optional :: valid(:)
      type(residual_type) :: level
      real(dp) :: column(block_length, most), width
      integer :: i, j, k

      level = difference
      level%differences = .false.
      width = 1.0_dp/real(max(difference%samples - 2, 1_int64), dp)
      call load_residuals(difference, x, first, column(:length, 4), valid, column(:length, 1))
      call load_residuals(level, x, first, column(:length, 3), valid)
      do i = 1, length
         column(i, 2) = real(2*(first + i - 2) - (difference%samples - 2), dp)*width*column(i, 1)
         column(i, 3) = column(i, 3)*column(i, 1)
      end do
      do k = 1, most
         do j = 1, k
            gram(j, k) = gram(j, k) + product_sum(column(:length, j), column(:length, k))
         end do
      end do
   end subroutine add_rows

   !> Scalar product.
   pure real(dp) function product_sum(a, b) result(total)
      real(dp), intent(in), contiguous :: a(:), b(:)
      integer :: i

      total = 0.0_dp
      !$omp simd reduction(+:total)
      do i = 1, size(a)
         total = total + a(i)*b(i)
      end do
   end function product_sum

   !> The regression of the difference on the deterministic terms and the level, by Cholesky's factor of the scaled sums.
   subroutine regress(gram, terms, residual, result, error)
      !> Sums; the factor on return
      real(dp), intent(inout) :: gram(most, most)
      integer, intent(in) :: terms
      !> Becomes that of the regression
      type(residual_type), intent(inout) :: residual
      type(phillips_perron_type), intent(inout) :: result
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: scale(most), b(most), rss
      integer :: k, j, info

      k = terms + 2
      info = 0
      do j = 1, k
         scale(j) = sqrt(gram(j, j))
         if (.not. scale(j) > 0.0_dp) info = j
      end do
      if (info == 0) then
         do j = 1, k
            gram(:j, j) = gram(:j, j)/scale(j)/scale(:j)
         end do
         call dpotrf("U", k, gram, most, info)
      end if
      do j = 1, k
         if (info == 0 .and. gram(j, j) < smallest_pivot) info = j
      end do
      if (info == 0) then
         b(:k - 1) = gram(:k - 1, k)
         call dtrtrs("U", "N", "N", k - 1, 1, gram, most, b, most, info)
      end if
      if (info /= 0) then
         call fatal_error(error, status%singular, &
            & "the Phillips-Perron regression is singular: the series is predicted perfectly by its last value")
         return
      end if
      b(:k - 1) = b(:k - 1)*scale(k)/scale(:k - 1)
      rss = (gram(k, k)*scale(k))**2
      result%variance = rss/real(result%observations, dp)
      result%coefficient = 1.0_dp + b(k - 1)
      result%std_error = sqrt(rss/real(result%observations - (k - 1), dp))/(gram(k - 1, k - 1)*scale(k - 1))
      result%statistic = b(k - 1)/result%std_error              ! the t statistic so far
      result%rho_statistic = real(result%observations, dp)*b(k - 1)
      residual%differences = .true.
      residual%level = b(k - 1)
      if (terms > 0) residual%constant = b(1)
      if (terms > 1) residual%line = b(2)
   end subroutine regress

   !> The correction of the t statistic for correlated residuals.
   subroutine correct(result, regressors, error)
      !> Statistics without it; long-run variance
      type(phillips_perron_type), intent(inout) :: result
      integer, intent(in) :: regressors
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: n, s, excess

      n = real(result%observations, dp)
      if (.not. result%variance >= tiny(1.0_dp)) then
         call fatal_error(error, status%singular, &
            & "the values are too small for the Phillips-Perron test: multiply them by a constant")
         return
      end if
      if (.not. result%long_run_variance > epsilon(1.0_dp)**2*result%variance) then
         call fatal_error(error, status%singular, &
            & "the long-run variance of the Phillips-Perron test is 0 with this bandwidth; try fewer lags")
         return
      end if
      s = sqrt(result%variance*n/(n - real(regressors, dp)))
      excess = 0.5_dp*(result%long_run_variance - result%variance)
      result%statistic = sqrt(result%variance/result%long_run_variance)*result%statistic &
         & - excess/sqrt(result%long_run_variance)*(n*result%std_error/s)
      result%rho_statistic = result%rho_statistic - excess*(n*result%std_error/s)**2
   end subroutine correct

end module gyroakf_series_phillips_perron
