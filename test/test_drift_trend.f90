! SPDX-License-Identifier: MIT
!> A polynomial under the drift: generalised least squares against dense matrices, its place in the fit of a drift model.
module test_drift_trend
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_lapack, only : dposv
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use gyroakf_filter_drift_trend, only : fit_polynomial
   use filter_library, only : fill_noise, make_series
   implicit none (type, external)
   private
   public :: collect_drift_trend

contains

   subroutine collect_drift_trend(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("dense", test_dense), &
         new_unittest("recovered", test_recovered), &
         new_unittest("walk", test_walk), &
         new_unittest("no-trend", test_no_trend), &
         new_unittest("identified", test_identified), &
         new_unittest("refused", test_refused)]
   end subroutine collect_drift_trend

   !> Legendre polynomials of degree 1 to 3 over n samples: [n, 3]
   pure subroutine make_basis(basis)
      real(dp), intent(out) :: basis(:, :)
      real(dp) :: t
      integer :: k, n

      n = size(basis, 1)
      do k = 1, n
         t = real(2*k - n - 1, dp)/real(n - 1, dp)
         basis(k, :) = [t, (3*t**2 - 1)/2, (5*t**3 - 3*t)/2]
      end do
   end subroutine make_basis

   !> (X' S^-1 X)^-1 X' S^-1 z with the covariance matrix S of AR(1) and white noise written out, some samples missing.
   subroutine test_dense(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: n = 50
      type(component_model_type) :: model
      real(dp) :: z(n), basis(n, 3), s(n, n), right(n, 4), a(3, 3), b(3, 1), coefficient(3)
      integer(int8), allocatable :: here(:)
      integer :: i, j, info
      integer :: row(n - 3)

      model%count = 1
      model%phi(1) = 0.9_dp
      model%q(1) = 0.3_dp
      model%r = 0.7_dp
      call fill_noise(50, z)
      call make_basis(basis)
      z = z + matmul(basis, [0.5_dp, -1.0_dp, 2.0_dp])
      allocate (here(n), source=1_int8)
      here([4, 21, 22]) = 0_int8
      row = pack([(i, i=1, n)], here == 1_int8)
      do i = 1, size(row)
         do j = 1, size(row)
            s(i, j) = model%q(1)/(1 - model%phi(1)**2)*model%phi(1)**abs(row(i) - row(j))
         end do
         s(i, i) = s(i, i) + model%r
      end do
      right(:size(row), :3) = basis(row, :)
      right(:size(row), 4) = z(row)
      call dposv("L", size(row), 4, s, n, right, n, info)
      a = matmul(transpose(basis(row, :)), right(:size(row), :3))
      b(:, 1) = matmul(transpose(basis(row, :)), right(:size(row), 4))
      call dposv("L", 3, 1, a, 3, b, 3, info)
      coefficient = 0.0_dp
      call fit_polynomial(model, z, here, coefficient)
      call check(error, maxval(abs(coefficient - b(:, 1))) < 1.0e-9_dp*maxval(abs(b)), "not the generalised least squares")
   end subroutine test_dense

   !> A cubic under AR(1) and white noise: coefficients within their scatter, the model as without the cubic.
   subroutine test_recovered(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: truth(3) = [3.0_dp, -2.0_dp, 1.5_dp]
      type(drift_fit_type) :: fit, without
      type(gyro_error), allocatable :: failed
      real(dp) :: z(4000), basis(4000, 3)
      integer :: k

      call make_series(51, 0.9_dp, 1.0_dp, 1.0_dp, z)
      call make_basis(basis)
      call fit_drift(z, without, failed, degree=3)
      call fit_drift(z + matmul(basis, truth), fit, failed, degree=3)
      call check(error, .not. allocated(failed) .and. fit%best == without%best)
      if (allocated(error)) return
      associate (one => fit%candidate(2), other => without%candidate(2))
         call check(error, one%name == "ar1" .and. one%parameters == 7)
         if (allocated(error)) return
         ! the fit does not see the cubic: the same numbers, its coefficients on top
         call check(error, maxval(abs(one%trend - other%trend - truth)) < 1.0e-3_dp, "coefficients")
         if (allocated(error)) return
         call check(error, one%model%r, other%model%r, thr=1.0e-4_dp, rel=.true.)
         if (allocated(error)) return
         call check(error, one%model%phi(1), other%model%phi(1), thr=1.0e-4_dp)
         if (allocated(error)) return
         do k = 1, 3
            ! variance of the mean of n correlated samples, times 2k + 1 for the polynomial
            call check(error, abs(other%trend(k)) < 4*sqrt((1.0_dp*19 + 1.0_dp)*(2*k + 1)/4000.0_dp), "scatter")
            if (allocated(error)) return
         end do
         call check(error, abs(one%model%phi(1) - 0.9_dp) < 4*one%std_error%phi(1) .and. one%errors_known, "phi")
      end associate
   end subroutine test_recovered

   !> With a steep line under it a walk needs a large q; with the polynomial it is the one without.
   subroutine test_walk(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_fit_type) :: fit
      type(gyro_error), allocatable :: failed
      real(dp) :: z(3000), basis(3000, 3), step(3000)
      integer :: k

      call fill_noise(52, z)
      call fill_noise(53, step)
      step = 0.01_dp*step
      do k = 2, 3000
         step(k) = step(k) + step(k - 1)
      end do
      call make_basis(basis)
      z = z + step + 200.0_dp*basis(:, 1)
      call fit_drift(z, fit, failed)
      call check(error, .not. allocated(failed))
      if (allocated(error)) return
      call check(error, fit%candidate(1)%model%q(1) > 1.0e-3_dp, "the line is in the walk")
      if (allocated(error)) return
      call fit_drift(z, fit, failed, degree=1)
      call check(error, fit%candidate(1)%model%q(1) < 4.0e-4_dp, "the line is still in the walk")
      if (allocated(error)) return
      ! of a walk the end is uncertain by 0.01 sqrt(3000) = 0.55
      call check(error, abs(fit%candidate(1)%trend(1) - 200.0_dp) < 2.0_dp, "slope")
   end subroutine test_walk

   !> Degree 0 is the fit without a polynomial, bit for bit; a polynomial that is not there is not found worth its parameters.
   subroutine test_no_trend(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_fit_type) :: fit, other
      type(gyro_error), allocatable :: failed
      real(dp) :: z(2000)

      call make_series(54, 0.8_dp, 1.0_dp, 1.0_dp, z)
      call fit_drift(z, fit, failed)
      call fit_drift(z, other, failed, degree=0)
      call check(error, abs(fit%candidate(2)%aic - other%candidate(2)%aic) <= 0.0_dp)
      if (allocated(error)) return
      call fit_drift(z, other, failed, degree=2)
      call check(error, other%candidate(2)%log_likelihood >= fit%candidate(2)%log_likelihood - 1.0e-6_dp, "less likely")
      if (allocated(error)) return
      call check(error, other%candidate(2)%aic > fit%candidate(2)%aic, "worth its parameters")
   end subroutine test_no_trend

   !> The identification of the record: what is drift without the cubic is no drift with it.
   subroutine test_identified(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_identification_type) :: without, with
      type(gyro_error), allocatable :: failed
      real(dp) :: z(3000), basis(3000, 3)

      call fill_noise(55, z)
      call make_basis(basis)
      z = z + matmul(basis, [4.0_dp, 3.0_dp, -2.0_dp])
      call identify_drift_model(z, drift_identification_options(), without, failed)
      call check(error, .not. allocated(failed) .and. without%found, "a cubic passes for drift")
      if (allocated(error)) return
      call identify_drift_model(z, drift_identification_options(degree=3), with, failed)
      call check(error, .not. allocated(failed) .and. .not. with%found, "drift under the cubic")
      if (allocated(error)) return
      call check(error, maxval(abs(with%trend - [4.0_dp, 3.0_dp, -2.0_dp])) < 4*sqrt(7.0_dp/3000), "coefficients")
   end subroutine test_identified

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(drift_fit_type) :: fit
      type(gyro_error), allocatable :: failed
      real(dp) :: z(60)
      integer :: degree

      call fill_noise(56, z)
      do degree = -1, 4, 5
         call fit_drift(z, fit, failed, degree=degree)
         call check_refused(error, failed, status%invalid_argument)
         if (allocated(error)) return
      end do
   end subroutine test_refused

end module test_drift_trend
