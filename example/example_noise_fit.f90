! SPDX-License-Identifier: MIT
!> Coefficients from a curve, chosen by the fit and with chosen terms and averaging times; what the record was made of beside them.
program example_noise_fit
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, allan_options, allan_curve_type, &
      compute_allan, noise_options, noise_type, fit_noise, term_names
   implicit none (type, external)
   real(dp), parameter :: truth(5) = [0.0_dp, 0.3_dp, 0.1_dp, 0.0_dp, 0.0_dp]
   character(6), parameter :: terms(2) = ["auto  ", "NBK   "]
   real(dp), parameter :: tau_max(2) = [huge(1.0_dp), 4000.0_dp]
   type(error_type), allocatable :: error
   type(simulate_options) :: simulated
   type(record_type) :: record
   type(allan_curve_type) :: curve
   type(noise_type) :: noise
   integer :: i, term

   simulated%samples = 200000
   simulated%rate_hz = 10
   simulated%coefficient = truth
   call simulate_record(simulated, record, error)
   do i = 1, 2
      if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, &
                                                     allan_options(taus="log:8"), curve, error)
      if (.not. allocated(error)) call fit_noise(curve, noise_options(terms(i), tau_max=tau_max(i)), noise, error)
      if (allocated(error)) error stop error%message
      print "(a, i0, a, f0.2)", trim(terms(i))//": ", noise%points, " octaves, chi2 per degree of freedom ", noise%chi2_reduced
      do term = 2, 4
         associate (c => noise%coefficient(term))
            print "(2x, 2a, f8.4, 3(a, f7.4))", term_names(term), ": "//c%state, c%value, " +/-", c%std_error, ", below ", &
               c%upper_limit, ", true", truth(term)
         end associate
      end do
   end do
end program example_noise_fit
