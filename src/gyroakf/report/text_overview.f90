! SPDX-License-Identifier: MIT
!> Tests, AR models and filters on the first screen: of several channels a row each, of a single one a row for each test or series.
module gyroakf_report_text_overview
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type, stage
   use gyroakf_preprocess_clean, only : clean_type
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_document_tests, only : put_ar
   use gyroakf_report_tables, only : bare, has_tests, kpss_p_text, make_ar_table, &
      make_tests_table, upper_case
   use gyroakf_report_text_description, only : text_description_type
   use gyroakf_report_text_filters, only : make_filter_table, put_rmse
   use gyroakf_report_text_layout, only : count_text, if_known, number, percent, plural, put_item, put_paragraph, rounded, &
      scientific
   use gyroakf_report_text_table, only : add_row, new_table, put_numbered, put_table, set_cell, &
      table_type
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

   !> Outliers and trend in a line: "12 outliers (0.1 %) beyond 4.493 sigma (auto); cubic trend".
   pure function cleaning_text(clean) result(text)
      type(clean_type), intent(in) :: clean
      character(:), allocatable :: text

      text = "no outliers looked for"
      if (clean%method /= "none") text = plural(clean%removed, "outlier")//" ("//percent(clean%fraction)//") beyond "// &
         number(clean%threshold, 4)//" sigma ("//trim(clean%method)//")"
      if (clean%trend%degree >= 0) text = text//"; "//degree_name(clean%trend%degree)//" trend"
   end function cleaning_text

   !> The trend in words.
   pure function degree_name(degree) result(name)
      integer, intent(in) :: degree
      character(:), allocatable :: name

      select case (degree)
      case (0); name = "constant"
      case (1); name = "straight line"
      case (2); name = "parabola"
      case (3); name = "cubic"
      case default; name = "polynomial of degree "//count_text(int(degree, int64))
      end select
   end function degree_name

   !> Before and after: the series and the filters of one channel.
   subroutine put_series(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(11), parameter :: shown(7) = [character(11) :: "raw", "cleaned", "KF (paper)", "AKF (paper)", &
                                              "drift KF", "drift AKF", "smoother"]
      integer, parameter :: stages(4) = [stage%input, stage%cleaned, stage%kf, stage%akf], n = 4
      type(table_type) :: full, table
      character(:), allocatable :: coefficient
      integer :: i, j

      associate (is => channel%available)
         if (.not. (is%kf .or. is%akf .or. is%drift_kf .or. is%drift_akf)) return
      end associate
      call make_filter_table(record, channel, full)
      call new_table(table, full%head, 6, head=full%head)
      do i = 1, size(full%cell, 1)
         if (i > full%head .and. .not. any(shown == full%cell(i, 1)%text)) cycle
         coefficient = ""
         do j = 1, size(stages)
            if (i <= full%head .or. shown(j) /= full%cell(i, 1)%text) cycle
            associate (term => channel%allan(stages(j))%stated%term(2))
               if (.not. term%detected) cycle
               coefficient = number(term%value, 3)
               if (full%head > 1) call set_cell(table, 2, n, term%unit)
            end associate
         end do
         associate (cell => full%cell(i, :))
            call add_row(table, cell(1)%text, cell(3)%text//";"//cell(4)%text//";"//coefficient// &
                         ";"// &
                         cell(6)%text//";"//cell(9)%text)
         end associate
      end do
      call set_cell(table, 1, n, "N")
      call set_cell(table, 1, 6, "innovations")
      call put_line(writer, "")
      call put_table(writer, table)
   end subroutine put_series

   !> The filters of several channels.
   subroutine put_filters(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type) :: table
      integer :: c

      call new_table(table, 2, 9, head=2)
      call add_row(table, "", "outliers;AR;KF;;AKF;;drift KF;smoother")
      call add_row(table, "", ";order;share;passes;share;passes;share;share")
      do c = 1, size(channel)
         associate (one => channel(c), is => channel(c)%available)
            call add_row(table, one%name, if_known(is%preprocess, count_text(one%clean%removed))//";"// &
                         if_known(is%ar, count_text(int(one%ar%order, int64)))//";"// &
                         if_known(is%kf, percent(one%kf_figures%variance_ratio))//";"// &
                         if_known(is%kf, percent(one%kf%dc_gain))//";"// &
                         if_known(is%akf, percent(one%akf_figures%variance_ratio))//";"// &
                         if_known(is%akf, percent(one%akf%dc_gain))//";"// &
                         if_known(is%drift_kf, percent(one%drift_kf_figures%variance_ratio), "-")//";"// &
                         if_known(is%drift_smoother, percent(one%drift_smoother_figures%variance_ratio), "-"))
         end associate
      end do
      call put_line(writer, "")
      call put_table(writer, table)
      call put_paragraph(writer, "share: variance of the output over that of the input. passes: share of a constant rotation", 2)
   end subroutine put_filters

   !> The AR models of several channels.
   subroutine put_models(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type) :: table
      character(:), allocatable :: cells
      integer :: c, i

      call new_table(table, 1, 9)
      call add_row(table, "", "order;phi_1;phi_2;phi_3;variance;predicts;|rho|;residuals")
      do c = 1, size(channel)
         if (.not. channel(c)%available%ar) then
            call add_row(table, channel(c)%name, "")
            cycle
         end if
         associate (ar => channel(c)%ar, test => channel(c)%ar%residual_ljung_box)
            cells = count_text(int(ar%order, int64))//";"
            do i = 1, 3
               if (i <= ar%order) cells = cells//number(ar%coefficient(i), 4)
               cells = cells//";"
            end do
            cells = cells//scientific(ar%noise_variance, 4)//";"// &
               number(channel(c)%predictable_percent, 3)//" %;"// &
               number(test%largest_rho, 2)//";"
            call add_row(table, channel(c)%name, cells//if_known(test%lags > 0, trim(whiteness_word(test))))
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

      call new_table(table, 2, 8, head=2)
      call add_row(table, "", "unit root;level;normal;excess;white;largest;noise")
      call add_row(table, "", "ADF;KPSS;Jarque-Bera;kurtosis;Ljung-Box;|rho|")
      do c = 1, size(channel)
         associate (one => channel(c), is => channel(c)%available)
            call add_row(table, one%name, if_known(is%adf, bare(one%adf%p_value))//";"// &
                         if_known(is%kpss, kpss_p_text(one))//";"// &
                         if_known(is%jarque_bera, bare(one%jarque_bera%p_value))//";"// &
                         if_known(is%jarque_bera, number(one%jarque_bera%kurtosis - 3, 2))//";"// &
                         if_known(is%ljung_box, bare(one%ljung_box%p_value))//";"// &
                         if_known(is%ljung_box, number(one%ljung_box%largest_rho, 2))//";"// &
                         if_known(one%verdict%wanted, trim(verdict_text(one))))
         end associate
      end do
      call put_line(writer, "")
      call put_table(writer, table)
      call put_paragraph(writer, "ADF, KPSS, Jarque-Bera, Ljung-Box: p-values; what the head names is rejected "// &
                         "where they are small", 2)
   end subroutine put_tests

end module gyroakf_report_text_overview
