! SPDX-License-Identifier: MIT
!> The summary of many files: summary.csv, summary.json (`doc/summary.schema.json`) and a table for a terminal.
module gyroakf_report_summary
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, text_type, view_channel
   use gyroakf_release, only : release_string
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : put, put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_description, only : description_type
   use gyroakf_report_json, only : json_text, json_type
   use gyroakf_report_text_layout, only : plural, put_paragraph, report_width
   use gyroakf_report_summary_row, only : column_heads, csv_head, drift_of, make_failed_row, make_row, summary_row_type
   use gyroakf_report_text_table, only : column_widths, new_table, put_table, set_cell, table_type
   use gyroakf_utf8, only : is_continuation, text_width
   implicit none (type, external)
   private
   public :: summary_row_type, summarise, summarise_failure, write_summary_csv, write_summary_json, write_summary_table

   !> Maximum number of warnings of a file that are shown in full
   integer, parameter :: most_warnings = 3
   !> A file's name has at least so many characters in the table, and a channel's at most
   integer, parameter :: least_name = 12, most_channel = 12

contains

   !> A file that was worked on.
   subroutine summarise(command, path, folder, record, row, result)
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> As it was given
      character(*), intent(in) :: path
      !> Of its results, "" where none are written
      character(*), intent(in) :: folder
      !> What was read
      type(record_type), intent(in) :: record
      !> The row
      type(summary_row_type), intent(out) :: row
      !> What came out; absent for inspect
      type(pipeline_result_type), intent(in), optional :: result
      type(json_type) :: json

      call make_row(command, path, folder, record, row, result)
      call begin_file(json, row)
      call put_record(json, record, result)
      call end_file(json, row)
   end subroutine summarise

   !> A file that failed.
   subroutine summarise_failure(command, path, folder, code, message, row)
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> As it was given
      character(*), intent(in) :: path
      !> Of its results, "" where none are written
      character(*), intent(in) :: folder
      !> What a run of this file alone would end with
      integer, intent(in) :: code
      !> What went wrong
      character(*), intent(in) :: message
      !> The row
      type(summary_row_type), intent(out) :: row
      type(json_type) :: json
      integer :: i
      character(10), parameter :: unknown(4) = [character(10) :: "samples", "rate_hz", "duration_s", "missing"]

      call make_failed_row(command, path, folder, code, message, row)
      call begin_file(json, row)
      do i = 1, size(unknown)
         call json%absent(trim(unknown(i)))
      end do
      call json%put("warning_count", 0)
      call json%open_list("warnings")
      call json%close()
      call json%open_list("channels")
      call json%close()
      call end_file(json, row)
   end subroutine summarise_failure

   !> Opens the element of a file, as deep as it stands in the whole document.
   subroutine begin_file(json, row)
      type(json_type), intent(inout) :: json
      type(summary_row_type), intent(in) :: row

      call json%open("")
      call json%open_list("files")
      call json%open("")
      call json%put("path", row%path)
      call json%put("folder", row%folder, row%folder /= "")
      call json%put("exit_code", row%code)
      call json%put("message", row%message, row%message /= "")
   end subroutine begin_file

   !> Closes it and keeps its text without what stands around it.
   subroutine end_file(json, row)
      type(json_type), intent(inout) :: json
      type(summary_row_type), intent(inout) :: row
      character(:), allocatable :: text

      call json%close()
      text = json_text(json)
      row%json = text(index(text, "[") + index(text(index(text, "["):), "{") - 1:)
   end subroutine end_file

   !> What was read and what came out.
   subroutine put_record(out, record, result)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in), optional :: result
      type(text_type), allocatable :: warnings(:)
      type(channel_result_type) :: nothing
      integer :: c

      call gather_warnings(record, warnings, result)
      call out%put("samples", sample_count(record))
      call out%put("rate_hz", 1.0_dp/record%sample_interval, record%rate_known)
      call out%put("duration_s", real(sample_count(record), dp)*record%sample_interval, record%rate_known)
      call out%put("missing", record%audit%missing)
      call out%put("warning_count", size(warnings))
      call out%put("warnings", warnings(:min(size(warnings), most_warnings)))
      call out%open_list("channels")
      do c = 1, size(record%channel)
         if (present(result)) then
            call put_channel(out, record, c, result%channel(c), .true.)
         else
            call put_channel(out, record, c, nothing, .false.)
         end if
      end do
      call out%close()
   end subroutine put_record

   !> One channel.
   subroutine put_channel(out, record, c, channel, there)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      type(channel_result_type), intent(in) :: channel
      !> False where nothing was computed
      logical, intent(in) :: there
      type(record_type) :: view
      integer :: term

      call view_channel(record, c, view)
      call out%open("")
      call out%put("name", record%channel(c)%text)
      if (allocated(view%unit%name)) then
         call out%put("unit", view%unit%name, view%unit%name /= "")
      else
         call out%absent("unit")
      end if
      call out%put("mean", channel%raw%mean, there)
      call out%put("std", channel%raw%std, there)
      call out%put("outliers_removed", channel%clean%removed, channel%available%preprocess)
      call out%open("coefficients")
      do term = 1, 5
         associate (stated => channel%allan(stage%input)%stated%term(term))
            if (.not. stated%fitted) then
               call out%absent(term_names(term))
               cycle
            end if
            call out%open(term_names(term))
            call out%put("value", stated%value)
            call out%put("std_error", stated%std_error)
            call out%put("upper_limit", stated%upper_limit)
            call out%put("detected", stated%detected)
            call out%put("unit", stated%unit)
            call out%close()
         end associate
      end do
      call out%close()
      call put_methods(out, channel, there)
      call out%close()
   end subroutine put_channel

   !> Tests, model, filters of a channel.
   subroutine put_methods(out, channel, there)
      class(description_type), intent(inout) :: out
      type(channel_result_type), intent(in) :: channel
      !> False where nothing was computed
      logical, intent(in) :: there

      call out%put("adf_p_value", channel%adf%p_value, channel%available%adf)
      call out%put("jarque_bera_p_value", channel%jarque_bera%p_value, channel%available%jarque_bera)
      call out%put("ljung_box_p_value", channel%ljung_box%p_value, channel%available%ljung_box)
      call out%put("ar_order", int(channel%ar%order, int64), channel%available%ar)
      call out%put("ar_noise_variance", channel%ar%noise_variance, channel%available%ar)
      call out%put("cleaned_variance", channel%cleaned%variance, there)
      call out%put("kf_variance", channel%kf%variance, channel%available%kf)
      call out%put("akf_variance", channel%akf%variance, channel%available%akf)
      call out%put("drift_kf_variance", channel%drift_kf%variance, channel%available%drift_kf)
      call out%put("drift_akf_variance", channel%drift_akf%variance, channel%available%drift_akf)
      call out%put("akf_dc_gain", channel%akf%dc_gain, channel%available%akf)
      call out%put("drift", drift_of(channel), drift_of(channel) /= "")
   end subroutine put_methods

   !> summary.csv: a line per file and channel; a file that failed has one line. nan where a number is not known.
   subroutine write_summary_csv(writer, rows)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      integer :: i

      call put_line(writer, csv_head())
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
      call json%open_list("files")
      do i = 1, size(rows)
         call json%put_json("", rows(i)%json)
      end do
      call json%close()
      call json%close()
   end subroutine write_summary_json

   !> A table of at most 80 columns where names and units allow it, and how many files failed.
   subroutine write_summary_table(writer, command, rows)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> In the order of the files
      type(summary_row_type), intent(in) :: rows(:)
      type(text_type), allocatable :: heads(:)
      type(table_type) :: table
      integer :: i, j, k, line

      call column_heads(command, heads)
      line = 1
      do i = 1, size(rows)
         line = line + size(rows(i)%cell, 1)
      end do
      call new_table(table, line, size(heads), left=2)
      do j = 1, size(heads)
         call set_cell(table, 1, j, heads(j)%text)
      end do
      line = 1
      do i = 1, size(rows)
         do k = 1, size(rows(i)%cell, 1)
            line = line + 1
            call set_cell(table, line, 1, rows(i)%cell(k, 1)%text)
            call set_cell(table, line, 2, tail_of(rows(i)%cell(k, 2)%text, most_channel))
            do j = 3, size(heads)
               call set_cell(table, line, j, rows(i)%cell(k, j)%text)
            end do
         end do
      end do
      if (.not. writer%markup%on) then                     ! a page is wide enough
         do j = 3, size(heads)
            call move_unit(table, j)
         end do
         call fit_names(table)
      end if
      call put_table(writer, table, verbatim=.true.)
      if (.not. writer%markup%on) call put_line(writer, "")
      if (any(rows%code /= 0)) then
         call put_paragraph(writer, plural(size(rows, kind=int64), "file")//", "//plural(count(rows%code /= 0, kind=int64), &
                                                                                        "failure"), 2)
      else
         call put_paragraph(writer, plural(size(rows, kind=int64), "file"), 2)
      end if
   end subroutine write_summary_table

   !> A unit that all numbers of a column have goes into its head.
   pure subroutine move_unit(table, column)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: column
      character(:), allocatable :: unit
      integer :: i, first

      unit = ""
      do i = 2, size(table%cell, 1)
         associate (text => table%cell(i, column)%text)
            if (text == "" .or. text == "-") cycle
            first = index(text, " ", back=.true.)
            if (first == 0) return
            if (scan(text(first + 1:first + 1), "0123456789") > 0) return
            if (unit == "") unit = text(first:)
            if (text(first:) /= unit) return
         end associate
      end do
      if (unit == "") return
      table%cell(1, column)%text = table%cell(1, column)%text//new_line("a")//unit(2:)
      do i = 2, size(table%cell, 1)
         first = index(table%cell(i, column)%text, " ", back=.true.)
         if (first > 0) table%cell(i, column)%text = table%cell(i, column)%text(:first - 1)
      end do
   end subroutine move_unit

   !> A unit that only some numbers of a column have goes below its number.
   pure subroutine break_cells(table)
      type(table_type), intent(inout) :: table
      integer :: i, j, blank

      do j = 3, size(table%cell, 2)
         do i = 2, size(table%cell, 1)
            associate (text => table%cell(i, j)%text)
               blank = index(text, " ", back=.true.)
               if (blank == 0) cycle
               if (scan(text(blank + 1:blank + 1), "0123456789") == 0) text(blank:blank) = new_line("a")
            end associate
         end do
      end do
   end subroutine break_cells

   !> Units, then file names give way where the table would else be too wide: names lose their beginning.
   pure subroutine fit_names(table)
      type(table_type), intent(inout) :: table
      integer, allocatable :: width(:)
      integer :: i, widest

      call column_widths(table, width)
      if (2*size(width) + least_name + sum(width(2:)) > report_width) then
         call break_cells(table)
         call column_widths(table, width)
      end if
      widest = max(least_name, report_width - 2*size(width) - sum(width(2:)))
      do i = 2, size(table%cell, 1)
         table%cell(i, 1)%text = tail_of(table%cell(i, 1)%text, widest)
      end do
   end subroutine fit_names

   !> The end of a text that is too long, with "..." in front.
   pure function tail_of(text, width) result(tail)
      character(*), intent(in) :: text
      integer, intent(in) :: width
      character(:), allocatable :: tail
      integer :: first, characters

      tail = text
      if (text_width(text) <= width) return
      first = len(text) + 1
      characters = 0
      do while (characters < width - 3)
         first = first - 1
         if (.not. is_continuation(text(first:first))) characters = characters + 1
      end do
      tail = "..."//text(first:)
   end function tail_of

end module gyroakf_report_summary
