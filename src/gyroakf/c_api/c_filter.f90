! SPDX-License-Identifier: MIT
!> C interface, the filter. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_filter
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, &
      & c_double, c_size_t, c_null_ptr, c_null_funptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, step_filter, &
      & run_filter, freeze_filter
   use gyroakf_progress, only : report_progress
   use gyroakf_c_api_c_host, only : check_aligned, check_apart, begin_step, end_step
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_struct_size, check_place, check_finite, take_text, max_samples
   implicit none (type, external)
   private
   public :: gyroakf_filter_options_init, gyroakf_filter_new, gyroakf_filter_step, &
      & gyroakf_filter_freeze, gyroakf_filter_run, gyroakf_filter_run_watched, gyroakf_filter_get, &
      & gyroakf_filter_free
   public :: filter_options_c, handle_type, new_handle, hand_over, read_options

   !> Largest state
   integer, parameter :: largest_order = 1000

   !> Samples that [[gyroakf_filter_run]] copies at a time, so that x may be z
   integer, parameter :: block = 1024

   !> Samples between two reports of progress for a state of one coefficient; a step of p
   !> coefficients takes p^2 times as long
   integer(int64), parameter :: report_samples = 256*block

   !> What a `gyroakf_filter *` points to
   type :: handle_type
      class(filter_type), allocatable :: filter
   end type handle_type

   !> `gyroakf_filter_options`
   type, bind(C) :: filter_options_c
      integer(c_size_t) :: struct_size
      integer(c_int32_t) :: estimate_process_mean = 0, estimate_measurement_mean = 0
      integer(c_int32_t) :: estimate_process_variance = 0, estimate_measurement_variance = 0
      real(c_double) :: forgetting
      type(c_ptr) :: measurement_form = c_null_ptr
      integer(c_int32_t) :: burn_in
      real(c_double) :: huber, r_scale, initial_variance, q_lower, q_upper, r_lower, r_upper
      integer(c_int32_t) :: allow_unobservable = 0
   end type filter_options_c

   !> `gyroakf_filter_state`
   type, bind(C) :: filter_state_c
      real(c_double) :: x, p, gain, innovation, innovation_variance, q_mean, r_mean, q, r
      integer(c_int64_t) :: steps
   end type filter_state_c

contains

   subroutine gyroakf_filter_options_init(opt) bind(C)
      type(filter_options_c), intent(out), optional :: opt
      type(filter_options) :: defaults

      if (present(opt)) opt = filter_options_c(c_sizeof(opt), forgetting=defaults%forgetting, &
         & burn_in=int(defaults%burn_in, c_int32_t), huber=defaults%huber, &
         & r_scale=defaults%r_scale, initial_variance=defaults%initial_variance, &
         & q_lower=defaults%q_lower, q_upper=defaults%q_upper, r_lower=defaults%r_lower, &
         & r_upper=defaults%r_upper)
   end subroutine gyroakf_filter_options_init

   integer(c_int) function gyroakf_filter_new(p, phi, q, r, opt, out, err) bind(C)
      integer(c_int32_t), intent(in), value :: p
      type(c_ptr), intent(in), value :: phi
      real(c_double), intent(in), value :: q, r
      type(filter_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      real(dp), allocatable :: coefficients(:)
      type(filter_options) :: options
      type(handle_type), pointer :: handle
      integer :: stat

      call enter_library(c)
      call new_handle(handle, c%error, out)
      call read_options(options, c%error, opt)
      call read_coefficients(p, phi, coefficients, c%error)
      stat = 0
      if (ok(c)) allocate (filter_type :: handle%filter, stat=stat)
      call check_memory(stat, "a filter", c%error)
      if (ok(c)) call new_filter(handle%filter, coefficients, q, r, options, c%error)
      call hand_over(handle, c%error, out)
      gyroakf_filter_new = leave_library(c, err)
   end function gyroakf_filter_new

   integer(c_int) function gyroakf_filter_step(f, z, x) bind(C)
      type(c_ptr), intent(in), value :: f
      real(c_double), intent(in), value :: z
      real(c_double), intent(inout), optional :: x
      integer(c_int64_t) :: environment(64)
      type(handle_type), pointer :: handle
      integer(c_int) :: changed
      real(dp) :: estimate

      gyroakf_filter_step = status%invalid_argument
      if (.not. c_associated(f) .or. .not. present(x)) return
      call c_f_pointer(f, handle)
      changed = begin_step(environment)
      call step_filter(handle%filter, z, estimate)
      gyroakf_filter_step = status%non_finite
      if (ieee_is_finite(estimate)) then
         gyroakf_filter_step = status%ok
         x = estimate
      end if
      if (changed /= 0) call end_step(environment)
   end function gyroakf_filter_step

   integer(c_int) function gyroakf_filter_freeze(f, frozen) bind(C)
      type(c_ptr), intent(in), value :: f
      integer(c_int32_t), intent(in), value :: frozen
      type(handle_type), pointer :: handle

      gyroakf_filter_freeze = status%invalid_argument
      if (.not. c_associated(f)) return
      call c_f_pointer(f, handle)
      call freeze_filter(handle%filter, frozen /= 0)
      gyroakf_filter_freeze = status%ok
   end function gyroakf_filter_freeze

   integer(c_int) function gyroakf_filter_run(f, z, n, x, err) bind(C)
      type(c_ptr), intent(in), value :: f, z, x
      integer(c_int64_t), intent(in), value :: n
      type(error_c), intent(out), optional :: err

      gyroakf_filter_run = gyroakf_filter_run_watched(f, z, n, x, c_null_funptr, c_null_ptr, err)
   end function gyroakf_filter_run

   integer(c_int) function gyroakf_filter_run_watched(f, z, n, x, progress, progress_user, &
      & err) bind(C)
      type(c_ptr), intent(in), value :: f, z, x
      integer(c_int64_t), intent(in), value :: n
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(handle_type), pointer :: handle

      call enter_library(c, progress, progress_user)
      if (.not. (c_associated(f) .and. c_associated(z) .and. c_associated(x)) .or. n < 1 .or. &
         & n > max_samples) call fatal_error(c%error, status%invalid_argument, &
         & "filter and series must not be NULL, the length must be 1 .. 2**44")
      call check_aligned(z, c%error)
      call check_aligned(x, c%error)
      if (.not. c_associated(x, z)) call check_apart([z, x], [8*n, 8*n], c%error)
      if (ok(c)) then
         call c_f_pointer(f, handle)
         call run_blocks(handle%filter, z, n, x, c)
      end if
      gyroakf_filter_run_watched = leave_library(c, err)
   end function gyroakf_filter_run_watched

   integer(c_int) function gyroakf_filter_get(f, out) bind(C)
      type(c_ptr), intent(in), value :: f
      type(filter_state_c), intent(inout), optional :: out
      type(handle_type), pointer :: handle
      type(filter_state_c) :: held
      type(call_type) :: c

      gyroakf_filter_get = status%invalid_argument
      if (.not. c_associated(f) .or. .not. present(out)) return
      call c_f_pointer(f, handle)
      call enter_library(c)
      associate (filter => handle%filter)
         held = filter_state_c(filter%x(1), filter%p(1, 1), filter%gain(1), filter%innovation, &
            & filter%innovation_variance, filter%q_mean, filter%r_mean, filter%q, filter%r, &
            & filter%steps)
      end associate
      call check_finite([held%x, held%p, held%gain, held%innovation, held%innovation_variance, &
         & held%q_mean, held%r_mean, held%q, held%r], c%error)
      if (ok(c)) out = held
      gyroakf_filter_get = leave_library(c)
   end function gyroakf_filter_get

   subroutine gyroakf_filter_free(f) bind(C)
      type(c_ptr), intent(in), value :: f
      type(handle_type), pointer :: handle

      if (.not. c_associated(f)) return
      call c_f_pointer(f, handle)
      deallocate (handle)
   end subroutine gyroakf_filter_free

   !> An empty handle; `out` must be there.
   subroutine new_handle(handle, error, out)
      type(handle_type), pointer, intent(out) :: handle
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr), intent(in), optional :: out
      integer :: stat

      nullify (handle)
      call check_place(present(out), "result (out)", error)
      stat = 0
      if (.not. allocated(error)) allocate (handle, stat=stat)
      call check_memory(stat, "a filter", error)
   end subroutine new_handle

   !> The handle to the caller; nothing after an error.
   subroutine hand_over(handle, error, out)
      type(handle_type), pointer, intent(inout) :: handle
      type(error_type), allocatable, intent(in) :: error
      type(c_ptr), intent(inout), optional :: out

      if (allocated(error) .and. associated(handle)) deallocate (handle)
      if (.not. present(out)) return
      out = c_null_ptr
      if (associated(handle)) out = c_loc(handle)
   end subroutine hand_over

   subroutine read_coefficients(p, phi, coefficients, error)
      integer(c_int32_t), intent(in) :: p
      type(c_ptr), intent(in) :: phi
      real(dp), allocatable, intent(out) :: coefficients(:)
      type(error_type), allocatable, intent(inout) :: error
      real(c_double), pointer :: given(:)

      if (allocated(error)) return
      if (p < 0 .or. p > largest_order .or. (p > 0 .and. .not. c_associated(phi))) then
         call fatal_error(error, status%invalid_argument, &
            & "the order p must be 0 .. 1000, phi not NULL")
         return
      end if
      allocate (coefficients(p))
      if (p == 0) return
      call check_aligned(phi, error)
      if (allocated(error)) return
      call c_f_pointer(phi, given, [p])
      coefficients(:) = given
   end subroutine read_coefficients

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, error, opt)
      type(filter_options), intent(out) :: options
      !> An earlier error stays
      type(error_type), allocatable, intent(inout) :: error
      type(filter_options_c), intent(in), optional :: opt
      character(len(options%measurement_form)) :: form

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      form = options%measurement_form
      call take_text(opt%measurement_form, form, error)
      options = filter_options(opt%estimate_process_mean /= 0, opt%estimate_measurement_mean /= 0, &
         & opt%estimate_process_variance /= 0, opt%estimate_measurement_variance /= 0, &
         & opt%forgetting, form, opt%burn_in, opt%huber, opt%r_scale, opt%initial_variance, &
         & opt%q_lower, opt%q_upper, opt%r_lower, opt%r_upper, opt%allow_unobservable /= 0)
   end subroutine read_options

   !> The whole series, block by block: a block is read before its results are written.
   subroutine run_blocks(filter, z, n, x, c)
      class(filter_type), intent(inout) :: filter
      type(c_ptr), intent(in) :: z, x
      integer(int64), intent(in) :: n
      type(call_type), intent(inout) :: c
      real(c_double), pointer, contiguous :: input(:), output(:)
      real(dp) :: raw(block), filtered(block)
      integer(int64) :: first, m, stride

      call c_f_pointer(z, input, [n])
      call c_f_pointer(x, output, [n])
      stride = max(1_int64, report_samples/int(filter%order, int64)**2)
      do first = 1, n, min(int(block, int64), stride)
         if (modulo(first - 1, stride) == 0) then
            call report_progress("filtering", first - 1, n, c%error, c%callback)
         end if
         if (allocated(c%error)) return
         m = min(int(block, int64), stride, n - first + 1)
         raw(:m) = input(first:first + m - 1)
         call run_filter(filter, raw(:m), filtered(:m))
         call check_finite(filtered(:m), c%error)
         if (allocated(c%error)) return
         output(first:first + m - 1) = filtered(:m)
      end do
   end subroutine run_blocks

end module gyroakf_c_api_c_filter
