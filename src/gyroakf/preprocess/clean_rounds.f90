! SPDX-License-Identifier: MIT
!> The rounds of the cleaning: the trend of the inliers, and the outliers about it.
module gyroakf_preprocess_clean_rounds
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_preprocess_clean_types, only : clean_options, clean_type
   use gyroakf_stats_trend, only : trend_type, fit_trend, remove_trend
   use gyroakf_preprocess_outlier_rules, only : robust_centre, mark_outliers
   use gyroakf_preprocess_running_residual, only : find_coarse_step
   use gyroakf_preprocess_local_outliers, only : mark_hampel
   implicit none (type, external)
   private
   public :: run_rounds, detrend, set_mask

   !> Rounds in which a mark may be taken back
   integer, parameter :: free_rounds = 12

contains

   !> Every present sample is an inlier.
   pure subroutine set_mask(mask, valid)
      integer(int8), intent(out) :: mask(:)
      integer(int8), intent(in), optional :: valid(:)

      mask = 1_int8
      if (present(valid)) mask = merge(1_int8, 0_int8, valid /= 0_int8)
   end subroutine set_mask

   !> Fits the trend to the samples of the mask and subtracts it from all.
   subroutine detrend(x, degree, cleaned, trend, error, mask, progress)
      real(dp), intent(in), contiguous :: x(:)
      integer, intent(in) :: degree
      real(dp), intent(inout), contiguous :: cleaned(:)
      type(trend_type), intent(out) :: trend
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: mask(:)
      class(progress_type), intent(inout), optional :: progress

      call fit_trend(x, degree, trend, error, mask, progress)
      if (.not. allocated(error)) call report_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      cleaned(:) = x
      call remove_trend(trend, cleaned)
   end subroutine detrend

   !> The rounds, until nothing changes.
   subroutine run_rounds(x, options, cleaned, mask, moments, result, error, valid, progress)
      !> Series, and less its trend
      real(dp), intent(in), contiguous :: x(:)
      type(clean_options), intent(in) :: options
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing
      integer(int8), intent(inout), contiguous :: mask(:)
      !> Of the inliers, where the last round took them; else its count is 0
      type(moments_type), intent(out) :: moments
      !> threshold is set; passes, removed, converged and trend are filled
      type(clean_type), intent(inout) :: result
      !> As of fit_trend; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: changed
      real(dp) :: step, limit

      call report_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call find_coarse_step(x, step, error, valid)
      if (allocated(error)) return
      ! no limit is below that of half a quantization step, nor within rounding errors
      limit = max(0.5_dp*step*result%threshold, 16.0_dp*epsilon(x)*maxval(abs(x), mask=mask /= 0_int8))
      do while (result%passes < options%max_passes)
         result%passes = result%passes + 1
         call detrend(x, options%degree, cleaned, result%trend, error, mask, progress)
         if (.not. allocated(error)) call report_progress("cleaning", 0_int64, 0_int64, error, progress)
         if (.not. allocated(error)) call judge(cleaned, options, limit, mask, moments, changed, result, error, valid, progress)
         if (allocated(error)) return
         result%converged = changed == 0
         if (result%converged) return
         if (options%method == "hampel" .and. options%degree < 1) exit                 ! a constant changes no mark
      end do
      moments = moments_type()
      result%converged = options%method == "hampel" .and. options%degree < 1
      call detrend(x, options%degree, cleaned, result%trend, error, mask, progress)
   end subroutine run_rounds

   !> One round: marks the outliers of the detrended series.
   subroutine judge(cleaned, options, least, mask, moments, changed, result, error, valid, progress)
      real(dp), intent(in), contiguous :: cleaned(:)
      type(clean_options), intent(in) :: options
      !> Least distance of an outlier
      real(dp), intent(in) :: least
      integer(int8), intent(inout), contiguous :: mask(:)
      type(moments_type), intent(inout) :: moments
      !> Marks that changed
      integer(int64), intent(out) :: changed
      type(clean_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: centre, scale
      logical :: keep

      changed = 0
      moments = moments_type()
      keep = result%passes > free_rounds
      if (options%method == "hampel") then
         call mark_hampel(cleaned, options%half_width, result%threshold, least/result%threshold, keep, mask, changed, &
            & result%removed, error, valid, progress)
         return
      end if
      if (options%method == "mad") then
         call robust_centre(cleaned, centre, scale, error, valid, progress)
         if (allocated(error)) return
      else
         call compute_moments(cleaned, moments, mask)
         centre = moments%mean
         scale = moments%std
      end if
      call report_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call mark_outliers(cleaned, centre, max(result%threshold*scale, least), keep, mask, changed, result%removed, valid)
   end subroutine judge

end module gyroakf_preprocess_clean_rounds
