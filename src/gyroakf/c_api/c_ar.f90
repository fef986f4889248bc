! SPDX-License-Identifier: MIT
!> C: the AR model. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_ar
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_null_ptr, c_associated, c_sizeof
   use gyroakf_error, only : fatal_error, status
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_c_api_c_host, only : progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_finite, open_options, open_series, take_text
   use gyroakf_c_api_c_places, only : check_aligned, check_apart, copy_out
   implicit none (type, external)
   private
   public :: gyroakf_ar_options_init, gyroakf_ar_fit, ar_options_c

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

   !> `gyroakf_ar_options_init`
   subroutine gyroakf_ar_options_init(opt) bind(C, name="gyroakf_ar_options_init")
      type(ar_options_c), intent(out), optional :: opt
      type(ar_options) :: defaults

      if (present(opt)) opt = ar_options_c(c_sizeof(opt), order=int(defaults%order, c_int32_t))
   end subroutine gyroakf_ar_options_init

   !> `gyroakf_ar_fit`
   integer(c_int) function gyroakf_ar_fit(x, n, opt, max_order, order, phi, noise_variance, mean, &
      & err) bind(C, name="gyroakf_ar_fit")
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
      if (max_order < 0 .or. max_order > largest_order) then
         call fatal_error(c%error, status%invalid_argument, "max_order must be 0 .. 1000")
      else if (.not. present(order) .or. (max_order > 0 .and. .not. c_associated(phi))) then
         call fatal_error(c%error, status%invalid_argument, &
            "the places for the order and the coefficients must not be NULL")
      end if
      call check_aligned(phi, c%error)
      options%max_order = max_order
      if (present(opt)) call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (present(opt) .and. ok(c)) then
         call take_text(opt%method, options%method, c%error)
         call take_text(opt%criterion, options%criterion, c%error)
         options%order = opt%order
         if (opt%order > max_order .and. ok(c)) call fatal_error(c%error, &
            status%invalid_argument, "the order of the options exceeds max_order")
      end if
      call open_series(x, n, c)
      call check_apart([x, phi], 8*[n, int(max_order, c_int64_t)], c%error)
      if (ok(c)) call fit_ar(c%x, options, model, c%error, c%valid, progress=c%callback)
      if (ok(c)) call check_finite([model%coefficient, model%noise_variance, model%mean], c%error)
      if (ok(c)) then
         order = int(model%order, c_int32_t)
         call copy_out([model%coefficient, spread(0.0_c_double, 1, max_order - model%order)], phi)
         if (present(noise_variance)) noise_variance = model%noise_variance
         if (present(mean)) mean = model%mean
      end if
      gyroakf_ar_fit = leave_library(c, err)
   end function gyroakf_ar_fit

end module gyroakf_c_api_c_ar
