! SPDX-License-Identifier: MIT
!> What no single option can tell: options that exclude each other, files that are missing or would be overwritten.
module gyroakf_app_check
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_writer, only : is_file
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : document_mark, foreign_file, foreign_result, is_marked, result_files
   use gyroakf_report_kalibr, only : kalibr_mark
   use gyroakf_report_latex, only : latex_mark
   use gyroakf_app_config, only : cli_config, has_many_files, reading_config, analysis_config, simulate_config, &
      selftest_config
   use gyroakf_app_folders, only : summary_files, summary_marks
   use gyroakf_app_setting_input, only : check_input
   use gyroakf_app_setting_method, only : check_method
   use gyroakf_app_setting_record, only : check_record
   use gyroakf_app_words, only : words_type, is_given, usage_error
   implicit none (type, external)
   private
   public :: check_job, check_existing, is_result

contains

   !> What no single option can tell.
   subroutine check_job(words, config, error)
      !> The sorted command line
      type(words_type), intent(in) :: words
      !> What was made of it
      class(cli_config), intent(in) :: config
      !> usage
      type(error_type), allocatable, intent(out) :: error

      if (is_given(words, "--rate") .and. is_given(words, "--dt")) then
         call usage_error(error, "--rate and --dt say the same thing: give one of them")
         return
      end if
      select type (config)
      class is (reading_config)
         if (has_many_files(config)) then
            call check_many(config, error)
         else if (config%path == "") then
            call usage_error(error, "no file; '-' reads standard input; see gyroakf --help")
         else
            call check_outputs(config, error)
         end if
         if (allocated(error)) return
         call check_input(config%reader, error)
      type is (simulate_config)
         if (words%positional > 1) then
            call usage_error(error, "simulate reads no file: '"//words%word(2)%text//"'; --output FILE writes one")
            return
         end if
         call check_record(config%record, error)
         if (allocated(error) .or. .not. allocated(config%truth)) return
         if (without_dot(config%truth) == without_dot(config%output)) then
            call usage_error(error, "--output and --truth name the same file '"//config%truth//"'")
            return
         end if
      type is (selftest_config)
         if (words%positional > 1) call usage_error(error, "selftest reads no file: '"//words%word(2)%text//"'")
      end select
      if (allocated(error)) return
      select type (config)
      type is (analysis_config)
         call check_method(config%pipeline, is_given(words, "--outlier-threshold"), is_given(words, "--outlier-rounds"), &
                           is_given(words, "--outlier-window"), error)
      end select
   end subroutine check_job

   !> What many files cannot have: one file that all would write, two that read standard input.
   subroutine check_many(config, error)
      class(reading_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      character(8) :: option(3)
      type(text_type) :: target(3)
      integer :: i, inputs

      inputs = 0
      if (allocated(config%list)) then
         if (config%list == "-") inputs = 1
      end if
      do i = 1, size(config%paths)
         if (config%paths(i)%text == "-") inputs = inputs + 1
         if (allocated(config%json)) then
            if (without_dot(config%json) == without_dot(config%paths(i)%text) .and. config%json /= "-") then
               call usage_error(error, "--json would overwrite the recording '"//config%json//"'")
               return
            end if
         end if
      end do
      if (inputs > 1) call usage_error(error, "standard input ('-') can be read once")
      if (allocated(error)) return
      select type (config)
      type is (analysis_config)
         if (allocated(config%truth)) then
            call usage_error(error, "--truth is that of one recording; many files have one each: give them one by one")
            return
         end if
         call list_targets(config, option, target)
         do i = 2, size(option)
            if (target(i)%text == "" .or. allocated(error)) cycle
            if (.not. allocated(config%out)) then
               call usage_error(error, trim(option(i))//" with many files needs --out: it is written into the folder of each")
            else if (scan(target(i)%text, "/") > 0 .or. target(i)%text == "-") then
               call usage_error(error, trim(option(i))//" with many files needs a name without a folder: it is written into "// &
                                "that of each")
            else if (any(result_files == target(i)%text)) then
               call usage_error(error, trim(option(i))//" and --out name the same file '"//target(i)%text//"'")
            end if
         end do
         if (.not. allocated(error)) call check_different(option(2:), target(2:), error)
      end select
   end subroutine check_many

   !> Files that are no results of gyroakf are kept, records and files of options too, unless --force says otherwise: found out
   !> before anything is read.
   subroutine check_existing(config, error)
      !> A checked job
      class(cli_config), intent(in) :: config
      !> io
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: path

      if (config%force) return
      path = existing(config%options_file)
      select type (config)
      class is (reading_config)
         if (path == "") path = existing(config%json, document_mark)
         if (path == "" .and. allocated(config%out)) then
            if (has_many_files(config)) then
               path = foreign_file(config%out, summary_files, summary_marks)
            else
               path = foreign_result(config%out)
            end if
         end if
      type is (simulate_config)
         if (path == "") path = existing(config%output)
         if (path == "") path = existing(config%truth)
      end select
      select type (config)
      type is (analysis_config)
         if (.not. has_many_files(config)) then
            if (path == "") path = existing(config%kalibr, kalibr_mark)
            if (path == "") path = existing(config%latex, latex_mark)
         end if
      end select
      if (path /= "") call fatal_error(error, status%io, path//": already exists; use --force to overwrite it")
   end subroutine check_existing

   !> The path where a file is there that was not written by gyroakf, else "".
   function existing(path, mark)
      character(:), allocatable, intent(in) :: path
      !> Of the files that gyroakf writes; absent: every file is kept
      character(*), intent(in), optional :: mark
      character(:), allocatable :: existing

      existing = ""
      if (.not. allocated(path)) return
      if (path == "-" .or. .not. is_file(path)) return
      if (present(mark)) then
         if (is_marked(path, mark)) return
      end if
      existing = path
   end function existing

   !> The recording is not overwritten by a result, and no result by another.
   subroutine check_outputs(config, error)
      class(reading_config), intent(in) :: config
      type(error_type), allocatable, intent(out) :: error
      character(8) :: option(3)
      type(text_type) :: target(3)
      integer :: i

      if (allocated(config%json)) call check_target(config, "--json", config%json, error)
      if (allocated(error)) return
      select type (config)
      type is (analysis_config)
         call list_targets(config, option, target)
         do i = 2, size(option)
            if (.not. allocated(error) .and. target(i)%text /= "") call check_target(config, trim(option(i)), target(i)%text, error)
         end do
         if (.not. allocated(error)) call check_source(config, target, error)
         if (.not. allocated(error)) call check_different(option, target, error)
         if (allocated(error)) return
      end select
      if (config%path == "-" .or. .not. allocated(config%out)) return
      if (is_result(config%out, config%path)) call usage_error(error, "--out would overwrite the recording '"// &
                                                               without_dot(config%path)//"'")
   end subroutine check_outputs

   !> The options that name a file, and the files, "" where they were not given.
   subroutine list_targets(config, option, target)
      type(analysis_config), intent(in) :: config
      character(8), intent(out) :: option(3)
      type(text_type), intent(out) :: target(3)
      integer :: i

      option = [character(8) :: "--json", "--kalibr", "--latex"]
      do i = 1, size(target)
         target(i)%text = ""
      end do
      if (allocated(config%json)) target(1)%text = config%json
      if (allocated(config%kalibr)) target(2)%text = config%kalibr
      if (allocated(config%latex)) target(3)%text = config%latex
   end subroutine list_targets

   !> No two options write the same file, or both standard output.
   subroutine check_different(option, target, error)
      character(*), intent(in) :: option(:)
      type(text_type), intent(in) :: target(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j

      do i = 2, size(option)
         do j = 1, i - 1
            if (target(i)%text == "" .or. without_dot(target(i)%text) /= without_dot(target(j)%text)) cycle
            if (target(i)%text == "-") then
               call usage_error(error, trim(option(j))//" and "//trim(option(i))//" would both be on standard output ('-')")
            else
               call usage_error(error, trim(option(j))//" and "//trim(option(i))//" name the same file '"//target(j)%text//"'")
            end if
            return
         end do
      end do
   end subroutine check_different

   !> The true drift is not overwritten by a result.
   subroutine check_source(config, target, error)
      type(analysis_config), intent(in) :: config
      type(text_type), intent(in) :: target(:)
      type(error_type), allocatable, intent(out) :: error
      logical :: overwritten
      integer :: i

      if (.not. allocated(config%truth)) return
      overwritten = .false.
      do i = 1, size(target)
         overwritten = overwritten .or. without_dot(target(i)%text) == without_dot(config%truth)
      end do
      if (allocated(config%out)) overwritten = overwritten .or. is_result(config%out, config%truth)
      if (overwritten) call usage_error(error, "a result would overwrite the true drift '"//config%truth//"'")
   end subroutine check_source

   !> A file that is to be written: not the recording, not one that --out writes.
   subroutine check_target(config, option, target, error)
      class(reading_config), intent(in) :: config
      character(*), intent(in) :: option
      character(*), intent(in) :: target
      type(error_type), allocatable, intent(out) :: error

      if (target == "-") return
      if (without_dot(target) == without_dot(config%path)) then
         call usage_error(error, option//" would overwrite the recording '"//without_dot(config%path)//"'")
         return
      end if
      if (.not. allocated(config%out) .or. option == "--json") return
      if (is_result(config%out, target)) call usage_error(error, option//" and --out name the same file '"//target//"'")
   end subroutine check_target

   !> Whether --out writes that file.
   pure logical function is_result(directory, path)
      !> Of --out, and the file
      character(*), intent(in) :: directory, path
      integer :: i

      is_result = .false.
      do i = 1, size(result_files)
         if (without_dot(directory//"/"//trim(result_files(i))) == without_dot(path)) is_result = .true.
      end do
   end function is_result

   !> A path without "./" in front.
   pure function without_dot(path) result(rest)
      character(*), intent(in) :: path
      character(:), allocatable :: rest
      integer :: first

      first = 1
      do while (index(path(first:), "./") == 1)
         first = first + 2
      end do
      rest = path(first:)
   end function without_dot

end module gyroakf_app_check
