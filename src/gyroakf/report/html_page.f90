! SPDX-License-Identifier: MIT
!> report.html: the whole report of a recording as one file that needs nothing else.
!>
!>     call open_writer(writer, "results/report.html", error)
!>     call write_page(writer, command, record, result, figures)
!>     call commit_writer(writer, error)
module gyroakf_report_html_page
   use, intrinsic :: iso_fortran_env, only : compiler_version
   use gyroakf_record, only : record_type
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_figures, only : named_figure_type
   use gyroakf_report_html_markup, only : close_list, put_element, put_escaped
   use gyroakf_report_html_recording, only : put_recording, record_name
   use gyroakf_report_html_script, only : put_script
   use gyroakf_report_html_style, only : put_style
   use gyroakf_report_summary, only : summarise, summary_row_type, write_summary_table
   use gyroakf_report_text_report, only : report_subject
   implicit none (type, external)
   private
   public :: write_page

contains

   !> The page of one recording.
   subroutine write_page(writer, command, record, result, figures, command_line)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Of the result: [[build_figures]]
      type(named_figure_type), intent(in) :: figures(:)
      !> As it would be typed
      character(*), intent(in), optional :: command_line
      type(summary_row_type) :: row(1)

      call begin_page(writer, command, record_name(record))
      if (command /= "run" .and. command /= "allan") then
         call summarise(command, record_name(record), "", record, row(1), result)
         call put_element(writer, "h2", "Summary")
         writer%markup%heading = "Summary"
         call write_summary_table(writer, row)
         call close_list(writer)
      end if
      call put_recording(writer, command, record, result, figures)
      call end_page(writer, command_line)
   end subroutine write_page

   !> From the document's type to the beginning of the content.
   subroutine begin_page(writer, command, path)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: command
      !> What was read
      character(*), intent(in) :: path
      character(:), allocatable :: name
      character(8) :: day

      name = path(index(path, "/", back=.true.) + 1:)
      call date_and_time(date=day)
      name = name//", "//day(:4)//"-"//day(5:6)//"-"//day(7:)
      writer%markup%on = .true.
      writer%unicode = .true.
      call put_line(writer, "<!DOCTYPE html>")
      call put_line(writer, "<html lang=""en"">")
      call put_line(writer, "<head>")
      call put_line(writer, "<meta charset=""utf-8"">")
      call put_line(writer, "<meta name=""viewport"" content=""width=device-width, initial-scale=1"">")
      call put_line(writer, "<meta name=""generator"" content=""gyroakf "//release_string//""">")
      call put_element(writer, "title", name//": "//report_subject(command)//" (gyroakf)")
      call put_style(writer)
      call put_line(writer, "</head>")
      call put_line(writer, "<body>")
      call put_line(writer, "<a class=""skip"" href=""#content"">Skip to the results</a>")
      call put_line(writer, "<header>")
      call put_element(writer, "h1", name)
      call put_element(writer, "p", "gyroakf "//release_string//": "//report_subject(command)//"; "//path)
      call put_line(writer, "</header>")
      call put_line(writer, "<main id=""content"">")
   end subroutine begin_page

   !> From the end of the content to that of the document.
   subroutine end_page(writer, command_line)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in), optional :: command_line

      call close_list(writer)
      call put_line(writer, "</main>")
      call put_line(writer, "<footer>")
      call put_element(writer, "h2", "How this page was made")
      call put_line(writer, "<dl>")
      if (present(command_line)) then
         call put(writer, "<dt>Command</dt><dd><code>")
         call put_escaped(writer, command_line)
         call put_line(writer, "</code></dd>")
      end if
      call put_element(writer, "dt", "Program")
      call put_element(writer, "dd", "gyroakf "//release_string//", compiled by "//compiler_version())
      call put_element(writer, "dt", "Numbers")
      call put_element(writer, "dd", "to their last digit in results.json, beside this page")
      call put_line(writer, "</dl>")
      call put_line(writer, "</footer>")
      call put_script(writer)
      call put_line(writer, "</body>")
      call put_line(writer, "</html>")
   end subroutine end_page

end module gyroakf_report_html_page
