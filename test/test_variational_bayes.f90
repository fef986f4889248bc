! SPDX-License-Identifier: MIT
!> R by variational Bayes: against the recursion written out, and against the filter that knows R.
module test_variational_bayes
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_variational_bayes, only : filter_variational_bayes, variational_options
   use adaptive_cases, only : drift_model, make_burst, rmse, run_oracle
   implicit none (type, external)
   private
   public :: collect_variational_bayes

contains

   subroutine collect_variational_bayes(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("written-out", test_written_out), &
         new_unittest("walk", test_walk), &
         new_unittest("burst", test_burst), &
         new_unittest("wrong-start", test_wrong_start), &
         new_unittest("no-noise", test_no_noise), &
         new_unittest("missing", test_missing), &
         new_unittest("refused", test_refused)]
   end subroutine collect_variational_bayes

   !> A scalar filter with the equations as they stand in the source.
   subroutine literal(model, rho, times, prior, z, x, white)
      type(component_model_type), intent(in) :: model
      real(dp), intent(in) :: rho, prior, z(:)
      integer, intent(in) :: times
      real(dp), intent(out) :: x(:), white(:)
      real(dp) :: m, p, m_minus, p_minus, alpha, beta, beta_minus, gain
      integer :: k, i

      m = 0
      p = model%q(1)/(1 - model%phi(1)**2)
      alpha = prior/2
      beta = alpha*model%r
      do k = 1, size(z)
         m_minus = model%phi(1)*m
         p_minus = model%phi(1)**2*p + model%q(1)
         alpha = rho*alpha + 0.5_dp
         beta_minus = rho*beta
         beta = beta_minus
         do i = 1, times
            gain = p_minus/(p_minus + beta/alpha)
            m = m_minus + gain*(z(k) - m_minus)
            p = p_minus - gain*p_minus
            beta = beta_minus + (z(k) - m)**2/2 + p/2
         end do
         x(k) = m
         white(k) = beta/alpha
      end do
   end subroutine literal

   !> The recursion, for the defaults and for others.
   subroutine test_written_out(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(3000) :: z, drift, white, x, r, expected, expected_r
      type(gyro_error), allocatable :: gyro

      call make_burst(1, z, drift, white)
      call filter_variational_bayes(drift_model(), [.true.], variational_options(), z, x, gyro, white=r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call literal(drift_model(), 0.98_dp, 5, 1/(1 - 0.98_dp), z, expected, expected_r)
      call check(error, maxval(abs(x - expected)) < 1.0e-13_dp .and. maxval(abs(r/expected_r - 1)) < 1.0e-11_dp)
      if (allocated(error)) return
      call filter_variational_bayes(drift_model(), [.true.], variational_options(0.9_dp, 2, 3.0_dp), z, x, gyro, white=r)
      call literal(drift_model(), 0.9_dp, 2, 3.0_dp, z, expected, expected_r)
      call check(error, maxval(abs(x - expected)) < 1.0e-13_dp .and. maxval(abs(r/expected_r - 1)) < 1.0e-11_dp)
   end subroutine test_written_out

   !> A random walk begins with its first measurement; a fast process beside it is no drift.
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
      call filter_variational_bayes(model, [.true., .false.], variational_options(), z, x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, abs(x(1) - z(1)) < 1.0e-9_dp)
      if (allocated(error)) return
      call filter_variational_bayes(model, [.true., .true.], variational_options(), z, both, gyro)
      call check(error, maxval(abs(x(2:) - both(2:))) > 1.0e-4_dp)
      if (allocated(error)) return
      call check(error, rmse(x(500:), drift(500:) + 1000) < 0.01_dp)
   end subroutine test_walk

   !> White noise of nine times the variance in the middle third: near the filter that knows it, nearer than the one that does not.
   subroutine test_burst(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(12000) :: z, drift, white, x, fixed, known
      type(gyro_error), allocatable :: gyro

      call make_burst(4, z, drift, white)
      call filter_variational_bayes(drift_model(), [.true.], variational_options(), z, x, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call run_oracle(drift_model(), white, z, known)
      call run_oracle(drift_model(), spread(4.2e-4_dp, 1, 12000), z, fixed)
      call check(error, rmse(x, drift) < 1.04_dp*rmse(known, drift))
      if (allocated(error)) return
      call check(error, rmse(fixed, drift) > 1.1_dp*rmse(x, drift))
   end subroutine test_burst

   !> An R at the start that is wrong by a thousand is forgotten.
   subroutine test_wrong_start(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), dimension(6000) :: z, drift, white, x, right
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model
      integer :: i

      call make_burst(5, z, drift, white)
      call filter_variational_bayes(drift_model(), [.true.], variational_options(), z, right, gyro)
      do i = -3, 3, 6
         model = drift_model()
         model%r = model%r*10.0_dp**i
         call filter_variational_bayes(model, [.true.], variational_options(), z, x, gyro)
         call check(error, .not. allocated(gyro))
         if (allocated(error)) return
         call check(error, rmse(x(3000:), drift(3000:)) < 1.001_dp*rmse(right(3000:), drift(3000:)))
         if (allocated(error)) return
      end do
   end subroutine test_wrong_start

   !> A series of zeros drives R towards 0 and never to it.
   subroutine test_no_noise(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: z(:), x(:), r(:)
      type(gyro_error), allocatable :: gyro
      type(component_model_type) :: model

      allocate (z(60000), x(60000), r(60000))
      z = 0
      model = drift_model()
      model%q = 0
      call filter_variational_bayes(model, [.true.], variational_options(), z, x, gyro, white=r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, all(r > 0) .and. r(60000) < 1.0e-100_dp .and. all(abs(x) <= 0))
   end subroutine test_no_noise

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
      call filter_variational_bayes(drift_model(), [.true.], variational_options(), z, x, gyro, valid, r)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      do k = 400, 450
         call check(error, abs(x(k) - 0.978_dp*x(k - 1)) < 1.0e-15_dp .and. abs(r(k) - r(399)) <= 0)
         if (allocated(error)) return
      end do
      call filter_variational_bayes(drift_model(), [.true.], variational_options(), y, z, gyro)
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
      call filter_variational_bayes(none, [.true.], variational_options(), z, x, gyro)
      call expect()
      if (.not. allocated(error)) call filter_variational_bayes(model, [.true., .true.], variational_options(), z, x, gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_variational_bayes(model, [.true.], variational_options(), z, x(:49), gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_variational_bayes(model, [.true.], variational_options(1.0_dp), z, x, gyro)
      if (.not. allocated(error)) call expect()
      if (.not. allocated(error)) call filter_variational_bayes(model, [.true.], variational_options(0.9_dp, 0), z, x, gyro)
      if (.not. allocated(error)) call expect()
      model%r = 0
      if (.not. allocated(error)) call filter_variational_bayes(model, [.true.], variational_options(), z, x, gyro)
      if (.not. allocated(error)) call expect()

   contains

      subroutine expect()
         call check_refused(error, gyro, status%invalid_argument)
      end subroutine expect
   end subroutine test_refused

end module test_variational_bayes
