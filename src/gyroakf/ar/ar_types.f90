! SPDX-License-Identifier: MIT
!> What an AR fit is asked for and what it returns.
module gyroakf_ar_ar_types
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_criteria, only : ar_order_type, criterion_number
   use gyroakf_ar_roots, only : ar_root_type
   use gyroakf_stats_correlation, only : correlation_type
   use gyroakf_stats_normality, only : jarque_bera_type
   use gyroakf_stats_whiteness, only : ljung_box_type
   implicit none (type, external)
   private
   public :: ar_options, ar_model_type, check_options, check_length

   !> How the model is found
   type :: ar_options
      !> `yw`: Yule-Walker by Levinson's recursion; `burg`: Burg's recursion; `ols`: least squares
      !> ("covariance"), with intercept
      character(4) :: method = "yw"
      !> aic, aicc, bic, hqic, fpe (formulas in gyroakf_ar_criteria)
      character(4) :: criterion = "aic"
      !> Orders 0 .. max_order are compared
      integer :: max_order = 3
      !> Order; -1: chosen by the criterion
      integer :: order = -1
   end type ar_options

   !> The model $$x_t - m = \sum_j \phi_j (x_{t-j} - m) + a_t$$ of a series in the unit u; ols has
   !> the intercept instead, $$x_t = c + \sum_j \phi_j x_{t-j} + a_t$$
   type :: ar_model_type
      !> What was used
      character(4) :: method = "yw", criterion = "aic"
      !> Order p
      integer :: order = 0
      !> Present samples
      integer(int64) :: samples = 0
      !> Coefficients phi and their standard errors: [order]
      real(dp), allocatable :: coefficient(:), std_error(:)
      !> Innovation variance, u^2; mean, u; variance r(0) of the series (divisor n), u^2
      real(dp) :: noise_variance = 0.0_dp, mean = 0.0_dp, variance = 0.0_dp
      !> Orders compared: [max_order + 1], order 0 first
      type(ar_order_type), allocatable :: table(:)
      !> Whiteness of the residuals: 20 lags, or order + 20 from order 20 on, fewer where the series
      !> is short; its lags are 0 where it could not be made
      type(ljung_box_type) :: residual_ljung_box
      !> Their autocorrelation at these lags; its lags are 0 where there is none
      type(correlation_type) :: residual_correlation
      !> The criterion chose the largest order on offer: look at larger ones
      logical :: largest_order_chosen = .false.
      !> Intercept c, u: m (1 - sum phi), with ols the fitted one; its standard error, ols only
      real(dp) :: intercept = 0.0_dp, intercept_std_error = 0.0_dp
      !> Samples that the coefficients rest on: with ols the rows (an x_t whose p predecessors are
      !> present), else those present
      integer(int64) :: rows = 0
      !> Samples that the criteria count: with ols the rows that the largest order has
      integer(int64) :: compared_rows = 0
      !> Variance that allows for the p coefficients and the mean, u^2: noise_variance rows/(rows -
      !> p - 1). Standard errors with it instead of noise_variance are larger by the root of that
      !> ratio
      real(dp) :: unbiased_variance = 0.0_dp
      !> Mean square of the residuals, u^2; burg: both forward and backward; yw: noise_variance
      real(dp) :: residual_variance = 0.0_dp
      !> Roots of the characteristic polynomial, largest modulus first: [order]
      type(ar_root_type), allocatable :: root(:)
      !> All roots lie within the unit circle; with ols that is not certain
      logical :: stationary = .true.
      !> Normality of the residuals; its kurtosis is 0 where it could not be tested
      type(jarque_bera_type) :: residual_normality
   end type ar_model_type

contains

   !> Refuses options out of range.
   subroutine check_options(options, most, error)
      !> The options
      type(ar_options), intent(in) :: options
      !> Largest order that is fitted
      integer, intent(out) :: most
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      most = max(options%max_order, options%order)
      if (.not. any(options%method == [character(4) :: "yw", "burg", "ols"])) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown AR method '"//trim(options%method)//"'; there are yw, burg, ols")
      else if (criterion_number(trim(options%criterion)) == 0) then
         call fatal_error(error, status%invalid_argument, "unknown AR criterion '" &
            & //trim(options%criterion)//"'; there are aic, aicc, bic, hqic, fpe")
      else if (options%max_order < 0 .or. options%order < -1) then
         call fatal_error(error, status%invalid_argument, &
            & "the AR order must not be negative; -1 chooses it")
      end if
   end subroutine check_options

   !> Refuses a series too short for an order.
   subroutine check_length(n, most, what, error)
      !> How many there are
      integer(int64), intent(in) :: n
      !> Largest order
      integer, intent(in) :: most
      !> Of what: "samples"
      character(*), intent(in) :: what
      !> too_few_samples
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      if (n > int(most, int64) + 3) return
      write (text, "(2(a, i0), 3a, i0)") "AR order ", most, " needs at least ", &
         & int(most, int64) + 4, " ", what, ", there are ", n
      call fatal_error(error, status%too_few_samples, trim(text))
   end subroutine check_length

end module gyroakf_ar_ar_types
