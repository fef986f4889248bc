! SPDX-License-Identifier: MIT
!> Which columns were asked for: by number or by name, with a suggestion where no name fits.
module gyroakf_io_column_choice
   use gyroakf_column_class, only : class_of, column_class
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_columns, only : column_names_type, take_name
   use gyroakf_io_place, only : integer_text
   use gyroakf_spelling, only : lower, nearest_word
   implicit none (type, external)
   private
   public :: find_column, choose_columns

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

end module gyroakf_io_column_choice
