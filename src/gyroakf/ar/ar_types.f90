! SPDX-License-Identifier: MIT
!> What an AR fit is asked for and what it returns, and the criteria that compare its orders.
!>
!> With s2 the innovation variance of order p, n samples and k = p + 1 parameters of the mean
!> (coefficients and mean value), $$\ln L = -\frac n2(\ln 2\pi + \ln s^2 + 1):$$
!>
!> | criterion | form |
!> |---|---|
!> | AIC  | -2 ln L + 2 (k + 1) |
!> | AICc | -2 ln L + 2 (k + 1) n/(n - k - 2) |
!> | BIC  | -2 ln L + (k + 1) ln n |
!> | HQIC | -2 ln L + 2 (k + 1) ln ln n |
!> | FPE  | s2 (n + k)/(n - k) |
!> | AIC per observation | 1 + ln 2 pi + ln s2 + 2 p/n |
!>
!> k + 1 counts the innovation variance, as statsmodels' AutoReg does; every order uses the same n,
!> so that differences are comparable with any other convention. The last line is the form of the
!> paper's Table I, which counts the coefficients alone. Sources: Akaike, IEEE Trans. Autom. Control
!> 19 (1974) 716-723; Hurvich & Tsai, Biometrika 76 (1989) 297-307; Schwarz, Ann. Stat. 6 (1978)
!> 461-464; Hannan & Quinn, J. R. Stat. Soc. B 41 (1979) 190-195.
module gyroakf_ar_ar_types
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_roots, only : ar_root_type
   use gyroakf_stats_normality, only : jarque_bera_type
   use gyroakf_stats_whiteness, only : ljung_box_type
   implicit none (type, external)
   private
   public :: ar_options, ar_model_type, check_options, check_length
   public :: ar_order_type, order_criteria, criterion_number, best_order

   !> How the model is found
   type :: ar_options
      !> `yw`: Yule-Walker; `burg`: Burg's recursion; `ols`: least squares, with intercept
      character(4) :: method = "yw"
      !> aic, aicc, bic, hqic, fpe (formulas in this module)
      character(4) :: criterion = "aic"
      !> Orders 0 .. max_order are compared
      integer :: max_order = 3
      !> Order; -1: chosen by the criterion
      integer :: order = -1
   end type ar_options

   !> A line of the order table
   type :: ar_order_type
      !> Order p
      integer :: order = 0
      !> Innovation variance s2
      real(dp) :: noise_variance = 0.0_dp
      !> Criteria; the smaller the better
      real(dp) :: aic = 0.0_dp, aicc = 0.0_dp, bic = 0.0_dp, hqic = 0.0_dp, fpe = 0.0_dp
      !> AIC per observation, as in the paper
      real(dp) :: aic_per_observation = 0.0_dp
   end type ar_order_type

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
      !> The criterion chose the largest order on offer: look at larger ones
      logical :: largest_order_chosen = .false.
      !> Intercept c, u: m (1 - sum phi), with ols the fitted one; its standard error, ols only
      real(dp) :: intercept = 0.0_dp, intercept_std_error = 0.0_dp
      !> Samples that the coefficients rest on: with ols the complete rows, else those present
      integer(int64) :: rows = 0
      !> Samples that the criteria count: with ols the rows that the largest order has
      integer(int64) :: compared_rows = 0
      !> Variance that allows for the p coefficients and the mean, u^2: noise_variance rows/(rows -
      !> p - 1); standard errors with it are larger by the root of that ratio
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

   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp

   character(4), parameter :: names(5) = [character(4) :: "aic", "aicc", "bic", "hqic", "fpe"]

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

   !> All criteria of one order.
   elemental type(ar_order_type) function order_criteria(order, noise_variance, n) result(line)
      !> Order p >= 0
      integer, intent(in) :: order
      !> Innovation variance > 0
      real(dp), intent(in) :: noise_variance
      !> Samples, > p + 3
      integer(int64), intent(in) :: n
      real(dp) :: m, k, minus_two_l

      m = real(n, dp)
      k = real(order + 1, dp)
      minus_two_l = m*(log_two_pi + log(noise_variance) + 1.0_dp)
      line%order = order
      line%noise_variance = noise_variance
      line%aic = minus_two_l + 2.0_dp*(k + 1.0_dp)
      line%aicc = minus_two_l + 2.0_dp*(k + 1.0_dp)*(m/(m - k - 2.0_dp))
      line%bic = minus_two_l + (k + 1.0_dp)*log(m)
      line%hqic = minus_two_l + 2.0_dp*(k + 1.0_dp)*log(log(m))
      line%fpe = noise_variance*((m + k)/(m - k))
      line%aic_per_observation = 1.0_dp + log_two_pi + log(noise_variance) &
         & + 2.0_dp*real(order, dp)/m
   end function order_criteria

   !> 1 aic, 2 aicc, 3 bic, 4 hqic, 5 fpe; 0 unknown.
   pure integer function criterion_number(criterion)
      !> Its name
      character(*), intent(in) :: criterion

      criterion_number = findloc(names == criterion, .true., 1)
   end function criterion_number

   !> Order with the smallest value, the smaller one where two agree.
   pure integer function best_order(table, criterion)
      !> Orders 0, 1, ...
      type(ar_order_type), intent(in) :: table(:)
      !> 1 .. 5, see criterion_number
      integer, intent(in) :: criterion
      real(dp) :: value(size(table))

      select case (criterion)
      case (1); value = table%aic
      case (2); value = table%aicc
      case (3); value = table%bic
      case (4); value = table%hqic
      case default; value = table%fpe
      end select
      best_order = table(minloc(value, dim=1))%order
   end function best_order

end module gyroakf_ar_ar_types
