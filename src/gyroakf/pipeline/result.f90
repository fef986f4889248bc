! SPDX-License-Identifier: MIT
!> What the main job is asked for and what it returns.
!>
!> Every number that a report prints is in these types: reports compute nothing. A stage without a
!> result for a channel (constant series, too few samples) has its flag in `available` false and a
!> line in `unavailable`.
module gyroakf_pipeline_result
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_record, only : text_type
   use gyroakf_preprocess_clean, only : clean_options, clean_type
   use gyroakf_stats_moments, only : moments_type
   use gyroakf_series_adf, only : adf_options, adf_type
   use gyroakf_stats_normality, only : jarque_bera_type
   use gyroakf_stats_anderson_darling, only : anderson_darling_options, anderson_darling_type
   use gyroakf_stats_quantization, only : quantization_type
   use gyroakf_stats_whiteness, only : ljung_box_type
   use gyroakf_stats_correlation, only : correlation_type
   use gyroakf_series_kpss, only : kpss_options, kpss_type
   use gyroakf_ar_periodicity, only : periodicity_type
   use gyroakf_stats_welch, only : welch_type
   use gyroakf_ar_model, only : ar_options, ar_model_type
   use gyroakf_filter_design, only : design_options, drift_options
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_filter_kalman, only : filter_type
   use gyroakf_filter_drift_identification, only : drift_identification_type
   use gyroakf_allan_deviations, only : allan_options
   use gyroakf_allan_noise_fit, only : noise_options
   use gyroakf_allan_halves, only : halves_type
   use gyroakf_allan_trend_test, only : record_trend_type
   use gyroakf_pipeline_allan_result, only : allan_result_type, not_described, stage, stage_names, &
      stated_coefficient_type, stated_noise_type, stated_read_off_type
   implicit none (type, external)
   private
   public :: new_channels, pipeline_options, pipeline_result_type, channel_result_type, &
      available_type
   public :: allan_result_type, stated_noise_type, stated_coefficient_type, stated_read_off_type
   public :: filter_figures_type, drift_process_type, verdict_type, stage, stage_names, &
      not_described

   !> What the main job does and how
   type :: pipeline_options
      !> "default", or "paper" once [[gyroakf_pipeline:apply_preset]] has set the paper's chain
      character(8) :: preset = "default"
      !> Stages that a single command switches off
      logical :: do_tests = .true., do_ar = .true., do_filter = .true., do_allan = .true.
      !> Trend and outliers; degree -1 and method "none" take the record as it is, without a copy
      type(clean_options) :: clean
      !> The tests take the series without its trend: their critical values do not hold then
      logical :: test_cleaned = .false.
      !> Augmented Dickey-Fuller test
      type(adf_options) :: adf
      !> Order and coefficients of the AR model
      type(ar_options) :: ar
      !> The paper's filters
      type(design_options) :: design
      !> The adaptive filter of the identified drift, also that of the smoother
      type(drift_options) :: drift
      !> Allan curves; the kind that is fitted is oadev
      type(allan_options) :: allan
      !> Further kinds for the series as read and cleaned, separated by commas: "mdev,ohdev"
      character(:), allocatable :: other_kinds
      !> Coefficients from the curves
      type(noise_options) :: noise
      !> Anderson-Darling test: longer ones are thinned
      type(anderson_darling_options) :: anderson_darling = anderson_darling_options(200000_int64)
      !> Lags of the Ljung-Box test
      integer :: ljung_box_lags = 20
      !> Lags of the autocorrelation and of the Ljung-Box test where they are asked for; 0:
      !> ljung_box_lags, a fifth of the samples at most
      integer :: correlation_lags = 0
      !> The KPSS test
      type(kpss_options) :: kpss
      !> What counts as drift, in s: slower than this; 0 is the larger of 5 samples and 1 s
      real(dp) :: drift_tau = 0.0_dp
      !> Segment of Welch's spectrum in s (samples without a rate); 0: chosen
      real(dp) :: welch_segment = 0.0_dp
      !> The cleaned and filtered series stay in the result (8 bytes a sample and series)
      logical :: keep_series = .false.
      !> "kf", "akf", "drift_kf" or "drift_akf": no more is done than it takes to make this filter,
      !> which stays in the result before its first step, `channel%designed`, and what cannot be
      !> done is an error; "": all filters
      character(9) :: design_only = ""
   end type pipeline_options

   !> Which parts of a channel's result are there
   type :: available_type
      !> The cleaning was done; outliers or a trend were removed
      logical :: preprocess = .false., cleaned = .false.
      logical :: adf = .false., jarque_bera = .false., ljung_box = .false., ar = .false.
      logical :: kf = .false., akf = .false.
      logical :: drift = .false., drift_kf = .false., drift_akf = .false.
      !> The smoothed drift, and with it what is left of the record without it
      logical :: drift_smoother = .false.
      logical :: halves = .false.
      logical :: anderson_darling = .false., quantization = .false.
      logical :: kpss = .false., correlation = .false.
      logical :: periodicity = .false., spectrum = .false.
   end type available_type

   !> One process of the drift model as it is stated
   type :: drift_process_type
      !> A random walk; else an AR(1) process
      logical :: walk = .false.
      !> It counts as drift
      logical :: slow = .false.
      !> Coefficient, correlation time in s (samples without a rate) and its standard error; 1 and 0
      !> for a random walk
      real(dp) :: phi = 0.0_dp, time = 0.0_dp, time_error = 0.0_dp
      !> Standard deviation in the unit of the record: of the process; of a random walk that of a
      !> step, with its standard error
      real(dp) :: std = 0.0_dp, std_error = 0.0_dp
      !> A random walk as the coefficient K of Table III, in its unit; `detected` where it is stated
      type(stated_coefficient_type) :: k
   end type drift_process_type

   !> What a filter did to the variance
   type :: filter_figures_type
      !> Variance of the output over that of the filter's input: of the cleaned series; of the
      !> drift's filters, of the record as read without outliers
      real(dp) :: variance_ratio = 0.0_dp
      !> Share of a constant rotation, in percent, that passes, and that is lost
      real(dp) :: passed_percent = 0.0_dp, lost_percent = 0.0_dp
      !> Root mean square error against the true drift, in the unit of the record, and the number of
      !> samples it is taken over; 0: the true drift is not known
      real(dp) :: rmse = 0.0_dp
      integer(int64) :: rmse_samples = 0
   end type filter_figures_type

   !> Whether a channel drifts
   type :: verdict_type
      !> It was looked for, and there is one: the record is long enough
      logical :: wanted = .false., known = .false.
      !> The noise is stationary; it drifts. Neither: nothing is known
      logical :: stationary = .false., drifts = .false.
      !> It drifts by a random walk, or may do so: K is stated
      logical :: walks = .false.
      !> "none", "flicker", "colored"; "random_walk", "trend", "trend_and_random_walk",
      !> "random_walk_or_trend", "unit_root"; or "undescribed"
      character(21) :: drift = "undescribed"
      !> A ramp or a warm-up, in the unit of the record and samples
      type(record_trend_type) :: trend
      !> Tests of the means of 128 blocks without the trend; the first value is that of a unit root
      type(adf_type) :: adf
      type(kpss_type) :: kpss
      !> K is more than half of the Allan variance at the length of a block, where the unit root is
      !> rejected
      logical :: bounded = .false.
      !> All octaves to the longest are described by the fit, and what one without K, and without K
      !> and R, costs more
      logical :: complete = .false.
      real(dp) :: walk_margin = 0.0_dp, drift_margin = 0.0_dp
      !> What the verdict rests on, in sentences
      type(text_type), allocatable :: reasons(:)
   end type verdict_type

   !> One channel
   type :: channel_result_type
      character(:), allocatable :: name
      !> Which parts below are filled
      type(available_type) :: available
      !> What the report says of drift and stationarity
      type(verdict_type) :: verdict
      !> Of the record as read, of that without its outliers, and of the cleaned series
      type(moments_type) :: raw, level, cleaned
      !> What was tested: the record with its trend and without its outliers; with `test_cleaned`
      !> the cleaned series
      character(27) :: tested = "record as read"
      type(clean_type) :: clean
      type(adf_type) :: adf
      type(jarque_bera_type) :: jarque_bera
      type(ljung_box_type) :: ljung_box
      !> Normality of the series that was tested
      type(anderson_darling_type) :: anderson_darling
      !> Verdict of [[judge_normality]] by the Anderson-Darling test of all samples; by Jarque-Bera
      !> where the series was thinned or rounding alone adds 0.1 or more to A2; "": not tested
      character(9) :: normality = ""
      !> The grid of the record as read, compared with the standard deviation of the cleaned series
      type(quantization_type) :: quantization
      type(kpss_type) :: kpss
      !> Autocorrelation of the series that was tested
      type(correlation_type) :: correlation
      !> Fisher's test, of a part of a long record
      type(periodicity_type) :: periodicity
      !> What was whitened: "the residuals of AR(2)"; the unit of all frequencies: Hz or
      !> cycles/sample
      character(40) :: whitened = "the series"
      character(13) :: frequency_unit = "Hz"
      !> Frequency of Fisher's test in that unit
      real(dp) :: fisher_frequency = 0.0_dp
      !> Welch's spectrum of the cleaned series
      type(welch_type) :: spectrum
      !> The model that was chosen
      type(ar_model_type) :: ar
      !> The model that the paper's filters take: the same, or Yule-Walker's of the same order where
      !> that is not stationary
      type(ar_model_type) :: filter_ar
      !> Largest share of the variance, in percent, that one-step prediction by the AR model
      !> removes: 100 (1 - sigma_a^2/var)
      real(dp) :: predictable_percent = 0.0_dp
      !> The paper's filters
      type(filter_result_type) :: kf, akf
      type(filter_figures_type) :: kf_figures, akf_figures
      !> Drift identified from the record without its outliers, its processes as stated, and its
      !> filters; their outputs and means hold the level
      type(drift_identification_type) :: drift
      type(drift_process_type), allocatable :: drift_process(:)
      !> Why no drift model describes the record; unallocated where the identified one does
      character(:), allocatable :: drift_doubt
      !> Standard error of the white noise's standard deviation, 0 where it is not known
      real(dp) :: white_std_error = 0.0_dp
      !> Correlation time of the drift, and the shortest that counts as drift, both in s (samples
      !> without a rate)
      real(dp) :: drift_time = 0.0_dp, drift_tau = 0.0_dp
      type(filter_result_type) :: drift_kf, drift_akf, drift_smoother
      type(filter_figures_type) :: drift_kf_figures, drift_akf_figures, drift_smoother_figures
      !> The filter of `design_only`, for samples less this mean; unallocated where the channel has
      !> no drift
      class(filter_type), allocatable :: designed
      real(dp) :: designed_mean = 0.0_dp
      !> The record as read, without its outliers, less the smoothed drift: in-sample, for the drift
      !> was taken from it
      type(moments_type) :: compensated
      real(dp) :: compensated_ratio = 0.0_dp
      !> By [[gyroakf_pipeline_allan_result:stage]]
      type(allan_result_type), allocatable :: allan(:)
      !> Whether the curve of the record as read changed from its first to its second half
      type(halves_type) :: halves
      !> From cleaned to akf, Q N B K R, in percent; only where `reduction_known` (detected in both)
      real(dp) :: reduction_percent(5) = 0.0_dp
      logical :: reduction_known(5) = .false.
      !> Detected before, not after: at least this reduction, in percent (from the upper limit); 0
      !> elsewhere
      real(dp) :: reduction_at_least(5) = 0.0_dp
      !> With keep_series: [n]; 0 where missing
      real(dp), allocatable :: series_cleaned(:), series_kf(:), series_akf(:)
      !> The same of the drift: smoothed, what is left without it, filtered; they hold the level
      real(dp), allocatable :: series_drift(:), series_compensated(:)
      real(dp), allocatable :: series_drift_kf(:), series_drift_akf(:)
      !> Allocated with keep_series where something is missing (in the file, or an outlier): [n]
      !> 1 present 0 missing
      integer(int8), allocatable :: series_present(:)
      !> Warnings, and which stages failed and why
      type(text_type), allocatable :: warnings(:), unavailable(:)
   end type channel_result_type

   !> The whole record
   type :: pipeline_result_type
      !> s; samples where no rate is known
      real(dp) :: duration = 0.0_dp
      type(channel_result_type), allocatable :: channel(:)
   end type pipeline_result_type

contains

   !> Channels of which nothing is known yet. Here, for the compiler makes a copy of one on the
   !> stack.
   subroutine new_channels(result, channels, stat)
      !> Its channels are allocated
      type(pipeline_result_type), intent(inout) :: result
      !> How many, >= 0
      integer, intent(in) :: channels
      !> Not 0 where there is no memory
      integer, intent(out) :: stat
      integer :: i

      allocate (result%channel(channels), stat=stat)
      if (stat /= 0) return
      do i = 1, channels
         allocate (result%channel(i)%allan(size(stage_names)), stat=stat)
         if (stat /= 0) return
      end do
   end subroutine new_channels

end module gyroakf_pipeline_result
