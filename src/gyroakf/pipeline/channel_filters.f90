! SPDX-License-Identifier: MIT
!> The four filters of one channel, and the series of the paper's two: Kalman and adaptive Kalman
!> filter of the cleaned series.
module gyroakf_pipeline_channel_filters
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_filter_design, only : design_akf, design_drift_akf, design_drift_kf, design_kf
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_stats_differences, only : difference_variance
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type, stage
   use gyroakf_pipeline_coefficients, only : run_allan
   use gyroakf_pipeline_truth, only : compute_rmse
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_filters, run_filter, figures_of, reserve

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

   !> Designs a filter and runs it; what cannot be done is noted in the channel. Where one filter
   !> shall be made only, it is kept there instead, and the others are left out.
   subroutine run_filter(name, job, z, mean, differences, x, channel, error)
      !> "kf", "akf", "drift_kf" or "drift_akf"
      character(*), intent(in) :: name
      !> The channel in work
      type(job_type), intent(in) :: job
      !> The series: [n], without this mean
      real(dp), intent(in), contiguous :: z(:)
      real(dp), intent(in) :: mean
      !> Variance of the differences of the series, for an adaptive filter
      real(dp), intent(in) :: differences
      !> The output; its memory is taken where it is there
      real(dp), allocatable, intent(inout) :: x(:)
      !> What the filter did, and its figures; gets a note
      type(channel_result_type), intent(inout) :: channel
      !> That of its design where it shall be made only; no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      type(filter_type) :: filter
      type(filter_result_type) :: filtered
      type(filter_figures_type) :: figures
      character(22) :: title
      logical :: of_drift
      integer :: stat

      if (job%options%design_only /= "" .and. job%options%design_only /= name) return
      call reserve(x, size(z, kind=int64), error)
      if (allocated(error)) return
      of_drift = index(name, "drift") == 1
      select case (name)
      case ("kf")
         title = "Kalman filter"
         call design_kf(channel%filter_ar, job%options%design, filter, error)
      case ("akf")
         title = "adaptive Kalman filter"
         call design_akf(channel%filter_ar, differences, job%options%design, filter, error)
      case ("drift_kf")
         title = "drift Kalman filter"
         call design_drift_kf(channel%drift, filter, error)
      case default
         title = "adaptive drift filter"
         call design_drift_akf(channel%drift, differences, job%options%drift, filter, error)
      end select
      if (job%options%design_only /= "") then
         if (allocated(error)) return
         allocate (channel%designed, source=filter, stat=stat)
         call check_memory(stat, "a filter", error)
         return
      end if
      if (.not. allocated(error)) call filter_series(filter, z, x, filtered, error, job%valid, &
                                                     job%progress)
      if (allocated(error)) then
         call note_failure(channel, trim(title), error)
         return
      end if
      if (of_drift) filtered%mean = filtered%mean + mean
      figures = figures_of(filtered, merge(channel%level%variance, channel%cleaned%variance, &
                                           of_drift), x, mean, .not. of_drift, channel, job%valid)
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

   !> Ratios of variances, and the RMSE where the true drift is known.
   pure function figures_of(filtered, input_variance, x, mean, detrended, channel, valid) &
      result(figures)
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
      integer :: stat

      if (allocated(x)) return
      allocate (x(n), stat=stat)
      call check_memory(stat, "a filtered series", error)
   end subroutine reserve

end module gyroakf_pipeline_channel_filters
