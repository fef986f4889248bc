! SPDX-License-Identifier: MIT
!> All tests of the library:
!>
!>     fpm test                     all suites
!>     fpm test -- error            one suite
!>     fpm test -- error texts      one test
program test_main
   ! One line for every suite here, in alphabetical order ...
   use test_adf, only : suite_adf
   use test_adf_table, only : suite_adf_table
   use test_allan_covariance, only : suite_allan_covariance, suite_allan_noise_model
   use test_allan_deviation, only : suite_allan_deviation
   use test_allan_gaps, only : suite_allan_gaps
   use test_allan_grid, only : suite_allan_grid, suite_allan_freedom
   use test_allan_halves, only : suite_allan_halves
   use test_verdict, only : suite_verdict
   use test_allan_noise_fit, only : suite_allan_noise_fit
   use test_noise_statements, only : suite_noise_statements
   use test_chart, only : suite_chart
   use test_allan_read_off, only : suite_allan_read_off
   use test_allan_statistics, only : suite_allan_statistics
   use test_ar, only : suite_ar
   use test_ar_roots, only : suite_ar_roots, suite_ar_spectrum
   use test_audit, only : suite_audit
   use test_auto_outliers, only : suite_auto_outliers
   use test_cadence, only : suite_cadence
   use test_resample, only : suite_resample
   use test_autocovariance, only : suite_autocovariance, suite_levinson
   use test_burg, only : suite_burg
   use test_clean, only : suite_clean
   use test_dates, only : suite_dates
   use test_decimal, only : suite_decimal
   use test_design, only : suite_design
   use test_fft, only : suite_fft
   use test_fisher, only : suite_fisher
   use test_drift_adaptation, only : suite_drift_adaptation, suite_drift_steady
   use test_drift_filter, only : suite_drift_filter
   use test_two_pass, only : suite_two_pass
   use test_filter_series, only : suite_filter_series
   use test_html, only : suite_html
   use test_likelihood, only : suite_likelihood
   use test_truth, only : suite_truth
   use test_smoother, only : suite_smoother
   use test_drift_fit, only : suite_drift_fit
   use test_drift_identification, only : suite_drift_identification
   use test_figures, only : suite_figures
   use test_filter_saving, only : suite_filter_saving
   use test_json, only : suite_json
   use test_kalman, only : suite_kalman
   use test_least_squares, only : suite_least_squares
   use test_legacy, only : suite_legacy
   use test_moments, only : suite_moments
   use test_normality, only : suite_normality, suite_anderson
   use test_quantization, only : suite_quantization
   use test_sort, only : suite_sort
   use test_npy, only : suite_npy
   use test_number, only : suite_number
   use test_outliers, only : suite_outliers
   use test_hampel, only : suite_hampel
   use test_truncation, only : suite_truncation
   use test_periodicity, only : suite_periodicity
   use test_pipeline, only : suite_pipeline
   use test_pipeline_drift, only : suite_pipeline_drift
   use test_pipeline_limits, only : suite_pipeline_limits
   use test_progress, only : suite_progress, suite_progress_text
   use test_quasi_newton, only : suite_quasi_newton
   use test_random, only : suite_random
   use test_raw, only : suite_raw
   use test_reader, only : suite_reader
   use test_reader_errors, only : suite_reader_errors
   use test_odd, only : suite_odd
   use test_text_rows, only : suite_text_rows, suite_store
   use test_record_writer, only : suite_record_writer, suite_columns_writer
   use test_report, only : suite_report
   use test_schema, only : suite_schema
   use test_sage_husa, only : suite_sage_husa
   use test_selftest, only : suite_selftest, suite_release
   use test_simulate, only : suite_simulate
   use test_simulate_sensor, only : suite_simulate_sensor, suite_simulate_disturbance
   use test_status, only : suite_status, suite_error
   use test_special, only : suite_special
   use test_state_space, only : suite_state_space
   use test_summary, only : suite_summary
   use test_table, only : suite_table, suite_tables
   use test_text, only : suite_text
   use test_trend, only : suite_trend
   use test_conventions, only : suite_conventions
   use test_kalibr, only : suite_kalibr
   use test_machine, only : suite_threads, suite_machine_memory
   use test_units, only : suite_units, suite_column_class
   use test_kpss, only : suite_kpss
   use test_welch, only : suite_welch
   use test_whiteness, only : suite_whiteness, suite_correlation
   use test_writer, only : suite_writer
   use suite_runner, only : add, finish
   implicit none (type, external)

   ! ... and one line here, in the same order.
   call add("adf", suite_adf)
   call add("adf_table", suite_adf_table)
   call add("allan_covariance", suite_allan_covariance)
   call add("allan_deviation", suite_allan_deviation)
   call add("allan_freedom", suite_allan_freedom)
   call add("allan_gaps", suite_allan_gaps)
   call add("allan_grid", suite_allan_grid)
   call add("allan_halves", suite_allan_halves)
   call add("verdict", suite_verdict)
   call add("allan_noise_fit", suite_allan_noise_fit)
   call add("noise_statements", suite_noise_statements)
   call add("allan_read_off", suite_allan_read_off)
   call add("allan_statistics", suite_allan_statistics)
   call add("allan_noise_model", suite_allan_noise_model)
   call add("ar", suite_ar)
   call add("ar_roots", suite_ar_roots)
   call add("ar_spectrum", suite_ar_spectrum)
   call add("audit", suite_audit)
   call add("auto_outliers", suite_auto_outliers)
   call add("cadence", suite_cadence)
   call add("resample", suite_resample)
   call add("autocovariance", suite_autocovariance)
   call add("burg", suite_burg)
   call add("clean", suite_clean)
   call add("dates", suite_dates)
   call add("decimal", suite_decimal)
   call add("design", suite_design)
   call add("error", suite_error)
   call add("fft", suite_fft)
   call add("fisher", suite_fisher)
   call add("filter_series", suite_filter_series)
   call add("drift_adaptation", suite_drift_adaptation)
   call add("drift_filter", suite_drift_filter)
   call add("two_pass", suite_two_pass)
   call add("likelihood", suite_likelihood)
   call add("truth", suite_truth)
   call add("smoother", suite_smoother)
   call add("drift_fit", suite_drift_fit)
   call add("drift_identification", suite_drift_identification)
   call add("figures", suite_figures)
   call add("filter_saving", suite_filter_saving)
   call add("drift_steady", suite_drift_steady)
   call add("json", suite_json)
   call add("kalman", suite_kalman)
   call add("least_squares", suite_least_squares)
   call add("legacy", suite_legacy)
   call add("levinson", suite_levinson)
   call add("machine_memory", suite_machine_memory)
   call add("moments", suite_moments)
   call add("normality", suite_normality)
   call add("anderson", suite_anderson)
   call add("html", suite_html)
   call add("quantization", suite_quantization)
   call add("sort", suite_sort)
   call add("npy", suite_npy)
   call add("number", suite_number)
   call add("outliers", suite_outliers)
   call add("hampel", suite_hampel)
   call add("truncation", suite_truncation)
   call add("periodicity", suite_periodicity)
   call add("pipeline", suite_pipeline)
   call add("pipeline_drift", suite_pipeline_drift)
   call add("pipeline_limits", suite_pipeline_limits)
   call add("progress", suite_progress)
   call add("progress_text", suite_progress_text)
   call add("quasi_newton", suite_quasi_newton)
   call add("random", suite_random)
   call add("raw", suite_raw)
   call add("reader", suite_reader)
   call add("reader_errors", suite_reader_errors)
   call add("odd", suite_odd)
   call add("store", suite_store)
   call add("text_rows", suite_text_rows)
   call add("record_writer", suite_record_writer)
   call add("release", suite_release)
   call add("report", suite_report)
   call add("schema", suite_schema)
   call add("sage_husa", suite_sage_husa)
   call add("selftest", suite_selftest)
   call add("simulate", suite_simulate)
   call add("simulate_disturbance", suite_simulate_disturbance)
   call add("simulate_sensor", suite_simulate_sensor)
   call add("status", suite_status)
   call add("special", suite_special)
   call add("state_space", suite_state_space)
   call add("summary", suite_summary)
   call add("table", suite_table)
   call add("tables", suite_tables)
   call add("chart", suite_chart)
   call add("text", suite_text)
   call add("trend", suite_trend)
   call add("column_class", suite_column_class)
   call add("columns_writer", suite_columns_writer)
   call add("conventions", suite_conventions)
   call add("kalibr", suite_kalibr)
   call add("threads", suite_threads)
   call add("units", suite_units)
   call add("kpss", suite_kpss)
   call add("correlation", suite_correlation)
   call add("welch", suite_welch)
   call add("whiteness", suite_whiteness)
   call add("writer", suite_writer)

   if (finish()) stop 1, quiet=.true.
end program test_main
