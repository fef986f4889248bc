! SPDX-License-Identifier: MIT
!> `--repeat FILE`: command, options and files of a run, from the results.json that it wrote.
!>
!> Where the results went and how the program showed them is not repeated: --out, --json, --plot, --quiet, ... are of the new line.
module gyroakf_app_repeat
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : add_text
   use gyroakf_report_document_origin, only : input_file_type
   use gyroakf_report_json_reader, only : find_item, json_item, read_json, text_of
   use gyroakf_app_config_file, only : join
   use gyroakf_app_file_list, only : read_text
   use gyroakf_app_option, only : command_names, find_option, is_of_the_line, options, takes_value
   use gyroakf_app_words, only : is_given, usage_error, words_type
   implicit none (type, external)
   private
   public :: add_repeat

   character(*), parameter :: nl = new_line("a")
   !> Options that do not change a number of the results
   character(10), parameter :: of_the_place(15) = [character(10) :: "--out", "--json", "--kalibr", "--plot", "--force", "--quiet", &
      & "--list", "--progress", "--threads", "--dt", "--markdown", "--latex", "--chart", "--color", "--ascii"]
   character(*), parameter :: advice = "gyroakf run FILE --out DIR writes a results.json that can be repeated"

contains

   !> Puts the options of a results.json before those of the command line.
   subroutine add_repeat(path, words, error)
      !> The file, "-" is standard input
      character(*), intent(in) :: path
      !> The sorted command line; grows
      type(words_type), intent(inout) :: words
      !> io; parse: with line and column; usage: another command
      type(error_type), allocatable, intent(out) :: error
      type(words_type) :: more
      type(json_item), allocatable :: items(:)
      character(:), allocatable :: text, command

      call read_text(path, "is no results.json", advice, text, error)
      if (allocated(error)) return
      call read_json(text, items, error)
      if (allocated(error)) then
         error%message = path//":"//error%message//nl//advice
         return
      end if
      call take_command(path, items, words, command, error)
      if (.not. allocated(error)) call take_options(path, items, more, error)
      if (.not. allocated(error)) call take_files(path, items, words, command, more, error)
      if (allocated(error)) return
      call move_alloc(more%expected, words%expected)
      call join(more, command, words)
   end subroutine add_repeat

   !> The command; the line may name the same one.
   subroutine take_command(path, items, words, command, error)
      character(*), intent(in) :: path
      type(json_item), intent(in) :: items(:)
      type(words_type), intent(in) :: words
      character(:), allocatable, intent(out) :: command
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: program

      call text_at(items, "/program", program)
      call text_at(items, "/origin/command", command)
      if (program /= "gyroakf") then
         call fatal_error(error, status%parse, path//": was not written by gyroakf"//nl//advice)
      else if (command == "") then
         call fatal_error(error, status%parse, path//": does not tell the options of its run; the library and older versions "// &
                          "do not write them"//nl//advice)
      else if (.not. any(command_names == command)) then
         call fatal_error(error, status%parse, path//": unknown command '"//command//"'"//nl//advice)
      else if (words%positional > 0 .and. .not. words%behind_dashes) then
         associate (word => words%word(1)%text)
            if (any(command_names == word) .and. word /= command) then
              call usage_error(error, path//" is of another command: gyroakf "//command//" --repeat "//path)
            end if
         end associate
      end if
   end subroutine take_command

   !> The options that were given and say how the numbers are made.
   subroutine take_options(path, items, more, error)
      character(*), intent(in) :: path
      type(json_item), intent(in) :: items(:)
      type(words_type), intent(inout) :: more
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name, value, place
      integer :: i, j, row

      allocate (more%given(size(items)), more%word(0))
      do i = 1, size(items)
         if (index(items(i)%path, "/origin/given/") /= 1) cycle
         call text_of(items(i)%text, name)
         j = find_item(items, "/origin/options/"//name)
         place = path//":"//integer_text(int(items(i)%line, int64))
         if (j > 0) place = path//":"//integer_text(int(items(j)%line, int64))
         name = "--"//name
         row = find_option(name, "")
         if (j == 0 .or. is_of_the_line(name)) row = 0
         if (row == 0) then
            call fatal_error(error, status%parse, place//": this version has no option '"//name//"'"//nl// &
                             "repeat the run with the version that wrote the file")
            return
         end if
         if (any(of_the_place == name) .or. items(j)%text == "null" .or. items(j)%text == "false") cycle
         call text_of(items(j)%text, value)
         if (.not. takes_value(options(row))) value = ""
         more%used = more%used + 1
         more%given(more%used)%row = row
         more%given(more%used)%value = value
         more%given(more%used)%place = place
      end do
   end subroutine take_options

   !> The recording, and the checksums of the files that the line does not name.
   subroutine take_files(path, items, words, command, more, error)
      character(*), intent(in) :: path
      type(json_item), intent(in) :: items(:)
      type(words_type), intent(in) :: words
      character(*), intent(in) :: command
      type(words_type), intent(inout) :: more
      type(error_type), allocatable, intent(out) :: error
      type(input_file_type) :: file
      character(:), allocatable :: parent
      logical :: named
      integer :: i, first

      first = 1
      if (words%positional > 0 .and. .not. words%behind_dashes) then
         if (words%word(1)%text == command) first = 2
      end if
      allocate (more%expected(0))
      do i = 0, 1
         parent = "/origin/files/"//integer_text(int(i, int64))
         if (find_item(items, parent) == 0) exit
         call read_file(path, items, parent, file, error)
         if (allocated(error)) return
         if (allocated(file%option)) then
            named = is_given(words, "--truth")
         else
            named = words%positional >= first .or. is_given(words, "--list")
            if (.not. named) call add_text(more%word, file%path)
         end if
         if (file%checksum%known .and. .not. named) call add_file(more%expected, file)
      end do
   end subroutine take_files

   !> A file of the run.
   subroutine read_file(path, items, parent, file, error)
      character(*), intent(in) :: path, parent
      type(json_item), intent(in) :: items(:)
      type(input_file_type), intent(out) :: file
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      integer :: stat

      call text_at(items, parent//"/option", text)
      if (text /= "") file%option = text
      call text_at(items, parent//"/path", file%path)
      call text_at(items, parent//"/sha256", text)
      file%checksum%known = text /= ""
      file%checksum%sha256 = text
      call text_at(items, parent//"/bytes", text)
      stat = 0
      if (file%checksum%known) read (text, *, iostat=stat) file%checksum%bytes
      if (file%path == "" .or. stat /= 0 .or. (file%checksum%known .and. len_trim(file%checksum%sha256) /= 64)) then
        call fatal_error(error, status%parse, path//": 'origin' is damaged: path, bytes and sha256 of a file do not belong "// &
                          "together"//nl//advice)
      end if
   end subroutine read_file

   !> The text at a path, "" where there is none.
   subroutine text_at(items, path, text)
      type(json_item), intent(in) :: items(:)
      character(*), intent(in) :: path
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = ""
      i = find_item(items, path)
      if (i == 0) return
      if (items(i)%text /= "null") call text_of(items(i)%text, text)
   end subroutine text_at

   subroutine add_file(list, file)
      type(input_file_type), allocatable, intent(inout) :: list(:)
      type(input_file_type), intent(in) :: file
      type(input_file_type), allocatable :: longer(:)
      integer :: i

      allocate (longer(size(list) + 1))
      do i = 1, size(list)
         longer(i) = list(i)
      end do
      longer(size(longer)) = file
      call move_alloc(longer, list)
   end subroutine add_file

end module gyroakf_app_repeat
