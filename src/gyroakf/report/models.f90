! SPDX-License-Identifier: MIT
!> Table I (AR models) and Table II (filters) of a report.
module gyroakf_report_models
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_series_whiteness, only : ljung_box_type
   use gyroakf_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : pipeline_options, channel_result_type, filter_figures_type
   use gyroakf_report_ar_details, only : put_ar_normality, put_ar_roots
   use gyroakf_report_layout, only : put_heading, put_item, put_items, number, scientific, fixed, count_text, p_value_text
   use gyroakf_report_table, only : table_type, new_table, set_cell, put_table
   use gyroakf_report_stationarity, only : whiteness_text, negligible_rho
   implicit none (type, external)
   private
   public :: put_ar_table, put_filter_table, put_filter_details, upper_case

contains

   !> Orders, criteria, the choice, and the model that was chosen.
   subroutine put_ar_table(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> `ar` is filled where it is available
      type(channel_result_type), intent(in) :: channel
      character(8), parameter :: head(9) = [character(8) :: "", "order", "variance", "AIC", "AICc", "BIC", "HQIC", "FPE", "AIC/n"]
      type(table_type) :: table
      integer :: i, row

      if (.not. channel%available%ar) return
      call put_heading(writer, "Table I. AR models ("//method_name(channel%ar%method)//", n = "// &
                       count_text(channel%ar%compared_rows)//"); * is the order chosen by "//upper_case(trim(channel%ar%criterion)))
      call new_table(table, size(channel%ar%table) + 1, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         row = i - lbound(channel%ar%table, 1) + 2
         associate (line => channel%ar%table(i))
            if (line%order == channel%ar%order) call set_cell(table, row, 1, "*")
            call set_cell(table, row, 2, count_text(int(line%order, int64)))
            call set_cell(table, row, 3, scientific(line%noise_variance, 6))
            call set_cell(table, row, 4, fixed(line%aic, 2))
            call set_cell(table, row, 5, fixed(line%aicc, 2))
            call set_cell(table, row, 6, fixed(line%bic, 2))
            call set_cell(table, row, 7, fixed(line%hqic, 2))
            call set_cell(table, row, 8, scientific(line%fpe, 6))
            call set_cell(table, row, 9, fixed(line%aic_per_observation, 6))
         end associate
      end do
      call put_table(writer, table, 1)
      call put_model(writer, channel)
   end subroutine put_ar_table

   !> Coefficients of the chosen model.
   subroutine put_model(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, channel%ar%order
         text = text//"phi_"//count_text(int(i, int64))//" = "//number(channel%ar%coefficient(i), 6)//" +/- "// &
                number(channel%ar%std_error(i), 2)//", "
      end do
      call put_item(writer, "AR("//count_text(int(channel%ar%order, int64))//")", text//"noise variance "// &
                    scientific(channel%ar%noise_variance, 6)//" of a variance of "// &
                    scientific(channel%ar%variance, 6))
      call put_ar_roots(writer, channel%ar)
      if (channel%ar%residual_ljung_box%lags > 0) call put_item(writer, "Residuals", whiteness_text(channel%ar%residual_ljung_box))
      call put_ar_normality(writer, channel%ar)
   end subroutine put_model

   !> Mean and variance before and after each filter, and beside them what the filter does to a true rotation.
   subroutine put_filter_table(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      character(13), parameter :: head(8) = [character(13) :: "", "mean", "variance", "of cleaned", "DC gain", "mean NIS", &
                                             "largest |rho|", "innovations"]
      type(table_type) :: table
      integer :: i, rows

      call put_heading(writer, "Table II. Before and after the filters")
      rows = 3 + count([channel%available%kf, channel%available%akf, channel%available%drift_kf, channel%available%drift_akf])
      call new_table(table, rows, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      call set_cell(table, 2, 1, "as read")
      call set_cell(table, 2, 2, scientific(channel%raw%mean, 5))
      call set_cell(table, 2, 3, scientific(channel%raw%variance, 5))
      call set_cell(table, 3, 1, "cleaned")
      call set_cell(table, 3, 2, scientific(channel%cleaned%mean, 5))
      call set_cell(table, 3, 3, scientific(channel%cleaned%variance, 5))
      call set_cell(table, 3, 4, "100 %")
      rows = 3
      if (channel%available%kf) call add_row(table, rows, "KF (paper)", channel%kf, channel%kf_figures)
      if (channel%available%akf) call add_row(table, rows, "AKF (paper)", channel%akf, channel%akf_figures)
      if (channel%available%drift_kf) call add_row(table, rows, "drift KF", channel%drift_kf, channel%drift_kf_figures)
      if (channel%available%drift_akf) call add_row(table, rows, "drift AKF", channel%drift_akf, channel%drift_akf_figures)
      call put_table(writer, table, 1)
      call put_item(writer, "", "DC gain: share of a constant rotation that passes. NIS: 1 where Q and R "// &
                    "describe the innovations. |rho|: largest autocorrelation of the innovations.")
   end subroutine put_filter_table

   !> One filter in the table.
   subroutine add_row(table, row, name, filter, figures)
      type(table_type), intent(inout) :: table
      integer, intent(inout) :: row
      character(*), intent(in) :: name
      type(filter_result_type), intent(in) :: filter
      type(filter_figures_type), intent(in) :: figures

      row = row + 1
      call set_cell(table, row, 1, name)
      call set_cell(table, row, 2, scientific(filter%mean, 5))
      call set_cell(table, row, 3, scientific(filter%variance, 5))
      call set_cell(table, row, 4, number(100*figures%variance_ratio, 4)//" %")
      call set_cell(table, row, 5, fixed(filter%dc_gain, 4))
      call set_cell(table, row, 6, fixed(filter%nis_mean, 3))
      call set_cell(table, row, 7, number(filter%ljung_box%largest_rho, 3))
      call set_cell(table, row, 8, trim(verdict(filter%ljung_box)))
   end subroutine add_row

   !> Whiteness in a word: significance alone would call every long record coloured.
   pure function verdict(test) result(text)
      type(ljung_box_type), intent(in) :: test
      character(12) :: text

      if (.not. test%p_value < 0.05_dp) then
         text = "white"
      else if (test%largest_rho < negligible_rho) then
         text = "nearly white"
      else
         text = "not white"
      end if
   end function verdict

   !> Gain, Q, R, counts and warnings of every filter.
   subroutine put_filter_details(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel

      if (channel%available%kf) call put_details(writer, "KF", channel%kf)
      if (channel%available%akf) call put_details(writer, "AKF", channel%akf)
      if (channel%available%drift_kf) call put_details(writer, "drift KF", channel%drift_kf)
      if (channel%available%drift_akf) call put_details(writer, "drift AKF", channel%drift_akf)
   end subroutine put_filter_details

   subroutine put_details(writer, name, filter)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name
      type(filter_result_type), intent(in) :: filter
      character(:), allocatable :: text
      integer :: i

      text = "mean gain of the last third "//number(filter%gain, 4)//"; at the end Q "//scientific(filter%q, 5)// &
             ", R "//scientific(filter%r, 5)
      if (allocated(filter%estimate)) then
         do i = 1, size(filter%estimate)
            if (i == 1) text = text//"; b = "//number(filter%forgetting, 4)//", adapts"
            text = text//" "//filter%estimate(i)%text
         end do
      end if
      if (filter%clamped > 0) text = text//"; "//count_text(filter%clamped)//" of "//count_text(filter%steps)// &
                                     " steps held at a bound"
      if (filter%gated > 0) text = text//"; "//count_text(filter%gated)//" steps gated"
      call put_item(writer, name, text)
      call put_item(writer, "", "innovations: "//whiteness_text(filter%ljung_box))
      call put_items(writer, "Warning", filter%warnings)
   end subroutine put_details

   pure function method_name(method) result(name)
      character(*), intent(in) :: method
      character(:), allocatable :: name

      select case (method)
      case ("yw"); name = "Yule-Walker"
      case ("burg"); name = "Burg"
      case ("ols"); name = "least squares"
      case ("mcov"); name = "forward and backward least squares"
      case default; name = trim(method)
      end select
   end function method_name

   !> aic -> AIC, aicc -> AICc.
   pure function upper_case(criterion) result(name)
      !> As the options have it
      character(*), intent(in) :: criterion
      character(:), allocatable :: name

      select case (criterion)
      case ("aicc"); name = "AICc"
      case ("aic"); name = "AIC"
      case ("bic"); name = "BIC"
      case ("hqic"); name = "HQIC"
      case ("fpe"); name = "FPE"
      case default; name = criterion
      end select
   end function upper_case

end module gyroakf_report_models
