! SPDX-License-Identifier: MIT
!> The C interface to the noise coefficients of a deviation curve. What the function promises is
!> said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_noise
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int32_t, c_double, c_size_t, &
      & c_null_ptr, c_associated, c_f_pointer, c_sizeof
   use gyroakf_error, only : fatal_error, status
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, coefficient_type, fit_noise
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_struct_size, take_text
   implicit none (type, external)
   private
   public :: gyroakf_fit_options_init, gyroakf_noise_fit, gyroakf_allan_fit

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
      integer(c_int32_t) :: points, left_out
      integer(c_int32_t) :: cut_off, described
      real(c_double) :: tau_first, tau_last, chi2_probability, floor, kurtosis
      type(coefficient_c) :: n_unquantized
      real(c_double) :: lsb_ratio
   end type noise_c

contains

   !> `gyroakf_fit_options_init`
   subroutine gyroakf_fit_options_init(opt) bind(C, name="gyroakf_fit_options_init")
      type(fit_options_c), intent(out), optional :: opt
      type(noise_options) :: defaults

      if (present(opt)) opt = fit_options_c(c_sizeof(opt), tau_min=defaults%tau_min, &
         & tau_max=defaults%tau_max, lsb=defaults%lsb)
   end subroutine gyroakf_fit_options_init

   !> `gyroakf_noise_fit`
   integer(c_int) function gyroakf_noise_fit(a, opt, out, err) bind(C, name="gyroakf_noise_fit")
      type(c_ptr), intent(in), value :: a
      type(fit_options_c), intent(in), optional :: opt
      type(noise_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(allan_curve_type), pointer :: curve
      type(allan_curve_type), allocatable :: copy
      integer :: stat

      call enter_library(c)
      call open_curve(a, present(out), curve, c)
      if (ok(c)) then
         allocate (copy, source=curve, stat=stat)
         if (stat /= 0) call fatal_error(c%error, status%no_memory, &
            & "no memory for a deviation curve")
      end if
      if (ok(c)) call fit(copy, out, c, opt)
      gyroakf_noise_fit = leave_library(c, err)
   end function gyroakf_noise_fit

   !> `gyroakf_allan_fit`
   integer(c_int) function gyroakf_allan_fit(a, opt, out, err) bind(C, name="gyroakf_allan_fit")
      type(c_ptr), intent(in), value :: a
      type(fit_options_c), intent(in), optional :: opt
      type(noise_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(allan_curve_type), pointer :: curve

      call enter_library(c)
      call open_curve(a, present(out), curve, c)
      if (ok(c)) call fit(curve, out, c, opt)
      gyroakf_allan_fit = leave_library(c, err)
   end function gyroakf_allan_fit

   subroutine open_curve(a, has_out, curve, c)
      type(c_ptr), intent(in) :: a
      logical, intent(in) :: has_out
      type(allan_curve_type), pointer, intent(out) :: curve
      type(call_type), intent(inout) :: c

      nullify (curve)
      if (c_associated(a)) call c_f_pointer(a, curve)
      if (.not. (associated(curve) .and. has_out)) call fatal_error(c%error, &
         & status%invalid_argument, "the curve and the place for the result must not be NULL")
   end subroutine open_curve

   !> Fits the terms to a curve, whose limits change.
   subroutine fit(curve, out, c, opt)
      type(allan_curve_type), intent(inout) :: curve
      type(noise_c), intent(inout) :: out
      type(call_type), intent(inout) :: c
      type(fit_options_c), intent(in), optional :: opt
      type(noise_options) :: options
      type(noise_type) :: noise

      if (present(opt)) call check_struct_size(opt%struct_size, c_sizeof(opt), c%error)
      if (present(opt) .and. ok(c)) then
         call take_text(opt%terms, options%terms, c%error)
         options%tau_min = opt%tau_min
         options%tau_max = opt%tau_max
         options%lsb = opt%lsb
      end if
      if (ok(c)) call fit_noise(curve, options, noise, c%error)
      if (allocated(c%error)) return
      associate (term => coefficient_of(noise%coefficient))
         out = noise_c(term(1), term(2), term(3), term(4), term(5), noise%chi2_reduced, &
            & noise%points, noise%left_out, noise%cut_off, merge(1, 0, noise%described), &
            & noise%tau_first, noise%tau_last, noise%chi2_probability, noise%floor, &
            & noise%kurtosis, coefficient_of(noise%unquantized), noise%lsb_ratio)
      end associate
   end subroutine fit

   elemental type(coefficient_c) function coefficient_of(c)
      type(coefficient_type), intent(in) :: c

      coefficient_of = coefficient_c(c%value, c%std_error, c%upper_limit, &
         & merge(1, 0, c%detected), merge(1, 0, c%fitted))
   end function coefficient_of

end module gyroakf_c_api_c_noise
