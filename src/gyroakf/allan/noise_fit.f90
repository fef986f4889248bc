! SPDX-License-Identifier: MIT
!> Noise coefficients from an Allan curve.
!>
!>     type(noise_options) :: options
!>     type(noise_type) :: noise
!>     call fit_noise(curve, options, noise, error)        ! noise%coefficient(2)%value is N
!>
!> Minimizes r^T C^{-1} r over the squared coefficients, r the distances of the Allan variances from
!> the model ([[gyroakf_allan_noise_model]]), C their covariance ([[gyroakf_allan_fit_covariance]]).
!> [[gyroakf_allan_read_off]] is the graphical method, for comparison. This one generalized
!> least-squares fit ([[gyroakf_allan_fit_solver]]) gives values, standard errors,
!> upper limits, goodness of fit, the choice of terms and of the points
!> ([[gyroakf_allan_fit_selection]]), and the confidence limits of the curve. It looks at the
!> octaves m = 1, 2, 4, ... up to a quarter of the record, whatever averaging times the curve is
!> shown at.
!>
!> A filter of unit gain turns the N^2/tau of white noise into N^2/tau + c/tau^2 once tau exceeds
!> its memory, c of either sign. Where points are excluded at the start the 1/tau^2 term is
!> therefore of either sign and not Q. What the run of points does not determine is withheld: Q, and
!> an N that is not the larger part of its first three points, where it begins late; K, R, and a B
!> that is not the larger part of its last three points, where it ends early; everything where no
!> run follows the terms.
module gyroakf_allan_noise_fit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_curve, only : allan_curve_type
   use gyroakf_allan_fit_covariance, only : covariance_basis
   use gyroakf_allan_fit_selection, only : find_floor, find_run, is_described, is_likely, &
      & noise_options, points_between, select_terms
   use gyroakf_allan_fit_solver, only : fit_terms
   use gyroakf_allan_fit_statement, only : coefficient_type, estimate_type, &
      & fill_coefficients, fill_confidence_limits, fill_goodness_of_fit, fill_unquantized, &
      & noise_type
   use gyroakf_allan_noise_model, only : term_count, term_letters, term_quantization, term_ramp, &
      & term_white, terms
   implicit none (type, external)
   private
   public :: noise_options, coefficient_type, noise_type, fit_noise

   !> Powers of the sample interval in the units of Q N B K R
   real(dp), parameter :: power(term_count) = [1.0_dp, 0.5_dp, 0.0_dp, -0.5_dp, -1.0_dp]

contains

   !> Fits the terms, and gives the curve the degrees of freedom and limits of the fitted mixture.
   subroutine fit_noise(curve, options, noise, error)
      !> From [[compute_allan]], kind oadev; edf, lower and upper are replaced (outside the points
      !> fitted, by larger limits only)
      type(allan_curve_type), intent(inout) :: curve
      !> Terms, range of averaging times, thresholds
      type(noise_options), intent(in) :: options
      !> Coefficients with errors, goodness of the fit
      type(noise_type), intent(out) :: noise
      !> invalid_argument, too_few_samples (fewer points than terms), constant_input, singular
      type(error_type), allocatable, intent(out) :: error
      type(estimate_type) :: estimate

      call check_terms(options, estimate, error)
      if (.not. allocated(error)) call take_points(curve, estimate, error)
      if (.not. allocated(error)) call choose_run(options, estimate, noise%described, error)
      if (allocated(error)) return
      noise%tau = estimate%interval*real(estimate%curve%m, dp)
      noise%residual = 0*noise%tau
      noise%model = 0*curve%deviation
      if (.not. noise%described) then
         where (estimate%offered) noise%coefficient%state = "withheld"
         return
      end if
      call choose_terms(options, estimate)
      call fill_goodness_of_fit(options, estimate, noise, error)
      if (allocated(error)) return
      call fill_coefficients(options, estimate, noise)
      call fill_unquantized(options, estimate, noise)
      call fill_confidence_limits(estimate, curve, noise)
   end subroutine fit_noise

   !> Reads the letters of the terms.
   subroutine check_terms(options, estimate, error)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(inout) :: estimate
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. (ieee_is_finite(options%tau_min) .and. ieee_is_finite(options%tau_max))) then
         call fatal_error(error, status%invalid_argument, &
            & "the range of averaging times of the fit must be finite")
      else if (.not. (options%lsb >= 0 .and. options%lsb <= huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, &
            & "the step of the samples must not be negative, and finite")
      end if
      if (allocated(error)) return
      estimate%own_terms = options%terms /= "auto"
      estimate%own_points = estimate%own_terms .or. options%tau_min > 0 &
         & .or. options%tau_max < huge(1.0_dp)
      if (.not. estimate%own_terms) return
      if (verify(trim(options%terms), term_letters) > 0 .or. options%terms == " ") then
         call fatal_error(error, status%invalid_argument, "terms '"//trim(options%terms) &
            & //"': auto, or letters of "//term_letters)
      end if
      estimate%offered = index(options%terms, [(term_letters(i:i), i=1, term_count)]) > 0
   end subroutine check_terms

   !> Takes the octaves of a curve.
   subroutine take_points(curve, estimate, error)
      type(allan_curve_type), intent(in) :: curve
      type(estimate_type), intent(inout) :: estimate
      type(error_type), allocatable, intent(out) :: error

      associate (points => estimate%curve, octaves => curve%octaves)
         if (curve%kind /= "oadev") then
            call fatal_error(error, status%invalid_argument, &
               & "the noise terms are fitted to a curve of kind oadev, this one is " &
               & //trim(curve%kind))
         else if (.not. allocated(octaves%m)) then
            call fatal_error(error, status%invalid_argument, "the Allan curve is empty")
         else if (size(octaves%m) == 0) then
            call fatal_error(error, status%too_few_samples, &
               & "the curve has no averaging time of 1, 2, 4 ... samples to be fitted")
         else if (any(octaves%variance <= tiny(1.0_dp))) then
            call fatal_error(error, status%constant_input, &
               & "an Allan deviation is zero: the record does not vary")
         end if
         if (allocated(error)) return
         estimate%interval = curve%sample_interval
         estimate%scale = octaves%variance(1)
         estimate%unit = sqrt(estimate%scale)*estimate%interval**power
         points%samples = curve%samples
         points%m = octaves%m
         points%variance = octaves%variance/estimate%scale
         points%kurtosis = octaves%kurtosis
         points%share = octaves%share
         points%basis = covariance_basis(points%samples, points%m)
      end associate
   end subroutine take_points

   !> The octaves that are fitted: those of the user, or the longest run that the terms describe.
   subroutine choose_run(options, estimate, described, error)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(inout) :: estimate
      logical, intent(out) :: described
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: tau(size(estimate%curve%m))
      integer :: first, last
      character(120) :: text

      described = .true.
      associate (e => estimate)
         if (e%own_points) then
            tau = e%interval*real(e%curve%m, dp)
            first = 1 + count(tau < options%tau_min*(1 - 1e-9_dp))
            last = count(tau <= options%tau_max)
            if (last - first + 1 < count(e%offered)) then
               write (text, "(a, i0, a, i0, a)") "a fit of ", count(e%offered), &
                  & " terms needs as many octaves, there are ", max(0, last - first + 1), &
                  & " up to a quarter of the record"
               call fatal_error(error, status%too_few_samples, trim(text))
               return
            end if
            e%run = points_between(e%curve, options, first, last)
            e%run%signed = e%run%signed .and. .not. e%own_terms
         else if (size(e%curve%m) <= options%run_octaves) then
            e%offered = terms == term_white
            e%run = points_between(e%curve, options, 1, size(e%curve%m))
            described = is_described(e%run, options, e%offered, .true.)
         else
            call find_run(e%curve, options, e%run, described)
         end if
      end associate
   end subroutine choose_run

   !> The floor, the choice of terms, and the fit of those chosen.
   subroutine choose_terms(options, estimate)
      type(noise_options), intent(in) :: options
      type(estimate_type), intent(inout) :: estimate
      logical :: used(term_count)
      real(dp) :: start(term_count)

      associate (e => estimate)
         call find_floor(e%run, options, e%offered, e%full)
         e%final = e%full
         call select_terms(e%run, options, e%offered, e%final, e%chosen, e%stated, e%margin)
         used = merge(e%offered, e%chosen, e%own_terms .or. .not. any(e%chosen))
         start = merge(e%final%squares, 0.0_dp, used)
         e%run%ramp = used(term_ramp)
         call fit_terms(e%run, used, e%final, start)
         if (e%run%ramp .and. .not. is_likely(e%final, options)) then
            e%run%ramp = .false.
            call fit_terms(e%run, used, e%final, start)
         end if
         e%chosen = used &
            & .and. (e%final%squares > 0 .or. (e%run%signed .and. terms == term_quantization))
      end associate
   end subroutine choose_terms

end module gyroakf_allan_noise_fit
