! SPDX-License-Identifier: MIT
!> What a summary of many files says of one of them, as text for each form of the summary.
!>
!> The texts are made where the results are, in a process of its own perhaps, and put together by [[gyroakf_report_summary]].
module gyroakf_report_summary_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, text_type, view_channel
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : format_real
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage, stated_coefficient_type
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_document, only : gather_warnings
   use gyroakf_report_text_layout, only : count_text, number
   use gyroakf_report_verdicts, only : verdict_text
   implicit none (type, external)
   private
   public :: summary_row_type, make_row, make_failed_row, csv_head, column_heads, drift_of

   !> One file
   type :: summary_row_type
      !> Path as it was given, and its result folder; "" where there is none
      character(:), allocatable :: path, folder
      !> What a run of this file alone would end with: 0 done, 2 the data or a file, 3 a numerical failure, or a crash
      integer :: code = 0
      !> What went wrong, "" where nothing did
      character(:), allocatable :: message
      !> Lines of summary.csv, each with its line feed
      character(:), allocatable :: csv
      !> Element of "files" in summary.json
      character(:), allocatable :: json
      !> Cells of the table, a row for each channel, as many columns as [[column_heads]] has: [row, column]
      type(text_type), allocatable :: cell(:, :)
   end type summary_row_type

   !> Digits of a number in summary.csv, as in the other CSV files, and in the table
   integer, parameter :: csv_digits = 15, table_digits = 4

contains

   !> The row of a file that was worked on; `json` is made by [[gyroakf_report_summary]].
   subroutine make_row(command, path, folder, record, row, result)
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
      type(text_type), allocatable :: warnings(:), heads(:)
      type(record_type) :: view
      type(channel_result_type) :: nothing
      integer :: c

      row%path = path
      row%folder = folder
      row%message = ""
      row%csv = ""
      call gather_warnings(record, warnings, result)
      call column_heads(command, heads)
      allocate (row%cell(size(record%channel), size(heads)))
      do c = 1, size(record%channel)
         call view_channel(record, c, view)
         row%csv = row%csv//csv_start(row, warnings)//","//count_text(sample_count(record))//","// &
            & csv_number(1.0_dp/record%sample_interval, record%rate_known)//","// &
            & csv_number(real(sample_count(record), dp)*record%sample_interval, record%rate_known)//","// &
            & quoted(record%channel(c)%text)//","//quoted(unit_name(view))
         if (present(result)) then
            row%csv = row%csv//csv_channel(result%channel(c), .true.)
            call fill_cells(command, record, c, size(warnings), row%cell, result%channel(c))
         else
            row%csv = row%csv//csv_channel(nothing, .false.)
            call fill_cells(command, record, c, size(warnings), row%cell, nothing)
         end if
         row%cell(c, 1)%text = path
         row%csv = row%csv//new_line("a")
      end do
   end subroutine make_row

   !> The row of a file that failed.
   subroutine make_failed_row(command, path, folder, code, message, row)
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
      type(channel_result_type) :: nothing
      type(text_type), allocatable :: heads(:), none(:)
      integer :: i

      row%path = path
      row%folder = folder
      row%code = code
      row%message = message
      allocate (none(0))
      row%csv = csv_start(row, none)//",nan,nan,nan,,"//csv_channel(nothing, .false.)//new_line("a")
      call column_heads(command, heads)
      allocate (row%cell(1, size(heads)))
      do i = 1, size(heads)
         row%cell(1, i)%text = ""
      end do
      row%cell(1, 1)%text = path
      row%cell(1, 2)%text = "failed"
   end subroutine make_failed_row

   !> The first line of a text.
   pure function first_line(text) result(line)
      character(*), intent(in) :: text
      character(:), allocatable :: line

      line = text(:index(text//new_line("a"), new_line("a")) - 1)
   end function first_line

   !> The head line of summary.csv.
   function csv_head() result(line)
      character(:), allocatable :: line
      integer :: term

      line = "path,folder,exit_code,warnings,message,samples,rate_hz,duration_s,channel,unit,mean,std,outliers_removed"
      do term = 1, 5
         line = line//","//term_names(term)//","//term_names(term)//"_std_error,"//term_names(term)//"_upper_limit_95,"// &
            & term_names(term)//"_detected,"//term_names(term)//"_unit"
      end do
      line = line//",adf_p_value,jarque_bera_p_value,ljung_box_p_value,ar_order,ar_noise_variance,cleaned_variance,kf_variance,"// &
         & "akf_variance,drift_kf_variance,drift_akf_variance,akf_dc_gain,drift"
   end function csv_head

   !> What all lines of a file begin with: the message is the error, or else the first warning.
   function csv_start(row, warnings) result(line)
      type(summary_row_type), intent(in) :: row
      type(text_type), intent(in) :: warnings(:)
      character(:), allocatable :: line

      line = quoted(row%path)//","//quoted(row%folder)//","//count_text(int(row%code, int64))//","// &
         & count_text(size(warnings, kind=int64))//","
      if (row%code == 0 .and. size(warnings) > 0) then
         line = line//quoted(first_line(warnings(1)%text))
      else
         line = line//quoted(first_line(row%message))
      end if
   end function csv_start

   !> The columns of a channel's result, each with a comma in front.
   function csv_channel(channel, there) result(line)
      type(channel_result_type), intent(in) :: channel
      !> False where nothing was computed
      logical, intent(in) :: there
      character(:), allocatable :: line
      integer :: term

      line = ","//csv_number(channel%raw%mean, there)//","//csv_number(channel%raw%std, there)
      if (channel%available%preprocess) then
         line = line//","//count_text(channel%clean%removed)
      else
         line = line//",nan"
      end if
      do term = 1, 5
         line = line//csv_coefficient(channel%allan(stage%input)%stated%term(term))
      end do
      line = line//","//csv_number(channel%adf%p_value, channel%available%adf)//","// &
         & csv_number(channel%jarque_bera%p_value, channel%available%jarque_bera)//","// &
         & csv_number(channel%ljung_box%p_value, channel%available%ljung_box)
      if (channel%available%ar) then
         line = line//","//count_text(int(channel%ar%order, int64))
      else
         line = line//",nan"
      end if
      line = line//","//csv_number(channel%ar%noise_variance, channel%available%ar)//","// &
         & csv_number(channel%cleaned%variance, there)//","//csv_number(channel%kf%variance, channel%available%kf)//","// &
         & csv_number(channel%akf%variance, channel%available%akf)//","// &
         & csv_number(channel%drift_kf%variance, channel%available%drift_kf)//","// &
         & csv_number(channel%drift_akf%variance, channel%available%drift_akf)//","// &
         & csv_number(channel%akf%dc_gain, channel%available%akf)//","//quoted(drift_of(channel))
   end function csv_channel

   !> The five columns of a coefficient, each with a comma in front.
   function csv_coefficient(stated) result(line)
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: line

      if (.not. stated%fitted) then
         line = ",nan,nan,nan,,"
         return
      end if
      line = ","//csv_number(stated%value, .true.)//","//csv_number(stated%std_error, .true.)//","// &
         & csv_number(stated%upper_limit, .true.)//","//trim(merge("true ", "false", stated%detected))//","//quoted(stated%unit)
   end function csv_coefficient

   !> A number, nan where it is not known.
   pure function csv_number(value, known) result(text)
      real(dp), intent(in) :: value
      logical, intent(in) :: known
      character(:), allocatable :: text

      text = "nan"
      if (known) text = format_real(value, csv_digits)
   end function csv_number

   !> The verdict on drift as results.json has it, "" where there is none.
   pure function drift_of(channel) result(drift)
      !> Any
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: drift

      drift = ""
      if (channel%verdict%wanted) drift = trim(channel%verdict%drift)
   end function drift_of

   !> Unit of a channel, "" where it is not known.
   pure function unit_name(view) result(name)
      type(record_type), intent(in) :: view
      character(:), allocatable :: name

      name = ""
      if (allocated(view%unit%name)) name = view%unit%name
   end function unit_name

   !> Heads of the table: file and channel to the left, warnings last.
   subroutine column_heads(command, heads)
      !> run, inspect, allan, tests, ar, filter
      character(*), intent(in) :: command
      !> [at least 4]
      type(text_type), allocatable, intent(out) :: heads(:)
      character(12), allocatable :: middle(:)
      integer :: i

      select case (command)
      case ("inspect"); middle = [character(12) :: "rate Hz", "unit", "missing", "gaps"]
      case ("tests"); middle = [character(12) :: "ADF p", "Jarque-Bera", "Ljung-Box"]
      case ("ar"); middle = [character(12) :: "order", "noise var.", "phi 1"]
      case ("filter"); middle = [character(12) :: "variance", "KF", "AKF", "AKF passes"]
      case default; middle = [character(12) :: "N", "B", "K", "noise"]
      end select
      allocate (heads(size(middle) + 4))
      heads(1)%text = "file"
      heads(2)%text = "channel"
      heads(3)%text = "samples"
      do i = 1, size(middle)
         heads(3 + i)%text = trim(middle(i))
      end do
      heads(size(heads))%text = "warnings"
   end subroutine column_heads

   !> One row of the table but for the file's name.
   subroutine fill_cells(command, record, c, warnings, cell, channel)
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      !> Number of the channel
      integer, intent(in) :: c
      !> How many there are
      integer, intent(in) :: warnings
      !> Of all channels
      type(text_type), intent(inout) :: cell(:, :)
      type(channel_result_type), intent(in) :: channel
      type(record_type) :: view
      integer :: last

      last = size(cell, 2)
      cell(c, 2)%text = record%channel(c)%text
      cell(c, 3)%text = count_text(sample_count(record))
      cell(c, last)%text = count_text(int(warnings, int64))
      select case (command)
      case ("inspect")
         call view_channel(record, c, view)
         cell(c, 4)%text = table_number(1.0_dp/record%sample_interval, record%rate_known)
         cell(c, 5)%text = unit_name(view)
         cell(c, 6)%text = count_text(record%audit%missing)
         cell(c, 7)%text = count_text(record%audit%gaps)
      case ("tests")
         cell(c, 4)%text = table_number(channel%adf%p_value, channel%available%adf)
         cell(c, 5)%text = table_number(channel%jarque_bera%p_value, channel%available%jarque_bera)
         cell(c, 6)%text = table_number(channel%ljung_box%p_value, channel%available%ljung_box)
      case ("ar")
         cell(c, 4)%text = table_number(real(channel%ar%order, dp), channel%available%ar)
         cell(c, 5)%text = table_number(channel%ar%noise_variance, channel%available%ar)
         cell(c, 6)%text = "-"
         if (channel%available%ar .and. channel%ar%order > 0) cell(c, 6)%text = number(channel%ar%coefficient(1), table_digits)
      case ("filter")
         cell(c, 4)%text = table_number(channel%cleaned%variance, .true.)
         cell(c, 5)%text = table_number(channel%kf%variance, channel%available%kf)
         cell(c, 6)%text = table_number(channel%akf%variance, channel%available%akf)
         cell(c, 7)%text = table_number(channel%akf%dc_gain, channel%available%akf)
      case default
         cell(c, 4)%text = table_coefficient(channel%allan(stage%input)%stated%term(2))
         cell(c, 5)%text = table_coefficient(channel%allan(stage%input)%stated%term(3))
         cell(c, 6)%text = table_coefficient(channel%allan(stage%input)%stated%term(4))
         cell(c, 7)%text = "-"
         if (channel%verdict%known) cell(c, 7)%text = trim(verdict_text(channel))
      end select
   end subroutine fill_cells

   !> "0.3005 deg/sqrt(h)", "< 8.6 deg/h^1.5", "-".
   function table_coefficient(stated) result(text)
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: text

      text = "-"
      if (.not. stated%fitted) return
      if (stated%detected) then
         text = number(stated%value, table_digits)//" "//stated%unit
      else
         text = "< "//number(stated%upper_limit, 3)//" "//stated%unit
      end if
   end function table_coefficient

   !> A number of the table, "-" where it is not known.
   pure function table_number(value, known) result(text)
      real(dp), intent(in) :: value
      logical, intent(in) :: known
      character(:), allocatable :: text

      text = "-"
      if (known) text = number(value, table_digits)
   end function table_number

end module gyroakf_report_summary_row
