! SPDX-License-Identifier: MIT
!> C interface, the drift. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_drift
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, &
      & c_size_t, c_funptr, c_null_funptr, c_null_ptr, c_associated, c_f_pointer, c_sizeof
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_filter_components, only : component_model_type, most_components, check_components
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_drift_identification, only : drift_identification_options, &
      & drift_identification_type, identify_drift_model
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use gyroakf_filter_filter_types, only : drift_filter_type, filter_options
   use gyroakf_c_api_c_filter, only : filter_options_c, handle_type, new_handle, hand_over, &
      & read_options
   use gyroakf_c_api_c_host, only : check_aligned, check_apart, progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_struct_size, check_place, check_finite, open_options, open_series
   implicit none (type, external)
   private
   public :: gyroakf_drift_model_init, gyroakf_drift_options_init, gyroakf_drift_identify, &
      & gyroakf_drift_filter_new, gyroakf_drift_smooth, gyroakf_drift_smooth_watched

   !> `gyroakf_drift_model`
   type, bind(C) :: drift_model_c
      integer(c_size_t) :: struct_size
      integer(c_int32_t) :: count = 0
      real(c_double) :: phi(most_components) = 0, q(most_components) = 0, r = 0
      integer(c_int32_t) :: slow(most_components) = 0
   end type drift_model_c

   !> `gyroakf_drift_options`
   type, bind(C) :: drift_options_c
      integer(c_size_t) :: struct_size
      real(c_double) :: drift_samples
      integer(c_int64_t) :: most_samples
      type(progress_c) :: progress
   end type drift_options_c

contains

   subroutine gyroakf_drift_model_init(model) bind(C)
      type(drift_model_c), intent(out), optional :: model

      if (present(model)) model = drift_model_c(c_sizeof(model))
   end subroutine gyroakf_drift_model_init

   subroutine gyroakf_drift_options_init(opt) bind(C)
      type(drift_options_c), intent(out), optional :: opt
      type(drift_identification_options) :: defaults

      if (present(opt)) opt = drift_options_c(c_sizeof(opt), defaults%drift_samples, defaults%most)
   end subroutine gyroakf_drift_options_init

   integer(c_int) function gyroakf_drift_identify(z, n, opt, model, err) bind(C)
      type(c_ptr), intent(in), value :: z
      integer(c_int64_t), intent(in), value :: n
      type(drift_options_c), intent(in), optional :: opt
      type(drift_model_c), intent(inout), optional :: model
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(drift_identification_options) :: options
      type(drift_identification_type) :: found

      call enter_library(c)
      call check_model_place(c%error, model)
      if (present(opt)) call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (present(opt) .and. ok(c)) then
         options%drift_samples = opt%drift_samples
         options%most = opt%most_samples
      end if
      call open_series(z, n, c)
      if (ok(c)) call identify_drift_model(c%x, options, found, c%error, &
         & c%valid, progress=c%callback)
      if (ok(c)) model = drift_model_c(c_sizeof(model), found%model%count, &
         & found%model%phi, found%model%q, found%model%r, merge(1, 0, found%slow))
      gyroakf_drift_identify = leave_library(c, err)
   end function gyroakf_drift_identify

   integer(c_int) function gyroakf_drift_filter_new(model, opt, out, err) bind(C)
      type(drift_model_c), intent(in), optional :: model
      type(filter_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(component_model_type) :: components
      type(filter_options) :: options
      type(handle_type), pointer :: handle
      type(drift_filter_type), allocatable :: filter
      logical :: slow(most_components)
      integer :: stat

      call enter_library(c)
      call new_handle(handle, c%error, out)
      call read_options(options, c%error, opt)
      call read_model(components, slow, c%error, model)
      allocate (filter, stat=stat)
      call check_memory(stat, "a filter", c%error)
      if (ok(c)) call new_drift_filter(filter, components, slow(:components%count), options, &
         & c%error)
      if (ok(c)) call move_alloc(filter, handle%filter)
      call hand_over(handle, c%error, out)
      gyroakf_drift_filter_new = leave_library(c, err)
   end function gyroakf_drift_filter_new

   integer(c_int) function gyroakf_drift_smooth(model, z, n, drift, variance, opt, err) bind(C)
      type(drift_model_c), intent(in), optional :: model
      type(c_ptr), intent(in), value :: z, drift, variance
      integer(c_int64_t), intent(in), value :: n
      type(filter_options_c), intent(in), optional :: opt
      type(error_c), intent(out), optional :: err

      gyroakf_drift_smooth = gyroakf_drift_smooth_watched(model, z, n, drift, variance, opt, &
         & c_null_funptr, c_null_ptr, err)
   end function gyroakf_drift_smooth

   integer(c_int) function gyroakf_drift_smooth_watched(model, z, n, drift, variance, opt, &
      & progress, progress_user, err) bind(C)
      type(drift_model_c), intent(in), optional :: model
      type(c_ptr), intent(in), value :: z, drift, variance
      integer(c_int64_t), intent(in), value :: n
      type(filter_options_c), intent(in), optional :: opt
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(component_model_type) :: components
      type(filter_options) :: options
      logical :: slow(most_components)

      call enter_library(c, progress, progress_user)
      call read_options(options, c%error, opt)
      call read_model(components, slow, c%error, model)
      call check_place(c_associated(drift), "drift", c%error)
      call check_aligned(drift, c%error)
      call check_aligned(variance, c%error)
      call open_series(z, n, c)
      call check_apart([z, drift, variance], 8*[n, n, n], c%error)
      if (ok(c)) call smooth(components, slow(:components%count), c, drift, variance, options)
      gyroakf_drift_smooth_watched = leave_library(c, err)
   end function gyroakf_drift_smooth_watched

   !> The smoother that the options ask for, into the caller's arrays.
   subroutine smooth(model, slow, c, drift, variance, options)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(call_type), intent(inout) :: c
      type(c_ptr), intent(in) :: drift, variance
      type(filter_options), intent(in) :: options
      real(c_double), pointer, contiguous :: output(:), spread_of(:)

      nullify (spread_of)
      call c_f_pointer(drift, output, shape(c%x, c_int64_t))
      if (c_associated(variance)) call c_f_pointer(variance, spread_of, shape(c%x, c_int64_t))
      if (options%estimate_measurement_variance) then
         call smooth_adaptive(model, slow, options, c%x, output, c%error, c%valid, spread_of, &
            & progress=c%callback)
      else
         call smooth_drift(model, slow, c%x, output, c%error, c%valid, spread_of, &
            & progress=c%callback)
      end if
      call check_finite(output, c%error)
      if (associated(spread_of)) call check_finite(spread_of, c%error)
   end subroutine smooth

   !> The place for a model must be there and initialized.
   subroutine check_model_place(error, model)
      !> An earlier error stays
      type(error_type), allocatable, intent(inout) :: error
      type(drift_model_c), intent(in), optional :: model

      if (present(model)) then
         call check_struct_size(model%struct_size, c_sizeof(model), error)
      else if (.not. allocated(error)) then
         call fatal_error(error, status%invalid_argument, "the drift model must not be NULL")
      end if
   end subroutine check_model_place

   !> A model of C into one of the library, checked.
   subroutine read_model(components, slow, error, model)
      type(component_model_type), intent(out) :: components
      logical, intent(out) :: slow(:)
      !> An earlier error stays
      type(error_type), allocatable, intent(inout) :: error
      type(drift_model_c), intent(in), optional :: model

      slow = .false.
      call check_model_place(error, model)
      if (allocated(error)) return
      components = component_model_type(model%count, model%phi, model%q, model%r)
      slow = model%slow /= 0
      call check_components(components, error)
   end subroutine read_model

end module gyroakf_c_api_c_drift
