! SPDX-License-Identifier: MIT
!> The rounds of the cleaning: the trend of the inliers, and the outliers about it.
module gyroakf_preprocess_clean_rounds
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_chunks, only : threads_from
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_preprocess_clean_types, only : clean_options, clean_type
   use gyroakf_stats_trend, only : trend_type, fit_trend, detach_trend
   use gyroakf_stats_quantization, only : quantisation_step
   use gyroakf_preprocess_outlier_rules, only : robust_centre, is_repeated, mark_outliers
   use gyroakf_preprocess_local_outliers, only : mark_hampel
   implicit none (type, external)
   private
   public :: run_rounds, detrend, set_mask

   !> Rounds in which a mark may be taken back
   integer, parameter :: free_rounds = 12

   !> What a round goes by
   type :: scale_type
      !> Centre and scale of the inliers, u
      real(dp) :: centre = 0.0_dp, scale = 0.0_dp
      !> Least scale: half a quantisation step, u
      real(dp) :: floor = 0.0_dp
      !> The step of the floor was seen often enough to be one
      logical :: floor_checked = .false.
      !> Distances below it are rounding errors, u
      real(dp) :: rounding = 0.0_dp
   end type scale_type

contains

   !> Every present sample is an inlier.
   pure subroutine set_mask(mask, valid)
      !> 1 inlier: [n]
      integer(int8), intent(out) :: mask(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      mask = 1_int8
      if (present(valid)) mask = merge(1_int8, 0_int8, valid /= 0_int8)
   end subroutine set_mask

   !> Fits the trend to the samples of the mask and subtracts it from all.
   subroutine detrend(x, degree, cleaned, trend, error, mask, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> Degree
      integer, intent(in) :: degree
      !> Series less trend
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> The trend
      type(trend_type), intent(out) :: trend
      !> As of fit_trend
      type(error_type), allocatable, intent(out) :: error
      !> 1 inlier, 0 outlier or missing
      integer(int8), intent(in), optional :: mask(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress

      call fit_trend(x, degree, trend, error, mask, progress)
      if (.not. allocated(error)) call tell_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (.not. allocated(error)) call detach_trend(trend, x, cleaned)
   end subroutine detrend

   !> The rounds, until nothing changes.
   subroutine run_rounds(x, options, cleaned, mask, moments, result, error, valid, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The options
      type(clean_options), intent(in) :: options
      !> Series less trend
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing
      integer(int8), intent(inout), contiguous :: mask(:)
      !> Of the inliers, where the last round took them; else its count is 0
      type(moments_type), intent(out) :: moments
      !> threshold is set; passes, removed, converged and trend are filled
      type(clean_type), intent(inout) :: result
      !> As of fit_trend; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(scale_type) :: scale
      integer(int64) :: changed
      real(dp) :: largest

      call tell_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call quantisation_step(x, scale%floor, largest, valid)
      scale%floor = 0.5_dp*scale%floor
      scale%rounding = 16.0_dp*epsilon(x)*largest
      do while (result%passes < options%max_passes)
         result%passes = result%passes + 1
         call detrend(x, options%degree, cleaned, result%trend, error, mask, progress)
         if (.not. allocated(error)) call tell_progress("cleaning", 0_int64, 0_int64, error, progress)
         if (.not. allocated(error)) call judge(x, cleaned, options, scale, mask, moments, changed, result, error, valid, progress)
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
   subroutine judge(x, cleaned, options, scale, mask, moments, changed, result, error, valid, progress)
      !> Series, and less its trend: [n]
      real(dp), intent(in), contiguous :: x(:), cleaned(:)
      !> The options
      type(clean_options), intent(in) :: options
      !> What the round goes by
      type(scale_type), intent(inout) :: scale
      !> The marks: [n]
      integer(int8), intent(inout), contiguous :: mask(:)
      !> Of the inliers before, where the rule goes by them
      type(moments_type), intent(inout) :: moments
      !> Marks that changed
      integer(int64), intent(out) :: changed
      !> removed
      type(clean_type), intent(inout) :: result
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: limit
      logical :: keep

      changed = 0
      moments = moments_type()
      keep = result%passes > free_rounds
      if (options%method == "hampel") then
         call check_floor(x, -1.0_dp, scale, valid)
         limit = max(scale%floor, scale%rounding/result%threshold)
         call mark_hampel(cleaned, options%half_width, result%threshold, limit, mask, changed, result%removed, error, valid, &
            & progress, keep)
         return
      end if
      if (options%method == "mad") then
         call robust_centre(cleaned, 0.0_dp, scale%centre, scale%scale, error, valid, progress)
         if (allocated(error)) return
      else
         call compute_moments(cleaned, moments, mask)
         scale%centre = moments%mean
         scale%scale = moments%std
      end if
      call check_floor(x, scale%scale, scale, valid)
      call tell_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      limit = max(result%threshold*max(scale%scale, scale%floor), scale%rounding)
      call mark_outliers(cleaned, scale%centre, limit, keep, mask, changed, result%removed, valid)
   end subroutine judge

   !> A floor that counts must come from a step that is seen again and again; two glitches of a dead sensor make none.
   subroutine check_floor(x, other, scale, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The scale that the floor would raise
      real(dp), intent(in) :: other
      !> Its floor is 0 where there is no such step
      type(scale_type), intent(inout) :: scale
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      if (scale%floor_checked .or. other >= scale%floor) return
      scale%floor_checked = .true.
      if (.not. is_repeated(x, 2.0_dp*scale%floor, valid)) scale%floor = 0.0_dp
   end subroutine check_floor

end module gyroakf_preprocess_clean_rounds
