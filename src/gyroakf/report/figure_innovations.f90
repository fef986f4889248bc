! SPDX-License-Identifier: MIT
!> Figure of the adaptive filters at work: their innovations over their standard deviations, and the variance R that they estimate.
module gyroakf_report_figure_innovations
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_filter_trace, only : trace_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_figure_script, only : add_curve, begin_block, begin_script, black, blue, end_block, end_plot, literal, &
      purple, put_axes, put_numbers
   implicit none (type, external)
   private
   public :: write_innovations_figure, write_innovations_data

contains

   !> Panels: the innovations of each adaptive filter with the limits that 95 % of them keep; below, R of both.
   subroutine write_innovations_figure(writer, name, form, channel, time, unit)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of the figure; its format
      character(*), intent(in) :: name, form
      !> With an adaptive filter
      type(channel_result_type), intent(in) :: channel
      !> Units of time and rate
      character(*), intent(in) :: time, unit
      integer :: curves

      call begin_script(writer, name, form, channel%name//": innovations of the adaptive filters over their standard deviations", &
                        .true.)
      call put_axes(writer, "time, "//time, "normalised innovation", "")
      call put_line(writer, "set lmargin 11")
      call put_line(writer, "set autoscale xfix")
      call put_line(writer, "set multiplot layout "//trim(merge("3,1", "2,1", channel%available%akf .and. &
                                                                channel%available%drift_akf)))
      curves = 0
      if (channel%available%akf) then
         call add_curve(writer, curves, "'"//name//".dat' index 'akf'", "lines lc rgb "//purple, "AKF (paper)")
         call add_limits(writer, curves)
      end if
      if (channel%available%akf .and. channel%available%drift_akf) call put_line(writer, "unset title")
      if (channel%available%drift_akf) then
         call add_curve(writer, curves, "'"//name//".dat' index 'drift_akf'", "lines lc rgb "//blue, "drift AKF")
         call add_limits(writer, curves)
      end if
      call put_line(writer, "set title "//literal(channel%name//": variance of the measurement noise that they estimate")// &
                    " noenhanced")
      call put_line(writer, "set ylabel "//literal("R, ("//unit//")²")//" noenhanced")
      call put_line(writer, "set logscale y")
      call put_line(writer, "set format y '%.1e'")
      if (channel%available%akf) call add_curve(writer, curves, "'"//name//".dat' index 'akf_r'", &
                                                "lines lw 1.5 lc rgb "//purple, "AKF (paper)")
      if (channel%available%drift_akf) call add_curve(writer, curves, "'"//name//".dat' index 'drift_akf_r'", &
                                                      "lines lw 1.5 dt 2 lc rgb "//blue, "drift AKF")
      call end_plot(writer, curves)
      call put_line(writer, "unset multiplot")
   end subroutine write_innovations_figure

   !> The limits that 95 % of right innovations keep; ends the plot.
   subroutine add_limits(writer, curves)
      type(writer_type), intent(inout) :: writer
      integer, intent(inout) :: curves

      call add_curve(writer, curves, "1.96", "lines lw 1.5 dt 2 lc rgb "//black, "95 % limits")
      call add_curve(writer, curves, "-1.96", "lines lw 1.5 dt 2 lc rgb "//black, "")
      call end_plot(writer, curves)
   end subroutine add_limits

   !> What it draws: blocks by name, lines of time and value.
   subroutine write_innovations_data(writer, channel, interval)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> With an adaptive filter
      type(channel_result_type), intent(in) :: channel
      !> Between samples, s; 1 without a rate
      real(dp), intent(in) :: interval

      if (channel%available%akf) call put_trace(writer, "akf", channel%akf%trace, interval)
      if (channel%available%drift_akf) call put_trace(writer, "drift_akf", channel%drift_akf%trace, interval)
   end subroutine write_innovations_data

   !> Innovations and R of one filter.
   subroutine put_trace(writer, name, trace, interval)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name
      type(trace_type), intent(in) :: trace
      real(dp), intent(in) :: interval

      call begin_block(writer, name)
      call put_extremes(writer, trace%innovation%at, trace%innovation%value, interval)
      call begin_block(writer, name//"_r")
      call put_extremes(writer, trace%variance%at, trace%variance%value, interval)
   end subroutine put_trace

   !> Lowest and highest value of every stretch, in the order of time; the line is broken where a stretch has none.
   subroutine put_extremes(writer, at, value, interval)
      type(writer_type), intent(inout) :: writer
      !> Samples from 1, 0 where there is none, and the values there: [2, stretches]
      integer(int64), intent(in) :: at(:, :)
      real(dp), intent(in) :: value(:, :)
      real(dp), intent(in) :: interval
      integer :: i, early, late

      do i = 1, size(at, 2)
         if (at(1, i) == 0) then
            call put_line(writer, "")
            cycle
         end if
         early = merge(1, 2, at(1, i) <= at(2, i))
         late = 3 - early
         call put_numbers(writer, [real(at(early, i) - 1, dp)*interval, value(early, i)])
         if (at(early, i) /= at(late, i)) call put_numbers(writer, [real(at(late, i) - 1, dp)*interval, value(late, i)])
      end do
      if (any(at > 0)) then
         call end_block(writer)
      else
         call end_block(writer, 2)
      end if
   end subroutine put_extremes

end module gyroakf_report_figure_innovations
