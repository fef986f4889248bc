! SPDX-License-Identifier: MIT
!> Tests of the AR models and their criteria. The reference values were computed in exact arithmetic
!> from the doubles of the series (series_library, 1000 samples each) and rounded once.
module test_ar
   use expectations, only : agree, unmet, problem, test, error, check, check_refused, went_wrong
   use ar_reference, only : levinson_variance
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status
   use gyroakf_ar_ar_types, only : ar_order_type, best_order, criterion_number, order_criteria
   use gyroakf_ar_model, only : ar_model_type, ar_options, fit_ar
   use series_library, only : reference_series, reference_names
   implicit none (type, external)
   private
   public :: suite_ar

   real(dp), parameter :: tolerance = 1.0e-12_dp
   character(4), parameter :: methods(3) = [character(4) :: "yw", "burg", "ols"]
   real(dp), parameter :: log_two_pi = 1.8378770664093454836_dp
   !> AR(4) coefficients in the order of reference_names
   real(dp), parameter :: phi_of(4,11) = reshape([ &
      & 0.014031865371987869_dp, -0.01696405311967785_dp, 0.024724305676162142_dp, -0.070684453036034_dp, &
      & -0.01883106407305559_dp, 0.03694890226454784_dp, -0.03378714113332833_dp, -0.009915401759923986_dp, &
      & -0.026072361007196093_dp, 0.017087589526449152_dp, -0.001554635555260534_dp, 0.03072604039575598_dp, &
      & 1.0025128110895654_dp, -0.028204086151826846_dp, 0.04217804219921374_dp, -0.0254937868087086_dp, &
      & 0.7093401118762808_dp, -0.025395087432703044_dp, 0.035544369426706905_dp, -0.07275282057418453_dp, &
      & 0.99499585541266_dp, -0.03003989134979369_dp, 0.044511843420024975_dp, -0.04076922295350688_dp, &
      & 1.2083325695060736_dp, -0.5277185544985515_dp, 0.047778498264502325_dp, -0.06085193543110148_dp, &
      & 0.1657790821380841_dp, 0.13523142388895354_dp, 0.17566893329043276_dp, 0.07928396269951754_dp, &
      & 0.7202276590036978_dp, -0.022293583499174638_dp, 0.038684281654896166_dp, -0.06235416752179739_dp, &
      & 0.7093401119057335_dp, -0.025395087474750555_dp, 0.03554436939447533_dp, -0.07275282051907968_dp, &
      & 0.048787379869141174_dp, 0.01221372604674299_dp, 0.046175075232779715_dp, -0.0601191610505398_dp], [4, 11])

contains

   subroutine suite_ar()
      call test("paper_table_1", test_paper_table_1)
      call test("criteria_by_hand", test_criteria_by_hand)
      call test("best_order", test_best_order)
      call test("reference", test_reference)
      call test("standard_errors", test_standard_errors)
      call test("choice", test_choice)
      call test("offset_scale", test_offset_scale)
      call test("large_offset", test_large_offset)
      call test("threads", test_threads)
      call test("residuals", test_residuals)
      call test("missing", test_missing)
      call test("order_zero", test_order_zero)
      call test("failures", test_failures)
      call test("failures_ols", test_failures_ols)
   end subroutine suite_ar

   !> The paper's record: variance 5.24e-4, AR(1) with 0.409975, 12 000 samples. Per observation -4.9000,
   !> -4.8998, -4.8997 for the orders 1, 2, 3 (the paper prints -4.8930 for the first).
   subroutine test_paper_table_1()
      type(ar_order_type) :: line
      real(dp), parameter :: expected(3) = [-4.9000_dp, -4.8998_dp, -4.8997_dp]
      integer :: p

      do p = 1, 3
         line = order_criteria(p, 5.24e-4_dp*(1.0_dp - 0.409975_dp**2), 12000_int64)
         call check(error, line%aic_per_observation, expected(p), thr=5.0e-5_dp)
      end do
   end subroutine test_paper_table_1

   !> s2 = 1, n = 100, p = 2: k = 3, -2 ln L = 100 (1 + ln 2 pi).
   subroutine test_criteria_by_hand()
      type(ar_order_type) :: line
      real(dp) :: l

      line = order_criteria(2, 1.0_dp, 100_int64)
      l = 100.0_dp*(1.0_dp + log_two_pi)
      call check(error, line%aic, l + 8.0_dp, thr=tolerance, rel=.true.)
      call check(error, line%aicc, l + 800.0_dp/95.0_dp, thr=tolerance, rel=.true.)
      call check(error, line%bic, l + 4.0_dp*log(100.0_dp), thr=tolerance, rel=.true.)
      call check(error, line%hqic, l + 8.0_dp*log(log(100.0_dp)), thr=tolerance, rel=.true.)
      call check(error, line%fpe, 103.0_dp/97.0_dp, thr=tolerance)
      call check(error, line%aic_per_observation, 1.0_dp + log_two_pi + 0.04_dp, thr=tolerance)
   end subroutine test_criteria_by_hand

   !> The smallest value wins, of equal ones the smaller order.
   subroutine test_best_order()
      character(4), parameter :: name(5) = [character(4) :: "aic", "aicc", "bic", "hqic", "fpe"]
      type(ar_order_type) :: table(4)
      integer :: i

      table = order_criteria([0, 1, 2, 3], [2.0_dp, 1.0_dp, 1.0_dp, 0.995_dp], 100_int64)
      do i = 1, 5
         call check(error, criterion_number(trim(name(i))), i)
         call check(error, best_order(table, i), 1)
      end do
      table(3)%aic = table(2)%aic
      call check(error, best_order(table, 1), 1)
   end subroutine test_best_order

   !> Coefficients, variance and criteria of the eleven series.
   subroutine test_reference()
      type(ar_model_type) :: model
      type(ar_order_type) :: expected(0:6)
      integer :: i, p

      do i = 1, size(reference_names)
         expected = order_criteria([(p, p=0, 6)], levinson_variance(:, i), 1000_int64)
         call fit_ar(reference_series(trim(reference_names(i)), 1000), ar_options(order=4, max_order=6), model, problem)
         if (went_wrong(problem, reference_names(i))) return
         call check(error, maxval(abs(model%coefficient - phi_of(:, i))), 0.0_dp, reference_names(i), thr=tolerance)
         call agree([model%noise_variance], levinson_variance(4:4, i), tolerance, &
            & reference_names(i))
         call agree(model%table%aic, expected%aic, tolerance, reference_names(i))
         call agree(model%table%bic, expected%bic, tolerance, reference_names(i))
      end do
   end subroutine test_reference

   !> AR(1): sqrt((1 - phi^2)/n); AR(2): both sqrt((1 - phi_2^2)/n).
   subroutine test_standard_errors()
      type(ar_model_type) :: model
      integer :: i

      do i = 1, 2
         call fit_ar(reference_series("ar1", 1000), ar_options(method=methods(i), order=1), model, &
            & problem)
         if (went_wrong(problem)) return
         call check(error, model%std_error(1), sqrt((1.0_dp - model%coefficient(1)**2)/1000.0_dp), thr=tolerance)
      end do
      call fit_ar(reference_series("ar2", 1000), ar_options(order=2), model, problem)
      call check(error, maxval(abs(model%std_error - sqrt((1.0_dp - model%coefficient(2)**2)/1000.0_dp))), 0.0_dp, thr=tolerance)
   end subroutine test_standard_errors

   !> BIC finds the orders 1 and 2; AIC goes to the largest order of 6, and says so.
   subroutine test_choice()
      type(ar_model_type) :: model
      integer :: i

      do i = 1, 2
         call fit_ar(reference_series(merge("ar1", "ar2", i == 1), 1000), ar_options(criterion="bic", max_order=6), model, problem)
         if (went_wrong(problem)) return
         call check(error, model%order, i)
         call check(error, .not. model%largest_order_chosen, "BIC did not choose the largest")
         call fit_ar(reference_series(merge("ar1", "ar2", i == 1), 1000), ar_options(max_order=6), model, problem)
         call check(error, model%order == 6 .and. model%largest_order_chosen, "AIC chooses 6 of 6")
      end do
      call check(error, size(model%table) == 7 .and. model%table(1)%order == 0, "the table begins with order 0")
   end subroutine test_choice

   !> Offset 2^40 and scale 2^-50, exact for multiples of 1/1024, by every method, short and long.
   subroutine test_offset_scale()
      integer, parameter :: length(2) = [6000, 40000]
      type(ar_model_type) :: a, b
      real(dp), allocatable :: x(:)
      integer :: i, k

      do k = 1, size(length)
         x = anint(1024.0_dp*reference_series("ar2", length(k)))/1024.0_dp
         do i = 1, size(methods)
            call fit_ar(x, ar_options(method=methods(i), max_order=5), a, problem)
            call fit_ar((x + 2.0_dp**40)*2.0_dp**(-50), &
               & ar_options(method=methods(i), max_order=5), b, problem)
            if (went_wrong(problem)) return
            call check(error, a%order, b%order, methods(i))
            call check(error, maxval(abs(a%coefficient - b%coefficient)), 0.0_dp, methods(i), &
               & thr=tolerance)
            call check(error, maxval(abs(a%std_error - b%std_error)), 0.0_dp, methods(i), &
               & thr=tolerance)
            call agree([b%noise_variance, b%residual_variance]*2.0_dp**100, &
                       [a%noise_variance, a%residual_variance], tolerance, methods(i))
            call agree([b%residual_ljung_box%statistic, b%residual_normality%statistic], &
                       [a%residual_ljung_box%statistic, a%residual_normality%statistic], &
                          & 1.0e-10_dp, methods(i))
         end do
      end do
   end subroutine test_offset_scale

   !> A signal of 1e-3 on 1e6: rounding of the samples, 1e-10, is 1e-7 of it.
   subroutine test_large_offset()
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

   !> One thread and two, with gaps too.
   subroutine test_threads()
      character(4), parameter :: series(4) = [character(4) :: "ar2", "ar2", "rw", "ar2"]
      integer, parameter :: method(4) = [2, 2, 2, 3]
      logical, parameter :: gaps(4) = [.false., .true., .false., .true.]
      type(ar_model_type) :: model(2)
      type(ar_options) :: options
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: before, i, k

      before = thread_count()
      do k = 1, size(method)
         options = ar_options(method=methods(method(k)), order=4, max_order=4)
         x = reference_series(trim(series(k)), 120000)
         valid = [(merge(0_int8, 1_int8, gaps(k) .and. modulo(i, 997) == 5), i=1, size(x))]
         do i = 1, 2
            call set_thread_count(i)
            if (gaps(k)) call fit_ar(x, options, model(i), problem, valid)
            if (.not. gaps(k)) call fit_ar(x, options, model(i), problem)
            if (allocated(problem)) exit
         end do
         call set_thread_count(before)
         if (went_wrong(problem)) return
         call check(error, maxval(abs(model(1)%coefficient - model(2)%coefficient)), 0.0_dp, thr=tolerance)
         call check(error, model(1)%residual_normality%statistic, &
            & model(2)%residual_normality%statistic, &
                    thr=1.0e-10_dp, rel=.true.)
      end do
   end subroutine test_threads

   !> White with the right order, not with one too small; 20 lags, order subtracted.
   subroutine test_residuals()
      type(ar_model_type) :: model

      call fit_ar(reference_series("ar2", 5000), ar_options(order=2), model, problem)
      if (went_wrong(problem)) return
      call check(error, model%residual_ljung_box%lags == 20 .and. model%residual_ljung_box%fitted == 2, "degrees of freedom")
      call check(error, model%residual_ljung_box%p_value > 0.01_dp, "residuals of AR(2) are white")
      call fit_ar(reference_series("ar2", 5000), ar_options(order=1), model, problem)
      call check(error, model%residual_ljung_box%p_value < 1.0e-10_dp, "residuals of AR(1) are not")
      call fit_ar(reference_series("ar2", 5000), ar_options(order=30), model, problem)
      call check(error, model%residual_ljung_box%lags, 50)
   end subroutine test_residuals

   !> 5 % and 40 % lost: phi within three standard errors of the whole series' (more as samples go).
   subroutine test_missing()
      type(ar_model_type) :: whole, model
      real(dp), allocatable :: x(:)
      integer(int8), allocatable :: valid(:)
      integer :: i

      x = reference_series("ar2", 20000)
      call fit_ar(x, ar_options(order=2), whole, problem)
      do i = 1, 2
         valid = merge(0_int8, 1_int8, cshift(reference_series("unif", 20000), 10000) < merge(0.05_dp, 0.4_dp, i == 1))
         where (valid == 0_int8) x = 1.0e7_dp
         call fit_ar(x, ar_options(order=2), model, problem, valid)
         if (went_wrong(problem)) return
         call check(error, all(abs(model%coefficient - whole%coefficient) < 3.0_dp*model%std_error), "coefficients")
         call check(error, model%std_error(1)/whole%std_error(1), merge(1.0_dp/0.95_dp, 1.0_dp/0.6_dp, i == 1), &
            & "standard errors grow with the pairs that are lost", thr=0.02_dp, rel=.true.)
         call check(error, model%samples == count(valid == 1_int8, kind=int64), "samples")
         call check(error, model%residual_ljung_box%p_value > 0.001_dp, "residuals")
      end do
   end subroutine test_missing

   !> Order 0: the mean and the variance.
   subroutine test_order_zero()
      type(ar_model_type) :: model
      integer :: i

      do i = 1, size(methods)
         call fit_ar([1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp], &
            & ar_options(method=methods(i), order=0, max_order=0), model, problem)
         if (went_wrong(problem, methods(i))) return
         if (unmet(size(model%coefficient) + size(model%std_error) + size(model%root), 0, &
            & methods(i))) return
         call agree([model%noise_variance, model%residual_variance, model%mean, model%intercept], &
                    [1.25_dp, 1.25_dp, 2.5_dp, 2.5_dp], tolerance, methods(i))
         call check(error, .not. model%largest_order_chosen, "there was nothing to choose")
      end do
   end subroutine test_order_zero

   !> Each error; the only pair of neighbors that gaps leave can be worth more than the variance.
   subroutine test_failures()
      real(dp) :: x(30)
      integer(int8) :: valid(30)
      integer :: i

      do i = 1, size(methods)
         call refused(spread(0.1_dp, 1, 30), ar_options(method=methods(i)), status%constant_input)
      end do
      x = reference_series("wn", 30)
      valid = 0_int8
      valid(1:5) = 1_int8
      call refused(x, ar_options(method="best"), status%invalid_argument)
      call refused(x, ar_options(criterion="best"), status%invalid_argument)
      call refused(x, ar_options(max_order=-1), status%invalid_argument)
      call refused(x, ar_options(max_order=27), status%too_few_samples)
      call refused(x, ar_options(max_order=2), status%too_few_samples, valid)
      call refused(x, ar_options(method="burg"), status%too_few_samples, valid)
      x = 0.0_dp
      x(1:2) = 10.0_dp
      valid = [(int(1 - mod(i, 2), int8), i=1, 30)]
      valid(1) = 1_int8
      call refused(x, ar_options(), status%singular, valid)
      x = reference_series("wn", 30)
      valid(1) = 0_int8                                                ! every other sample: no pair at an odd lag
      call refused(x, ar_options(order=2), status%too_few_samples, valid)
      call refused(x, ar_options(method="burg"), status%too_few_samples, valid)
      x = [(real(modulo(i, 2), dp), i=1, 30)]
      call refused(x, ar_options(method="burg"), status%singular)
   end subroutine test_failures

   !> Least squares: a line, a sinusoid without noise; too few rows.
   subroutine test_failures_ols()
      type(ar_options) :: options
      real(dp) :: x(60)
      integer(int8) :: valid(60)
      integer :: t

      options%method = "ols"
      call refused([(sin(2.0_dp*acos(-1.0_dp)*real(t, dp)/20.0_dp), t=1, 60)], options, &
         & status%singular)
      call refused([(real(2*t, dp) - 7.0_dp, t=1, 60)], options, status%singular)
      x = reference_series("wn", 60)
      valid = [(merge(0_int8, 1_int8, modulo(t, 4) == 0), t=1, 60)]
      call refused(x, options, status%too_few_samples, valid)
      call refused(x(1:9), options, status%too_few_samples)
   end subroutine test_failures_ols

   !> Fails unless the fit is refused with the code.
   subroutine refused(x, options, code, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(ar_options), intent(in) :: options
      integer, intent(in) :: code
      integer(int8), intent(in), optional :: valid(:)
      type(ar_model_type) :: model

      call fit_ar(x, options, model, problem, valid)
      call check_refused(problem, code)
   end subroutine refused

end module test_ar
