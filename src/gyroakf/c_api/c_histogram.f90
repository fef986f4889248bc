! SPDX-License-Identifier: MIT
!> C: the histogram. What each function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_c_histogram
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, &
      & c_null_ptr, c_null_funptr, c_associated, c_f_pointer, c_loc
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_quantization, only : quantisation_type, find_quantisation
   use gyroakf_stats_histogram, only : histogram_options, histogram_type, compute_histogram
   use gyroakf_progress, only : tell_progress
   use gyroakf_c_api_c_support, only : error_c, call_type, enter_library, leave_library, &
      & check_place, check_finite, open_series
   implicit none (type, external)
   private
   public :: gyroakf_histogram_new, gyroakf_histogram_new_watched, gyroakf_histogram_bins, &
      & gyroakf_histogram_edges, gyroakf_histogram_counts, gyroakf_histogram_expected, gyroakf_histogram_outside, &
      & gyroakf_histogram_free

contains

   !> `gyroakf_histogram_new`
   integer(c_int) function gyroakf_histogram_new(x, n, most_bins, out, err) bind(C, name="gyroakf_histogram_new")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: most_bins
      type(c_ptr), intent(out), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_histogram_new = gyroakf_histogram_new_watched(x, n, most_bins, out, c_null_funptr, c_null_ptr, err)
   end function gyroakf_histogram_new

   !> `gyroakf_histogram_new_watched`
   integer(c_int) function gyroakf_histogram_new_watched(x, n, most_bins, out, progress, progress_user, err) &
      & bind(C, name="gyroakf_histogram_new_watched")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n
      integer(c_int32_t), intent(in), value :: most_bins
      type(c_ptr), intent(out), optional :: out
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(call_type) :: c
      type(histogram_type), pointer :: histogram
      type(error_type), allocatable :: error
      integer :: stat

      call enter_library(c, progress, progress_user)
      nullify (histogram)
      call check_place(present(out), "result (out)", error)
      stat = 0
      if (.not. allocated(error)) allocate (histogram, stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a histogram")
      call open_series(x, n, c, error)
      if (.not. allocated(error)) call count_series(c, most_bins, histogram, error)
      if (allocated(error) .and. associated(histogram)) deallocate (histogram)
      if (present(out)) out = c_null_ptr
      if (associated(histogram)) out = c_loc(histogram)
      gyroakf_histogram_new_watched = leave_library(c, error, err)
   end function gyroakf_histogram_new_watched

   !> Moments, grid, bins.
   subroutine count_series(c, most_bins, histogram, error)
      type(call_type), intent(inout) :: c
      integer(c_int32_t), intent(in) :: most_bins
      type(histogram_type), intent(inout) :: histogram
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments
      type(quantisation_type) :: grid
      type(histogram_options) :: options

      if (most_bins /= 0) options%most_bins = most_bins
      call tell_progress("histogram", 0_c_int64_t, 0_c_int64_t, error, c%callback)
      if (allocated(error)) return
      call compute_moments(c%x, moments, c%valid)
      call find_quantisation(c%x, moments%std, grid, error, c%valid)
      if (.not. allocated(error)) call tell_progress("histogram", 0_c_int64_t, 0_c_int64_t, error, c%callback)
      if (allocated(error)) return
      options%step = grid%step
      call compute_histogram(c%x, moments, options, histogram, error, c%valid)
      if (allocated(error)) return
      call check_finite(histogram%edge, error)
      call check_finite(histogram%expected, error)
   end subroutine count_series

   !> `gyroakf_histogram_bins`
   integer(c_int32_t) function gyroakf_histogram_bins(h) bind(C, name="gyroakf_histogram_bins")
      type(c_ptr), intent(in), value :: h
      type(histogram_type), pointer :: histogram

      gyroakf_histogram_bins = 0
      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      gyroakf_histogram_bins = size(histogram%count, kind=c_int32_t)
   end function gyroakf_histogram_bins

   !> `gyroakf_histogram_edges`
   type(c_ptr) function gyroakf_histogram_edges(h) bind(C, name="gyroakf_histogram_edges")
      type(c_ptr), intent(in), value :: h
      type(histogram_type), pointer :: histogram

      gyroakf_histogram_edges = c_null_ptr
      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      gyroakf_histogram_edges = c_loc(histogram%edge)
   end function gyroakf_histogram_edges

   !> `gyroakf_histogram_counts`
   type(c_ptr) function gyroakf_histogram_counts(h) bind(C, name="gyroakf_histogram_counts")
      type(c_ptr), intent(in), value :: h
      type(histogram_type), pointer :: histogram

      gyroakf_histogram_counts = c_null_ptr
      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      gyroakf_histogram_counts = c_loc(histogram%count)
   end function gyroakf_histogram_counts

   !> `gyroakf_histogram_expected`
   type(c_ptr) function gyroakf_histogram_expected(h) bind(C, name="gyroakf_histogram_expected")
      type(c_ptr), intent(in), value :: h
      type(histogram_type), pointer :: histogram

      gyroakf_histogram_expected = c_null_ptr
      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      gyroakf_histogram_expected = c_loc(histogram%expected)
   end function gyroakf_histogram_expected

   !> `gyroakf_histogram_outside`
   subroutine gyroakf_histogram_outside(h, below, above) bind(C, name="gyroakf_histogram_outside")
      type(c_ptr), intent(in), value :: h
      integer(c_int64_t), intent(out), optional :: below, above
      type(histogram_type), pointer :: histogram

      if (present(below)) below = 0
      if (present(above)) above = 0
      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      if (present(below)) below = histogram%below
      if (present(above)) above = histogram%above
   end subroutine gyroakf_histogram_outside

   !> `gyroakf_histogram_free`
   subroutine gyroakf_histogram_free(h) bind(C, name="gyroakf_histogram_free")
      type(c_ptr), intent(in), value :: h
      type(histogram_type), pointer :: histogram

      if (.not. c_associated(h)) return
      call c_f_pointer(h, histogram)
      deallocate (histogram)
   end subroutine gyroakf_histogram_free

end module gyroakf_c_api_c_histogram
