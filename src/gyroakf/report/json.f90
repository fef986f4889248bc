! SPDX-License-Identifier: MIT
!> A small JSON writer: a text that grows while objects and arrays are opened, filled and closed.
!>
!>     call open_object(json)
!>     call put_member(json, "rate_hz", 5.0_dp)          ! "rate_hz": 5
!>     call open_array(json, "channels")
!>     call put_member(json, "", "gyro x")               ! an element of an array has no key
!>     call close_array(json)
!>     call close_object(json)
!>
!> Numbers carry 17 significant digits, so that reading them back gives the same bits. NaN and infinite values are
!> written as null. Text is written as valid UTF-8: control characters are escaped, bytes that are not UTF-8 become U+FFFD.
module gyroakf_report_json
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_decimal, only : format_real, real_length
   use gyroakf_io_writer, only : writer_type, put
   use gyroakf_record, only : text_type
   use gyroakf_utf8, only : sequence_length
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: json_type, open_object, close_object, open_array, close_array, put_member, put_null, put_json
   public :: json_text, flush_json, quote_json

   !> Objects and arrays may be nested this deep
   integer, parameter :: max_depth = 32

   !> The text so far
   type :: json_type
      private
      character(:), allocatable :: buffer
      integer :: used = 0
      integer :: depth = 0
      logical :: empty(0:max_depth) = .true.
   end type json_type

   !> Writes one member of an object, or one element of an array where the key is "".
   interface put_member
      module procedure put_real, put_integer, put_int64, put_logical, put_text
      module procedure put_reals, put_int64s, put_texts
   end interface put_member

contains

   !> Opens an object, `{`.
   subroutine open_object(json, key)
      !> The document
      type(json_type), intent(inout) :: json
      !> Its name; absent or "" at the root and in an array
      character(*), intent(in), optional :: key

      call open_bracket(json, "{", key)
   end subroutine open_object

   !> Closes the object that was opened last.
   subroutine close_object(json)
      !> The document
      type(json_type), intent(inout) :: json

      call close_bracket(json, "}")
   end subroutine close_object

   !> Opens an array, `[`.
   subroutine open_array(json, key)
      !> The document
      type(json_type), intent(inout) :: json
      !> Its name; absent or "" at the root and in an array
      character(*), intent(in), optional :: key

      call open_bracket(json, "[", key)
   end subroutine open_array

   !> Closes the array that was opened last.
   subroutine close_array(json)
      !> The document
      type(json_type), intent(inout) :: json

      call close_bracket(json, "]")
   end subroutine close_array

   !> Writes null.
   subroutine put_null(json, key)
      !> The document
      type(json_type), intent(inout) :: json
      !> Name of the member, "" in an array
      character(*), intent(in) :: key

      call put_raw(json, key, "null")
   end subroutine put_null

   !> Writes a text that is JSON already: what [[json_text]] gave of another document.
   subroutine put_json(json, key, text)
      !> The document
      type(json_type), intent(inout) :: json
      !> Name of the member, "" in an array
      character(*), intent(in) :: key
      !> One value, without a line feed at its ends
      character(*), intent(in) :: text

      call put_raw(json, key, text)
   end subroutine put_json

   !> What was written since the last flush.
   pure function json_text(json) result(text)
      !> The document
      type(json_type), intent(in) :: json
      character(json%used) :: text

      if (allocated(json%buffer)) text = json%buffer(:json%used)
   end function json_text

   !> Hands the text over to a file and forgets it; nesting goes on. Where the file is not open the text stays.
   subroutine flush_json(json, writer)
      !> The document
      type(json_type), intent(inout) :: json
      !> The file
      type(writer_type), intent(inout) :: writer

      if (writer%unit < 0) return
      if (json%used > 0) call put(writer, json%buffer(:json%used))
      json%used = 0
   end subroutine flush_json

   subroutine put_real(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      real(dp), intent(in) :: value

      call put_raw(json, key, json_number(value))
   end subroutine put_real

   subroutine put_integer(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      integer, intent(in) :: value

      call put_int64(json, key, int(value, int64))
   end subroutine put_integer

   subroutine put_int64(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      integer(int64), intent(in) :: value
      character(24) :: digits

      write (digits, "(i0)") value
      call put_raw(json, key, trim(digits))
   end subroutine put_int64

   subroutine put_logical(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      logical, intent(in) :: value

      call put_raw(json, key, trim(merge("true ", "false", value)))
   end subroutine put_logical

   subroutine put_text(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key, value
      character(:), allocatable :: quoted

      call quote_json(value, quoted)
      call put_raw(json, key, quoted)
   end subroutine put_text

   subroutine put_reals(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      real(dp), intent(in) :: value(:)
      integer(int64) :: i

      call put_raw(json, key, "[")
      do i = 1, size(value, kind=int64)
         if (i > 1) call append(json, ", ")
         call append(json, json_number(value(i)))
      end do
      call append(json, "]")
   end subroutine put_reals

   subroutine put_int64s(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      integer(int64), intent(in) :: value(:)
      character(24) :: digits
      integer(int64) :: i

      call put_raw(json, key, "[")
      do i = 1, size(value, kind=int64)
         if (i > 1) call append(json, ", ")
         write (digits, "(i0)") value(i)
         call append(json, trim(digits))
      end do
      call append(json, "]")
   end subroutine put_int64s

   subroutine put_texts(json, key, value)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key
      type(text_type), intent(in) :: value(:)
      character(:), allocatable :: quoted
      integer :: i

      call put_raw(json, key, "[")
      do i = 1, size(value)
         if (i > 1) call append(json, ", ")
         call quote_json(value(i)%text, quoted)
         call append(json, quoted)
      end do
      call append(json, "]")
   end subroutine put_texts

   !> The length of `json_number`.
   pure integer function number_length(value)
      real(dp), intent(in) :: value

      number_length = len("null")
      if (ieee_is_finite(value)) number_length = real_length(value, 17)
   end function number_length

   !> A number at 17 significant digits, null where it is not finite.
   pure function json_number(value) result(text)
      real(dp), intent(in) :: value
      character(number_length(value)) :: text

      text = "null"
      if (ieee_is_finite(value)) text = format_real(value, 17)
   end function json_number

   !> A string in quotes, escaped.
   pure subroutine quote_json(text, quoted)
      !> Bytes, usually UTF-8
      character(*), intent(in) :: text
      !> With its quotes
      character(:), allocatable, intent(out) :: quoted
      character(*), parameter :: hexadecimal = "0123456789abcdef"
      character(6) :: escape
      integer :: i, length, code

      quoted = '"'
      i = 1
      do while (i <= len(text))
         code = iachar(text(i:i))
         length = sequence_length(text(i:))
         if (length == 0) then
            quoted = quoted//"\ufffd"
            length = 1
         else if (text(i:i) == '"' .or. text(i:i) == "\") then
            quoted = quoted//"\"//text(i:i)
         else if (code < 32 .or. code == 127) then
            escape = "\u00"//hexadecimal(code/16 + 1:code/16 + 1)//hexadecimal(mod(code, 16) + 1:mod(code, 16) + 1)
            quoted = quoted//escape
         else
            quoted = quoted//text(i:i + length - 1)
         end if
         i = i + length
      end do
      quoted = quoted//'"'
   end subroutine quote_json

   subroutine open_bracket(json, bracket, key)
      type(json_type), intent(inout) :: json
      character(1), intent(in) :: bracket
      character(*), intent(in), optional :: key

      if (present(key)) then
         call put_raw(json, key, bracket)
      else
         call put_raw(json, "", bracket)
      end if
      json%depth = min(json%depth + 1, max_depth)
      json%empty(json%depth) = .true.
   end subroutine open_bracket

   subroutine close_bracket(json, bracket)
      type(json_type), intent(inout) :: json
      character(1), intent(in) :: bracket
      logical :: was_empty

      was_empty = json%empty(json%depth)
      json%depth = max(json%depth - 1, 0)
      if (.not. was_empty) call new_line_indented(json)
      call append(json, bracket)
      if (json%depth == 0) call append(json, new_line("a"))
   end subroutine close_bracket

   !> Comma, new line, key and a text that is JSON already.
   subroutine put_raw(json, key, text)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: key, text
      character(:), allocatable :: quoted

      if (.not. json%empty(json%depth)) call append(json, ",")
      if (json%depth > 0) call new_line_indented(json)
      json%empty(json%depth) = .false.
      if (len(key) > 0) then
         call quote_json(key, quoted)
         call append(json, quoted//": ")
      end if
      call append(json, text)
   end subroutine put_raw

   subroutine new_line_indented(json)
      type(json_type), intent(inout) :: json

      call append(json, new_line("a")//repeat("  ", json%depth))
   end subroutine new_line_indented

   !> Appends to the buffer, which doubles when it is full.
   subroutine append(json, text)
      type(json_type), intent(inout) :: json
      character(*), intent(in) :: text
      character(:), allocatable :: larger
      integer :: needed

      needed = json%used + len(text)
      if (.not. allocated(json%buffer)) allocate (character(max(4096, needed)) :: json%buffer)
      if (needed > len(json%buffer)) then
         allocate (character(max(2*len(json%buffer), needed)) :: larger)
         larger(:json%used) = json%buffer(:json%used)
         call move_alloc(larger, json%buffer)
      end if
      json%buffer(json%used + 1:needed) = text
      json%used = needed
   end subroutine append

end module gyroakf_report_json
