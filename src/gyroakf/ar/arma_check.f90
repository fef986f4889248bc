! SPDX-License-Identifier: MIT
!> What a fitted ARMA model is worth: errors, roots, residuals, the drift that it is, warnings.
module gyroakf_ar_arma_check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_record, only : add_text
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_series_moments, only : moments_type, compute_moments
   use gyroakf_series_normality, only : test_jarque_bera
   use gyroakf_series_whiteness, only : ljung_box_of
   use gyroakf_ar_autocovariance, only : compute_autocovariance
   use gyroakf_ar_roots, only : find_ar_roots
   use gyroakf_ar_arma_filter, only : arma_series_type
   use gyroakf_ar_arma_start, only : arma_as_drift
   use gyroakf_ar_arma_result, only : arma_model_type
   implicit none (type, external)
   private
   public :: invert_information, find_roots, check_residuals, find_drift, warn_of

   !> Twice the gain of likelihood below which two polynomials' common factor is taken for nothing: chi-square of 2 at 1 %
   real(dp), parameter :: little_gain = 9.21_dp
   !> Lags of the residuals' test
   integer, parameter :: most_lags = 20

contains

   !> Covariance matrix of the parameters; `known` is false where the information is singular.
   subroutine invert_information(information, covariance, known)
      !> Information: [k, k]
      real(dp), intent(in) :: information(:, :)
      !> Its inverse, 0 where it has none: [k, k]
      real(dp), intent(out) :: covariance(:, :)
      logical, intent(out) :: known
      real(dp) :: scale(size(information, 1))
      integer :: i, j, k, info

      k = size(information, 1)
      covariance(:, :) = 0.0_dp
      do i = 1, k
         scale(i) = information(i, i)
      end do
      known = all(scale > 0.0_dp)
      if (.not. known) return
      scale(:) = 1.0_dp/sqrt(scale)
      do j = 1, k
         covariance(:, j) = information(:, j)*scale*scale(j)
      end do
      call dpotrf("U", k, covariance, k, info)
      known = info == 0
      do i = 1, k
         if (covariance(i, i) <= 1.0e-7_dp) known = .false.
      end do
      if (known) call dpotri("U", k, covariance, k, info)
      if (.not. known) covariance(:, :) = 0.0_dp
      do j = 1, k
         do i = 1, j
            covariance(i, j) = covariance(i, j)*scale(i)*scale(j)
            covariance(j, i) = covariance(i, j)
         end do
      end do
   end subroutine invert_information

   !> Roots of both polynomials.
   subroutine find_roots(model)
      !> Coefficients are set
      type(arma_model_type), intent(inout) :: model
      type(error_type), allocatable :: error
      real(dp) :: minus_theta(model%q)

      minus_theta(:) = -model%theta
      call find_ar_roots(model%phi, model%ar_root, error)
      if (.not. allocated(model%ar_root)) allocate (model%ar_root(0))
      if (allocated(error)) deallocate (error)
      call find_ar_roots(minus_theta, model%ma_root, error)
      if (.not. allocated(model%ma_root)) allocate (model%ma_root(0))
   end subroutine find_roots

   !> Whiteness and normality of the standardised innovations; left out where there are too few.
   subroutine check_residuals(series, residual, model)
      !> For what is missing
      type(arma_series_type), intent(in) :: series
      !> Standardised innovations: [n]
      real(dp), intent(in), contiguous :: residual(:)
      !> Gets the tests
      type(arma_model_type), intent(inout) :: model
      type(error_type), allocatable :: error
      type(moments_type) :: moments
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean
      integer(int64) :: n
      integer :: lags

      n = size(residual, kind=int64)
      call compute_moments(residual, moments, series%valid)
      call test_jarque_bera(moments, model%residual_jarque_bera, error)
      if (allocated(error)) deallocate (error)
      lags = int(min(int(most_lags, int64), n/2 - 1))
      if (lags <= model%p + model%q) return
      call compute_autocovariance(residual, lags, mean, r, error, series%valid, pairs)
      if (allocated(error)) return
      if (allocated(series%valid)) then
         call ljung_box_of(r, n, model%p + model%q, model%residual_ljung_box, error, pairs)
      else
         call ljung_box_of(r, n, model%p + model%q, model%residual_ljung_box, error)
      end if
   end subroutine check_residuals

   !> The drift in white noise that the model is, with errors by propagation; that of sigma^2 is sigma^2 sqrt(2/n).
   subroutine find_drift(covariance, model)
      !> Of (phi, theta, mean): [k, k]
      real(dp), intent(in) :: covariance(:, :)
      !> Gets the drift
      type(arma_model_type), intent(inout) :: model
      real(dp) :: phi, theta, d, r, slope(2), white_slope(2), relative
      logical :: admissible

      if (model%p /= 1 .or. model%q > 1) return
      phi = model%phi(1)
      theta = 0.0_dp
      if (model%q == 1) theta = model%theta(1)
      call arma_as_drift(phi, theta, d, r, slope, white_slope, admissible)
      model%drift%found = admissible
      if (.not. admissible) return
      relative = 2.0_dp/real(model%samples, dp)
      model%drift%time_constant = -1.0_dp/log(phi)
      model%drift%drift_std = sqrt(d*model%noise_variance)
      model%drift%white_std = sqrt(r*model%noise_variance)
      if (.not. model%errors_known) return
      model%drift%time_error = model%phi_error(1)/(phi*log(phi)**2)
      model%drift%drift_error = 0.5_dp*model%drift%drift_std*sqrt(log_variance(slope/d) + relative)
      if (r > 0.0_dp) model%drift%white_error = 0.5_dp*model%drift%white_std*sqrt(log_variance(white_slope/r) + relative)

   contains

      !> Variance of a logarithm of that slope.
      pure real(dp) function log_variance(slope)
         real(dp), intent(in) :: slope(2)

         log_variance = slope(1)**2*covariance(1, 1)
         if (model%q == 1) log_variance = log_variance + 2.0_dp*slope(1)*slope(2)*covariance(1, 2) + slope(2)**2*covariance(2, 2)
      end function log_variance

   end subroutine find_drift

   !> What is odd about the model.
   subroutine warn_of(model, gain)
      !> Complete; gets its warnings
      type(arma_model_type), intent(inout) :: model
      !> Twice the logarithm of the likelihood over that of the model of orders p - 1 and q - 1; negative: not known
      real(dp), intent(in) :: gain
      character(200) :: text
      real(dp) :: edge

      if (.not. allocated(model%warnings)) allocate (model%warnings(0))
      if (.not. model%converged) call add_text(model%warnings, &
         "the search for the largest likelihood did not converge: the coefficients are the best found")
      if (gain >= 0.0_dp .and. gain < little_gain) then
         write (text, '("AR and MA polynomial have a factor nearly in common: ARMA(", i0, ",", i0, ") describes the series as well &
            &(2 ln L is lower by ", f0.2, ")")') model%p - 1, model%q - 1, gain
         call add_text(model%warnings, trim(text))
      end if
      edge = 1.0_dp - 2.0_dp/real(model%length, dp)
      if (outermost(model, .true.) > edge) call add_text(model%warnings, &
         "a root of the AR polynomial is at the unit circle: the series is not stationary, errors do not hold")
      if (outermost(model, .false.) > edge) call add_text(model%warnings, &
         "a root of the MA polynomial is at the unit circle: the series was differenced too often, or q is too large")
      if (.not. model%errors_known) call add_text(model%warnings, &
         "the information matrix is singular: there are no standard errors")
   end subroutine warn_of

   !> Largest modulus of a root.
   pure real(dp) function outermost(model, autoregressive)
      type(arma_model_type), intent(in) :: model
      logical, intent(in) :: autoregressive

      outermost = 0.0_dp
      if (autoregressive) then
         if (size(model%ar_root) > 0) outermost = maxval(model%ar_root%modulus)
      else
         if (size(model%ma_root) > 0) outermost = maxval(model%ma_root%modulus)
      end if
   end function outermost

end module gyroakf_ar_arma_check
