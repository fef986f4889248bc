! SPDX-License-Identifier: MIT
!> C interface, the Allan deviation and its noise coefficients. What each function promises is said
!> in c_api/include/gyroakf.h.
module gyroakf_c_api_c_allan
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_int64_t, c_double, c_size_t, &
      & c_null_ptr, c_associated, c_f_pointer, c_loc, c_sizeof
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, coefficient_type, fit_noise
   use gyroakf_c_api_c_host, only : progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, check_finite, check_struct_size, copy_c_text, open_options, open_series, &
      & take_text
   implicit none (type, external)
   private
   public :: gyroakf_allan_options_init, gyroakf_allan_new, gyroakf_allan_size, gyroakf_allan_tau, &
      & gyroakf_allan_deviation, gyroakf_allan_lower, gyroakf_allan_upper, gyroakf_allan_edf, &
      & gyroakf_allan_free
   public :: gyroakf_fit_options_init, gyroakf_noise_fit, gyroakf_allan_fit

   !> `gyroakf_allan_options`
   type, bind(C) :: allan_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: kind = c_null_ptr, taus = c_null_ptr
      real(c_double) :: confidence, min_coverage
      type(progress_c) :: progress
   end type allan_options_c

   !> `gyroakf_fit_options`
   type, bind(C) :: fit_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: terms = c_null_ptr
      real(c_double) :: tau_min, tau_max, lsb
   end type fit_options_c

   !> `gyroakf_coefficient`
   type, bind(C) :: coefficient_c
      real(c_double) :: value, std_error, upper_limit
      integer(c_int32_t) :: detected, fitted
   end type coefficient_c

   !> `gyroakf_noise`: q n b k r in the order of the terms
   type, bind(C) :: noise_c
      type(coefficient_c) :: q, n, b, k, r
      real(c_double) :: chi2_reduced
      integer(c_int32_t) :: points, left_out, cut_off, described
      real(c_double) :: tau_first, tau_last, chi2_probability, floor, kurtosis
      type(coefficient_c) :: n_unquantized
      real(c_double) :: lsb_ratio
   end type noise_c

contains

   subroutine gyroakf_allan_options_init(opt) bind(C)
      type(allan_options_c), intent(out), optional :: opt
      type(allan_options) :: defaults

      if (present(opt)) opt = allan_options_c(c_sizeof(opt), confidence=defaults%confidence, &
         & min_coverage=defaults%min_coverage)
   end subroutine gyroakf_allan_options_init

   integer(c_int) function gyroakf_allan_new(rate, n, dt, opt, out, err) bind(C)
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
      call check_place(present(out), "result (out)", c%error)
      allocate (curve, stat=stat)
      call check_memory(stat, "a deviation curve", c%error)
      call read_options(options, c, opt)
      call open_series(rate, n, c)
      if (ok(c)) call compute_allan(c%x, dt, options, curve, c%error, c%valid, c%callback)
      if (ok(c)) call check_curve(curve, c%error)
      if (present(out)) out = c_null_ptr
      if (ok(c)) out = c_loc(curve)
      if (stat == 0 .and. .not. ok(c)) deallocate (curve)
      gyroakf_allan_new = leave_library(c, err)
   end function gyroakf_allan_new

   subroutine read_options(options, c, opt)
      type(allan_options), intent(out) :: options
      type(call_type), intent(inout) :: c
      type(allan_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (.not. ok(c)) return
      call take_text(opt%kind, options%kind, c%error)
      call copy_c_text(opt%taus, "octave", options%taus)
      options%confidence = opt%confidence
      options%min_coverage = opt%min_coverage
   end subroutine read_options

   subroutine check_curve(curve, error)
      type(allan_curve_type), intent(in) :: curve
      type(error_type), allocatable, intent(inout) :: error

      call check_finite(curve%tau, error)
      call check_finite(curve%deviation, error)
      call check_finite(curve%lower, error)
      call check_finite(curve%upper, error)
      call check_finite(curve%edf, error)
   end subroutine check_curve

   integer(c_int64_t) function gyroakf_allan_size(a) bind(C)
      type(c_ptr), intent(in), value :: a
      type(allan_curve_type), pointer :: curve

      gyroakf_allan_size = 0
      if (.not. c_associated(a)) return
      call c_f_pointer(a, curve)
      gyroakf_allan_size = size(curve%tau, kind=c_int64_t)
   end function gyroakf_allan_size

   type(c_ptr) function gyroakf_allan_tau(a) bind(C)
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_tau = column_of(a, "tau")
   end function gyroakf_allan_tau

   type(c_ptr) function gyroakf_allan_deviation(a) bind(C)
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_deviation = column_of(a, "deviation")
   end function gyroakf_allan_deviation

   type(c_ptr) function gyroakf_allan_lower(a) bind(C)
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_lower = column_of(a, "lower")
   end function gyroakf_allan_lower

   type(c_ptr) function gyroakf_allan_upper(a) bind(C)
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_upper = column_of(a, "upper")
   end function gyroakf_allan_upper

   type(c_ptr) function gyroakf_allan_edf(a) bind(C)
      type(c_ptr), intent(in), value :: a

      gyroakf_allan_edf = column_of(a, "edf")
   end function gyroakf_allan_edf

   subroutine gyroakf_allan_free(a) bind(C)
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

   subroutine gyroakf_fit_options_init(opt) bind(C)
      type(fit_options_c), intent(out), optional :: opt
      type(noise_options) :: defaults

      if (present(opt)) opt = fit_options_c(c_sizeof(opt), tau_min=defaults%tau_min, &
         & tau_max=defaults%tau_max, lsb=defaults%lsb)
   end subroutine gyroakf_fit_options_init

   integer(c_int) function gyroakf_noise_fit(a, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: a
      type(fit_options_c), intent(in), optional :: opt
      type(noise_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_noise_fit = fit(a, .true., opt, out, err)
   end function gyroakf_noise_fit

   integer(c_int) function gyroakf_allan_fit(a, opt, out, err) bind(C)
      type(c_ptr), intent(in), value :: a
      type(fit_options_c), intent(in), optional :: opt
      type(noise_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_allan_fit = fit(a, .false., opt, out, err)
   end function gyroakf_allan_fit

   !> Fits the terms to a curve, whose limits change unless it is copied before.
   integer(c_int) function fit(a, copied, opt, out, err)
      type(c_ptr), intent(in) :: a
      logical, intent(in) :: copied
      type(fit_options_c), intent(in), optional :: opt
      type(noise_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(allan_curve_type), pointer :: curve
      type(allan_curve_type), allocatable, target :: copy
      type(noise_options) :: options
      type(noise_type) :: noise
      integer :: stat

      call enter_library(c)
      nullify (curve)
      if (c_associated(a)) call c_f_pointer(a, curve)
      if (.not. (associated(curve) .and. present(out))) call fatal_error(c%error, &
         & status%invalid_argument, "the curve and the pointer to the result must not be NULL")
      if (ok(c) .and. copied) then
         allocate (copy, source=curve, stat=stat)
         call check_memory(stat, "a deviation curve", c%error)
         curve => copy
      end if
      if (present(opt)) call check_struct_size(opt%struct_size, c_sizeof(opt), c%error)
      if (present(opt) .and. ok(c)) then
         call take_text(opt%terms, options%terms, c%error)
         options%tau_min = opt%tau_min
         options%tau_max = opt%tau_max
         options%lsb = opt%lsb
      end if
      if (ok(c)) call fit_noise(curve, options, noise, c%error)
      if (ok(c)) call take_noise(noise, out)
      fit = leave_library(c, err)
   end function fit

   subroutine take_noise(noise, out)
      type(noise_type), intent(in) :: noise
      type(noise_c), intent(out) :: out
      type(coefficient_c) :: term(5)

      term = coefficient_of(noise%coefficient)
      out = noise_c(term(1), term(2), term(3), term(4), term(5), noise%chi2_reduced, &
         & noise%points, noise%left_out, noise%cut_off, merge(1, 0, noise%described), &
         & noise%tau_first, noise%tau_last, noise%chi2_probability, noise%floor, &
         & noise%kurtosis, coefficient_of(noise%unquantized), noise%lsb_ratio)
   end subroutine take_noise

   elemental type(coefficient_c) function coefficient_of(c)
      type(coefficient_type), intent(in) :: c

      coefficient_of = coefficient_c(c%value, c%std_error, c%upper_limit, &
         & merge(1, 0, c%detected), merge(1, 0, c%fitted))
   end function coefficient_of

end module gyroakf_c_api_c_allan
