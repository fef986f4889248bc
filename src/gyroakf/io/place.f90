! SPDX-License-Identifier: MIT
!> Messages that show the place in a file: `FILE:LINE:COLUMN: what is wrong`, the line, a caret, what to do.
module gyroakf_io_place
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: place_error, place_message, shown_bytes, integer_text

   !> So many characters of a long line are shown
   integer, parameter :: width = 96

contains

   !> An error of code parse at a place in a file.
   pure subroutine place_error(error, name, line, bytes, first, last, at, what, advice)
      !> Allocated
      type(error_type), allocatable, intent(out) :: error
      !> The file
      character(*), intent(in) :: name
      !> The line's number, from 1
      integer(int64), intent(in) :: line
      !> Holds the line at first:last, without its end
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> The byte that the caret is under, first to last + 1
      integer(int64), intent(in) :: at
      !> What is wrong
      character(*), intent(in) :: what
      !> What to do
      character(*), intent(in) :: advice

      call fatal_error(error, status%parse, place_message(name, line, bytes, first, last, at, what, advice))
   end subroutine place_error

   !> The message alone; columns are counted in characters (UTF-8), from 1.
   pure function place_message(name, line, bytes, first, last, at, what, advice) result(message)
      !> As those of [[place_error]]
      character(*), intent(in) :: name, what, advice
      integer(int64), intent(in) :: line, first, last, at
      integer(int8), intent(in), contiguous :: bytes(:)
      character(:), allocatable :: message
      character(1), parameter :: nl = new_line("a")
      character(:), allocatable :: head, tail
      integer(int64) :: from, to, column

      column = characters(bytes, first, at - 1) + 1
      from = first
      to = last
      head = ""
      tail = ""
      if (characters(bytes, first, last) > width) then
         from = step(bytes, first, last, at, -int(width, int64)/2)
         to = step(bytes, first, last, from, int(width, int64))
         if (from > first) head = "..."
         if (to < last) tail = "..."
      end if
      message = name//":"//integer_text(line)//":"//integer_text(column)//": "//what//nl// &
                head//shown_bytes(bytes, from, to)//tail//nl// &
                repeat(" ", len(head) + int(characters(bytes, from, at - 1)))//"^"//nl//advice
   end function place_message

   !> Characters in first:last; the continuation bytes 10xxxxxx of UTF-8 do not count.
   pure integer(int64) function characters(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: i

      characters = 0
      do i = first, min(last, size(bytes, kind=int64))
         if (bytes(i) >= -64) characters = characters + 1
      end do
   end function characters

   !> The first byte of the character that is so many characters away, within the line.
   pure integer(int64) function step(bytes, first, last, at, count)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last, at, count
      integer(int64) :: passed

      step = min(at, last)
      passed = 0
      do while (passed < abs(count) .and. step + sign(1_int64, count) >= first .and. step + sign(1_int64, count) <= last)
         step = step + sign(1_int64, count)
         if (bytes(step) >= -64) passed = passed + 1
      end do
      if (count > 0 .and. passed == count) step = step - 1
   end function step

   !> Bytes as a text for a terminal: tabs become blanks, control characters and broken UTF-8 question marks.
   pure function shown_bytes(bytes, first, last) result(text)
      !> The text at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable :: text
      integer(int64) :: i, j
      integer :: code, more

      allocate (character(max(0_int64, last - first + 1)) :: text)
      more = 0
      do i = first, last
         j = i - first + 1
         code = iand(int(bytes(i)), 255)
         text(j:j) = achar(code)
         if (code == 9) text(j:j) = " "
         if ((code < 32 .and. code /= 9) .or. code == 127) text(j:j) = "?"
         if (code < 128) then
            more = 0
         else if (code < 192) then
            if (more == 0) text(j:j) = "?"
            more = max(more - 1, 0)
         else
            more = following(bytes, i, last, code)
            if (more == 0) text(j:j) = "?"
         end if
      end do
   end function shown_bytes

   !> Continuation bytes after the leading byte at i; 0 where they are not all there.
   pure integer function following(bytes, i, last, code)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: i, last
      integer, intent(in) :: code

      following = 1
      if (code >= 224) following = 2
      if (code >= 240) following = 3
      if (code >= 248 .or. i + following > last) then
         following = 0
      else if (any(bytes(i + 1:i + following) >= -64)) then
         following = 0
      end if
   end function following

   !> An integer without blanks.
   pure function integer_text(i) result(text)
      !> Any value
      integer(int64), intent(in) :: i
      character(:), allocatable :: text
      character(20) :: room

      write (room, "(i0)") i
      text = trim(room)
   end function integer_text

end module gyroakf_io_place
