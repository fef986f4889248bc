! SPDX-License-Identifier: MIT
!> Tests, AR models and filters on the first screen: of several channels a row each, of a single one a row for each test or series.
module gyroakf_report_text_overview
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_document_ar, only : put_ar
   use gyroakf_report_models, only : make_ar_table, upper_case
   use gyroakf_report_removed, only : cleaning_text
   use gyroakf_report_tests_table, only : bare, has_tests, kpss_p_text, make_tests_table
   use gyroakf_report_text_description, only : text_description_type
   use gyroakf_report_text_filters, only : make_filter_table, put_rmse
   use gyroakf_report_text_layout, only : count_text, number, p_value_text, put_item, put_paragraph, rounded, scientific
   use gyroakf_report_text_table, only : new_table, put_numbered, put_table, set_cell, set_row, table_type
   use gyroakf_report_verdicts, only : verdict_text, whiteness_word
   implicit none (type, external)
   private
   public :: put_overview

contains

   !> What a command is for, but for the Allan analysis.
   subroutine put_overview(writer, command, record, result)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> run, tests, ar or filter
      character(*), intent(in) :: command
      !> For units
      type(record_type), intent(in) :: record
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      type(record_type) :: view

      if (size(result%channel) == 1) then
         call view_channel(record, 1, view)
         call put_one(writer, command, view, result%channel(1))
         return
      end if
      select case (command)
      case ("tests"); call put_tests(writer, result%channel)
      case ("ar"); call put_models(writer, result%channel)
      case default; call put_filters(writer, result%channel)
      end select
   end subroutine put_overview

   !> A single channel.
   subroutine put_one(writer, command, record, channel)
      type(writer_type), intent(inout), target :: writer
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      type(table_type) :: table
      type(text_description_type) :: out

      select case (command)
      case ("tests")
         call put_verdict(writer, channel)
         if (.not. has_tests(channel)) return
         call make_tests_table(channel, table)
         call put_line(writer, "")
         call put_table(writer, table)
         call put_paragraph(writer, table%caption//". "//table%note, 2)
      case ("ar")
         if (.not. channel%available%ar) return
         call make_ar_table(record, channel, table)
         call put_numbered(writer, table)
         call out%attach(writer)
         call put_ar(out, channel)
      case default
         if (channel%available%preprocess) call put_item(writer, "Cleaned", cleaning_text(channel%clean))
         if (channel%available%ar) call put_item(writer, "AR("//count_text(int(channel%ar%order, int64))//")", model_text(channel))
         call put_series(writer, record, channel)
         call put_rmse(writer, record, channel)
      end select
   end subroutine put_one

   !> The verdict and its reasons; nothing where none was looked for.
   subroutine put_verdict(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%verdict%wanted) return
      call put_item(writer, "Noise", trim(verdict_text(channel)))
      if (.not. allocated(channel%verdict%reasons)) return
      do i = 1, size(channel%verdict%reasons)
         call put_item(writer, "", channel%verdict%reasons(i)%text)
      end do
   end subroutine put_verdict

   !> "phi_1 = 0.4093 +/- 0.0083 by AIC up to order 3; residuals white".
   pure function model_text(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      integer :: i

      associate (ar => channel%ar)
         text = ""
         do i = 1, ar%order
            text = text//"phi_"//count_text(int(i, int64))//" = "//rounded(ar%coefficient(i), ar%std_error(i))//", "
         end do
         if (ar%order > 0) text = text(:len(text) - 2)//" "
         text = text//"by "//upper_case(trim(ar%criterion))//" up to order "// &
                count_text(int(ar%table(size(ar%table))%order, int64))
         if (ar%residual_ljung_box%lags > 0) text = text//"; residuals "//trim(whiteness_word(ar%residual_ljung_box))
      end associate
   end function model_text

   !> Before and after: the series and the filters of one channel.
   subroutine put_series(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(11), parameter :: shown(7) = [character(11) :: "raw", "cleaned", "KF (paper)", "AKF (paper)", &
                                              "drift KF", "drift AKF", "smoother"]
      integer, parameter :: column(6) = [1, 3, 4, 0, 6, 9], n = 4
      integer :: stages(4)
      type(table_type) :: full, table
      integer :: i, j, row

      if (.not. any([channel%available%kf, channel%available%akf, channel%available%drift_kf, channel%available%drift_akf])) return
      stages = [stage%input, stage%cleaned, stage%kf, stage%akf]
      call make_filter_table(record, channel, full)
      row = full%head
      do i = full%head + 1, size(full%cell, 1)
         if (any(shown == full%cell(i, 1)%text)) row = row + 1
      end do
      call new_table(table, row, size(column), head=full%head)
      row = 0
      do i = 1, size(full%cell, 1)
         if (i > full%head .and. .not. any(shown == full%cell(i, 1)%text)) cycle
         row = row + 1
         do j = 1, size(column)
            if (column(j) > 0) call set_cell(table, row, j, full%cell(i, column(j))%text)
         end do
         if (i <= full%head) cycle
         do j = 1, size(stages)
            if (shown(j) /= full%cell(i, 1)%text) cycle
            associate (term => channel%allan(stages(j))%stated%term(2))
               if (.not. term%detected) cycle
               call set_cell(table, row, n, number(term%value, 3))
               if (full%head > 1) call set_cell(table, 2, n, term%unit)
            end associate
         end do
      end do
      call set_cell(table, 1, n, "N")
      call set_cell(table, 1, size(column), "innovations")
      call put_line(writer, "")
      call put_table(writer, table)
   end subroutine put_series

   !> The filters of several channels.
   subroutine put_filters(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type) :: table
      integer :: c

      call new_table(table, 2 + size(channel), 9, head=2)
      call set_row(table, 1, [character(8) :: "", "outliers", "AR", "KF", "", "AKF", "", "drift KF", "smoother"])
      call set_row(table, 2, [character(8) :: "", "", "order", "share", "passes", "share", "passes", "share", "share"])
      do c = 1, size(channel)
         associate (one => channel(c), row => c + 2, is => channel(c)%available)
            call set_cell(table, row, 1, one%name)
            if (is%preprocess) call set_cell(table, row, 2, count_text(one%clean%removed))
            if (is%ar) call set_cell(table, row, 3, count_text(int(one%ar%order, int64)))
            if (is%kf) call set_shares(4, one%kf_figures%variance_ratio, one%kf%dc_gain)
            if (is%akf) call set_shares(6, one%akf_figures%variance_ratio, one%akf%dc_gain)
            call set_cell(table, row, 8, "-")
            call set_cell(table, row, 9, "-")
            if (is%drift_kf) call set_cell(table, row, 8, number(100*one%drift_kf_figures%variance_ratio, 3)//" %")
            if (is%drift_smoother) call set_cell(table, row, 9, number(100*one%drift_smoother_figures%variance_ratio, 3)//" %")
         end associate
      end do
      call put_line(writer, "")
      call put_table(writer, table)
      call put_paragraph(writer, "share: variance of the output over that of the input. passes: share of a constant rotation", 2)

   contains

      !> Share of the variance, and of a rotation
      subroutine set_shares(first, variance, rotation)
         integer, intent(in) :: first
         real(dp), intent(in) :: variance, rotation
         call set_cell(table, c + 2, first, number(100*variance, 3)//" %")
         call set_cell(table, c + 2, first + 1, number(100*rotation, 3)//" %")
      end subroutine set_shares

   end subroutine put_filters

   !> The AR models of several channels.
   subroutine put_models(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type) :: table
      integer :: c, i

      call new_table(table, 1 + size(channel), 9)
      call set_row(table, 1, [character(9) :: "", "order", "phi_1", "phi_2", "phi_3", "variance", "predicts", "|rho|", &
                              "residuals"])
      do c = 1, size(channel)
         call set_cell(table, c + 1, 1, channel(c)%name)
         if (.not. channel(c)%available%ar) cycle
         associate (ar => channel(c)%ar)
            call set_cell(table, c + 1, 2, count_text(int(ar%order, int64)))
            do i = 1, min(3, ar%order)
               call set_cell(table, c + 1, 2 + i, number(ar%coefficient(i), 4))
            end do
            call set_cell(table, c + 1, 6, scientific(ar%noise_variance, 4))
            call set_cell(table, c + 1, 7, number(channel(c)%predictable_percent, 3)//" %")
            call set_cell(table, c + 1, 8, number(ar%residual_ljung_box%largest_rho, 2))
            if (ar%residual_ljung_box%lags > 0) call set_cell(table, c + 1, 9, trim(whiteness_word(ar%residual_ljung_box)))
         end associate
      end do
      call put_line(writer, "")
      call put_table(writer, table)
      call put_paragraph(writer, "order: by "//upper_case(trim(channel(1)%ar%criterion))//". variance: of the residuals. "// &
                         "predicts: share of the variance one sample ahead. |rho|: largest autocorrelation of the residuals", 2)
   end subroutine put_models

   !> The tests of several channels.
   subroutine put_tests(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type) :: table
      integer :: c

      call new_table(table, 2 + size(channel), 8, head=2)
      call set_row(table, 1, [character(11) :: "", "unit root", "level", "normal", "excess", "white", "largest", "noise"])
      call set_row(table, 2, [character(11) :: "", "ADF", "KPSS", "Jarque-Bera", "kurtosis", "Ljung-Box", "|rho|", ""])
      do c = 1, size(channel)
         associate (one => channel(c), is => channel(c)%available)
            call set_cell(table, c + 2, 1, one%name)
            if (is%adf) call set_cell(table, c + 2, 2, bare(p_value_text(one%adf%p_value)))
            if (is%kpss) call set_cell(table, c + 2, 3, bare(kpss_p_text(one)))
            if (is%jarque_bera) call set_cell(table, c + 2, 4, bare(p_value_text(one%jarque_bera%p_value)))
            if (is%jarque_bera) call set_cell(table, c + 2, 5, number(one%jarque_bera%kurtosis - 3, 2))
            if (is%ljung_box) call set_cell(table, c + 2, 6, bare(p_value_text(one%ljung_box%p_value)))
            if (is%ljung_box) call set_cell(table, c + 2, 7, number(one%ljung_box%largest_rho, 2))
            if (one%verdict%wanted) call set_cell(table, c + 2, 8, trim(verdict_text(one)))
         end associate
      end do
      call put_line(writer, "")
      call put_table(writer, table)
      call put_paragraph(writer, "ADF, KPSS, Jarque-Bera, Ljung-Box: p-values; what the head names is rejected "// &
                         "where they are small", 2)
   end subroutine put_tests

end module gyroakf_report_text_overview
