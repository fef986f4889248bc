! SPDX-License-Identifier: MIT
!> Of what kinds the lines of a text are: which options and commands might read it.
module gyroakf_app_line_kinds
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : is_time_name
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_heading, only : find_pattern
   use gyroakf_io_labels, only : name_fields
   use gyroakf_io_marks, only : find_marks, marks_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_text, only : bytes_text, fields_type, is_no_row, split, split_line
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: line_type, take_lines, list_kinds, lines_together, lines_above, number_columns

   !> So many lines are searched for kinds of records, and so many kinds are tried
   integer, parameter :: most_lines = 4000, most_kinds = 4
   !> Lines of a record, at most
   integer, parameter :: most_together = 64
   !> A choice of more columns is not named
   integer, parameter :: most_columns = 64

   !> A line of the file
   type :: line_type
      character(:), allocatable :: pattern
      !> COLUMN=VALUE, where a word or a label names the kind of the record; "" where none does
      character(:), allocatable :: kind
   end type line_type

contains

   !> The lines of a text, with their patterns and kinds.
   subroutine take_lines(bytes, line)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(line_type), allocatable, intent(out) :: line(:)
      type(marks_type) :: marks
      integer(int64) :: at, feed
      integer :: i

      allocate (line(min(most_lines, count(bytes == 10))))
      at = 1
      do i = 1, size(line)
         feed = at - 1 + findloc(bytes(at:), 10_int8, dim=1)
         line(i)%pattern = ""
         line(i)%kind = ""
         if (.not. is_no_row(bytes, at, feed - 1)) then
            call find_pattern(bytes, at, feed - 1, line(i)%pattern, marks)
            call find_kind(bytes(at:feed - 1), line(i))
         end if
         at = feed + 1
      end do
   end subroutine take_lines

   !> The kind of a record: its first label, or the first word.
   subroutine find_kind(bytes, line)
      !> The line
      integer(int8), intent(in), contiguous :: bytes(:)
      type(line_type), intent(inout) :: line
      type(marks_type) :: marks
      integer(int8) :: plain(size(bytes))
      type(column_names_type) :: names
      type(fields_type) :: fields
      character(:), allocatable :: text
      integer :: array, word, label, i

      plain(:) = bytes
      call find_marks(plain, 1_int64, size(plain, kind=int64), .true., marks)
      call split_line(plain, 1_int64, size(plain, kind=int64), split%mixed, fields)
      word = index(line%pattern, "t")
      label = 0
      if (marks%labels > 0 .and. len(line%pattern) > 1) then
         call name_fields(bytes, 1_int64, fields, names, array)
         if (names%known) label = findloc([(len(names%name(i)%text) > 0, i=1, size(names%name))], &
                                          .true., dim=1)
      end if
      text = ""
      if (word > 0) text = bytes_text(plain, fields%first(word), fields%last(word))
      if (word > 0 .and. verify(text, "->:=|") == 0) word = label
      if (label > 0 .and. (word == 0 .or. word >= label)) then
         text = names%name(label)%text(:index(names%name(label)%text//"[", "[") - 1)
         line%kind = integer_text(int(label, int64))//"="//text
      else if (word > 0 .and. index(line%pattern, "n") > 0) then
         line%kind = integer_text(int(word, int64))//"="//text
      end if
   end subroutine find_kind

   !> Kinds of records that are met three times at least, those that are met most first; none where
   !> all lines are of one.
   subroutine list_kinds(line, kinds)
      type(line_type), intent(in) :: line(:)
      type(text_type), allocatable, intent(out) :: kinds(:)
      type(text_type), allocatable :: found(:)
      integer :: times(64), i, k
      logical :: several

      allocate (kinds(0), found(0))
      times = 0
      do i = 1, size(line)
         if (line(i)%kind == "") cycle
         do k = 1, size(found)
            if (found(k)%text == line(i)%kind) exit
         end do
         if (k > size(times)) cycle
         if (k > size(found)) call add_text(found, line(i)%kind)
         times(k) = times(k) + 1
      end do
      several = size(found) > 1
      do i = 1, size(line)
         several = several .or. (line(i)%kind == "" .and. len(line(i)%pattern) > 0)
      end do
      do while (size(kinds) < most_kinds .and. several .and. any(times > 2))
         k = maxloc(times, dim=1)
         call add_text(kinds, found(k)%text)
         times(k) = 0
      end do
   end subroutine list_kinds

   !> Lines above the first three in a row that hold as many numbers each and nothing else; but for
   !> names right above these.
   pure integer(int64) function lines_above(line) result(above)
      type(line_type), intent(in) :: line(:)
      integer :: i

      above = 0
      do i = 2, size(line) - 2
         if (len(line(i)%pattern) == 0 .or. verify(line(i)%pattern, "n") > 0) cycle
         if (line(i)%pattern /= line(i + 1)%pattern) cycle
         if (line(i)%pattern /= line(i + 2)%pattern) cycle
         above = i - 1
         associate (before => line(i - 1)%pattern)
            if (len(before) == len(line(i)%pattern) .and. verify(before, "t") == 0) above = i - 2
         end associate
         return
      end do
   end function lines_above

   !> The columns that hold numbers in most lines and have no name of a time, as a list.
   pure function number_columns(line, names) result(list)
      type(line_type), intent(in) :: line(:)
      type(column_names_type), intent(in) :: names
      character(:), allocatable :: list
      integer :: i, j, n
      logical :: fits(size(line)), is_number(size(line))

      n = 0
      if (size(line) > 0) n = len(line((size(line) + 1)/2)%pattern)
      fits = [(len(line(i)%pattern) == n, i=1, size(line))]
      list = ""
      if (n > most_columns) return
      do j = 1, n
         if (names%known) then
            if (j > size(names%name)) return
            if (is_time_name(names%name(j)%text, names%unit(j)%text)) cycle
         end if
         is_number = [(index(line(i)%pattern(j:), "n") == 1, i=1, size(line))]
         if (10*count(is_number .and. fits) < 8*count(fits)) cycle
         list = list//trim(merge(",", " ", len(list) > 0))//integer_text(int(j, int64))
      end do
   end function number_columns

   !> How many lines a record spans: after so many the patterns and kinds repeat; 1 where all lines
   !> are alike or none repeat.
   pure integer function lines_together(line) result(lines)
      type(line_type), intent(in) :: line(:)
      logical :: again
      integer :: i

      do lines = 1, min(most_together, size(line)/3)
         do i = lines + 1, size(line)
            associate (this => line(i), earlier => line(i - lines))
               again = this%pattern == earlier%pattern .and. this%kind == earlier%kind
            end associate
            if (.not. again) exit
         end do
         if (i > size(line)) return
      end do
      lines = 1
   end function lines_together

end module gyroakf_app_line_kinds
