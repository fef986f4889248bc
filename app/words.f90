! SPDX-License-Identifier: MIT
!> The words of the command line, sorted into options with their values and other words by the table
!> of options.
module gyroakf_app_words
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_record, only : text_type
   use gyroakf_spelling, only : replace_all
   use gyroakf_app_option, only : find_option, suggest_option, takes_value
   use gyroakf_app_option_table, only : command_names, option_type, options
   implicit none (type, external)
   private
   public :: given_type, words_type, read_arguments, sort_words, is_given, value_of, names_command
   public :: usage_error, shell_quoted, shell_word, joined

   !> An option as it was given
   type :: given_type
      !> Row of the table
      integer :: row = 0
      !> Its value, "" of a flag
      character(:), allocatable :: value
      !> FILE:LINE where it stands in a file of options
      character(:), allocatable :: place
   end type given_type

   !> The sorted command line
   type :: words_type
      !> [used] options in order
      type(given_type), allocatable :: given(:)
      integer :: used = 0
      !> [positional] the words that are no options, in order
      type(text_type), allocatable :: word(:)
      integer :: positional = 0
      !> The first one stood behind "--": it is no command
      logical :: behind_dashes = .false.
   end type words_type

contains

   !> The words behind the program's name, trailing blanks included.
   subroutine read_arguments(arguments)
      !> In their order
      type(text_type), allocatable, intent(out) :: arguments(:)
      integer :: i, length

      allocate (arguments(command_argument_count()))
      do i = 1, size(arguments)
         call get_command_argument(i, length=length)
         allocate (character(length) :: arguments(i)%text)
         if (length > 0) call get_command_argument(i, arguments(i)%text)
      end do
   end subroutine read_arguments

   !> Options with their values, and the other words.
   subroutine sort_words(arguments, words, error)
      !> The command line
      type(text_type), intent(in) :: arguments(:)
      !> The same, sorted
      type(words_type), intent(out) :: words
      !> usage: an unknown option, a value that is missing or too much
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      logical :: only_words

      allocate (words%given(size(arguments)), words%word(size(arguments)))
      only_words = .false.
      i = 1
      do while (i <= size(arguments))
         associate (word => arguments(i)%text)
            if (only_words .or. word == "-" .or. len(word) == 0 .or. index(word, "-") /= 1) then
               words%positional = words%positional + 1
               words%word(words%positional)%text = word
               if (words%positional == 1) words%behind_dashes = only_words
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

   !> The option at word i, with its value, which may be the next word: then i is moved on. A number
   !> may be negative, "-" is standard input or output.
   subroutine add_option(arguments, i, words, error)
      type(text_type), intent(in) :: arguments(:)
      integer, intent(inout) :: i
      type(words_type), intent(inout) :: words
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name, value
      type(option_type) :: option
      integer :: equals, row
      logical :: follows

      name = arguments(i)%text
      equals = index(name, "=")
      if (equals > 0) name = name(:equals - 1)
      row = find_option(name, "")
      if (row == 0) then
         call unknown_option(name, error)
         return
      end if
      option = options(row)
      value = ""
      if (equals > 0) then
         value = arguments(i)%text(equals + 1:)
         if (.not. (takes_value(option) .or. (option%kind == "all" .and. value == "all"))) then
            call usage_error(error, "option '"//name//"' takes no value"// &
                             trim(merge(" but all", "        ", option%kind == "all")))
         end if
      else if (takes_value(option)) then
         follows = i < size(arguments)
         if (follows) follows = index(arguments(i + 1)%text, "--") /= 1 .and. &
            find_option(arguments(i + 1)%text, "") == 0
         i = i + 1
         if (follows) value = arguments(i)%text
         if (.not. follows) call usage_error(error, "option '"//trim(option%name)// &
            "' needs a value: "//trim(option%name)//" "//trim(option%value))
      end if
      words%used = words%used + 1
      words%given(words%used)%row = row
      words%given(words%used)%value = value
   end subroutine add_option

   subroutine unknown_option(name, error)
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known

      known = suggest_option(name)
      if (known == "") then
         known = "gyroakf --help=all lists the options"
      else
         known = "the nearest is '"//known//"'"
      end if
      call usage_error(error, "unknown option '"//name//"'; "//known)
   end subroutine unknown_option

   !> Whether the first word is the name of a command.
   pure logical function names_command(words)
      !> The sorted command line
      type(words_type), intent(in) :: words

      names_command = words%positional > 0 .and. .not. words%behind_dashes
      if (names_command) names_command = any(command_names == words%word(1)%text)
   end function names_command

   !> Whether an option was given.
   pure logical function is_given(words, name)
      !> The sorted command line
      type(words_type), intent(in) :: words
      !> With its dashes
      character(*), intent(in) :: name

      is_given = any(options(words%given(:words%used)%row)%name == name)
   end function is_given

   !> The last value that an option was given, "" where it was not.
   pure function value_of(words, name) result(value)
      !> The sorted command line
      type(words_type), intent(in) :: words
      !> With its dashes
      character(*), intent(in) :: name
      character(:), allocatable :: value
      integer :: i

      value = ""
      do i = 1, words%used
         if (options(words%given(i)%row)%name == name) value = words%given(i)%value
      end do
   end function value_of

   !> An error of the command line.
   subroutine usage_error(error, message)
      !> usage
      type(error_type), allocatable, intent(out) :: error
      !> What is wrong and what to do
      character(*), intent(in) :: message

      call fatal_error(error, status%usage, message)
   end subroutine usage_error

   !> A word as a shell takes it, in quotes where it needs them.
   pure function shell_word(text) result(word)
      !> Any
      character(*), intent(in) :: text
      character(:), allocatable :: word
      character(*), parameter :: plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"// &
         "0123456789.,:/=+-_^%"

      word = text
      if (len(text) == 0 .or. verify(text, plain) > 0) word = shell_quoted(text)
   end function shell_word

   !> A text in the single quotes of the shell.
   pure function shell_quoted(text) result(word)
      !> Any
      character(*), intent(in) :: text
      character(:), allocatable :: word

      word = text
      call replace_all(word, "'", "'\''")
      word = "'"//word//"'"
   end function shell_quoted

   !> Words in a row.
   pure function joined(words, between) result(list)
      !> At least one, blank padded, and what stands between them
      character(*), intent(in) :: words(:), between
      character(:), allocatable :: list
      integer :: i

      list = trim(words(1))
      do i = 2, size(words)
         list = list//between//trim(words(i))
      end do
   end function joined

end module gyroakf_app_words
