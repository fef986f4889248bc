! SPDX-License-Identifier: MIT
!> Drift models identified from a record by maximum likelihood.
!>
!> Three candidates, all with white noise: a random walk, an AR(1) process, and both. Each is fitted
!> by the BFGS method to the exact Gaussian likelihood ([[gyroakf_filter_likelihood]]) in the
!> logarithms of the variances (of the AR(1) process itself, not of its driving noise) and
!> artanh(phi), from several starts, the best of the models that it contains among them
!> ([[gyroakf_filter_drift_starts]]); the curvature at the best of their ends gives the last steps
!> and the standard errors. A variance that the likelihood does not tell from 0 is 0.
!> $$ \mathrm{AIC} = -2 \ln L + 2 k, \quad \mathrm{BIC} = -2 \ln L + k \ln n $$
!> with k variances and coefficients, and the mean where no random walk takes its place. What counts
!> as drift is not theirs to say: it is what is slower than a limit that the user sets.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.3;
!> Harvey, Forecasting, Structural Time Series Models and the Kalman Filter (1989), 4.5.
module gyroakf_filter_drift_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_quasi_newton, only : minimum_type
   use gyroakf_stats_moments, only : first_present
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_objective, only : give_errors, likelihood_objective, model_of, &
      parameters_of
   use gyroakf_filter_drift_search, only : finish, search
   use gyroakf_filter_drift_starts, only : known_type
   implicit none (type, external)
   private
   public :: drift_fit_type, drift_candidate_type, fit_drift, is_slow

   !> A model and how well it describes the series, whose unit is u
   type :: drift_candidate_type
      !> "walk", "ar1" or "walk+ar1"
      character(8) :: name = ""
      !> The process AR(1) first, the random walk last; q is 0 where the likelihood does not tell it
      !> from that: a random walk without steps is an unknown constant, an AR(1) process without
      !> variance is not there
      type(component_model_type) :: model
      !> Standard errors of phi, q and r; 0 where `errors_known` is false, and for what is 0
      type(component_model_type) :: std_error
      logical :: errors_known = .false.
      !> Fitted parameters
      integer :: parameters = 0
      !> Of the series in u; with a random walk its first sample is given, not measured
      real(dp) :: log_likelihood = 0.0_dp
      !> Of the series in standard deviations, plus 2 n ln of that: the diffuse start of the random
      !> walk has no density in u, and its likelihood a power of u more than that of the others
      real(dp) :: aic = 0.0_dp, bic = 0.0_dp
      !> A maximum was found
      logical :: converged = .false.
   end type drift_candidate_type

   !> All candidates
   type :: drift_fit_type
      !> Those that could be fitted: [0 .. 3]
      type(drift_candidate_type), allocatable :: candidate(:)
      !> The one of the smallest AIC, 0 where there is none
      integer :: best = 0
      !> Samples that were used, the first of them, and those present
      integer(int64) :: samples = 0, first = 1, measurements = 0
      !> Subtracted before: the mean of those present, u; their variance about it, u^2
      real(dp) :: mean = 0.0_dp, variance = 0.0_dp
      !> AIC of white noise alone, of mean and variance
      real(dp) :: white_aic = 0.0_dp
   end type drift_fit_type

   !> Samples used of a huge record (half a second), and fewest
   integer(int64), parameter :: most_samples = 131072, fewest_samples = 50
   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> The candidates and their processes
   character(8), parameter :: names(3) = [character(8) :: "walk", "ar1", "walk+ar1"]
   logical, parameter :: with_walk(3) = [.true., .false., .true.], with_ar(3) = &
      [.false., .true., .true.]

contains

   !> Fits the candidates.
   subroutine fit_drift(x, fit, error, valid, most, progress)
      !> Series, [n], n >= 50; of a huge one the middle is used
      real(dp), intent(in), contiguous :: x(:)
      !> What was found
      type(drift_fit_type), intent(out) :: fit
      !> too_few_samples, constant_input, no_memory, cancelled, not_converged (no candidate has a
      !> top)
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Samples that are used at most, >= 50; 131,072 if absent
      integer(int64), intent(in), optional :: most
      !> Progress callback, at every evaluation of a likelihood; may cancel
      class(progress_type), intent(inout), optional, target :: progress
      type(likelihood_objective) :: objective
      type(drift_candidate_type) :: found
      type(known_type) :: known
      type(error_type), allocatable :: failed
      real(dp) :: scale
      integer :: k

      fit%samples = min(size(x, kind=int64), most_samples)
      if (present(most)) fit%samples = min(size(x, kind=int64), max(most, fewest_samples))
      call take_part(x, objective, scale, fit, error, valid)
      if (allocated(error)) return
      allocate (fit%candidate(0))
      if (present(progress)) objective%progress%whole => progress
      objective%candidates = size(names)
      do k = 1, size(names)
         objective%walk = with_walk(k)
         objective%ar = with_ar(k)
         objective%done = k - 1
         objective%evaluations = 0
         call fit_candidate(objective, names(k), scale, known, found, failed)
         if (allocated(objective%cancelled)) exit
         if (allocated(failed)) cycle
         fit%candidate = [fit%candidate, found]
         if (fit%best == 0) fit%best = size(fit%candidate)
         if (found%aic < fit%candidate(fit%best)%aic) fit%best = size(fit%candidate)
      end do
      if (allocated(objective%cancelled)) then
         call move_alloc(objective%cancelled, error)
      else if (fit%best == 0) then
         call fatal_error(error, status%not_converged, &
            "no drift model has a maximum likelihood estimate for this series")
      end if
   end subroutine fit_drift

   !> The part that is used, less its mean, over its standard deviation.
   subroutine take_part(x, objective, scale, fit, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(likelihood_objective), intent(inout) :: objective
      real(dp), intent(out) :: scale
      type(drift_fit_type), intent(inout) :: fit
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: offset
      integer(int64) :: n
      integer :: stat

      scale = 0.0_dp
      n = fit%samples
      fit%first = (size(x, kind=int64) - n)/2 + 1
      allocate (objective%z(n), stat=stat)
      if (stat == 0 .and. present(valid)) allocate (objective%here(n), stat=stat)
      call check_memory(stat, "the part of a series that a drift is identified from", error)
      if (allocated(error)) return
      objective%z(:) = x(fit%first:fit%first + n - 1)
      fit%measurements = n
      if (present(valid)) then
         objective%here(:) = valid(fit%first:fit%first + n - 1)
         fit%measurements = count(objective%here /= 0_int8, kind=int64)
         if (fit%measurements == n) deallocate (objective%here)
      end if
      objective%measurements = fit%measurements
      if (fit%measurements < fewest_samples) then
         call fatal_error(error, status%too_few_samples, &
            "a drift is identified from at least 50 present samples")
         return
      end if
      offset = first_present(objective%z, objective%here)
      if (allocated(objective%here)) where (objective%here == 0_int8) objective%z = offset
      fit%mean = sum(objective%z - offset)/real(fit%measurements, dp) + offset
      objective%z = objective%z - fit%mean
      if (allocated(objective%here)) where (objective%here == 0_int8) objective%z = 0.0_dp
      scale = sqrt(sum(objective%z**2)/real(fit%measurements, dp))
      fit%variance = scale**2
      if (.not. ieee_is_finite(fit%variance)) then
         call fatal_error(error, status%non_finite, &
            & "the samples are too large: their variance is not a finite number")
      else if (scale <= 0.0_dp) then
         call fatal_error(error, status%constant_input, "a series without variance has no drift")
      else
         objective%z = objective%z/scale
         fit%white_aic = real(fit%measurements, dp)*(log_two_pi + 1.0_dp + log(fit%variance)) &
            + 4.0_dp
      end if
   end subroutine take_part

   !> Fits one of them from its best starts.
   subroutine fit_candidate(objective, name, scale, known, found, error)
      type(likelihood_objective), intent(inout) :: objective
      character(*), intent(in) :: name
      real(dp), intent(in) :: scale
      !> What is known; gets the walk and the AR(1) process
      type(known_type), intent(inout) :: known
      type(drift_candidate_type), intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      type(minimum_type) :: minimum
      type(component_model_type) :: model
      real(dp), allocatable :: inverse(:, :)
      real(dp) :: deviance

      call search(objective, known, minimum)
      if (.not. allocated(minimum%parameter)) then
         call fatal_error(error, status%not_converged, "the likelihood of the drift model '"// &
            trim(name)//"' has no maximum")
         return
      end if
      allocate (inverse(size(minimum%parameter), size(minimum%parameter)))
      call finish(objective, minimum, inverse, found%errors_known)
      call model_of(objective, minimum%parameter, model)
      if (.not. objective%ar) known%walk = model
      if (.not. objective%walk) known%ar = model
      found%name = name
      found%converged = minimum%converged
      found%parameters = parameters_of(objective) + merge(0, 1, objective%walk)
      found%log_likelihood = -minimum%value*real(objective%measurements, dp) &
         - real(objective%measurements - merge(1, 0, objective%walk), dp)*log(scale)
      deviance = 2.0_dp*real(objective%measurements, dp)*(minimum%value + log(scale))
      found%aic = deviance + 2.0_dp*found%parameters
      found%bic = deviance + log(real(objective%measurements, dp))*found%parameters
      if (found%errors_known) call give_errors(objective, minimum%parameter, inverse, scale, &
         model, found%std_error)
      found%model = model
      found%model%q = scale**2*model%q
      found%model%r = scale**2*model%r
   end subroutine fit_candidate

   !> Whether a process is slower than a limit: a random walk is.
   elemental logical function is_slow(phi, limit)
      !> Its coefficient
      real(dp), intent(in) :: phi
      !> Correlation time in samples
      real(dp), intent(in) :: limit

      is_slow = phi >= 1.0_dp
      if (phi > 0.0_dp .and. .not. is_slow) is_slow = -1.0_dp/log(phi) >= limit
   end function is_slow

end module gyroakf_filter_drift_fit
