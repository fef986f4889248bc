! SPDX-License-Identifier: MIT
!> C: what is periodic in a series. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_periodicity
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int64_t, c_double, &
      & c_null_ptr, c_null_funptr
   use gyroakf_error, only : error_type
   use gyroakf_stats_fisher, only : fisher_type, test_fisher_g
   use gyroakf_stats_welch, only : welch_options, welch_type, welch_spectrum, default_segment
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_place, check_finite, open_series
   use gyroakf_c_api_c_places, only : check_aligned, check_apart, copy_out
   implicit none (type, external)
   private
   public :: gyroakf_fisher_g, gyroakf_fisher_g_watched, gyroakf_welch_size, gyroakf_welch_spectrum, &
      & gyroakf_welch_spectrum_watched

   !> `gyroakf_fisher`
   type, bind(C) :: fisher_c
      real(c_double) :: statistic, p_value, log_p_value, frequency
      integer(c_int64_t) :: ordinates
   end type fisher_c

contains

   !> `gyroakf_fisher_g`
   integer(c_int) function gyroakf_fisher_g(x, n, out, err) bind(C, name="gyroakf_fisher_g")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(fisher_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_fisher_g = gyroakf_fisher_g_watched(x, n, out, c_null_funptr, c_null_ptr, err)
   end function gyroakf_fisher_g

   !> `gyroakf_fisher_g_watched`
   integer(c_int) function gyroakf_fisher_g_watched(x, n, out, progress, progress_user, err) &
      & bind(C, name="gyroakf_fisher_g_watched")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      type(fisher_c), intent(inout), optional :: out
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(fisher_type) :: result
      type(error_type), allocatable :: error

      call enter_library(c, progress, progress_user)
      call check_place(present(out), "result", error)
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call test_fisher_g(c%x, result, error, c%valid, c%callback)
      call check_finite([result%statistic, result%p_value, result%log_p_value, result%frequency], error)
      if (.not. allocated(error)) out = fisher_c(result%statistic, result%p_value, result%log_p_value, result%frequency, &
         & result%ordinates)
      gyroakf_fisher_g_watched = leave_library(c, error, err)
   end function gyroakf_fisher_g_watched

   !> `gyroakf_welch_size`
   integer(c_int64_t) function gyroakf_welch_size(n, segment) bind(C, name="gyroakf_welch_size")
      integer(c_int64_t), intent(in), value :: n, segment

      gyroakf_welch_size = 0
      if (n < 2 .or. segment < 0 .or. segment == 1 .or. segment > n) return
      gyroakf_welch_size = segment/2 + 1
      if (segment == 0) gyroakf_welch_size = default_segment(n)/2 + 1
   end function gyroakf_welch_size

   !> `gyroakf_welch_spectrum`
   integer(c_int) function gyroakf_welch_spectrum(x, n, dt, segment, frequency, density, degrees_of_freedom, err) &
      & bind(C, name="gyroakf_welch_spectrum")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      integer(c_int64_t), intent(in), value :: segment
      type(c_ptr), intent(in), value :: frequency, density
      real(c_double), intent(inout), optional :: degrees_of_freedom
      type(error_c), intent(out), optional :: err

      gyroakf_welch_spectrum = gyroakf_welch_spectrum_watched(x, n, dt, segment, frequency, density, degrees_of_freedom, &
         & c_null_funptr, c_null_ptr, err)
   end function gyroakf_welch_spectrum

   !> `gyroakf_welch_spectrum_watched`
   integer(c_int) function gyroakf_welch_spectrum_watched(x, n, dt, segment, frequency, density, degrees_of_freedom, &
      & progress, progress_user, err) &
      & bind(C, name="gyroakf_welch_spectrum_watched")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      real(c_double), intent(in), value :: dt
      integer(c_int64_t), intent(in), value :: segment
      type(c_ptr), intent(in), value :: frequency, density
      real(c_double), intent(inout), optional :: degrees_of_freedom
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(welch_type) :: result
      type(error_type), allocatable :: error
      integer(c_int64_t) :: places

      call enter_library(c, progress, progress_user)
      call check_aligned(frequency, error)
      call check_aligned(density, error)
      call open_series(x, n, c, error)
      places = gyroakf_welch_size(n, segment)
      call check_apart([x, frequency, density], 8*[n, places, places], error)
      if (.not. allocated(error)) call welch_spectrum(c%x, dt, welch_options(segment=segment), result, error, &
         & c%valid, c%callback)
      if (.not. allocated(error)) call check_finite(result%frequency, error)
      if (.not. allocated(error)) call check_finite(result%density, error)
      if (.not. allocated(error)) then
         call copy_out(result%frequency, frequency)
         call copy_out(result%density, density)
         if (present(degrees_of_freedom)) degrees_of_freedom = result%degrees_of_freedom
      end if
      gyroakf_welch_spectrum_watched = leave_library(c, error, err)
   end function gyroakf_welch_spectrum_watched

end module gyroakf_c_api_c_periodicity
