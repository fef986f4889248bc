! SPDX-License-Identifier: MIT
!> What the fit of an ARMA model is asked for and what it returns, and the criteria that compare such models.
!>
!> With K = p + q + 2 parameters (coefficients, mean, sigma^2) and n samples:
!>
!> | criterion | form |
!> |---|---|
!> | AIC  | -2 ln L + 2 K |
!> | AICc | -2 ln L + 2 K n/(n - K - 1) |
!> | BIC  | -2 ln L + K ln n |
!> | HQIC | -2 ln L + 2 K ln ln n |
!> | FPE  | sigma^2 (n + K - 1)/(n - K + 1) |
!>
!> as in [[gyroakf_ar_criteria]], but with the exact likelihood.
module gyroakf_ar_arma_result
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : text_type
   use gyroakf_ar_roots, only : ar_root_type
   use gyroakf_series_normality, only : jarque_bera_type
   use gyroakf_series_whiteness, only : ljung_box_type
   implicit none (type, external)
   private
   public :: arma_options, arma_order_type, arma_drift_type, arma_model_type, arma_criteria, best_line

   !> How to fit
   type :: arma_options
      !> Orders, 0 .. 3; -1: chosen by the criterion
      integer :: p = -1, q = -1
      !> Largest orders compared, 0 .. 3
      integer :: max_p = 3, max_q = 3
      !> "aic", "aicc", "bic", "hqic" or "fpe"
      character(8) :: criterion = "bic"
      !> Of a longer series the middle part of so many samples is used, >= 1000; orders are compared on a quarter of them in its
      !> middle. With more than one gap in 256 samples both are a quarter
      integer(int64) :: max_samples = 131072
   end type arma_options

   !> A line of the order table
   type :: arma_order_type
      !> Orders
      integer :: p = 0, q = 0
      !> ln L at its largest, and sigma^2
      real(dp) :: log_likelihood = 0.0_dp, noise_variance = 0.0_dp
      !> Criteria; the smaller the better
      real(dp) :: aic = 0.0_dp, aicc = 0.0_dp, bic = 0.0_dp, hqic = 0.0_dp, fpe = 0.0_dp
      !> The search converged, away from the edge of the invertible models: the orders may be chosen
      logical :: usable = .true.
   end type arma_order_type

   !> The drift in white noise that an ARMA(1, 1) or AR(1) with positive phi is
   type :: arma_drift_type
      !> The model is one: -phi < theta <= 0 < phi
      logical :: found = .false.
      !> Correlation time -1/ln(phi) in samples; standard deviations of the drift and of the white noise
      real(dp) :: time_constant = 0.0_dp, drift_std = 0.0_dp, white_std = 0.0_dp
      !> Their standard errors, 0 where those of the model are not known
      real(dp) :: time_error = 0.0_dp, drift_error = 0.0_dp, white_error = 0.0_dp
   end type arma_drift_type

   !> x_t - mean = sum phi_i (x_(t-i) - mean) + e_t + sum theta_j e_(t-j)
   type :: arma_model_type
      !> What chose the orders
      character(8) :: criterion = "bic"
      !> Orders
      integer :: p = 0, q = 0
      !> Coefficients and their standard errors: [p], [q]
      real(dp), allocatable :: phi(:), phi_error(:), theta(:), theta_error(:)
      !> Mean, its standard error, variance sigma^2 of e
      real(dp) :: mean = 0.0_dp, mean_error = 0.0_dp, noise_variance = 0.0_dp
      !> ln L and the criteria, of the samples used
      type(arma_order_type) :: fit
      !> The information matrix is regular; otherwise all errors are 0
      logical :: errors_known = .false.
      !> The gradient of the likelihood is small
      logical :: converged = .false.
      !> Present samples used; the part they are from: its first sample (from 1) and its length
      integer(int64) :: samples = 0, first = 1, length = 0
      !> Not the whole series was used
      logical :: partial = .false.
      !> Samples of the part on which the orders were compared
      integer(int64) :: compared_length = 0
      !> Orders compared: [number], p + q growing, ln L to 0.01; no line where they were given
      type(arma_order_type), allocatable :: table(:)
      !> Roots of both polynomials, inside the unit circle: [p], [q]
      type(ar_root_type), allocatable :: ar_root(:), ma_root(:)
      !> Tests of the standardised innovations; lags 0: not made
      type(ljung_box_type) :: residual_ljung_box
      type(jarque_bera_type) :: residual_jarque_bera
      !> The drift that it is
      type(arma_drift_type) :: drift
      !> Iterations and evaluations of the likelihood
      integer :: iterations = 0, evaluations = 0
      !> What to know before it is used, one sentence each
      type(text_type), allocatable :: warnings(:)
   end type arma_model_type

contains

   !> All criteria of a model.
   elemental type(arma_order_type) function arma_criteria(p, q, log_likelihood, noise_variance, n) result(line)
      !> Orders
      integer, intent(in) :: p, q
      !> ln L and sigma^2
      real(dp), intent(in) :: log_likelihood, noise_variance
      !> Samples, > p + q + 3
      integer(int64), intent(in) :: n
      real(dp) :: m, k

      m = real(n, dp)
      k = real(p + q + 2, dp)
      line%p = p
      line%q = q
      line%log_likelihood = log_likelihood
      line%noise_variance = noise_variance
      line%aic = -2.0_dp*log_likelihood + 2.0_dp*k
      line%aicc = -2.0_dp*log_likelihood + 2.0_dp*k*(m/(m - k - 1.0_dp))
      line%bic = -2.0_dp*log_likelihood + k*log(m)
      line%hqic = -2.0_dp*log_likelihood + 2.0_dp*k*log(log(m))
      line%fpe = noise_variance*((m + k - 1.0_dp)/(m - k + 1.0_dp))
   end function arma_criteria

   !> The usable line with the smallest criterion, the first where two agree; the first line where none is usable.
   pure integer function best_line(table, criterion)
      !> The lines
      type(arma_order_type), intent(in) :: table(:)
      !> 1 aic, 2 aicc, 3 bic, 4 hqic, else fpe
      integer, intent(in) :: criterion
      real(dp) :: value(size(table))

      select case (criterion)
      case (1); value = table%aic
      case (2); value = table%aicc
      case (3); value = table%bic
      case (4); value = table%hqic
      case default; value = table%fpe
      end select
      best_line = max(minloc(value, dim=1, mask=table%usable), 1)
   end function best_line

end module gyroakf_ar_arma_result
