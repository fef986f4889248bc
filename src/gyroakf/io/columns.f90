! SPDX-License-Identifier: MIT
!> Names of columns, with units in brackets.
module gyroakf_io_columns
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : class_of, column_class, is_unit, opening_bracket
   use gyroakf_error, only : error_type
   use gyroakf_io_place, only : integer_text, integer_length, line_error
   use gyroakf_io_text, only : bytes_text, fields_type, split, split_line
   use gyroakf_record, only : text_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: column_names_type, count_names, has_name, read_names, join_names, drop_empty_names
   public :: refuse_equal_names, names_way, take_name, label_of, most_columns

   !> A file with more of them has lost its line ends
   integer, parameter :: most_columns = 65536
   !> Names of more columns are not compared with each other
   integer, parameter :: most_compared = 4096

   !> The names of a file's columns
   type :: column_names_type
      !> False where the file names none
      logical :: known = .false.
      !> Line that they stand in
      integer(int64) :: line = 0
      !> Without brackets: [column]; may be ""
      type(text_type), allocatable :: name(:)
      !> What stood in brackets behind the name: [column]; "" where there was nothing
      type(text_type), allocatable :: unit(:)
   end type column_names_type

   integer(int8), parameter :: tab = 9, comma = 44, semicolon = 59

contains

   !> Names from a line: between commas, semicolons and tabs if there are any, else between blanks.
   subroutine read_names(bytes, first, last, line, names)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last, line
      type(column_names_type), intent(out) :: names
      type(fields_type) :: fields
      character(:), allocatable :: word
      integer :: i, way, count

      way = names_way(bytes, first, last)
      call split_line(bytes, first, last, way, fields)
      names%known = fields%count > 0 .and. fields%count <= most_columns
      names%line = line
      if (.not. names%known) return
      allocate (names%name(fields%count), names%unit(fields%count))
      count = 0
      do i = 1, fields%count
         word = bytes_text(bytes, fields%first(i), fields%last(i))
         call make_readable(word)
         if (way == split%mixed .and. word == "|") cycle
         if (way == split%mixed .and. count > 0 .and. scan(word, "[(") == 1) then
            call take_name(names%name(count)%text//" "//word, names%name(count)%text, &
               names%unit(count)%text)
         else
            count = count + 1
            call take_name(word, names%name(count)%text, names%unit(count)%text)
         end if
      end do
      names%known = count > 0
      names%name = names%name(:count)
      names%unit = names%unit(:count)
      call keep_apart(names)
   end subroutine read_names

   !> Names that are equal without their units keep them: "a [g]", "a [m/s^2]".
   pure subroutine keep_apart(names)
      type(column_names_type), intent(inout) :: names
      logical :: equal(merge(size(names%name), 0, size(names%name) <= most_compared))
      integer :: i, j

      associate (name => names%name, unit => names%unit)
         do i = 1, size(equal)
            equal(i) = len(name(i)%text) > 0 .and. len(unit(i)%text) > 0
            if (equal(i)) equal(i) = any([(name(i)%text == name(j)%text .and. &
               unit(i)%text /= unit(j)%text, j=1, size(equal))])
         end do
         do i = 1, size(equal)
            if (equal(i)) name(i)%text = name(i)%text//" ["//unit(i)%text//"]"
         end do
      end associate
   end subroutine keep_apart

   !> Names of one line from two: a group above its columns, "gyro" above "x", or what says more.
   pure subroutine join_names(above, names)
      !> As many as the names; empty where the group of the column before goes on
      type(column_names_type), intent(in) :: above
      type(column_names_type), intent(inout) :: names
      character(:), allocatable :: group, unit
      integer :: i

      if (knows(above) .and. (.not. knows(names) .or. &
         2*known_classes(above) >= size(above%name) + known_classes(names))) then
         names%name = above%name
         names%unit = above%unit
         return
      else if (count([(len(above%name(i)%text) > 0, i=1, size(above%name))]) < 2 .and. &
         len(above%name(1)%text) > 0) then
         return
      else if (.not. knows(names) .or. &
         any([(len(above%name(i)%text) == 0, i=2, size(above%name))])) then
         group = ""
         unit = ""
         do i = 1, size(names%name)
            if (len(above%name(i)%text) + len(names%name(i)%text) == 0) cycle
            if (len(above%name(i)%text) > 0) then
               group = above%name(i)%text
               unit = above%unit(i)%text
            end if
            if (len(names%unit(i)%text) == 0) names%unit(i)%text = unit
            if (len(names%name(i)%text) == 0) names%name(i)%text = group
            if (names%name(i)%text /= group .and. len(group) > 0) then
               names%name(i)%text = group//" "//names%name(i)%text
            end if
         end do
      end if
   end subroutine join_names

   pure integer function known_classes(names)
      type(column_names_type), intent(in) :: names
      integer :: i

      known_classes = count([(class_of(names%name(i)%text, names%unit(i)%text), i=1, &
         size(names%name))] /= column_class%unknown)
   end function known_classes

   !> Takes off the empty names of a line that begins or ends with a separator where the rows do
   !> not, and that of comments at the end, which rows may not have (LabVIEW).
   pure subroutine drop_empty_names(columns, names)
      integer, intent(in) :: columns
      type(column_names_type), intent(inout) :: names
      integer :: first, last

      if (.not. names%known) return
      first = 1
      last = size(names%name)
      if (columns < 1 .or. last <= columns) return
      if (any(["        ", "Comment ", "Comments"] == names%name(last)%text)) last = last - 1
      if (last > columns .and. len(names%name(1)%text) == 0) first = 2
      if (last - first + 1 == columns) then
         names%name = names%name(first:last)
         names%unit = names%unit(first:last)
      end if
   end subroutine drop_empty_names

   !> True where every column has a name of its own.
   pure logical function knows(names)
      type(column_names_type), intent(in) :: names
      integer :: i, j

      knows = .true.
      do i = 1, min(size(names%name), most_compared)
         knows = knows .and. len(names%name(i)%text) > 0
         do j = 1, i - 1
            knows = knows .and. names%name(i)%text /= names%name(j)%text
         end do
      end do
   end function knows

   !> How a line of names is split: blanks belong to the names where there are other separators.
   pure integer function names_way(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last

      names_way = split%mixed
      associate (line => bytes(first:last))
         if (any(line == comma .or. line == semicolon .or. line == tab)) names_way = split%names
      end associate
   end function names_way

   !> "gx [deg/s]" or "gx: deg/s" as name and unit; "gyro[0]", without a unit, is a name.
   pure subroutine take_name(word, name, unit)
      character(*), intent(in) :: word
      !> The unit is "" where there is none
      character(:), allocatable, intent(inout) :: name, unit
      character(:), allocatable :: text
      integer :: bracket, last

      text = word
      do while (index(text, '""') > 0)
         text = text(:index(text, '""'))//text(index(text, '""') + 2:)
      end do
      name = text
      unit = ""
      bracket = opening_bracket(text)
      last = merge(len(text), len(text) - 1, bracket < 2)
      if (bracket < 2) bracket = index(text, ": ")
      if (bracket < 2) return
      if (.not. is_unit(text(bracket + 1:last))) return
      name = trim(text(:bracket - 1))
      unit = trim(adjustl(text(bracket + 1:last)))
   end subroutine take_name

   !> How many names are known.
   pure integer function count_names(names)
      type(column_names_type), intent(in) :: names

      count_names = 0
      if (names%known) count_names = size(names%name)
   end function count_names

   !> True where a column has a name in the file.
   pure logical function has_name(names, column)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column

      has_name = names%known
      if (has_name) has_name = len(names%name(column)%text) > 0
   end function has_name

   pure integer function label_length(names, column)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column

      label_length = len("column ") + integer_length(int(column, int64))
      if (has_name(names, column)) label_length = len("column ''") + len(names%name(column)%text)
   end function label_length

   !> A column as messages name it: "column 3" or "column 'gx'".
   pure function label_of(names, column) result(label)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column
      character(label_length(names, column)) :: label

      if (has_name(names, column)) then
         label = "column '"//names%name(column)%text//"'"
      else
         label = "column "//integer_text(column)
      end if
   end function label_of

   !> Refuses equal names, unless columns were asked for by number: the names get theirs then.
   subroutine refuse_equal_names(file, names, error, columns)
      character(*), intent(in) :: file
      type(column_names_type), intent(inout) :: names
      !> Allocated where names are equal: parse
      type(error_type), allocatable, intent(out) :: error
      !> Those that were asked for, if any
      character(*), intent(in), optional :: columns
      character(:), allocatable :: list, name
      integer :: i, j, count

      list = ""
      if (.not. names%known) return
      do i = 1, merge(size(names%name), 0, size(names%name) <= most_compared)
         name = names%name(i)%text
         count = 0
         do j = i + 1, merge(size(names%name), 0, len(name) > 0)
            if (names%name(j)%text /= name) cycle
            if (count == 0) list = list//"; '"//name//"' in columns "//integer_text(i)
            count = count + 1
            list = list//", "//integer_text(j)
            names%name(j)%text = name//" (column "//integer_text(j)//")"
         end do
         if (count > 0) names%name(i)%text = name//" (column "//integer_text(i)//")"
      end do
      if (len(list) == 0) return
      if (present(columns)) then
         if (verify(columns, "0123456789, ") == 0) return
      end if
      call line_error(error, file, names%line, "names of columns are equal: "//list(3:), &
         "choose columns by their numbers, or make the names different")
   end subroutine refuse_equal_names

end module gyroakf_io_columns
