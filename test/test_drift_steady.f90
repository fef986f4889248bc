! SPDX-License-Identifier: MIT
!> The steady gains of a drift filter: those that its recursion comes to, and none where there is next to no white noise.
module test_drift_steady
   use expectations, only : failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp
   use gyroakf_filter_components, only : component_model_type, component_state_type, most_components, start_components, &
      predict_components, correct_components
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_drift_steady, only : steady_drift_gain
   use gyroakf_filter_kalman, only : filter_options, filter_type, run_filter
   use filter_library, only : make_series
   implicit none (type, external)
   private
   public :: suite_drift_steady

contains

   subroutine suite_drift_steady()
      call test("recursion", test_recursion)
      call test("no white noise", test_no_white_noise)
   end subroutine suite_drift_steady

   !> An AR(1) process and a random walk.
   pure type(component_model_type) function pair(phi, q1, q2, r) result(model)
      real(dp), intent(in) :: phi, q1, q2, r

      model%count = 2
      model%phi(:2) = [phi, 1.0_dp]
      model%q(:2) = [q1, q2]
      model%r = r
   end function pair

   !> 20000 steps of the filter itself: the slowest mode has 300 samples.
   subroutine test_recursion()
      type(component_model_type) :: model
      type(component_state_type) :: state
      real(dp) :: gain(most_components)
      integer :: k

      model = pair(0.95_dp, 1.2e-6_dp, 2.5e-8_dp, 4.2e-4_dp)
      call steady_drift_gain(model, gain, failed)
      if (went_wrong(failed)) return
      call start_components(model, state)
      do k = 1, 20000
         if (state%started) call predict_components(model, state)
         call correct_components(2, model%r, 0.0_dp, state)
      end do
      call check(error, maxval(abs(gain - state%gain)) <= 1.0e-12_dp*maxval(gain))
   end subroutine test_recursion

   !> The likelihood of the paper's own record may leave white noise of e^-60 beside an AR(1) and a walk: the filter is that
   !> without it.
   subroutine test_no_white_noise()
      type(filter_type) :: filter
      type(filter_options) :: options
      real(dp) :: z(2000), x(2000, 2)
      integer :: i

      call make_series(4, 0.41_dp, 5.2e-4_dp, 0.0_dp, z)
      do i = 1, 2
         call new_drift_filter(filter, pair(0.406_dp, 4.32e-4_dp, 3.84e-9_dp, merge(4.58e-30_dp, 0.0_dp, i == 1)), &
                               [.false., .true.], options, failed)
         if (went_wrong(failed)) return
         call run_filter(filter, z, x(:, i))
      end do
      call check(error, maxval(abs(x(:, 1) - x(:, 2))) <= 1.0e-9_dp*sqrt(5.2e-4_dp))
      options%estimate_measurement_variance = .true.
      options%burn_in = -1
      options%r_scale = 3.0e-4_dp
      call new_drift_filter(filter, pair(0.406_dp, 4.32e-4_dp, 3.84e-9_dp, 4.58e-30_dp), [.false., .true.], options, failed)
      call check(error, .not. allocated(failed))
   end subroutine test_no_white_noise

end module test_drift_steady
