! SPDX-License-Identifier: MIT
!> R from a window of innovations: against the recursion written out, and against the filter that knows R.
module test_innovation_window
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_innovation_window, only : filter_innovation_window, innovation_window_options
   use adaptive_cases, only : drift_model, make_burst, rmse, run_oracle
   implicit none (type, external)
   private
   public :: collect_innovation_window

contains

   subroutine collect_innovation_window(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("written-out", test_written_out), &
         new_unittest("before-the-window", test_before), &
         new_unittest("walk", test_walk), &
         new_unittest("burst", test_burst), &
         new_unittest("wrong-start", test_wrong_start), &
         new_unittest("spike", test_spike), &
         new_unittest("missing", test_missing), &
         new_unittest("refused", test_refused)]
   end subroutine collect_innovation_window

   !> A scalar filter with the equations as they stand in the source, every sum made anew.
   subroutine literal(model, window, scale, z, x, white)
      type(component_model_type), intent(in) :: model
      integer, intent(in) :: window
      real(dp), intent(in) :: scale, z(:)
      real(dp), intent(out) :: x(:), white(:)
      real(dp) :: e(size(z)), state, p, r, gain
      integer :: k

      state = 0
      r = model%r
      p = model%q(1)/(1 - model%phi(1)**2)
      do k = 1, size(z)
         state = model%phi(1)*state
         p = model%phi(1)**2*p + model%q(1)
         e(k) = z(k) - state
         if (k >= window) r = max(0.01_dp*scale, min(100*scale, sum(e(k - window + 1:k)**2)/window - p))
         gain = p/(p + r)
         state = state + gain*e(k)
         p = (1 - gain)*p
         x(k) = state
         white(k) = r
      end do
   end subroutine literal

   !> The recursion, and the bounds: with the R of the model as their scale the lower one acts.
   subroutine test_written_out(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(3000) :: z, drift, white, x, r, expected, expected_r
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model

      call make_burst(1, z, drift, white)
      model = drift_model()
      call filter_innovation_window(model, [.true.], innovation_window_options(window=20), z, x, gyro, white=r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call literal(model, 20, model%r, z, expected, expected_r)
      call check(error, maxval(abs(x - expected)) < 1.0e-13_dp .and. maxval(abs(r - expected_r)) < 1.0e-14_dp)
      if (allocated(error)) return
      call filter_innovation_window(model, [.true.], innovation_window_options(20, 4*model%r), z, x, gyro, white=r)
      call literal(model, 20, 4*model%r, z, expected, expected_r)
      call check(error, maxval(abs(x - expected)) < 1.0e-13_dp .and. maxval(abs(r - expected_r)) < 1.0e-14_dp)
      if (allocated(error)) return
      ! innovations of less than the bound allows: it holds
      call filter_innovation_window(model, [.true.], innovation_window_options(20, 1.0_dp), z, x, gyro, white=r)
      call check(error, all(abs(r(20:) - 0.01_dp) < 1.0e-15_dp))
   end subroutine test_written_out

   !> Until the window is full the filter is that of the model.
   subroutine test_before(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(300) :: z, drift, white, x, expected
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model

      call make_burst(2, z, drift, white)
      model = drift_model()
      call filter_innovation_window(model, [.true.], innovation_window_options(window=301), z, x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call run_oracle(model, spread(model%r, 1, 300), z, expected)
      call check(error, maxval(abs(x - expected)) <= 0)
   end subroutine test_before

   !> A random walk: its first measurement has no innovation; a fast process beside it is no drift.
   subroutine test_walk(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(2000) :: z, drift, white, x, both
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model

      call make_burst(3, z, drift, white)
      model%count = 2
      model%phi(:2) = [1.0_dp, 0.3_dp]
      model%q(:2) = [4.0e-6_dp, 1.0e-5_dp]
      model%r = 4.2e-4_dp
      z = z + 1000
      call filter_innovation_window(model, [.true., .false.], innovation_window_options(), z, x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, abs(x(1) - z(1)) < 1.0e-9_dp)
      if (allocated(error)) return
      call filter_innovation_window(model, [.true., .true.], innovation_window_options(), z, both, gyro)
      call check(error, maxval(abs(x(2:) - both(2:))) > 1.0e-4_dp)
      if (allocated(error)) return
      call check(error, rmse(x(500:), drift(500:) + 1000) < 0.01_dp)
   end subroutine test_walk

   !> White noise of nine times the variance in the middle third: near the filter that knows it, nearer than the one that does not.
   subroutine test_burst(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(12000) :: z, drift, white, x, fixed, known
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model

      call make_burst(4, z, drift, white)
      model = drift_model()
      call filter_innovation_window(model, [.true.], innovation_window_options(), z, x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call run_oracle(model, white, z, known)
      call run_oracle(model, spread(model%r, 1, 12000), z, fixed)
      call check(error, rmse(x, drift) < 1.04_dp*rmse(known, drift))
      if (allocated(error)) return
      call check(error, rmse(fixed, drift) > 1.1_dp*rmse(x, drift))
   end subroutine test_burst

   !> An R at the start that is wrong by a thousand, with bounds that follow the series: forgotten once the window is full.
   subroutine test_wrong_start(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(6000) :: z, drift, white, x, right
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model
      type(innovation_window_options) :: options
      integer :: i

      call make_burst(5, z, drift, white)
      options%r_scale = 0.5_dp*sum((z(2:2000) - z(:1999))**2)/1999
      call filter_innovation_window(drift_model(), [.true.], options, z, right, gyro)
      do i = -3, 3, 6
         model = drift_model()
         model%r = model%r*10.0_dp**i
         call filter_innovation_window(model, [.true.], options, z, x, gyro)
         call check(error, .not. allocated(gyro))
         if (allocated(error)) return
         call check(error, maxval(abs(x(1500:) - right(1500:))) < 1.0e-9_dp)
         if (allocated(error)) return
      end do
   end subroutine test_wrong_start

   !> A sample of 1e8 leaves nothing behind once it has left the window: its square is not subtracted from the sum.
   subroutine test_spike(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(4000) :: z, drift, white, x, r, without_r
      type(gyro_error), allocatable :: gyro

      call make_burst(6, z, drift, white)
      call filter_innovation_window(drift_model(), [.true.], innovation_window_options(), z, x, gyro, white=without_r)
      z(1000) = 1.0e8_dp
      call filter_innovation_window(drift_model(), [.true.], innovation_window_options(), z, x, gyro, white=r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, all(abs(r(2600:) - without_r(2600:)) < 1.0e-9_dp*without_r(2600:)))
   end subroutine test_spike

   !> Missing samples are predicted and adapt nothing, by the mask and by NaN.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(1000) :: z, drift, white, x, y, r
      integer(int8) :: valid(1000)
      type(gyro_error), allocatable :: gyro
      integer :: k

      call make_burst(7, z, drift, white)
      valid = 1_int8
      valid(400:450) = 0_int8
      y = z
      y(400:450) = ieee_value(0.0_dp, ieee_quiet_nan)
      z(400:450) = 1.0e6_dp
      call filter_innovation_window(drift_model(), [.true.], innovation_window_options(), z, x, gyro, valid, r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      do k = 400, 450
         call check(error, abs(x(k) - 0.978_dp*x(k - 1)) < 1.0e-15_dp .and. abs(r(k) - r(399)) <= 0)
         if (allocated(error)) return
      end do
      call filter_innovation_window(drift_model(), [.true.], innovation_window_options(), y, z, gyro)
      call check(error, maxval(abs(z - x)) <= 0)
   end subroutine test_missing

   !> What is no filter.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: z(50), x(50)
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model, none

      z = 1
      model = drift_model()
      call filter_innovation_window(none, [.true.], innovation_window_options(), z, x, gyro)
      call expect()
      if (.not. allocated(error)) call filter_innovation_window(model, [.true., .true.], innovation_window_options(), z, x, gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_innovation_window(model, [.true.], innovation_window_options(), z, x(:49), gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_innovation_window(model, [.true.], innovation_window_options(1), z, x, gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_innovation_window(model, [.true.], innovation_window_options(9, -1.0_dp), z, x, gyro)
      if (.not. allocated(error)) call expect()
      model%r = 0
      if (.not. allocated(error)) call filter_innovation_window(model, [.true.], innovation_window_options(), z, x, gyro)
      if (.not. allocated(error)) call expect()

   contains

      subroutine expect()
         call check_refused(error, gyro, status%invalid_argument)
      end subroutine expect
   end subroutine test_refused

end module test_innovation_window
