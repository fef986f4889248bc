! SPDX-License-Identifier: MIT
!> Labels, brackets and checksums in rows: `gx=1.2, gy=-3`, `{"gx": 1.2}`, `0.01,"[1, 2, 3]"`,
!> `$IMU,1,2*5A`, `b'1.2'`.
!>
!> They become blanks in rows with the marks of the first, which leaves numbers and separators.
module gyroakf_io_marks
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_text, only : last_visible, line_feed_from
   implicit none (type, external)
   private
   public :: marks_type, find_marks, strip_lines

   !> The marks of a line
   type :: marks_type
      integer :: labels = 0, brackets = 0, values = 0
      !> Made of the labels, and of the places of the brackets among the values
      integer(int64) :: skeleton = 0
   end type marks_type

   character(*), parameter :: opening = "[({<", closing = "])}>", quotes = """'", &
      separators = " ,;"//achar(9)//achar(13)
   integer(int8), parameter :: blank = 32

contains

   !> Writes blanks for the marks of lines where they are those of the first row, or where a line
   !> holds nothing else; other lines become blank where `where_label` asks for it.
   pure subroutine strip_lines(bytes, first, last, layout)
      !> Holds lines at first:last, a line feed at last
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> With the skeleton of the first row
      type(layout_type), intent(in) :: layout
      type(marks_type) :: marks
      integer(int64) :: at, feed

      at = first
      do while (at <= last)
         feed = line_feed_from(bytes, at)
         call find_marks(bytes, at, feed - 1, .false., marks)
         if (marks%skeleton == layout%skeleton .or. marks%values + marks%labels == 0) then
            call find_marks(bytes, at, feed - 1, .true., marks)
         else if (layout%where_label) then
            bytes(at:feed - 1) = blank
         end if
         at = feed + 1
      end do
   end subroutine strip_lines

   !> The marks of a line; writes blanks for them or leaves them.
   pure subroutine find_marks(bytes, first, last, erase, marks)
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      logical, intent(in) :: erase
      type(marks_type), intent(out) :: marks
      integer(int64) :: p, to, i, pending
      character(1) :: sign, next
      logical :: fresh, bar

      p = first
      fresh = .true.
      pending = 0
      do while (p <= last)
         sign = achar(iand(int(bytes(p)), 255))
         to = p
         next = achar(iand(int(bytes(min(p + 1, last))), 255))
         bar = sign == "|"
         if (bar) bar = parts(bytes, p, last)
         if (sign == ">" .and. (p == first .or. bytes(max(first, p - 1)) == iachar("-"))) then
            ! ">gx:1", "->"
            fresh = p == first
         else if ((fresh .and. scan(sign, opening) > 0) .or. scan(sign, closing) > 0 .or. bar) then
            if (marks%values > 0) pending = mixed(pending, &
               int(iachar(sign) + 256*marks%values, int64))
            marks%brackets = marks%brackets + 1
            if (erase) bytes(p) = blank
            if (scan(sign, closing) > 0 .and. scan(next, quotes) > 0) to = min(p + 1, last)
            if (erase) bytes(to) = blank
            fresh = .true.
         else if (scan(sign, separators) > 0) then
            fresh = .true.
         else if (fresh .and. sign == "b" .and. scan(next, quotes) > 0 .and. p < last) then
            marks%brackets = marks%brackets + 1
            to = p + 1
            if (erase) call take_bytes_off(bytes(p:closing_quote(bytes, to, last)))
         else if (fresh .and. scan(sign, quotes) > 0 .and. scan(next, opening) > 0) then
            if (erase) bytes(p) = blank
         else if (fresh) then
            marks%skeleton = mixed(marks%skeleton, pending)
            pending = 0
            to = label_end(bytes, p, last)
            fresh = to > 0
            if (fresh) then
               marks%labels = marks%labels + 1
               do i = p, to
                  if (bytes(i) /= blank) marks%skeleton = mixed(marks%skeleton, &
                     int(bytes(i), int64))
               end do
               if (erase) bytes(p:to) = blank
            else
               to = p
               marks%values = marks%values + 1
               if (scan(sign, quotes) > 0) to = closing_quote(bytes, p, last)
            end if
         else if (sign == "*" .and. p == last_visible(bytes, first, last) - 2 .and. &
            any(bytes(first) == [33_int8, 36_int8])) then
            marks%brackets = marks%brackets + 1
            if (erase) bytes(p:last) = blank
            to = last
         end if
         p = to + 1
      end do
   end subroutine find_marks

   !> True for a sign with blanks, digits or the ends of the line on both sides.
   pure logical function parts(bytes, p, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last
      character(*), parameter :: beside = " 0123456789+-."//achar(9)//achar(10)//achar(13)

      parts = p == last
      if (.not. parts) parts = scan(achar(iand(int(bytes(p + 1)), 255)), beside) > 0
      if (p > 1) parts = parts .and. scan(achar(iand(int(bytes(p - 1)), 255)), beside) > 0
   end function parts

   !> Writes blanks for the marks of b'1.2,3.4\r\n', as Python writes bytes.
   pure subroutine take_bytes_off(bytes)
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer :: last

      bytes(:2) = blank
      last = size(bytes)
      bytes(last) = blank
      do while (last > 4)
         if (bytes(last - 2) /= iachar(achar(92))) exit
         bytes(last - 2:last - 1) = blank
         last = last - 2
      end do
   end subroutine take_bytes_off

   !> The quote that closes the one at p, the last byte of the line where there is none.
   pure integer(int64) function closing_quote(bytes, p, last) result(to)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last

      do to = p + 1, last - 1
         if (bytes(to) == bytes(p)) exit
      end do
      to = min(to, last)
   end function closing_quote

   !> The colon or equals sign that ends a label at p: words before a value; 0 where there is none.
   pure integer(int64) function label_end(bytes, p, last) result(mark)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last
      character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_>$"
      integer(int64) :: from
      integer :: depth
      character(1) :: sign

      mark = 0
      from = p
      if (scan(achar(iand(int(bytes(p)), 255)), quotes) > 0) from = closing_quote(bytes, p, last)
      if (from == p .and. bytes(p) > 0 .and. scan(achar(int(bytes(p))), letters) == 0) return
      depth = 0
      do from = merge(from, from + 1, from == p), last
         sign = achar(iand(int(bytes(from)), 255))
         if (sign == ":" .or. sign == "=") exit
         if (scan(sign, ",;{}<"//quotes//achar(9)) > 0) return
         if (sign == "(" .and. from < last) then
            if (bytes(from + 1) >= 48 .and. bytes(from + 1) <= 57) return
         end if
         if (scan(sign, "([") > 0) depth = depth + 1
         if (scan(sign, ")]") > 0) depth = depth - 1
         if (depth < 0) return
      end do
      if (from >= last .or. depth /= 0) return
      sign = achar(iand(int(bytes(from + 1)), 255))
      if (scan(sign, "0123456789+-.nN "//quotes//opening//achar(9)) == 0 .or. &
         last_visible(bytes, from + 1, last) == from) return
      if (scan(sign, "0123456789") > 0 .and. &
         any(bytes(min(from + 2, last):min(from + 3, last)) == iachar(":"))) return
      mark = from
   end function label_end

   !> Another number for every sequence of numbers, nearly.
   pure integer(int64) function mixed(skeleton, value)
      integer(int64), intent(in) :: skeleton, value

      mixed = skeleton
      if (value /= 0) mixed = ieor(modulo(skeleton, 2_int64**40)*4194319_int64, value) + 1
   end function mixed

end module gyroakf_io_marks
