! SPDX-License-Identifier: MIT
!> Tests of a unit root, of a constant level and of whiteness in a report.
module gyroakf_report_stationarity
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_stats_whiteness, only : ljung_box_type
   use gyroakf_report_text_layout, only : put_item, number, count_text, p_value_text, plural
   implicit none (type, external)
   private
   public :: put_stationarity, put_whiteness, whiteness_text, negligible_rho

   !> A test decides at this level
   real(dp), parameter :: level = 0.05_dp
   !> Autocorrelation that does no harm, however significant it is
   real(dp), parameter :: negligible_rho = 0.05_dp

contains

   !> A line for each test of the samples.
   subroutine put_stationarity(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      if (channel%available%adf) call put_item(writer, "Unit root", adf_text(channel))
      if (channel%available%kpss) call put_item(writer, "Level", kpss_text(channel))
   end subroutine put_stationarity

   !> The ADF test.
   function adf_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = "ADF "//number(channel%adf%statistic, 5)//" against "//number(channel%adf%critical(2), 4)//" at 5 % ("// &
             number(channel%adf%critical(1), 4)//" at 1 %, "//number(channel%adf%critical(3), 4)//" at 10 %), "// &
             p_value_text(channel%adf%p_value)//"; "//regression_name(channel%adf%regression)//", "// &
             plural(int(channel%adf%lag, int64), "lag")//", "//count_text(channel%adf%observations)//" observations"
   end function adf_text

   !> The KPSS test; beyond its table p is stated as a bound, with the asymptotic one beside it.
   function kpss_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      select case (channel%kpss%p_bound)
      case (-1); text = "p < 0.01"
      case (1); text = "p > 0.10"
      case default; text = p_value_text(channel%kpss%p_value)
      end select
      text = "KPSS "//number(channel%kpss%statistic, 4)//" against "//number(channel%kpss%critical(2), 4)//" at 5 % ("// &
             number(channel%kpss%critical(4), 4)//" at 1 %, "//number(channel%kpss%critical(1), 4)//" at 10 %), "//text// &
             " by the table, "//p_value_text(channel%kpss%p_asymptotic)//" asymptotically; about a "// &
             trim(merge("line ", "level", channel%kpss%regression == "ct"))//", bandwidth "//count_text(channel%kpss%lags)
   end function kpss_text

   !> Whiteness by the size of the effect: significance alone would call every long record colored.
   subroutine put_whiteness(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Tests are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%ljung_box) then
         call put_item(writer, "Whiteness", "not tested (see below)")
      else if (.not. channel%ljung_box%p_value < level) then
         call put_item(writer, "Whiteness", "no correlation is found: "//whiteness_text(channel%ljung_box)// &
                       "; a model has nothing to describe")
      else if (channel%ljung_box%largest_rho < negligible_rho) then
         call put_item(writer, "Whiteness", "nearly white: "//whiteness_text(channel%ljung_box)//", below "// &
                       number(negligible_rho, 2)//": a small correlation, seen because the record is long")
      else
         call put_item(writer, "Whiteness", "not white: "//whiteness_text(channel%ljung_box)// &
                       "; there is correlation for a model to describe")
      end if
   end subroutine put_whiteness

   !> "Ljung-Box 2030 over 20 lags, p < 1e-20, largest |rho| 0.41 at lag 1".
   pure function whiteness_text(ljung_box) result(text)
      !> The test
      type(ljung_box_type), intent(in) :: ljung_box
      character(:), allocatable :: text

      text = "Ljung-Box "//number(ljung_box%statistic, 4)//" over "//plural(int(ljung_box%lags, int64), "lag")//", "// &
             p_value_text(ljung_box%p_value)//", largest |rho| "//number(ljung_box%largest_rho, 3)
      if (ljung_box%largest_lag > 0) text = text//" at lag "//count_text(int(ljung_box%largest_lag, int64))
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

end module gyroakf_report_stationarity
