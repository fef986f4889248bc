! SPDX-License-Identifier: MIT
!> Generalized least squares of the noise terms in a run of points of an Allan curve.
!>
!> The residuals r_i = 3 ((v_i/s_i)^(1/3) - 1 + C_ii/9), with s = A theta the model and C the relative
!> covariance of the points, are nearly normal down to one or two degrees of freedom (the cube root of
!> chi-square: Wilson and Hilferty, 1931). Their r' C^-1 r is minimized over theta >= 0: each step is
!> nonnegative least squares of L^-1 (A/s) theta = L^-1 (1 + r), C = L L', and C is renewed from the
!> fitted model. The covariance is that of the mixture ([[gyroakf_allan_fit_covariance]]) with two more
!> parts: the excess kurtosis of the white noise, and a floor for what a sum of five power laws cannot
!> describe.
module gyroakf_allan_fit_solver
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dgels, dpotrf, dtrtrs
   use gyroakf_allan_fit_covariance, only : covariance_basis_type, mixture_covariances
   use gyroakf_allan_noise_model, only : term_count, term_quantization, term_ramp, term_shape, term_walk, term_white
   implicit none (type, external)
   private
   public :: fit_points_type, fit_run_type, solution_type
   public :: fit_run, fit_held, relative_covariance, shapes_of, whitened, solve_nonnegative

   !> Points of an Allan curve; lengths in samples
   type :: fit_points_type
      !> Rate samples in the record
      integer(int64) :: samples = 0
      !> Averaging factors, ascending: [k]
      integer(int64), allocatable :: m(:)
      !> Variances, excess kurtosis of the white noise per sample as seen at each factor, share of the
      !> terms that gaps left: [k]
      real(dp), allocatable :: variance(:), kurtosis(:), complete(:)
      !> For the covariances
      type(covariance_basis_type) :: basis
   end type fit_points_type

   !> A run of these points
   type :: fit_run_type
      !> Its first and last one
      integer :: first = 1, last = 1
      !> Excess kurtosis per sample; floor of the relative deviation of the variances from the model
      real(dp) :: kurtosis = 0.0_dp, floor = 0.0_dp
      !> The 1/tau^2 term may be of either sign: a filter in the sensor bends the points before the run
      logical :: signed = .false.
   end type fit_run_type

   !> A fit
   type :: solution_type
      !> Squares of Q N B K R
      real(dp) :: squares(term_count) = 0.0_dp
      !> r' C^-1 r
      real(dp) :: chi_square = 0.0_dp
      !> Residuals in standard deviations, and the relative covariance: [n], [n, n]
      real(dp), allocatable :: residual(:), covariance(:, :)
   end type solution_type

   !> Steps of a fit at most, the step from which on only half of the way is taken, and the relative
   !> change of the model at which it ends
   integer, parameter :: steps_max = 40, halved_from = 9
   real(dp), parameter :: step_end = 1e-6_dp, pass_end = 1e-3_dp
   !> Least relative variance of a point: a ramp alone has none
   real(dp), parameter :: variance_least = 1e-14_dp

contains

   !> Fits some terms with the covariance of the fitted model.
   subroutine fit_run(points, run, used, solution, start, fixed, ramp, passes)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Which terms
      logical, intent(in) :: used(term_count)
      !> The fit
      type(solution_type), intent(out) :: solution
      !> Squares to start from (default: from the medians of the points)
      real(dp), intent(in), optional :: start(term_count)
      !> A term whose square stays as in `start`; 0: none
      integer, intent(in), optional :: fixed
      !> R is a ramp, free of noise, and not a random walk as large at the last point (default false)
      logical, intent(in), optional :: ramp
      !> Times that the covariance is renewed at most (default 4)
      integer, intent(in), optional :: passes
      real(dp) :: shapes(run%last - run%first + 1, term_count), old(run%last - run%first + 1)
      integer :: pass, passes_max, held
      logical :: is_ramp

      passes_max = 4
      if (present(passes)) passes_max = passes
      held = 0
      if (present(fixed)) held = fixed
      is_ramp = .false.
      if (present(ramp)) is_ramp = ramp
      shapes = shapes_of(points, run)
      associate (v => points%variance(run%first:run%last))
         solution%squares = [0.0_dp, median(v/shapes(:, term_white)), median(v), 0.0_dp, 0.0_dp]
      end associate
      if (present(start)) solution%squares = start
      do pass = 1, passes_max
         solution%covariance = relative_covariance(points, run, solution%squares, is_ramp)
         old = matmul(shapes, solution%squares)
         call fit_held(points, run, used, held, solution)
         if (maxval(abs(log(matmul(shapes, solution%squares)/old))) < pass_end) exit
      end do
   end subroutine fit_run

   !> Fits some terms with the covariance held as it is.
   subroutine fit_held(points, run, used, fixed, solution)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Which terms
      logical, intent(in) :: used(term_count)
      !> A further term whose square stays, 0: none
      integer, intent(in) :: fixed
      !> Its covariance is used, its squares are the start
      type(solution_type), intent(inout) :: solution
      real(dp) :: shapes(run%last - run%first + 1, term_count), new(term_count)
      real(dp), dimension(run%last - run%first + 1) :: model, known, right, own, ratio
      integer :: step, j
      logical :: free(term_count), done

      shapes = shapes_of(points, run)
      own = [(solution%covariance(j, j), j=1, size(own))]
      where (.not. (used .or. [(j == fixed, j=1, term_count)])) solution%squares = 0
      known = 0
      if (fixed > 0) known = solution%squares(fixed)*shapes(:, fixed)
      free = used .and. run%signed .and. [(j == term_quantization, j=1, term_count)]
      ratio = points%variance(run%first:run%last)
      if (any(matmul(shapes, solution%squares) <= 0)) then
         do j = 1, term_count
            if (used(j)) solution%squares(j) = median(ratio/shapes(:, j))/count(used) + tiny(1.0_dp)
         end do
      end if
      model = matmul(shapes, solution%squares)
      do step = 1, steps_max
         right = 1 + max(-0.9_dp, min(3.0_dp, residuals(ratio, model, own))) - known/model
         new = solution%squares
         call weighted_step(solution%covariance, shapes/spread(model, 2, term_count), right, used, free, new)
         if (step >= halved_from) new = (new + solution%squares)/2
         do while (any(matmul(shapes, new) <= 0))
            new = (new + solution%squares)/2
         end do
         done = maxval(abs(log(matmul(shapes, new)/model))) < step_end
         solution%squares = new
         model = matmul(shapes, new)
         if (done) exit
      end do
      right = residuals(ratio, model, own)
      solution%residual = right/sqrt(own)
      solution%chi_square = sum(whitened(solution%covariance, reshape(right, [size(right), 1]))**2)
   end subroutine fit_held

   !> The residuals of variances v about a model, relative variances C_ii.
   elemental real(dp) function residuals(v, model, own)
      real(dp), intent(in) :: v, model, own

      residuals = 3*((v/model)**(1/3.0_dp) - (1 - own/9))
   end function residuals

   !> A step: the squares of the used terms.
   subroutine weighted_step(covariance, columns, right, used, free, squares)
      real(dp), intent(in) :: covariance(:, :), columns(:, :), right(:)
      logical, intent(in) :: used(:), free(:)
      real(dp), intent(inout) :: squares(:)
      real(dp) :: part(size(right), count(used) + 1), x(count(used)), length(count(used))
      integer :: place(count(used)), j, k
      logical :: signed(count(used))

      k = count(used)
      place = pack([(j, j=1, size(used))], used)
      part(:, :k) = columns(:, place)
      part(:, k + 1) = right
      part = whitened(covariance, part)
      length = norm2(part(:, :k), dim=1)
      do j = 1, k
         part(:, j) = part(:, j)/length(j)
      end do
      signed = free(place)
      call solve_nonnegative(part(:, :k), part(:, k + 1), x, signed)
      squares(place) = x/length
   end subroutine weighted_step

   !> Relative covariance of the points.
   function relative_covariance(points, run, squares, ramp) result(covariance)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      !> Of the mixture
      real(dp), intent(in) :: squares(term_count)
      !> R is a ramp; else it moves like a random walk that is as large at the last point
      logical, intent(in) :: ramp
      !> Positive definite: [n, n]
      real(dp) :: covariance(run%last - run%first + 1, run%last - run%first + 1)
      real(dp) :: shapes(size(covariance, 1), term_count), noise(term_count)
      real(dp), dimension(size(covariance, 1)) :: base, white, m
      type(covariance_basis_type) :: part
      integer :: j

      shapes = shapes_of(points, run)
      m = real(points%m(run%first:run%last), dp)
      noise = max(0.0_dp, squares)
      if (.not. ramp) then
         noise(term_walk) = noise(term_walk) + 1.5_dp*m(size(m))*noise(term_ramp)
         noise(term_ramp) = 0
      end if
      base = matmul(shapes, noise)*sqrt(points%complete(run%first:run%last))
      white = noise(term_white)*shapes(:, term_white)/(matmul(shapes, squares)*sqrt(points%complete(run%first:run%last)))
      part%m = points%basis%m(run%first:run%last)
      part%product = points%basis%product(:, :, run%first:run%last, run%first:run%last)
      part%plain = points%basis%plain(:, run%first:run%last, run%first:run%last)
      call mixture_covariances(part, noise, covariance)
      do j = 1, size(m)
         covariance(:, j) = covariance(:, j)/(base*base(j)) + run%kurtosis/real(points%samples, dp)*white*white(j) &
            & + run%floor**2*min(m, m(j))/max(m, m(j))
         covariance(j, j) = covariance(j, j) + variance_least
      end do
   end function relative_covariance

   !> Shapes of the five terms at the points of a run: [n, 5].
   pure function shapes_of(points, run) result(shapes)
      !> The curve
      type(fit_points_type), intent(in) :: points
      !> What of it
      type(fit_run_type), intent(in) :: run
      real(dp) :: shapes(run%last - run%first + 1, term_count)
      integer :: j

      do j = 1, term_count
         shapes(:, j) = term_shape(j, real(points%m(run%first:run%last), dp))
      end do
   end function shapes_of

   !> L^-1 B, L L' the covariance.
   function whitened(covariance, b) result(x)
      !> Positive definite: [n, n]
      real(dp), intent(in) :: covariance(:, :)
      !> Right-hand sides: [n, k]
      real(dp), intent(in) :: b(:, :)
      !> [n, k]
      real(dp) :: x(size(b, 1), size(b, 2))
      real(dp) :: factor(size(b, 1), size(b, 1)), raise
      integer :: info, n, j

      n = size(b, 1)
      raise = 0
      do                                                    ! rounding may take the least eigenvalue below 0
         factor = covariance
         do j = 1, n
            factor(j, j) = factor(j, j)*(1 + raise)
         end do
         call dpotrf("L", n, factor, n, info)
         if (info == 0) exit
         raise = max(1e-12_dp, 10*raise)
      end do
      x = b
      call dtrtrs("L", "N", "N", n, size(b, 2), factor, n, x, n, info)
   end function whitened

   !> Minimizes |A x - b| subject to x >= 0: the active-set method of C. L. Lawson, R. J. Hanson,
   !> "Solving Least Squares Problems" (1974), chapter 23.
   subroutine solve_nonnegative(a, b, x, signed)
      !> Independent columns of length about 1: [rows, columns], rows >= columns
      real(dp), intent(in), contiguous :: a(:, :)
      !> Right-hand side: [rows]
      real(dp), intent(in), contiguous :: b(:)
      !> Solution: [columns]
      real(dp), intent(out) :: x(:)
      !> Unknowns that may be negative: [columns]
      logical, intent(in) :: signed(:)
      real(dp) :: gradient(size(x)), tolerance
      logical :: free(size(x)), tried(size(x))
      integer :: step, enter

      x = 0
      free = signed
      tried = .false.
      tolerance = 1e-12_dp*norm2(b)
      if (any(free)) call solve_free(a, b, signed, free, x)
      do step = 1, 10*size(x)
         gradient = matmul(b - matmul(a, x), a)
         if (.not. any(gradient > tolerance .and. .not. (free .or. tried))) return
         enter = maxloc(gradient, dim=1, mask=.not. (free .or. tried))
         free(enter) = .true.
         call solve_free(a, b, signed, free, x)
         tried = .false.
         tried(enter) = .not. free(enter)
      end do
   end subroutine solve_nonnegative

   !> Moves to the least-squares solution of the free unknowns, fixing those that reach 0 on the way.
   subroutine solve_free(a, b, signed, free, x)
      real(dp), intent(in), contiguous :: a(:, :), b(:)
      logical, intent(in) :: signed(:)
      logical, intent(inout) :: free(:)
      real(dp), intent(inout) :: x(:)
      real(dp) :: part(size(a, 1), size(x)), right(size(a, 1), 1), goal(size(x)), work(64*size(x) + 64), share
      integer :: place(size(x)), round, j, k, info

      do round = 1, size(x) + 1
         k = count(free)
         if (k == 0) return
         place(:k) = pack([(j, j=1, size(x))], free)
         part(:, :k) = a(:, place(:k))
         right(:, 1) = b
         call dgels("N", size(b), k, 1, part, size(b), right, size(b), work, size(work), info)
         goal = 0
         if (info == 0) goal(place(:k)) = right(:k, 1)
         if (all(goal > 0 .or. signed .or. .not. free)) then
            x = goal
            return
         end if
         share = 1
         do j = 1, size(x)
            if (free(j) .and. .not. signed(j) .and. goal(j) <= 0) then
               share = min(share, x(j)/max(x(j) - goal(j), tiny(1.0_dp)))
            end if
         end do
         do j = 1, size(x)
            if (.not. free(j)) cycle
            if (.not. signed(j) .and. goal(j) <= 0 .and. x(j) <= share*(x(j) - goal(j))*(1 + 1e-12_dp)) then
               free(j) = .false.
               x(j) = 0
            else
               x(j) = x(j) + share*(goal(j) - x(j))
            end if
         end do
      end do
   end subroutine solve_free

   !> Median of a few numbers.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      integer :: i, below(size(x))

      below = [(count(x < x(i)) + count(.not. (x(:i - 1) < x(i) .or. x(:i - 1) > x(i))), i=1, size(x))]
      median = (sum(x, mask=below == (size(x) - 1)/2) + sum(x, mask=below == size(x)/2))/2
   end function median

end module gyroakf_allan_fit_solver
