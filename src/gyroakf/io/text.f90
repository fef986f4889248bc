! SPDX-License-Identifier: MIT
!> Lines of text taken apart: fields between blanks, tabs, commas and semicolons, comments, quotes.
!>
!> Here and in the other modules of text a line is `bytes(first:last)`, without its end.
module gyroakf_io_text
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: fields_type, split, split_line, has_fields, is_no_row, begins_with_semicolon
   public :: first_visible, last_visible, line_feed_from, line_end_from, bytes_text, text_bytes

   !> How a line is split, reached as `split%mixed`
   type :: split_enum
      !> Blanks and tabs separate, as many as there are; each comma or semicolon ends a field
      integer :: mixed = 0
      !> As mixed, but each tab ends a field too
      integer :: tabs = 1
      !> Each comma, semicolon or tab ends a field; blanks belong to it (names)
      integer :: names = 2
   end type split_enum

   !> All ways
   type(split_enum), parameter :: split = split_enum()

   !> The fields of a line
   type :: fields_type
      !> How many, an empty one after a trailing separator included
      integer :: count = 0
      !> First and last byte of each field, without quotes; last = first - 1 where it is empty
      integer(int64), allocatable :: first(:), last(:)
      !> True where the line ends with a comma or semicolon (or tab, where those count)
      logical :: trailing = .false.
      !> Byte of a quote that is not closed, 0 where there is none
      integer(int64) :: open_quote = 0
   end type fields_type

   integer(int8), parameter :: tab = 9, blank = 32, quote = 34, hash = 35, percent = 37, &
      apostrophe = 39
   integer(int8), parameter :: comma = 44, slash = 47, semicolon = 59, carriage_return = 13

contains

   !> Splits a line. A `#`, `%` or `//` at the start of a field ends the line.
   pure subroutine split_line(bytes, first, last, way, fields)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> One of the components of [[gyroakf_io_text:split]]
      integer, intent(in) :: way
      !> The fields; its arrays are reused
      type(fields_type), intent(inout) :: fields
      integer(int64) :: p, from, to

      fields%count = 0
      fields%open_quote = 0
      fields%trailing = .false.
      p = first
      do
         call skip_blanks(bytes, last, way, p)
         if (p > last) exit
         if (comment_at(bytes, p, last)) exit
         call next_field(bytes, last, way, p, from, to, fields%open_quote)
         call append(fields, from, to)
         if (fields%open_quote /= 0) return
         call skip_blanks(bytes, last, way, p)
         fields%trailing = .false.
         if (p > last) exit
         fields%trailing = separates(bytes(p), way)
         if (fields%trailing) p = p + 1
      end do
      if (fields%trailing) call append(fields, min(p, last + 1), min(p, last + 1) - 1)
   end subroutine split_line

   !> True where a line has a field for each of so many columns; a separator may follow.
   pure logical function has_fields(fields, columns)
      type(fields_type), intent(in) :: fields
      integer, intent(in) :: columns

      has_fields = fields%count == columns .or. (fields%count == columns + 1 .and. fields%trailing)
   end function has_fields

   !> Moves on to the next byte that is no soft separator.
   pure subroutine skip_blanks(bytes, last, way, p)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: last
      integer, intent(in) :: way
      integer(int64), intent(inout) :: p

      do p = p, last
         if (all(bytes(p) /= [blank, carriage_return, tab])) exit
         if (bytes(p) == tab .and. way /= split%mixed) exit
      end do
   end subroutine skip_blanks

   pure logical function separates(byte, way)
      integer(int8), intent(in) :: byte
      integer, intent(in) :: way

      separates = byte == comma .or. byte == semicolon .or. (byte == tab .and. way /= split%mixed)
   end function separates

   !> The field at p, without its quotes or trailing blanks; p moves behind it.
   pure subroutine next_field(bytes, last, way, p, from, to, open_quote)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: last
      integer, intent(in) :: way
      integer(int64), intent(inout) :: p, open_quote
      integer(int64), intent(out) :: from, to

      from = p
      if (bytes(p) == quote .or. bytes(p) == apostrophe) then
         from = p + 1
         to = from
         do while (to <= last)
            if (bytes(to) == bytes(p)) then
               if (to == last .or. bytes(min(to + 1, last)) /= bytes(p)) exit
               to = to + 1                                      ! a doubled quote is one in the text
            end if
            to = to + 1
         end do
         if (to > last) open_quote = p
         p = to + 1
         to = to - 1
         return
      end if
      do p = p, last
         if (separates(bytes(p), way)) exit
         if (way /= split%names .and. any(bytes(p) == [blank, tab, carriage_return])) exit
      end do
      to = last_visible(bytes, from, p - 1)
   end subroutine next_field

   pure subroutine append(fields, from, to)
      type(fields_type), intent(inout) :: fields
      integer(int64), intent(in) :: from, to
      integer :: n

      n = fields%count
      if (.not. allocated(fields%first)) allocate (fields%first(16), fields%last(16))
      if (n == size(fields%first)) then
         fields%first = [fields%first, fields%first]
         fields%last = [fields%last, fields%last]
      end if
      fields%count = n + 1
      fields%first(n + 1) = from
      fields%last(n + 1) = to
   end subroutine append

   !> True where a comment begins within a line: `#`, `%`, `//`.
   pure logical function comment_at(bytes, p, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last

      comment_at = bytes(p) == hash .or. bytes(p) == percent
      if (bytes(p) /= slash .or. p >= last) return
      comment_at = bytes(p + 1) == slash
   end function comment_at

   !> True for a line that is no row: it is blank or begins with `#`, `%`, `;` or `//`.
   pure logical function is_no_row(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p

      p = first_visible(bytes, first, last)
      is_no_row = p > last
      if (.not. is_no_row) is_no_row = bytes(p) == semicolon .or. comment_at(bytes, p, last)
   end function is_no_row

   !> True for a line that begins with `;`: a comment, or a row whose first field is empty.
   pure logical function begins_with_semicolon(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: p

      p = first_visible(bytes, first, last)
      begins_with_semicolon = p <= last
      if (begins_with_semicolon) begins_with_semicolon = bytes(p) == semicolon
   end function begins_with_semicolon

   !> First byte in first:last that is not blank; last + 1 where all are.
   pure integer(int64) function first_visible(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last

      do first_visible = first, last
         if (bytes(first_visible) < 0 .or. bytes(first_visible) > blank) exit
      end do
   end function first_visible

   !> Last byte in first:last that is not blank; first - 1 where all are.
   pure integer(int64) function last_visible(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last

      do last_visible = last, first, -1
         if (bytes(last_visible) < 0 .or. bytes(last_visible) > blank) exit
      end do
   end function last_visible

   !> The first line feed from a byte on.
   pure integer(int64) function line_feed_from(bytes, at) result(feed)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at

      feed = at
      do while (bytes(feed) /= 10)
         feed = feed + 1
      end do
   end function line_feed_from

   !> The last byte of the line at a byte, without its end (line feed, carriage return).
   pure integer(int64) function line_end_from(bytes, at) result(last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at

      last = line_feed_from(bytes, at) - 1
      if (last < at) return
      if (bytes(last) == carriage_return) last = last - 1
   end function line_end_from

   !> Bytes as a character string.
   pure function bytes_text(bytes, first, last) result(text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(max(0_int64, last - first + 1)) :: text
      integer(int64) :: i

      do i = first, last
         text(i - first + 1:i - first + 1) = achar(iand(int(bytes(i)), 255))
      end do
   end function bytes_text

   !> A character string as bytes; those above 127 become negative.
   pure function text_bytes(text) result(bytes)
      character(*), intent(in) :: text
      integer(int8) :: bytes(len(text))
      integer :: i

      do i = 1, len(text)
         bytes(i) = int(iachar(text(i:i)) - merge(256, 0, iachar(text(i:i)) > 127), int8)
      end do
   end function text_bytes

end module gyroakf_io_text
