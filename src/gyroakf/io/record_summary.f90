! SPDX-License-Identifier: MIT
!> What a recording holds, whatever its size: where it is larger than the memory allows, it goes by in blocks.
module gyroakf_io_record_summary
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type
   use gyroakf_io_reader, only : complete_record
   use gyroakf_io_record_stream, only : begin_record_stream, end_record_stream, next_record_block, record_stream_type
   use gyroakf_io_recording, only : close_recording, hold_rows, open_recording, reader_options, recording_type
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: summarise_record, find_interval

contains

   !> Reads a recording for what it shows: rate, units, gaps, ranges, warnings.
   !>
   !> As [[read_record]] where the samples fit into `options%memory`, and then they are in the record. Where they do not,
   !> `record%streamed` is true, `value` has no rows and `audit%samples` tells how many there were.
   subroutine summarise_record(path, options, record, error, progress)
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> How; without a bound of the memory it is as [[read_record]]
      type(reader_options), intent(in) :: options
      !> What was found
      type(record_type), intent(out) :: record
      !> Allocated on failure: those of [[read_record]], cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: recording

      call open_recording(path, options, recording, error)
      if (.not. allocated(error)) call hold_rows(recording, error, progress)
      if (.not. allocated(error)) then
         if (recording%table%whole) then
            call complete_record(recording, record, error)
         else
            call stream_by(recording, record, error, progress)
         end if
      end if
      call close_recording(recording)
   end subroutine summarise_record

   !> The interval of the whole recording, where a part of it in seconds is wanted and the stamps tell the rate: the first
   !> window's would cut it elsewhere. Takes a pass of its own over a file; a pipe comes only once.
   subroutine find_interval(recording, interval, error, progress)
      !> Open; it is opened a second time
      type(recording_type), intent(in) :: recording
      !> s; 0 where it is not needed or cannot be had
      real(dp), intent(out) :: interval
      !> As of [[summarise_record]]
      type(error_type), allocatable, intent(out) :: error
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: again
      type(reader_options) :: whole
      type(record_type) :: record

      interval = 0.0_dp
      whole = recording%options
      if (recording%table%time == 0 .or. whole%rate_hz > 0.0_dp .or. recording%expected_rows == 0) return
      if (whole%from <= 0.0_dp .and. whole%to >= huge(1.0_dp)) return
      whole%from = 0.0_dp
      whole%to = huge(1.0_dp)
      call open_recording(recording%path, whole, again, error)
      if (.not. allocated(error)) call stream_by(again, record, error, progress)
      call close_recording(again)
      if (.not. allocated(error)) interval = record%sample_interval
   end subroutine find_interval

   !> Lets the rest go by.
   subroutine stream_by(recording, record, error, progress)
      type(recording_type), intent(inout) :: recording
      type(record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(record_stream_type) :: stream
      type(record_type) :: block

      call begin_record_stream(recording, stream)
      do
         call next_record_block(recording, stream, block, error, progress)
         if (allocated(error)) return
         if (stream%done) exit
      end do
      call end_record_stream(recording, stream, record, error)
   end subroutine stream_by

end module gyroakf_io_record_summary
