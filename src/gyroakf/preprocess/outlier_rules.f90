! SPDX-License-Identifier: MIT
!> Rules that mark an outlier: |residual - center| > threshold x scale.
!>
!> | method | center and scale | threshold |
!> |---|---|---|
!> | `pauta` | mean and standard deviation (divisor n - 1) of the inliers | 3 |
!> | `auto`  | running median, median distance from it ([[find_auto_outliers]]) | for the length |
!> | `mad`   | median and 1.4826 MAD | 4.5 |
!> | `hampel` | median and 1.4826 MAD of the sample's neighborhood ([[mark_hampel]]) | 3 |
!>
!> Mean and standard deviation of n samples let none of them be further off than (n-1)/sqrt(n)
!> standard deviations: 3 sigma rejects nothing below 11 samples.
!>
!> Sources: Pauta's rule as in the paper; Hampel, J. Amer. Stat. Assoc. 69 (1974) 383-393 for the
!> MAD.
module gyroakf_preprocess_outlier_rules
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : threads_from
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_select, only : find_median, find_deviation
   use gyroakf_preprocess_auto_outliers, only : auto_threshold
   use gyroakf_preprocess_local_outliers, only : mad_to_sigma, set_mark
   implicit none (type, external)
   private
   public :: check_method, default_threshold, robust_center, mark_outliers

contains

   !> Refuses a method that is not known or not built.
   subroutine check_method(method, error)
      !> none, auto, pauta, mad, hampel
      character(*), intent(in) :: method
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      select case (method)
      case ("none", "auto", "pauta", "mad", "hampel")
      case default
         call fatal_error(error, status%invalid_argument, "unknown outlier method '" &
            & //trim(method)//"'; there are none, auto, pauta, mad, hampel")
      end select
   end subroutine check_method

   !> The method's own threshold in standard deviations, 0 for `none`.
   pure real(dp) function default_threshold(method, n)
      !> One of the methods
      character(*), intent(in) :: method
      !> Present samples
      integer(int64), intent(in) :: n

      select case (method)
      case ("auto"); default_threshold = auto_threshold(n)
      case ("pauta", "hampel"); default_threshold = 3.0_dp
      case ("mad"); default_threshold = 4.5_dp
      case default; default_threshold = 0.0_dp
      end select
   end function default_threshold

   !> Median, and 1.4826 times the median distance from it.
   subroutine robust_center(x, center, scale, error, valid, progress)
      !> Residuals: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The two
      real(dp), intent(out) :: center, scale
      !> too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback, between the two; may cancel
      class(progress_type), intent(inout), optional :: progress

      scale = 0.0_dp
      call find_median(x, center, error, valid)
      if (allocated(error)) return
      call report_progress("cleaning", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call find_deviation(x, center, scale, error, valid)
      scale = mad_to_sigma*scale
   end subroutine robust_center

   !> Marks the samples beyond the limit and unmarks those within.
   subroutine mark_outliers(x, center, limit, keep, inlier, changed, removed, valid)
      !> Residuals: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Marked is |x - center| > limit
      real(dp), intent(in) :: center, limit
      !> .true.: a mark stays, whatever the limit
      logical, intent(in) :: keep
      !> 1 inlier, 0 outlier or missing: [n]
      integer(int8), intent(inout), contiguous :: inlier(:)
      !> Samples whose mark changed, and outliers now
      integer(int64), intent(out) :: changed, removed
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i, n

      n = size(x, kind=int64)
      changed = 0
      removed = 0
      !$omp parallel do if (n >= threads_from) default(shared) reduction(+:changed, removed) &
      !$omp& schedule(static)
      do i = 1, n
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         call set_mark(abs(x(i) - center) > limit, keep, inlier(i), changed, removed)
      end do
      !$omp end parallel do
   end subroutine mark_outliers

end module gyroakf_preprocess_outlier_rules
