! SPDX-License-Identifier: MIT
!> Tests, AR models and filters on the first screen: of several channels a row each, of a single one
!> a row for each test or series.
module gyroakf_report_text_overview
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type, &
      pipeline_result_type, stage
   use gyroakf_preprocess_clean, only : clean_type
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_document_tests, only : put_ar
   use gyroakf_report_input, only : unit_name
   use gyroakf_report_tables, only : bare, full_name, kpss_p_text, &
      make_ar_table, make_filter_table, make_tests_table
   use gyroakf_report_text_description, only : text_description_type
   use gyroakf_report_text_layout, only : count_text, if_known, number, percent, plural, &
      put_item, put_paragraph, rounded, scientific
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, put_numbered, put_table, &
      table_type
   use gyroakf_report_verdicts, only : verdict_text, whiteness_word
   implicit none (type, external)
   private
   public :: put_overview, make_overview

contains

   !> What a command is for, but for the Allan analysis.
   subroutine put_overview(writer, command, record, result)
      type(writer_type), intent(inout), target :: writer
      !> run, tests, ar or filter
      character(*), intent(in) :: command
      !> For units
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(record_type) :: view
      type(table_type) :: table

      if (size(result%channel) == 1) then
         call view_channel(record, 1, view)
         call put_one(writer, command, view, result%channel(1))
         return
      end if
      call make_overview(command, result%channel, table)
      call put_below(writer, table, table%note)
   end subroutine put_overview

   !> A row for each channel.
   subroutine make_overview(command, channel, table)
      !> run, tests, ar or filter
      character(*), intent(in) :: command
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type), intent(out) :: table
      integer :: c

      select case (command)
      case ("tests"); call make_tests()
      case ("ar"); call make_models()
      case default; call make_filters()
      end select

   contains

      subroutine make_filters()
         call new_table(table, 9, head=2)
         call add_row(table, "", "outliers", "AR", "KF", "", "AKF", "", "drift KF", "smoother")
         call add_row(table, "", "", "order", "ratio", "DC gain", "ratio", "DC gain", &
                      "ratio", "ratio")
         table%note = "ratio: variance of the output over that of the input. DC gain: share of "// &
            "a constant rotation that passes"
         do c = 1, size(channel)
            associate (one => channel(c), is => channel(c)%available)
               call add_row(table, one%name, &
                            if_known(is%preprocess, count_text(one%clean%removed)), &
                            if_known(is%ar, count_text(int(one%ar%order, int64))), &
                            if_known(is%kf, percent(one%kf_figures%variance_ratio)), &
                            if_known(is%kf, percent(one%kf%dc_gain)), &
                            if_known(is%akf, percent(one%akf_figures%variance_ratio)), &
                            if_known(is%akf, percent(one%akf%dc_gain)), &
                            if_known(is%drift_kf, percent(one%drift_kf_figures%variance_ratio), &
                                     "-"), &
                            if_known(is%drift_smoother, &
                                     percent(one%drift_smoother_figures%variance_ratio), "-"))
            end associate
         end do
      end subroutine make_filters

      subroutine make_models()
         integer :: i

         call new_table(table, 9)
         call add_row(table, "", "order", "phi_1", "phi_2", "phi_3", "variance", "predicts", &
                      "|rho|", "residuals")
         table%note = "order: by "//full_name(channel(1)%ar%criterion)//". variance: of "// &
            "the residuals. predicts: share of the variance one sample ahead. |rho|: largest "// &
            "autocorrelation of the residuals"
         do c = 1, size(channel)
            call add_row(table, channel(c)%name)
            if (.not. channel(c)%available%ar) cycle
            associate (ar => channel(c)%ar, test => channel(c)%ar%residual_ljung_box)
               call add_cell(table, count_text(int(ar%order, int64)))
               do i = 1, min(3, ar%order)
                  call add_cell(table, number(ar%coefficient(i), 4))
               end do
               table%filled = 5                                         ! phi_1 to phi_3
               call add_cell(table, scientific(ar%noise_variance, 4))
               call add_cell(table, number(channel(c)%predictable_percent, 3)//" %")
               call add_cell(table, number(test%largest_rho, 2))
               call add_cell(table, if_known(test%lags > 0, trim(whiteness_word(test))))
            end associate
         end do
      end subroutine make_models

      subroutine make_tests()
         call new_table(table, 8, head=2)
         call add_row(table, "", "unit root", "level", "normal", "excess", "white", "largest", &
                      "noise")
         call add_row(table, "", "ADF", "KPSS", "Jarque-Bera", "kurtosis", "Ljung-Box", "|rho|")
         table%note = "ADF, KPSS, Jarque-Bera, Ljung-Box: p-values; what the head names is "// &
            "rejected where they are small"
         do c = 1, size(channel)
            associate (one => channel(c), is => channel(c)%available)
               call add_row(table, one%name, if_known(is%adf, bare(one%adf%p_value)), &
                            if_known(is%kpss, kpss_p_text(one)), &
                            if_known(is%jarque_bera, bare(one%jarque_bera%p_value)), &
                            if_known(is%jarque_bera, number(one%jarque_bera%kurtosis - 3, 2)), &
                            if_known(is%ljung_box, bare(one%ljung_box%p_value)), &
                            if_known(is%ljung_box, number(one%ljung_box%largest_rho, 2)), &
                            if_known(one%verdict%wanted, trim(verdict_text(one))))
            end associate
         end do
      end subroutine make_tests

   end subroutine make_overview

   !> A table below an empty line, and what it means.
   subroutine put_below(writer, table, note)
      type(writer_type), intent(inout) :: writer
      type(table_type), intent(in) :: table
      character(*), intent(in) :: note

      call put_line(writer, "")
      call put_table(writer, table)
      if (note /= "") call put_paragraph(writer, note)
   end subroutine put_below

   !> A single channel.
   subroutine put_one(writer, command, record, channel)
      type(writer_type), intent(inout), target :: writer
      character(*), intent(in) :: command
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      type(table_type) :: table
      type(text_description_type) :: out
      integer :: i
      character(:), allocatable :: text
      character(13), parameter :: names(0:3) = [character(13) :: "constant", "straight line", &
                                                   "parabola", "cubic"]

      select case (command)
      case ("tests")
         if (channel%verdict%wanted) then
            call put_item(writer, "Noise", trim(verdict_text(channel)))
            do i = 1, merge(size(channel%verdict%reasons), 0, allocated(channel%verdict%reasons))
               call put_item(writer, "", channel%verdict%reasons(i)%text)
            end do
         end if
         call make_tests_table(channel, table)
         if (size(table%cell, 1) > table%head) then
            call put_below(writer, table, table%caption//". "//table%note)
         end if
      case ("ar")
         if (.not. channel%available%ar) return
         call make_ar_table(record, channel, table)
         call put_numbered(writer, table)
         call out%attach(writer)
         call put_ar(out, channel)
      case default
         associate (clean => channel%clean, degree => channel%clean%trend%degree)
            text = "no outliers looked for"
            if (clean%method /= "none") text = plural(clean%removed, "outlier")//" ("// &
               percent(clean%fraction)//") beyond "//number(clean%threshold, 4)//" sigma ("// &
               trim(clean%method)//")"
            if (degree > 3) text = text//"; polynomial of degree "// &
               count_text(int(degree, int64))//" trend"
            if (any(degree == [0, 1, 2, 3])) text = text//"; "//trim(names(degree))//" trend"
            if (channel%available%preprocess) call put_item(writer, "Cleaned", text)
         end associate
         if (channel%available%ar) call put_model()
         associate (is => channel%available)
            if (is%kf .or. is%akf .or. is%drift_kf .or. is%drift_akf) call put_series()
         end associate
      end select

   contains

      !> "phi_1 = 0.4093 +/- 0.0083 by AIC up to order 3; residuals white".
      subroutine put_model()
         character(:), allocatable :: text

         text = ""
         associate (ar => channel%ar, test => channel%ar%residual_ljung_box)
            do i = 1, ar%order
               text = text//if_known(i > 1, ", ")//"phi_"//count_text(int(i, int64))//" = "// &
                  rounded(ar%coefficient(i), ar%std_error(i))
            end do
            text = text//if_known(ar%order > 0, " ")//"by "//full_name(ar%criterion)// &
               " up to order "//count_text(int(ar%table(ubound(ar%table, 1))%order, int64))// &
               if_known(test%lags > 0, "; residuals "//trim(whiteness_word(test)))
            call put_item(writer, "AR("//count_text(int(ar%order, int64))//")", text)
         end associate
      end subroutine put_model

      !> Before and after: the series and the filters, N where their curves show it, RMSE where the
      !> true drift is known.
      subroutine put_series()
         character(11), parameter :: shown(7) = [character(11) :: "raw", "cleaned", "KF (paper)", &
                                                 "AKF (paper)", "drift KF", "drift AKF", "smoother"]
         integer, parameter :: stages(4) = [stage%input, stage%cleaned, stage%kf, stage%akf]
         type(filter_figures_type) :: figures(3:7)
         type(table_type) :: full
         integer :: row, which

         figures = [channel%kf_figures, channel%akf_figures, channel%drift_kf_figures, &
                    channel%drift_akf_figures, channel%drift_smoother_figures]
         call make_filter_table(record, channel, full)
         call new_table(table, 7, head=full%head)
         do i = 1, size(full%cell, 1)
            which = findloc(shown == full%cell(i, 1)%text, .true., dim=1)
            if (i > full%head .and. which == 0) cycle
            associate (cell => full%cell(i, :))
               call add_row(table, cell(1)%text, cell(3)%text, cell(4)%text, &
                            if_known(i == 1, "N"), cell(6)%text, if_known(i == 1, "RMSE"), &
                            if_known(i > 1, cell(9)%text, "innovations"))
            end associate
            row = size(table%cell, 1)
            if (which >= 1 .and. which <= size(stages)) then
               associate (term => channel%allan(stages(which))%stated%term(2))
                  if (term%detected) table%cell(row, 4)%text = number(term%value, 3)
                  if (term%detected .and. full%head > 1) table%cell(2, 4)%text = term%unit
               end associate
            end if
            if (which < lbound(figures, 1)) cycle
            if (figures(which)%rmse_samples == 0) cycle
            table%cell(row, 6)%text = number(figures(which)%rmse, 4)
            if (full%head > 1) table%cell(2, 6)%text = unit_name(record)
         end do
         table%cell = table%cell(:, pack([1, 2, 3, 4, 5, 6, 7], &
            [.true., .true., .true., is_filled(4), .true., is_filled(6), .true.]))
         text = "RMSE: against the true drift, over "// &
            plural(maxval(figures%rmse_samples), "sample")
         call put_below(writer, table, if_known(any(figures%rmse_samples > 0), text))
      end subroutine put_series

      !> Whether a column has a value below its head.
      pure logical function is_filled(column)
         integer, intent(in) :: column
         integer :: row

         is_filled = any([(table%cell(row, column)%text /= "", &
                           row=table%head + 1, size(table%cell, 1))])
      end function is_filled

   end subroutine put_one

end module gyroakf_report_text_overview
