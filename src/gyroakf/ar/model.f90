! SPDX-License-Identifier: MIT
!> AR(p) model of a series: orders compared, one chosen, with its uncertainty.
module gyroakf_ar_model
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_ar_autocovariance, only : compute_autocovariance, residual_autocovariance
   use gyroakf_ar_criteria, only : ar_order_type, order_criteria, criterion_number, best_order
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_series_whiteness, only : ljung_box_type, ljung_box_of
   implicit none (type, external)
   private
   public :: ar_options, ar_order_type, ar_model_type, fit_ar, fit_ar_of, residual_lags

   !> How the model is found
   type :: ar_options
      !> yw: Yule-Walker by Levinson's recursion
      character(4) :: method = "yw"
      !> aic, aicc, bic, hqic, fpe (formulas in gyroakf_ar_criteria)
      character(4) :: criterion = "aic"
      !> Orders 0 .. max_order are compared
      integer :: max_order = 3
      !> Order; -1: chosen by the criterion
      integer :: order = -1
   end type ar_options

   !> The model $$x_t - m = \sum_j \phi_j (x_{t-j} - m) + a_t$$ of a series in the unit u
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
      !> Whiteness of the residuals: 20 lags, or order + 20 from order 20 on, fewer where the series is
      !> short; its lags are 0 where it could not be made
      type(ljung_box_type) :: residual_ljung_box
      !> The criterion chose the largest order on offer: look at larger ones
      logical :: largest_order_chosen = .false.
   end type ar_model_type

contains

   !> Fits AR models of the orders 0 .. max_order and chooses one.
   !>
   !> All orders come from one set of biased autocovariances (one pass) by the Levinson recursion and
   !> are compared with one n, the present samples. Standard errors are the square roots of the diagonal
   !> of $$\frac{s_p^2}{n} R_p^{-1},$$ R_p the Toeplitz matrix of r_0 .. r_(p-1); with gaps n is the length times
   !> the smallest share of pairs that is present at the lags 0 .. p. The residuals are tested in a second
   !> pass, without being stored. Without gaps the model is always stationary. Source: Brockwell & Davis,
   !> Time Series: Theory and Methods (1991), 8.1, 8.2.
   subroutine fit_ar(x, options, model, error, valid)
      !> Series: [n], finite, n > order + 3; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(ar_options), intent(in) :: options
      !> The model
      type(ar_model_type), intent(out) :: model
      !> invalid_argument, not_supported, too_few_samples, constant_input, singular, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      integer :: most

      call check_options(options, most, error)
      if (allocated(error)) return
      call check_length(size(x, kind=int64), most, error)
      if (allocated(error)) return
      call compute_autocovariance(x, most, model%mean, r, error, valid, pairs)
      if (allocated(error)) return
      call model_of(r, size(x, kind=int64), pairs, most, options, model, error)
      if (allocated(error)) return
      call test_residuals(x, model, valid)
   end subroutine fit_ar

   !> Fits AR models to autocovariances, for whoever accumulates them on the way; otherwise as [[fit_ar]].
   subroutine fit_ar_of(r, n, pairs, mean, options, model, error)
      !> Biased autocovariances: [0:max_order or order, whichever is larger, or more]
      real(dp), intent(in) :: r(0:)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Present pairs at each lag: as many as `r`
      integer(int64), intent(in) :: pairs(0:)
      !> Mean of the series
      real(dp), intent(in) :: mean
      !> How
      type(ar_options), intent(in) :: options
      !> The model; its residuals are not tested: see [[residual_lags]]
      type(ar_model_type), intent(out) :: model
      !> As of [[fit_ar]]
      type(error_type), allocatable, intent(out) :: error
      integer :: most

      call check_options(options, most, error)
      if (allocated(error)) return
      call check_length(n, most, error)
      if (allocated(error)) return
      model%mean = mean
      call model_of(r(0:most), n, pairs(0:most), most, options, model, error)
   end subroutine fit_ar_of

   !> The model from autocovariances.
   subroutine model_of(r, n, pairs, most, options, model, error)
      !> Autocovariances: [0:most]
      real(dp), intent(in) :: r(0:)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Present pairs: [0:most]
      integer(int64), intent(in) :: pairs(0:)
      !> Largest order
      integer, intent(in) :: most
      !> How
      type(ar_options), intent(in) :: options
      !> Its mean is set
      type(ar_model_type), intent(inout) :: model
      !> too_few_samples, constant_input, singular
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: phi(:, :), variance(:)
      integer :: k

      model%samples = pairs(0)
      call check_length(model%samples, most, error)
      if (allocated(error)) return
      call solve_levinson(r, phi, variance, error)
      if (allocated(error)) return
      allocate (model%table(most + 1))
      do k = 0, most
         model%table(k + 1) = order_criteria(k, variance(k), model%samples)
      end do
      model%method = options%method
      model%criterion = options%criterion
      model%order = options%order
      if (options%order < 0) then
         model%order = best_order(model%table, criterion_number(trim(options%criterion)))
         model%largest_order_chosen = most > 0 .and. model%order == most
      end if
      allocate (model%coefficient(model%order), model%std_error(model%order))
      if (model%order > 0) model%coefficient(:) = phi(:model%order, model%order)
      model%noise_variance = variance(model%order)
      model%variance = r(0)
      call standard_errors(r, model%noise_variance/effective_length(n, pairs(:model%order)), model%std_error, error)
   end subroutine model_of

   !> Refuses options out of range.
   subroutine check_options(options, most, error)
      !> The options
      type(ar_options), intent(in) :: options
      !> Largest order that is fitted
      integer, intent(out) :: most
      !> invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error

      most = max(options%max_order, options%order)
      if (options%method == "burg" .or. options%method == "ols") then
         call fatal_error(error, status%not_supported, &
            & "the AR method '"//trim(options%method)//"' is not part of this version; there is yw (Yule-Walker)")
      else if (options%method /= "yw") then
         call fatal_error(error, status%invalid_argument, &
            & "unknown AR method '"//trim(options%method)//"'; there is yw (Yule-Walker)")
      else if (criterion_number(trim(options%criterion)) == 0) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown AR criterion '"//trim(options%criterion)//"'; there are aic, aicc, bic, hqic, fpe")
      else if (options%max_order < 0 .or. options%order < -1) then
         call fatal_error(error, status%invalid_argument, "the AR order must not be negative; -1 chooses it")
      end if
   end subroutine check_options

   !> Refuses a series too short for an order.
   subroutine check_length(n, most, error)
      !> Samples
      integer(int64), intent(in) :: n
      !> Largest order
      integer, intent(in) :: most
      !> too_few_samples
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text

      if (n > int(most, int64) + 3) return
      write (text, '("AR order ", i0, " needs at least ", i0, " samples, there are ", i0)') most, int(most, int64) + 4, n
      call fatal_error(error, status%too_few_samples, trim(text))
   end subroutine check_length

   !> Length of a series without gaps that would determine the autocovariances as well.
   pure real(dp) function effective_length(n, pairs) result(length)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Present pairs at the lags 0 .. p, of n - k: [0:p]
      integer(int64), intent(in) :: pairs(0:)
      integer :: k

      length = real(n, dp)
      do k = 0, ubound(pairs, 1)
         length = min(length, real(n, dp)*real(pairs(k), dp)/real(n - k, dp))
      end do
   end function effective_length

   !> Square roots of the diagonal of factor R^-1.
   subroutine standard_errors(r, factor, std_error, error)
      !> Autocovariances: [0:]
      real(dp), intent(in) :: r(0:)
      !> Innovation variance over n
      real(dp), intent(in) :: factor
      !> The errors: [order]
      real(dp), intent(out) :: std_error(:)
      !> singular
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :)
      integer :: i, j, p, info

      p = size(std_error)
      info = 0
      allocate (a(p, p))
      do j = 1, p
         do i = 1, j
            a(i, j) = r(j - i)/r(0)
         end do
      end do
      if (p > 0) call dpotrf("U", p, a, p, info)
      if (p > 0 .and. info == 0) call dpotri("U", p, a, p, info)
      if (info /= 0) then
         call fatal_error(error, status%singular, "the autocovariance matrix is singular, there are no standard errors")
         return
      end if
      do i = 1, p
         std_error(i) = sqrt(factor/r(0)*a(i, i))
      end do
   end subroutine standard_errors

   !> Lags of the residuals' test; no test where they are not more than the order.
   pure integer function residual_lags(n, order) result(lags)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Order of the model
      integer, intent(in) :: order

      lags = 20
      if (order >= 20) lags = order + 20
      lags = int(min(int(lags, int64), n - order - 1))
   end function residual_lags

   !> Ljung-Box test of the residuals; left out where there are too few of them or they are constant.
   subroutine test_residuals(x, model, valid)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The model; its test is filled
      type(ar_model_type), intent(inout) :: model
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      integer(int64) :: n
      integer :: lags
      type(error_type), allocatable :: error

      n = size(x, kind=int64) - model%order
      lags = residual_lags(size(x, kind=int64), model%order)
      if (lags <= model%order) return
      call residual_autocovariance(x, model%mean, model%coefficient, lags, r, error, valid, pairs)
      if (allocated(error)) return
      if (present(valid)) then
         call ljung_box_of(r, n, model%order, model%residual_ljung_box, error, pairs)
      else
         call ljung_box_of(r, n, model%order, model%residual_ljung_box, error)
      end if
   end subroutine test_residuals

end module gyroakf_ar_model
