! SPDX-License-Identifier: MIT
!> Elements of an SVG: lines, circles, texts.
module gyroakf_report_svg_draw
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_report_html_markup, only : put_escaped
   implicit none (type, external)
   private
   public :: put_path, put_circle, put_text, put_pixels

contains

   !> A line through pixels.
   subroutine put_path(writer, class, x, y)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: class
      real(dp), intent(in) :: x(:), y(:)
      integer :: i

      call put(writer, "<path")
      if (class /= "") call put(writer, " class="""//class//"""")
      do i = 1, size(x)
         if (i == 1) call put_pixels(writer, " d=""M", [x(i), y(i)], "")
         if (i > 1) call put_pixels(writer, "L", [x(i), y(i)], "")
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

   !> A circle.
   subroutine put_circle(writer, class, at, radius, number)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: class
      real(dp), intent(in) :: at(2), radius
      !> Of the point in its series
      integer, intent(in) :: number

      call put_pixels(writer, "<path class="""//class//""" data-i=""", [real(number, dp)], "")
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

end module gyroakf_report_svg_draw
