! SPDX-License-Identifier: MIT
!> The Allan deviations of a result, drawn in characters.
module gyroakf_report_text_chart
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type, stage
   use gyroakf_record, only : record_type, text_type, view_channel
   use gyroakf_report_chart, only : draw_chart
   use gyroakf_report_figure_allan, only : alike_channels
   use gyroakf_report_input, only : unit_name, time_unit
   use gyroakf_report_text_layout, only : put_heading
   implicit none (type, external)
   private
   public :: put_chart

   integer, parameter :: chart_rows = 9

contains

   !> The Allan deviation of a single channel with its limits and the fit; of several those that
   !> have the unit of the first.
   subroutine put_chart(writer, record, result)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For units and rate
      type(record_type), intent(in) :: record
      !> Nothing is drawn where it has no Allan deviation
      type(pipeline_result_type), intent(in) :: result
      type(text_type), allocatable :: lines(:)
      type(record_type) :: first
      character(:), allocatable :: legend
      real(dp), allocatable :: model(:)
      integer :: i

      call view_channel(record, 1, first)
      allocate (lines(0))
      if (size(result%channel) > 1) then
         call draw_overlay(writer, record, result, lines, legend)
      else if (result%channel(1)%allan(stage%input)%available) then
         legend = "o measured, | limits"
         associate (allan => result%channel(1)%allan(stage%input), &
                    curve => result%channel(1)%allan(stage%input)%curve)
            model = 0*curve%tau
            if (allan%fitted) model = allan%noise%model
            if (allan%fitted) legend = legend//", . fitted"
            call draw_chart(curve%tau, curve%deviation, curve%lower, curve%upper, writer%unicode, &
                            lines, model, chart_rows)
         end associate
      end if
      if (size(lines) == 0) return
      call put_heading(writer, "Allan deviation in "//unit_name(first)//" against tau in "// &
                       time_unit(record)//": "//legend)
      do i = 1, size(lines)
         call put_line(writer, lines(i)%text)
      end do
   end subroutine put_chart

   !> The curves of several channels, a letter each.
   subroutine draw_overlay(writer, record, result, lines, legend)
      type(writer_type), intent(in) :: writer
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(in) :: result
      type(text_type), allocatable, intent(out) :: lines(:)
      !> "x gx, y gy"
      character(:), allocatable, intent(out) :: legend
      real(dp), allocatable :: tau(:), deviation(:)
      character(1), allocatable :: mark(:)
      logical :: drawn(size(result%channel))
      character(1) :: letter
      integer :: c, i

      drawn = alike_channels(record, result, 1)
      allocate (tau(0), deviation(0), mark(0))
      legend = ""
      do c = 1, size(result%channel)
         if (.not. drawn(c)) cycle
         letter = mark_of(result, drawn, c)
         legend = legend//", "//letter//" "//result%channel(c)%name
         associate (curve => result%channel(c)%allan(stage%input)%curve)
            tau = [tau, curve%tau]
            deviation = [deviation, curve%deviation]
            mark = [character(1) :: mark, (letter, i=1, size(curve%tau))]
         end associate
      end do
      legend = legend(min(3, len(legend) + 1):)
      call draw_chart(tau, deviation, deviation, deviation, writer%unicode, lines, &
                      rows=chart_rows, mark=mark)
   end subroutine draw_overlay

   !> The last letter of a channel's name, where these differ; else a, b, c, ...
   pure character(1) function mark_of(result, drawn, c)
      type(pipeline_result_type), intent(in) :: result
      !> The channels in the chart: [channel]
      logical, intent(in) :: drawn(:)
      integer, intent(in) :: c
      character(size(drawn)) :: last
      integer :: i, n

      n = 0
      do i = 1, size(drawn)
         if (.not. drawn(i)) cycle
         n = n + 1
         last(n:n) = " "
         associate (name => result%channel(i)%name)
            if (len(name) > 0) last(n:n) = name(len(name):)
         end associate
         if (i == c) mark_of = last(n:n)
      end do
      do i = 1, n
         if (iachar(last(i:i)) > iachar(" ") .and. iachar(last(i:i)) < 127 .and. &
             index(last(:n), last(i:i)) == i) cycle
         mark_of = achar(iachar("a") + modulo(count(drawn(:c)) - 1, 26))
         return
      end do
   end function mark_of

end module gyroakf_report_text_chart
