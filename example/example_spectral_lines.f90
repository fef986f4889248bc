! SPDX-License-Identifier: MIT
!> A vibration of 0.5 at 12.3 Hz in correlated noise, found with its amplitude and the probability of a false alarm.
program example_spectral_lines
   implicit none (type, external)

   call find_vibration()

contains

   subroutine find_vibration()
      use gyroakf, only : dp, int64, error_type, random_type, seed_random, fill_normal, periodicity_options, periodicity_type, &
         analyse_periodicity
      integer, parameter :: n = 20000
      real(dp), parameter :: rate = 100.0_dp, turn = 6.283185307179586_dp
      type(random_type) :: random
      type(periodicity_type) :: result
      type(error_type), allocatable :: error
      real(dp) :: x(n)
      integer :: i

      call seed_random(random, 1_int64)
      call fill_normal(random, x)
      do i = 2, n
         x(i) = x(i) + 0.9_dp*x(i - 1)
      end do
      x = x + [(0.5_dp*sin(turn*12.3_dp*i/rate), i=0, n - 1)]
      call analyse_periodicity(x, 1/rate, periodicity_options(), result, error)
      if (allocated(error)) error stop error%message
      print "(i0, a)", size(result%line), " line"
      print "(a, f0.2, a, l1)", "frequency ", result%line(1)%frequency, " Hz, a false alarm below 1e-9: ", &
         result%line(1)%log_p_value < log(1.0e-9_dp)
      print "(a, l1)", "amplitude right within four standard errors: ", &
         abs(result%line(1)%amplitude - 0.5_dp) < 4*result%line(1)%amplitude_error
   end subroutine find_vibration

end program example_spectral_lines
