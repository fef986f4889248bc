! SPDX-License-Identifier: MIT
!> One pass over a series for all that is made of lagged products: the Dickey-Fuller test takes it, and on the way the
!> autocovariances are made that the Ljung-Box test and the AR model need. The moments, one pass before, give the mean.
module gyroakf_pipeline_shared_pass
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_autocovariance, only : autocovariance_type, plan_autocovariance, &
      & need_autocovariance
   use gyroakf_stats_moments, only : moments_type
   use gyroakf_series_adf, only : test_adf
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: plan_pass, run_adf

   !> Autocovariances that are made in any case
   integer, parameter :: least_lags = 40

contains

   !> Plans the autocovariances that the stages need.
   pure subroutine plan_pass(n, options, moments, shared)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Of the series
      type(moments_type), intent(in) :: moments
      !> Planned
      type(autocovariance_type), intent(out) :: shared
      integer :: lags

      lags = least_lags
      if (options%do_tests) lags = max(lags, options%ljung_box_lags)
      if (options%do_ar .or. options%do_filter) lags = max(lags, options%ar%max_order, options%ar%order)
      call plan_autocovariance(shared, int(min(int(lags, int64), n - 1)), moments%mean, moments%remainder)
   end subroutine plan_pass

   !> The Dickey-Fuller test; the autocovariances are made on the way, or in a pass of their own where the test came to nothing.
   subroutine run_adf(z, options, channel, shared, error, valid, progress)
      !> The series: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Its test is filled
      type(channel_result_type), intent(inout) :: channel
      !> Planned; filled
      type(autocovariance_type), intent(inout) :: shared
      !> no_memory, cancelled; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback
      class(progress_type), intent(inout), optional :: progress

      call test_adf(z, options%adf, channel%adf, error, valid, shared, progress)
      if (is_fatal(error)) return
      channel%available%adf = .not. allocated(error)
      call note_failure(channel, "ADF test", error)
      call need_autocovariance(z, shared, error, valid)
   end subroutine run_adf

end module gyroakf_pipeline_shared_pass
