! SPDX-License-Identifier: MIT
!> What a command line asks for: one type for every kind of command, filled by [[gyroakf_app_cli]].
module gyroakf_app_config
   use gyroakf_io_reader, only : reader_options
   use gyroakf_pipeline, only : pipeline_options
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : series_output_type
   use gyroakf_simulate_simulate_record, only : simulate_options
   implicit none (type, external)
   private
   public :: cli_config, text_config, reading_config, inspect_config, analysis_config, simulate_config, selftest_config
   public :: new_config, has_many_files

   !> Common to all commands
   type, abstract :: cli_config
      !> Name of the command
      character(:), allocatable :: command
      !> Number of threads, 0: as many as there are
      integer :: threads = 0
      !> No report on standard output
      logical :: quiet = .false.
      !> When a bar is drawn: "auto", "on", "off"
      character(4) :: progress = "auto"
      !> Files that are there already are overwritten
      logical :: force = .false.
      !> File that gets the options, and what is written into it; unallocated: none
      character(:), allocatable :: options_file, options_text
   end type cli_config

   !> `--help`, `--version`, `--citation`
   type, extends(cli_config) :: text_config
      !> What is printed
      character(:), allocatable :: text
   end type text_config

   !> Every command that reads a recording
   type, extends(cli_config), abstract :: reading_config
      !> The recording, "-" is standard input
      character(:), allocatable :: path
      !> How it is read
      type(reader_options) :: reader
      !> File of the JSON document, "-" is standard output; unallocated: none
      character(:), allocatable :: json
      !> Directory of the result files; unallocated: none
      character(:), allocatable :: out
      !> Colours of the report: "auto", "always", "never"; no signs beyond ASCII in it
      character(6) :: colour = "auto"
      logical :: ascii = .false.
      !> Further recordings, `path` first, and the file that names more; unallocated: none
      type(text_type), allocatable :: paths(:)
      character(:), allocatable :: list
      !> As it was typed, and the part of it that says how the recording is read
      character(:), allocatable :: command_line, input_options
   end type reading_config

   !> inspect
   type, extends(reading_config) :: inspect_config
   end type inspect_config

   !> run, allan, tests, ar, filter
   type, extends(reading_config) :: analysis_config
      !> What is computed and how
      type(pipeline_options) :: pipeline
      !> How the series are written into `out`
      type(series_output_type) :: series
      !> Files of Kalibr's imu.yaml and of the tables in LaTeX ("-" is standard output); unallocated: none
      character(:), allocatable :: kalibr, latex
      !> Draw the Allan deviation in characters
      logical :: chart = .true.
      !> The report has everything, not the first screen alone
      logical :: details = .false.
      !> File of the true drift; unallocated: none
      character(:), allocatable :: truth
   end type analysis_config

   !> simulate
   type, extends(cli_config) :: simulate_config
      !> The record
      type(simulate_options) :: record
      !> Its file, "-" is standard output
      character(:), allocatable :: output
      !> File of the true drift; unallocated: none
      character(:), allocatable :: truth
      !> Significant digits; 0: as few as read back to the same numbers
      integer :: digits = 0
      !> The command line that makes the same record again, the seed included
      character(:), allocatable :: origin
   end type simulate_config

   !> selftest
   type, extends(cli_config) :: selftest_config
   end type selftest_config

contains

   !> The defaults of a command: run cleans the record, the others take it as it is.
   subroutine new_config(command, path, config)
      !> A known command
      character(*), intent(in) :: command
      !> The recording; of no meaning to simulate
      character(*), intent(in) :: path
      !> Filled with the defaults
      class(cli_config), allocatable, intent(out) :: config

      select case (command)
      case ("inspect"); allocate (inspect_config :: config)
      case ("simulate"); allocate (simulate_config :: config)
      case ("selftest"); allocate (selftest_config :: config)
      case default; allocate (analysis_config :: config)
      end select
      config%command = command
      select type (config)
      class is (reading_config)
         config%path = path
      type is (simulate_config)
         config%output = "-"
      end select
      select type (config)
      type is (analysis_config)
         if (command == "run") return
         call choose_stages(command, config%pipeline)
      end select
   end subroutine new_config

   !> Whether several files are worked on, or a list of them.
   pure logical function has_many_files(config)
      !> A checked job
      class(reading_config), intent(in) :: config

      has_many_files = allocated(config%list)
      if (allocated(config%paths)) has_many_files = has_many_files .or. size(config%paths) > 1
   end function has_many_files

   !> A single command: the raw record, and only the stages that the command names.
   subroutine choose_stages(command, pipeline)
      character(*), intent(in) :: command
      type(pipeline_options), intent(inout) :: pipeline

      pipeline%clean%method = "none"
      pipeline%clean%degree = -1
      pipeline%do_allan = command == "allan"
      pipeline%do_tests = command == "tests"
      pipeline%test_cleaned = pipeline%do_tests
      pipeline%do_ar = command == "ar" .or. command == "filter"
      pipeline%do_filter = command == "filter"
      if (command == "ar") pipeline%ar%max_order = 12
   end subroutine choose_stages

end module gyroakf_app_config
