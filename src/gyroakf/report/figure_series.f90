! SPDX-License-Identifier: MIT
!> Figures of the series: the record with trend, drift and outliers; the cleaned series with the
!> outputs of the filters.
!>
!> A long series is drawn by the lowest and the highest sample of each block: no peak is lost, and
!> the figure of a long record is as small as that of a short one.
module gyroakf_report_figure_series
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_record, only : record_type
   use gyroakf_report_input, only : time_unit
   use gyroakf_report_sign, only : to_unicode
   use gyroakf_report_svg, only : figure_type
   use gyroakf_report_svg_series, only : series_type
   use gyroakf_stats_trend, only : evaluate_trend
   implicit none (type, external)
   private
   public :: build_record_figure, build_filter_figure, max_blocks

   !> Blocks of a long series, points of a trend, outliers
   integer(int64), parameter :: max_blocks = 550, trend_points = 200, max_outliers = 300

contains

   !> The record with its outliers, its trend and its drift; without series where it has no samples.
   subroutine build_record_figure(record, number, channel, unit, figure)
      !> With its samples, or without
      type(record_type), intent(in), target :: record
      !> Of the channel in it
      integer, intent(in) :: number
      !> Trend, drift and outliers are drawn where they are known, a drift that no model describes is not
      type(channel_result_type), intent(in) :: channel
      !> Of the channel
      character(*), intent(in) :: unit
      !> Ready to be written
      type(figure_type), intent(out) :: figure
      integer(int8), pointer :: present(:)

      if (.not. allocated(record%value)) return
      present => null()
      if (allocated(record%present)) present => record%present(:, number)
      call begin_figure(record, channel%name//", record", unit, figure)
      allocate (figure%series(4))
      call set_series(figure%series(1), "record", -1, record%sample_interval, &
                      record%value(:, number), present)
      if (allocated(channel%series_present)) then
         call set_outliers(figure%series(2), record%value(:, number), record%sample_interval, &
                           channel%series_present, present)
      end if
      if (channel%clean%trend%degree >= 1) call set_trend(figure%series(3), record, channel)
      if (allocated(channel%series_drift) .and. .not. allocated(channel%drift_doubt)) then
         call set_series(figure%series(4), "drift (smoother)", 2, record%sample_interval, channel%series_drift)
      end if
   end subroutine build_record_figure

   !> The cleaned series and the outputs of the filters; without series where no output was kept.
   subroutine build_filter_figure(record, channel, unit, figure)
      !> For the rate
      type(record_type), intent(in) :: record
      !> With its cleaned series where an output was kept
      type(channel_result_type), intent(in) :: channel
      !> Of the channel
      character(*), intent(in) :: unit
      !> Ready to be written
      type(figure_type), intent(out) :: figure

      if (.not. (allocated(channel%series_kf) .or. allocated(channel%series_akf))) return
      call begin_figure(record, channel%name//", cleaned and filtered", unit, figure)
      allocate (figure%series(3))
      associate (interval => record%sample_interval)
         call set_series(figure%series(1), "cleaned", -1, interval, channel%series_cleaned, &
                         channel%series_present)
         if (allocated(channel%series_kf)) then
            call set_series(figure%series(2), "KF", 2, interval, channel%series_kf, channel%series_present)
         end if
         if (allocated(channel%series_akf)) then
            call set_series(figure%series(3), "AKF", 1, interval, channel%series_akf, channel%series_present)
         end if
      end associate
   end subroutine build_filter_figure

   !> Title, axes and caption.
   subroutine begin_figure(record, title, unit, figure)
      type(record_type), intent(in) :: record
      character(*), intent(in) :: title, unit
      type(figure_type), intent(inout) :: figure

      figure%title = title
      figure%x_label = "time, "//time_unit(record)
      figure%y_label = to_unicode(unit)
      figure%caption = "Lowest and highest sample of each block of a long record."
   end subroutine begin_figure

   !> Every sample of a short series, lowest and highest sample of each block of a long one; NaN
   !> where a block has none.
   subroutine set_series(series, label, color, interval, values, marks)
      type(series_type), intent(inout) :: series
      character(*), intent(in) :: label
      integer, intent(in) :: color
      real(dp), intent(in) :: interval
      real(dp), intent(in), contiguous :: values(:)
      !> 1 present, 0 missing: [n]; all are present if absent
      integer(int8), intent(in), optional :: marks(:)
      integer(int64) :: n, length, first, last, points, ends(2), k

      n = size(values, kind=int64)
      length = 1
      if (n > 2*max_blocks) length = (n + max_blocks - 1)/max_blocks
      series%label = label
      series%color = color
      allocate (series%x(2*((n + length - 1)/length)))
      allocate (series%y, mold=series%x)
      points = 0
      do first = 1, n, length
         last = min(n, first + length - 1)
         ends = first - 1 + block_ends(values(first:last), [(is_present(k, marks), k=first, last)])
         do k = 1, merge(1, 2, ends(1) == ends(2))
            points = points + 1
            series%x(points) = real(ends(k) - 1, dp)*interval
            series%y(points) = ieee_value(0.0_dp, ieee_quiet_nan)
            if (ends(k) >= first) series%y(points) = values(ends(k))
         end do
      end do
      series%x = series%x(:points)
      series%y = series%y(:points)
   end subroutine set_series

   !> The lowest and the highest sample of a block in their order; 0 and 0 where none is present.
   pure function block_ends(values, there) result(ends)
      real(dp), intent(in) :: values(:)
      logical, intent(in) :: there(:)
      integer(int64) :: ends(2)

      ends = [minloc(values, 1, there, kind=int64), maxloc(values, 1, there, kind=int64)]
      ends = [minval(ends), maxval(ends)]
   end function block_ends

   !> A sample is there.
   pure logical function is_present(k, marks)
      integer(int64), intent(in) :: k
      integer(int8), intent(in), optional :: marks(:)

      is_present = .true.
      if (present(marks)) is_present = marks(k) /= 0_int8
   end function is_present

   !> The trend that was removed.
   subroutine set_trend(series, record, channel)
      type(series_type), intent(inout) :: series
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      integer(int64) :: i, k, n

      n = size(record%value, 1, kind=int64)
      series%label = "trend"
      series%color = 1
      allocate (series%x(trend_points), series%y(trend_points))
      do i = 1, trend_points
         k = ((i - 1)*(n - 1))/(trend_points - 1)
         series%x(i) = real(k, dp)*record%sample_interval
         series%y(i) = evaluate_trend(channel%clean%trend, k)
      end do
   end subroutine set_trend

   !> The first outliers: samples of the record that the cleaned series does not have.
   subroutine set_outliers(series, values, interval, kept, marks)
      type(series_type), intent(inout) :: series
      real(dp), intent(in) :: values(:), interval
      !> 1 where the cleaned series has a sample: [n]
      integer(int8), intent(in) :: kept(:)
      !> 1 where the record has one: [n]; everywhere if absent
      integer(int8), intent(in), optional :: marks(:)
      integer(int64) :: found(max_outliers), k
      integer :: n

      n = 0
      do k = 1, size(kept, kind=int64)
         if (kept(k) /= 0_int8 .or. n == max_outliers) cycle
         if (.not. is_present(k, marks)) cycle
         n = n + 1
         found(n) = k
      end do
      if (n == 0) return
      series = series_type("outliers", "points", 4, real(found(:n) - 1, dp)*interval, values(found(:n)))
   end subroutine set_outliers

end module gyroakf_report_figure_series
