! SPDX-License-Identifier: MIT
!> Lines of a terminal report: at most 80 columns, padded by characters (UTF-8), not by bytes.
!>
!> UTF-8 signs and colors are added here if the writer has them enabled; the texts hold neither.
!> Where its `markup` is on, the same parts become elements of a page.
module gyroakf_report_text_layout
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_report_number_text, only : count_text, fixed, if_known, number, p_value_text, &
      percent, plural, rounded, scientific, to_unicode
   use gyroakf_utf8, only : text_width, is_continuation
   use gyroakf_report_html_markup, only : close_list, html_heading, html_item, put_element
   implicit none (type, external)
   private
   public :: report_width, pad_right, pad_left
   public :: put_title, put_heading, put_item, put_paragraph
   public :: number, rounded, scientific, fixed, count_text, p_value_text, plural, percent, &
      if_known, to_unicode

   !> No line is longer
   integer, parameter :: report_width = 80
   !> The terminal's number of bold letters
   character(*), parameter :: bold = "1"
   !> Column where the text of an item begins
   integer, parameter :: item_column = 18

contains

   !> Blanks behind, up to a width; a longer text stays as it is.
   pure function pad_right(text, width) result(padded)
      !> UTF-8
      character(*), intent(in) :: text
      !> Characters
      integer, intent(in) :: width
      character(:), allocatable :: padded

      padded = text//repeat(" ", max(0, width - text_width(text)))
   end function pad_right

   !> Blanks in front, up to a width; a longer text stays as it is.
   pure function pad_left(text, width) result(padded)
      !> UTF-8
      character(*), intent(in) :: text
      !> Characters
      integer, intent(in) :: width
      character(:), allocatable :: padded

      padded = repeat(" ", max(0, width - text_width(text)))//text
   end function pad_left

   !> The text with the signs of UTF-8, where they are shown.
   pure function with_signs(writer, text, verbatim) result(shown)
      type(writer_type), intent(in) :: writer
      character(*), intent(in) :: text
      logical, intent(in), optional :: verbatim
      character(:), allocatable :: shown

      shown = text
      if (writer%unicode .and. .not. present(verbatim)) shown = to_unicode(text)
   end function with_signs

   !> The text in a color, where colors are shown.
   pure function painted(writer, text, color) result(shown)
      type(writer_type), intent(in) :: writer
      character(*), intent(in) :: text, color
      character(:), allocatable :: shown

      shown = text
      if (writer%color .and. color /= "" .and. text /= "") then
         shown = achar(27)//"["//color//"m"//text//achar(27)//"[0m"
      end if
   end function painted

   !> The first line of a report.
   subroutine put_title(writer, text)
      type(writer_type), intent(inout) :: writer
      !> What it is about
      character(*), intent(in) :: text

      call put_wrapped(writer, "", text, 0, bold)
   end subroutine put_title

   !> An empty line, the heading, and a line of signs under it.
   subroutine put_heading(writer, text, underline, verbatim)
      type(writer_type), intent(inout) :: writer
      !> The heading
      character(*), intent(in) :: text
      !> "=" or "-"; absent: none
      character(1), intent(in), optional :: underline
      !> Holds what a user wrote: shown as it is
      logical, intent(in), optional :: verbatim
      character(:), allocatable :: shown

      shown = with_signs(writer, text, verbatim)
      if (writer%markup%on) then
         call html_heading(writer, shown, present(underline))
         return
      end if
      call put_line(writer, "")
      call put_wrapped(writer, "", shown, 0, bold)
      if (present(underline)) call put_line(writer, &
         painted(writer, repeat(underline, min(text_width(shown), report_width)), bold))
   end subroutine put_heading

   !> A label and its text, wrapped under itself; the label is yellow where a look is needed, red
   !> where something failed.
   subroutine put_item(writer, label, text, verbatim)
      type(writer_type), intent(inout) :: writer
      !> At most 15 characters; any length
      character(*), intent(in) :: label, text
      !> Holds what a user wrote: shown as it is
      logical, intent(in), optional :: verbatim
      character(2) :: color

      if (writer%markup%on) then
         call html_item(writer, label, with_signs(writer, text, verbatim))
         return
      end if
      color = merge("33", "  ", label == "Warning")
      if (label == "Not available") color = "31"
      call put_wrapped(writer, pad_right("  "//label, item_column - 1)//" ", &
                       with_signs(writer, text, verbatim), item_column, color)
   end subroutine put_item

   !> Wrapped text, two blanks in front of every line.
   subroutine put_paragraph(writer, text)
      type(writer_type), intent(inout) :: writer
      !> Any length
      character(*), intent(in) :: text

      if (writer%markup%on) then
         call close_list(writer)
         call put_element(writer, "p", with_signs(writer, text))
      else
         call put_wrapped(writer, "  ", with_signs(writer, text), 2, "")
      end if
   end subroutine put_paragraph

   !> Wraps at blanks, but not inside "1 %", "a = 1", "1 +/- 2"; a word wider than a line is cut
   !> between characters. The color is that of what stands first, of the whole text where nothing
   !> does.
   subroutine put_wrapped(writer, first, text, indent, color)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: first, text, color
      integer, intent(in) :: indent
      character(:), allocatable :: line
      integer :: position, last, width, word, used

      line = painted(writer, first, color)
      width = text_width(first)
      used = 0                                          ! words in the line
      position = 1
      do
         position = position + verify(text(position:)//"x", " ") - 1
         last = position - 1
         word = 0
         do while (last < len(text))
            if (is_break(text, last + 1)) exit
            if (.not. is_continuation(text(last + 1:last + 1))) word = word + 1
            if (word > report_width - indent) exit
            last = last + 1
         end do
         if (last < position) exit
         word = text_width(text(position:last))
         if (used > 0 .and. width + 1 + word > report_width) then
            call end_line()
            line = repeat(" ", indent)
            width = indent
            used = 0
         else if (used > 0) then
            line = line//" "
            width = width + 1
         end if
         line = line//text(position:last)
         width = width + word
         used = used + 1
         position = last + 1
      end do
      call end_line()

   contains

      subroutine end_line()
         if (first == "") line = painted(writer, line, color)
         call put_line(writer, trim(line))
      end subroutine end_line

   end subroutine put_wrapped

   !> A line may end at this byte.
   pure logical function is_break(text, i)
      character(*), intent(in) :: text
      integer, intent(in) :: i

      is_break = text(i:i) == " "
      if (.not. is_break .or. i == 1 .or. i == len(text)) return
      is_break = scan(text(i + 1:i + 1), "%=+<>") == 0 .and. scan(text(i - 1:i - 1), "=<>") == 0 &
         .and. text(max(1, i - 3):i - 1) /= "+/-" .and. text(max(1, i - 2):i - 1) /= "±" &
         .and. text(i + 1:min(len(text), i + 2)) /= "±"
   end function is_break

end module gyroakf_report_text_layout
