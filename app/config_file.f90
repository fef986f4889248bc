! SPDX-License-Identifier: MIT
!> Options in a file: `--config FILE` reads it, `--write-config FILE` writes it, so that a run can
!> be repeated.
!>
!> A line is `name = value`, the name that of an option without its dashes (or `command`, `files`),
!> the value a number, true or false, or a text in quotes; # begins a comment. That is a part of
!> TOML.
module gyroakf_app_config_file
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : add_text, text_type
   use gyroakf_release, only : release_string
   use gyroakf_spelling, only : replace_all
   use gyroakf_app_file_list, only : read_lines
   use gyroakf_app_option, only : belongs_to, explained, find_option, suggest_option, takes_value
   use gyroakf_app_option_table, only : command_names, options
   use gyroakf_app_words, only : given_type, is_given, names_command, value_of, words_type
   implicit none (type, external)
   private
   public :: add_config, config_text

   character(*), parameter :: nl = new_line("a"), white = " "//achar(9)//achar(13)

contains

   !> Puts the options of a file before those of the command line, and its command and files where
   !> the line names none.
   subroutine add_config(path, words, error)
      !> The file, "-" is standard input
      character(*), intent(in) :: path
      !> The sorted command line; grows
      type(words_type), intent(inout) :: words
      !> io, parse: with the line
      type(error_type), allocatable, intent(out) :: error
      type(words_type) :: more
      type(text_type), allocatable :: lines(:)
      character(:), allocatable :: command
      integer :: i

      call read_lines(path, "is no file of options", "gyroakf --write-config FILE writes one", &
                      lines, error)
      if (allocated(error)) return
      allocate (more%given(size(lines)), more%word(0))
      command = ""
      do i = 1, size(lines)
         call read_line(lines(i)%text, path//":"//integer_text(int(i, int64)), more, command, error)
         if (allocated(error)) return
      end do
      call join(more, command, words)
   end subroutine add_config

   subroutine read_line(line, place, more, command, error)
      character(*), intent(in) :: line
      !> FILE:LINE
      character(*), intent(in) :: place
      type(words_type), intent(inout) :: more
      character(:), allocatable, intent(inout) :: command
      type(error_type), allocatable, intent(out) :: error
      type(text_type), allocatable :: value(:)
      character(:), allocatable :: name, problem
      integer :: first, equals

      first = verify(line, white)
      if (first == 0) return
      if (line(first:first) == "#") return
      equals = index(line, "=")
      if (equals <= first) then
         call fatal_error(error, status%parse, place//": no 'name = value'"//nl//line//nl// &
                          "# begins a comment")
         return
      end if
      name = line(first:verify(line(:equals - 1), white, back=.true.))
      call read_value(line(equals + 1:), value, problem)
      if (problem /= "") then
         call fatal_error(error, status%parse, place//": "//problem//nl//line)
         return
      end if
      select case (name)
      case ("files"); more%word = value
      case ("command")
         command = value(1)%text
         if (any(command_names == command)) return
         call fatal_error(error, status%parse, place//": unknown command '"//command//"'")
      case default
         call add_option("--"//name, value, place, more, error)
      end select
   end subroutine read_line

   subroutine add_option(name, value, place, more, error)
      character(*), intent(in) :: name
      type(text_type), intent(in) :: value(:)
      character(*), intent(in) :: place
      type(words_type), intent(inout) :: more
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: known
      integer :: row
      logical :: is_flag

      row = find_option(name, "")
      if (row > 0) then
         if (options(row)%group == "common") row = 0
      end if
      if (row > 0) is_flag = .not. takes_value(options(row))
      if (row == 0) then
         known = suggest_option(name)
         if (known == name) known = ""
         if (known /= "") known = "; the nearest is '"//known(3:)//"'"
         call fatal_error(error, status%parse, &
            place//": no option of a file: '"//name(3:)//"'"//known)
      else if (size(value) /= 1) then
         call fatal_error(error, status%parse, place//": only 'files' has a list; '"//name(3:)// &
                          "' has one value, which may hold commas: """//"gx,gy"//"""")
      else if (is_flag .and. all(value(1)%text /= ["true ", "false"])) then
         call fatal_error(error, status%parse, place//": '"//name(3:)//"' is true or false")
      end if
      if (allocated(error)) return
      if (is_flag .and. value(1)%text == "false") return
      more%used = more%used + 1
      more%given(more%used)%row = row
      more%given(more%used)%value = value(1)%text
      if (is_flag) more%given(more%used)%value = ""
      more%given(more%used)%place = place
   end subroutine add_option

   !> The file's options first; its command and files where the command line has none.
   subroutine join(more, command, words)
      type(words_type), intent(in) :: more
      !> Of the file, "" where it has none
      character(*), intent(in) :: command
      type(words_type), intent(inout) :: words
      type(given_type), allocatable :: given(:)
      type(text_type), allocatable :: word(:)
      integer :: i, n
      logical :: named

      allocate (given(more%used + words%used))
      n = 0
      do i = 1, more%used
         if (is_replaced(trim(options(more%given(i)%row)%name), words)) cycle
         n = n + 1
         given(n) = more%given(i)
      end do
      given(n + 1:n + words%used) = words%given(:words%used)
      words%used = n + words%used
      call move_alloc(given, words%given)
      named = names_command(words)
      allocate (word(words%positional + size(more%word) + 1))
      n = 0
      if (command /= "" .and. .not. named) then
         n = 1
         word(1)%text = command
         words%behind_dashes = .false.
      end if
      word(n + 1:n + words%positional) = words%word(:words%positional)
      n = n + words%positional
      if (words%positional == merge(1, 0, named)) then
         word(n + 1:n + size(more%word)) = more%word
         n = n + size(more%word)
      end if
      call move_alloc(word, words%word)
      words%positional = n
   end subroutine join

   !> Whether the line says otherwise what an option of the file says by another name, or what only
   !> goes with another option.
   pure logical function is_replaced(name, words)
      character(*), intent(in) :: name
      type(words_type), intent(in) :: words

      select case (name)
      case ("--rate"); is_replaced = is_given(words, "--dt")
      case ("--dt"); is_replaced = is_given(words, "--rate")
      case ("--outlier-threshold", "--outlier-rounds", "--outlier-window")
         is_replaced = is_given(words, "--outliers")
      case default; is_replaced = .false.
      end select
   end function is_replaced

   !> The file that repeats a command line: what was given, and all else that the command knows as
   !> comments.
   function config_text(words, command, first) result(text)
      !> The command line with the options of --config
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      !> Word of the first file
      integer, intent(in) :: first
      character(:), allocatable :: text
      integer :: i

      text = "# Options of gyroakf "//release_string//": gyroakf --config FILE runs with them, "// &
         "those of the line come on top."//nl//"command = "//quoted(command)//nl
      if (words%positional >= first) then
         text = text//"files = ["//quoted(words%word(first)%text)
         do i = first + 1, words%positional
            text = text//", "//quoted(words%word(i)%text)
         end do
         text = text//"]"//nl
      else if (command /= "simulate" .and. command /= "selftest") then
         text = text//"# files = [""FILE""]"//nl
      end if
      do i = 1, size(options)
         associate (option => options(i))
            if (option%group == "common" .or. .not. belongs_to(option, command)) cycle
            text = text//nl//"# "//explained(option)//nl
            if (.not. is_given(words, option%name)) text = text//"# "
            text = text//trim(option%name(3:))//" = "
            if (.not. takes_value(option)) then
               text = text//"true"//nl
            else if (is_given(words, option%name)) then
               text = text//quoted(value_of(words, option%name))//nl
            else
               text = text//trim(option%value)//nl
            end if
         end associate
      end do
   end function config_text

   !> What stands behind the equals sign: a bare word, a text in quotes, a list of them; a comment
   !> may follow.
   subroutine read_value(text, value, problem)
      character(*), intent(in) :: text
      !> [1], of a list any number
      type(text_type), allocatable, intent(out) :: value(:)
      !> What is wrong; "" if nothing
      character(:), allocatable, intent(out) :: problem
      character(:), allocatable :: line
      integer :: at
      logical :: list

      allocate (value(0))
      problem = ""
      line = text//"#"                             ! a comment at the end at least
      at = verify(line, white)
      list = line(at:at) == "["
      if (list) at = at + 1
      do
         at = at - 1 + verify(line(at:), white)
         if (list .and. line(at:at) == "]") exit
         call read_word(line, at, value, problem)
         if (problem /= "") return
         at = at - 1 + verify(line(at:), white)
         if (.not. list .or. line(at:at) == "]") exit
         if (line(at:at) /= ",") then
            problem = "the list does not end with ]"
            return
         end if
         at = at + 1
      end do
      if (list) at = at + verify(line(at + 1:), white)
      if (line(at:at) /= "#") problem = "something follows the value: '"//text(at:)//"'"
   end subroutine read_value

   !> A text in quotes, with \" and \\ in it, or a bare word.
   subroutine read_word(text, at, value, problem)
      !> With # somewhere behind the word
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      type(text_type), allocatable, intent(inout) :: value(:)
      character(:), allocatable, intent(inout) :: problem
      character(:), allocatable :: word
      integer :: to

      word = ""
      if (text(at:at) == """") then
         at = at + 1
         do while (at <= len(text))
            if (text(at:at) == """") exit
            if (text(at:at) == "\" .and. at < len(text)) at = at + 1
            word = word//text(at:at)
            at = at + 1
         end do
         if (at > len(text)) problem = "the quotes are not closed"
         at = at + 1
      else
         to = scan(text(at:), white//"#,]""")
         word = text(at:at + to - 2)
         at = at + to - 1
         if (word == "") problem = "there is no value"
      end if
      if (problem == "") call add_text(value, word)
   end subroutine read_word

   !> A text in quotes.
   pure function quoted(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word

      word = text
      call replace_all(word, "\", "\\")
      call replace_all(word, """", "\""")
      word = """"//word//""""
   end function quoted

end module gyroakf_app_config_file
