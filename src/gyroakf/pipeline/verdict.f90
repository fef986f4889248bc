! SPDX-License-Identifier: MIT
!> One verdict on the drift of a channel: everything that a report says of drift and stationarity is
!> written from it.
!>
!> 1. The means of 128 blocks, outliers missing, are searched for a ramp or a warm-up
!>    ([[find_trend]]).
!> 2. The Allan curve of the record without this trend is fitted; R is not sought beside a trend.
!> 3. The record drifts where a fit without K and R costs more than the one with them by 2; by a
!>    random walk, where K is stated.
!> 4. Where K has more than half of the fitted Allan variance at the length of a block, the ADF test
!>    of the block means has to see a unit root; if it rejects one, the noise is bounded:
!>    stationary, and K is withheld.
!> 5. Where the fit does not describe the longest times, ADF and KPSS of the block means decide.
module gyroakf_pipeline_verdict
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_record, only : add_text
   use gyroakf_io_decimal, only : format_real
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_variance, term_flicker, term_ramp, term_shape, &
      term_walk
   use gyroakf_allan_trend_test, only : block_count, block_means, find_trend, trend_means, &
      trend_test_options, trend_values
   use gyroakf_series_adf, only : adf_options, test_adf
   use gyroakf_series_kpss, only : kpss_options, test_kpss
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type, stage, verdict_type
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: examine_means, octaves_without_trend, options_beside, judge

   !> Of 128 means: t statistic of a unit root, rejected on a random walk in 3 % of records; KPSS,
   !> exceeded on white noise in 5 %
   real(dp), parameter :: unit_root_limit = -3.2_dp, level_limit = 0.463_dp
   !> By which a fit without K and R costs more where the record drifts
   real(dp), parameter :: drift_margin = 2.0_dp

contains

   !> Looks for a trend in the block means, and tests what is left of them. A failure is noted in
   !> the channel.
   subroutine examine_means(job, channel, error)
      !> The channel in work; the samples as read are examined
      type(job_type), intent(in) :: job
      !> `verdict%trend`, `adf` and `kpss` are filled; `verdict%known` where the record is long
      !> enough
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: mean(block_count)
      integer(int64) :: n

      n = size(job%x, kind=int64)
      associate (verdict => channel%verdict)
         verdict%wanted = .true.
         call block_means(job%x, mean, verdict%known, job%valid)
         if (.not. verdict%known) return
         call find_trend(mean, n, trend_test_options(), verdict%trend, error)
         if (allocated(error)) return
         mean = mean - trend_means(verdict%trend, n)
         call test_adf(mean, adf_options(criterion="bic"), verdict%adf, error)
         if (.not. allocated(error)) call test_kpss(mean, kpss_options(), verdict%kpss, error)
         call note_failure(channel%unavailable, "verdict on drift", error, verdict%known)
      end associate
   end subroutine examine_means

   !> Gives a curve the octaves of the record without its trend, which are those that are fitted.
   subroutine octaves_without_trend(job, valid, verdict, curve, error)
      !> The channel in work; the samples as read are taken
      type(job_type), intent(in) :: job
      !> 1 present, 0 missing: [n]; not associated where none is
      integer(int8), pointer, contiguous, intent(in) :: valid(:)
      !> With a trend; else nothing is done
      type(verdict_type), intent(in) :: verdict
      !> Of the record
      type(allan_curve_type), intent(inout) :: curve
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(allan_curve_type) :: level
      real(dp), allocatable :: rest(:)
      integer(int64) :: i, n
      integer :: stat

      if (verdict%trend%shape == "") return
      n = size(job%x, kind=int64)
      allocate (rest(n), stat=stat)
      call check_memory(stat, "the record without its trend", error)
      if (allocated(error)) return
      do i = 1, n
         rest(i) = job%x(i) - trend_values(verdict%trend, n, i)
      end do
      call compute_allan(rest, job%step, &
                         allan_options(min_coverage=job%options%allan%min_coverage), level, error, &
                         valid, job%progress)
      if (.not. allocated(error)) curve%octaves = level%octaves
   end subroutine octaves_without_trend

   !> Options of a fit in which no R is sought beside a trend.
   pure type(noise_options) function options_beside(options, verdict) result(beside)
      type(noise_options), intent(in) :: options
      type(verdict_type), intent(in) :: verdict

      beside = options
      if (verdict%trend%shape /= "") beside%term_penalty(term_ramp) = 1.0e9_dp
   end function options_beside

   !> The verdict. A failure is noted in the channel.
   subroutine judge(job, channel, error)
      !> The channel in work; the samples as read are judged
      type(job_type), intent(in) :: job
      !> Means examined, Allan curves fitted as far as they were asked for
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      type(noise_type) :: noise
      integer :: which

      if (.not. channel%verdict%known) then
         call add_text(channel%verdict%reasons, "too few samples to tell noise from drift")
         return
      end if
      which = merge(stage%outliers_removed, stage%input, &
                    channel%allan(stage%outliers_removed)%available)
      associate (asked => job%options%noise)
         if (channel%allan(which)%fitted .and. asked%terms == "auto" .and. asked%tau_min <= 0 &
             .and. asked%tau_max >= huge(1.0_dp)) then
            noise = channel%allan(which)%noise
         else
            call fit_for_verdict(job, channel, noise, error)
         end if
      end associate
      call note_failure(channel%unavailable, "verdict on drift", error, channel%verdict%known)
      if (.not. channel%verdict%known) return
      call decide(noise, real(size(job%x, kind=int64)/block_count, dp), channel%verdict)
      ! not where outliers hide B
      if (channel%verdict%drift == "flicker" .and. channel%allan(stage%input)%fitted) then
         associate (flicker => channel%allan(stage%input)%noise%coefficient(term_flicker))
            if (.not. flicker%detected) channel%verdict%drift = "none"
         end associate
      end if
      call give_reasons(job, channel%verdict)
   end subroutine judge

   !> The fit of all terms to all octaves, where the user wanted another one or none.
   subroutine fit_for_verdict(job, channel, noise, error)
      type(job_type), intent(in) :: job
      type(channel_result_type), intent(in) :: channel
      type(noise_type), intent(out) :: noise
      type(error_type), allocatable, intent(out) :: error
      type(allan_curve_type) :: curve

      call compute_allan(job%x, job%step, &
                         allan_options(min_coverage=job%options%allan%min_coverage), curve, error, &
                         job%valid, job%progress)
      if (.not. allocated(error)) call octaves_without_trend(job, job%valid, channel%verdict, &
                                                             curve, error)
      if (.not. allocated(error)) call fit_noise(curve, options_beside(noise_options(), &
                                                 channel%verdict), noise, error)
   end subroutine fit_for_verdict

   !> Steps 3 to 5.
   pure subroutine decide(noise, length, verdict)
      type(noise_type), intent(in) :: noise
      !> Samples of a block
      real(dp), intent(in) :: length
      type(verdict_type), intent(inout) :: verdict
      real(dp) :: walk_share
      logical :: trend, walk

      trend = verdict%trend%shape /= ""
      walk = noise%coefficient(term_walk)%detected
      verdict%complete = noise%described .and. noise%cut_off == 0
      verdict%walk_margin = noise%walk_margin
      verdict%drift_margin = noise%drift_margin
      if (verdict%complete .and. verdict%drift_margin > drift_margin) then
         walk_share = noise%squares(term_walk)*term_shape(term_walk, length)/ &
            model_variance(noise%squares, length)
         verdict%bounded = walk_share > 0.5_dp .and. verdict%adf%statistic < unit_root_limit .and. &
            .not. trend
         verdict%walks = .not. verdict%bounded
      end if
      if (trend) then
         verdict%drift = merge("trend_and_random_walk", "trend                ", &
            verdict%walks)
      else if (verdict%walks) then
         verdict%drift = merge("random_walk         ", "random_walk_or_trend", walk)
      else if (verdict%complete) then
         verdict%drift = "none"
         if (noise%coefficient(term_flicker)%detected) verdict%drift = "flicker"
         if (verdict%bounded) verdict%drift = "colored"
      else if (verdict%adf%statistic > unit_root_limit) then
         verdict%drift = "unit_root"
      else if (verdict%kpss%statistic < level_limit) then
         verdict%drift = "colored"
      else
         verdict%drift = "undescribed"
      end if
      verdict%stationary = any(verdict%drift == [character(7) :: "none", "flicker", "colored"])
      verdict%drifts = .not. (verdict%stationary .or. verdict%drift == "undescribed")
   end subroutine decide

   !> What the verdict rests on.
   subroutine give_reasons(job, verdict)
      type(job_type), intent(in) :: job
      type(verdict_type), intent(inout) :: verdict
      character(:), allocatable :: text

      allocate (verdict%reasons(0))
      if (verdict%trend%shape /= "") call add_trend(job, verdict)
      text = trim(merge("rejects        ", "does not reject", &
                        verdict%adf%statistic < unit_root_limit))
      text = "the ADF test of the means of 128 blocks gives "// &
         format_real(verdict%adf%statistic, 3)//" and "//text//" a unit root (limit "// &
         format_real(unit_root_limit, 3)//")"
      if (.not. verdict%complete) then
         call add_text(verdict%reasons, "no sum of Q, N, B, K and R follows the Allan curve to "// &
            "its longest averaging times")
         call add_text(verdict%reasons, text//"; KPSS "//format_real(verdict%kpss%statistic, 3)// &
                       " (limit of a constant level "//format_real(level_limit, 3)//")")
      else if (verdict%bounded) then
         call add_text(verdict%reasons, "the Allan curve rises like that of a random walk, but "// &
            "is bounded: "//text)
      else if (verdict%drift == "random_walk_or_trend") then
         call add_text(verdict%reasons, "the Allan curve needs K or R: a fit without both "// &
            "costs "//format_real(verdict%drift_margin, 3)//" of chi-square more")
      else if (verdict%walks) then
         call add_text(verdict%reasons, "the Allan curve needs K: a fit without it costs "// &
                       format_real(verdict%walk_margin, 3)//" of chi-square more")
      end if
   end subroutine give_reasons

   !> "a ramp of 72.1 +- 1.3 deg/h over the record raises 2 ln L by 45".
   subroutine add_trend(job, verdict)
      type(job_type), intent(in) :: job
      type(verdict_type), intent(inout) :: verdict
      character(:), allocatable :: text

      text = "a "//trim(verdict%trend%shape)//" of "//format_real(verdict%trend%size, 4)//" +- "// &
             format_real(verdict%trend%std_error, 2)
      if (allocated(job%unit%name)) text = trim(text//" "//job%unit%name)
      if (verdict%trend%shape == "ramp") then
         text = text//" over the record"
      else
         text = text//" with a time constant of "// &
            format_real(verdict%trend%time_constant*job%step, 3)// &
            trim(merge(" s      ", " samples", job%rate_known))
      end if
      call add_text(verdict%reasons, text//" raises 2 ln L by "// &
         format_real(verdict%trend%gain, 3)// &
         "; the coefficients are those of the noise beside it")
   end subroutine add_trend

end module gyroakf_pipeline_verdict
