! SPDX-License-Identifier: MIT
!> Tests of one channel: stationarity, normality, whiteness, quantization, periodicity (Welch's
!> spectrum of the cleaned series, Fisher's test of its AR residuals).
!>
!> All that is made of lagged products takes one pass: the Dickey-Fuller test reads the series, and
!> on the way the autocovariances are made that the Ljung-Box test and the AR model need. The
!> moments, one pass before, give the mean.
module gyroakf_pipeline_channel_tests
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : report_progress
   use gyroakf_record, only : add_text
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text
   use gyroakf_ar_periodicity, only : periodicity_options, analyze_periodicity
   use gyroakf_stats_anderson_darling, only : test_anderson_darling, rounding_statistic
   use gyroakf_stats_autocovariance, only : autocovariance_type, compute_autocovariance, &
      need_autocovariance, plan_autocovariance
   use gyroakf_stats_correlation, only : correlation_of
   use gyroakf_stats_moments, only : moments_type
   use gyroakf_stats_normality, only : judge_normality, test_jarque_bera
   use gyroakf_stats_quantization, only : find_quantization, coarse_ratio
   use gyroakf_stats_welch, only : welch_options, welch_spectrum
   use gyroakf_stats_whiteness, only : ljung_box_of
   use gyroakf_series_adf, only : test_adf
   use gyroakf_series_kpss, only : test_kpss
   use gyroakf_pipeline_channel_job, only : job_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_tests, run_distribution, find_quantization_step, plan_pass
   public :: run_periodicity, longest_part, longest_segment

   !> Autocovariances that are made in any case
   integer, parameter :: least_lags = 40
   !> Where rounding alone adds as much as this to A2, the Anderson-Darling test does not decide
   real(dp), parameter :: negligible_rounding = 0.1_dp
   !> Fisher's test takes so many samples from the middle of a longer record
   integer(int64), parameter :: longest_part = 262144_int64
   !> A longer segment of the spectrum is refused: its memory is not that of the record
   integer(int64), parameter :: longest_segment = 1048576_int64

contains

   !> Plans the autocovariances that the stages need.
   pure subroutine plan_pass(job, moments, shared)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> Of the series
      type(moments_type), intent(in) :: moments
      !> Planned
      type(autocovariance_type), intent(out) :: shared
      integer :: lags

      associate (options => job%options)
         lags = least_lags
         if (options%do_tests) lags = max(lags, options%ljung_box_lags)
         if (options%do_ar .or. options%do_filter) lags = max(lags, options%ar%max_order, &
                                                              options%ar%order)
      end associate
      call plan_autocovariance(shared, int(min(int(lags, int64), size(job%x, kind=int64) - 1)), &
                               moments%mean, moments%remainder)
   end subroutine plan_pass

   !> Quantization of the record as read.
   subroutine find_quantization_step(job, channel, error)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> `cleaned` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error

      call report_progress("steps of the samples", 0_int64, 0_int64, error, job%progress)
      if (allocated(error)) return
      call find_quantization(job%x, channel%cleaned%std, channel%quantization, error, job%valid)
      call note_failure(channel%unavailable, "quantization", error, channel%available%quantization)
   end subroutine find_quantization_step

   !> All tests of a series.
   subroutine run_tests(z, moments, job, channel, shared, error)
      !> The series as read or cleaned, without outliers: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Of the series
      type(moments_type), intent(in) :: moments
      !> The channel in work
      type(job_type), intent(in) :: job
      !> The tests are filled, or their failures noted
      type(channel_result_type), intent(inout) :: channel
      !> Filled
      type(autocovariance_type), intent(out) :: shared
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: n

      n = size(z, kind=int64)
      call report_progress("testing", 0_int64, 3*n, error, job%progress)
      if (allocated(error)) return
      call plan_pass(job, moments, shared)
      call test_adf(z, job%options%adf, channel%adf, error, job%valid, shared, job%progress)
      call note_failure(channel%unavailable, "ADF test", error, channel%available%adf)
      if (allocated(error)) return
      call need_autocovariance(z, shared, error, job%valid)       ! where the test came to nothing
      if (allocated(error)) return
      call test_kpss(z, job%options%kpss, channel%kpss, error, job%valid, job%progress)
      call note_failure(channel%unavailable, "KPSS test", error, channel%available%kpss)
      if (allocated(error)) return
      call test_jarque_bera(moments, channel%jarque_bera, error)
      call note_failure(channel%unavailable, "Jarque-Bera test", error, &
         channel%available%jarque_bera)
      if (.not. allocated(error)) call report_progress("testing", 2*n, 3*n, error, job%progress)
      if (allocated(error)) return
      call run_correlation(z, job, shared, channel, error)
      if (.not. allocated(error)) call run_distribution(z, job, channel, error)
   end subroutine run_tests

   !> Autocorrelation and Ljung-Box test, from the autocovariances that are there if they reach far
   !> enough.
   subroutine run_correlation(z, job, shared, channel, error)
      real(dp), intent(in), contiguous :: z(:)
      type(job_type), intent(in) :: job
      type(autocovariance_type), intent(in) :: shared
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      integer(int64) :: n
      real(dp) :: mean
      integer :: lags

      n = size(z, kind=int64)
      associate (asked => job%options%correlation_lags)
         lags = int(min(int(job%options%ljung_box_lags, int64), max(1_int64, n/5)))
         if (asked > 0) lags = int(min(int(asked, int64), n - 1))
      end associate
      if (lags <= ubound(shared%r, 1)) then
         r = shared%r(0:lags)
         pairs = shared%pairs(0:lags)
      else
         call compute_autocovariance(z, lags, mean, r, error, job%valid, pairs, job%progress)
      end if
      if (.not. allocated(error)) then
         call ljung_box_of(r, n, 0, channel%ljung_box, error, pairs)
         channel%available%ljung_box = .not. allocated(error)
      end if
      if (.not. allocated(error)) call correlation_of(r, n, 0, channel%correlation, error, pairs)
      call note_failure(channel%unavailable, "Ljung-Box test", error, channel%available%correlation)
   end subroutine run_correlation

   !> Anderson-Darling test and verdict on normality.
   subroutine run_distribution(z, job, channel, error)
      !> The series that is tested: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> `quantization` and `jarque_bera` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error

      call warn_coarse(channel)
      call test_anderson_darling(z, job%options%anderson_darling, channel%anderson_darling, error, &
                                 job%valid, job%progress)
      call note_failure(channel%unavailable, "Anderson-Darling test", error, &
         channel%available%anderson_darling)
      if (.not. allocated(error) .and. channel%available%jarque_bera) call judge(channel)
   end subroutine run_distribution

   !> The verdict on normality: by the Anderson-Darling test where all samples were tested and
   !> rounding is negligible, otherwise by Jarque-Bera.
   subroutine judge(channel)
      type(channel_result_type), intent(inout) :: channel
      real(dp) :: p_value, rounding

      associate (test => channel%anderson_darling, moments => channel%jarque_bera)
         p_value = moments%p_value
         rounding = rounding_statistic(channel%quantization%ratio, test%samples)
         if (channel%available%anderson_darling .and. test%stride == 1 .and. &
             rounding < negligible_rounding) p_value = test%p_value
         channel%normality = judge_normality(moments%skewness, moments%kurtosis, p_value)
      end associate
   end subroutine judge

   !> The step is as large as what is measured.
   subroutine warn_coarse(channel)
      type(channel_result_type), intent(inout) :: channel
      character(:), allocatable :: share

      associate (grid => channel%quantization)
         if (grid%ratio < coarse_ratio) return
         share = format_real(100.0_dp*grid%variance_share, 2)//" % of the variance are rounding"
         if (grid%variance_share >= 1.0_dp) share = "rounding hides the noise"
         call add_text(channel%warnings, "the step of the samples, "//format_real(grid%step, 4)// &
            ", is "//format_real(grid%ratio, 3)//" standard deviations of the cleaned series: "// &
            share//", and no test of normality means anything; a finer range of the converter "// &
            "would show the sensor's noise")
      end associate
   end subroutine warn_coarse

   !> Spectrum and Fisher's test; failures are noted in the channel.
   subroutine run_periodicity(job, channel, error)
      !> The channel in work
      type(job_type), intent(in) :: job
      !> Its AR model is used where it is there; `spectrum` and `periodicity` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled, invalid_argument; everything else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      type(welch_options) :: welch
      type(periodicity_options) :: choice

      channel%frequency_unit = merge("Hz           ", "cycles/sample", job%rate_known)
      welch%confidence = job%options%allan%confidence
      if (job%options%welch_segment > 0.0_dp) welch%segment = &
         max(2_int64, nint(min(job%options%welch_segment/job%step, 1.0e15_dp), int64))
      if (welch%segment > longest_segment) then
         call fatal_error(error, status%invalid_argument, "a segment of the spectrum may have "// &
            integer_text(longest_segment)//" samples here, not "//integer_text(welch%segment)// &
            "; use the Allan deviation for slower processes")
         return
      end if
      call welch_spectrum(job%z, job%step, welch, channel%spectrum, error, job%valid, job%progress)
      call note_failure(channel%unavailable, "spectrum", error, channel%available%spectrum)
      if (allocated(error)) return
      choice%longest = longest_part
      choice%ar = job%options%ar
      if (channel%available%ar) then
         call analyze_periodicity(job%z, choice, channel%periodicity, error, job%valid, &
                                  channel%ar, job%progress)
      else
         call analyze_periodicity(job%z, choice, channel%periodicity, error, job%valid, &
                                  progress=job%progress)
      end if
      call note_failure(channel%unavailable, "Fisher's test", error, channel%available%periodicity)
      if (.not. channel%available%periodicity) return
      associate (found => channel%periodicity)
         channel%fisher_frequency = found%fisher%frequency/job%step
         if (found%order > 0) channel%whitened = "the residuals of AR("// &
            integer_text(int(found%order, int64))//")"
      end associate
   end subroutine run_periodicity

end module gyroakf_pipeline_channel_tests
