! SPDX-License-Identifier: MIT
!> Random errors of gyroscopes, characterized and compensated.
!>
!> The public interface under one name; this module holds no code. Module names give the source
!> files: `gyroakf_allan_deviations` is in `src/gyroakf/allan/deviations.f90`.
module gyroakf
   ! Kinds, errors, progress, version
   use gyroakf_kinds, only : dp, int8, int16, int32, int64
   use gyroakf_error, only : error_type, fatal_error, status, exit_code
   use gyroakf_progress, only : progress_type
   use gyroakf_progress_text, only : progress_line
   use gyroakf_release, only : release_string
   ! Records: units, reading, writing
   use gyroakf_record, only : record_type, text_type, sample_count
   use gyroakf_units, only : unit_type, term_names, parse_unit
   use gyroakf_coefficient_units, only : coefficient_unit_type, coefficient_unit, density_unit, &
      coefficient_definition
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_io_columns_writer, only : write_record
   use gyroakf_io_writer, only : writer_type, open_writer, put_line, commit_writer, discard_writer
   ! Simulated records and random numbers
   use gyroakf_random, only : random_type, seed_random, next_uniform, next_normal, fill_normal
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, &
      paper_seed
   ! Cleaning: outliers, trend, quantization
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_stats_trend, only : trend_type, remove_trend, evaluate_trend
   use gyroakf_stats_trend_fit, only : fit_trend
   use gyroakf_stats_quantization, only : quantization_type, find_quantization
   ! Allan deviation and its relatives, noise coefficients, change during the record
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan, &
      compute_allan_from_phase
   use gyroakf_allan_phase, only : integrate_rate
   use gyroakf_allan_statistic, only : statistic_names, statistic_edf
   use gyroakf_allan_degrees_of_freedom, only : greenhall_edf, chi_square_limits
   use gyroakf_allan_noise_identification, only : identify_noise
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, fit_noise
   use gyroakf_allan_read_off, only : read_off_type, read_off
   use gyroakf_allan_halves, only : halves_options, halves_type, compare_halves
   ! Moments, distribution, spectrum
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_normality, only : jarque_bera_type, test_jarque_bera, judge_normality
   use gyroakf_stats_anderson_darling, only : anderson_darling_options, anderson_darling_type, &
      test_anderson_darling
   use gyroakf_stats_welch, only : welch_options, welch_type, welch_spectrum
   ! Tests of stationarity and whiteness
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation
   ! AR models
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar, ar_spectrum
   ! Kalman filter and Sage-Husa adaptive Kalman filter
   use gyroakf_filter_kalman, only : drift_filter_type, filter_options, filter_type, new_filter, &
      step_filter, run_filter, freeze_filter
   use gyroakf_filter_saving, only : save_filter, restore_filter, reset_filter
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_design, only : design_options, design_kf, design_akf, drift_options, &
      design_drift_akf
   use gyroakf_filter_state_space, only : dc_gain, output_variance_ratio
   use gyroakf_filter_steady_gain, only : steady_state
   ! Drift: models by maximum likelihood, filter, smoothers
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift
   use gyroakf_filter_drift_identification, only : drift_identification_options, &
      drift_identification_type, identify_drift_model
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_two_pass, only : smooth_adaptive
   ! The whole job, and its results as text, files, JSON, page and Kalibr's imu.yaml
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, channel_result_type, &
      stage, apply_preset, run_pipeline
   use gyroakf_report_text_report, only : write_report
   use gyroakf_report_files, only : write_results
   use gyroakf_report_document, only : write_document
   use gyroakf_report_html_page, only : write_page
   use gyroakf_report_kalibr, only : write_kalibr
   ! Verification of a build
   use gyroakf_selftest, only : selftest_type, run_selftest
   implicit none (type, external)
   public
end module gyroakf
