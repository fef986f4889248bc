! SPDX-License-Identifier: MIT
!> What a command line asks for, filled by [[gyroakf_app_cli]].
module gyroakf_app_config
   use gyroakf_io_reader, only : reader_options
   use gyroakf_pipeline, only : pipeline_options
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : series_output_type
   use gyroakf_simulate_simulate_record, only : simulate_options
   implicit none (type, external)
   private
   public :: config_type, new_config, reads_files, is_analysis, has_many_files, file_options

   !> Options that name a file of results each, in the order of `config_type%file`; the first may be
   !> "-", standard output
   character(8), parameter :: file_options(2) = [character(8) :: "--json", "--kalibr"]

   !> A job; texts are "" where an option was not given
   type :: config_type
      !> Name of the command; help prints `text` and does nothing else
      character(:), allocatable :: command, text
      !> Number of threads, 0: as many as there are
      integer :: threads = 0
      !> No report on standard output
      logical :: quiet = .false.
      !> When a bar is drawn: "auto", "on", "off"
      character(4) :: progress = "auto"
      !> Files that are there already are overwritten
      logical :: force = .false.
      !> File that gets the options, and what is written into it
      character(:), allocatable :: options_file, options_text
      !> The recording, "-" is standard input
      character(:), allocatable :: path
      !> All recordings, `path` first, and the file that names more
      type(text_type), allocatable :: paths(:)
      character(:), allocatable :: list
      !> How a recording is read
      type(reader_options) :: reader
      !> As it was typed, and the part of it that says how the recording is read
      character(:), allocatable :: command_line, input_options
      !> What is computed and how
      type(pipeline_options) :: pipeline
      !> Directory of the result files
      character(:), allocatable :: out
      !> Files of [[gyroakf_app_config:file_options]]; "-" is standard output
      type(text_type) :: file(size(file_options))
      !> How the series are written into `out`, and the digits of a simulated record
      type(series_output_type) :: series
      !> File of the true drift, read by run and filter, written by simulate
      character(:), allocatable :: truth
      !> Colors of the report: "auto", "always", "never"; no signs beyond ASCII in it
      character(6) :: color = "auto"
      logical :: ascii = .false.
      !> Draw the Allan deviation in characters; the report has everything, not the first screen
      !> alone
      logical :: chart = .true., details = .false.
      !> The simulated record, its file ("-" is standard output), and the command line that makes it
      !> again, the seed included
      type(simulate_options) :: record
      character(:), allocatable :: output, origin
   end type config_type

contains

   !> The defaults of a command: run cleans the record, the others take it as it is and do only the
   !> stages that they name.
   subroutine new_config(command, config)
      !> A known command, or help
      character(*), intent(in) :: command
      !> Filled with the defaults
      type(config_type), intent(out) :: config
      integer :: i

      config%command = command
      config%text = ""
      config%options_file = ""
      config%options_text = ""
      config%path = ""
      config%list = ""
      config%command_line = ""
      config%input_options = ""
      config%out = ""
      do i = 1, size(config%file)
         config%file(i)%text = ""
      end do
      config%truth = ""
      config%output = "-"
      config%origin = ""
      allocate (config%paths(0))
      if (command == "run") return
      associate (pipeline => config%pipeline)
         pipeline%clean%method = "none"
         pipeline%clean%degree = -1
         pipeline%do_allan = command == "allan"
         pipeline%do_tests = command == "tests"
         pipeline%test_cleaned = pipeline%do_tests
         pipeline%do_ar = command == "ar" .or. command == "filter"
         pipeline%do_filter = command == "filter"
         if (command == "ar") pipeline%ar%max_order = 12
      end associate
   end subroutine new_config

   !> Whether a command reads recordings.
   pure logical function reads_files(command)
      !> Its name
      character(*), intent(in) :: command

      reads_files = command == "inspect" .or. is_analysis(command)
   end function reads_files

   !> Whether a command computes something of recordings.
   pure logical function is_analysis(command)
      !> Its name
      character(*), intent(in) :: command

      is_analysis = any(command == [character(6) :: "run", "allan", "tests", "ar", "filter"])
   end function is_analysis

   !> Whether several files are worked on, or a list of them.
   pure logical function has_many_files(config)
      !> A checked job
      type(config_type), intent(in) :: config

      has_many_files = config%list /= "" .or. size(config%paths) > 1
   end function has_many_files

end module gyroakf_app_config
