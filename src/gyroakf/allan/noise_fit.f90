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
!> where nu_i are the degrees of freedom of the i-th variance in the mixture of the terms that the curve asks for
!> ([[gyroakf_allan_term_selection]]), from its analytic covariance, no integer noise type; b_i is the expectation of the
!> logarithm of chi-square(nu)/nu. Weights taken from a model and not from the data do not prefer points that happen to lie low.
!> The minimum is found by non-negative Gauss-Newton steps; the linear method fits the variances themselves with the same
!> relative weights. Only chosen terms are in this fit ([[gyroakf_allan_fit_statement]] says why); of the others there is a limit.
!>
!> Standard errors are those of estimates drawn with the full covariance of the variances, because estimates at neighbouring
!> averaging times are nearly the same, and with the bounds of the fit, because a term that often comes out as zero
!> scatters less than the sandwich formula says ([[draw_estimates]]). Limits are inverted tests ([[upper_limit_of]]).
!>
!> Where chi-square says that no description holds ([[gyroakf_allan_description]]), the many degrees of
!> freedom of the short times would fix the fit to a shape that is wrong anyhow. The points are then granted a relative
!> variance s^2 of their own, the same for all and as large as they ask for: w_i = 1/(2/nu_i + s^2), C_ij +
!> s^2 exp(-|ln tau_i/tau_j|). The standard errors grow with it.
module gyroakf_allan_noise_fit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_allan_description, only : description_type, describe_curve
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_fit_points, only : choose_points, choose_terms, noise_options
   use gyroakf_allan_fit_problem, only : half_freedom, minimise, model_at, problem_type
   use gyroakf_allan_fit_statement, only : coefficient_type, noise_type, state_coefficients
   use gyroakf_allan_mixture_limits, only : give_mixture_limits
   use gyroakf_allan_noise_model, only : model_variance, noise_model_type
   use gyroakf_allan_term_selection, only : acceptable, normal_residuals, select_terms
   use gyroakf_special, only : digamma
   implicit none (type, external)
   private
   public :: noise_options, coefficient_type, noise_type, fit_noise

   !> Chi-square per degree of freedom above which a model is taken as wrong, and rounds that adapt the weights then
   real(dp), parameter :: chi2_wrong = 5.0_dp
   integer, parameter :: misfit_rounds = 20
   !> Standard deviations by which a point is said to miss the model
   real(dp), parameter :: conspicuous = 3.0_dp
   !> The stage that progress is told of
   character(*), parameter :: told = "noise coefficients"

contains

   !> Fits the terms, and gives the curve the degrees of freedom and limits of the fitted mixture.
   subroutine fit_noise(curve, options, noise, error, progress)
      !> From [[compute_allan]], kind oadev; edf, lower and upper are replaced (by larger limits only where the
      !> model does not fit, and at points left out)
      type(allan_curve_type), intent(inout) :: curve
      !> Terms, range of averaging times, method
      type(noise_options), intent(in) :: options
      !> Coefficients with errors, goodness of the fit
      type(noise_type), intent(out) :: noise
      !> invalid_argument, too_few_samples (fewer averaging times than terms), constant_input, not_converged, singular, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told between the steps; may cancel
      class(progress_type), intent(inout), optional :: progress

      type(problem_type) :: problem
      type(description_type) :: description
      type(noise_model_type) :: fitted
      logical :: automatic
      integer :: i

      call choose_terms(options, problem%offered, automatic, error)
      if (.not. allocated(error)) call choose_points(curve, options, problem, error)
      if (.not. allocated(error)) call tell_progress(told, 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call describe_curve(problem, automatic, options%further_terms, description, error)
      if (.not. allocated(error)) call tell_progress(told, 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call judge(problem, curve, description, noise)
      if (noise%chi2_reduced > chi2_wrong) call admit_misfit(description)
      noise%misfit = sqrt(description%problem%misfit)
      call tell_progress(told, 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call state_coefficients(description, options%method == "linear", curve%sample_interval, &
         & fitted, noise, error)
      if (.not. allocated(error)) call tell_progress(told, 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      noise%model = [(sqrt(description%problem%scale*model_variance(fitted, real(curve%m(i), dp))), i=1, size(curve%m))]
      call give_mixture_limits(curve, noise)
   end subroutine fit_noise

   !> Goodness of the description, and the points that spoil it.
   subroutine judge(problem, curve, description, noise)
      !> With all points
      type(problem_type), intent(in) :: problem
      !> For the averaging times
      type(allan_curve_type), intent(in) :: curve
      !> The description
      type(description_type), intent(in) :: description
      !> Its goodness is set
      type(noise_type), intent(inout) :: noise

      associate (selection => description%selection)
         noise%points = size(description%problem%m)
         noise%left_out = description%left_out
         noise%tau_first = curve%sample_interval*real(description%problem%m(1), dp)
         noise%tau_last = curve%sample_interval*real(description%problem%m(noise%points), dp)
         noise%price = description%problem%price
         noise%share = sum(description%problem%complete)/noise%points
         noise%chi2_freedom = selection%freedom
         noise%chi2_probability = selection%probability
         noise%acceptable = acceptable(selection)
         if (selection%freedom > 0) noise%chi2_reduced = selection%chi_square/selection%freedom
         noise%tau = curve%sample_interval*real(problem%m, dp)
         noise%residual = [spread(0.0_dp, 1, description%left_out), normal_residuals(description%problem, selection%model)]
         noise%conspicuous = abs(noise%residual) > conspicuous
      end associate
   end subroutine judge

   !> Grants the points a variance of their own until they scatter as they should, and chooses again.
   subroutine admit_misfit(description)
      !> Its misfit is set, its choice renewed
      type(description_type), intent(inout) :: description

      type(noise_model_type) :: start
      type(error_type), allocatable :: failure
      real(dp), dimension(size(description%problem%m)) :: model, half
      real(dp) :: before
      integer :: round

      associate (problem => description%problem, selection => description%selection)
         do round = 1, misfit_rounds
            model = model_at(problem, selection%model)
            half = half_freedom(problem, selection%model)
            before = problem%misfit
            problem%misfit = extra_variance(log(problem%variance/model) - digamma(half) + log(half), 1/half, &
               & count(selection%chosen))
            start = selection%model
            call minimise(problem, .false., half, start, failure)
            if (allocated(failure)) start = selection%model
            call select_terms(problem, start, selection)
            if (abs(problem%misfit - before) <= 1e-2_dp*problem%misfit) exit
         end do
      end associate
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

end module gyroakf_allan_noise_fit
