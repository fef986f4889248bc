! SPDX-License-Identifier: MIT
!> The result of a noise fit: coefficients, their errors and limits in the units of the curve and seconds.
!>
!> Values and errors are those of a fit of the chosen terms alone. With every term on offer in it, those that are not there,
!> which cannot become negative, take on average a little of those that are, and intervals cover less than they say. What the
!> choice leaves out is too faint to bend the others by as much: `validation/run.sh coefficients` prints how far each is off and
!> how often its interval holds.
!>
!> A chosen term counts as detected if it stays above its error where all are fitted, too. Where two explain the curve as
!> well, such as K and R, the choice falls on either by chance; the fit of all then has little of it, and neither is claimed.
!>
!> The limit of a detected term is tested among the chosen ones; that of another one among these and among all on offer, and
!> the larger is stated: it must hold whatever else is hidden.
module gyroakf_allan_fit_statement
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_description, only : description_type
   use gyroakf_allan_fit_errors, only : errors_of, fit_errors_type, free_errors_of
   use gyroakf_allan_fit_problem, only : half_freedom, minimise, problem_type
   use gyroakf_allan_noise_model, only : column_count, noise_model_type, term_count, term_markov, term_sinusoid
   use gyroakf_allan_term_selection, only : upper_limit_of
   implicit none (type, external)
   private
   public :: coefficient_type, noise_type, state_coefficients

   !> A coefficient, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R: u/s)
   type :: coefficient_type
      !> The estimate, >= 0, and its standard error; of a term that is not detected the root of the error of its square beside
      !> the chosen terms, every square free to be negative. Of a term that was not chosen the value is 0: the fitted curve is
      !> without it
      real(dp) :: value = 0.0_dp, std_error = 0.0_dp
      !> One-sided limit: the true value is below it with 95 % confidence
      real(dp) :: upper_limit = 0.0_dp
      !> The curve asks for the term (without it chi-square is larger by more than 5, which chance does in one of eighty
      !> records), and the square is above half its standard error, the coefficient thus above its own, also where all terms on
      !> offer are fitted (where points were left out: by more than 8, and above the whole)
      logical :: detected = .false.
      !> The term was on offer
      logical :: fitted = .false.
   end type coefficient_type

   !> The result
   type :: noise_type
      !> Q N B K R
      type(coefficient_type) :: coefficient(term_count)
      !> Covariance of these estimates, in the product of their units: their standard errors as stated, times the correlation of the
      !> estimates with the bounds of the fit where both were chosen, 0 elsewhere
      real(dp) :: covariance(term_count, term_count) = 0.0_dp
      !> First-order Markov process: strength q_c of its driving noise (u/sqrt(s)); fitted only where the others do not describe
      !> the curve, or on request. The limit is that of a normal estimate
      type(coefficient_type) :: markov
      !> Its correlation time and standard error in s, 0 where it was not fitted
      real(dp) :: correlation_time = 0.0_dp, correlation_time_error = 0.0_dp
      !> Sinusoid: amplitude (u); its frequency and standard error in Hz
      type(coefficient_type) :: sinusoid
      real(dp) :: frequency = 0.0_dp, frequency_error = 0.0_dp
      !> Chi-square of the chosen terms per degree of freedom, with the full covariance; 0 where no freedom is left
      real(dp) :: chi2_reduced = 0.0_dp
      !> Degrees of freedom, and the chance of a chi-square as large
      integer :: chi2_freedom = 0
      real(dp) :: chi2_probability = 1.0_dp
      !> Chance may explain it: the probability is above 1e-4
      logical :: acceptable = .true.
      !> Of the curve, s
      real(dp) :: sample_interval = 1.0_dp
      !> Averaging times that were fitted; first points left out because a filter bends them; first and last averaging
      !> time fitted, s
      integer :: points = 0, left_out = 0
      real(dp) :: tau_first = 0.0_dp, tau_last = 0.0_dp
      !> What a term had to lower chi-square by to be chosen
      real(dp) :: price = 5.0_dp
      !> Mean share of their terms that gaps left
      real(dp) :: share = 1.0_dp
      !> Averaging times in the range of the fit, s; distance of the curve from the chosen terms there in standard
      !> deviations, 0 where left out; whether that is conspicuous
      real(dp), allocatable :: tau(:), residual(:)
      logical, allocatable :: conspicuous(:)
      !> Fitted deviation at each averaging time of the curve
      real(dp), allocatable :: model(:)
      !> Relative standard deviation of the variances from the model beyond their own scatter, 0 where the model fits
      real(dp) :: misfit = 0.0_dp
      !> The chosen mixture for a sample interval of 1, in the square of the curve's unit
      type(noise_model_type) :: mixture
   end type noise_type

   !> Standard errors that the square of a detected term is above at least: of all points, and where points were left out
   real(dp), parameter :: least_sizes(2) = [0.5_dp, 1.0_dp]
   !> Standard normal quantile of 95 %
   real(dp), parameter :: normal_95 = 1.6448536269514722_dp

   !> What the coefficients are stated from
   type :: fits_type
      !> The variances are fitted, not their logarithms
      logical :: linear = .false.
      !> Standard errors that the square of a detected term is above
      real(dp) :: least_size = 0.0_dp
      !> All terms that are offered, and the chosen ones
      type(problem_type) :: whole, among
      !> The choice, and the fit of its terms with errors
      type(noise_model_type) :: chosen, fitted
      type(fit_errors_type) :: errors
      !> Which chosen terms are above their errors in the fit of all, too
      logical :: agreed(column_count) = .false.
   end type fits_type

   !> Powers of the sample interval in the units of Q N B K R
   real(dp), parameter :: power(term_count) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]

contains

   !> Fits the chosen terms and states all that are offered in the units of the curve.
   subroutine state_coefficients(description, linear, sample_interval, fitted, noise, error)
      !> Points, terms, choice
      type(description_type), intent(in) :: description
      !> The variances are fitted, not their logarithms
      logical, intent(in) :: linear
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> The fitted mixture
      type(noise_model_type), intent(out) :: fitted
      !> Its coefficients are set
      type(noise_type), intent(inout) :: noise
      !> not_converged, singular
      type(error_type), allocatable, intent(out) :: error

      type(fits_type) :: fits
      integer :: term

      call fit_both(description, linear, fits, error)
      if (allocated(error)) return
      fitted = fits%fitted
      noise%sample_interval = sample_interval
      noise%mixture = fits%chosen
      noise%mixture%squares = fits%chosen%squares*fits%whole%scale
      do term = 1, term_count
         if (.not. fits%whole%offered(term)) cycle
         call state_term(fits, term, sqrt(fits%whole%scale)*sample_interval**power(term), noise%coefficient(term), error)
         if (allocated(error)) return
      end do
      associate (stated => noise%coefficient%std_error)
         do term = 1, term_count
            noise%covariance(:, term) = fits%errors%correlation(:term_count, term)*(stated*stated(term))
            noise%covariance(term, term) = stated(term)**2
         end do
      end associate
      call state_further_terms(fits, noise)
   end subroutine state_coefficients

   !> Fits the chosen terms, and all that are offered: whether both agree.
   subroutine fit_both(description, linear, fits, error)
      !> Points, terms, choice
      type(description_type), intent(in) :: description
      !> The variances are fitted, not their logarithms
      logical, intent(in) :: linear
      !> The fits
      type(fits_type), intent(out) :: fits
      !> not_converged, singular
      type(error_type), allocatable, intent(out) :: error

      type(noise_model_type) :: all_fitted
      real(dp) :: free(column_count)
      logical :: converged

      fits%linear = linear
      fits%least_size = least_sizes(merge(1, 2, description%left_out == 0))
      fits%chosen = description%selection%model
      fits%whole = description%problem
      associate (found => description%selection%chosen, whole => fits%whole, among => fits%among)
         whole%offered(term_markov:) = found(term_markov:)  ! further terms only where they were chosen
         if (.not. any(whole%offered)) then
            call fatal_error(error, status%not_converged, "the curve has none of the noise terms that were asked for")
            return
         end if
         among = whole
         if (any(found)) among%offered = found
         all_fitted = fits%chosen
         call minimise(whole, linear, half_freedom(whole, fits%chosen), all_fitted, error)
         if (allocated(error)) return
         call free_errors_of(whole, linear, fits%chosen, all_fitted, free, converged)
         fits%agreed = found .and. all_fitted%squares > fits%least_size*free
         fits%fitted = fits%chosen
         if (converged) call minimise(among, linear, half_freedom(among, fits%chosen), fits%fitted, error)
         if (allocated(error)) return
         if (converged) call errors_of(among, linear, fits%chosen, fits%fitted, fits%errors, converged)
         if (.not. converged) call say_singular(error)
      end associate
   end subroutine fit_both

   !> A term: in the fit of the chosen ones, or what could hide beside them.
   subroutine state_term(fits, term, unit, coefficient, error)
      !> The fits
      type(fits_type), intent(in) :: fits
      !> The term
      integer, intent(in) :: term
      !> Unit of its coefficient
      real(dp), intent(in) :: unit
      !> The coefficient
      type(coefficient_type), intent(out) :: coefficient
      !> singular
      type(error_type), allocatable, intent(out) :: error

      type(problem_type) :: with
      real(dp) :: free(column_count), limit
      logical :: converged

      with = fits%among
      with%offered(term) = .true.
      free = fits%errors%square
      if (.not. fits%among%offered(term)) then
         call free_errors_of(with, fits%linear, fits%chosen, fits%fitted, free, converged)
         if (.not. converged) then
            call say_singular(error)
            return
         end if
      end if
      limit = upper_limit_of(with, fits%chosen, term, 2*free(term))
      associate (c => coefficient, square => fits%fitted%squares(term))
         c%fitted = .true.
         c%detected = fits%agreed(term) .and. square > fits%least_size*free(term)
         c%value = unit*sqrt(square)
         if (c%detected) then
            c%std_error = unit*fits%errors%coefficient(term)
            c%upper_limit = unit*sqrt(max(limit, square))   ! the test is of another fit than the value
         else
            c%std_error = unit*sqrt(free(term))
            c%upper_limit = unit*sqrt(max(limit, upper_limit_of(fits%whole, fits%chosen, term, 2*free(term))))
         end if
      end associate
   end subroutine state_term

   !> States a Markov process and a sinusoid.
   subroutine state_further_terms(fits, noise)
      !> The fits
      type(fits_type), intent(in) :: fits
      !> Its further terms are set
      type(noise_type), intent(inout) :: noise

      real(dp) :: unit

      unit = sqrt(fits%whole%scale)
      associate (interval => noise%sample_interval, fitted => fits%fitted, errors => fits%errors)
         if (fits%whole%offered(term_markov)) then
            noise%correlation_time = fitted%correlation_time*interval
            noise%correlation_time_error = noise%correlation_time*errors%parameter(term_markov)
            call state_further(sqrt(2*fitted%squares(term_markov)/fitted%correlation_time)*unit/sqrt(interval), &
               & errors%coefficient(term_markov)*unit/sqrt(interval), fitted%squares(term_markov) > 0, noise%markov)
         end if
         if (fits%whole%offered(term_sinusoid)) then
            noise%frequency = fitted%frequency/interval
            noise%frequency_error = noise%frequency*errors%parameter(term_sinusoid)
            call state_further(sqrt(fitted%squares(term_sinusoid))*unit, errors%coefficient(term_sinusoid)*unit, &
               & fitted%squares(term_sinusoid) > 0, noise%sinusoid)
         end if
      end associate
   end subroutine state_further_terms

   !> Says so.
   subroutine say_singular(error)
      !> singular
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%singular, "the noise terms cannot be told apart at these averaging times")
   end subroutine say_singular

   !> A further term as a coefficient.
   pure subroutine state_further(value, error, there, coefficient)
      !> Value and standard error
      real(dp), intent(in) :: value, error
      !> The fit has it
      logical, intent(in) :: there
      !> The coefficient
      type(coefficient_type), intent(out) :: coefficient

      coefficient%fitted = .true.
      coefficient%detected = there
      coefficient%value = value
      coefficient%std_error = error
      coefficient%upper_limit = value + normal_95*error
   end subroutine state_further

end module gyroakf_allan_fit_statement
