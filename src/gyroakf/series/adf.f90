! SPDX-License-Identifier: MIT
!> Unit root of a series: the augmented Dickey-Fuller test.
!>
!> Products of the regression: [[gyroakf_stats_lagged_gram]]; t statistic:
!> [[gyroakf_series_adf_factor]]; number of lags: [[gyroakf_series_adf_lags]]; critical values and
!> p-values: [[gyroakf_series_mackinnon]].
module gyroakf_series_adf
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_trend, only : trend_type
   use gyroakf_stats_autocovariance, only : autocovariance_type, check_series
   use gyroakf_stats_trend_fit, only : fit_trend
   use gyroakf_stats_lagged_gram, only : gram_type, build_gram, shorten_gram
   use gyroakf_series_adf_factor, only : factor_regression
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
      !> Most lags to choose from, fewer in a short series; -1: ceiling(12 (n/100)^(1/4))
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
      !> Asymptotic probability of a smaller statistic where there is a unit root; 0 where it is
      !> below 1e-20 and the response surface ends
      real(dp) :: p_value = 1.0_dp
      !> Lags used
      integer :: lag = 0
      !> Rows of the regression
      integer(int64) :: observations = 0
      !> What was used
      character(3) :: regression = "c", criterion = "aic"
      !> Critical values at 1 %, 5 %, 10 % for this number of rows
      real(dp) :: critical(3) = 0.0_dp
      !> statistic < critical(2): the unit root is rejected at 5 %
      logical :: stationary = .false.
      !> The lag was chosen, from 0 .. max_lags, by `criterion`; else it was given
      logical :: lag_chosen = .false.
      !> Criterion on the rows that all candidates have in common; where it is t: |t| of the lag, of
      !> the level at lag 0; 0 where the lag was given
      real(dp) :: criterion_value = 0.0_dp
      !> Most lags that were tried, the lags given where they were given
      integer :: max_lags = 0
      !> Most lags that were asked for, or by the rule of [[adf_options]]; larger than max_lags
      !> where the series, or its gaps, did not allow so many
      integer :: wanted_lags = 0
      !> Coefficient of the level
      real(dp) :: level = 0.0_dp
      !> Residual variance, with N - k
      real(dp) :: noise_variance = 0.0_dp
      !> Only with the option `table`: deterministic terms, level, lags 1 .. lag;
      !> [[gyroakf_series_adf_table]] has the convention
      type(adf_coefficient_type), allocatable :: table(:)
   end type adf_type

   !> Samples of the rough trend, and up to how many it is that of all
   integer(int64), parameter :: rough_samples = 4096, all_up_to = 8192
   !> Beyond it the sum of the squares may overflow
   real(dp), parameter :: largest_square_root = 1.0e145_dp
   character(*), parameter :: overflows = &
      & "the series has a value that is not finite, or its squares overflow"

contains

   !> Augmented Dickey-Fuller test.
   !>
   !> $$\Delta y_t = \text{deterministic} + \rho y_{t-1} + \sum_{j=1}^{p} b_j \Delta y_{t-j} + e_t$$
   !> The statistic is rho over its standard error (residual variance with N - k); null hypothesis:
   !> a unit root, rho = 0. The lag is chosen on the rows that all candidates have in common,
   !> $$AIC = N_0(\ln 2\pi + \ln(RSS/N_0) + 1) + 2k$$ (BIC: k ln N_0), ties to the smaller lag, and
   !> the regression repeated with it on all rows that it has. One pass over the series, memory
   !> O(p^2); with missing samples over complete rows only. Sources: Said & Dickey, Biometrika 71
   !> (1984) 599-607; gyroakf_series_mackinnon. Where p-value and critical value disagree near 5 %
   !> with few samples, the critical value decides.
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
      !> Autocovariances that somebody else needs, planned by [[plan_autocovariance]]: filled on the
      !> way, also where the test then fails; not where it fails before the pass
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(trend_type) :: trend
      type(gram_type) :: gram
      real(dp) :: rounding
      integer(int64) :: stride
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
      if (result%lag_chosen) call default_max_lags(size(x, kind=int64), terms, options%max_lags, &
         & result%max_lags, result%wanted_lags, valid)
      stride = size(x, kind=int64)/4096 + 1                            ! some thousand tell enough
      if (present(valid)) then
         rounding = epsilon(x)*max(0.0_dp, maxval(abs(x(::stride)), mask=valid(::stride) /= 0_int8))
      else
         rounding = epsilon(x)*maxval(abs(x(::stride)))
      end if
      if (rounding > epsilon(x)*largest_square_root) call fatal_error(error, &
         & status%non_finite, overflows)
      if (allocated(error)) return
      call build_regression(x, trend, terms, result%max_lags, rounding, gram, error, valid, &
         shared, progress)
      if (allocated(error)) return
      result%lag = result%max_lags
      if (result%lag_chosen) then
         call choose_lag(x, trend, gram, rounding, result, error, valid, progress)
         if (allocated(error)) return
         call shorten_gram(x, trend, result%lag, gram, error, valid, progress)
         if (allocated(error)) return
      end if
      call compute_statistic(x, trend, gram, rounding, options%table, result, error, valid, &
         progress)
   end subroutine test_adf

   !> Refuses options and series that cannot be tested.
   subroutine check_options(x, options, terms, error, valid)
      real(dp), intent(in) :: x(:)
      type(adf_options), intent(in) :: options
      integer, intent(out) :: terms
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n
      character(120) :: text

      n = size(x, kind=int64)
      terms = regression_number(trim(options%regression)) - 1
      if (terms < 0) then
         call fatal_error(error, status%invalid_argument, "unknown regression '" &
            & //trim(options%regression)//"' of the ADF test; there are n, c, ct, ctt")
      else if (all(options%criterion /= [character(3) :: "aic", "bic", "t"])) then
         call fatal_error(error, status%invalid_argument, "unknown criterion '" &
            & //trim(options%criterion)//"' of the ADF test; there are aic, bic, t")
      else if (options%lags < -1 .or. options%max_lags < -1) then
         call fatal_error(error, status%invalid_argument, &
            & "the lags of the ADF test must not be negative; -1 chooses them")
      else if (n < terms + 4) then
         write (text, "(2(a, i0))") "the ADF test needs at least ", terms + 4, &
            & " samples, there are ", n
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (options%lags >= n) then
         write (text, "(2(a, i0), a)") "the ADF test with ", options%lags, &
            & " lags needs more than ", n, " samples"
         call fatal_error(error, status%too_few_samples, trim(text))
      else
         call check_series(n, 0, error, valid)
      end if
   end subroutine check_options

   !> A polynomial near the trend, of every m-th sample of a long series. The regression does not
   !> feel what polynomial is taken off before, but its sums would lose the digits of the trend.
   subroutine rough_trend(x, degree, trend, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: degree
      type(trend_type), intent(out) :: trend
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: few(:)
      integer(int8), allocatable :: here(:)
      integer(int64) :: n, stride, count
      integer :: stat

      n = size(x, kind=int64)
      if (n > all_up_to .and. degree >= 0) then
         stride = n/rough_samples
         count = (n - 1)/stride + 1
         allocate (few(count), stat=stat)
         if (stat == 0) allocate (here(count), stat=stat)
         call check_memory(stat, "the rough trend", error)
         if (allocated(error)) return
         few(:) = x(::stride)
         here(:) = 1_int8
         if (present(valid)) here(:) = valid(::stride)
         call fit_trend(few, degree, trend, error, here)
         trend%samples = (count - 1)*stride + 1
         if (.not. allocated(error)) return
         deallocate (error)                                  ! too few of them are present
      end if
      call fit_trend(x, degree, trend, error, valid)
   end subroutine rough_trend

   !> Sums of the regression, with enough rows and a difference that varies.
   subroutine build_regression(x, trend, terms, lags, rounding, gram, error, valid, shared, &
                               progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      integer, intent(in) :: terms, lags
      real(dp), intent(in) :: rounding
      type(gram_type), intent(out) :: gram
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(autocovariance_type), intent(inout), optional :: shared
      class(progress_type), intent(inout), optional :: progress
      integer :: k
      character(120) :: text

      k = terms + lags + 1
      gram%rows = max(0_int64, size(x, kind=int64) - 1 - lags)         ! no more, even without gaps
      if (gram%rows > k) call build_gram(x, trend, terms, 1, lags, gram, error, valid, shared, &
         & progress)
      if (allocated(error)) return
      if (gram%rows <= k) then
         write (text, "(3(a, i0))") "the ADF test with ", lags, " lags needs more than ", k, &
            & " complete rows, there are ", gram%rows
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      associate (squares => gram%matrix(k + 1, k + 1), level => gram%matrix(terms + 1, terms + 1))
         if (.not. (ieee_is_finite(squares) .and. ieee_is_finite(level))) then
            call fatal_error(error, status%non_finite, overflows)
         else if (squares <= real(gram%rows, dp)*rounding**2) then
            call fatal_error(error, status%constant_input, "the series is constant, or a line " &
               & //"with ct, to rounding: there is nothing to test for a unit root")
         end if
      end associate
   end subroutine build_regression

   !> The lag by the criterion.
   subroutine choose_lag(x, trend, gram, rounding, result, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      type(gram_type), intent(in) :: gram
      real(dp), intent(in) :: rounding
      type(adf_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:, :)
      real(dp) :: scale(size(gram%matrix, 1))
      integer :: order(size(scale)), i

      order = [(i, i=1, size(order))]
      call factor_regression(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      if (.not. allocated(error)) call pick_lag(r, gram%terms, gram%lags, gram%rows, &
         & trim(result%criterion), scale(size(scale)), result%lag, result%criterion_value)
   end subroutine choose_lag

   !> The regression with the level last: its t statistic is l_level/sqrt(l_y^2/dof).
   subroutine compute_statistic(x, trend, gram, rounding, wants_table, result, error, valid, &
                                progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      type(gram_type), intent(in) :: gram
      real(dp), intent(in) :: rounding
      logical, intent(in) :: wants_table
      type(adf_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:, :)
      real(dp) :: scale(size(gram%matrix, 1)), freedom
      integer :: order(size(scale)), i, k

      k = size(order)
      order = [(i, i=1, gram%terms), (i + 1, i=gram%terms + 1, k - 2), gram%terms + 1, k]
      call factor_regression(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      if (allocated(error)) return
      freedom = real(gram%rows, dp) - real(k - 1, dp)
      result%statistic = r(k - 1, k)/sqrt(r(k, k)**2/freedom)
      result%level = r(k - 1, k)/r(k - 1, k - 1)*(scale(k)/scale(k - 1))
      result%noise_variance = (r(k, k)*scale(k))**2/freedom
      result%observations = gram%rows
      result%critical = critical_values(gram%terms + 1, gram%rows)
      result%p_value = p_value(result%statistic, gram%terms + 1)
      result%stationary = result%statistic < result%critical(2)
      if (wants_table) call coefficient_table(r, scale, gram%terms, gram%lags, gram%rows, &
         & size(x, kind=int64), trend, result%table)
   end subroutine compute_statistic

end module gyroakf_series_adf
