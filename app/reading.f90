! SPDX-License-Identifier: MIT
!> Reads a recording within the memory that is allowed, and works on it: whole, or in blocks as it goes by.
module gyroakf_app_reading
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, status
   use gyroakf_io_machine_memory, only : free_memory
   use gyroakf_io_reader, only : complete_record, read_record, reader_options
   use gyroakf_io_record_summary, only : summarise_record
   use gyroakf_io_source, only : is_directory
   use gyroakf_io_recording, only : base_bytes, close_recording, hold_rows, open_recording, recording_type
   use gyroakf_io_writer, only : complete_writer, discard_writer, writer_type
   use gyroakf_pipeline, only : check_filter, filter_streamed, pipeline_result_type, run_pipeline, run_streamed, tell_memory
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_report_kalibr, only : check_kalibr
   use gyroakf_report_series_file, only : open_series_file, series_file_type
   use gyroakf_app_config, only : analysis_config, inspect_config
   use gyroakf_app_interrupt, only : guard_files, release_files
   use gyroakf_app_truth, only : read_truth
   implicit none (type, external)
   private
   public :: find_bound, read_and_look, read_and_run, with_path

   !> Share of the memory that can be had which a recording may take
   real(dp), parameter :: usable_share = 0.95_dp
   !> Bytes a sample that a true drift takes: as read, less the trend, an estimate to compare with, the integral for its length
   integer(int64), parameter :: truth_bytes = 40

contains

   !> Where nobody gave a bound of the memory it is what the machine, the container and the shell leave.
   subroutine find_bound(reader)
      !> Its `memory` is set
      type(reader_options), intent(inout) :: reader
      integer(int64) :: bytes

      if (reader%memory > 0) return
      bytes = free_memory()
      if (bytes <= 0) return
      reader%memory = max(2*base_bytes, int(usable_share*real(bytes, dp), int64))
      reader%memory_found = .true.
   end subroutine find_bound

   !> inspect: what was read.
   subroutine read_and_look(config, record, error, progress)
      !> The file and how it is read
      type(inspect_config), intent(in) :: config
      !> What was read
      type(record_type), intent(out) :: record
      !> As of [[read_record]]
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout) :: progress
      type(reader_options) :: reader

      reader = config%reader
      call find_bound(reader)
      if (config%shared) then
         call read_record(config%path, reader, record, error, progress)
      else
         call summarise_record(config%path, reader, record, error, progress)
      end if
   end subroutine read_and_look

   !> run, allan, tests, ar, filter: what was read, and what came out; allan and filter stream what is larger than the memory.
   subroutine read_and_run(config, record, result, error, progress, series)
      !> The file, how it is read and what is computed
      type(analysis_config), intent(in) :: config
      !> What was read
      type(record_type), intent(out) :: record
      !> What came out
      type(pipeline_result_type), intent(out) :: result
      !> As of [[read_record]] and [[run_pipeline]]
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout) :: progress
      !> The file of the series where the recording was filtered block by block: complete but not yet in its place, files guarded
      type(writer_type), intent(inout) :: series
      type(reader_options) :: reader
      type(recording_type) :: recording
      type(record_type) :: truth

      reader = config%reader
      call tell_memory(config%pipeline, reader%work_bytes, reader%channel_bytes, reader%part_bytes, &
                       reader%part_samples)
      if (allocated(config%truth)) then
         reader%work_bytes = reader%work_bytes + truth_bytes
         reader%whole_for = "--truth"
      end if
      call find_bound(reader)
      if ((config%command == "allan" .or. config%command == "filter") .and. &
          .not. (config%shared .or. allocated(config%truth))) then
         call open_recording(config%path, reader, recording, error)
         if (.not. allocated(error)) call hold_rows(recording, error, progress)
         if (allocated(error)) then
            continue
         else if (recording%table%whole) then
            call complete_record(recording, record, error)
         else if (config%command == "allan") then
            call run_streamed(recording, config%pipeline, record, result, error, progress)
         else
            call filter_in_blocks(recording, config, record, result, error, progress, series)
         end if
         call close_recording(recording)
      else
         call read_record(config%path, reader, record, error, progress)
      end if
      if (.not. allocated(error) .and. allocated(config%kalibr)) call check_kalibr(record, error)
      if (allocated(error) .or. record%streamed) return
      if (allocated(config%truth)) then
         call read_truth(config, record, truth, error, progress)
         if (.not. allocated(error)) call run_pipeline(record, config%pipeline, result, error, progress, truth)
      else
         call run_pipeline(record, config%pipeline, result, error, progress)
      end if
      if (.not. allocated(error)) return
      if (error%code == status%too_few_samples) error%message = with_path(config%path, error%message)
   end subroutine read_and_run

   !> Filters what is larger than the memory, and writes the series with --out while they go by.
   subroutine filter_in_blocks(recording, config, record, result, error, progress, series)
      type(recording_type), intent(inout) :: recording
      type(analysis_config), intent(in) :: config
      type(record_type), intent(out) :: record
      type(pipeline_result_type), intent(out) :: result
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout) :: progress
      type(writer_type), intent(inout) :: series
      type(series_file_type) :: file
      character(:), allocatable :: scratch

      call check_filter(recording, config%pipeline, error)
      if (allocated(error)) return
      call find_scratch(config, scratch)
      if (.not. allocated(config%out)) then
         call filter_streamed(recording, config%pipeline, record, result, error, progress=progress, scratch=scratch)
         return
      end if
      call guard_files()
      call open_series_file(file, config%out, config%series, error)
      if (.not. allocated(error)) call filter_streamed(recording, config%pipeline, record, result, error, file, progress, &
                                                         scratch)
      if (.not. allocated(error)) call complete_writer(file%writer, error)
      if (allocated(error)) call discard_writer(file%writer)
      if (allocated(error)) call release_files()
      if (.not. allocated(error)) series = file%writer
   end subroutine filter_in_blocks

   !> Where a scratch file goes: TMPDIR, the directory of the results, /var/tmp (which is on a disk where /tmp may not be), /tmp.
   subroutine find_scratch(config, directory)
      type(analysis_config), intent(in) :: config
      character(:), allocatable, intent(out) :: directory
      integer :: length

      call get_environment_variable("TMPDIR", length=length)
      if (length > 0) then
         allocate (character(length) :: directory)
         call get_environment_variable("TMPDIR", directory)
      else if (allocated(config%out)) then
         directory = config%out
      else if (is_directory("/var/tmp")) then
         directory = "/var/tmp"
      else
         directory = "/tmp"
      end if
   end subroutine find_scratch

   !> A message that names the file.
   pure function with_path(path, message) result(text)
      character(*), intent(in) :: path, message
      character(:), allocatable :: text

      text = path
      if (path == "-") text = "<stdin>"
      if (index(message, text) == 1) then
         text = message
      else
         text = text//": "//message
      end if
   end function with_path

end module gyroakf_app_reading
