! SPDX-License-Identifier: MIT
!> C: the marks of outliers. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_outliers
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_int8_t, c_int32_t, c_int64_t, &
      & c_double, c_size_t, c_null_ptr, c_associated, c_f_pointer, c_sizeof
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : error_type
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_c_api_c_host, only : progress_c, callback_type
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_struct_size, check_place, check_finite, take_text, open_series
   use gyroakf_c_api_c_places, only : check_apart
   implicit none (type, external)
   private
   public :: gyroakf_outlier_options_init, gyroakf_mark_outliers

   !> `gyroakf_outlier_options`
   type, bind(C) :: outlier_options_c
      integer(c_size_t) :: struct_size
      type(c_ptr) :: method = c_null_ptr
      real(c_double) :: threshold
      integer(c_int32_t) :: rounds, half_width, degree
      type(progress_c) :: progress
   end type outlier_options_c

   !> Size of the options before they had a progress function
   integer(c_size_t), parameter :: size_before = 40

   !> `gyroakf_outliers`
   type, bind(C) :: outliers_c
      integer(c_int64_t) :: removed
      real(c_double) :: expected, threshold, mean, variance, corrected_variance
      integer(c_int32_t) :: rounds, converged
   end type outliers_c

contains

   !> `gyroakf_outlier_options_init`
   subroutine gyroakf_outlier_options_init(opt) bind(C, name="gyroakf_outlier_options_init")
      type(outlier_options_c), intent(out), optional :: opt
      type(clean_options) :: defaults

      if (present(opt)) opt = outlier_options_c(c_sizeof(opt), threshold=defaults%threshold, &
         & rounds=int(defaults%max_passes, c_int32_t), half_width=int(defaults%half_width, c_int32_t), &
         & degree=int(defaults%degree, c_int32_t))
   end subroutine gyroakf_outlier_options_init

   !> `gyroakf_mark_outliers`
   integer(c_int) function gyroakf_mark_outliers(x, n, opt, inlier, out, err) bind(C, name="gyroakf_mark_outliers")
      type(c_ptr), intent(in), value :: x, inlier
      integer(c_int64_t), intent(in), value :: n
      type(outlier_options_c), intent(in), optional :: opt
      type(outliers_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(clean_options) :: options
      type(clean_type) :: result
      real(dp), allocatable :: cleaned(:)
      integer(int8), allocatable :: mask(:)
      type(error_type), allocatable :: error

      call enter_library(c)
      call check_place(c_associated(inlier), "marks", error)
      if (.not. allocated(error)) call read_options(options, c%callback, error, opt)
      call open_series(x, n, c, error)
      call check_apart([x, inlier], [8*n, n], error)
      if (.not. allocated(error)) call clean_series(c%x, options, cleaned, mask, result, error, c%valid, &
         & c%callback)
      call check_finite([result%expected, result%threshold, result%mean, result%variance, result%corrected_variance], error)
      if (.not. allocated(error)) call write_marks(n, inlier, mask, result, out)
      gyroakf_mark_outliers = leave_library(c, error, err)
   end function gyroakf_mark_outliers

   !> Options of C into options of the library; the defaults where they are absent.
   subroutine read_options(options, callback, error, opt)
      type(clean_options), intent(out) :: options
      type(callback_type), intent(out) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(outlier_options_c), intent(in), optional :: opt

      if (.not. present(opt)) return
      call check_struct_size(opt%struct_size, c_sizeof(opt), error, size_before)
      if (allocated(error)) return
      call take_text(opt%method, options%method, error)
      options%threshold = opt%threshold
      options%max_passes = opt%rounds
      options%half_width = opt%half_width
      options%degree = opt%degree
      if (opt%struct_size == c_sizeof(opt)) callback = callback_type(opt%progress)
   end subroutine read_options

   !> The marks and the figures in C's arguments.
   subroutine write_marks(n, inlier, mask, result, out)
      integer(c_int64_t), intent(in) :: n
      type(c_ptr), intent(in) :: inlier
      integer(int8), intent(in), allocatable :: mask(:)
      type(clean_type), intent(in) :: result
      type(outliers_c), intent(inout), optional :: out
      integer(c_int8_t), pointer :: marks(:)

      call c_f_pointer(inlier, marks, [n])
      if (allocated(mask)) then
         marks(:) = mask
      else
         marks(:) = 1_c_int8_t
      end if
      if (.not. present(out)) return
      out = outliers_c(result%removed, result%expected, result%threshold, result%mean, result%variance, &
         & result%corrected_variance, int(result%passes, c_int32_t), merge(1_c_int32_t, 0_c_int32_t, result%converged))
   end subroutine write_marks

end module gyroakf_c_api_c_outliers
