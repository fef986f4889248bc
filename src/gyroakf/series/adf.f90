! SPDX-License-Identifier: MIT
!> Unit root of a series: the augmented Dickey-Fuller test.
module gyroakf_series_adf
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_trend, only : trend_type
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_stats_rough_trend, only : rough_trend
   use gyroakf_stats_lagged_gram, only : gram_type, build_gram, shorten_gram
   use gyroakf_series_adf_factor, only : factor_gram, factor_rows
   use gyroakf_series_adf_lags, only : default_max_lags, pick_lag
   use gyroakf_series_adf_table, only : adf_coefficient_type, coefficient_table
   use gyroakf_series_mackinnon, only : regression_number, critical_values, p_value
   implicit none (type, external)
   private
   public :: adf_options, adf_type, adf_coefficient_type, test_adf, default_max_lags

   !> How the test is made
   type :: adf_options
      !> Deterministic part: n nothing, c constant, ct line, ctt parabola
      character(3) :: regression = "c"
      !> Lags of the difference; -1: chosen by the criterion
      integer :: lags = -1
      !> Most lags to choose from; -1: ceiling(12 (n/100)^(1/4)). A short series, or gaps, allow fewer: see default_max_lags
      integer :: max_lags = -1
      !> aic, bic, or t (the last lag with |t| >= 1.645; 0 where there is none)
      character(3) :: criterion = "aic"
      !> The coefficients of the regression are returned too
      logical :: table = .false.
   end type adf_options

   !> Result of the test
   type :: adf_type
      !> t statistic of the level
      real(dp) :: statistic = 0.0_dp
      !> Asymptotic probability of a smaller statistic where there is a unit root; 0 where it is below 1e-20 and the
      !> response surface ends
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
      !> The lag was chosen, from 0 .. max_lags, by `criterion`; else it was given
      logical :: lag_chosen = .false.
      !> Criterion on the rows that all candidates have in common; where it is t: |t| of the lag, of the level at lag 0; 0 where
      !> the lag was given
      real(dp) :: criterion_value = 0.0_dp
      !> Most lags that were tried, the lags given where they were given
      integer :: max_lags = 0
      !> Most lags that were asked for, or by the rule of [[adf_options]]; larger than max_lags where the series, or its gaps,
      !> did not allow so many
      integer :: wanted_lags = 0
      !> Coefficient of the level
      real(dp) :: level = 0.0_dp
      !> Residual variance, with N - k
      real(dp) :: noise_variance = 0.0_dp
      !> Only with the option `table`: deterministic terms, level, lags 1 .. lag; [[gyroakf_series_adf_table]] has the convention
      type(adf_coefficient_type), allocatable :: table(:)
   end type adf_type

   !> Beyond it the sum of the squares may overflow
   real(dp), parameter :: largest_square_root = 1.0e145_dp
   character(*), parameter :: overflows = "the series has a value that is not finite, or its squares overflow"

contains

   !> Augmented Dickey-Fuller test.
   !>
   !> $$\Delta y_t = \text{deterministic} + \rho y_{t-1} + \sum_{j=1}^{p} b_j \Delta y_{t-j} + e_t$$
   !> The statistic is rho over its standard error (residual variance with N - k); null hypothesis: a
   !> unit root, rho = 0. The lag is chosen on the rows that all candidates have in common,
   !> $$AIC = N_0(\ln 2\pi + \ln(RSS/N_0) + 1) + 2k$$ (BIC: k ln N_0), ties to the smaller lag, and the
   !> regression repeated with it on all rows that it has. One pass over the series, memory O(p^2);
   !> with missing samples over complete rows only. Sources: Said & Dickey, Biometrika 71 (1984) 599-607;
   !> gyroakf_series_mackinnon. Where p-value and critical value disagree near 5 % with few samples, the
   !> critical value decides.
   subroutine test_adf(x, options, result, error, valid, shared, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(adf_options), intent(in) :: options
      !> The test
      type(adf_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input (also a perfect line with ct), singular
      !> (a perfect fit or collinear lags), non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Autocovariances that somebody else needs, planned by [[plan_autocovariance]]: filled on the way, also where the test
      !> then fails; not where it fails before the pass
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(trend_type) :: trend
      type(gram_type) :: gram
      real(dp) :: rounding
      integer :: terms

      call check_options(x, options, terms, error, valid)
      if (allocated(error)) return
      call rough_trend(x, terms - 1, trend, error, valid)
      if (allocated(error)) return
      result%regression = options%regression
      result%criterion = options%criterion
      result%lag_chosen = options%lags < 0
      result%max_lags = options%lags
      result%wanted_lags = options%lags
      if (result%lag_chosen) then
         call default_max_lags(size(x, kind=int64), terms, options%max_lags, result%max_lags, result%wanted_lags, valid)
      end if
      rounding = epsilon(x)*largest_value(x, valid)
      if (rounding > epsilon(x)*largest_square_root) then
         call fatal_error(error, status%non_finite, overflows)
         return
      end if
      call regress(x, trend, terms, result%max_lags, rounding, gram, error, valid, shared, progress)
      if (allocated(error)) return
      result%lag = result%max_lags
      if (result%lag_chosen) then
         call choose_lag(x, trend, gram, trim(options%criterion), rounding, result%lag, result%criterion_value, error, valid, &
            & progress)
         if (allocated(error)) return
         call shorten_gram(x, trend, result%lag, gram, error, valid, progress)
         if (allocated(error)) return
      end if
      call solve(x, trend, gram, rounding, options%table, result, error, valid, progress)
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
      else if (options%lags >= size(x, kind=int64)) then
         write (text, '("the ADF test with ", i0, " lags needs more than ", i0, " samples")') options%lags, size(x, kind=int64)
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (present(valid)) then
         if (size(valid, kind=int64) /= size(x, kind=int64)) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
         end if
      end if
   end subroutine check_options

   !> Sums of the regression, with enough rows and a difference that varies.
   subroutine regress(x, trend, terms, lags, rounding, gram, error, valid, shared, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Its trend
      type(trend_type), intent(in) :: trend
      !> Deterministic terms, lags
      integer, intent(in) :: terms, lags
      !> Rounding of a sample
      real(dp), intent(in) :: rounding
      !> The sums
      type(gram_type), intent(out) :: gram
      !> too_few_samples, constant_input, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Autocovariances that are made on the way
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback
      class(progress_type), intent(inout), optional :: progress
      integer :: k
      character(160) :: text

      k = terms + lags + 1
      gram%rows = max(0_int64, size(x, kind=int64) - 1 - lags)               ! no more, even without gaps
      if (gram%rows > k) then
         call build_gram(x, trend, terms, 1, lags, gram, error, valid, shared, progress)
      end if
      if (allocated(error)) return
      if (gram%rows <= k) then
         write (text, '("the ADF test with ", i0, " lags needs more than ", i0, " complete rows, there are ", i0)') &
            & lags, k, gram%rows
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (.not. (ieee_is_finite(gram%matrix(k + 1, k + 1)) .and. ieee_is_finite(gram%matrix(terms + 1, terms + 1)))) then
         call fatal_error(error, status%non_finite, overflows)
      else if (gram%matrix(k + 1, k + 1) <= real(gram%rows, dp)*rounding**2) then
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

   !> The lag by a criterion. The factor stands in the upper triangle of the sums, which wait in the lower one meanwhile.
   subroutine choose_lag(x, trend, gram, criterion, rounding, lag, value, error, valid, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Its trend
      type(trend_type), intent(in) :: trend
      !> Sums with the most lags; the same on return
      type(gram_type), intent(inout) :: gram
      !> aic, bic, t
      character(*), intent(in) :: criterion
      !> Rounding of a sample
      real(dp), intent(in) :: rounding
      !> The lag
      integer, intent(out) :: lag
      !> What the criterion is there
      real(dp), intent(out) :: value
      !> singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback, used where the factor comes from the rows
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:, :)
      real(dp) :: diagonal(size(gram%matrix, 1)), scale(size(gram%matrix, 1))
      integer :: order(size(gram%matrix, 1))
      integer :: i, k
      logical :: ready

      lag = 0
      value = 0.0_dp
      k = size(gram%matrix, 1)
      do i = 1, k
         order(i) = i
         diagonal(i) = gram%matrix(i, i)
         gram%matrix(i + 1:, i) = gram%matrix(i, i + 1:)
      end do
      call factor_gram(gram%matrix, scale, ready)
      if (ready) call pick_lag(gram%matrix, gram%terms, gram%lags, gram%rows, criterion, scale(k), lag, value)
      do i = 1, k
         gram%matrix(i, i) = diagonal(i)
         gram%matrix(i, i + 1:) = gram%matrix(i + 1:, i)
      end do
      if (ready) return
      allocate (r(k, k), stat=i)
      if (i /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the factor of the unit-root regression")
         return
      end if
      call factor_rows(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      if (.not. allocated(error)) call pick_lag(r, gram%terms, gram%lags, gram%rows, criterion, scale(k), lag, value)
   end subroutine choose_lag

   !> The regression with the level as the last regressor: its t statistic is l_level/sqrt(l_y^2/dof).
   subroutine solve(x, trend, gram, rounding, wants_table, result, error, valid, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Its trend
      type(trend_type), intent(in) :: trend
      !> Sums with the lag that is used
      type(gram_type), intent(in) :: gram
      !> Rounding of a sample
      real(dp), intent(in) :: rounding
      !> Whether the coefficients are returned
      logical, intent(in) :: wants_table
      !> The test; all but the options is filled
      type(adf_type), intent(inout) :: result
      !> singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback, used where the factor comes from the rows
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:, :)
      real(dp) :: scale(size(gram%matrix, 1)), freedom
      integer :: order(size(gram%matrix, 1))
      integer :: i, j, k, stat
      logical :: ready

      k = size(gram%matrix, 1)
      allocate (r(k, k), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the factor of the unit-root regression")
         return
      end if
      do i = 1, k
         order(i) = i
         if (i > gram%terms .and. i < k - 1) order(i) = i + 1
      end do
      order(k - 1) = gram%terms + 1
      r = 0.0_dp
      do j = 1, k
         do i = 1, j
            r(i, j) = gram%matrix(min(order(i), order(j)), max(order(i), order(j)))
         end do
      end do
      call factor_gram(r, scale, ready)
      if (.not. ready) call factor_rows(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      if (allocated(error)) return
      freedom = real(gram%rows, dp) - real(k - 1, dp)
      result%statistic = r(k - 1, k)/sqrt(r(k, k)**2/freedom)
      result%level = r(k - 1, k)/r(k - 1, k - 1)*(scale(k)/scale(k - 1))
      result%noise_variance = (r(k, k)*scale(k))**2/freedom
      result%observations = gram%rows
      result%critical = critical_values(gram%terms + 1, gram%rows)
      result%p_value = p_value(result%statistic, gram%terms + 1)
      result%stationary = result%statistic < result%critical(2)
      if (wants_table) call coefficient_table(r, scale, gram%terms, gram%lags, gram%rows, size(x, kind=int64), trend, &
         & result%table)
   end subroutine solve

end module gyroakf_series_adf
