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
!>
!> Where chi-square says that the terms cannot make the curve (a resonance, a first-order Markov process), the many degrees of
!> freedom of the short times would fix the fit to a shape that is wrong anyhow. The points are then granted a relative
!> variance s^2 of their own, the same for all and as large as they ask for: w_i = 1/(2/nu_i + s^2), C_ij +
!> s^2 exp(-|ln tau_i/tau_j|). The standard errors grow with it.
module gyroakf_allan_noise_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_covariance, only : allan_variance_covariances
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_deviations, only : allan_curve_type, terms_share
   use gyroakf_allan_fit_problem, only : minimise, mixture_edf, model_at, problem_type, relative_design, scatter_of_model, trigamma
   use gyroakf_allan_fit_uncertainty, only : generalised_chi_square, sandwich_covariance
   use gyroakf_allan_noise_model, only : model_variance, term_count, term_letters
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
      !> Relative standard deviation of the variances from the model beyond their own scatter, 0 where the model fits
      real(dp) :: misfit = 0.0_dp
   end type noise_type

   !> Points of a fit at most; a denser curve is thinned evenly in the logarithm
   integer, parameter :: points_max = 80
   !> Chi-square per degree of freedom above which a model is taken as wrong, and rounds that adapt the weights then
   real(dp), parameter :: chi2_wrong = 5.0_dp
   integer, parameter :: misfit_rounds = 30
   !> Standard normal quantile of 95 %
   real(dp), parameter :: normal_95 = 1.6448536269514722_dp

contains

   !> Fits the terms, and gives the curve the degrees of freedom and limits of the fitted mixture.
   subroutine fit_noise(curve, options, noise, error)
      !> From [[compute_allan]], kind oadev; edf, lower and upper are replaced (by larger limits only, where the model does not fit)
      type(allan_curve_type), intent(inout) :: curve
      !> Terms, range of averaging times, method
      type(noise_options), intent(in) :: options
      !> Coefficients with errors, goodness of the fit
      type(noise_type), intent(out) :: noise
      !> invalid_argument, too_few_samples (fewer averaging times than terms), constant_input, not_converged, singular
      type(error_type), allocatable, intent(out) :: error

      type(problem_type) :: problem
      real(dp) :: squares(term_count), errors(term_count)
      logical :: linear

      if (curve%kind /= "oadev") then
         call fatal_error(error, status%invalid_argument, "the noise terms are fitted to a curve of kind oadev, this one is "// &
            & trim(curve%kind))
         return
      end if
      call choose_terms(options, problem, error)
      if (.not. allocated(error)) call choose_points(curve, options, problem, error)
      if (allocated(error)) return
      linear = options%method == "linear"
      call minimise(problem, linear, squares, error)
      if (allocated(error)) return
      noise%points = size(problem%m)
      call assess(problem, linear, squares, errors, noise, error)
      if (allocated(error)) return
      if (noise%chi2_reduced > chi2_wrong) call admit_misfit(problem, linear, squares, errors, noise, error)
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

      real(dp), allocatable :: share(:)
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
      share = terms_share(curve)
      problem%complete = share(place)
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
      real(dp), dimension(size(problem%m)) :: model, half, bias, factor
      integer, allocatable :: active(:)
      integer :: j
      logical :: converged

      model = model_at(problem, squares)
      call scatter_of_model(problem, squares, half, bias)
      call allan_variance_covariances(problem%samples, problem%m, squares, covariance)
      factor = 1/(model*sqrt(problem%complete))
      if (.not. linear) factor = factor*sqrt(half*trigamma(half))     ! the logarithm spreads more where nu is small
      do j = 1, size(model)
         covariance(:, j) = covariance(:, j)*factor*factor(j) &
            & + problem%misfit*exp(-abs(log(real(problem%m, dp)/real(problem%m(j), dp))))
      end do
      call relative_design(problem, model, [(1.0_dp, j=1, size(model))], design, length)
      active = pack([(j, j=1, size(problem%term))], squares(problem%term) > 0)
      call errors_of_squares(problem, active, design, 1/(1/half + problem%misfit), covariance, length, errors, converged)
      if (.not. converged) then
         call fatal_error(error, status%singular, "the noise terms cannot be told apart at these averaging times")
         return
      end if
      call generalised_chi_square(log(problem%variance/model) - bias, design(:, active), covariance, chi_square, noise%chi2_freedom)
      if (noise%chi2_freedom > 0) noise%chi2_reduced = chi_square/noise%chi2_freedom
   end subroutine assess

   !> Grants the points a variance of their own until they scatter as they should, and fits again.
   subroutine admit_misfit(problem, linear, squares, errors, noise, error)
      !> Points and terms; its misfit is set
      type(problem_type), intent(inout) :: problem
      !> The variances are fitted, not their logarithms
      logical, intent(in) :: linear
      !> Squared coefficients and their standard errors
      real(dp), intent(inout) :: squares(term_count), errors(term_count)
      !> Its misfit is set; its chi-square stays that without misfit
      type(noise_type), intent(inout) :: noise
      !> not_converged, singular
      type(error_type), allocatable, intent(out) :: error

      type(noise_type) :: ignored
      real(dp), dimension(size(problem%m)) :: half, bias, model
      real(dp) :: before
      integer :: round

      do round = 1, misfit_rounds
         model = model_at(problem, squares)
         call scatter_of_model(problem, squares, half, bias)
         before = problem%misfit
         if (linear) then
            problem%misfit = extra_variance(problem%variance/model - 1, 1/half, count(squares > 0))
         else
            problem%misfit = extra_variance(log(problem%variance/model) - bias, 1/half, count(squares > 0))
         end if
         call minimise(problem, linear, squares, error)
         if (allocated(error)) return
         if (abs(problem%misfit - before) <= 1e-3_dp*problem%misfit) exit
      end do
      noise%misfit = sqrt(problem%misfit)
      if (problem%misfit > 0) call assess(problem, linear, squares, errors, ignored, error)
   end subroutine admit_misfit

   !> The variance s^2 with which the sum of e^2/(v + s^2) is the number of points less that of the unknowns.
   pure real(dp) function extra_variance(residual, variance, unknowns) result(extra)
      !> e: [points]
      real(dp), intent(in) :: residual(:)
      !> v: [points]
      real(dp), intent(in) :: variance(:)
      !> How many were fitted
      integer, intent(in) :: unknowns

      real(dp) :: low, high, freedom
      integer :: round

      extra = 0
      freedom = real(max(1, size(residual) - unknowns), dp)
      if (sum(residual**2/variance) <= freedom) return
      low = 0
      high = sum(residual**2)/freedom
      do round = 1, 60
         extra = (low + high)/2
         if (sum(residual**2/(variance + extra)) > freedom) then
            low = extra
         else
            high = extra
         end if
      end do
   end function extra_variance

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
      real(dp), allocatable :: columns(:, :)
      integer, allocatable :: set(:)
      integer :: j, k, n

      errors = 0
      converged = .true.
      do j = 1, size(length)
         set = active
         if (.not. any(active == j)) set = [active, j]
         n = size(set)
         columns = design(:, set)
         call sandwich_covariance(columns, weight, covariance, uncertainty(:n, :n), converged)
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
      real(dp) :: share(size(curve%m)), edf
      integer, allocatable :: place(:)
      integer :: i, points

      points = size(curve%m)
      share = terms_share(curve)
      allocate (noise%model(points))
      place = [(i, i=1, points)]
      call thin(curve%m, place)
      allocate (known(size(place)), lag(size(place)))
      do i = 1, size(place)
         lag(i) = log(real(curve%m(place(i)), dp))
         known(i) = log(mixture_edf(curve%samples, curve%m(place(i)), squares, 1.0_dp))
      end do
      do i = 1, points
         noise%model(i) = sqrt(problem%scale*model_variance(squares, real(curve%m(i), dp)))
         edf = share(i)*exp(between(lag, known, log(real(curve%m(i), dp))))
         if (problem%misfit > 0) edf = min(edf, curve%edf(i))
         curve%edf(i) = edf
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
