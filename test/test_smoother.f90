! SPDX-License-Identifier: MIT
!> The smoother of drift models against dense conditional means.
module test_smoother
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use expectations, only : failed => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_smoother, only : smooth_drift
   use filter_library, only : dense_drift, fill_noise, make_series
   implicit none (type, external)
   private
   public :: suite_smoother

   !> Rounding of a dense solution of 50 equations
   real(dp), parameter :: dense = 1.0e-10_dp

contains

   subroutine suite_smoother()
      call test("dense", test_dense)
      call test("blocks", test_blocks)
      call test("honest-variance", test_honest_variance)
      call test("offset", test_offset)
      call test("refused", test_refused)
   end subroutine suite_smoother

   !> Two AR(1) processes, a random walk, white noise: the first so many of them.
   pure type(component_model_type) function model_of(phi, q, r)
      real(dp), intent(in) :: phi(:), q(:), r

      model_of%count = size(phi)
      model_of%phi(:size(phi)) = phi
      model_of%q(:size(phi)) = q
      model_of%r = r
   end function model_of

   !> Compares the smoother with the matrices.
   subroutine compare(model, slow, here, white)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:), here(:)
      real(dp), intent(in), optional :: white(:)
      real(dp), dimension(50) :: z, drift, variance, expected, spread_expected, r
      integer(int8) :: valid(50)

      call fill_noise(21, z)
      z = z + 5.0_dp
      r = model%r
      valid = int(merge(1, 0, here), int8)
      if (present(white)) then
         r = white
         call smooth_drift(model, slow, z, drift, failed, valid, variance, white)
      else
         call smooth_drift(model, slow, z, drift, failed, valid, variance)
      end if
      if (went_wrong(failed)) return
      call dense_drift(model, slow, z, here, r, expected, spread_expected)
      call check(error, maxval(abs(drift - expected)) <= dense)
      call check(error, maxval(abs(variance - spread_expected)) <= dense)
   end subroutine compare

   !> Processes of every kind, samples missing, also before the first measurement, white noise whose
   !> variance changes.
   subroutine test_dense()
      type(component_model_type) :: both
      logical :: here(50)
      integer :: i

      here = .true.
      both = model_of([0.7_dp, 1.0_dp], [0.5_dp, 0.02_dp], 0.6_dp)
      call compare(model_of([0.9_dp], [0.4_dp], 1.5_dp), [.true.], here)
      call compare(model_of([0.5_dp, 0.95_dp], [0.4_dp, 0.02_dp], 0.7_dp), [.false., .true.], here)
      call compare(model_of([1.0_dp], [0.1_dp], 1.0_dp), [.true.], here)
      call compare(both, [.false., .true.], here)
      call compare(both, [.true., .true.], here)
      call compare(model_of([0.9_dp, 1.0_dp], [0.1_dp, 0.02_dp], 0.6_dp), [.true., .true.], here, &
                   [(merge(9.0_dp, 0.5_dp, i > 20 .and. i < 35), i=1, 50)])
      here([2, 3, 17, 30, 31, 32, 50]) = .false.
      call compare(both, [.true., .true.], here)
      here = .true.
      here(:7) = .false.
      call compare(both, [.true., .true.], here)
      call compare(model_of([0.7_dp, 0.9_dp], [0.5_dp, 0.02_dp], 0.6_dp), [.false., .true.], here)
   end subroutine test_dense

   !> More samples than a block: those far from both ends do not feel where a series is cut.
   subroutine test_blocks()
      type(component_model_type) :: model
      real(dp) :: z(5000), drift(5000), part(3000), variance(5000), other(3000)

      model = model_of([0.6_dp, 0.9_dp], [0.2_dp, 0.05_dp], 1.0_dp)
      call fill_noise(22, z)
      call smooth_drift(model, [.false., .true.], z, drift, failed, variance=variance)
      if (went_wrong(failed)) return
      call smooth_drift(model, [.false., .true.], z(1001:4000), part, failed, variance=other)
      call check(error, maxval(abs(drift(1501:3500) - part(501:2500))) <= 1.0e-12_dp)
      call check(error, maxval(abs(variance(1501:3500) - other(501:2500))) <= 1.0e-12_dp)
   end subroutine test_blocks

   !> The errors have the stated variance: 20000 of them, correlated over some 20 samples, within five standard deviations.
   subroutine test_honest_variance()
      real(dp), dimension(20000) :: z, truth, drift, variance

      call make_series(23, 0.95_dp, 1.0_dp, 4.0_dp, z, truth)
      call smooth_drift(model_of([0.95_dp], [0.0975_dp], 4.0_dp), [.true.], z, drift, failed, variance=variance)
      if (went_wrong(failed)) return
      call check(error, sum((drift - truth)**2/variance)/20000, 1.0_dp, thr=5*sqrt(2.0_dp*20/20000))
   end subroutine test_honest_variance

   !> A random walk takes an offset as it is.
   subroutine test_offset()
      real(dp), dimension(2000) :: z, drift, moved

      call fill_noise(24, z)
      call smooth_drift(model_of([1.0_dp], [0.01_dp], 1.0_dp), [.true.], z, drift, failed)
      call smooth_drift(model_of([1.0_dp], [0.01_dp], 1.0_dp), [.true.], z + 1024.0_dp, moved, failed)
      call check(error, maxval(abs(moved - 1024.0_dp - drift)) <= 1.0e-10_dp)
   end subroutine test_offset

   subroutine test_refused()
      real(dp) :: z(10), drift(10)

      call fill_noise(25, z)
      call smooth_drift(model_of([0.9_dp], [0.1_dp], 1.0_dp), [.true.], z, drift(:9), failed)
      call check_refused(failed, status%invalid_argument)
      call smooth_drift(model_of([1.1_dp], [0.1_dp], 1.0_dp), [.true.], z, drift, failed)
      call check_refused(failed, status%unstable)
      z = ieee_value(1.0_dp, ieee_quiet_nan)
      call smooth_drift(model_of([0.9_dp], [0.1_dp], 1.0_dp), [.true.], z, drift, failed)
      call check_refused(failed, status%too_few_samples)
   end subroutine test_refused

end module test_smoother
