! SPDX-License-Identifier: MIT
!> What a summary of many files says of one of them: described once, for summary.csv and
!> summary.json; the cells of the table.
module gyroakf_report_summary_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, text_type, view_channel
   use gyroakf_units, only : term_names
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage, &
      stage_names, stated_coefficient_type
   use gyroakf_report_csv, only : csv_row_type
   use gyroakf_report_description, only : description_type
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_input, only : has_unit, text_or, unit_name
   use gyroakf_report_json, only : json_text, json_type
   use gyroakf_report_text_layout, only : count_text, if_known, number
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, table_type
   use gyroakf_report_verdicts, only : verdict_text
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
      !> A row for each channel
      type(table_type) :: table
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
      logical :: there, known
      integer :: term

      there = allocated(channel%name)
      if (allocated(record%channel)) call view_channel(record, c, view)
      call out%open("")
      call out%put("name", channel_name(record, c), title="channel")
      call out%put("unit", view%unit%name, has_unit(view))
      call out%put("mean", channel%raw%mean, there)
      call out%put("std", channel%raw%std, there)
      call out%put("outliers_removed", channel%clean%removed, channel%available%preprocess)
      call out%open("coefficients")
      do term = 1, 5
         associate (stated => channel%allan(stage%input)%stated%term(term), key => term_names(term))
            known = stated%fitted
            if (.not. out%opens(key, known)) cycle
            call out%put("value", stated%value, known, title=key)
            call out%put("std_error", stated%std_error, known, title=key//"_std_error")
            call out%put("upper_limit", stated%upper_limit, known, title=key//"_upper_limit_95")
            call out%put("detected", stated%detected, known, title=key//"_detected")
            call out%put("unit", stated%unit, known, title=key//"_unit")
            call out%close()
         end associate
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

   !> The row of a channel in the table, below the heads; a file that failed has nothing in it.
   subroutine add_channel_row(table, command, path, record, c, channel, warnings, failed)
      !> Not allocated: it begins with the heads
      type(table_type), intent(inout) :: table
      character(*), intent(in) :: command, path
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      type(channel_result_type), intent(in) :: channel
      !> How many
      integer, intent(in) :: warnings
      logical, intent(in) :: failed
      type(record_type) :: view
      integer :: i

      if (.not. allocated(table%cell)) then
         call new_table(table, merge(7, 8, command == "tests" .or. command == "ar"), left=2)
         call add_row(table, "file", "channel")
      end if
      call add_row(table, path, if_known(failed, "failed", channel_name(record, c)))
      if (allocated(record%channel)) call view_channel(record, c, view)
      call add("samples", count_text(sample_count(record)))
      associate (is => channel%available, ar => channel%ar)
         select case (command)
         case ("inspect")
            call add("rate Hz", known(record%rate_known, 1.0_dp/record%sample_interval))
            call add("unit", if_known(has_unit(view), unit_name(view)))
            call add("missing", count_text(record%audit%missing))
            call add("gaps", count_text(record%audit%gaps))
         case ("tests")
            call add("ADF p", known(is%adf, channel%adf%p_value))
            call add("Jarque-Bera", known(is%jarque_bera, channel%jarque_bera%p_value))
            call add("Ljung-Box", known(is%ljung_box, channel%ljung_box%p_value))
         case ("ar")
            call add("order", known(is%ar, real(ar%order, dp)))
            call add("noise var.", known(is%ar, ar%noise_variance))
            if (is%ar .and. ar%order > 0) then
               call add("phi 1", known(.true., ar%coefficient(1)))
            else
               call add("phi 1", "-")
            end if
         case ("filter")
            call add("variance", known(.true., channel%cleaned%variance))
            call add("KF", known(is%kf, channel%kf%variance))
            call add("AKF", known(is%akf, channel%akf%variance))
            call add("AKF passes", known(is%akf, channel%akf%dc_gain))
         case default
            do i = 2, 4
               call add(term_names(i), coefficient_text(channel%allan(stage%input)%stated%term(i)))
            end do
            call add("noise", if_known(channel%verdict%known, trim(verdict_text(channel)), "-"))
         end select
      end associate
      call add("warnings", count_text(int(warnings, int64)))

   contains

      !> A cell, below its head.
      subroutine add(head, text)
         character(*), intent(in) :: head, text

         table%cell(1, table%filled + 1)%text = head
         call add_cell(table, if_known(.not. failed, text))
      end subroutine add

   end subroutine add_channel_row

   !> "" of a record that was not read.
   pure function channel_name(record, c) result(name)
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      character(:), allocatable :: name

      name = ""
      if (allocated(record%channel)) name = record%channel(c)%text
   end function channel_name

   !> A number of the table, "-" where it is not known.
   pure function known(is_known, value) result(text)
      logical, intent(in) :: is_known
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = if_known(is_known, number(value, table_digits), "-")
   end function known

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
