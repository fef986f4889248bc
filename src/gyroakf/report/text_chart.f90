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
   use gyroakf_report_text_layout, only : if_known, put_heading
   implicit none (type, external)
   private
   public :: put_chart

   integer, parameter :: chart_rows = 9

contains

   !> The Allan deviation of a single channel with its limits and the fit; of several those that
   !> have the unit of the first, a letter each.
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
      real(dp), allocatable :: tau(:), deviation(:), lower(:), upper(:), model(:)
      character(1), allocatable :: mark(:)
      character(1) :: letters(size(result%channel))
      logical :: drawn(size(result%channel))
      integer :: c, i

      drawn = alike_channels(record, result, 1)
      call choose_letters(result, drawn, letters)
      allocate (tau(0), deviation(0), mark(0))
      legend = ""
      do c = 1, size(drawn)
         if (.not. drawn(c)) cycle
         legend = legend//", "//letters(c)//" "//result%channel(c)%name
         associate (curve => result%channel(c)%allan(stage%input)%curve)
            tau = [tau, curve%tau]
            deviation = [deviation, curve%deviation]
            mark = [character(1) :: mark, (letters(c), i=1, size(curve%tau))]
         end associate
      end do
      lower = deviation
      upper = deviation
      model = 0*tau
      if (size(drawn) == 1 .and. all(drawn)) then
         associate (allan => result%channel(1)%allan(stage%input))
            legend = ", o measured, | limits"//if_known(allan%fitted, ", . fitted")
            lower = allan%curve%lower
            upper = allan%curve%upper
            if (allan%fitted) model = allan%noise%model
         end associate
      end if
      call draw_chart(tau, deviation, lower, upper, writer%unicode, lines, model, chart_rows, mark)
      if (size(lines) == 0) return
      call view_channel(record, 1, first)
      call put_heading(writer, "Allan deviation in "//unit_name(first)//" against tau in "// &
                       time_unit(record)//": "//legend(3:))
      do i = 1, size(lines)
         call put_line(writer, lines(i)%text)
      end do
   end subroutine put_chart

   !> The last letter of each channel's name, where these differ; else a, b, c, ...; o of a single
   !> channel.
   pure subroutine choose_letters(result, drawn, letters)
      type(pipeline_result_type), intent(in) :: result
      !> The channels in the chart: [channel]
      logical, intent(in) :: drawn(:)
      character(1), intent(out) :: letters(:)
      integer :: i
      logical :: usable

      letters = " "
      usable = .true.
      do i = 1, size(drawn)
         if (.not. drawn(i)) cycle
         associate (name => result%channel(i)%name)
            if (len(name) > 0) letters(i) = name(len(name):)
         end associate
         usable = usable .and. letters(i) > " " .and. letters(i) < achar(127) .and. &
            count(letters(:i) == letters(i)) == 1
      end do
      do i = 1, size(drawn)
         if (.not. usable) letters(i) = achar(iachar("a") + modulo(count(drawn(:i)) - 1, 26))
      end do
      if (size(drawn) == 1) letters = "o"
   end subroutine choose_letters

end module gyroakf_report_text_chart
