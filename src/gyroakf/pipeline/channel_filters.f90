! SPDX-License-Identifier: MIT
!> The filters of one channel: the paper's, of the cleaned series, and the recommended ones, of the
!> drift that the record itself shows.
!>
!> The latter work on the record as read without its outliers: a polynomial that was fitted to the
!> whole record is not there while a sensor is in use, and a random walk follows what it would
!> remove. Off line the smoother sees the record from both sides; what is left of the record without
!> the smoothed drift is `compensated`.
module gyroakf_pipeline_channel_filters
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_filter_design, only : adaptive_drift, design_akf, design_drift_akf, &
      design_drift_kf, design_kf
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_kalman, only : drift_filter_type, filter_type
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_stats_moments, only : compute_moments, moments_type
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_channel_models, only : find_drift, judge_model, smoothed_share
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type, stage
   use gyroakf_pipeline_truth, only : compute_rmse
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_filters, run_drift_filters

contains

   !> Filters the cleaned series with the paper's filters, and computes the Allan curves of their
   !> outputs.
   !>
   !> One filtered series is alive at a time unless `keep_series`.
   subroutine run_filters(job, z, mean, channel, error)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> Cleaned series without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> The mean that was subtracted
      real(dp), intent(in) :: mean
      !> `ar` is filled; filter results, figures and curves are filled here
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like; a filter that cannot be designed is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: x(:)
      real(dp) :: differences

      channel%designed_mean = mean
      call run_filter("kf", job, z, mean, 0.0_dp, x, channel, error)
      if (allocated(error)) return
      if (job%options%do_allan .and. channel%available%kf) then
         call run_allan(job, x, stage%kf, channel, error)
         if (allocated(error)) return
      end if
      if (job%options%keep_series) call move_alloc(x, channel%series_kf)
      differences = difference_variance(z, job%valid)
      call run_filter("akf", job, z, mean, differences, x, channel, error)
      if (job%options%do_allan .and. channel%available%akf .and. .not. allocated(error)) then
         call run_allan(job, x, stage%akf, channel, error)
      end if
      if (job%options%keep_series .and. .not. allocated(error)) then
         call move_alloc(x, channel%series_akf)
      end if
   end subroutine run_filters

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
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: drift(:)
      real(dp), intent(in) :: differences
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: moments

      associate (model => channel%drift%model, result => channel%drift_smoother, &
                 slow => channel%drift%slow(:channel%drift%model%count))
         call smooth_adaptive(model, slow, adaptive_drift(job%options%drift, 0.5_dp*differences), &
                              z, drift, error, job%valid, progress=job%progress)
         call note_failure(channel%unavailable, "drift smoother", error, &
            channel%available%drift_smoother)
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
         channel%drift_smoother_figures = figures_of(job, result, channel%level%variance, drift, &
            channel%level%mean, .false., channel)
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

   !> Designs a filter and runs it; what cannot be done is noted in the channel. Where one filter
   !> shall be made only, it is kept there instead, and the others are left out.
   subroutine run_filter(name, job, z, mean, differences, x, channel, error)
      !> "kf", "akf", "drift_kf" or "drift_akf"
      character(*), intent(in) :: name
      type(job_type), intent(in) :: job
      !> The series: [n], without this mean
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: mean
      !> Variance of the differences of the series, for an adaptive filter
      real(dp), intent(in) :: differences
      !> The output; its memory is taken where it is there
      real(dp), allocatable, intent(inout) :: x(:)
      type(channel_result_type), intent(inout) :: channel
      !> That of its design where it shall be made only; no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      class(filter_type), allocatable :: filter
      type(filter_result_type) :: filtered
      type(filter_figures_type) :: figures
      character(22) :: title
      logical :: of_drift

      if (job%options%design_only /= "" .and. job%options%design_only /= name) return
      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      of_drift = index(name, "drift") == 1
      call design_filter(name, job, differences, channel, filter, title, error)
      if (job%options%design_only /= "") then
         if (.not. allocated(error)) call move_alloc(filter, channel%designed)
         return
      end if
      if (.not. allocated(error)) call filter_series(filter, z, x, filtered, error, job%valid, &
                                                     job%progress)
      if (allocated(error)) then
         call note_failure(channel%unavailable, trim(title), error)
         return
      end if
      if (of_drift) filtered%mean = filtered%mean + mean
      figures = figures_of(job, filtered, merge(channel%level%variance, channel%cleaned%variance, &
                                           of_drift), x, mean, .not. of_drift, channel)
      select case (name)
      case ("kf"); call keep(channel%available%kf, channel%kf, channel%kf_figures)
      case ("akf"); call keep(channel%available%akf, channel%akf, channel%akf_figures)
      case ("drift_kf")
         call keep(channel%available%drift_kf, channel%drift_kf, channel%drift_kf_figures)
      case default
         call keep(channel%available%drift_akf, channel%drift_akf, channel%drift_akf_figures)
      end select

   contains

      subroutine keep(available, kept, kept_figures)
         logical, intent(inout) :: available
         type(filter_result_type), intent(inout) :: kept
         type(filter_figures_type), intent(inout) :: kept_figures

         available = .true.
         kept = filtered
         kept_figures = figures
      end subroutine keep

   end subroutine run_filter

   !> The filter of that name, before its first step.
   subroutine design_filter(name, job, differences, channel, filter, title, error)
      !> As of `run_filter`
      character(*), intent(in) :: name
      type(job_type), intent(in) :: job
      real(dp), intent(in) :: differences
      type(channel_result_type), intent(in) :: channel
      class(filter_type), allocatable, intent(out) :: filter
      !> What messages call it
      character(*), intent(out) :: title
      type(error_type), allocatable, intent(out) :: error
      logical :: adaptive
      integer :: stat

      adaptive = index(name, "akf") > 0
      if (index(name, "drift") == 1) then
         title = merge("adaptive drift filter", "drift Kalman filter  ", adaptive)
         allocate (drift_filter_type :: filter, stat=stat)
      else
         title = merge("adaptive Kalman filter", "Kalman filter         ", adaptive)
         allocate (filter_type :: filter, stat=stat)
      end if
      call check_memory(stat, "a filter", error)
      if (allocated(error)) return
      select type (filter)
      type is (drift_filter_type)
         if (adaptive) then
            call design_drift_akf(channel%drift, differences, job%options%drift, filter, error)
         else
            call design_drift_kf(channel%drift, filter, error)
         end if
      type is (filter_type)
         if (adaptive) then
            call design_akf(channel%filter_ar, differences, job%options%design, filter, error)
         else
            call design_kf(channel%filter_ar, job%options%design, filter, error)
         end if
      end select
   end subroutine design_filter

   !> Ratios of variances, and the RMSE where the true drift is known.
   pure type(filter_figures_type) function figures_of(job, filtered, input_variance, x, mean, &
                                                      detrended, channel) result(figures)
      type(job_type), intent(in) :: job
      type(filter_result_type), intent(in) :: filtered
      !> Of the series that it filtered
      real(dp), intent(in) :: input_variance
      !> The output: [n]; of the series less this mean, and less its trend
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: mean
      logical, intent(in) :: detrended
      type(channel_result_type), intent(in) :: channel

      if (input_variance > 0.0_dp) figures%variance_ratio = filtered%variance/input_variance
      figures%passed_percent = 100.0_dp*filtered%dc_gain
      figures%lost_percent = 100.0_dp - figures%passed_percent
      call compute_rmse(job, x, mean, detrended, channel, figures)
   end function figures_of

   !> Memory for one series, where there is none yet.
   subroutine reserve(x, n, error)
      real(dp), allocatable, intent(inout) :: x(:)
      integer(int64), intent(in) :: n
      type(error_type), allocatable, intent(out) :: error
      integer :: stat

      if (allocated(x)) return
      allocate (x(n), stat=stat)
      call check_memory(stat, "a filtered series", error)
   end subroutine reserve

end module gyroakf_pipeline_channel_filters
