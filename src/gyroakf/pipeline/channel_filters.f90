! SPDX-License-Identifier: MIT
!> The paper's filters of one channel: Kalman and adaptive Kalman filter of the cleaned series.
module gyroakf_pipeline_channel_filters
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_design, only : design_kf, design_akf
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, filter_figures_type, stage, stage_names
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_truth, only : compute_rmse
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: run_filters, run_designed, figures_of, reserve

contains

   !> Filters the cleaned series with every filter there is, and computes the Allan curves of the paper's outputs.
   !>
   !> One filtered series is alive at a time unless `options%keep_series`.
   subroutine run_filters(record, z, mean, options, channel, error, valid, progress)
      !> Sample interval and unit are taken from it
      type(record_type), intent(in) :: record
      !> Cleaned series without its mean: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> The mean that was subtracted
      real(dp), intent(in) :: mean
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> `ar` is filled; filter results, figures and curves are filled here
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like; a filter that cannot be designed is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: x(:)
      integer :: which

      channel%designed_mean = mean
      do which = stage%kf, stage%akf
         if (options%design_only /= "" .and. options%design_only /= stage_names(which)) cycle
         call reserve(x, size(z, kind=int64), error)
         if (allocated(error)) return
         call run_paper_filter(which, z, mean, x, options, channel, error, valid, progress)
         if (allocated(error)) return
         if (options%do_allan .and. merge(channel%available%kf, channel%available%akf, which == stage%kf)) then
            call run_allan(x, record%sample_interval, record%rate_known, record%unit, options, which, channel, error, valid, &
                           progress)
            if (allocated(error)) return
         end if
         if (options%keep_series .and. which == stage%kf) call move_alloc(x, channel%series_kf)
         if (options%keep_series .and. which == stage%akf) call move_alloc(x, channel%series_akf)
      end do
   end subroutine run_filters

   !> One of the paper's two filters.
   subroutine run_paper_filter(which, z, mean, x, options, channel, error, valid, progress)
      integer, intent(in) :: which
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: mean
      real(dp), intent(out), contiguous :: x(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      type(filter_result_type) :: filtered
      logical :: done

      if (which == stage%kf) then
         call design_kf(channel%filter_ar, options%design, filter, error)
         call run_designed(filter, "Kalman filter", z, x, options, channel, filtered, done, error, valid, progress)
      else
         call design_akf(channel%filter_ar, difference_variance(z, valid), options%design, filter, error)
         call run_designed(filter, "adaptive Kalman filter", z, x, options, channel, filtered, done, error, valid, progress)
      end if
      if (.not. done) return
      if (which == stage%kf) then
         channel%available%kf = .true.
         channel%kf = filtered
         channel%kf_figures = figures_of(filtered, channel%cleaned%variance, x, mean, .true., channel, valid)
      else
         channel%available%akf = .true.
         channel%akf = filtered
         channel%akf_figures = figures_of(filtered, channel%cleaned%variance, x, mean, .true., channel, valid)
      end if
   end subroutine run_paper_filter

   !> Runs a filter; what cannot be done is noted in the channel. Where it shall be made only, it is kept there instead.
   subroutine run_designed(filter, name, z, x, options, channel, filtered, done, error, valid, progress)
      !> Made, where `error` is not set
      type(filter_type), intent(inout) :: filter
      !> Its name in the note
      character(*), intent(in) :: name
      !> Series and output: [n]
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(out), contiguous :: x(:)
      !> `design_only`
      type(pipeline_options), intent(in) :: options
      !> Gets the note
      type(channel_result_type), intent(inout) :: channel
      !> What the filter did, where it is `done`
      type(filter_result_type), intent(out) :: filtered
      logical, intent(out) :: done
      !> That of its design; no_memory, cancelled and the like afterwards
      type(error_type), allocatable, intent(inout) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer :: stat

      done = .false.
      if (options%design_only /= "") then
         if (allocated(error)) return
         allocate (channel%designed, source=filter, stat=stat)
         if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for a filter")
         return
      end if
      if (.not. allocated(error)) call filter_series(filter, z, x, filtered, error, valid, progress)
      done = .not. allocated(error)
      if (.not. is_fatal(error)) call note_failure(channel, name, error)
   end subroutine run_designed

   !> Ratios of variances, and the RMSE where the true drift is known.
   pure function figures_of(filtered, input_variance, x, mean, detrended, channel, valid) result(figures)
      !> What the filter did
      type(filter_result_type), intent(in) :: filtered
      !> Of the series that it filtered
      real(dp), intent(in) :: input_variance
      !> The output: [n]; of the series less this mean, and less its trend
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: mean
      logical, intent(in) :: detrended
      !> `raw` is filled
      type(channel_result_type), intent(in) :: channel
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(filter_figures_type) :: figures

      if (input_variance > 0.0_dp) figures%variance_ratio = filtered%variance/input_variance
      if (channel%raw%variance > 0.0_dp) figures%raw_variance_ratio = filtered%variance/channel%raw%variance
      figures%passed_percent = 100.0_dp*filtered%dc_gain
      figures%lost_percent = 100.0_dp - figures%passed_percent
      call compute_rmse(x, mean, detrended, channel, figures%rmse, figures%rmse_samples, valid)
   end function figures_of

   !> Memory for one series, where there is none yet.
   subroutine reserve(x, n, error)
      !> Allocated afterwards
      real(dp), allocatable, intent(inout) :: x(:)
      !> Samples
      integer(int64), intent(in) :: n
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      integer :: failed

      if (allocated(x)) return
      allocate (x(n), stat=failed)
      if (failed /= 0) call fatal_error(error, status%no_memory, "no memory for a filtered series")
   end subroutine reserve

end module gyroakf_pipeline_channel_filters
