! SPDX-License-Identifier: MIT
!> The job of one file: reads, computes, writes, reports.
!>
!> Nothing is written before everything is computed, and standard output comes last: where something
!> fails it stays empty.
module gyroakf_app_job
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_writer, only : writer_type, open_writer, complete_writer, commit_writer, &
      & make_directory
   use gyroakf_pipeline, only : pipeline_result_type, channel_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_document, only : write_document
   use gyroakf_report_files, only : remove_others, write_results
   use gyroakf_report_kalibr, only : write_kalibr
   use gyroakf_report_text_report, only : write_report, report_inspect
   use gyroakf_app_config, only : config_type, file_options
   use gyroakf_app_progress_bar, only : bar_type, clear_bar
   use gyroakf_app_reading, only : read_and_run
   use gyroakf_app_system, only : end_writers, guard_files, interrupted, open_report
   implicit none (type, external)
   private
   public :: do_job

contains

   !> inspect, run, allan, tests, ar, filter: the files first, standard output last.
   subroutine do_job(config, bar, record, result, error)
      !> What is wanted
      type(config_type), intent(in) :: config
      !> Progress of the run; taken away before the report
      type(bar_type), intent(inout) :: bar
      !> What was read
      type(record_type), intent(out) :: record
      !> What came out; nothing of inspect
      type(pipeline_result_type), intent(out) :: result
      !> As of [[read_record]] and [[run_pipeline]]; io; cancelled
      type(error_type), allocatable, intent(out) :: error

      call read_and_run(config, record, result, error, bar)
      if (.not. allocated(error) .and. config%command /= "inspect") then
         call check_result(config, result, error)
      end if
      if (allocated(error)) return
      call guard_files(.true.)
      call write_files(config, bar, record, result, error)
      call guard_files(.false.)
      call clear_bar(bar)
      if (.not. allocated(error) .and. interrupted()) then
         call fatal_error(error, status%cancelled, "ended; the files are complete")
      end if
      if (.not. allocated(error)) call print_result(config, record, result, error)
   end subroutine do_job

   !> The files that options name and the result files: all are complete before the first one
   !> appears. Those of inspect --out are report.txt and results.json.
   subroutine write_files(config, bar, record, result, error)
      type(config_type), intent(in) :: config
      type(bar_type), intent(inout) :: bar
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: written(2) = [character(12) :: "report.txt", "results.json"]
      type(writer_type) :: writer(size(config%file) + 2)
      integer :: i

      if (config%out /= "") call make_directory(config%out, error)
      do i = 1, size(config%file)
         if (config%file(i)%text /= "-") call write_aside(file_options(i), config%file(i)%text, i)
      end do
      if (config%command == "inspect" .and. config%out /= "") then
         do i = 1, 2
            call write_aside(written(i), config%out//"/"//trim(written(i)), size(config%file) + i)
         end do
         if (.not. allocated(error)) call remove_others(config%out, written)
      else if (.not. allocated(error) .and. config%out /= "") then
         call write_results(config%out, config%command, record, config%pipeline, result, &
            & error, config%series, bar, config%command_line, config%chart)
      end if
      call end_writers(writer, error)

   contains

      subroutine write_aside(kind, path, i)
         character(*), intent(in) :: kind, path
         integer, intent(in) :: i

         if (allocated(error) .or. path == "") return
         call write_kind(kind, path, config, record, result, writer(i), error)
         if (.not. allocated(error)) call complete_writer(writer(i), error)
      end subroutine write_aside

   end subroutine write_files

   !> The content of a file in an open writer.
   subroutine write_kind(kind, path, config, record, result, writer, error)
      !> An option of [[gyroakf_app_config:file_options]], or the name of the file
      character(*), intent(in) :: kind
      character(*), intent(in) :: path
      type(config_type), intent(in) :: config
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(writer_type), intent(out) :: writer
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, path, error)
      if (allocated(error)) return
      if (kind == "--kalibr") then
         call write_kalibr(writer, record, result, error)
      else if (kind == "report.txt") then
         call report_inspect(writer, record)
      else if (config%command == "inspect") then
         call write_document(writer, record, command_line=config%command_line)
      else
         call write_document(writer, record, result, config%command_line)
      end if
   end subroutine write_kind

   !> Where not one channel gives what the command is for, there is nothing to report: an error of
   !> the data.
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
            if (allocated(channel%unavailable)) then
               reason = channel%name//": "//channel%unavailable(1)%text
            end if
         end associate
      end if
      call fatal_error(error, status%constant_input, &
         & config%path//": nothing can be computed; "//reason)
   end subroutine check_result

   !> Whether a channel gives what the command is for.
   pure logical function has_result(command, channel)
      character(*), intent(in) :: command
      type(channel_result_type), intent(in) :: channel
      logical :: tests, filters

      tests = channel%available%adf .or. channel%available%jarque_bera .or. &
         & channel%available%ljung_box
      filters = channel%available%kf .or. channel%available%akf .or. &
         & channel%available%drift_kf .or. channel%available%drift_akf
      select case (command)
      case ("allan"); has_result = any(channel%allan%available)
      case ("tests"); has_result = tests
      case ("ar"); has_result = channel%available%ar
      case ("filter"); has_result = filters
      case default
         has_result = tests .or. filters .or. channel%available%ar .or. any(channel%allan%fitted)
      end select
   end function has_result

   !> What an option wants on standard output, or the command's report.
   subroutine print_result(config, record, result, error)
      type(config_type), intent(in) :: config
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer

      if (config%file(1)%text == "-") then
         call write_kind(file_options(1), "-", config, record, result, writer, error)
         if (.not. allocated(error)) call commit_writer(writer, error)
         return
      end if
      if (config%quiet) return
      call open_report(writer, config%color, config%ascii, error)
      if (allocated(error)) return
      if (config%command == "inspect") then
         call report_inspect(writer, record)
      else
         call write_report(writer, config%command, record, config%pipeline, result, config%chart, &
            & config%details)
      end if
      call commit_writer(writer, error)
   end subroutine print_result

end module gyroakf_app_job
