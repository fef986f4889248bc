! SPDX-License-Identifier: MIT
!> A figure as SVG: one frame with axes, grid, ticks, a second axis, series and a legend, light and
!> dark.
!>
!>     type(figure_type) :: figure
!>     allocate (figure%series(1))
!>     figure%series(1) = series_type(label="rate", x=time, y=rate)
!>     call write_svg(writer, figure, .true.)
!>
!> Colors are those of Okabe and Ito, distinguishable by the color-blind. Series and their entries
!> in the legend share
!> `data-series`, by which the script of a page shows and hides them.
module gyroakf_report_svg
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_report_html_markup, only : put_attribute
   use gyroakf_report_svg_axis, only : axis_type, find_ticks, is_inside, is_shown, position, scale_axis, &
      set_range, tick_type
   use gyroakf_report_svg_draw, only : put_circle, put_path, put_pixels, put_text
   use gyroakf_report_svg_style, only : put_own_style
   implicit none (type, external)
   private
   public :: series_type, figure_type, write_svg, has_points, set_axes, color_count

   !> What one series draws
   type :: series_type
      !> In the legend; unallocated: not there
      character(:), allocatable :: label
      !> "line", "points" (with error bars), "both", "guide" (dashed, no part of the ranges),
      !> "mark" (rings)
      character(6) :: style = "line"
      !> 0 is that of the text, 1 to color_count, -1 a soft one
      integer :: color = 0
      !> [n]; a line is broken at points that cannot be shown
      real(dp), allocatable :: x(:), y(:)
      !> Ends of the error bars: [n]; unallocated: none
      real(dp), allocatable :: lower(:), upper(:)
      !> Points that are hollow: [n]; unallocated: none
      logical, allocatable :: hollow(:)
   end type series_type

   !> A figure
   type :: figure_type
      character(:), allocatable :: title, caption
      !> Labels of the axes
      character(:), allocatable :: x_label, y_label
      !> Of the second axis on the right, and its values over those on the left
      character(:), allocatable :: right_label
      real(dp) :: right_factor = 1.0_dp
      !> Both axes are logarithmic, and slopes -1/2, 0 and +1/2 are shown in a corner
      logical :: logarithmic = .false.
      !> In the order in which they are drawn, the reverse of that of the legend; those without
      !> points are in the legend alone
      type(series_type), allocatable :: series(:)
   end type figure_type

   !> Colors of series
   integer, parameter :: color_count = 6
   !> Pixels: the whole width, borders of the frame, of the legend its top, its rows and its columns
   real(dp), parameter :: width = 720.0_dp, left = 84.0_dp, right = 636.0_dp, top = 58.0_dp, &
      bottom = 368.0_dp, &
      legend_top = 446.0_dp, row_height = 26.0_dp, legend_column(0:1) = [12.0_dp, 356.0_dp]
   !> Spacing of labels along the axes, in pixels
   real(dp), parameter :: x_spacing = 78.0_dp, y_spacing = 34.0_dp

contains

   !> Writes a figure; it needs one point that can be shown.
   subroutine write_svg(writer, figure, alone)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> [[has_points]] holds
      type(figure_type), intent(in) :: figure
      !> A document of its own with its style; else an element of a page that has [[put_svg_style]]
      logical, intent(in) :: alone
      type(axis_type) :: x, y
      real(dp) :: height
      integer :: i, entries

      call set_axes(figure, x, y)
      entries = 0
      do i = 1, size(figure%series)
         if (allocated(figure%series(i)%label)) entries = entries + 1
      end do
      height = legend_top + row_height*real((entries + 1)/2, dp) - 8.0_dp
      if (alone) call put_line(writer, "<?xml version=""1.0"" encoding=""UTF-8""?>")
      call put(writer, "<svg class=""fig"" role=""img""")
      if (alone) call put(writer, " xmlns=""http://www.w3.org/2000/svg""")
      call put_attribute(writer, "aria-label", figure%title//". "//figure%caption)
      call put_pixels(writer, " viewBox=""0 0 ", [width, height], """")
      call put_pixels(writer, " width=""", [width], """")
      call put_pixels(writer, " height=""", [height], """>")
      if (alone) call put_own_style(writer)
      call put_text(writer, "title", 12.0_dp, 22.0_dp, figure%title)
      call put_axes(writer, figure, x, y)
      if (figure%logarithmic) call put_slopes(writer, figure, x, y)
      do i = 1, size(figure%series)
         call put_series(writer, figure%series(i), i, x, y)
      end do
      call put_legend(writer, figure)
      call put_line(writer, "</svg>")
   end subroutine write_svg

   !> Whether a figure has a point that can be shown.
   pure logical function has_points(figure)
      !> Any
      type(figure_type), intent(in) :: figure
      integer :: i

      has_points = .false.
      if (.not. allocated(figure%series)) return
      do i = 1, size(figure%series)
         if (.not. has_points) has_points = any(are_shown(figure, figure%series(i)))
      end do
   end function has_points

   !> Which points of a series can be shown and count for the ranges.
   pure function are_shown(figure, series) result(shown)
      type(figure_type), intent(in) :: figure
      type(series_type), intent(in) :: series
      logical, allocatable :: shown(:)
      type(axis_type) :: axis

      axis%logarithmic = figure%logarithmic
      if (.not. allocated(series%x) .or. series%style == "guide") then
         allocate (shown(0))
      else
         shown = is_shown(axis, series%x) .and. is_shown(axis, series%y)
      end if
   end function are_shown

   !> Axes that hold all points but those of guides.
   pure subroutine set_axes(figure, x, y)
      !> [[has_points]] holds
      type(figure_type), intent(in) :: figure
      !> Pixels from the left and from the top
      type(axis_type), intent(out) :: x, y
      real(dp) :: low(2), high(2)
      logical, allocatable :: shown(:)
      integer :: i

      low = huge(low)
      high = -huge(high)
      do i = 1, size(figure%series)
         shown = are_shown(figure, figure%series(i))
         if (.not. any(shown)) cycle
         associate (s => figure%series(i))
            low = min(low, [minval(s%x, mask=shown), minval(s%y, mask=shown)])
            high = max(high, [maxval(s%x, mask=shown), maxval(s%y, mask=shown)])
         end associate
      end do
      x = axis_type(figure%logarithmic, from=left, to=right)
      y = axis_type(figure%logarithmic, from=bottom, to=top)
      call set_range(x, low(1), high(1), merge(0.03_dp, 0.0_dp, figure%logarithmic))
      call set_range(y, low(2), high(2), merge(0.1_dp, 0.04_dp, figure%logarithmic))
   end subroutine set_axes

   !> Grid, ticks, labels and the frame.
   subroutine put_axes(writer, figure, x, y)
      type(writer_type), intent(inout) :: writer
      type(figure_type), intent(in) :: figure
      type(axis_type), intent(in) :: x, y
      type(tick_type), allocatable :: tick(:)
      type(axis_type) :: second
      real(dp) :: at
      integer :: i

      call find_ticks(x, x_spacing, tick)
      do i = 1, size(tick)
         at = position(x, tick(i)%value)
         call put_path(writer, grid_class(tick(i)), [at, at], [bottom, top])
         call put_text(writer, "middle", at, bottom + 22.0_dp, trim(tick(i)%label))
      end do
      call find_ticks(y, y_spacing, tick)
      do i = 1, size(tick)
         at = position(y, tick(i)%value)
         call put_path(writer, grid_class(tick(i)), [left, right], [at, at])
         call put_text(writer, "end", left - 7.0_dp, at + 5.0_dp, trim(tick(i)%label))
      end do
      call put_text(writer, "middle", (left + right)/2, bottom + 48.0_dp, figure%x_label)
      call put_text(writer, "start", 12.0_dp, top - 12.0_dp, figure%y_label)
      if (allocated(figure%right_label)) then
         second = scale_axis(y, figure%right_factor)
         call put_text(writer, "end", width - 12.0_dp, top - 12.0_dp, figure%right_label)
         call find_ticks(second, y_spacing, tick)
         do i = 1, size(tick)
            at = position(second, tick(i)%value)
            call put_path(writer, "frame", [right, right + 4.0_dp], [at, at])
            call put_text(writer, "start", right + 8.0_dp, at + 5.0_dp, trim(tick(i)%label))
         end do
      end if
      call put_path(writer, "frame", [left, right, right, left, left], &
                    [bottom, bottom, top, top, bottom])
   end subroutine put_axes

   !> Lines without a label are fainter.
   pure function grid_class(tick) result(name)
      type(tick_type), intent(in) :: tick
      character(:), allocatable :: name

      name = "grid"
      if (tick%label == "") name = "grid minor"
   end function grid_class

   !> Three lines of the slopes -1/2, 0 and +1/2 in the first corner without points.
   subroutine put_slopes(writer, figure, x, y)
      type(writer_type), intent(inout) :: writer
      type(figure_type), intent(in) :: figure
      type(axis_type), intent(in) :: x, y
      character(4), parameter :: name(-1:1) = [character(4) :: "-1/2", "0", "+1/2"]
      real(dp), parameter :: label_width = 40.0_dp
      real(dp) :: rise, length, at(2)
      integer :: corner, slope

      rise = 0.5_dp*abs((y%to - y%from)/(y%last - y%first))*(x%last - x%first)/(x%to - x%from)
      length = min(60.0_dp, 36.0_dp/rise)
      do corner = 1, 4                         ! bottom left, top right, top left, bottom right
         at = [left + 12.0_dp, bottom - 16.0_dp - rise*length]
         if (modulo(corner, 2) == 0) at(1) = right - length - label_width - 12.0_dp
         if (corner == 2 .or. corner == 3) at(2) = top + 16.0_dp + rise*length
         if (.not. any_within(figure, x, y, at, [length + label_width, rise*length + 12.0_dp])) exit
      end do
      if (corner > 4) return
      call put_line(writer, "<g class=""soft"">")
      do slope = -1, 1
         call put_path(writer, "", at(1) + [0.0_dp, length], at(2) - rise*slope*[0.0_dp, length])
         call put_text(writer, "start", at(1) + length + 5.0_dp, at(2) - rise*slope*length + 5.0_dp, &
                       trim(name(slope)))
      end do
      call put_line(writer, "</g>")
   end subroutine put_slopes

   !> Whether a point of a series lies in a box to the right of a pixel, above and below it.
   pure logical function any_within(figure, x, y, at, extent)
      type(figure_type), intent(in) :: figure
      type(axis_type), intent(in) :: x, y
      real(dp), intent(in) :: at(2), extent(2)
      real(dp) :: across, down
      integer :: i, k

      any_within = .false.
      do i = 1, size(figure%series)
         associate (s => figure%series(i))
            if (.not. allocated(s%x)) cycle
            do k = 1, size(s%x)
               if (.not. is_inside(x, s%x(k))) cycle
               if (.not. is_inside(y, s%y(k))) cycle
               across = position(x, s%x(k)) - at(1)
               down = abs(position(y, s%y(k)) - at(2))
               if (across < -6.0_dp .or. across > extent(1) .or. down > extent(2)) cycle
               any_within = .true.
            end do
         end associate
      end do
   end function any_within

   !> Line, error bars, points of one series.
   subroutine put_series(writer, series, number, x, y)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      integer, intent(in) :: number
      type(axis_type), intent(in) :: x, y
      integer :: i

      if (.not. allocated(series%x)) return
      call put_group(writer, "series "//trim(series%style), series, number)
      if (has_line(series)) call put_polyline(writer, series, x, y)
      if (any(series%style == [character(6) :: "points", "both", "mark"])) then
         do i = 1, size(series%x)
            if (.not. is_inside(x, series%x(i))) cycle
            if (is_inside(y, series%y(i))) call put_point(writer, series, i, x, y)
         end do
      end if
      call put_line(writer, "</g>")
   end subroutine put_series

   !> Begins a group; what it holds has the series' color.
   subroutine put_group(writer, class, series, number)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: class
      type(series_type), intent(in) :: series
      integer, intent(in) :: number

      call put(writer, "<g class="""//class)
      if (series%color > 0) call put_pixels(writer, " c", [real(series%color, dp)], "")
      if (series%color < 0) call put(writer, " soft")
      call put_pixels(writer, """ data-series=""", [real(number, dp)], """>")
   end subroutine put_group

   !> The points of a series in order, broken where one cannot be shown or is outside.
   subroutine put_polyline(writer, series, x, y)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      type(axis_type), intent(in) :: x, y
      character(1) :: step
      logical :: inside
      integer :: i

      call put(writer, "<path d=""")
      step = "M"
      do i = 1, size(series%x)
         inside = is_inside(x, series%x(i))
         if (inside) inside = is_inside(y, series%y(i))
         if (inside) then
            call put_pixels(writer, step, [position(x, series%x(i)), position(y, series%y(i))], "")
         end if
         step = merge("L", "M", inside)
      end do
      call put_line(writer, """/>")
   end subroutine put_polyline

   !> A point with its error bar, as far as that is inside; a ring of a mark.
   subroutine put_point(writer, series, i, x, y)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      integer, intent(in) :: i
      type(axis_type), intent(in) :: x, y
      character(:), allocatable :: class
      real(dp) :: at(2), ends(2)

      at = [position(x, series%x(i)), position(y, series%y(i))]
      if (allocated(series%lower)) then
         if (is_shown(y, series%lower(i)) .and. is_shown(y, series%upper(i))) then
            ends = max(top, min(bottom, position(y, [series%lower(i), series%upper(i)])))
            call put_path(writer, "bar", [at(1), at(1)], ends)
         end if
      end if
      class = "dot"
      if (allocated(series%hollow)) then
         if (series%hollow(i)) class = "hollow"
      end if
      if (series%style == "mark") class = "ring"
      call put_circle(writer, class, at, merge(9.0_dp, 3.8_dp, class == "ring"), i)
   end subroutine put_point

   !> The labels of the series, the last one first, in two columns below the frame, each behind a
   !> sample of what is drawn.
   subroutine put_legend(writer, figure)
      type(writer_type), intent(inout) :: writer
      type(figure_type), intent(in) :: figure
      real(dp) :: at(2)
      integer :: i, entry

      entry = 0
      do i = size(figure%series), 1, -1
         associate (s => figure%series(i))
            if (.not. allocated(s%label)) cycle
            at = [legend_column(modulo(entry, 2)), legend_top + row_height*real(entry/2, dp)]
            entry = entry + 1
            call put_group(writer, "key "//trim(s%style), s, i)
            if (allocated(s%x)) call put_sample(writer, s, at)
            call put_text(writer, "start", at(1) + 38.0_dp, at(2) + 5.0_dp, s%label)
            call put_line(writer, "</g>")
         end associate
      end do
   end subroutine put_legend

   !> A sample of what a series draws.
   subroutine put_sample(writer, series, at)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      !> Its left end
      real(dp), intent(in) :: at(2)

      if (has_line(series)) call put_path(writer, "", at(1) + [0.0_dp, 28.0_dp], [at(2), at(2)])
      select case (series%style)
      case ("points", "both"); call put_circle(writer, "dot", at + [14.0_dp, 0.0_dp], 3.8_dp, 0)
      case ("mark"); call put_circle(writer, "ring", at + [14.0_dp, 0.0_dp], 8.0_dp, 0)
      case default
      end select
   end subroutine put_sample

   !> Whether a series is drawn as a line.
   pure logical function has_line(series)
      type(series_type), intent(in) :: series

      has_line = any(series%style == [character(6) :: "line", "both", "guide"])
   end function has_line

end module gyroakf_report_svg
