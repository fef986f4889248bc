! SPDX-License-Identifier: MIT
!> Tests of AR models by least squares (ols).
module test_least_squares
   use expectations, only : unmet, problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_lapack, only : dgels
   use gyroakf_ar_ar_types, only : ar_order_type, order_criteria
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use ar_reference, only : ols_common, ols_errors, ols_parameters, ols_variance
   use series_library, only : reference_series, reference_names
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
      call test("gaps_dense", test_gaps_dense)
      call test("unstable", test_unstable)
      call test("sinusoid", test_sinusoid)
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
      type(ar_order_type) :: expected
      integer :: i, p

      do i = 1, size(reference_names)
         do p = 1, 6
            call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(method="ols", order=p, max_order=p), &
               & model, problem)
            expected = order_criteria(p, ols_variance(p, i), int(1000 - p, int64))
            associate (line => model%table(p + 1))
               call check(error, maxval(abs([line%aic, line%aicc, line%bic, line%hqic, line%fpe]/ &
                  & [expected%aic, expected%aicc, expected%bic, expected%hqic, &
                  & expected%fpe] - 1.0_dp)), 0.0_dp, &
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

end module test_least_squares
