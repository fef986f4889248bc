! SPDX-License-Identifier: MIT
!> Is a record stationary, is it white? KPSS with the size of the drift, autocorrelation with its limit.
program example_correlation
   use gyroakf, only : dp, error_type, reader_options, read_record, record_type, kpss_options, kpss_type, test_kpss, &
      correlation_type, compute_correlation
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(kpss_type) :: kpss
   type(correlation_type) :: correlation
   integer :: lag

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   if (.not. allocated(error)) call test_kpss(record%value(:, 1), kpss_options(), kpss, error)
   if (.not. allocated(error)) call compute_correlation(record%value(:, 1), 20, 0, correlation, error)
   if (allocated(error)) error stop error%message
   print "(a, f0.4, a, f0.3, a, i0)", "KPSS ", kpss%statistic, ", p = ", kpss%p_asymptotic, ", bandwidth ", kpss%lags
   print "(a, f0.3, a)", "a line that spans ", kpss%drift/sqrt(kpss%variance), " standard deviations drifts as much"
   do lag = 1, 3
      print "(a, i0, a, f7.4, a, f7.4)", "lag ", lag, ": acf ", correlation%acf(lag), ", pacf ", correlation%pacf(lag)
   end do
   print "(a, f0.4, a, i0)", "95 % limit ", correlation%limit(1), ", largest at lag ", correlation%largest_lag
   print "(a, f0.1)", "Ljung-Box ", correlation%ljung_box(20)
end program example_correlation
