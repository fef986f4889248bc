! SPDX-License-Identifier: MIT
!> Cleaning of a series: outliers and polynomial trend jointly.
module gyroakf_preprocess_clean
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_trend, only : largest_degree
   use gyroakf_preprocess_auto_outliers, only : find_auto_outliers
   use gyroakf_preprocess_outlier_rules, only : check_method, default_threshold
   use gyroakf_preprocess_local_outliers, only : largest_half_width
   use gyroakf_preprocess_truncation, only : expected_false_alarms, truncated_deviation, final_cut
   use gyroakf_preprocess_clean_types, only : clean_options, clean_type
   use gyroakf_preprocess_clean_rounds, only : run_rounds, detrend, set_mask
   implicit none (type, external)
   private
   public :: clean_options, clean_type, clean_series

contains

   !> Marks outliers as missing and subtracts the trend.
   !>
   !> `auto` looks for outliers about a running median ([[find_auto_outliers]]); the trend is fitted to what is left. The other
   !> rules judge by the distance from the trend, in rounds: each fits the trend to the inliers and judges every present sample,
   !> so that one marked by mistake comes back, until the marks stay. After twelve rounds no mark is taken back, which ends the
   !> rounds where samples at the very limit would go to and fro. Where they end before the marks stay, the trend is fitted once
   !> more, to what is left. No scale of theirs is less than half a quantization step ([[find_coarse_step]]): a record that sits on
   !> one level and now and then on the next has no outliers.
   !> Memory: the results, 9 bytes a sample.
   subroutine clean_series(x, options, cleaned, present_out, result, error, valid, progress)
      !> Series: [n], n >= 1, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> What is removed
      type(clean_options), intent(in) :: options
      !> Series less its trend, 0 where missing: [n]
      real(dp), allocatable, intent(out) :: cleaned(:)
      !> 1 present, 0 missing (before, or an outlier): [n]; allocated only where something is missing
      integer(int8), allocatable, intent(out) :: present_out(:)
      !> What was removed
      type(clean_type), intent(out) :: result
      !> invalid_argument, not_supported, too_few_samples, singular, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(moments_type) :: moments
      real(dp) :: z
      integer(int64) :: found

      call check_options(x, options, found, error, valid)
      if (allocated(error)) return
      call allocate_results(x, options, cleaned, present_out, error, valid)
      if (allocated(error)) return
      result%method = options%method
      result%threshold = options%threshold
      if (options%method == "hampel") result%half_width = options%half_width
      if (options%method == "none") then
         result%threshold = 0.0_dp
         call detrend(x, options%degree, cleaned, result%trend, error, valid, progress)
      else
         if (.not. options%threshold > 0.0_dp) result%threshold = default_threshold(trim(options%method), found)
         if (options%method == "auto") then
            z = result%threshold
            call find_auto_outliers(x, z, present_out, result%threshold, result%motion, error, valid, progress)
            if (allocated(error)) return
            result%passes = 1
            result%removed = found - count(present_out /= 0_int8, kind=int64)
            call detrend(x, options%degree, cleaned, result%trend, error, present_out, progress)
         else
            call run_rounds(x, options, cleaned, present_out, moments, result, error, valid, progress)
         end if
      end if
      if (.not. allocated(error)) call report_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call finish(cleaned, present_out, found, options%max_passes, moments, result, error, valid)
   end subroutine clean_series

   !> Refuses options out of range and a series without a present sample.
   subroutine check_options(x, options, found, error, valid)
      real(dp), intent(in) :: x(:)
      type(clean_options), intent(in) :: options
      integer(int64), intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text
      logical :: bad

      found = size(x, kind=int64)
      call check_method(trim(options%method), error)
      if (allocated(error)) return
      bad = .not. ieee_is_finite(options%threshold)
      if (.not. bad) bad = options%threshold < 0.0_dp
      if (bad) then
         call fatal_error(error, status%invalid_argument, "the outlier threshold must be positive, or 0 for the method's own")
      else if (options%max_passes < 1) then
         call fatal_error(error, status%invalid_argument, "at least one round is needed to find outliers")
      else if (options%half_width < 1 .or. options%half_width > largest_half_width) then
         write (text, '("the half-width of the window must be 1 .. ", i0, ", it is ", i0)') largest_half_width, options%half_width
         call fatal_error(error, status%invalid_argument, trim(text))
      else if (options%degree < -1 .or. options%degree > largest_degree) then
         write (text, '("the degree of the trend must be -1 .. ", i0, ", it is ", i0)') largest_degree, options%degree
         call fatal_error(error, status%invalid_argument, trim(text))
      else
         if (present(valid)) then
            if (size(valid, kind=int64) /= found) then
               call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
               return
            end if
            found = count(valid /= 0_int8, kind=int64)
         end if
         if (found < 1) call fatal_error(error, status%too_few_samples, "no sample of the series is present")
      end if
   end subroutine check_options

   !> Allocates the results; the mask only where it is needed.
   subroutine allocate_results(x, options, cleaned, mask, error, valid)
      real(dp), intent(in) :: x(:)
      type(clean_options), intent(in) :: options
      real(dp), allocatable, intent(out) :: cleaned(:)
      !> Mask, a copy of valid
      integer(int8), allocatable, intent(out) :: mask(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer :: stat

      allocate (cleaned(size(x, kind=int64)), stat=stat)
      if (stat == 0 .and. (present(valid) .or. options%method /= "none")) then
         allocate (mask(size(x, kind=int64)), stat=stat)
         if (stat == 0) then
            call set_mask(mask, valid)
         end if
      end if
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the cleaned series")
   end subroutine allocate_results

   !> Indices of the outliers, 0 where missing, mean and variance.
   subroutine finish(cleaned, mask, found, max_passes, moments, result, error, valid)
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing; deallocated where everything is present
      integer(int8), allocatable, intent(inout) :: mask(:)
      integer(int64), intent(in) :: found
      integer, intent(in) :: max_passes
      !> Of the inliers, where they are known; else its count is 0
      type(moments_type), intent(inout) :: moments
      type(clean_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      integer :: stat

      result%fraction = real(result%removed, dp)/real(found, dp)
      allocate (result%outlier(result%removed), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the list of outliers")
         return
      end if
      if (allocated(mask)) then
         call list_outliers(cleaned, mask, result%outlier, valid)
         if (found == size(mask, kind=int64) .and. result%removed == 0) deallocate (mask)
      end if
      if (moments%count == 0) call compute_moments(cleaned, moments, mask)
      result%mean = moments%mean
      result%variance = moments%variance
      call correct_variance(found, max_passes, result)
   end subroutine finish

   !> Indices of the outliers; 0 in place of what is missing.
   pure subroutine list_outliers(cleaned, mask, outlier, valid)
      real(dp), intent(inout), contiguous :: cleaned(:)
      integer(int8), intent(in), contiguous :: mask(:)
      integer(int64), intent(inout) :: outlier(:)
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, k

      k = 0
      do i = 1, size(mask, kind=int64)
         if (mask(i) /= 0_int8) cycle
         cleaned(i) = 0.0_dp
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         k = k + 1
         outlier(k) = i
      end do
   end subroutine list_outliers

   !> False alarms to expect, and the variance that the noise had before it was cut.
   pure subroutine correct_variance(found, max_passes, result)
      integer(int64), intent(in) :: found
      integer, intent(in) :: max_passes
      !> method, threshold, passes, converged, half_width and variance are set
      type(clean_type), intent(inout) :: result
      real(dp) :: kept
      integer :: rounds

      result%corrected_variance = result%variance
      if (result%method == "none") return
      rounds = merge(0, result%passes, result%converged .and. max_passes > 1)
      result%expected = expected_false_alarms(result%method, result%threshold, found, rounds, result%half_width)
      if (result%method == "pauta") then
         result%blind = real(found - 1, dp) <= result%threshold*sqrt(real(found, dp))
      end if
      select case (result%method)
      case ("hampel"); kept = 0.0_dp
      case ("auto", "mad"); kept = truncated_deviation(result%threshold)
      case default; kept = truncated_deviation(final_cut(result%threshold, rounds))
      end select
      result%corrected_variance = 0.0_dp
      if (kept > 0.0_dp) result%corrected_variance = result%variance/kept**2
   end subroutine correct_variance

end module gyroakf_preprocess_clean
