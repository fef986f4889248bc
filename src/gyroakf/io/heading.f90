! SPDX-License-Identifier: MIT
!> Lines of words above the rows of a table: names of the columns and their units, in comments too,
!> as `rostopic echo -p` (`%time,field.x`) and numpy's `savetxt` (`# t gx gy`) write them.
module gyroakf_io_heading
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : is_time_name, is_unit
   use gyroakf_io_columns, only : column_names_type, count_names, join_names, names_way, read_names
   use gyroakf_io_date, only : is_digit
   use gyroakf_io_column_choice, only : is_text
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_marks, only : find_marks, marks_type
   use gyroakf_io_number, only : is_missing_field
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, &
      has_fields, is_no_row, last_visible, line_feed_from, split, split_line
   implicit none (type, external)
   private
   public :: only_words, find_pattern, alike, is_setting, labels_are_names, suppose_names, &
      suppose_record_names, take_heading

   !> So many lines below one that may be a setting are looked at
   integer, parameter :: most_ahead = 256

contains

   !> True for a line that holds words and nothing like a number: names of columns.
   pure logical function only_words(bytes, first, last)
      !> Holds the line and its end
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(fields_type) :: fields
      integer :: i
      logical :: numbers

      only_words = .false.
      numbers = .false.
      call split_line(bytes, first, last, names_way(bytes, first, last), fields)
      do i = 1, fields%count
         if (fields%last(i) < fields%first(i)) cycle
         numbers = numbers .or. begins_like_number(bytes, fields%first(i))
         only_words = only_words .or. .not. is_missing_field(bytes, fields%first(i), fields%last(i))
      end do
      only_words = only_words .and. .not. numbers
   end function only_words

   !> What the fields of a line hold: "n" a number, right or wrong, "t" a word, "-" a missing one.
   subroutine find_pattern(bytes, first, last, pattern, marks)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable, intent(out) :: pattern
      type(marks_type), intent(out) :: marks
      type(fields_type) :: fields
      integer(int8), allocatable :: line(:)
      integer :: j, failed

      pattern = ""
      allocate (line(last - first + 1), stat=failed)
      if (failed /= 0) return
      line(:) = bytes(first:last)
      if (any(line == iachar(";"))) then
         where (line == iachar(",")) line = iachar(".")                         ! decimal commas
      end if
      call find_marks(line, 1_int64, size(line, kind=int64), .true., marks)
      call split_line(line, 1_int64, size(line, kind=int64), split%mixed, fields)
      pattern = repeat("n", fields%count - merge(1, 0, fields%trailing))
      do j = 1, len(pattern)
         if (fields%last(j) < fields%first(j)) then
            pattern(j:j) = " "
         else if (is_missing_field(line, fields%first(j), fields%last(j))) then
            pattern(j:j) = "-"
         end if
         if (is_text(bytes_text(line, fields%first(j), fields%last(j)))) pattern(j:j) = "t"
      end do
   end subroutine find_pattern

   !> True for a setting above the table: words among numbers, or a label, unlike the lines below.
   !>
   !> It is a row where the next one, or two behind others, have the same number of fields, labels
   !> and words in the same places; with a word in front these begin with the same one: records of
   !> several kinds. So is what begins with a number and has as many fields.
   logical function is_setting(lines, pattern, marks)
      type(lines_type), intent(in) :: lines
      character(*), intent(in) :: pattern
      type(marks_type), intent(in) :: marks
      character(:), allocatable :: other
      type(marks_type) :: other_marks
      integer(int64) :: at, to
      integer :: i, again

      again = 0
      is_setting = index(pattern, "t") > 0 .and. index(pattern, "n") == 0
      if (is_setting .or. (index(pattern, "t") == 0 .and. marks%labels == 0)) return
      at = lines%to + 1
      do i = 1, most_ahead
         at = line_feed_from(lines%bytes, at) + 1
         if (at > lines%last) return
         to = line_feed_from(lines%bytes, at)
         if (is_no_row(lines%bytes, at, to - 1)) cycle
         call find_pattern(lines%bytes, at, to - 1, other, other_marks)
         if (len(other) == 0) cycle
         if (other_marks%skeleton /= marks%skeleton .or. .not. alike(pattern, other)) then
            is_setting = .true.
            if (len(pattern) == len(other) .and. pattern(1:1) /= "t" .and. marks%labels == 0) exit
         else if (pattern(1:1) /= "t" .or. begin_alike(lines%bytes, lines%at, at)) then
            again = again + 1
            if (again > 1 .or. .not. is_setting) exit
         end if
      end do
      if (i <= most_ahead) is_setting = .false.
   end function is_setting

   !> True for names in the form of labels, "time: s, gx: deg/s", above a row of as many numbers.
   logical function labels_are_names(lines, pattern)
      type(lines_type), intent(in) :: lines
      character(*), intent(in) :: pattern
      character(:), allocatable :: other
      type(marks_type) :: marks
      type(fields_type) :: fields
      integer(int64) :: at

      at = line_feed_from(lines%bytes, lines%to + 1) + 1
      labels_are_names = index(pattern, "n") == 0 .and. at <= lines%last
      if (.not. labels_are_names) return
      call find_pattern(lines%bytes, at, line_feed_from(lines%bytes, at) - 1, other, marks)
      call split_line(lines%bytes, lines%at, lines%to, names_way(lines%bytes, lines%at, lines%to), &
         fields)
      labels_are_names = marks%labels == 0 .and. verify(other, "n- ") == 0 .and. &
         index(other, "n") > 0 .and. has_fields(fields, len(other))
   end function labels_are_names

   pure logical function begin_alike(bytes, first, second)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, second
      character(*), parameter :: ends = " ,;:="//achar(9)//achar(10)//achar(13)
      integer(int64) :: i

      i = 0
      do while (bytes(first + i) == bytes(second + i) .and. &
         scan(achar(iand(int(bytes(first + i)), 255)), ends) == 0)
         i = i + 1
      end do
      begin_alike = bytes(first + i) == bytes(second + i)
   end function begin_alike

   !> True for patterns of rows of one table: equal but for what is missing.
   pure logical function alike(pattern, other)
      character(*), intent(in) :: pattern, other
      integer :: j

      alike = len(pattern) == len(other)
      if (alike) alike = all([(pattern(j:j) == other(j:j) .or. &
         scan(pattern(j:j)//other(j:j), "- ") > 0, j=1, len(pattern))])
   end function alike

   !> True for a byte that a name does not begin with, perhaps behind brackets: what begins so, or
   !> with U+2212, is a number, right or wrong.
   pure recursive logical function begins_like_number(bytes, at) result(begins)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: at

      begins = is_digit(bytes(at)) .or. bytes(at) == 43 .or. bytes(at) == 45
      if (bytes(at) == 46) begins = is_digit(bytes(at + 1))
      if (bytes(at) == -30_int8) begins = bytes(at + 1) == -120_int8 .and. &
         bytes(at + 2) == -110_int8
      if (any(bytes(at) == iachar(["(", "<", "["]))) then
         begins = begins_like_number(bytes, at + 1) .and. bytes(at + 2) /= iachar("]")
      end if
   end function begins_like_number

   !> Takes in a line of words: names, units below them, names below a title or groups of columns.
   subroutine take_heading(lines, behind_setting, names, layout)
      type(lines_type), intent(in) :: lines
      !> True where a setting stands between the names so far and this line
      logical, intent(in) :: behind_setting
      type(column_names_type), intent(inout) :: names
      type(layout_type), intent(inout) :: layout
      type(column_names_type) :: above
      logical :: taken

      taken = .false.
      if (names%known .and. .not. behind_setting) call take_units(lines, names, taken)
      if (taken) return
      above = names
      call read_names(lines%bytes, lines%at, lines%to, lines%number, names)
      if (above%known .and. count_names(above) == count_names(names) .and. &
         .not. behind_setting) call join_names(above, names)
      associate (bytes => lines%bytes)
         layout%heading = &
            bytes(first_visible(bytes, lines%at, lines%to):last_visible(bytes, lines%at, lines%to))
      end associate
      layout%semicolons = any(lines%bytes(lines%at:lines%to) == iachar(";"))
   end subroutine take_heading

   !> Takes in a line of units below the names, in brackets or not, if it is one.
   subroutine take_units(lines, names, taken)
      type(lines_type), intent(in) :: lines
      type(column_names_type), intent(inout) :: names
      logical, intent(out) :: taken
      type(column_names_type) :: words
      integer :: i, last, units, others

      call read_names(lines%bytes, lines%at, lines%to, lines%number, words)
      taken = count_names(words) == count_names(names)
      if (.not. taken) return
      units = 0
      others = 0
      do i = 1, size(words%name)
         associate (word => words%name(i)%text)
            last = len(word)
            if (scan(word, "[(") == 1) then
               if (last > 1 .and. scan(word, "])", back=.true.) == last) last = last - 1
               words%name(i)%text = trim(adjustl(word(2:last)))
            end if
         end associate
         if (len(words%name(i)%text) == 0) cycle
         units = units + merge(1, 0, is_unit(words%name(i)%text))
         others = others + merge(0, 1, is_unit(words%name(i)%text))
      end do
      taken = units > others
      if (taken) names%unit = words%name
   end subroutine take_units

   !> Takes a comment for names: words between separators, or a time and words between blanks.
   !>
   !> Whether they are names is decided later, by the number of columns.
   subroutine suppose_names(lines, supposed)
      type(lines_type), intent(in) :: lines
      !> Left alone where the comment is no list of words, or has a colon or an equals sign
      type(column_names_type), intent(inout) :: supposed
      type(column_names_type) :: names
      integer(int64) :: from, to

      if (scan(bytes_text(lines%bytes, lines%at, lines%to), ":=") > 0) return
      from = lines%at - 1 + verify(bytes_text(lines%bytes, lines%at, lines%to)//"x", "#%;/! "// &
         achar(9))
      to = last_visible(lines%bytes, from, lines%to)
      if (to < from) return
      call read_names(lines%bytes, from, to, lines%number, names)
      if (count_names(names) < 2) return
      if (names_way(lines%bytes, from, to) == split%mixed .and. &
         .not. is_time_name(names%name(1)%text, "")) return
      if (only_words(lines%bytes, from, to)) supposed = names
   end subroutine suppose_names

   !> Takes the words behind the name of a record for the names of its fields: `FMT, 134, 51, IMU,
   !> QBfff, TimeUS,I,GyrX,GyrY,GyrZ`.
   subroutine suppose_record_names(bytes, fields, line, record, supposed)
      integer(int8), intent(in), contiguous :: bytes(:)
      type(fields_type), intent(in) :: fields
      integer(int64), intent(in) :: line
      integer(int8), intent(in), contiguous :: record(:)
      !> Left alone where there are no words behind the name, or numbers among them
      type(column_names_type), intent(inout) :: supposed
      integer :: j

      do j = 1, fields%count - 2
         if (fields%last(j) - fields%first(j) + 1 /= size(record)) cycle
         if (all(bytes(fields%first(j):fields%last(j)) == record)) exit
      end do
      if (j > fields%count - 2) return
      associate (first => fields%first(j + 1), last => fields%last(fields%count))
         if (only_words(bytes, first, last)) call read_names(bytes, first, last, line, supposed)
      end associate
   end subroutine suppose_record_names

end module gyroakf_io_heading
