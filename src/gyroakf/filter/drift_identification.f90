! SPDX-License-Identifier: MIT
!> The drift of a record and its white noise, identified from the record itself.
!>
!>     call identify_drift_model(z, drift_identification_options(), identification, error)
!>     if (identification%found) call new_drift_filter(filter, identification%model, identification%slow, options, error)
!>
!> The candidates of [[fit_drift]] (random walk, AR(1), both, each with white noise) are compared by AIC. Which of their
!> processes are the drift is not theirs to say: it is those that are slower than a limit. Something slow is found where the best
!> model is better than the best one without anything slow, white noise alone among them, by more than chance makes it.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.3, 7.4.
module gyroakf_filter_drift_identification
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_filter_allan_model, only : allan_terms_type, make_allan_model
   use gyroakf_filter_components, only : component_model_type, most_components
   use gyroakf_filter_drift_fit, only : drift_candidate_type, drift_fit_type, fit_drift, is_slow
   use gyroakf_filter_likelihood, only : component_likelihood
   implicit none (type, external)
   private
   public :: drift_identification_options, drift_identification_type, identify_drift_model
   public :: allan_terms_type

   !> What is asked for
   type :: drift_identification_options
      !> Correlation time in samples from which a process counts as drift, > 0
      real(dp) :: drift_samples = 5.0_dp
      !> Samples that the likelihood uses at most, >= 50
      integer(int64) :: most = 131072
      !> Where the model comes from: "record" (largest likelihood) or "allan" (coefficients of the Allan deviation)
      character(8) :: source = "record"
   end type drift_identification_options

   !> What was found; u is the unit of the series
   type :: drift_identification_type
      !> Something in the record is slower than the limit
      logical :: found = .false.
      !> All processes, fast ones too, and white noise r: AR(1) processes first, a random walk last; no process where the series
      !> is white
      type(component_model_type) :: model
      !> Which of them count as drift
      logical :: slow(most_components) = .false.
      !> "walk", "ar1", "walk+ar1", "white"
      character(8) :: name = "white"
      !> "likelihood", "autocov", "allan"
      character(10) :: source = "likelihood"
      !> Standard errors of phi, q and r, 0 where they are not known
      type(component_model_type) :: std_error
      logical :: errors_known = .false.
      !> Of the slowest AR(1) process that counts as drift, samples; 0: a random walk alone, or nothing
      real(dp) :: correlation_samples = 0.0_dp
      !> Standard deviation of the slow AR(1) processes, u; of a random walk alone that of a step, u per root of a sample
      real(dp) :: drift_std = 0.0_dp
      !> Of the white noise, u
      real(dp) :: white_std = 0.0_dp
      !> All that were fitted, and which of them was chosen; 0: white noise, or the model is that of the Allan deviation
      type(drift_candidate_type), allocatable :: candidate(:)
      integer :: chosen = 0
      !> Used by the likelihood (the middle of the record), of the record
      integer(int64) :: samples = 0, of_samples = 0
      !> The model of the Allan deviation
      type(component_model_type) :: from_allan
      logical :: allan_known = .false.
      !> Of both models on the same samples, as AIC counts it: the difference has no unit
      real(dp) :: allan_log_likelihood = 0.0_dp, log_likelihood = 0.0_dp
   end type drift_identification_type

   !> Decrease of AIC from the best model without drift that speaks for one
   real(dp), parameter :: evident = 10.0_dp

contains

   !> Identifies the drift of a series.
   subroutine identify_drift_model(z, options, identification, error, valid, noise, progress)
      !> Series, [n], n >= 50
      real(dp), intent(in), contiguous :: z(:)
      !> The limit, the part, the source
      type(drift_identification_options), intent(in) :: options
      !> What was found
      type(drift_identification_type), intent(out) :: identification
      !> invalid_argument (options), too_few_samples, constant_input, no_memory, not_converged, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Coefficients of the series' Allan deviation; source "allan" needs them
      type(allan_terms_type), intent(in), optional :: noise
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(drift_fit_type) :: fit

      call check_options(options, present(noise), error)
      if (.not. allocated(error)) call tell_progress("identifying", 0_int64, size(z, kind=int64), error, progress)
      if (.not. allocated(error)) call fit_drift(z, fit, error, valid, options%most)
      if (allocated(error)) return
      identification%samples = fit%samples
      identification%of_samples = size(z, kind=int64)
      call choose(fit, options%drift_samples, identification)
      call move_alloc(fit%candidate, identification%candidate)
      if (present(noise)) call compare_allan(z, noise, fit, options, identification, error, valid)
      if (.not. allocated(error)) call state_numbers(identification)
   end subroutine identify_drift_model

   !> Refuses options out of range.
   subroutine check_options(options, has_noise, error)
      type(drift_identification_options), intent(in) :: options
      !> Coefficients of an Allan deviation are at hand
      logical, intent(in) :: has_noise
      type(error_type), allocatable, intent(out) :: error

      if (.not. (options%drift_samples > 0.0_dp .and. options%drift_samples <= huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, "the correlation time from which a process is drift must be positive")
      else if (options%source /= "record" .and. options%source /= "allan") then
         call fatal_error(error, status%invalid_argument, "the source of a drift model is record or allan, not '"// &
                          trim(options%source)//"'")
      else if (options%source == "allan" .and. .not. has_noise) then
         call fatal_error(error, status%invalid_argument, "a drift model from the Allan deviation needs its coefficients")
      end if
   end subroutine check_options

   !> The best candidate, or the best without drift where that is no worse.
   subroutine choose(fit, limit, identification)
      type(drift_fit_type), intent(in) :: fit
      !> Correlation time in samples
      real(dp), intent(in) :: limit
      type(drift_identification_type), intent(inout) :: identification
      logical, allocatable :: slow(:)
      real(dp) :: plain
      integer :: fast, k

      plain = fit%white_aic
      fast = 0
      do k = 1, size(fit%candidate)
         call is_slow(fit%candidate(k)%model, limit, slow)
         if (any(slow) .or. .not. fit%candidate(k)%aic < plain) cycle
         plain = fit%candidate(k)%aic
         fast = k
      end do
      associate (best => fit%candidate(fit%best))
         call is_slow(best%model, limit, slow)
         identification%found = any(slow) .and. best%aic < plain - evident
      end associate
      identification%chosen = merge(fit%best, fast, identification%found)
      if (identification%chosen == 0) then
         identification%model%r = fit%variance
         identification%log_likelihood = 2.0_dp - 0.5_dp*fit%white_aic
         return
      end if
      associate (chosen => fit%candidate(identification%chosen))
         identification%model = chosen%model
         identification%name = chosen%name
         identification%std_error = chosen%std_error
         identification%errors_known = chosen%errors_known
         identification%log_likelihood = chosen%parameters - 0.5_dp*chosen%aic
         call is_slow(chosen%model, limit, slow)
         identification%slow(:size(slow)) = slow
      end associate
   end subroutine choose

   !> The model of the Allan deviation, its likelihood, and its place where it was asked for.
   subroutine compare_allan(z, noise, fit, options, identification, error, valid)
      real(dp), intent(in), contiguous :: z(:)
      type(allan_terms_type), intent(in) :: noise
      type(drift_fit_type), intent(in) :: fit
      type(drift_identification_options), intent(in) :: options
      type(drift_identification_type), intent(inout) :: identification
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(error_type), allocatable :: failed
      logical, allocatable :: slow(:)

      call make_allan_model(noise, identification%from_allan, error)
      if (allocated(error)) return
      associate (model => identification%from_allan, last => fit%first + fit%samples - 1)
         if (model%count > 0) then
            if (present(valid)) then
               call component_likelihood(model, z(fit%first:last) - fit%mean, identification%allan_log_likelihood, failed, &
                                         valid(fit%first:last))
            else
               call component_likelihood(model, z(fit%first:last) - fit%mean, identification%allan_log_likelihood, failed)
            end if
            identification%allan_known = .not. allocated(failed)
            if (any(model%phi(:model%count) >= 1.0_dp)) identification%allan_log_likelihood = &
               identification%allan_log_likelihood - 0.5_dp*log(fit%variance)
         end if
      end associate
      if (options%source /= "allan") return
      identification%source = "allan"
      identification%model = identification%from_allan
      identification%std_error = component_model_type()
      identification%errors_known = .false.
      identification%chosen = 0
      call is_slow(identification%model, options%drift_samples, slow)
      identification%slow = .false.
      identification%slow(:size(slow)) = slow
      identification%found = any(slow)
      identification%name = "white"
      if (identification%model%count == 1) identification%name = merge("walk", "ar1 ", identification%model%phi(1) >= 1.0_dp)
      if (identification%model%count == 2) identification%name = "walk+ar1"
   end subroutine compare_allan

   !> The numbers that a reader looks for.
   subroutine state_numbers(identification)
      type(drift_identification_type), intent(inout) :: identification
      real(dp) :: variance
      integer :: i

      variance = 0.0_dp
      associate (model => identification%model)
         identification%white_std = sqrt(model%r)
         do i = 1, model%count
            if (.not. identification%slow(i) .or. model%phi(i) >= 1.0_dp) cycle
            variance = variance + model%q(i)/((1.0_dp - model%phi(i))*(1.0_dp + model%phi(i)))
            identification%correlation_samples = max(identification%correlation_samples, -1.0_dp/log(model%phi(i)))
         end do
         if (identification%correlation_samples <= 0.0_dp) variance = sum(model%q, mask=identification%slow)
      end associate
      identification%drift_std = sqrt(variance)
   end subroutine state_numbers

end module gyroakf_filter_drift_identification
