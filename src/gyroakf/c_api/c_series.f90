! SPDX-License-Identifier: MIT
!> C: the test of stationarity. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_series
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, c_size_t, c_null_ptr, c_funptr, &
      & c_null_funptr, c_sizeof, &
      & c_char, c_null_char, c_associated, c_f_pointer
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_c_api_c_progress, only : callback_type
   use gyroakf_c_api_c_support, only : error_c, host_type, series_type, enter_library, leave_library, check_struct_size, &
      & check_finite, take_text, open_series, close_series
   use gyroakf_c_api_c_places, only : check_aligned, check_apart
   implicit none (type, external)
   private
   public :: gyroakf_adf_options_init, gyroakf_adf_test, gyroakf_adf_coefficients

   !> `gyroakf_adf_options`
   type, bind(C) :: adf_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: regression
      integer(c_int32_t) :: lags, max_lags
      type(c_ptr) :: criterion
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
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

contains

   !> `gyroakf_adf_options_init`
   subroutine gyroakf_adf_options_init(opt) bind(C, name="gyroakf_adf_options_init")
      type(adf_options_c), intent(out), optional :: opt
      type(adf_options) :: defaults

      if (.not. present(opt)) return
      opt%struct_size = c_sizeof(opt)
      opt%regression = c_null_ptr
      opt%lags = int(defaults%lags, c_int32_t)
      opt%max_lags = int(defaults%max_lags, c_int32_t)
      opt%criterion = c_null_ptr
      opt%progress = c_null_funptr
      opt%progress_user = c_null_ptr
   end subroutine gyroakf_adf_options_init

   !> `gyroakf_adf_test`
   integer(c_int) function gyroakf_adf_test(x, n, opt, out, err) bind(C, name="gyroakf_adf_test")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(adf_options_c), intent(in), optional :: opt
      type(adf_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(adf_options) :: options
      type(callback_type) :: callback
      type(adf_type) :: result
      type(error_type), allocatable :: error

      call enter_library(host)
      if (.not. present(out)) call fatal_error(error, status%invalid_argument, "the place for the result must not be NULL")
      if (.not. allocated(error)) call read_options(options, callback, error, opt)
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call test_adf(series%x, options, result, error, series%valid, progress=callback)
      call close_series(series)
      call check_finite([result%statistic, result%p_value], error)
      if (.not. allocated(error)) call write_adf(result, out)
      gyroakf_adf_test = leave_library(host, error, err)
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
      type(host_type) :: host
      type(series_type) :: series
      type(adf_options) :: options
      type(callback_type) :: callback
      type(adf_type) :: result
      type(adf_coefficient_c) :: row
      type(error_type), allocatable :: error

      call enter_library(host)
      if (.not. present(rows)) call fatal_error(error, status%invalid_argument, "the place for the number must not be NULL")
      if (.not. allocated(error) .and. c_associated(table) .and. capacity < 1) call fatal_error(error, status%invalid_argument, &
         & "the table must have a row at least")
      call check_aligned(table, error)
      if (.not. allocated(error)) call read_options(options, callback, error, opt)
      options%table = .true.
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call test_adf(series%x, options, result, error, series%valid, progress=callback)
      call close_series(series)
      if (.not. allocated(error)) call check_apart([x, table], [8*n, min(size(result%table), capacity)*c_sizeof(row)], error)
      if (.not. allocated(error)) call write_table(result, capacity, table, rows)
      gyroakf_adf_coefficients = leave_library(host, error, err)
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
      callback = callback_type(opt%progress, opt%progress_user)
   end subroutine read_options

   !> The result in C's struct.
   pure subroutine write_adf(result, out)
      type(adf_type), intent(in) :: result
      type(adf_c), intent(inout) :: out

      out%statistic = result%statistic
      out%p_value = result%p_value
      out%critical(:) = result%critical
      out%lag = int(result%lag, c_int32_t)
      out%observations = result%observations
   end subroutine write_adf

end module gyroakf_c_api_c_series
