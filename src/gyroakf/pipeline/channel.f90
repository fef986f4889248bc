! SPDX-License-Identifier: MIT
!> Runs the stages of one channel in order; a failed stage is recorded, the others continue.
!>
!> Passes over the record and the memory held meanwhile: see doc/performance.md, "Passes over the
!> record".
module gyroakf_pipeline_channel
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : record_type
   use gyroakf_preprocess_clean, only : clean_series
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_stats_moments, only : compute_moments
   use gyroakf_allan_halves, only : compare_halves, halves_options
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, stage
   use gyroakf_pipeline_coefficients, only : run_allan, compare_coefficients
   use gyroakf_pipeline_channel_filters, only : run_filters
   use gyroakf_pipeline_channel_model, only : run_ar
   use gyroakf_pipeline_channel_periodicity, only : run_periodicity
   use gyroakf_pipeline_channel_tests, only : find_step, plan_pass, run_tests
   use gyroakf_pipeline_drift_filters, only : run_drift_filters
   use gyroakf_pipeline_verdict, only : examine_means, judge
   use gyroakf_pipeline_warnings, only : note_failure, warn_outliers, warn_curve, warn_fit, &
      warn_halves, warn_centred
   implicit none (type, external)
   private
   public :: run_channel

   !> A mean below this share of the standard deviation is left in the series that is filtered
   real(dp), parameter :: negligible_mean = 1.0e-6_dp

contains

   !> Characterises and filters one channel.
   subroutine run_channel(record, x, options, channel, error, valid, progress)
      !> Sample interval and unit are taken from it
      type(record_type), intent(in) :: record
      !> The channel's samples, in the unit of the record: [n], finite
      real(dp), intent(in), contiguous :: x(:)
      !> Options of the main job
      type(pipeline_options), intent(in) :: options
      !> `name` is set before; all else is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: cleaned(:)
      integer(int8), allocatable :: present_samples(:)

      call compute_moments(x, channel%raw, valid)
      channel%level = channel%raw
      channel%cleaned = channel%raw
      channel%clean%mean = channel%raw%mean
      channel%clean%variance = channel%raw%variance
      if (options%clean%degree >= 0 .or. options%clean%method /= "none") then
         call clean_series(x, options%clean, cleaned, present_samples, channel%clean, error, &
                           valid, progress)
         channel%available%preprocess = .not. allocated(error)
         channel%available%cleaned = channel%available%preprocess .and. &
            (options%clean%degree >= 0 .or. channel%clean%removed > 0)
         call note_failure(channel, "outliers and trend", error)
         if (allocated(error)) return
      end if
      if (channel%available%preprocess) then
         call compute_moments(cleaned, channel%cleaned, present_samples)
         channel%level = channel%cleaned
         if (options%clean%degree >= 0) call compute_moments(x, channel%level, present_samples)
         if (channel%clean%removed > 0) channel%tested = "record without its outliers"
         call warn_outliers(channel, record%sample_interval, record%rate_known)
         call analyze(record, x, cleaned, options, channel, error, present_samples, valid, progress)
      else
         call analyze(record, x, x, options, channel, error, valid, valid, progress)
      end if
      if (allocated(error)) return
      if (allocated(cleaned) .and. .not. options%keep_series) deallocate (cleaned)
      if (options%do_filter .and. channel%available%preprocess) then
         call run_drift_filters(record, x, options, channel, error, present_samples, progress)
      else if (options%do_filter) then
         call run_drift_filters(record, x, options, channel, error, valid, progress)
      end if
      if (allocated(channel%true_drift)) deallocate (channel%true_drift)
      if (allocated(channel%true_drift_present)) deallocate (channel%true_drift_present)
      if (allocated(error) .or. .not. options%keep_series) return
      if (allocated(cleaned)) call move_alloc(cleaned, channel%series_cleaned)
      if (.not. allocated(channel%series_cleaned)) channel%series_cleaned = x
      if (allocated(present_samples)) then
         call move_alloc(present_samples, channel%series_present)
      else if (present(valid) .and. .not. channel%available%preprocess) then
         channel%series_present = valid
      end if
   end subroutine run_channel

   !> Everything after cleaning.
   subroutine analyze(record, x, z, options, channel, error, valid, recorded, progress)
      !> Sample interval and unit
      type(record_type), intent(in) :: record
      !> As read, and cleaned: [n]
      real(dp), intent(in), contiguous :: x(:), z(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: of z, outliers missing too, and of x
      integer(int8), intent(in), optional :: valid(:), recorded(:)
      class(progress_type), intent(inout), optional :: progress
      type(autocovariance_type) :: shared
      integer(int64) :: n
      logical :: trend, described

      n = size(z, kind=int64)
      described = options%do_tests .or. options%do_allan
      if (described) call find_step(x, channel, error, valid, progress)
      if (described .and. .not. allocated(error)) call examine_means(x, channel, error, valid)
      if (allocated(error)) return
      trend = channel%available%preprocess .and. options%clean%degree >= 0
      if (options%do_tests .and. trend .and. .not. options%test_cleaned) then
         call run_tests(x, channel%level, options, channel, shared, error, valid, progress)
         call plan_pass(n, options, channel%cleaned, shared)
      else
         if (trend) channel%tested = "cleaned series"
         if (options%do_tests) call run_tests(z, channel%cleaned, options, channel, shared, error, &
                                              valid, progress)
         if (.not. options%do_tests) call plan_pass(n, options, channel%cleaned, shared)
      end if
      if (allocated(error)) return
      if (index(options%design_only, "drift") == 1) return
      if (options%do_ar .or. options%do_filter) then
         call report_progress("AR model", 0_int64, n, error, progress)
         if (.not. allocated(error)) call run_ar(z, options, channel, shared, error, valid, &
            progress)
         if (allocated(error)) return
      end if
      if (options%do_tests) call run_periodicity(z, record, options, channel, error, valid, &
         progress)
      if (options%do_allan .and. .not. allocated(error)) then
         call run_curves(record, x, z, options, channel, error, valid, recorded, progress)
      end if
      if (described .and. .not. allocated(error)) then
         call judge(x, record, options, channel, error, valid, progress)
      end if
      if (options%do_allan .and. .not. allocated(error)) then
         call warn_curve(channel, record)
         call warn_fit(channel)
         call report_progress("comparing the halves", 0_int64, n, error, progress)
         if (allocated(error)) return
         if (channel%allan(stage%input)%noise%described) then
            call compare_halves(x, record%sample_interval, channel%allan(stage%input)%noise, &
                                halves_options(min_coverage=options%allan%min_coverage), &
                                channel%halves, error, recorded, progress)
            channel%available%halves = .not. allocated(error)
            call note_failure(channel, "comparison of the record's halves", error)
         end if
         if (.not. allocated(error)) call warn_halves(channel, record%rate_known)
      end if
      if (options%do_filter .and. channel%available%ar .and. .not. allocated(error)) then
         call filter_centred(record, z, options, channel, error, valid, progress)
         if (.not. allocated(error)) call compare_coefficients(channel)
      end if
   end subroutine analyze

   !> Allan curves as read, without outliers, and cleaned.
   subroutine run_curves(record, x, z, options, channel, error, valid, recorded, progress)
      type(record_type), intent(in) :: record
      !> As those of analyze
      real(dp), intent(in), contiguous :: x(:), z(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:), recorded(:)
      class(progress_type), intent(inout), optional :: progress

      call run_allan(x, record, options, stage%input, channel, error, recorded, progress)
      if (channel%clean%removed > 0 .and. .not. allocated(error)) then
         call run_allan(x, record, options, stage%outliers_removed, channel, error, valid, progress)
      end if
      if (allocated(error)) return
      if (.not. channel%available%cleaned) then
         channel%allan(stage%cleaned) = channel%allan(stage%input)
      else if (options%clean%degree < 0) then
         channel%allan(stage%cleaned) = channel%allan(stage%outliers_removed)
      else
         call run_allan(z, record, options, stage%cleaned, channel, error, valid, progress)
      end if
   end subroutine run_curves

   !> Filters the series without its mean; a copy is made only where the mean counts.
   subroutine filter_centred(record, z, options, channel, error, valid, progress)
      type(record_type), intent(in) :: record
      real(dp), intent(in), contiguous :: z(:)
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: centred(:)
      integer :: failed

      if (abs(channel%cleaned%mean) <= negligible_mean*channel%cleaned%std) then
         call run_filters(record, z, 0.0_dp, options, channel, error, valid, progress)
         return
      end if
      allocate (centred(size(z, kind=int64)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the series without its mean")
         return
      end if
      centred(:) = z - channel%cleaned%mean
      call warn_centred(channel)
      call run_filters(record, centred, channel%cleaned%mean, options, channel, error, valid, &
                       progress)
   end subroutine filter_centred

end module gyroakf_pipeline_channel
