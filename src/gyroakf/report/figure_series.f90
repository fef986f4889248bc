! SPDX-License-Identifier: MIT
!> Figures of the series: raw with trend and outliers, cleaned, and what the filters make of it.
!>
!> A picture shows some thousand points: a long series is drawn by the lowest and the highest sample of every stretch, so that no
!> peak is lost and the figure of a long record is as small as that of a short one.
module gyroakf_report_figure_series
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_stats_trend, only : evaluate_trend
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_figure_script, only : add_curve, begin_block, begin_script, blue, end_block, end_plot, grey, literal, &
      orange, purple, put_axes, put_numbers, sky
   implicit none (type, external)
   private
   public :: write_series_figure, write_filters_figure, write_series_data

   !> Stretches of a long series, and outliers that are drawn
   integer(int64), parameter :: most_stretches = 1500, most_outliers = 5000

contains

   !> Above the raw series with its trend and outliers, below the cleaned series.
   subroutine write_series_figure(writer, name, form, channel, time, unit)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of the figure; its format
      character(*), intent(in) :: name, form
      !> With its series kept
      type(channel_result_type), intent(in) :: channel
      !> Units of time and rate
      character(*), intent(in) :: time, unit
      integer :: curves

      call begin_script(writer, name, form, channel%name//", as read", .true.)
      call put_axes(writer, "time, "//time, "rate, "//unit, "")
      call put_line(writer, "set multiplot layout 2,1")
      curves = 0
      call add_curve(writer, curves, "'"//name//".dat' index 'raw'", "lines lc rgb "//grey, "as read")
      call add_curve(writer, curves, "'' index 'trend'", "lines lw 2.5 lc rgb "//blue, "trend")
      call add_curve(writer, curves, "'' index 'outliers'", "points pt 6 ps 1.1 lw 2 lc rgb "//orange, "outliers")
      call end_plot(writer, curves)
      call put_line(writer, "set title "//literal(channel%name//", cleaned")//" noenhanced")
      call add_curve(writer, curves, "'"//name//".dat' index 'cleaned'", "lines lc rgb "//blue, "cleaned")
      call end_plot(writer, curves)
      call put_line(writer, "unset multiplot")
   end subroutine write_series_figure

   !> The cleaned series and the filters' outputs; the data are those of the series' figure.
   subroutine write_filters_figure(writer, name, form, channel, series, time, unit)
      !> As of write_series_figure
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name, form
      type(channel_result_type), intent(in) :: channel
      !> Name of the series' figure
      character(*), intent(in) :: series
      character(*), intent(in) :: time, unit
      integer :: curves

      call begin_script(writer, name, form, channel%name//", cleaned: the paper's filters", channel%available%drift_smoother)
      call put_axes(writer, "time, "//time, "rate, "//unit, "")
      if (channel%available%drift_smoother) call put_line(writer, "set multiplot layout 2,1")
      curves = 0
      call add_curve(writer, curves, "'"//series//".dat' index 'cleaned'", "lines lc rgb "//grey, "cleaned")
      if (channel%available%kf) call add_curve(writer, curves, "'' index 'kf'", "lines lc rgb "//orange, "KF (paper)")
      if (channel%available%akf) call add_curve(writer, curves, "'' index 'akf'", "lines lc rgb "//purple, "AKF (paper)")
      call end_plot(writer, curves)
      if (.not. channel%available%drift_smoother) return
      call put_line(writer, "set title "//literal(channel%name//", as read: its drift")//" noenhanced")
      call add_curve(writer, curves, "'"//series//".dat' index 'raw'", "lines lc rgb "//grey, "as read")
      call add_curve(writer, curves, "'' index 'compensated'", "lines lc rgb "//sky, "compensated")
      call add_curve(writer, curves, "'' index 'drift'", "lines lw 2.5 lc rgb "//blue, "drift")
      call end_plot(writer, curves)
      call put_line(writer, "unset multiplot")
   end subroutine write_filters_figure

   !> What both figures draw: blocks by name, lines of time and rate.
   subroutine write_series_data(writer, record, number, channel)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> As read
      type(record_type), intent(in), target :: record
      !> Of the channel in it
      integer, intent(in) :: number
      !> With its series kept
      type(channel_result_type), intent(in), target :: channel
      integer(int8), pointer :: here(:)

      here => null()
      if (allocated(record%present)) here => record%present(:, number)
      call put_series(writer, "raw", record%sample_interval, record%value(:, number), here)
      call put_trend(writer, record, channel)
      call put_outliers(writer, record, number, channel)
      here => null()
      if (allocated(channel%series_present)) here => channel%series_present
      call put_series(writer, "cleaned", record%sample_interval, channel%series_cleaned, here)
      if (channel%available%kf) call put_series(writer, "kf", record%sample_interval, channel%series_kf, here)
      if (channel%available%akf) call put_series(writer, "akf", record%sample_interval, channel%series_akf, here)
      if (.not. channel%available%drift_smoother) return
      call put_series(writer, "compensated", record%sample_interval, channel%series_compensated, here)
      call put_series(writer, "drift", record%sample_interval, channel%series_drift, null())
   end subroutine write_series_data

   !> Every sample of a short series, lowest and highest sample of every stretch of a long one, in the order of time.
   subroutine put_series(writer, name, interval, series, here)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name
      real(dp), intent(in) :: interval
      real(dp), intent(in), contiguous :: series(:)
      !> Presence of the samples; not associated where all are there
      integer(int8), intent(in), pointer :: here(:)
      integer(int64) :: n, stretch, first, k, low, high

      call begin_block(writer, name)
      n = size(series, kind=int64)
      stretch = 1
      if (n > 2*most_stretches) stretch = (n + most_stretches - 1)/most_stretches
      do first = 1, n, stretch
         low = 0
         high = 0
         do k = first, min(n, first + stretch - 1)
            if (associated(here)) then
               if (here(k) == 0_int8) cycle
            end if
            if (low == 0) low = k
            if (high == 0) high = k
            if (series(k) < series(low)) low = k
            if (series(k) > series(high)) high = k
         end do
         if (low == 0) then
            call put_line(writer, "")                               ! nothing is there: the line is broken
            cycle
         end if
         k = min(low, high)
         call put_numbers(writer, [real(k - 1, dp)*interval, series(k)])
         if (low == high) cycle
         k = max(low, high)
         call put_numbers(writer, [real(k - 1, dp)*interval, series(k)])
      end do
      call end_block(writer)
   end subroutine put_series

   !> The trend at the bounds of the stretches.
   subroutine put_trend(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: k, n

      call begin_block(writer, "trend")
      n = size(record%value, 1, kind=int64)
      if (channel%clean%trend%degree >= 0) then
         do k = 0, n - 1, max(1_int64, n/200)
            call put_numbers(writer, [real(k, dp)*record%sample_interval, evaluate_trend(channel%clean%trend, k)])
         end do
         call end_block(writer)
      else
         call end_block(writer, 2)
      end if
   end subroutine put_trend

   !> The samples that were there and are no longer, the first thousands of them.
   subroutine put_outliers(writer, record, number, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      integer, intent(in) :: number
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: k, found

      call begin_block(writer, "outliers")
      found = 0
      if (allocated(channel%series_present)) then
         do k = 1, size(channel%series_present, kind=int64)
            if (found == most_outliers) exit
            if (channel%series_present(k) /= 0_int8) cycle
            if (allocated(record%present)) then
               if (record%present(k, number) == 0_int8) cycle
            end if
            found = found + 1
            call put_numbers(writer, [real(k - 1, dp)*record%sample_interval, record%value(k, number)])
         end do
      end if
      if (found == 0) then
         call end_block(writer, 2)
      else
         call end_block(writer)
      end if
   end subroutine put_outliers

end module gyroakf_report_figure_series
