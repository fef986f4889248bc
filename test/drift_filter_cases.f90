! SPDX-License-Identifier: MIT
!> Models, options and series for the tests of the drift filter.
module drift_filter_cases
   use gyroakf_kinds, only : dp
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_kalman, only : filter_options, filter_type
   use filter_library, only : fill_noise
   use expectations, only : failure => problem, went_wrong
   implicit none (type, external)
   private
   public :: rounding, some_model, adaptive, not_made, make_data

   !> The same numbers in another order of operations
   real(dp), parameter :: rounding = 1.0e-12_dp

contains

   !> So many processes of a model with a walk, an AR(1) process and a faster one.
   pure function some_model(processes) result(model)
      integer, intent(in) :: processes
      type(component_model_type) :: model

      model%count = processes
      model%phi = [0.98_dp, 1.0_dp, 0.5_dp]
      model%q = [0.04_dp, 1.0e-3_dp, 0.3_dp]
      model%r = 2.0_dp
   end function some_model

   !> What adapts in most tests: R, gated.
   pure function adaptive() result(options)
      type(filter_options) :: options

      options%estimate_measurement_variance = .true.
      options%forgetting = 0.99_dp
      options%huber = 2.5_dp
      options%burn_in = 20
   end function adaptive

   !> A filter that must come about.
   logical function not_made(filter, model, slow, options)
      type(filter_type), intent(out) :: filter
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(filter_options), intent(in) :: options

      call new_drift_filter(filter, model, slow, options, failure)
      not_made = went_wrong(failure)
   end function not_made

   !> A series of the model, with a level.
   subroutine make_data(seed, model, z, drift)
      integer, intent(in) :: seed
      type(component_model_type), intent(in) :: model
      real(dp), intent(out), contiguous :: z(:)
      real(dp), intent(out), optional :: drift(:)
      real(dp) :: w(size(z)), state
      integer :: i, k

      call fill_noise(seed, z)
      z = sqrt(model%r)*z
      if (present(drift)) drift = 0
      do i = 1, model%count
         call fill_noise(1000*i + seed, w)
         state = 0
         if (model%phi(i) < 1) state = w(1)*sqrt(model%q(i)/(1 - model%phi(i)**2))
         do k = 1, size(z)
            if (k > 1) state = model%phi(i)*state + sqrt(model%q(i))*w(k)
            z(k) = z(k) + state
            if (present(drift)) drift(k) = drift(k) + state
         end do
      end do
   end subroutine make_data

end module drift_filter_cases
