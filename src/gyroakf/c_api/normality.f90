! SPDX-License-Identifier: MIT
!> C: normality and quantisation. What the function promises is said in c_api/include/gyroakf.h.
module gyroakf_c_api_normality
   use, intrinsic :: iso_c_binding, only : c_ptr, c_funptr, c_int, c_int32_t, c_int64_t, c_double, c_null_ptr, c_null_funptr
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_series_moments, only : moments_type, compute_moments
   use gyroakf_series_normality, only : jarque_bera_type, test_jarque_bera, dagostino_type, test_dagostino
   use gyroakf_series_anderson_darling, only : anderson_darling_options, anderson_darling_type, test_anderson_darling
   use gyroakf_series_quantisation, only : quantisation_type, find_quantisation
   use gyroakf_progress, only : tell_progress
   use gyroakf_c_api_progress, only : callback_type
   use gyroakf_c_api_support, only : error_c, host_type, series_type, enter_library, leave_library, open_series, close_series
   implicit none (type, external)
   private
   public :: gyroakf_normality_test, gyroakf_normality_test_watched

   !> `gyroakf_normality`
   type, bind(C) :: normality_c
      real(c_double) :: skewness, skewness_error, excess_kurtosis, kurtosis_error
      real(c_double) :: jarque_bera, jarque_bera_p, dagostino_k2, dagostino_k2_p, anderson_darling, anderson_darling_p
      integer(c_int64_t) :: samples, tested
      integer(c_int32_t) :: quantised
      real(c_double) :: step, step_over_std, corrected_std
   end type normality_c

contains

   !> `gyroakf_normality_test`
   integer(c_int) function gyroakf_normality_test(x, n, most_samples, out, err) bind(C, name="gyroakf_normality_test")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n, most_samples
      type(normality_c), intent(inout), optional :: out
      type(error_c), intent(out), optional :: err

      gyroakf_normality_test = gyroakf_normality_test_watched(x, n, most_samples, out, c_null_funptr, c_null_ptr, err)
   end function gyroakf_normality_test

   !> `gyroakf_normality_test_watched`
   integer(c_int) function gyroakf_normality_test_watched(x, n, most_samples, out, progress, progress_user, err) &
      & bind(C, name="gyroakf_normality_test_watched")
      type(c_ptr), intent(in), value :: x
      integer(c_int64_t), intent(in), value :: n, most_samples
      type(normality_c), intent(inout), optional :: out
      type(c_funptr), intent(in), value :: progress
      type(c_ptr), intent(in), value :: progress_user
      type(error_c), intent(out), optional :: err
      type(host_type) :: host
      type(series_type) :: series
      type(normality_c) :: result
      type(callback_type) :: callback
      type(error_type), allocatable :: error

      call enter_library(host)
      callback = callback_type(progress, progress_user)
      if (.not. present(out)) call fatal_error(error, status%invalid_argument, "the place for the result must not be NULL")
      if (.not. allocated(error)) call open_series(x, n, series, error)
      if (.not. allocated(error)) call test_all(series, most_samples, result, callback, error)
      call close_series(series)
      if (present(out) .and. .not. allocated(error)) out = result
      gyroakf_normality_test_watched = leave_library(host, error, err)
   end function gyroakf_normality_test_watched

   !> All tests of a series.
   subroutine test_all(series, most_samples, result, callback, error)
      type(series_type), intent(in) :: series
      integer(c_int64_t), intent(in) :: most_samples
      type(normality_c), intent(out) :: result
      type(callback_type), intent(inout) :: callback
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments
      type(jarque_bera_type) :: jb
      type(dagostino_type) :: k2
      type(anderson_darling_options) :: options
      type(anderson_darling_type) :: ad
      type(quantisation_type) :: grid

      if (most_samples /= 0) options%most_samples = most_samples
      call tell_progress("normality test", 0_c_int64_t, 0_c_int64_t, error, callback)
      if (allocated(error)) return
      call compute_moments(series%x, moments, series%valid)
      call test_dagostino(moments, k2, error)
      if (.not. allocated(error)) call test_jarque_bera(moments, jb, error)
      if (.not. allocated(error)) call test_anderson_darling(series%x, options, ad, error, series%valid, callback)
      if (.not. allocated(error)) call tell_progress("steps of the samples", 0_c_int64_t, 0_c_int64_t, error, callback)
      if (.not. allocated(error)) call find_quantisation(series%x, moments%std, grid, error, series%valid)
      if (allocated(error)) return
      result = normality_c(moments%skewness, k2%skewness_error, moments%kurtosis - 3, k2%kurtosis_error, jb%statistic, &
         & jb%p_value, k2%statistic, k2%p_value, ad%modified, ad%p_value, moments%count, ad%samples, &
         & int(merge(1, 0, grid%quantised), c_int32_t), grid%step, grid%ratio, grid%corrected_std)
   end subroutine test_all

end module gyroakf_c_api_normality
