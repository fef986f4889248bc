! SPDX-License-Identifier: MIT
!> Series whose white noise changes, and the filter that knows how: for the tests of adaptive filters.
module adaptive_cases
   use gyroakf_kinds, only : dp, int8
   use gyroakf_filter_components, only : component_model_type, component_state_type, correct_components, predict_components, &
      start_components
   use filter_library, only : fill_noise
   implicit none (type, external)
   private
   public :: drift_model, make_burst, run_oracle, rmse

   !> A drift of 9 s in white noise, at 5 Hz: phi, variance of the drift, of the noise (deg/s)^2
   real(dp), parameter :: phi = 0.978_dp, drift_variance = 1.0e-4_dp, white_variance = 4.2e-4_dp

contains

   !> The model of the series.
   pure type(component_model_type) function drift_model()
      drift_model%count = 1
      drift_model%phi(1) = phi
      drift_model%q(1) = drift_variance*(1 - phi**2)
      drift_model%r = white_variance
   end function drift_model

   !> A series whose white noise has nine times the variance in its middle third, its drift, and that variance.
   subroutine make_burst(seed, z, drift, white)
      integer, intent(in) :: seed
      real(dp), intent(out), contiguous :: z(:), drift(:), white(:)
      real(dp), allocatable :: w(:)
      integer :: k, n

      n = size(z)
      allocate (w(n))
      call fill_noise(seed, w)
      call fill_noise(seed + 100000, z)
      white = white_variance
      white(n/3 + 1:2*(n/3)) = 9*white_variance
      drift(1) = sqrt(drift_variance)*w(1)
      do k = 2, n
         drift(k) = phi*drift(k - 1) + sqrt(drift_variance*(1 - phi**2))*w(k)
      end do
      z = drift + sqrt(white)*z
   end subroutine make_burst

   !> The filter that is told the variance of each sample's white noise.
   subroutine run_oracle(model, white, z, x, valid)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in) :: white(:), z(:)
      real(dp), intent(out) :: x(:)
      integer(int8), intent(in), optional :: valid(:)
      type(component_state_type) :: state
      integer :: k
      logical :: here

      call start_components(model, state)
      do k = 1, size(z)
         call predict_components(model, state)
         here = .true.
         if (present(valid)) here = valid(k) == 1_int8
         if (here) call correct_components(model%count, white(k), z(k), state)
         x(k) = sum(state%x(:model%count))
      end do
   end subroutine run_oracle

   !> Root mean square of the difference.
   pure real(dp) function rmse(x, truth)
      real(dp), intent(in) :: x(:), truth(:)

      rmse = norm2(x - truth)/sqrt(real(size(x), dp))
   end function rmse

end module adaptive_cases
