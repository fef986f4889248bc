! SPDX-License-Identifier: MIT
!> Where the noise of a record changes: its Allan deviation in segments.
program example_dynamic_allan
   use gyroakf, only : dp, error_type, simulate_options, simulate_record, record_type, dynamic_options, dynamic_type, dynamic_allan
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(simulate_options) :: options
   type(record_type) :: record
   type(dynamic_type) :: dynamic
   integer :: j

   options%samples = 100000
   options%rate_hz = 100
   options%coefficient(2) = 0.01_dp
   call simulate_record(options, record, error)
   if (allocated(error)) error stop error%message
   record%value(60001:70000, 1) = 2*record%value(60001:70000, 1)   ! loud from 600 s to 700 s
   call dynamic_allan(record%value(:, 1), record%sample_interval, dynamic_options(segments=19), dynamic, error)
   if (allocated(error)) error stop error%message
   print "(a9, 4f10.2, a)", "tau", dynamic%tau([1, 4, 7, 10]), " s"
   print "(f9.0, 4f10.6)", (dynamic%start(j), dynamic%deviation([1, 4, 7, 10], j), j=1, size(dynamic%start))
end program example_dynamic_allan
