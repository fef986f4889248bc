! SPDX-License-Identifier: MIT
!> What a summary of many files says of one of them: described once, for summary.csv and
!> summary.json; and the CSV renderer of a description: its members in a line, of a list how many
!> values it has.
module gyroakf_report_summary_row
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, sample_count, view_channel
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : format_real
   use gyroakf_pipeline_result, only : channel_result_type, stage
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_description, only : description_type, unknown_type
   use gyroakf_report_input, only : has_unit
   use gyroakf_report_text_layout, only : count_text
   implicit none (type, external)
   private
   public :: csv_row_type, put_record, put_channel

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
      call out%open("")
      if (allocated(record%channel)) then
         call view_channel(record, c, view)
         call out%put("name", record%channel(c)%text, title="channel")
      else
         call out%put("name", "", title="channel")
      end if
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
