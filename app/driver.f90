! SPDX-License-Identifier: MIT
!> Does what the command line asks for: reads, computes, reports.
!>
!> Nothing is written before everything is computed, and standard output comes last: where something
!> fails it stays empty.
module gyroakf_app_driver
   use, intrinsic :: iso_fortran_env, only : error_unit
   use gyroakf_threads, only : set_thread_count
   use gyroakf_utf8, only : make_readable
   use gyroakf_error, only : error_type, exit_code, fatal_error, status
   use gyroakf_io_columns_writer, only : write_record
   use gyroakf_io_writer, only : writer_type, open_writer, put, commit_writer
   use gyroakf_pipeline, only : pipeline_result_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_report_selftest_report, only : report_selftest, selftest_sum
   use gyroakf_selftest, only : run_selftest, selftest_type
   use gyroakf_simulate_simulate_record, only : simulate_record
   use gyroakf_app_check, only : check_existing
   use gyroakf_app_cli, only : get_config
   use gyroakf_app_config, only : config_type, has_many_files
   use gyroakf_app_help, only : usage_text
   use gyroakf_app_job, only : do_job
   use gyroakf_app_many, only : work_on_many
   use gyroakf_app_option, only : name_options
   use gyroakf_app_progress_bar, only : bar_type, clear_bar, start_bar
   use gyroakf_app_system, only : guard_files, interrupt_signal, watch_signals
   use gyroakf_app_words, only : read_arguments
   implicit none (type, external)
   private
   public :: run_program

contains

   !> The whole program, from the command line to the exit code.
   subroutine run_program(code)
      !> 0 done, 1 wrong usage, 2 the data or a file, 3 a numerical failure, 128 and the signal's
      !> number
      integer, intent(out) :: code
      type(text_type), allocatable :: arguments(:)
      type(config_type) :: config
      type(error_type), allocatable :: error

      call watch_signals()
      call read_arguments(arguments)
      if (size(arguments) == 0) then
         write (error_unit, "(a)") usage_text()
         code = exit_code(status%usage)
         return
      end if
      code = 0
      call get_config(arguments, config, error)
      if (.not. allocated(error)) call execute(config, code, error)
      if (.not. allocated(error)) return
      call name_options(error%message)
      call make_readable(error%message, lines=.true.)
      write (error_unit, "(a)") "gyroakf: error: "//error%message
      code = exit_code(error%code)
      if (error%code /= status%cancelled .or. interrupt_signal() == 0) return
      code = 128 + interrupt_signal()
   end subroutine run_program

   subroutine execute(config, code, error)
      type(config_type), intent(in) :: config
      integer, intent(out) :: code
      type(error_type), allocatable, intent(out) :: error
      type(bar_type) :: bar
      type(record_type) :: record
      type(pipeline_result_type) :: result

      code = 0
      call check_existing(config, error)
      if (allocated(error)) return
      if (config%options_file /= "") then
         call write_text(config%options_file, config%options_text, error)
         if (allocated(error)) return
      end if
      if (config%threads > 0) call set_thread_count(config%threads)
      call start_bar(bar, config%progress)
      if (has_many_files(config)) then
         call work_on_many(config, bar, code, error)
         return
      end if
      select case (config%command)
      case ("help"); call write_text("-", config%text, error)
      case ("simulate"); call simulate(config, bar, error)
      case ("selftest"); call test_itself(config, error)
      case default; call do_job(config, bar, record, result, error)
      end select
      call clear_bar(bar)
   end subroutine execute

   subroutine write_text(path, text, error)
      character(*), intent(in) :: path, text
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer

      call open_writer(writer, path, error)
      if (allocated(error)) return
      call put(writer, text)
      call commit_writer(writer, error)
   end subroutine write_text

   !> simulate: a record as a text file.
   subroutine simulate(config, bar, error)
      type(config_type), intent(in) :: config
      type(bar_type), intent(inout) :: bar
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record, truth
      type(text_type) :: header(1)

      if (config%truth /= "") then
         call simulate_record(config%record, record, error, truth)
      else
         call simulate_record(config%record, record, error)
      end if
      if (allocated(error)) then
         if (error%code /= status%no_memory) error%code = status%usage
         return
      end if
      call guard_files(config%output /= "-" .or. config%truth /= "")
      if (config%truth /= "") then
         header(1)%text = "the true drift of: "//config%origin
         call write_record(config%truth, truth, header, config%series%digits, error, bar)
         if (allocated(error)) return
      end if
      header(1)%text = "made by: "//config%origin
      call write_record(config%output, record, header, config%series%digits, error, bar)
   end subroutine simulate

   !> selftest: the table; where a check failed the exit code is that of a numerical failure.
   subroutine test_itself(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(writer_type) :: writer

      call run_selftest(result)
      if (.not. config%quiet) then
         call open_writer(writer, "-", error)
         if (allocated(error)) return
         call report_selftest(writer, result)
         call commit_writer(writer, error)
         if (allocated(error)) return
      end if
      if (result%failed > 0) call fatal_error(error, status%internal, "selftest: "// &
         selftest_sum(result)//"; do not use the results of this build on this machine")
   end subroutine test_itself

end module gyroakf_app_driver
