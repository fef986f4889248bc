! SPDX-License-Identifier: MIT
!> The reports of a terminal, at most 80 columns wide: the first screen, and all details. They print
!> numbers of the result and compute nothing.
module gyroakf_report_text_report
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_release, only : release_string
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, pipeline_options, &
      pipeline_result_type, stage
   use gyroakf_report_document_filters, only : put_drift, put_filters
   use gyroakf_report_document_allan, only : put_halves, put_noise
   use gyroakf_report_document_tests, only : put_ar, put_tests, put_verdict
   use gyroakf_report_document_distribution, only : put_preprocess
   use gyroakf_report_input, only : put_input, report_inspect, time_unit, unit_name
   use gyroakf_report_remarks, only : put_remarks
   use gyroakf_report_tables, only : make_ar_table, make_comparison, make_filter_table
   use gyroakf_report_text_answer, only : put_answer
   use gyroakf_report_chart, only : put_chart
   use gyroakf_report_text_description, only : text_description_type
   use gyroakf_report_text_layout, only : count_text, if_known, number, put_heading, put_item, &
      put_paragraph, put_title
   use gyroakf_report_text_overview, only : put_overview
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, put_numbered, put_table, &
      table_type
   implicit none (type, external)
   private
   public :: write_report, report_inspect, put_sections, put_curves_of, report_subject

   !> Notes on the first screen
   integer, parameter :: most_notes = 3

contains

   !> The report of a command: what was read, the answer, a chart, what can make a number wrong, and
   !> then each channel.
   subroutine write_report(writer, command, record, options, result, chart, details)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(in) :: result
      !> Draw the Allan deviations in characters (default: yes)
      logical, intent(in), optional :: chart
      !> Everything (default); false: the first screen
      logical, intent(in), optional :: details
      type(record_type) :: view
      logical :: drawn, all
      integer :: c

      drawn = .true.
      if (present(chart)) drawn = chart
      all = .true.
      if (present(details)) all = details
      if (all) call put_title(writer, "gyroakf "//release_string//": "//report_subject(command)// &
                              if_known(options%preset /= "default", " (preset "// &
                                       trim(options%preset)//")"))
      if (.not. all) call put_input(writer, record, brief=.true.)
      if (command == "run" .or. command == "allan") call put_answer(writer, record, result)
      if (command /= "allan" .and. .not. all) call put_overview(writer, command, record, result)
      if (drawn) call put_chart(writer, record, result)
      call put_line(writer, "")
      if (.not. all) then
         call put_remarks(writer, command, record, result, most_notes)
         call put_item(writer, "More", "--details; --out DIR (page, figures, CSV); --json FILE")
         return
      end if
      call put_remarks(writer, command, record, result)
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call view_channel(record, c, view)
         call put_heading(writer, "Channel "//result%channel(c)%name, "=", verbatim=.true.)
         call put_sections(writer, command, view, result%channel(c))
      end do
   end subroutine write_report

   !> The sections of a command, for one channel; those of `run` are in the order of the paper's
   !> results.
   subroutine put_sections(writer, command, record, channel)
      type(writer_type), intent(inout), target :: writer
      !> run, allan, tests, ar or filter
      character(*), intent(in) :: command
      !> For units and what is assumed
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      type(text_description_type) :: out
      type(table_type) :: table
      character(:), allocatable :: title
      logical :: all

      call out%attach(writer)
      out%time_unit = time_unit(record)
      all = command == "run"
      ! of a long record they reject a unit root for any sensor
      if (all) out%skip = [character(8) :: "adf", "kpss"]
      call put_paragraph(writer, "Values are in "//unit_name(record)//" and variances in ("// &
                         unit_name(record)//")^2 where no unit stands beside them.")
      call put_verdict(out, record, channel)
      call put_preprocess(out, channel)
      if (all .or. command == "tests") call put_tests(out, channel)
      if (channel%available%ar) then
         call make_ar_table(record, channel, table)
         call put_numbered(writer, table)
         call put_ar(out, channel)
         if (all .and. channel%ar%order > 0) call put_paragraph(writer, "The model predicts "// &
            number(channel%predictable_percent, 3)//" % of the variance one sample ahead: the "// &
            "largest reduction such a model can honestly give. A larger one is smoothing, "// &
            "which acts on a rotation alike.")
      end if
      if (all .or. command == "filter") then
         call make_filter_table(record, channel, table)
         call put_numbered(writer, table)
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
      call put_curves_of(writer, record, channel%allan(stage%input), "Raw")
      if (.not. channel%available%cleaned) return
      title = if_known(channel%clean%trend%degree < 0, "Without outliers", "Cleaned")
      call put_noise(out, "cleaned", "Noise coefficients: "//title, channel%allan(stage%cleaned))
      call put_curves_of(writer, record, channel%allan(stage%cleaned), title)
   end subroutine put_sections

   !> The deviation curves with their confidence limits, and the fitted model beside the first.
   subroutine put_curves_of(writer, record, allan, title)
      type(writer_type), intent(inout) :: writer
      !> For the units
      type(record_type), intent(in) :: record
      !> Curve, and the fit where there is one
      type(allan_result_type), intent(in) :: allan
      !> Which series
      character(*), intent(in) :: title
      integer :: i

      if (.not. allan%available) return
      call put_curve(allan%curve, allan%fitted)
      if (.not. allocated(allan%other)) return
      do i = 1, size(allan%other)
         if (allocated(allan%other(i)%tau)) call put_curve(allan%other(i), .false.)
      end do

   contains

      subroutine put_curve(curve, fitted)
         type(allan_curve_type), intent(in) :: curve
         !> The model is shown
         logical, intent(in) :: fitted
         type(table_type) :: table
         integer :: i

         call put_heading(writer, title//": "//trim(curve%kind)//" in "//unit_name(record)// &
                          if_known(curve%kind == "tdev", " times tau")//", tau in "// &
                          time_unit(record)//", "//number(100*curve%confidence, 4)//" % limits")
         call new_table(table, merge(7, 6, fitted), left=0)
         call add_row(table, "tau", "deviation", "lower", "upper", "edf", "terms")
         if (fitted) call add_cell(table, "model")
         do i = 1, size(curve%tau)
            call add_row(table, number(curve%tau(i), 6), number(curve%deviation(i), 6), &
                         number(curve%lower(i), 4), number(curve%upper(i), 4), &
                         number(curve%edf(i), 4), count_text(curve%terms(i)))
            if (fitted) call add_cell(table, if_known(allan%noise%model(i) > 0.0_dp, &
                                                      number(allan%noise%model(i), 4), "-"))
         end do
         call put_table(writer, table)
      end subroutine put_curve

   end subroutine put_curves_of

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

end module gyroakf_report_text_report
