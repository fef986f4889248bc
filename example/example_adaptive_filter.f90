! SPDX-License-Identifier: MIT
!> Drift under white noise: identified from the record, then followed by a filter that adapts R.
program example_adaptive_filter
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, drift_identification_options, &
      drift_identification_type, identify_drift_model, drift_options, drift_filter_type, design_drift_akf, filter_result_type, &
      & filter_series
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(drift_identification_type) :: drift
   type(drift_filter_type) :: filter
   type(filter_result_type) :: quality
   real(dp) :: x(12000)

   noise%coefficient(2) = 0.01_dp                                        ! N, deg/s/sqrt(Hz)
   noise%ar = [0.995_dp]
   noise%ar_variance = 4.0e-4_dp
   call simulate_record(noise, record, error)
   if (.not. allocated(error)) call identify_drift_model(record%value(:, 1), drift_identification_options(), drift, error)
   if (.not. allocated(error)) call design_drift_akf(drift, 0.0_dp, drift_options(), filter, error)
   if (.not. allocated(error)) call filter_series(filter, record%value(:, 1), x, quality, error)
   if (allocated(error)) error stop error%message
   print "(a, f0.1, a)", "correlation time ", drift%correlation_samples*record%sample_interval, " s"
   print "(a, f0.3)", "mean normalized innovation squared ", quality%nis_mean
end program example_adaptive_filter
