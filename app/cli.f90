! SPDX-License-Identifier: MIT
!> From the words of the command line to a configuration.
!>
!> First the words are sorted ([[gyroakf_app_words]]); the first one that is no option may be a command. Then the options
!> are checked against the command and applied: --preset first, the others in order on top of it.
module gyroakf_app_cli
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_app_argument, only : argument_list
   use gyroakf_pipeline, only : apply_preset
   use gyroakf_app_check, only : check_job
   use gyroakf_app_config, only : cli_config, text_config, reading_config, analysis_config, simulate_config, new_config
   use gyroakf_app_config_file, only : add_config, config_text
   use gyroakf_app_completion, only : completion_text
   use gyroakf_app_help, only : program_help, command_help, version_text, citation_text
   use gyroakf_app_manual, only : manual_text
   use gyroakf_app_option, only : option_type, options, all_names, command_names, find_option, belongs_to, suggest_word, &
      takes_value
   use gyroakf_app_setting_input, only : set_input, set_common
   use gyroakf_app_setting_method, only : set_method
   use gyroakf_app_setting_record, only : set_preset, set_record
   use gyroakf_app_value, only : value_type, convert_value
   use gyroakf_app_words, only : given_type, words_type, sort_words, is_given, value_of, shell_word, usage_error
   implicit none (type, external)
   private
   public :: get_config

contains

   !> Parses a command line.
   subroutine get_config(arguments, config, error)
      !> The words
      type(argument_list), intent(in) :: arguments
      !> What they ask for
      class(cli_config), allocatable, intent(out) :: config
      !> usage
      type(error_type), allocatable, intent(out) :: error
      type(words_type) :: words
      character(:), allocatable :: command
      integer :: first

      call sort_words(arguments, words, error)
      if (.not. allocated(error)) call take_verb(words, error)
      if (allocated(error)) return
      if (is_given(words, "--config")) call add_config(value_of(words, "--config"), words, error)
      if (allocated(error)) return
      call find_command(words, command, first, error)
      if (allocated(error)) return
      call make_text(words, config, error)
      if (allocated(config) .or. allocated(error)) return
      call make_job(words, command, first, config, error)
      if (allocated(error)) return
      select type (config)
      class is (reading_config)
         config%command_line = typed_line(arguments)
         config%input_options = options_of("input", words, config%command)
      end select
   end subroutine get_config

   !> `gyroakf help` is `gyroakf --help`, `gyroakf version` is `gyroakf --version`.
   subroutine take_verb(words, error)
      type(words_type), intent(inout) :: words
      !> usage: help of a command that is none
      type(error_type), allocatable, intent(out) :: error

      do while (words%positional > 0 .and. .not. words%behind_dashes)
         if (all(words%word(1)%text /= ["help   ", "version"])) return
         words%used = words%used + 1
         words%given(words%used)%row = find_option("--"//words%word(1)%text, "")
         words%given(words%used)%value = ""
         words%word = words%word(2:)
         words%positional = words%positional - 1
         if (words%positional == 0) return
         if (all(all_names /= words%word(1)%text)) call unknown_command(words%word(1)%text, "", error)
      end do
   end subroutine take_verb

   !> The command line as it would be typed.
   function typed_line(arguments) result(line)
      type(argument_list), intent(in) :: arguments
      character(:), allocatable :: line
      integer :: i

      line = "gyroakf"
      do i = 1, size(arguments%item)
         line = line//" "//shell_word(arguments%item(i)%text)
      end do
   end function typed_line

   !> The command among the words that are no options, and the first file.
   subroutine find_command(words, command, first, error)
      type(words_type), intent(in) :: words
      character(:), allocatable, intent(out) :: command
      !> Number of the word
      integer, intent(out) :: first
      type(error_type), allocatable, intent(out) :: error

      command = "run"
      first = 1
      if (words%positional == 0) return
      if (any(command_names == words%word(1)%text) .and. .not. words%behind_dashes) then
         command = words%word(1)%text
         first = 2
      else
         call check_command(words, error)
      end if
   end subroutine find_command

   !> The first word is no command: is it meant as one? Yes where another word follows or no such file is there.
   subroutine check_command(words, error)
      type(words_type), intent(in) :: words
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: word
      logical :: there

      word = words%word(1)%text
      if (words%behind_dashes .or. word == "-" .or. scan(word, "./\") > 0) return
      inquire (file=word, exist=there)
      if (there) return
      if (words%positional > 1 .or. suggest_word(word, all_names) /= "") then
         call unknown_command(word, ", and no file of that name", error)
      end if
   end subroutine check_command

   !> A word that is no command, with the nearest one, or all.
   subroutine unknown_command(word, and, error)
      character(*), intent(in) :: word
      !> Stands behind it where one is near
      character(*), intent(in) :: and
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known

      known = suggest_word(word, all_names)
      if (known /= "") then
         call usage_error(error, "unknown command '"//word//"'"//and//"; the nearest command is '"//known//"'")
      else
         call usage_error(error, "unknown command '"//word//"'; the commands are "//list_of(all_names))
      end if
   end subroutine unknown_command

   !> --help, --version, --citation, --man and --completion go before everything else.
   subroutine make_text(words, config, error)
      type(words_type), intent(in) :: words
      class(cli_config), allocatable, intent(inout) :: config
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      type(value_type) :: value
      integer :: i

      do i = 1, words%used
         select case (options(words%given(i)%row)%name)
         case ("--help")
            text = program_help(whole=words%given(i)%value == "all")
            if (words%positional > 0) then
               if (any(command_names == words%word(1)%text)) text = command_help(words%word(1)%text)
            end if
         case ("--version"); text = version_text()
         case ("--citation"); text = citation_text()
         case ("--man"); text = manual_text()
         case ("--completion")
            call convert_value(options(words%given(i)%row), words%given(i)%value, value, error)
            if (allocated(error)) return
            text = completion_text(value%text)
         case default; cycle
         end select
         allocate (config, source=text_config(command="help", text=text))
         return
      end do
   end subroutine make_text

   !> A command that works on data: its defaults, then --preset, then the other options in order.
   subroutine make_job(words, command, first, config, error)
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      !> Word of the first file
      integer, intent(in) :: first
      class(cli_config), allocatable, intent(inout) :: config
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: path
      integer :: i

      path = ""
      if (words%positional >= first) path = words%word(first)%text
      call new_config(command, path, config)
      select type (config)
      class is (reading_config)
         allocate (config%paths(max(0, words%positional - first + 1)))
         do i = 1, size(config%paths)
            config%paths(i)%text = words%word(first + i - 1)%text
         end do
      end select
      call apply_options(words, config, .true., error)
      if (allocated(error)) return
      call apply_options(words, config, .false., error)
      if (allocated(error)) return
      if (is_given(words, "--write-config")) then
         if (path == "" .and. command /= "simulate" .and. command /= "selftest" .and. .not. is_given(words, "--list")) then
            call move_to_text(config)                               ! no recording: nothing but that file
         end if
         config%options_file = value_of(words, "--write-config")
         config%options_text = config_text(words, command, first)
      end if
      call check_job(words, config, error)
      if (allocated(error)) return
      select type (config)
      type is (analysis_config)
         config%pipeline%keep_series = allocated(config%out) .and. config%pipeline%do_filter
      type is (simulate_config)
         config%origin = origin_of(words, config%record%seed)
      end select
   end subroutine make_job

   !> The command line that makes a simulated record again: what was given but for the file, and the seed.
   function origin_of(words, seed) result(origin)
      type(words_type), intent(in) :: words
      integer(int64), intent(in) :: seed
      character(:), allocatable :: origin

      origin = "gyroakf simulate"//options_of("record", words, "simulate")//" --seed "//integer_text(seed)
   end function origin_of

   !> The options of a group as they were given, each after a blank; of a record without its files and its seed.
   function options_of(group, words, command) result(text)
      character(*), intent(in) :: group
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      character(:), allocatable :: text
      character(8), parameter :: not_of_the_record(3) = [character(8) :: "--output", "--truth", "--seed"]
      integer :: i

      text = ""
      do i = 1, words%used
         associate (option => options(find_option(options(words%given(i)%row)%name, command)))
            if (option%group /= group .or. any(option%name == not_of_the_record)) cycle
            text = text//" "//trim(option%name)
            if (takes_value(option)) text = text//" "//shell_word(words%given(i)%value)
         end associate
      end do
   end function options_of

   !> Applies --preset, or all others; an error in an option of a file is reported with its line.
   subroutine apply_options(words, config, preset, error)
      type(words_type), intent(in) :: words
      class(cli_config), intent(inout) :: config
      logical, intent(in) :: preset
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, words%used
         call apply_option(words%given(i), config, preset, error)
         if (.not. allocated(error)) cycle
         if (allocated(words%given(i)%place)) error%message = words%given(i)%place//": "//error%message
         return
      end do
   end subroutine apply_options

   !> A job that only writes its options.
   subroutine move_to_text(config)
      class(cli_config), allocatable, intent(inout) :: config
      logical :: force

      force = config%force
      deallocate (config)
      allocate (config, source=text_config(command="help", text=""))
      config%force = force
   end subroutine move_to_text

   !> Applies --preset, or any other option.
   subroutine apply_option(given, config, preset, error)
      type(given_type), intent(in) :: given
      class(cli_config), intent(inout) :: config
      logical, intent(in) :: preset
      type(error_type), allocatable, intent(out) :: error
      type(option_type) :: option
      type(value_type) :: value

      option = options(find_option(options(given%row)%name, config%command))
      call convert_value(option, given%value, value, error)
      if (allocated(error)) return
      if (.not. belongs_to(option, config%command)) then
         call usage_error(error, "option '"//trim(option%name)//"' is not one of '"//config%command// &
                          "'; it belongs to: "//trim(option%commands))
         return
      end if
      if (preset .neqv. option%name == "--preset") return
      if (any(option%group == [character(6) :: "output", "work", "common"])) then
         call set_common(config, option, value, error)
         return
      end if
      select type (config)
      class is (reading_config)
         if (option%group == "input") call set_input(config%reader, option, value, error)
      type is (simulate_config)
         if (preset) call set_preset(config, option, value%text, error)
         if (.not. preset) call set_record(config, option, value, error)
      end select
      if (allocated(error)) return
      select type (config)
      type is (analysis_config)
         if (preset) call apply_preset(value%text, config%pipeline, error)
         if (.not. preset) call set_method(config%pipeline, option, value, error)
      end select
   end subroutine apply_option

   !> Words separated by commas.
   function list_of(words) result(list)
      character(*), intent(in) :: words(:)
      character(:), allocatable :: list
      integer :: i

      list = trim(words(1))
      do i = 2, size(words)
         list = list//", "//trim(words(i))
      end do
   end function list_of

end module gyroakf_app_cli
