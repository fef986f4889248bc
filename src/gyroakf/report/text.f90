! SPDX-License-Identifier: MIT
!> The terminal reports, at most 100 columns wide; they print numbers of the result and compute nothing.
module gyroakf_report_text
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type, channel_result_type, stage
   use gyroakf_report_layout, only : put_heading
   use gyroakf_report_input, only : put_title, put_input, report_inspect
   use gyroakf_report_sections, only : put_removed, put_tests
   use gyroakf_report_models, only : put_ar_table, put_filter_table, put_filter_details
   use gyroakf_report_noise, only : put_curve, put_coefficients, put_comparison
   use gyroakf_report_advice, only : put_advice, put_warnings
   implicit none (type, external)
   private
   public :: write_report, report_run, report_inspect, report_allan, report_tests, report_ar, report_filter

contains

   !> The report of a command.
   subroutine write_report(writer, command, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> allan, tests, ar, filter; anything else is run
      character(*), intent(in) :: command
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result

      select case (command)
      case ("allan"); call report_allan(writer, record, options, result)
      case ("tests"); call report_tests(writer, record, options, result)
      case ("ar"); call report_ar(writer, record, options, result)
      case ("filter"); call report_filter(writer, record, options, result)
      case default; call report_run(writer, record, options, result)
      end select
   end subroutine write_report

   !> The report of the whole job, in the order of the paper's results.
   subroutine report_run(writer, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_title(writer, "random errors of a gyroscope record"//preset_name(options))
      call put_input(writer, record)
      do c = 1, size(result%channel)
         associate (channel => result%channel(c))
            call put_channel_name(writer, channel)
            call put_removed(writer, record, channel)
            call put_tests(writer, channel)
            call put_ar_table(writer, channel)
            call put_filter_table(writer, channel)
            call put_filter_details(writer, channel)
            call put_comparison(writer, record, channel)
            call put_advice(writer, record, channel)
         end associate
      end do
   end subroutine report_run

   !> Deviation curves and coefficients.
   subroutine report_allan(writer, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_title(writer, "Allan deviation")
      call put_input(writer, record)
      do c = 1, size(result%channel)
         associate (channel => result%channel(c))
            call put_channel_name(writer, channel)
            if (channel%available%preprocess) call put_removed(writer, record, channel)
            call put_curve(writer, record, channel%allan(stage%input), "As read")
            call put_coefficients(writer, record, channel%allan(stage%input))
            if (channel%available%preprocess .and. options%clean%degree >= 0) then
               call put_curve(writer, record, channel%allan(stage%cleaned), "Cleaned")
               call put_coefficients(writer, record, channel%allan(stage%cleaned))
            end if
            call put_warnings(writer, channel)
         end associate
      end do
   end subroutine report_allan

   !> The tests with their verdicts.
   subroutine report_tests(writer, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_title(writer, "tests"//preset_name(options))
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call put_channel_name(writer, result%channel(c))
         if (result%channel(c)%available%preprocess) call put_removed(writer, record, result%channel(c))
         call put_tests(writer, result%channel(c))
         call put_warnings(writer, result%channel(c))
      end do
   end subroutine report_tests

   !> Orders, criteria and the model that was chosen.
   subroutine report_ar(writer, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_title(writer, "AR models"//preset_name(options))
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call put_channel_name(writer, result%channel(c))
         if (result%channel(c)%available%preprocess) call put_removed(writer, record, result%channel(c))
         call put_ar_table(writer, result%channel(c))
         call put_warnings(writer, result%channel(c))
      end do
   end subroutine report_ar

   !> The filters and their figures.
   subroutine report_filter(writer, record, options, result)
      !> Open; "-" is standard output
      type(writer_type), intent(inout) :: writer
      !> What was read
      type(record_type), intent(in) :: record
      !> What was asked for
      type(pipeline_options), intent(in) :: options
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_title(writer, "filters"//preset_name(options))
      call put_input(writer, record)
      do c = 1, size(result%channel)
         call put_channel_name(writer, result%channel(c))
         if (result%channel(c)%available%preprocess) call put_removed(writer, record, result%channel(c))
         call put_ar_table(writer, result%channel(c))
         call put_filter_table(writer, result%channel(c))
         call put_filter_details(writer, result%channel(c))
         call put_warnings(writer, result%channel(c))
      end do
   end subroutine report_filter

   !> The heading of a channel.
   subroutine put_channel_name(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel

      call put_heading(writer, "Channel "//channel%name, "=")
   end subroutine put_channel_name

   !> Says so where the paper's chain was asked for.
   pure function preset_name(options) result(text)
      type(pipeline_options), intent(in) :: options
      character(:), allocatable :: text

      text = ""
      if (options%preset /= "default") text = " (preset "//trim(options%preset)//")"
   end function preset_name

end module gyroakf_report_text
