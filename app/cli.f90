! SPDX-License-Identifier: MIT
!> From the words of the command line to a configuration.
!>
!> First the words are sorted into options and positional words by the table in [[gyroakf_app_option]]; the first
!> positional word may be a command. Then the options are checked against the command and applied.
module gyroakf_app_cli
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_app_argument, only : argument_list
   use gyroakf_app_config, only : cli_config, text_config
   use gyroakf_app_help, only : program_help, command_help, version_text, citation_text
   use gyroakf_app_option, only : option_type, options, command_names, find_option, takes_value, belongs_to, &
      suggest_option, suggest_word
   implicit none (type, external)
   private
   public :: get_config

   !> An option as it was given
   type :: given_type
      !> Row of the table
      integer :: row = 0
      !> Its value, "" of a flag
      character(:), allocatable :: value
   end type given_type

   !> The sorted command line
   type :: words_type
      !> [used] options in order
      type(given_type), allocatable :: given(:)
      integer :: used = 0
      !> The first two words that are no options, and how many there are
      character(:), allocatable :: first, second
      integer :: positional = 0
      !> The first one stood behind "--": it is no command
      logical :: behind_dashes = .false.
   end type words_type

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
      character(:), allocatable :: command, path

      call sort_words(arguments, words, error)
      if (allocated(error)) return
      call find_command(words, command, path, error)
      if (allocated(error)) return
      call make_text(words, command, config)
      if (.not. allocated(config)) call usage_error(error, "'"//command//"' "//path//": not available in this version")
   end subroutine get_config

   !> Options with their values, and the other words.
   subroutine sort_words(arguments, words, error)
      type(argument_list), intent(in) :: arguments
      type(words_type), intent(out) :: words
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      logical :: only_words

      allocate (words%given(size(arguments%item)))
      only_words = .false.
      i = 1
      do while (i <= size(arguments%item))
         associate (word => arguments%item(i)%text)
            if (only_words .or. word == "-" .or. len(word) == 0 .or. index(word, "-") /= 1) then
               call add_word(words, word, only_words)
            else if (word == "--") then
               only_words = .true.
            else
               call add_option(arguments, i, words, error)
               if (allocated(error)) return
            end if
         end associate
         i = i + 1
      end do
   end subroutine sort_words

   !> Remembers a word that is no option.
   subroutine add_word(words, word, behind_dashes)
      type(words_type), intent(inout) :: words
      character(*), intent(in) :: word
      logical, intent(in) :: behind_dashes

      words%positional = words%positional + 1
      if (words%positional == 1) then
         words%first = word
         words%behind_dashes = behind_dashes
      else if (words%positional == 2) then
         words%second = word
      end if
   end subroutine add_word

   !> The option at word i, with its value, which may be the next word: then i is moved on.
   subroutine add_option(arguments, i, words, error)
      type(argument_list), intent(in) :: arguments
      integer, intent(inout) :: i
      type(words_type), intent(inout) :: words
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name
      integer :: equals, row

      name = arguments%item(i)%text
      equals = index(name, "=")
      if (equals > 0) name = name(:equals - 1)
      if (name == "-h") name = "--help"
      row = find_option(name, "")
      if (row == 0) then
         call unknown_option(name, error)
         return
      end if
      words%used = words%used + 1
      words%given(words%used)%row = row
      if (equals > 0) then
         if (.not. takes_value(options(row))) then
            call usage_error(error, "option '"//name//"' takes no value")
            return
         end if
         words%given(words%used)%value = arguments%item(i)%text(equals + 1:)
      else if (takes_value(options(row))) then
         call take_next(arguments, i, options(row), words%given(words%used)%value, error)
      else
         words%given(words%used)%value = ""
      end if
   end subroutine add_option

   !> The next word as the value of an option; a number may be negative, "-" is standard input or output.
   subroutine take_next(arguments, i, option, value, error)
      type(argument_list), intent(in) :: arguments
      integer, intent(inout) :: i
      type(option_type), intent(in) :: option
      character(:), allocatable, intent(out) :: value
      type(error_type), allocatable, intent(out) :: error

      if (i < size(arguments%item)) then
         if (index(arguments%item(i + 1)%text, "--") /= 1) then
            i = i + 1
            value = arguments%item(i)%text
            return
         end if
      end if
      call usage_error(error, "option '"//trim(option%name)//"' needs a value: "//trim(option%name)//" "//trim(option%value))
   end subroutine take_next

   !> An option that is in no row, with the nearest one that is.
   subroutine unknown_option(name, error)
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known

      known = suggest_option(name)
      if (known == "") then
         call usage_error(error, "unknown option '"//name//"'; gyroakf --help lists the options")
      else
         call usage_error(error, "unknown option '"//name//"'; the nearest is '"//known//"'")
      end if
   end subroutine unknown_option

   !> The command and the file among the positional words.
   subroutine find_command(words, command, path, error)
      type(words_type), intent(in) :: words
      character(:), allocatable, intent(out) :: command, path
      type(error_type), allocatable, intent(out) :: error
      integer :: files

      command = ""
      path = ""
      files = words%positional
      if (files == 0) return
      if (any(command_names == words%first) .and. .not. words%behind_dashes) then
         command = words%first
         files = files - 1
         if (files > 0) path = words%second
      else
         path = words%first
         call check_command(words, error)
         if (allocated(error)) return
      end if
      if (files > 1) call usage_error(error, "more than one file: '"//words%first//"' and '"//words%second// &
                                      "'; one recording at a time")
   end subroutine find_command

   !> The first word is no command: is it meant as one? Yes where another word follows or no such file is there.
   subroutine check_command(words, error)
      type(words_type), intent(in) :: words
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known
      logical :: there

      if (words%behind_dashes .or. words%first == "-" .or. scan(words%first, "./\") > 0) return
      inquire (file=words%first, exist=there)
      if (there) return
      known = suggest_word(words%first, command_names)
      if (known /= "") then
         call usage_error(error, "unknown command '"//words%first//"', and no file of that name; the nearest command is '"// &
                          known//"'")
      else if (words%positional > 1) then
         call usage_error(error, "unknown command '"//words%first//"'; the commands are "//list_of(command_names))
      end if
   end subroutine check_command

   !> --help, --version and --citation go before everything else.
   subroutine make_text(words, command, config)
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      class(cli_config), allocatable, intent(inout) :: config
      character(:), allocatable :: text
      integer :: i

      do i = 1, words%used
         select case (options(words%given(i)%row)%name)
         case ("--help")
            text = program_help()
            if (command /= "") text = command_help(command)
         case ("--version"); text = version_text()
         case ("--citation"); text = citation_text()
         end select
         if (.not. allocated(text)) cycle
         allocate (config, source=text_config(command=command, text=text))
         return
      end do
   end subroutine make_text

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

   !> An error of the command line.
   subroutine usage_error(error, message)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: message

      call fatal_error(error, status%usage, message)
   end subroutine usage_error

end module gyroakf_app_cli
