! SPDX-License-Identifier: MIT
!> Noise coefficients from an Allan curve.
!>
!>     type(noise_options) :: options
!>     type(noise_type) :: noise
!>     call fit_noise(curve, options, noise, error)        ! noise%coefficient(2)%value is N
!>
!> One generalized least-squares fit ([[gyroakf_allan_fit_solver]]) gives values, standard errors, upper
!> limits, goodness of fit, the choice of terms and of the points ([[gyroakf_allan_fit_selection]]), and the
!> confidence limits of the curve. It looks at the octaves m = 1, 2, 4, ... up to a quarter of the record,
!> whatever averaging times the curve is shown at: more points add nothing to the errors.
!>
!> A filter of unit gain turns the N^2/tau of white noise into N^2/tau + c/tau^2 once tau exceeds its
!> memory, c of either sign. Where points are excluded at the start the 1/tau^2 term is therefore of
!> either sign and not Q. What the run of points does not determine is withheld: Q, and an N that is not the
!> larger part of its first three points, where it begins late; K, R, and a B that is not the larger
!> part of its last three points, where it ends early; everything where no run of points follows the
!> terms.
module gyroakf_allan_noise_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_lapack, only : dpotrf, dpotri
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_special, only : chi_square_survival
   use gyroakf_allan_degrees_of_freedom, only : chi_square_limits
   use gyroakf_allan_deviations, only : allan_curve_type, terms_share
   use gyroakf_allan_fit_covariance, only : mixture_freedom, new_covariance_basis
   use gyroakf_allan_fit_selection, only : find_floor, find_run, is_described, noise_options, run_between, select_terms, &
      & upper_limit
   use gyroakf_allan_fit_solver, only : fit_points_type, fit_run, fit_run_type, shapes_of, solution_type, whitened
   use gyroakf_allan_noise_model, only : model_variance, noise_model_type, term_count, term_flicker, term_letters, &
      & term_quantization, term_ramp, term_walk, term_white
   implicit none (type, external)
   private
   public :: noise_options, coefficient_type, noise_type, fit_noise

   !> A coefficient, in units of the curve and seconds (Q: u s, N: u sqrt(s), B: u, K: u/sqrt(s), R: u/s)
   type :: coefficient_type
      !> Estimate, >= 0, and standard error; 0 of a term that is not in the fit
      real(dp) :: value = 0.0_dp, std_error = 0.0_dp
      !> One-sided limit: the true value is below it in at least 95 % of records
      real(dp) :: upper_limit = 0.0_dp
      !> The value is stated: no set of terms without this one describes the curve as well
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
      !> Covariance of these estimates, in the product of their units; 0 beside a term that is not in the fit
      real(dp) :: covariance(term_count, term_count) = 0.0_dp
      !> Chance does not explain chi-square: the covariance is multiplied by chi-square per degree of freedom
      logical :: errors_increased = .false.
      !> N without quantization, sqrt(N^2 - lsb^2 dt/12): "withheld" where the step is above two standard deviations of the noise;
      !> "" where it is of no account, or N is not stated. And the step in these standard deviations
      type(coefficient_type) :: unquantized
      real(dp) :: lsb_ratio = 0.0_dp
      !> A run of points follows the terms
      logical :: described = .false.
      !> Chi-square per degree of freedom; 0 where no freedom is left
      real(dp) :: chi2_reduced = 0.0_dp
      !> Degrees of freedom, and the chance of a chi-square as large
      integer :: chi2_freedom = 0
      real(dp) :: chi2_probability = 1.0_dp
      !> Of the curve, s
      real(dp) :: sample_interval = 1.0_dp
      !> Points that were fitted, points excluded before and after them; first and last averaging time fitted, s
      integer :: points = 0, left_out = 0, cut_off = 0
      real(dp) :: tau_first = 0.0_dp, tau_last = 0.0_dp
      !> Floor of the relative deviation of the variances from the terms, 0 where chance explains it
      real(dp) :: floor = 0.0_dp
      !> Excess kurtosis of the white noise per sample, 0 where it is not significant
      real(dp) :: kurtosis = 0.0_dp
      !> Mean share of their degrees of freedom that gaps left
      real(dp) :: share = 1.0_dp
      !> Averaging times of the octaves, s; distance of the curve from the terms there in standard
      !> deviations, 0 where excluded
      real(dp), allocatable :: tau(:), residual(:)
      !> Fitted deviation at each averaging time of the curve, 0 where the fit says nothing
      real(dp), allocatable :: model(:)
      !> The fitted mixture for a sample interval of 1, in the square of the curve's unit
      type(noise_model_type) :: mixture
   end type noise_type

   !> A fit in progress
   type :: estimate_type
      type(fit_points_type) :: points
      !> Unit of the variances
      real(dp) :: scale = 1.0_dp
      !> Terms on offer, those of the best set, those that are stated
      logical :: offered(term_count) = .true., chosen(term_count) = .false., stated(term_count) = .false.
      !> The points are those of the user; the terms are, too
      logical :: own_points = .false., own_terms = .false.
      type(fit_run_type) :: run
      !> Fit of all terms on offer, and of the chosen ones
      type(solution_type) :: full, final
   end type estimate_type

   !> Powers of the sample interval in the units of Q N B K R
   real(dp), parameter :: power(term_count) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]
   !> Averaging times per octave at which degrees of freedom are computed; between them they are interpolated
   integer, parameter :: per_octave = 4
   !> Stage of the analysis for the progress callback
   character(*), parameter :: stage = "noise coefficients"

contains

   !> Fits the terms, and gives the curve the degrees of freedom and limits of the fitted mixture.
   subroutine fit_noise(curve, options, noise, error, progress)
      !> From [[compute_allan]], kind oadev; edf, lower and upper are replaced (by larger limits only
      !> outside the run of points that was fitted) where the terms describe the curve
      type(allan_curve_type), intent(inout) :: curve
      !> Terms, range of averaging times, thresholds
      type(noise_options), intent(in) :: options
      !> Coefficients with errors, goodness of the fit
      type(noise_type), intent(out) :: noise
      !> invalid_argument, too_few_samples (fewer points than terms), constant_input, singular, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told between the steps; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(estimate_type) :: estimate

      call check_terms(options, estimate, error)
      if (.not. allocated(error)) call take_points(curve, estimate, error)
      if (.not. allocated(error)) call tell_progress(stage, 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call choose_run(options, curve%sample_interval, estimate, noise%described, error)
      if (.not. allocated(error)) call tell_progress(stage, 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      noise%sample_interval = curve%sample_interval
      noise%tau = curve%sample_interval*real(estimate%points%m, dp)
      noise%residual = 0*noise%tau
      noise%model = 0*curve%deviation
      if (.not. noise%described) then
         where (estimate%offered) noise%coefficient%state = "withheld"
         return
      end if
      call fit_terms(options, estimate)
      call tell_progress(stage, 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call state_fit(options, estimate, noise, error)
      if (.not. allocated(error)) call state_coefficients(options, estimate, noise)
      if (.not. allocated(error)) call state_unquantized(options, estimate, noise)
      if (.not. allocated(error)) call give_limits(estimate, curve, noise)
   end subroutine fit_noise

   !> Reads the letters of the terms.
   subroutine check_terms(options, estimate, error)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(inout) :: estimate
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. (ieee_is_finite(options%tau_min) .and. ieee_is_finite(options%tau_max))) then
         call fatal_error(error, status%invalid_argument, "the range of averaging times of the fit must be finite")
      else if (.not. (options%lsb >= 0 .and. options%lsb <= huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, "the step of the samples must not be negative, and finite")
      end if
      if (allocated(error)) return
      estimate%own_terms = options%terms /= "auto"
      estimate%own_points = estimate%own_terms .or. options%tau_min > 0 .or. options%tau_max < huge(1.0_dp)
      if (.not. estimate%own_terms) return
      if (verify(trim(options%terms), term_letters) > 0 .or. options%terms == " ") then
         call fatal_error(error, status%invalid_argument, "terms '"//trim(options%terms)//"': auto, or letters of "//term_letters)
      end if
      estimate%offered = [(index(options%terms, term_letters(i:i)) > 0, i=1, term_count)]
   end subroutine check_terms

   !> Takes the octaves of a curve.
   subroutine take_points(curve, estimate, error)
      type(allan_curve_type), intent(in) :: curve
      type(estimate_type), intent(inout) :: estimate
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: share(:)
      integer, allocatable :: place(:)
      integer :: i

      if (curve%kind /= "oadev") then
         call fatal_error(error, status%invalid_argument, "the noise terms are fitted to a curve of kind oadev, this one is "// &
            & trim(curve%kind))
      else if (.not. (allocated(curve%deviation) .and. allocated(curve%edf) .and. allocated(curve%terms))) then
         call fatal_error(error, status%invalid_argument, "the Allan curve is empty")
      end if
      if (allocated(error)) return
      associate (points => estimate%points, octaves => curve%octaves)
         points%samples = curve%samples
         if (allocated(octaves%m)) then
            points%m = octaves%m
            points%variance = octaves%variance
            points%kurtosis = octaves%kurtosis
            points%complete = octaves%share
         else                                               ! a curve of other origin
            place = pack([(i, i=1, size(curve%m))], popcnt(curve%m) == 1 .and. curve%m <= max(1_int64, curve%samples/4))
            points%m = curve%m(place)
            points%variance = curve%deviation(place)**2
            allocate (points%kurtosis(size(place)), source=0.0_dp)
            share = terms_share(curve)
            points%complete = share(place)
         end if
         if (size(points%m) == 0) then
            call fatal_error(error, status%too_few_samples, "the curve has no averaging time of 1, 2, 4 ... samples to be fitted")
         else if (any(points%variance <= tiny(1.0_dp))) then
            call fatal_error(error, status%constant_input, "an Allan deviation is zero: the record does not vary")
         end if
         if (allocated(error)) return
         estimate%scale = points%variance(1)
         points%variance = points%variance/estimate%scale
         call new_covariance_basis(points%samples, points%m, points%basis)
      end associate
   end subroutine take_points

   !> The points that are fitted: those of the user, or the longest run that the terms describe.
   subroutine choose_run(options, interval, estimate, described, error)
      type(noise_options), intent(in) :: options
      !> Of the samples, s
      real(dp), intent(in) :: interval
      type(estimate_type), intent(inout) :: estimate
      logical, intent(out) :: described
      type(error_type), allocatable, intent(out) :: error
      integer :: first, last
      character(120) :: text

      described = .true.
      associate (points => estimate%points, run => estimate%run)
         if (estimate%own_points) then
            first = 1 + count(interval*real(points%m, dp) < options%tau_min*(1 - 1e-9_dp))
            last = count(interval*real(points%m, dp) <= options%tau_max)
            if (last - first + 1 < count(estimate%offered)) then
               write (text, "(a, i0, a, i0, a)") "a fit of ", count(estimate%offered), " terms needs as many octaves, there are ", &
                  & max(0, last - first + 1), " up to a quarter of the record"
               call fatal_error(error, status%too_few_samples, trim(text))
               return
            end if
            run = run_between(points, options, first, last)
            run%signed = run%signed .and. .not. estimate%own_terms
         else if (size(points%m) <= options%run_octaves) then
            estimate%offered = [1, 2, 3, 4, 5] == term_white
            run = run_between(points, options, 1, size(points%m))
            described = is_described(points, run, options, estimate%offered)
         else
            call find_run(points, options, run, described)
         end if
      end associate
   end subroutine choose_run

   !> The floor, the choice of terms, and the fit of those chosen.
   subroutine fit_terms(options, estimate)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(inout) :: estimate
      logical :: used(term_count)
      real(dp) :: start(term_count)

      associate (e => estimate)
         call find_floor(e%points, options, e%offered, e%run, e%full)
         e%final = e%full
         call select_terms(e%points, e%run, options, e%offered, e%final, e%chosen, e%stated)
         used = e%chosen
         if (e%own_terms .or. .not. any(e%chosen)) used = e%offered
         start = e%final%squares
         call fit_run(e%points, e%run, used, e%final, start, ramp=.true.)
         if (used(term_ramp) .and. .not. is_likely(options, e%final, used)) call fit_run(e%points, e%run, used, e%final, start)
         e%chosen = used .and. (e%final%squares > 0 .or. (e%run%signed .and. [1, 2, 3, 4, 5] == term_quantization))
      end associate
   end subroutine fit_terms

   !> Chance explains what is left of a fit.
   logical function is_likely(options, fit, used)
      type(noise_options), intent(in) :: options
      type(solution_type), intent(in) :: fit
      logical, intent(in) :: used(term_count)
      integer :: freedom

      freedom = size(fit%residual) - count(used)
      is_likely = freedom <= 0
      if (freedom > 0) is_likely = chi_square_survival(fit%chi_square, real(freedom, dp)) >= options%run_chance
   end function is_likely

   !> What was fitted, and how well.
   subroutine state_fit(options, estimate, noise, error)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: columns(:, :), inverse(:, :)
      real(dp) :: unit(term_count)
      integer, allocatable :: place(:)
      integer :: j, k, info

      associate (e => estimate, run => estimate%run, squares => estimate%final%squares)
         noise%points = run%last - run%first + 1
         noise%left_out = run%first - 1
         noise%cut_off = size(e%points%m) - run%last
         noise%tau_first = noise%tau(run%first)
         noise%tau_last = noise%tau(run%last)
         noise%floor = run%floor
         noise%kurtosis = run%kurtosis
         noise%share = sum(e%points%complete(run%first:run%last))/noise%points
         noise%residual(run%first:run%last) = e%final%residual
         noise%chi2_freedom = noise%points - count(e%chosen)
         if (noise%chi2_freedom > 0) then
            noise%chi2_reduced = e%final%chi_square/noise%chi2_freedom
            noise%chi2_probability = chi_square_survival(e%final%chi_square, real(noise%chi2_freedom, dp))
         end if
         noise%mixture%squares = max(0.0_dp, squares)*e%scale
         ! covariance of the squares, (B' C^-1 B)^-1, then of the coefficients
         place = pack([(j, j=1, term_count)], e%chosen)
         k = size(place)
         columns = shapes_of(e%points, run)
         columns = whitened(e%final%covariance, columns(:, place)/spread(matmul(columns, squares), 2, k))
         unit = 0
         unit(place) = norm2(columns, dim=1)
         columns = columns/spread(unit(place), 1, noise%points)
         inverse = matmul(transpose(columns), columns)
         call dpotrf("U", k, inverse, k, info)
         if (info == 0) call dpotri("U", k, inverse, k, info)
         if (info /= 0) then
            call fatal_error(error, status%singular, "the noise terms are collinear at these averaging times")
            return
         end if
         unit(place) = sqrt(e%scale)*noise%sample_interval**power(place)/(2*sqrt(abs(squares(place)))*unit(place))
         do j = 1, k
            noise%covariance(place(:j), place(j)) = inverse(:j, j)*unit(place(:j))*unit(place(j))
            noise%covariance(place(j), place(:j)) = noise%covariance(place(:j), place(j))
         end do
            noise%errors_increased = noise%chi2_probability < options%run_chance
         if (noise%errors_increased) noise%covariance = noise%covariance*noise%chi2_reduced
      end associate
   end subroutine state_fit

   !> Values, limits, and what is withheld.
   subroutine state_coefficients(options, estimate, noise)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      logical :: withheld(term_count)
      real(dp) :: unit
      integer :: j

      call find_withheld(options, estimate, withheld)
      do j = 1, term_count
         if (withheld(j)) then
            noise%covariance(:, j) = 0
            noise%covariance(j, :) = 0
         end if
         associate (c => noise%coefficient(j), e => estimate)
            if (withheld(j)) then
               c%state = "withheld"
            else if (e%offered(j)) then
               unit = sqrt(e%scale)*noise%sample_interval**power(j)
               c%fitted = .true.
               c%value = unit*sqrt(max(0.0_dp, e%final%squares(j)))
               c%std_error = sqrt(noise%covariance(j, j))
               c%detected = e%stated(j)
               c%state = merge("value", "limit", c%detected)
               c%upper_limit = c%value + sqrt(options%limit_rise)*c%std_error
               if (.not. c%detected) c%upper_limit = &
                  & unit*sqrt(upper_limit(e%points, e%run, options, e%offered, j, e%full%squares))
            end if
         end associate
      end do
   end subroutine state_coefficients

   !> N without the variance lsb^2/12 of rounding, which is white noise where a step is not above two standard deviations of the
   !> noise before it (W. F. Sheppard, Proc. London Math. Soc. 29, 1898); these are taken from the differences of neighbors.
   pure subroutine state_unquantized(options, estimate, noise)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      type(noise_type), intent(inout) :: noise
      real(dp) :: before, square

      before = estimate%scale - options%lsb**2/12
      noise%lsb_ratio = options%lsb/sqrt(max(before, tiny(1.0_dp)))
      associate (n => noise%coefficient(term_white), c => noise%unquantized)
         if (noise%lsb_ratio < options%lsb_range(1) .or. .not. n%detected) return
         c%state = "withheld"
         square = n%value**2 - options%lsb**2*noise%sample_interval/12
         if (noise%lsb_ratio > options%lsb_range(2) .or. square <= 0) return
         c%value = sqrt(square)
         c%std_error = n%std_error*n%value/c%value
         c%upper_limit = c%value + sqrt(options%limit_rise)*c%std_error
         c%detected = .true.
         c%fitted = .true.
         c%state = "value"
      end associate
   end subroutine state_unquantized

   !> Terms that the run of points does not determine.
   pure subroutine find_withheld(options, estimate, withheld)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(in) :: estimate
      logical, intent(out) :: withheld(term_count)
      real(dp) :: share(estimate%run%last - estimate%run%first + 1, term_count), squares(term_count)
      integer :: n, three

      withheld = .false.
      withheld(term_quantization) = estimate%run%signed
      if (estimate%own_points) return
      squares = max(0.0_dp, estimate%final%squares)
      share = shapes_of(estimate%points, estimate%run)*spread(squares, 1, size(share, 1))
      share = share/spread(sum(share, dim=2), 2, term_count)
      n = size(share, 1)
      three = min(3, n)
      withheld = withheld .or. .not. estimate%offered       ! a record of fewer octaves than a run
      if (estimate%run%first > 1) withheld(term_white) = minval(share(:three, term_white)) < options%plain_share
      if (estimate%run%last == size(estimate%points%m)) return
      withheld([term_walk, term_ramp]) = .true.
      withheld(term_flicker) = minval(share(n - three + 1:, term_flicker)) < options%plain_share
   end subroutine find_withheld

   !> The fitted deviations, and degrees of freedom and limits of the curve from the fit of all terms without its floor.
   subroutine give_limits(estimate, curve, noise)
      type(estimate_type), intent(in) :: estimate
      type(allan_curve_type), intent(inout) :: curve
      type(noise_type), intent(inout) :: noise
      type(noise_model_type) :: noisy
      real(dp), allocatable :: lag(:), relative(:), share(:)
      real(dp) :: m, white, edf
      integer(int64), allocatable :: place(:)
      integer :: i
      logical :: outside

      associate (points => estimate%points, run => estimate%run)
         noisy%squares = max(0.0_dp, estimate%full%squares)
         noisy%squares(term_walk) = noisy%squares(term_walk) + 1.5_dp*real(points%m(run%last), dp)*noisy%squares(term_ramp)
         noisy%squares(term_ramp) = 0
         share = terms_share(curve)
         call spread_factors(curve%m(size(curve%m)), place)
         lag = log(real(place, dp))
         relative = log(2/mixture_freedom(points%samples, place, noisy))
         do i = 1, size(curve%m)
            m = real(curve%m(i), dp)
            outside = curve%m(i) < points%m(run%first) .or. curve%m(i) > 2*points%m(run%last)
            if (.not. outside) noise%model(i) = sqrt(estimate%scale*model_variance(estimate%final%squares, m))
            white = noisy%squares(term_white)/(m*model_variance(noisy, m))
            edf = 2*share(i)/(exp(between(lag, relative, log(m))) + run%kurtosis/real(points%samples, dp)*white**2)
            if (outside) edf = min(edf, curve%edf(i))
            curve%edf(i) = max(0.5_dp, edf)
         end do
      end associate
      call chi_square_limits(curve%deviation, curve%edf, curve%confidence, curve%lower, curve%upper)
   end subroutine give_limits

   !> Averaging factors from 1 to the longest, some per octave.
   pure subroutine spread_factors(longest, place)
      integer(int64), intent(in) :: longest
      integer(int64), allocatable, intent(out) :: place(:)
      integer(int64) :: next
      integer :: k

      place = [1_int64]
      k = 0
      do while (place(size(place)) < longest)
         k = k + 1
         next = min(longest, nint(2.0_dp**(real(k, dp)/per_octave), int64))
         if (next > place(size(place))) place = [place, next]
      end do
   end subroutine spread_factors

   !> Linear interpolation between ascending places, constant outside.
   pure real(dp) function between(x, y, at)
      real(dp), intent(in) :: x(:), y(:), at
      integer :: low

      low = max(1, min(size(x) - 1, count(x <= at)))
      between = y(low)
      if (size(x) > 1) between = y(low) + max(0.0_dp, min(1.0_dp, (at - x(low))/(x(low + 1) - x(low))))*(y(low + 1) - y(low))
   end function between

end module gyroakf_allan_noise_fit
