! SPDX-License-Identifier: MIT
!> Outliers and trend removed; is what is left stationary, normal, white?
program example_clean_and_test
   use gyroakf, only : dp, int8, error_type, reader_options, read_record, record_type, clean_options, clean_type, clean_series, &
      adf_options, adf_type, test_adf, moments_type, compute_moments, jarque_bera_type, test_jarque_bera
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(clean_type) :: clean
   type(adf_type) :: adf
   type(moments_type) :: moments
   type(jarque_bera_type) :: normality
   real(dp), allocatable :: z(:)
   integer(int8), allocatable :: present(:)

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   if (.not. allocated(error)) call clean_series(record%value(:, 1), clean_options(), z, present, clean, error)
   if (.not. allocated(error)) call test_adf(z, adf_options(), adf, error, present)
   if (.not. allocated(error)) call compute_moments(z, moments, present)
   if (.not. allocated(error)) call test_jarque_bera(moments, normality, error)
   if (allocated(error)) error stop error%message
   print "(i0, a)", clean%removed, " outliers removed"
   print "(a, f0.2, a, l1)", "ADF ", adf%statistic, ", stationary: ", adf%stationary
   print "(a, f0.3)", "Jarque-Bera p = ", normality%p_value
end program example_clean_and_test
