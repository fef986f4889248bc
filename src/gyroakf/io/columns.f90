! SPDX-License-Identifier: MIT
!> Columns by name and number: names with units in brackets, which columns were asked for.
module gyroakf_io_columns
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_io_place, only : integer_text, integer_length
   use gyroakf_io_text, only : bytes_text, fields_type, split, split_line
   use gyroakf_record, only : text_type
   use gyroakf_spelling, only : lower, nearest_word
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: column_names_type, read_names, take_brackets_off, names_way, name_of, label_of, find_column, choose_columns
   public :: most_columns

   !> A file with more of them has lost its line ends
   integer, parameter :: most_columns = 65536

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

   !> Names from a line: between commas, semicolons and tabs where there are any, else between blanks.
   subroutine read_names(bytes, first, last, line, names)
      !> Holds the names at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> Number of the line
      integer(int64), intent(in) :: line
      !> The names
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
         if (way == split%mixed .and. count > 0 .and. scan(word, "[(") == 1) then
            names%unit(count)%text = word
            call take_brackets_off(names%unit(count)%text)
         else
            count = count + 1
            call take_name(word, names%name(count)%text, names%unit(count)%text)
         end if
      end do
      call shorten(names%name, count)
      call shorten(names%unit, count)
   end subroutine read_names

   !> Keeps the first texts of a list.
   pure subroutine shorten(list, count)
      type(text_type), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: count
      type(text_type), allocatable :: shorter(:)
      integer :: i

      if (count == size(list)) return
      allocate (shorter(count))
      do i = 1, count
         call move_alloc(list(i)%text, shorter(i)%text)
      end do
      call move_alloc(shorter, list)
   end subroutine shorten

   !> How a line of names is split: blanks belong to the names where there are other separators.
   pure integer function names_way(bytes, first, last)
      !> Holds the line at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last

      names_way = split%mixed
      if (any(bytes(first:last) == comma .or. bytes(first:last) == semicolon .or. bytes(first:last) == tab)) names_way = split%names
   end function names_way

   !> "gx [deg/s]" as name and unit.
   subroutine take_name(word, name, unit)
      character(*), intent(in) :: word
      character(:), allocatable, intent(out) :: name, unit
      integer :: bracket

      bracket = scan(word, "[(")
      if (bracket > 1 .and. scan(word, "])") == len(word)) then
         name = trim(word(:bracket - 1))
         unit = word(bracket:)
         call take_brackets_off(unit)
      else
         name = word
         unit = ""
      end if
   end subroutine take_name

   !> "[deg/s]" becomes "deg/s".
   pure subroutine take_brackets_off(word)
      !> Begins with a bracket
      character(:), allocatable, intent(inout) :: word
      integer :: last

      last = len(word)
      if (last > 1 .and. scan(word, "])", back=.true.) == last) last = last - 1
      word = trim(adjustl(word(2:last)))
   end subroutine take_brackets_off

   !> The length of the name that a column has in the file; 0: none.
   pure integer function own_length(names, column)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column

      own_length = 0
      if (names%known) own_length = len(names%name(column)%text)
   end function own_length

   !> The length of [[name_of]].
   pure integer function name_length(names, column)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column

      name_length = own_length(names, column)
      if (name_length == 0) name_length = len("column") + integer_length(int(column, int64))
   end function name_length

   !> The length of [[label_of]].
   pure integer function label_length(names, column)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column

      label_length = own_length(names, column)
      if (label_length > 0) label_length = len("column ''") + label_length
      if (label_length == 0) label_length = len("column ") + integer_length(int(column, int64))
   end function label_length

   !> The name of a column, "column3" where it has none.
   pure function name_of(names, column) result(name)
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> Counted from 1
      integer, intent(in) :: column
      character(name_length(names, column)) :: name

      if (own_length(names, column) > 0) then
         name = names%name(column)%text
      else
         name = "column"//integer_text(int(column, int64))
      end if
   end function name_of

   !> The same for messages: "column 3" or "column 'gx'".
   pure function label_of(names, column) result(label)
      !> As those of [[name_of]]
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: column
      character(label_length(names, column)) :: label

      if (own_length(names, column) > 0) then
         label = "column '"//names%name(column)%text//"'"
      else
         label = "column "//integer_text(int(column, int64))
      end if
   end function label_of

   !> The column that a number or a name means.
   subroutine find_column(word, names, columns, column, error)
      !> "2" or "gx"
      character(*), intent(in) :: word
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> How many the file has
      integer, intent(in) :: columns
      !> From 1
      integer, intent(out) :: column
      !> Allocated where there is no such column: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer :: i, found
      real(dp) :: x

      column = 0
      if (names%known) then
         do i = columns, 1, -1
            if (lower(names%name(i)%text) == lower(word) .and. len(word) > 0) column = i
         end do
         do i = columns, 1, -1
            if (names%name(i)%text == word .and. len(word) > 0) column = i
         end do
      end if
      if (column > 0) return
      call parse_number(word, x, found)
      if (found == number%ok .and. verify(word, "0123456789") == 0 .and. x < 1.0e9_dp) then
         column = nint(x)
         if (column >= 1 .and. column <= columns) return
         column = 0
         call fatal_error(error, status%invalid_argument, "there is no column "//word//": the file has columns 1 to "// &
                          integer_text(int(columns, int64)))
      else
         call refuse_name(word, names, error)
      end if
   end subroutine find_column

   !> The error for a name that no column has.
   subroutine refuse_name(word, names, error)
      character(*), intent(in) :: word
      type(column_names_type), intent(in) :: names
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: message
      character(80), allocatable :: known(:)
      integer :: i, near

      message = "there is no column '"//word//"'"
      if (.not. names%known) then
         call fatal_error(error, status%invalid_argument, &
                          message//": the file does not name its columns; give numbers, counted from 1")
         return
      end if
      allocate (known(size(names%name)))
      do i = 1, size(known)
         known(i) = names%name(i)%text
      end do
      near = nearest_word(word, known)
      if (near > 0) message = message//", perhaps '"//names%name(near)%text//"'"
      message = message//"; the file has"
      do i = 1, min(size(known), 40)
         message = message//" '"//names%name(i)%text//"'"
      end do
      if (size(known) > 40) message = message//" ..."
      call fatal_error(error, status%invalid_argument, message)
   end subroutine refuse_name

   !> The columns of a comma list.
   subroutine choose_columns(list, names, columns, chosen, error)
      !> "2" or "gx,gz"
      character(*), intent(in) :: list
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> How many the file has
      integer, intent(in) :: columns
      !> As asked for, in this order
      integer, allocatable, intent(out) :: chosen(:)
      !> Allocated where there is no such column or one is named twice: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer :: room(len(list) + 1), count, from, to, i

      count = 0
      from = 1
      do while (from <= len(list) + 1)
         to = index(list(from:), ",")
         to = merge(len(list), from + to - 2, to == 0)
         count = count + 1
         call find_column(trim(adjustl(list(from:to))), names, columns, room(count), error)
         if (allocated(error)) return
         do i = 1, count - 1
            if (room(i) /= room(count)) cycle
            call fatal_error(error, status%invalid_argument, "the column '"//list(from:to)//"' is chosen twice")
            return
         end do
         from = to + 2
      end do
      chosen = room(:count)
   end subroutine choose_columns

end module gyroakf_io_columns
