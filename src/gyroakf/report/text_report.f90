! SPDX-License-Identifier: MIT
!> The reports of a terminal, at most 80 columns wide: the first screen, and all details. They print numbers of the result and
!> compute nothing.
module gyroakf_report_text_report
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_io_writer, only : writer_type
   use gyroakf_release, only : release_string
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type, &
      stage, stated_coefficient_type
   use gyroakf_pipeline_warnings, only : outlier_share
   use gyroakf_report_advice, only : put_advice, put_warnings
   use gyroakf_report_document_filters, only : put_drift, put_filters
   use gyroakf_report_document_allan, only : put_halves, put_noise
   use gyroakf_report_document_tests, only : put_ar, put_tests, put_verdict
   use gyroakf_report_document_distribution, only : put_preprocess
   use gyroakf_report_input, only : put_input, report_inspect, unit_name
   use gyroakf_report_tables, only : make_ar_table
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_text_description, only : text_description_type
   use gyroakf_report_text_filters, only : put_filter_table
   use gyroakf_report_text_layout, only : count_text, number, percent, plural, put_heading, put_item, &
      put_paragraph, put_title
   use gyroakf_report_text_noise, only : make_comparison, put_curves_of
   use gyroakf_report_text_screen, only : put_chart, put_screen
   use gyroakf_report_text_table, only : put_numbered, table_type
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
      if (drawn) call put_chart(writer, record, result)
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call put_channel(writer, command, view, result%channel(c))
      end do
   end subroutine write_report

   !> One channel: its sections, and what to make of them.
   subroutine put_channel(writer, command, record, channel)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel

      call put_heading(writer, "Channel "//channel%name, "=", verbatim=.true.)
      call put_sections(writer, command, record, channel)
      if (command == "run") call put_advice(writer, record, channel)
      call put_warnings(writer, channel)
   end subroutine put_channel

   !> The sections of a command, for one channel; those of `run` are in the order of the paper's results.
   subroutine put_sections(writer, command, record, channel)
      !> The report
      type(writer_type), intent(inout), target :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      !> For units and what is assumed
      type(record_type), intent(in) :: record
      !> What came out
      type(channel_result_type), intent(in) :: channel
      type(text_description_type) :: out
      type(table_type) :: table
      character(:), allocatable :: title
      logical :: all

      call out%attach(writer)
      all = command == "run"
      if (all) out%skip = [character(8) :: "adf", "kpss"]       ! of a long record they reject a unit root for any sensor
      call put_alerts(writer, channel)
      call put_paragraph(writer, "Values are in "//unit_name(record)//" and variances in ("//unit_name(record)// &
                         ")^2 where no unit stands beside them.", 2)
      call put_verdict(out, record, channel)
      call put_preprocess(out, channel)
      if (all .or. command == "tests") call put_tests(out, channel)
      if (channel%available%ar) then
         call make_ar_table(record, channel, table)
         call put_numbered(writer, table)
         call put_ar(out, channel)
      end if
      if (all .or. command == "filter") then
         call put_filter_table(writer, record, channel)
         call put_filters(out, channel)
         call put_drift(out, channel)
      end if
      if (.not. (all .or. command == "allan")) return
      call make_comparison(record, channel, table)
      if (.not. all) table%number = ""
      call put_numbered(writer, table)
      call put_noise(out, "input", "Noise coefficients: Raw", channel%allan(stage%input))
      call put_halves(out, channel)
      if (all) return
      call put_curves_of(writer, record, channel%allan(stage%input), "Raw", "input")
      if (.not. channel%available%cleaned) return
      title = trim(merge("Without outliers", "Cleaned         ", channel%clean%trend%degree < 0))
      call put_noise(out, "cleaned", "Noise coefficients: "//title, channel%allan(stage%cleaned))
      call put_curves_of(writer, record, channel%allan(stage%cleaned), title, "cleaned")
   end subroutine put_sections

   !> The first lines of a channel, where more than 1 % of its samples are outliers or the sensor moves.
   subroutine put_alerts(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (raw => channel%allan(stage%input)%stated%term(2), cleaned => channel%allan(stage%outliers_removed)%stated%term(2))
         if (channel%clean%fraction > outlier_share) then
            text = percent(channel%clean%fraction)//" of the samples are rejected as outliers"
            if (raw%detected .or. cleaned%detected) text = text//": N = "//stated(raw)//" of the raw record, "//stated(cleaned)// &
               & " without them"
            call put_item(writer, "Outliers", text)
         end if
      end associate
      if (.not. allocated(channel%clean%motion)) return
      if (size(channel%clean%motion) > 0) call put_item(writer, "Motion", "motion or vibration in "// &
         & plural(size(channel%clean%motion, 2, kind=int64), "place")//", of samples "// &
         & count_text(channel%clean%motion(1, 1))//" to "//count_text(channel%clean%motion(2, 1))//" first: nothing is "// &
         & "rejected there, see the warnings")
   end subroutine put_alerts

   !> "0.9687 deg/sqrt(h)".
   pure function stated(term) result(text)
      type(stated_coefficient_type), intent(in) :: term
      character(:), allocatable :: text

      text = "(not stated)"
      if (term%detected) text = number(term%value, 4)//" "//term%unit
   end function stated

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
