! SPDX-License-Identifier: MIT
!> All tests of the library:
!>
!>     fpm test                     all suites
!>     fpm test -- error            one suite
!>     fpm test -- error texts      one test
program test_main
   ! One line for every suite here, in alphabetical order ...
   use test_adf, only : collect_adf
   use test_adf_table, only : collect_adf_table
   use test_allan_covariance, only : collect_allan_covariance
   use test_allan_deviation, only : collect_allan_deviation
   use test_allan_freedom, only : collect_allan_freedom
   use test_allan_gaps, only : collect_allan_gaps
   use test_allan_grid, only : collect_allan_grid
   use test_allan_halves, only : collect_allan_halves
   use test_verdict, only : collect_verdict
   use test_allan_noise_fit, only : collect_allan_noise_fit
   use test_noise_statements, only : collect_noise_statements
   use test_chart, only : collect_chart
   use test_allan_read_off, only : collect_allan_read_off
   use test_allan_statistics, only : collect_allan_statistics
   use test_allan_noise_model, only : collect_allan_noise_model
   use test_ar, only : collect_ar
   use test_ar_roots, only : collect_ar_roots
   use test_ar_spectrum, only : collect_ar_spectrum
   use test_audit, only : collect_audit
   use test_auto_outliers, only : collect_auto_outliers
   use test_cadence, only : collect_cadence
   use test_report_models, only : collect_report_models
   use test_resample, only : collect_resample
   use test_autocovariance, only : collect_autocovariance
   use test_burg, only : collect_burg
   use test_clean, only : collect_clean
   use test_dates, only : collect_dates
   use test_decimal, only : collect_decimal
   use test_design, only : collect_design
   use test_error, only : collect_error
   use test_fft, only : collect_fft
   use test_fisher, only : collect_fisher
   use test_drift_adaptation, only : collect_drift_adaptation
   use test_drift_filter, only : collect_drift_filter
   use test_two_pass, only : collect_two_pass
   use test_filter_series, only : collect_filter_series
   use test_html, only : collect_html
   use test_likelihood, only : collect_likelihood
   use test_truth, only : collect_truth
   use test_smoother, only : collect_smoother
   use test_drift_fit, only : collect_drift_fit
   use test_drift_identification, only : collect_drift_identification
   use test_figures, only : collect_figures
   use test_filter_saving, only : collect_filter_saving
   use test_drift_steady, only : collect_drift_steady
   use test_json, only : collect_json
   use test_kalman, only : collect_kalman
   use test_least_squares, only : collect_least_squares
   use test_legacy, only : collect_legacy
   use test_levinson, only : collect_levinson
   use test_machine_memory, only : collect_machine_memory
   use test_moments, only : collect_moments
   use test_normality, only : collect_normality
   use test_anderson, only : collect_anderson
   use test_quantisation, only : collect_quantisation
   use test_sort, only : collect_sort
   use test_npy, only : collect_npy
   use test_number, only : collect_number
   use test_outliers, only : collect_outliers
   use test_hampel, only : collect_hampel
   use test_truncation, only : collect_truncation
   use test_periodicity, only : collect_periodicity
   use test_pipeline, only : collect_pipeline
   use test_pipeline_drift, only : collect_pipeline_drift
   use test_pipeline_limits, only : collect_pipeline_limits
   use test_progress, only : collect_progress
   use test_progress_text, only : collect_progress_text
   use test_quasi_newton, only : collect_quasi_newton
   use test_random, only : collect_random
   use test_raw, only : collect_raw
   use test_reader, only : collect_reader
   use test_reader_errors, only : collect_reader_errors
   use test_odd, only : collect_odd
   use test_store, only : collect_store
   use test_text_rows, only : collect_text_rows
   use test_record_writer, only : collect_record_writer
   use test_release, only : collect_release
   use test_report, only : collect_report
   use test_sage_husa, only : collect_sage_husa
   use test_selftest, only : collect_selftest
   use test_simulate, only : collect_simulate
   use test_simulate_disturbance, only : collect_simulate_disturbance
   use test_simulate_sensor, only : collect_simulate_sensor
   use test_status, only : collect_status
   use test_special, only : collect_special
   use test_state_space, only : collect_state_space
   use test_summary, only : collect_summary
   use test_table, only : collect_table
   use test_tables, only : collect_tables
   use test_text, only : collect_text
   use test_trend, only : collect_trend
   use test_column_class, only : collect_column_class
   use test_columns_writer, only : collect_columns_writer
   use test_conventions, only : collect_conventions
   use test_kalibr, only : collect_kalibr
   use test_threads, only : collect_threads
   use test_units, only : collect_units
   use test_kpss, only : collect_kpss
   use test_correlation, only : collect_correlation
   use test_welch, only : collect_welch
   use test_whiteness, only : collect_whiteness
   use test_writer, only : collect_writer
   use suite_runner, only : add, finish
   implicit none (type, external)

   ! ... and one line here, in the same order.
   call add("adf", collect_adf)
   call add("adf_table", collect_adf_table)
   call add("allan_covariance", collect_allan_covariance)
   call add("allan_deviation", collect_allan_deviation)
   call add("allan_freedom", collect_allan_freedom)
   call add("allan_gaps", collect_allan_gaps)
   call add("allan_grid", collect_allan_grid)
   call add("allan_halves", collect_allan_halves)
   call add("verdict", collect_verdict)
   call add("allan_noise_fit", collect_allan_noise_fit)
   call add("noise_statements", collect_noise_statements)
   call add("allan_read_off", collect_allan_read_off)
   call add("allan_statistics", collect_allan_statistics)
   call add("allan_noise_model", collect_allan_noise_model)
   call add("ar", collect_ar)
   call add("ar_roots", collect_ar_roots)
   call add("ar_spectrum", collect_ar_spectrum)
   call add("audit", collect_audit)
   call add("auto_outliers", collect_auto_outliers)
   call add("cadence", collect_cadence)
   call add("report_models", collect_report_models)
   call add("resample", collect_resample)
   call add("autocovariance", collect_autocovariance)
   call add("burg", collect_burg)
   call add("clean", collect_clean)
   call add("dates", collect_dates)
   call add("decimal", collect_decimal)
   call add("design", collect_design)
   call add("error", collect_error)
   call add("fft", collect_fft)
   call add("fisher", collect_fisher)
   call add("filter_series", collect_filter_series)
   call add("drift_adaptation", collect_drift_adaptation)
   call add("drift_filter", collect_drift_filter)
   call add("two_pass", collect_two_pass)
   call add("likelihood", collect_likelihood)
   call add("truth", collect_truth)
   call add("smoother", collect_smoother)
   call add("drift_fit", collect_drift_fit)
   call add("drift_identification", collect_drift_identification)
   call add("figures", collect_figures)
   call add("filter_saving", collect_filter_saving)
   call add("drift_steady", collect_drift_steady)
   call add("json", collect_json)
   call add("kalman", collect_kalman)
   call add("least_squares", collect_least_squares)
   call add("legacy", collect_legacy)
   call add("levinson", collect_levinson)
   call add("machine_memory", collect_machine_memory)
   call add("moments", collect_moments)
   call add("normality", collect_normality)
   call add("anderson", collect_anderson)
   call add("html", collect_html)
   call add("quantisation", collect_quantisation)
   call add("sort", collect_sort)
   call add("npy", collect_npy)
   call add("number", collect_number)
   call add("outliers", collect_outliers)
   call add("hampel", collect_hampel)
   call add("truncation", collect_truncation)
   call add("periodicity", collect_periodicity)
   call add("pipeline", collect_pipeline)
   call add("pipeline_drift", collect_pipeline_drift)
   call add("pipeline_limits", collect_pipeline_limits)
   call add("progress", collect_progress)
   call add("progress_text", collect_progress_text)
   call add("quasi_newton", collect_quasi_newton)
   call add("random", collect_random)
   call add("raw", collect_raw)
   call add("reader", collect_reader)
   call add("reader_errors", collect_reader_errors)
   call add("odd", collect_odd)
   call add("store", collect_store)
   call add("text_rows", collect_text_rows)
   call add("record_writer", collect_record_writer)
   call add("release", collect_release)
   call add("report", collect_report)
   call add("sage_husa", collect_sage_husa)
   call add("selftest", collect_selftest)
   call add("simulate", collect_simulate)
   call add("simulate_disturbance", collect_simulate_disturbance)
   call add("simulate_sensor", collect_simulate_sensor)
   call add("status", collect_status)
   call add("special", collect_special)
   call add("state_space", collect_state_space)
   call add("summary", collect_summary)
   call add("table", collect_table)
   call add("tables", collect_tables)
   call add("chart", collect_chart)
   call add("text", collect_text)
   call add("trend", collect_trend)
   call add("column_class", collect_column_class)
   call add("columns_writer", collect_columns_writer)
   call add("conventions", collect_conventions)
   call add("kalibr", collect_kalibr)
   call add("threads", collect_threads)
   call add("units", collect_units)
   call add("kpss", collect_kpss)
   call add("correlation", collect_correlation)
   call add("welch", collect_welch)
   call add("whiteness", collect_whiteness)
   call add("writer", collect_writer)

   if (finish()) stop 1, quiet=.true.
end program test_main
