! SPDX-License-Identifier: MIT
!> A record and a result with made-up numbers, so that the reports are tested without any room behind them.
module report_fixture
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, add_text
   use gyroakf_units, only : parse_unit
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_writer, only : writer_type, open_writer, commit_writer
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_allan_read_off, only : read_off_type
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type, channel_result_type, stage, verdict_type
   use gyroakf_pipeline_coefficients, only : state_noise, state_read_off, compare_coefficients
   use json_reader, only : file_text
   implicit none (type, external)
   private
   public :: make_record, make_result, fill_drift, begin_text, end_text

   !> Written and removed by each test
   character(*), parameter, public :: scratch = "test_report_scratch.tmp"

contains

   !> A writer into the scratch file.
   subroutine begin_text(writer)
      type(writer_type), intent(out) :: writer
      type(gyro_error), allocatable :: failed

      call open_writer(writer, scratch, failed)
   end subroutine begin_text

   !> What was written.
   subroutine end_text(writer, text)
      type(writer_type), intent(inout) :: writer
      character(:), allocatable, intent(out) :: text
      type(gyro_error), allocatable :: failed
      integer :: unit

      call commit_writer(writer, failed)
      text = file_text(scratch)
      open (newunit=unit, file=scratch)
      close (unit, status="delete")
   end subroutine end_text

   !> 12 samples, one channel at 5 Hz in deg/s; or nothing known.
   subroutine make_record(record, known)
      type(record_type), intent(out) :: record
      logical, intent(in) :: known
      type(gyro_error), allocatable :: failed
      integer :: i

      record%path = "data/gyro.txt"
      record%format = "text"
      allocate (record%value(12, 1), record%channel(1))
      record%value(:, 1) = [(0.25_dp*real(i, dp), i=1, 12)]
      record%channel(1)%text = "gx"
      record%rate_source = "none"
      record%unit_source = "none"
      record%audit%samples = 12
      allocate (record%audit%minimum(1), record%audit%maximum(1), record%audit%quantization(1))
      record%audit%minimum = 0.25_dp
      record%audit%maximum = 3.0_dp
      record%audit%quantization = 0.25_dp
      if (.not. known) return
      record%sample_interval = 0.2_dp
      record%rate_known = .true.
      record%rate_source = "header"
      record%unit_source = "option"
      call parse_unit("deg/s", record%unit, failed)
      call add_text(record%warnings, "the stamps show 5.2 Hz, the option says 5 Hz")
   end subroutine make_record

   !> One channel, everything available but the drift filters.
   subroutine make_result(record, result)
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(out) :: result
      type(read_off_type) :: read
      integer :: which

      read%found(2) = .true.
      read%value(2) = 0.016_dp
      read%minimum = 0.005_dp
      read%minimum_tau = 100
      result%duration = 12*record%sample_interval
      allocate (result%channel(1))
      allocate (result%channel(1)%allan(6))
      associate (channel => result%channel(1))
         channel%name = "gx"
         call fill_series(channel)
         call fill_model(channel)
         call fill_filter(channel%kf, 0.2845_dp*5.24e-4_dp, 0.6072_dp)
         call fill_filter(channel%akf, 2.0e-5_dp, 0.21_dp)
         call add_text(channel%akf%estimate, "Q")
         call add_text(channel%akf%estimate, "R")
         channel%akf%clamped = 7
         channel%kf_figures%variance_ratio = 0.2845_dp
         channel%kf_figures%passed_percent = 60.72_dp
         channel%akf_figures%variance_ratio = 0.038_dp
         channel%akf_figures%passed_percent = 21.0_dp
         do which = stage%input, stage%akf
            if (which == stage%outliers_removed) cycle
            call fill_allan(channel, which)
            call state_noise(channel%allan(which)%noise, record%rate_known, record%unit, channel%allan(which)%stated)
            call state_read_off(read, record%rate_known, record%unit, channel%allan(which)%read_off)
         end do
         channel%verdict = verdict_type(wanted=.true., known=.true., stationary=.true., drift="flicker")
         call add_text(channel%verdict%reasons, "a reason")
         call fill_periodicity(channel)
         call fill_halves(channel)
         call compare_coefficients(channel)
         call add_text(channel%warnings, "2.5 % of the samples (3) were removed as outliers, at 0.2, 0.4 s")
         call add_text(channel%unavailable, "drift identification: too few samples")
      end associate
   end subroutine make_result

   !> A drift: a random walk, and an AR(1) process that is too fast; filters, smoother, what is left.
   subroutine fill_drift(record, channel)
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(inout) :: channel

      if (allocated(channel%unavailable)) deallocate (channel%unavailable)
      channel%available%drift = .true.
      channel%available%drift_kf = .true.
      channel%available%drift_akf = .true.
      channel%available%drift_smoother = .true.
      channel%level%mean = 0.0043_dp
      channel%level%variance = 5.5e-4_dp
      channel%drift_tau = 1.0_dp
      associate (drift => channel%drift)
         drift%found = .true.
         drift%name = "walk+ar1"
         drift%model%count = 2
         drift%model%phi(:2) = [0.41_dp, 1.0_dp]
         drift%model%q(:2) = [4.0e-4_dp, 1.0e-10_dp]
         drift%model%r = 2.5e-5_dp
         drift%slow(2) = .true.
         drift%std_error = drift%model
         drift%errors_known = .true.
         drift%white_std = 0.005_dp
         drift%drift_std = 1.0e-5_dp
         drift%samples = 12
         drift%of_samples = 12
         drift%chosen = 2
         allocate (drift%candidate(2))
         drift%candidate%name = [character(8) :: "walk", "walk+ar1"]
         drift%candidate%aic = [-56951.82_dp, -58726.91_dp]
         drift%candidate%bic = [-56937.04_dp, -58697.34_dp]
         drift%candidate(2)%model = drift%model
         drift%log_likelihood = 29363.5_dp
      end associate
      channel%white_std_error = 0.0021_dp
      allocate (channel%drift_process(2))
      channel%drift_process%walk = [.false., .true.]
      channel%drift_process%slow = [.false., .true.]
      channel%drift_process%phi = [0.41_dp, 1.0_dp]
      channel%drift_process(1)%time = 0.2243_dp
      channel%drift_process(1)%time_error = 0.012_dp
      channel%drift_process%std = [0.0219_dp, 1.0e-5_dp]
      channel%drift_process(2)%k = channel%allan(stage%input)%stated%term(4)
      channel%drift_process(2)%k%value = 4.83_dp
      channel%drift_process(2)%k%detected = .true.
      channel%verdict%stationary = .false.
      channel%verdict%drift = "random_walk"
      channel%drift_process(2)%k%std_error = 1.2_dp
      call fill_filter(channel%drift_kf, 1.0e-5_dp, 1.0_dp)
      call fill_filter(channel%drift_akf, 1.1e-5_dp, 1.0_dp)
      call add_text(channel%drift_akf%estimate, "R")
      call fill_filter(channel%drift_smoother, 1.2e-5_dp, 1.0_dp)
      channel%drift_smoother%nis_high = 0
      channel%drift_kf_figures%variance_ratio = 0.018_dp
      channel%drift_kf_figures%passed_percent = 100.0_dp
      channel%drift_smoother_figures = channel%drift_kf_figures
      channel%compensated%mean = 1.0e-6_dp
      channel%compensated%variance = 5.38e-4_dp
      channel%compensated_ratio = 0.978_dp
      call fill_allan(channel, stage%compensated)
      call state_noise(channel%allan(stage%compensated)%noise, record%rate_known, record%unit, &
                       channel%allan(stage%compensated)%stated)
   end subroutine fill_drift

   !> Fisher's test and a spectrum of three frequencies.
   subroutine fill_periodicity(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%available%periodicity = .true.
      channel%available%spectrum = .true.
      channel%frequency_unit = "Hz"
      channel%whitened = "the residuals of AR(1)"
      channel%fisher_frequency = 1.25_dp
      channel%periodicity%fisher%statistic = 0.3_dp
      channel%periodicity%fisher%p_value = 0.004_dp
      channel%spectrum%frequency = [0.0_dp, 1.25_dp, 2.5_dp]
      channel%spectrum%density = [1.0e-5_dp, 2.0e-5_dp, 3.0e-5_dp]
      channel%spectrum%lower = 0.8_dp*channel%spectrum%density
      channel%spectrum%upper = 1.3_dp*channel%spectrum%density
      channel%spectrum%one_sided = channel%spectrum%density*[1, 2, 1]
      channel%spectrum%edf = [5.0_dp, 10.0_dp, 5.0_dp]
      channel%spectrum%degrees_of_freedom = 10
      channel%spectrum%segment = 4
      channel%spectrum%segments = 5
      channel%spectrum%used = 4
      channel%spectrum%overlap = 0.5_dp
      channel%spectrum%resolution = 1.25_dp
   end subroutine fill_periodicity

   !> Louder at the end, by 12 and 8 %.
   subroutine fill_halves(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%available%halves = .true.
      channel%halves%statistic = 60
      channel%halves%freedom = 2
      channel%halves%p_value = 1e-13_dp
      channel%halves%tau = [0.2_dp, 0.4_dp]
      channel%halves%ratio = [1.12_dp, 1.08_dp]
      channel%halves%lower = [1.08_dp, 1.04_dp]
      channel%halves%upper = [1.16_dp, 1.12_dp]
      channel%halves%score = [6.0_dp, 4.0_dp]
   end subroutine fill_halves

   subroutine fill_series(channel)
      type(channel_result_type), intent(inout) :: channel
      real(dp), parameter :: trend(4) = [4.3e-3_dp, -2.0e-6_dp, 3.0e-10_dp, 1.25e-14_dp]

      channel%available%preprocess = .true.
      channel%raw%mean = 1.0e-3_dp
      channel%raw%variance = 6.0e-4_dp
      channel%raw%maximum = 3
      channel%cleaned%variance = 5.24e-4_dp
      channel%clean%method = "auto"
      channel%clean%threshold = 4.27_dp
      channel%clean%passes = 2
      channel%clean%removed = 1
      channel%clean%fraction = 1.0_dp/12
      channel%clean%trend%degree = 3
      allocate (channel%clean%trend%power(0:3), source=trend)
      allocate (channel%clean%trend%legendre(0:3), source=trend)
      channel%available%adf = .true.
      channel%adf%statistic = -71.5_dp
      channel%adf%p_value = 0
      channel%adf%observations = 11
      channel%adf%critical = [-3.43_dp, -2.86_dp, -2.57_dp]
      channel%adf%stationary = .true.
      allocate (channel%adf%table(1))
      channel%adf%table(1)%name = "level"
      channel%available%jarque_bera = .true.
      channel%jarque_bera%statistic = 1.2_dp
      channel%jarque_bera%p_value = 0.55_dp
      channel%jarque_bera%skewness = 0.0125_dp
      channel%jarque_bera%kurtosis = 3.25_dp
      channel%jarque_bera%skewness_error = 0.022_dp
      channel%jarque_bera%kurtosis_error = 0.045_dp
      call fill_distribution(channel)
      channel%available%ljung_box = .true.
      channel%ljung_box%statistic = 2030
      channel%ljung_box%p_value = 0
      channel%ljung_box%lags = 20
      channel%ljung_box%largest_rho = 0.41_dp
      channel%ljung_box%largest_lag = 3
      channel%available%kpss = .true.
      channel%kpss%statistic = 0.84_dp
      channel%kpss%p_value = 0.01_dp
      channel%kpss%p_bound = -1
      channel%kpss%p_asymptotic = 0.0058_dp
      channel%kpss%critical = [0.347_dp, 0.463_dp, 0.574_dp, 0.739_dp]
      channel%kpss%lags = 2
      channel%kpss%observations = 11
      channel%kpss%drift = 0.1_dp
   end subroutine fill_series

   !> Nearly normal, in steps of half a standard deviation, every second sample tested.
   subroutine fill_distribution(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%normality = "nearly"
      channel%available%anderson_darling = .true.
      channel%anderson_darling%modified = 0.7_dp
      channel%anderson_darling%p_value = 0.0668_dp
      channel%anderson_darling%samples = 5994
      channel%anderson_darling%stride = 2
      channel%available%quantization = .true.
      channel%quantization%quantized = .true.
      channel%quantization%step = 0.0114_dp
      channel%quantization%ratio = 0.5_dp
      channel%quantization%variance_share = 0.0208_dp
      channel%quantization%levels = 17
      channel%quantization%corrected_std = 0.02265_dp
   end subroutine fill_distribution

   subroutine fill_model(channel)
      type(channel_result_type), intent(inout) :: channel

      channel%available%ar = .true.
      channel%ar%order = 1
      channel%ar%coefficient = [0.41_dp]
      channel%ar%std_error = [0.0083_dp]
      channel%ar%noise_variance = 4.36e-4_dp
      allocate (channel%ar%table(0:3))
      channel%ar%table%order = [0, 1, 2, 3]
      channel%ar%table%noise_variance = 4.36e-4_dp
      channel%ar%table%aic = -58800.123_dp - channel%ar%table%order
      channel%ar%table%aic_per_observation = -4.9000123_dp
      channel%predictable_percent = 16.8_dp
   end subroutine fill_model

   subroutine fill_filter(filter, variance, dc_gain)
      type(filter_result_type), intent(out) :: filter
      real(dp), intent(in) :: variance, dc_gain

      filter%variance = variance
      filter%gain = 0.477_dp
      filter%dc_gain = dc_gain
      filter%nis_mean = 0.75_dp
      filter%q = 4.36e-4_dp
      filter%r = 5.24e-4_dp
      filter%forgetting = 0.98_dp
      filter%nis_low = 0.98_dp
      filter%nis_high = 1.02_dp
      filter%ljung_box%statistic = 700
      filter%ljung_box%p_value = 0
      filter%ljung_box%lags = 20
      filter%ljung_box%largest_rho = 0.2_dp
   end subroutine fill_filter

   !> N always, B only before the filters, the rest below its limit, R not fitted.
   subroutine fill_allan(channel, which)
      type(channel_result_type), intent(inout) :: channel
      integer, intent(in) :: which
      real(dp), parameter :: shrink(6) = [1.0_dp, 1.0_dp, 1.0_dp, 0.6_dp, 0.2_dp, 0.9_dp]

      if (which == stage%kf) channel%available%kf = .true.
      if (which == stage%akf) channel%available%akf = .true.
      associate (allan => channel%allan(which))
         allan%available = .true.
         allan%fitted = .true.
         allan%curve%tau = [0.2_dp, 0.4_dp]
         allan%curve%deviation = [0.02_dp, 0.0141_dp]*shrink(which)
         allan%curve%lower = 0.9_dp*allan%curve%deviation
         allan%curve%upper = 1.1_dp*allan%curve%deviation
         allan%curve%edf = [11.0_dp, 5.5_dp]
         allan%curve%terms = [11_int64, 9_int64]
         allan%noise%model = allan%curve%deviation
         allan%noise%described = .true.
         allan%noise%points = 2
         allan%noise%chi2_reduced = 1.1_dp
         allan%noise%coefficient%fitted = [.true., .true., .true., .true., .false.]
         allan%noise%coefficient%upper_limit = 3.0e-3_dp*shrink(which)
         allan%noise%coefficient(2)%value = 0.0158_dp*shrink(which)
         allan%noise%coefficient(2)%std_error = 2.0e-4_dp*shrink(which)
         allan%noise%coefficient(2)%detected = .true.
         allan%noise%coefficient(3)%value = 4.0e-3_dp*shrink(which)
         allan%noise%coefficient(3)%std_error = 1.0e-3_dp*shrink(which)
         allan%noise%coefficient(3)%detected = which < stage%kf
         where (allan%noise%coefficient%fitted) allan%noise%coefficient%state = "limit"
         where (allan%noise%coefficient%detected) allan%noise%coefficient%state = "value"
      end associate
   end subroutine fill_allan

end module report_fixture
