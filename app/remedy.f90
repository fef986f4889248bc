! SPDX-License-Identifier: MIT
!> Options and commands that read a recording which cannot be read as it is: each is tried on the
!> first megabyte before it is named.
module gyroakf_app_remedy
   use gyroakf_kinds, only : int8
   use gyroakf_error, only : error_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_io_recording, only : recording_type
   use gyroakf_record, only : record_type, text_type
   use gyroakf_app_line_kinds, only : line_type, lines_above, lines_together, list_kinds, &
      number_columns, take_lines
   use gyroakf_app_words, only : shell_word
   implicit none (type, external)
   private
   public :: add_remedies

   !> The sign of degrees in UTF-8
   character(*), parameter :: degree = char(194)//char(176)

contains

   !> Adds a line "options that read it: --where 1=IMU; --where 1=GPS" to the message, where there
   !> are any, else one of a command.
   subroutine add_remedies(recording, error)
      !> Could not be read
      type(recording_type), intent(in) :: recording
      !> Why
      type(error_type), intent(inout) :: error
      type(line_type), allocatable :: line(:)
      type(text_type), allocatable :: kinds(:)
      integer(int8), allocatable :: head(:)
      integer(int8), allocatable, target :: tried_text(:)
      character(:), allocatable :: list
      integer :: i, tried

      tried = 0
      if (.not. (allocated(recording%lines%head) .and. allocated(recording%table%name))) return
      head = recording%lines%head
      tried_text = head
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
      if (index(list, "|") > 0) then
         error%message = error%message//new_line("a")//"a command that reads it: "//list(3:)
         return
      end if
      if (recording%table%rows < 16) call try("skip", integer_text(lines_above(line)))
      if (recording%table%rows == 0) call try("column", number_columns(line, recording%table%names))
      if (index(error%message, "decimal comma") > 0) call try("decimal-comma", "")
      if (recording%table%rows > 0 .and. len(list) == 0) call try("bad-lines", "missing")
      if (allocated(recording%table%chosen)) then
         if (size(recording%table%chosen) == 0) call try("time-column", "none")
      end if
      if (len(list) == 0) return
      error%message = error%message//new_line("a")//"options that read it: "//list(3:)

   contains

      !> Joins the lines of a record, or parts what stands together in the field that is no number.
      subroutine try_commands()
         character(:), allocatable :: field
         integer :: lines, mark
         character(1) :: sign

         lines = lines_together(line)
         if (lines > 1) call try_text("paste -d' '"//repeat(" -", lines), joined_lines(head, lines))
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
                          parted_units(head))
         end if
      end subroutine try_commands

      !> Reads what a command makes of the head; names the command where that succeeds.
      subroutine try_text(command, text)
         character(*), intent(in) :: command
         integer(int8), intent(in) :: text(:)
         character(:), allocatable :: file

         tried_text = text
         call try("", "")
         tried_text = head
         file = ""
         if (recording%path /= "-") file = " < "//shell_word(recording%path)
         if (list == "; ") list = list//command//file//" | gyroakf run -"
      end subroutine try_text

      !> Reads the text with an option more, or with that and --bad-lines; names it where that
      !> succeeds and few lines are bad.
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
         options%bytes => tried_text
         call read_record(recording%path, options, record, failed)
         also = ""
         if (allocated(failed) .and. (name == "skip" .or. name == "where")) then
            also = " --bad-lines missing"
            options%bad_lines_missing = .true.
            call read_record(recording%path, options, record, failed)
         end if
         if (allocated(failed)) return
         if (8*record%audit%bad_lines > size(record%value, 1) .or. size(record%value, 1) < 2) return
         list = list//"; "
         if (len(name) > 0) list = list//"--"//name
         if (len(value) > 0) list = list//" "//shell_word(value)
         list = list//also
         tried = tried + 1
      end subroutine try
   end subroutine add_remedies

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
      character(*), parameter :: units = degree(1:1)// &
         "abcdfghijklmnopqrstuvwxyzABCDFGHIJKLMNOPQRSTUVWXYZ"
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

end module gyroakf_app_remedy
