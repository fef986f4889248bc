! SPDX-License-Identifier: MIT
!> Characters in bytes: how many there are, whether they are UTF-8, UTF-8 made of what is not.
module gyroakf_utf8
   implicit none (type, external)
   private
   public :: text_width, is_continuation, sequence_length, make_readable

contains

   !> Characters of a UTF-8 text.
   pure integer function text_width(text)
      character(*), intent(in) :: text
      integer :: i

      text_width = count([(.not. is_continuation(text(i:i)), i=1, len(text))])
   end function text_width

   pure logical function is_continuation(byte)
      character(1), intent(in) :: byte

      is_continuation = iand(ichar(byte), 192) == 128
   end function is_continuation

   !> Bytes of the UTF-8 sequence that text begins with; 0 for none (overlong, surrogate, ...).
   pure integer function sequence_length(text)
      character(*), intent(in) :: text
      integer :: lead, second, i

      lead = byte(text, 1)
      select case (lead)
      case (0:127); sequence_length = 1
      case (194:223); sequence_length = 2
      case (224:239); sequence_length = 3
      case (240:244); sequence_length = 4
      case default; sequence_length = 0
      end select
      if (sequence_length > len(text)) sequence_length = 0
      do i = 2, sequence_length
         if (byte(text, i)/64 /= 2) sequence_length = 0
      end do
      if (sequence_length < 3) return
      second = byte(text, 2)
      if (lead == 224 .and. second < 160) sequence_length = 0
      if (lead == 237 .and. second > 159) sequence_length = 0
      if (lead == 240 .and. second < 144) sequence_length = 0
      if (lead == 244 .and. second > 143) sequence_length = 0
   end function sequence_length

   !> Makes text that can be shown: `?` for control characters, Latin-1 where it is not UTF-8.
   pure subroutine make_readable(text, lines)
      !> Any bytes; afterwards UTF-8 without control characters
      character(:), allocatable, intent(inout) :: text
      !> Present: line feeds stay
      logical, intent(in), optional :: lines
      character(:), allocatable :: shown
      integer :: code, filled, i, length

      do i = 1, len(text)
         if (byte(text, i) < 32 .or. byte(text, i) > 126) exit
      end do
      if (i > len(text)) return
      allocate (character(2*len(text)) :: shown)
      i = 1
      filled = 0
      do while (i <= len(text))
         length = sequence_length(text(i:))
         code = byte(text, i)
         if (length == 0 .and. code >= 160) then
            shown(filled + 1:filled + 2) = achar(192 + code/64)//achar(128 + modulo(code, 64))
            filled = filled + 2
         else if ((code < 32 .or. code == 127 .or. length == 0) .and. &
            .not. (code == 10 .and. present(lines))) then
            shown(filled + 1:filled + 1) = "?"
            filled = filled + 1
         else
            shown(filled + 1:filled + length) = text(i:i + length - 1)
            filled = filled + length
         end if
         i = i + max(length, 1)
      end do
      text = shown(:filled)
   end subroutine make_readable

   !> The i-th byte as 0..255; 0 past the end.
   pure integer function byte(text, i)
      character(*), intent(in) :: text
      integer, intent(in) :: i

      byte = 0
      if (i <= len(text)) byte = iand(ichar(text(i:i)), 255)
   end function byte

end module gyroakf_utf8
