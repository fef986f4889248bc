! SPDX-License-Identifier: MIT
!> The filters of one channel whose samples arrive in blocks: the paper's, and those of the drift.
module gyroakf_pipeline_filter_lane
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_series_correlation, only : correlation_of
   use gyroakf_series_moments, only : moments_type
   use gyroakf_series_normality, only : test_jarque_bera
   use gyroakf_series_whiteness, only : ljung_box_of
   use gyroakf_ar_residual_stream, only : begin_residual_stream, feed_residual_stream, finish_residual_stream, &
      residual_stream_type
   use gyroakf_ar_model, only : residual_lags
   use gyroakf_filter_design, only : design_akf, design_drift_akf, design_drift_kf, design_kf
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_filter_series, only : begin_filter_run, end_filter_run, feed_filter_run, filter_result_type, filter_run_type
   use gyroakf_pipeline_channel, only : negligible_mean
   use gyroakf_pipeline_filters, only : figures_of
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure, warn_centred, warn_model, warn_order
   implicit none (type, external)
   private
   public :: filter_lane_type, begin_lane, begin_drift_lane, feed_lane, free_block, finish_lane

   !> A filter at work
   type :: worker_type
      logical :: works = .false.
      type(filter_type) :: filter
      type(filter_run_type) :: run
   end type worker_type

   !> One channel
   type :: filter_lane_type
      !> Subtracted before the filters, 0 where the mean does not count
      real(dp) :: centre = 0.0_dp
      logical :: centred = .false.
      type(worker_type) :: kf, akf, drift_kf, drift_akf
      !> Residuals of the AR model; whether they are tested
      type(residual_stream_type) :: residuals
      logical :: tests_residuals = .false.
      !> Something was missing
      logical :: gaps = .false.
      !> The series without its mean
      real(dp), allocatable :: z(:)
      !> Its level, that of the drift's outputs
      real(dp) :: level = 0.0_dp
   end type filter_lane_type

contains

   !> Makes the filters of a channel's model.
   subroutine begin_lane(lane, difference_variance, samples, options, channel, error)
      !> Fresh afterwards
      type(filter_lane_type), intent(out) :: lane
      !> Variance of the differences of the series
      real(dp), intent(in) :: difference_variance
      !> Of the series, missing ones included
      integer(int64), intent(in) :: samples
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Moments and AR model are filled, as far as available; a filter that cannot be made is noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      integer :: lags

      if (.not. channel%available%ar) return
      lags = residual_lags(samples, channel%ar%order)
      lane%tests_residuals = lags > channel%ar%order
      if (lane%tests_residuals) call begin_residual_stream(lane%residuals, lags, channel%ar%mean, channel%ar%coefficient, error)
      if (allocated(error)) return
      lane%centred = abs(channel%cleaned%mean) > negligible_mean*channel%cleaned%std
      if (lane%centred) lane%centre = channel%cleaned%mean
      call design_kf(channel%ar, options%design, lane%kf%filter, error)
      call begin_worker(lane%kf, samples, channel, "Kalman filter", error)
      if (allocated(error)) return
      channel%available%kf = lane%kf%works
      call design_akf(channel%ar, difference_variance, options%design, lane%akf%filter, error)
      call begin_worker(lane%akf, samples, channel, "adaptive Kalman filter", error)
      channel%available%akf = lane%akf%works
   end subroutine begin_lane

   !> Makes the filters of a channel's drift.
   subroutine begin_drift_lane(lane, difference_variance, samples, options, channel, error)
      !> Begun
      type(filter_lane_type), intent(inout) :: lane
      !> Variance of the differences of the series
      real(dp), intent(in) :: difference_variance
      !> Of the series, missing ones included
      integer(int64), intent(in) :: samples
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Its drift is identified; a filter that cannot be made is noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error

      if (.not. channel%drift%found) return
      lane%level = channel%level%mean
      call design_drift_kf(channel%drift, lane%drift_kf%filter, error)
      call begin_worker(lane%drift_kf, samples, channel, "drift Kalman filter", error)
      if (allocated(error)) return
      call design_drift_akf(channel%drift, difference_variance, options%drift, lane%drift_akf%filter, error)
      call begin_worker(lane%drift_akf, samples, channel, "adaptive drift filter", error)
   end subroutine begin_drift_lane

   !> Begins the run of a filter that was made.
   subroutine begin_worker(worker, samples, channel, name, error)
      type(worker_type), intent(inout) :: worker
      integer(int64), intent(in) :: samples
      type(channel_result_type), intent(inout) :: channel
      character(*), intent(in) :: name
      !> That of the design; afterwards only what ends the job
      type(error_type), allocatable, intent(inout) :: error

      if (.not. allocated(error)) call begin_filter_run(worker%filter, samples, channel%raw%count, worker%run, error)
      worker%works = .not. allocated(error)
      if (is_fatal(error)) return
      call note_failure(channel, name, error)
   end subroutine begin_worker

   !> Filters the next samples of a channel.
   subroutine feed_lane(lane, x, part, error, valid)
      !> Of the beginning
      type(filter_lane_type), intent(inout) :: lane
      !> As read: [any number], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Its series are filled
      type(channel_result_type), intent(inout) :: part
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n

      n = size(x, kind=int64)
      part%series_cleaned = x
      if (allocated(part%series_present)) deallocate (part%series_present)
      if (present(valid)) part%series_present = valid
      lane%gaps = lane%gaps .or. present(valid)
      lane%z = x - lane%centre
      if (lane%tests_residuals) then
         if (present(valid)) then
            call feed_residual_stream(lane%residuals, x, valid)
         else
            call feed_residual_stream(lane%residuals, x)
         end if
      end if
      call resize(part%series_kf, n, lane%kf%works, error)
      if (.not. allocated(error)) call resize(part%series_akf, n, lane%akf%works, error)
      if (allocated(error)) return
      if (lane%kf%works) call work(lane%kf, lane%z, part%series_kf, error, valid)
      if (.not. allocated(error) .and. lane%akf%works) call work(lane%akf, lane%z, part%series_akf, error, valid)
      if (allocated(error)) return
      lane%z = x - lane%level
      call resize(part%series_drift_kf, n, lane%drift_kf%works, error)
      if (.not. allocated(error)) call resize(part%series_drift_akf, n, lane%drift_akf%works, error)
      if (.not. allocated(error) .and. lane%drift_kf%works) call work(lane%drift_kf, lane%z, part%series_drift_kf, error, valid)
      if (.not. allocated(error) .and. lane%drift_akf%works) call work(lane%drift_akf, lane%z, part%series_drift_akf, error, valid)
      if (allocated(error)) return
      if (lane%drift_kf%works) part%series_drift_kf = part%series_drift_kf + lane%level
      if (lane%drift_akf%works) part%series_drift_akf = part%series_drift_akf + lane%level
   end subroutine feed_lane

   !> Frees what a block took.
   subroutine free_block(lane, part)
      !> Its filters stay
      type(filter_lane_type), intent(inout) :: lane
      !> Its series go
      type(channel_result_type), intent(inout) :: part

      if (allocated(lane%z)) deallocate (lane%z)
      if (allocated(part%series_cleaned)) deallocate (part%series_cleaned)
      if (allocated(part%series_present)) deallocate (part%series_present)
      if (allocated(part%series_kf)) deallocate (part%series_kf)
      if (allocated(part%series_akf)) deallocate (part%series_akf)
      if (allocated(part%series_drift)) deallocate (part%series_drift)
      if (allocated(part%series_compensated)) deallocate (part%series_compensated)
      if (allocated(part%series_drift_kf)) deallocate (part%series_drift_kf)
      if (allocated(part%series_drift_akf)) deallocate (part%series_drift_akf)
   end subroutine free_block

   !> Runs a filter over some samples.
   subroutine work(worker, z, x, error, valid)
      type(worker_type), intent(inout) :: worker
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: x(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)

      if (present(valid)) then
         call feed_filter_run(worker%filter, worker%run, z, x, error, valid)
      else
         call feed_filter_run(worker%filter, worker%run, z, x, error)
      end if
   end subroutine work

   !> Room for so many samples.
   subroutine resize(x, n, wanted, error)
      real(dp), allocatable, intent(inout) :: x(:)
      integer(int64), intent(in) :: n
      logical, intent(in) :: wanted
      type(error_type), allocatable, intent(out) :: error
      integer :: failed

      if (.not. wanted) return
      if (allocated(x)) then
         if (size(x, kind=int64) == n) return
         deallocate (x)
      end if
      allocate (x(n), stat=failed)
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for a block of a filtered series")
   end subroutine resize

   !> What the filters did, and what is to be said of it.
   subroutine finish_lane(lane, channel, error)
      !> After the last sample
      type(filter_lane_type), intent(in) :: lane
      !> Diagnostics, figures, warnings are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      type(filter_result_type) :: measured
      logical :: there

      if (lane%tests_residuals) call test_residuals(lane, channel)
      if (channel%available%ar) call warn_order(channel)
      call warn_model(channel)
      if (lane%centred) call warn_centred(channel)
      call measure(lane%kf, "Kalman filter", measured, channel, there, error)
      if (allocated(error)) return
      channel%available%kf = there
      channel%kf = measured
      if (there) channel%kf_figures = figures_of(measured, channel%cleaned%variance, channel)
      call measure(lane%akf, "adaptive Kalman filter", measured, channel, there, error)
      if (allocated(error)) return
      channel%available%akf = there
      channel%akf = measured
      if (there) channel%akf_figures = figures_of(measured, channel%cleaned%variance, channel)
      call measure(lane%drift_kf, "drift Kalman filter", measured, channel, there, error)
      if (allocated(error)) return
      channel%available%drift_kf = there
      channel%drift_kf = measured
      if (there) channel%drift_kf%mean = measured%mean + channel%level%mean
      if (there) channel%drift_kf_figures = figures_of(measured, channel%level%variance, channel)
      call measure(lane%drift_akf, "adaptive drift filter", measured, channel, there, error)
      if (allocated(error)) return
      channel%available%drift_akf = there
      channel%drift_akf = measured
      if (there) channel%drift_akf%mean = measured%mean + channel%level%mean
      if (there) channel%drift_akf_figures = figures_of(measured, channel%level%variance, channel)
   end subroutine finish_lane

   !> Diagnostics of one filter, where it worked.
   subroutine measure(worker, name, measured, channel, there, error)
      type(worker_type), intent(in) :: worker
      character(*), intent(in) :: name
      type(filter_result_type), intent(out) :: measured
      !> Told what failed
      type(channel_result_type), intent(inout) :: channel
      logical, intent(out) :: there
      !> What ends the job
      type(error_type), allocatable, intent(out) :: error

      there = .false.
      if (.not. worker%works) return
      call end_filter_run(worker%filter, worker%run, measured, error)
      if (is_fatal(error)) return
      there = .not. allocated(error)
      call note_failure(channel, name, error)
   end subroutine measure

   !> Whiteness and normality of the AR model's residuals; left out where there are too few of them or they are constant.
   subroutine test_residuals(lane, channel)
      type(filter_lane_type), intent(in) :: lane
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable :: error
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      integer(int64) :: n
      type(moments_type) :: moments

      call finish_residual_stream(lane%residuals, r, pairs, n, moments)
      if (pairs(0) < 1) return
      call test_jarque_bera(moments, channel%ar%residual_normality, error)
      if (lane%gaps) then
         call ljung_box_of(r, n, channel%ar%order, channel%ar%residual_ljung_box, error, pairs)
         if (.not. allocated(error)) call correlation_of(r, n, channel%ar%order, channel%ar%residual_correlation, error, pairs)
      else
         call ljung_box_of(r, n, channel%ar%order, channel%ar%residual_ljung_box, error)
         if (.not. allocated(error)) call correlation_of(r, n, channel%ar%order, channel%ar%residual_correlation, error)
      end if
   end subroutine test_residuals

end module gyroakf_pipeline_filter_lane
