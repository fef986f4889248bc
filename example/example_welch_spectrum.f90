! SPDX-License-Identifier: MIT
!> White noise of variance 4 at 50 Hz: its two-sided density is 4/50, its one-sided density twice that.
program example_welch_spectrum
   implicit none (type, external)

   call spectrum_of_noise()

contains

   subroutine spectrum_of_noise()
      use gyroakf, only : dp, int64, error_type, random_type, seed_random, fill_normal, welch_options, welch_type, welch_spectrum
      type(random_type) :: random
      type(welch_type) :: spectrum
      type(error_type), allocatable :: error
      real(dp) :: x(50000)

      call seed_random(random, 1_int64)
      call fill_normal(random, x)
      call welch_spectrum(2*x, 1/50.0_dp, welch_options(segment=500), spectrum, error)
      if (allocated(error)) error stop error%message
      print "(i0, a, f0.1, a)", spectrum%used, " segments, a value every ", spectrum%resolution, " Hz"
      print "(a, f5.3)", "mean of the two-sided density: ", sum(spectrum%density(1:249))/249
      print "(a, f5.3)", "mean of the one-sided density: ", sum(spectrum%one_sided(1:249))/249
   end subroutine spectrum_of_noise

end program example_welch_spectrum
