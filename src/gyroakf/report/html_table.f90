! SPDX-License-Identifier: MIT
!> A table of a report as an element of a page: in a box that scrolls where the table is wider than the window, with a caption, and
!> with the number at full precision in each cell that shows one.
module gyroakf_report_html_table
   use gyroakf_kinds, only : dp
   use gyroakf_record, only : text_type
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_escaped, put_number_attribute
   implicit none (type, external)
   private
   public :: exact_type, html_table

   !> The number that a cell shows
   type :: exact_type
      !> Where results.json has it, from the channel on: "allan.input.tau_s.0"; unallocated where the cell shows none
      character(:), allocatable :: key
      real(dp) :: value = 0.0_dp
   end type exact_type

contains

   !> Writes the table; the first column that has a text names its row.
   subroutine html_table(writer, cell, exact, head, left)
      !> The page; its last heading is the caption
      type(writer_type), intent(inout) :: writer
      !> Texts, a line feed parts lines: [rows, columns]
      type(text_type), intent(in) :: cell(:, :)
      !> The numbers behind them, of that shape
      type(exact_type), intent(in) :: exact(:, :)
      !> Rows of the head; columns that are text, from the left
      integer, intent(in) :: head, left
      character(:), allocatable :: caption
      integer :: i, j

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
            call put_cell(writer, cell(i, j)%text, exact(i, j), i <= head, j, left)
         end do
         call put_line(writer, "</tr>")
      end do
      call put_line(writer, trim(merge("</thead>", "</tbody>", size(cell, 1) <= head))//"</table></div>")
   end subroutine html_table

   !> One cell; an empty one names nothing.
   subroutine put_cell(writer, text, exact, head, column, left)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: text
      type(exact_type), intent(in) :: exact
      !> In the head
      logical, intent(in) :: head
      integer, intent(in) :: column, left
      character(2) :: tag

      tag = "td"
      if ((head .or. column == 1) .and. text /= "") tag = "th"
      call put(writer, "<"//tag)
      if (tag == "th") call put(writer, " scope="""//trim(merge("col", "row", head))//"""")
      if (column <= left) call put(writer, " class=""text""")
      if (allocated(exact%key)) then
         call put_attribute(writer, "data-key", exact%key)
         call put_number_attribute(writer, "data-value", exact%value)
      end if
      call put(writer, ">")
      call put_lines(writer, text)
      call put(writer, "</"//tag//">")
   end subroutine put_cell

   !> Lines of a cell.
   subroutine put_lines(writer, text)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: text
      integer :: first, feed

      first = 1
      do
         feed = index(text(first:), new_line("a"))
         if (feed == 0) exit
         call put_escaped(writer, text(first:first + feed - 2))
         call put(writer, "<br>")
         first = first + feed
      end do
      call put_escaped(writer, text(first:))
   end subroutine put_lines

end module gyroakf_report_html_table
