! SPDX-License-Identifier: MIT
!> Minimum of a smooth function of a few variables by the BFGS method.
!>
!>     type, extends(objective_type) :: bowl
!>     contains
!>        procedure :: evaluate => evaluate_bowl      ! value and gradient at a point
!>     end type
!>     call minimize(objective, start, minimize_options(), minimum, error)
!>
!> The inverse Hessian is kept as a matrix; a step ends where the strong Wolfe conditions hold. Near
!> the minimum, where differences of values are rounding, the decrease is judged by the slopes, so
!> that the gradient goes to zero and not only to the root of the precision. Sources: J. Nocedal, S.
!> J. Wright, Numerical Optimization (2006), algorithms 3.5, 3.6 and 6.1; W. W. Hager, H. Zhang,
!> SIAM J. Optim. 16 (2005) 170.
module gyroakf_quasi_newton
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: objective_type, minimize_options, minimum_type, minimize

   !> Sufficient decrease; decrease of the slope; slope in place of the decrease near the minimum
   real(dp), parameter :: decrease = 1.0e-4_dp, flattening = 0.9_dp, slope_share = 0.1_dp
   !> Differences of values below this share of the value are rounding
   real(dp), parameter :: rounding = 1.0e-14_dp
   !> Steps without progress after which the search ends; evaluations along a line
   integer, parameter :: max_stalled_steps = 5, max_line_evaluations = 40

   !> A function; extensions hold its data
   type, abstract :: objective_type
   contains
      procedure(evaluate_interface), deferred :: evaluate
   end type objective_type

   abstract interface
      !> Value and gradient at a point.
      subroutine evaluate_interface(self, parameter, value, gradient, feasible)
         import :: dp, objective_type
         implicit none (type, external)
         !> May keep work arrays
         class(objective_type), intent(inout) :: self
         !> The point: [n]
         real(dp), intent(in) :: parameter(:)
         !> The function there
         real(dp), intent(out) :: value
         !> Its derivatives: [n]
         real(dp), intent(out) :: gradient(:)
         !> False where the function does not exist; value and gradient are then not looked at
         logical, intent(out) :: feasible
      end subroutine evaluate_interface
   end interface

   !> When to stop
   type :: minimize_options
      !> Largest |gradient_i| max(|parameter_i|, 1) over max(|value|, 1) at the minimum, > 0
      real(dp) :: gradient_tolerance = 1.0e-9_dp
      !> Most iterations, >= 0
      integer :: max_iterations = 200
      !> Expected decrease, half of gradient' inverse Hessian gradient, not worth a step, >= 0
      real(dp) :: decrease_tolerance = 0.0_dp
      !> Decrease of the value that is not worth a step, >= 0: five such steps in succession are the
      !> end, as where the value falls for ever to a limit that it never reaches
      real(dp) :: least_decrease = 0.0_dp
   end type minimize_options

   !> What was found
   type :: minimum_type
      !> The best point and the gradient there: [n]
      real(dp), allocatable :: parameter(:), gradient(:)
      !> The function there
      real(dp) :: value = 0.0_dp
      !> Steps made, and calls of `evaluate`
      integer :: iterations = 0, evaluations = 0
      !> The gradient is as small as asked for, or no further decrease exceeds rounding
      logical :: converged = .false.
   end type minimum_type

   !> A point on the line of a step: its distance in steps, the function and its slope there
   type :: point_type
      real(dp) :: step = 0.0_dp, value = 0.0_dp, slope = 0.0_dp
      !> The function exists there
      logical :: feasible = .true.
      real(dp), allocatable :: parameter(:), gradient(:)
   end type point_type

contains

   !> Minimizes a function.
   subroutine minimize(objective, start, options, minimum, error, inverse_hessian)
      !> The function
      class(objective_type), intent(inout) :: objective
      !> Where to begin: [n], n >= 1; the function exists there
      real(dp), intent(in) :: start(:)
      !> When to stop
      type(minimize_options), intent(in) :: options
      !> The minimum, also where `converged` is false: the best point so far
      type(minimum_type), intent(out) :: minimum
      !> invalid_argument: no variables, options, sizes, no function value at the start
      type(error_type), allocatable, intent(out) :: error
      !> First guess: [n, n], symmetric, positive definite; else a multiple of the unit matrix
      real(dp), intent(in), optional :: inverse_hessian(:, :)
      type(point_type) :: here, next
      real(dp) :: h(size(start), size(start)), direction(size(start))
      logical :: unit, found
      integer :: stalled

      call check_arguments(size(start), options, error, inverse_hessian)
      if (allocated(error)) return
      direction = 0.0_dp
      call try_point(objective, start, direction, 0.0_dp, here, minimum%evaluations)
      minimum%parameter = here%parameter
      minimum%gradient = here%gradient
      if (.not. here%feasible) then
         call fatal_error(error, status%invalid_argument, &
            "the function does not exist at the start of the minimization")
         return
      end if
      call reset(h, unit, inverse_hessian)
      stalled = 0
      do while (minimum%iterations < options%max_iterations)
         minimum%converged = scaled_gradient(here) <= options%gradient_tolerance &
            .or. stalled >= max_stalled_steps
         if (minimum%converged) exit
         direction = -matmul(h, here%gradient)
         if (unit) direction = direction/max(norm2(here%gradient), 1.0_dp)
         here%step = 0.0_dp
         here%slope = dot_product(direction, here%gradient)
         minimum%converged = .not. unit .and. &
            -0.5_dp*here%slope < options%decrease_tolerance .and. here%slope <= 0.0_dp
         if (minimum%converged) exit
         found = here%slope < 0.0_dp
         if (found) call search_line(objective, here, direction, next, minimum%evaluations, found)
         if (found) then
            call update(h, next%parameter - here%parameter, next%gradient - here%gradient, unit)
            minimum%iterations = minimum%iterations + 1
            stalled = stalled + 1
            if (here%value - next%value > max(rounding*max(abs(here%value), 1.0_dp), &
               options%least_decrease)) stalled = 0
            here = next
         else
            minimum%converged = -here%slope <= rounding*max(abs(here%value), 1.0_dp)
            if (unit .or. minimum%converged) exit
            call reset(h, unit)
         end if
      end do
      if (.not. minimum%converged) minimum%converged = scaled_gradient(here) &
         <= options%gradient_tolerance
      minimum%parameter(:) = here%parameter
      minimum%gradient(:) = here%gradient
      minimum%value = here%value
   end subroutine minimize

   !> Refuses arguments out of range.
   subroutine check_arguments(n, options, error, inverse_hessian)
      integer, intent(in) :: n
      type(minimize_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      real(dp), intent(in), optional :: inverse_hessian(:, :)

      if (n < 1) then
         call fatal_error(error, status%invalid_argument, "there is no variable to minimize over")
      else if (.not. (options%gradient_tolerance > 0.0_dp .and. options%max_iterations >= 0 .and. &
         options%decrease_tolerance >= 0.0_dp .and. options%least_decrease >= 0.0_dp)) then
         call fatal_error(error, status%invalid_argument, "the gradient tolerance of a &
            &minimization must be positive, the others not negative")
      else if (present(inverse_hessian)) then
         if (any(shape(inverse_hessian) /= n)) call fatal_error(error, status%invalid_argument, &
            "the inverse Hessian and the start differ in size")
      end if
   end subroutine check_arguments

   !> The inverse Hessian before anything is known of it.
   pure subroutine reset(h, unit, inverse_hessian)
      real(dp), intent(out) :: h(:, :)
      logical, intent(out) :: unit
      real(dp), intent(in), optional :: inverse_hessian(:, :)
      integer :: i

      unit = .not. present(inverse_hessian)
      h(:, :) = 0.0_dp
      do i = 1, size(h, 1)
         h(i, i) = 1.0_dp
      end do
      if (present(inverse_hessian)) h(:, :) = inverse_hessian
   end subroutine reset

   !> Largest derivative, scaled by its variable and the value.
   pure real(dp) function scaled_gradient(point)
      type(point_type), intent(in) :: point

      scaled_gradient = maxval(abs(point%gradient)*max(abs(point%parameter), 1.0_dp))/ &
         max(abs(point%value), 1.0_dp)
   end function scaled_gradient

   !> The BFGS formula for the inverse Hessian; not where the curvature is not positive.
   pure subroutine update(h, s, y, unit)
      real(dp), intent(inout) :: h(:, :)
      !> Step and change of the gradient: [n]
      real(dp), intent(in) :: s(:), y(:)
      !> h is still the unit matrix and gets the size of the curvature first
      logical, intent(inout) :: unit
      real(dp) :: hy(size(s)), sy, factor
      integer :: j

      sy = dot_product(s, y)
      if (sy <= epsilon(sy)*norm2(s)*norm2(y)) return
      if (unit) h(:, :) = h*(sy/dot_product(y, y))
      unit = .false.
      hy = matmul(h, y)
      factor = (1.0_dp + dot_product(y, hy)/sy)/sy
      do j = 1, size(s)
         h(:, j) = h(:, j) + factor*s*s(j) - (hy*s(j) + s*hy(j))/sy
      end do
   end subroutine update

   !> Evaluates a point of a line.
   subroutine try_point(objective, origin, direction, step, point, evaluations)
      class(objective_type), intent(inout) :: objective
      real(dp), intent(in) :: origin(:), direction(:), step
      type(point_type), intent(inout) :: point
      integer, intent(inout) :: evaluations

      if (.not. allocated(point%gradient)) allocate (point%gradient(size(origin)))
      point%step = step
      point%parameter = origin + step*direction
      call objective%evaluate(point%parameter, point%value, point%gradient, point%feasible)
      evaluations = evaluations + 1
      if (point%feasible) point%feasible = ieee_is_finite(point%value) .and. &
         all(ieee_is_finite(point%gradient))
      if (point%feasible) then
         point%slope = dot_product(direction, point%gradient)
      else
         point%value = huge(1.0_dp)
         point%slope = 0.0_dp
         point%gradient(:) = 0.0_dp
      end if
   end subroutine try_point

   !> The point on a line where the strong Wolfe conditions hold; where none does, the lowest found.
   subroutine search_line(objective, origin, direction, best, evaluations, found)
      class(objective_type), intent(inout) :: objective
      type(point_type), intent(in) :: origin
      real(dp), intent(in) :: direction(:)
      type(point_type), intent(out) :: best
      integer, intent(inout) :: evaluations
      logical, intent(out) :: found
      type(point_type) :: low, high, trial
      real(dp) :: step, noise
      logical :: bracketed
      integer :: i

      low = origin
      bracketed = .false.
      noise = rounding*max(abs(origin%value), 1.0_dp)           ! differences that mean nothing
      step = 1.0_dp
      do i = 1, max_line_evaluations
         call try_point(objective, origin%parameter, direction, step, trial, evaluations)
         if (.not. is_lower(origin, low, trial, noise)) then
            high = trial
            bracketed = .true.
         else
            if (trial%slope*(trial%step - low%step) >= 0.0_dp) then
               high = low
               bracketed = .true.
            end if
            low = trial
            if (abs(trial%slope) <= -flattening*origin%slope) exit
         end if
         if (bracketed) then
            if (abs(high%step - low%step)*(-origin%slope) <= 1.0e-2_dp*noise) exit
            step = interpolate_step(low, high)
         else
            step = 3.0_dp*low%step
         end if
      end do
      best = low
      found = low%step > 0.0_dp
   end subroutine search_line

   !> A trial is low enough for the way it went, and lower than the lowest so far.
   pure logical function is_lower(origin, low, trial, noise)
      type(point_type), intent(in) :: origin, low, trial
      real(dp), intent(in) :: noise

      is_lower = .false.
      if (.not. trial%feasible) return
      is_lower = trial%value <= origin%value + decrease*trial%step*origin%slope .and. &
         trial%value < low%value
      if (is_lower .or. -origin%slope*trial%step > 1.0e3_dp*noise) return
      is_lower = trial%value <= origin%value + noise .and. &
         trial%slope <= (2.0_dp*slope_share - 1.0_dp)*origin%slope
   end function is_lower

   !> A point inside a bracket: the minimum of the cubic through values and slopes, off the ends.
   pure real(dp) function interpolate_step(low, high) result(step)
      type(point_type), intent(in) :: low, high
      real(dp), parameter :: margin = 0.1_dp
      real(dp) :: width, scale, a, b, s, t, share

      width = high%step - low%step
      share = 0.5_dp
      if (high%feasible) then
         a = 3.0_dp*((low%value - high%value)/width) + low%slope + high%slope
         scale = max(abs(a), abs(low%slope), abs(high%slope), tiny(a))
         a = a/scale
         s = low%slope/scale
         t = high%slope/scale
         b = sign(sqrt(max(a*a - s*t, 0.0_dp)), width)
         if (abs(t - s + 2.0_dp*b) > epsilon(b)) then
            share = min(max(1.0_dp - (t + b - a)/(t - s + 2.0_dp*b), margin), 1.0_dp - margin)
         end if
      end if
      step = low%step + share*width
   end function interpolate_step

end module gyroakf_quasi_newton
