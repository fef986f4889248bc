! SPDX-License-Identifier: MIT
!> What is asked of the table of options: rows by their names, suggestions for misspelt words, and
!> messages of the library with the options that set its arguments.
module gyroakf_app_option
   use gyroakf_io_decimal, only : format_real
   use gyroakf_record, only : text_type
   use gyroakf_spelling, only : edit_distance, nearest_word, replace_all
   use gyroakf_app_option_table, only : groups, option_type, options
   implicit none (type, external)
   private
   public :: find_option, option_names, explained, takes_value, belongs_to, commands_of
   public :: suggest_option, suggest_word, name_options, name_options_in

contains

   !> Row of an option for a command; where the command does not know it, its first row; 0 where no
   !> row has the name.
   pure integer function find_option(name, command)
      !> With its dashes, long or short
      character(*), intent(in) :: name
      !> A command; "" for any
      character(*), intent(in) :: command
      integer :: i

      find_option = 0
      if (name == "") return
      do i = 1, size(options)
         if (options(i)%name /= name .and. options(i)%short /= name) cycle
         if (find_option == 0) find_option = i
         if (belongs_to(options(i), command)) find_option = i
      end do
   end function find_option

   !> The short and the long form, as in "-o, --out".
   pure function option_names(option) result(names)
      !> A row
      type(option_type), intent(in) :: option
      character(:), allocatable :: names

      names = trim(option%name)
      if (option%short /= "") names = option%short//", "//names
   end function option_names

   !> What an option does, with the end of its range.
   function explained(option) result(text)
      !> A row
      type(option_type), intent(in) :: option
      character(:), allocatable :: text

      text = trim(option%help)
      if (option%upper < huge(option%upper)) text = text//"; at most "//format_real(option%upper, 6)
   end function explained

   !> Whether a value follows.
   pure logical function takes_value(option)
      !> A row
      type(option_type), intent(in) :: option

      takes_value = all(option%kind /= [character(4) :: "flag", "all"])
   end function takes_value

   !> Whether a command knows the option.
   pure logical function belongs_to(option, command)
      !> A row
      type(option_type), intent(in) :: option
      !> A command
      character(*), intent(in) :: command

      belongs_to = index(" "//commands_of(option)//" ", " "//trim(command)//" ") > 0
   end function belongs_to

   !> The commands that know an option, separated by blanks.
   pure character(len(options%commands)) function commands_of(option)
      !> A row
      type(option_type), intent(in) :: option

      commands_of = groups(findloc(groups%name, option%group, dim=1))%commands
      if (option%commands /= "") commands_of = option%commands
   end function commands_of

   !> The known option that a misspelt one probably means, "" if none is near.
   !>
   !> The distance to an option is that to its whole name or to its last part: --threshold means
   !> --outlier-threshold.
   function suggest_option(name) result(known)
      !> As it was typed, with its dashes
      character(*), intent(in) :: name
      character(:), allocatable :: known, full
      integer :: i, distance, best

      known = ""
      if (len(name) < 3 .or. len(name) > 2*len(options%name)) return
      best = (len(name) - 2)/2 + 1
      do i = 1, size(options)
         full = trim(options(i)%name)
         distance = min(edit_distance(name(3:), full(3:)), &
            edit_distance(name(3:), full(index(full, "-", back=.true.) + 1:)))
         if (distance >= best) cycle
         best = distance
         known = full
      end do
   end function suggest_option

   !> A message of the library, which names its arguments in grave accents: with the options that
   !> set them.
   subroutine name_options(text)
      !> Any text
      character(:), allocatable, intent(inout) :: text
      character(:), allocatable :: argument
      integer :: i

      if (index(text, "`") == 0) return
      do i = 1, size(options)
         argument = trim(options(i)%argument)
         if (argument == "") argument = trim(options(i)%name(3:))
         call replace_all(argument, "-", "_")
         call replace_all(text, "`"//argument//"`", trim(options(i)%name))
      end do
   end subroutine name_options

   !> The same for a list of messages.
   subroutine name_options_in(list)
      !> Any texts; may be unallocated
      type(text_type), allocatable, intent(inout) :: list(:)
      integer :: i

      if (.not. allocated(list)) return
      do i = 1, size(list)
         call name_options(list(i)%text)
      end do
   end subroutine name_options_in

   !> The nearest of some words, "" if none is near.
   function suggest_word(word, words) result(known)
      !> As it was typed
      character(*), intent(in) :: word
      !> [n] the known ones
      character(*), intent(in) :: words(:)
      character(:), allocatable :: known
      integer :: i

      known = ""
      if (len_trim(word) > 2*len(words)) return
      i = nearest_word(word, words)
      if (i > 0) known = trim(words(i))
   end function suggest_word

end module gyroakf_app_option
