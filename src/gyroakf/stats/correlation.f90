! SPDX-License-Identifier: MIT
!> Autocorrelation and partial autocorrelation of a series to any lag, and the tests of whiteness at
!> every lag, from the same numbers: one pass for the mean, one for all lags.
module gyroakf_stats_correlation
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_special, only : chi_square_survival
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   use gyroakf_stats_whiteness, only : ljung_box_type, ljung_box_of
   implicit none (type, external)
   private
   public :: correlation_type, compute_correlation, correlation_of

   !> Correlation at the lags 0 .. h
   type :: correlation_type
      !> Largest lag h
      integer :: lags = 0
      !> Samples of the series, and those present
      integer(int64) :: samples = 0, observations = 0
      !> Parameters fitted before, subtracted from the degrees of freedom
      integer :: fitted = 0
      !> Mean and variance (divisor: samples present); 0 where the autocovariances were given
      real(dp) :: mean = 0.0_dp, variance = 0.0_dp
      !> Autocorrelation, biased: [0:h]
      real(dp), allocatable :: acf(:)
      !> Partial autocorrelation: [0:h]; 0 above `partial_lags`
      real(dp), allocatable :: pacf(:)
      !> Lags whose partial autocorrelation exists: h, fewer where the past predicts perfectly
      integer :: partial_lags = 0
      !> Present pairs: [0:h]
      integer(int64), allocatable :: pairs(:)
      !> 95 % limits of |acf| of white noise, 1.96/sqrt(n) without gaps: [0:h], 0 at lag 0
      real(dp), allocatable :: limit(:)
      !> Those of a series that is correlated up to the lag before (Bartlett): [0:h]
      real(dp), allocatable :: bartlett(:)
      !> Ljung-Box statistic over the lags 1 .. k, and p, 1 up to `fitted`: [0:h]
      real(dp), allocatable :: ljung_box(:), ljung_box_p(:)
      !> Size of the effect: largest |acf| beyond lag 0, and its lag
      real(dp) :: largest_rho = 0.0_dp
      integer :: largest_lag = 0
   end type correlation_type

   !> Two-sided 95 % point of the normal distribution
   real(dp), parameter :: normal_95 = 1.9599639845400542_dp

contains

   !> Correlation of a series.
   !>
   !> $$\hat\rho_k = r_k/r_0, \quad r_k = \frac{1}{n} \sum_{t=k}^{n-1} (x_t - \bar x)(x_{t-k} - \bar
   !> x)$$ and the partial autocorrelation is the last coefficient of the AR(k) model that solves
   !> the Yule-Walker equations. White noise stays within 1.96/sqrt(n) at 95 % of the lags; a series
   !> that is correlated up to lag k-1 within $$1.96 \sqrt{(1 + 2 \sum_{i<k} \hat\rho_i^2)/n}$$ at
   !> lag k (Bartlett, J. R. Stat. Soc. B 8 (1946) 27-41). With missing samples r_k comes from the
   !> m_k present pairs, and m_k takes the place of n - k.
   subroutine compute_correlation(x, lags, fitted, result, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag h, 1 .. n-1, > fitted
      integer, intent(in) :: lags
      !> Parameters of the model whose residuals these are, >= 0
      integer, intent(in) :: fitted
      !> The correlation
      type(correlation_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean

      call compute_autocovariance(x, lags, mean, r, error, valid, pairs, progress)
      if (allocated(error)) return
      call correlation_of(r, size(x, kind=int64), fitted, result, error, pairs)
      result%mean = mean
   end subroutine compute_correlation

   !> The same from autocovariances, for whoever accumulates them on the way.
   subroutine correlation_of(r, n, fitted, result, error, pairs)
      !> Biased autocovariances: [0:h], h > fitted
      real(dp), intent(in), contiguous :: r(0:)
      !> Length of the series that they come from, > h
      integer(int64), intent(in) :: n
      !> Parameters fitted before, >= 0
      integer, intent(in) :: fitted
      !> The correlation
      type(correlation_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Present pairs at each lag: [0:h]
      integer(int64), intent(in) :: pairs(0:)
      type(ljung_box_type) :: whole
      integer :: h, stat

      call ljung_box_of(r, n, fitted, whole, error, pairs)
      if (allocated(error)) return
      h = ubound(r, 1)
      allocate (result%acf(0:h), stat=stat)
      if (stat == 0) allocate (result%pacf(0:h), stat=stat)
      if (stat == 0) allocate (result%pairs(0:h), stat=stat)
      if (stat == 0) allocate (result%limit(0:h), stat=stat)
      if (stat == 0) allocate (result%bartlett(0:h), stat=stat)
      if (stat == 0) allocate (result%ljung_box(0:h), stat=stat)
      if (stat == 0) allocate (result%ljung_box_p(0:h), stat=stat)
      call check_memory(stat, "the correlation at every lag", error)
      if (allocated(error)) return
      result%lags = h
      result%samples = n
      result%fitted = fitted
      result%variance = r(0)
      result%largest_rho = whole%largest_rho
      result%largest_lag = whole%largest_lag
      result%pairs(:) = pairs
      result%acf(:) = r/r(0)
      result%observations = result%pairs(0)
      call set_limits_and_tests(result)
      call partial_autocorrelation(result%acf, result%pacf, result%partial_lags, stat)
      call check_memory(stat, "the partial autocorrelation", error)
   end subroutine correlation_of

   !> Limits of the autocorrelation: the mean over m_k pairs has the variance 1/m_k, and acf has the
   !> factor (n-k)/n. Ljung-Box statistic at every lag; weights as in [[ljung_box_of]].
   subroutine set_limits_and_tests(result)
      type(correlation_type), intent(inout) :: result
      real(dp) :: n, used, share, weight, rho, bartlett
      integer :: k

      result%limit(0) = 0.0_dp
      result%bartlett(0) = 0.0_dp
      result%ljung_box(0) = 0.0_dp
      result%ljung_box_p = 1.0_dp
      bartlett = 1.0_dp
      n = real(result%samples, dp)
      used = real(result%observations, dp)
      do k = 1, result%lags
         rho = result%acf(k)
         share = (n - real(k, dp))/n/real(max(result%pairs(k), 1_int64), dp)
         result%limit(k) = normal_95*sqrt(share)
         result%bartlett(k) = normal_95*sqrt(share*bartlett)
         bartlett = bartlett + 2.0_dp*rho**2
         weight = real(result%pairs(k), dp)*(n/(n - real(k, dp)))
         result%ljung_box(k) = result%ljung_box(k - 1) &
            & + weight*(n/(n - real(k, dp)))*rho*rho*((used + 2.0_dp)/used)
         if (k > result%fitted) result%ljung_box_p(k) = chi_square_survival(result%ljung_box(k), &
            & real(k - result%fitted, dp))
      end do
   end subroutine set_limits_and_tests

   !> Reflection coefficients of Levinson's recursion ([[solve_levinson]]) in memory O(h).
   pure subroutine partial_autocorrelation(rho, pacf, known, stat)
      real(dp), intent(in), contiguous :: rho(0:)
      real(dp), intent(out), contiguous :: pacf(0:)
      !> Lags up to which the recursion went
      integer, intent(out) :: known, stat
      real(dp), allocatable :: phi(:)
      real(dp) :: variance, reflection
      integer :: m

      pacf(:) = 0.0_dp
      pacf(0) = 1.0_dp
      known = 0
      allocate (phi(ubound(rho, 1)), stat=stat)
      if (stat /= 0) return
      variance = 1.0_dp
      do m = 1, ubound(rho, 1)
         reflection = (rho(m) - dot_product(phi(:m - 1), rho(m - 1:1:-1)))/variance
         variance = variance*((1.0_dp - reflection)*(1.0_dp + reflection))
         if (variance <= epsilon(variance)) return
         phi(:m - 1) = phi(:m - 1) - reflection*phi(m - 1:1:-1)
         phi(m) = reflection
         pacf(m) = reflection
         known = m
      end do
   end subroutine partial_autocorrelation

end module gyroakf_stats_correlation
