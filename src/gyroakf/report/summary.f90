! SPDX-License-Identifier: MIT
!> The summary of many files: summary.csv, summary.json (`doc/summary.schema.json`) and a table for
!> a terminal.
module gyroakf_report_summary
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, sample_count, text_type, view_channel
   use gyroakf_release, only : release_string
   use gyroakf_io_writer, only : put, put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage_names
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_input, only : has_unit, text_or, unit_name
   use gyroakf_report_json, only : json_text, json_type
   use gyroakf_report_summary_row, only : csv_row_type, put_channel, put_record
   use gyroakf_report_text_answer, only : make_answer
   use gyroakf_report_text_layout, only : count_text, if_known, number, plural, put_paragraph, &
      report_width
   use gyroakf_report_text_overview, only : make_overview
   use gyroakf_report_text_table, only : add_row, column_widths, new_table, put_table, table_type
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
      !> How many warnings
      integer :: warnings = 0
      !> Names of the columns of summary.csv, and its lines, each with its line feed
      character(:), allocatable :: csv_head, csv
      !> Element of "files" in summary.json, "" where there was no memory for it
      character(:), allocatable :: json
      !> Of each channel what the first screen of its file shows
      type(table_type), allocatable :: table(:)
   end type summary_row_type

   !> The name of a file and its channel has at least so many characters in the table
   integer, parameter :: least_name = 20
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
      row%warnings = size(warnings)
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
      allocate (row%table(merge(n, 0, allocated(record%channel))))
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
         if (allocated(record%channel)) call make_table(row%table(c))
      end subroutine add_channel

      !> The rows of the first screen, with the name of the file in front.
      subroutine make_table(table)
         type(table_type), intent(out) :: table
         type(record_type) :: view
         integer :: i

         call view_channel(record, c, view)
         if (.not. present(result)) then
            call new_table(table, 6)
            call add_row(table, "", "samples", "rate Hz", "unit", "missing", "gaps")
            call add_row(table, record%channel(c)%text, count_text(sample_count(record)), &
                         if_known(record%rate_known, number(1/record%sample_interval, 5), "-"), &
                         if_known(has_unit(view), unit_name(view), "-"), &
                         count_text(record%audit%missing), count_text(record%audit%gaps))
         else if (command == "run" .or. command == "allan") then
            call make_answer(view, result%channel(c:c), table)
            table%cell = table%cell(:, [1, 3, 4, 5, 8])         ! name, N, B, K, noise
            table%note = "+/-: standard error; <: 95 % limit, not detected; -: withheld"
         else
            call make_overview(command, result%channel(c:c), table)
         end if
         table%cell(1, 1)%text = "file"
         i = table%head + 1
         table%cell(i, 1)%text = text_or(path, "")//" "//table%cell(i, 1)%text// &
            if_known(row%warnings > 0, " *")
         table%caption = ""                                 ! by which equal heads are found
         do i = 1, size(table%cell, 2)
            table%caption = table%caption//"|"//table%cell(1, i)%text//"|"// &
               table%cell(table%head, i)%text
         end do
      end subroutine make_table

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

   !> The rows of all files, a table for each unit; how many files, failures, and warnings.
   subroutine write_summary_table(writer, rows)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      type(table_type), allocatable :: table(:)
      character(:), allocatable :: text
      integer, allocatable :: width(:)
      integer :: i, k, n

      call join_tables(rows, table, n)
      do k = 1, n
         call column_widths(table(k), width)
         do i = table(k)%head + 1, merge(0, size(table(k)%cell, 1), writer%markup%on)
            table(k)%cell(i, 1)%text = tail_of(table(k)%cell(i, 1)%text, &
               max(least_name, report_width - 2*size(width) - sum(width(2:))))
         end do
         if (k > 1) call put_line(writer, "")
         call put_table(writer, table(k))
      end do
      if (n > 0) then
         if (table(1)%note /= "") call put_paragraph(writer, table(1)%note)
         call put_line(writer, "")
      end if
      text = plural(size(rows, kind=int64), "file")
      if (any(rows%code /= 0)) text = text//", "//plural(count(rows%code /= 0, kind=int64), &
                                                         "failure")
      if (any(rows%warnings > 0)) text = text//"; *: warnings"
      call put_paragraph(writer, text)
   end subroutine write_summary_table

   !> The tables of all files; those with the same head become one.
   subroutine join_tables(rows, table, n)
      type(summary_row_type), intent(in) :: rows(:)
      !> Allocated for more; n are filled
      type(table_type), allocatable, intent(out) :: table(:)
      integer, intent(out) :: n
      integer :: i, c, k, row

      allocate (table(sum([(size(rows(i)%table), i=1, size(rows))])))
      n = 0
      do i = 1, size(rows)
         do c = 1, size(rows(i)%table)
            associate (new => rows(i)%table(c))
               do k = 1, n
                  if (table(k)%caption == new%caption) exit
               end do
               n = max(n, k)
               if (.not. allocated(table(k)%cell)) then
                  table(k) = new
                  cycle
               end if
               do row = new%head + 1, size(new%cell, 1)
                  call add_row(table(k))
                  table(k)%cell(size(table(k)%cell, 1), :) = new%cell(row, :)
               end do
            end associate
         end do
      end do
   end subroutine join_tables

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
