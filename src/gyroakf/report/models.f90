! SPDX-License-Identifier: MIT
!> Table I (AR models) of a report.
module gyroakf_report_models
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_ar_details, only : put_ar_normality, put_ar_roots
   use gyroakf_report_layout, only : put_heading, put_item, number, scientific, fixed, count_text
   use gyroakf_report_table, only : table_type, new_table, set_cell, put_table
   use gyroakf_report_stationarity, only : whiteness_text
   implicit none (type, external)
   private
   public :: put_ar_table, upper_case

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
