! SPDX-License-Identifier: MIT
!> Part of a report on one channel: the tests with their verdict in words.
module gyroakf_report_sections
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_layout, only : put_heading, put_item
   use gyroakf_report_text_normality, only : put_normality
   use gyroakf_report_text_adf_table, only : put_adf_details
   use gyroakf_report_stationarity, only : put_stationarity, put_whiteness
   implicit none (type, external)
   private
   public :: put_tests

contains

   !> Stationarity, normality, whiteness.
   subroutine put_tests(writer, command, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> "tests" has the unit-root tests of all samples too; on a long record they reject a unit root for any sensor
      character(*), intent(in) :: command
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      call put_heading(writer, "Tests of the "//trim(channel%tested))
      if (command == "tests") then
         call put_stationarity(writer, channel)
         if (channel%available%adf) call put_adf_details(writer, channel%adf)
      end if
      if (channel%tested == "cleaned series") then
         text = "critical values and p-values of tests of a unit root do not hold"
         if (channel%clean%trend%degree == 3) text = text// &
            ": of random walks without their cubic about half are called stationary at 5 %"
         call put_item(writer, "Trend removed", text)
      end if
      call put_normality(writer, channel)
      call put_whiteness(writer, channel)
   end subroutine put_tests

end module gyroakf_report_sections
