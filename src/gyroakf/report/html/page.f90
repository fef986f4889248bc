! SPDX-License-Identifier: MIT
!> report.html: the whole report as one file that needs nothing else, of one recording or of many.
!>
!>     call open_writer(writer, "results/report.html", error)
!>     call write_page(writer, about, command, record, options, result, rows, drawings)
!>     call commit_writer(writer, error)
module gyroakf_report_html_page
   use, intrinsic :: iso_fortran_env, only : compiler_version
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_release, only : release_string
   use gyroakf_io_whole_file, only : read_whole_file
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_element, put_escaped
   use gyroakf_report_html_recording, only : drawings_type, first_mark, last_mark, put_recording
   use gyroakf_report_html_script, only : put_script
   use gyroakf_report_html_style, only : put_style
   use gyroakf_report_layout, only : count_text
   use gyroakf_report_summary, only : summary_row_type, write_summary_table
   use gyroakf_report_text, only : report_subject
   implicit none (type, external)
   private
   public :: page_about_type, write_page, write_pages, drawings_type

   !> What a page says of itself
   type :: page_about_type
      !> The command line, as it would be typed; "" where there was none
      character(:), allocatable :: command_line
      !> Number of the recording among those of the command line
      integer :: number = 1
   end type page_about_type

   !> Recordings that a page of many takes in; the others have pages of their own
   integer, parameter :: most_recordings = 16
   !> Of a page
   character(*), parameter :: page_name = "report.html"

contains

   !> The page of one recording.
   subroutine write_page(writer, about, command, record, options, result, row, drawings)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What made it
      type(page_about_type), intent(in) :: about
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Its row of the summary
      type(summary_row_type), intent(in) :: row
      !> Its figures
      type(drawings_type), intent(inout) :: drawings
      type(summary_row_type) :: rows(1)

      rows(1) = row
      call begin_page(writer, command, row%path)
      call put_summary(writer, command, rows)
      call put_recording(writer, about%number, command, record, options, result, drawings)
      call end_page(writer, about, drawings%program)
   end subroutine write_page

   !> The page of many recordings: the summary, ways to each, and the first of them in full.
   subroutine write_pages(writer, about, command, rows, directory)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> What made it
      type(page_about_type), intent(in) :: about
      !> run, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> In the order of the recordings
      type(summary_row_type), intent(in) :: rows(:)
      !> Of --out; the folders of the rows are in it
      character(*), intent(in) :: directory
      type(error_type), allocatable :: unread
      character(:), allocatable :: page
      integer :: i, taken

      call begin_page(writer, command, count_text(size(rows, kind=int64))//" recordings")
      call put_summary(writer, command, rows)
      call put_ways(writer, rows, directory)
      taken = 0
      do i = 1, size(rows)
         if (rows(i)%code /= 0) cycle
         taken = taken + 1
         if (taken > most_recordings) exit
         call read_whole_file(rows(i)%folder//"/"//page_name, page, unread)
         if (.not. allocated(unread)) call put_between_marks(writer, page)
      end do
      call end_page(writer, about)
   end subroutine write_pages

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
   subroutine end_page(writer, about, program)
      type(writer_type), intent(inout) :: writer
      type(page_about_type), intent(in) :: about
      !> Drew the figures
      character(:), allocatable, intent(in), optional :: program

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
      if (present(program)) then
         if (allocated(program)) then
            call put_element(writer, "dt", "Figures")
            call put_element(writer, "dd", program)
         end if
      end if
      call put_element(writer, "dt", "Numbers")
      call put_element(writer, "dd", "to their last digit in results.json, beside the page of each recording")
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

   !> Ways to the sections and pages of the recordings; what became of those that failed.
   subroutine put_ways(writer, rows, directory)
      type(writer_type), intent(inout) :: writer
      type(summary_row_type), intent(in) :: rows(:)
      character(*), intent(in) :: directory
      integer :: i, taken

      call put_line(writer, "<nav aria-label=""Recordings""><ul>")
      taken = 0
      do i = 1, size(rows)
         call put(writer, "<li>")
         if (rows(i)%code /= 0) then
            call put_escaped(writer, rows(i)%message)
         else
            taken = taken + 1
            call put(writer, "<a")
            if (taken <= most_recordings) then
               call put(writer, " href=""#r"//count_text(int(i, int64))//"""")
            else
               call put_attribute(writer, "href", url_of(rows(i)%folder(len(directory) + 2:))//"/"//page_name)
            end if
            call put(writer, ">")
            call put_escaped(writer, rows(i)%path)
            call put(writer, "</a>")
         end if
         call put_line(writer, "</li>")
      end do
      call put_line(writer, "</ul></nav>")
   end subroutine put_ways

   !> A name in an address: bytes that are no letter, digit, - . _ ~ by their number.
   pure function url_of(name) result(url)
      character(*), intent(in) :: name
      character(:), allocatable :: url
      character(*), parameter :: hexadecimal = "0123456789ABCDEF"
      integer :: i, code

      url = ""
      do i = 1, len(name)
         code = ichar(name(i:i))
         if (verify(name(i:i), "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~") == 0) then
            url = url//name(i:i)
         else
            url = url//"%"//hexadecimal(code/16 + 1:code/16 + 1)//hexadecimal(mod(code, 16) + 1:mod(code, 16) + 1)
         end if
      end do
   end function url_of

   !> The section of a recording from its own page.
   subroutine put_between_marks(writer, page)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: page
      integer :: first, last

      first = index(page, first_mark)
      last = index(page, last_mark, back=.true.)
      if (first > 0 .and. last > first) call put_line(writer, page(first:last + len(last_mark) - 1))
   end subroutine put_between_marks

end module gyroakf_report_html_page
