! SPDX-License-Identifier: MIT
!> A figure of a page: what gnuplot drew (SVG), taken into the page, its names made those of one figure among many.
module gyroakf_report_html_figure
   use gyroakf_io_writer, only : writer_type, put, put_line
   use gyroakf_report_html_markup, only : close_list, put_attribute, put_element
   implicit none (type, external)
   private
   public :: html_figure, drawn_by

   !> Where a name stands in an SVG: it gets a prefix
   character(7), parameter :: references(5) = [character(7) :: " id='", " id=""", "href='#", "href=""#", "url(#"]

contains

   !> Writes the figure with its caption; nothing where the text holds no SVG.
   subroutine html_figure(writer, svg, prefix, caption, attributes)
      !> The page
      type(writer_type), intent(inout) :: writer
      !> The file that gnuplot wrote
      character(*), intent(in) :: svg
      !> Before every name in it; letters, digits and -
      character(*), intent(in) :: prefix
      !> What it shows
      character(*), intent(in) :: caption
      !> Further attributes of the figure, escaped, with a blank before each
      character(*), intent(in) :: attributes
      integer :: first

      first = index(svg, "<svg")
      if (first == 0) return
      call close_list(writer)
      call put(writer, "<figure"//attributes//"><div class=""plot"" tabindex=""0"" role=""group""")
      call put_attribute(writer, "aria-label", caption)
      call put(writer, "><svg role=""img""")
      call put_attribute(writer, "aria-label", caption)
      call put_renamed(writer, svg(first + 4:), prefix)
      call put_line(writer, "</div>")
      call put_element(writer, "figcaption", caption)
      call put_line(writer, "</figure>")
   end subroutine html_figure

   !> The drawing without gnuplot's title and description, each name in it with the prefix.
   subroutine put_renamed(writer, svg, prefix)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: svg, prefix
      integer :: first, last, i

      first = 1
      if (index(svg, "<title>Gnuplot</title>") > 0 .and. index(svg, "</desc>") > 0) then
         last = index(svg, "<title>Gnuplot</title>") - 1
         call put(writer, svg(:last))
         first = index(svg, "</desc>") + len("</desc>")
      end if
      i = first
      do while (i <= len(svg))
         if (svg(i:i) /= " " .and. svg(i:i) /= "h" .and. svg(i:i) /= "u") then
            i = i + 1
            cycle
         end if
         last = end_of_reference(svg, i)
         if (last > 0) then
            call put(writer, svg(first:last)//prefix)
            first = last + 1
            i = last
         end if
         i = i + 1
      end do
      call put(writer, svg(first:))
   end subroutine put_renamed

   !> The last byte before a name, where a reference to one or its definition begins at a byte; else 0.
   pure integer function end_of_reference(svg, i) result(last)
      character(*), intent(in) :: svg
      integer, intent(in) :: i
      integer :: k

      last = 0
      do k = 1, size(references)
         associate (n => len_trim(references(k)))
            if (i + n - 1 > len(svg)) cycle
            if (svg(i:i + n - 1) == references(k)(:n)) last = i + n - 1
         end associate
      end do
   end function end_of_reference

   !> "GNUPLOT 5.4 patchlevel 4", as the drawing says; "" where it does not.
   pure function drawn_by(svg) result(text)
      !> The file that gnuplot wrote
      character(*), intent(in) :: svg
      character(:), allocatable :: text
      integer :: first, length

      text = ""
      first = index(svg, "Produced by ")
      if (first == 0) return
      first = first + len("Produced by ")
      length = index(svg(first:), "</desc>") - 1
      if (length < 1 .or. length > 60) return
      text = trim(svg(first:first + length - 1))
   end function drawn_by

end module gyroakf_report_html_figure
