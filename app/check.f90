! SPDX-License-Identifier: MIT
!> What no single option can tell: options that exclude each other, files that are missing or would
!> be overwritten.
module gyroakf_app_check
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_reader, only : reader_options
   use gyroakf_io_writer, only : is_file
   use gyroakf_report_files, only : after_dots, document_mark, foreign_file, foreign_result, &
      is_marked, is_same_file, result_files
   use gyroakf_report_kalibr, only : kalibr_mark
   use gyroakf_units, only : unit_type, is_integral, parse_units, quantity
   use gyroakf_app_config, only : config_type, file_options, has_many_files, is_analysis, &
      reads_files
   use gyroakf_app_file_list, only : summary_files, summary_marks
   use gyroakf_app_words, only : words_type, is_given, usage_error
   implicit none (type, external)
   private
   public :: check_job, check_existing, is_result

   !> Of the files of [[gyroakf_app_config:file_options]] that gyroakf wrote
   character(48), parameter :: file_marks(2) = [character(48) :: document_mark, kalibr_mark]

contains

   !> What no single option can tell.
   subroutine check_job(words, config, error)
      !> The sorted command line
      type(words_type), intent(in) :: words
      !> What was made of it
      type(config_type), intent(in) :: config
      !> usage
      type(error_type), allocatable, intent(out) :: error

      call refuse(is_given(words, "--rate") .and. is_given(words, "--dt"), &
                  "--rate and --dt say the same thing: give one of them", error)
      if (allocated(error)) return
      if (reads_files(config%command)) then
         if (has_many_files(config)) then
            call check_many(config, error)
         else if (config%path == "") then
            call usage_error(error, "no file; '-' reads standard input; see gyroakf --help")
         else
            call check_outputs(config, error)
         end if
         if (.not. allocated(error)) call check_input(config%reader, error)
      else if (words%positional > 1) then
         call refuse(config%command == "simulate", "simulate reads no file: '"// &
                     words%word(2)%text//"'; --output FILE writes one", error)
         call refuse(.true., "selftest reads no file: '"//words%word(2)%text//"'", error)
      else if (config%command == "simulate") then
         call check_simulation(config, error)
      end if
      if (is_analysis(config%command)) call check_method(words, config, error)
   end subroutine check_job

   !> An error of the command line where a condition holds; an earlier one stays.
   subroutine refuse(condition, message, error)
      logical, intent(in) :: condition
      character(*), intent(in) :: message
      type(error_type), allocatable, intent(inout) :: error

      if (condition .and. .not. allocated(error)) call usage_error(error, message)
   end subroutine refuse

   subroutine check_input(reader, error)
      type(reader_options), intent(in) :: reader
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: unit(:)
      logical :: angles
      integer :: i

      call refuse(reader%from >= reader%to, &
                  "--from is not before --to: nothing would be left", error)
      if (allocated(error) .or. .not. allocated(reader%unit)) return
      call parse_units(reader%unit, unit, error)
      if (allocated(error)) return
      angles = .false.
      if (allocated(reader%input)) angles = reader%input /= "rate"
      do i = 1, size(unit)
         if (angles .eqv. is_integral(unit(i))) cycle
         if (angles) then
            call refuse(.true., &
               "with --input "//reader%input//" the unit is that of the angle: "// &
               "rad, deg, arcsec, or of the velocity: m/s, not '"//unit(i)%name//"'", error)
         else
            call refuse(.true., "'"//unit(i)%name//"' is the unit of "// &
               trim(merge("a velocity", "an angle  ", unit(i)%quantity == quantity%velocity))// &
               ": say --input increment or --input angle, or name the unit of a rate", error)
         end if
      end do
   end subroutine check_input

   subroutine check_method(words, config, error)
      type(words_type), intent(in) :: words
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(inout) :: error

      associate (pipeline => config%pipeline, method => config%pipeline%clean%method)
         call refuse(method == "none" .and. is_given(words, "--outlier-threshold"), &
                     "--outlier-threshold without --outliers: no outliers are looked for", error)
         call refuse(method == "none" .and. is_given(words, "--outlier-rounds"), &
                     "--outlier-rounds without --outliers: no outliers are looked for", error)
         call refuse(method /= "hampel" .and. is_given(words, "--outlier-window"), &
            "--outlier-window goes with --outliers hampel: the other rules have no window", error)
         call refuse(pipeline%ar%order > pipeline%ar%max_order, &
                     "--order is larger than --max-order", error)
         call refuse(pipeline%noise%tau_min >= pipeline%noise%tau_max, &
                     "--fit-tau-min is not below --fit-tau-max: nothing would be fitted", error)
      end associate
   end subroutine check_method

   subroutine check_simulation(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error

      associate (record => config%record)
         call refuse(allocated(record%ar) .neqv. record%ar_variance > 0, &
                     "--ar and --ar-variance go together", error)
         call refuse(record%outliers > 0 .neqv. abs(record%outlier_size) > 0, &
                     "--outlier-count and --outlier-size go together", error)
         call refuse(is_same_file(config%truth, config%output), &
                     "--output and --truth name the same file '"//config%truth//"'", error)
      end associate
   end subroutine check_simulation

   !> What many files cannot have: one file that all would write, two that read standard input.
   subroutine check_many(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      integer :: i, inputs

      inputs = merge(1, 0, config%list == "-")
      do i = 1, size(config%paths)
         if (config%paths(i)%text == "-") inputs = inputs + 1
         call refuse(config%paths(i)%text /= "-" .and. &
                     is_same_file(config%paths(i)%text, config%file(1)%text), &
                     "--json would overwrite the recording '"//config%file(1)%text//"'", error)
      end do
      call refuse(inputs > 1, "standard input ('-') can be read once", error)
      call refuse(config%truth /= "", "--truth is that of one recording; many files have one "// &
                  "each: give them one by one", error)
      associate (kalibr => config%file(2)%text)
         if (kalibr == "") return
         call refuse(config%out == "", "--kalibr with many files needs --out: it is written "// &
                     "into the folder of each", error)
         call refuse(scan(kalibr, "/") > 0, "--kalibr with many files needs a name without a "// &
                     "folder: it is written into that of each", error)
         call refuse(any(result_files == kalibr), &
                     "--kalibr and --out name the same file '"//kalibr//"'", error)
      end associate
   end subroutine check_many

   !> Files that are no results of gyroakf are kept, records and files of options too, unless
   !> --force says otherwise: found out before anything is read.
   subroutine check_existing(config, error)
      !> A checked job
      type(config_type), intent(in) :: config
      !> io
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: path
      integer :: i

      if (config%force) return
      path = existing(config%options_file)
      do i = 1, size(config%file)
         if (has_many_files(config) .and. i > 1) exit
         if (path == "") path = existing(config%file(i)%text, trim(file_marks(i)))
      end do
      if (path == "" .and. config%out /= "") then
         if (has_many_files(config)) then
            path = foreign_file(config%out, summary_files, summary_marks)
         else
            path = foreign_result(config%out)
         end if
      end if
      if (config%command == "simulate") then
         if (path == "") path = existing(config%output)
         if (path == "") path = existing(config%truth)
      end if
      if (path == "") return
      call fatal_error(error, status%io, path//": already exists; use --force to overwrite it")
   end subroutine check_existing

   !> The path where a file is there that was not written by gyroakf, else "".
   function existing(path, mark)
      character(*), intent(in) :: path
      !> Of the files that gyroakf writes; absent: every file is kept
      character(*), intent(in), optional :: mark
      character(:), allocatable :: existing

      existing = ""
      if (path == "" .or. path == "-") return
      if (.not. is_file(path)) return
      if (present(mark)) then
         if (is_marked(path, mark)) return
      end if
      existing = path
   end function existing

   !> The recording and the true drift are not overwritten by a result, and no result by another.
   subroutine check_outputs(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: option
      integer :: i

      do i = 1, size(config%file)
         option = trim(file_options(i))
         associate (target => config%file(i)%text)
            if (target == "" .or. target == "-") cycle
            call refuse(is_same_file(config%path, target), option//" would overwrite the "// &
               "recording '"//config%path(after_dots(config%path):)//"'", error)
            call refuse(is_result(config%out, target), &
                        option//" and --out name the same file '"//target//"'", error)
            call refuse(is_same_file(target, config%truth), &
                        "a result would overwrite the true drift '"//config%truth//"'", error)
         end associate
      end do
      call refuse(is_result(config%out, config%truth), &
                  "a result would overwrite the true drift '"//config%truth//"'", error)
      call refuse(is_same_file(config%file(2)%text, config%file(1)%text), "--json and --kalibr "// &
                  "name the same file '"//config%file(1)%text//"'", error)
      call refuse(is_result(config%out, config%path), "--out would overwrite the recording '"// &
                  config%path(after_dots(config%path):)//"'", error)
   end subroutine check_outputs

   !> Whether --out writes that file.
   logical function is_result(directory, path)
      !> Of --out, "" where it was not given, and the file
      character(*), intent(in) :: directory, path
      integer :: i

      is_result = .false.
      if (directory == "" .or. path == "-") return
      do i = 1, size(result_files)
         if (is_same_file(directory//"/"//trim(result_files(i)), path)) is_result = .true.
      end do
   end function is_result

end module gyroakf_app_check
