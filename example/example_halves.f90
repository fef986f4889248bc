! SPDX-License-Identifier: MIT
!> Whether the noise of a record changed from its first to its second half.
program example_halves
   use gyroakf, only : dp, error_type, simulate_options, simulate_record, record_type, allan_options, allan_curve_type, &
      compute_allan, noise_options, noise_type, fit_noise, halves_options, halves_type, compare_halves
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: options
   type(record_type) :: record
   type(allan_curve_type) :: curve
   type(noise_type) :: noise
   type(halves_type) :: halves
   integer :: i

   options%samples = 100000
   options%rate_hz = 100
   options%coefficient(2) = 0.01_dp
   call simulate_record(options, record, error)
   if (allocated(error)) error stop error%message
   record%value(50001:, 1) = 1.05_dp*record%value(50001:, 1)       ! 5 % more noise
   call compute_allan(record%value(:, 1), record%sample_interval, allan_options(), curve, error)
   if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
   if (.not. allocated(error)) call compare_halves(record%value(:, 1), record%sample_interval, noise, halves_options(), halves, &
      error)
   if (allocated(error)) error stop error%message
   print "(a, f0.1, a, i0, a, es8.1)", "chi-square ", halves%statistic, ", ", halves%freedom, " degrees of freedom, p ", &
      halves%p_value
   print "(f9.2, a, f6.3, a, f6.3, a, f6.3)", (halves%tau(i), " s: second/first ", halves%ratio(i), ", limits ", halves%lower(i), &
      " and ", halves%upper(i), i=1, size(halves%tau))
end program example_halves
