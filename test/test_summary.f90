! SPDX-License-Identifier: MIT
!> The summary of many files: its document (test/cli/part_many.sh compares it with the schema), its lines, its table.
module test_summary
   use expectations, only : test, error, check
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_summary, only : summarize, summary_row_type, write_summary_csv, write_summary_json, write_summary_table
   use gyroakf_utf8, only : text_width
   use json_reader, only : json_at, json_item, json_real, json_text_at, read_json
   use report_fixture, only : begin_text, end_text, make_record, make_result
   implicit none (type, external)
   private
   public :: suite_summary

   character(*), parameter :: nl = new_line("a")

contains

   subroutine suite_summary()
      call test("document", document)
      call test("document_of_inspect", document_of_inspect)
      call test("no_files", no_files)
      call test("lines", lines)
      call test("failed_line", failed_line)
      call test("table", table)
      call test("long_names", long_names)
   end subroutine suite_summary

   !> A file that was analyzed, one that failed.
   subroutine two_rows(rows, path)
      type(summary_row_type), intent(out) :: rows(2)
      character(*), intent(in) :: path
      type(record_type) :: record, unread
      type(pipeline_result_type) :: result

      call make_record(record, .true.)
      call make_result(record, result)
      call summarize("run", path, "out/a", record, rows(1), result)
      call summarize("run", 'b "c", d', "", unread, rows(2), code=2, message="b: no such file"//nl//"check the path")
   end subroutine two_rows

   !> The document of some rows.
   subroutine read_document(command, rows, items, valid)
      character(*), intent(in) :: command
      type(summary_row_type), intent(in) :: rows(:)
      type(json_item), allocatable, intent(out) :: items(:)
      logical, intent(out) :: valid
      type(writer_type) :: writer
      character(:), allocatable :: text

      call begin_text(writer)
      call write_summary_json(writer, command, rows)
      call end_text(writer, text)
      call read_json(text, items, valid)
   end subroutine read_document

   subroutine document()
      type(summary_row_type) :: rows(2)
      type(json_item), allocatable :: items(:)
      logical :: valid

      call two_rows(rows, "a.txt")
      call read_document("run", rows, items, valid)
      call check(error, valid, "the document is no JSON")
      call check(error, json_text_at(items, "/files/0/channels/0/name"), '"gx"')
      call check(error, json_real(items, "/files/0/duration_s"), 2.4_dp, thr=1.0e-15_dp)
      call check(error, json_text_at(items, "/failed")//json_text_at(items, "/files/1/exit_code"), "12")
      call check(error, json_text_at(items, "/files/1/message"), '"b: no such file\u000acheck the path"')
      call check(error, json_text_at(items, "/files/1/samples"), "null")
   end subroutine document

   subroutine document_of_inspect()
      type(summary_row_type) :: rows(1)
      type(record_type) :: record
      type(json_item), allocatable :: items(:)
      logical :: valid

      call make_record(record, .false.)
      call summarize("inspect", "-", "", record, rows(1))
      call read_document("inspect", rows, items, valid)
      call check(error, valid)
      call check(error, json_text_at(items, "/files/0/rate_hz")//json_text_at(items, "/files/0/duration_s")// &
                 json_text_at(items, "/files/0/folder")//json_text_at(items, "/files/0/channels/0/mean")// &
                 json_text_at(items, "/files/0/channels/0/coefficients/N"), repeat("null", 5))
   end subroutine document_of_inspect

   subroutine no_files()
      type(summary_row_type) :: rows(0)
      type(json_item), allocatable :: items(:)
      logical :: valid

      call read_document("run", rows, items, valid)
      call check(error, valid .and. json_at(items, "/files") > 0 .and. json_at(items, "/files/0") == 0)
   end subroutine no_files

   subroutine lines()
      type(summary_row_type) :: rows(2)
      type(writer_type) :: writer
      character(:), allocatable :: text
      integer :: first, last

      call two_rows(rows, "a.txt")
      call begin_text(writer)
      call write_summary_csv(writer, rows)
      call end_text(writer, text)
      first = index(text, nl) + 1
      last = first + index(text(first:), nl) - 2
      call check(error, index(text(first:last), "a.txt,out/a,0,") == 1, text(first:last))
      call check(error, commas(text(:first - 2)), commas(text(first:last)), "columns of the head and of a line")
      call check(error, count([(text(first:first) == nl, first=1, len(text))]), 3, "lines")
   end subroutine lines

   subroutine failed_line()
      type(summary_row_type) :: rows(2)

      call two_rows(rows, "a.txt")
      call check(error, index(rows(2)%csv, '"b ""c"", d",,2,0,b: no such file,nan,nan,nan,,,nan,') == 1, rows(2)%csv)
      call check(error, commas(rows(2)%csv), commas(rows(1)%csv), "columns of a failed file")
   end subroutine failed_line

   !> Commas outside of quotes.
   pure integer function commas(line)
      character(*), intent(in) :: line
      logical :: inside
      integer :: i

      commas = 0
      inside = .false.
      do i = 1, len(line)
         if (line(i:i) == '"') inside = .not. inside
         if (line(i:i) == "," .and. .not. inside) commas = commas + 1
      end do
   end function commas

   subroutine table()
      type(summary_row_type) :: rows(2)
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(writer_type) :: writer
      character(:), allocatable :: text

      call two_rows(rows, "a.txt")
      call begin_text(writer)
      call write_summary_table(writer, rows)
      call end_text(writer, text)
      call check(error, index(text, "  file") == 1 .and. index(text, " deg/sqrt(h)") > 0, text)
      call check(error, index(text, "  a.txt gx *  0.948 +/- 0.012 ") > 0, text)
      call check(error, index(text, "  2 files, 1 failure; *: warnings"//nl) > 0, text)
      ! a channel that does not vary stands in the same table
      call make_record(record, .true.)
      call make_result(record, result)
      result%channel(1)%allan(1)%fitted = .false.
      call summarize("run", "tau", "", record, rows(2), result)
      call begin_text(writer)
      writer%unicode = .true.
      call write_summary_table(writer, rows)
      call end_text(writer, text)
      call check(error, index(text, "deg/√h") > 0 .and. index(text, "deg/√h") == index(text, "deg/√h", back=.true.), text)
      call check(error, index(text, nl//"  tau gx *") > 0, text)
   end subroutine table

   subroutine long_names()
      type(summary_row_type) :: rows(2)
      type(writer_type) :: writer
      character(:), allocatable :: text
      integer :: first, last

      call two_rows(rows, repeat("f"//achar(195)//achar(188)//"r/", 60)//"end.txt")
      call begin_text(writer)
      call write_summary_table(writer, rows)
      call end_text(writer, text)
      call check(error, index(text, "  ...") > 0 .and. index(text, "/end.txt ") > 0, text)
      first = 1
      do while (first <= len(text))
         last = first + index(text(first:), nl) - 2
         call check(error, text_width(text(first:last)) <= 100, text(first:last))
         first = last + 2
      end do
   end subroutine long_names

end module test_summary
