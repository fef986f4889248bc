! SPDX-License-Identifier: MIT
!> The reports of a terminal, at most 80 columns wide: the first screen, and all details. They print numbers of the result and
!> compute nothing.
module gyroakf_report_text_report
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_release, only : release_string
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type, channel_result_type, stage
   use gyroakf_report_text_layout, only : put_title, put_heading, put_item
   use gyroakf_report_input, only : put_input, report_inspect
   use gyroakf_report_removed, only : put_alerts, put_removed
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_text_screen, only : put_screen
   use gyroakf_report_sections, only : put_tests
   use gyroakf_report_models, only : put_ar_table
   use gyroakf_report_text_drift, only : put_drift_model
   use gyroakf_report_text_filters, only : put_filter_table, put_filter_details, put_rmse
   use gyroakf_report_text_noise, only : put_chart, put_curves_of, put_coefficients, put_comparison
   use gyroakf_report_text_changes, only : put_changes
   use gyroakf_report_text_periodicity, only : put_periodicity
   use gyroakf_report_verdicts, only : put_verdict
   use gyroakf_report_advice, only : put_advice, put_warnings
   implicit none (type, external)
   private
   public :: write_report, report_inspect, put_sections, report_subject

contains

   !> The report of a command: what was read, then each channel.
   subroutine write_report(writer, command, record, options, result, chart, details)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      !> Draw the Allan deviations in characters (default: yes)
      logical, intent(in), optional :: chart
      !> Everything (default); false: the first screen
      logical, intent(in), optional :: details
      type(record_type) :: view
      logical :: drawn
      integer :: c

      drawn = .true.
      if (present(chart)) drawn = chart
      if (present(details)) then
         if (.not. details) then
            call put_screen(writer, command, record, result, drawn)
            return
         end if
      end if
      call put_title(writer, "gyroakf "//release_string//": "//report_subject(command)//preset_name(options))
      if (command == "run" .or. command == "allan") call put_answer(writer, record, result)
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call put_channel(writer, command, view, result%channel(c), drawn)
      end do
   end subroutine write_report

   !> One channel: its sections, and what to make of them.
   subroutine put_channel(writer, command, record, channel, chart)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      !> Draw the deviation
      logical, intent(in) :: chart

      call put_heading(writer, "Channel "//channel%name, "=", verbatim=.true.)
      call put_sections(writer, command, record, channel, chart)
      if (command == "run") call put_advice(writer, record, channel)
      call put_warnings(writer, channel)
   end subroutine put_channel

   !> The sections of a command, for one channel; those of `run` are in the order of the paper's results.
   subroutine put_sections(writer, command, record, channel, chart)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      !> For units and what is assumed
      type(record_type), intent(in) :: record
      !> What came out
      type(channel_result_type), intent(in) :: channel
      !> Draw the deviation in characters
      logical, intent(in) :: chart

      call put_verdict(writer, channel)
      call put_alerts(writer, channel)
      if (channel%available%preprocess .or. command == "run") call put_removed(writer, record, channel)
      select case (command)
      case ("allan")
         call put_curves(writer, record, channel, chart)
         call put_changes(writer, record, channel)
      case ("tests")
         call put_tests(writer, command, channel)
         call put_periodicity(writer, channel)
      case ("ar")
         call put_ar_table(writer, record, channel)
      case ("filter")
         call put_ar_table(writer, record, channel)
         call put_filter_table(writer, record, channel)
         call put_filter_details(writer, channel)
         call put_rmse(writer, record, channel)
         call put_drift_model(writer, record, channel)
      case default
         call put_tests(writer, command, channel)
         call put_periodicity(writer, channel)
         call put_ar_table(writer, record, channel)
         call put_filter_table(writer, record, channel)
         call put_filter_details(writer, channel)
         call put_rmse(writer, record, channel)
         call put_drift_model(writer, record, channel)
         if (chart) call put_chart(writer, record, channel%allan(stage%input), "As read")
         call put_comparison(writer, record, channel)
         call put_changes(writer, record, channel)
      end select
   end subroutine put_sections

   !> Deviation curves and coefficients, as read and, where something was removed, cleaned.
   subroutine put_curves(writer, record, channel, chart)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      logical, intent(in) :: chart
      character(:), allocatable :: title

      if (chart) call put_chart(writer, record, channel%allan(stage%input), "As read")
      call put_curves_of(writer, record, channel%allan(stage%input), "As read", "input")
      call put_coefficients(writer, record, channel%allan(stage%input), "input")
      if (channel%available%cleaned) then
         title = "Cleaned"
         if (channel%clean%trend%degree < 0) title = "Without outliers"
         if (chart) call put_chart(writer, record, channel%allan(stage%cleaned), title)
         call put_curves_of(writer, record, channel%allan(stage%cleaned), title, "cleaned")
         call put_coefficients(writer, record, channel%allan(stage%cleaned), "cleaned")
      end if
   end subroutine put_curves

   !> What the report of a command is about.
   pure function report_subject(command) result(text)
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      character(:), allocatable :: text

      select case (command)
      case ("allan"); text = "Allan deviation"
      case ("tests"); text = "tests"
      case ("ar"); text = "AR models"
      case ("filter"); text = "filters"
      case default; text = "random errors of a gyroscope record"
      end select
   end function report_subject

   !> Says so where the paper's chain was asked for.
   pure function preset_name(options) result(text)
      type(pipeline_options), intent(in) :: options
      character(:), allocatable :: text

      text = ""
      if (options%preset /= "default") text = " (preset "//trim(options%preset)//")"
   end function preset_name

end module gyroakf_report_text_report
