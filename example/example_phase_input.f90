! SPDX-License-Identifier: MIT
!> Allan deviation from angles (phases), the output of an integrating gyroscope: the same as from the rates between them.
program example_phase_input
   use gyroakf, only : dp, error_type, allan_options, allan_curve_type, compute_allan, compute_allan_from_phase
   implicit none (type, external)
   real(dp), parameter :: rate(9) = [892.0_dp, 809.0_dp, 823.0_dp, 798.0_dp, 671.0_dp, 644.0_dp, 883.0_dp, 903.0_dp, 677.0_dp]
   type(error_type), allocatable :: error
   type(allan_curve_type) :: of_rates, of_angles
   real(dp) :: angle(10)
   integer :: i

   angle(1) = 0
   do i = 1, 9
      angle(i + 1) = angle(i) + rate(i)                          ! n rates make n + 1 angles
   end do
   call compute_allan(rate, 1.0_dp, allan_options(), of_rates, error)
   if (.not. allocated(error)) call compute_allan_from_phase(angle, 1.0_dp, allan_options(), of_angles, error)
   if (allocated(error)) error stop error%message
   print "(f4.0, 2f12.5)", (of_rates%tau(i), of_rates%deviation(i), of_angles%deviation(i), i=1, size(of_rates%tau))
end program example_phase_input
