! SPDX-License-Identifier: MIT
!> C: the Allan deviation. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_allan
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int64_t, c_double, c_size_t, &
      & c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_error, only : fatal_error, status
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_c_api_c_host, only : progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, check_finite, copy_c_text, open_options, open_series, take_text
   implicit none (type, external)
   private
   public :: gyroakf_allan_options_init, gyroakf_allan_new, gyroakf_allan_size, gyroakf_allan_tau, &
      & gyroakf_allan_deviation, gyroakf_allan_lower, gyroakf_allan_upper, gyroakf_allan_edf, &
      & gyroakf_allan_free

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
   integer(c_int) function gyroakf_allan_new(rate, n, dt, opt, out, err) &
      & bind(C, name="gyroakf_allan_new")
      type(c_ptr), intent(in), value :: rate
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      type(allan_options_c), intent(in), optional :: opt
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(allan_options) :: options
      type(allan_curve_type), pointer :: curve
      integer :: stat

      call enter_library(c)
      nullify (curve)
      call check_place(present(out), "result (out)", c%error)
      allocate (curve, stat=stat)
      if (stat /= 0) call fatal_error(c%error, status%no_memory, "no memory for a deviation curve")
      if (present(opt)) call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (present(opt) .and. ok(c)) then
         call take_text(opt%kind, options%kind, c%error)
         call copy_c_text(opt%taus, "octave", options%taus)
         options%confidence = opt%confidence
         options%min_coverage = opt%min_coverage
      end if
      call open_series(rate, n, c)
      if (ok(c)) call compute_allan(c%x, dt, options, curve, c%error, c%valid, c%callback)
      if (ok(c)) then
         call check_finite(curve%tau, c%error)
         call check_finite(curve%deviation, c%error)
         call check_finite(curve%lower, c%error)
         call check_finite(curve%upper, c%error)
         call check_finite(curve%edf, c%error)
      end if
      if (allocated(c%error) .and. associated(curve)) deallocate (curve)
      if (present(out)) out = c_null_ptr
      if (associated(curve)) out = c_loc(curve)
      gyroakf_allan_new = leave_library(c, err)
   end function gyroakf_allan_new

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

      gyroakf_allan_tau = column_of(a, "tau")
   end function gyroakf_allan_tau

   !> `gyroakf_allan_deviation`
   type(c_ptr) function gyroakf_allan_deviation(a) bind(C, name="gyroakf_allan_deviation")
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_deviation = column_of(a, "deviation")
   end function gyroakf_allan_deviation

   !> `gyroakf_allan_lower`
   type(c_ptr) function gyroakf_allan_lower(a) bind(C, name="gyroakf_allan_lower")
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_lower = column_of(a, "lower")
   end function gyroakf_allan_lower

   !> `gyroakf_allan_upper`
   type(c_ptr) function gyroakf_allan_upper(a) bind(C, name="gyroakf_allan_upper")
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_upper = column_of(a, "upper")
   end function gyroakf_allan_upper

   !> `gyroakf_allan_edf`
   type(c_ptr) function gyroakf_allan_edf(a) bind(C, name="gyroakf_allan_edf")
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_edf = column_of(a, "edf")
   end function gyroakf_allan_edf

   !> `gyroakf_allan_free`
   subroutine gyroakf_allan_free(a) bind(C, name="gyroakf_allan_free")
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      if (.not. c_associated(a)) return
      call c_f_pointer(a, curve)
      deallocate (curve)
   end subroutine gyroakf_allan_free

   !> One of the arrays of a curve; NULL where it is empty.
   type(c_ptr) function column_of(a, name) result(column)
      type(c_ptr), intent(in) :: a
      character(*), intent(in) :: name
      type(allan_curve_type), pointer :: curve

      column = c_null_ptr
      if (gyroakf_allan_size(a) == 0) return
      call c_f_pointer(a, curve)
      select case (name)
      case ("tau"); column = c_loc(curve%tau)
      case ("deviation"); column = c_loc(curve%deviation)
      case ("lower"); column = c_loc(curve%lower)
      case ("upper"); column = c_loc(curve%upper)
      case default; column = c_loc(curve%edf)
      end select
   end function column_of

end module gyroakf_c_api_c_allan
