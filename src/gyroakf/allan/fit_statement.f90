! SPDX-License-Identifier: MIT
!> The result of a noise fit: coefficients, their errors and limits in the units of the curve and seconds.
module gyroakf_allan_fit_statement
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_description, only : description_type
   use gyroakf_allan_fit_problem, only : half_freedom, model_at, offered_terms, problem_type, relative_columns, &
      & relative_covariance, tangents_of, trigamma
   use gyroakf_allan_fit_uncertainty, only : draw_estimates, sandwich_covariance
   use gyroakf_allan_noise_model, only : column_count, noise_model_type, term_count, term_markov, term_sinusoid
   use gyroakf_allan_term_selection, only : upper_limit_of
   implicit none (type, external)
   private
   public :: coefficient_type, noise_type, state_coefficients

   !> A coefficient, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R: u/s)
   type :: coefficient_type
      !> The estimate, >= 0, and its standard error; of a term that is not detected the root of the error of its square,
      !> every square free to be negative
      real(dp) :: value = 0.0_dp, std_error = 0.0_dp
      !> One-sided limit: the true value is below it with 95 % confidence
      real(dp) :: upper_limit = 0.0_dp
      !> The curve asks for the term (without it chi-square is larger by more than 5, which chance does in one of eighty
      !> records), and the square is above half its standard error, the coefficient thus above its own (where points were left out:
      !> by more than 8, and above the whole)
      logical :: detected = .false.
      !> The term was in the fit
      logical :: fitted = .false.
   end type coefficient_type

   !> The result
   type :: noise_type
      !> Q N B K R
      type(coefficient_type) :: coefficient(term_count)
      !> Covariance of these estimates, in the product of their units, where both were fitted, 0 elsewhere: their standard errors
      !> as stated, times the correlation of the estimates with the bounds of the fit
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

contains

   !> Coefficients, errors and limits in the units of the curve.
   subroutine state_coefficients(description, linear, fitted, sample_interval, noise, error)
      !> Points, terms, choice
      type(description_type), intent(in) :: description
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> The fitted mixture
      type(noise_model_type), intent(in) :: fitted
      !> Seconds
      real(dp), intent(in) :: sample_interval
      !> Its coefficients are set
      type(noise_type), intent(inout) :: noise
      !> singular
      type(error_type), allocatable, intent(out) :: error

      real(dp), parameter :: power(term_count) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]
      real(dp) :: errors(column_count), free_errors(column_count), parameter_errors(column_count), unit, least_size
      real(dp) :: correlation(column_count, column_count)
      integer :: term
      logical :: converged

      associate (problem => description%problem, chosen => description%selection%model)
         call errors_of(problem, linear, chosen, fitted, errors, free_errors, parameter_errors, correlation, converged)
         if (.not. converged) then
            call fatal_error(error, status%singular, "the noise terms cannot be told apart at these averaging times")
            return
         end if
         noise%sample_interval = sample_interval
         least_size = least_sizes(merge(1, 2, description%left_out == 0))
         noise%mixture = chosen
         noise%mixture%squares = chosen%squares*problem%scale
         do term = 1, term_count
            if (.not. problem%offered(term)) cycle
            unit = sqrt(problem%scale)*sample_interval**power(term)
            associate (c => noise%coefficient(term))
               c%fitted = .true.
               c%value = unit*sqrt(fitted%squares(term))
               c%detected = description%selection%chosen(term) .and. fitted%squares(term) > least_size*free_errors(term)
               c%std_error = unit*sqrt(free_errors(term))
               if (c%detected) c%std_error = unit*errors(term)
               c%upper_limit = unit*sqrt(upper_limit_of(problem, chosen, term, 2*free_errors(term)))
               if (c%detected) c%upper_limit = max(c%upper_limit, c%value)      ! the test is of another fit than the value
            end associate
         end do
         associate (stated => noise%coefficient%std_error)
            do term = 1, term_count
               noise%covariance(:, term) = correlation(:term_count, term)*(stated*stated(term))
            end do
         end associate
         unit = sqrt(problem%scale)
         if (problem%offered(term_markov)) then
            noise%correlation_time = fitted%correlation_time*sample_interval
            noise%correlation_time_error = noise%correlation_time*parameter_errors(term_markov)
            call state_further(sqrt(2*fitted%squares(term_markov)/fitted%correlation_time)*unit/sqrt(sample_interval), &
               & errors(term_markov)*unit/sqrt(sample_interval), fitted%squares(term_markov) > 0, noise%markov)
         end if
         if (problem%offered(term_sinusoid)) then
            noise%frequency = fitted%frequency/sample_interval
            noise%frequency_error = noise%frequency*parameter_errors(term_sinusoid)
            call state_further(sqrt(fitted%squares(term_sinusoid))*unit, errors(term_sinusoid)*unit, &
               & fitted%squares(term_sinusoid) > 0, noise%sinusoid)
         end if
      end associate
   end subroutine state_coefficients

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

   !> Standard errors: of coefficients as they are drawn, of squares without bounds, of the logarithms of the parameters.
   subroutine errors_of(problem, linear, chosen, fitted, errors, free_errors, parameter_errors, correlation, converged)
      !> Points and terms
      type(problem_type), intent(in) :: problem
      !> The variances were fitted, not their logarithms
      logical, intent(in) :: linear
      !> The mixture that is taken as true, and the fitted one
      type(noise_model_type), intent(in) :: chosen, fitted
      !> Of the coefficients (of the Markov process: sqrt(2 variance/time)), in samples: 0 for terms that are not offered
      real(dp), intent(out) :: errors(column_count)
      !> Of the squares where every unknown may be of either sign
      real(dp), intent(out) :: free_errors(column_count)
      !> Of the logarithms of the correlation time and the frequency
      real(dp), intent(out) :: parameter_errors(column_count)
      !> Of the coefficients: 1 on the diagonal, 0 for terms that are not offered
      real(dp), intent(out) :: correlation(column_count, column_count)
      !> False if the columns are not independent
      logical, intent(out) :: converged

      real(dp), dimension(size(problem%m)) :: half, weight, factor
      real(dp) :: covariance(size(problem%m), size(problem%m))
      real(dp), allocatable :: design(:, :), length(:), centre(:), estimates(:, :), unbounded(:, :), square_covariance(:, :)
      integer, allocatable :: term(:), tangent(:)
      integer :: j, n, p

      errors = 0
      free_errors = 0
      parameter_errors = 0
      correlation = 0
      term = offered_terms(problem)
      tangent = tangents_of(problem, fitted)
      call relative_columns(problem, fitted, model_at(problem, fitted), term, tangent, design)
      weight = 1/(1/half_freedom(problem, chosen) + problem%misfit)
      half = half_freedom(problem, fitted)
      call relative_covariance(problem, fitted, covariance)
      if (.not. linear) then                                ! the logarithm spreads more where nu is small
         factor = sqrt(half*trigamma(half))
         do j = 1, size(factor)
            covariance(:, j) = covariance(:, j)*factor*factor(j)
         end do
      end if
      n = size(term)
      p = size(design, 2)
      allocate (length(p), centre(p), square_covariance(p, p))
      do j = 1, p
         length(j) = norm2(sqrt(weight)*design(:, j))
         design(:, j) = design(:, j)/length(j)
      end do
      centre = 0
      centre(:n) = merge(1.0_dp, 0.5_dp, chosen%squares(term) > 0)*fitted%squares(term)*length(:n)
      call sandwich_covariance(design, weight, covariance, square_covariance, converged)
      if (.not. converged) return
      do j = 1, n
         free_errors(term(j)) = sqrt(max(square_covariance(j, j), 0.0_dp))/length(j)
      end do
      call draw_estimates(design, weight, covariance, centre, size(tangent), estimates, unbounded)
      converged = size(estimates, 2) > 0
      if (.not. converged) return
      if (all(abs(estimates(:n, :) - unbounded(:n, :)) <= 0)) then
         correlation(term, term) = correlation_of(square_covariance(:n, :n))
      else
         correlation(term, term) = correlation_of(covariance_of(sqrt(max(estimates(:n, :), 0.0_dp))))
      end if
      do j = 1, n
         associate (free => free_errors(term(j))*length(j))
            if (all(abs(estimates(:n, :) - unbounded(:n, :)) <= 0) .and. centre(j) > 0) then
               errors(term(j)) = free/(2*sqrt(centre(j)*length(j)))
            else                                            ! the scatter of the draws themselves falls out
               errors(term(j)) = scatter(sqrt(max(estimates(j, :), 0.0_dp)/length(j)))*free/scatter(unbounded(j, :))
            end if
         end associate
      end do
      do j = 1, size(tangent)
         parameter_errors(tangent(j)) = sqrt(max(square_covariance(n + j, n + j), 0.0_dp))/length(n + j)
         if (tangent(j) == term_markov) errors(term_markov) = scatter(sqrt(2/fitted%correlation_time* &
            & max(estimates(findloc(term, term_markov, dim=1), :), 0.0_dp)/length(findloc(term, term_markov, dim=1)))* &
            & exp(-max(-2.0_dp, min(2.0_dp, estimates(n + j, :)/length(n + j)/2))))
      end do
   end subroutine errors_of

   !> Covariance of draws, but for a factor.
   pure function covariance_of(draws) result(covariance)
      !> [unknowns, draws]
      real(dp), intent(in) :: draws(:, :)
      real(dp) :: covariance(size(draws, 1), size(draws, 1))

      real(dp) :: distance(size(draws, 1), size(draws, 2))

      distance = draws - spread(sum(draws, dim=2)/size(draws, 2), 2, size(draws, 2))
      covariance = matmul(distance, transpose(distance))
   end function covariance_of

   !> A covariance as correlation; what does not vary correlates with nothing.
   pure function correlation_of(covariance) result(correlation)
      !> [unknowns, unknowns]
      real(dp), intent(in) :: covariance(:, :)
      real(dp) :: correlation(size(covariance, 1), size(covariance, 1))

      integer :: i, j

      correlation = 0
      do j = 1, size(covariance, 1)
         correlation(j, j) = 1
         do i = 1, j - 1
            if (.not. (covariance(i, i) > 0 .and. covariance(j, j) > 0)) cycle
            correlation(i, j) = covariance(i, j)/(sqrt(covariance(i, i))*sqrt(covariance(j, j)))
            correlation(j, i) = correlation(i, j)
         end do
      end do
   end function correlation_of

   !> Standard deviation.
   pure real(dp) function scatter(values)
      !> The values
      real(dp), intent(in) :: values(:)

      scatter = sqrt(sum((values - sum(values)/size(values))**2)/(size(values) - 1))
   end function scatter

end module gyroakf_allan_fit_statement
