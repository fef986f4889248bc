! SPDX-License-Identifier: MIT
!> A polynomial under the drift: generalised least squares against dense matrices, its place in the fit of a drift model.
module test_drift_trend
   use expectations, only : check_refused
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_lapack, only : dposv
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use gyroakf_filter_drift_trend, only : fit_polynomial, legendre_sum, subtract_polynomial, whole_polynomial
   use filter_library, only : fill_noise, make_series
   implicit none (type, external)
   private
   public :: collect_drift_trend

contains

   subroutine collect_drift_trend(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("dense", test_dense), &
         new_unittest("whole-record", test_whole), &
         new_unittest("errors", test_errors), &
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

   !> (X' S^-1 X)^-1 X' S^-1 z with the covariance matrix S of AR(1) and white noise written out, some samples missing; the columns
   !> have no mean over those that are there.
   subroutine test_dense(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: n = 50
      type(component_model_type) :: model
      real(dp) :: z(n), basis(n, 3), s(n, n), right(n, 4), a(3, 3), b(3, 4), coefficient(3), std_error(3)
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
      do j = 1, 3
         basis(:, j) = basis(:, j) - sum(basis(row, j))/size(row)
      end do
      right(:size(row), :3) = basis(row, :)
      right(:size(row), 4) = z(row)
      call dposv("L", size(row), 4, s, n, right, n, info)
      a = matmul(transpose(basis(row, :)), right(:size(row), :3))
      b(:, 1) = matmul(transpose(basis(row, :)), right(:size(row), 4))
      b(:, 2:) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      call dposv("L", 3, 4, a, 3, b, 3, info)
      coefficient = 0.0_dp
      call fit_polynomial(model, z, here, coefficient, std_error)
      call check(error, maxval(abs(coefficient - b(:, 1))) < 1.0e-9_dp*maxval(abs(b)), "not the generalised least squares")
      if (allocated(error)) return
      call check(error, maxval(abs(std_error - sqrt([b(1, 2), b(2, 3), b(3, 4)]))) < 1.0e-9_dp, "standard errors")
   end subroutine test_dense

   !> A record longer than the part, its second half with a long gap: the polynomial is that of the whole of it, whatever the unit
   !> and the offset of the series; without a process it is that of least squares.
   subroutine test_whole(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: truth(3) = [30.0_dp, -20.0_dp, 15.0_dp], units(3) = [1.0_dp, 1.0e-100_dp, 1.0e+100_dp]
      type(drift_identification_type) :: found
      type(gyro_error), allocatable :: failed
      real(dp) :: z(8000), line(8000), least(1), least_error(1), first(3)
      integer(int8) :: here(8000)
      integer :: k

      call make_series(57, 0.95_dp, 1.0_dp, 1.0_dp, z)
      z = z + [(legendre_sum(truth, int(k, int64), 8000_int64), k=1, 8000)] + 500.0_dp
      here = 1_int8
      here(5500:7200) = 0_int8
      do k = 1, size(units)
         call identify_drift_model(units(k)*z, drift_identification_options(most=2000_int64, degree=3), found, failed, here)
         call check(error, .not. allocated(failed) .and. found%found .and. found%degree == 3)
         if (allocated(error)) return
         associate (trend => found%trend/units(k), std_error => found%trend_error/units(k))
            call check(error, all(abs(trend - truth) < 4*std_error), "coefficients")
            if (allocated(error)) return
            ! of an AR(1) process with phi = 0.95 the mean of 8000 samples scatters by sqrt(39/8000)
            call check(error, all(std_error > 0.05_dp) .and. all(std_error < 0.5_dp), "their errors")
            if (allocated(error)) return
            if (k == 1) first = trend
            ! the search for the model ends within 5e-4 of its parameters' errors
            call check(error, maxval(abs(trend - first)/std_error) < 1.0e-3_dp, "the unit")
            if (allocated(error)) return
         end associate
      end do
      call fill_noise(58, line)
      line = line + [(legendre_sum(truth(:1), int(k, int64), 8000_int64), k=1, 8000)]
      call whole_polynomial(component_model_type(r=1.0_dp), line, least, least_error, failed)
      line = [((2*k - 8001)/7999.0_dp, k=1, 8000)]*(line - sum(line)/8000)
      call check(error, least(1), sum(line)/(8001*8000/(3*7999.0_dp)), thr=1.0e-9_dp, rel=.true.)
      if (allocated(error)) return
      call check(error, least_error(1), sqrt(3*7999.0_dp/(8001*8000.0_dp)), thr=1.0e-9_dp, rel=.true.)
      if (allocated(error)) return
      z = 7.0_dp
      call subtract_polynomial(truth, z, here)
      call check(error, abs(sum(z, mask=here == 1_int8)/count(here == 1_int8) - 7) < 1.0e-12_dp, "the mean of the present stays")
   end subroutine test_whole

   !> The standard errors are those of the scatter over records: of the squares of 40 records and 2 coefficients over their
   !> variances the mean is 1 to four standard deviations, 4 sqrt(2/80).
   subroutine test_errors(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: records = 40
      type(component_model_type) :: model
      type(gyro_error), allocatable :: failed
      real(dp) :: z(1000), coefficient(2), std_error(2), squares
      integer :: k

      model%count = 1
      model%phi(1) = 0.98_dp
      model%q(1) = 0.5_dp*(1 - model%phi(1)**2)
      model%r = 1.0_dp
      squares = 0.0_dp
      do k = 1, records
         call make_series(600 + 2*k, model%phi(1), 0.5_dp, model%r, z)
         call whole_polynomial(model, z, coefficient, std_error, failed)
         squares = squares + sum((coefficient/std_error)**2)
      end do
      call check(error, abs(squares/(2*records) - 1) < 4*sqrt(2.0_dp/(2*records)), "scatter and standard errors differ")
   end subroutine test_errors

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
