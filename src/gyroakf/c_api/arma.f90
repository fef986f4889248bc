! SPDX-License-Identifier: MIT
!> C: the ARMA model. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_arma
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, c_size_t, c_null_ptr, c_funptr, &
      & c_null_funptr, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_arma_result, only : arma_options, arma_model_type
   use gyroakf_ar_arma_model, only : fit_arma
   use gyroakf_c_api_progress, only : callback_type
   use gyroakf_c_api_support, only : error_c, host_type, series_type, enter_library, leave_library, check_struct_size, &
      & take_text, open_series, close_series
   implicit none (type, external)
   private
   public :: gyroakf_arma_options_init, gyroakf_arma_fit

   !> `gyroakf_arma_options`
   type, bind(C) :: arma_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: criterion
      integer(c_int32_t) :: p, q, max_p, max_q
      integer(c_int64_t) :: max_samples
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
   end type arma_options_c

   !> `gyroakf_arma`
   type, bind(C) :: arma_c
      real(c_double) :: phi(3), phi_error(3), theta(3), theta_error(3), mean, mean_error, noise_variance
      real(c_double) :: log_likelihood, aic, bic, residual_p_value, residual_largest_rho
      real(c_double) :: drift_time, drift_time_error, drift_std, drift_std_error, white_std, white_std_error
      integer(c_int64_t) :: first, length, samples
      integer(c_int32_t) :: p, q, converged, errors_known, drift_found, warnings
   end type arma_c

contains

   !> `gyroakf_arma_options_init`
   subroutine gyroakf_arma_options_init(opt) bind(C, name="gyroakf_arma_options_init")
      type(arma_options_c), intent(out), optional :: opt
      type(arma_options) :: defaults

      if (.not. present(opt)) return
      opt%struct_size = c_sizeof(opt)
      opt%criterion = c_null_ptr
      opt%p = int(defaults%p, c_int32_t)
      opt%q = int(defaults%q, c_int32_t)
      opt%max_p = int(defaults%max_p, c_int32_t)
      opt%max_q = int(defaults%max_q, c_int32_t)
      opt%max_samples = defaults%max_samples
      opt%progress = c_null_funptr
      opt%progress_user = c_null_ptr
   end subroutine gyroakf_arma_options_init

   !> `gyroakf_arma_fit`
   integer(c_int) function gyroakf_arma_fit(x, n, opt, out, err) bind(C, name="gyroakf_arma_fit")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(arma_options_c), intent(in), optional :: opt
      type(arma_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(arma_options) :: options
      type(callback_type) :: callback
      type(arma_model_type) :: model
      type(error_type), allocatable :: error

      call enter_library(host)
      if (.not. present(out)) call fatal_error(error, status%invalid_argument, "the place for the model must not be NULL")
      if (.not. allocated(error)) call read_options(options, callback, error, opt)
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call fit_arma(series%x, options, model, error, series%valid, callback)
      call close_series(series)
      if (.not. allocated(error)) call write_model(model, out)
      gyroakf_arma_fit = leave_library(host, error, err)
   end function gyroakf_arma_fit

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(arma_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(arma_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      call take_text(opt%criterion, options%criterion, error)
      options%p = opt%p
      options%q = opt%q
      options%max_p = opt%max_p
      options%max_q = opt%max_q
      options%max_samples = opt%max_samples
      callback = callback_type(opt%progress, opt%progress_user)
   end subroutine read_options

   !> The model in C's struct.
   subroutine write_model(model, out)
      type(arma_model_type), intent(in) :: model
      type(arma_c), intent(out) :: out

      out = arma_c(phi=0, phi_error=0, theta=0, theta_error=0, mean=model%mean, mean_error=model%mean_error, &
         & noise_variance=model%noise_variance, log_likelihood=model%fit%log_likelihood, aic=model%fit%aic, bic=model%fit%bic, &
         & residual_p_value=model%residual_ljung_box%p_value, residual_largest_rho=model%residual_ljung_box%largest_rho, &
         & drift_time=model%drift%time_constant, drift_time_error=model%drift%time_error, drift_std=model%drift%drift_std, &
         & drift_std_error=model%drift%drift_error, white_std=model%drift%white_std, white_std_error=model%drift%white_error, &
         & first=model%first - 1, length=model%length, samples=model%samples, p=model%p, q=model%q, &
         & converged=merge(1, 0, model%converged), errors_known=merge(1, 0, model%errors_known), &
         & drift_found=merge(1, 0, model%drift%found), warnings=size(model%warnings))
      out%phi(:model%p) = model%phi
      out%phi_error(:model%p) = model%phi_error
      out%theta(:model%q) = model%theta
      out%theta_error(:model%q) = model%theta_error
   end subroutine write_model

end module gyroakf_c_api_arma
