! SPDX-License-Identifier: MIT
!> Lines of words above the rows of a table: names of the columns and their units, in comments too, as `rostopic echo -p`
!> (`%time,field.x`) and numpy's `savetxt` (`# t gx gy`) write them.
module gyroakf_io_heading
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : is_time_name, is_unit
   use gyroakf_io_columns, only : column_names_type, join_names, names_way, read_names, take_brackets_off
   use gyroakf_io_lines, only : lines_type
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_text, only : begins_with_semicolon, bytes_text, fields_type, first_visible, is_comment, &
      last_visible, split, split_line
   implicit none (type, external)
   private
   public :: only_words, has_labels, is_title, begins_with_names, take_heading, suppose_names

contains

   !> Keeps the bytes of the line of names.
   subroutine keep_heading(lines, last, layout)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(layout_type), intent(inout) :: layout
      integer(int64) :: from, to

      from = first_visible(lines%bytes, lines%at, last)
      to = last_visible(lines%bytes, lines%at, last)
      if (allocated(layout%heading)) deallocate (layout%heading)
      allocate (layout%heading(to - from + 1))
      layout%heading(:) = lines%bytes(from:to)
   end subroutine keep_heading

   !> True for a line that holds words and nothing like a number: names of columns.
   logical function only_words(lines, last)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last

      only_words = count_words(lines%bytes, lines%at, last) > 0
   end function only_words

   !> Words of a line, 0 where it holds anything like a number.
   integer function count_words(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(fields_type) :: fields
      integer :: i

      count_words = 0
      call split_line(bytes, first, last, names_way(bytes, first, last), fields)
      do i = 1, fields%count
         if (fields%last(i) < fields%first(i)) cycle
         if (begins_like_number(bytes, fields%first(i))) then
            count_words = 0
            return
         end if
         if (.not. is_missing_word(bytes_text(bytes, fields%first(i), fields%last(i)))) count_words = count_words + 1
      end do
   end function count_words

   !> True where a label stands before a number: "gx:1", "gx=-2".
   pure logical function has_labels(bytes, first, last)
      !> Holds the line at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64) :: i

      has_labels = .false.
      do i = first + 1, last - 1
         if (bytes(i) /= iachar(":") .and. bytes(i) /= iachar("=")) cycle
         has_labels = has_labels .or. begins_like_number(bytes, i + 1)
      end do
   end function has_labels

   !> True for a line above the names: it begins with a word, and the next line that is not empty holds words only.
   logical function is_title(lines, last)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      integer(int64) :: at, to

      at = first_visible(lines%bytes, lines%at, last)
      is_title = .not. begins_like_number(lines%bytes, at)
      at = last + 1
      do while (is_title .and. at < lines%last)
         to = at
         do while (lines%bytes(to) /= 10)
            to = to + 1
         end do
         if (first_visible(lines%bytes, at, to - 1) < to) exit
         at = to + 1
      end do
      if (is_title) is_title = at < lines%last
      if (is_title) is_title = .not. is_comment(lines%bytes, at, to - 1) .and. count_words(lines%bytes, at, to - 1) > 1 &
                              .and. .not. has_labels(lines%bytes, at, to - 1)
   end function is_title

   !> True for a line that begins with a semicolon and holds names between semicolons: the first column has none.
   logical function begins_with_names(lines, last)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last

      begins_with_names = begins_with_semicolon(lines%bytes, lines%at, last)
      if (begins_with_names) begins_with_names = count(lines%bytes(lines%at:last) == iachar(";")) > 1
      if (begins_with_names) begins_with_names = only_words(lines, last)
   end function begins_with_names

   !> True for a byte that a name does not begin with, and for the minus sign of mathematics (U+2212): what begins so is a number,
   !> right or wrong.
   pure logical function begins_like_number(bytes, at)
      !> Holds it, and a byte more
      integer(int8), intent(in), contiguous :: bytes(:)
      !> Its first byte
      integer(int64), intent(in) :: at

      begins_like_number = (bytes(at) >= 48 .and. bytes(at) <= 57) .or. bytes(at) == 43 .or. bytes(at) == 45
      if (bytes(at) == 46) begins_like_number = bytes(at + 1) >= 48 .and. bytes(at + 1) <= 57
      if (bytes(at) == -30_int8) begins_like_number = bytes(at + 1) == -120_int8 .and. bytes(at + 2) == -110_int8
   end function begins_like_number

   !> Takes in a line of words: names, units below them, or names below a title or below groups of columns.
   subroutine take_heading(lines, last, names, layout)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(column_names_type), intent(inout) :: names
      type(layout_type), intent(inout) :: layout
      type(column_names_type) :: above
      logical :: taken

      taken = .false.
      if (names%known) call take_units(lines, last, names, taken)
      if (taken) return
      above = names
      call read_names(lines%bytes, lines%at, last, lines%number, names)
      if (above%known .and. names%known) then
         if (size(above%name) == size(names%name)) call join_names(above, names)
      end if
      call keep_heading(lines, last, layout)
      layout%semicolons = any(lines%bytes(lines%at:last) == iachar(";"))
   end subroutine take_heading

   !> Takes in a line of units below the names, in brackets or not; not taken where no word of it is a unit.
   subroutine take_units(lines, last, names, taken)
      type(lines_type), intent(in) :: lines
      integer(int64), intent(in) :: last
      type(column_names_type), intent(inout) :: names
      logical, intent(out) :: taken
      type(column_names_type) :: words
      integer :: i, units, others

      call read_names(lines%bytes, lines%at, last, lines%number, words)
      taken = words%known
      if (taken) taken = size(words%name) == size(names%name)
      if (.not. taken) return
      units = 0
      others = 0
      do i = 1, size(words%name)
         if (scan(words%name(i)%text, "[(") == 1) call take_brackets_off(words%name(i)%text)
         if (len(words%name(i)%text) == 0) cycle
         units = units + merge(1, 0, is_unit(words%name(i)%text))
         others = others + merge(0, 1, is_unit(words%name(i)%text))
      end do
      taken = units > others
      if (taken) names%unit = words%name
   end subroutine take_units

   !> Takes a comment for names of columns: words between commas, semicolons or tabs, or a time and words between blanks.
   !>
   !> Whether they are names is decided later, by the number of columns.
   subroutine suppose_names(bytes, first, last, line, supposed)
      !> Holds the line at first:last; a line feed is behind it
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> Number of the line
      integer(int64), intent(in) :: line
      !> Left alone where the comment is no list of words, or has a colon or an equals sign
      type(column_names_type), intent(inout) :: supposed
      type(column_names_type) :: names
      integer(int64) :: from, to
      integer :: i

      if (any(bytes(first:last) == iachar(":") .or. bytes(first:last) == iachar("="))) return
      from = first
      do while (from <= last)
         if (scan(achar(iand(int(bytes(from)), 127)), "#%;/! "//achar(9)) == 0) exit
         from = from + 1
      end do
      to = last_visible(bytes, from, last)
      if (to < from) return
      call read_names(bytes, from, to, line, names)
      if (.not. names%known) return
      if (size(names%name) < 2) return
      if (names_way(bytes, from, to) == split%mixed .and. .not. is_time_name(names%name(1)%text)) return
      do i = 1, size(names%name)
         if (len(names%name(i)%text) == 0) cycle
         if (scan(names%name(i)%text(1:1), "+-0123456789") > 0) return
         if (names%name(i)%text(1:1) == "." .and. scan(names%name(i)%text, "0123456789") == 2) return
      end do
      supposed = names
   end subroutine suppose_names

end module gyroakf_io_heading
