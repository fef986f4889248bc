! SPDX-License-Identifier: MIT
!> Columns that are no rates: text, temperatures, further times. They are left out unless they were asked for, and it is said.
module gyroakf_io_leave_out
   use gyroakf_kinds, only : int8, int64
   use gyroakf_io_columns, only : column_names_type, label_of
   use gyroakf_io_number, only : is_missing_word
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_rows, only : join_fields, layout_type
   use gyroakf_column_class, only : is_temperature_name, is_time_name
   use gyroakf_io_text, only : bytes_text, fields_type, first_visible, is_comment, last_visible, split, split_line
   use gyroakf_record, only : add_text, text_type
   use gyroakf_spelling, only : lower
   implicit none (type, external)
   private
   public :: find_texts, leave_out, list_number_columns

   !> So many lines at the start are looked at for text
   integer, parameter :: looked_at = 64
   !> So many columns are named in a warning
   integer, parameter :: most_named = 12

contains

   !> Which columns hold words in all of the first lines.
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

      allocate (texts(layout%columns))
      texts(:) = .true.
      at = first
      do i = 1, looked_at
         if (at > last .or. .not. any(texts)) return
         to = at
         do while (bytes(to) /= 10)
            to = to + 1
         end do
         if (.not. is_comment(bytes, at, to - 1) .and. first_visible(bytes, at, to - 1) < to) then
            call split_line(bytes, at, to - 1, split%mixed, fields)
            call join_fields(bytes, layout, fields)
            if (fields%count < layout%columns) texts(:) = .false.
            do j = 1, merge(layout%columns, 0, any(texts))
               texts(j) = texts(j) .and. is_text(bytes, fields%first(j), fields%last(j))
            end do
         end if
         at = to + 1
      end do
   end subroutine find_texts

   !> True for a word that can be no number, not even a wrong one; what holds a number behind a colon is not.
   pure logical function is_text(bytes, first, last)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(*), parameter :: beginnings = "abcdefghijklmnopqrstuvwxyz_=:|>"
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

   !> Takes out of the chosen columns what is no rate, and says so; nothing is left out where nothing would be left.
   subroutine leave_out(names, texts, time, fraction, chosen, warnings)
      !> Of the file
      type(column_names_type), intent(in) :: names
      !> Of [[find_texts]]: [column], or of size 0
      logical, intent(in) :: texts(:)
      !> The columns of the time and of its fractions of a second, 0 where there are none
      integer, intent(in) :: time, fraction
      !> Some columns; afterwards those that stay
      integer, allocatable, intent(inout) :: chosen(:)
      !> What was left out
      type(text_type), allocatable, intent(inout) :: warnings(:)
      logical, dimension(size(chosen)) :: text, warm, other_time, part
      integer :: i

      do i = 1, size(chosen)
         text(i) = .false.
         if (size(texts) > 0) text(i) = texts(chosen(i))
         part(i) = chosen(i) == fraction
         warm(i) = .false.
         other_time(i) = .false.
         if (.not. names%known .or. text(i) .or. part(i)) cycle
         associate (name => names%name(chosen(i))%text, unit => names%unit(chosen(i))%text)
            other_time(i) = time > 0 .and. is_time_name(name, unit)
            warm(i) = is_temperature_name(name, unit) .and. .not. other_time(i) .and. (time > 0 .or. name /= "T")
         end associate
      end do
      if (all(text .or. warm .or. other_time .or. part)) return
      call say(names, pack(chosen, text), "text", "", warnings)
      call say(names, pack(chosen, warm), "a temperature", "; --column reads it", warnings)
      call say(names, pack(chosen, other_time), "a further time", "; --time-column takes it for the time", warnings)
      chosen = pack(chosen, .not. (text .or. warm .or. other_time .or. part))
   end subroutine leave_out

   !> One warning for all columns of a kind.
   subroutine say(names, columns, what, advice, warnings)
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: columns(:)
      character(*), intent(in) :: what, advice
      type(text_type), allocatable, intent(inout) :: warnings(:)
      character(:), allocatable :: list
      integer :: i

      if (size(columns) == 0) return
      if (size(columns) == 1) then
         call add_text(warnings, label_of(names, columns(1))//" holds "//what//" and is left out"//advice)
         return
      end if
      list = ""
      do i = 1, min(size(columns), most_named)
         list = list//", "//label_of(names, columns(i))
      end do
      if (size(columns) > most_named) list = list//", ..."
      call add_text(warnings, integer_text(size(columns, kind=int64))//" columns hold "//what//" and are left out: "//list(3:))
   end subroutine say

   !> The columns that hold numbers in a line, as a list for --column: "4,6,8"; "" where there are none.
   subroutine list_number_columns(bytes, first, last, list)
      !> Holds the line at first:last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      character(:), allocatable, intent(out) :: list
      character(:), allocatable :: word
      type(fields_type) :: fields
      integer :: i

      list = ""
      call split_line(bytes, first, last_visible(bytes, first, last), split%mixed, fields)
      do i = 1, min(fields%count, most_named)
         if (fields%last(i) < fields%first(i)) cycle
         word = bytes_text(bytes, fields%first(i), fields%last(i))
         if (verify(word, "0123456789+-.eE") > 0 .or. scan(word, "0123456789") == 0) cycle
         list = list//","//integer_text(int(i, int64))
      end do
      if (len(list) > 0) list = list(2:)
   end subroutine list_number_columns

end module gyroakf_io_leave_out
