! SPDX-License-Identifier: MIT
!> Drift models identified from a record by maximum likelihood.
!>
!> Three candidates, all with white noise: a random walk, an AR(1) process, and both. Each is fitted by the BFGS method to the exact
!> Gaussian likelihood ([[gyroakf_filter_likelihood]]) in the logarithms of the variances (of the AR(1) process itself, not of its
!> driving noise) and artanh(phi), from several starts; standard errors come from the curvature there.
!> $$ \mathrm{AIC} = -2 \ln L + 2 k, \quad \mathrm{BIC} = -2 \ln L + k \ln n $$
!> with k variances and coefficients, and the mean where no random walk takes its place. What counts as drift is not theirs to say:
!> it is what is slower than a limit that the user sets.
!>
!> Source: Durbin & Koopman, Time Series Analysis by State Space Methods, 2nd ed. (2012), 7.3; Harvey, Forecasting, Structural Time
!> Series Models and the Kalman Filter (1989), 4.5.
module gyroakf_filter_drift_fit
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_quasi_newton, only : minimise, minimise_options, minimum_type, objective_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   implicit none (type, external)
   private
   public :: drift_fit_type, drift_candidate_type, fit_drift, is_slow

   !> A model and how well it describes the series, whose unit is u
   type :: drift_candidate_type
      !> "walk", "ar1" or "walk+ar1"
      character(8) :: name = ""
      !> The process AR(1) first, the random walk last
      type(component_model_type) :: model
      !> Standard errors of phi, q and r, 0 where `errors_known` is false
      type(component_model_type) :: std_error
      logical :: errors_known = .false.
      !> Fitted parameters
      integer :: parameters = 0
      !> Of the series in u; with a random walk its first sample is given, not measured
      real(dp) :: log_likelihood = 0.0_dp
      !> Of the series in standard deviations, plus 2 n ln of that: the diffuse start of the random walk has no density in u,
      !> and its likelihood a power of u more than that of the others
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

   !> Likelihood of the scaled series by transformed parameters
   type, extends(objective_type) :: likelihood_objective
      real(dp), allocatable :: z(:)
      integer(int8), allocatable :: here(:)
      logical :: walk = .false., ar = .false.
      integer(int64) :: measurements = 0
   contains
      procedure :: evaluate => evaluate_likelihood
   end type likelihood_objective

   !> Samples used of a huge record (some 2 s), and fewest
   integer(int64), parameter :: most_samples = 131072, fewest_samples = 50
   !> Logarithms of variances beyond it are nothing or everything
   real(dp), parameter :: widest = 60.0_dp
   !> Slope of the log-likelihood of a sample that is flat: a parameter is then nearer to the maximum than 1e-4 of its error; steps
   real(dp), parameter :: flat = 1.0e-7_dp
   integer, parameter :: most_iterations = 100
   real(dp), parameter :: log_two_pi = 1.8378770664093454835606594728112_dp
   !> Step of the differences of the gradient
   real(dp), parameter :: difference = 1.0e-4_dp
   character(8), parameter :: names(3) = [character(8) :: "walk", "ar1", "walk+ar1"]

contains

   !> Fits the candidates.
   subroutine fit_drift(x, fit, error, valid, most)
      !> Series, [n], n >= 50; of a huge one the middle is used
      real(dp), intent(in), contiguous :: x(:)
      !> What was found
      type(drift_fit_type), intent(out) :: fit
      !> too_few_samples, constant_input, no_memory, not_converged (no candidate has a maximum)
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Samples that are used at most, >= 50; 131,072 if absent
      integer(int64), intent(in), optional :: most
      type(likelihood_objective) :: objective
      type(drift_candidate_type) :: found
      type(error_type), allocatable :: failed
      real(dp) :: scale
      integer :: k

      fit%samples = min(size(x, kind=int64), most_samples)
      if (present(most)) fit%samples = min(size(x, kind=int64), max(most, fewest_samples))
      call take_part(x, objective, scale, fit, error, valid)
      if (allocated(error)) return
      allocate (fit%candidate(0))
      do k = 1, size(names)
         objective%walk = k /= 2
         objective%ar = k /= 1
         call fit_candidate(objective, names(k), scale, found, failed)
         if (allocated(failed)) cycle
         call append(fit%candidate, found)
         if (fit%best == 0) fit%best = size(fit%candidate)
         if (found%aic < fit%candidate(fit%best)%aic) fit%best = size(fit%candidate)
      end do
      if (fit%best == 0) call fatal_error(error, status%not_converged, "no drift model has a largest likelihood for this series")
   end subroutine fit_drift

   !> Adds a candidate.
   pure subroutine append(list, one)
      type(drift_candidate_type), allocatable, intent(inout) :: list(:)
      type(drift_candidate_type), intent(in) :: one
      type(drift_candidate_type), allocatable :: longer(:)

      allocate (longer(size(list) + 1))
      longer(:size(list)) = list
      longer(size(longer)) = one
      call move_alloc(longer, list)
   end subroutine append

   !> The part that is used, less its mean, over its standard deviation.
   subroutine take_part(x, objective, scale, fit, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(likelihood_objective), intent(inout) :: objective
      !> Its standard deviation
      real(dp), intent(out) :: scale
      type(drift_fit_type), intent(inout) :: fit
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n
      integer :: stat

      scale = 0.0_dp
      n = fit%samples
      fit%first = (size(x, kind=int64) - n)/2 + 1
      allocate (objective%z(n), stat=stat)
      if (stat == 0) allocate (objective%here(n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the part of a series that a drift is identified from")
         return
      end if
      objective%z(:) = x(fit%first:fit%first + n - 1)
      objective%here = 1_int8
      if (present(valid)) objective%here(:) = valid(fit%first:fit%first + n - 1)
      fit%measurements = count(objective%here /= 0_int8, kind=int64)
      objective%measurements = fit%measurements
      if (fit%measurements < fewest_samples) then
         call fatal_error(error, status%too_few_samples, "a drift is identified from at least 50 present samples")
         return
      end if
      fit%mean = sum(objective%z - objective%z(1), mask=objective%here /= 0_int8)/real(fit%measurements, dp) + objective%z(1)
      objective%z = objective%z - fit%mean
      scale = sqrt(sum(objective%z**2, mask=objective%here /= 0_int8)/real(fit%measurements, dp))
      if (.not. scale > 0.0_dp) then
         call fatal_error(error, status%constant_input, "a series without variance has no drift")
      else
         objective%z = objective%z/scale
         fit%variance = scale**2
         fit%white_aic = real(fit%measurements, dp)*(log_two_pi + 1.0_dp + log(fit%variance)) + 4.0_dp
      end if
   end subroutine take_part

   !> Fits one of them from its best starts.
   subroutine fit_candidate(objective, name, scale, found, error)
      type(likelihood_objective), intent(inout) :: objective
      character(*), intent(in) :: name
      !> Standard deviation of the series
      real(dp), intent(in) :: scale
      type(drift_candidate_type), intent(out) :: found
      !> not_converged and the like
      type(error_type), allocatable, intent(out) :: error
      type(minimum_type) :: minimum, other
      type(error_type), allocatable :: failed
      real(dp), allocatable :: start(:, :), value(:), inverse(:, :)
      real(dp) :: deviance
      logical :: known
      integer :: k, first, n

      call make_starts(objective, start)
      n = size(start, 1)
      allocate (value(size(start, 2)))
      do k = 1, size(value)
         value(k) = value_at(objective, start(:, k))
      end do
      do k = 1, min(2, size(value))
         first = minloc(value, dim=1)
         value(first) = huge(1.0_dp)
         call minimise(objective, start(:, first), minimise_options(flat, most_iterations), other, failed)
         if (allocated(failed)) cycle
         if (.not. allocated(minimum%parameter) .or. other%value < minimum%value) minimum = other
      end do
      if (.not. allocated(minimum%parameter)) then
         call fatal_error(error, status%not_converged, "the likelihood of the drift model '"//trim(name)//"' has no maximum")
         return
      end if
      found%name = name
      found%converged = minimum%converged
      found%parameters = n + merge(0, 1, objective%walk)
      found%log_likelihood = -minimum%value*real(objective%measurements, dp) - &
                             real(objective%measurements - merge(1, 0, objective%walk), dp)*log(scale)
      deviance = 2.0_dp*real(objective%measurements, dp)*(minimum%value + log(scale))
      found%aic = deviance + 2.0_dp*found%parameters
      found%bic = deviance + log(real(objective%measurements, dp))*found%parameters
      call model_of(objective, minimum%parameter, found%model)
      allocate (inverse(n, n))
      call invert_curvature(objective, minimum%parameter, inverse, known)
      if (known) call set_errors(objective, minimum%parameter, inverse, scale, found)
      found%model%q = scale**2*found%model%q
      found%model%r = scale**2*found%model%r
   end subroutine fit_candidate

   !> Where the search begins: [parameter, start], for a series of variance 1. Drifts from fast to slow, small and large.
   pure subroutine make_starts(objective, start)
      type(likelihood_objective), intent(in) :: objective
      real(dp), allocatable, intent(out) :: start(:, :)
      real(dp), parameter :: times(5) = [1.0_dp, 4.0_dp, 30.0_dp, 300.0_dp, 3000.0_dp], walks(4) = [1.0e-2_dp, 1.0e-4_dp, &
                                                                                                  1.0e-6_dp, 1.0e-8_dp]
      real(dp), parameter :: shares(2) = [0.3_dp, 0.03_dp]
      integer :: i, j, k, s

      if (.not. objective%ar) then
         allocate (start(2, size(walks)))
         start(1, :) = log(walks)
         start(2, :) = log(0.5_dp)
         return
      end if
      k = merge(size(walks), 1, objective%walk)
      allocate (start(merge(4, 3, objective%walk), size(times)*size(shares)*k))
      s = 0
      do k = 1, merge(size(walks), 1, objective%walk)
         do j = 1, size(shares)
            do i = 1, size(times)
               s = s + 1
               start(1, s) = atanh(exp(-1.0_dp/times(i)))
               start(2, s) = log(shares(j))
               if (objective%walk) start(3, s) = log(walks(k))
               start(size(start, 1), s) = log(1.0_dp - shares(j))
            end do
         end do
      end do
   end subroutine make_starts

   !> The model of transformed parameters: artanh phi and ln D of the AR(1) process, ln q of the random walk, ln r.
   pure subroutine model_of(objective, parameter, model)
      type(likelihood_objective), intent(in) :: objective
      real(dp), intent(in) :: parameter(:)
      type(component_model_type), intent(out) :: model
      integer :: next

      next = 1
      if (objective%ar) then
         model%count = 1
         model%phi(1) = tanh(parameter(1))
         model%q(1) = exp(parameter(2))/cosh(parameter(1))**2
         next = 3
      end if
      if (objective%walk) then
         model%count = model%count + 1
         model%phi(model%count) = 1.0_dp
         model%q(model%count) = exp(parameter(next))
         next = next + 1
      end if
      model%r = exp(parameter(next))
   end subroutine model_of

   !> Minus the log-likelihood of a sample on average.
   subroutine evaluate_likelihood(self, parameter, value, gradient, feasible)
      class(likelihood_objective), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible
      type(component_model_type) :: model
      type(error_type), allocatable :: failed
      real(dp) :: slope(7), share
      integer :: n, next

      value = 0.0_dp
      gradient = 0.0_dp
      feasible = all(abs(parameter) < widest)
      if (feasible .and. self%ar) feasible = abs(parameter(1)) < 9.0_dp           ! phi is 1 there
      if (.not. feasible) return
      call model_of(self, parameter, model)
      n = model%count
      call component_likelihood(model, self%z, value, failed, self%here, slope(:2*n + 1))
      feasible = .not. allocated(failed)
      if (.not. feasible) return
      share = -1.0_dp/real(self%measurements, dp)
      value = share*value
      next = 1
      if (self%ar) then
         gradient(1) = share*(slope(1)/cosh(parameter(1))**2 - 2.0_dp*model%phi(1)*model%q(1)*slope(n + 1))
         gradient(2) = share*slope(n + 1)*model%q(1)
         next = 3
      end if
      if (self%walk) then
         gradient(next) = share*slope(2*n)*model%q(n)
         next = next + 1
      end if
      gradient(next) = share*slope(2*n + 1)*model%r
   end subroutine evaluate_likelihood

   !> Minus the log-likelihood without its gradient, huge where there is none.
   real(dp) function value_at(objective, parameter) result(value)
      type(likelihood_objective), intent(in) :: objective
      real(dp), intent(in) :: parameter(:)
      type(component_model_type) :: model
      type(error_type), allocatable :: failed

      call model_of(objective, parameter, model)
      call component_likelihood(model, objective%z, value, failed, objective%here)
      value = -value
      if (allocated(failed)) value = huge(1.0_dp)
   end function value_at

   !> Covariance of the transformed parameters: inverse of the curvature of the log-likelihood.
   subroutine invert_curvature(objective, parameter, inverse, known)
      type(likelihood_objective), intent(inout) :: objective
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: inverse(:, :)
      !> False where it is not that of a maximum: a variance that is nothing
      logical, intent(out) :: known
      real(dp), dimension(size(parameter)) :: near, above, below
      real(dp) :: value
      integer :: k, n, info

      n = size(parameter)
      do k = 1, n
         near = parameter
         near(k) = near(k) + difference
         call objective%evaluate(near, value, above, known)
         if (known) near(k) = parameter(k) - difference
         if (known) call objective%evaluate(near, value, below, known)
         if (.not. known) return
         inverse(:, k) = (above - below)/(2.0_dp*difference)*real(objective%measurements, dp)
      end do
      inverse = 0.5_dp*(inverse + transpose(inverse))
      call dpotrf("L", n, inverse, n, info)
      if (info == 0) call dpotri("L", n, inverse, n, info)
      known = info == 0
   end subroutine invert_curvature

   !> Standard errors of phi, q and r.
   pure subroutine set_errors(objective, parameter, inverse, scale, found)
      type(likelihood_objective), intent(in) :: objective
      real(dp), intent(in) :: parameter(:)
      !> Lower triangle
      real(dp), intent(in) :: inverse(:, :)
      real(dp), intent(in) :: scale
      !> Its model is that of the scaled series
      type(drift_candidate_type), intent(inout) :: found
      real(dp) :: tangent
      integer :: next, n

      n = found%model%count
      found%errors_known = .true.
      found%std_error%count = n
      next = 1
      if (objective%ar) then
         tangent = -2.0_dp*found%model%phi(1)
         found%std_error%phi(1) = sqrt(inverse(1, 1))/cosh(parameter(1))**2
         found%std_error%q(1) = scale**2*found%model%q(1)*sqrt(max(0.0_dp, tangent**2*inverse(1, 1) + inverse(2, 2) &
                                                                   + 2.0_dp*tangent*inverse(2, 1)))
         next = 3
      end if
      if (objective%walk) then
         found%std_error%q(n) = scale**2*found%model%q(n)*sqrt(inverse(next, next))
         next = next + 1
      end if
      found%std_error%r = scale**2*found%model%r*sqrt(inverse(next, next))
   end subroutine set_errors

   !> Which processes of a model are slower than a limit: a random walk is.
   pure subroutine is_slow(model, limit, slow)
      !> The model
      type(component_model_type), intent(in) :: model
      !> Correlation time in samples
      real(dp), intent(in) :: limit
      !> [count]
      logical, allocatable, intent(out) :: slow(:)
      integer :: i

      allocate (slow(model%count))
      do i = 1, model%count
         slow(i) = model%phi(i) >= 1.0_dp
         if (model%phi(i) > 0.0_dp .and. .not. slow(i)) slow(i) = -1.0_dp/log(model%phi(i)) >= limit
      end do
   end subroutine is_slow

end module gyroakf_filter_drift_fit
