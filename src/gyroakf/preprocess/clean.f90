! SPDX-License-Identifier: MIT
!> Cleaning of a series: outliers and polynomial trend jointly.
module gyroakf_preprocess_clean
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_series_moments, only : moments_type, compute_moments
   use gyroakf_preprocess_trend, only : trend_type, fit_trend, remove_trend, largest_degree
   use gyroakf_preprocess_outliers, only : check_method, default_threshold, robust_centre, quantisation_step, mark_outliers
   implicit none (type, external)
   private
   public :: clean_options, clean_type, clean_series

   !> Rounds of `auto` with median and MAD, rounds in which a mark may come back
   integer, parameter :: robust_rounds = 6, free_rounds = 12
   !> One sample of so many may be an outlier by median and MAD
   integer(int64), parameter :: outlier_share = 4

   !> What is removed
   type :: clean_options
      !> Degree of the trend, -1 .. 9; -1 keeps it, outliers are then those about the mean or median
      integer :: degree = 3
      !> Outliers: none, auto, pauta, mad (see gyroakf_preprocess_outliers)
      character(8) :: method = "auto"
      !> Threshold in standard deviations, > 0; 0: the method's own
      real(dp) :: threshold = 0.0_dp
      !> Most rounds, >= 1
      integer :: max_passes = 20
   end type clean_options

   !> What was removed, in the unit u of the series
   type :: clean_type
      !> Method used
      character(8) :: method = "none"
      !> Threshold used, in standard deviations; 0 with none
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
   end type clean_type

contains

   !> Marks outliers as missing and subtracts the trend.
   !>
   !> Each round fits the trend to the inliers and judges every present sample by its distance from
   !> that trend, so that a sample marked by mistake comes back; the rounds end when the marks stay.
   !> `auto` begins with median and MAD, which a gross outlier cannot inflate, and when these marks
   !> stay (after six rounds at most) goes on with mean and standard deviation. Where median and MAD
   !> call more than a quarter of the record outliers, it is no record with outliers but one with quiet
   !> and disturbed stretches, and `auto` begins again with mean and standard deviation of all. After
   !> twelve rounds no mark comes back, which ends the rounds where samples at the very limit would go to and fro.
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
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: found

      call check_options(x, options, found, error, valid)
      if (allocated(error)) return
      call make_room(x, options, cleaned, present_out, error, valid)
      if (allocated(error)) return
      result%method = options%method
      result%threshold = options%threshold
      if (options%method == "none") then
         result%threshold = 0.0_dp
         call detrend(x, options%degree, cleaned, result%trend, error, valid)
      else
         if (.not. options%threshold > 0.0_dp) result%threshold = default_threshold(trim(options%method), found)
         call run_rounds(x, options, cleaned, present_out, result, error, valid, progress)
      end if
      if (allocated(error)) return
      call finish(cleaned, present_out, found, result, error, valid)
   end subroutine clean_series

   !> Refuses options out of range and a series without a present sample.
   subroutine check_options(x, options, found, error, valid)
      !> Series
      real(dp), intent(in) :: x(:)
      !> The options
      type(clean_options), intent(in) :: options
      !> Present samples
      integer(int64), intent(out) :: found
      !> invalid_argument, not_supported, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
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
   subroutine make_room(x, options, cleaned, mask, error, valid)
      !> Series
      real(dp), intent(in) :: x(:)
      !> The options
      type(clean_options), intent(in) :: options
      !> Cleaned series
      real(dp), allocatable, intent(out) :: cleaned(:)
      !> Mask, a copy of valid
      integer(int8), allocatable, intent(out) :: mask(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
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
   end subroutine make_room

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
   subroutine detrend(x, degree, cleaned, trend, error, mask)
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
      integer(int64) :: i, n

      call fit_trend(x, degree, trend, error, mask)
      if (allocated(error)) return
      n = size(x, kind=int64)
      !$omp parallel do if (n >= threads_from) default(shared) schedule(static)
      do i = 1, n
         cleaned(i) = x(i)
      end do
      !$omp end parallel do
      call remove_trend(trend, cleaned)
   end subroutine detrend

   !> The rounds.
   subroutine run_rounds(x, options, cleaned, mask, result, error, valid, progress)
      !> Series
      real(dp), intent(in), contiguous :: x(:)
      !> The options
      type(clean_options), intent(in) :: options
      !> Series less trend
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing
      integer(int8), intent(inout), contiguous :: mask(:)
      !> threshold is set; passes, removed, converged and trend are filled
      type(clean_type), intent(inout) :: result
      !> As of fit_trend
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(moments_type) :: moments
      real(dp) :: step, largest, rounding, centre, scale
      integer(int64) :: changed, found
      logical :: robust

      found = count(mask /= 0_int8, kind=int64)
      call quantisation_step(x, step, largest, valid)
      rounding = 16.0_dp*epsilon(x)*largest
      robust = options%method /= "pauta"
      do while (result%passes < options%max_passes)
         call tell_progress("cleaning", result%passes*size(x, kind=int64), 0_int64, error, progress)
         if (allocated(error)) return
         result%passes = result%passes + 1
         call detrend(x, options%degree, cleaned, result%trend, error, mask)
         if (allocated(error)) return
         if (robust) then
            call robust_centre(cleaned, 0.5_dp*step, centre, scale, error, valid)
            if (allocated(error)) return
         else
            call compute_moments(cleaned, moments, mask)
            centre = moments%mean
            scale = moments%std
         end if
         call mark_outliers(cleaned, centre, max(result%threshold*scale, rounding), result%passes > free_rounds, &
            & mask, changed, result%removed, valid)
         result%converged = changed == 0 .and. .not. (robust .and. options%method == "auto")
         if (result%converged) return
         if (.not. robust .or. options%method /= "auto") cycle
         if (changed == 0 .or. result%passes >= robust_rounds) then
            robust = .false.
            if (outlier_share*result%removed > found) call set_mask(mask, valid)
         end if
      end do
   end subroutine run_rounds

   !> Indices of the outliers, 0 where missing, mean and variance.
   subroutine finish(cleaned, mask, found, result, error, valid)
      !> Series less trend
      real(dp), intent(inout), contiguous :: cleaned(:)
      !> 1 inlier, 0 outlier or missing; deallocated where everything is present
      integer(int8), allocatable, intent(inout) :: mask(:)
      !> Samples present before
      integer(int64), intent(in) :: found
      !> Filled
      type(clean_type), intent(inout) :: result
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      type(moments_type) :: moments
      integer(int64) :: i, k
      integer :: stat

      result%fraction = real(result%removed, dp)/real(found, dp)
      allocate (result%outlier(result%removed), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the list of outliers")
         return
      end if
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
      if (allocated(mask)) then
         call compute_moments(cleaned, moments, mask)
      else
         call compute_moments(cleaned, moments)
      end if
      result%mean = moments%mean
      result%variance = moments%variance
   end subroutine finish

end module gyroakf_preprocess_clean
