! SPDX-License-Identifier: MIT
!> Unit root of a series: the augmented Dickey-Fuller test.
module gyroakf_series_stationarity
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf
   use gyroakf_preprocess_trend, only : trend_type, fit_trend
   use gyroakf_series_lagged_gram, only : gram_type, build_gram
   use gyroakf_series_mackinnon, only : regression_number, critical_values, p_value
   implicit none (type, external)
   private
   public :: adf_options, adf_type, test_adf, default_max_lags

   !> How the test is made
   type :: adf_options
      !> Deterministic part: n nothing, c constant, ct line, ctt parabola
      character(3) :: regression = "c"
      !> Lags of the difference; -1: chosen by the criterion
      integer :: lags = -1
      !> Most lags to choose from; -1: ceiling(12 (n/100)^(1/4)), see default_max_lags
      integer :: max_lags = -1
      !> aic, bic, or t (the last lag with |t| >= 1.645)
      character(3) :: criterion = "aic"
   end type adf_options

   !> Result of the test
   type :: adf_type
      !> t statistic of the level
      real(dp) :: statistic = 0.0_dp
      !> Asymptotic probability of a smaller statistic where there is a unit root
      real(dp) :: p_value = 1.0_dp
      !> Lags used
      integer :: lag = 0
      !> Rows of the regression
      integer(int64) :: observations = 0
      !> What was used
      character(3) :: regression = "c", criterion = "aic"
      !> Critical values at 1 %, 5 %, 10 % for this number of rows
      real(dp) :: critical(3) = 0.0_dp
      !> statistic < critical(2): the unit root is rejected at 5 %, the series counts as stationary
      !> (about its deterministic part)
      logical :: stationary = .false.
   end type adf_type

   !> Two-sided 10 % point of the normal distribution
   real(dp), parameter :: significant_t = 1.6448536269514722_dp
   !> A diagonal element of the factor of the scaled matrix below this has lost half of its digits
   real(dp), parameter :: smallest_pivot = 1.0e-7_dp

contains

   !> Augmented Dickey-Fuller test.
   !>
   !> $$\Delta y_t = \text{deterministic} + \rho y_{t-1} + \sum_{j=1}^{p} b_j \Delta y_{t-j} + e_t$$
   !> The statistic is rho over its standard error (residual variance with N - k); null hypothesis: a
   !> unit root, rho = 0. The lag is chosen on the rows that all candidates have in common,
   !> $$AIC = N_0(\ln 2\pi + \ln(RSS/N_0) + 1) + 2k$$ (BIC: k ln N_0), ties to the smaller lag, and the
   !> regression repeated with it on all rows that it has. One pass over the series per fit, memory O(p^2);
   !> with missing samples over complete rows only. Sources: Said & Dickey, Biometrika 71 (1984) 599-607;
   !> gyroakf_series_mackinnon. Where p-value and critical value disagree near 5 % with few samples, the
   !> critical value decides.
   subroutine test_adf(x, options, result, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(adf_options), intent(in) :: options
      !> The test
      type(adf_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input (also a perfect line with ct), singular
      !> (a perfect fit or collinear lags), non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(trend_type) :: trend
      type(gram_type) :: gram
      integer :: terms, most

      call check_options(x, options, terms, error, valid)
      if (allocated(error)) return
      call fit_trend(x, terms - 1, trend, error, valid)
      if (allocated(error)) return
      result%regression = options%regression
      result%criterion = options%criterion
      result%lag = options%lags
      if (options%lags < 0) then
         most = options%max_lags
         if (most < 0) most = default_max_lags(size(x, kind=int64), terms, valid)
         call regress(x, trend, terms, most, gram, error, valid)
         if (allocated(error)) return
         call choose_lag(gram, trim(options%criterion), result%lag, error)
         if (allocated(error)) return
      end if
      call regress(x, trend, terms, result%lag, gram, error, valid)
      if (allocated(error)) return
      call level_statistic(gram, result%statistic, error)
      if (allocated(error)) return
      result%observations = gram%rows
      result%critical = critical_values(terms + 1, gram%rows)
      result%p_value = p_value(result%statistic, terms + 1)
      result%stationary = result%statistic < result%critical(2)
   end subroutine test_adf

   !> Refuses options and series that cannot be tested.
   subroutine check_options(x, options, terms, error, valid)
      !> Series
      real(dp), intent(in) :: x(:)
      !> The options
      type(adf_options), intent(in) :: options
      !> Deterministic terms, 0 .. 3
      integer, intent(out) :: terms
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text

      terms = regression_number(trim(options%regression)) - 1
      if (terms < 0) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown regression '"//trim(options%regression)//"' of the ADF test; there are n, c, ct, ctt")
      else if (all(options%criterion /= [character(3) :: "aic", "bic", "t"])) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown criterion '"//trim(options%criterion)//"' of the ADF test; there are aic, bic, t")
      else if (options%lags < -1 .or. options%max_lags < -1) then
         call fatal_error(error, status%invalid_argument, "the lags of the ADF test must not be negative; -1 chooses them")
      else if (size(x, kind=int64) < terms + 4) then
         write (text, '("the ADF test needs at least ", i0, " samples, there are ", i0)') terms + 4, size(x, kind=int64)
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (max(options%lags, options%max_lags) >= size(x, kind=int64)) then
         write (text, '("the ADF test with ", i0, " lags needs more than ", i0, " samples")') &
            & max(options%lags, options%max_lags), size(x, kind=int64)
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (present(valid)) then
         if (size(valid, kind=int64) /= size(x, kind=int64)) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
         end if
      end if
   end subroutine check_options

   !> Most lags that are tried: ceiling(12 (n/100)^(1/4)) (Schwert), at most n/2 - terms - 1, and with
   !> gaps no more than leave a tenth of the samples in complete rows.
   integer function default_max_lags(n, terms, valid) result(most)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Deterministic terms, 0 .. 3
      integer, intent(in) :: terms
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: found, i, run
      integer(int64), allocatable :: rows(:)

      most = ceiling(12.0_dp*(real(n, dp)/100.0_dp)**0.25_dp)
      most = max(0, int(min(int(most, int64), n/2 - terms - 1)))
      if (.not. present(valid)) return
      allocate (rows(0:most + 2))
      rows = 0
      run = 0
      do i = 1, n
         run = run + 1
         if (valid(i) == 0_int8) run = 0
         rows(min(run, int(most + 2, int64))) = rows(min(run, int(most + 2, int64))) + 1
      end do
      found = n - rows(0)
      do while (most > 0)
         if (10*sum(rows(most + 2:)) >= found) exit
         most = most - 1
      end do
   end function default_max_lags

   !> Sums of the regression, with enough rows and a difference that varies.
   subroutine regress(x, trend, terms, lags, gram, error, valid)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Its trend
      type(trend_type), intent(in) :: trend
      !> Deterministic terms, lags
      integer, intent(in) :: terms, lags
      !> The sums
      type(gram_type), intent(out) :: gram
      !> too_few_samples, constant_input, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer :: k
      real(dp) :: rounding
      character(160) :: text

      k = terms + lags + 1
      gram%rows = 0
      if (size(x, kind=int64) > int(lags, int64) + k + 1) call build_gram(x, trend, terms, lags, gram, error, valid)
      if (allocated(error)) return
      if (gram%rows <= k) then
         write (text, '("the ADF test with ", i0, " lags needs more than ", i0, " complete rows, there are ", i0)') &
            & lags, k, gram%rows
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      rounding = epsilon(x)*largest_value(x, valid)
      if (gram%matrix(k + 1, k + 1) <= real(gram%rows, dp)*rounding**2) then
         call fatal_error(error, status%constant_input, &
            & "the series is constant, or a line with ct, to rounding: there is nothing to test for a unit root")
      end if
   end subroutine regress

   !> Largest absolute value of the present samples, from at most some thousand of them.
   pure real(dp) function largest_value(x, valid) result(largest)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i

      largest = 0.0_dp
      do i = 1, size(x, kind=int64), size(x, kind=int64)/4096 + 1
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         largest = max(largest, abs(x(i)))
      end do
   end function largest_value

   !> Cholesky factor of the matrix scaled to a unit diagonal.
   subroutine factor(matrix, scale, error)
      !> Upper triangle; the factor on return
      real(dp), intent(inout) :: matrix(:, :)
      !> Square root of the last diagonal element, the difference's
      real(dp), intent(out) :: scale
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: s(size(matrix, 1))
      integer :: i, j, k, info

      k = size(matrix, 1)
      info = 0
      do j = 1, k
         s(j) = sqrt(max(matrix(j, j), 0.0_dp))
         if (.not. s(j) > 0.0_dp) info = j
      end do
      scale = s(k)
      if (info == 0) then
         do j = 1, k
            matrix(:j, j) = matrix(:j, j)/s(j)/s(:j)
         end do
         call dpotrf("U", k, matrix, k, info)
      end if
      if (info == 0) then
         do i = 1, k
            if (matrix(i, i) < smallest_pivot) info = i
         end do
      end if
      if (info /= 0) call fatal_error(error, status%singular, &
         & "the ADF regression is singular: the series is predicted perfectly by its own past; try fewer lags")
   end subroutine factor

   !> The lag by a criterion, from one factorisation: with l the last column, RSS of the first i
   !> regressors is the sum of l_j^2, j > i.
   subroutine choose_lag(gram, criterion, lag, error)
      !> Sums with the most lags
      type(gram_type), intent(in) :: gram
      !> aic, bic, t
      character(*), intent(in) :: criterion
      !> The lag
      integer, intent(out) :: lag
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: r(:, :)
      real(dp) :: scale, rss, best, value, n, penalty
      integer :: k, base, last

      lag = 0
      r = gram%matrix
      call factor(r, scale, error)
      if (allocated(error)) return
      base = gram%terms + 1
      last = size(r, 1)
      n = real(gram%rows, dp)
      penalty = merge(log(n), 2.0_dp, criterion == "bic")
      best = huge(best)
      rss = r(last, last)**2
      do k = gram%lags, 0, -1
         if (criterion == "t") then
            value = abs(r(base + k, last))/sqrt(rss/(n - real(base + k, dp)))
            if (k > 0 .and. value >= significant_t) then
               lag = k
               return
            end if
         else
            value = n*log(rss) + penalty*real(base + k, dp)
            if (value <= best) then
               best = value
               lag = k
            end if
         end if
         rss = rss + r(base + k, last)**2
      end do
   end subroutine choose_lag

   !> t statistic of the level: with the level as the last regressor it is l_level/sqrt(l_y^2/dof).
   subroutine level_statistic(gram, statistic, error)
      !> Sums with the lag chosen
      type(gram_type), intent(in) :: gram
      !> The statistic
      real(dp), intent(out) :: statistic
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: r(:, :)
      real(dp) :: scale
      integer :: order(size(gram%matrix, 1))
      integer :: i, j, k

      statistic = 0.0_dp
      k = size(gram%matrix, 1)
      do i = 1, k
         order(i) = i
         if (i > gram%terms .and. i < k - 1) order(i) = i + 1
      end do
      order(k - 1) = gram%terms + 1
      allocate (r(k, k))
      r = 0.0_dp
      do j = 1, k
         do i = 1, j
            r(i, j) = gram%matrix(min(order(i), order(j)), max(order(i), order(j)))
         end do
      end do
      call factor(r, scale, error)
      if (allocated(error)) return
      statistic = r(k - 1, k)/sqrt(r(k, k)**2/(real(gram%rows, dp) - real(k - 1, dp)))
   end subroutine level_statistic

end module gyroakf_series_stationarity
