! SPDX-License-Identifier: MIT
!> The maximum of the likelihood of a drift model: searched from several starts, then approached
!> with the curvature at it until the slope is rounding.
module gyroakf_filter_drift_search
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_quasi_newton, only : minimize, minimize_options, minimum_type
   use gyroakf_filter_drift_objective, only : likelihood_objective, invert_curvature, value_at
   use gyroakf_filter_drift_starts, only : from_ar, from_walk, known_type, list_starts, of_all_kinds
   implicit none (type, external)
   private
   public :: search, finish

   !> Slope of the log-likelihood of a sample at which a search ends; steps of a search, and of its
   !> end: two or three are enough, more would follow the long ridges of models that the series does
   !> not distinguish
   real(dp), parameter :: gradient_tolerance = 1.0e-8_dp
   integer, parameter :: max_iterations = 40, max_final_steps = 6
   !> Log-likelihood that is not worth a step: of a search (the parameters are then
   !> within 5 % of their errors), of the last steps (5e-4)
   real(dp), parameter :: search_tolerance = 1.0e-3_dp, final_tolerance = 1.0e-7_dp
   !> Distance of the minimum in standard errors from which Newton's steps lead there, and most
   !> of them: with a curvature from farther away each divides the distance by 2 or more, with that
   !> of the place by 1e3
   real(dp), parameter :: newton_range = 0.1_dp
   integer, parameter :: max_newton_steps = 8
   !> Log-likelihood that makes no difference between a variance and 0
   real(dp), parameter :: negligible_gain = 1.0e-2_dp
   !> Groups whose best starts are followed to their end, the two best of the first
   integer, parameter :: followed(4) = [of_all_kinds, of_all_kinds, from_walk, from_ar]

contains

   !> The best of the ends of the best starts, nearly.
   subroutine search(objective, known, minimum)
      type(likelihood_objective), intent(inout) :: objective
      type(known_type), intent(in) :: known
      !> Without parameters where there is none
      type(minimum_type), intent(out) :: minimum
      type(minimum_type) :: other
      type(error_type), allocatable :: failed
      real(dp), allocatable :: start(:, :), value(:)
      integer, allocatable :: group(:)
      real(dp) :: tolerance
      integer :: k, first

      tolerance = search_tolerance/real(objective%measurements, dp)
      objective%zero = .false.
      call list_starts(objective, known, start, group)
      allocate (value(size(start, 2)))
      do k = 1, size(value)
         value(k) = value_at(objective, start(:, k))
      end do
      do k = 1, size(followed)
         first = minloc(value, dim=1, mask=group == followed(k))
         if (first == 0) cycle
         group(first) = 0
         call minimize(objective, start(:, first), minimize_options(gradient_tolerance, &
            max_iterations, tolerance, tolerance), other, failed)
         if (allocated(failed)) cycle
         if (.not. allocated(minimum%parameter)) minimum = other
         if (other%value < minimum%value) minimum = other
      end do
   end subroutine search

   !> The last steps, with the curvature. Where it has no inverse, or they do not end, the search
   !> goes on; what it does not tell from 0 is dropped.
   subroutine finish(objective, minimum, inverse, known)
      type(likelihood_objective), intent(inout) :: objective
      !> Nearly a minimum; that minimum afterwards
      type(minimum_type), intent(inout) :: minimum
      !> Covariance of the parameters
      real(dp), intent(out) :: inverse(:, :)
      !> False where the curvature is not that of a maximum of the likelihood
      logical, intent(out) :: known
      real(dp) :: n
      logical :: settled, dropped

      n = real(objective%measurements, dp)
      call invert_curvature(objective, minimum%parameter, inverse, known)
      if (known) call continue_search(objective, max_final_steps, minimum, n*inverse)
      settled = known .and. minimum%converged
      if (.not. settled) call continue_search(objective, max_iterations, minimum)
      call drop_zero_variances(objective, minimum, dropped)
      if (.not. settled .or. dropped) then
         call invert_curvature(objective, minimum%parameter, inverse, known)
         if (known) call continue_search(objective, max_final_steps, minimum, n*inverse)
      end if
      if (.not. known) return
      call polish(objective, inverse, minimum)
      call invert_curvature(objective, minimum%parameter, inverse, known)
      if (known) call polish(objective, inverse, minimum)
   end subroutine finish

   !> Newton's steps to where the slope is its own rounding: a model then depends on the series
   !> alone, not on the way of the search, which the order of a sum may change.
   subroutine polish(objective, inverse, minimum)
      type(likelihood_objective), intent(inout) :: objective
      real(dp), intent(in) :: inverse(:, :)
      !> Nearly a minimum; that minimum afterwards
      type(minimum_type), intent(inout) :: minimum
      real(dp), dimension(size(minimum%parameter)) :: move, trial, gradient
      real(dp) :: distance, n, value
      logical :: feasible
      integer :: step

      n = real(objective%measurements, dp)
      move = -n*matmul(inverse, minimum%gradient)
      distance = -n*dot_product(move, minimum%gradient)
      if (distance > newton_range**2) return
      do step = 1, max_newton_steps
         trial = minimum%parameter + move
         call objective%evaluate(trial, value, gradient, feasible)
         if (.not. feasible) exit
         move = -n*matmul(inverse, gradient)
         if (-n*dot_product(move, gradient) >= distance) exit          ! it falls no more
         distance = -n*dot_product(move, gradient)
         minimum%parameter = trial
         minimum%gradient = gradient
         minimum%value = value
      end do
   end subroutine polish

   !> Goes on from a point that is nearly a minimum.
   subroutine continue_search(objective, steps, minimum, inverse)
      type(likelihood_objective), intent(inout) :: objective
      integer, intent(in) :: steps
      type(minimum_type), intent(inout) :: minimum
      !> Inverse of the curvature, where it is known
      real(dp), intent(in), optional :: inverse(:, :)
      type(minimum_type) :: other
      type(error_type), allocatable :: failed
      real(dp) :: tolerance

      tolerance = final_tolerance/real(objective%measurements, dp)
      call minimize(objective, minimum%parameter, minimize_options(gradient_tolerance, steps, &
         tolerance, tolerance), other, failed, inverse)
      if (allocated(failed)) return
      if (other%value <= minimum%value) minimum = other
   end subroutine continue_search

   !> Makes variances 0 that the likelihood does not tell from it. Their logarithms go down for
   !> ever, to a limit that says nothing; at 0 they are at the edge of what there is, and the others
   !> have errors as if they were not in the model.
   subroutine drop_zero_variances(objective, minimum, dropped)
      type(likelihood_objective), intent(inout) :: objective
      !> A minimum; its value and gradient are those without what is dropped
      type(minimum_type), intent(inout) :: minimum
      logical, intent(out) :: dropped
      real(dp) :: most, value
      integer :: k
      logical :: feasible

      most = minimum%value + negligible_gain/real(objective%measurements, dp)
      do k = merge(2, 1, objective%ar), size(minimum%parameter)
         objective%zero(k) = .true.
         if (value_at(objective, minimum%parameter) > most) objective%zero(k) = .false.
      end do
      if (objective%ar) objective%zero(1) = objective%zero(2)
      dropped = any(objective%zero)
      if (.not. dropped) return
      call objective%evaluate(minimum%parameter, value, minimum%gradient, feasible)
      if (feasible) minimum%value = value
   end subroutine drop_zero_variances

end module gyroakf_filter_drift_search
