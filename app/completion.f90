! SPDX-License-Identifier: MIT
!> Completion scripts for bash, zsh and fish: `gyroakf --completion SHELL`, made from the table of
!> options.
module gyroakf_app_completion
   use gyroakf_spelling, only : replace_all
   use gyroakf_app_option, only : belongs_to, commands_of, explained, takes_value
   use gyroakf_app_option_table, only : command_names, commands, option_type, options
   use gyroakf_app_words, only : joined, quoted => shell_quoted
   implicit none (type, external)
   private
   public :: completion_text

   character(*), parameter :: nl = new_line("a")

contains

   !> The script of a shell.
   function completion_text(shell) result(text)
      !> bash, zsh or fish
      character(*), intent(in) :: shell
      character(:), allocatable :: text

      select case (shell)
      case ("fish"); text = fish_text()
      case ("zsh"); text = zsh_text()
      case default; text = bash_text()
      end select
   end function completion_text

   !> bash: options of the command, words of the option before, else files.
   function bash_text() result(text)
      character(:), allocatable :: text, list
      integer :: i, j

      text = "# bash completion of gyroakf; made by: gyroakf --completion bash"//nl// &
         "_gyroakf() {"//nl//"  local cur=${COMP_WORDS[COMP_CWORD]} "// &
         "prev=${COMP_WORDS[COMP_CWORD-1]} command=run words="//nl// &
         "  case ${COMP_WORDS[1]} in"//nl//"    "//joined(command_names, "|")// &
         ") command=${COMP_WORDS[1]} ;;"//nl//"  esac"//nl//"  case $command:$prev in"//nl
      do i = 1, size(options)
         if (options(i)%kind(:6) /= "choice") cycle
         list = ""
         do j = 1, size(command_names)
            if (.not. belongs_to(options(i), command_names(j))) cycle
            list = list//"|"//trim(command_names(j))//":"//trim(options(i)%name)
         end do
         text = text//"    "//list(2:)//") words='"//spaced(options(i)%value)//"' ;;"//nl
      end do
      text = text//"  esac"//nl//"  if [ -z ""$words"" ] && [[ $cur == -* ]]; then"//nl// &
         "    case $command in"//nl
      do j = 1, size(command_names)
         text = text//"      "//trim(command_names(j))//") words='"//names_of(command_names(j))// &
            "' ;;"//nl
      end do
      text = text//"    esac"//nl//"  fi"//nl// &
         "  [[ $COMP_CWORD -gt 1 && $prev != help || $cur == -* ]] || words='"// &
         joined(command_names, " ")//" help version'"//nl// &
         '  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")'//nl//"}"//nl// &
         "complete -o default -o bashdefault -F _gyroakf gyroakf"//nl
   end function bash_text

   !> zsh: _arguments of each command.
   function zsh_text() result(text)
      character(:), allocatable :: text
      integer :: i, j

      text = "#compdef gyroakf"//nl// &
         "# zsh completion of gyroakf; made by: gyroakf --completion zsh"//nl// &
         "local command=run"//nl//"case ${words[2]} in"//nl// &
         "  "//joined(command_names, "|")//") command=${words[2]} ;;"//nl//"esac"//nl// &
         "if (( CURRENT == 2 )) && [[ ${words[2]} != -* ]]; then"//nl//"  local -a commands=("//nl
      do i = 1, size(commands, 2)
         text = text//"    "//quoted(trim(commands(1, i))//":"//trim(commands(2, i)))//nl
      end do
      text = text//"  )"//nl//"  _describe command commands"//nl//"fi"//nl//"case $command in"//nl
      do j = 1, size(command_names)
         text = text//"  "//trim(command_names(j))//") _arguments -s \"//nl
         do i = 1, size(options)
            if (.not. belongs_to(options(i), command_names(j))) cycle
            text = text//zsh_spec(options(i), options(i)%name)
            if (options(i)%short /= "") text = text//zsh_spec(options(i), options(i)%short)
         end do
         text = text//"    '*:file:_files' ;;"//nl
      end do
      text = text//"esac"//nl
   end function zsh_text

   function zsh_spec(option, name) result(spec)
      type(option_type), intent(in) :: option
      character(*), intent(in) :: name
      character(4), parameter :: escaped = "\[]:"
      character(:), allocatable :: spec
      integer :: i

      spec = explained(option)
      do i = 1, 4
         call replace_all(spec, escaped(i:i), "\"//escaped(i:i))
      end do
      spec = trim(name)//"["//spec//"]"
      if (option%kind(:6) == "choice") then
         spec = spec//":value:("//spaced(option%value)//")"
      else if (any(option%value == ["FILE", "DIR "])) then
         spec = spec//":file:_files"
      else if (takes_value(option)) then
         spec = spec//":value: "
      end if
      spec = "    "//quoted(spec)//" \"//nl
   end function zsh_spec

   !> fish: a line for each option, with the commands that know it.
   function fish_text() result(text)
      character(:), allocatable :: text, condition
      integer :: i

      text = "# fish completion of gyroakf; made by: gyroakf --completion fish"//nl
      do i = 1, size(commands, 2)
         text = text//"complete -c gyroakf -n __fish_use_subcommand -a "//trim(commands(1, i))// &
            " -d "//quoted(trim(commands(2, i)))//nl
      end do
      do i = 1, size(options)
         condition = "__fish_seen_subcommand_from "//trim(commands_of(options(i)))
         if (belongs_to(options(i), "run")) condition = condition// &
            "; or not __fish_seen_subcommand_from "//joined(command_names, " ")
         text = text//"complete -c gyroakf -n "//quoted(condition)//" -l "// &
            trim(options(i)%name(3:))//" -d "//quoted(explained(options(i)))
         if (options(i)%short /= "") text = text//" -s "//options(i)%short(2:)
         if (options(i)%kind(:6) == "choice") then
            text = text//" -x -a "//quoted(spaced(options(i)%value))
         else if (takes_value(options(i))) then
            text = text//" -r"
         end if
         text = text//nl
      end do
   end function fish_text

   function names_of(command) result(list)
      character(*), intent(in) :: command
      character(:), allocatable :: list
      integer :: i

      list = ""
      do i = 1, size(options)
         if (.not. belongs_to(options(i), command)) cycle
         list = list//" "//trim(options(i)%name)
         if (options(i)%short /= "") list = list//" "//options(i)%short
      end do
      list = list(2:)
   end function names_of

   !> Words separated by blanks instead of |.
   function spaced(words) result(list)
      character(*), intent(in) :: words
      character(:), allocatable :: list

      list = trim(words)
      call replace_all(list, "|", " ")
   end function spaced

end module gyroakf_app_completion
