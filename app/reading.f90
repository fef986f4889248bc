! SPDX-License-Identifier: MIT
!> Reads a recording within the memory that is allowed, and runs the analysis on it.
module gyroakf_app_reading
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_machine_memory, only : free_memory
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : complete_record, read_record, reader_options
   use gyroakf_io_recording, only : base_bytes, bytes_needed, close_recording, hold_rows, &
      open_recording, recording_type, rows_within, say_too_large
   use gyroakf_pipeline, only : check_truth, estimate_memory, pipeline_result_type, run_pipeline
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_report_kalibr, only : check_kalibr
   use gyroakf_app_config, only : config_type, new_config
   use gyroakf_app_option, only : name_options_in
   use gyroakf_app_remedy, only : add_remedies
   use gyroakf_app_words, only : shell_word
   implicit none (type, external)
   private
   public :: read_and_run, with_path

   !> Share of the memory that can be had which a recording may take
   real(dp), parameter :: usable_share = 0.95_dp
   !> Bytes a sample that a true drift takes, with its marks
   integer(int64), parameter :: truth_bytes = 9, megabyte = 1000000

contains

   !> What was read, and but for inspect what came out.
   subroutine read_and_run(config, record, result, error, progress)
      !> The file, how it is read and what is computed
      type(config_type), intent(in) :: config
      !> What was read
      type(record_type), intent(out) :: record
      !> What came out
      type(pipeline_result_type), intent(out) :: result
      !> As of [[read_record]] and [[run_pipeline]]
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback; may cancel
      class(progress_type), intent(inout) :: progress
      type(reader_options) :: reader
      type(record_type) :: truth
      integer(int64) :: bytes
      integer :: i

      reader = config%reader
      reader%survey = config%command == "inspect"
      if (.not. reader%survey) call estimate_memory(config%pipeline, reader)
      if (config%truth /= "") reader%work_bytes = reader%work_bytes + truth_bytes
      if (reader%memory <= 0) then            ! what the machine, the container and the shell leave
         bytes = free_memory()
         reader%memory_found = bytes > 0
         if (bytes > 0) reader%memory = max(2*base_bytes, int(usable_share*real(bytes, dp), int64))
      end if
      call read_within(config, reader, record, error, progress)
      call name_options_in(record%warnings)
      if (.not. allocated(error) .and. config%file(2)%text /= "") call check_kalibr(record, error)
      if (allocated(error) .or. reader%survey) return
      if (config%truth /= "") then
         call read_truth(config, record, truth, error, progress)
         if (.not. allocated(error)) then
            call run_pipeline(record, config%pipeline, result, error, progress, truth)
         end if
      else
         call run_pipeline(record, config%pipeline, result, error, progress)
      end if
      if (allocated(result%channel)) then
         do i = 1, size(result%channel)
            call name_options_in(result%channel(i)%warnings)
            call name_options_in(result%channel(i)%unavailable)
         end do
      end if
      if (.not. allocated(error)) return
      if (error%code == status%too_few_samples) then
         error%message = with_path(config%path, error%message)
      end if
   end subroutine read_and_run

   !> Reads the true drift and checks that it fits the record.
   !>
   !> It is on the record's grid: --rate, --dt, --from and --to hold for it too. Its unit is that of
   !> its header, else the record's.
   subroutine read_truth(config, record, truth, error, progress)
      type(config_type), intent(in) :: config
      type(record_type), intent(in) :: record
      type(record_type), intent(out) :: truth
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout) :: progress
      type(reader_options) :: reader

      reader%rate_hz = config%reader%rate_hz
      reader%from = config%reader%from
      reader%to = config%reader%to
      reader%memory = config%reader%memory
      call read_record(config%truth, reader, truth, error, progress)
      if (.not. allocated(error)) call check_truth(truth, record, error)
      if (.not. allocated(error)) return
      if (error%code == status%invalid_argument) error%message = config%truth//": "//error%message
   end subroutine read_truth

   !> Reads a recording; one that does not fit into the memory is refused with the options that make
   !> it fit.
   subroutine read_within(config, reader, record, error, progress)
      type(config_type), intent(in) :: config
      !> With the memory and what the command needs of it
      type(reader_options), intent(in) :: reader
      type(record_type), intent(out) :: record
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout) :: progress
      type(recording_type) :: recording
      character(:), allocatable :: text, ways

      call open_recording(config%path, reader, recording, error)
      if (.not. allocated(error)) call hold_rows(recording, error, progress)
      call close_recording(recording)
      if (allocated(error)) then
         if (error%code == status%parse) call add_remedies(recording, error)
      else if (recording%table%whole) then
         call complete_record(recording, record, error, progress)
      else
         call say_too_large(recording, text)
         call list_ways(config, recording, ways)
         call fatal_error(error, status%no_memory, text//new_line("a")//ways)
      end if
   end subroutine read_within

   !> "what fits: --column 2; gyroakf allan FILE; --to 5000; --memory 63MB"; of a pipe, whose size
   !> is not known, what needs less.
   subroutine list_ways(config, recording, text)
      type(config_type), intent(in) :: config
      type(recording_type), intent(in) :: recording
      character(:), allocatable, intent(out) :: text
      type(config_type) :: allan
      type(reader_options) :: less
      real(dp) :: rate
      integer(int64) :: rows
      logical :: known, one_unit

      known = recording%expected_rows > 0
      one_unit = .true.
      if (allocated(recording%options%unit)) one_unit = index(recording%options%unit, ",") == 0
      rows = max(recording%expected_rows, recording%table%rows)
      text = trim(merge("what fits:      ", "what needs less:", known))
      less = recording%options
      if (size(recording%table%chosen) > merge(2, 1, recording%table%with_first) .and. &
         & one_unit) then
         call add_if_fits("--column "//integer_text(int(recording%table%chosen(1), int64)), 1)
      end if
      if (less%channel_bytes > 0) then
         less%channel_bytes = 0
         call add_if_fits("without --out")
      end if
      if (config%command == "run" .or. config%command == "filter") then
         call new_config("allan", allan)
         call estimate_memory(allan%pipeline, less)
         call add_if_fits("gyroakf allan "//shell_word(config%path)//config%input_options)
      end if
      rate = recording%options%rate_hz
      if (.not. rate > 0.0_dp) rate = recording%table%header%rate_hz
      if (recording%table%time == 0 .and. rate > 0.0_dp) then
         rate = real(rows_within(recording, recording%options) - 3, dp)/rate
         if (rate >= max(0.0_dp, recording%options%from) + 1.0_dp) then
            call add("--to "//integer_text(int(rate, int64)))
         end if
      end if
      if (known) then
         call add("--memory "//integer_text(bytes_needed(recording, rows, recording%options)/ &
            & megabyte + 1)//"MB")
      else
         call add("or allow more with --memory SIZE")
      end if

   contains

      subroutine add_if_fits(way, channels)
         character(*), intent(in) :: way
         integer, intent(in), optional :: channels

         if (known) then
            if (rows_within(recording, less, channels) < rows) return
         end if
         call add(way)
      end subroutine add_if_fits

      subroutine add(way)
         character(*), intent(in) :: way

         text = text//trim(merge(" ", ";", text(len(text):) == ":"))//" "//way
      end subroutine add
   end subroutine list_ways

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
