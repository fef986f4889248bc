! SPDX-License-Identifier: MIT
!> Names of fields by the labels before them, as in `gx=1.2, gy=-3`, and of the values of arrays.
module gyroakf_io_labels
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : class_of, column_class, is_unit
   use gyroakf_io_columns, only : column_names_type, take_name
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_text, only : bytes_text, fields_type
   use gyroakf_record, only : add_text, text_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: name_fields

   character(*), parameter :: quotes = """'", separators = " ,;"//achar(9)//achar(13)

contains

   !> Names the fields of a stripped line by their labels, or by the cells of arrays: "gyro[0]".
   subroutine name_fields(bytes, first, fields, names, array)
      !> Holds the line at first with its marks
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first
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
      if (start > 0) base = min(base, &
         depth(1) - count([(scan(gap(j:j), "[({") > 0, j=start + 1, len(gap))]))
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
            if (any(bytes(p) == iachar(["[", "(", "{"]))) level = level + 1
            if (any(bytes(p) == iachar(["]", ")", "}"]))) level = level - 1
            lowest(j) = min(lowest(j), level)
         end do
         depth(j) = level
         p = fields%last(j) + 1
      end do
   end subroutine find_depths

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
         start = verify(gap(from:mark), separators//quotes//"[({<])}>") + from - 1
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

end module gyroakf_io_labels
