! SPDX-License-Identifier: MIT
!> Random errors of gyroscopes, characterised and compensated.
!>
!> The whole public interface under one name; this module holds no code. Module names give the
!> source files: `gyroakf_allan_deviations` is in `src/gyroakf/allan/deviations.f90`.
module gyroakf
   use gyroakf_kinds, only : dp, int8, int16, int32, int64
   use gyroakf_error, only : error_type, fatal_error, status, exit_code
   use gyroakf_progress, only : progress_type
   use gyroakf_progress_text, only : progress_line
   use gyroakf_release, only : release_string
   use gyroakf_units, only : unit_type, coefficient_unit_type, quantity, term_names, parse_unit, &
      parse_units, coefficient_unit, density_unit, is_integral, coefficient_definition
   use gyroakf_record, only : record_type, text_type, add_text, sample_count
   use gyroakf_fft, only : real_fft_plan_type, new_real_fft_plan, real_fft_forward
   use gyroakf_random, only : random_type, seed_random, next_uniform, next_normal, fill_normal
   use gyroakf_io_record_writer, only : write_record
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record, paper_preset, &
      paper_seed
   use gyroakf_filter_state_space, only : steady_state, dc_gain, output_variance_ratio
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter, step_filter, &
      run_filter, freeze_filter
   use gyroakf_allan_grid, only : averaging_factors
   use gyroakf_allan_deviations, only : allan_options, allan_curve_type, compute_allan, &
      compute_allan_from_phase
   use gyroakf_allan_statistic, only : statistic_names, statistic_edf, longest_factor
   use gyroakf_allan_phase, only : integrate_rate
   use gyroakf_allan_noise_identification, only : identify_noise
   use gyroakf_allan_fit_covariance, only : covariance_basis, covariance_basis_type, mixture_covariances
   use gyroakf_allan_noise_fit, only : noise_options, noise_type, fit_noise
   use gyroakf_allan_read_off, only : read_off_type, read_off
   use gyroakf_allan_degrees_of_freedom, only : greenhall_edf, chi_square_limits
   use gyroakf_allan_halves, only : halves_options, halves_type, compare_halves
   use gyroakf_io_number, only : parse_number
   use gyroakf_io_columns_writer, only : column_type, row_layout_type, set_even, begin_rows, &
      put_rows
   use gyroakf_io_reader, only : reader_options, read_record, complete_record
   use gyroakf_io_recording, only : recording_type, open_recording, hold_rows, close_recording, &
      bytes_needed
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, complete_writer, &
      commit_writer, discard_writer, make_directory
   use gyroakf_stats_moments, only : moments_type, compute_moments
   use gyroakf_stats_whiteness, only : ljung_box_type, test_ljung_box
   use gyroakf_stats_correlation, only : correlation_type, compute_correlation
   use gyroakf_series_kpss, only : kpss_options, kpss_type, test_kpss
   use gyroakf_stats_welch, only : welch_options, welch_type, welch_spectrum
   use gyroakf_stats_normality, only : jarque_bera_type, test_jarque_bera, judge_normality
   use gyroakf_stats_anderson_darling, only : anderson_darling_options, anderson_darling_type, &
      test_anderson_darling
   use gyroakf_stats_histogram, only : histogram_options, histogram_type, compute_histogram
   use gyroakf_stats_quantization, only : quantisation_type, find_quantisation
   use gyroakf_ar_spectrum, only : ar_spectrum
   use gyroakf_filter_filter_series, only : filter_result_type, filter_series
   use gyroakf_filter_components, only : component_model_type
   use gyroakf_filter_likelihood, only : component_likelihood
   use gyroakf_filter_smoother, only : smooth_drift
   use gyroakf_filter_drift_filter, only : new_drift_filter
   use gyroakf_filter_two_pass, only : smooth_adaptive
   use gyroakf_filter_drift_fit, only : drift_fit_type, fit_drift
   use gyroakf_filter_saving, only : save_filter, restore_filter, reset_filter
   use gyroakf_filter_drift_identification, only : drift_identification_options, &
      drift_identification_type, identify_drift_model
   use gyroakf_stats_trend, only : trend_type, fit_trend, remove_trend, evaluate_trend
   use gyroakf_preprocess_clean, only : clean_options, clean_type, clean_series
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_ar_model, only : ar_options, ar_model_type, fit_ar
   use gyroakf_filter_design, only : design_options, design_kf, design_akf, drift_options, &
      design_drift_akf
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, channel_result_type, &
      stage, apply_preset, run_pipeline, estimate_memory
   use gyroakf_selftest, only : selftest_type, run_selftest
   use gyroakf_report_selftest_report, only : report_selftest
   use gyroakf_report_text_report, only : write_report, report_inspect
   use gyroakf_report_files, only : write_results
   use gyroakf_report_figures, only : build_figures, named_figure_type
   use gyroakf_report_html_page, only : write_page
   use gyroakf_report_summary, only : summarise, summarise_failure, summary_row_type
   use gyroakf_report_csv, only : series_output_type
   use gyroakf_report_kalibr, only : check_kalibr, write_kalibr
   use gyroakf_report_document, only : write_document
   implicit none (type, external)
   public
end module gyroakf
