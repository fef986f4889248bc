! SPDX-License-Identifier: MIT
!> Which points of an Allan curve the five noise terms describe, how well, and which of the terms
!> are there.
!>
!> The thresholds are those of [[noise_options]], which says what each is for.
module gyroakf_allan_fit_selection
   use gyroakf_kinds, only : dp
   use gyroakf_special, only : chi_square_survival
   use gyroakf_allan_difference_kurtosis, only : kurtosis_samples
   use gyroakf_allan_fit_solver, only : fit_held, fit_points_type, fit_terms, log_determinant, &
      & solution_type
   use gyroakf_allan_noise_model, only : term_count, term_quantization, term_ramp, term_shape, &
      & term_walk, terms
   implicit none (type, external)
   private
   public :: noise_options, points_between, find_run, is_described, is_likely, find_floor, &
      & select_terms, upper_limit

   !> What to fit, and the thresholds of the fit
   type :: noise_options
      !> "auto": those of Q N B K R that the curve asks for. Or the letters of the terms that are
      !> fitted
      character(8) :: terms = "auto"
      !> Shortest and longest averaging time that the fit looks at, s. Where one of them or `terms`
      !> is given, all points in the range are fitted; else the longest run of points that the terms
      !> describe
      real(dp) :: tau_min = 0.0_dp, tau_max = huge(1.0_dp)
      !> Step that the samples are rounded to (least significant bit), in the unit of the curve; 0:
      !> none
      real(dp) :: lsb = 0.0_dp
      !> A run of points is accepted if, with this floor, the p-value of chi-square is above
      !> `min_p_value` and no residual exceeds `max_residual` standard deviations
      real(dp) :: run_floor = 0.02_dp, min_p_value = 0.003_dp, max_residual = 3.5_dp
      !> Largest residual where the run is the whole curve, standard deviations
      real(dp) :: max_whole_residual = 4.0_dp
      !> Least octaves of a run, and their least fraction of the octaves of the curve; the point
      !> beside an excluded one is excluded too
      integer :: run_octaves = 5
      real(dp) :: run_share = 0.5_dp
      !> Candidate floors, relative to the variance, and the penalty of a floor on
      !> -2 log likelihood
      real(dp) :: floors(6) = [0.0_dp, 0.0025_dp, 0.005_dp, 0.01_dp, 0.02_dp, 0.04_dp], &
         & floor_penalty = 4.0_dp
      !> Penalty of each term on chi-square, Q N B K R
      real(dp) :: term_penalty(term_count) = [12.0_dp, 6.0_dp, 6.0_dp, 6.0_dp, 9.0_dp]
      !> A term is stated if the best set without it costs more by this: else another one may take
      !> its place
      real(dp) :: stated_margin = 2.3_dp
      !> Rise of chi-square at an upper limit: 2.71 for 95 % of a single fit, 3.84 after the choice
      !> of terms
      real(dp) :: limit_chi_square = 3.84_dp
      !> Least fraction of the variance that N has at the first three points of a run that begins
      !> late, and B at the last three of one that ends early; below it the term is withheld
      real(dp) :: min_term_fraction = 0.5_dp
      !> Range of the step, in standard deviations of the noise: a finer one is negligible, with a
      !> coarser one N without quantization is withheld
      real(dp) :: lsb_range(2) = [0.1_dp, 2.0_dp]
      !> Standard deviations from which on a kurtosis counts
      real(dp) :: kurtosis_deviations = 3.0_dp
   end type noise_options

contains

   !> The octaves `first` to `last` of a curve, with their excess kurtosis if it is significant.
   pure type(fit_points_type) function points_between(curve, options, first, last) result(run)
      type(fit_points_type), intent(in) :: curve
      type(noise_options), intent(in) :: options
      integer, intent(in) :: first, last
      real(dp) :: m, differences

      run%samples = curve%samples
      run%first = first
      allocate (run%m, source=curve%m(first:last))
      allocate (run%variance, source=curve%variance(first:last))
      allocate (run%share, source=curve%share(first:last))
      allocate (run%basis%product, source=curve%basis%product(:, :, first:last, first:last))
      allocate (run%basis%plain, source=curve%basis%plain(:, first:last, first:last))
      allocate (run%shape, source=term_shape(spread(terms, 1, size(run%m)), &
         & spread(real(run%m, dp), 2, term_count)))
      run%signed = first > 1
      ! 24/n: variance of the kurtosis of n normal differences
      m = real(run%m(1), dp)
      differences = real(min(run%samples, merge(run%samples, kurtosis_samples, first == 1)), dp)/m
      if (curve%kurtosis(first) > 2*m*options%kurtosis_deviations*sqrt(24/differences)) then
         run%excess = curve%kurtosis(first)
      end if
   end function points_between

   !> Finds the longest run of octaves that the terms describe; of equally long ones that which
   !> excludes octaves at the start.
   subroutine find_run(curve, options, run, found)
      !> All octaves
      type(fit_points_type), intent(in) :: curve
      type(noise_options), intent(in) :: options
      !> The run, with one octave more left out beside excluded ones
      type(fit_points_type), intent(out) :: run
      !> There is one, and it is long enough
      logical, intent(out) :: found
      integer :: points, excluded, at_end, first, last

      points = size(curve%m)
      found = .false.
      do excluded = 0, points - 1 - options%run_octaves
         do at_end = 0, excluded
            first = 1 + excluded - at_end
            last = points - at_end
            run = points_between(curve, options, first, last)
            if (.not. is_described(run, options, spread(.true., 1, term_count), &
               & excluded == 0)) cycle
            if (first > 1) first = first + 1
            if (last < points) last = last - 1
            run = points_between(curve, options, first, last)
            found = last - first >= max(real(options%run_octaves, dp), &
               & options%run_share*(points - 1))
            return
         end do
      end do
   end subroutine find_run

   !> Whether the terms on offer describe octaves, those of the whole curve or some of them.
   logical function is_described(points, options, offered, whole)
      type(fit_points_type), intent(in) :: points
      type(noise_options), intent(in) :: options
      logical, intent(in) :: offered(term_count), whole
      type(fit_points_type) :: floored
      type(solution_type) :: fit

      floored = points
      floored%floor = options%run_floor
      call fit_terms(floored, offered, fit)
      is_described = is_likely(fit, options) .and. &
         & maxval(abs(fit%residual)) &
         & < merge(options%max_whole_residual, options%max_residual, whole)
   end function is_described

   !> Whether the chance of as large a chi-square is above `min_p_value`.
   logical function is_likely(fit, options)
      type(solution_type), intent(in) :: fit
      type(noise_options), intent(in) :: options
      integer :: freedom

      freedom = size(fit%residual) - count(abs(fit%squares) > 0)
      is_likely = freedom <= 0
      if (freedom > 0) is_likely = &
         & chi_square_survival(fit%chi_square, real(freedom, dp)) > options%min_p_value
   end function is_likely

   !> The floor of the misfit that remains, by the likelihood.
   subroutine find_floor(points, options, offered, solution)
      !> Their floor is set
      type(fit_points_type), intent(inout) :: points
      type(noise_options), intent(in) :: options
      logical, intent(in) :: offered(term_count)
      !> The fit with this floor
      type(solution_type), intent(out) :: solution
      type(fit_points_type) :: trial
      type(solution_type) :: fit
      real(dp) :: cost, least
      integer :: i

      least = huge(least)
      trial = points
      do i = 1, size(options%floors)
         trial%floor = options%floors(i)
         call fit_terms(trial, offered, fit)
         cost = fit%chi_square + log_determinant(fit%covariance)
         if (trial%floor > 0) cost = cost + options%floor_penalty
         if (cost >= least) cycle
         least = cost
         points%floor = trial%floor
         solution = fit
      end do
   end subroutine find_floor

   !> The set of terms that costs least, chi-square and prices, and which of them no other set does
   !> without.
   subroutine select_terms(points, options, offered, solution, chosen, stated, margin)
      type(fit_points_type), intent(in) :: points
      type(noise_options), intent(in) :: options
      !> Terms to choose from
      logical, intent(in) :: offered(term_count)
      !> The fit of all of them; replaced by that of the chosen ones, with the same covariance
      type(solution_type), intent(inout) :: solution
      !> The best set; those without which every set costs more by the margin
      logical, intent(out) :: chosen(term_count), stated(term_count)
      !> What the best set without K, and that without K and R, costs more than the best one; huge
      !> where there is none
      real(dp), intent(out) :: margin(2)
      type(solution_type) :: trial, best
      real(dp) :: cost, least, without(term_count), bounded
      logical :: used(term_count), signed(term_count)
      integer :: set

      least = huge(least)
      without = huge(least)
      bounded = huge(least)
      chosen = .false.
      signed = points%signed .and. terms == term_quantization
      do set = 1, 2**term_count - 1
         used = btest(set, terms - 1)
         if (any(used .and. .not. offered) .or. any(signed .and. .not. used)) cycle
         trial = solution
         trial%squares = merge(solution%squares, 0.0_dp, used)
         call fit_held(points, used, trial)
         if (any(trial%squares <= 0 .and. used .and. .not. signed)) cycle
         cost = trial%chi_square + sum(options%term_penalty, mask=used)
         where (.not. used) without = min(without, cost)
         if (.not. any(used([term_walk, term_ramp]))) bounded = min(bounded, cost)
         if (cost >= least) cycle
         least = cost
         chosen = used
         best = trial
      end do
      stated = chosen .and. without > least + options%stated_margin
      margin = [without(term_walk), bounded]
      where (margin < huge(least)) margin = margin - least
      if (any(chosen)) solution = best
   end subroutine select_terms

   !> One-sided limit of the square of a term: there chi-square, the other terms refitted and the
   !> covariance that of the model tried, is above its least value by `limit_chi_square`.
   real(dp) function upper_limit(points, options, offered, term, full) result(limit)
      type(fit_points_type), intent(in) :: points
      type(noise_options), intent(in) :: options
      !> Terms that are fitted, one of them, and the squares of the fit of all
      logical, intent(in) :: offered(term_count)
      integer, intent(in) :: term
      real(dp), intent(in) :: full(term_count)
      real(dp) :: squares(term_count), unit, low, least, middle
      integer :: i

      squares = full
      unit = minval(matmul(points%shape, full)/points%shape(:, term))
      low = max(full(term), 1e-3_dp*unit)
      least = profile(low)
      least = min(least, profile(1e-6_dp*unit))
      limit = 1.5_dp*low
      do while (limit < 1e4_dp*unit)
         if (profile(limit) >= least + options%limit_chi_square) exit
         low = limit
         limit = 1.6_dp*limit
      end do
      do i = 1, 8
         middle = sqrt(low*limit)
         if (profile(middle) < least + options%limit_chi_square) then
            low = middle
         else
            limit = middle
         end if
      end do

   contains

      !> Chi-square with the square of the term held at x, the other terms refitted from where they
      !> were last.
      real(dp) function profile(x)
         real(dp), intent(in) :: x
         type(solution_type) :: fit

         squares(term) = x
         call fit_terms(points, offered .and. terms /= term, fit, squares, passes=2)
         squares = fit%squares
         profile = fit%chi_square
      end function profile
   end function upper_limit

end module gyroakf_allan_fit_selection
