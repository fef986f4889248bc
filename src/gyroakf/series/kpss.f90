! SPDX-License-Identifier: MIT
!> Stationarity of a series: the test of Kwiatkowski, Phillips, Schmidt and Shin.
module gyroakf_series_kpss
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_autocovariance, only : check_series, find_level
   use gyroakf_stats_trend, only : trend_type
   use gyroakf_stats_trend_fit, only : fit_trend
   use gyroakf_stats_long_run, only : cumulative_type, sum_residuals, sum_bartlett, &
      & bartlett_variance, hobijn_lags, schwert_lags
   use gyroakf_stats_bridge, only : bridge_survival
   implicit none (type, external)
   private
   public :: kpss_options, kpss_type, test_kpss

   !> How the test is made
   type :: kpss_options
      !> What the series is stationary about: c a level, ct a line
      character(2) :: regression = "c"
      !> Bandwidth of the long-run variance; -1: by the rule
      integer(int64) :: lags = -1
      !> auto: Hobijn, Franses and Ooms, from the autocovariances; legacy: floor(12 (n/100)^(1/4))
      character(6) :: rule = "auto"
   end type kpss_options

   !> Result of the test
   type :: kpss_type
      !> The statistic
      real(dp) :: statistic = 0.0_dp
      !> Interpolated linearly in the published table, 0.01 or 0.10 at its ends
      real(dp) :: p_value = 1.0_dp
      !> -1: p is below p_value, beyond the table; 0: p is p_value; 1: p is above p_value
      integer :: p_bound = 0
      !> Exact probability of a larger statistic for a long stationary series, [[bridge_survival]]
      real(dp) :: p_asymptotic = 1.0_dp
      !> Bandwidth used
      integer(int64) :: lags = 0
      !> What was used; "fixed" where the lags were given
      character(2) :: regression = "c"
      character(6) :: rule = "auto"
      !> Present samples
      integer(int64) :: observations = 0
      !> Critical values at 10 %, 5 %, 2.5 %, 1 %
      real(dp) :: critical(4) = 0.0_dp
      !> statistic < critical(2): stationarity is not rejected at 5 %
      logical :: stationary = .false.
      !> Variance of the residuals and their long-run variance, divisor n
      real(dp) :: variance = 0.0_dp, long_run_variance = 0.0_dp
      !> Size of the effect, which n does not inflate, in the unit of the series: a line (ct: a
      !> parabola) of this height from its lowest to its highest point gives the same running sums
      real(dp) :: drift = 0.0_dp
   end type kpss_type

   !> Table 1 of the source: p and the critical values of c and ct
   real(dp), parameter :: table_p(4) = [0.10_dp, 0.05_dp, 0.025_dp, 0.01_dp]
   real(dp), parameter :: table(4, 2) = reshape([ &
      & 0.347_dp, 0.463_dp, 0.574_dp, 0.739_dp, &
      & 0.119_dp, 0.146_dp, 0.176_dp, 0.216_dp], [4, 2])
   !> Sum of S_t^2 over n^3 for a line of height 1, for a parabola of height 1
   real(dp), parameter :: line_share(2) = [1.0_dp/120.0_dp, 1.0_dp/472.5_dp]
   !> A variance below so many times that of the rounding is none
   real(dp), parameter :: rounding_factor = 4.0_dp

contains

   !> KPSS test: null hypothesis stationarity, about a level or a line.
   !>
   !> $$\eta = \frac{1}{n^2 \hat\sigma^2} \sum_{t=1}^{n} S_t^2, \quad S_t = \sum_{i \le t} e_i,
   !> \quad
   !>   \hat\sigma^2 = \sum_{|i| \le l} \Big(1 - \frac{|i|}{l+1}\Big) \hat\gamma_i, \quad
   !>   \hat\gamma_i = \frac{1}{n} \sum_t e_t e_{t-i}$$
   !> with the residuals e of the level or the line. One pass for the fit (two for a line), one for
   !> S and the products at the first lags, one more where the bandwidth exceeds them; memory O(1).
   !> With missing samples n is the number of present ones, S grows and counts at present samples
   !> only, and the products are those of present pairs, divided by n (so that they estimate the
   !> variance of the sums that S takes, and stay positive definite). Sources: Kwiatkowski et al.,
   !> J. Econometrics 54 (1992) 159-178; for gaps Datta & Du, FRB IFDP 1060 (2012).
   subroutine test_kpss(x, options, result, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(kpss_options), intent(in) :: options
      !> The test
      type(kpss_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input (also a perfect line with ct),
      !> non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(trend_type) :: trend
      type(cumulative_type) :: sums
      real(dp), allocatable :: products(:)
      real(dp) :: n, rounding
      integer :: terms, q
      character(120) :: text

      call check_options(options, size(x, kind=int64), terms, error)
      if (allocated(error)) return
      call report_progress("stationarity test", 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call check_series(size(x, kind=int64), 0, error, valid)
      if (allocated(error)) return
      if (terms > 1) then
         call fit_trend(x, terms - 1, trend, error, valid, progress)
      else
         call find_level(x, trend, result%observations, error, valid)
      end if
      if (allocated(error)) return
      q = first_lags(size(x, kind=int64))
      call sum_residuals(trend, x, q, sums, products, error, valid, progress)
      if (allocated(error)) return
      n = sums%count
      result%observations = nint(n, int64)
      rounding = epsilon(1.0_dp)*(sum(abs(trend%legendre)) + abs(trend%remainder))
      if (result%observations < int(terms, int64) + 2) then
         write (text, "(2(a, i0), a)") "the KPSS test needs at least ", terms + 2, " samples, ", &
            & result%observations, " are present"
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (.not. products(0) > rounding_factor*n*rounding**2) then
         call fatal_error(error, status%constant_input, "the series is constant, or a line " &
            & //"with ct, to rounding: there is nothing to test for stationarity")
      end if
      if (allocated(error)) return
      result%regression = options%regression
      result%rule = options%rule
      if (options%lags >= 0) then
         result%lags = options%lags
         result%rule = "fixed"
      else if (options%rule == "legacy") then
         result%lags = schwert_lags(result%observations)
      else
         result%lags = hobijn_lags(products(0:min(first_lags(result%observations), q)), &
            & result%observations)
      end if
      result%lags = min(result%lags, size(x, kind=int64) - 1)
      result%variance = products(0)/n
      if (result%lags <= q) then
         result%long_run_variance = bartlett_variance(products, int(result%lags))/n
      else
         call sum_bartlett(trend, x, result%lags, result%long_run_variance, error, valid, progress)
         if (allocated(error)) return
         result%long_run_variance = result%long_run_variance/n
      end if
      result%drift = sqrt(max(sums%squares, 0.0_dp)/n/n/n/line_share(terms))
      call judge(sums%squares/n/n, terms, result, error)
   end subroutine test_kpss

   !> Refuses options that mean nothing.
   subroutine check_options(options, n, terms, error)
      type(kpss_options), intent(in) :: options
      integer(int64), intent(in) :: n
      integer, intent(out) :: terms
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      terms = findloc(["c ", "ct"] == options%regression, .true., 1)
      if (terms == 0) then
         call fatal_error(error, status%invalid_argument, "unknown regression '" &
            & //trim(options%regression)//"' of the KPSS test; there are c, ct")
      else if (options%rule /= "auto" .and. options%rule /= "legacy") then
         call fatal_error(error, status%invalid_argument, "unknown rule '"//trim(options%rule) &
            & //"' for the lags of the KPSS test; there are auto, legacy")
      else if (options%lags < -1) then
         call fatal_error(error, status%invalid_argument, &
            & "the lags of the KPSS test must not be negative; -1 chooses them")
      else if (n < int(terms, int64) + 2 .or. options%lags >= n) then
         write (text, '("the KPSS test needs more than ", i0, " samples, there are ", i0)') &
            & max(options%lags, int(terms, int64) + 1), n
         call fatal_error(error, status%too_few_samples, trim(text))
      end if
   end subroutine check_options

   !> floor(n^(2/9)), exactly: the lags from which the bandwidth is chosen.
   pure integer function first_lags(n) result(q)
      integer(int64), intent(in) :: n
      !> Squares of larger ones would not fit; there the power is exact enough
      integer(int64), parameter :: largest = 1000000000_int64

      q = int(real(n, dp)**(2.0_dp/9.0_dp))
      if (n > largest) return
      if (int(q + 1, int64)**9 <= n*n) q = q + 1
      if (int(q, int64)**9 > n*n) q = q - 1
   end function first_lags

   !> Statistic, p-value, verdict.
   subroutine judge(sum_share, terms, result, error)
      real(dp), intent(in) :: sum_share
      integer, intent(in) :: terms
      type(kpss_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. result%long_run_variance > tiny(1.0_dp)*max(1.0_dp, sum_share)) then
         call fatal_error(error, status%singular, &
            & "the long-run variance of the KPSS test is 0 with this bandwidth; try fewer lags")
         return
      end if
      result%statistic = sum_share/result%long_run_variance
      result%critical = table(:, terms)
      result%stationary = result%statistic < result%critical(2)
      result%p_asymptotic = bridge_survival(result%statistic, terms)
      if (result%statistic < table(1, terms)) then
         result%p_value = table_p(1)
         result%p_bound = 1
      else if (result%statistic > table(4, terms)) then
         result%p_value = table_p(4)
         result%p_bound = -1
      else
         i = max(1, count(table(:, terms) < result%statistic))
         result%p_value = table_p(i) + (table_p(i + 1) - table_p(i)) &
            & *(result%statistic - table(i, terms))/(table(i + 1, terms) - table(i, terms))
      end if
   end subroutine judge

end module gyroakf_series_kpss
