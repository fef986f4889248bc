! SPDX-License-Identifier: MIT
!> Many files: those of `--list FILE`, one path a line (empty lines and lines that begin with # are passed over), and the names of
!> their result folders: each file's own without its extension, -2, -3 ... where that is taken.
module gyroakf_app_file_list
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_source, only : close_source, open_source, read_block, source_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : text_type
   use gyroakf_report_files, only : document_mark
   implicit none (type, external)
   private
   public :: read_list, read_text, name_folders, summary_files, summary_marks

   !> A longer list is a data file by mistake
   integer, parameter :: largest = 100000000
   character(*), parameter :: no_list = "is no list of files", how_to_write = "write one path a line"
   !> What some editors put before UTF-8
   character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   !> What stands beside the folders, and how it is recognized
   character(12), parameter :: summary_files(2) = [character(12) :: "summary.csv", "summary.json"]
   character(23), parameter :: summary_marks(2) = [character(23) :: "path,folder,exit_code", document_mark]

   !> Names that are taken, found by a hash of theirs
   type :: name_table
      !> [power of two] unallocated where free
      type(text_type), allocatable :: name(:)
      !> Largest number that was tried behind the name
      integer, allocatable :: last(:)
   end type name_table

contains

   !> Appends the files of a list to those that were named.
   subroutine read_list(path, paths, error)
      !> The list, "-" is standard input
      character(*), intent(in) :: path
      !> Grows
      type(text_type), allocatable, intent(inout) :: paths(:)
      !> io, parse: no path in it, too long, no text
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      type(text_type), allocatable :: all_paths(:)
      integer :: i, n, first, length

      call read_text(path, no_list, how_to_write, text, error)
      if (allocated(error)) return
      allocate (all_paths(size(paths) + 1 + count([(text(i:i) == new_line("a"), i=1, len(text))])))
      n = size(paths)
      do i = 1, n
         call move_alloc(paths(i)%text, all_paths(i)%text)
      end do
      first = 1
      do while (first <= len(text))
         length = index(text(first:), new_line("a")) - 1
         if (length < 0) length = len(text) - first + 1
         call add_line(text(first:first + length - 1), all_paths, n)
         first = first + length + 1
      end do
      if (n == size(paths)) then
         call fatal_error(error, status%parse, path//": names no file"//new_line("a")//how_to_write)
         return
      end if
      paths = all_paths(:n)
   end subroutine read_list

   !> A path, blanks and a carriage return around it taken off.
   subroutine add_line(line, paths, n)
      character(*), intent(in) :: line
      type(text_type), intent(inout) :: paths(:)
      integer, intent(inout) :: n
      character(*), parameter :: white = " "//achar(9)//achar(13)
      integer :: first

      first = verify(line, white)
      if (first == 0) return
      if (line(first:first) == "#") return
      n = n + 1
      paths(n)%text = line(first:verify(line, white, back=.true.))
   end subroutine add_line

   !> A whole file of text.
   subroutine read_text(path, what, advice, text, error)
      !> "-" is standard input
      character(*), intent(in) :: path
      !> Message and advice where it is too long or no text
      character(*), intent(in) :: what, advice
      !> Its bytes, a byte-order mark left out
      character(:), allocatable, intent(out) :: text
      !> io, parse
      type(error_type), allocatable, intent(out) :: error
      integer(int8) :: buffer(65536)
      type(source_type) :: source
      character(:), allocatable :: longer
      integer(int64) :: got
      integer :: at, i, used

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
      at = 1
      if (index(text(:used), byte_order_mark) == 1) at = 4
      text = text(at:used)
   end subroutine read_text

   !> One name for each path, in their order, no two the same.
   subroutine name_folders(paths, names)
      !> As they were given; "-" is standard input
      type(text_type), intent(in) :: paths(:)
      !> Without a slash: [size(paths)]
      type(text_type), allocatable, intent(out) :: names(:)
      type(name_table) :: taken
      integer :: i, slot, base, capacity

      capacity = 64
      do while (capacity < 4*size(paths))
         capacity = 2*capacity
      end do
      allocate (taken%name(capacity), taken%last(capacity), names(size(paths)))
      taken%last = 1
      do i = 1, size(summary_files)
         slot = slot_of(taken, trim(summary_files(i)))
         taken%name(slot)%text = trim(summary_files(i))
      end do
      do i = 1, size(paths)
         names(i)%text = base_name(paths(i)%text)
         base = slot_of(taken, names(i)%text)
         slot = base
         do while (allocated(taken%name(slot)%text))
            taken%last(base) = taken%last(base) + 1
            names(i)%text = base_name(paths(i)%text)//"-"//integer_text(int(taken%last(base), int64))
            slot = slot_of(taken, names(i)%text)
         end do
         taken%name(slot)%text = names(i)%text
      end do
   end subroutine name_folders

   !> Where a name stands, or the free place where it would.
   pure integer function slot_of(taken, name) result(slot)
      type(name_table), intent(in) :: taken
      character(*), intent(in) :: name
      integer(int64) :: hash
      integer :: i

      hash = 5381
      do i = 1, len(name)
         hash = modulo(33*hash + iachar(name(i:i)), 4294967296_int64)
      end do
      slot = int(modulo(hash, size(taken%name, kind=int64))) + 1
      do while (allocated(taken%name(slot)%text))
         if (taken%name(slot)%text == name .and. len(taken%name(slot)%text) == len(name)) return
         slot = modulo(slot, size(taken%name)) + 1
      end do
   end function slot_of

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
