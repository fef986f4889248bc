! SPDX-License-Identifier: MIT
!> The parts of a report as elements of a page: headings, items, sentences, tables, and every text
!> escaped.
!>
!> [[gyroakf_report_text_layout]] and [[gyroakf_report_text_table]] call these where the writer's
!> `markup` is on, so that a page says what the terminal says, from the same lines of code.
module gyroakf_report_html_markup
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_record, only : text_type
   use gyroakf_utf8, only : sequence_length
   implicit none (type, external)
   private
   public :: html_heading, html_item, html_table, close_list
   public :: put_escaped, put_attribute, put_element, put_lines

contains

   !> A heading; what follows it belongs to it.
   subroutine html_heading(writer, text, upper)
      type(writer_type), intent(inout) :: writer
      !> Any text
      character(*), intent(in) :: text
      !> Of the level of the page's part, else one deeper
      logical, intent(in) :: upper
      character(2) :: tag

      call close_list(writer)
      tag = "h"//achar(iachar("0") + min(6, writer%markup%level + merge(0, 1, upper)))
      call put_element(writer, tag, text)
      writer%markup%heading = text
   end subroutine html_heading

   !> A label and its text; without a label the text goes on with the item before.
   subroutine html_item(writer, label, text)
      type(writer_type), intent(inout) :: writer
      !> "" for none; "Warning" is shown as one
      character(*), intent(in) :: label, text

      if (label == "" .and. writer%markup%list == "") then
         call put_element(writer, "p", text)
         return
      end if
      if (writer%markup%list == "") call put_line(writer, "<dl>")
      writer%markup%list = "dl"
      if (label == "Warning") then
         call put_line(writer, "<dt class=""warning"">Warning</dt>")
      else if (label /= "") then
         call put_element(writer, "dt", label)
      end if
      call put_element(writer, "dd", text)
   end subroutine html_item

   !> A table in a box that scrolls where it is wider than the window; the first cell of a row names
   !> it, an empty one names nothing.
   subroutine html_table(writer, cell, head, left)
      !> The page; its last heading is the caption
      type(writer_type), intent(inout) :: writer
      !> Texts, a line feed parts lines: [rows, columns]
      type(text_type), intent(in) :: cell(:, :)
      !> Rows of the head; columns that are text, from the left
      integer, intent(in) :: head, left
      character(:), allocatable :: caption
      character(2) :: tag
      integer :: i, j, feed

      call close_list(writer)
      caption = "Table"
      if (allocated(writer%markup%heading)) caption = writer%markup%heading
      call put(writer, "<div class=""scroll"" role=""region"" tabindex=""0""")
      call put_attribute(writer, "aria-label", caption)
      call put(writer, "><table><caption>")
      call put_escaped(writer, caption)
      call put_line(writer, "</caption>")
      do i = 1, size(cell, 1)
         if (i == 1) call put(writer, "<thead>")
         if (i == head + 1) call put(writer, "</thead><tbody>")
         call put(writer, "<tr>")
         do j = 1, size(cell, 2)
            tag = "td"
            if ((i <= head .or. j == 1) .and. cell(i, j)%text /= "") tag = "th"
            call put(writer, "<"//tag)
            if (tag == "th") call put_attribute(writer, "scope", &
                                                trim(merge("col", "row", i <= head)))
            if (j <= left) call put(writer, " class=""text""")
            call put(writer, ">")
            feed = index(cell(i, j)%text, new_line("a"))
            call put_escaped(writer, cell(i, j)%text(:feed - 1))
            if (feed > 0) call put(writer, "<br>")
            call put_escaped(writer, cell(i, j)%text(feed + 1:))
            call put(writer, "</"//tag//">")
         end do
         call put_line(writer, "</tr>")
      end do
      call put_line(writer, merge("</thead>", "</tbody>", size(cell, 1) <= head)//"</table></div>")
   end subroutine html_table

   !> Ends the list that is open, if one is.
   subroutine close_list(writer)
      type(writer_type), intent(inout) :: writer

      if (writer%markup%list == "") return
      call put_line(writer, "</"//writer%markup%list//">")
      writer%markup%list = ""
   end subroutine close_list

   !> Lines as they are.
   subroutine put_lines(writer, lines)
      type(writer_type), intent(inout) :: writer
      !> Without their blanks at the end
      character(*), intent(in) :: lines(:)
      integer :: i

      do i = 1, size(lines)
         call put_line(writer, trim(lines(i)))
      end do
   end subroutine put_lines

   !> An element that holds text alone, on a line.
   subroutine put_element(writer, tag, text)
      type(writer_type), intent(inout) :: writer
      !> Its name; any text
      character(*), intent(in) :: tag, text

      call put(writer, "<"//trim(tag)//">")
      call put_escaped(writer, text)
      call put_line(writer, "</"//trim(tag)//">")
   end subroutine put_element

   !> " name="text"", escaped.
   subroutine put_attribute(writer, name, text)
      !> The page, within a tag
      type(writer_type), intent(inout) :: writer
      !> Name; any text
      character(*), intent(in) :: name, text

      call put(writer, " "//name//"=""")
      call put_escaped(writer, text)
      call put(writer, """")
   end subroutine put_attribute

   !> A text as HTML: what would be markup becomes references, what is no UTF-8 or a control
   !> character U+FFFD.
   subroutine put_escaped(writer, text)
      type(writer_type), intent(inout) :: writer
      !> Any bytes
      character(*), intent(in) :: text
      integer :: i, length

      i = 1
      do while (i <= len(text))
         length = sequence_length(text(i:))
         select case (text(i:i))
         case ("&"); call put(writer, "&amp;")
         case ("<"); call put(writer, "&lt;")
         case (">"); call put(writer, "&gt;")
         case (""""); call put(writer, "&quot;")
         case ("'"); call put(writer, "&#39;")
         case (new_line("a")); call put(writer, " ")
         case default
            if (length == 0 .or. is_control(text(i:i + max(1, length) - 1))) then
               call put(writer, "&#xFFFD;")
            else
               call put(writer, text(i:i + length - 1))
            end if
         end select
         i = i + max(1, length)
      end do
   end subroutine put_escaped

   !> A control character that no page may hold: below a blank, delete, U+0080 to U+009F.
   pure logical function is_control(character)
      character(*), intent(in) :: character

      is_control = iachar(character(1:1)) < 32 .or. iachar(character(1:1)) == 127
      if (len(character) == 2) is_control = ichar(character(1:1)) == 194 .and. &
         ichar(character(2:2)) < 160
   end function is_control

end module gyroakf_report_html_markup
