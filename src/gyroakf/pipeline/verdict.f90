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
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_io_decimal, only : format_real
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_allan_noise_fit, only : coefficient_type, fit_noise, noise_options, noise_type
   use gyroakf_allan_noise_model, only : model_variance, term_flicker, term_ramp, term_shape, &
      term_walk
   use gyroakf_allan_trend_test, only : block_count, block_means, find_trend, trend_means, &
      trend_test_options, trend_values
   use gyroakf_series_adf, only : adf_options, test_adf
   use gyroakf_series_kpss, only : kpss_options, test_kpss
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, stage, &
      stated_coefficient_type, verdict_type
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
   subroutine examine_means(x, channel, error, valid)
      !> The record as read: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> `verdict%trend`, `adf` and `kpss` are filled; `verdict%known` where the record is long
      !> enough
      type(channel_result_type), intent(inout) :: channel
      !> no_memory and the like
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: mean(block_count)
      integer(int64) :: n

      n = size(x, kind=int64)
      associate (verdict => channel%verdict)
         verdict%wanted = .true.
         call block_means(x, mean, verdict%known, valid)
         if (.not. verdict%known) return
         call find_trend(mean, n, trend_test_options(), verdict%trend, error)
         if (allocated(error)) return
         mean = mean - trend_means(verdict%trend, n)
         call test_adf(mean, adf_options(criterion="bic"), verdict%adf, error)
         if (.not. allocated(error)) call test_kpss(mean, kpss_options(), verdict%kpss, error)
         verdict%known = .not. allocated(error)
         call note_failure(channel, "verdict on drift", error)
      end associate
   end subroutine examine_means

   !> Gives a curve the octaves of the record without its trend, which are those that are fitted.
   subroutine octaves_without_trend(x, options, verdict, curve, error, valid, progress)
      !> The record: [n]
      real(dp), intent(in), contiguous :: x(:)
      type(pipeline_options), intent(in) :: options
      !> With a trend; else nothing is done
      type(verdict_type), intent(in) :: verdict
      !> Of the record
      type(allan_curve_type), intent(inout) :: curve
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(allan_curve_type) :: level
      real(dp), allocatable :: rest(:)
      integer(int64) :: i, n
      integer :: failed

      if (verdict%trend%shape == "") return
      n = size(x, kind=int64)
      allocate (rest(n), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the record without its trend")
         return
      end if
      do i = 1, n
         rest(i) = x(i) - trend_values(verdict%trend, n, i)
      end do
      call compute_allan(rest, curve%sample_interval, &
                         allan_options(min_coverage=options%allan%min_coverage), level, error, &
                         valid, progress)
      if (.not. allocated(error)) curve%octaves = level%octaves
   end subroutine octaves_without_trend

   !> Options of a fit in which no R is sought beside a trend.
   pure type(noise_options) function options_beside(options, verdict) result(beside)
      type(noise_options), intent(in) :: options
      type(verdict_type), intent(in) :: verdict

      beside = options
      if (verdict%trend%shape /= "") beside%term_price(term_ramp) = 1.0e9_dp
   end function options_beside

   !> The verdict, and what of the coefficients it withholds. A failure is noted in the channel.
   subroutine judge(x, record, options, channel, error, valid, progress)
      !> The record as read: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Sample interval and unit
      type(record_type), intent(in) :: record
      type(pipeline_options), intent(in) :: options
      !> Means examined, Allan curves fitted as far as they were asked for
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(noise_type) :: noise
      integer :: which

      if (.not. channel%verdict%known) then
         call add_text(channel%verdict%reasons, "too few samples to tell noise from drift")
         return
      end if
      which = merge(stage%outliers_removed, stage%input, &
                    channel%allan(stage%outliers_removed)%available)
      if (channel%allan(which)%fitted .and. options%noise%terms == "auto" .and. &
          options%noise%tau_min <= 0 .and. options%noise%tau_max >= huge(1.0_dp)) then
         noise = channel%allan(which)%noise
      else
         call fit_for_verdict(x, record%sample_interval, options, channel, noise, error, valid, &
                              progress)
      end if
      channel%verdict%known = .not. allocated(error)
      call note_failure(channel, "verdict on drift", error)
      if (.not. channel%verdict%known) return
      call decide(noise, real(size(x, kind=int64)/block_count, dp), channel%verdict)
      ! not where outliers hide B
      if (channel%verdict%drift == "flicker" .and. channel%allan(stage%input)%fitted) then
         associate (flicker => channel%allan(stage%input)%noise%coefficient(term_flicker))
            if (.not. flicker%detected) channel%verdict%drift = "none"
         end associate
      end if
      call give_reasons(record, channel%verdict)
      call withhold(channel)
   end subroutine judge

   !> The fit of all terms to all octaves, where the user wanted another one or none.
   subroutine fit_for_verdict(x, step, options, channel, noise, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: step
      type(pipeline_options), intent(in) :: options
      type(channel_result_type), intent(in) :: channel
      type(noise_type), intent(out) :: noise
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      type(allan_curve_type) :: curve

      call compute_allan(x, step, allan_options(min_coverage=options%allan%min_coverage), curve, &
                         error, valid, progress)
      if (allocated(error)) return
      call octaves_without_trend(x, options, channel%verdict, curve, error, valid, progress)
      if (allocated(error)) return
      call fit_noise(curve, options_beside(noise_options(), channel%verdict), noise, error)
   end subroutine fit_for_verdict

   !> Steps 3 to 5.
   pure subroutine decide(noise, length, verdict)
      type(noise_type), intent(in) :: noise
      !> Samples of a block
      real(dp), intent(in) :: length
      type(verdict_type), intent(inout) :: verdict
      real(dp) :: walk_share
      logical :: trend, walk, more

      trend = verdict%trend%shape /= ""
      walk = noise%coefficient(term_walk)%detected
      verdict%complete = noise%described .and. noise%cut_off == 0
      verdict%walk_margin = noise%walk_margin
      verdict%drift_margin = noise%drift_margin
      more = .false.
      if (verdict%complete .and. verdict%drift_margin > drift_margin) then
         walk_share = noise%squares(term_walk)*term_shape(term_walk, length)/ &
            model_variance(noise%squares, length)
         verdict%bounded = walk_share > 0.5_dp .and. verdict%adf%statistic < unit_root_limit .and. &
            .not. trend
         more = .not. verdict%bounded
      end if
      if (trend) then
         verdict%drift = merge("trend_and_random_walk", "trend                ", more)
      else if (more) then
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
   subroutine give_reasons(record, verdict)
      !> For the units
      type(record_type), intent(in) :: record
      type(verdict_type), intent(inout) :: verdict
      character(:), allocatable :: text

      allocate (verdict%reasons(0))
      if (verdict%trend%shape /= "") call add_trend(record, verdict)
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
      else if (index(verdict%drift, "_or_") > 0) then
         call add_text(verdict%reasons, "the Allan curve needs K or R: a fit without both "// &
            "costs "//format_real(verdict%drift_margin, 3)//" of chi-square more")
      else if (index(verdict%drift, "random_walk") > 0) then
         call add_text(verdict%reasons, "the Allan curve needs K: a fit without it costs "// &
                       format_real(verdict%walk_margin, 3)//" of chi-square more")
      end if
   end subroutine give_reasons

   !> "a ramp of 72.1 +- 1.3 deg/h over the record raises 2 ln L by 45".
   subroutine add_trend(record, verdict)
      type(record_type), intent(in) :: record
      type(verdict_type), intent(inout) :: verdict
      character(:), allocatable :: text

      text = "a "//trim(verdict%trend%shape)//" of "//format_real(verdict%trend%size, 4)//" +- "// &
             format_real(verdict%trend%std_error, 2)
      if (allocated(record%unit%name)) text = trim(text//" "//record%unit%name)
      if (verdict%trend%shape == "ramp") then
         text = text//" over the record"
      else
         text = text//" with a time constant of "// &
            format_real(verdict%trend%time_constant*record%sample_interval, 3)// &
            trim(merge(" s      ", " samples", record%rate_known))
      end if
      call add_text(verdict%reasons, text//" raises 2 ln L by "// &
         format_real(verdict%trend%gain, 3)// &
         "; the coefficients are those of the noise beside it")
   end subroutine add_trend

   !> No coefficient of the record as read says what the verdict excludes: K without a random walk,
   !> R beside a trend or none.
   pure subroutine withhold(channel)
      type(channel_result_type), intent(inout) :: channel

      integer :: which

      do which = stage%input, merge(stage%cleaned, stage%outliers_removed, &
                                    channel%clean%trend%degree < 0)
         associate (verdict => channel%verdict, allan => channel%allan(which))
            if (.not. allan%fitted) cycle
            if (index(verdict%drift, "random_walk") == 0 .and. &
                allan%noise%coefficient(term_walk)%detected) then
               call withhold_one(allan%noise%coefficient(term_walk), allan%stated%term(term_walk))
            end if
            if (verdict%trend%shape /= "" .or. (verdict%drift /= "random_walk_or_trend" .and. &
                                                allan%noise%coefficient(term_ramp)%detected)) then
               call withhold_one(allan%noise%coefficient(term_ramp), allan%stated%term(term_ramp))
            end if
         end associate
      end do
   end subroutine withhold

   !> A coefficient that is not stated.
   pure subroutine withhold_one(coefficient, stated)
      type(coefficient_type), intent(inout) :: coefficient
      type(stated_coefficient_type), intent(inout) :: stated

      coefficient = coefficient_type(state="withheld")
      stated%value = 0
      stated%std_error = 0
      stated%upper_limit = 0
      stated%value_si = 0
      stated%std_error_si = 0
      stated%upper_limit_si = 0
      stated%detected = .false.
      stated%fitted = .false.
      stated%state = "withheld"
   end subroutine withhold_one

end module gyroakf_pipeline_verdict
