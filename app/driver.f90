! SPDX-License-Identifier: MIT
!> Does what the command line asks for: reads, computes, reports.
!>
!> Nothing is written before everything is computed, and standard output comes last: where something fails it stays empty.
module gyroakf_app_driver
   use, intrinsic :: iso_fortran_env, only : error_unit
   use omp_lib, only : omp_set_num_threads
   use gyroakf_error, only : error_type, fatal_error, exit_code, status
   use gyroakf_io_record_writer, only : write_record
   use gyroakf_io_writer, only : writer_type, open_writer, put, complete_writer, commit_writer, discard_writer
   use gyroakf_pipeline, only : pipeline_result_type, channel_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_document, only : write_document
   use gyroakf_report_files, only : write_results
   use gyroakf_report_kalibr, only : write_kalibr
   use gyroakf_report_text, only : write_report, report_inspect
   use gyroakf_simulate_record, only : simulate_record
   use gyroakf_app_argument, only : argument_list, process_source, read_arguments
   use gyroakf_app_cli, only : get_config
   use gyroakf_app_config, only : cli_config, text_config, inspect_config, analysis_config, simulate_config
   use gyroakf_app_reading, only : read_and_look, read_and_run
   implicit none (type, external)
   private
   public :: run_program

contains

   !> The whole program, from the command line to the exit code.
   subroutine run_program(code)
      !> 0 done, 1 wrong usage, 2 the data or a file, 3 a numerical failure
      integer, intent(out) :: code
      type(argument_list) :: arguments
      class(cli_config), allocatable :: config
      type(error_type), allocatable :: error

      call read_arguments(process_source(), arguments, error)
      if (.not. allocated(error)) call get_config(arguments, config, error)
      if (.not. allocated(error)) call execute(config, error)
      code = 0
      if (.not. allocated(error)) return
      write (error_unit, "(a)") "gyroakf: error: "//error%message
      code = exit_code(error%code)
   end subroutine run_program

   !> The job of one command.
   subroutine execute(config, error)
      class(cli_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error

      if (config%threads > 0) call omp_set_num_threads(config%threads)
      select type (config)
      type is (text_config); call print_text(config%text, error)
      type is (inspect_config); call inspect(config, error)
      type is (analysis_config); call analyse(config, error)
      type is (simulate_config); call simulate(config, error)
      end select
   end subroutine execute

   !> A text on standard output.
   subroutine print_text(text, error)
      character(*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer

      call open_writer(writer, "-", error)
      if (allocated(error)) return
      call put(writer, text)
      call commit_writer(writer, error)
   end subroutine print_text

   !> inspect: what was read.
   subroutine inspect(config, error)
      type(inspect_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(writer_type) :: writer

      call read_and_look(config, record, error)
      if (allocated(error)) return
      if (allocated(config%json)) then
         call begin_document(config%json, record, writer, error)
         if (.not. allocated(error)) call commit_writer(writer, error)
         if (allocated(error) .or. config%json == "-") return
      end if
      if (config%quiet) return
      call open_writer(writer, "-", error)
      if (allocated(error)) return
      call report_inspect(writer, record)
      call commit_writer(writer, error)
   end subroutine inspect

   !> run, allan, tests, ar, filter: the files first, standard output last.
   subroutine analyse(config, error)
      type(analysis_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(writer_type) :: document, kalibr
      character(:), allocatable :: json

      call read_and_run(config, record, result, error)
      if (.not. allocated(error)) call check_result(config, result, error)
      if (allocated(error)) return
      json = ""
      if (allocated(config%json)) json = config%json
      if (json /= "" .and. json /= "-") then
         call begin_document(json, record, document, error, result)
         if (.not. allocated(error)) call complete_writer(document, error)
      end if
      if (.not. allocated(error) .and. allocated(config%kalibr)) call begin_kalibr(config%kalibr, record, result, kalibr, error)
      if (.not. allocated(error) .and. allocated(config%out)) call write_results(config%out, config%command, record, &
                                                                                config%pipeline, result, error)
      if (allocated(error)) then
         call discard_writer(document)
         call discard_writer(kalibr)
         return
      end if
      if (json /= "" .and. json /= "-") call commit_writer(document, error)
      if (.not. allocated(error) .and. allocated(config%kalibr)) call commit_writer(kalibr, error)
      if (.not. allocated(error)) call print_result(config, json == "-", record, result, error)
   end subroutine analyse

   !> Where not one channel gives what the command is for, there is nothing to report: an error of the data.
   subroutine check_result(config, result, error)
      type(analysis_config), intent(in) :: config
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

   !> The JSON document or the command's report on standard output.
   subroutine print_result(config, as_json, record, result, error)
      type(analysis_config), intent(in) :: config
      logical, intent(in) :: as_json
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer

      if (config%quiet .and. .not. as_json) return
      if (as_json) then
         call begin_document("-", record, writer, error, result)
      else
         call open_writer(writer, "-", error)
      end if
      if (allocated(error)) return
      if (.not. as_json) call write_report(writer, config%command, record, config%pipeline, result)
      call commit_writer(writer, error)
   end subroutine print_result

   !> The JSON document in an open writer; without a result it tells what was read.
   subroutine begin_document(path, record, writer, error, result)
      character(*), intent(in) :: path
      type(record_type), intent(in) :: record
      type(writer_type), intent(out) :: writer
      type(error_type), allocatable, intent(out) :: error
      type(pipeline_result_type), intent(in), optional :: result

      call open_writer(writer, path, error)
      if (.not. allocated(error)) call write_document(writer, record, result)
   end subroutine begin_document

   !> Kalibr's file, complete but not yet in its place.
   subroutine begin_kalibr(path, record, result, writer, error)
      character(*), intent(in) :: path
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(writer_type), intent(out) :: writer
      type(error_type), allocatable, intent(out) :: error

      call open_writer(writer, path, error)
      if (.not. allocated(error)) call write_kalibr(writer, record, result, error)
      if (.not. allocated(error)) call complete_writer(writer, error)
   end subroutine begin_kalibr

   !> simulate: a record as a text file.
   subroutine simulate(config, error)
      type(simulate_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(text_type) :: header(1)

      call simulate_record(config%record, record, error)
      if (allocated(error)) then
         if (error%code /= status%no_memory) error%code = status%usage
         return
      end if
      header(1)%text = "made by: "//config%origin
      call write_record(config%output, record, header, config%digits, error)
   end subroutine simulate

end module gyroakf_app_driver
