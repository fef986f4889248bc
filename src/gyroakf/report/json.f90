! SPDX-License-Identifier: MIT
!> The JSON renderer of a description: a text that grows while groups are opened, filled and closed.
!>
!> Numbers carry 17 significant digits, so that reading them back gives the same bits. NaN and
!> infinite values are written as null. Text is written as valid UTF-8: control characters are
!> escaped, bytes that are not UTF-8 become U+FFFD.
module gyroakf_report_json
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_decimal, only : format_real, longest_real
   use gyroakf_io_writer, only : writer_type, put
   use gyroakf_record, only : text_type
   use gyroakf_report_description, only : description_type
   use gyroakf_spelling, only : lower
   use gyroakf_utf8, only : sequence_length
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: json_type, json_text, quote_json

   !> Groups may be nested this deep
   integer, parameter :: max_depth = 32

   !> The text so far
   type, extends(description_type) :: json_type
      private
      !> Takes the text; null: it stays in memory
      type(writer_type), pointer, public :: writer => null()
      !> The text that is in memory is `buffer(:used)`
      character(:), allocatable, public :: buffer
      integer, public :: used = 0
      !> There was no memory: the text is not whole
      logical, public :: failed = .false.
      integer :: depth = 0
      logical :: empty(0:max_depth) = .true.
      logical :: list(0:max_depth) = .false.
   contains
      procedure :: close => close_group
      procedure :: begin => open_bracket
      procedure :: value => put_value
      procedure :: values => put_values
      !> Writes one value that is JSON already, `put_json(key, text)`
      procedure :: put_json => put_raw
   end type json_type

contains

   !> The bracket of what was opened last.
   subroutine close_group(self)
      class(json_type), intent(inout) :: self
      integer :: closed

      closed = self%depth
      self%depth = max(self%depth - 1, 0)
      if (.not. self%empty(closed)) call new_line_indented(self)
      call append(self, merge("]", "}", self%list(closed)))
      if (self%depth == 0) call append(self, new_line("a"))
   end subroutine close_group

   !> The text that is in memory.
   pure function json_text(self) result(text)
      !> The document
      type(json_type), intent(in) :: self
      character(self%used) :: text

      if (allocated(self%buffer)) text = self%buffer(:self%used)
   end function json_text

   subroutine put_value(self, key, value)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value

      call put_raw(self, key, "")
      call append_value(self, value)
   end subroutine put_value

   subroutine put_values(self, key, value)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)
      integer(int64) :: i

      call put_raw(self, key, "[")
      do i = 1, size(value, kind=int64)
         if (i > 1) call append(self, ", ")
         call append_value(self, value(i))
      end do
      call append(self, "]")
   end subroutine put_values

   !> One value; null where it is not known or not finite.
   subroutine append_value(self, value)
      class(json_type), intent(inout) :: self
      class(*), intent(in) :: value
      character(:), allocatable :: text
      character(longest_real) :: digits

      digits = "null"
      select type (value)
      type is (real(dp))
         if (ieee_is_finite(value)) digits = format_real(value, 17)
      type is (integer); write (digits, "(i0)") value
      type is (integer(int64)); write (digits, "(i0)") value
      type is (logical); digits = merge("true ", "false", value)
      type is (character(*)); call quote_json(value, text)
      type is (text_type); call quote_json(value%text, text)
      end select
      if (.not. allocated(text)) text = trim(digits)
      call append(self, text)
   end subroutine append_value

   !> A string in quotes, escaped.
   pure subroutine quote_json(text, quoted)
      !> Bytes, usually UTF-8
      character(*), intent(in) :: text
      !> With its quotes
      character(:), allocatable, intent(out) :: quoted
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
            write (escape, "(a, z4.4)") "\u", code
            quoted = quoted//lower(escape)
         else
            quoted = quoted//text(i:i + length - 1)
         end if
         i = i + length
      end do
      quoted = quoted//'"'
   end subroutine quote_json

   subroutine open_bracket(self, key, list)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list

      call put_raw(self, key, merge("[", "{", list))
      self%depth = min(self%depth + 1, max_depth)
      self%empty(self%depth) = .true.
      self%list(self%depth) = list
   end subroutine open_bracket

   !> Comma, new line, key and a text that is JSON already.
   subroutine put_raw(self, key, text)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: key, text
      character(:), allocatable :: quoted

      if (.not. self%empty(self%depth)) call append(self, ",")
      if (self%depth > 0) call new_line_indented(self)
      self%empty(self%depth) = .false.
      if (len(key) > 0) then
         call quote_json(key, quoted)
         call append(self, quoted//": ")
      end if
      call append(self, text)
   end subroutine put_raw

   subroutine new_line_indented(self)
      class(json_type), intent(inout) :: self

      call append(self, new_line("a")//repeat("  ", self%depth))
   end subroutine new_line_indented

   !> Appends to the file, or to the buffer, which doubles when it is full.
   subroutine append(self, text)
      class(json_type), intent(inout) :: self
      character(*), intent(in) :: text
      character(:), allocatable :: larger
      integer :: needed, stat

      if (associated(self%writer)) call put(self%writer, text)
      if (associated(self%writer) .or. self%failed) return
      needed = self%used + len(text)
      if (.not. allocated(self%buffer)) self%buffer = ""
      if (needed > len(self%buffer)) then
         allocate (character(max(4096, 2*needed)) :: larger, stat=stat)
         self%failed = stat /= 0
         if (self%failed) return
         larger(:self%used) = self%buffer(:self%used)
         call move_alloc(larger, self%buffer)
      end if
      self%buffer(self%used + 1:needed) = text
      self%used = needed
   end subroutine append

end module gyroakf_report_json
