! SPDX-License-Identifier: MIT
!> C: tests of stationarity (ADF, KPSS), autocorrelation, Ljung-Box test, as documented in c_api/include/gyroakf.h.
module gyroakf_c_api_c_series
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_ptr, c_funptr, c_null_funptr, c_sizeof, c_char, c_null_char, &
      & c_associated, c_f_pointer
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_c_api_c_host, only : progress_c, callback_type
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_struct_size, check_place, check_finite, take_text, open_series
   use gyroakf_c_api_c_places, only : check_aligned, check_apart, copy_out
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   implicit none (type, external)
   private
   public :: gyroakf_adf_options_init, gyroakf_adf_test, gyroakf_adf_coefficients
   public :: gyroakf_kpss_options_init, gyroakf_kpss_test
   public :: gyroakf_autocorrelation, gyroakf_autocorrelation_watched, gyroakf_ljung_box, gyroakf_ljung_box_watched

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

   !> `gyroakf_adf_coefficient`
   type, bind(C) :: adf_coefficient_c
      character(kind=c_char) :: name(16)
      real(c_double) :: value, std_error, t
   end type adf_coefficient_c

   !> `gyroakf_kpss_options`
   type, bind(C) :: kpss_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: regression = c_null_ptr, rule = c_null_ptr
      integer(c_int64_t) :: lags = -1
      type(progress_c) :: progress
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

   !> `gyroakf_adf_options_init`
   subroutine gyroakf_adf_options_init(opt) bind(C, name="gyroakf_adf_options_init")
      type(adf_options_c), intent(out), optional :: opt
      type(adf_options) :: defaults

      if (present(opt)) opt = adf_options_c(c_sizeof(opt), lags=int(defaults%lags, c_int32_t), &
         & max_lags=int(defaults%max_lags, c_int32_t))
   end subroutine gyroakf_adf_options_init

   !> `gyroakf_adf_test`
   integer(c_int) function gyroakf_adf_test(x, n, opt, out, err) bind(C, name="gyroakf_adf_test")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(adf_options_c), intent(in), optional :: opt
      type(adf_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(adf_options) :: options
      type(adf_type) :: result
      type(error_type), allocatable :: error

      call enter_library(c)
      call check_place(present(out), "result", error)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call test_adf(c%x, options, result, error, c%valid, progress=c%callback)
      call check_finite([result%statistic, result%p_value], error)
      if (.not. allocated(error)) out = adf_c(result%statistic, result%p_value, result%critical, int(result%lag, c_int32_t), &
         & int(result%observations, c_int64_t))
      gyroakf_adf_test = leave_library(c, error, err)
   end function gyroakf_adf_test

   !> `gyroakf_adf_coefficients`
   integer(c_int) function gyroakf_adf_coefficients(x, n, opt, capacity, table, rows, err) &
      & bind(C, name="gyroakf_adf_coefficients")
      type(c_ptr), intent(in), value :: x, table
      integer(c_int64_t), intent(in), value :: n
      type(adf_options_c), intent(in), optional :: opt
      integer(c_int32_t), intent(in), value :: capacity
      integer(c_int32_t), intent(out), optional :: rows
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(adf_options) :: options
      type(adf_type) :: result
      type(adf_coefficient_c) :: row
      type(error_type), allocatable :: error

      call enter_library(c)
      call check_place(present(rows), "number", error)
      if (.not. allocated(error) .and. c_associated(table) .and. capacity < 1) call fatal_error(error, status%invalid_argument, &
         & "the table must have a row at least")
      call check_aligned(table, error)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      options%table = .true.
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call test_adf(c%x, options, result, error, c%valid, progress=c%callback)
      call check_apart([x, table], [8*n, min(size(result%table), capacity)*c_sizeof(row)], error)
      if (.not. allocated(error)) call write_table(result, capacity, table, rows)
      gyroakf_adf_coefficients = leave_library(c, error, err)
   end function gyroakf_adf_coefficients

   !> The coefficients in C's array, as many as it holds.
   subroutine write_table(result, capacity, table, rows)
      type(adf_type), intent(in) :: result
      integer(c_int32_t), intent(in) :: capacity
      type(c_ptr), intent(in) :: table
      integer(c_int32_t), intent(out) :: rows
      type(adf_coefficient_c), pointer :: row(:)
      integer :: i, k

      rows = size(result%table)
      if (.not. c_associated(table)) return
      call c_f_pointer(table, row, [capacity])
      do i = 1, min(size(result%table), size(row))
         row(i)%name(:) = c_null_char
         do k = 1, len_trim(result%table(i)%name)
            row(i)%name(k) = result%table(i)%name(k:k)
         end do
         row(i)%value = result%table(i)%value
         row(i)%std_error = result%table(i)%std_error
         row(i)%t = result%table(i)%t
      end do
   end subroutine write_table

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(adf_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(adf_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      call take_text(opt%regression, options%regression, error)
      options%lags = opt%lags
      options%max_lags = opt%max_lags
      call take_text(opt%criterion, options%criterion, error)
      callback = callback_type(opt%progress)
   end subroutine read_options

   !> `gyroakf_kpss_options_init`
   subroutine gyroakf_kpss_options_init(opt) bind(C, name="gyroakf_kpss_options_init")
      type(kpss_options_c), intent(out), optional :: opt

      if (present(opt)) opt = kpss_options_c(c_sizeof(opt))
   end subroutine gyroakf_kpss_options_init

   !> `gyroakf_kpss_test`
   integer(c_int) function gyroakf_kpss_test(x, n, opt, out, err) bind(C, name="gyroakf_kpss_test")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(kpss_options_c), intent(in), optional :: opt
      type(kpss_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(kpss_options) :: options
      type(kpss_type) :: result
      type(error_type), allocatable :: error

      call enter_library(c)
      call check_place(present(out), "result", error)
      if (.not. allocated(error)) call read_kpss(options, c%callback, error, opt)
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call test_kpss(c%x, options, result, error, c%valid, c%callback)
      call check_finite([result%statistic, result%p_value, result%p_asymptotic, result%variance, result%long_run_variance, &
         & result%drift], error)
      if (.not. allocated(error)) out = kpss_c(result%statistic, result%p_value, result%p_asymptotic, result%critical, &
         & result%variance, result%long_run_variance, result%drift, result%lags, result%observations, &
         & int(result%p_bound, c_int32_t))
      gyroakf_kpss_test = leave_library(c, error, err)
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
      if (opt%struct_size == c_sizeof(opt)) callback = callback_type(opt%progress)
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
      type(call_type) :: c
      type(correlation_type) :: result
      type(error_type), allocatable :: error
      integer(c_int64_t) :: places

      call enter_library(c, progress, progress_user)
      places = max(min(lags + 1_c_int64_t, n), 0_c_int64_t)
      call check_place(c_associated(acf), "result", error)
      call check_aligned(acf, error)
      call check_aligned(pacf, error)
      call check_aligned(limit, error)
      call open_series(x, n, c, error)
      call check_apart([x, acf, pacf, limit], 8*[n, places, places, places], error)
      if (.not. allocated(error)) call compute_correlation(c%x, int(lags), 0, result, error, c%valid, &
         & c%callback)
      if (.not. allocated(error)) call check_finite([result%acf, result%pacf, result%limit], error)
      if (.not. allocated(error)) then
         call copy_out(result%acf, acf)
         call copy_out(result%pacf, pacf)
         call copy_out(result%limit, limit)
      end if
      gyroakf_autocorrelation_watched = leave_library(c, error, err)
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
      type(call_type) :: c
      type(ljung_box_type) :: result
      type(error_type), allocatable :: error

      call enter_library(c, progress, progress_user)
      call check_place(present(out), "result", error)
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call test_ljung_box(c%x, int(lags), int(fitted), result, error, c%valid, &
         & c%callback)
      call check_finite([result%statistic, result%p_value, result%largest_rho], error)
      if (.not. allocated(error)) out = ljung_box_c(result%statistic, result%p_value, result%largest_rho, &
         & int(result%largest_lag, c_int32_t))
      gyroakf_ljung_box_watched = leave_library(c, error, err)
   end function gyroakf_ljung_box_watched

end module gyroakf_c_api_c_series
