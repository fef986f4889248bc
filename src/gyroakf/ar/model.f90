! SPDX-License-Identifier: MIT
!> AR(p) model of a series: orders compared, one chosen, with its uncertainty; its spectrum.
module gyroakf_ar_model
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_stats_autocovariance, only : autocovariance_type, compute_autocovariance, find_level
   use gyroakf_stats_lagged_gram, only : gram_type, build_gram
   use gyroakf_stats_trend, only : trend_type
   use gyroakf_ar_burg, only : burg_type, compute_burg
   use gyroakf_ar_least_squares, only : compare_orders, fit_order, fitted_order_type
   use gyroakf_ar_levinson, only : solve_levinson
   use gyroakf_ar_residuals, only : analyze_residuals
   use gyroakf_ar_roots, only : find_ar_roots, largest_modulus
   use gyroakf_ar_ar_types, only : ar_options, ar_model_type, ar_order_type, check_options, &
      & check_length, order_criteria, criterion_number, best_order
   use gyroakf_stats_moments, only : moments_type
   use gyroakf_stats_normality, only : test_jarque_bera
   use gyroakf_stats_whiteness, only : ljung_box_of
   implicit none (type, external)
   private
   public :: ar_options, ar_order_type, ar_model_type, fit_ar, ar_spectrum

   real(dp), parameter :: two_pi = 6.283185307179586476925286766559_dp

contains

   !> Fits AR models of the orders 0 .. max_order and chooses one.
   !>
   !> | method | coefficients | noise variance | n of the criteria | missing samples |
   !> |---|---|---|---|---|
   !> | yw | [[solve_levinson]] | r_0 prod (1 - k^2) | present samples | every present pair |
   !> | burg | [[compute_burg]] | r_0 prod (1 - k^2) | present samples | stretches of samples |
   !> | ols | x_t on 1, x_(t-1) .. x_(t-p) | RSS/rows | rows of the largest order | complete rows |
   !>
   !> With ols the order that is taken is fitted again to all rows that it has. Standard errors are
   !> the square roots of the diagonal of $$\frac{s_p^2}{n} R_p^{-1},$$ R_p the Toeplitz matrix of
   !> the autocovariances r_0 .. r_(p-1) (burg: those of the model), with gaps n the length times
   !> the smallest share of pairs that is present at the lags 0 .. p (burg: of rows); with ols the
   !> matrix of the normal equations, over its rows, takes the place of R_p. The variance in them
   !> has the divisor n, without a correction for the parameters: `unbiased_variance` has that. yw
   !> without gaps and burg are always stationary, a model by ols is mostly. The residuals are
   !> tested in a pass of their own, without being stored. Source: Brockwell & Davis, Time Series:
   !> Theory and Methods (1991), 8.1, 8.2; Marple, Digital Spectral Analysis (1987), chapter 8.
   subroutine fit_ar(x, options, model, error, valid, shared, progress)
      !> Series: [n], finite, n > order + 3 (ols: so many rows); not modified
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(ar_options), intent(in) :: options
      !> The model
      type(ar_model_type), intent(out) :: model
      !> invalid_argument, too_few_samples, constant_input, singular, non_finite, no_memory,
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Autocovariances that a pass has filled, taken where they reach far enough
      type(autocovariance_type), intent(in), optional :: shared
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      type(trend_type) :: level
      real(dp) :: constant, n
      integer :: most, lags

      call check_options(options, most, error)
      if (allocated(error)) return
      call check_length(size(x, kind=int64), most, "samples", error)
      if (allocated(error)) return
      lags = merge(most, 0, options%method == "yw")
      if (present(shared)) then
         if (allocated(shared%r) .and. shared%max_lag >= lags) then
            allocate (r(0:lags), source=shared%r(0:lags))
            allocate (pairs(0:lags), source=shared%pairs(0:lags))
            model%mean = shared%mean
         end if
      end if
      if (.not. allocated(r)) call compute_autocovariance(x, lags, model%mean, r, error, valid, &
         & pairs, progress)
      if (allocated(error)) return
      model%samples = pairs(0)
      model%variance = r(0)
      constant = 0.0_dp
      if (options%method /= "ols") call check_length(model%samples, most, "samples", error)
      if (allocated(error)) return
      if (options%method /= "yw") call find_level(x, level, model%samples, error, valid)
      if (allocated(error)) return
      select case (options%method)
      case ("yw")
         call model_of(r, size(x, kind=int64), pairs, options, model, error)
      case ("burg")
         call fit_burg(x, level, most, options, model, error, valid, progress)
      case default
         call fit_least_squares(x, level, most, options, model, constant, error, valid, progress)
      end select
      if (allocated(error)) return
      n = real(model%rows, dp)
      model%unbiased_variance = model%noise_variance*(n/(n - real(model%order + 1, dp)))
      if (model%method /= "ols") model%intercept = model%mean*(1.0_dp - sum(model%coefficient))
      call find_ar_roots(model%coefficient, model%root, error)
      if (allocated(error)) return
      model%stationary = largest_modulus(model%root) < 1.0_dp
      call test_residuals(x, constant, model, error, valid, progress)
   end subroutine fit_ar

   !> The model from autocovariances.
   subroutine model_of(r, n, pairs, options, model, error)
      !> Autocovariances of the lags up to the largest order, and present pairs
      real(dp), intent(in) :: r(0:)
      integer(int64), intent(in) :: n, pairs(0:)
      type(ar_options), intent(in) :: options
      type(ar_model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: phi(:, :), variance(:)
      real(dp) :: length
      integer :: k
      character(160) :: text

      k = findloc(pairs, 0_int64, 1) - 1
      if (k >= 0) then                               ! nothing is known of that autocovariance
         write (text, "(2(a, i0), a)") "the gaps leave no two samples ", k, " apart for AR(", &
            & ubound(pairs, 1), "): try a lower order, or another method"
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      call solve_levinson(r, phi, variance, error)
      if (allocated(error)) return
      call take_order(variance, phi, options, model)
      model%residual_variance = model%noise_variance
      length = real(n, dp)        ! of a series without gaps that would determine them as well
      do k = 0, model%order
         length = min(length, real(n, dp)*real(pairs(k), dp)/real(n - k, dp))
      end do
      call standard_errors(r, model%noise_variance/length, model, error)
   end subroutine model_of

   !> The model by Burg's recursion.
   subroutine fit_burg(x, level, most, options, model, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: level
      integer, intent(in) :: most
      type(ar_options), intent(in) :: options
      type(ar_model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(burg_type) :: burg
      real(dp) :: n, share

      call compute_burg(x, level, most, burg, error, valid, progress)
      if (allocated(error)) return
      call take_order(burg%variance, burg%phi, options, model)
      model%residual_variance = burg%residual_variance(model%order)
      n = real(size(x, kind=int64), dp)
      share = real(burg%rows(model%order), dp)/(n - real(model%order, dp))
      call standard_errors(burg%r, model%noise_variance/(n*share), model, error)
   end subroutine fit_burg

   !> The model by least squares.
   subroutine fit_least_squares(x, level, most, options, model, constant, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: level
      integer, intent(in) :: most
      type(ar_options), intent(in) :: options
      type(ar_model_type), intent(inout) :: model
      !> Of the regression of the series about its mean
      real(dp), intent(out) :: constant
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(gram_type) :: gram
      type(fitted_order_type) :: fit
      real(dp), allocatable :: variance(:)

      constant = 0.0_dp
      call build_gram(x, level, 1, 0, most, gram, error, valid, progress=progress)
      if (.not. allocated(error)) call check_length(gram%rows, most, &
         & "complete rows (order + 1 samples without a gap)", error)
      if (.not. allocated(error)) call compare_orders(gram, variance, error)
      if (allocated(error)) return
      call choose_order(variance, gram%rows, options, model)
      call fit_order(x, level, model%order, gram, fit, error, valid, progress)
      if (allocated(error)) return
      model%coefficient = fit%phi
      model%rows = fit%rows
      model%noise_variance = fit%variance
      model%residual_variance = fit%variance
      model%std_error = sqrt(fit%variance)*fit%spread
      constant = fit%constant
      model%intercept = constant + (level%legendre(0) + level%remainder)*(1.0_dp - sum(fit%phi))
      model%intercept_std_error = sqrt(fit%variance)*fit%intercept_spread
   end subroutine fit_least_squares

   !> The order that is taken from the models of all orders.
   subroutine take_order(variance, phi, options, model)
      !> Of the orders 0, 1, ...; their coefficients in the columns 1, 2, ...
      real(dp), intent(in) :: variance(0:), phi(:, :)
      type(ar_options), intent(in) :: options
      type(ar_model_type), intent(inout) :: model

      call choose_order(variance, model%samples, options, model)
      allocate (model%coefficient(model%order))
      if (model%order > 0) model%coefficient = phi(:model%order, model%order)
      model%noise_variance = variance(model%order)
      model%rows = model%samples
   end subroutine take_order

   !> The table of the orders, and the one that is taken.
   subroutine choose_order(variance, n, options, model)
      real(dp), intent(in) :: variance(0:)
      integer(int64), intent(in) :: n
      type(ar_options), intent(in) :: options
      type(ar_model_type), intent(inout) :: model
      integer :: k, most

      most = ubound(variance, 1)
      model%table = [(order_criteria(k, variance(k), n), k=0, most)]
      model%compared_rows = n
      model%method = options%method
      model%criterion = options%criterion
      model%order = options%order
      if (options%order >= 0) return
      model%order = best_order(model%table, criterion_number(trim(options%criterion)))
      model%largest_order_chosen = most > 0 .and. model%order == most
   end subroutine choose_order

   !> Square roots of the diagonal of factor R^-1.
   subroutine standard_errors(r, factor, model, error)
      real(dp), intent(in) :: r(0:), factor
      type(ar_model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: a(:, :)
      integer :: i, j, p, info

      p = model%order
      allocate (model%std_error(p))
      allocate (a(p, p), stat=info)
      call check_memory(info, "the standard errors", error)
      if (allocated(error)) return
      do j = 1, p
         a(:j, j) = r(j - 1:0:-1)/r(0)
      end do
      if (p > 0) call dpotrf("U", p, a, p, info)
      if (p > 0 .and. info == 0) call dpotri("U", p, a, p, info)
      if (info /= 0) call fatal_error(error, status%singular, &
         & "the autocovariance matrix is singular, there are no standard errors")
      if (allocated(error)) return
      do i = 1, p
         model%std_error(i) = sqrt(factor/r(0)*a(i, i))
      end do
   end subroutine standard_errors

   !> Whiteness and normality of the residuals, unless these are too few or constant.
   subroutine test_residuals(x, constant, model, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: constant
      type(ar_model_type), intent(inout) :: model
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      type(moments_type) :: moments
      integer(int64) :: n
      integer :: lags
      type(error_type), allocatable :: untested

      n = size(x, kind=int64) - model%order
      lags = int(min(int(merge(model%order + 20, 20, model%order >= 20), int64), n - 1))
      if (lags < 0) return
      call analyze_residuals(x, model%mean, model%coefficient, constant, lags, r, pairs, moments, &
         & untested, valid, progress)
      if (allocated(untested)) then
         if (untested%code == status%cancelled) call move_alloc(untested, error)
         return
      end if
      call test_jarque_bera(moments, model%residual_normality, untested)
      if (lags > model%order) call ljung_box_of(r, n, model%order, model%residual_ljung_box, &
         & untested, pairs)
   end subroutine test_residuals

   !> Two-sided power spectral density of a model at a frequency.
   !>
   !> $$S(f) = \frac{s_p^2\,\Delta}{\bigl|1 - \sum_j \phi_j e^{-2\pi i f j \Delta}\bigr|^2}, \quad
   !> \int_{-1/(2\Delta)}^{1/(2\Delta)} S(f)\,df = \mathrm{Var}(x)$$ so that white noise of density
   !> N^2 has S = N^2; a one-sided density is twice this. Of a model that is not stationary the
   !> formula has no such meaning. Source: Marple, Digital Spectral Analysis (1987), 6.3.
   elemental real(dp) function ar_spectrum(model, frequency, interval) result(density)
      !> Fitted; u its unit
      type(ar_model_type), intent(in) :: model
      !> f in 1/s, any: the density has the period 1/interval and is even
      real(dp), intent(in) :: frequency
      !> Sample interval in s, > 0; 1 for a frequency in cycles a sample
      real(dp), intent(in) :: interval
      complex(dp) :: z, filter
      integer :: j

      filter = (0.0_dp, 0.0_dp)
      z = exp(cmplx(0.0_dp, -two_pi*modulo(frequency*interval, 1.0_dp), dp))
      do j = model%order, 1, -1
         filter = (filter + model%coefficient(j))*z
      end do
      filter = 1.0_dp - filter
      density = huge(density)
      if (abs(filter) <= sqrt(tiny(density))) return
      density = model%noise_variance*interval/(real(filter, dp)**2 + aimag(filter)**2)
   end function ar_spectrum

end module gyroakf_ar_model
