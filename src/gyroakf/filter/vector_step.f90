! SPDX-License-Identifier: MIT
!> One step of the filter of an AR(p) state of any order, its arrays apart from its numbers: the
!> arrays are those of a filter, or of a caller who keeps them. Allocates nothing.
module gyroakf_filter_vector_step
   use gyroakf_kinds, only : dp
   use gyroakf_filter_filter_types, only : filter_type
   use gyroakf_filter_state_space, only : predict_covariance, correct_covariance
   use gyroakf_filter_sage_husa, only : adapt_noise, gate_inflation, watch_level
   use gyroakf_filter_components, only : settle_distance
   implicit none (type, external)
   private
   public :: step_vector

contains

   !> Prediction, and the correction by the measurement if there is one.
   pure subroutine step_vector(filter, n, phi, steady_gain, x, gain, work, p, z, here)
      !> Its numbers; its arrays are not looked at, and may be those that follow
      type(filter_type), intent(inout), target :: filter
      !> Order
      integer, intent(in) :: n
      !> Coefficients, gain that it settles to: [n]
      real(dp), intent(in) :: phi(n), steady_gain(n)
      !> State, gain, work array: [n]; covariance: [n, n]
      real(dp), intent(inout) :: x(n), gain(n), work(n), p(n, n)
      !> Measurement
      real(dp), intent(in) :: z
      !> Whether there is one
      logical, intent(in) :: here
      real(dp) :: first, prior, inflation, s
      integer :: i

      filter%steps = filter%steps + 1
      first = dot_product(phi, x) + filter%q_mean
      do i = n, 2, -1
         x(i) = x(i - 1)
      end do
      x(1) = first
      if (.not. (here .and. filter%settled)) call predict_covariance(phi, filter%q, p, work)
      if (.not. here) then
         filter%settled = .false.
         return
      end if
      filter%innovation = z - first - filter%r_mean
      if (.not. filter%settled) then
         prior = p(1, 1)
         filter%innovation_variance = prior + filter%r
         inflation = gate_inflation(filter%options%huber, filter%innovation, &
            & filter%innovation_variance)
         call correct_covariance(filter%r*inflation, p, gain, s)
         call watch_level(filter, inflation, p(1, 1))
         if (filter%adaptive .and. .not. filter%frozen) then
            call adapt_noise(filter, filter%innovation, filter%innovation_variance, prior)
         end if
         if (.not. filter%varying) filter%settled = &
            & maxval(abs(gain - steady_gain)) <= settle_distance(maxval(abs(steady_gain)))
      end if
      x = x + gain*filter%innovation
      filter%measurements = filter%measurements + 1
   end subroutine step_vector
end module gyroakf_filter_vector_step
