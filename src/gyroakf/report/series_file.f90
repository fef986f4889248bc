! SPDX-License-Identifier: MIT
!> The series of a recording that goes by in blocks, written while it does.
!>
!>     call open_series_file(file, directory, output, error)
!>     call filter_streamed(recording, options, record, result, error, file)
!>     call complete_writer(file%writer, error)                  ! and commit_writer where all is well, discard_writer where not
module gyroakf_report_series_file
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : make_directory, open_writer, writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_pipeline_series_sink, only : series_sink_type
   use gyroakf_report_csv, only : series_output_type, write_series
   implicit none (type, external)
   private
   public :: series_file_type, open_series_file

   !> A file of series that grows
   type, extends(series_sink_type) :: series_file_type
      type(writer_type) :: writer
      type(series_output_type) :: output
   contains
      procedure :: take
   end type series_file_type

contains

   !> Begins series.csv, series.npy or series.f64.
   subroutine open_series_file(file, directory, output, error)
      !> Its writer is open
      type(series_file_type), intent(out) :: file
      !> Made where it does not exist
      character(*), intent(in) :: directory
      !> Form and digits
      type(series_output_type), intent(in) :: output
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error

      file%output = output
      call make_directory(directory, error)
      if (.not. allocated(error)) call open_writer(file%writer, directory//"/series."//trim(output%form), error)
   end subroutine open_series_file

   !> Writes the next samples.
   subroutine take(self, block, part, before, samples, error)
      !> Open
      class(series_file_type), intent(inout) :: self
      !> As read
      type(record_type), intent(in) :: block
      !> Series of every channel
      type(pipeline_result_type), intent(in) :: part
      !> Samples before these, and all
      integer(int64), intent(in) :: before, samples
      !> no_memory; io where nothing more can be written
      type(error_type), allocatable, intent(out) :: error

      call write_series(self%writer, block, part, self%output, error, before=before, samples=samples)
   end subroutine take

end module gyroakf_report_series_file
