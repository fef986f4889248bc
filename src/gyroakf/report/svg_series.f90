! SPDX-License-Identifier: MIT
!> Series of a figure in its frame, and their legend below it.
!>
!> Colors are those of Okabe and Ito, distinguishable by the color-blind. Series and their entries
!> in the legend share
!> `data-series`, by which the script of a page shows and hides them.
module gyroakf_report_svg_series
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_report_axis, only : axis_type, is_inside, is_shown, position
   use gyroakf_report_svg_draw, only : put_circle, put_path, put_pixels, put_text
   implicit none (type, external)
   private
   public :: series_type, color_count, put_series, put_legend, legend_bottom, any_within

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
   !> Letters that fit into a column on a narrow screen
   integer, parameter :: column_letters = 31

contains

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
            ends = max(y%to, min(y%from, position(y, [series%lower(i), series%upper(i)])))
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

   !> Whether a point of a series lies in a box to the right of a pixel, above and below it.
   pure logical function any_within(series, x, y, at, extent)
      type(series_type), intent(in) :: series(:)
      type(axis_type), intent(in) :: x, y
      real(dp), intent(in) :: at(2), extent(2)
      real(dp) :: across, down
      integer :: i, k

      any_within = .false.
      do i = 1, size(series)
         associate (s => series(i))
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

end module gyroakf_report_svg_series
