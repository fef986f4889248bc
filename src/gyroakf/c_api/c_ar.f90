! SPDX-License-Identifier: MIT
!> C: the AR model. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_ar
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_ptr, c_associated, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_c_api_c_host, only : progress_c, callback_type
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_struct_size, check_finite, take_text, open_series
   use gyroakf_c_api_c_places, only : check_aligned, check_apart, copy_out
   implicit none (type, external)
   private
   public :: gyroakf_ar_options_init, gyroakf_ar_fit

   !> Largest order that is compared
   integer, parameter :: largest_order = 1000

   !> `gyroakf_ar_options`
   type, bind(C) :: ar_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: method = c_null_ptr, criterion = c_null_ptr
      integer(c_int32_t) :: order
      type(progress_c) :: progress
   end type ar_options_c

   !> Size of the options before they had a progress function
   integer(c_size_t), parameter :: size_before = 32

contains

   !> `gyroakf_ar_options_init`
   subroutine gyroakf_ar_options_init(opt) bind(C, name="gyroakf_ar_options_init")
      type(ar_options_c), intent(out), optional :: opt
      type(ar_options) :: defaults

      if (present(opt)) opt = ar_options_c(c_sizeof(opt), order=int(defaults%order, c_int32_t))
   end subroutine gyroakf_ar_options_init

   !> `gyroakf_ar_fit`
   integer(c_int) function gyroakf_ar_fit(x, n, opt, max_order, order, phi, noise_variance, mean, err) &
      & bind(C, name="gyroakf_ar_fit")
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
      type(error_type), allocatable :: error

      call enter_library(c)
      call check_arguments(max_order, present(order), c_associated(phi), error)
      call check_aligned(phi, error)
      if (.not. allocated(error)) call read_options(options, max_order, c%callback, error, opt)
      call open_series(x, n, c, error)
      call check_apart([x, phi], 8*[n, int(max_order, c_int64_t)], error)
      if (.not. allocated(error)) call fit_ar(c%x, options, model, error, c%valid, progress=c%callback)
      if (.not. allocated(error)) call check_finite([model%coefficient, model%noise_variance, model%mean], error)
      if (.not. allocated(error)) then
         order = int(model%order, c_int32_t)
         call copy_out([model%coefficient, spread(0.0_c_double, 1, max_order - model%order)], phi)
         if (present(noise_variance)) noise_variance = model%noise_variance
         if (present(mean)) mean = model%mean
      end if
      gyroakf_ar_fit = leave_library(c, error, err)
   end function gyroakf_ar_fit

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, max_order, callback, error, opt)
      type(ar_options), intent(out) :: options
      integer(c_int32_t), intent(in) :: max_order
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(ar_options_c), intent(in), optional :: opt

      options%max_order = max_order
      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error, size_before)
      if (allocated(error)) return
      call take_text(opt%method, options%method, error)
      call take_text(opt%criterion, options%criterion, error)
      options%order = opt%order
      if (opt%struct_size == c_sizeof(opt)) callback = callback_type(opt%progress)
      if (allocated(error)) return
      if (opt%order > max_order) call fatal_error(error, status%invalid_argument, "the order of the options exceeds max_order")
   end subroutine read_options

   !> Orders in range, places for the results.
   subroutine check_arguments(max_order, has_order, has_phi, error)
      integer(c_int32_t), intent(in) :: max_order
      logical, intent(in) :: has_order, has_phi
      type(error_type), allocatable, intent(out) :: error

      if (max_order < 0 .or. max_order > largest_order) then
         call fatal_error(error, status%invalid_argument, "max_order must be 0 .. 1000")
      else if (.not. has_order .or. (max_order > 0 .and. .not. has_phi)) then
         call fatal_error(error, status%invalid_argument, "the places for the order and the coefficients must not be NULL")
      end if
   end subroutine check_arguments

end module gyroakf_c_api_c_ar
