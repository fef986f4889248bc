! SPDX-License-Identifier: MIT
!> report.html: the whole report of a recording as one file that needs nothing else.
!>
!>     call open_writer(writer, "results/report.html", error)
!>     call write_page(writer, command, record, result, figures)
!>     call commit_writer(writer, error)
module gyroakf_report_html_page
   use, intrinsic :: iso_fortran_env, only : compiler_version
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_report_figure_allan, only : minimum_note
   use gyroakf_report_figures, only : named_figure_type
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_element, put_escaped, &
      put_lines
   use gyroakf_report_html_style, only : page_script, page_style
   use gyroakf_report_input, only : put_input
   use gyroakf_report_remarks, only : put_remarks
   use gyroakf_report_svg, only : svg_style, write_svg
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_text_layout, only : count_text, put_paragraph
   use gyroakf_report_text_overview, only : put_overview
   use gyroakf_report_text_report, only : put_curves_of, put_sections, report_subject
   implicit none (type, external)
   private
   public :: write_page

   !> The first lines, and those between the style and the title
   character(*), parameter :: page_head(*) = [character(72) :: "<!DOCTYPE html>", &
      "<html lang=""en"">", "<head>", "<meta charset=""utf-8"">", &
      "<meta name=""viewport"" content=""width=device-width, initial-scale=1"">"]
   character(*), parameter :: page_top(*) = [character(56) :: "</style>", "</head>", "<body>", &
      "<a class=""skip"" href=""#content"">Skip to the results</a>", "<header>"]

contains

   !> The page of one recording.
   subroutine write_page(writer, command, record, result, figures, command_line)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      !> Of the result: [[build_figures]]
      type(named_figure_type), intent(in) :: figures(:)
      !> As it would be typed
      character(*), intent(in), optional :: command_line
      character(:), allocatable :: path
      logical :: with_allan
      integer :: c

      with_allan = command == "run" .or. command == "allan"
      path = "(in memory)"
      if (allocated(record%path)) path = record%path
      if (path == "-") path = "standard input"
      call begin_page()
      call put(writer, "<section")
      call put_attribute(writer, "data-path", path)
      call put_line(writer, ">")
      call put_summary()
      writer%markup%level = 3
      call close_list(writer)
      do c = 1, size(result%channel)
         call put_figures("overlay")
         if (size(result%channel) == 1) call put_figures("allan")
      end do
      if (size(result%channel) > 1) then
         call put_line(writer, "<nav aria-label=""Channels""><ul>")
         do c = 1, size(result%channel)
            call put(writer, "<li><a href=""#c"//count_text(int(c, int64))//""">")
            call put_escaped(writer, "Channel "//result%channel(c)%name)
            call put_line(writer, "</a></li>")
         end do
         call put_line(writer, "</ul></nav>")
      end if
      call put_input(writer, record)
      call close_list(writer)
      do c = 1, size(result%channel)
         call put_channel()
      end do
      call put_line(writer, "</section>")
      call end_page()

   contains

      !> From the document's type to the beginning of the content.
      subroutine begin_page()
         character(:), allocatable :: name
         character(8) :: day

         name = path(index(path, "/", back=.true.) + 1:)
         call date_and_time(date=day)
         name = name//", "//day(:4)//"-"//day(5:6)//"-"//day(7:)
         writer%markup%on = .true.
         writer%unicode = .true.
         call put_lines(writer, page_head)
         call put_line(writer, "<meta name=""generator"" content=""gyroakf "//release_string//""">")
         call put_element(writer, "title", name//": "//report_subject(command)//" (gyroakf)")
         call put_lines(writer, [character(96) :: "<style>", page_style, svg_style, page_top])
         call put_element(writer, "h1", name)
         call put_element(writer, "p", "gyroakf "//release_string//": "//report_subject(command)// &
                          "; "//path)
         call put_lines(writer, [character(19) :: "</header>", "<main id=""content"">"])
      end subroutine begin_page

      !> Remarks and the numbers of all channels.
      subroutine put_summary()
         call put_element(writer, "h2", "Results")
         writer%markup%heading = "Results"
         call put_remarks(writer, command, record, result)
         if (with_allan) then
            call put_answer(writer, record, result)
            if (any([(result%channel(c)%allan(stage%input)%fitted, &
                      c=1, size(result%channel))])) then
               call put_paragraph(writer, "minimum: lowest reliable Allan deviation, "// &
                                  minimum_note())
            end if
         else if (command /= "ar" .or. size(result%channel) > 1) then
            call put_overview(writer, command, record, result)
         end if
      end subroutine put_summary

      !> The channel c.
      subroutine put_channel()
         type(record_type) :: view

         call view_channel(record, c, view)
         call put(writer, "<section id=""c"//count_text(int(c, int64))//"""")
         call put_line(writer, " data-channel="""//count_text(int(c - 1, int64))//""">")
         call put_element(writer, "h3", "Channel "//result%channel(c)%name)
         associate (channel => result%channel(c))
            if (size(result%channel) > 1) call put_figures("allan")
            call put_figures("series")
            call close_list(writer)
            if (with_allan) call put(writer, "<details>")
            if (with_allan) call put_element(writer, "summary", "Details of "//channel%name)
            call put_figures("filters")
            call put_sections(writer, command, view, channel)
            if (command == "run" .and. channel%allan(stage%input)%available) then
               call put_curves_of(writer, view, channel%allan(stage%input), "Raw")
               if (channel%available%cleaned) then
                  call put_curves_of(writer, view, channel%allan(stage%cleaned), "Cleaned")
               end if
            end if
         end associate
         call close_list(writer)
         if (with_allan) call put_line(writer, "</details>")
         call put_line(writer, "</section>")
      end subroutine put_channel

      !> The figures of a kind and the channel c, with their captions.
      subroutine put_figures(kind)
         character(*), intent(in) :: kind
         integer :: i

         do i = 1, size(figures)
            if (figures(i)%kind /= kind .or. figures(i)%channel /= c) cycle
            call close_list(writer)
            call put(writer, "<figure><div class=""plot"" tabindex=""0"" role=""group""")
            call put_attribute(writer, "aria-label", figures(i)%figure%title)
            call put_line(writer, ">")
            call write_svg(writer, figures(i)%figure, .false.)
            call put_line(writer, "</div>")
            call put_element(writer, "figcaption", figures(i)%figure%caption)
            call put_line(writer, "</figure>")
         end do
      end subroutine put_figures

      !> From the end of the content to that of the document.
      subroutine end_page()
         call close_list(writer)
         call put_lines(writer, [character(8) :: "</main>", "<footer>"])
         call put_element(writer, "h2", "How this page was made")
         call put_line(writer, "<dl>")
         if (present(command_line)) then
            call put(writer, "<dt>Command</dt><dd><code>")
            call put_escaped(writer, command_line)
            call put_line(writer, "</code></dd>")
         end if
         call put_element(writer, "dt", "Program")
         call put_element(writer, "dd", "gyroakf "//release_string//", compiled by "// &
                          compiler_version())
         call put_element(writer, "dt", "Numbers")
         call put_element(writer, "dd", "to their last digit in results.json, beside this page")
         call put_lines(writer, [character(96) :: "</dl>", "</footer>", "<script>", page_script, &
                                 "</script>", "</body>", "</html>"])
      end subroutine end_page

   end subroutine write_page

end module gyroakf_report_html_page
