! SPDX-License-Identifier: MIT
!> The C interface to outliers, and the series without them and its trend. What the functions
!> promise is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_outliers
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int8_t, c_int32_t, c_int64_t, &
      & c_double, c_size_t, c_null_ptr, c_associated, c_f_pointer, c_sizeof
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_c_api_c_host, only : check_aligned, check_apart, progress_c
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, ok, &
      & check_place, check_finite, open_options, open_series, take_text
   implicit none (type, external)
   private
   public :: gyroakf_outlier_options_init, gyroakf_mark_outliers, gyroakf_clean
   public :: outlier_options_c, outliers_c

   !> `gyroakf_outlier_options`
   type, bind(C) :: outlier_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: method = c_null_ptr
      real(c_double) :: threshold
      integer(c_int32_t) :: rounds, half_width, degree
      type(progress_c) :: progress
   end type outlier_options_c

   !> `gyroakf_outliers`
   type, bind(C) :: outliers_c
      integer(c_int64_t) :: removed
      real(c_double) :: expected, threshold, mean, variance, corrected_variance
      integer(c_int32_t) :: rounds, converged
   end type outliers_c

contains

   subroutine gyroakf_outlier_options_init(opt) bind(C)
      type(outlier_options_c), intent(out), optional :: opt
      type(clean_options) :: defaults

      if (present(opt)) opt = outlier_options_c(c_sizeof(opt), threshold=defaults%threshold, &
         & rounds=int(defaults%max_passes, c_int32_t), degree=int(defaults%degree, c_int32_t), &
         & half_width=int(defaults%half_width, c_int32_t))
   end subroutine gyroakf_outlier_options_init

   integer(c_int) function gyroakf_mark_outliers(x, n, opt, inlier, out, err) bind(C)
      type(c_ptr), intent(in), value :: x, inlier
      integer(c_int64_t), intent(in), value :: n
      type(outlier_options_c), intent(in), optional :: opt
      type(outliers_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      real(dp), allocatable :: series(:)
      integer(int8), allocatable :: mask(:)
      integer(c_int8_t), pointer :: marks(:)

      call enter_library(c)
      call check_place(c_associated(inlier), "marks", c%error)
      call clean(c, x, n, inlier, n, series, mask, opt, out)
      if (ok(c)) then
         call c_f_pointer(inlier, marks, [n])
         marks(:) = 1_c_int8_t
         if (allocated(mask)) marks(:) = mask
      end if
      gyroakf_mark_outliers = leave_library(c, err)
   end function gyroakf_mark_outliers

   integer(c_int) function gyroakf_clean(x, n, opt, cleaned, out, err) bind(C)
      type(c_ptr), intent(in), value :: x, cleaned
      integer(c_int64_t), intent(in), value :: n
      type(outlier_options_c), intent(in), optional :: opt
      type(outliers_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      real(dp), allocatable :: series(:)
      integer(int8), allocatable :: mask(:)
      real(c_double), pointer, contiguous :: output(:)

      call enter_library(c)
      call check_place(c_associated(cleaned), "cleaned series", c%error)
      call check_aligned(cleaned, c%error)
      call clean(c, x, n, cleaned, 8*n, series, mask, opt, out)
      if (ok(c)) then
         call c_f_pointer(cleaned, output, [n])
         output(:) = series
         if (allocated(mask)) then
            where (mask == 0_int8) output = ieee_value(1.0_dp, ieee_quiet_nan)
         end if
      end if
      gyroakf_clean = leave_library(c, err)
   end function gyroakf_clean

   !> Checks what C has given, cleans the series and gives the figures.
   subroutine clean(c, x, n, place, bytes, series, mask, opt, out)
      type(call_type), intent(inout) :: c
      type(c_ptr), intent(in) :: x
      integer(c_int64_t), intent(in) :: n
      !> Where results go, and how long they are
      type(c_ptr), intent(in) :: place
      integer(c_int64_t), intent(in) :: bytes
      !> As [[clean_series]]
      real(dp), allocatable, intent(out) :: series(:)
      integer(int8), allocatable, intent(out) :: mask(:)
      type(outlier_options_c), intent(in), optional :: opt
      type(outliers_c), intent(inout), optional :: out
      type(clean_options) :: options
      type(clean_type) :: result

      if (present(opt)) call open_options(opt%struct_size, c_sizeof(opt), opt%progress, c)
      if (present(opt) .and. ok(c)) then
         call take_text(opt%method, options%method, c%error)
         options%threshold = opt%threshold
         options%max_passes = opt%rounds
         options%half_width = opt%half_width
         options%degree = opt%degree
      end if
      call open_series(x, n, c)
      call check_apart([x, place], [8*n, bytes], c%error)
      if (allocated(c%error)) return
      call clean_series(c%x, options, series, mask, result, c%error, c%valid, c%callback)
      call check_finite([result%expected, result%threshold, result%mean, result%variance, &
         & result%corrected_variance], c%error)
      if (ok(c)) call check_finite(series, c%error)
      if (allocated(c%error) .or. .not. present(out)) return
      out = outliers_c(result%removed, result%expected, result%threshold, result%mean, &
         & result%variance, result%corrected_variance, int(result%passes, c_int32_t), &
         & merge(1_c_int32_t, 0_c_int32_t, result%converged))
   end subroutine clean

end module gyroakf_c_api_c_outliers
