! SPDX-License-Identifier: MIT
!> The files of `--list FILE`: one path a line, empty lines and lines that begin with # are passed over.
module gyroakf_app_file_list
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_source, only : close_source, open_source, read_block, source_type
   use gyroakf_record, only : text_type
   implicit none (type, external)
   private
   public :: read_list, read_text

   !> A longer list is a data file by mistake
   integer, parameter :: largest = 100000000
   character(*), parameter :: no_list = "is no list of files", how_to_write = "write one path a line"
   !> What some editors put before UTF-8
   character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

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
      integer :: i, n, first, last, length

      call read_text(path, no_list, how_to_write, text, error)
      if (allocated(error)) return
      n = size(paths) + 1
      do i = 1, len(text)
         if (text(i:i) == new_line("a")) n = n + 1
      end do
      allocate (all_paths(n))
      n = size(paths)
      do i = 1, n
         call move_alloc(paths(i)%text, all_paths(i)%text)
      end do
      first = 1
      do while (first <= len(text))
         length = index(text(first:), new_line("a")) - 1
         if (length < 0) length = len(text) - first + 1
         last = first + length - 1
         call add_line(text(first:last), all_paths, n)
         first = last + 2
      end do
      if (n == size(paths)) then
         call fatal_error(error, status%parse, path//": names no file"//new_line("a")//how_to_write)
         return
      end if
      deallocate (paths)
      allocate (paths(n))
      do i = 1, n
         call move_alloc(all_paths(i)%text, paths(i)%text)
      end do
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

end module gyroakf_app_file_list
