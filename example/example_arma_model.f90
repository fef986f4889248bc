! SPDX-License-Identifier: MIT
!> A drift under white noise as an ARMA model: orders by BIC, and the drift's time and size with their errors.
program example_arma_model
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, arma_options, arma_model_type, fit_arma
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(arma_model_type) :: model
   integer :: i

   noise%ar = [0.98_dp]                                      ! correlation time -1/ln 0.98 = 49.5 samples
   noise%ar_variance = 0.09_dp                               ! of the drift
   noise%coefficient(2) = sqrt(0.2_dp)                      ! white noise of variance 1 at 5 Hz
   call simulate_record(noise, record, error)
   if (.not. allocated(error)) call fit_arma(record%value(:, 1), arma_options(max_p=2, max_q=2), model, error)
   if (allocated(error)) error stop error%message
   print "(a, i0, a, i0, a, f0.1)", ("ARMA(", model%table(i)%p, ",", model%table(i)%q, ")  BIC ", model%table(i)%bic, &
      i=1, size(model%table))
   print "(a, i0, a, i0, a)", "chosen: ARMA(", model%p, ",", model%q, ")"
   print "(a, f6.3, a, f5.3)", "phi   = ", model%phi(1), " +/- ", model%phi_error(1)
   print "(a, f6.3, a, f5.3)", "theta = ", model%theta(1), " +/- ", model%theta_error(1)
   print "(a, f5.1, a, f5.1)", "time  = ", model%drift%time_constant, " +/- ", model%drift%time_error
   print "(a, f6.3, a, f5.3)", "drift = ", model%drift%drift_std, " +/- ", model%drift%drift_error
   print "(a, f6.3, a, f5.3)", "white = ", model%drift%white_std, " +/- ", model%drift%white_error
end program example_arma_model
