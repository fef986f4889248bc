! SPDX-License-Identifier: MIT
!> Runs the stages of one channel in order; a failed stage is recorded, the others continue.
!>
!> Passes over the record and the memory held meanwhile: see doc/performance.md, "Passes over the
!> record".
module gyroakf_pipeline_channel
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_progress, only : report_progress
   use gyroakf_record, only : add_text
   use gyroakf_preprocess_clean, only : clean_series
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_stats_moments, only : compute_moments
   use gyroakf_allan_halves, only : compare_halves, halves_options
   use gyroakf_pipeline_result, only : channel_result_type, stage
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_coefficients, only : run_allan, compare_coefficients, withhold
   use gyroakf_pipeline_channel_filters, only : run_drift_filters, run_filters
   use gyroakf_pipeline_channel_models, only : run_ar
   use gyroakf_pipeline_channel_tests, only : find_quantization_step, plan_pass, &
      run_periodicity, run_tests
   use gyroakf_pipeline_verdict, only : examine_means, judge
   use gyroakf_pipeline_warnings, only : note_failure, warn_outliers, warn_curve, warn_fit, &
      warn_halves
   implicit none (type, external)
   private
   public :: run_channel

   !> A mean below this share of the standard deviation is left in the series that is filtered
   real(dp), parameter :: negligible_mean = 1.0e-6_dp

contains

   !> Characterizes and filters one channel.
   subroutine run_channel(given, channel, error)
      !> With the samples as read; the cleaned ones are added here
      type(job_type), intent(in) :: given
      !> `name` is set before; all else is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable, target :: cleaned(:)
      integer(int8), allocatable, target :: present_samples(:)
      type(job_type) :: job
      logical :: keep_series, detrended
      integer :: stat

      job = given
      job%z => job%x
      job%valid => job%recorded
      keep_series = job%options%keep_series
      detrended = job%options%clean%degree >= 0
      call compute_moments(job%x, channel%raw, job%recorded)
      channel%level = channel%raw
      channel%cleaned = channel%raw
      channel%clean%mean = channel%raw%mean
      channel%clean%variance = channel%raw%variance
      if (detrended .or. job%options%clean%method /= "none") then
         call clean_series(job%x, job%options%clean, cleaned, present_samples, channel%clean, &
                           error, job%recorded, job%progress)
         call note_failure(channel%unavailable, "outliers and trend", error, &
            channel%available%preprocess)
         if (allocated(error)) return
      end if
      if (channel%available%preprocess) then
         job%z => cleaned
         nullify (job%valid)
         if (allocated(present_samples)) job%valid => present_samples
         channel%available%cleaned = detrended .or. channel%clean%removed > 0
         call compute_moments(cleaned, channel%cleaned, job%valid)
         channel%level = channel%cleaned
         if (detrended) call compute_moments(job%x, channel%level, job%valid)
         if (channel%clean%removed > 0) channel%tested = "record without its outliers"
         call warn_outliers(channel, job%step, job%rate_known)
      end if
      call analyze(job, channel, error)
      if (allocated(error)) return
      if (allocated(cleaned) .and. .not. keep_series) deallocate (cleaned)
      if (job%options%do_filter) call run_drift_filters(job, channel, error)
      if (allocated(error) .or. .not. keep_series) return
      if (allocated(cleaned)) call move_alloc(cleaned, channel%series_cleaned)
      stat = 0
      if (.not. allocated(channel%series_cleaned)) allocate (channel%series_cleaned, &
         source=job%x, stat=stat)
      if (allocated(present_samples)) then
         call move_alloc(present_samples, channel%series_present)
      else if (associated(job%valid) .and. stat == 0) then
         allocate (channel%series_present, source=job%valid, stat=stat)
      end if
      call check_memory(stat, "the cleaned series", error)
   end subroutine run_channel

   !> Everything after cleaning.
   subroutine analyze(job, channel, error)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      type(autocovariance_type) :: shared
      logical :: trend, described

      associate (options => job%options)
         described = options%do_tests .or. options%do_allan
         if (described) call find_quantization_step(job, channel, error)
         if (described .and. .not. allocated(error)) call examine_means(job, channel, error)
         if (allocated(error)) return
         trend = channel%available%preprocess .and. options%clean%degree >= 0
         if (options%do_tests .and. trend .and. .not. options%test_cleaned) then
            call run_tests(job%x, channel%level, job, channel, shared, error)
            call plan_pass(job, channel%cleaned, shared)
         else
            if (trend) channel%tested = "cleaned series"
            if (options%do_tests) then
               call run_tests(job%z, channel%cleaned, job, channel, shared, error)
            else
               call plan_pass(job, channel%cleaned, shared)
            end if
         end if
         if (allocated(error) .or. index(options%design_only, "drift") == 1) return
         if (options%do_ar .or. options%do_filter) then
            call report_progress("AR model", 0_int64, size(job%z, kind=int64), error, job%progress)
            if (.not. allocated(error)) call run_ar(job, channel, shared, error)
            if (allocated(error)) return
         end if
         if (options%do_tests) call run_periodicity(job, channel, error)
         if (options%do_allan .and. .not. allocated(error)) call run_curves(job, channel, error)
         if (described .and. .not. allocated(error)) call judge(job, channel, error)
         if (described .and. .not. allocated(error)) call withhold(job, channel)
         if (options%do_allan .and. .not. allocated(error)) call run_halves(job, channel, error)
         if (options%do_filter .and. channel%available%ar .and. .not. allocated(error)) then
            call filter_centered(job, channel, error)
            if (.not. allocated(error)) call compare_coefficients(channel)
         end if
      end associate
   end subroutine analyze

   !> Allan curves as read, without outliers, and cleaned.
   subroutine run_curves(job, channel, error)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error

      call run_allan(job, job%x, stage%input, channel, error)
      if (channel%clean%removed > 0 .and. .not. allocated(error)) then
         call run_allan(job, job%x, stage%outliers_removed, channel, error)
      end if
      if (allocated(error)) return
      if (.not. channel%available%cleaned) then
         channel%allan(stage%cleaned) = channel%allan(stage%input)
      else if (job%options%clean%degree < 0) then
         channel%allan(stage%cleaned) = channel%allan(stage%outliers_removed)
      else
         call run_allan(job, job%z, stage%cleaned, channel, error)
      end if
   end subroutine run_curves

   !> Warnings of the curve as read, and the comparison of the record's halves.
   subroutine run_halves(job, channel, error)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error

      call warn_curve(channel, job%step, job%rate_known)
      call warn_fit(channel)
      call report_progress("comparing the halves", 0_int64, size(job%x, kind=int64), error, &
                           job%progress)
      if (allocated(error)) return
      associate (noise => channel%allan(stage%input)%noise)
         if (noise%described) then
            call compare_halves(job%x, job%step, noise, &
                                halves_options(min_coverage=job%options%allan%min_coverage), &
                                channel%halves, error, job%recorded, job%progress)
            call note_failure(channel%unavailable, "comparison of the record's halves", error, &
               channel%available%halves)
         end if
      end associate
      if (.not. allocated(error)) call warn_halves(channel, job%rate_known)
   end subroutine run_halves

   !> Filters the series without its mean; a copy is made only where the mean counts.
   subroutine filter_centered(job, channel, error)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: centered(:)
      integer :: stat

      associate (mean => channel%cleaned%mean)
         if (abs(mean) <= negligible_mean*channel%cleaned%std) then
            call run_filters(job, job%z, 0.0_dp, channel, error)
            return
         end if
         allocate (centered(size(job%z, kind=int64)), stat=stat)
         call check_memory(stat, "the series without its mean", error)
         if (allocated(error)) return
         centered(:) = job%z - mean
         call add_text(channel%warnings, "the filters work on the series less its mean of "// &
            format_real(mean, 5)//"; their outputs are without it", note=.true.)
         call run_filters(job, centered, mean, channel, error)
      end associate
   end subroutine filter_centered

end module gyroakf_pipeline_channel
