! SPDX-License-Identifier: MIT
!> What a summary of many files says of one of them: described once, for summary.csv and
!> summary.json; the cells of the table; and the CSV renderer of a description: its members in a
!> line, of a list how many values it has.
module gyroakf_report_summary_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, view_channel
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : format_real
   use gyroakf_pipeline_result, only : channel_result_type, stage, stated_coefficient_type
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_description, only : description_type, unknown_type
   use gyroakf_report_input, only : has_unit, unit_name
   use gyroakf_report_text_layout, only : count_text, if_known, number
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, table_type
   use gyroakf_report_verdicts, only : verdict_text
   implicit none (type, external)
   private
   public :: csv_row_type, put_record, put_channel, add_channel_row

   !> Every member takes a column, known or not, which its title names, or else its key
   type, extends(description_type) :: csv_row_type
      !> Names and values
      character(:), allocatable :: head, line
   contains
      procedure :: begin
      procedure :: close => close_group
      procedure :: value => put_value
      procedure :: values => put_values
   end type csv_row_type

   !> Digits of a number in the table
   integer, parameter :: table_digits = 4

contains

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

   !> "" of a record that was not read.
   pure function channel_name(record, c) result(name)
      type(record_type), intent(in) :: record
      integer, intent(in) :: c
      character(:), allocatable :: name

      name = ""
      if (allocated(record%channel)) name = record%channel(c)%text
   end function channel_name

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
            call add("DC gain", known(is%akf, channel%akf%dc_gain))
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

   !> A line has no groups.
   subroutine begin(self, key, list)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      logical, intent(in) :: list

      self%complete = self%complete .or. key == "" .or. list
   end subroutine begin

   subroutine close_group(self)
      class(csv_row_type), intent(inout) :: self

      self%complete = .true.
   end subroutine close_group

   subroutine put_value(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value
      character(:), allocatable :: text, name

      if (.not. self%member%shown) return
      text = ""
      select type (value)
      type is (real(dp)); text = format_real(value, 15)
      type is (integer); text = count_text(int(value, int64))
      type is (integer(int64)); text = count_text(value)
      type is (logical); text = trim(merge("true ", "false", value))
      type is (character(*)); text = quoted(value)
      type is (unknown_type); if (value%number) text = "nan"
      end select
      name = key
      if (allocated(self%member%title)) name = self%member%title
      if (allocated(self%line)) then
         name = self%head//","//name
         text = self%line//","//text
      end if
      call move_alloc(name, self%head)
      call move_alloc(text, self%line)
   end subroutine put_value

   !> Of a list, how many values it has.
   subroutine put_values(self, key, value)
      class(csv_row_type), intent(inout) :: self
      character(*), intent(in) :: key
      class(*), intent(in) :: value(:)

      call put_value(self, key, size(value))
   end subroutine put_values

end module gyroakf_report_summary_row
