! SPDX-License-Identifier: MIT
!> Tests of the minimization by BFGS.
module test_quasi_newton
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_quasi_newton, only : objective_type, minimize_options, minimum_type, minimize
   use expectations, only : unmet, failure => problem, test, error, check, check_refused
   implicit none (type, external)
   private
   public :: suite_quasi_newton

   !> Rosenbrock's function in any number of pairs: sum of 100 (y - x^2)^2 + (1 - x)^2
   type, extends(objective_type) :: rosenbrock_type
   contains
      procedure :: evaluate => evaluate_rosenbrock
   end type rosenbrock_type

   !> offset + half the sum of curvature_i (x_i - i)^2
   type, extends(objective_type) :: quadratic_type
      real(dp), allocatable :: curvature(:)
      real(dp) :: offset = 0.0_dp
   contains
      procedure :: evaluate => evaluate_quadratic
   end type quadratic_type

   !> x - log(x) - log(1 - x) beyond walls at 0 and 1; beyond them NaN, or infeasible
   type, extends(objective_type) :: wall_type
      logical :: infeasible = .true.
   contains
      procedure :: evaluate => evaluate_wall
   end type wall_type

contains

   subroutine suite_quasi_newton()
      call test("Rosenbrock's valley", test_rosenbrock)
      call test("Rosenbrock's valley in ten variables", test_ten)
      call test("a quadratic with the inverse Hessian needs one step", test_newton)
      call test("badly scaled quadratics", test_scaled)
      call test("a value of 1e6 does not hide the minimum", test_offset)
      call test("walls where the function ends", test_walls)
      call test("few iterations are not called converged", test_stopped)
      call test("arguments out of range", test_failures)
   end subroutine suite_quasi_newton

   subroutine evaluate_rosenbrock(self, parameter, value, gradient, feasible)
      class(rosenbrock_type), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible
      integer :: i

      value = 0
      gradient = 0
      feasible = same_type_as(self, rosenbrock_type())
      do i = 1, size(parameter) - 1, 2
         associate (x => parameter(i), y => parameter(i + 1))
            value = value + 100*(y - x*x)**2 + (1 - x)**2
            gradient(i) = -400*x*(y - x*x) - 2*(1 - x)
            gradient(i + 1) = 200*(y - x*x)
         end associate
      end do
   end subroutine evaluate_rosenbrock

   subroutine evaluate_quadratic(self, parameter, value, gradient, feasible)
      class(quadratic_type), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible
      integer :: i

      feasible = .true.
      gradient = [(self%curvature(i)*(parameter(i) - i), i=1, size(parameter))]
      value = self%offset + 0.5_dp*sum([(gradient(i)*(parameter(i) - i), i=1, size(parameter))])
   end subroutine evaluate_quadratic

   subroutine evaluate_wall(self, parameter, value, gradient, feasible)
      class(wall_type), intent(inout) :: self
      real(dp), intent(in) :: parameter(:)
      real(dp), intent(out) :: value, gradient(:)
      logical, intent(out) :: feasible

      value = 0
      gradient = 0
      feasible = parameter(1) > 0 .and. parameter(1) < 1
      if (feasible) then
         value = parameter(1) - log(parameter(1)) - log(1 - parameter(1))
         gradient = 1 - 1/parameter(1) + 1/(1 - parameter(1))
      else if (.not. self%infeasible) then
         feasible = .true.
         value = ieee_value(value, ieee_quiet_nan)
      end if
   end subroutine evaluate_wall

   subroutine test_rosenbrock()
      type(rosenbrock_type) :: valley
      type(minimum_type) :: minimum

      call minimize(valley, [-1.2_dp, 1.0_dp], minimize_options(), minimum, failure)
      if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
      call check(error, maxval(abs(minimum%parameter - 1)) < 1e-9_dp .and. minimum%value < 1e-18_dp, "at (1, 1)")
      call check(error, minimum%evaluations < 80, "with fewer than 80 evaluations")
   end subroutine test_rosenbrock

   subroutine test_ten()
      type(rosenbrock_type) :: valley
      type(minimum_type) :: minimum
      integer :: i

      call minimize(valley, [(merge(-1.2_dp, 1.0_dp, mod(i, 2) == 1) + 0.1_dp*i, i=1, 10)], minimize_options(), minimum, failure)
      if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
      call check(error, maxval(abs(minimum%parameter - 1)) < 1e-8_dp, "all variables are 1")
   end subroutine test_ten

   subroutine test_newton()
      type(quadratic_type) :: bowl
      type(minimum_type) :: minimum

      bowl%curvature = [1.0e6_dp, 2.0_dp, 1.0e-6_dp]
      call minimize(bowl, [5.0_dp, -4.0_dp, 1.0e3_dp], minimize_options(), minimum, failure, &
                    reshape([1.0e-6_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.5_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0e6_dp], [3, 3]))
      if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
      call check(error, minimum%iterations <= 2 .and. minimum%evaluations <= 4, "the step of Newton")
      call check(error, maxval(abs(minimum%parameter - [1, 2, 3])) < 1e-9_dp, "the center")
   end subroutine test_newton

   subroutine test_scaled()
      type(quadratic_type) :: bowl
      type(minimum_type) :: minimum
      integer :: decades

      do decades = 2, 8, 2
         bowl%curvature = [10.0_dp**decades, 1.0_dp, 10.0_dp**(decades/2), 3.0_dp]
         call minimize(bowl, [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], minimize_options(gradient_tolerance=1e-10_dp), minimum, failure)
         if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
         call check(error, maxval(abs(minimum%parameter - [1, 2, 3, 4])) < 1e-9_dp, "the center")
      end do
   end subroutine test_scaled

   subroutine test_offset()
      type(quadratic_type) :: bowl
      type(minimum_type) :: minimum

      bowl%curvature = [3.0_dp, 1.0_dp]
      bowl%offset = 1.0e6_dp
      call minimize(bowl, [7.0_dp, 7.0_dp], minimize_options(gradient_tolerance=1e-16_dp), minimum, failure)
      if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
      call check(error, maxval(abs(minimum%parameter - [1, 2])) < 1e-8_dp, "values alone would leave 1e-5")
   end subroutine test_offset

   !> Minimum of x - log x - log(1 - x): x^2 - 3 x + 1 = 0.
   subroutine test_walls()
      type(wall_type) :: wall
      type(minimum_type) :: minimum
      integer :: i

      do i = 1, 4
         wall%infeasible = mod(i, 2) == 0
         call minimize(wall, [merge(1e-3_dp, 1 - 1e-6_dp, i > 2)], minimize_options(), minimum, failure)
         if (unmet(.not. allocated(failure) .and. minimum%converged, "converged")) return
         call check(error, abs(minimum%parameter(1) - (3 - sqrt(5.0_dp))/2) < 1e-9_dp, "between the walls")
      end do
   end subroutine test_walls

   subroutine test_stopped()
      type(rosenbrock_type) :: valley
      type(minimum_type) :: minimum

      call minimize(valley, [-1.2_dp, 1.0_dp], minimize_options(max_iterations=3), minimum, failure)
      if (unmet(.not. allocated(failure) .and. .not. minimum%converged, "not converged")) return
      call check(error, minimum%iterations == 3 .and. minimum%value < 24.2_dp, "the best point so far")
   end subroutine test_stopped

   subroutine test_failures()
      type(wall_type) :: wall
      type(minimum_type) :: minimum
      real(dp) :: nothing(0), two_by_two(2, 2)

      two_by_two = 1
      call minimize(wall, nothing, minimize_options(), minimum, failure)
      call expect("no variable")
      call minimize(wall, [2.0_dp], minimize_options(), minimum, failure)
      call expect("start beyond the wall")
      call minimize(wall, [0.5_dp], minimize_options(gradient_tolerance=0.0_dp), minimum, failure)
      call expect("tolerance 0")
      call minimize(wall, [0.5_dp], minimize_options(max_iterations=-1), minimum, failure)
      call expect("negative iterations")
      call minimize(wall, [0.5_dp], minimize_options(), minimum, failure, two_by_two)
      call expect("size of the inverse Hessian")

   contains

      subroutine expect(name)
         character(*), intent(in) :: name

         if (allocated(error)) return
         call check_refused(failure, status%invalid_argument)
      end subroutine expect

   end subroutine test_failures

end module test_quasi_newton
