! SPDX-License-Identifier: MIT
!> Tests of one channel: stationarity, normality, whiteness, quantization.
!>
!> All that is made of lagged products takes one pass: the Dickey-Fuller test reads the series, and
!> on the way the autocovariances are made that the Ljung-Box test and the AR model need. The
!> moments, one pass before, give the mean.
module gyroakf_pipeline_channel_tests
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text
   use gyroakf_io_decimal, only : format_real
   use gyroakf_stats_anderson_darling, only : test_anderson_darling, rounding_statistic
   use gyroakf_stats_autocovariance, only : autocovariance_type, compute_autocovariance, &
      need_autocovariance, plan_autocovariance
   use gyroakf_stats_correlation, only : correlation_of
   use gyroakf_stats_moments, only : moments_type
   use gyroakf_stats_normality, only : judge_normality, test_jarque_bera
   use gyroakf_stats_quantization, only : find_quantisation, coarse_ratio
   use gyroakf_stats_whiteness, only : ljung_box_of
   use gyroakf_series_adf, only : test_adf
   use gyroakf_series_kpss, only : test_kpss
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type
   use gyroakf_pipeline_warnings, only : note_failure
   implicit none (type, external)
   private
   public :: run_tests, run_distribution, find_step, plan_pass

   !> Autocovariances that are made in any case
   integer, parameter :: least_lags = 40
   !> Where rounding alone adds as much as this to A2, the Anderson-Darling test does not decide
   real(dp), parameter :: negligible_rounding = 0.1_dp

contains

   !> Plans the autocovariances that the stages need.
   pure subroutine plan_pass(n, options, moments, shared)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Of the series
      type(moments_type), intent(in) :: moments
      !> Planned
      type(autocovariance_type), intent(out) :: shared
      integer :: lags

      lags = least_lags
      if (options%do_tests) lags = max(lags, options%ljung_box_lags)
      if (options%do_ar .or. options%do_filter) lags = max(lags, options%ar%max_order, &
                                                           options%ar%order)
      call plan_autocovariance(shared, int(min(int(lags, int64), n - 1)), moments%mean, &
                               moments%remainder)
   end subroutine plan_pass

   !> Quantization of the record as read.
   subroutine find_step(x, channel, error, valid, progress)
      !> As read: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> `cleaned` is filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call report_progress("steps of the samples", 0_int64, 0_int64, error, progress)
      if (allocated(error)) return
      call find_quantisation(x, channel%cleaned%std, channel%quantisation, error, valid)
      channel%available%quantisation = .not. allocated(error)
      call note_failure(channel, "quantisation", error)
   end subroutine find_step

   !> All tests of a series.
   subroutine run_tests(z, moments, options, channel, shared, error, valid, progress)
      !> The series: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Of the series
      type(moments_type), intent(in) :: moments
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> The tests are filled, or their failures noted
      type(channel_result_type), intent(inout) :: channel
      !> Filled
      type(autocovariance_type), intent(out) :: shared
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: n

      n = size(z, kind=int64)
      call report_progress("testing", 0_int64, 3*n, error, progress)
      if (allocated(error)) return
      call plan_pass(n, options, moments, shared)
      call test_adf(z, options%adf, channel%adf, error, valid, shared, progress)
      channel%available%adf = .not. allocated(error)
      call note_failure(channel, "ADF test", error)
      if (allocated(error)) return
      call need_autocovariance(z, shared, error, valid)           ! where the test came to nothing
      if (allocated(error)) return
      call test_kpss(z, options%kpss, channel%kpss, error, valid, progress)
      channel%available%kpss = .not. allocated(error)
      call note_failure(channel, "KPSS test", error)
      if (allocated(error)) return
      call test_jarque_bera(moments, channel%jarque_bera, error)
      channel%available%jarque_bera = .not. allocated(error)
      call note_failure(channel, "Jarque-Bera test", error)
      if (.not. allocated(error)) call report_progress("testing", 2*n, 3*n, error, progress)
      if (allocated(error)) return
      call run_correlation(z, options, shared, channel, error, valid, progress)
      if (.not. allocated(error)) call run_distribution(z, options, channel, error, valid, progress)
   end subroutine run_tests

   !> Autocorrelation and Ljung-Box test, from the autocovariances that are there if they reach far
   !> enough.
   subroutine run_correlation(z, options, shared, channel, error, valid, progress)
      real(dp), intent(in), contiguous :: z(:)
      type(pipeline_options), intent(in) :: options
      type(autocovariance_type), intent(in) :: shared
      type(channel_result_type), intent(inout) :: channel
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      integer(int64) :: n
      real(dp) :: mean
      integer :: lags

      n = size(z, kind=int64)
      lags = int(min(int(options%ljung_box_lags, int64), max(1_int64, n/5)))
      if (options%correlation_lags > 0) lags = int(min(int(options%correlation_lags, int64), n - 1))
      if (lags <= ubound(shared%r, 1)) then
         r = shared%r(0:lags)
         if (present(valid)) pairs = shared%pairs(0:lags)
      else
         call compute_autocovariance(z, lags, mean, r, error, valid, pairs, progress)
         if (.not. present(valid) .and. allocated(pairs)) deallocate (pairs)
      end if
      if (.not. allocated(error)) then
         call ljung_box_of(r, n, 0, channel%ljung_box, error, pairs)
         channel%available%ljung_box = .not. allocated(error)
      end if
      if (.not. allocated(error)) call correlation_of(r, n, 0, channel%correlation, error, pairs)
      channel%available%correlation = .not. allocated(error)
      call note_failure(channel, "Ljung-Box test", error)
   end subroutine run_correlation

   !> Anderson-Darling test and verdict on normality.
   subroutine run_distribution(z, options, channel, error, valid, progress)
      !> The series that is tested: [n]
      real(dp), intent(in), contiguous :: z(:)
      !> Samples of the Anderson-Darling test
      type(pipeline_options), intent(in) :: options
      !> `quantisation` and `jarque_bera` are filled
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like; all else is noted in the channel
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing or an outlier: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress

      call warn_coarse(channel)
      call test_anderson_darling(z, options%anderson_darling, channel%anderson_darling, error, &
                                 valid, progress)
      channel%available%anderson_darling = .not. allocated(error)
      call note_failure(channel, "Anderson-Darling test", error)
      if (.not. allocated(error) .and. channel%available%jarque_bera) call judge(channel)
   end subroutine run_distribution

   !> The verdict on normality: by the Anderson-Darling test where all samples were tested and
   !> rounding is negligible, otherwise by Jarque-Bera.
   subroutine judge(channel)
      type(channel_result_type), intent(inout) :: channel
      real(dp) :: p_value, rounding

      associate (test => channel%anderson_darling, moments => channel%jarque_bera)
         p_value = moments%p_value
         rounding = rounding_statistic(channel%quantisation%ratio, test%samples)
         if (channel%available%anderson_darling .and. test%stride == 1 .and. &
             rounding < negligible_rounding) p_value = test%p_value
         channel%normality = judge_normality(moments%skewness, moments%kurtosis, p_value)
      end associate
   end subroutine judge

   !> The step is as large as what is measured.
   subroutine warn_coarse(channel)
      type(channel_result_type), intent(inout) :: channel
      character(:), allocatable :: share

      associate (grid => channel%quantisation)
         if (grid%ratio < coarse_ratio) return
         share = format_real(100.0_dp*grid%variance_share, 2)//" % of the variance are rounding"
         if (grid%variance_share >= 1.0_dp) share = "rounding hides the noise"
         call add_text(channel%warnings, "the step of the samples, "//format_real(grid%step, 4)// &
            ", is "//format_real(grid%ratio, 3)//" standard deviations of the cleaned series: "// &
            share//", and no test of normality means anything; a finer range of the converter "// &
            "would show the sensor's noise")
      end associate
   end subroutine warn_coarse

end module gyroakf_pipeline_channel_tests
