! SPDX-License-Identifier: MIT
!> A recording of any length in blocks that are not kept: its moments, as a caller of the library would sum anything else.
program example_record_blocks
   use gyroakf, only : error_type, reader_options, recording_type, open_recording, close_recording, record_type, &
      record_stream_type, begin_record_stream, next_record_block, end_record_stream, moments_type, compute_moments, join_moments
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(recording_type) :: recording
   type(record_stream_type) :: stream
   type(record_type) :: block, record
   type(moments_type) :: moments, part

   call open_recording("example/data/mems_gyro_x.txt", reader_options(), recording, error)
   if (allocated(error)) error stop error%message
   call begin_record_stream(recording, stream)
   do
      call next_record_block(recording, stream, block, error)
      if (allocated(error)) error stop error%message
      if (stream%done) exit
      if (size(block%value, 1) == 0) cycle
      call compute_moments(block%value(:, 1), part)              ! block%present(:, 1) behind it where samples are missing
      call join_moments(moments, part)
   end do
   call end_record_stream(recording, stream, record, error)      ! rate, unit, gaps, ranges, warnings
   call close_recording(recording)
   if (allocated(error)) error stop error%message
   print "(i0, a, f0.1, 3a, es12.4, a, es12.4)", record%audit%samples, " samples at ", 1/record%sample_interval, " Hz, ", &
      record%unit%name, ": mean", moments%mean, ", variance", moments%variance
end program example_record_blocks
