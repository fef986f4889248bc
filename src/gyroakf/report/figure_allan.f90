! SPDX-License-Identifier: MIT
!> Figures of the Allan analysis: the curve with its limits, the fitted terms and what is read off it; the curves before and after.
!>
!> The curves stand in a data file beside the scripts; the terms are formulas with the fitted numbers in them.
module gyroakf_report_figure_allan
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, format_real, put_line
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, stage, stage_names
   use gyroakf_report_figure_script, only : add_curve, begin_block, begin_script, black, blue, end_block, &
      end_plot, green, grey, literal, orange, purple, put_axes, put_numbers, sky, yellow
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   implicit none (type, external)
   private
   public :: write_allan_figure, write_stages_figure, write_allan_data

   !> Q N B K R: what the line is called, and its formula behind the coefficient
   character(1), parameter :: letters(5) = ["Q", "N", "B", "K", "R"]
   character(24), parameter :: formulas(5) = [character(24) :: "sqrt(3)/x", "1/sqrt(x)", "sqrt(2*log(2)/pi)", "sqrt(x/3)", &
                                              "x/sqrt(2)"]
   character(9), parameter :: colours(5) = [purple, orange, green, yellow, sky]
   !> Where each is read off the line of its slope: sqrt 3, 1, (anywhere), 3, sqrt 2; the height there over the coefficient
   real(dp), parameter :: read_at(5) = [sqrt(3.0_dp), 1.0_dp, 0.0_dp, 3.0_dp, sqrt(2.0_dp)]
   !> Curve, sign and words of each series
   character(16), parameter :: stage_titles(6) = [character(16) :: "as read", "without outliers", "cleaned", "KF (paper)", &
                                                   "AKF (paper)", "compensated"]
   character(9), parameter :: stage_colours(6) = [black, sky, blue, orange, purple, green]

contains

   !> The curve of the record as read, or of the cleaned series where that is all there is.
   subroutine write_allan_figure(writer, name, form, channel, time, unit)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of the figure; its format
      character(*), intent(in) :: name, form
      !> With a curve of the record as read
      type(channel_result_type), intent(in) :: channel
      !> Units of time and rate
      character(*), intent(in) :: time, unit
      character(:), allocatable :: input
      integer :: curves, i

      input = "'"//name//".dat' index 'input' using 1:"

      associate (allan => channel%allan(stage%input))
         call begin_script(writer, name, form, "Overlapping Allan deviation of "//channel%name, .false.)
         call put_axes(writer, "averaging time τ, "//time, "deviation, "//unit, "xy")
            call put_line(writer, "set samples 300")
         call put_line(writer, "set xrange ["//number(0.7_dp*allan%curve%tau(1))//":"// &
                       number(1.5_dp*allan%curve%tau(size(allan%curve%tau)))//"]")
         call put_line(writer, "set yrange ["//number(0.5_dp*minval(allan%curve%lower))//":"// &
                       number(2.0_dp*maxval(allan%curve%upper))//"]")
         call put_read_off(writer, allan)
         curves = 0
         call add_curve(writer, curves, input//"3:4", "filledcurves fc rgb "//blue, &
                        format_real(100*allan%curve%confidence, 3)//" % limits")
         if (allan%fitted) then
            call add_curve(writer, curves, input//"5", "lines lw 2 lc rgb "//black, "fitted model")
            do i = 1, size(letters)
               call add_term(writer, curves, allan, i)
            end do
         end if
         call add_curve(writer, curves, "$read_off using 1:2", "points pt 6 ps 1.6 lw 2 lc rgb "//grey, "read off")
         call add_curve(writer, curves, input//"2", "points pt 7 ps 0.6 lc rgb "//blue, "deviation")
         call end_plot(writer, curves)
      end associate
   end subroutine write_allan_figure

   !> The curves of all series that have one.
   subroutine write_stages_figure(writer, name, form, channel, data, time, unit)
      !> As of write_allan_figure
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: name, form
      type(channel_result_type), intent(in) :: channel
      !> Name of the figure whose data these are
      character(*), intent(in) :: data
      character(*), intent(in) :: time, unit
      integer :: curves, i

      call begin_script(writer, name, form, "Allan deviation of "//channel%name//" before and after", .false.)
      call put_axes(writer, "averaging time τ, "//time, "deviation, "//unit, "xy")
      curves = 0
      do i = 1, size(channel%allan)
         if (.not. channel%allan(i)%available) cycle
         call add_curve(writer, curves, "'"//data//".dat' index '"//trim(stage_names(i))//"' using 1:2", &
                        "linespoints lw 1.5 pt "//digit(3 + i)//" ps 0.7 dt "//digit(i)//" lc rgb "//stage_colours(i), &
                        trim(stage_titles(i)))
      end do
      call end_plot(writer, curves)
   end subroutine write_stages_figure

   !> The curves of all series that have one: averaging time, deviation, limits, fitted model.
   subroutine write_allan_data(writer, channel)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> With its curves
      type(channel_result_type), intent(in) :: channel
      real(dp) :: point(5)
      integer :: i, k

      do i = 1, size(channel%allan)
         if (.not. channel%allan(i)%available) cycle
         call begin_block(writer, trim(stage_names(i)))
         associate (allan => channel%allan(i), curve => channel%allan(i)%curve)
            do k = 1, size(curve%tau)
               point = [curve%tau(k), curve%deviation(k), curve%lower(k), curve%upper(k), ieee_value(0.0_dp, ieee_quiet_nan)]
               if (allan%fitted) then
                  if (allan%noise%model(k) > 0.0_dp) point(5) = allan%noise%model(k)
               end if
               call put_numbers(writer, point)
            end do
         end associate
         call end_block(writer)
      end do
   end subroutine write_allan_data

   !> The line of a term that was found.
   subroutine add_term(writer, curves, allan, term)
      type(writer_type), intent(inout) :: writer
      integer, intent(inout) :: curves
      type(allan_result_type), intent(in) :: allan
      integer, intent(in) :: term

      associate (coefficient => allan%noise%coefficient(term))
         if (coefficient%detected) call add_curve(writer, curves, number(coefficient%value)//"*"//trim(formulas(term)), &
                                                  "lines lw 1.5 dt 2 lc rgb "//colours(term), letters(term))
      end associate
   end subroutine add_term

   !> Points of the classical rules, on the line of their slope, where its averaging time is in the figure; B at the lowest point.
   subroutine put_read_off(writer, allan)
      type(writer_type), intent(inout) :: writer
      type(allan_result_type), intent(in) :: allan
      integer :: i

      call put_line(writer, "$read_off << EOD")
      call put_line(writer, "nan,nan")
      do i = 1, size(letters)
         if (.not. allan%read%found(i)) cycle
         if (read_at(i) > 0) then
            call put_numbers(writer, [read_at(i), allan%read%value(i)])
         else
            call put_numbers(writer, [sqrt(allan%read%from_tau(i)*allan%read%to_tau(i)), &
                                      sqrt(2*log(2.0_dp)/acos(-1.0_dp))*allan%read%value(i)])
         end if
      end do
      call put_line(writer, "EOD")
   end subroutine put_read_off

   !> A number below ten.
   pure character(1) function digit(i)
      integer, intent(in) :: i

      digit = achar(iachar("0") + i)
   end function digit

   !> A number with ten digits.
   function number(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = format_real(value, 10)
   end function number

end module gyroakf_report_figure_allan
