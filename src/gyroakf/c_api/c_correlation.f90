! SPDX-License-Identifier: MIT
!> C: KPSS test, autocorrelation, Ljung-Box test, as documented in c_api/include/gyroakf.h.
module gyroakf_c_api_c_correlation
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, c_double, c_size_t, &
      & c_null_ptr, c_null_funptr, c_associated, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   use gyroakf_c_api_c_progress, only : callback_type
   use gyroakf_c_api_c_support, only : error_c, host_type, series_type, enter_library, leave_library, check_struct_size, &
      & check_finite, take_text, open_series, close_series
   use gyroakf_c_api_c_places, only : check_aligned, check_apart, copy_out
   implicit none (type, external)
   private
   public :: gyroakf_kpss_options_init, gyroakf_kpss_test
   public :: gyroakf_autocorrelation, gyroakf_autocorrelation_watched, gyroakf_ljung_box, gyroakf_ljung_box_watched

   !> `gyroakf_kpss_options`
   type, bind(C) :: kpss_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: regression, rule
      integer(c_int64_t) :: lags
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
   end type kpss_options_c

   !> `gyroakf_kpss`
   type, bind(C) :: kpss_c
      real(c_double) :: statistic, p_value, p_asymptotic, critical(4), variance, long_run_variance, drift
      integer(c_int64_t) :: lags, observations
      integer(c_int32_t) :: p_bound
   end type kpss_c

   !> `gyroakf_whiteness`
   type, bind(C) :: ljung_box_c
      real(c_double) :: statistic, p_value, largest_rho
      integer(c_int32_t) :: largest_lag
   end type ljung_box_c

   !> Size of the options before they had a progress function
   integer(c_size_t), parameter :: kpss_size_before = 32

contains

   !> `gyroakf_kpss_options_init`
   subroutine gyroakf_kpss_options_init(opt) bind(C, name="gyroakf_kpss_options_init")
      type(kpss_options_c), intent(out), optional :: opt

      if (.not. present(opt)) return
      opt%struct_size = c_sizeof(opt)
      opt%regression = c_null_ptr
      opt%rule = c_null_ptr
      opt%lags = -1
      opt%progress = c_null_funptr
      opt%progress_user = c_null_ptr
   end subroutine gyroakf_kpss_options_init

   !> `gyroakf_kpss_test`
   integer(c_int) function gyroakf_kpss_test(x, n, opt, out, err) bind(C, name="gyroakf_kpss_test")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(kpss_options_c), intent(in), optional :: opt
      type(kpss_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(kpss_options) :: options
      type(kpss_type) :: result
      type(callback_type) :: callback
      type(error_type), allocatable :: error

      call enter_library(host)
      call check_place(present(out), error)
      if (.not. allocated(error)) call read_kpss(options, callback, error, opt)
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call test_kpss(series%x, options, result, error, series%valid, callback)
      call close_series(series)
      call check_finite([result%statistic, result%p_value, result%p_asymptotic, result%variance, result%long_run_variance, &
         & result%drift], error)
      if (.not. allocated(error)) out = kpss_c(result%statistic, result%p_value, result%p_asymptotic, result%critical, &
         & result%variance, result%long_run_variance, result%drift, result%lags, result%observations, &
         & int(result%p_bound, c_int32_t))
      gyroakf_kpss_test = leave_library(host, error, err)
   end function gyroakf_kpss_test

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_kpss(options, callback, error, opt)
      type(kpss_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(kpss_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error, kpss_size_before)
      if (allocated(error)) return
      call take_text(opt%regression, options%regression, error)
      if (.not. allocated(error)) call take_text(opt%rule, options%rule, error)
      options%lags = opt%lags
      if (opt%struct_size == c_sizeof(opt)) callback = callback_type(opt%progress, opt%progress_user)
   end subroutine read_kpss

   !> `gyroakf_autocorrelation`
   integer(c_int) function gyroakf_autocorrelation(x, n, lags, acf, pacf, limit, err) bind(C, name="gyroakf_autocorrelation")
      type(c_ptr), intent(in), value :: x, acf, pacf, limit
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: lags
      type(error_c), intent(out), optional :: err

      gyroakf_autocorrelation = gyroakf_autocorrelation_watched(x, n, lags, acf, pacf, limit, c_null_funptr, c_null_ptr, err)
   end function gyroakf_autocorrelation

   !> `gyroakf_autocorrelation_watched`
   integer(c_int) function gyroakf_autocorrelation_watched(x, n, lags, acf, pacf, limit, progress, progress_user, err) &
      & bind(C, name="gyroakf_autocorrelation_watched")
      type(c_ptr), intent(in), value :: x, acf, pacf, limit
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: lags
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(correlation_type) :: result
      type(callback_type) :: callback
      type(error_type), allocatable :: error
      integer(c_int64_t) :: places

      call enter_library(host)
      callback = callback_type(progress, progress_user)
      places = max(min(lags + 1_c_int64_t, n), 0_c_int64_t)
      call check_place(c_associated(acf), error)
      call check_aligned(acf, error)
      call check_aligned(pacf, error)
      call check_aligned(limit, error)
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call check_apart([x, acf, pacf, limit], 8*[n, places, places, places], error)
      if (.not. allocated(error)) call compute_correlation(series%x, int(lags), 0, result, error, series%valid, &
         & callback)
      call close_series(series)
      if (.not. allocated(error)) call check_finite(result%acf, error)
      if (.not. allocated(error)) call check_finite(result%pacf, error)
      if (.not. allocated(error)) call check_finite(result%limit, error)
      if (.not. allocated(error)) then
         call copy_out(result%acf, acf)
         call copy_out(result%pacf, pacf)
         call copy_out(result%limit, limit)
      end if
      gyroakf_autocorrelation_watched = leave_library(host, error, err)
   end function gyroakf_autocorrelation_watched

   !> `gyroakf_ljung_box`
   integer(c_int) function gyroakf_ljung_box(x, n, lags, fitted, out, err) bind(C, name="gyroakf_ljung_box")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: lags, fitted
      type(ljung_box_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_ljung_box = gyroakf_ljung_box_watched(x, n, lags, fitted, out, c_null_funptr, c_null_ptr, err)
   end function gyroakf_ljung_box

   !> `gyroakf_ljung_box_watched`
   integer(c_int) function gyroakf_ljung_box_watched(x, n, lags, fitted, out, progress, progress_user, err) &
      & bind(C, name="gyroakf_ljung_box_watched")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: lags, fitted
      type(ljung_box_c), intent(inout), optional :: out
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(ljung_box_type) :: result
      type(callback_type) :: callback
      type(error_type), allocatable :: error

      call enter_library(host)
      callback = callback_type(progress, progress_user)
      call check_place(present(out), error)
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call test_ljung_box(series%x, int(lags), int(fitted), result, error, series%valid, &
         & callback)
      call close_series(series)
      call check_finite([result%statistic, result%p_value, result%largest_rho], error)
      if (.not. allocated(error)) out = ljung_box_c(result%statistic, result%p_value, result%largest_rho, &
         & int(result%largest_lag, c_int32_t))
      gyroakf_ljung_box_watched = leave_library(host, error, err)
   end function gyroakf_ljung_box_watched

   !> The caller has a place for the result.
   pure subroutine check_place(there, error)
      logical, intent(in) :: there
      type(error_type), allocatable, intent(out) :: error

      if (.not. there) call fatal_error(error, status%invalid_argument, "the place for the result must not be NULL")
   end subroutine check_place

end module gyroakf_c_api_c_correlation
