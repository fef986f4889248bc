! SPDX-License-Identifier: MIT
!> Noise coefficients from an Allan curve.
!>
!>     type(noise_options) :: options
!>     type(noise_type) :: noise
!>     call fit_noise(curve, options, noise, error)        ! noise%coefficient(2)%value is N
!>
!> The squared coefficients theta >= 0 minimise
!>
!> $$ \sum_i w_i \left( \ln \hat\sigma^2_i - b_i - \ln \sum_t \theta_t \phi_t(\tau_i) \right)^2, \quad
!>    w_i = \nu_i/2, \quad b_i = \psi(\nu_i/2) - \ln(\nu_i/2) $$
!>
!> where nu_i are the degrees of freedom of the i-th variance in the fitted mixture itself (from its analytic
!> covariance, no integer noise type) and b_i is the expectation of the logarithm of chi-square(nu)/nu. Weights taken from the
!> model and not from the data do not prefer points that happen to lie low. The minimum is found by non-negative
!> Gauss-Newton steps; the linear method fits the variances themselves with the same relative weights.
!>
!> Standard errors: the covariance of theta is the sandwich G C G' with the full covariance C of the variances,
!> because estimates at neighbouring averaging times are nearly the same; G belongs to the terms that came out positive
!> (and, for the error of one that came out as zero, that one). They pass to the coefficients by the derivative of the square root.
module gyroakf_allan_noise_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : digamma
   use gyroakf_allan_covariance, only : allan_covariance, allan_variance_covariances
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_fit_uncertainty, only : generalised_chi_square, sandwich_covariance
   use gyroakf_allan_noise_model, only : model_variance, term_count, term_letters, term_shape
   use gyroakf_allan_nonnegative, only : solve_nonnegative
   implicit none (type, external)
   private
   public :: noise_options, coefficient_type, noise_type, fit_noise

   !> What to fit
   type :: noise_options
      !> Letters of the terms, in any order
      character(5) :: terms = "QNBKR"
      !> Shortest and longest averaging time that the fit looks at, s
      real(dp) :: tau_min = 0.0_dp, tau_max = huge(1.0_dp)
      !> Reserved for limits of the coefficients; those of the curve have the curve's own
      real(dp) :: confidence = 0.683_dp
      !> "log": logarithms of the variances, their bias removed; "linear": the variances
      character(6) :: method = "log"
   end type noise_options

   !> A coefficient, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R: u/s)
   type :: coefficient_type
      !> The estimate, >= 0, and its standard error
      real(dp) :: value = 0.0_dp, std_error = 0.0_dp
      !> One-sided limit: the true value is below it with 95 % confidence
      real(dp) :: upper_limit = 0.0_dp
      !> The square is above two of its standard errors, which one in forty records shows without the term;
      !> the value is then above four standard errors
      logical :: detected = .false.
      !> The term was in the fit
      logical :: fitted = .false.
   end type coefficient_type

   !> The result
   type :: noise_type
      !> Q N B K R
      type(coefficient_type) :: coefficient(term_count)
      !> Chi-square per degree of freedom, with the full covariance; 0 where no freedom is left
      real(dp) :: chi2_reduced = 0.0_dp
      !> Averaging times that were fitted
      integer :: points = 0
      !> Fitted deviation at each averaging time of the curve
      real(dp), allocatable :: model(:)
      !> Degrees of freedom of chi2_reduced
      integer :: chi2_freedom = 0
   end type noise_type

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
      !> Which terms are offered: their numbers
      integer, allocatable :: term(:)
   end type problem_type

   !> Points of a fit at most; a denser curve is thinned evenly in the logarithm
   integer, parameter :: points_max = 80
   !> Steps of the fit at most, and how many of them renew the weights
   integer, parameter :: steps_max = 200, steps_renewing = 20
   !> Relative change at which the fit has converged
   real(dp), parameter :: precision_goal = 1e-11_dp
   !> Standard normal quantile of 95 %
   real(dp), parameter :: normal_95 = 1.6448536269514722_dp
   !> Least degrees of freedom of a weight
   real(dp), parameter :: edf_least = 0.5_dp

contains

   !> Fits the terms, and gives the curve the degrees of freedom and limits of the fitted mixture.
   subroutine fit_noise(curve, options, noise, error)
      !> From [[compute_allan]]; edf, lower and upper are replaced
      type(allan_curve_type), intent(inout) :: curve
      !> Terms, range of averaging times, method
      type(noise_options), intent(in) :: options
      !> Coefficients with errors, goodness of the fit
      type(noise_type), intent(out) :: noise
      !> invalid_argument, too_few_samples (fewer averaging times than terms), constant_input, not_converged, singular
      type(error_type), allocatable, intent(out) :: error

      type(problem_type) :: problem
      real(dp) :: squares(term_count), errors(term_count)

      call choose_terms(options, problem, error)
      if (.not. allocated(error)) call choose_points(curve, options, problem, error)
      if (allocated(error)) return
      call minimise(problem, options%method == "linear", squares, error)
      if (allocated(error)) return
      noise%points = size(problem%m)
      call assess(problem, options%method == "linear", squares, errors, noise, error)
      if (allocated(error)) return
      call state_coefficients(problem, squares, errors, curve%sample_interval, noise)
      call renew_limits(problem, squares, curve, noise)
   end subroutine fit_noise

   !> Reads the letters of the terms.
   subroutine choose_terms(options, problem, error)
      !> Options
      type(noise_options), intent(in) :: options
      !> Its terms are set
      type(problem_type), intent(inout) :: problem
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      integer :: i, term
      logical :: chosen(term_count)

      if (verify(trim(options%terms), term_letters) > 0 .or. options%terms == " ") then
         call fatal_error(error, status%invalid_argument, "terms '"//trim(options%terms)//"': letters of "//term_letters)
         return
      end if
      if (options%method /= "log" .and. options%method /= "linear") then
         call fatal_error(error, status%invalid_argument, "fit method '"//trim(options%method)//"': there are log and linear")
         return
      end if
      do i = 1, term_count
         chosen(i) = index(options%terms, term_letters(i:i)) > 0
      end do
      problem%term = pack([(term, term=1, term_count)], chosen)
   end subroutine choose_terms

   !> Takes the averaging times in the range, at most points_max of them.
   subroutine choose_points(curve, options, problem, error)
      !> The curve
      type(allan_curve_type), intent(in) :: curve
      !> Options
      type(noise_options), intent(in) :: options
      !> Its points are set
      type(problem_type), intent(inout) :: problem
      !> invalid_argument, too_few_samples, constant_input
      type(error_type), allocatable, intent(out) :: error

      integer, allocatable :: place(:)
      integer :: i
      character(160) :: text

      if (.not. (ieee_is_finite(options%tau_min) .and. ieee_is_finite(options%tau_max))) then
         call fatal_error(error, status%invalid_argument, "the range of averaging times of the fit must be finite")
         return
      end if
      if (.not. (allocated(curve%deviation) .and. allocated(curve%edf) .and. allocated(curve%terms))) then
         call fatal_error(error, status%invalid_argument, "the Allan curve is empty")
         return
      end if
      place = pack([(i, i=1, size(curve%m))], curve%tau >= options%tau_min*(1 - 1e-9_dp) &
         & .and. curve%tau <= options%tau_max)
      if (size(place) < size(problem%term)) then
         write (text, "(a, i0, a, i0)") "a fit of ", size(problem%term), " noise terms needs as many averaging times, there are ", &
            & size(place)
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      end if
      call thin(curve%m, place)
      if (any(curve%deviation(place) <= tiny(1.0_dp))) then
         call fatal_error(error, status%constant_input, "an Allan deviation is zero: the record does not vary")
         return
      end if
      problem%samples = curve%samples
      problem%m = curve%m(place)
      problem%scale = curve%deviation(place(1))**2
      problem%variance = (curve%deviation(place)/curve%deviation(place(1)))**2
      problem%edf = curve%edf(place)
      problem%complete = real(curve%terms(place), dp)/real(curve%samples - 2*problem%m + 1, dp)
   end subroutine choose_points

   !> Keeps at most points_max places, evenly in the logarithm of the averaging factor.
   pure subroutine thin(m, place)
      !> Averaging factors, ascending
      integer(int64), intent(in) :: m(:)
      !> Places in it, ascending; thinned on return
      integer, allocatable, intent(inout) :: place(:)

      integer :: kept(points_max), count, i
      real(dp) :: step, next

      if (size(place) <= points_max) return
      step = log(real(m(place(size(place))), dp)/real(m(place(1)), dp))/(points_max - 1)
      count = 0
      next = log(real(m(place(1)), dp))
      do i = 1, size(place)
         if (log(real(m(place(i)), dp)) < next - 1e-9_dp .or. count == points_max) cycle
         count = count + 1
         kept(count) = place(i)
         next = max(next + step, log(real(m(place(i)), dp)) + 0.5_dp*step)
      end do
      place = kept(:count)
   end subroutine thin

   !> Finds the squares that fit best.
   subroutine minimise(problem, linear, squares, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Fit the variances instead of their logarithms
      logical, intent(in) :: linear
      !> Squared coefficients, 0 for terms that are not offered
      real(dp), intent(out) :: squares(term_count)
      !> not_converged
      type(error_type), allocatable, intent(out) :: error

      real(dp), dimension(size(problem%m)) :: weight, bias, target, model
      real(dp) :: change
      logical :: converged
      integer :: step

      squares = 0
      weight = max(problem%edf, edf_least)/2
      target = 1
      call weighted_step(problem, problem%variance, weight, target, squares, change, converged)
      do step = 1, steps_max
         if (.not. converged) exit
         model = model_at(problem, squares)
         if (step <= steps_renewing) call weights_of_model(problem, squares, model, weight, bias)
         target = problem%variance/model
         if (linear) then
            call weighted_step(problem, model, weight, target, squares, change, converged)
         else
            target = 1 + log(target) - bias
            call weighted_step(problem, model, weight, target, squares, change, converged, bias)
         end if
         if (change < precision_goal .and. step > steps_renewing) return
      end do
      call fatal_error(error, status%not_converged, "the fit of the noise coefficients did not converge")
   end subroutine minimise

   !> Fitted variances at the points.
   pure function model_at(problem, squares) result(model)
      !> Points
      type(problem_type), intent(in) :: problem
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      real(dp) :: model(size(problem%m))

      integer :: i

      do i = 1, size(model)
         model(i) = max(model_variance(squares, real(problem%m(i), dp)), tiny(1.0_dp))
      end do
   end function model_at

   !> Weights nu/2 and biases of the logarithms from the model.
   pure subroutine weights_of_model(problem, squares, model, weight, bias)
      !> Points
      type(problem_type), intent(in) :: problem
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> Fitted variances
      real(dp), intent(in) :: model(:)
      !> Weights
      real(dp), intent(out) :: weight(:)
      !> Biases
      real(dp), intent(out) :: bias(:)

      integer :: i

      do i = 1, size(model)
         weight(i) = max(mixture_edf(problem%samples, problem%m(i), squares, problem%complete(i)), edf_least)/2
         bias(i) = digamma(weight(i)) - log(weight(i))
      end do
   end subroutine weights_of_model

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

   !> Degrees of freedom of a variance of the mixture.
   pure real(dp) function mixture_edf(samples, m, squares, complete) result(edf)
      !> Samples of the record
      integer(int64), intent(in) :: samples
      !> Averaging factor
      integer(int64), intent(in) :: m
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> Share of the terms that gaps left
      real(dp), intent(in) :: complete

      real(dp) :: variance

      variance = allan_covariance(samples, m, m, squares)
      edf = huge(1.0_dp)
      if (variance > 0) edf = complete*2*model_variance(squares, real(m, dp))**2/variance
      edf = min(edf, 1e15_dp)
   end function mixture_edf

   !> One non-negative step; with biases (logarithms) it is shortened until the sum of squares falls.
   subroutine weighted_step(problem, model, weight, target, squares, change, converged, bias)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Variances to which everything is relative
      real(dp), intent(in) :: model(:)
      !> Weights
      real(dp), intent(in) :: weight(:)
      !> What the relative model should be
      real(dp), intent(in) :: target(:)
      !> Squared coefficients, renewed
      real(dp), intent(inout) :: squares(term_count)
      !> Largest relative change of the model
      real(dp), intent(out) :: change
      !> False if a matrix was singular
      logical, intent(out) :: converged
      !> Biases of the logarithms
      real(dp), intent(in), optional :: bias(:)

      real(dp) :: design(size(model), size(problem%term)), length(size(problem%term)), x(size(problem%term))
      real(dp) :: before(term_count), full(term_count), merit
      integer :: halving

      call relative_design(problem, model, sqrt(weight), design, length)
      call solve_nonnegative(design, sqrt(weight)*target, x, converged)
      before = squares
      full = 0
      full(problem%term) = x/length
      squares = full
      if (present(bias)) then
         merit = sum(weight*(log(problem%variance/model) - bias)**2)
         do halving = 1, 30
            if (sum(weight*(log(problem%variance/model_at(problem, squares)) - bias)**2) <= merit*(1 + 1e-12_dp)) exit
            squares = before + (full - before)*0.5_dp**halving
         end do
      end if
      change = maxval(abs(squares(problem%term) - before(problem%term))*length)/norm2(sqrt(weight))
   end subroutine weighted_step

   !> Shapes of the terms relative to the model, columns of length 1.
   pure subroutine relative_design(problem, model, factor, design, length)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Variances to which everything is relative
      real(dp), intent(in) :: model(:)
      !> Multiplies each row
      real(dp), intent(in) :: factor(:)
      !> The matrix: [points, terms]
      real(dp), intent(out) :: design(:, :)
      !> By what each column was divided
      real(dp), intent(out) :: length(:)

      integer :: j

      do j = 1, size(problem%term)
         design(:, j) = factor*term_shape(problem%term(j), real(problem%m, dp))/model
         length(j) = norm2(design(:, j))
         design(:, j) = design(:, j)/length(j)
      end do
   end subroutine relative_design

   !> Standard errors of the squares, and chi-square of the fit.
   subroutine assess(problem, linear, squares, errors, noise, error)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> Their standard errors, 0 for terms that are not offered
      real(dp), intent(out) :: errors(term_count)
      !> Its chi-square is set
      type(noise_type), intent(inout) :: noise
      !> singular
      type(error_type), allocatable, intent(out) :: error

      real(dp) :: covariance(size(problem%m), size(problem%m)), design(size(problem%m), size(problem%term))
      real(dp) :: length(size(problem%term)), chi_square
      real(dp), dimension(size(problem%m)) :: model, weight, bias, factor
      integer, allocatable :: active(:)
      integer :: j
      logical :: converged

      model = model_at(problem, squares)
      call weights_of_model(problem, squares, model, weight, bias)
      call allan_variance_covariances(problem%samples, problem%m, squares, covariance)
      factor = 1/(model*sqrt(problem%complete))
      if (.not. linear) factor = factor*sqrt(weight*trigamma(weight))     ! the logarithm spreads more where nu is small
      do j = 1, size(model)
         covariance(:, j) = covariance(:, j)*factor*factor(j)
      end do
      call relative_design(problem, model, [(1.0_dp, j=1, size(model))], design, length)
      active = pack([(j, j=1, size(problem%term))], squares(problem%term) > 0)
      call errors_of_squares(problem, active, design, weight, covariance, length, errors, converged)
      if (.not. converged) then
         call fatal_error(error, status%singular, "the noise terms cannot be told apart at these averaging times")
         return
      end if
      call generalised_chi_square(log(problem%variance/model) - bias, design(:, active), covariance, chi_square, noise%chi2_freedom)
      if (noise%chi2_freedom > 0) noise%chi2_reduced = chi_square/noise%chi2_freedom
   end subroutine assess

   !> Standard errors of the squares: of a positive one among the positive ones, of a zero one as if it joined them.
   subroutine errors_of_squares(problem, active, design, weight, covariance, length, errors, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Columns of the positive terms
      integer, intent(in) :: active(:)
      !> Relative design with columns of length 1
      real(dp), intent(in) :: design(:, :)
      !> Weights and covariance of the relative variances
      real(dp), intent(in) :: weight(:), covariance(:, :)
      !> By what the columns were divided
      real(dp), intent(in) :: length(:)
      !> Standard errors, 0 for terms that are not offered
      real(dp), intent(out) :: errors(term_count)
      !> False if the columns are not independent
      logical, intent(out) :: converged

      real(dp) :: uncertainty(size(length), size(length))
      integer, allocatable :: set(:)
      integer :: j, k, n

      errors = 0
      converged = .true.
      do j = 1, size(length)
         set = active
         if (.not. any(active == j)) set = [active, j]
         n = size(set)
         call sandwich_covariance(design(:, set), weight, covariance, uncertainty(:n, :n), converged)
         if (.not. converged) return
         k = findloc(set, j, dim=1)
         errors(problem%term(j)) = sqrt(max(uncertainty(k, k), 0.0_dp))/length(j)
      end do
   end subroutine errors_of_squares

   !> Coefficients, errors and limits in the units of the curve.
   pure subroutine state_coefficients(problem, squares, errors, sample_interval, noise)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> Squared coefficients and their standard errors
      real(dp), intent(in) :: squares(term_count), errors(term_count)
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Its coefficients are set
      type(noise_type), intent(inout) :: noise

      real(dp), parameter :: power(term_count) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]
      real(dp) :: unit
      integer :: term, j

      do j = 1, size(problem%term)
         term = problem%term(j)
         unit = sqrt(problem%scale)*sample_interval**power(term)
         associate (c => noise%coefficient(term))
            c%fitted = .true.
            c%value = unit*sqrt(squares(term))
            c%std_error = unit*sqrt(errors(term))
            if (squares(term) > errors(term)/4) c%std_error = unit*errors(term)/(2*sqrt(squares(term)))
            c%upper_limit = unit*sqrt(squares(term) + normal_95*errors(term))
            c%detected = squares(term) > 2*errors(term)
         end associate
      end do
   end subroutine state_coefficients

   !> Model, degrees of freedom and limits at every averaging time of the curve.
   subroutine renew_limits(problem, squares, curve, noise)
      !> Points
      type(problem_type), intent(in) :: problem
      !> Squared coefficients
      real(dp), intent(in) :: squares(term_count)
      !> The curve
      type(allan_curve_type), intent(inout) :: curve
      !> Its model is set
      type(noise_type), intent(inout) :: noise

      real(dp), allocatable :: known(:), lag(:)
      real(dp) :: complete
      integer, allocatable :: place(:)
      integer :: i, points

      points = size(curve%m)
      allocate (noise%model(points))
      place = [(i, i=1, points)]
      call thin(curve%m, place)
      allocate (known(size(place)), lag(size(place)))
      do i = 1, size(place)
         lag(i) = log(real(curve%m(place(i)), dp))
         known(i) = log(mixture_edf(curve%samples, curve%m(place(i)), squares, 1.0_dp))
      end do
      do i = 1, points
         complete = real(curve%terms(i), dp)/real(curve%samples - 2*curve%m(i) + 1, dp)
         noise%model(i) = sqrt(problem%scale*model_variance(squares, real(curve%m(i), dp)))
         curve%edf(i) = complete*exp(between(lag, known, log(real(curve%m(i), dp))))
      end do
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine renew_limits

   !> Linear interpolation, constant outside.
   pure real(dp) function between(x, y, at)
      !> Ascending places and values there
      real(dp), intent(in) :: x(:), y(:)
      !> Where
      real(dp), intent(in) :: at

      integer :: i

      i = count(x <= at)
      if (i == 0) then
         between = y(1)
      else if (i == size(x)) then
         between = y(i)
      else
         between = y(i) + (at - x(i))/(x(i + 1) - x(i))*(y(i + 1) - y(i))
      end if
   end function between

end module gyroakf_allan_noise_fit
