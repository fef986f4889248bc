! SPDX-License-Identifier: MIT
!> report.html: the whole report of a recording as one file that needs nothing else.
!>
!>     call open_writer(writer, "results/report.html", error)
!>     call write_page(writer, about, command, record, result, row)
!>     call commit_writer(writer, error)
module gyroakf_report_html_page
   use, intrinsic :: iso_fortran_env, only : compiler_version
   use gyroakf_record, only : record_type
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_html_markup, only : close_list, put_element, put_escaped
   use gyroakf_report_html_recording, only : put_recording
   use gyroakf_report_html_script, only : put_script
   use gyroakf_report_html_style, only : put_style
   use gyroakf_report_summary, only : summary_row_type, write_summary_table
   use gyroakf_report_text_report, only : report_subject
   implicit none (type, external)
   private
   public :: page_about_type, write_page

   !> What a page says of itself
   type :: page_about_type
      !> The command line, as it would be typed; "" where there was none
      character(:), allocatable :: command_line
      !> Number of the recording among those of the command line
      integer :: number = 1
   end type page_about_type

contains

   !> The page of one recording.
   subroutine write_page(writer, about, command, record, result, row)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What made it
      type(page_about_type), intent(in) :: about
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Its row of the summary
      type(summary_row_type), intent(in) :: row
      type(summary_row_type) :: rows(1)

      rows(1) = row
      call begin_page(writer, command, row%path)
      if (command /= "run" .and. command /= "allan") call put_summary(writer, command, rows)
      call put_recording(writer, about%number, command, record, result)
      call end_page(writer, about)
   end subroutine write_page

   !> From the document's type to the beginning of the content.
   subroutine begin_page(writer, command, what)
      type(writer_type), intent(inout) :: writer
      !> Of gyroakf; what the page is of
      character(*), intent(in) :: command, what

      writer%markup%on = .true.
      writer%unicode = .true.
      call put_line(writer, "<!DOCTYPE html>")
      call put_line(writer, "<html lang=""en"">")
      call put_line(writer, "<head>")
      call put_line(writer, "<meta charset=""utf-8"">")
      call put_line(writer, "<meta name=""viewport"" content=""width=device-width, initial-scale=1"">")
      call put_line(writer, "<meta name=""generator"" content=""gyroakf "//release_string//""">")
      call put_element(writer, "title", what//": "//report_subject(command)//" (gyroakf)")
      call put_style(writer)
      call put_line(writer, "</head>")
      call put_line(writer, "<body>")
      call put_line(writer, "<a class=""skip"" href=""#content"">Skip to the results</a>")
      call put_line(writer, "<header>")
      call put_element(writer, "h1", "gyroakf "//release_string//": "//report_subject(command))
      call put_line(writer, "</header>")
      call put_line(writer, "<main id=""content"">")
   end subroutine begin_page

   !> From the end of the content to that of the document.
   subroutine end_page(writer, about)
      type(writer_type), intent(inout) :: writer
      type(page_about_type), intent(in) :: about

      call close_list(writer)
      call put_line(writer, "</main>")
      call put_line(writer, "<footer>")
      call put_element(writer, "h2", "How this page was made")
      call put_line(writer, "<dl>")
      if (about%command_line /= "") then
         call put(writer, "<dt>Command</dt><dd><code>")
         call put_escaped(writer, about%command_line)
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

   !> One row of every channel.
   subroutine put_summary(writer, command, rows)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: command
      type(summary_row_type), intent(in) :: rows(:)

      call put_element(writer, "h2", "Summary")
      writer%markup%heading = "Summary"
      call write_summary_table(writer, command, rows)
      call close_list(writer)
   end subroutine put_summary

end module gyroakf_report_html_page
