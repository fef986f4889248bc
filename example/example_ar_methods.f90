! SPDX-License-Identifier: MIT
!> AR(2) of a simulated series by three methods, its roots and its spectrum.
program example_ar_methods
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, ar_options, ar_model_type, &
      ar_spectrum, fit_ar
   implicit none (type, external)
   character(4), parameter :: method(3) = [character(4) :: "yw", "burg", "ols"]
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(ar_model_type) :: model
   integer :: i, j

   noise%ar = [1.2_dp, -0.7_dp]
   noise%ar_variance = 1.0_dp
   call simulate_record(noise, record, error)
   if (allocated(error)) error stop error%message
   do i = 1, size(method)
      call fit_ar(record%value(:, 1), ar_options(method=method(i), order=2), model, error)
      if (allocated(error)) error stop error%message
      print "(a4, 2(a, f8.5, a, f7.5), a, f8.5)", method(i), ("  phi ", model%coefficient(j), " +/- ", &
         model%std_error(j), j=1, 2), "  variance ", model%noise_variance
   end do
   print "(a, l1, 3(a, f8.5))", "stationary ", model%stationary, ", modulus ", model%root(1)%modulus, ", frequency ", &
      model%root(1)%frequency, " cycles a sample, time constant ", model%root(1)%time_constant
   print "(f6.3, es12.4)", (0.05_dp*real(i, dp), ar_spectrum(model, 0.05_dp*real(i, dp), 1.0_dp), i=0, 10)
end program example_ar_methods
