! SPDX-License-Identifier: MIT
!> Overlapping Hadamard deviation: a rate ramp (warming up) bends the Allan deviation up, the Hadamard deviation does not see it.
program example_ohdev
   use gyroakf, only : dp, error_type, record_type, simulate_options, simulate_record, allan_options, allan_curve_type, &
      compute_allan
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: noise
   type(record_type) :: record
   type(allan_curve_type) :: allan, hadamard
   integer :: i

   noise%samples = 60000
   noise%coefficient([2, 5]) = [0.01_dp, 1.0e-5_dp]              ! N in deg/sqrt(s), R in deg/s^2
   call simulate_record(noise, record, error)
   if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, &
                                                  allan_options(taus="1,10,100,1000"), allan, error)
   if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, &
                                                  allan_options(kind="ohdev", taus="1,10,100,1000"), hadamard, error)
   if (allocated(error)) error stop error%message
   print "(a)", "   tau       oadev       ohdev   white noise"
   print "(f6.0, 3es12.3)", (allan%tau(i), allan%deviation(i), hadamard%deviation(i), 0.01_dp/sqrt(allan%tau(i)), i=1, 4)
end program example_ohdev
