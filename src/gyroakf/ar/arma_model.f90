! SPDX-License-Identifier: MIT
!> ARMA(p, q) models, p, q <= 3, by the exact Gaussian likelihood, with the choice of the orders.
!>
!>     call fit_arma(x, arma_options(), model, error)
!>
!> A gyroscope whose drift is AR(1) under white noise is an ARMA(1, 1); a drift of p such terms an ARMA(p, p). A fit of AR models
!> alone takes many coefficients for either.
module gyroakf_ar_arma_model
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_ar_autocovariance, only : compute_autocovariance, series_mean
   use gyroakf_ar_criteria, only : criterion_number
   use gyroakf_filter_identification, only : drift_model_type, identify_drift
   use gyroakf_filter_progress_share, only : progress_share_type
   use gyroakf_ar_arma_state, only : arma_sums_type, most
   use gyroakf_ar_arma_filter, only : arma_series_type, sum_innovations
   use gyroakf_ar_arma_start, only : long_order
   use gyroakf_ar_arma_likelihood, only : log_likelihood_of, split_free, information_of
   use gyroakf_ar_arma_fit, only : arma_hint_type, arma_optimum_type, maximise_likelihood
   use gyroakf_ar_arma_orders, only : choose_orders
   use gyroakf_ar_arma_result, only : arma_options, arma_model_type, arma_criteria
   use gyroakf_ar_arma_check, only : invert_information, find_roots, check_residuals, find_drift, warn_of
   implicit none (type, external)
   private
   public :: fit_arma

   !> sigma^2 below this share of the variance is a perfect fit: what is left comes from the edge of the stationary models
   real(dp), parameter :: perfect = 1.0e-14_dp
   !> Where there is more than one gap in so many samples the part is shorter by the second number: after a gap the prediction
   !> goes sample by sample
   integer(int64), parameter :: rare_gap = 256, gap_share = 4

contains

   !> Fits an ARMA(p, q) model with a mean by its exact Gaussian likelihood.
   !>
   !> The start is the regression of Hannan and Rissanen (and others, [[gyroakf_ar_arma_fit]]), the end the maximum over all
   !> stationary and invertible models; missing samples are predicted over, not filled in. Standard errors are from the
   !> information matrix at the maximum ([[gyroakf_ar_arma_likelihood]]). Orders that are not given are chosen from all p <= max_p,
   !> q <= max_q by the criterion on one part of the series, then fitted to all of it. Source: A. C. Harvey (1989), 3.3, 3.4;
   !> P. J. Brockwell, R. A. Davis, Time Series: Theory and Methods (1991), 8.7.
   subroutine fit_arma(x, options, model, error, valid, progress)
      !> Series: [n], finite; not modified; of more than `max_samples` the middle part is used
      real(dp), intent(in), contiguous :: x(:)
      !> How
      type(arma_options), intent(in) :: options
      !> The model
      type(arma_model_type), intent(out) :: model
      !> invalid_argument, too_few_samples (20 + 4 (p + q) are needed), constant_input, singular (a perfect fit), non_finite,
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional, target :: progress
      class(progress_type), pointer :: listener
      type(arma_series_type) :: series
      type(arma_hint_type) :: hint
      type(arma_optimum_type) :: optimum
      real(dp), allocatable :: chosen(:)
      real(dp) :: centre(2), scale
      integer(int64) :: most_samples

      call check_options(options, error)
      if (allocated(error)) return
      model%criterion = options%criterion
      call tell_progress("ARMA model", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call take_series(x, options, model, most_samples, series, hint, centre, scale, error, valid, progress)
      if (.not. allocated(error)) call tell_progress("ARMA model", 0_int64, model%length, error, progress)
      if (allocated(error)) return
      model%p = options%p
      model%q = options%q
      if (options%p < 0 .or. options%q < 0) then
         call choose_orders(series, hint, options, most_samples, model, scale, chosen, error, progress)
         if (allocated(error)) return
      end if
      listener => null()
      if (present(progress)) listener => progress
      call maximise_likelihood(series, hint, model%p, model%q, optimum, .false., listener, error, chosen)
      if (.not. allocated(error)) call complete_model(series, hint, optimum, centre, scale, listener, model, error)
   end subroutine fit_arma

   !> Refuses options out of range.
   subroutine check_options(options, error)
      type(arma_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error

      if (any([options%p, options%q] < -1) .or. any([options%p, options%q, options%max_p, options%max_q] > most) &
          .or. min(options%max_p, options%max_q) < 0) then
         call fatal_error(error, status%invalid_argument, "the orders of an ARMA model are 0 .. 3; -1 chooses one")
      else if (criterion_number(trim(options%criterion)) == 0) then
         call fatal_error(error, status%invalid_argument, &
            & "unknown criterion '"//trim(options%criterion)//"'; there are aic, aicc, bic, hqic, fpe")
      else if (options%max_samples < 1000) then
         call fatal_error(error, status%invalid_argument, "an ARMA model is fitted to at least 1000 samples of a longer series")
      end if
   end subroutine check_options

   !> The part of the series that is used, centred and scaled by a power of 2, and what its autocovariances show.
   subroutine take_series(x, options, model, most_samples, series, hint, centre, scale, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(arma_options), intent(in) :: options
      !> Gets the samples used
      type(arma_model_type), intent(inout) :: model
      !> Samples that may be used
      integer(int64), intent(out) :: most_samples
      type(arma_series_type), intent(out) :: series
      type(arma_hint_type), intent(out) :: hint
      !> Subtracted one after the other, then divided by
      real(dp), intent(out) :: centre(2), scale
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: mean
      integer(int64) :: n, last
      integer :: lags, failed

      centre = 0.0_dp
      scale = 1.0_dp
      most_samples = options%max_samples
      n = size(x, kind=int64)
      if (present(valid)) then
         if (size(valid, kind=int64) /= n) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
            return
         end if
      end if
      if (present(valid)) then
         if (gaps(valid) > n/rare_gap) most_samples = max(most_samples/gap_share, 1000_int64)
      end if
      model%length = min(n, most_samples)
      model%partial = model%length < n
      model%first = (n - model%length)/2 + 1
      last = model%first + model%length - 1
      allocate (series%y(model%length), stat=failed)
      if (failed == 0 .and. present(valid)) allocate (series%valid(model%length), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the part of the series that an ARMA model is fitted to")
         return
      end if
      series%y(:) = x(model%first:last)
      if (present(valid)) series%valid(:) = valid(model%first:last)
      call series_mean(series%y, centre(1), centre(2), model%samples, series%valid)
      call check_length(model%samples, options, error)
      if (allocated(error)) return
      series%y(:) = (series%y - centre(1)) - centre(2)
      if (present(valid)) where (series%valid == 0_int8) series%y = 0.0_dp
      lags = int(min(int(long_order(real(model%samples, dp)) + most, int64), model%length - 1))
      call compute_autocovariance(series%y, lags, mean, hint%r, error, series%valid, progress=progress)
      if (allocated(error)) return
      if (hint%r(0) <= (16.0_dp*epsilon(mean)*max(abs(centre(1)), abs(centre(2))))**2) then
         call fatal_error(error, status%constant_input, "the series has no variance, no ARMA model describes it")
         return
      end if
      scale = 2.0_dp**exponent(sqrt(hint%r(0)))
      series%y(:) = series%y/scale
      hint%r(:) = hint%r/scale/scale
      hint%samples = real(model%samples, dp)
      call look_for_drift(series, hint)
   end subroutine take_series

   !> Runs of missing samples.
   pure integer(int64) function gaps(valid)
      integer(int8), intent(in) :: valid(:)
      integer(int64) :: t

      gaps = 0
      do t = 1, size(valid, kind=int64) - 1
         if (valid(t) == 0_int8 .and. valid(t + 1) /= 0_int8) gaps = gaps + 1
      end do
   end function gaps

   !> Refuses a series too short for the orders.
   subroutine check_length(samples, options, error)
      integer(int64), intent(in) :: samples
      type(arma_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      character(120) :: text
      integer :: p, q

      p = options%p
      q = options%q
      if (p < 0) p = options%max_p
      if (q < 0) q = options%max_q
      if (samples >= 20 + 4*(p + q)) return
      write (text, '("ARMA(", i0, ",", i0, ") needs at least ", i0, " samples, there are ", i0)') p, q, 20 + 4*(p + q), samples
      call fatal_error(error, status%too_few_samples, trim(text))
   end subroutine check_length

   !> A drift in white noise, as block means show it; none where that fails.
   subroutine look_for_drift(series, hint)
      type(arma_series_type), intent(in) :: series
      type(arma_hint_type), intent(inout) :: hint
      type(drift_model_type) :: drift
      type(error_type), allocatable :: error

      call identify_drift(series%y, drift, error, series%valid)
      if (allocated(error)) return
      if (.not. (drift%phi > 0.0_dp .and. drift%phi < 1.0_dp)) return
      hint%drift_phi = drift%phi
      hint%drift_variance = drift%drift_variance
      hint%white_variance = max(drift%measurement_variance, 0.0_dp)
   end subroutine look_for_drift

   !> Everything that follows from the maximum.
   subroutine complete_model(series, hint, optimum, centre, scale, listener, model, error)
      type(arma_series_type), intent(in) :: series
      type(arma_hint_type), intent(in) :: hint
      type(arma_optimum_type), intent(in) :: optimum
      real(dp), intent(in) :: centre(2), scale
      !> Told how far it is, may cancel; not associated: nobody
      class(progress_type), pointer, intent(in) :: listener
      type(arma_model_type), intent(inout) :: model
      !> singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(arma_sums_type) :: sums
      type(arma_optimum_type) :: reduced
      type(progress_share_type) :: share
      real(dp), allocatable :: residual(:)
      real(dp), dimension(model%p + model%q + 1, model%p + model%q + 1) :: matrix, covariance
      real(dp) :: gain
      logical :: stationary
      integer :: k, failed

      k = model%p + model%q + 1
      if (.not. allocated(optimum%parameter)) then
         call fatal_error(error, status%singular, "the likelihood of the ARMA model could not be evaluated anywhere")
         return
      end if
      allocate (residual(size(series%y, kind=int64)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the residuals of the ARMA model")
         return
      end if
      allocate (model%phi(model%p), model%theta(model%q), model%phi_error(model%p), model%theta_error(model%q))
      call split_free(optimum%parameter, model%phi, model%theta, matrix)
      share%whole => listener
      share%total = model%length
      call sum_innovations(series, model%phi, model%theta, optimum%parameter(k), sums, stationary, .true., residual=residual, &
         & progress=share, cancelled=error)
      if (allocated(error)) return
      if (.not. stationary .or. sums%square <= perfect*hint%r(0)*real(sums%count, dp)) then
         call fatal_error(error, status%singular, "the ARMA model predicts the series perfectly: it has no noise")
         return
      end if
      model%noise_variance = sums%square/real(sums%count, dp)*scale**2
      model%mean = centre(1) + (centre(2) + optimum%parameter(k)*scale)
      model%fit = arma_criteria(model%p, model%q, log_likelihood_of(sums) - real(sums%count, dp)*log(scale), model%noise_variance, &
                                sums%count)
      model%converged = optimum%converged
      model%iterations = optimum%iterations
      model%evaluations = optimum%evaluations
      call information_of(sums, model%p, model%q, matrix)
      call invert_information(matrix, covariance, model%errors_known)
      call give_errors(covariance, scale, model)
      call find_roots(model)
      call check_residuals(series, residual, model)
      call find_drift(covariance, model)
      gain = -1.0_dp
      if (model%p > 0 .and. model%q > 0) then
         call maximise_likelihood(series, hint, model%p - 1, model%q - 1, reduced, .true., listener, error)
         if (allocated(error)) return
         gain = max(2.0_dp*real(sums%count, dp)*(reduced%value - optimum%value), 0.0_dp)
      end if
      call warn_of(model, gain)
   end subroutine complete_model

   !> Standard errors.
   pure subroutine give_errors(covariance, scale, model)
      real(dp), intent(in) :: covariance(:, :), scale
      type(arma_model_type), intent(inout) :: model
      integer :: i

      do i = 1, model%p
         model%phi_error(i) = sqrt(covariance(i, i))
      end do
      do i = 1, model%q
         model%theta_error(i) = sqrt(covariance(model%p + i, model%p + i))
      end do
      model%mean_error = sqrt(covariance(size(covariance, 1), size(covariance, 1)))*scale
   end subroutine give_errors

end module gyroakf_ar_arma_model
