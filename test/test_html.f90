! SPDX-License-Identifier: MIT
!> Tests of the page: texts that are escaped, parts of a report as elements, tables with their numbers, figures.
module test_html
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_figures, only : build_figures, named_figure_type
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_escaped
   use gyroakf_report_html_page, only : write_page
   use gyroakf_report_text_layout, only : put_heading, put_item, put_paragraph
   use gyroakf_report_text_table, only : add_row, new_table, put_table, table_type
   use report_fixture, only : begin_text, end_text, make_record, make_result
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_html

   character(*), parameter :: lf = new_line("a")

contains

   subroutine suite_html()
      call test("escape", test_escape)
      call test("parts", test_parts)
      call test("table", test_table)
      call test("page", test_page)
   end subroutine suite_html

   !> Markup, quotes, control characters (also those of U+0080 to U+009F), bytes that are no UTF-8; letters stay.
   subroutine test_escape()
      type(writer_type) :: writer
      character(:), allocatable :: text

      call begin_text(writer)
      call put_escaped(writer, "<b>&""'"//achar(7)//achar(127)//char(255)//char(194)//char(133)//"°"//lf//"x"//char(195))
      call put_attribute(writer, "a", "<")
      call end_text(writer, text)
      call check(error, text, "&lt;b&gt;&amp;&quot;&#39;&#xFFFD;&#xFFFD;&#xFFFD;&#xFFFD;° x&#xFFFD; a=""&lt;""")
   end subroutine test_escape

   !> Items make one list until something else comes; an item without a label goes on, or is a paragraph.
   subroutine test_parts()
      type(writer_type) :: writer
      character(:), allocatable :: text

      call begin_text(writer)
      writer%markup%on = .true.
      writer%unicode = .true.
      call put_heading(writer, "A < B", "-")
      call put_item(writer, "", "alone")
      call put_item(writer, "N", "1 +/- 2")
      call put_item(writer, "", "more")
      call put_item(writer, "Warning", "a +/- b", verbatim=.true.)
      call put_paragraph(writer, "end")
      call put_heading(writer, "below")
      call close_list(writer)
      call end_text(writer, text)
      call check(error, text, "<h2>A &lt; B</h2>"//lf//"<p>alone</p>"//lf//"<dl>"//lf//"<dt>N</dt>"//lf//"<dd>1 ± 2</dd>"//lf// &
                 "<dd>more</dd>"//lf//"<dt class=""warning"">Warning</dt>"//lf//"<dd>a +/- b</dd>"//lf//"</dl>"//lf// &
                 "<p>end</p>"//lf//"<h3>below</h3>"//lf)
   end subroutine test_parts

   !> Head, names of rows, empty cells, lines in a cell, numbers behind cells; the caption is the heading above.
   subroutine test_table()
      type(writer_type) :: writer
      type(table_type) :: table
      character(:), allocatable :: text

      call new_table(table, 2)
      call add_row(table, "", "x")
      call add_row(table, "a", "1"//lf//"+/- 2")
      call begin_text(writer)
      writer%markup%on = .true.
      writer%unicode = .true.
      writer%markup%heading = "T & U"
      call put_table(writer, table)
      call end_text(writer, text)
      call check(error, text, "<div class=""scroll"" role=""region"" tabindex=""0"" aria-label=""T &amp; U""><table><caption>"// &
                 "T &amp; U</caption>"//lf//"<thead><tr><td class=""text""></td><th scope=""col"">x</th></tr>"//lf// &
                 "</thead><tbody><tr><th scope=""row"" class=""text"">a</th><td>1<br>± 2</td></tr>"//lf// &
                 "</tbody></table></div>"//lf)
   end subroutine test_table

   !> A page of the fixture: begun and ended, what it says of itself, a hostile name, every report.
   subroutine test_page()
      character(6), parameter :: commands(5) = [character(6) :: "run", "allan", "tests", "ar", "filter"]
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(named_figure_type), allocatable :: figures(:)
      character(:), allocatable :: text
      integer :: i

      call make_record(record, .true.)
      call make_result(record, result)
      record%channel(1)%text = "</section>"
      result%channel(1)%name = record%channel(1)%text
      call build_figures(record, result, figures)
      do i = 1, size(commands)
         call begin_text(writer)
         call write_page(writer, trim(commands(i)), record, result, figures, "gyroakf 'a b' && rm")
         call end_text(writer, text)
         call check(error, index(text, "<!DOCTYPE html>"//lf) == 1 .and. index(text, "</html>"//lf) == len(text) - 7, commands(i))
         call check(error, index(text, "<code>gyroakf &#39;a b&#39; &amp;&amp; rm</code>") > 0 .and. &
                    index(text, "<h3>Channel &lt;/section&gt;</h3>") > 0 .and. occurrences(text, "<figure") == 2 .and. &
                    occurrences(text, "<svg class=""fig"" role=""img"" aria-label=""") == 2, commands(i))
         call check(error, occurrences(text, "<section") == 2 .and. occurrences(text, "</section>") == 2 .and. &
                    occurrences(text, "<dl>") == occurrences(text, "</dl>") .and. &
                    occurrences(text, "<ul>") == occurrences(text, "</ul>"), commands(i))
      end do
   end subroutine test_page

   !> How often a text holds another.
   pure integer function occurrences(text, part)
      character(*), intent(in) :: text, part
      integer :: at, next

      occurrences = 0
      at = 1
      do
         next = index(text(at:), part)
         if (next == 0) return
         occurrences = occurrences + 1
         at = at + next
      end do
   end function occurrences

end module test_html
