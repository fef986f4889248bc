! SPDX-License-Identifier: MIT
!> Generalized least squares of the noise terms in consecutive octaves of an Allan curve.
!>
!> The residuals r_i = 3 ((v_i/s_i)^(1/3) - 1 + C_ii/9), with s = A theta the model and C the
!> relative covariance of the points, are nearly normal down to one or two degrees of freedom (the
!> cube root of chi-square: Wilson and Hilferty, 1931). Their r' C^-1 r is minimized over
!> theta >= 0: each step is nonnegative least squares of L^-1 (A/s) theta = L^-1 (1 + r), C = L L',
!> and C is renewed from the fitted model. The covariance is that of the mixture
!> ([[gyroakf_allan_fit_covariance]]) with two more parts: the excess kurtosis of the white noise,
!> and a floor for what a sum of five power laws cannot describe.
module gyroakf_allan_fit_solver
   use gyroakf_kinds, only : dp, int64
   use gyroakf_lapack, only : dgels, dpotrf, dtrtrs
   use gyroakf_sort, only : median_of
   use gyroakf_allan_fit_covariance, only : covariance_basis_type, mixture_covariances
   use gyroakf_allan_noise_model, only : term_count, term_quantization, term_ramp, term_walk, &
      & term_white, terms
   implicit none (type, external)
   private
   public :: fit_points_type, solution_type, fit_terms, fit_held, whitened, log_determinant, &
      & solve_nonnegative

   !> Consecutive octaves of an Allan curve; lengths in samples
   type :: fit_points_type
      !> Rate samples in the record; the place of the first of the octaves among those of the curve
      integer(int64) :: samples = 0
      integer :: first = 1
      !> Averaging factors, ascending: [n]
      integer(int64), allocatable :: m(:)
      !> Variances; excess kurtosis of the white noise per sample as seen at each factor; degrees of
      !> freedom as a share of those of a complete record: [n]
      real(dp), allocatable :: variance(:), kurtosis(:), share(:)
      !> Variance of each term of coefficient 1: [n, 5]
      real(dp), allocatable :: shape(:, :)
      !> For the covariances
      type(covariance_basis_type) :: basis
      !> Excess kurtosis per sample; floor of the relative deviation of the variances from the model
      real(dp) :: excess = 0.0_dp, floor = 0.0_dp
      !> The 1/tau^2 term may be of either sign: a filter in the sensor bends the points before the
      !> first
      logical :: signed = .false.
      !> R is a ramp, free of noise, and not a random walk as large at the last point
      logical :: ramp = .false.
   end type fit_points_type

   !> A fit
   type :: solution_type
      !> Squares of Q N B K R
      real(dp) :: squares(term_count) = 0.0_dp
      !> r' C^-1 r
      real(dp) :: chi_square = 0.0_dp
      !> Residuals in standard deviations, and the relative covariance: [n], [n, n]
      real(dp), allocatable :: residual(:), covariance(:, :)
   end type solution_type

   !> Steps at most, the step from which on half of the way is taken, relative changes of the model
   !> that end steps and passes
   integer, parameter :: steps_max = 40, halved_from = 9
   real(dp), parameter :: step_end = 1e-6_dp, pass_end = 1e-3_dp
   !> Least relative variance of a point: a ramp alone has none
   real(dp), parameter :: variance_least = 1e-14_dp

contains

   !> Fits some terms with the covariance of the fitted model.
   subroutine fit_terms(points, used, solution, start, passes)
      type(fit_points_type), intent(in) :: points
      !> Which terms; the squares of the others stay as in `start`
      logical, intent(in) :: used(term_count)
      type(solution_type), intent(out) :: solution
      !> Squares to start from (default: from the medians of the points, 0 of terms that are not
      !> used)
      real(dp), intent(in), optional :: start(term_count)
      !> Times that the covariance is renewed at most (default 4)
      integer, intent(in), optional :: passes
      real(dp) :: old(size(points%m))
      integer :: pass, passes_max

      passes_max = 4
      if (present(passes)) passes_max = passes
      solution%squares = merge([0.0_dp, median_of(points%variance/points%shape(:, term_white)), &
         & median_of(points%variance), 0.0_dp, 0.0_dp], 0.0_dp, used)
      if (present(start)) solution%squares = start
      do pass = 1, passes_max
         call make_positive(points, used, solution%squares)
         solution%covariance = relative_covariance(points, solution%squares)
         old = matmul(points%shape, solution%squares)
         call fit_held(points, used, solution)
         if (maxval(abs(log(matmul(points%shape, solution%squares)/old))) < pass_end) exit
      end do
   end subroutine fit_terms

   !> Where the variances of the terms are not all positive, the used terms share the points evenly,
   !> by the medians.
   subroutine make_positive(points, used, squares)
      type(fit_points_type), intent(in) :: points
      logical, intent(in) :: used(term_count)
      real(dp), intent(inout) :: squares(term_count)
      integer :: j

      if (all(matmul(points%shape, squares) > 0)) return
      do j = 1, term_count
         if (used(j)) squares(j) = median_of(points%variance/points%shape(:, j))/count(used) &
            & + tiny(1.0_dp)
      end do
   end subroutine make_positive

   !> Fits some terms with the covariance held as it is.
   subroutine fit_held(points, used, solution)
      type(fit_points_type), intent(in) :: points
      !> Which terms; the squares of the others stay
      logical, intent(in) :: used(term_count)
      !> Its covariance is used, its squares are the start
      type(solution_type), intent(inout) :: solution
      real(dp), dimension(size(points%m)) :: model, known, right, own
      real(dp) :: new(term_count)
      integer :: step, j
      logical :: done

      own = [(solution%covariance(j, j), j=1, size(own))]
      known = matmul(points%shape, merge(0.0_dp, solution%squares, used))
      call make_positive(points, used, solution%squares)
      model = matmul(points%shape, solution%squares)
      do step = 1, steps_max
         right = 1 + max(-0.9_dp, min(3.0_dp, residuals(points%variance, model, own))) - known/model
         new = solution%squares
         call weighted_step(points, solution%covariance, model, right, used, new)
         if (step >= halved_from) new = (new + solution%squares)/2
         do while (any(matmul(points%shape, new) <= 0))
            new = (new + solution%squares)/2
         end do
         done = maxval(abs(log(matmul(points%shape, new)/model))) < step_end
         solution%squares = new
         model = matmul(points%shape, new)
         if (done) exit
      end do
      right = residuals(points%variance, model, own)
      solution%residual = right/sqrt(own)
      solution%chi_square = sum(whitened(solution%covariance, reshape(right, [size(right), 1]))**2)
   end subroutine fit_held

   !> The residuals of variances v about a model, relative variances C_ii.
   elemental real(dp) function residuals(v, model, own)
      real(dp), intent(in) :: v, model, own

      residuals = 3*((v/model)**(1/3.0_dp) - (1 - own/9))
   end function residuals

   !> A step: the squares of the used terms.
   subroutine weighted_step(points, covariance, model, right, used, squares)
      type(fit_points_type), intent(in) :: points
      real(dp), intent(in) :: covariance(:, :), model(:), right(:)
      logical, intent(in) :: used(:)
      real(dp), intent(inout) :: squares(:)
      real(dp) :: part(size(right), count(used) + 1), x(count(used)), length(count(used))
      integer :: place(count(used)), k

      k = count(used)
      place = pack(terms, used)
      part(:, :k) = points%shape(:, place)/spread(model, 2, k)
      part(:, k + 1) = right
      part = whitened(covariance, part)
      length = norm2(part(:, :k), dim=1)
      part(:, :k) = part(:, :k)/spread(length, 1, size(right))
      call solve_nonnegative(part(:, :k), part(:, k + 1), x, points%signed &
         & .and. place == term_quantization)
      squares(place) = x/length
   end subroutine weighted_step

   !> Relative covariance of the points.
   function relative_covariance(points, squares) result(covariance)
      type(fit_points_type), intent(in) :: points
      real(dp), intent(in) :: squares(term_count)
      real(dp) :: covariance(size(points%m), size(points%m)), noise(term_count)
      real(dp), dimension(size(points%m)) :: base, white, m
      integer :: j

      m = real(points%m, dp)
      noise = max(0.0_dp, squares)
      if (.not. points%ramp) then
         noise(term_walk) = noise(term_walk) + 1.5_dp*m(size(m))*noise(term_ramp)
         noise(term_ramp) = 0
      end if
      base = matmul(points%shape, noise)*sqrt(points%share)
      white = noise(term_white)*points%shape(:, term_white) &
         & /(matmul(points%shape, squares)*sqrt(points%share))
      covariance = mixture_covariances(points%basis, noise)
      do j = 1, size(m)
         covariance(:, j) = covariance(:, j)/(base*base(j)) &
            & + points%excess/real(points%samples, dp)*white*white(j) &
            & + points%floor**2*min(m, m(j))/max(m, m(j))
         covariance(j, j) = covariance(j, j) + variance_least
      end do
   end function relative_covariance

   !> L of a covariance matrix L L', in the lower triangle. Where rounding takes its least
   !> eigenvalue below 0, its diagonal is raised.
   function factor_of(covariance) result(factor)
      real(dp), intent(in) :: covariance(:, :)
      real(dp) :: factor(size(covariance, 1), size(covariance, 1)), raise
      integer :: info, j

      raise = 0
      do
         factor = covariance
         do j = 1, size(factor, 1)
            factor(j, j) = factor(j, j)*(1 + raise)
         end do
         call dpotrf("L", size(factor, 1), factor, size(factor, 1), info)
         if (info == 0 .or. raise > 1) exit
         raise = max(1e-12_dp, 10*raise)
      end do
   end function factor_of

   !> L^-1 B of a covariance matrix L L': [n, n], [n, k].
   function whitened(covariance, b) result(x)
      real(dp), intent(in) :: covariance(:, :), b(:, :)
      real(dp) :: x(size(b, 1), size(b, 2)), factor(size(b, 1), size(b, 1))
      integer :: info

      factor = factor_of(covariance)
      x = b
      call dtrtrs("L", "N", "N", size(b, 1), size(b, 2), factor, size(b, 1), x, size(b, 1), info)
   end function whitened

   !> Logarithm of the determinant of a covariance matrix.
   real(dp) function log_determinant(covariance)
      real(dp), intent(in) :: covariance(:, :)
      real(dp) :: factor(size(covariance, 1), size(covariance, 1))
      integer :: j

      factor = factor_of(covariance)
      log_determinant = 2*sum([(log(factor(j, j)), j=1, size(factor, 1))])
   end function log_determinant

   !> Minimizes |A x - b| subject to x >= 0: the conditions of the minimum are a linear
   !> complementarity problem, solved by exchange of the last unknown that violates them (K. G.
   !> Murty, Opsearch 11, 1974); it ends as A'A is positive definite.
   subroutine solve_nonnegative(a, b, x, signed)
      !> Independent columns of length about 1: [rows, columns], rows >= columns; right-hand side:
      !> [rows]
      real(dp), intent(in), contiguous :: a(:, :), b(:)
      !> Solution: [columns]
      real(dp), intent(out) :: x(:)
      !> Unknowns that may be negative: [columns]
      logical, intent(in) :: signed(:)
      real(dp) :: part(size(a, 1), size(x)), right(size(a, 1), 1), work(64*size(x) + 64), &
         & gradient(size(x))
      logical :: free(size(x))
      integer :: place(size(x)), step, last, j, k, info

      free = .true.
      do step = 1, 2**size(x)
         k = count(free)
         place(:k) = pack([(j, j=1, size(x))], free)
         part(:, :k) = a(:, place(:k))
         right(:, 1) = b
         if (k > 0) call dgels("N", size(b), k, 1, part, size(b), right, size(b), work, &
            & size(work), info)
         x = 0
         x(place(:k)) = right(:k, 1)
         gradient = matmul(b - matmul(a, x), a)
         last = findloc(merge(x < 0 .and. .not. signed, gradient > 1e-12_dp*norm2(b), free), &
            & .true., dim=1, back=.true.)
         if (last == 0) exit
         free(last) = .not. free(last)
      end do
      where (.not. signed) x = max(x, 0.0_dp)
   end subroutine solve_nonnegative

end module gyroakf_allan_fit_solver
