! SPDX-License-Identifier: MIT
!> Messages that show a place in a file: `FILE:LINE:COLUMN: fault`, the line, a caret, what to do.
module gyroakf_io_place
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_text, only : bytes_text
   use gyroakf_utf8, only : is_continuation, sequence_length, text_width
   implicit none (type, external)
   private
   public :: place_error, line_error, shown_bytes, integer_text, integer_length

   !> An integer without blanks
   interface integer_text
      module procedure short_text, long_text
   end interface integer_text

   !> So many characters of a long line are shown
   integer, parameter :: width = 96

contains

   !> An error of code parse at a place in a file; columns are counted in characters, from 1.
   pure subroutine place_error(error, name, line, bytes, first, last, at, what, advice)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name
      integer(int64), intent(in) :: line
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> The byte that the caret is under, first to last + 1
      integer(int64), intent(in) :: at
      character(*), intent(in) :: what, advice
      character(1), parameter :: nl = new_line("a")
      character(:), allocatable :: shown, head, tail
      integer :: place, from, to

      shown = shown_bytes(bytes, first, last)
      place = int(at - first) + 1
      from = 1
      to = len(shown)
      head = ""
      tail = ""
      if (text_width(shown) > width) then
         from = step(shown, min(place, len(shown)), -width/2)
         to = step(shown, from, width) - 1
         if (from > 1) head = "..."
         if (to < len(shown)) tail = "..."
      end if
      call fatal_error(error, status%parse, name//":"//integer_text(line)//":"// &
         integer_text(text_width(shown(:place - 1)) + 1)//": "//what//nl//head//shown(from:to)// &
         tail//nl//repeat(" ", len(head) + text_width(shown(from:place - 1)))//"^"//nl//advice)
   end subroutine place_error

   !> An error of code parse about a whole line of a file.
   pure subroutine line_error(error, name, line, what, advice)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name
      integer(int64), intent(in) :: line
      character(*), intent(in) :: what, advice

      call fatal_error(error, status%parse, &
                       name//":"//integer_text(line)//":1: "//what//new_line("a")//advice)
   end subroutine line_error

   !> The first byte of the character so many characters away, at least 1, at most len + 1.
   pure integer function step(text, at, count)
      character(*), intent(in) :: text
      integer, intent(in) :: at, count
      integer :: passed

      step = at
      passed = 0
      do while (passed < abs(count))
         step = step + sign(1, count)
         if (step <= 1 .or. step > len(text)) exit
         if (.not. is_continuation(text(step:step))) passed = passed + 1
      end do
      step = max(step, 1)
   end function step

   !> Bytes for a terminal: tabs become blanks, control characters and broken UTF-8 question marks.
   pure function shown_bytes(bytes, first, last) result(text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(max(0_int64, last - first + 1)) :: text
      integer :: i, length

      text = bytes_text(bytes, first, last)
      i = 1
      do while (i <= len(text))
         length = sequence_length(text(i:))
         if (text(i:i) == achar(9)) text(i:i) = " "
         if (length == 0 .or. iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) text(i:i) = "?"
         i = i + max(length, 1)
      end do
   end function shown_bytes

   !> The length of [[integer_text]].
   pure integer function integer_length(i)
      integer(int64), intent(in) :: i
      character(20) :: text

      write (text, "(i0)") i
      integer_length = len_trim(text)
   end function integer_length

   pure function long_text(i) result(text)
      integer(int64), intent(in) :: i
      character(integer_length(i)) :: text

      write (text, "(i0)") i
   end function long_text

   pure function short_text(i) result(text)
      integer, intent(in) :: i
      character(integer_length(int(i, int64))) :: text

      write (text, "(i0)") i
   end function short_text

end module gyroakf_io_place
