! SPDX-License-Identifier: MIT
!> A figure as SVG: one frame with axes, grid, ticks, a second axis, slopes, series and a legend.
!>
!>     type(figure_type) :: figure
!>     allocate (figure%series(1))
!>     figure%series(1) = series_type(label="rate", x=time, y=rate)
!>     call write_svg(writer, figure, .true.)
module gyroakf_report_svg
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, format_real
   use gyroakf_report_html_markup, only : put_attribute, put_lines
   use gyroakf_report_axis, only : axis_type, find_ticks, is_shown, position, scale_axis, &
      set_range, tick_type
   use gyroakf_report_svg_series, only : legend_bottom, outside, places, put_legend, put_path, &
      put_pixels, put_series, put_text, series_type
   implicit none (type, external)
   private
   public :: figure_type, write_svg, has_points

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

   !> Stands at the head of every figure that is a document of its own
   character(*), parameter, public :: svg_mark = "<!-- Figure of gyroakf -->"
   !> Pixels: the whole width, borders of the frame, top of the legend
   real(dp), parameter :: width = 720.0_dp, left = 84.0_dp, right = 636.0_dp, top = 58.0_dp, &
      bottom = 368.0_dp, legend_top = 446.0_dp
   !> Spacing of labels along the axes
   real(dp), parameter :: x_spacing = 78.0_dp, y_spacing = 34.0_dp

   !> Colors of a document of its own; a page has the same variables
   character(*), parameter :: own_style(*) = [character(96) :: &
      "svg { --text: #1b1d20; --soft: #565c64; --card: #fff; --line: #cfd3d8;", &
      "  background: var(--card) }", &
      "@media screen and (prefers-color-scheme: dark) { svg { --text: #e6e7e9; --soft: #a9b0b9;", &
      "  --card: #16181b; --line: #3d434b } }"]
   !> The rules that a page needs for its figures; they take the variables --text, --soft, --card
   !> and --line of the page. Colors of the series are those of Okabe and Ito, distinguishable by
   !> the color-blind
   character(*), parameter, public :: svg_style(*) = [character(96) :: &
      ".fig { color: var(--text) } .fig .soft { color: var(--soft) }", &
      "  .fig text { fill: var(--text); stroke: none; font: 13px system-ui, 'Segoe UI', Roboto,", &
      "  'Noto Sans', 'DejaVu Sans', sans-serif }", &
      ".fig .title { font-weight: 600 }", &
      ".fig .middle { text-anchor: middle } .fig .end { text-anchor: end }", &
      ".fig .c1 { color: #0072b2 } .fig .c2 { color: #d55e00 } .fig .c3 { color: #008a63 }", &
      "  .fig .c4 { color: #b0558a }", &
      ".fig .c5 { color: #b07d00 } .fig .c6 { color: #3c93c9 }", &
      "@media screen and (prefers-color-scheme: dark) { .fig .c1 { color: #58b1ec }", &
      "  .fig .c2 { color: #ff8a3d } .fig .c3 { color: #33c79a } .fig .c4 { color: #e59ac7 }", &
      "  .fig .c5 { color: #f0c24f } .fig .c6 { color: #a5d8f8 } }", &
      ".fig path { fill: none; stroke: currentColor; stroke-width: 1.6;", &
      "  stroke-linejoin: round }", &
      ".fig .grid { stroke: var(--line); stroke-width: 1 } .fig .minor { opacity: 0.45 }", &
      "  .fig .frame { stroke: var(--soft) }", &
      ".fig .soft path { stroke-width: 1; opacity: 0.75 }", &
      "  .fig .guide path { stroke-dasharray: 7 4 }", &
      ".fig .mark path { stroke-width: 2.4 }", &
      ".fig .both path, .fig .points path { stroke-width: 1.3 }", &
      "  .fig .dot { fill: currentColor }", &
      ".fig .hollow { fill: var(--card) }", &
      ".plot .key { cursor: pointer } .fig .off { opacity: 0.4 }", &
      "  .fig .series.off { display: none }", &
      "@media (max-width: 40rem) { .fig text { font-size: 20px } }", &
      "@media print { .fig text { font-size: 13px } }"]

contains

   !> Writes a figure; it needs one point that can be shown.
   subroutine write_svg(writer, figure, alone)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> [[has_points]] holds
      type(figure_type), intent(in) :: figure
      !> A document of its own with its style; else an element of a page that has `svg_style`
      logical, intent(in) :: alone
      type(axis_type) :: x, y
      real(dp) :: low(2), high(2), extent(2), value(8)
      integer :: i
      character(2), parameter :: name(8) = ["x0", "x1", "x2", "x3", "y0", "y1", "y2", "y3"]

      call find_range(figure, low, high)
      x = axis_type(figure%logarithmic, from=left, to=right)
      y = axis_type(figure%logarithmic, from=bottom, to=top)
      call set_range(x, low(1), high(1), merge(0.03_dp, 0.0_dp, figure%logarithmic))
      call set_range(y, low(2), high(2), merge(0.1_dp, 0.04_dp, figure%logarithmic))
      extent = [width, legend_bottom(figure%series, legend_top)]
      if (alone) call put_line(writer, "<?xml version=""1.0"" encoding=""UTF-8""?>"// &
         new_line("a")//svg_mark)
      call put(writer, "<svg class=""fig"" role=""img""")
      if (alone) call put(writer, " xmlns=""http://www.w3.org/2000/svg""")
      call put_attribute(writer, "aria-label", figure%title//". "//figure%caption)
      call put_pixels(writer, " viewBox=""0 0 ", extent, """")
      call put_pixels(writer, " width=""", extent(:1), """")
      call put_pixels(writer, " height=""", extent(2:), """")
      ! what the script of a page takes to turn pixels into values
      if (.not. alone) then
         value = [x%from, x%to, x%first, x%last, y%from, y%to, y%first, y%last]
         do i = 1, size(name)
            call put_attribute(writer, "data-"//name(i), format_real(value(i), 17))
         end do
         if (x%logarithmic) call put_attribute(writer, "data-log", "1")
      end if
      call put_line(writer, ">")
      if (alone) then
         call put_lines(writer, [character(96) :: "<style>", own_style, svg_style, "</style>"])
      end if
      call put_text(writer, "title", 12.0_dp, 22.0_dp, figure%title)
      call put_axes()
      if (figure%logarithmic) call put_slopes()
      do i = 1, size(figure%series)
         call put_series(writer, figure%series(i), i, x, y)
      end do
      call put_legend(writer, figure%series, legend_top)
      call put_line(writer, "</svg>")

   contains

      !> Grid, ticks, labels and the frame; grid lines without a label are fainter.
      subroutine put_axes()
         character(10), parameter :: grid(0:1) = [character(10) :: "grid minor", "grid"]
         type(tick_type), allocatable :: tick(:)
         type(axis_type) :: second
         real(dp) :: at

         call find_ticks(x, x_spacing, tick)
         do i = 1, size(tick)
            at = position(x, tick(i)%value)
            call put_path(writer, trim(grid(min(1, len_trim(tick(i)%label)))), [at, at], &
                          [bottom, top])
            call put_text(writer, "middle", at, bottom + 22.0_dp, trim(tick(i)%label))
         end do
         call find_ticks(y, y_spacing, tick)
         do i = 1, size(tick)
            at = position(y, tick(i)%value)
            call put_path(writer, trim(grid(min(1, len_trim(tick(i)%label)))), [left, right], &
                          [at, at])
            call put_text(writer, "end", left - 7.0_dp, at + 5.0_dp, trim(tick(i)%label))
         end do
         call put_text(writer, "middle label", (left + right)/2, bottom + 48.0_dp, figure%x_label)
         call put_text(writer, "start label", 12.0_dp, top - 12.0_dp, figure%y_label)
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

      !> Three lines of the slopes -1/2, 0 and +1/2 in the first corner without points.
      subroutine put_slopes()
         character(4), parameter :: name(-1:1) = [character(4) :: "-1/2", "0", "+1/2"]
         real(dp), parameter :: label_width = 40.0_dp
         real(dp) :: rise, length, at(2)
         real(dp), allocatable :: point(:, :)
         logical :: free
         integer :: corner, slope

         rise = 0.5_dp*abs((y%to - y%from)/(y%last - y%first))*(x%last - x%first)/(x%to - x%from)
         length = min(60.0_dp, 36.0_dp/rise)
         do corner = 1, 4                      ! bottom left, top right, top left, bottom right
            at = [left + 12.0_dp, bottom - 16.0_dp - rise*length]
            if (modulo(corner, 2) == 0) at(1) = right - length - label_width - 12.0_dp
            if (corner == 2 .or. corner == 3) at(2) = top + 16.0_dp + rise*length
            free = .true.
            do i = 1, size(figure%series)
               point = places(figure%series(i), x, y)
               free = free .and. .not. any(point(1, :) > max(outside, at(1) - 6.0_dp) .and. &
                  point(1, :) < at(1) + length + label_width .and. &
                  abs(point(2, :) - at(2)) < rise*length + 12.0_dp)
            end do
            if (free) exit
         end do
         if (corner > 4) return
         call put_line(writer, "<g class=""soft"">")
         do slope = -1, 1
            call put_path(writer, "", at(1) + [0.0_dp, length], at(2) - rise*slope*[0.0_dp, length])
            call put_text(writer, "start", at(1) + length + 5.0_dp, &
                          at(2) - rise*slope*length + 5.0_dp, trim(name(slope)))
         end do
         call put_line(writer, "</g>")
      end subroutine put_slopes

   end subroutine write_svg

   !> Whether a figure has a point that can be shown.
   pure logical function has_points(figure)
      !> Any
      type(figure_type), intent(in) :: figure
      real(dp) :: low(2), high(2)

      call find_range(figure, low, high)
      has_points = all(low <= high)
   end function has_points

   !> Lowest and highest x and y of the points that can be shown, but those of guides.
   pure subroutine find_range(figure, low, high)
      type(figure_type), intent(in) :: figure
      real(dp), intent(out) :: low(2), high(2)
      logical, allocatable :: shown(:)
      type(axis_type) :: axis
      integer :: i

      low = huge(low)
      high = -huge(high)
      if (.not. allocated(figure%series)) return
      axis%logarithmic = figure%logarithmic
      do i = 1, size(figure%series)
         associate (s => figure%series(i))
            if (.not. allocated(s%x) .or. s%style == "guide") cycle
            shown = is_shown(axis, s%x) .and. is_shown(axis, s%y)
            low = min(low, [minval(s%x, mask=shown), minval(s%y, mask=shown)])
            high = max(high, [maxval(s%x, mask=shown), maxval(s%y, mask=shown)])
         end associate
      end do
   end subroutine find_range

end module gyroakf_report_svg
