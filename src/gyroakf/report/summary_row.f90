! SPDX-License-Identifier: MIT
!> What a summary of many files says of one of them: described once, for summary.csv and
!> summary.json; the cells of the table.
module gyroakf_report_summary_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, text_type, view_channel
   use gyroakf_units, only : term_names
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage, stage_names, &
      stated_coefficient_type
   use gyroakf_report_csv_row, only : csv_row_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_input, only : has_unit
   use gyroakf_report_json, only : json_text, json_type
   use gyroakf_report_text_layout, only : count_text, if_known, number
   use gyroakf_report_verdicts, only : verdict_text
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: summary_row_type, summarise

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
      !> Cells of the table, a row for each channel: [row, column]; and their heads
      type(text_type), allocatable :: cell(:, :), heads(:)
   end type summary_row_type

   !> Maximum number of warnings of a file that are shown in full
   integer, parameter :: most_warnings = 3
   !> Digits of a number in the table
   integer, parameter :: table_digits = 4

contains

   !> A file that was worked on, or that failed: then with a record that was not read, which has
   !> no channels.
   subroutine summarise(command, path, folder, record, row, result, code, message)
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
      call json%open("")                                   ! as deep as it stands in the whole document
      call json%open_list("files")
      call json%open("")
      call json%put("path", path)
      call json%put("folder", folder, folder /= "")
      call json%put("exit_code", row%code)
      call json%put("message", row%message, row%message /= "")
      call put_record(json, record)
      call json%put("warning_count", size(warnings))
      call json%put("warnings", warnings(:min(size(warnings), most_warnings)))
      call json%open_list("channels")
      n = 1
      if (allocated(record%channel)) n = size(record%channel)
      do c = 1, n
         if (present(result)) call add_channel(result%channel(c))
         if (.not. present(result)) call add_channel(nothing)
      end do
      call json%close()
      call json%close()
      text = json_text(json)
      row%json = ""
      if (.not. json%failed) row%json = text(index(text, "[") + index(text(index(text, "["):), "{") - 1:)

   contains

      !> A channel in all forms; the message of its line is the error, or else the first warning.
      subroutine add_channel(channel)
         type(channel_result_type), intent(in) :: channel
         type(text_type), allocatable :: texts(:)
         type(csv_row_type) :: csv
         integer :: i

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
         call make_cells(command, record, c, channel, row%heads, texts)
         texts(size(texts))%text = count_text(size(warnings, kind=int64))
         if (row%code /= 0) then
            do i = 3, size(texts)
               texts(i)%text = ""
            end do
            texts(2)%text = "failed"
         end if
         texts(1)%text = path
         call make_readable(texts(1)%text)
         if (c == 1) allocate (row%cell(n, size(texts)))
         row%cell(c, :) = texts
      end subroutine add_channel

   end subroutine summarise

   !> What was read; nothing is known of a record without channels.
   subroutine put_record(out, record)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record

      call out%put("samples", sample_count(record), allocated(record%channel))
      call out%put("rate_hz", 1.0_dp/record%sample_interval, record%rate_known)
      call out%put("duration_s", real(sample_count(record), dp)*record%sample_interval, &
                   record%rate_known)
      call out%put("missing", record%audit%missing, allocated(record%channel), shown=.false.)
   end subroutine put_record

   !> One channel; the titles name the columns of summary.csv.
   subroutine put_channel(out, record, c, channel)
      class(description_type), intent(inout) :: out
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      !> Without a name where nothing was computed
      type(channel_result_type), intent(in) :: channel
      type(record_type) :: view
      character(:), allocatable :: name
      logical :: there
      integer :: term

      there = allocated(channel%name)
      name = ""
      if (allocated(record%channel)) then
         call view_channel(record, c, view)
         name = record%channel(c)%text
      end if
      call out%open("")
      call out%put("name", name, title="channel")
      call out%put("unit", view%unit%name, has_unit(view))
      call out%put("mean", channel%raw%mean, there)
      call out%put("std", channel%raw%std, there)
      call out%put("outliers_removed", channel%clean%removed, channel%available%preprocess)
      call out%open("coefficients")
      do term = 1, 5
         call put_coefficient(out, term_names(term), channel%allan(stage%input)%stated%term(term))
      end do
      call out%close()
      associate (is => channel%available)
         call out%put("adf_p_value", channel%adf%p_value, is%adf)
         call out%put("jarque_bera_p_value", channel%jarque_bera%p_value, is%jarque_bera)
         call out%put("ljung_box_p_value", channel%ljung_box%p_value, is%ljung_box)
         call out%put("ar_order", channel%ar%order, is%ar)
         call out%put("ar_noise_variance", channel%ar%noise_variance, is%ar)
         call out%put("cleaned_variance", channel%cleaned%variance, there)
         call out%put("kf_variance", channel%kf%variance, is%kf)
         call out%put("akf_variance", channel%akf%variance, is%akf)
         call out%put("drift_kf_variance", channel%drift_kf%variance, is%drift_kf)
         call out%put("drift_akf_variance", channel%drift_akf%variance, is%drift_akf)
         call out%put("akf_dc_gain", channel%akf%dc_gain, is%akf)
         call out%put("drift", trim(channel%verdict%drift), channel%verdict%wanted)
      end associate
      call out%close()
   end subroutine put_channel

   !> One coefficient.
   subroutine put_coefficient(out, name, stated)
      class(description_type), intent(inout) :: out
      character(*), intent(in) :: name
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: unit

      if (.not. out%opens(name, stated%fitted)) return
      unit = ""
      if (allocated(stated%unit)) unit = stated%unit
      call out%put("value", stated%value, stated%fitted, title=name)
      call out%put("std_error", stated%std_error, stated%fitted, title=name//"_std_error")
      call out%put("upper_limit", stated%upper_limit, stated%fitted, title=name//"_upper_limit_95")
      call out%put("detected", stated%detected, stated%fitted, title=name//"_detected")
      call out%put("unit", unit, stated%fitted, title=name//"_unit")
      call out%close()
   end subroutine put_coefficient

   !> The table's heads and a row of it; file and warnings are left to the caller.
   subroutine make_cells(command, record, c, channel, heads, texts)
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      type(channel_result_type), intent(in) :: channel
      !> [at least 4] file, channel, samples, ..., warnings; and the cells below them
      type(text_type), allocatable, intent(out) :: heads(:), texts(:)
      type(record_type) :: view
      character(:), allocatable :: text
      integer :: n

      allocate (heads(8), texts(8))
      n = 0
      call add("file", "")
      call add("channel", "")
      if (allocated(record%channel)) then
         call view_channel(record, c, view)
         texts(2)%text = record%channel(c)%text
      end if
      call add("samples", count_text(sample_count(record)))
      associate (is => channel%available)
         select case (command)
         case ("inspect")
            call add_number("rate Hz", 1.0_dp/record%sample_interval, record%rate_known)
            call add("unit", "")
            if (allocated(view%unit%name)) texts(n)%text = view%unit%name
            call add("missing", count_text(record%audit%missing))
            call add("gaps", count_text(record%audit%gaps))
         case ("tests")
            call add_number("ADF p", channel%adf%p_value, is%adf)
            call add_number("Jarque-Bera", channel%jarque_bera%p_value, is%jarque_bera)
            call add_number("Ljung-Box", channel%ljung_box%p_value, is%ljung_box)
         case ("ar")
            call add_number("order", real(channel%ar%order, dp), is%ar)
            call add_number("noise var.", channel%ar%noise_variance, is%ar)
            text = "-"
            if (is%ar .and. channel%ar%order > 0) text = number(channel%ar%coefficient(1), table_digits)
            call add("phi 1", text)
         case ("filter")
            call add_number("variance", channel%cleaned%variance, .true.)
            call add_number("KF", channel%kf%variance, is%kf)
            call add_number("AKF", channel%akf%variance, is%akf)
            call add_number("AKF passes", channel%akf%dc_gain, is%akf)
         case default
            associate (term => channel%allan(stage%input)%stated%term)
               call add("N", coefficient_text(term(2)))
               call add("B", coefficient_text(term(3)))
               call add("K", coefficient_text(term(4)))
            end associate
            text = "-"
            if (channel%verdict%known) text = trim(verdict_text(channel))
            call add("noise", text)
         end select
      end associate
      call add("warnings", "")
      heads = heads(:n)
      texts = texts(:n)

   contains

      !> One column.
      subroutine add(head, text)
         character(*), intent(in) :: head, text

         n = n + 1
         heads(n)%text = head
         texts(n)%text = text
      end subroutine add

      subroutine add_number(head, value, known)
         character(*), intent(in) :: head
         real(dp), intent(in) :: value
         logical, intent(in) :: known

         call add(head, if_known(known, number(value, table_digits), "-"))
      end subroutine add_number

   end subroutine make_cells

   !> "0.3005 deg/sqrt(h)", "< 8.6 deg/h^1.5", "-".
   pure function coefficient_text(stated) result(text)
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: text

      text = "-"
      if (.not. stated%fitted) return
      text = "< "//number(stated%upper_limit, 3)//" "//stated%unit
      if (stated%detected) text = number(stated%value, table_digits)//" "//stated%unit
   end function coefficient_text

end module gyroakf_report_summary_row
