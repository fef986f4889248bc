! SPDX-License-Identifier: MIT
!> What no single option can tell: options that exclude each other, files that are missing or would be overwritten.
module gyroakf_app_check
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_reader, only : reader_options
   use gyroakf_io_writer, only : is_file
   use gyroakf_report_files, only : after_dots, document_mark, foreign_file, &
      foreign_result, is_marked, is_same_file, result_files
   use gyroakf_report_kalibr, only : kalibr_mark
   use gyroakf_units, only : unit_type, is_integral, parse_units, quantity
   use gyroakf_app_config, only : config_type, file_options, has_many_files, is_analysis, reads_files
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

      if (is_given(words, "--rate") .and. is_given(words, "--dt")) then
         call usage_error(error, "--rate and --dt say the same thing: give one of them")
      else if (reads_files(config%command)) then
         if (has_many_files(config)) then
            call check_many(config, error)
         else if (config%path == "") then
            call usage_error(error, "no file; '-' reads standard input; see gyroakf --help")
         else
            call check_outputs(config, error)
         end if
         if (.not. allocated(error)) call check_input(config%reader, error)
      else if (words%positional > 1) then
         call usage_error(error, config%command//" reads no file: '"//words%word(2)%text//"'"// &
                          trim(merge("; --output FILE writes one", repeat(" ", 26), config%command == "simulate")))
      else if (config%command == "simulate") then
         call check_simulation(config, error)
      end if
      if (.not. allocated(error) .and. is_analysis(config%command)) call check_method(words, config, error)
   end subroutine check_job

   !> How the recording is read.
   subroutine check_input(reader, error)
      type(reader_options), intent(in) :: reader
      type(error_type), allocatable, intent(out) :: error
      type(unit_type), allocatable :: unit(:)
      logical :: angles
      integer :: i

      if (reader%from >= reader%to) then
         call usage_error(error, "--from is not before --to: nothing would be left")
         return
      end if
      if (.not. allocated(reader%unit)) return
      call parse_units(reader%unit, unit, error)
      if (allocated(error)) return
      angles = .false.
      if (allocated(reader%input)) angles = reader%input /= "rate"
      do i = 1, size(unit)
         if (angles .eqv. is_integral(unit(i))) cycle
         if (angles) then
            call usage_error(error, "with --input "//reader%input//" the unit is that of the angle: rad, deg, "// &
                             "arcsec, or of the velocity: m/s, not '"//unit(i)%name//"'")
         else
            call usage_error(error, "'"//unit(i)%name//"' is the unit of "// &
                             trim(merge("a velocity", "an angle  ", unit(i)%quantity == quantity%velocity))// &
                             ": say --input increment or --input angle, or name the unit of a rate")
         end if
         return
      end do
   end subroutine check_input

   !> What is computed.
   subroutine check_method(words, config, error)
      type(words_type), intent(in) :: words
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      character(19), parameter :: of_outliers(2) = [character(19) :: "--outlier-threshold", "--outlier-rounds"]
      integer :: i

      associate (pipeline => config%pipeline)
         do i = 1, size(of_outliers)
            if (pipeline%clean%method == "none" .and. is_given(words, of_outliers(i))) then
               call usage_error(error, trim(of_outliers(i))//" without --outliers: no outliers are looked for")
               return
            end if
         end do
         if (is_given(words, "--outlier-window") .and. pipeline%clean%method /= "hampel") then
            call usage_error(error, "--outlier-window goes with --outliers hampel: the other rules have no window")
         else if (pipeline%ar%order > pipeline%ar%max_order) then
            call usage_error(error, "--order is larger than --max-order")
         else if (pipeline%noise%tau_min >= pipeline%noise%tau_max) then
            call usage_error(error, "--fit-tau-min is not below --fit-tau-max: nothing would be fitted")
         end if
      end associate
   end subroutine check_method

   !> The simulated record and its files.
   subroutine check_simulation(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error

      associate (record => config%record)
         if (allocated(record%ar) .neqv. record%ar_variance > 0) then
            call usage_error(error, "--ar and --ar-variance go together")
         else if (record%outliers > 0 .neqv. abs(record%outlier_size) > 0) then
            call usage_error(error, "--outlier-count and --outlier-size go together")
         else if (is_same_file(config%truth, config%output)) then
            call usage_error(error, "--output and --truth name the same file '"//config%truth//"'")
         end if
      end associate
   end subroutine check_simulation

   !> What many files cannot have: one file that all would write, two that read standard input.
   subroutine check_many(config, error)
      type(config_type), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      integer :: i, inputs

      inputs = merge(1, 0, config%list == "-")
      associate (target => config%file)
         do i = 1, size(config%paths)
            if (config%paths(i)%text == "-") then
               inputs = inputs + 1
            else if (is_same_file(config%paths(i)%text, target(1)%text)) then
               call usage_error(error, "--json would overwrite the recording '"//target(1)%text//"'")
               return
            end if
         end do
         if (inputs > 1) then
            call usage_error(error, "standard input ('-') can be read once")
         else if (config%truth /= "") then
            call usage_error(error, "--truth is that of one recording; many files have one each: give them one by one")
         end if
         do i = 2, size(target)
            if (target(i)%text == "" .or. allocated(error)) cycle
            if (config%out == "") then
               call usage_error(error, trim(file_options(i))//" with many files needs --out: it is written into the "// &
                                "folder of each")
            else if (scan(target(i)%text, "/") > 0 .or. target(i)%text == "-") then
               call usage_error(error, trim(file_options(i))//" with many files needs a name without a folder: it is "// &
                                "written into that of each")
            else if (any(result_files == target(i)%text)) then
               call usage_error(error, trim(file_options(i))//" and --out name the same file '"//target(i)%text//"'")
            end if
         end do
      end associate
      if (.not. allocated(error)) call check_different(config, 2, error)
   end subroutine check_many

   !> Files that are no results of gyroakf are kept, records and files of options too, unless --force says otherwise: found out
   !> before anything is read.
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
      if (path /= "") call fatal_error(error, status%io, path//": already exists; use --force to overwrite it")
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
      integer :: i

      do i = 1, size(config%file)
         associate (target => config%file(i)%text)
            if (target == "" .or. target == "-") cycle
            if (is_same_file(config%path, target)) then
               call usage_error(error, trim(file_options(i))//" would overwrite the recording '"// &
                                config%path(after_dots(config%path):)//"'")
            else if (is_result(config%out, target)) then
               call usage_error(error, trim(file_options(i))//" and --out name the same file '"//target//"'")
            else if (is_same_file(target, config%truth)) then
               call usage_error(error, "a result would overwrite the true drift '"//config%truth//"'")
            end if
         end associate
         if (allocated(error)) return
      end do
      if (is_result(config%out, config%truth)) then
         call usage_error(error, "a result would overwrite the true drift '"//config%truth//"'")
      else
         call check_different(config, 1, error)
      end if
      if (allocated(error) .or. .not. is_result(config%out, config%path)) return
      call usage_error(error, "--out would overwrite the recording '"//config%path(after_dots(config%path):)//"'")
   end subroutine check_outputs

   !> No two options write the same file, or both standard output.
   subroutine check_different(config, first, error)
      type(config_type), intent(in) :: config
      !> Options that are compared: from this one on
      integer, intent(in) :: first
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: options
      integer :: i, j

      do i = first + 1, size(config%file)
         do j = first, i - 1
            associate (target => config%file(i)%text)
               if (.not. is_same_file(target, config%file(j)%text)) cycle
               options = trim(file_options(j))//" and "//trim(file_options(i))
               if (target == "-") then
                  call usage_error(error, options//" would both be on standard output ('-')")
               else
                  call usage_error(error, options//" name the same file '"//config%file(j)%text//"'")
               end if
            end associate
            return
         end do
      end do
   end subroutine check_different

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
