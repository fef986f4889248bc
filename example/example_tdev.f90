! SPDX-License-Identifier: MIT
!> Time deviation, tau mdev/sqrt(3): of a gyroscope the angle that white phase noise adds, in the unit of the angle.
program example_tdev
   use gyroakf, only : dp, error_type, allan_options, allan_curve_type, compute_allan
   implicit none (type, external)
   real(dp), parameter :: rate(9) = [892.0_dp, 809.0_dp, 823.0_dp, 798.0_dp, 671.0_dp, 644.0_dp, 883.0_dp, 903.0_dp, 677.0_dp]
   type(error_type), allocatable :: error
   type(allan_curve_type) :: modified, time
   integer :: i

   call compute_allan(rate, 1.0_dp, allan_options(kind="mdev", taus="1,2"), modified, error)
   if (.not. allocated(error)) call compute_allan(rate, 1.0_dp, allan_options(kind="tdev", taus="1,2"), time, error)
   if (allocated(error)) error stop error%message
   print "(f4.0, 3f12.5)", (time%tau(i), modified%deviation(i), time%deviation(i), &
                            time%tau(i)*modified%deviation(i)/sqrt(3.0_dp), i=1, 2)
end program example_tdev
