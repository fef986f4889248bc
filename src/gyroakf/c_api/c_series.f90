! SPDX-License-Identifier: MIT
!> C interface, tests of stationarity (ADF, KPSS) and the AR model, as documented in
!> c_api/include/gyroakf.h.
module gyroakf_c_api_c_series
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_ptr, c_associated, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_c_api_c_host, only : check_aligned, check_apart, copy_out, progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, check_finite, open_options, open_series, take_text
   implicit none (type, external)
   private
   public :: gyroakf_adf_options_init, gyroakf_adf_test, adf_options_c, adf_c
   public :: gyroakf_kpss_options_init, gyroakf_kpss_test
   public :: gyroakf_ar_options_init, gyroakf_ar_fit, ar_options_c

   !> `gyroakf_adf_options`
   type, bind(C) :: adf_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: regression = c_null_ptr
      integer(c_int32_t) :: lags, max_lags
      type(c_ptr) :: criterion = c_null_ptr
      type(progress_c) :: progress
   end type adf_options_c

   !> `gyroakf_adf`
   type, bind(C) :: adf_c
      real(c_double) :: statistic, p_value, critical(3)
      integer(c_int32_t) :: lag
      integer(c_int64_t) :: observations
   end type adf_c

   !> `gyroakf_kpss_options`
   type, bind(C) :: kpss_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: regression = c_null_ptr, rule = c_null_ptr
      integer(c_int64_t) :: lags = -1
      type(progress_c) :: progress
   end type kpss_options_c

   !> `gyroakf_kpss`
   type, bind(C) :: kpss_c
      real(c_double) :: statistic, p_value, p_asymptotic, critical(4)
      real(c_double) :: variance, long_run_variance, drift
      integer(c_int64_t) :: lags, observations
      integer(c_int32_t) :: p_bound
   end type kpss_c

   !> Largest order that is compared
   integer, parameter :: largest_order = 1000

   !> `gyroakf_ar_options`
   type, bind(C) :: ar_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: method = c_null_ptr, criterion = c_null_ptr
      integer(c_int32_t) :: order
      type(progress_c) :: progress
   end type ar_options_c

contains

   subroutine gyroakf_adf_options_init(opt) bind(C)
      type(adf_options_c), intent(out), optional :: opt
      type(adf_options) :: defaults

      if (present(opt)) opt = adf_options_c(c_sizeof(opt), lags=int(defaults%lags, c_int32_t), &
         & max_lags=int(defaults%max_lags, c_int32_t))
   end subroutine gyroakf_adf_options_init

   integer(c_int) function gyroakf_adf_test(x, n, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(adf_options_c), intent(in), optional :: opt
      type(adf_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(adf_options) :: options
      type(adf_type) :: result

      call enter_library(c)
      call check_place(present(out), "result", c%error)
      call read_adf_options(options, c, opt)
      call open_series(x, n, c)
      if (ok(c)) call test_adf(c%x, options, result, c%error, c%valid, progress=c%callback)
      call check_finite([result%statistic, result%p_value], c%error)
      if (ok(c)) out = adf_c(result%statistic, result%p_value, &
         & result%critical, int(result%lag, c_int32_t), int(result%observations, c_int64_t))
      gyroakf_adf_test = leave_library(c, err)
   end function gyroakf_adf_test

   subroutine read_adf_options(options, c, opt)
      type(adf_options), intent(out) :: options
      type(call_type), intent(inout) :: c
      type(adf_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (.not. ok(c)) return
      call take_text(opt%regression, options%regression, c%error)
      call take_text(opt%criterion, options%criterion, c%error)
      options%lags = opt%lags
      options%max_lags = opt%max_lags
   end subroutine read_adf_options

   subroutine gyroakf_kpss_options_init(opt) bind(C)
      type(kpss_options_c), intent(out), optional :: opt

      if (present(opt)) opt = kpss_options_c(c_sizeof(opt))
   end subroutine gyroakf_kpss_options_init

   integer(c_int) function gyroakf_kpss_test(x, n, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(kpss_options_c), intent(in), optional :: opt
      type(kpss_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(kpss_options) :: options
      type(kpss_type) :: result

      call enter_library(c)
      call check_place(present(out), "result", c%error)
      call read_kpss_options(options, c, opt)
      call open_series(x, n, c)
      if (ok(c)) call test_kpss(c%x, options, result, c%error, c%valid, c%callback)
      call check_finite([result%statistic, result%p_value, result%p_asymptotic, result%variance, &
         & result%long_run_variance, result%drift], c%error)
      if (ok(c)) out = kpss_c(result%statistic, result%p_value, result%p_asymptotic, &
         & result%critical, result%variance, result%long_run_variance, result%drift, &
         & result%lags, result%observations, int(result%p_bound, c_int32_t))
      gyroakf_kpss_test = leave_library(c, err)
   end function gyroakf_kpss_test

   subroutine read_kpss_options(options, c, opt)
      type(kpss_options), intent(out) :: options
      type(call_type), intent(inout) :: c
      type(kpss_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (.not. ok(c)) return
      call take_text(opt%regression, options%regression, c%error)
      call take_text(opt%rule, options%rule, c%error)
      options%lags = opt%lags
   end subroutine read_kpss_options

   subroutine gyroakf_ar_options_init(opt) bind(C)
      type(ar_options_c), intent(out), optional :: opt
      type(ar_options) :: defaults

      if (present(opt)) opt = ar_options_c(c_sizeof(opt), order=int(defaults%order, c_int32_t))
   end subroutine gyroakf_ar_options_init

   integer(c_int) function gyroakf_ar_fit(x, n, opt, max_order, order, phi, noise_variance, &
      & mean, err) bind(C)
      type(c_ptr), intent(in), value :: x, phi
      integer(c_int64_t), intent(in), value :: n
      type(ar_options_c), intent(in), optional :: opt
      integer(c_int32_t), intent(in), value :: max_order
      integer(c_int32_t), intent(inout), optional :: order
      real(c_double), intent(inout), optional :: noise_variance, mean
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(ar_options) :: options
      type(ar_model_type) :: model

      call enter_library(c)
      call check_place(present(order), "order", c%error)
      call check_place(max_order == 0 .or. c_associated(phi), "coefficients", c%error)
      call check_aligned(phi, c%error)
      call read_ar_options(options, max_order, c, opt)
      call open_series(x, n, c)
      call check_apart([x, phi], 8*[n, int(max_order, c_int64_t)], c%error)
      if (ok(c)) call fit_ar(c%x, options, model, c%error, c%valid, progress=c%callback)
      if (ok(c)) call give_model(model, max_order, order, phi, c%error, noise_variance, mean)
      gyroakf_ar_fit = leave_library(c, err)
   end function gyroakf_ar_fit

   subroutine give_model(model, max_order, order, phi, error, noise_variance, mean)
      type(ar_model_type), intent(in) :: model
      integer(c_int32_t), intent(in) :: max_order
      integer(c_int32_t), intent(inout) :: order
      type(c_ptr), intent(in) :: phi
      type(error_type), allocatable, intent(inout) :: error
      real(c_double), intent(inout), optional :: noise_variance, mean

      call check_finite([model%coefficient, model%noise_variance, model%mean], error)
      if (allocated(error)) return
      order = int(model%order, c_int32_t)
      call copy_out([model%coefficient, spread(0.0_c_double, 1, max_order - model%order)], phi)
      if (present(noise_variance)) noise_variance = model%noise_variance
      if (present(mean)) mean = model%mean
   end subroutine give_model

   subroutine read_ar_options(options, max_order, c, opt)
      type(ar_options), intent(out) :: options
      integer(c_int32_t), intent(in) :: max_order
      type(call_type), intent(inout) :: c
      type(ar_options_c), intent(in), optional :: opt

      if (ok(c) .and. (max_order < 0 .or. max_order > largest_order)) call fatal_error(c%error, &
         & status%invalid_argument, "max_order must be 0 .. 1000")
      options%max_order = max_order
      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (.not. ok(c)) return
      call take_text(opt%method, options%method, c%error)
      call take_text(opt%criterion, options%criterion, c%error)
      options%order = opt%order
      if (opt%order > max_order .and. ok(c)) call fatal_error(c%error, &
         & status%invalid_argument, "the order of the options exceeds max_order")
   end subroutine read_ar_options

end module gyroakf_c_api_c_series
