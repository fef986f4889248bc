! SPDX-License-Identifier: MIT
!> The score of an estimate: errors that are known in closed form.
module test_score
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_score, only : score_estimate, score_times, score_type
   use filter_library, only : fill_noise
   implicit none (type, external)
   private
   public :: collect_score

   !> Rounding of a sum of some thousand terms
   real(dp), parameter :: rounding = 1.0e-12_dp

contains

   subroutine collect_score(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("constant-error", test_constant), &
         new_unittest("alternating-error", test_alternating), &
         new_unittest("prediction", test_prediction), &
         new_unittest("ramp", test_ramp), &
         new_unittest("white-error", test_white), &
         new_unittest("missing", test_missing), &
         new_unittest("windows", test_windows), &
         new_unittest("refused", test_refused)]
   end subroutine collect_score

   !> A constant error is the bias, the RMSE and, times T, the error of the angle.
   subroutine test_constant(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: truth(1600), estimate(1600)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      call fill_noise(1, truth)
      estimate = truth - 0.25_dp
      call score_estimate(estimate, truth, 0.2_dp, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, score%samples, 1600_int64)
      if (allocated(error)) return
      call check(error, score%bias, -0.25_dp, thr=rounding)
      if (allocated(error)) return
      call check(error, score%rmse, 0.25_dp, thr=rounding)
      if (allocated(error)) return
      call check(error, maxval(abs(score%attitude_error - 0.25_dp*score_times)) < 300*rounding)
      if (allocated(error)) return
      call check(error, all(score%attitude_windows == [32_int64, 5_int64, 1_int64]))
      if (allocated(error)) return
      call check(error, all(score%predicted_windows == [31_int64, 4_int64, 0_int64]))
   end subroutine test_constant

   !> An error of changing sign has an RMSE but turns nothing: windows of an even number of samples.
   subroutine test_alternating(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: truth(3200), estimate(3200)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      truth = 0
      estimate(1::2) = 3.0_dp
      estimate(2::2) = -3.0_dp
      call score_estimate(estimate, truth, 0.5_dp, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, score%rmse, 3.0_dp, thr=rounding)
      if (allocated(error)) return
      call check(error, abs(score%bias) < rounding .and. all(score%attitude_error < rounding))
      if (allocated(error)) return
      ! the last estimate of each window is -3: held, it turns 3 T
      call check(error, maxval(abs(score%predicted_error - 3*score_times)) < 900*rounding)
   end subroutine test_alternating

   !> A drift that decays as the model says is predicted without error; held, it errs by the closed form.
   subroutine test_prediction(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: phi = 0.999_dp
      real(dp) :: truth(40), held
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro
      integer :: k, w

      truth = [(phi**k, k=1, 40)]
      call score_estimate(truth, truth, 1.0_dp, score, gyro, decay=phi)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, score%predicted_windows(1), 3_int64)
      if (allocated(error)) return
      call check(error, score%predicted_error(1) < rounding)
      if (allocated(error)) return
      call score_estimate(truth, truth, 1.0_dp, score, gyro)
      held = 0
      do w = 1, 3
         held = held + (phi**(10*w)*(10 - phi*(1 - phi**10)/(1 - phi)))**2
      end do
      call check(error, score%predicted_error(1), sqrt(held/3), thr=rounding)
      if (allocated(error)) return
      call check(error, score%rmse < tiny(held) .and. score%attitude_error(1) < tiny(held))
   end subroutine test_prediction

   !> A ramp of r a second, known up to the window's beginning, turns r t0^2 m (m + 1)/2.
   subroutine test_ramp(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: t0 = 0.1_dp, r = 0.02_dp
      real(dp) :: truth(7000), m(3)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro
      integer :: k

      truth = [(r*t0*k, k=1, 7000)]
      call score_estimate(truth, truth, t0, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      m = score_times/t0
      call check(error, maxval(abs(score%predicted_error/(0.5_dp*r*t0**2*m*(m + 1)) - 1)) < rounding)
   end subroutine test_ramp

   !> White error of standard deviation s: the angle errs by s t0 sqrt(m); 320 windows, five standard errors.
   subroutine test_white(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: s = 0.02_dp
      real(dp), allocatable :: truth(:), estimate(:)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      allocate (truth(16000), estimate(16000))
      call fill_noise(7, estimate)
      truth = 1.0_dp
      estimate = truth + s*estimate
      call score_estimate(estimate, truth, 0.2_dp, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, score%rmse, s, thr=5*s/sqrt(32000.0_dp))
      if (allocated(error)) return
      call check(error, score%attitude_windows(1), 320_int64)
      if (allocated(error)) return
      call check(error, score%attitude_error(1), s*0.2_dp*sqrt(50.0_dp), thr=5*s*0.2_dp*sqrt(50.0_dp)/sqrt(640.0_dp))
   end subroutine test_white

   !> Missing by the mask and by NaN: what is there is scored, a window with less than nine tenths does not count.
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: truth(200), estimate(200)
      integer(int8) :: valid(200)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      truth = 1.0_dp
      estimate = 1.5_dp
      valid = 1_int8
      valid(55) = 0_int8
      estimate(55) = 1.0e100_dp                          ! 9 of 10 are left in the second window
      truth(101) = ieee_value(0.0_dp, ieee_quiet_nan)
      estimate(104) = ieee_value(0.0_dp, ieee_quiet_nan)
      valid(106:110) = 0_int8                            ! 43 of 50 in the third
      call score_estimate(estimate, truth, 0.2_dp, score, gyro, valid)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, score%samples, 192_int64)
      if (allocated(error)) return
      call check(error, score%rmse, 0.5_dp, thr=rounding)
      if (allocated(error)) return
      call check(error, score%attitude_windows(1), 3_int64)
      if (allocated(error)) return
      call check(error, score%attitude_error(1), 5.0_dp, thr=10*rounding)
      if (allocated(error)) return
      call check(error, score%predicted_windows(1), 2_int64)
      if (allocated(error)) return
      call check(error, score%predicted_error(1), 5.0_dp, thr=10*rounding)
   end subroutine test_missing

   !> Where a time is no window it has no error; an interval longer than it has none either.
   subroutine test_windows(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: truth(49), estimate(49)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      truth = 0
      estimate = 1
      call score_estimate(estimate, truth, 0.2_dp, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, all(score%attitude_windows == 0) .and. all(score%predicted_windows == 0))
      if (allocated(error)) return
      call score_estimate(estimate, truth, 100.0_dp, score, gyro)
      call check(error, all(score%attitude_windows == [0_int64, 49_int64, 16_int64]))
      if (allocated(error)) return
      call score_estimate(estimate, truth, tiny(1.0_dp)/4, score, gyro)
      call check(error, .not. allocated(gyro))
      if (allocated(error)) return
      call check(error, all(score%attitude_windows == 0))
   end subroutine test_windows

   !> What cannot be scored.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(20), y(20), nan
      integer(int8) :: valid(20)
      type(score_type) :: score
      type(gyro_error), allocatable :: gyro

      nan = ieee_value(0.0_dp, ieee_quiet_nan)
      x = 0
      y = 0
      valid = 0_int8
      call score_estimate(x(:19), y, 1.0_dp, score, gyro)
      call expect(status%invalid_argument)
      if (.not. allocated(error)) call score_estimate(x, y, 1.0_dp, score, gyro, valid(:19))
      if (.not. allocated(error)) call expect(status%invalid_argument)
      if (.not. allocated(error)) call score_estimate(x, y, 0.0_dp, score, gyro)
      if (.not. allocated(error)) call expect(status%invalid_argument)
      if (.not. allocated(error)) call score_estimate(x, y, nan, score, gyro)
      if (.not. allocated(error)) call expect(status%invalid_argument)
      if (.not. allocated(error)) call score_estimate(x, y, 1.0_dp, score, gyro, decay=1.01_dp)
      if (.not. allocated(error)) call expect(status%invalid_argument)
      if (.not. allocated(error)) call score_estimate(x, y, 1.0_dp, score, gyro, valid)
      if (.not. allocated(error)) call expect(status%too_few_samples)

   contains

      subroutine expect(code)
         integer, intent(in) :: code

         call check_refused(error, gyro, code)
      end subroutine expect
   end subroutine test_refused

end module test_score
