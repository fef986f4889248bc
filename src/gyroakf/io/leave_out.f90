! SPDX-License-Identifier: MIT
!> Which columns are analyzed: gyroscopes, then accelerometers. The others are listed.
module gyroakf_io_leave_out
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_place, only : integer_text
   use gyroakf_column_class, only : class_of, class_names, column_class
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: is_text, classes_of, analyzed_columns, in_order, list_left_out

   !> So many columns are named in a warning
   integer, parameter :: most_listed = 40

contains

   !> True for a word that can be no number, not even a wrong one or one behind a colon.
   pure logical function is_text(field)
      character(*), intent(in) :: field
      character(*), parameter :: beginnings = "abcdefghijklmnopqrstuvwxyz_=:|>$"
      character(2), parameter :: degree = char(194)//char(176)
      character(min(len(field), 64)) :: word
      integer :: mark

      is_text = .false.
      if (len(field) == 0) return
      word = lower(field(:len(word)))
      is_text = index(beginnings, word(1:1)) > 0 .or. verify(word, "-") == 0 .or. any(&
         ["->", "0x", degree] == word(1:min(2, len(word))))
      mark = scan(word(:len(word) - 1), ":=")
      if (mark > 0) is_text = is_text .and. verify(word(mark + 1:mark + 1), "0123456789+-.") > 0
      if (is_text) is_text = .not. is_missing_word(word)
   end function is_text

   !> What each column of a file measures; p, q and r together are the rates of a body.
   pure function classes_of(names, units, texts, columns) result(class)
      type(column_names_type), intent(in) :: names
      !> Of the header's key `units`: [column], or of another size
      type(text_type), intent(in) :: units(:)
      !> Columns of words: [column], or of size 0
      logical, intent(in) :: texts(:)
      integer, intent(in) :: columns
      integer :: class(columns), i, j, turns(3)
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
      if (.not. names%known) return
      turns = [(findloc([(lower(names%name(j)%text) == "pqr"(i:i), j=1, columns)], .true., dim=1), &
         i=1, 3)]
      if (all(turns > 0)) class(turns) = column_class%rate
   end function classes_of

   !> Which columns are analyzed: gyroscopes and accelerometers, else what may be one, else all.
   pure function analyzed_columns(class, angles) result(analyzed)
      integer, intent(in) :: class(:)
      !> True where they hold angles or increments
      logical, intent(in) :: angles
      logical :: analyzed(size(class))

      if (angles) then
         analyzed = class == column_class%rate .or. class == column_class%acceleration .or. &
            class == column_class%angle .or. class == column_class%unknown .or. &
            class == column_class%other .or. class == column_class%position
      else if (any(class == column_class%rate)) then
         analyzed = class == column_class%rate .or. class == column_class%acceleration
      else
         analyzed = class == column_class%unknown .or. class == column_class%acceleration
      end if
      if (.not. any(analyzed)) analyzed = class /= column_class%text .and. &
         class /= column_class%time .and. class /= column_class%temperature .and. &
         class /= column_class%counter
      if (.not. any(analyzed)) analyzed = class /= column_class%text .and. &
         class /= column_class%time
      if (.not. any(analyzed)) analyzed = class /= column_class%text
   end function analyzed_columns

   !> The columns of the record in their order: gyroscopes, then accelerometers, then the others.
   pure function in_order(class) result(order)
      integer, intent(in) :: class(:)
      integer :: order(size(class)), i

      order = [pack([(i, i=1, size(class))], class == column_class%rate), &
         pack([(i, i=1, size(class))], class == column_class%acceleration), pack([(i, i=1, &
         size(class))], class /= column_class%rate .and. class /= column_class%acceleration)]
   end function in_order

   !> One sentence on the columns that are not analyzed: numbers, names, what they measure.
   subroutine list_left_out(names, class, left, warnings)
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
         list = list//" "//integer_text(j)
         if (names%known) list = list//" "//names%name(j)%text
         before = j
      end do
      list = trim(list)//" ("//trim(class_names(class(before)))//")"
      if (named > most_listed) list = list//" and more"
      call add_text(warnings, "columns not analyzed:"//list//"; `columns` reads them", note=.true.)
   end subroutine list_left_out

end module gyroakf_io_leave_out
