! SPDX-License-Identifier: MIT
!> Messages that show the place in a file: `FILE:LINE:COLUMN: what is wrong`, the line, a caret, what to do.
module gyroakf_io_place
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: place_error, make_place_message, shown_bytes, integer_text, integer_length

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
      character(:), allocatable :: message

      call make_place_message(name, line, bytes, first, last, at, what, advice, message)
      call fatal_error(error, status%parse, message)
   end subroutine place_error

   !> The message alone; columns are counted in characters (UTF-8), from 1.
   pure subroutine make_place_message(name, line, bytes, first, last, at, what, advice, message)
      !> As those of [[place_error]]
      character(*), intent(in) :: name, what, advice
      integer(int64), intent(in) :: line, first, last, at
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Four lines
      character(:), allocatable, intent(out) :: message
      character(1), parameter :: nl = new_line("a")
      character(:), allocatable :: shown, head, tail
      integer :: place, from, to

      shown = shown_bytes(bytes, first, last)
      place = int(at - first) + 1
      from = 1
      to = len(shown)
      head = ""
      tail = ""
      if (characters(shown) > width) then
         from = step(shown, min(place, len(shown)), -width/2)
         to = step(shown, from, width) - 1
         if (from > 1) head = "..."
         if (to < len(shown)) tail = "..."
      end if
      message = name//":"//integer_text(line)//":"//integer_text(int(characters(shown(:place - 1)) + 1, int64))//": "//what//nl// &
                head//shown(from:to)//tail//nl//repeat(" ", len(head) + characters(shown(from:place - 1)))//"^"//nl//advice
   end subroutine make_place_message

   !> Characters of a text; the continuation bytes 10xxxxxx of UTF-8 do not count.
   pure integer function characters(text)
      character(*), intent(in) :: text
      integer :: i

      characters = 0
      do i = 1, len(text)
         if (.not. continues(text(i:i))) characters = characters + 1
      end do
   end function characters

   !> True for a byte that goes on with a character.
   pure logical function continues(byte)
      character(1), intent(in) :: byte

      continues = iand(iachar(byte), 192) == 128
   end function continues

   !> The first byte of the character so many characters away; 1 or len + 1 where the text is too short.
   pure integer function step(text, at, count)
      character(*), intent(in) :: text
      integer, intent(in) :: at, count
      integer :: passed

      step = at
      passed = 0
      do while (passed < abs(count))
         step = step + sign(1, count)
         if (step <= 1 .or. step > len(text)) exit
         if (.not. continues(text(step:step))) passed = passed + 1
      end do
      step = max(step, 1)
   end function step

   !> Bytes as a text for a terminal: tabs become blanks, control characters and broken UTF-8 question marks.
   pure function shown_bytes(bytes, first, last) result(text)
      !> The text at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(max(0_int64, last - first + 1)) :: text
      integer(int64) :: i, j
      integer :: code, more

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

   !> The length of [[integer_text]].
   pure integer function integer_length(i)
      !> Any value
      integer(int64), intent(in) :: i
      character(20) :: room

      write (room, "(i0)") i
      integer_length = len_trim(room)
   end function integer_length

   !> An integer without blanks.
   pure function integer_text(i) result(text)
      !> Any value
      integer(int64), intent(in) :: i
      character(integer_length(i)) :: text

      write (text, "(i0)") i
   end function integer_text

end module gyroakf_io_place
