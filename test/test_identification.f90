! SPDX-License-Identifier: MIT
!> Tests of the identification of drift plus white noise.
module test_identification
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_filter_identification, only : drift_model_type, identify_drift
   use gyroakf_filter_exponential_fit, only : exponential_type, fit_exponential
   use filter_library, only : fill_noise, make_series, paper_phi
   use expectations, only : check
   use testdrive, only : error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_identification

contains

   !> The tests of this suite.
   subroutine collect_identification(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("exact_autocovariances", test_exact), &
         & new_unittest("drift_and_white_noise", test_truth), &
         & new_unittest("missing_samples", test_missing), &
         & new_unittest("slow_drift_in_block_means", test_slow), &
         & new_unittest("random_walk_with_steps", test_random_walk), &
         & new_unittest("pure_ar_has_no_white_noise", test_pure_ar), &
         & new_unittest("white_noise_has_no_drift", test_white), &
         & new_unittest("limit_of_the_drift", test_limit), &
         & new_unittest("offset_and_scale", test_offset_scale), &
         & new_unittest("refused", test_refused)]
   end subroutine collect_identification

   !> D psi^k itself, with the removed mean's share, gives D and psi back
   subroutine test_exact(error)
      type(error_type), allocatable, intent(out) :: error
      type(exponential_type) :: fit
      real(dp), parameter :: d = 3.0_dp, psi = 0.9_dp, n = 1.0e5_dp
      real(dp) :: r(0:60)
      integer :: k

      r(0) = 10
      do k = 1, 60
         r(k) = d*((1 - k/n)*psi**k - (1 + psi)/((1 - psi)*n))
      end do
      call fit_exponential(r, n, fit)
      call check(error, fit%amplitude, d, thr=1.0e-6_dp, rel=.true.)
      call check(error, fit%ratio, psi, thr=1.0e-7_dp, rel=.true.)
   end subroutine test_exact

   !> Correlation time 49.5 samples, D = 1e-4, R = 4.2e-4: the mean of eight records of 12,000 samples, whose scatter is
   !> 7, 1e-5 and 5e-6 a record, within three standard errors
   subroutine test_truth(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(12000), mean(3)
      integer :: seed

      mean = 0
      do seed = 1, 8
         call make_series(30 + seed, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z)
         call identify_drift(z, model, failure)
         call check(error, model%found, "the drift is not found")
         mean = mean + [model%correlation_samples, model%drift_variance, model%measurement_variance]/8
      end do
      call check(error, mean(1), 49.5_dp, thr=8.0_dp)
      call check(error, mean(2), 1.0e-4_dp, thr=1.1e-5_dp)
      call check(error, mean(3), 4.2e-4_dp, thr=6.0e-6_dp)
      call check(error, model%process_variance, model%drift_variance*(1 - model%phi**2), thr=1.0e-12_dp, rel=.true.)
   end subroutine test_truth

   !> A third of the samples lost at random, and a gap of 2000: the truth within the larger scatter
   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(30000), lost(30000)
      integer(int8) :: valid(30000)

      call make_series(39, 0.95_dp, 1.0_dp, 2.0_dp, z)
      call fill_noise(40, lost)
      valid = merge(0_int8, 1_int8, lost > 0.43_dp)
      valid(20001:22000) = 0_int8
      where (valid == 0_int8) z = 1.0e6_dp
      call identify_drift(z, model, failure, valid)
      call check(error, model%found, "the drift is not found")
      call check(error, model%correlation_samples, 19.5_dp, thr=4.0_dp)
      call check(error, model%measurement_variance, 2.0_dp, thr=0.1_dp)
   end subroutine test_missing

   !> Correlation time 2000 samples, 1/40 of the white variance: not to be seen in 96 lags
   subroutine test_slow(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp), allocatable :: z(:)

      allocate (z(400000))
      call make_series(41, exp(-1/2000.0_dp), 0.025_dp, 1.0_dp, z)
      call identify_drift(z, model, failure)
      call check(error, model%found, "the drift is not found")
      call check(error, model%correlation_samples, 2000.0_dp, thr=700.0_dp)
      call check(error, model%drift_variance, 0.025_dp, thr=0.008_dp)
      call check(error, model%measurement_variance, 1.0_dp, thr=0.01_dp)
   end subroutine test_slow

   !> A random walk with steps: records at which a weighted fit alone goes astray and finds nothing
   subroutine test_random_walk(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(12000), w(12000), level
      integer, parameter :: seed(5) = [7, 82, 112, 160, 183]
      integer :: i, k

      do i = 1, size(seed)
         call fill_noise(4000 + seed(i), w)
         call fill_noise(4500 + seed(i), z)
         level = 0
         do k = 1, size(z)
            level = level + 3.0e-4_dp*w(k)
            if (mod(k, 1714) == 0) level = level + merge(0.03_dp, -0.03_dp, mod(k/1714, 2) == 0)
            z(k) = level + sqrt(4.2e-4_dp)*z(k)
         end do
         call identify_drift(z, model, failure)
         call check(error, model%found, "the walk is not found")
         call check(error, model%measurement_variance, 4.2e-4_dp, thr=0.1_dp, rel=.true.)
         call check(error, model%correlation_samples > 300, "the walk is taken for something fast")
      end do
   end subroutine test_random_walk

   !> The paper's record: AR(1) alone, R about zero, correlation time 1.12 samples (0.22 s): no drift
   subroutine test_pure_ar(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(12000)

      call make_series(42, paper_phi, 5.24e-4_dp, 0.0_dp, z)
      call identify_drift(z, model, failure)
      call check(error,.not. model%found, "fast noise is taken for drift")
      call check(error, model%measurement_variance, 0.0_dp, thr=0.1_dp*5.24e-4_dp)
      call check(error, 0.2_dp*model%correlation_samples, 0.224_dp, thr=0.03_dp)
   end subroutine test_pure_ar

   !> White noise: all of it is R
   subroutine test_white(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(5000)
      integer :: seed

      do seed = 43, 62
         call fill_noise(seed, z)
         call identify_drift(z, model, failure)
         call check(error,.not. model%found, "white noise is taken for drift")
         call check(error, model%drift_variance, 0.0_dp)
      end do
      call check(error, model%measurement_variance, sum((z - sum(z)/5000)**2)/5000, thr=1.0e-12_dp, rel=.true.)
   end subroutine test_white

   !> A correlation time of 20 samples is drift or not, as the caller says
   subroutine test_limit(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(20000)

      call make_series(63, exp(-0.05_dp), 1.0_dp, 1.0_dp, z)
      call identify_drift(z, model, failure, minimum_samples=10.0_dp)
      call check(error, model%found, "slower than the limit")
      call identify_drift(z, model, failure, minimum_samples=50.0_dp)
      call check(error,.not. model%found, "faster than the limit")
      call check(error, model%correlation_samples, 20.0_dp, thr=5.0_dp)
   end subroutine test_limit

   !> An offset changes nothing; a scale the variances by its square
   subroutine test_offset_scale(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model, other
      real(dp) :: z(5000)

      call make_series(64, 0.98_dp, 1.0_dp, 2.0_dp, z)
      call identify_drift(z, model, failure)
      z = 1.0e-3_dp*z + 7
      call identify_drift(z, other, failure)
      call check(error, other%correlation_samples, model%correlation_samples, thr=1.0e-6_dp, rel=.true.)
      call check(error, 1.0e6_dp*other%measurement_variance, model%measurement_variance, thr=1.0e-7_dp, rel=.true.)
   end subroutine test_offset_scale

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      type(drift_model_type) :: model
      real(dp) :: z(100)

      z = 3
      call identify_drift(z(:49), model, failure)
      call check(error, allocated(failure), "49 samples are too few")
      if (allocated(error)) return
      call check(error, failure%code, status%too_few_samples)
      call identify_drift(z, model, failure)
      call check(error, allocated(failure), "a constant series has no drift")
      if (allocated(error)) return
      call check(error, failure%code, status%constant_input)
   end subroutine test_refused
end module test_identification
