! SPDX-License-Identifier: MIT
!> C: the Allan deviation. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_allan
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int64_t, c_double, c_size_t, c_null_ptr, c_funptr, &
      & c_null_funptr, c_associated, &
      & c_f_pointer, c_loc, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_c_api_c_progress, only : callback_type
   use gyroakf_c_api_c_support, only : error_c, host_type, series_type, enter_library, leave_library, check_struct_size, &
      & check_finite, copy_c_text, take_text, open_series, close_series
   implicit none (type, external)
   private
   public :: allan_handle, gyroakf_allan_options_init, gyroakf_allan_new, gyroakf_allan_size, gyroakf_allan_tau, &
      & gyroakf_allan_deviation, gyroakf_allan_lower, gyroakf_allan_upper, gyroakf_allan_edf, gyroakf_allan_free

   !> `gyroakf_allan_options`
   type, bind(C) :: allan_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: kind, taus
      real(c_double) :: confidence, min_coverage
      type(c_funptr) :: progress
      type(c_ptr) :: progress_user
   end type allan_options_c

   !> What `gyroakf_allan *` points at
   type :: allan_handle
      type(allan_curve_type) :: curve
   end type allan_handle

contains

   !> `gyroakf_allan_options_init`
   subroutine gyroakf_allan_options_init(opt) bind(C, name="gyroakf_allan_options_init")
      type(allan_options_c), intent(out), optional :: opt
      type(allan_options) :: defaults

      if (.not. present(opt)) return
      opt%struct_size = c_sizeof(opt)
      opt%kind = c_null_ptr
      opt%taus = c_null_ptr
      opt%confidence = defaults%confidence
      opt%min_coverage = defaults%min_coverage
      opt%progress = c_null_funptr
      opt%progress_user = c_null_ptr
   end subroutine gyroakf_allan_options_init

   !> `gyroakf_allan_new`
   integer(c_int) function gyroakf_allan_new(rate, n, dt, opt, out, err) bind(C, name="gyroakf_allan_new")
      type(c_ptr), intent(in), value :: rate
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(allan_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(allan_options) :: options
      type(callback_type) :: callback
      type(allan_handle), pointer :: handle
      type(error_type), allocatable :: error

      call enter_library(host)
      call new_handle(handle, error, out)
      if (.not. allocated(error)) call read_options(options, callback, error, opt)
      if (.not. allocated(error)) call open_series(rate, n, series, error)
      if (.not. allocated(error)) call compute_allan(series%x, dt, options, handle%curve, error, series%valid, callback)
      call close_series(series)
      if (.not. allocated(error)) call check_curve(handle%curve, error)
      call hand_over(handle, error, out)
      gyroakf_allan_new = leave_library(host, error, err)
   end function gyroakf_allan_new

   !> A curve holds finite numbers.
   subroutine check_curve(curve, error)
      type(allan_curve_type), intent(in) :: curve
      type(error_type), allocatable, intent(inout) :: error

      call check_finite(curve%tau, error)
      call check_finite(curve%deviation, error)
      call check_finite(curve%lower, error)
      call check_finite(curve%upper, error)
      call check_finite(curve%edf, error)
   end subroutine check_curve

   !> `gyroakf_allan_size`
   integer(c_int64_t) function gyroakf_allan_size(a) bind(C, name="gyroakf_allan_size")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_size = 0
      if (.not. c_associated(a)) return
      call c_f_pointer(a, handle)
      gyroakf_allan_size = size(handle%curve%tau, kind=c_int64_t)
   end function gyroakf_allan_size

   !> `gyroakf_allan_tau`
   type(c_ptr) function gyroakf_allan_tau(a) bind(C, name="gyroakf_allan_tau")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_tau = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, handle)
      gyroakf_allan_tau = c_loc(handle%curve%tau)
   end function gyroakf_allan_tau

   !> `gyroakf_allan_deviation`
   type(c_ptr) function gyroakf_allan_deviation(a) bind(C, name="gyroakf_allan_deviation")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_deviation = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, handle)
      gyroakf_allan_deviation = c_loc(handle%curve%deviation)
   end function gyroakf_allan_deviation

   !> `gyroakf_allan_lower`
   type(c_ptr) function gyroakf_allan_lower(a) bind(C, name="gyroakf_allan_lower")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_lower = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, handle)
      gyroakf_allan_lower = c_loc(handle%curve%lower)
   end function gyroakf_allan_lower

   !> `gyroakf_allan_upper`
   type(c_ptr) function gyroakf_allan_upper(a) bind(C, name="gyroakf_allan_upper")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_upper = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, handle)
      gyroakf_allan_upper = c_loc(handle%curve%upper)
   end function gyroakf_allan_upper

   !> `gyroakf_allan_edf`
   type(c_ptr) function gyroakf_allan_edf(a) bind(C, name="gyroakf_allan_edf")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      gyroakf_allan_edf = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, handle)
      gyroakf_allan_edf = c_loc(handle%curve%edf)
   end function gyroakf_allan_edf

   !> `gyroakf_allan_free`
   subroutine gyroakf_allan_free(a) bind(C, name="gyroakf_allan_free")
      type(c_ptr), intent(in), value :: a
      type(allan_handle), pointer :: handle

      if (.not. c_associated(a)) return
      call c_f_pointer(a, handle)
      deallocate (handle)
   end subroutine gyroakf_allan_free

   !> An empty handle; `out` must be there.
   subroutine new_handle(handle, error, out)
      type(allan_handle), pointer, intent(out) :: handle
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr), intent(in), optional :: out
      integer :: stat

      nullify (handle)
      if (.not. present(out)) then
         call fatal_error(error, status%invalid_argument, "the place for the result (out) must not be NULL")
         return
      end if
      allocate (handle, stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a deviation curve")
   end subroutine new_handle

   !> The handle to the caller; nothing after an error.
   subroutine hand_over(handle, error, out)
      type(allan_handle), pointer, intent(inout) :: handle
      type(error_type), allocatable, intent(in) :: error
      type(c_ptr), intent(inout), optional :: out

      if (allocated(error) .and. associated(handle)) deallocate (handle)
      if (.not. present(out)) return
      out = c_null_ptr
      if (associated(handle)) out = c_loc(handle)
   end subroutine hand_over

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(allan_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(allan_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error)
      if (allocated(error)) return
      call take_text(opt%kind, options%kind, error)
      call copy_c_text(opt%taus, "octave", options%taus)
      options%confidence = opt%confidence
      options%min_coverage = opt%min_coverage
      callback = callback_type(opt%progress, opt%progress_user)
   end subroutine read_options

end module gyroakf_c_api_c_allan
