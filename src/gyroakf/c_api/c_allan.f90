! SPDX-License-Identifier: MIT
!> C: the Allan deviation. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_allan
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int64_t, c_double, c_size_t, &
      & c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_c_api_c_host, only : progress_c, callback_type
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_struct_size, check_place, check_finite, copy_c_text, take_text, open_series
   implicit none (type, external)
   private
   public :: gyroakf_allan_options_init, gyroakf_allan_new, gyroakf_allan_size, gyroakf_allan_tau, &
      & gyroakf_allan_deviation, gyroakf_allan_lower, gyroakf_allan_upper, gyroakf_allan_edf, gyroakf_allan_free

   !> `gyroakf_allan_options`
   type, bind(C) :: allan_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: kind = c_null_ptr, taus = c_null_ptr
      real(c_double) :: confidence, min_coverage
      type(progress_c) :: progress
   end type allan_options_c

contains

   !> `gyroakf_allan_options_init`
   subroutine gyroakf_allan_options_init(opt) bind(C, name="gyroakf_allan_options_init")
      type(allan_options_c), intent(out), optional :: opt
      type(allan_options) :: defaults

      if (present(opt)) opt = allan_options_c(c_sizeof(opt), confidence=defaults%confidence, &
         & min_coverage=defaults%min_coverage)
   end subroutine gyroakf_allan_options_init

   !> `gyroakf_allan_new`
   integer(c_int) function gyroakf_allan_new(rate, n, dt, opt, out, err) bind(C, name="gyroakf_allan_new")
      type(c_ptr), intent(in), value :: rate
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(allan_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(allan_options) :: options
      type(allan_curve_type), pointer :: curve
      type(error_type), allocatable :: error
      integer :: stat

      call enter_library(c)
      nullify (curve)
      call check_place(present(out), "result (out)", error)
      stat = 0
      if (.not. allocated(error)) allocate (curve, stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a deviation curve")
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      call open_series(rate, n, c, error)
      if (.not. allocated(error)) call compute_allan(c%x, dt, options, curve, error, c%valid, c%callback)
      if (.not. allocated(error)) call check_curve(curve, error)
      if (allocated(error) .and. associated(curve)) deallocate (curve)
      if (present(out)) out = c_null_ptr
      if (associated(curve)) out = c_loc(curve)
      gyroakf_allan_new = leave_library(c, error, err)
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
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_size = 0
      if (.not. c_associated(a)) return
      call c_f_pointer(a, curve)
      gyroakf_allan_size = size(curve%tau, kind=c_int64_t)
   end function gyroakf_allan_size

   !> `gyroakf_allan_tau`
   type(c_ptr) function gyroakf_allan_tau(a) bind(C, name="gyroakf_allan_tau")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_tau = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      gyroakf_allan_tau = c_loc(curve%tau)
   end function gyroakf_allan_tau

   !> `gyroakf_allan_deviation`
   type(c_ptr) function gyroakf_allan_deviation(a) bind(C, name="gyroakf_allan_deviation")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_deviation = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      gyroakf_allan_deviation = c_loc(curve%deviation)
   end function gyroakf_allan_deviation

   !> `gyroakf_allan_lower`
   type(c_ptr) function gyroakf_allan_lower(a) bind(C, name="gyroakf_allan_lower")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_lower = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      gyroakf_allan_lower = c_loc(curve%lower)
   end function gyroakf_allan_lower

   !> `gyroakf_allan_upper`
   type(c_ptr) function gyroakf_allan_upper(a) bind(C, name="gyroakf_allan_upper")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_upper = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      gyroakf_allan_upper = c_loc(curve%upper)
   end function gyroakf_allan_upper

   !> `gyroakf_allan_edf`
   type(c_ptr) function gyroakf_allan_edf(a) bind(C, name="gyroakf_allan_edf")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_edf = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      gyroakf_allan_edf = c_loc(curve%edf)
   end function gyroakf_allan_edf

   !> `gyroakf_allan_free`
   subroutine gyroakf_allan_free(a) bind(C, name="gyroakf_allan_free")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      if (.not. c_associated(a)) return
      call c_f_pointer(a, curve)
      deallocate (curve)
   end subroutine gyroakf_allan_free

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
      callback = callback_type(opt%progress)
   end subroutine read_options

end module gyroakf_c_api_c_allan
