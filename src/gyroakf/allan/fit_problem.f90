! SPDX-License-Identifier: MIT
!> The least-squares problem of [[gyroakf_allan_noise_fit]] and its solution for given weights.
!>
!> Everything is relative to a model, so that rows are free of units: with the design
!> X_it = phi_t(tau_i)/sigma^2_model,i a step of Gauss and Newton for the logarithms solves, for theta >= 0,
!>
!> $$ \min \sum_i w_i \left( \sum_t X_{it} \theta_t - 1 - \ln\frac{\hat\sigma^2_i}{\sigma^2_{model,i}} + b_i \right)^2 $$
!>
!> The correlation time and the frequency of the last two terms are unknowns of either sign: the
!> derivatives of their terms by the logarithm of the parameter (the tangents) are further columns.
module gyroakf_allan_fit_problem
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : digamma
   use gyroakf_allan_covariance, only : covariance_basis_type, mixture_covariances, mixture_freedom, new_covariance_basis
   use gyroakf_allan_noise_model, only : column_count, model_shape, model_variance, noise_model_type, term_markov, term_sinusoid
   use gyroakf_allan_nonnegative, only : solve_nonnegative
   implicit none (type, external)
   private
   public :: problem_type, prepare_basis, without_first, first_guess, minimise, model_at, relative_covariance, half_freedom
   public :: offered_terms, tangents_of, relative_columns, move_parameters, set_parameter, trigamma

   !> Everything the fit works on; times in samples, squares for a sample interval of 1
   type :: problem_type
      !> Samples of the record
      integer(int64) :: samples = 0
      !> Averaging factors of the points
      integer(int64), allocatable :: m(:)
      !> Variances in units of `scale`, their degrees of freedom as known before, the share of their terms that gaps left
      real(dp), allocatable :: variance(:), edf(:), complete(:)
      !> Unit of the variances
      real(dp) :: scale = 1.0_dp
      !> Which terms are offered, Q N B K R M S
      logical :: offered(column_count) = .false.
      !> Covariances of the variances of any mixture; with a Markov process of `basis%correlation_time` where one is offered
      type(covariance_basis_type) :: basis
      !> What a term must lower chi-square by to be chosen. In records of white noise, 1e4 and 2e5 samples, 5 lets some other term
      !> be found in 2 %, Q or R in 1 % (bench/allan_fit)
      real(dp) :: price = 5.0_dp
      !> Relative variance by which the points miss the model beyond their own scatter
      real(dp) :: misfit = 0.0_dp
   end type problem_type

   !> Steps of the fit at most
   integer, parameter :: steps_max = 200
   !> Relative change at which the fit has converged
   real(dp), parameter :: precision_goal = 1e-11_dp
   !> Share by which the sum of squares must fall in a step for another one to be worth while
   real(dp), parameter :: gain_least = 1e-10_dp
   !> Least relative variance of a point: a ramp alone has none
   real(dp), parameter :: variance_least = 2e-15_dp
   !> Least variance of a model, where a sinusoid has its zeros: the square of its reciprocal does not overflow
   real(dp), parameter :: model_least = 1e-100_dp
   !> Least degrees of freedom of a weight
   real(dp), parameter :: edf_least = 0.5_dp
   !> Step of the derivatives by the logarithm of a parameter, and largest move of such a logarithm at once
   real(dp), parameter :: tangent_step = 1e-4_dp, move_max = 0.3_dp

contains

   !> Computes the basis of the covariances for the problem's points and the model's Markov process.
   pure subroutine prepare_basis(problem, model)
      !> Its basis is renewed where it does not serve the model
      type(problem_type), intent(inout) :: problem
      !> For its correlation time, where a Markov process is offered
      type(noise_model_type), intent(in) :: model

      logical :: fits

      fits = allocated(problem%basis%m)
      if (fits) fits = size(problem%basis%m) == size(problem%m)
      if (problem%offered(term_markov)) then
         if (fits) fits = problem%basis%markov .and. abs(log(problem%basis%correlation_time/model%correlation_time)) < 1e-3_dp
         if (.not. fits) call new_covariance_basis(problem%samples, problem%m, problem%basis, model%correlation_time)
      else if (.not. fits) then
         call new_covariance_basis(problem%samples, problem%m, problem%basis)
      end if
   end subroutine prepare_basis

   !> The problem without its first points.
   pure function without_first(problem, left_out) result(rest)
      !> The problem
      type(problem_type), intent(in) :: problem
      !> How many points are left out
      integer, intent(in) :: left_out
      type(problem_type) :: rest

      rest%samples = problem%samples
      allocate (rest%m, source=problem%m(left_out + 1:))
      allocate (rest%variance, source=problem%variance(left_out + 1:))
      allocate (rest%edf, source=problem%edf(left_out + 1:))
      allocate (rest%complete, source=problem%complete(left_out + 1:))
      rest%scale = problem%scale
      rest%offered = problem%offered
      rest%price = problem%price
      rest%basis%samples = problem%samples
      rest%basis%markov = problem%basis%markov
      rest%basis%correlation_time = problem%basis%correlation_time
      allocate (rest%basis%m, source=rest%m)
      allocate (rest%basis%pair, source=problem%basis%pair(left_out + 1:, left_out + 1:))
   end function without_first

   !> A mixture to start from: weights from the degrees of freedom known before.
   !>
   !> Least squares relative to the variances themselves, then of their logarithms. The first alone can be far from the curve: a
   !> variance of one degree of freedom that is small by chance, a thousandth of what is expected, would forbid every term that
   !> is larger there.
   subroutine first_guess(problem, model, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Its squares are set, and its times, from those where they are, where such terms are offered
      type(noise_model_type), intent(inout) :: model
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      real(dp) :: weight(size(problem%m)), length(count(problem%offered))
      real(dp) :: design(size(problem%m), count(problem%offered)), x(count(problem%offered))
      type(noise_model_type) :: better
      type(error_type), allocatable :: failure
      integer :: term(count(problem%offered)), j
      logical :: converged

      term = offered_terms(problem)
      weight = sqrt(1/(2/max(problem%edf, edf_least) + problem%misfit))
      do j = 1, size(term)
         design(:, j) = weight*shape_at(problem, model, term(j))/problem%variance
         length(j) = norm2(design(:, j))
         design(:, j) = design(:, j)/length(j)
      end do
      call solve_nonnegative(design, weight, x, converged)
      model%squares = 0
      model%squares(term) = x/length
      if (.not. converged) then
         call fail_to_converge(error)
         return
      end if
      better = model
      call minimise(problem, .false., max(problem%edf, edf_least)/2, better, failure)
      if (.not. allocated(failure)) model = better
   end subroutine first_guess

   !> Finds the squares, and the parameters of the last two terms, that fit best with the weights of a given scatter.
   subroutine minimise(problem, linear, half, model, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Fit the variances instead of their logarithms
      logical, intent(in) :: linear
      !> Half the degrees of freedom of the points
      real(dp), intent(in) :: half(:)
      !> The start, and the result
      type(noise_model_type), intent(inout) :: model
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      real(dp), dimension(size(problem%m)) :: weight, bias, target, reference
      real(dp) :: change, gain
      logical :: converged
      integer :: step

      weight = 1/(1/half + problem%misfit)
      bias = digamma(half) - log(half)
      if (linear) bias = 0
      reference = model_at(problem, model)
      do step = 1, steps_max
         if (.not. linear) reference = model_at(problem, model)
         target = problem%variance/reference
         if (.not. linear) target = 1 + log(target) - bias
         call weighted_step(problem, linear, reference, weight, target, bias, model, change, gain, converged)
         if (.not. converged) exit
         if (change < precision_goal .or. gain < gain_least) return
      end do
      call fail_to_converge(error)
   end subroutine minimise

   !> Says so.
   subroutine fail_to_converge(error)
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%not_converged, "the fit of the noise coefficients did not converge")
   end subroutine fail_to_converge

   !> One non-negative step, shortened until the sum of squares falls most: where residuals are large full steps overshoot.
   subroutine weighted_step(problem, linear, reference, weight, target, bias, model, change, gain, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Fit the variances instead of their logarithms
      logical, intent(in) :: linear
      !> Variances to which everything is relative
      real(dp), intent(in) :: reference(:)
      !> Weights, what the relative model should be, biases of the logarithms
      real(dp), intent(in) :: weight(:), target(:), bias(:)
      !> The model, renewed
      type(noise_model_type), intent(inout) :: model
      !> Largest relative change of the model
      real(dp), intent(out) :: change
      !> By what share of itself the sum of squares fell
      real(dp), intent(out) :: gain
      !> False if a matrix was singular
      logical, intent(out) :: converged

      type(noise_model_type) :: before, full, trial
      integer :: term(count(problem%offered))
      integer, allocatable :: tangent(:)
      real(dp), allocatable :: columns(:, :), design(:, :), length(:), x(:)
      real(dp) :: merit, trial_merit, at_start
      integer :: j, n, p, halving

      term = offered_terms(problem)
      tangent = tangents_of(problem, model)
      n = size(term)
      p = size(tangent)
      call relative_columns(problem, model, reference, term, tangent, columns)
      allocate (design(size(target), n + 2*p), length(n + p), x(n + 2*p))
      do j = 1, n + p
         length(j) = norm2(sqrt(weight)*columns(:, j))
         design(:, j) = sqrt(weight)*columns(:, j)/length(j)
      end do
      design(:, n + p + 1:) = -design(:, n + 1:n + p)       ! an unknown of either sign is two that are not negative
      call solve_nonnegative(design, sqrt(weight)*target, x, converged)
      before = model
      full = model
      full%squares(term) = x(:n)/length(:n)
      call move_parameters(full, tangent, (x(n + 1:n + p) - x(n + p + 1:))/length(n + 1:), before)
      at_start = misfit_of(before)
      merit = huge(1.0_dp)
      do halving = 0, 30                                    ! as long as a shorter step is better, or needed
         trial = before
         trial%squares = before%squares + (full%squares - before%squares)*0.5_dp**halving
         trial%correlation_time = before%correlation_time*(full%correlation_time/before%correlation_time)**(0.5_dp**halving)
         trial%frequency = before%frequency*(full%frequency/before%frequency)**(0.5_dp**halving)
         trial_merit = misfit_of(trial)
         if (trial_merit >= merit .and. merit <= at_start*(1 + 1e-12_dp)) exit
         model = trial
         merit = trial_merit
      end do
      gain = (at_start - merit)/max(at_start, tiny(1.0_dp))
      change = maxval(abs(model%squares(term) - before%squares(term))*length(:n))/norm2(sqrt(weight)) &
         & + abs(log(model%correlation_time/before%correlation_time)) + abs(log(model%frequency/before%frequency))

   contains

      !> Weighted sum of squared residuals.
      real(dp) function misfit_of(trial)
         type(noise_model_type), intent(in) :: trial

         if (linear) then
            misfit_of = sum(weight*((problem%variance - model_at(problem, trial))/reference)**2)
         else
            misfit_of = sum(weight*(log(problem%variance/model_at(problem, trial)) - bias)**2)
         end if
      end function misfit_of

   end subroutine weighted_step

   !> Fitted variances at the points.
   pure function model_at(problem, model) result(variance)
      !> Points
      type(problem_type), intent(in) :: problem
      !> The mixture
      type(noise_model_type), intent(in) :: model
      real(dp) :: variance(size(problem%m))

      integer :: i

      do i = 1, size(variance)
         variance(i) = max(model_variance(model, real(problem%m(i), dp)), model_least)
      end do
   end function model_at

   !> Half the degrees of freedom of the points in a mixture.
   pure function half_freedom(problem, model) result(half)
      !> Points, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture
      type(noise_model_type), intent(in) :: model
      real(dp) :: half(size(problem%m))

      half = max(problem%complete*mixture_freedom(problem%basis, model), edf_least)/2
   end function half_freedom

   !> Covariance of the variances relative to the model, with that of a misfit.
   pure subroutine relative_covariance(problem, model, covariance)
      !> Points, with a basis for the model
      type(problem_type), intent(in) :: problem
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> The matrix: [points, points]
      real(dp), intent(out) :: covariance(:, :)

      real(dp) :: factor(size(problem%m))
      integer :: j

      call mixture_covariances(problem%basis, model, covariance)
      factor = 1/(model_at(problem, model)*sqrt(problem%complete))
      do j = 1, size(factor)
         covariance(:, j) = covariance(:, j)*factor*factor(j) &
            & + problem%misfit*exp(-abs(log(real(problem%m, dp)/real(problem%m(j), dp))))
         covariance(j, j) = max(covariance(j, j), variance_least)
      end do
   end subroutine relative_covariance

   !> Numbers of the terms that are offered.
   pure function offered_terms(problem) result(term)
      !> The problem
      type(problem_type), intent(in) :: problem
      integer :: term(count(problem%offered))

      integer :: j

      term = pack([(j, j=1, column_count)], problem%offered)
   end function offered_terms

   !> Numbers of the terms whose parameter is an unknown: those with one that the model has.
   pure function tangents_of(problem, model) result(tangent)
      !> The problem
      type(problem_type), intent(in) :: problem
      !> Its squares say
      type(noise_model_type), intent(in) :: model
      integer, allocatable :: tangent(:)

      integer :: j

      tangent = pack([(j, j=term_markov, term_sinusoid)], &
         & problem%offered(term_markov:) .and. model%squares(term_markov:) > 0)
   end function tangents_of

   !> Shapes of terms, and their tangents, relative to variances.
   subroutine relative_columns(problem, model, reference, term, tangent, columns)
      !> Points
      type(problem_type), intent(in) :: problem
      !> For its parameters, and the squares by which the tangents are multiplied
      type(noise_model_type), intent(in) :: model
      !> Variances to which everything is relative
      real(dp), intent(in) :: reference(:)
      !> Terms, and those whose tangent is wanted
      integer, intent(in) :: term(:), tangent(:)
      !> The matrix: [points, terms and tangents]
      real(dp), allocatable, intent(out) :: columns(:, :)

      type(noise_model_type) :: up, down
      integer :: j

      allocate (columns(size(reference), size(term) + size(tangent)))
      do j = 1, size(term)
         columns(:, j) = shape_at(problem, model, term(j))/reference
      end do
      do j = 1, size(tangent)
         up = model
         down = model
         call move_parameters(up, tangent(j:j), [tangent_step], model)
         call move_parameters(down, tangent(j:j), [-tangent_step], model)
         columns(:, size(term) + j) = model%squares(tangent(j))*(shape_at(problem, up, tangent(j)) &
            & - shape_at(problem, down, tangent(j)))/(2*tangent_step*reference)
      end do
   end subroutine relative_columns

   !> Shape of a term at the points.
   pure function shape_at(problem, model, term) result(values)
      !> Points
      type(problem_type), intent(in) :: problem
      !> For its parameters
      type(noise_model_type), intent(in) :: model
      !> Number of the term
      integer, intent(in) :: term
      real(dp) :: values(size(problem%m))

      values = model_shape(model, term, real(problem%m, dp))
   end function shape_at

   !> Moves the logarithms of parameters, by 0.3 at most.
   pure subroutine move_parameters(model, tangent, move, from)
      !> Its parameters are set
      type(noise_model_type), intent(inout) :: model
      !> Terms whose parameters move
      integer, intent(in) :: tangent(:)
      !> By how much
      real(dp), intent(in) :: move(:)
      !> Where they start
      type(noise_model_type), intent(in) :: from

      integer :: j

      do j = 1, size(tangent)
         call set_parameter(model, tangent(j), exp(max(-move_max, min(move_max, move(j))))* &
            & merge(from%correlation_time, from%frequency, tangent(j) == term_markov))
      end do
   end subroutine move_parameters

   !> Sets the correlation time or the frequency, within what they can be.
   pure subroutine set_parameter(model, term, value)
      !> The model
      type(noise_model_type), intent(inout) :: model
      !> Markov process or sinusoid
      integer, intent(in) :: term
      !> Samples, or cycles per sample
      real(dp), intent(in) :: value

      if (term == term_markov) then
         model%correlation_time = max(0.1_dp, value)
      else
         model%frequency = max(1e-12_dp, min(0.4999_dp, value))
      end if
   end subroutine set_parameter

   !> Derivative of digamma (Abramowitz & Stegun 6.4.6 and 6.4.12, to 1e-8).
   elemental real(dp) function trigamma(x)
      !> Argument, > 0
      real(dp), intent(in) :: x

      real(dp) :: y, q

      trigamma = 0
      y = x
      do while (y < 8)
         trigamma = trigamma + 1/y**2
         y = y + 1
      end do
      q = 1/y**2
      trigamma = trigamma + 1/y + q/2 + q/y*(1/6.0_dp - q*(1/30.0_dp - q*(1/42.0_dp - q/30)))
   end function trigamma

end module gyroakf_allan_fit_problem
