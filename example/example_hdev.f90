! SPDX-License-Identifier: MIT
!> Hadamard deviation of adjacent windows, of the nine rates of NIST SP 1065 (table 30); published: 70.80607, 116.7980.
program example_hdev
   use gyroakf, only : dp, error_type, allan_options, allan_curve_type, compute_allan
   implicit none (type, external)
   real(dp), parameter :: rate(9) = [892.0_dp, 809.0_dp, 823.0_dp, 798.0_dp, 671.0_dp, 644.0_dp, 883.0_dp, 903.0_dp, 677.0_dp]
   type(error_type), allocatable :: error
   type(allan_curve_type) :: curve
   integer :: i

   call compute_allan(rate, 1.0_dp, allan_options(kind="hdev", taus="1,2"), curve, error)
   if (allocated(error)) error stop error%message
   print "(f4.0, f12.5, i4, a)", (curve%tau(i), curve%deviation(i), curve%terms(i), " terms", i=1, size(curve%tau))
end program example_hdev
