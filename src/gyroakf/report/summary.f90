! SPDX-License-Identifier: MIT
!> The summary of many files: summary.csv, summary.json (`doc/summary.schema.json`) and a table for
!> a terminal.
module gyroakf_report_summary
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, text_type
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : put, put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage_names
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_input, only : text_or
   use gyroakf_report_json, only : json_text, json_type
   use gyroakf_report_summary_row, only : add_channel_row, csv_row_type, put_channel, put_record
   use gyroakf_report_text_layout, only : plural, put_paragraph, report_width
   use gyroakf_report_text_table, only : add_row, column_widths, put_table, table_type
   use gyroakf_utf8, only : text_width
   implicit none (type, external)
   private
   public :: summary_row_type, summarize, write_summary_csv, write_summary_json, write_summary_table

   !> One file
   type :: summary_row_type
      !> What a run of this file alone would end with: 0 done, 2 the data or a file, 3 a numerical
      !> failure, or a crash
      integer :: code = 0
      !> What went wrong, "" where nothing did
      character(:), allocatable :: message
      !> Names of the columns of summary.csv, and its lines, each with its line feed
      character(:), allocatable :: csv_head, csv
      !> Element of "files" in summary.json, "" where there was no memory for it
      character(:), allocatable :: json
      !> A row for each channel
      type(table_type) :: table
   end type summary_row_type

   !> A file's name has at least so many characters in the table, and a channel's at most
   integer, parameter :: least_name = 12, most_channel = 12
   !> Maximum number of warnings of a file that are shown in full
   integer, parameter :: most_warnings = 3

contains

   !> A file that was worked on, or that failed: then with a record that was not read, which has
   !> no channels.
   subroutine summarize(command, path, folder, record, row, result, code, message)
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> As it was given
      character(*), intent(in) :: path
      !> Of its results, "" where none are written
      character(*), intent(in) :: folder
      type(record_type), intent(in) :: record
      !> The row
      type(summary_row_type), intent(out) :: row
      !> What came out; absent for inspect
      type(pipeline_result_type), intent(in), optional :: result
      !> What a run of this file alone would end with (default 0: done)
      integer, intent(in), optional :: code
      !> What went wrong
      character(*), intent(in), optional :: message
      type(channel_result_type) :: nothing
      type(text_type), allocatable :: warnings(:)
      character(:), allocatable :: text
      type(json_type) :: json
      integer :: c, n

      allocate (nothing%allan(size(stage_names)))
      row%message = ""
      if (present(code)) row%code = code
      if (present(message)) row%message = message
      row%csv = ""
      call gather_warnings(record, warnings, result)
      ! as deep as it stands in the whole document
      call json%open("")
      call json%open("files", list=.true.)
      call json%open("")
      call json%put("path", path)
      call json%put("folder", folder, folder /= "")
      call json%put("exit_code", row%code)
      call json%put("message", row%message, row%message /= "")
      call put_record(json, record)
      call json%put("warning_count", size(warnings))
      call json%put("warnings", warnings(:min(size(warnings), most_warnings)))
      call json%open("channels", list=.true.)
      n = 1
      if (allocated(record%channel)) n = size(record%channel)
      do c = 1, n
         if (present(result)) call add_channel(result%channel(c))
         if (.not. present(result)) call add_channel(nothing)
      end do
      call json%close()
      call json%close()
      row%json = ""
      if (json%failed) return
      text = json_text(json)
      text = text(index(text, "["):)
      row%json = text(index(text, "{"):)

   contains

      !> A channel in all forms; the message of its line is the error, or else the first warning.
      subroutine add_channel(channel)
         type(channel_result_type), intent(in) :: channel
         type(csv_row_type) :: csv

         if (allocated(record%channel)) call put_channel(json, record, c, channel)
         text = row%message
         if (row%code == 0 .and. size(warnings) > 0) text = warnings(1)%text
         call csv%put("path", path)
         call csv%put("folder", folder)
         call csv%put("exit_code", row%code)
         call csv%put("warnings", size(warnings))
         call csv%put("message", text(:index(text//new_line("a"), new_line("a")) - 1))
         call put_record(csv, record)
         call put_channel(csv, record, c, channel)
         row%csv_head = csv%head
         row%csv = row%csv//csv%line//new_line("a")
         call add_channel_row(row%table, command, text_or(path, ""), record, c, channel, &
                              size(warnings), row%code /= 0)
      end subroutine add_channel

   end subroutine summarize

   !> summary.csv: a line per file and channel; a file that failed has one line. nan where a number
   !> is not known.
   subroutine write_summary_csv(writer, rows)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      integer :: i

      if (size(rows) > 0) call put_line(writer, rows(1)%csv_head)
      do i = 1, size(rows)
         call put(writer, rows(i)%csv)
      end do
   end subroutine write_summary_csv

   !> summary.json.
   subroutine write_summary_json(writer, command, rows)
      !> Open
      type(writer_type), intent(inout), target :: writer
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      type(json_type) :: json
      integer :: i

      json%writer => writer
      call json%open("")
      call json%put("schema", 1)
      call json%put("program", "gyroakf")
      call json%put("version", release_string)
      call json%put("command", command)
      call json%put("failed", count(rows%code /= 0))
      call json%open("files", list=.true.)
      do i = 1, size(rows)
         call json%put_json("", rows(i)%json)
         writer%failed = writer%failed .or. rows(i)%json == ""
      end do
      call json%close()
      call json%close()
   end subroutine write_summary_json

   !> A table of at most 80 columns where names and units allow it, and how many files failed.
   subroutine write_summary_table(writer, rows)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      type(table_type) :: table
      character(:), allocatable :: text
      integer, allocatable :: width(:)
      integer :: i, j, k, last, widest, blank

      if (size(rows) == 0) return
      table = rows(1)%table
      do i = 1, size(rows)
         do k = 2, size(rows(i)%table%cell, 1)
            if (i > 1) call add_row(table)
            last = merge(k, size(table%cell, 1), i == 1)
            table%cell(last, :) = rows(i)%table%cell(k, :)
            table%cell(last, 2)%text = tail_of(table%cell(last, 2)%text, most_channel)
         end do
      end do
      if (.not. writer%markup%on) then                     ! a page is wide enough
         do j = 3, size(table%cell, 2)
            call move_unit(table, j)
         end do
         call column_widths(table, width)
         if (2*size(width) + least_name + sum(width(2:)) > report_width) then
            do j = 3, size(table%cell, 2)
               do i = 2, size(table%cell, 1)
                  blank = unit_blank(table%cell(i, j)%text)
                  if (blank > 0) table%cell(i, j)%text(blank:blank) = new_line("a")
               end do
            end do
            call column_widths(table, width)
         end if
         widest = max(least_name, report_width - 2*size(width) - sum(width(2:)))
         do i = 2, size(table%cell, 1)
            table%cell(i, 1)%text = tail_of(table%cell(i, 1)%text, widest)
         end do
      end if
      call put_table(writer, table, verbatim=.true.)
      if (.not. writer%markup%on) call put_line(writer, "")
      text = plural(size(rows, kind=int64), "file")
      if (any(rows%code /= 0)) text = text//", "//plural(count(rows%code /= 0, kind=int64), &
                                                         "failure")
      call put_paragraph(writer, text)
   end subroutine write_summary_table

   !> The blank before a number's unit, 0 where it has none.
   pure integer function unit_blank(text)
      character(*), intent(in) :: text

      unit_blank = index(text, " ", back=.true.)
      if (unit_blank == 0) return
      if (scan(text(unit_blank + 1:unit_blank + 1), "0123456789") > 0) unit_blank = 0
   end function unit_blank

   !> A unit that all numbers of a column have goes into its head.
   pure subroutine move_unit(table, column)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: column
      character(:), allocatable :: unit
      integer :: i, blank

      unit = ""
      do i = 2, size(table%cell, 1)
         associate (text => table%cell(i, column)%text)
            if (text == "" .or. text == "-") cycle
            blank = unit_blank(text)
            if (blank == 0) return
            if (unit == "") unit = text(blank:)
            if (text(blank:) /= unit) return
         end associate
      end do
      if (unit == "") return
      table%cell(1, column)%text = table%cell(1, column)%text//new_line("a")//unit(2:)
      do i = 2, size(table%cell, 1)
         blank = unit_blank(table%cell(i, column)%text)
         if (blank > 0) table%cell(i, column)%text = table%cell(i, column)%text(:blank - 1)
      end do
   end subroutine move_unit

   !> The end of a text that is too long, with "..." in front.
   pure function tail_of(text, width) result(tail)
      character(*), intent(in) :: text
      integer, intent(in) :: width
      character(:), allocatable :: tail
      integer :: first

      tail = text
      if (text_width(text) <= width) return
      first = len(text) + 1
      do while (text_width(text(first:)) < width - 3)
         first = first - 1
      end do
      tail = "..."//text(first:)
   end function tail_of

end module gyroakf_report_summary
