! SPDX-License-Identifier: MIT
!> The recommended filters of one channel: of the drift that the record itself shows.
!>
!> They work on the record as read without its outliers: a polynomial that was fitted to the whole record is not there while a
!> sensor is in use, and a random walk follows what it would remove. Off line the smoother sees the record from both sides; what is
!> left of the record without the smoothed drift is `compensated`.
module gyroakf_pipeline_drift_filters
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_filter_design, only : adaptive_drift, design_drift_akf, design_drift_kf
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_channel_drift, only : find_drift, judge_model, smoothed_share
   use gyroakf_pipeline_channel_filters, only : figures_of, reserve, run_designed
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, filter_figures_type, stage
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_drift_filters

contains

   !> Identifies the drift, filters and smooths it, and computes the Allan curve of the record without it.
   !>
   !> Alive at a time: the record without its mean, one output, the white noise of each sample; afterwards one series and what its
   !> Allan curve takes. With `options%keep_series` all outputs stay.
   subroutine run_drift_filters(record, x, options, channel, error, valid, progress)
      !> Sample interval and unit are taken from it
      type(record_type), intent(in) :: record
      !> As read: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> Drift, filter results, figures and the curve are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; what cannot be done is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing (outliers too): [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: z(:), drift(:)
      real(dp) :: differences

      call reserve(z, size(x, kind=int64), error)
      if (allocated(error)) return
      z(:) = x - channel%level%mean
      call find_drift(z, record%sample_interval, record%rate_known, record%unit, options, channel, error, valid, progress)
      if (allocated(error) .or. .not. channel%drift%found) return
      differences = difference_variance(z, valid)
      channel%designed_mean = channel%level%mean
      if (options%design_only /= "drift_akf") call run_one(z, differences, .false., options, channel, error, valid, progress)
      if (.not. allocated(error) .and. options%design_only /= "drift_kf") then
         call judge_model(channel)
         call run_one(z, differences, .true., options, channel, error, valid, progress)
      end if
      if (options%design_only /= "") return
      if (.not. allocated(error)) call reserve(drift, size(x, kind=int64), error)
      if (.not. allocated(error)) then
         call run_smoother(z, drift, differences, options, channel, error, valid, progress)
      end if
      if (allocated(error) .or. .not. channel%available%drift_smoother) return
      deallocate (z)
      call compensate(record, x, drift, options, channel, error, valid, progress)
   end subroutine run_drift_filters

   !> One of the drift's two filters.
   subroutine run_one(z, differences, adaptive, options, channel, error, valid, progress)
      !> Without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Variance of the differences
      real(dp), intent(in) :: differences
      !> R is adapted
      logical, intent(in) :: adaptive
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      type(filter_result_type) :: filtered
      type(filter_figures_type) :: figures
      real(dp), allocatable :: x(:)
      logical :: done

      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      if (adaptive) then
         call design_drift_akf(channel%drift, differences, options%drift, filter, error)
         call run_designed(filter, "adaptive drift filter", z, x, options, channel, filtered, done, error, valid, progress)
      else
         call design_drift_kf(channel%drift, filter, error)
         call run_designed(filter, "drift Kalman filter", z, x, options, channel, filtered, done, error, valid, progress)
      end if
      if (.not. done) return
      filtered%mean = filtered%mean + channel%level%mean
      figures = figures_of(filtered, channel%level%variance, x, channel%level%mean, .false., channel, valid)
      if (adaptive) then
         channel%available%drift_akf = .true.
         channel%drift_akf = filtered
         channel%drift_akf_figures = figures
      else
         channel%available%drift_kf = .true.
         channel%drift_kf = filtered
         channel%drift_kf_figures = figures
      end if
      if (.not. options%keep_series) return
      x(:) = x + channel%level%mean
      if (adaptive) call move_alloc(x, channel%series_drift_akf)
      if (.not. adaptive) call move_alloc(x, channel%series_drift_kf)
   end subroutine run_one

   !> The drift from both sides, the variance of the white noise at each sample too.
   subroutine run_smoother(z, drift, differences, options, channel, error, valid, progress)
      !> Without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Smoothed: [n]
      real(dp), intent(out), contiguous :: drift(:)
      !> Variance of the differences
      real(dp), intent(in) :: differences
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(moments_type) :: moments

      associate (model => channel%drift%model)
         call smooth_adaptive(model, channel%drift%slow(:model%count), &
                              adaptive_drift(options%drift, 0.5_dp*differences), z, drift, &
                              error, valid, progress=progress)
      end associate
      if (is_fatal(error)) return
      channel%available%drift_smoother = .not. allocated(error)
      call note_failure(channel, "drift smoother", error)
      if (.not. channel%available%drift_smoother) return
      call compute_moments(drift, moments, valid)
      associate (model => channel%drift%model, result => channel%drift_smoother)
         result%mean = moments%mean + channel%level%mean
         result%variance = moments%variance
         result%dc_gain = smoothed_share(channel)
         result%q = sum(model%q(:model%count), mask=channel%drift%slow(:model%count))
         result%r = model%r
         result%forgetting = options%drift%forgetting
         result%steps = size(drift, kind=int64)
         allocate (result%estimate(1))
         result%estimate(1)%text = "R"
         channel%drift_smoother_figures = figures_of(result, channel%level%variance, drift, &
                                                     channel%level%mean, .false., channel, valid)
      end associate
   end subroutine run_smoother

   !> The record without the smoothed drift, and its Allan curve.
   subroutine compensate(record, x, drift, options, channel, error, valid, progress)
      type(record_type), intent(in) :: record
      !> As read: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Smoothed, without the level: [n]
      real(dp), allocatable, intent(inout) :: drift(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress

      if (options%keep_series) then
         call reserve(channel%series_drift, size(x, kind=int64), error)
         if (allocated(error)) return
         channel%series_drift(:) = drift + channel%level%mean
      end if
      drift(:) = x - channel%level%mean - drift
      call compute_moments(drift, channel%compensated, valid)
      if (channel%level%variance > 0.0_dp) channel%compensated_ratio = channel%compensated%variance/channel%level%variance
      if (options%do_allan) call run_allan(drift, record%sample_interval, record%rate_known, record%unit, options, &
                                           stage%compensated, channel, error, valid, progress)
      if (options%keep_series) call move_alloc(drift, channel%series_compensated)
   end subroutine compensate

end module gyroakf_pipeline_drift_filters
