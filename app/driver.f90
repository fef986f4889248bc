! SPDX-License-Identifier: MIT
!> Does what the command line asks for: reads, computes, reports.
module gyroakf_app_driver
   use, intrinsic :: iso_fortran_env, only : error_unit, output_unit
   use gyroakf_error, only : error_type, exit_code
   use gyroakf_app_argument, only : argument_list, process_source, read_arguments
   use gyroakf_app_cli, only : get_config
   use gyroakf_app_config, only : cli_config, text_config
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

      select type (config)
      type is (text_config)
         write (output_unit, "(a)", advance="no") config%text
      end select
   end subroutine execute

end module gyroakf_app_driver
