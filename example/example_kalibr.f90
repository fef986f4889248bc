! SPDX-License-Identifier: MIT
!> Kalibr's imu.yaml of three simulated axes, on standard output.
program example_kalibr
   implicit none (type, external)

   call kalibr()

contains

   subroutine kalibr()
      use gyroakf, only : dp, int64, error_type, record_type, simulate_options, simulate_record, pipeline_options, &
         pipeline_result_type, run_pipeline, writer_type, open_writer, commit_writer, write_kalibr
      type(error_type), allocatable :: error
      type(simulate_options) :: noise
      type(record_type) :: record, axis
      type(pipeline_options) :: options
      type(pipeline_result_type) :: result
      type(writer_type) :: writer
      character(2), parameter :: name(3) = ["gx", "gy", "gz"]
      integer :: i

      noise%samples = 20000
      noise%rate_hz = 100
      noise%unit = "rad/s"
      noise%coefficient([2, 4]) = [2.0e-4_dp, 1.0e-4_dp]
      do i = 1, 3
         noise%seed = i
         call simulate_record(noise, axis, error)
         if (allocated(error)) error stop error%message
         if (i == 1) record = axis
         if (i == 1) deallocate (record%value, record%channel)
         if (i == 1) allocate (record%value(noise%samples, 3), record%channel(3))
         record%value(:, i) = axis%value(:, 1)
         record%channel(i)%text = name(i)
      end do
      record%path = "(simulated)"
      options%do_tests = .false.
      options%do_ar = .false.
      options%do_filter = .false.
      call run_pipeline(record, options, result, error)
      if (.not. allocated(error)) call open_writer(writer, "-", error)
      if (.not. allocated(error)) call write_kalibr(writer, record, result, error)
      if (.not. allocated(error)) call commit_writer(writer, error)
      if (allocated(error)) error stop error%message
   end subroutine kalibr

end program example_kalibr
