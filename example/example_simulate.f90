! SPDX-License-Identifier: MIT
!> Ten minutes of a gyroscope at 100 Hz with known noise, rounded as its output would be.
program example_simulate
   implicit none (type, external)

   call simulate()

contains

   subroutine simulate()
      use gyroakf, only : error_type, record_type, simulate_options, simulate_record
      type(simulate_options) :: options
      type(record_type) :: record
      type(error_type), allocatable :: error

      options%samples = 60000
      options%rate_hz = 100
      options%seed = 7
      options%unit = "deg/h"
      options%coefficient = [0.0d0, 18.0d0, 6.0d0, 0.1d0, 0.0d0]    ! Q N B K R, in deg/h and seconds
      options%lsb = 0.5d0
      call simulate_record(options, record, error)
      if (allocated(error)) error stop error%message
      print "(i0, a, f4.2, a)", record%audit%samples, " samples of ", record%sample_interval, " s in "//record%unit%name
      print "(*(f0.1, :, 1x))", record%value(:10, 1)
   end subroutine simulate

end program example_simulate
