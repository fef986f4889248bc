! SPDX-License-Identifier: MIT
!> Which columns are analyzed: gyroscopes, then accelerometers. The others are listed.
module gyroakf_io_leave_out
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_layout, only : layout_type
   use gyroakf_io_row, only : agrees, join_fields
   use gyroakf_column_class, only : class_of, class_names, column_class
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, is_comment, line_feed_from, split, split_line
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: find_texts, is_text, classes_of, analyzed_columns, in_order, list_left_out

   !> So many lines at the start are looked at for text
   integer, parameter :: looked_at = 64
   !> So many columns are named in a warning
   integer, parameter :: most_listed = 40

contains

   !> Which columns hold words in all of the first rows.
   pure subroutine find_texts(bytes, first, last, layout, texts)
      !> Holds lines from first on, up to the line feed at last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> `columns` and `joined` are known
      type(layout_type), intent(in) :: layout
      !> [column]
      logical, allocatable, intent(out) :: texts(:)
      type(fields_type) :: fields
      integer(int64) :: at, to
      integer :: i, j
      logical :: wanted

      allocate (texts(layout%columns))
      texts(:) = .true.
      at = first
      do i = 1, looked_at
         if (at > last .or. .not. any(texts)) return
         to = line_feed_from(bytes, at)
         if (.not. is_comment(bytes, at, to - 1) .and. first_visible(bytes, at, to - 1) < to) then
            call split_line(bytes, at, to - 1, split%mixed, fields)
            call join_fields(bytes, layout, fields)
            wanted = fields%count >= layout%columns
            if (layout%where_column > 0) wanted = wanted .and. agrees(bytes, fields, layout)
            do j = 1, merge(layout%columns, 0, wanted)
               texts(j) = texts(j) .and. is_text(bytes, fields%first(j), fields%last(j))
            end do
         end if
         at = to + 1
      end do
   end subroutine find_texts

   !> True for a word that can be no number, not even a wrong one; what holds a number behind a colon is not.
   pure logical function is_text(bytes, first, last)
      !> Holds the field at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(*), parameter :: beginnings = "abcdefghijklmnopqrstuvwxyz_=:|>$"
      character(:), allocatable :: word
      integer :: mark

      is_text = .false.
      if (last < first) return
      word = lower(bytes_text(bytes, first, min(last, first + 63)))
      is_text = index(beginnings, word(1:1)) > 0 .or. word(1:min(2, len(word))) == "->"
      mark = scan(word(:len(word) - 1), ":=")
      if (mark > 0) is_text = is_text .and. verify(word(mark + 1:mark + 1), "0123456789+-.") > 0
      if (is_text) is_text = .not. is_missing_word(word)
   end function is_text

   !> What each column of a file measures.
   pure function classes_of(names, units, texts, columns) result(class)
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> Of the header's key `units`: [column], or of another size
      type(text_type), intent(in) :: units(:)
      !> Of [[find_texts]]: [column], or of size 0
      logical, intent(in) :: texts(:)
      integer, intent(in) :: columns
      integer :: class(columns), j
      character(:), allocatable :: name, unit

      do j = 1, columns
         name = ""
         unit = ""
         if (names%known) name = names%name(j)%text
         if (names%known) unit = names%unit(j)%text
         if (len(unit) == 0 .and. size(units) == columns) unit = units(j)%text
         class(j) = class_of(name, unit)
         if (size(texts) == columns) class(j) = merge(column_class%text, class(j), texts(j))
      end do
   end function classes_of

   !> Which columns are analyzed: gyroscopes and accelerometers, else what may be one, else all numbers.
   pure function analyzed_columns(class, angles) result(analyzed)
      !> Of some columns
      integer, intent(in) :: class(:)
      !> True where they hold angles or increments
      logical, intent(in) :: angles
      logical :: analyzed(size(class))

      if (angles) then
         analyzed = class == column_class%rate .or. class == column_class%acceleration .or. class == column_class%angle &
                    .or. class == column_class%unknown .or. class == column_class%other .or. class == column_class%position
      else if (any(class == column_class%rate)) then
         analyzed = class == column_class%rate .or. class == column_class%acceleration
      else
         analyzed = class == column_class%unknown .or. class == column_class%acceleration
      end if
      if (.not. any(analyzed)) analyzed = class /= column_class%text .and. class /= column_class%time .and. &
                                          class /= column_class%temperature .and. class /= column_class%counter
      if (.not. any(analyzed)) analyzed = class /= column_class%text .and. class /= column_class%time
      if (.not. any(analyzed)) analyzed = class /= column_class%text
   end function analyzed_columns

   !> The columns of the record in their order: gyroscopes, then accelerometers, then the others.
   pure function in_order(class) result(order)
      !> Of some columns
      integer, intent(in) :: class(:)
      integer :: order(size(class)), i

      order = [pack([(i, i=1, size(class))], class == column_class%rate), &
               pack([(i, i=1, size(class))], class == column_class%acceleration), &
               pack([(i, i=1, size(class))], class /= column_class%rate .and. class /= column_class%acceleration)]
   end function in_order

   !> One sentence on the columns that are not analyzed, with numbers and names, and what they measure.
   subroutine list_left_out(names, class, left, warnings)
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> [column]
      integer, intent(in) :: class(:)
      !> Columns that are neither analyzed nor the time: [column]
      logical, intent(in) :: left(:)
      type(text_type), allocatable, intent(inout) :: warnings(:)
      character(:), allocatable :: list
      integer :: j, before, named

      if (.not. any(left)) return
      list = ""
      before = 0
      named = 0
      do j = 1, size(class)
         if (.not. left(j)) cycle
         named = named + 1
         if (named > most_listed) exit
         if (before > 0) then
            if (class(before) /= class(j)) list = list//" ("//trim(class_names(class(before)))//");"
            if (class(before) == class(j)) list = list//","
         end if
         list = list//" "//integer_text(int(j, int64))
         if (names%known) list = list//" "//names%name(j)%text
         before = j
      end do
      list = trim(list)//" ("//trim(class_names(class(before)))//")"
      if (named > most_listed) list = list//" and more"
      call add_text(warnings, "columns not analyzed:"//list//"; --column reads them")
   end subroutine list_left_out

end module gyroakf_io_leave_out
