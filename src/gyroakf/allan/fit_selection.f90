! SPDX-License-Identifier: MIT
!> Which points of an Allan curve the five noise terms describe, how well, and which of the terms are there.
!>
!> The thresholds are those of [[noise_options]], which says what each is for.
module gyroakf_allan_fit_selection
   use gyroakf_kinds, only : dp
   use gyroakf_special, only : chi_square_survival
   use gyroakf_allan_difference_kurtosis, only : kurtosis_samples
   use gyroakf_allan_fit_solver, only : fit_held, fit_points_type, fit_run, fit_run_type, shapes_of, solution_type
   use gyroakf_allan_noise_model, only : term_count, term_quantization
   implicit none (type, external)
   private
   public :: noise_options, find_run, find_floor, select_terms, upper_limit, run_between, is_described

   !> What to fit, and the thresholds of the fit
   type :: noise_options
      !> "auto": those of Q N B K R that the curve asks for. Or the letters of the terms that are fitted
      character(8) :: terms = "auto"
      !> Shortest and longest averaging time that the fit looks at, s. Where one of them or `terms` is
      !> given, all points in the range are fitted; else the longest run of points that the terms describe
      real(dp) :: tau_min = 0.0_dp, tau_max = huge(1.0_dp)
      !> Step that the samples are rounded to (least significant bit), in the unit of the curve; 0: none
      real(dp) :: lsb = 0.0_dp
      !> The terms describe a run of points if, with this floor, chi-square has a chance of more than
      !> `run_chance` and no residual exceeds `run_residual` of its standard deviations: what five power
      !> laws can claim of a sensor
      real(dp) :: run_floor = 0.02_dp, run_chance = 0.003_dp, run_residual = 3.5_dp
      !> The same residual of the whole curve: with 3.5 a clean record in 1000 loses its first octaves, and with them most of N
      real(dp) :: whole_residual = 4.0_dp
      !> Octaves that a run spans at least, and their share of those of the curve: fewer are described by
      !> chance. One more point is left out beside an excluded one, which passes only just
      integer :: run_octaves = 5
      real(dp) :: run_share = 0.5_dp
      !> Floors that are tried, relative to the variance, and what one has to gain of -2 log likelihood: a
      !> false floor is found in 0 to 1 % of Gaussian records
      real(dp) :: floors(6) = [0.0_dp, 0.0025_dp, 0.005_dp, 0.01_dp, 0.02_dp, 0.04_dp], floor_price = 4.0_dp
      !> What each term has to gain of chi-square. A false Q takes 1 to 3 % off N; R is rarer than K
      real(dp) :: term_price(term_count) = [12.0_dp, 6.0_dp, 6.0_dp, 6.0_dp, 9.0_dp]
      !> A term is stated if the best set without it costs more by this: else another one may take its place
      real(dp) :: stated_margin = 2.0_dp
      !> Rise of chi-square at an upper limit: 2.71 for 95 % of a single fit, 3.84 after the choice of terms
      real(dp) :: limit_rise = 3.84_dp
      !> N is stated where points are excluded at the start if it is this share of the first three points of the run; so
      !> is B of the last three where points are excluded at the end
      real(dp) :: plain_share = 0.5_dp
      !> Steps in standard deviations of the noise: a finer one is of no account, of a coarser one nothing is known of the
      !> noise without it
      real(dp) :: lsb_range(2) = [0.1_dp, 2.0_dp]
      !> Standard deviations from which on a kurtosis counts
      real(dp) :: kurtosis_deviations = 3.0_dp
   end type noise_options

contains

   !> Finds the longest run of points that the terms describe; of equally long ones that which excludes points at the start.
   subroutine find_run(points, options, run, found)
      !> The curve, octaves
      type(fit_points_type), intent(in) :: points
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> The run, with one point more left out beside excluded ones
      type(fit_run_type), intent(out) :: run
      !> There is one, and it is long enough
      logical, intent(out) :: found
      integer :: octaves, excluded, at_end

      octaves = size(points%m) - 1
      found = .false.
      do excluded = 0, octaves - options%run_octaves
         do at_end = 0, excluded
            run = run_between(points, options, 1 + excluded - at_end, size(points%m) - at_end)
            run%floor = options%run_floor
            if (.not. is_described(points, run, options, spread(.true., 1, term_count))) cycle
            if (run%first > 1 .or. at_end > 0) then
               run = run_between(points, options, merge(run%first + 1, 1, run%first > 1), run%last - merge(1, 0, at_end > 0))
            end if
            found = run%last - run%first >= max(real(options%run_octaves, dp), options%run_share*octaves)
            return
         end do
      end do
   end subroutine find_run

   !> A run of points without a floor.
   pure type(fit_run_type) function run_between(points, options, first, last) result(run)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> First and last point
      integer, intent(in) :: first, last
      real(dp) :: m, differences

      run%first = first
      run%last = last
      run%signed = first > 1
      m = real(points%m(first), dp)                         ! 24/n: variance of the kurtosis of n normal differences
      differences = real(min(points%samples, merge(points%samples, kurtosis_samples, first == 1)), dp)/m
      if (points%kurtosis(first) > 2*m*options%kurtosis_deviations*sqrt(24/differences)) run%kurtosis = points%kurtosis(first)
   end function run_between

   !> Whether some terms describe a run.
   logical function is_described(points, run, options, offered)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> The terms
      logical, intent(in) :: offered(term_count)
      type(solution_type) :: solution
      integer :: freedom
      logical :: whole

      whole = run%last - run%first + 1 == size(points%m)
      call fit_run(points, run, offered, solution)
      freedom = run%last - run%first + 1 - count(abs(solution%squares) > 0)
      is_described = maxval(abs(solution%residual)) < merge(options%whole_residual, options%run_residual, whole)
      if (freedom > 0) is_described = is_described .and. &
         & chi_square_survival(solution%chi_square, real(freedom, dp)) > options%run_chance
   end function is_described

   !> The floor of the misfit that remains in a run, by the likelihood.
   subroutine find_floor(points, options, offered, run, solution)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> Terms that are fitted
      logical, intent(in) :: offered(term_count)
      !> Its floor is set
      type(fit_run_type), intent(inout) :: run
      !> The fit with this floor
      type(solution_type), intent(out) :: solution
      type(fit_run_type) :: trial
      type(solution_type) :: fit
      real(dp) :: cost, least
      integer :: i

      least = huge(least)
      trial = run
      do i = 1, size(options%floors)
         trial%floor = options%floors(i)
         call fit_run(points, trial, offered, fit)
         cost = fit%chi_square + log_determinant(fit%covariance)
         if (trial%floor > 0) cost = cost + options%floor_price
         if (cost >= least) cycle
         least = cost
         run%floor = trial%floor
         solution = fit
      end do
   end subroutine find_floor

   !> The set of terms that costs least, chi-square and prices, and which of them no other set does without.
   subroutine select_terms(points, run, options, offered, solution, chosen, stated)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> Terms to choose from
      logical, intent(in) :: offered(term_count)
      !> The fit of all of them; replaced by that of the chosen ones, with the same covariance
      type(solution_type), intent(inout) :: solution
      !> The best set; those without which every set costs more by the margin
      logical, intent(out) :: chosen(term_count), stated(term_count)
      type(solution_type) :: trial, best
      real(dp) :: cost, least, without(term_count)
      logical :: used(term_count)
      integer :: set, j

      least = huge(least)
      without = huge(least)
      chosen = .false.
      do set = 1, 2**term_count - 1
         used = [(btest(set, j - 1), j=1, term_count)]
         if (any(used .and. .not. offered) .or. (run%signed .and. .not. used(term_quantization))) cycle
         trial = solution
         call fit_held(points, run, used, 0, trial)
         if (any(trial%squares <= 0 .and. used .and. .not. (run%signed .and. [(j == term_quantization, j=1, term_count)]))) cycle
         cost = trial%chi_square + sum(options%term_price, mask=used)
         where (.not. used) without = min(without, cost)
         if (cost >= least) cycle
         least = cost
         chosen = used
         best = trial
      end do
      stated = chosen .and. without > least + options%stated_margin
      if (any(chosen)) solution = best
   end subroutine select_terms

   !> One-sided limit of the square of a term: there chi-square, the other terms refitted and the covariance that of the
   !> model tried, is above its least value by `limit_rise`.
   real(dp) function upper_limit(points, run, options, offered, term, full) result(limit)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Thresholds
      type(noise_options), intent(in) :: options
      !> Terms that are fitted
      logical, intent(in) :: offered(term_count)
      !> The term
      integer, intent(in) :: term
      !> Squares of the fit of all of them
      real(dp), intent(in) :: full(term_count)
      real(dp) :: shapes(run%last - run%first + 1, term_count), squares(term_count), unit, low, least, middle
      integer :: i

      shapes = shapes_of(points, run)
      squares = full
      unit = minval(matmul(shapes, full)/shapes(:, term))
      low = max(full(term), 1e-3_dp*unit)
      least = profile(low)
      least = min(least, profile(1e-6_dp*unit))
      limit = 1.5_dp*low
      do while (limit < 1e4_dp*unit)
         if (profile(limit) >= least + options%limit_rise) exit
         low = limit
         limit = 1.6_dp*limit
      end do
      do i = 1, 8
         middle = sqrt(low*limit)
         if (profile(middle) < least + options%limit_rise) then
            low = middle
         else
            limit = middle
         end if
      end do

   contains

      !> Chi-square with the square of the term held at x, the other terms refitted from where they were last.
      real(dp) function profile(x)
         real(dp), intent(in) :: x
         type(solution_type) :: fit
         logical :: others(term_count)

         others = offered
         others(term) = .false.
         squares(term) = x
         call fit_run(points, run, others, fit, squares, fixed=term, passes=2)
         squares = fit%squares
         profile = fit%chi_square
      end function profile
   end function upper_limit

   !> Logarithm of the determinant of a positive definite matrix, by elimination.
   pure real(dp) function log_determinant(matrix)
      real(dp), intent(in) :: matrix(:, :)
      real(dp) :: a(size(matrix, 1), size(matrix, 1))
      integer :: i, j

      a = matrix
      log_determinant = 0
      do j = 1, size(a, 1)
         log_determinant = log_determinant + log(max(a(j, j), tiny(1.0_dp)))
         do i = j + 1, size(a, 1)
            a(i, j + 1:) = a(i, j + 1:) - a(i, j)/a(j, j)*a(j, j + 1:)
         end do
      end do
   end function log_determinant

end module gyroakf_allan_fit_selection
