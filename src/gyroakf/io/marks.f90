! SPDX-License-Identifier: MIT
!> Labels, brackets and checksums in rows: `gx=1.2, gy=-3`, `{"gx": 1.2}`, `0.01,"[1, 2, 3]"`,
!> `$IMU,1,2*5A`, `b'1.2'`.
!>
!> They become blanks in rows with the marks of the first, which leaves numbers and separators.
module gyroakf_io_marks
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : class_of, column_class, is_unit
   use gyroakf_io_columns, only : column_names_type, take_name
   use gyroakf_io_layout, only : layout_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_text, only : bytes_text, fields_type, last_visible, line_feed_from
   use gyroakf_record, only : add_text, text_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: marks_type, find_marks, strip_lines, name_fields

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
         else if ((fresh .and. is_in(sign, opening)) .or. is_in(sign, closing) .or. bar) then
            if (marks%values > 0) &
               pending = mixed(pending, int(iachar(sign) + 256*marks%values, int64))
            marks%brackets = marks%brackets + 1
            if (erase) bytes(p) = blank
            if (is_in(sign, closing) .and. is_in(next, quotes)) to = min(p + 1, last)
            if (erase) bytes(to) = blank
            fresh = .true.
         else if (is_in(sign, separators)) then
            fresh = .true.
         else if (fresh .and. sign == "b" .and. is_in(next, quotes) .and. p < last) then
            marks%brackets = marks%brackets + 1
            to = p + 1
            if (erase) call take_bytes_off(bytes(p:closing_quote(bytes, to, last)))
         else if (fresh .and. is_in(sign, quotes) .and. is_in(next, opening)) then
            if (erase) bytes(p) = blank
         else if (fresh) then
            marks%skeleton = mixed(marks%skeleton, pending)
            pending = 0
            to = label_end(bytes, p, last)
            fresh = to > 0
            if (fresh) then
               marks%labels = marks%labels + 1
               do i = p, to
                  if (bytes(i) /= blank) &
                     marks%skeleton = mixed(marks%skeleton, int(bytes(i), int64))
               end do
               if (erase) bytes(p:to) = blank
            else
               to = p
               marks%values = marks%values + 1
               if (is_in(sign, quotes)) to = closing_quote(bytes, p, last)
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
      if (.not. parts) parts = is_in(achar(iand(int(bytes(p + 1)), 255)), beside)
      if (p > 1) parts = parts .and. is_in(achar(iand(int(bytes(p - 1)), 255)), beside)
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

   !> True for a character of a set; quick, as no text is built.
   pure logical function is_in(sign, set)
      character(1), intent(in) :: sign
      character(*), intent(in) :: set

      is_in = index(set, sign) > 0
   end function is_in

   !> The quote that closes the one at p, the last byte of the line where there is none.
   pure integer(int64) function closing_quote(bytes, p, last) result(to)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last

      do to = p + 1, last - 1
         if (bytes(to) == bytes(p)) exit
      end do
      to = min(to, last)
   end function closing_quote

   !> The colon or equals sign that ends a label at p: a word, or some between blanks, before a
   !> value; 0 where there is none.
   pure integer(int64) function label_end(bytes, p, last) result(mark)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: p, last
      character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_>$"
      integer(int64) :: from
      integer :: depth
      character(1) :: sign

      mark = 0
      from = p
      if (is_in(achar(iand(int(bytes(p)), 255)), quotes)) from = closing_quote(bytes, p, last)
      if (from == p .and. bytes(p) > 0 .and. .not. is_in(achar(int(bytes(p))), letters)) return
      depth = 0
      do from = merge(from, from + 1, from == p), last
         sign = achar(iand(int(bytes(from)), 255))
         if (sign == ":" .or. sign == "=") exit
         if (is_in(sign, ",;{}<"//quotes//achar(9))) return
         if (sign == "(" .and. from < last) then
            if (bytes(from + 1) >= 48 .and. bytes(from + 1) <= 57) return
         end if
         if (is_in(sign, "([")) depth = depth + 1
         if (is_in(sign, ")]")) depth = depth - 1
         if (depth < 0) return
      end do
      if (from >= last .or. depth /= 0) return
      sign = achar(iand(int(bytes(from + 1)), 255))
      if (.not. is_in(sign, "0123456789+-.nN "//quotes//opening//achar(9)) .or. &
         last_visible(bytes, from + 1, last) == from) return
      if (is_in(sign, "0123456789") .and. &
         any(bytes(min(from + 2, last):min(from + 3, last)) == iachar(":"))) return
      mark = from
   end function label_end

   !> Another number for every sequence of numbers, nearly.
   pure integer(int64) function mixed(skeleton, value)
      integer(int64), intent(in) :: skeleton, value

      mixed = skeleton
      if (value /= 0) mixed = ieor(modulo(skeleton, 2_int64**40)*4194319_int64, value) + 1
   end function mixed

   !> Names the fields of a stripped line by their labels, or by the cells of arrays: "gyro[0]".
   subroutine name_fields(bytes, first, fields, names, array)
      !> Holds the line at first with its marks
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first
      !> Of the line without them
      type(fields_type), intent(in) :: fields
      !> Those of the cells; afterwards of the fields, unless their number is another one
      type(column_names_type), intent(inout) :: names
      !> Values of the longest array in a cell, 0 where there is none
      integer, intent(out) :: array
      type(column_names_type) :: named
      type(text_type), allocatable :: labels(:)
      character(:), allocatable :: gap, group
      integer :: cell(fields%count), depth(fields%count), lowest(fields%count), j, n, start, base
      logical :: labeled

      n = fields%count - merge(1, 0, fields%trailing)
      array = 0
      if (n == 0) return
      allocate (named%name(n), named%unit(n))
      call find_depths(bytes, first, fields, depth, lowest)
      gap = bytes_text(bytes, first, fields%first(1) - 1)
      start = scan(gap, ":=", back=.true.)
      base = min(minval(depth(:n)), minval(lowest(2:n)))
      if (start > 0) &
         base = min(base, depth(1) - count([(is_in(gap(j:j), opening(:3)), j=start + 1, len(gap))]))
      cell(1) = 1
      do j = 2, n
         cell(j) = cell(j - 1) + merge(1, 0, min(depth(j), lowest(j)) <= base)
      end do
      if (maxval(cell(:n)) < n) array = maxval([(count(cell(:n) == j), j=1, maxval(cell(:n)))])
      group = ""
      start = 0
      labeled = .false.
      do j = 1, n
         named%name(j)%text = ""
         named%unit(j)%text = ""
         gap = bytes_text(bytes, merge(first, fields%last(max(1, j - 1)) + 1, j == 1), &
            fields%first(j) - 1)
         call find_labels(gap, labels)
         if (j > 1) then
            if (depth(j) < depth(max(1, j - 1))) group = ""
         end if
         if (names%known) then
            if (maxval(cell(:n)) /= size(names%name)) return
            named%name(j)%text = names%name(cell(j))%text
            if (count(cell(:n) == cell(j)) > 1) named%name(j)%text = named%name(j)%text//"["// &
               integer_text(count(cell(:j) == cell(j)) - 1)//"]"
            named%unit(j)%text = names%unit(cell(j))%text
         else if (size(labels) > 0) then
            labeled = .true.
            start = j
            if (size(labels) > 1) group = labels(size(labels) - 1)%text//" "
            call take_label(labels(size(labels))%text, depth(j) > base, j, group, named)
         else if (start > 0) then
            if (depth(j) == depth(start) .and. (cell(j) == cell(start) .or. depth(j) == base)) then
               call take_follower(bytes_text(bytes, fields%first(j), fields%last(j)), start, j, &
                  named)
            end if
         end if
      end do
      if (.not. names%known) call spread_units(named)
      named%known = names%known .or. labeled
      named%line = names%line
      if (named%known) names = named
   end subroutine name_fields

   !> How deep in brackets each field stands, and the least depth between it and the field before.
   pure subroutine find_depths(bytes, first, fields, depth, lowest)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first
      type(fields_type), intent(in) :: fields
      integer, intent(out) :: depth(:), lowest(:)
      integer(int64) :: p
      integer :: j, level

      p = first
      level = 0
      do j = 1, fields%count
         lowest(j) = level
         do p = p, fields%first(j) - 1
            if (is_in(achar(iand(int(bytes(p)), 255)), opening(:3))) level = level + 1
            if (is_in(achar(iand(int(bytes(p)), 255)), closing(:3))) level = level - 1
            lowest(j) = min(lowest(j), level)
         end do
         depth(j) = level
         p = fields%last(j) + 1
      end do
   end subroutine find_depths

   !> The labels before a field.
   pure subroutine find_labels(gap, labels)
      character(*), intent(in) :: gap
      type(text_type), allocatable, intent(out) :: labels(:)
      character(:), allocatable :: label
      integer :: from, mark, start, finish

      allocate (labels(0))
      from = 1
      do
         mark = scan(gap(from:), ":=") + from - 1
         if (mark < from) return
         start = verify(gap(from:mark), separators//opening//closing//quotes) + from - 1
         finish = verify(gap(:mark - 1), separators//quotes, back=.true.)
         label = gap(start:max(start - 1, finish))
         call make_readable(label)
         if (len(label) > 0) call add_text(labels, label)
         from = mark + 1
      end do
   end subroutine find_labels

   !> A label as name and unit of field j; a unit that stands before it is that of field j - 1.
   !> "rotation rate x" begins a group of axes, to which "y" and "z" belong.
   pure subroutine take_label(label, within, j, group, named)
      character(*), intent(in) :: label
      logical, intent(in) :: within
      integer, intent(in) :: j
      character(:), allocatable, intent(inout) :: group
      type(column_names_type), intent(inout) :: named
      integer :: at
      logical :: axis

      at = merge(index(label, " "), 0, j > 1)
      if (.not. is_unit(label(:max(0, at - 1)))) at = 0
      if (at > 0) named%unit(j - 1)%text = label(:at - 1)
      call take_name(trim(adjustl(label(at + 1:))), named%name(j)%text, named%unit(j)%text)
      associate (name => named%name(j)%text)
         axis = scan(name, "wxyzWXYZ", back=.true.) == len(name)
         at = scan(name(:max(0, len(name) - 1)), " ._>-/", back=.true.)
         if (axis .and. at > 1 .and. at == len(name) - 1) then
            group = name(:at)
         else if (len(group) > 0) then
            axis = within .or. (axis .and. len(name) == 1)
            axis = axis .or. any(class_of(group, "") == [column_class%flag, column_class%other])
            if (axis) named%name(j)%text = group//name
         end if
      end associate
   end subroutine take_label

   !> A unit behind the last axis is that of the axes before it, too: "gx: 1 gy: 2 gz: 3 deg/s".
   pure subroutine spread_units(named)
      type(column_names_type), intent(inout) :: named
      integer :: j, k, n

      k = 0
      do j = size(named%name), 1, -1
         n = len(named%name(j)%text)
         if (n == 0) cycle
         if (k > 0 .and. len(named%unit(j)%text) == 0) then
            associate (this => named%name(j)%text, next => named%name(k)%text)
               if (n == len(next) .and. scan(this, "xyzXYZ", back=.true.) == n) then
                  if (this(:n - 1) == next(:n - 1)) named%unit(j)%text = named%unit(k)%text
               end if
            end associate
         end if
         k = j
      end do
   end subroutine spread_units

   !> Names a field behind one with a label: the next of an array, or its unit.
   pure subroutine take_follower(word, start, j, named)
      character(*), intent(in) :: word
      integer, intent(in) :: start, j
      type(column_names_type), intent(inout) :: named
      character(:), allocatable :: base

      if (j == start + 1 .and. is_unit(word)) named%unit(start)%text = word
      if (scan(word, "+-.0123456789nN") /= 1) return
      base = named%name(start)%text
      if (j > start + 1) base = base(:index(base, "[", back=.true.) - 1)
      if (j == start + 1) named%name(start)%text = base//"[0]"
      named%name(j)%text = base//"["//integer_text(j - start)//"]"
      named%unit(j)%text = named%unit(start)%text
   end subroutine take_follower

end module gyroakf_io_marks
