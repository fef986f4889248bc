! SPDX-License-Identifier: MIT
!> Tests of the ARMA models: exact likelihood, its gradient, the fit.
module test_arma
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_lapack, only : dpotrf, dtrtrs
   use gyroakf_simulate_random, only : random_type, seed_random, fill_normal
   use gyroakf_ar_arma_state, only : arma_sums_type
   use gyroakf_ar_arma_filter, only : arma_series_type, sum_innovations
   use gyroakf_ar_arma_likelihood, only : arma_log_likelihood, arma_objective_type
   use gyroakf_ar_arma_start, only : drift_as_arma, arma_as_drift
   use gyroakf_ar_arma_transform, only : coefficients_of, free_of
   use gyroakf_ar_arma_result, only : arma_options, arma_model_type
   use gyroakf_ar_arma_model, only : fit_arma
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_arma

   !> What the searches of the order table leave
   real(dp), parameter :: table_error = 0.01_dp
   real(dp), parameter :: log_two_pi = 1.8378770664093454836_dp
   !> Coefficients of the models below, ARMA(3, 3) and its smaller ones
   real(dp), parameter :: phi3(3) = [0.5_dp, 0.2_dp, -0.3_dp], theta3(3) = [0.6_dp, 0.3_dp, 0.2_dp]

contains

   !> The tests of this suite.
   subroutine collect_arma(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("likelihood against the dense covariance", test_dense), &
         & new_unittest("likelihood of an AR(1) in closed form", test_closed), &
         & new_unittest("the steady prediction gives the same likelihood", test_switch), &
         & new_unittest("gradient against differences", test_gradient), &
         & new_unittest("coefficients and free parameters", test_transform), &
         & new_unittest("drift in white noise and ARMA(1,1)", test_drift_algebra), &
         & new_unittest("coefficients within their errors", test_recovery), &
         & new_unittest("a simulated drift in white noise", test_drift), &
         & new_unittest("offset and scale", test_invariance), &
         & new_unittest("missing samples", test_missing), &
         & new_unittest("orders by a criterion", test_orders), &
         & new_unittest("AR(1) under white noise is chosen as ARMA(1,1), whatever the threads", test_choice), &
         & new_unittest("the part of a long series", test_part), &
         & new_unittest("models at the edge are not chosen", test_edge), &
         & new_unittest("a common factor is told", test_common), &
         & new_unittest("failures", test_failures)]
   end subroutine collect_arma

   !> A series of an ARMA model; 500 samples before it are thrown away.
   subroutine simulate(phi, theta, seed, x)
      real(dp), intent(in) :: phi(:), theta(:)
      integer(int64), intent(in) :: seed
      real(dp), intent(out) :: x(:)
      type(random_type) :: random
      real(dp) :: e(size(x) + 500), y(size(x) + 500)
      integer :: t, j

      call seed_random(random, seed)
      call fill_normal(random, e)
      y = e
      do t = 4, size(y)
         do j = 1, size(phi)
            y(t) = y(t) + phi(j)*y(t - j)
         end do
         do j = 1, size(theta)
            y(t) = y(t) + theta(j)*e(t - j)
         end do
      end do
      x(:) = y(501:)
   end subroutine simulate

   !> ln L from the Cholesky factor of the covariance matrix of the present samples; covariances from 4000 weights.
   real(dp) function dense(x, phi, theta, valid) result(log_likelihood)
      real(dp), intent(in) :: x(:), phi(:), theta(:)
      integer(int8), intent(in) :: valid(:)
      real(dp) :: weight(-3:4000), a(count(valid == 1), count(valid == 1)), z(count(valid == 1), 1)
      integer :: at(count(valid == 1)), i, j, n, info

      n = size(at)
      at = pack([(i, i=1, size(x))], valid == 1)
      weight = 0
      weight(0) = 1
      do i = 1, 4000
         if (i <= size(theta)) weight(i) = theta(i)
         do j = 1, size(phi)
            weight(i) = weight(i) + phi(j)*weight(i - j)
         end do
      end do
      do j = 1, n
         do i = 1, n
            a(i, j) = dot_product(weight(:4000 - abs(at(i) - at(j))), weight(abs(at(i) - at(j)) - 3:))
         end do
         z(j, 1) = x(at(j))
      end do
      call dpotrf("L", n, a, n, info)
      call dtrtrs("L", "N", "N", n, 1, a, n, z, n, info)
      log_likelihood = -0.5_dp*n*(log_two_pi + 1 + log(sum(z**2)/n)) - sum([(log(a(i, i)), i=1, n)])
   end function dense

   subroutine test_dense(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      real(dp) :: x(50), value, variance
      integer(int8) :: valid(50)
      integer :: p, q, gaps

      call simulate(phi3, theta3, 3_int64, x)
      do gaps = 0, 1
         valid = 1_int8
         if (gaps == 1) valid([1, 2, 17, 30, 31, 32, 33, 34, 49]) = 0_int8
         do q = 0, 3
            do p = 0, 3
               call arma_log_likelihood(x, phi3(:p), theta3(:q), 0.0_dp, value, variance, failure, valid)
               call check(error,.not. allocated(failure), "there is a likelihood")
               if (allocated(error)) return
               call check(error, abs(value - dense(x, phi3(:p), theta3(:q), valid)) < 1e-10_dp, "as dense")
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_dense

   !> S = (1 - phi^2) x_1^2 + sum (x_t - phi x_(t-1))^2, ln L = -n/2 (ln 2 pi S/n + 1) + ln(1 - phi^2)/2.
   subroutine test_closed(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failure
      real(dp), parameter :: phi = 0.999_dp
      real(dp) :: x(300), value, variance, s

      call simulate([phi], theta3(:0), 5_int64, x)
      call arma_log_likelihood(x + 3, [phi], theta3(:0), 3.0_dp, value, variance, failure)
      call check(error,.not. allocated(failure), "there is a likelihood")
      if (allocated(error)) return
      s = (1 - phi**2)*x(1)**2 + sum((x(2:) - phi*x(:299))**2)
      call check(error, abs(variance*300/s - 1) < 1e-11_dp, "sigma^2")
      if (allocated(error)) return
      call check(error, abs(value + 150*(log_two_pi + log(s/300) + 1) - 0.5_dp*log(1 - phi**2)) < 1e-9_dp, "ln L")
   end subroutine test_closed

   subroutine test_switch(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_series_type) :: series
      type(arma_sums_type) :: fast, slow
      logical :: stationary
      integer :: q, gaps

      allocate (series%y(3000))
      call simulate(phi3, theta3, 4_int64, series%y)
      do gaps = 0, 1
         if (gaps == 1) then
            allocate (series%valid(3000), source=1_int8)
            series%valid([100, 101, 1000, 1001, 1500]) = 0_int8
         end if
         do q = 0, 3
            call sum_innovations(series, phi3, theta3(:q), 0.1_dp, slow, stationary, .false., switch=.false.)
            call sum_innovations(series, phi3, theta3(:q), 0.1_dp, fast, stationary, .false.)
            call check(error, abs(fast%square/slow%square - 1) < 1e-13_dp .and. abs(fast%log_f - slow%log_f) < 1e-12_dp, "sums")
            if (allocated(error)) return
            call check(error, maxval(abs(fast%square_slope(:3 + q) - slow%square_slope(:3 + q))) < 1e-10_dp, "slopes")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_switch

   subroutine test_gradient(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_objective_type) :: objective
      real(dp), parameter :: h = 1e-5_dp
      real(dp) :: u(7), gradient(7), unused(7), above, below, value
      logical :: feasible
      integer :: i, gaps

      allocate (objective%series%y(400))
      call simulate(phi3, theta3, 6_int64, objective%series%y)
      objective%p = 3
      objective%q = 3
      u = [0.4_dp, -0.2_dp, 0.3_dp, 1.0_dp, -0.3_dp, 0.1_dp, 0.2_dp]
      do gaps = 0, 1
         if (gaps == 1) allocate (objective%series%valid(400), source=1_int8)
         if (gaps == 1) objective%series%valid([1, 50, 51, 52, 300]) = 0_int8
         call objective%evaluate(u, value, gradient, feasible)
         do i = 1, 7
            u(i) = u(i) + h
            call objective%evaluate(u, above, unused, feasible)
            u(i) = u(i) - 2*h
            call objective%evaluate(u, below, unused, feasible)
            u(i) = u(i) + h
            call check(error, abs((above - below)/(2*h) - gradient(i)) < 1e-8_dp, "a difference")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_gradient

   subroutine test_transform(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: u(3), phi(3), jacobian(3, 3)
      logical :: stationary

      call free_of(phi3, u, stationary)
      call check(error, stationary, "stationary")
      if (allocated(error)) return
      call coefficients_of(u, phi, jacobian)
      call check(error, maxval(abs(phi - phi3)) < 1e-14_dp, "there and back")
      if (allocated(error)) return
      call free_of([1.2_dp, -0.1_dp], u(:2), stationary)
      call check(error,.not. stationary, "a root outside")
   end subroutine test_transform

   subroutine test_drift_algebra(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: phi = 0.99_dp, drift = 0.02_dp, white = 0.7_dp
      real(dp) :: theta, d, r, slope(2), white_slope(2), sigma2
      logical :: admissible

      theta = drift_as_arma(phi, drift, white)
      sigma2 = -phi*white/theta
      call check(error, abs(sigma2*(1 + theta**2)/(drift*(1 - phi**2) + white*(1 + phi**2)) - 1) < 1e-13_dp, "autocovariances")
      if (allocated(error)) return
      call arma_as_drift(phi, theta, d, r, slope, white_slope, admissible)
      call check(error, admissible .and. abs(d*sigma2/drift - 1) < 1e-11_dp .and. abs(r*sigma2/white - 1) < 1e-13_dp, "and back")
      if (allocated(error)) return
      call arma_as_drift(phi, 0.1_dp, d, r, slope, white_slope, admissible)
      call check(error,.not. admissible, "theta > 0 is no drift in white noise")
   end subroutine test_drift_algebra

   !> Mean squared deviation in units of the stated errors, over 30 series: 1 within 4 sqrt(2/90).
   subroutine test_recovery(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model
      type(gyro_error), allocatable :: failure
      real(dp) :: x(1000), square
      integer(int64) :: seed

      square = 0
      do seed = 1, 30
         call simulate([0.8_dp], [0.4_dp], seed, x)
         call fit_arma(x, arma_options(p=1, q=1), model, failure)
         call check(error,.not. allocated(failure) .and. model%converged .and. model%errors_known, "converged")
         if (allocated(error)) return
         square = square + ((model%phi(1) - 0.8_dp)/model%phi_error(1))**2 + ((model%theta(1) - 0.4_dp)/model%theta_error(1))**2 &
            + (model%mean/model%mean_error)**2
      end do
      call check(error, abs(square/90 - 1) < 4*sqrt(2/90.0_dp), "errors")
   end subroutine test_recovery

   subroutine test_drift(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model
      type(gyro_error), allocatable :: failure
      real(dp), parameter :: phi = 0.98_dp, drift = 0.2_dp
      real(dp) :: x(20000), white(20000)
      type(random_type) :: random

      call simulate([phi], theta3(:0), 8_int64, x)
      call seed_random(random, 9_int64)
      call fill_normal(random, white)
      x = 100 + 0.3_dp*white + drift*sqrt(1 - phi**2)*x
      call fit_arma(x, arma_options(p=1, q=1), model, failure)
      call check(error,.not. allocated(failure), "a fit")
      if (allocated(error)) return
      call check(error, abs(model%theta(1) - drift_as_arma(phi, drift**2, 0.09_dp)) < 4*model%theta_error(1), "theta")
      if (allocated(error)) return
      call check(error, model%drift%found .and. abs(model%drift%time_constant + 1/log(phi)) < 4*model%drift%time_error, "time")
      if (allocated(error)) return
      call check(error, abs(model%drift%drift_std - drift) < 4*model%drift%drift_error .and. &
                 abs(model%drift%white_std - 0.3_dp) < 4*model%drift%white_error .and. model%drift%white_error < 0.003_dp, "sizes")
      if (allocated(error)) return
      call check(error, model%residual_ljung_box%p_value > 1e-3_dp .and. model%residual_ljung_box%fitted == 2 .and. &
                 size(model%warnings) == 0, "residuals are white, nothing is odd")
   end subroutine test_drift

   subroutine test_invariance(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model, moved
      type(gyro_error), allocatable :: failure
      real(dp) :: x(2000)

      call simulate([0.9_dp], [-0.4_dp], 2_int64, x)
      call fit_arma(x, arma_options(p=1, q=1), model, failure)
      call check(error,.not. allocated(failure), "a fit")
      if (allocated(error)) return
      call fit_arma(1e6_dp + 1e-3_dp*x, arma_options(p=1, q=1), moved, failure)
      call check(error,.not. allocated(failure), "a fit with an offset")
      if (allocated(error)) return
      call check(error, abs(moved%phi(1) - model%phi(1)) < 1e-6_dp .and. abs(moved%theta(1) - model%theta(1)) < 1e-6_dp, "offset")
      if (allocated(error)) return
      call fit_arma(1024*x, arma_options(p=1, q=1), moved, failure)
      call check(error, moved%phi(1) - model%phi(1) == 0 .and. abs(moved%mean - 1024*model%mean) <= 0, "a power of 2 is exact")
      if (allocated(error)) return
      call check(error, abs(moved%fit%log_likelihood - model%fit%log_likelihood + 2000*log(1024.0_dp)) < 1e-8_dp, "ln L")
   end subroutine test_invariance

   subroutine test_missing(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model, other
      type(gyro_error), allocatable :: failure
      real(dp) :: x(3000)
      integer(int8) :: valid(3000)

      call simulate([0.9_dp], [-0.4_dp], 12_int64, x)
      valid = 1_int8
      call fit_arma(x, arma_options(p=1, q=1), model, failure)
      call fit_arma(x, arma_options(p=1, q=1), other, failure, valid)
      call check(error, abs(model%phi(1) - other%phi(1)) < 1e-9_dp, "a mask of ones")
      if (allocated(error)) return
      valid(::7) = 0_int8
      valid(1000:1100) = 0_int8
      call fit_arma(x, arma_options(p=1, q=1), model, failure, valid)
      call check(error, abs(model%phi(1) - 0.9_dp) < 4*model%phi_error(1) .and. &
                 abs(model%theta(1) + 0.4_dp) < 4*model%theta_error(1) .and. model%samples == count(valid == 1), "gaps")
      if (allocated(error)) return
      where (valid == 0) x = 1e30_dp
      call fit_arma(x, arma_options(p=1, q=1), other, failure, valid)
      call check(error, abs(model%phi(1) - other%phi(1)) <= 0, "what is missing does not matter")
   end subroutine test_missing

   subroutine test_orders(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model
      type(gyro_error), allocatable :: failure
      real(dp) :: x(1000)

      call simulate([0.9_dp], [0.5_dp], 13_int64, x)
      call fit_arma(x, arma_options(max_p=2, max_q=2), model, failure)
      call check(error,.not. allocated(failure), "a fit")
      if (allocated(error)) return
      call check(error, model%p == 1 .and. model%q == 1 .and. size(model%table) == 9, "ARMA(1,1) by BIC")
      if (allocated(error)) return
      call check(error, model%table(9)%log_likelihood >= maxval(model%table%log_likelihood) - table_error, "the largest")
      if (allocated(error)) return
      call check(error, abs(model%fit%log_likelihood - model%table(5)%log_likelihood) < table_error, "the line of the choice")
      if (allocated(error)) return
      call fit_arma(x, arma_options(p=2, max_q=1, criterion="aicc"), model, failure)
      call check(error, model%p == 2 .and. size(model%table) == 2, "one order given")
   end subroutine test_orders

   subroutine test_choice(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model, other
      type(gyro_error), allocatable :: failure
      real(dp) :: x(12000), white(12000)
      type(random_type) :: random
      integer :: threads

      call simulate([0.98_dp], theta3(:0), 8_int64, x)
      call seed_random(random, 9_int64)
      call fill_normal(random, white)
      x = white + 0.06_dp*x
      threads = thread_count()
      call set_thread_count(1)
      call fit_arma(x, arma_options(), model, failure)
      call set_thread_count(3)
      if (.not. allocated(failure)) call fit_arma(x, arma_options(), other, failure)
      call set_thread_count(threads)
      call check(error,.not. allocated(failure), "fits")
      if (allocated(error)) return
      call check(error, model%p == 1 .and. model%q == 1 .and. model%drift%found .and. model%converged, "ARMA(1,1) by BIC")
      if (allocated(error)) return
      call check(error, all(abs(model%table%bic - other%table%bic) <= 0) .and. abs(model%phi(1) - other%phi(1)) <= 0, "threads")
      if (allocated(error)) return
      call check(error, model%evaluations <= 20 .and. model%compared_length == 12000, "the fit begins where the choice ended")
   end subroutine test_choice

   subroutine test_part(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model, other
      type(gyro_error), allocatable :: failure
      real(dp) :: x(9000)
      integer(int8) :: valid(9000)

      call simulate([0.9_dp], [0.5_dp], 13_int64, x)
      call fit_arma(x, arma_options(max_p=1, max_q=1, max_samples=8000_int64), model, failure)
      call check(error, model%first == 501 .and. model%length == 8000 .and. model%compared_length == 2000, "the middle")
      if (allocated(error)) return
      call fit_arma(x(501:8500), arma_options(p=1, q=1), other, failure)
      call check(error, model%p == 1 .and. model%q == 1 .and. abs(model%phi(1) - other%phi(1)) < 1e-6_dp, "fitted to it")
      if (allocated(error)) return
      valid = 1_int8
      valid(::300) = 0_int8
      call fit_arma(x, arma_options(p=1, q=1, max_samples=8000_int64), model, failure, valid)
      call check(error, model%length == 8000, "few gaps")
      if (allocated(error)) return
      valid(::100) = 0_int8
      call fit_arma(x, arma_options(p=1, q=1, max_samples=8000_int64), model, failure, valid)
      call check(error, model%length == 2000 .and. model%first == 3501, "many gaps: a quarter")
   end subroutine test_part

   !> White noise, differenced: its MA(1) has theta = -1.
   subroutine test_edge(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model
      type(gyro_error), allocatable :: failure
      real(dp) :: x(1001)

      call simulate(phi3(:0), theta3(:0), 13_int64, x)
      x(:1000) = x(2:) - x(:1000)
      call fit_arma(x(:1000), arma_options(max_p=1, max_q=1), model, failure)
      call check(error,.not. allocated(failure), "a fit")
      if (allocated(error)) return
      call check(error, any(.not. model%table%usable) .and. .not. (model%p == 0 .and. model%q == 1), "left out")
      if (allocated(error)) return
      call fit_arma(x(:1000), arma_options(p=0, q=1), model, failure)
      call check(error, size(model%warnings) >= 1, "told where it is asked for")
      if (allocated(error)) return
      call check(error, index(model%warnings(1)%text, "MA polynomial is at the unit circle") > 0, "by name")
   end subroutine test_edge

   subroutine test_common(error)
      type(error_type), allocatable, intent(out) :: error
      type(arma_model_type) :: model
      type(gyro_error), allocatable :: failure
      real(dp) :: x(2000)

      call simulate([0.7_dp], theta3(:0), 21_int64, x)
      call fit_arma(x, arma_options(p=2, q=1), model, failure)
      call check(error,.not. allocated(failure), "a fit")
      if (allocated(error)) return
      call check(error, size(model%warnings) >= 1, "a warning")
      if (allocated(error)) return
      call check(error, index(model%warnings(1)%text, "ARMA(1,0)") > 0, "names the smaller model")
   end subroutine test_common

   subroutine test_failures(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: x(100), value, variance
      integer :: i
      type(gyro_error), allocatable :: failure
      type(arma_model_type) :: model

      x = 5
      call fit_arma(x, arma_options(p=1, q=1), model, failure)
      call expect(status%constant_input, "constant")
      x = [(sin(0.3_dp*i), i=1, 100)]
      call fit_arma(x(:27), arma_options(p=1, q=1), model, failure)
      call expect(status%too_few_samples, "27 samples")
      call fit_arma(x, arma_options(p=2, q=0), model, failure)
      call expect(status%singular, "perfect fit")
      call fit_arma(x, arma_options(p=4, q=0), model, failure)
      call expect(status%invalid_argument, "order 4")
      call fit_arma(x, arma_options(criterion="cat"), model, failure)
      call expect(status%invalid_argument, "criterion")
      call fit_arma(x, arma_options(p=1, q=1), model, failure, [1_int8])
      call expect(status%invalid_argument, "mask")
      call arma_log_likelihood(x, [1.0_dp], x(:0), 0.0_dp, value, variance, failure)
      call expect(status%unstable, "random walk")

   contains

      subroutine expect(code, name)
         integer, intent(in) :: code
         character(*), intent(in) :: name

         if (allocated(error)) return
         call check(error, allocated(failure), name)
         if (allocated(error)) return
         call check(error, failure%code, code, name)
      end subroutine expect

   end subroutine test_failures

end module test_arma
