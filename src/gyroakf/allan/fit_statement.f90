! SPDX-License-Identifier: MIT
!> Results of a noise fit: coefficients with standard errors and limits, goodness of fit, limits of
!> the curve.
module gyroakf_allan_fit_statement
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_special, only : chi_square_survival
   use gyroakf_allan_curve, only : allan_curve_type
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_fit_covariance, only : mixture_freedom
   use gyroakf_allan_fit_selection, only : noise_options, upper_limit
   use gyroakf_allan_fit_solver, only : fit_points_type, solution_type, whitened
   use gyroakf_allan_noise_model, only : model_variance, term_count, term_flicker, &
      & term_quantization, term_ramp, term_walk, term_white, terms
   implicit none (type, external)
   private
   public :: coefficient_type, noise_type, estimate_type, fill_goodness_of_fit, fill_coefficients, &
      & fill_unquantized, fill_confidence_limits

   !> A coefficient, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R:
   !> u/s)
   type :: coefficient_type
      !> Estimate, >= 0, and standard error; 0 of a term that is not in the fit
      real(dp) :: value = 0.0_dp, std_error = 0.0_dp
      !> One-sided limit: the true value is below it in at least 95 % of records
      real(dp) :: upper_limit = 0.0_dp
      !> The value is stated: no set of terms without this one describes the curve as well, and the
      !> value is twice its error or more where errors are increased
      logical :: detected = .false.
      !> There is a value or a limit; false where the term was not asked for, or is withheld
      logical :: fitted = .false.
      !> "value", "limit", "withheld" (the points do not determine it), or "" (not asked for)
      character(8) :: state = ""
   end type coefficient_type

   !> The result
   type :: noise_type
      !> Q N B K R
      type(coefficient_type) :: coefficient(term_count)
      !> Covariance of these estimates, in the product of their units; 0 beside a term that is not
      !> in the fit
      real(dp) :: covariance(term_count, term_count) = 0.0_dp
      !> Significant lack of fit: the covariance is multiplied by the reduced chi-square
      logical :: errors_increased = .false.
      !> N without quantization, sqrt(N^2 - lsb^2 dt/12): "withheld" where the step is above two
      !> standard deviations of the noise; "" where it is of no account, or N is not stated. And the
      !> step in these standard deviations
      type(coefficient_type) :: unquantized
      real(dp) :: lsb_ratio = 0.0_dp
      !> A run of points follows the terms
      logical :: described = .false.
      !> Degrees of freedom, chi-square per degree (0 where none is left), and the chance of a
      !> chi-square as large
      integer :: chi2_freedom = 0
      real(dp) :: chi2_reduced = 0.0_dp, chi2_probability = 1.0_dp
      !> Points that were fitted, points excluded before and after them; first and last averaging
      !> time fitted, s
      integer :: points = 0, left_out = 0, cut_off = 0
      real(dp) :: tau_first = 0.0_dp, tau_last = 0.0_dp
      !> Floor of the relative deviation of the variances from the terms, 0 where chance explains
      !> it; excess kurtosis of the white noise per sample, 0 where it is not significant
      real(dp) :: floor = 0.0_dp, kurtosis = 0.0_dp
      !> Averaging times of the octaves, s; distance of the curve from the terms there in standard
      !> deviations, 0 where excluded
      real(dp), allocatable :: tau(:), residual(:)
      !> Fitted deviation at each averaging time of the curve, 0 where the fit says nothing
      real(dp), allocatable :: model(:)
      !> What a fit without K, and one without K and R, costs more of chi-square and prices; 0 where
      !> nothing is described
      real(dp) :: walk_margin = 0.0_dp, drift_margin = 0.0_dp
      !> Q^2 N^2 B^2 K^2 R^2 of the fitted mixture for a sample interval of 1, in the square of the
      !> curve's unit
      real(dp) :: squares(term_count) = 0.0_dp
   end type noise_type

   !> A fit in progress
   type :: estimate_type
      !> All octaves, and those that are fitted
      type(fit_points_type) :: curve, run
      !> Unit of the variances, units of the coefficients, sample interval, s
      real(dp) :: scale = 1.0_dp, unit(term_count) = 1.0_dp, interval = 1.0_dp
      !> Terms on offer, those of the best set, those that are stated
      logical :: offered(term_count) = .true., chosen(term_count) = .false., &
         & stated(term_count) = .false.
      !> The points are those of the user; the terms are, too
      logical :: own_points = .false., own_terms = .false.
      !> What a fit without K, and one without K and R, costs more
      real(dp) :: margin(2) = 0.0_dp
      !> Fit of all terms on offer, and of the chosen ones
      type(solution_type) :: full, final
   end type estimate_type

contains

   !> What was fitted, and how well.
   subroutine fill_goodness_of_fit(options, estimate, noise, error)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: columns(:, :), inverse(:, :)
      real(dp) :: unit(term_count)
      integer, allocatable :: place(:)
      integer :: j, k, info, last

      associate (e => estimate, run => estimate%run, squares => estimate%final%squares)
         last = run%first + size(run%m) - 1
         noise%points = size(run%m)
         noise%left_out = run%first - 1
         noise%cut_off = size(e%curve%m) - last
         noise%tau_first = noise%tau(run%first)
         noise%tau_last = noise%tau(last)
         noise%floor = run%floor
         noise%kurtosis = run%excess
         noise%residual(run%first:last) = e%final%residual
         noise%chi2_freedom = noise%points - count(e%chosen)
         if (noise%chi2_freedom > 0) then
            noise%chi2_reduced = e%final%chi_square/noise%chi2_freedom
            noise%chi2_probability = chi_square_survival(e%final%chi_square, &
               & real(noise%chi2_freedom, dp))
         end if
         noise%squares = max(0.0_dp, squares)*e%scale
         noise%walk_margin = e%margin(1)
         noise%drift_margin = e%margin(2)
         ! covariance of the squares, (B' C^-1 B)^-1, then of the coefficients
         place = pack(terms, e%chosen)
         k = size(place)
         columns = whitened(e%final%covariance, &
            & run%shape(:, place)/spread(matmul(run%shape, squares), 2, k))
         inverse = matmul(transpose(columns), columns)
         call dpotrf("U", k, inverse, k, info)
         if (info == 0) call dpotri("U", k, inverse, k, info)
         if (info /= 0) then
            call fatal_error(error, status%singular, &
               & "the noise terms are collinear at these averaging times")
            return
         end if
         unit(place) = e%unit(place)/(2*sqrt(abs(squares(place))))
         do j = 1, k
            noise%covariance(place(:j), place(j)) = inverse(:j, j)*unit(place(:j))*unit(place(j))
            noise%covariance(place(j), place(:j)) = noise%covariance(place(:j), place(j))
         end do
         noise%errors_increased = noise%chi2_probability < options%min_p_value
         if (noise%errors_increased) noise%covariance = noise%covariance*noise%chi2_reduced
      end associate
   end subroutine fill_goodness_of_fit

   !> Values, limits, and what is withheld.
   subroutine fill_coefficients(options, estimate, noise)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      logical :: withheld(term_count)
      integer :: j

      call find_withheld(options, estimate, withheld)
      where (spread(withheld, 1, term_count) &
         & .or. spread(withheld, 2, term_count)) noise%covariance = 0
      do j = 1, term_count
         associate (c => noise%coefficient(j), e => estimate)
            if (withheld(j)) then
               c%state = "withheld"
            else if (e%offered(j)) then
               c%fitted = .true.
               c%value = e%unit(j)*sqrt(max(0.0_dp, e%final%squares(j)))
               c%std_error = sqrt(noise%covariance(j, j))
               c%detected = e%stated(j) .and. .not. &
                  & (noise%errors_increased .and. c%value < 2*c%std_error)
               c%state = merge("value", "limit", c%detected)
               c%upper_limit = c%value + sqrt(options%limit_chi_square)*c%std_error
               if (.not. e%stated(j)) c%upper_limit = &
                  & e%unit(j)*sqrt(upper_limit(e%run, options, e%offered, j, e%full%squares))
            end if
         end associate
      end do
   end subroutine fill_coefficients

   !> N without the variance lsb^2/12 of rounding, which is white noise where a step is not above
   !> two standard deviations of the noise before it (W. F. Sheppard, Proc. London Math. Soc. 29,
   !> 1898); these are taken from the differences of neighbors.
   pure subroutine fill_unquantized(options, estimate, noise)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      real(dp) :: before, square, deviation

      before = estimate%scale - options%lsb**2/12
      noise%lsb_ratio = huge(1.0_dp)                  ! rounding alone explains the differences
      if (before > 0) noise%lsb_ratio = options%lsb/sqrt(before)
      associate (n => noise%coefficient(term_white), c => noise%unquantized)
         if (noise%lsb_ratio < options%lsb_range(1) .or. .not. n%detected) return
         c%state = "withheld"
         square = n%value**2 - options%lsb**2*estimate%interval/12
         if (noise%lsb_ratio > options%lsb_range(2) .or. square <= 0) return
         deviation = n%std_error*n%value/sqrt(square)
         c = coefficient_type(sqrt(square), deviation, &
            & sqrt(square) + sqrt(options%limit_chi_square)*deviation, .true., .true., "value")
      end associate
   end subroutine fill_unquantized

   !> Terms that the run of points does not determine.
   pure subroutine find_withheld(options, estimate, withheld)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      logical, intent(out) :: withheld(term_count)
      real(dp) :: share(size(estimate%run%m), term_count)
      integer :: n

      associate (run => estimate%run)
         withheld = run%signed .and. terms == term_quantization
         if (estimate%own_points) return
         withheld = withheld .or. .not. estimate%offered    ! a record of fewer octaves than a run
         n = size(run%m)
         share = run%shape*spread(max(0.0_dp, estimate%final%squares), 1, n)
         share = share/spread(sum(share, dim=2), 2, term_count)
         if (run%first > 1) withheld(term_white) = &
            & minval(share(:min(3, n), term_white)) < options%min_term_fraction
         if (run%first + n - 1 == size(estimate%curve%m)) return
         withheld([term_walk, term_ramp]) = .true.
         withheld(term_flicker) = &
            & minval(share(max(1, n - 2):, term_flicker)) < options%min_term_fraction
      end associate
   end subroutine find_withheld

   !> The fitted deviations, and degrees of freedom and limits of the curve from the fit of all
   !> terms without its floor.
   subroutine fill_confidence_limits(estimate, curve, noise)
      type(estimate_type), intent(in) :: estimate
      type(allan_curve_type), intent(inout) :: curve
      type(noise_type), intent(inout) :: noise
      real(dp) :: squares(term_count), edf(size(curve%m)), m, white
      integer(int64) :: longest
      integer :: i
      logical :: outside

      associate (run => estimate%run)
         longest = run%m(size(run%m))
         squares = max(0.0_dp, estimate%full%squares)
         squares(term_walk) = squares(term_walk) + 1.5_dp*real(longest, dp)*squares(term_ramp)
         squares(term_ramp) = 0
         edf = mixture_freedom(run%samples, curve%m, squares)
         do i = 1, size(curve%m)
            m = real(curve%m(i), dp)
            outside = curve%m(i) < run%m(1) .or. curve%m(i) > 2*longest
            if (.not. outside) noise%model(i) = &
               & sqrt(estimate%scale*model_variance(estimate%final%squares, m))
            white = squares(term_white)/(m*model_variance(squares, m))
            edf(i) = 2*curve%share(i)/(2/edf(i) + run%excess/real(run%samples, dp)*white**2)
            if (outside) edf(i) = min(edf(i), curve%edf(i))
            curve%edf(i) = max(0.5_dp, edf(i))
         end do
      end associate
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine fill_confidence_limits

end module gyroakf_allan_fit_statement
