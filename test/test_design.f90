! SPDX-License-Identifier: MIT
!> Tests of the filters' design: the paper's family and that of the identified drift.
module test_design
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use gyroakf_filter_design, only : design_options, design_kf, design_akf, drift_options, design_drift_kf, design_drift_akf, &
      adaptive_drift
   use gyroakf_filter_drift_identification, only : drift_identification_options, drift_identification_type, identify_drift_model
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, filter_type, new_filter, run_filter
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use filter_library, only : fill_noise, make_series, paper_phi
   use expectations, only : unmet, failure => problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_design

contains

   subroutine suite_design()
      call test("paper_kalman", test_kf)
      call test("paper_adaptive_start", test_akf_start)
      call test("paper_adaptive_variance", test_akf_variance)
      call test("paper_adaptive_other_series", test_akf_bounded)
      call test("robust", test_robust)
      call test("letters", test_letters)
      call test("white_model", test_white)
      call test("drift_with_jumping_noise", test_jump)
      call test("identified_by_likelihood", test_identified)
      call test("unstable_model", test_unstable)
      call test("unstable_by_hand", test_unstable_by_hand)
      call test("refused", test_refused)
   end subroutine suite_design

   !> The AR(p) model of a series; variance of its differences
   subroutine fit(z, order, model, difference_variance)
      real(dp), intent(in), contiguous :: z(:)
      integer, intent(in) :: order
      type(ar_model_type), intent(out) :: model
      real(dp), intent(out) :: difference_variance

      call fit_ar(z, ar_options(order=order), model, failure)
      difference_variance = sum((z(2:) - z(:size(z) - 1))**2)/(size(z) - 1)
   end subroutine fit

   !> Q the noise variance, R the variance times the factor, the state stationary; the two gains of Table II
   subroutine test_kf()
      type(ar_model_type) :: model
      type(design_options) :: options
      type(filter_type) :: filter

      model%order = 1
      model%coefficient = [paper_phi]
      model%variance = 5.24e-4_dp
      model%noise_variance = model%variance*(1 - paper_phi**2)
      call design_kf(model, options, filter, failure)
      call check(error, filter%steady_gain(1), 0.4770139142617331_dp, thr=1.0e-12_dp)
      call check(error, filter%p(1, 1), model%variance, thr=1.0e-14_dp, rel=.true.)
      options%r_factor = 9.83897838_dp
      call design_kf(model, options, filter, failure)
      call check(error, filter%steady_gain(1), 0.09074925663875474_dp, thr=1.0e-10_dp)
      call check(error,.not. filter%adaptive, "the fixed filter adapts")
   end subroutine test_kf

   !> Q0 = sigma_a^2, R0 = P0 = Var(z), x0 = 0, Q and R, b = 0.98, the printed posterior
   subroutine test_akf_start()
      type(ar_model_type) :: model
      type(filter_type) :: filter

      model%order = 2
      model%coefficient = [0.4_dp, 0.1_dp]
      model%variance = 2
      model%noise_variance = 1.5_dp
      call design_akf(model, 1.0_dp, design_options(), filter, failure)
      if (went_wrong(failure, "the filter is not made")) return
      call check(error, sum(abs([filter%q - 1.5_dp, filter%r - 2, filter%p(1, 1) - 2, filter%p(2, 2) - 2, &
                                 filter%p(1, 2), &
                                 filter%x, filter%options%forgetting - 0.98_dp])), 0.0_dp)
      associate (options => filter%options)
         call check(error, options%estimate_process_variance .and. options%estimate_measurement_variance, "not Q and R")
         call check(error, .not. (options%estimate_process_mean .or. options%estimate_measurement_mean))
         call check(error, options%measurement_form, "paper")
      end associate
   end subroutine test_akf_start

   !> The paper's record: of 5.2e-4 a few 1e-5 are left (3.1e-5 ... 3.5e-5 over fifty records), no step at a bound
   subroutine test_akf_variance()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(12000), x(12000), differences
      integer :: seed

      do seed = 1, 8
         call make_series(seed, paper_phi, 5.24e-4_dp, 0.0_dp, z)
         call fit(z, 1, model, differences)
         call design_akf(model, differences, design_options(), filter, failure)
         call filter_series(filter, z, x, result, failure)
         call check(error, result%variance/model%variance, 0.0625_dp, thr=0.006_dp)
         call check(error, result%clamped, 0_int64)
         call check(error, result%gain, 0.175_dp, thr=0.015_dp)
      end do
   end subroutine test_akf_variance

   !> White noise, slow and alternating AR(1), a random walk; orders 1 and 3; three b; Q and R or all four:
   !> never diverging, never collapsed
   subroutine test_akf_bounded()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(6000), x(6000), differences, phi(4), b(3)
      integer :: i, j, order

      phi = [0.0_dp, 0.99_dp, -0.5_dp, 0.99999_dp]
      b = [0.95_dp, 0.98_dp, 0.999_dp]
      do i = 1, size(phi)
         call make_series(90 + i, phi(i), 1.0_dp, 0.05_dp, z)
         do order = 1, 3, 2
            call fit(z, order, model, differences)
            do j = 1, 2*size(b)                              ! Q and R, then all four
               call design_akf(model, differences, design_options(forgetting=b(mod(j - 1, 3) + 1), &
                               estimate=merge("QR  ", "qrQR", j <= size(b))), filter, failure)
               call filter_series(filter, z, x, result, failure)
               if (went_wrong(failure, "no result")) return
               call check(error, result%variance < 1.1_dp*model%variance, "diverged")
               call check(error, result%gain > 0.01_dp, "collapsed")
            end do
         end do
      end do
   end subroutine test_akf_bounded

   !> R alone on the paper's record: R falls towards zero and the series passes, because it holds no white noise
   subroutine test_robust()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(12000), x(12000), differences

      call make_series(95, paper_phi, 5.24e-4_dp, 0.0_dp, z)
      call fit(z, 1, model, differences)
      call design_akf(model, differences, design_options(akf="robust"), filter, failure)
      call check(error, filter%wait >= 20 .and. filter%options%huber > 2.4_dp, "no burn-in or no gate")
      call check(error, filter%r_bounds(2), 50*differences, thr=1.0e-12_dp, rel=.true.)
      call filter_series(filter, z, x, result, failure)
      if (unmet(size(result%estimate), 1)) return
      call check(error, result%variance > 0.85_dp*model%variance, "the series does not pass")
      call check(error, result%gain > 0.93_dp, "the gain is not near 1")
   end subroutine test_robust

   !> Any subset, in any order
   subroutine test_letters()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      real(dp) :: z(500), differences

      call fill_noise(96, z)
      call fit(z, 1, model, differences)
      call design_akf(model, differences, design_options(estimate="RqrQ"), filter, failure)
      call check(error, filter%options%estimate_process_mean .and. filter%options%estimate_measurement_mean &
                 .and. filter%options%estimate_process_variance .and. filter%options%estimate_measurement_variance, &
                 "not all four")
      call design_akf(model, differences, design_options(estimate="Q"), filter, failure)
      call check(error, filter%options%estimate_process_variance .and. .not. filter%options%estimate_measurement_variance, &
                 "not Q alone")
      call design_akf(model, differences, design_options(estimate="none"), filter, failure)
      call check(error, .not. filter%adaptive)
      call design_akf(model, differences, design_options(estimate="QX"), filter, failure)
      if (unmet(allocated(failure), "X is not a letter")) return
      call check(error, index(failure%message, "'X'") > 0, "the letter is not named")
   end subroutine test_letters

   !> Order 0: half of the series, the limit of a small coefficient, and a sentence about it
   subroutine test_white()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      type(filter_result_type) :: result
      real(dp) :: z(2000), x(2000), differences

      call fill_noise(97, z)
      call fit(z, 0, model, differences)
      call design_kf(model, design_options(), filter, failure)
      if (went_wrong(failure, "order 0 is refused")) return
      call filter_series(filter, z, x, result, failure)
      call check(error, result%gain, 0.5_dp, thr=1.0e-12_dp)
      if (unmet(size(result%warnings) > 0, "no warning")) return
      call design_akf(model, differences, design_options(), filter, failure)
      call filter_series(filter, z, x, result, failure)
      call check(error, result%variance < 0.2_dp .and. result%gain > 0.05_dp, "the adaptive filter is not bounded")
   end subroutine test_white

   !> White noise three times as large in the middle third: the adaptive filter within 1.05 of the one that knows when
   subroutine test_jump()
      type(drift_identification_type) :: model
      type(drift_filter_type) :: filter
      real(dp) :: z(12000), x(12000), drift(12000), best, p, k
      integer :: i

      call make_series(99, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
      z(4001:8000) = drift(4001:8000) + 3*(z(4001:8000) - drift(4001:8000))
      p = 1.0e-4_dp
      x = 0
      do i = 1, size(z)
         p = 0.9604_dp*p + 1.0e-4_dp*0.0396_dp
         k = p/(p + merge(9, 1, i > 4000 .and. i <= 8000)*4.2e-4_dp)
         p = (1 - k)*p
         x(i) = 0.98_dp*x(max(1, i - 1))
         x(i) = x(i) + k*(z(i) - x(i))
      end do
      best = norm2(x - drift)
      call identify_drift_model(z, drift_identification_options(), model, failure)
      call design_drift_akf(model, sum((z(2:) - z(:11999))**2)/11999, drift_options(), filter, failure)
      call run_filter(filter, z, x)
      call check(error, norm2(x - drift) <= 1.05_dp*best, "R is not followed")
   end subroutine test_jump

   !> Identified from the record itself, against the filter that knows the truth, also from R wrong by 1e-3 and 1e3; what the
   !> adaptive filter is made of
   subroutine test_identified()
      type(drift_identification_type) :: found, wrong
      type(filter_options) :: options
      type(filter_type) :: ideal
      type(drift_filter_type) :: filter
      real(dp) :: z(12000), x(12000), drift(12000), best, differences
      integer :: power

      call make_series(98, 0.98_dp, 1.0e-4_dp, 4.2e-4_dp, z, drift)
      call new_filter(ideal, [0.98_dp], 1.0e-4_dp*0.0396_dp, 4.2e-4_dp, filter_options(), failure)
      call run_filter(ideal, z, x)
      best = norm2(x - drift)
      call design_drift_kf(found, filter, failure)
      if (unmet(allocated(failure), "a drift that was not found is filtered")) return
      call identify_drift_model(z, drift_identification_options(), found, failure)
      call check(error, found%found, "the drift is not found")
      call design_drift_kf(found, filter, failure)
      call run_filter(filter, z, x)
      call check(error, norm2(x - drift) <= 1.02_dp*best, "the fixed filter")
      call check(error, filter%model%count == found%model%count .and. .not. filter%adaptive, "another model is filtered")
      differences = sum((z(2:) - z(:11999))**2)/11999
      do power = -3, 3, 3
         wrong = found
         wrong%model%r = found%model%r*10.0_dp**power
         call design_drift_akf(wrong, differences, drift_options(), filter, failure)
         call check(error, filter%wait >= 20 .and. filter%wait <= 1200, "the burn-in takes more than a tenth")
         call run_filter(filter, z, x)
         call check(error, norm2(x - drift) <= 1.07_dp*best, "the adaptive filter")
      end do
      options = adaptive_drift(drift_options(), 0.5_dp*differences)
      call check(error, filter%r_bounds(1), 0.5_dp*differences*options%r_lower, thr=1.0e-12_dp, rel=.true.)
      found%found = .false.
      call design_drift_akf(found, differences, drift_options(), filter, failure)
      call check_refused(failure, status%invalid_argument)
   end subroutine test_identified

   subroutine test_refused()
      type(ar_model_type) :: model
      type(drift_identification_type) :: drift
      type(filter_type) :: filter
      type(drift_filter_type) :: drift_filter
      real(dp) :: z(500), differences

      call design_kf(model, design_options(), filter, failure)
      if (unmet(allocated(failure), "an empty model")) return
      call fill_noise(100, z)
      call fit(z, 1, model, differences)
      call design_kf(model, design_options(r_factor=0.0_dp), filter, failure)
      if (unmet(allocated(failure), "r_factor = 0")) return
      call design_akf(model, differences, design_options(akf="other"), filter, failure)
      call check_refused(failure, status%invalid_argument)
      call design_drift_kf(drift, drift_filter, failure)
      if (unmet(allocated(failure), "no drift was found")) return
      model%variance = 0
      call design_kf(model, design_options(), filter, failure)
      call check(error, failure%code, status%constant_input)
   end subroutine test_refused

   !> Least squares of a growing series gives a model that grows: no filter is made of it, and the message says so
   subroutine test_unstable()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      real(dp) :: z(400)
      integer :: i

      call fill_noise(101, z)
      do i = 2, size(z)
         z(i) = z(i) + 1.02_dp*z(i - 1)
      end do
      do i = 1, 2
         call fit_ar(z, ar_options(method="ols", order=i), model, failure)
         if (unmet(.not. allocated(failure) .and. .not. model%stationary, "least squares does not grow")) return
         call design_kf(model, design_options(), filter, failure)
         call check_unstable(failure)
         call design_akf(model, 0.0_dp, design_options(), filter, failure)
         call check_unstable(failure)
      end do
   end subroutine test_unstable

   !> Coefficients set by hand: at the unit circle and beyond, order 1 and 2
   subroutine test_unstable_by_hand()
      type(ar_model_type) :: model
      type(filter_type) :: filter
      real(dp), parameter :: phi(2, 4) = reshape([1.0_dp, 0.0_dp, -1.0_dp, 0.0_dp, 1.5_dp, -0.4_dp, 0.3_dp, 0.8_dp], [2, 4])
      integer :: i

      model%variance = 1.0_dp
      model%noise_variance = 0.5_dp
      do i = 1, 4
         model%coefficient = phi(:merge(1, 2, i <= 2), i)
         call design_kf(model, design_options(), filter, failure)
         call check_unstable(failure)
         call design_akf(model, 1.0_dp, design_options(), filter, failure)
         call check_unstable(failure)
      end do
   end subroutine test_unstable_by_hand

   !> Refused as not stationary, in words
   subroutine check_unstable(failure)
      type(gyro_error), allocatable, intent(in) :: failure

      call check_refused(failure, status%unstable)
      call check(error, index(failure%message, "stationary") > 0, "the message does not say why: "//failure%message)
   end subroutine check_unstable
end module test_design
