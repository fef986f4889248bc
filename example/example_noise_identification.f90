! SPDX-License-Identifier: MIT
!> Which power law comes nearest at each averaging time: 2 quantization, 0 white, -1 flicker, -2 random walk.
program example_noise_identification
   implicit none (type, external)

   call identify()

contains

   subroutine identify()
      use gyroakf, only : dp, int32, int64, error_type, record_type, simulate_options, simulate_record, integrate_rate, &
         identify_noise
      integer(int64), parameter :: m(5) = [1_int64, 10_int64, 100_int64, 1000_int64, 3000_int64]
      type(error_type), allocatable :: error
      type(simulate_options) :: noise
      type(record_type) :: record
      real(dp), allocatable :: phase(:)
      integer(int32), allocatable :: missing(:)
      integer :: alpha(5), i

      noise%samples = 200000
      noise%rate_hz = 100
      noise%coefficient([1, 2, 4]) = [3.0e-4_dp, 1.0e-3_dp, 1.0e-4_dp]
      call simulate_record(noise, record, error)
      if (.not. allocated(error)) call integrate_rate(record%value(:, 1), phase, missing, error)
      if (allocated(error)) error stop error%message
      call identify_noise(phase, m, 0.9_dp, alpha, error)
      print "(a, f7.2, a, i3)", ("tau", m(i)*record%sample_interval, " s: alpha", alpha(i), i=1, 5)
   end subroutine identify

end program example_noise_identification
