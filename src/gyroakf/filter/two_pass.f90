! SPDX-License-Identifier: MIT
!> The drift of a record whose white noise changes: its variance from both sides, then the fixed-interval smoother.
!>
!> The adaptive drift filter runs over the record and over the reversed record ([[gyroakf_filter_weighing]]); the smoother weighs
!> the samples by what the two say.
module gyroakf_filter_two_pass
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_kalman, only : filter_options, filter_type
   use gyroakf_filter_measurement, only : is_sample
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_weighing, only : start_weighing, weigh_behind, weigh_sample
   implicit none (type, external)
   private
   public :: smooth_adaptive

   !> Samples between two reports of progress
   integer(int64), parameter :: report_samples = 262144

contains

   !> Smooths the drift out of a series whose white noise changes its variance.
   subroutine smooth_adaptive(model, slow, options, z, drift, error, valid, variance, white, progress)
      !> As new_drift_filter
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      !> Of the adaptive filter; `estimate_measurement_variance` is taken as set; a burn-in that is found (-1) is n/10 at most
      type(filter_options), intent(in) :: options
      !> Series, [n]; NaN counts as missing
      real(dp), intent(in), contiguous :: z(:)
      !> Its drift, also where samples are missing: [n]; not the same array as z
      real(dp), intent(out), contiguous :: drift(:)
      !> Those of new_drift_filter and smooth_drift; no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Variance of the drift's error: [n]
      real(dp), intent(inout), optional :: variance(:)
      !> Variance of the white noise of each sample, inflated where the gate acted: [n]
      real(dp), intent(inout), optional :: white(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      real(dp), allocatable :: r(:)
      integer(int64) :: n
      integer :: stat

      n = size(z, kind=int64)
      call start_weighing(filter, model, slow, options, n, error)
      if (allocated(error)) return
      allocate (r(n), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the white noise of a series")
         return
      end if
      call estimate_variances(filter, z, r, error, valid, progress)
      if (allocated(error)) return
      call smooth_drift(model, slow, z, drift, error, valid, variance, r, progress)
      if (present(white)) white(:) = r
   end subroutine smooth_adaptive

   !> The variance of the white noise at each sample from before and from behind.
   subroutine estimate_variances(fresh, z, r, error, valid, progress)
      !> As made
      type(filter_type), intent(in) :: fresh
      !> Series, [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Variance of the white noise, [n]
      real(dp), intent(inout), contiguous :: r(:)
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      integer(int64) :: k, n, seen

      n = size(z, kind=int64)
      filter = fresh
      do k = 1, n
         if (mod(k, report_samples) == 1) then
            call report_progress("weighing the samples", k - 1, 2*n, error, progress)
            if (allocated(error)) return
         end if
         call weigh_sample(filter, z(k), is_here(z(k), k, valid), r(k))
      end do
      seen = filter%measurements
      filter = fresh
      do k = n, 1, -1
         if (mod(k, report_samples) == 1) then
            call report_progress("weighing the samples", 2*n - k, 2*n, error, progress)
            if (allocated(error)) return
         end if
         call weigh_behind(fresh, filter, seen, z(k), is_here(z(k), k, valid), r(k))
      end do
   end subroutine estimate_variances

   !> Whether a sample is there.
   pure logical function is_here(z, k, valid)
      !> Sample k of the series
      real(dp), intent(in) :: z
      integer(int64), intent(in) :: k
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)

      is_here = is_sample(z)
      if (present(valid)) is_here = is_here .and. valid(k) /= 0_int8
   end function is_here

end module gyroakf_filter_two_pass
