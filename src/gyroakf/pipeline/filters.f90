! SPDX-License-Identifier: MIT
!> The filters of one channel: the paper's Kalman and adaptive Kalman filter, and those of the identified drift.
module gyroakf_pipeline_filters
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_design, only : design_kf, design_akf, design_drift_kf, design_drift_akf
   use gyroakf_filter_identification, only : identify_drift
   use gyroakf_series_differences, only : difference_variance
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, filter_figures_type, stage, stage_names
   use gyroakf_pipeline_alternatives, only : paper_decay, score_adaptive, score_averages, score_unfiltered
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_truth, only : score_output
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_filters, figures_of, find_drift

   !> What counts as drift where nobody says: slower than so many samples, and than so many seconds
   real(dp), parameter :: drift_samples = 5.0_dp, drift_seconds = 1.0_dp

contains

   !> Filters the cleaned series with every filter there is, and computes the Allan curves of the paper's outputs.
   !>
   !> One filtered series is alive at a time unless `options%keep_series`.
   subroutine run_filters(record, z, options, channel, error, valid, progress)
      !> Sample interval and unit are taken from it
      type(record_type), intent(in) :: record
      !> Cleaned series without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> `ar` is filled; filter results, figures and curves are filled here
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like; a filter that cannot be designed is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: x(:)
      integer :: which

      call score_unfiltered(z, record%sample_interval, channel%truth, error, valid)
      if (allocated(error)) return
      do which = stage%kf, stage%akf
         call reserve(x, size(z, kind=int64), error)
         if (allocated(error)) return
         call run_paper_filter(which, z, x, options, channel, error, valid, progress)
         if (allocated(error)) return
         if (merge(channel%available%kf, channel%available%akf, which == stage%kf)) then
            call score_output(trim(stage_names(which)), x, record%sample_interval, channel%truth, error, valid, &
                              paper_decay(channel%filter_ar%coefficient))
            if (allocated(error)) return
         end if
         if (options%do_allan .and. merge(channel%available%kf, channel%available%akf, which == stage%kf)) then
            call run_allan(x, record%sample_interval, record%rate_known, record%unit, options, which, channel, error, valid, &
                           progress)
            if (allocated(error)) return
         end if
         if (options%keep_series .and. which == stage%kf) call move_alloc(x, channel%series_kf)
         if (options%keep_series .and. which == stage%akf) call move_alloc(x, channel%series_akf)
      end do
      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      call run_drift_filters(z, x, record, options, channel, error, valid, progress)
      if (.not. allocated(error)) call score_others(z, record%sample_interval, channel, error, valid)
   end subroutine run_filters

   !> Where the true drift is known: what the filters are compared with.
   subroutine score_others(z, interval, channel, error, valid)
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: interval
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      type(component_model_type) :: model

      if (channel%drift%found) then
         model%count = 1
         model%phi(1) = channel%drift%phi
         model%q(1) = channel%drift%process_variance
         model%r = channel%drift%measurement_variance
         call score_adaptive(z, interval, model, [.true.], channel%truth, error, valid)
         if (allocated(error)) return
      end if
      call score_averages(z, interval, channel%truth, error, valid)
   end subroutine score_others

   !> One of the paper's two filters.
   subroutine run_paper_filter(which, z, x, options, channel, error, valid, progress)
      integer, intent(in) :: which
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: x(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter

      if (which == stage%kf) then
         call design_kf(channel%filter_ar, options%design, filter, error)
         if (.not. allocated(error)) call filter_series(filter, z, x, channel%kf, error, valid, progress)
         if (is_fatal(error)) return
         channel%available%kf = .not. allocated(error)
         call note_failure(channel, "Kalman filter", error)
         if (channel%available%kf) channel%kf_figures = figures_of(channel%kf, channel)
      else
         call design_akf(channel%filter_ar, difference_variance(z, valid), options%design, filter, error)
         if (.not. allocated(error)) call filter_series(filter, z, x, channel%akf, error, valid, progress)
         if (is_fatal(error)) return
         channel%available%akf = .not. allocated(error)
         call note_failure(channel, "adaptive Kalman filter", error)
         if (channel%available%akf) channel%akf_figures = figures_of(channel%akf, channel)
      end if
   end subroutine run_paper_filter

   !> Drift identified from the series itself, and the filters made for it.
   subroutine run_drift_filters(z, x, record, options, channel, error, valid, progress)
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: x(:)
      type(record_type), intent(in) :: record
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter

      call find_drift(z, record, options, channel, error, valid)
      if (allocated(error) .or. .not. channel%drift%found) return
      call design_drift_kf(channel%drift, filter, error)
      if (.not. allocated(error)) call filter_series(filter, z, x, channel%drift_kf, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%drift_kf = .not. allocated(error)
      call note_failure(channel, "drift Kalman filter", error)
      if (channel%available%drift_kf) then
         channel%drift_kf_figures = figures_of(channel%drift_kf, channel)
         call score_output("drift_kf", x, record%sample_interval, channel%truth, error, valid, max(0.0_dp, channel%drift%phi))
         if (allocated(error)) return
      end if
      call design_drift_akf(channel%drift, difference_variance(z, valid), options%drift, filter, error)
      if (.not. allocated(error)) call filter_series(filter, z, x, channel%drift_akf, error, valid, progress)
      if (is_fatal(error)) return
      channel%available%drift_akf = .not. allocated(error)
      call note_failure(channel, "adaptive drift filter", error)
      if (.not. channel%available%drift_akf) return
      channel%drift_akf_figures = figures_of(channel%drift_akf, channel)
      call score_output("drift_akf", x, record%sample_interval, channel%truth, error, valid, max(0.0_dp, channel%drift%phi))
   end subroutine run_drift_filters

   !> Identifies the drift; slower than `drift_tau`, or it counts as noise.
   subroutine find_drift(z, record, options, channel, error, valid)
      real(dp), intent(in), contiguous :: z(:)
      type(record_type), intent(in) :: record
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)

      channel%drift_tau = options%drift_tau
      if (channel%drift_tau <= 0.0_dp) channel%drift_tau = &
         max(drift_samples*record%sample_interval, merge(drift_seconds, 0.0_dp, record%rate_known))
      call identify_drift(z, channel%drift, error, valid, channel%drift_tau/record%sample_interval)
      if (is_fatal(error)) return
      channel%available%drift = .not. allocated(error)
      call note_failure(channel, "drift identification", error)
      if (.not. channel%available%drift) channel%drift%found = .false.
      if (.not. channel%drift%found) return
      channel%drift_time = channel%drift%correlation_samples*record%sample_interval
      channel%drift_std = sqrt(max(0.0_dp, channel%drift%drift_variance))
      channel%white_std = sqrt(max(0.0_dp, channel%drift%measurement_variance))
   end subroutine find_drift

   !> Ratios of variances.
   pure type(filter_figures_type) function figures_of(filtered, channel) result(figures)
      type(filter_result_type), intent(in) :: filtered
      type(channel_result_type), intent(in) :: channel

      if (channel%cleaned%variance > 0.0_dp) figures%variance_ratio = filtered%variance/channel%cleaned%variance
      if (channel%raw%variance > 0.0_dp) figures%raw_variance_ratio = filtered%variance/channel%raw%variance
      figures%passed_percent = 100.0_dp*filtered%dc_gain
      figures%lost_percent = 100.0_dp - figures%passed_percent
   end function figures_of

   !> Memory for one series, where there is none yet.
   subroutine reserve(x, n, error)
      real(dp), allocatable, intent(inout) :: x(:)
      integer(int64), intent(in) :: n
      type(error_type), allocatable, intent(out) :: error
      integer :: failed

      if (allocated(x)) return
      allocate (x(n), stat=failed)
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for a filtered series")
   end subroutine reserve

end module gyroakf_pipeline_filters
