! SPDX-License-Identifier: MIT
!> The recommended filters of one channel: of the drift that the record itself shows.
!>
!> They work on the record as read without its outliers: a polynomial that was fitted to the whole
!> record is not there while a sensor is in use, and a random walk follows what it would remove. Off
!> line the smoother sees the record from both sides; what is left of the record without the
!> smoothed drift is `compensated`.
module gyroakf_pipeline_drift_filters
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_filter_design, only : adaptive_drift
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_channel_drift, only : find_drift, judge_model, smoothed_share
   use gyroakf_pipeline_channel_filters, only : figures_of, reserve, run_filter
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, stage
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_drift_filters

contains

   !> Identifies the drift, filters and smooths it, and computes the Allan curve of the record
   !> without it.
   !>
   !> Alive at a time: the record without its mean, one output, the white noise of each sample;
   !> afterwards one series and what its Allan curve takes. With `keep_series` all outputs stay.
   subroutine run_drift_filters(job, channel, error)
      !> The channel in work; the samples as read are filtered
      type(job_type), intent(in) :: job
      !> Drift, filter results, figures and the curve are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; what cannot be done is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: z(:), drift(:)
      real(dp) :: differences, mean
      integer(int64) :: n

      if (any(job%options%design_only == [character(3) :: "kf", "akf"])) return
      n = size(job%x, kind=int64)
      mean = channel%level%mean
      call reserve(z, n, error)
      if (allocated(error)) return
      z(:) = job%x - mean
      call find_drift(z, job, channel, error)
      if (allocated(error) .or. .not. channel%drift%found) return
      differences = difference_variance(z, job%valid)
      channel%designed_mean = mean
      call run_filter("drift_kf", job, z, mean, differences, drift, channel, error)
      if (allocated(error)) return
      if (channel%available%drift_kf) call keep(drift, channel%series_drift_kf)
      call judge_model(channel)
      call run_filter("drift_akf", job, z, mean, differences, drift, channel, error)
      if (allocated(error)) return
      if (channel%available%drift_akf) call keep(drift, channel%series_drift_akf)
      if (job%options%design_only /= "") return
      call reserve(drift, n, error)
      if (.not. allocated(error)) call run_smoother(job, z, drift, differences, channel, error)
      if (allocated(error) .or. .not. channel%available%drift_smoother) return
      deallocate (z)
      call compensate(job, drift, channel, error)

   contains

      !> Keeps an output, with the level, where it is wanted.
      subroutine keep(output, series)
         real(dp), allocatable, intent(inout) :: output(:), series(:)

         if (.not. job%options%keep_series) return
         output(:) = output + mean
         call move_alloc(output, series)
      end subroutine keep

   end subroutine run_drift_filters

   !> The drift from both sides, the variance of the white noise at each sample too.
   subroutine run_smoother(job, z, drift, differences, channel, error)
      type(job_type), intent(in) :: job
      !> Without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Smoothed: [n]
      real(dp), intent(out), contiguous :: drift(:)
      !> Variance of the differences
      real(dp), intent(in) :: differences
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments

      associate (model => channel%drift%model, result => channel%drift_smoother, &
                 slow => channel%drift%slow(:channel%drift%model%count))
         call smooth_adaptive(model, slow, adaptive_drift(job%options%drift, 0.5_dp*differences), &
                              z, drift, error, job%valid, progress=job%progress)
         channel%available%drift_smoother = .not. allocated(error)
         call note_failure(channel, "drift smoother", error)
         if (.not. channel%available%drift_smoother) return
         call compute_moments(drift, moments, job%valid)
         result%mean = moments%mean + channel%level%mean
         result%variance = moments%variance
         result%dc_gain = smoothed_share(channel)
         result%q = sum(model%q(:model%count), mask=slow)
         result%r = model%r
         result%forgetting = job%options%drift%forgetting
         result%steps = size(drift, kind=int64)
         allocate (result%estimate(1))
         result%estimate(1)%text = "R"
         channel%drift_smoother_figures = figures_of(result, channel%level%variance, drift, &
            channel%level%mean, .false., channel, job%valid)
      end associate
   end subroutine run_smoother

   !> The record without the smoothed drift, and its Allan curve.
   subroutine compensate(job, drift, channel, error)
      type(job_type), intent(in) :: job
      !> Smoothed, without the level: [n]
      real(dp), allocatable, intent(inout) :: drift(:)
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error

      if (job%options%keep_series) then
         call reserve(channel%series_drift, size(drift, kind=int64), error)
         if (allocated(error)) return
         channel%series_drift(:) = drift + channel%level%mean
      end if
      drift(:) = job%x - channel%level%mean - drift
      call compute_moments(drift, channel%compensated, job%valid)
      if (channel%level%variance > 0.0_dp) channel%compensated_ratio = &
         channel%compensated%variance/channel%level%variance
      if (job%options%do_allan) call run_allan(job, drift, stage%compensated, channel, error)
      if (job%options%keep_series) call move_alloc(drift, channel%series_compensated)
   end subroutine compensate

end module gyroakf_pipeline_drift_filters
