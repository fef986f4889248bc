! SPDX-License-Identifier: MIT
!> Table II of a report: both families of filters side by side, and the details of each.
module gyroakf_report_text_filters
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : channel_result_type, filter_figures_type
   use gyroakf_report_input, only : has_unit, unit_name
   use gyroakf_report_text_layout, only : put_heading, put_item, put_paragraph, percent, number, scientific, &
      fixed, count_text
   use gyroakf_report_text_table, only : add_row, new_table, put_numbered, put_table, set_exact, &
      set_exacts, table_type
   use gyroakf_report_verdicts, only : whiteness_word
   implicit none (type, external)
   private
   public :: put_filter_table, make_filter_table, put_rmse

contains

   !> Mean and variance before and after each filter, and beside them what the filter does to a true rotation.
   subroutine put_filter_table(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit
      type(record_type), intent(in) :: record
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      type(table_type) :: table
      character(:), allocatable :: text

      call make_filter_table(record, channel, table)
      call put_numbered(writer, table)
      if (channel%available%drift_kf .or. channel%available%drift_akf) then
         text = "The paper's filters give out the whole signal, smoothed; the drift filters the drift alone, to be "// &
                "subtracted, and a rotation passes into it: estimate it at rest, only predict it in motion."
         if (two_inputs(channel)) text = text//" They see the raw record without its outliers; its trend is drift to them."
         call put_paragraph(writer, text, 2)
      end if
      if (channel%available%drift_smoother) call put_paragraph(writer, "compensated: the record less its smoothed drift. "// &
         "In-sample: the drift was taken from the same record, before and after each sample; no filter in use does as well.", 2)
   end subroutine put_filter_table

   !> Table II: a row for each series and for each filter of both families.
   subroutine make_filter_table(record, channel, table)
      !> For the unit
      type(record_type), intent(in) :: record
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table

      call new_table(table, 1, 9, head=merge(2, 1, has_unit(record)))
      table%name = "filters"
      table%number = "II"
      table%caption = "Before and after the filters"
      if (.not. has_unit(record)) table%caption = table%caption//", in input units"
      call add_row(table, "", "mean;variance;share;gain;passes;NIS;|rho|;innov.")
      if (has_unit(record)) call add_row(table, "", unit_name(record)//";("//unit_name(record)// &
                                         ")^2")
      table%note = "share: variance over that of the series above that is filtered. gain: mean of the last third. passes: "// &
         "share of a constant rotation (DC gain). NIS: mean squared normalised innovation, 1 where Q and R describe the "// &
         "innovations"
      if (channel%available%kf .and. channel%kf%nis_high > 0.0_dp) table%note = table%note//" (95 % of such filters within "// &
         fixed(channel%kf%nis_low, 3)//" to "//fixed(channel%kf%nis_high, 3)//")"
      table%note = table%note//". |rho|: largest autocorrelation of the innovations."
      associate (is => channel%available)
         call add_series(table, "raw", "raw", channel%raw%mean, channel%raw%variance, "")
         call add_series(table, "cleaned", "preprocess", channel%cleaned%mean, &
                         channel%cleaned%variance, "100 %")
         if (is%kf) call add_filter(table, "KF (paper)", "kf", channel%kf, channel%kf_figures)
         if (is%akf) call add_filter(table, "AKF (paper)", "akf", channel%akf, channel%akf_figures)
         if (two_inputs(channel)) call add_series(table, "no outliers", "", channel%level%mean, &
                                                  channel%level%variance, "100 %")
         if (is%drift_kf) call add_filter(table, "drift KF", "drift_kf", channel%drift_kf, &
                                          channel%drift_kf_figures)
         if (is%drift_akf) call add_filter(table, "drift AKF", "drift_akf", channel%drift_akf, &
                                           channel%drift_akf_figures)
         if (is%drift_smoother) then
            call add_filter(table, "smoother", "drift_smoother", channel%drift_smoother, &
                            channel%drift_smoother_figures)
            call add_series(table, "compensated", "", channel%compensated%mean, &
                            channel%compensated%variance, &
                            percent(channel%compensated_ratio)//";;"// &
                            fixed(channel%drift_smoother_figures%lost_percent/100, 4))
         end if
      end associate
   end subroutine make_filter_table

   !> The drift is looked for in another series than the one that the paper's filters work on.
   pure logical function two_inputs(channel)
      type(channel_result_type), intent(in) :: channel

      two_inputs = channel%drift%found .and. channel%available%preprocess
   end function two_inputs

   !> A series in the table.
   subroutine add_series(table, name, key, mean, variance, cells)
      type(table_type), intent(inout) :: table
      !> What the row is called; where results.json has its mean and variance, "" where it has not
      character(*), intent(in) :: name, key
      real(dp), intent(in) :: mean, variance
      !> From the share on
      character(*), intent(in) :: cells

      call add_row(table, name, scientific(mean, 4)//";"//scientific(variance, 5)//";"//cells)
      if (key /= "") call set_exacts(table, 2, key//".", [character(8) :: "mean", "variance"], &
                                     [mean, variance])
   end subroutine add_series

   !> One filter in the table; a smoother has no innovations.
   subroutine add_filter(table, name, member, filter, figures)
      type(table_type), intent(inout) :: table
      !> What the row is called; the filter among those of results.json
      character(*), intent(in) :: name, member
      type(filter_result_type), intent(in) :: filter
      type(filter_figures_type), intent(in) :: figures
      character(:), allocatable :: cells
      logical :: measured

      cells = percent(figures%variance_ratio)//";"
      measured = filter%nis_high > 0.0_dp
      if (measured) cells = cells//number(filter%gain, 2)
      cells = cells//";"//fixed(filter%dc_gain, 4)
      if (measured) cells = cells//";"//fixed(filter%nis_mean, 3)//";"// &
         number(filter%ljung_box%largest_rho, 2)// &
         ";"//trim(whiteness_word(filter%ljung_box))
      call add_series(table, name, "filters."//member, filter%mean, filter%variance, cells)
      call set_exact(table, table%filled, 6, "filters."//member//".dc_gain", filter%dc_gain)
      if (.not. measured) return
      call set_exact(table, table%filled, 5, "filters."//member//".gain", filter%gain)
      call set_exact(table, table%filled, 7, "filters."//member//".nis_mean", filter%nis_mean)
   end subroutine add_filter

   !> RMSE of every filter against the true drift; nothing where that is not known.
   subroutine put_rmse(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit
      type(record_type), intent(in) :: record
      !> Filters are filled as far as they are available
      type(channel_result_type), intent(in) :: channel
      character(11), parameter :: name(5) = [character(11) :: "KF (paper)", "AKF (paper)", "drift KF", &
                                             "drift AKF", "smoother"]
      type(filter_figures_type) :: figures(5)
      type(table_type) :: table
      integer :: i

      figures = [channel%kf_figures, channel%akf_figures, channel%drift_kf_figures, channel%drift_akf_figures, &
                 channel%drift_smoother_figures]
      if (all(figures%rmse_samples == 0)) return
      call put_heading(writer, "Against the true drift")
      call new_table(table, 1, 2)
      call add_row(table, "", "RMSE")
      do i = 1, size(figures)
         if (figures(i)%rmse_samples > 0) call add_row(table, trim(name(i)), &
                                                       number(figures(i)%rmse, 4))
      end do
      call put_table(writer, table)
      call put_item(writer, "", "RMSE in "//unit_name(record)//" over "// &
                    count_text(maxval(figures%rmse_samples))//" samples")
   end subroutine put_rmse

end module gyroakf_report_text_filters
