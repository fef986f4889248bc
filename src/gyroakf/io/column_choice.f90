! SPDX-License-Identifier: MIT
!> Which columns are read: by number or by name, with a suggestion where no name fits; else
!> gyroscopes, then accelerometers. The others are listed.
module gyroakf_io_column_choice
   use gyroakf_column_class, only : class_names, class_of, column_class
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : column_names_type, take_name
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_place, only : integer_text
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower, nearest_word
   implicit none (type, external)
   private
   public :: find_column, choose_columns
   public :: is_text, classes_of, analyzed_columns, in_order, list_left_out

   !> So many columns are named in a message
   integer, parameter :: most_listed = 40

contains

   !> The column that a number or a name means.
   subroutine find_column(word, names, columns, column, error)
      !> "2" or "gx"
      character(*), intent(in) :: word
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: columns
      integer, intent(out) :: column
      !> Allocated where there is no such column: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: name, unit

      column = 0
      call take_name(word, name, unit)
      if (names%known .and. len(word) > 0) then
         column = column_named(names, word, .true.)
         if (column == 0) column = column_named(names, word, .false.)
         if (column == 0) column = column_named(names, name, .true.)
      end if
      if (column > 0) return
      if (len(word) > 0 .and. len(word) < 10 .and. verify(word, "0123456789") == 0) then
         read (word, "(i9)") column
         if (column >= 1 .and. column <= columns) return
         column = 0
         call fatal_error(error, status%invalid_argument, "there is no column "//word// &
            ": the file has columns 1 to "//integer_text(columns))
      else
         call refuse_name(word, names, error)
      end if
   end subroutine find_column

   !> The column of that name, 0 where there is none or, apart from case, more than one.
   pure integer function column_named(names, name, exact) result(column)
      type(column_names_type), intent(in) :: names
      character(*), intent(in) :: name
      logical, intent(in) :: exact
      integer :: i

      column = 0
      do i = 1, size(names%name)
         if (exact .and. names%name(i)%text /= name) cycle
         if (lower(names%name(i)%text) /= lower(name)) cycle
         if (column > 0) then
            column = 0
            return
         end if
         column = i
      end do
   end function column_named

   subroutine refuse_name(word, names, error)
      character(*), intent(in) :: word
      type(column_names_type), intent(in) :: names
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: message
      character(80), allocatable :: known(:)
      integer :: i, near

      message = "there is no column '"//word//"'"
      if (.not. names%known) call fatal_error(error, status%invalid_argument, message// &
         ": the file does not name its columns; give numbers, counted from 1")
      if (allocated(error)) return
      allocate (known(size(names%name)))
      do i = 1, size(known)
         known(i) = ""
         if (may_mean(word, names%name(i)%text)) known(i) = names%name(i)%text
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

   !> True where a name may be another one misspelt: the same digits and the same last letter, so
   !> the same axis, and nothing that makes it the name of another quantity.
   pure logical function may_mean(word, name)
      character(*), intent(in) :: word, name
      character(*), parameter :: digits = "0123456789", letters = "abcdefghijklmnopqrstuvwxyz"
      integer :: last(2), class(2)

      may_mean = kept(word, digits) == kept(name, digits) .and. len(name) > 0
      last = [scan(lower(word), letters, back=.true.), scan(lower(name), letters, back=.true.)]
      if (.not. may_mean .or. any(last == 0)) return
      may_mean = lower(word(last(1):last(1))) == lower(name(last(2):last(2)))
      class = [class_of(word, ""), class_of(name, "")]
      may_mean = may_mean .and. (class(1) == class(2) .or. (class(1) == column_class%unknown .and. &
         len(word) /= len(name)) .or. (class(1) == column_class%unknown .and. len(word) > 4))
   end function may_mean

   !> The characters of a text that are in a set, then blanks.
   pure function kept(text, set) result(left)
      character(*), intent(in) :: text, set
      character(len(text)) :: left
      integer :: i, n

      left = ""
      n = 0
      do i = 1, len(text)
         if (scan(text(i:i), set) == 0) cycle
         n = n + 1
         left(n:n) = text(i:i)
      end do
   end function kept

   !> The columns of a comma list.
   subroutine choose_columns(list, names, columns, chosen, error)
      !> "2" or "gx,gz"
      character(*), intent(in) :: list
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: columns
      !> As asked for, in this order
      integer, allocatable, intent(out) :: chosen(:)
      !> Allocated where there is no such column or one is named twice: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer :: column(len(list) + 1), count, from, to, i

      count = 0
      from = 1
      do while (from <= len(list) + 1)
         to = index(list(from:), ",")
         to = merge(len(list), from + to - 2, to == 0)
         count = count + 1
         call find_column(trim(adjustl(list(from:to))), names, columns, column(count), error)
         if (allocated(error)) return
         do i = 1, count - 1
            if (column(i) /= column(count)) cycle
            call fatal_error(error, status%invalid_argument, "the column '"//list(from:to)// &
               "' is chosen twice")
            return
         end do
         from = to + 2
      end do
      chosen = column(:count)
   end subroutine choose_columns

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

end module gyroakf_io_column_choice
