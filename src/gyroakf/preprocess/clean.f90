! SPDX-License-Identifier: MIT
!> Cleaning of a series: outliers and polynomial trend jointly.
module gyroakf_preprocess_clean
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_autocovariance, only : check_series
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_trend, only : trend_type, remove_trend, largest_degree
   use gyroakf_stats_trend_fit, only : fit_trend
   use gyroakf_preprocess_auto_outliers, only : find_auto_outliers
   use gyroakf_preprocess_outlier_rules, only : check_method, default_threshold, &
      & mark_outliers, robust_center
   use gyroakf_preprocess_local_outliers, only : largest_half_width, mark_hampel
   use gyroakf_preprocess_truncation, only : expected_false_alarms, truncated_deviation, final_cut
   use gyroakf_preprocess_running_residual, only : find_coarse_step
   implicit none (type, external)
   private
   public :: clean_options, clean_type, clean_series

   !> What is removed
   type :: clean_options
      !> Degree of the trend, -1 .. 9; -1 keeps it, outliers are then those about the mean or median
      integer :: degree = 3
      !> Outliers: none, auto, pauta, mad, hampel (see gyroakf_preprocess_outlier_rules)
      character(6) :: method = "auto"
      !> Threshold in standard deviations, > 0; 0: the method's own
      real(dp) :: threshold = 0.0_dp
      !> Most rounds, >= 1; 1: what is marked by a single pass over all samples
      integer :: max_passes = 20
      !> Of hampel: samples on either side that a sample is compared with, 1 .. 100,000
      integer :: half_width = 25
   end type clean_options

   !> What was removed, in the unit u of the series
   type :: clean_type
      !> Method used
      character(6) :: method = "none"
      !> Threshold used (in the last round), in standard deviations; 0 with none
      real(dp) :: threshold = 0.0_dp
      !> Rounds; the last one changed nothing where converged
      integer :: passes = 0
      !> Outliers marked
      integer(int64) :: removed = 0
      !> Outliers over the samples that were present before
      real(dp) :: fraction = 0.0_dp
      !> Their 1-based indices, ascending: [removed]
      integer(int64), allocatable :: outlier(:)
      !> The trend that was subtracted
      type(trend_type) :: trend
      !> Mean of the cleaned series, u
      real(dp) :: mean = 0.0_dp
      !> Its variance with divisor count - 1, u^2
      real(dp) :: variance = 0.0_dp
      !> .false.: the marks still changed in the last round
      logical :: converged = .true.
      !> Samples that the rule marks on average of white normal noise of this length
      real(dp) :: expected = 0.0_dp
      !> The variance of normal noise that the cleaned series was cut from, u^2: the variance over
      !> the share that cutting leaves of it (see gyroakf_preprocess_truncation); a statement,
      !> nothing uses it. 0 where it is not known (hampel)
      real(dp) :: corrected_variance = 0.0_dp
      !> Samples on either side, with hampel; else 0
      integer :: half_width = 0
      !> With auto: first and last sample of each stretch of motion, which is left: [2, stretches]
      integer(int64), allocatable :: motion(:, :)
   end type clean_type

   !> Rounds in which a mark may be taken back
   integer, parameter :: free_rounds = 12

contains

   !> Marks outliers as missing and subtracts the trend.
   !>
   !> `auto` looks for outliers about a running median ([[find_auto_outliers]]); the trend is fitted
   !> to what is left. The other rules judge by the distance from the trend, in rounds: each fits
   !> the trend to the inliers and judges every present sample, so that one marked by mistake comes
   !> back, until the marks stay. After twelve rounds no mark is taken back, which ends the rounds
   !> where samples at the very limit would go to and fro. Where they end before the marks stay, the
   !> trend is fitted once more, to what is left. No scale of theirs is less than half a
   !> quantization step ([[find_coarse_step]]): a record that sits on one level and now and then on
   !> the next has no outliers. Memory: the results, 9 bytes a sample.
   subroutine clean_series(x, options, cleaned, present_out, result, error, valid, progress)
      !> Series: [n], n >= 1, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> What is removed
      type(clean_options), intent(in) :: options
      !> Series less its trend, 0 where missing: [n]
      real(dp), allocatable, intent(out) :: cleaned(:)
      !> 1 present, 0 missing or an outlier: [n]; allocated only where there is such a sample
      integer(int8), allocatable, intent(out) :: present_out(:)
      !> What was removed
      type(clean_type), intent(out) :: result
      !> invalid_argument, too_few_samples, singular, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(moments_type) :: moments
      real(dp) :: z
      integer(int64) :: found
      integer :: stat

      call check_options(x, options, found, error, valid)
      if (allocated(error)) return
      allocate (cleaned(size(x, kind=int64)), stat=stat)
      if (stat == 0 .and. (present(valid) .or. options%method /= "none")) allocate ( &
         & present_out(size(x, kind=int64)), stat=stat)
      call check_memory(stat, "the cleaned series", error)
      if (allocated(error)) return
      if (allocated(present_out)) present_out = 1_int8
      if (present(valid)) present_out = merge(1_int8, 0_int8, valid /= 0_int8)
      result%method = options%method
      if (options%method == "hampel") result%half_width = options%half_width
      if (options%method /= "none") result%threshold = options%threshold
      if (.not. options%threshold > 0.0_dp) result%threshold = default_threshold( &
         & trim(options%method), found)
      select case (options%method)
      case ("none")
         call detrend(x, options%degree, cleaned, result%trend, error, valid, progress)
      case ("auto")
         z = result%threshold
         call find_auto_outliers(x, z, present_out, result%threshold, result%motion, error, valid, &
            & progress)
         if (allocated(error)) return
         result%passes = 1
         result%removed = found - count(present_out /= 0_int8, kind=int64)
         call detrend(x, options%degree, cleaned, result%trend, error, present_out, progress)
      case default
         call run_rounds(x, options, cleaned, present_out, moments, result, error, valid, progress)
      end select
      if (.not. allocated(error)) call still_cleaning(error, progress)
      if (.not. allocated(error)) call finish(cleaned, present_out, found, options%max_passes, &
         & moments, result, error, valid)
   end subroutine clean_series

   !> Asks the callback whether to go on.
   subroutine still_cleaning(error, progress)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress

      call report_progress("cleaning", 0_int64, 0_int64, error, progress)
   end subroutine still_cleaning

   !> Refuses options out of range and a series without a present sample.
   subroutine check_options(x, options, found, error, valid)
      real(dp), intent(in) :: x(:)
      type(clean_options), intent(in) :: options
      integer(int64), intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text
      logical :: good

      found = size(x, kind=int64)
      call check_method(trim(options%method), error)
      if (allocated(error)) return
      good = ieee_is_finite(options%threshold)
      if (good) good = options%threshold >= 0.0_dp
      if (.not. good) then
         call fatal_error(error, status%invalid_argument, &
            & "the outlier threshold must be positive, or 0 for the method's own")
      else if (options%max_passes < 1) then
         call fatal_error(error, status%invalid_argument, &
            & "at least one round is needed to find outliers")
      else if (options%half_width < 1 .or. options%half_width > largest_half_width) then
         write (text, "(2(a, i0))") "the half-width of the window must be 1 .. ", &
            & largest_half_width, ", it is ", options%half_width
         call fatal_error(error, status%invalid_argument, trim(text))
      else if (options%degree < -1 .or. options%degree > largest_degree) then
         write (text, "(2(a, i0))") "the degree of the trend must be -1 .. ", largest_degree, &
            & ", it is ", options%degree
         call fatal_error(error, status%invalid_argument, trim(text))
      else
         if (found > 0) call check_series(found, 0, error, valid)
         if (allocated(error)) return
         if (present(valid)) found = count(valid /= 0_int8, kind=int64)
         if (found < 1) call fatal_error(error, status%too_few_samples, &
            & "no sample of the series is present")
      end if
   end subroutine check_options

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
      if (.not. allocated(error)) call still_cleaning(error, progress)
      if (allocated(error)) return
      cleaned(:) = x
      call remove_trend(trend, cleaned)
   end subroutine detrend

   !> The rounds, until nothing changes.
   subroutine run_rounds(x, options, cleaned, mask, moments, result, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(clean_options), intent(in) :: options
      real(dp), intent(inout), contiguous :: cleaned(:)
      integer(int8), intent(inout), contiguous :: mask(:)
      !> Of the inliers, where the last round took them; else its count is 0
      type(moments_type), intent(out) :: moments
      !> threshold is set; passes, removed, converged and trend are filled
      type(clean_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: changed
      real(dp) :: step, limit, center, scale
      logical :: keep

      call still_cleaning(error, progress)
      if (.not. allocated(error)) call find_coarse_step(x, step, error, valid)
      if (allocated(error)) return
      ! no limit is below that of half a quantization step, nor within rounding errors
      limit = max(0.5_dp*step*result%threshold, &
         & 16.0_dp*epsilon(x)*maxval(abs(x), mask=mask /= 0_int8))
      do while (result%passes < options%max_passes)
         result%passes = result%passes + 1
         keep = result%passes > free_rounds
         call detrend(x, options%degree, cleaned, result%trend, error, mask, progress)
         if (.not. allocated(error)) call still_cleaning(error, progress)
         if (allocated(error)) return
         select case (options%method)
         case ("hampel")
            call mark_hampel(cleaned, options%half_width, result%threshold, &
               & limit/result%threshold, keep, mask, changed, result%removed, error, valid, &
               & progress)
         case ("mad")
            call robust_center(cleaned, center, scale, error, valid, progress)
         case default
            call compute_moments(cleaned, moments, mask)
            center = moments%mean
            scale = moments%std
         end select
         if (.not. allocated(error)) call still_cleaning(error, progress)
         if (allocated(error)) return
         if (options%method /= "hampel") call mark_outliers(cleaned, center, &
            & max(result%threshold*scale, limit), keep, mask, changed, result%removed, valid)
         result%converged = changed == 0
         if (result%converged) return
         result%converged = options%method == "hampel" .and. options%degree < 1
         if (result%converged) exit                                  ! a constant changes no mark
      end do
      moments = moments_type()
      call detrend(x, options%degree, cleaned, result%trend, error, mask, progress)
   end subroutine run_rounds

   !> Indices of the outliers, 0 where missing, mean and variance.
   subroutine finish(cleaned, mask, found, max_passes, moments, result, error, valid)
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing; deallocated where everything is present
      integer(int8), allocatable, intent(inout) :: mask(:)
      integer(int64), intent(in) :: found
      integer, intent(in) :: max_passes
      type(moments_type), intent(inout) :: moments
      type(clean_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, k
      integer :: stat

      result%fraction = real(result%removed, dp)/real(found, dp)
      allocate (result%outlier(result%removed), stat=stat)
      call check_memory(stat, "the list of outliers", error)
      if (allocated(error)) return
      if (allocated(mask)) then
         k = 0
         do i = 1, size(mask, kind=int64)
            if (mask(i) /= 0_int8) cycle
            cleaned(i) = 0.0_dp
            if (present(valid)) then
               if (valid(i) == 0_int8) cycle
            end if
            k = k + 1
            result%outlier(k) = i
         end do
         if (found == size(mask, kind=int64) .and. result%removed == 0) deallocate (mask)
      end if
      if (moments%count == 0) call compute_moments(cleaned, moments, mask)
      result%mean = moments%mean
      result%variance = moments%variance
      call correct_variance(found, max_passes, result)
   end subroutine finish

   !> False alarms to expect, and the variance that the noise had before it was cut.
   pure subroutine correct_variance(found, max_passes, result)
      integer(int64), intent(in) :: found
      integer, intent(in) :: max_passes
      type(clean_type), intent(inout) :: result
      real(dp) :: kept
      integer :: rounds

      result%corrected_variance = result%variance
      if (result%method == "none") return
      rounds = merge(0, result%passes, result%converged .and. max_passes > 1)
      result%expected = expected_false_alarms(result%method, result%threshold, found, rounds, &
         & result%half_width)
      select case (result%method)
      case ("hampel"); kept = 0.0_dp
      case ("auto", "mad"); kept = truncated_deviation(result%threshold)
      case default; kept = truncated_deviation(final_cut(result%threshold, rounds))
      end select
      result%corrected_variance = 0.0_dp
      if (kept > 0.0_dp) result%corrected_variance = result%variance/kept**2
   end subroutine correct_variance

end module gyroakf_preprocess_clean
