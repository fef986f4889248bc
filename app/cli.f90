! SPDX-License-Identifier: MIT
!> From the words of the command line to a configuration.
!>
!> First the words are sorted ([[gyroakf_app_words]]); the first one that is no option may be a
!> command. Then the options are checked against the command and applied: --preset first, the others
!> in order on top of it.
module gyroakf_app_cli
   use gyroakf_error, only : error_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : text_type
   use gyroakf_release, only : release_string
   use gyroakf_app_check, only : check_job
   use gyroakf_app_completion, only : completion_text
   use gyroakf_app_config, only : config_type, new_config, reads_files
   use gyroakf_app_config_file, only : add_config, config_text
   use gyroakf_app_help, only : citation_text, command_help, manual_text, program_help
   use gyroakf_app_option, only : belongs_to, commands_of, find_option, suggest_word, takes_value
   use gyroakf_app_option_table, only : all_names, option_type, options
   use gyroakf_app_settings, only : apply_option
   use gyroakf_app_value, only : value_type, convert_value
   use gyroakf_app_words, only : is_given, joined, names_command, shell_word, sort_words, &
      usage_error, value_of, words_type
   implicit none (type, external)
   private
   public :: get_config

contains

   !> Parses a command line.
   subroutine get_config(arguments, config, error)
      !> The words
      type(text_type), intent(in) :: arguments(:)
      !> What they ask for
      type(config_type), intent(out) :: config
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(words_type) :: words
      character(:), allocatable :: command
      integer :: first, i

      call sort_words(arguments, words, error)
      if (.not. allocated(error)) call take_verb(words, error)
      if (allocated(error)) return
      if (is_given(words, "--config")) call add_config(value_of(words, "--config"), words, error)
      if (.not. allocated(error)) call find_command(words, command, first, error)
      if (.not. allocated(error)) call make_text(words, config, error)
      if (allocated(error)) return
      if (config%command == "help") return
      call make_job(words, command, first, config, error)
      if (allocated(error)) return
      config%command_line = "gyroakf"
      do i = 1, size(arguments)
         config%command_line = config%command_line//" "//shell_word(arguments(i)%text)
      end do
      if (reads_files(command)) config%input_options = options_of("input", words, command)
   end subroutine get_config

   !> `gyroakf help` is `gyroakf --help`, `gyroakf version` is `gyroakf --version`.
   subroutine take_verb(words, error)
      type(words_type), intent(inout) :: words
      type(error_type), allocatable, intent(out) :: error

      do while (words%positional > 0 .and. .not. words%behind_dashes)
         if (all(words%word(1)%text /= ["help   ", "version"])) return
         words%used = words%used + 1
         words%given(words%used)%row = find_option("--"//words%word(1)%text, "")
         words%given(words%used)%value = ""
         words%word = words%word(2:)
         words%positional = words%positional - 1
         if (words%positional == 0) return
         if (any(all_names == words%word(1)%text)) cycle
         call unknown_command(words%word(1)%text, "", error)
         return
      end do
   end subroutine take_verb

   !> The command among the words that are no options, and the first file. A first word that is no
   !> command is meant as one where another word follows or no such file is there.
   subroutine find_command(words, command, first, error)
      type(words_type), intent(in) :: words
      character(:), allocatable, intent(out) :: command
      integer, intent(out) :: first
      type(error_type), allocatable, intent(out) :: error
      logical :: there

      command = "run"
      first = 1
      if (names_command(words)) then
         command = words%word(1)%text
         first = 2
      else if (words%positional > 0 .and. .not. words%behind_dashes) then
         associate (word => words%word(1)%text)
            if (word == "-" .or. scan(word, "./\") > 0) return
            inquire (file=word, exist=there)
            if (there .or. (words%positional == 1 .and. suggest_word(word, all_names) == "")) return
            call unknown_command(word, ", and no file of that name", error)
         end associate
      end if
   end subroutine find_command

   !> A word that is no command, with the nearest one, or all.
   subroutine unknown_command(word, and, error)
      character(*), intent(in) :: word
      !> Stands behind it where one is near
      character(*), intent(in) :: and
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known

      known = suggest_word(word, all_names)
      if (known /= "") then
         known = and//"; the nearest command is '"//known//"'"
      else
         known = "; the commands are "//joined(all_names, ", ")
      end if
      call usage_error(error, "unknown command '"//word//"'"//known)
   end subroutine unknown_command

   !> --help, --version, --citation, --man and --completion go before everything else: then the
   !> command is help.
   subroutine make_text(words, config, error)
      type(words_type), intent(in) :: words
      type(config_type), intent(out) :: config
      type(error_type), allocatable, intent(out) :: error
      type(value_type) :: value
      integer :: i

      call new_config("help", config)
      do i = 1, words%used
         select case (options(words%given(i)%row)%name)
         case ("--help")
            config%text = program_help(whole=words%given(i)%value == "all")
            if (names_command(words)) config%text = command_help(words%word(1)%text)
         case ("--version"); config%text = "gyroakf "//release_string//new_line("a")
         case ("--citation"); config%text = citation_text()
         case ("--man"); config%text = manual_text()
         case ("--completion")
            call convert_value(options(words%given(i)%row), words%given(i)%value, value, error)
            if (.not. allocated(error)) config%text = completion_text(value%text)
         case default; cycle
         end select
         return
      end do
      config%command = ""
   end subroutine make_text

   !> A command that works on data: its defaults, then --preset, then the other options in order.
   subroutine make_job(words, command, first, config, error)
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      integer, intent(in) :: first
      type(config_type), intent(out) :: config
      type(error_type), allocatable, intent(out) :: error
      logical :: force

      call new_config(command, config)
      if (reads_files(command)) config%paths = words%word(first:words%positional)
      if (size(config%paths) > 0) config%path = config%paths(1)%text
      call apply_options(words, config, .true., error)
      if (allocated(error)) return
      call apply_options(words, config, .false., error)
      if (allocated(error)) return
      force = config%force
      if (is_given(words, "--write-config")) then
         if (reads_files(command) .and. config%path == "" .and. config%list == "") then
            call new_config("help", config)                  ! no recording: nothing but that file
            config%force = force
         end if
         config%options_file = value_of(words, "--write-config")
         config%options_text = config_text(words, command, first)
      end if
      if (config%command /= "help") call check_job(words, config, error)
      if (allocated(error)) return
      config%pipeline%keep_series = config%out /= "" .and. config%pipeline%do_filter
      config%origin = "gyroakf simulate"//options_of("record", words, "simulate")//" --seed "// &
                      integer_text(config%record%seed)
   end subroutine make_job

   !> The options of a group as they were given, each after a blank; of a record without its files
   !> and its seed.
   function options_of(group, words, command) result(text)
      character(*), intent(in) :: group
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, words%used
         associate (option => options(find_option(options(words%given(i)%row)%name, command)))
            if (option%group /= group) cycle
            if (any(option%name == [character(8) :: "--output", "--truth", "--seed"])) cycle
            text = text//" "//trim(option%name)
            if (takes_value(option)) text = text//" "//shell_word(words%given(i)%value)
         end associate
      end do
   end function options_of

   !> Applies --preset, or all others; an error in an option of a file is reported with its line.
   subroutine apply_options(words, config, preset, error)
      type(words_type), intent(in) :: words
      type(config_type), intent(inout) :: config
      logical, intent(in) :: preset
      type(error_type), allocatable, intent(out) :: error
      type(option_type) :: option
      integer :: i

      do i = 1, words%used
         associate (given => words%given(i))
            option = options(find_option(options(given%row)%name, config%command))
            if (.not. belongs_to(option, config%command)) then
               call usage_error(error, "option '"//trim(option%name)//"' is not one of '"// &
                  config%command//"'; it belongs to: "//trim(commands_of(option)))
            else if (preset .eqv. option%name == "--preset") then
               call apply_option(config, option, given%value, error)
            end if
            if (.not. allocated(error)) cycle
            if (allocated(given%place)) error%message = given%place//": "//error%message
            return
         end associate
      end do
   end subroutine apply_options

end module gyroakf_app_cli
