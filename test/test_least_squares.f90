! SPDX-License-Identifier: MIT
!> Tests of AR models by least squares (ols).
module test_least_squares
   use expectations, only : unmet, problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_lapack, only : dgels
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use ar_reference, only : ols_common, ols_criteria, ols_errors, ols_parameters, ols_variance
   use series_library, only : reference_series, reference_names
   use gyroakf_threads, only : thread_count, set_thread_count
   implicit none (type, external)
   private
   public :: suite_least_squares

   real(dp), parameter :: tolerance = 1.0e-12_dp

contains

   subroutine suite_least_squares()
      call test("by_hand", test_by_hand)
      call test("reference_ols", test_reference_ols)
      call test("criteria", test_criteria)
      call test("common_rows", test_common_rows)
      call test("long_reference", test_long_reference)
      call test("offset_scale", test_offset_scale)
      call test("large_offset", test_large_offset)
      call test("gaps_dense", test_gaps_dense)
      call test("threads", test_threads)
      call test("unstable", test_unstable)
      call test("sinusoid", test_sinusoid)
      call test("order_zero", test_order_zero)
      call test("failures", test_failures)
   end subroutine suite_least_squares

   !> (1, 0, 2, 0, 1) on (0, 1, 0, 2, 0): slope (0 - 5 0.6 0.8)/(5 - 5 0.36) = -3/4 through (0.6, 0.8).
   subroutine test_by_hand()
      type(ar_model_type) :: model

      call fit_ar([0.0_dp, 1.0_dp, 0.0_dp, 2.0_dp, 0.0_dp, 1.0_dp], ar_options(method="ols", max_order=1, order=1), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%coefficient(1), -0.75_dp, thr=tolerance)
      call check(error, model%intercept, 1.25_dp, thr=tolerance)
      call check(error, model%rows == 5 .and. model%compared_rows == 5, "rows")
      call check(error, model%unbiased_variance, model%noise_variance*5.0_dp/3.0_dp, thr=tolerance)
   end subroutine test_by_hand

   !> Intercept, coefficients, standard errors and variance of the orders 1 .. 6 of the eleven series.
   subroutine test_reference_ols()
      type(ar_model_type) :: model
      real(dp) :: expected(7), spread(7)
      integer :: i, p, k

      do i = 1, size(reference_names)
         do p = 1, 6
            call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(method="ols", order=p, max_order=6), &
               & model, problem)
            if (went_wrong(problem, reference_names(i))) return
            k = p*(p + 1)/2
            expected(:p + 1) = ols_parameters(k:k + p, i)
            spread(:p + 1) = ols_errors(k:k + p, i)*sqrt(real(999 - 2*p, dp)/real(1000 - p, dp))
            call check(error, maxval(abs(model%coefficient - expected(2:p + 1))), 0.0_dp, reference_names(i), thr=tolerance)
            call check(error, abs(model%intercept - expected(1))/max(abs(expected(1)), abs(model%mean)), 0.0_dp, &
               & reference_names(i), thr=tolerance)
            call check(error, maxval(abs(model%std_error/spread(2:p + 1) - 1.0_dp)), 0.0_dp, reference_names(i), thr=tolerance)
            call check(error, model%intercept_std_error, spread(1), reference_names(i), thr=tolerance, rel=.true.)
            call check(error, model%noise_variance, ols_variance(p, i), reference_names(i), thr=tolerance, rel=.true.)
         end do
      end do
   end subroutine test_reference_ols

   !> Criteria of every order on its own rows.
   subroutine test_criteria()
      type(ar_model_type) :: model
      real(dp) :: expected(5)
      integer :: i, p

      do i = 1, size(reference_names)
         do p = 1, 6
            call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(method="ols", order=p, max_order=p), &
               & model, problem)
            expected = ols_criteria(5*p - 4:5*p, i)
            associate (line => model%table(p + 1))
               call check(error, maxval(abs([line%aic, line%aicc, line%bic, line%hqic, line%fpe]/expected - 1.0_dp)), 0.0_dp, &
                  & reference_names(i), thr=1.0e-11_dp)
            end associate
         end do
      end do
   end subroutine test_criteria

   !> RSS of the orders 0 .. 12 on the rows that order 12 has.
   subroutine test_common_rows()
      type(ar_model_type) :: model
      integer :: i

      do i = 1, size(reference_names)
         call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(method="ols", max_order=12), model, problem)
         if (went_wrong(problem)) return
         call check(error, model%compared_rows == 988 .and. model%rows == 1000 - model%order, "rows")
         call check(error, maxval(abs(988.0_dp*model%table%noise_variance/ols_common(:, i) - 1.0_dp)), 0.0_dp, &
            & reference_names(i), thr=tolerance)
      end do
   end subroutine test_common_rows

   !> 12,000 samples of AR(2).
   subroutine test_long_reference()
      type(ar_model_type) :: model

      call fit_ar(reference_series("ar2", 12000), ar_options(method="ols", order=3), model, problem)
      if (went_wrong(problem)) return
      call check(error, maxval(abs([model%intercept, model%coefficient] - [-0.007209649564846636_dp, 1.1734540975554553_dp, &
         & -0.45248722180508255_dp, -0.02507909677464238_dp])), 0.0_dp, thr=tolerance)
      call check(error, model%noise_variance, 0.998474005145591_dp, thr=tolerance, rel=.true.)
      call check(error, model%table(4)%aic, 34037.689822748966_dp, thr=tolerance, rel=.true.)
   end subroutine test_long_reference

   !> Offset 2^40 and scale 2^-50, exact for multiples of 1/1024.
   subroutine test_offset_scale()
      type(ar_model_type) :: a, b
      real(dp), allocatable :: x(:)

      x = anint(1024.0_dp*reference_series("ar2", 6000))/1024.0_dp
      call fit_ar(x, ar_options(method="ols", max_order=5), a, problem)
      call fit_ar((x + 2.0_dp**40)*2.0_dp**(-50), ar_options(method="ols", max_order=5), b, problem)
      if (went_wrong(problem)) return
      call check(error, a%order, b%order)
      call check(error, maxval(abs(a%coefficient - b%coefficient)), 0.0_dp, thr=tolerance)
      call check(error, maxval(abs(a%std_error - b%std_error)), 0.0_dp, thr=tolerance)
      call check(error, b%noise_variance*2.0_dp**100, a%noise_variance, thr=tolerance, rel=.true.)
      call check(error, b%residual_normality%statistic, a%residual_normality%statistic, thr=1.0e-10_dp, rel=.true.)
   end subroutine test_offset_scale

   !> A signal of 1e-3 on 1e6: rounding of the samples, 1e-10, is 1e-7 of it.
   subroutine test_large_offset()
      character(4), parameter :: methods(3) = [character(4) :: "yw", "burg", "ols"]
      type(ar_model_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: i

      x = 1.0e-3_dp*reference_series("ar1", 2000)
      do i = 1, size(methods)
         call fit_ar(x, ar_options(method=methods(i), max_order=5), a, problem)
         call fit_ar(x + 1.0e6_dp, ar_options(method=methods(i), max_order=5), b, problem)
         if (went_wrong(problem)) return
         call check(error, a%order, b%order)
         call check(error, maxval(abs(a%coefficient - b%coefficient)), 0.0_dp, thr=1.0e-7_dp)
      end do
   end subroutine test_large_offset

   !> Complete rows gathered into a matrix and solved by QR factors.
   subroutine test_gaps_dense()
      integer, parameter :: p = 3
      real(dp) :: x(800), a(800, p + 1), y(800, 1), work(4000), mean
      integer(int8) :: valid(800)
      type(ar_model_type) :: model
      integer :: t, m, info

      x = reference_series("ar2", 800) + 5.0_dp
      valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 800), 50) < 0.1_dp)
      mean = sum(x, valid == 1_int8)/real(count(valid == 1_int8), dp)
      m = 0
      do t = p + 1, 800
         if (any(valid(t - p:t) == 0_int8)) cycle
         m = m + 1
         a(m, :) = [x(t - 1:t - p:-1) - mean, 1.0_dp]
         y(m, 1) = x(t) - mean
      end do
      call dgels("N", m, p + 1, 1, a, 800, y, 800, work, size(work), info)
      call fit_ar(merge(x, 1.0e6_dp, valid == 1_int8), ar_options(method="ols", order=p, max_order=5), model, problem, valid)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(model%coefficient - y(:p, 1))), 0.0_dp, thr=tolerance)
      call check(error, model%noise_variance, sum(y(p + 2:m, 1)**2)/real(m, dp), thr=tolerance, rel=.true.)
      call check(error, model%rows == m .and. model%compared_rows < model%rows, "rows")
   end subroutine test_gaps_dense

   !> One thread and two, with gaps.
   subroutine test_threads()
      type(ar_model_type) :: model(2)
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i, before

      x = reference_series("ar2", 120000)
      valid = [(merge(0_int8, 1_int8, modulo(i, 997) == 5), i=1, 120000)]
      before = thread_count()
      do i = 1, 2
         call set_thread_count(i)
         call fit_ar(x, ar_options(method="ols", order=4, max_order=6), model(i), problem, valid)
      end do
      call set_thread_count(before)
      if (went_wrong(problem)) return
      call check(error, maxval(abs(model(1)%coefficient - model(2)%coefficient)), 0.0_dp, thr=tolerance)
   end subroutine test_threads

   !> A series that grows: least squares says so, yw and burg cannot.
   subroutine test_unstable()
      type(ar_model_type) :: model
      real(dp) :: x(200)
      integer :: t

      x = reference_series("wn", 200)
      do t = 2, 200
         x(t) = x(t) + 1.05_dp*x(t - 1)
      end do
      call fit_ar(x, ar_options(method="ols", order=1), model, problem)
      if (unmet(.not. allocated(problem) .and. .not. model%stationary, "it grows")) return
      call check(error, model%root(1)%modulus, 1.05_dp, thr=1.0e-3_dp)
      call fit_ar(x, ar_options(method="burg", order=1), model, problem)
      call check(error, .not. allocated(problem) .and. model%stationary, "burg")
   end subroutine test_unstable

   !> A cycle of 20 samples, phase 45 degrees, a little noise: ols finds the frequency, Burg's is shifted (Chen & Stegen,
   !> J. Geophys. Res. 79 (1974) 3019-3022).
   subroutine test_sinusoid()
      real(dp), parameter :: pi = acos(-1.0_dp)
      type(ar_model_type) :: model, burg
      real(dp) :: x(25)
      integer :: t

      x = [(sin(0.1_dp*pi*real(t, dp) + 0.25_dp*pi), t=1, 25)]
      x = x - sum(x)/25.0_dp + 1.0e-6_dp*reference_series("wn", 25)
      call fit_ar(x, ar_options(method="ols", order=2, max_order=2), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%root(1)%frequency, 0.05_dp, "ols", thr=1.0e-6_dp)
      x = [(sin(0.1_dp*pi*real(t, dp) + 0.25_dp*pi), t=1, 25)]
      x = [x(1:20) + 1.0e-6_dp*reference_series("wn", 20), x(21:25)]
      call fit_ar(x(1:20), ar_options(method="burg", order=2, max_order=2), burg, problem)
      call check(error, abs(burg%root(1)%frequency - 0.05_dp) > 1.0e-4_dp, "Burg's shift is gone")
      call check(error, burg%root(1)%frequency, 0.05_dp, "burg", thr=1.0e-2_dp)
   end subroutine test_sinusoid

   !> Order 0: mean and variance.
   subroutine test_order_zero()
      type(ar_model_type) :: model

      call fit_ar([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], ar_options(method="ols", order=0, max_order=0), model, problem)
      if (went_wrong(problem)) return
      if (unmet(size(model%coefficient) + size(model%root), 0)) return
      call check(error, model%noise_variance, 1.25_dp, thr=tolerance)
      call check(error, model%intercept, 2.5_dp, thr=tolerance)
   end subroutine test_order_zero

   !> A constant, a line, a sinusoid without noise; too few rows.
   subroutine test_failures()
      real(dp) :: x(60)
      integer(int8) :: valid(60)
      integer :: t

      x = 0.1_dp
      call refused(x, status%constant_input)
      x = [(sin(2.0_dp*acos(-1.0_dp)*real(t, dp)/20.0_dp), t=1, 60)]
      call refused(x, status%singular)
      x = reference_series("wn", 60)
      valid = [(merge(0_int8, 1_int8, modulo(t, 4) == 0), t=1, 60)]
      call refused(x, status%too_few_samples, valid)
      call refused(x(1:9), status%too_few_samples)
      x = [(real(2*t, dp) - 7.0_dp, t=1, 60)]
      call refused(x, status%singular)
   end subroutine test_failures

   !> Fails unless the fit is refused with the code.
   subroutine refused(x, code, valid)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Expected
      integer, intent(in) :: code
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      type(ar_model_type) :: model

      call fit_ar(x, ar_options(method="ols"), model, problem, valid)
      call check_refused(problem, code)
   end subroutine refused

end module test_least_squares
