! SPDX-License-Identifier: MIT
!> The ARMA model in a report, where it was asked for.
module gyroakf_report_arma
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_ar_arma_result, only : arma_model_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_layout, only : put_heading, put_item, put_items, number, scientific, fixed, count_text
   use gyroakf_report_table, only : table_type, new_table, set_cell, put_table
   use gyroakf_report_stationarity, only : whiteness_text
   use gyroakf_report_models, only : upper_case
   implicit none (type, external)
   private
   public :: put_arma

contains

   !> Orders compared, the model, its residuals, the drift that it is.
   subroutine put_arma(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Rate and unit
      type(record_type), intent(in) :: record
      !> `arma` is filled where it is available
      type(channel_result_type), intent(in) :: channel

      if (.not. channel%available%arma) return
      associate (model => channel%arma)
         call put_heading(writer, "ARMA model by exact likelihood: "//count_text(model%samples)//" samples"//part_text(model))
         if (allocated(model%table)) call put_orders(writer, model)
         call put_item(writer, model_name(model%p, model%q), coefficients_text(model))
         call put_item(writer, "", "ln L = "//fixed(model%fit%log_likelihood, 2)//", AIC "//fixed(model%fit%aic, 2)//", BIC "// &
                       fixed(model%fit%bic, 2))
         if (model%residual_ljung_box%lags > 0) call put_item(writer, "Residuals", whiteness_text(model%residual_ljung_box))
         if (model%drift%found) call put_item(writer, "Drift", drift_text(record, channel))
         call put_items(writer, "Warning", model%warnings)
      end associate
   end subroutine put_arma

   !> Says so where not the whole series was used.
   pure function part_text(model) result(text)
      type(arma_model_type), intent(in) :: model
      character(:), allocatable :: text

      text = ""
      if (model%partial) text = " in the middle of the series"
   end function part_text

   !> The table of orders.
   subroutine put_orders(writer, model)
      type(writer_type), intent(inout) :: writer
      type(arma_model_type), intent(in) :: model
      character(8), parameter :: head(8) = [character(8) :: "", "p", "q", "variance", "ln L", "AIC", "BIC", ""]
      type(table_type) :: table
      logical :: left_out
      integer :: i

      call new_table(table, size(model%table) + 1, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      left_out = .false.
      do i = 1, size(model%table)
         associate (line => model%table(i))
            if (line%p == model%p .and. line%q == model%q) call set_cell(table, i + 1, 1, "*")
            call set_cell(table, i + 1, 2, count_text(int(line%p, int64)))
            call set_cell(table, i + 1, 3, count_text(int(line%q, int64)))
            call set_cell(table, i + 1, 4, scientific(line%noise_variance, 6))
            call set_cell(table, i + 1, 5, fixed(line%log_likelihood, 2))
            call set_cell(table, i + 1, 6, fixed(line%aic, 2))
            call set_cell(table, i + 1, 7, fixed(line%bic, 2))
            if (.not. line%usable) call set_cell(table, i + 1, 8, "left out")
            left_out = left_out .or. .not. line%usable
         end associate
      end do
      call put_table(writer, table, 1)
      call put_item(writer, "", "* is chosen by "//upper_case(trim(model%criterion))//", compared on the middle "// &
                    count_text(model%compared_length)//" samples")
      if (left_out) call put_item(writer, "", "left out: a root of the MA polynomial at the unit circle, or no maximum found")
   end subroutine put_orders

   !> "ARMA(1,1)".
   pure function model_name(p, q) result(text)
      integer, intent(in) :: p, q
      character(:), allocatable :: text

      text = "ARMA("//count_text(int(p, int64))//","//count_text(int(q, int64))//")"
   end function model_name

   !> Coefficients with their standard errors, and the noise.
   pure function coefficients_text(model) result(text)
      type(arma_model_type), intent(in) :: model
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, model%p
         text = text//"phi_"//count_text(int(i, int64))//" = "//with_error(model%phi(i), model%phi_error(i), model)//", "
      end do
      do i = 1, model%q
         text = text//"theta_"//count_text(int(i, int64))//" = "//with_error(model%theta(i), model%theta_error(i), model)//", "
      end do
      text = text//"noise variance "//scientific(model%noise_variance, 6)//"; mean "// &
             with_error(model%mean, model%mean_error, model)
   end function coefficients_text

   !> "0.9805 +/- 0.0019"; without the error where it is not known.
   pure function with_error(value, std_error, model) result(text)
      real(dp), intent(in) :: value, std_error
      type(arma_model_type), intent(in) :: model
      character(:), allocatable :: text

      text = number(value, 6)
      if (model%errors_known) text = text//" +/- "//number(std_error, 2)
   end function with_error

   !> "AR(1) of correlation time 50.3 s +/- 4.9, standard deviation ... under white noise of ...".
   pure function drift_text(record, channel) result(text)
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text, unit

      unit = ""
      if (allocated(record%unit%name)) unit = " "//record%unit%name
      associate (model => channel%arma, drift => channel%arma%drift)
         text = "the same as an AR(1) of correlation time "//with_error(channel%arma_time, channel%arma_time_error, model)// &
                trim(merge(" s      ", " samples", record%rate_known))//" and standard deviation "// &
                with_error(drift%drift_std, drift%drift_error, model)//unit
         if (drift%white_std > 0.0_dp) text = text//" in white noise of standard deviation "// &
            with_error(drift%white_std, drift%white_error, model)//unit
      end associate
   end function drift_text

end module gyroakf_report_arma
