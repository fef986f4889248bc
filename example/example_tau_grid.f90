! SPDX-License-Identifier: MIT
!> Averaging factors of every kind of grid, for a record of 1000 samples at 10 Hz.
program example_tau_grid
   implicit none (type, external)

   call show("octave")
   call show("decade")
   call show("log:4")
   call show("0.1,1,7.3,20")

contains

   subroutine show(taus)
      use gyroakf, only : dp, int64, error_type, averaging_factors
      character(*), intent(in) :: taus
      type(error_type), allocatable :: error
      integer(int64), allocatable :: m(:)

      call averaging_factors(taus, 1000_int64, 0.1_dp, m, error)
      if (allocated(error)) error stop error%message
      print "(a, *(1x, i0))", taus//":", m
   end subroutine show

end program example_tau_grid
