! SPDX-License-Identifier: MIT
!> The main job: from a file to the report, as `gyroakf FILE` does it.
program example_whole_job
   use gyroakf, only : error_type, reader_options, read_record, record_type, pipeline_options, pipeline_result_type, &
      run_pipeline, writer_type, open_writer, commit_writer, write_report
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(pipeline_result_type) :: result
   type(writer_type) :: writer

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   if (allocated(error)) error stop error%message
   call run_pipeline(record, pipeline_options(), result, error)
   if (allocated(error)) error stop error%message
   call open_writer(writer, "-", error)                     ! standard output
   call write_report(writer, "run", record, pipeline_options(), result)
   call commit_writer(writer, error)
end program example_whole_job
