! SPDX-License-Identifier: MIT
!> Elements of an SVG: lines, circles, texts; the series of a figure and their legend below it.
!>
!> Series and their entries in the legend share `data-series`, by which the script of a page shows
!> and hides them.
module gyroakf_report_svg_series
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_report_axis, only : axis_type, is_inside, is_shown, position
   use gyroakf_report_html_markup, only : put_escaped
   implicit none (type, external)
   private
   public :: series_type, color_count, put_series, put_legend, legend_bottom, places
   public :: put_path, put_pixels, put_text

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

   !> Colors of series
   integer, parameter :: color_count = 6
   !> Pixels of a legend: its rows, its columns
   real(dp), parameter :: row_height = 26.0_dp, legend_column(0:1) = [12.0_dp, 356.0_dp]
   !> Pixel of what is not drawn
   real(dp), parameter, public :: outside = -1.0_dp
   !> Styles with a line, and with points
   character(6), parameter :: line_styles(3) = [character(6) :: "line", "both", "guide"], &
                              dot_styles(3) = [character(6) :: "points", "both", "mark"]
   !> Letters that fit into a column on a narrow screen
   integer, parameter :: column_letters = 31

contains

   !> Line, error bars as far as they are inside, points of one series.
   subroutine put_series(writer, series, number, x, y)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      integer, intent(in) :: number
      type(axis_type), intent(in) :: x, y
      real(dp), allocatable :: at(:, :)
      real(dp) :: ends(2)
      logical :: hollow
      integer :: i

      if (.not. allocated(series%x)) return
      at = places(series, x, y)
      call put_group(writer, "series "//trim(series%style), series, number)
      if (any(series%style == line_styles)) call put_path(writer, "", at(1, :), at(2, :))
      do i = 1, merge(size(at, 2), 0, any(series%style == dot_styles))
         if (at(1, i) <= outside) cycle
         if (allocated(series%lower)) then
            if (is_shown(y, series%lower(i)) .and. is_shown(y, series%upper(i))) then
               ends = max(y%to, min(y%from, position(y, [series%lower(i), series%upper(i)])))
               call put_path(writer, "bar", [at(1, i), at(1, i)], ends)
            end if
         end if
         hollow = .false.
         if (allocated(series%hollow)) hollow = series%hollow(i)
         call put_circle(writer, series, at(:, i), i, hollow)
      end do
      call put_line(writer, "</g>")
   end subroutine put_series

   !> Pixels of the points of a series, `outside` where one cannot be shown or is beyond an axis:
   !> [x and y, point].
   pure function places(series, x, y) result(at)
      type(series_type), intent(in) :: series
      type(axis_type), intent(in) :: x, y
      real(dp), allocatable :: at(:, :)
      integer :: i

      i = 0
      if (allocated(series%x)) i = size(series%x)
      allocate (at(2, i), source=outside)
      do i = 1, size(at, 2)
         if (.not. (is_inside(x, series%x(i)) .and. is_inside(y, series%y(i)))) cycle
         at(:, i) = [position(x, series%x(i)), position(y, series%y(i))]
      end do
   end function places

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

   !> The labels of the series, the last one first, in two columns below the frame, each behind a
   !> sample of what is drawn.
   subroutine put_legend(writer, series, top)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series(:)
      real(dp), intent(in) :: top
      real(dp) :: at(2)
      integer :: cell(size(series)), i

      cell = legend_cells(series)
      do i = size(series), 1, -1
         associate (s => series(i))
            if (cell(i) < 0) cycle
            at = [legend_column(modulo(cell(i), 2)), top + row_height*real(cell(i)/2, dp)]
            call put_group(writer, "key "//trim(s%style), s, i)
            if (allocated(s%x)) then
               if (any(s%style == line_styles)) call put_path(writer, "", &
                                                              at(1) + [0.0_dp, 28.0_dp], &
                                                              [at(2), at(2)])
               if (any(s%style == dot_styles)) call put_circle(writer, s, at + [14, 0], 0, .false.)
            end if
            call put_text(writer, "start", at(1) + 38.0_dp, at(2) + 5.0_dp, s%label)
            call put_line(writer, "</g>")
         end associate
      end do
   end subroutine put_legend

   !> Pixel below the last row of a legend.
   pure real(dp) function legend_bottom(series, top)
      type(series_type), intent(in) :: series(:)
      real(dp), intent(in) :: top

      legend_bottom = top + row_height*real((maxval(legend_cells(series)) + 2)/2, dp) - 8.0_dp
   end function legend_bottom

   !> The cell of each series in a legend, from 0 along its rows, -1 without a label; a long label
   !> takes a row.
   pure function legend_cells(series) result(cell)
      type(series_type), intent(in) :: series(:)
      integer :: cell(size(series))
      integer :: i, next

      cell = -1
      next = 0
      do i = size(series), 1, -1
         if (.not. allocated(series(i)%label)) cycle
         if (len(series(i)%label) > column_letters) next = next + modulo(next, 2)
         cell(i) = next
         next = next + merge(2, 1, len(series(i)%label) > column_letters)
      end do
   end function legend_cells

   !> A line through pixels, broken where they are outside.
   subroutine put_path(writer, class, x, y)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: class
      real(dp), intent(in) :: x(:), y(:)
      character(1) :: step
      integer :: i

      call put(writer, "<path")
      if (class /= "") call put(writer, " class="""//class//"""")
      call put(writer, " d=""")
      step = "M"
      do i = 1, size(x)
         if (x(i) > outside) call put_pixels(writer, step, [x(i), y(i)], "")
         step = merge("L", "M", x(i) > outside)
      end do
      call put_line(writer, """/>")
   end subroutine put_path

   !> A text at a pixel of its base line.
   subroutine put_text(writer, class, x, y, text)
      type(writer_type), intent(inout) :: writer
      !> Its anchor: start, middle or end; or title
      character(*), intent(in) :: class
      real(dp), intent(in) :: x, y
      !> Any; nothing is written for ""
      character(*), intent(in) :: text

      if (text == "") return
      call put_pixels(writer, "<text class="""//class//""" x=""", [x], """")
      call put_pixels(writer, " y=""", [y], """>")
      call put_escaped(writer, text)
      call put_line(writer, "</text>")
   end subroutine put_text

   !> A point; the ring of a mark, smaller in the legend.
   subroutine put_circle(writer, series, at, number, hollow)
      type(writer_type), intent(inout) :: writer
      type(series_type), intent(in) :: series
      real(dp), intent(in) :: at(2)
      !> Of the point in its series, 0 in the legend
      integer, intent(in) :: number
      logical, intent(in) :: hollow
      character(6) :: name
      real(dp) :: radius

      name = merge("hollow", "dot   ", hollow)
      radius = 3.8_dp
      if (series%style == "mark") then
         name = "ring"
         radius = merge(9.0_dp, 8.0_dp, number > 0)
      end if
      call put_pixels(writer, "<path class="""//trim(name)//""" data-i=""", [real(number, dp)], "")
      call put_pixels(writer, """ d=""M", [at(1) - radius, at(2)], "")
      call put_pixels(writer, "a", [radius, radius, 0.0_dp, 1.0_dp, 0.0_dp, 2*radius, 0.0_dp], "")
      call put_pixels(writer, "a", [radius, radius, 0.0_dp, 1.0_dp, 0.0_dp, -2*radius, 0.0_dp], &
                      "z""/>")
      call put_line(writer, "")
   end subroutine put_circle

   !> Numbers to a tenth of a pixel or finer, separated by blanks, between two texts.
   subroutine put_pixels(writer, before, value, behind)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: before
      real(dp), intent(in) :: value(:)
      character(*), intent(in) :: behind
      integer :: i

      call put(writer, before)
      do i = 1, size(value)
         if (i > 1) call put(writer, " ")
         call put_real(writer, value(i), 4)
      end do
      call put(writer, behind)
   end subroutine put_pixels

end module gyroakf_report_svg_series
