! SPDX-License-Identifier: MIT
!> A Kalman filter sample by sample, as in a control loop: no allocation after new_filter.
program example_kalman_filter
   use gyroakf, only : dp, error_type, reader_options, read_record, record_type, filter_options, filter_type, new_filter, &
      step_filter
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(filter_type) :: filter
   real(dp) :: x
   integer :: i

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   ! AR(1), the variances of its driving noise and of the measurement noise in (deg/s)**2
   if (.not. allocated(error)) call new_filter(filter, [0.41_dp], 4.36e-4_dp, 5.24e-4_dp, filter_options(), error)
   if (allocated(error)) error stop error%message
   do i = 1, 20
      call step_filter(filter, record%value(i, 1), x)
      print "(i4, 2f12.6, f9.5)", i, record%value(i, 1), x, filter%gain(1)
   end do
end program example_kalman_filter
