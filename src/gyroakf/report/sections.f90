! SPDX-License-Identifier: MIT
!> Part of a report on one channel: the tests with their verdict in words.
module gyroakf_report_sections
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_series_whiteness, only : ljung_box_type
   use gyroakf_report_layout, only : put_heading, put_item, number, count_text, p_value_text, plural
   use gyroakf_report_normality, only : put_normality
   use gyroakf_report_adf_table, only : put_adf_details
   implicit none (type, external)
   private
   public :: put_tests, whiteness_text

   !> A test decides at this level
   real(dp), parameter :: level = 0.05_dp

contains

   !> Stationarity, normality, whiteness.
   subroutine put_tests(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      if (channel%available%preprocess) then
         call put_heading(writer, "Tests of the cleaned series")
      else
         call put_heading(writer, "Tests")
      end if
      call put_stationarity(writer, channel)
      if (channel%available%adf) call put_adf_details(writer, channel%adf)
      call put_normality(writer, channel)
      if (.not. channel%available%ljung_box) then
         call put_item(writer, "Whiteness", "not tested (see below)")
      else if (channel%ljung_box%p_value < level) then
         call put_item(writer, "Whiteness", "not white: "//whiteness_text(channel%ljung_box)// &
                       "; there is correlation for a model to describe")
      else
         call put_item(writer, "Whiteness", "no correlation is found: "//whiteness_text(channel%ljung_box)// &
                       "; a model has nothing to describe")
      end if
   end subroutine put_tests

   !> The ADF test. Its null hypothesis is a unit root: rejecting it means stationary.
   subroutine put_stationarity(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      if (.not. channel%available%adf) then
         call put_item(writer, "Stationarity", "not tested (see below)")
         return
      end if
      if (channel%adf%stationary) then
         text = "stationary: the unit root is rejected, "
      else
         text = "no evidence of stationarity: the unit root is not rejected, "
      end if
      text = text//"ADF "//number(channel%adf%statistic, 5)//" against "//number(channel%adf%critical(2), 4)//" at 5 % ("// &
             number(channel%adf%critical(1), 4)//" at 1 %, "//number(channel%adf%critical(3), 4)//" at 10 %), "// &
             p_value_text(channel%adf%p_value)//"; "//regression_name(channel%adf%regression)//", "// &
             plural(int(channel%adf%lag, int64), "lag")//", "//count_text(channel%adf%observations)//" observations"
      call put_item(writer, "Stationarity", text)
   end subroutine put_stationarity

   !> "Ljung-Box 2030 over 20 lags, p < 1e-20, largest |rho| 0.41".
   pure function whiteness_text(ljung_box) result(text)
      !> The test
      type(ljung_box_type), intent(in) :: ljung_box
      character(:), allocatable :: text

      text = "Ljung-Box "//number(ljung_box%statistic, 4)//" over "//plural(int(ljung_box%lags, int64), "lag")//", "// &
             p_value_text(ljung_box%p_value)//", largest |rho| "//number(ljung_box%largest_rho, 3)
   end function whiteness_text

   pure function regression_name(regression) result(name)
      character(*), intent(in) :: regression
      character(:), allocatable :: name

      select case (regression)
      case ("n"); name = "without a constant"
      case ("c"); name = "with a constant"
      case ("ct"); name = "with a constant and a line"
      case default; name = "with a constant, a line and a parabola"
      end select
   end function regression_name

end module gyroakf_report_sections
