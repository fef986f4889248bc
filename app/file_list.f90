! SPDX-License-Identifier: MIT
!> Many files: those of `--list FILE`, one path a line (empty lines and lines that begin with # are
!> passed over), and the names of their result folders: each file's own without its extension, -2,
!> -3 ... where that is taken.
module gyroakf_app_file_list
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_source, only : close_source, open_source, read_block, source_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : document_mark
   implicit none (type, external)
   private
   public :: read_list, read_lines, name_folders, summary_files, summary_marks

   !> A longer list is a data file by mistake
   integer, parameter :: largest = 100000000
   !> What some editors put before UTF-8
   character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   !> What stands beside the folders, and how it is recognized
   character(12), parameter :: summary_files(2) = [character(12) :: "summary.csv", "summary.json"]
   character(23), parameter :: summary_marks(2) = [character(23) :: "path,folder,exit_code", &
      document_mark]

contains

   !> Appends the files of a list to those that were named, blanks and carriage returns taken off.
   subroutine read_list(path, paths, error)
      !> The list, "-" is standard input
      character(*), intent(in) :: path
      !> Grows
      type(text_type), allocatable, intent(inout) :: paths(:)
      !> io, parse: no path in it, too long, no text
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: white = " "//achar(9)//achar(13), advice = "write one path a line"
      type(text_type), allocatable :: lines(:), all_paths(:)
      integer :: i, n, first

      call read_lines(path, "is no list of files", advice, lines, error)
      if (allocated(error)) return
      n = size(paths)
      allocate (all_paths(n + size(lines)))
      all_paths(:n) = paths
      do i = 1, size(lines)
         associate (line => lines(i)%text)
            first = verify(line, white)
            if (index(line, "#") == first) cycle
            n = n + 1
            all_paths(n)%text = line(first:verify(line, white, back=.true.))
         end associate
      end do
      if (n == size(paths)) then
         call fatal_error(error, status%parse, path//": names no file"//new_line("a")//advice)
         return
      end if
      paths = all_paths(:n)
   end subroutine read_list

   !> The lines of a file of text.
   subroutine read_lines(path, what, advice, lines, error)
      !> "-" is standard input
      character(*), intent(in) :: path
      !> Message and advice where it is too long or no text
      character(*), intent(in) :: what, advice
      !> Without line feeds and a byte-order mark
      type(text_type), allocatable, intent(out) :: lines(:)
      !> io, parse
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: buffer(65536)
      type(source_type) :: source
      character(:), allocatable :: text, longer
      integer(int64) :: got
      integer :: first, i, length, used

      call open_source(source, path, error)
      if (allocated(error)) return
      allocate (character(65536) :: text)
      used = 0
      do
         call read_block(source, buffer, got, error)
         if (allocated(error) .or. got == 0) exit
         if (used + got > len(text)) then
            allocate (character(2*len(text)) :: longer)
            longer(:used) = text(:used)
            call move_alloc(longer, text)
         end if
         do i = 1, int(got)
            text(used + i:used + i) = achar(iand(int(buffer(i)), 255))
         end do
         used = used + int(got)
         if (used > largest .or. index(text(used - int(got) + 1:used), achar(0)) > 0) then
            call fatal_error(error, status%parse, path//": "//what//new_line("a")//advice)
            exit
         end if
      end do
      call close_source(source)
      if (allocated(error)) return
      allocate (lines(1 + count([(text(i:i) == new_line("a"), i=1, used)])))
      first = 1
      if (index(text(:used), byte_order_mark) == 1) first = 1 + len(byte_order_mark)
      do i = 1, size(lines)
         length = index(text(first:used), new_line("a")) - 1
         if (length < 0) length = used - first + 1
         lines(i)%text = text(first:first + length - 1)
         first = first + length + 1
      end do
   end subroutine read_lines

   !> One name for each path, in their order, no two the same.
   subroutine name_folders(paths, names)
      !> As they were given; "-" is standard input
      type(text_type), intent(in) :: paths(:)
      !> Without a slash: [size(paths)]
      type(text_type), allocatable, intent(out) :: names(:)
      type(text_type), allocatable :: taken(:)
      integer, allocatable :: last(:)                       ! largest number tried behind a name
      integer :: base, at, i, n

      n = size(summary_files)
      allocate (taken(n + size(paths)), names(size(paths)))
      allocate (last(size(taken)), source=1)
      do i = 1, n
         taken(i)%text = trim(summary_files(i))
      end do
      do i = 1, size(paths)
         names(i)%text = base_name(paths(i)%text)
         base = place_of(names(i)%text, taken(:n))
         at = base
         do while (at > 0)
            last(base) = last(base) + 1
            names(i)%text = base_name(paths(i)%text)//"-"//integer_text(int(last(base), int64))
            at = place_of(names(i)%text, taken(:n))
         end do
         n = n + 1
         taken(n)%text = names(i)%text
      end do
   end subroutine name_folders

   !> Where a name stands, 0 where it does not.
   pure integer function place_of(name, names) result(place)
      character(*), intent(in) :: name
      type(text_type), intent(in) :: names(:)

      do place = size(names), 1, -1
         if (len(names(place)%text) /= len(name)) cycle
         if (names(place)%text == name) return
      end do
   end function place_of

   !> "b" of "a/b.txt", "stdin" of "-".
   pure function base_name(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name
      integer :: dot

      name = path(index(path, "/", back=.true.) + 1:)
      if (path == "-") name = "stdin"
      dot = index(name, ".", back=.true.)
      if (dot > 1) name = name(:dot - 1)
      if (name == "" .or. verify(name, ".") == 0) name = "file"
   end function base_name

end module gyroakf_app_file_list
