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
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_input, only : time_unit, unit_name
   use gyroakf_report_sign, only : to_unicode
   use gyroakf_report_svg, only : figure_type
   use gyroakf_report_svg_series, only : series_type
   use gyroakf_stats_trend, only : evaluate_trend
   implicit none (type, external)
   private
   public :: build_series_figure, max_blocks

   !> Blocks of a long series, points of a trend, outliers
   integer(int64), parameter :: max_blocks = 550, trend_points = 200, max_outliers = 300

contains

   !> The record with its outliers, its trend and its drift; or the cleaned series and the outputs
   !> of the filters. Without series where there are no samples, or where no output was kept.
   subroutine build_series_figure(record, number, channel, filtered, figure)
      !> With its samples, or without
      type(record_type), intent(in), target :: record
      !> Of the channel in it
      integer, intent(in) :: number
      !> Trend, drift and outliers are drawn where they are known, a drift that no model describes
      !> is not
      type(channel_result_type), intent(in) :: channel
      !> The outputs of the filters, not the record
      logical, intent(in) :: filtered
      !> Ready to be written
      type(figure_type), intent(out) :: figure
      integer(int8), pointer :: marks(:)
      type(record_type) :: view
      integer(int64) :: i, k(trend_points)

      if (filtered .and. .not. (allocated(channel%series_kf) .or. &
                                allocated(channel%series_akf))) return
      if (.not. (filtered .or. allocated(record%value))) return
      call view_channel(record, number, view)
      figure%title = channel%name//", record"
      if (filtered) figure%title = channel%name//", cleaned and filtered"
      figure%x_label = "time, "//time_unit(record)
      figure%y_label = to_unicode(unit_name(view))
      figure%caption = "Lowest and highest sample of each block of a long record."
      allocate (figure%series(4))
      if (filtered) then
         call set_series(1, "cleaned", -1, channel%series_cleaned, channel%series_present)
         call set_series(2, "KF", 2, channel%series_kf, channel%series_present)
         call set_series(3, "AKF", 1, channel%series_akf, channel%series_present)
         return
      end if
      marks => null()
      if (allocated(record%present)) marks => record%present(:, number)
      call set_series(1, "record", -1, record%value(:, number), marks)
      if (allocated(channel%series_present)) call set_outliers(record%value(:, number), &
                                                               channel%series_present, marks)
      ! the trend that was removed
      if (channel%clean%trend%degree >= 1) then
         k = [(((i - 1)*(size(record%value, 1, kind=int64) - 1))/(trend_points - 1), i=1, &
               trend_points)]
         figure%series(3)%label = "trend"
         figure%series(3)%color = 1
         figure%series(3)%x = real(k, dp)*record%sample_interval
         figure%series(3)%y = [(evaluate_trend(channel%clean%trend, k(i)), i=1, trend_points)]
      end if
      if (.not. allocated(channel%drift_doubt)) then
         call set_series(4, "drift (smoother)", 2, channel%series_drift)
      end if

   contains

      !> Every sample of a short series, lowest and highest sample of each block of a long one; NaN
      !> where a block has none.
      subroutine set_series(i, label, color, values, marks)
         !> Its place in the figure
         integer, intent(in) :: i
         character(*), intent(in) :: label
         integer, intent(in) :: color
         !> Absent: nothing is drawn
         real(dp), intent(in), contiguous, optional :: values(:)
         !> 1 present, 0 missing: [n]; all are present if absent
         integer(int8), intent(in), optional :: marks(:)
         integer(int64) :: n, length, first, last, points, ends(2), k
         logical, allocatable :: there(:)

         if (.not. present(values)) return
         n = size(values, kind=int64)
         length = 1
         if (n > 2*max_blocks) length = (n + max_blocks - 1)/max_blocks
         associate (series => figure%series(i))
            series%label = label
            series%color = color
            allocate (series%x(2*((n + length - 1)/length)))
            allocate (series%y, mold=series%x)
            points = 0
            do first = 1, n, length
               last = min(n, first + length - 1)
               there = [(is_present(k, marks), k=first, last)]
               ends = [minloc(values(first:last), 1, there, kind=int64), &
                       maxloc(values(first:last), 1, there, kind=int64)]      ! 0 of an empty block
               ends = first - 1 + [minval(ends), maxval(ends)]
               do k = 1, merge(1, 2, ends(1) == ends(2))
                  points = points + 1
                  series%x(points) = real(ends(k) - 1, dp)*record%sample_interval
                  series%y(points) = ieee_value(0.0_dp, ieee_quiet_nan)
                  if (ends(k) >= first) series%y(points) = values(ends(k))
               end do
            end do
            series%x = series%x(:points)
            series%y = series%y(:points)
         end associate
      end subroutine set_series

      !> The first outliers: samples of the record that the cleaned series does not have.
      subroutine set_outliers(values, kept, marks)
         real(dp), intent(in) :: values(:)
         !> 1 where the cleaned series, and where the record has a sample: [n]; everywhere if absent
         integer(int8), intent(in) :: kept(:)
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
         figure%series(2) = series_type("outliers", "points", 4, &
                                        real(found(:n) - 1, dp)*record%sample_interval, &
                                        values(found(:n)))
      end subroutine set_outliers

   end subroutine build_series_figure

   !> A sample is there.
   pure logical function is_present(k, marks)
      integer(int64), intent(in) :: k
      integer(int8), intent(in), optional :: marks(:)

      is_present = .true.
      if (present(marks)) is_present = marks(k) /= 0_int8
   end function is_present

end module gyroakf_report_figure_series
