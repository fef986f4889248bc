! SPDX-License-Identifier: MIT
!> The job of one file: reads, computes, writes, reports.
!>
!> Nothing is written before everything is computed, and standard output comes last: where something fails it stays empty.
module gyroakf_app_job
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_writer, only : writer_type, open_writer, complete_writer, commit_writer, discard_writer, &
      & make_directory
   use gyroakf_pipeline, only : pipeline_result_type, channel_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_document, only : write_document
   use gyroakf_report_files, only : remove_others, write_results
   use gyroakf_report_kalibr, only : write_kalibr
   use gyroakf_report_text_report, only : write_report, report_inspect
   use gyroakf_app_config, only : config_type, file_options
   use gyroakf_app_interrupt, only : guard_files, interrupted, release_files
   use gyroakf_app_progress_bar, only : bar_type, clear_bar
   use gyroakf_app_reading, only : read_and_look, read_and_run
   use gyroakf_app_system, only : adapt_writer
   implicit none (type, external)
   private
   public :: inspect, analyze

contains

   !> inspect: what was read.
   subroutine inspect(config, bar, record, error)
      !> What is wanted
      type(config_type), intent(in) :: config
      !> Progress of the run; taken away before the report
      type(bar_type), intent(inout) :: bar
      !> What was read
      type(record_type), intent(out) :: record
      !> As of [[read_record]]; io
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer

      call read_and_look(config, record, error, bar)
      if (allocated(error)) return
      call clear_bar(bar)
      if (config%out /= "") call write_inspection(config%out, record, config%command_line, error)
      if (allocated(error)) return
      if (config%file(1)%text /= "") then
         call begin_document(config%file(1)%text, record, config%command_line, writer, error)
         if (.not. allocated(error)) call commit_writer(writer, error)
         if (allocated(error) .or. config%file(1)%text == "-") return
      end if
      if (config%quiet) return
      call open_writer(writer, "-", error)
      if (allocated(error)) return
      call adapt_writer(writer, config%colour, config%ascii)
      call report_inspect(writer, record)
      call commit_writer(writer, error)
   end subroutine inspect

   !> inspect --out: report.txt and results.json.
   subroutine write_inspection(directory, record, command_line, error)
      character(*), intent(in) :: directory
      type(record_type), intent(in) :: record
      character(*), intent(in) :: command_line
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: report, document
      character(12), parameter :: written(2) = [character(12) :: "report.txt", "results.json"]

      call guard_files()
      call make_directory(directory, error)
      if (.not. allocated(error)) call open_writer(report, directory//"/report.txt", error)
      if (.not. allocated(error)) call report_inspect(report, record)
      if (.not. allocated(error)) call complete_writer(report, error)
      if (.not. allocated(error)) call begin_document(directory//"/results.json", record, command_line, document, error)
      if (.not. allocated(error)) call complete_writer(document, error)
      if (.not. allocated(error)) call remove_others(directory, written)
      if (.not. allocated(error)) call commit_writer(report, error)
      if (.not. allocated(error)) call commit_writer(document, error)
      call discard_writer(report)
      call discard_writer(document)
      call release_files()
   end subroutine write_inspection

   !> run, allan, tests, ar, filter: the files first, standard output last.
   subroutine analyze(config, bar, record, result, error)
      !> What is wanted
      type(config_type), intent(in) :: config
      !> Progress of the run; taken away before the report
      type(bar_type), intent(inout) :: bar
      !> What was read
      type(record_type), intent(out) :: record
      !> What came out
      type(pipeline_result_type), intent(out) :: result
      !> As of [[read_record]] and [[run_pipeline]]; io; cancelled
      type(error_type), allocatable, intent(out) :: error

      call read_and_run(config, record, result, error, bar)
      if (.not. allocated(error)) call check_result(config, result, error)
      if (allocated(error)) return
      call guard_files()
      call write_files(config, bar, record, result, error)
      call release_files()
      call clear_bar(bar)
      if (.not. allocated(error) .and. interrupted()) call fatal_error(error, status%cancelled, "ended; the files are complete")
      if (.not. allocated(error)) call print_result(config, record, result, error)
   end subroutine analyze

   !> The files that options name and the result files: all are complete before the first one appears.
   subroutine write_files(config, bar, record, result, error)
      type(config_type), intent(in) :: config
      type(bar_type), intent(inout) :: bar
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer(size(config%file))
      integer :: i

      if (config%out /= "") call make_directory(config%out, error)
      do i = 1, size(config%file)
         if (allocated(error) .or. any(config%file(i)%text == ["-", " "])) cycle
         call write_kind(i, config, record, result, writer(i), error)
         if (.not. allocated(error)) call complete_writer(writer(i), error)
      end do
      if (.not. allocated(error) .and. config%out /= "") call write_results(config%out, config%command, record, &
         config%pipeline, result, error, config%series, bar, config%command_line, config%chart)
      do i = 1, size(config%file)
         if (allocated(error)) then
            call discard_writer(writer(i))
         else if (writer(i)%complete) then
            call commit_writer(writer(i), error)
         end if
      end do
   end subroutine write_files

   !> The content of a file that an option names, in an open writer.
   subroutine write_kind(kind, config, record, result, writer, error)
      !> Place of the option in [[gyroakf_app_config:file_options]]
      integer, intent(in) :: kind
      type(config_type), intent(in) :: config
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(writer_type), intent(out) :: writer
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, config%file(kind)%text, error)
      if (allocated(error)) return
      select case (file_options(kind))
      case ("--json"); call write_document(writer, record, result, config%command_line)
      case default; call write_kalibr(writer, record, result, error)
      end select
   end subroutine write_kind

   !> Where not one channel gives what the command is for, there is nothing to report: an error of the data.
   subroutine check_result(config, result, error)
      type(config_type), intent(in) :: config
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: reason
      integer :: i

      do i = 1, size(result%channel)
         if (has_result(config%command, result%channel(i))) return
      end do
      reason = "no channel"
      if (size(result%channel) > 0) then
         associate (channel => result%channel(1))
            if (allocated(channel%unavailable)) reason = channel%name//": "//channel%unavailable(1)%text
         end associate
      end if
      call fatal_error(error, status%constant_input, config%path//": nothing can be computed; "//reason)
   end subroutine check_result

   !> Whether a channel gives what the command is for.
   pure logical function has_result(command, channel)
      character(*), intent(in) :: command
      type(channel_result_type), intent(in) :: channel
      logical :: tests, filters

      tests = channel%available%adf .or. channel%available%jarque_bera .or. channel%available%ljung_box
      filters = channel%available%kf .or. channel%available%akf .or. channel%available%drift_kf .or. channel%available%drift_akf
      select case (command)
      case ("allan"); has_result = any(channel%allan%available)
      case ("tests"); has_result = tests
      case ("ar"); has_result = channel%available%ar
      case ("filter"); has_result = filters
      case default; has_result = tests .or. filters .or. channel%available%ar .or. any(channel%allan%fitted)
      end select
   end function has_result

   !> What an option wants on standard output, or the command's report.
   subroutine print_result(config, record, result, error)
      type(config_type), intent(in) :: config
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      integer :: i

      do i = 1, size(config%file)
         if (config%file(i)%text /= "-") cycle
         call write_kind(i, config, record, result, writer, error)
         if (.not. allocated(error)) call commit_writer(writer, error)
         return
      end do
      if (config%quiet) return
      call open_writer(writer, "-", error)
      if (allocated(error)) return
      call adapt_writer(writer, config%colour, config%ascii)
      call write_report(writer, config%command, record, config%pipeline, result, config%chart, config%details)
      call commit_writer(writer, error)
   end subroutine print_result

   !> Begins the JSON document, in an open writer, with what was read.
   subroutine begin_document(path, record, command_line, writer, error)
      character(*), intent(in) :: path
      type(record_type), intent(in) :: record
      character(*), intent(in) :: command_line
      type(writer_type), intent(out) :: writer
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, path, error)
      if (.not. allocated(error)) call write_document(writer, record, command_line=command_line)
   end subroutine begin_document

end module gyroakf_app_job
