! SPDX-License-Identifier: MIT
!> Options and commands that read a recording which cannot be read as it is: each is tried on the first megabyte before it is
!> named.
module gyroakf_app_remedy
   use gyroakf_kinds, only : int8, int64
   use gyroakf_column_class, only : is_time_name
   use gyroakf_error, only : error_type
   use gyroakf_io_columns, only : column_names_type
   use gyroakf_io_heading, only : find_pattern
   use gyroakf_io_labels, only : name_fields
   use gyroakf_io_marks, only : find_marks, marks_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_io_recording, only : recording_type
   use gyroakf_io_text, only : bytes_text, fields_type, is_no_row, split, split_line
   use gyroakf_record, only : add_text, record_type, text_type
   use gyroakf_app_words, only : shell_word
   implicit none (type, external)
   private
   public :: add_remedies

   !> So many lines are searched for kinds of records, and so many kinds are tried
   integer, parameter :: most_lines = 4000, most_kinds = 4
   !> Lines of a record, at most
   integer, parameter :: most_together = 64
   !> A choice of more columns is not named
   integer, parameter :: most_columns = 64

   !> The sign of degrees in UTF-8
   character(*), parameter :: degree = char(194)//char(176)

   !> A line of the file
   type :: line_type
      character(:), allocatable :: pattern
      !> COLUMN=VALUE, where a word or a label names the kind of the record; unallocated where none does
      character(:), allocatable :: kind
   end type line_type

contains

   !> Adds a line "options that read it: --where 1=IMU; --where 1=GPS" to the message, where there are
   !> any, else one of a command.
   subroutine add_remedies(recording, error)
      !> Could not be read
      type(recording_type), intent(in) :: recording
      !> Why
      type(error_type), intent(inout) :: error
      type(line_type), allocatable :: line(:)
      type(text_type), allocatable :: kinds(:)
      integer(int8), allocatable, target :: head(:)
      character(:), allocatable :: list
      integer :: i, tried

      tried = 0
      if (.not. (allocated(recording%lines%head) .and. allocated(recording%table%name))) return
      allocate (head, source=recording%lines%head)
      call take_lines(head, line)
      list = ""
      if (allocated(recording%table%kinds)) then
         do i = 1, size(recording%table%kinds)
            call try("where", recording%table%kinds(i)%text)
         end do
         if (tried < size(recording%table%kinds)) list = ""
      end if
      call list_kinds(line, kinds)
      do i = 1, merge(size(kinds), 0, len(list) == 0)
         call try("where", kinds(i)%text)
      end do
      if (len(list) == 0) call try_commands()
      if (index(list, "|") > 0) error%message = error%message//new_line("a")//"a command that reads it: "//list(3:)
      if (index(list, "|") > 0) return
      if (recording%table%rows < 16) call try("skip", integer_text(lines_above(line)))
      if (recording%table%rows == 0) call try("column", number_columns(line, recording%table%names))
      if (index(error%message, "decimal comma") > 0) call try("decimal-comma", "")
      if (recording%table%rows > 0 .and. len(list) == 0) call try("bad-lines", "missing")
      if (allocated(recording%table%chosen)) then
         if (size(recording%table%chosen) == 0) call try("time-column", "none")
      end if
      if (len(list) > 0) error%message = error%message//new_line("a")//"options that read it: "//list(3:)

   contains

      !> Joins the lines of a record, or parts what stands together in the field that is no number.
      subroutine try_commands()
         character(:), allocatable :: field
         integer :: lines, mark
         character(1) :: sign

         lines = lines_together(line)
         if (lines > 1) call try_text("paste -d' '"//repeat(" -", lines), &
                                      joined_lines(recording%lines%head, lines))
         mark = index(error%message, "' is not a number")
         if (mark == 0 .or. len(list) > 0) return
         field = error%message(index(error%message(:mark - 1), "'", back=.true.) + 1:mark - 1)
         mark = verify(field, "0123456789+-.")
         if (mark < 2) return
         sign = field(mark:mark)
         if (scan(sign, "/|#~&!@_^") > 0) then
            call try_text("tr '"//sign//"' ' '", &
                          merge(int(iachar(" "), int8), head, head == iachar(sign)))
         else if (sign /= "e" .and. sign /= "E") then
            call try_text("sed -E 's/([0-9.])([a-df-zA-DF-Z"//degree//"])/\1 \2/g'", &
                          parted_units(recording%lines%head))
         end if
      end subroutine try_commands

      !> The text that is tried.
      subroutine set_head(text)
         integer(int8), intent(in) :: text(:)

         deallocate (head)
         allocate (head, source=text)
      end subroutine set_head

      !> Reads what a command makes of the head; names the command where that succeeds.
      subroutine try_text(command, text)
         character(*), intent(in) :: command
         integer(int8), intent(in) :: text(:)
         character(:), allocatable :: file

         call set_head(text)
         call try("", "")
         call set_head(recording%lines%head)
         file = ""
         if (recording%path /= "-") file = " < "//shell_word(recording%path)
         if (list == "; ") list = list//command//file//" | gyroakf run -"
      end subroutine try_text

      !> Reads the head with an option more, or with that and --bad-lines; names it where that succeeds and few lines are bad.
      subroutine try(name, value)
         character(*), intent(in) :: name, value
         type(reader_options) :: options
         type(record_type) :: record
         type(error_type), allocatable :: failed
         character(:), allocatable :: also

         if (value == "" .and. name /= "decimal-comma" .and. name /= "") return
         options = recording%options
         select case (name)
         case ("where"); options%where = value
         case ("skip"); read (value, *) options%skip
         case ("column"); options%columns = value
         case ("time-column"); options%time_column = value
         case ("decimal-comma"); options%decimal_comma = .true.
         case (""); continue
         case default; options%bad_lines_missing = .true.
         end select
         options%bytes => head
         call read_record(recording%path, options, record, failed)
         also = ""
         if (allocated(failed) .and. (name == "skip" .or. name == "where")) then
            also = " --bad-lines missing"
            options%bad_lines_missing = .true.
            call read_record(recording%path, options, record, failed)
         end if
         if (allocated(failed)) return
         if (size(record%value, 1) < 2 .or. 8*record%audit%bad_lines > size(record%value, 1)) return
         list = list//"; "
         if (len(name) > 0) list = list//"--"//name
         if (len(value) > 0) list = list//" "//shell_word(value)
         list = list//also
         tried = tried + 1
      end subroutine try
   end subroutine add_remedies

   !> How many lines a record spans: after so many the patterns and kinds repeat; 1 where all lines are
   !> alike or none repeat.
   pure integer function lines_together(line) result(lines)
      type(line_type), intent(in) :: line(:)
      logical :: again
      integer :: i

      do lines = 1, min(most_together, size(line)/3)
         do i = lines + 1, size(line)
            associate (this => line(i), earlier => line(i - lines))
               again = this%pattern == earlier%pattern
               again = again .and. (allocated(this%kind) .eqv. allocated(earlier%kind))
               if (again .and. allocated(this%kind)) again = this%kind == earlier%kind
            end associate
            if (.not. again) exit
         end do
         if (i > size(line)) return
      end do
      lines = 1
   end function lines_together

   !> A text with blanks for all line feeds but those that end a record; what stands behind the last
   !> record is left out.
   pure function joined_lines(bytes, lines) result(text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer, intent(in) :: lines
      integer(int8), allocatable :: text(:)
      integer :: i, k, last

      text = bytes
      k = 0
      last = 0
      do i = 1, size(text)
         if (text(i) /= 10_int8) cycle
         k = k + 1
         if (modulo(k, lines) == 0) last = i
         if (modulo(k, lines) /= 0) text(i) = iachar(" ")
      end do
      text = text(:last)
   end function joined_lines

   !> A text with a blank between a number and the unit behind it.
   pure function parted_units(bytes) result(text)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int8), allocatable :: text(:)
      character(*), parameter :: units = "abcdfghijklmnopqrstuvwxyzABCDFGHIJKLMNOPQRSTUVWXYZ"//degree(1:1)
      character(1) :: sign, before
      integer :: i, n

      allocate (text(2*size(bytes)))
      n = 0
      before = " "
      do i = 1, size(bytes)
         sign = achar(iand(int(bytes(i)), 255))
         if (index("0123456789.", before) > 0 .and. index(units, sign) > 0) then
            n = n + 1
            text(n) = iachar(" ")
         end if
         n = n + 1
         text(n) = bytes(i)
         before = sign
      end do
      text = text(:n)
   end function parted_units

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
      integer :: array, word, label, i

      plain(:) = bytes
      call find_marks(plain, 1_int64, size(plain, kind=int64), .true., marks)
      call split_line(plain, 1_int64, size(plain, kind=int64), split%mixed, fields)
      word = index(line%pattern, "t")
      label = 0
      if (marks%labels > 0 .and. len(line%pattern) > 1) then
         call name_fields(bytes, 1_int64, fields, names, array)
         if (names%known) label = findloc([(len(names%name(i)%text) > 0, i=1, size(names%name))], .true., dim=1)
      end if
      if (word > 0) then
         if (verify(bytes_text(plain, fields%first(word), fields%last(word)), "->:=|") == 0) word = max(0, label)
      end if
      if (label > 0 .and. (word == 0 .or. word >= label)) then
         line%kind = integer_text(int(label, int64))//"="// &
            names%name(label)%text(:index(names%name(label)%text//"[", "[") - 1)
      else if (word > 0 .and. index(line%pattern, "n") > 0) then
         line%kind = integer_text(int(word, int64))//"="//bytes_text(plain, fields%first(word), fields%last(word))
      end if
   end subroutine find_kind

   !> Kinds of records that are met three times at least, those that are met most first; none where all lines are of one.
   subroutine list_kinds(line, kinds)
      type(line_type), intent(in) :: line(:)
      type(text_type), allocatable, intent(out) :: kinds(:)
      type(text_type), allocatable :: found(:)
      integer :: times(64), i, k
      logical :: several

      allocate (kinds(0), found(0))
      times = 0
      do i = 1, size(line)
         if (.not. allocated(line(i)%kind)) cycle
         do k = 1, size(found)
            if (found(k)%text == line(i)%kind) exit
         end do
         if (k > size(times)) cycle
         if (k > size(found)) call add_text(found, line(i)%kind)
         times(k) = times(k) + 1
      end do
      several = size(found) > 1 .or. any([(.not. allocated(line(i)%kind) .and. len(line(i)%pattern) > 0, i=1, size(line))])
      do while (size(kinds) < most_kinds .and. several .and. any(times > 2))
         k = maxloc(times, dim=1)
         call add_text(kinds, found(k)%text)
         times(k) = 0
      end do
   end subroutine list_kinds

   !> Lines above the first three in a row that hold as many numbers each and nothing else; but for names right above these.
   pure integer(int64) function lines_above(line) result(above)
      type(line_type), intent(in) :: line(:)
      integer :: i

      above = 0
      do i = 2, size(line) - 2
         if (len(line(i)%pattern) == 0 .or. verify(line(i)%pattern, "n") > 0) cycle
         if (line(i)%pattern /= line(i + 1)%pattern .or. line(i)%pattern /= line(i + 2)%pattern) cycle
         above = i - 1
         if (len(line(i - 1)%pattern) == len(line(i)%pattern) .and. verify(line(i - 1)%pattern, "t") == 0) above = i - 2
         return
      end do
   end function lines_above

   !> The columns that hold numbers in most lines and have no name of a time, as a list.
   pure function number_columns(line, names) result(list)
      type(line_type), intent(in) :: line(:)
      type(column_names_type), intent(in) :: names
      character(:), allocatable :: list
      integer :: i, j, n
      logical :: fits(size(line))

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
         if (10*count([(index(line(i)%pattern(j:), "n") == 1, i=1, size(line))] .and. fits) < 8*count(fits)) cycle
         list = list//trim(merge(",", " ", len(list) > 0))//integer_text(int(j, int64))
      end do
   end function number_columns

end module gyroakf_app_remedy
