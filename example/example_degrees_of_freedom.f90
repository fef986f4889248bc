! SPDX-License-Identifier: MIT
!> Degrees of freedom of an Allan deviation by noise type and statistic, and the confidence limits that follow from them.
!>
!> The values for 1001 phases, m = 10: 135.07 (white rate noise), 114.67 (flicker), 91.04 (random walk).
program example_degrees_of_freedom
   use gyroakf, only : dp, int64, greenhall_edf, statistic_edf, statistic_names, chi_square_limits
   implicit none (type, external)
   integer(int64), parameter :: phases = 1001, m = 10
   real(dp) :: lower, upper
   integer :: alpha, i

   do alpha = 0, -2, -1
      print "(a, i3, f9.2)", "alpha", alpha, greenhall_edf(phases, m, alpha, difference=2, modified=.false., overlapped=.true.)
   end do
   do i = 1, size(statistic_names)
      print "(a, f9.2)", statistic_names(i), statistic_edf(statistic_names(i), phases, m, 0)
   end do
   call chi_square_limits(1.0_dp, statistic_edf("oadev", phases, m, 0), 0.95_dp, lower, upper)
   print "(a, 2f8.4)", "95 % limits of a deviation of 1:", lower, upper
end program example_degrees_of_freedom
