! SPDX-License-Identifier: MIT
!> Figures of the Allan deviation: one channel with its fitted model, and the channels of one unit
!> over each other.
module gyroakf_report_figure_allan
   use gyroakf_allan_read_off, only : least_edf
   use gyroakf_kinds, only : dp
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, &
      pipeline_result_type, stage
   use gyroakf_record, only : record_type, view_channel
   use gyroakf_report_input, only : has_unit, unit_name, time_unit
   use gyroakf_report_svg, only : figure_type
   use gyroakf_report_svg_series, only : color_count, series_type
   use gyroakf_report_text_answer, only : coefficient_text
   use gyroakf_report_text_layout, only : if_known, number, percent, to_unicode
   use gyroakf_coefficient_units, only : coefficient_unit, coefficient_unit_type
   use gyroakf_units, only : term_names
   implicit none (type, external)
   private
   public :: build_allan_figure, build_overlay, minimum_note, alike_channels

   !> Terms that are drawn: K, B, N; slope of each, and its deviation at an averaging time of 1
   !> over the coefficient
   integer, parameter :: drawn_terms(3) = [4, 3, 2]
   real(dp), parameter :: term_slope(5) = [-1.0_dp, -0.5_dp, 0.0_dp, 0.5_dp, 1.0_dp]
   real(dp), parameter :: term_height(5) = [sqrt(3.0_dp), 1.0_dp, &
                                            sqrt(2*log(2.0_dp)/acos(-1.0_dp)), sqrt(1/3.0_dp), &
                                            sqrt(0.5_dp)]
   !> Relative difference of averaging times that are the same
   real(dp), parameter :: tolerance = 1.0e-6_dp

contains

   !> Measured points with confidence limits, hollow where excluded from the fit; model, terms,
   !> minimum; curves of the filters. Without series where there is no Allan deviation.
   subroutine build_allan_figure(record, channel, figure)
      !> [[view_channel]] of the channel
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      !> Ready to be written
      type(figure_type), intent(out) :: figure
      integer :: i

      if (.not. channel%allan(stage%input)%available) return
      call name_axes(record, figure)
      figure%title = "Overlapping Allan deviation of "//channel%name
      allocate (figure%series(8))
      call set_curve(figure%series(1), channel%allan(stage%akf), "AKF output", 4)
      call set_curve(figure%series(2), channel%allan(stage%kf), "KF output", 2)
      associate (allan => channel%allan(stage%input))
         figure%caption = "Error bars: "//percent(allan%curve%confidence)//" confidence limits"
         if (allan%noise%described) then
            figure%caption = figure%caption// &
               "; hollow: excluded from the fit. Dashed: detected terms"
            do i = 1, size(drawn_terms)
               call set_term(figure%series(2 + i), allan, drawn_terms(i))
            end do
            call set_curve(figure%series(7), allan, "fitted model", 0)
            figure%series(7)%y = allan%noise%model
         end if
         if (allan%read_off%known) then
            figure%caption = figure%caption//"; lowest reliable: "//minimum_note()
            figure%series(6)%style = "mark"
            figure%series(6)%x = [allan%read%minimum_tau]
            figure%series(6)%y = [allan%read%minimum]
            figure%series(6)%label = "lowest reliable "//number(allan%read_off%minimum, 3)//" "// &
               to_unicode(allan%stated%term(3)%unit)//" at "// &
               number(allan%read_off%minimum_tau, 3)//" "//time_unit(record)
         end if
         figure%caption = figure%caption//"."
         call set_curve(figure%series(8), allan, channel%name, 1, style="points")
         figure%series(8)%lower = allan%curve%lower
         figure%series(8)%upper = allan%curve%upper
         if (allan%noise%described) then
            figure%series(8)%hollow = allan%curve%tau < allan%noise%tau_first*(1 - tolerance) .or. &
               allan%curve%tau > allan%noise%tau_last*(1 + tolerance)
         end if
      end associate
   end subroutine build_allan_figure

   !> Curves of the channels that have the unit of one of them, this being the first; without
   !> series where it is the only one.
   subroutine build_overlay(record, result, first, figure)
      !> For units and rate
      type(record_type), intent(in) :: record
      !> All channels
      type(pipeline_result_type), intent(in) :: result
      !> Number of the channel
      integer, intent(in) :: first
      !> Ready to be written
      type(figure_type), intent(out) :: figure
      type(record_type) :: view
      logical :: alike(size(result%channel))
      integer :: c, drawn

      alike = alike_channels(record, result, first)
      if (count(alike) < 2 .or. any(alike(:first - 1)) .or. .not. alike(first)) return
      call view_channel(record, first, view)
      call name_axes(view, figure)
      figure%title = "Overlapping Allan deviation of all channels"
      if (has_unit(view)) figure%title = figure%title//" in "//to_unicode(unit_name(view))
      figure%caption = "Confidence limits and models: figures of the channels."
      allocate (figure%series(count(alike)))
      drawn = size(figure%series)
      do c = 1, size(alike)
         if (.not. alike(c)) cycle
         call set_curve(figure%series(drawn), result%channel(c)%allan(stage%input), &
                        result%channel(c)%name, &
                        1 + modulo(size(figure%series) - drawn, color_count), style="both")
         drawn = drawn - 1
      end do
   end subroutine build_overlay

   !> Which channels have the unit of one of them, and an Allan deviation.
   function alike_channels(record, result, channel) result(alike)
      !> For the units
      type(record_type), intent(in) :: record
      !> All channels
      type(pipeline_result_type), intent(in) :: result
      !> Number of the one
      integer, intent(in) :: channel
      logical :: alike(size(result%channel))
      type(record_type) :: view
      character(:), allocatable :: unit
      integer :: c

      call view_channel(record, channel, view)
      unit = unit_name(view)
      do c = 1, size(alike)
         call view_channel(record, c, view)
         alike(c) = unit_name(view) == unit .and. result%channel(c)%allan(stage%input)%available
      end do
   end function alike_channels

   !> Labels of the axes; on the right the unit of B.
   subroutine name_axes(record, figure)
      type(record_type), intent(in) :: record
      type(figure_type), intent(inout) :: figure
      type(coefficient_unit_type) :: unit

      figure%logarithmic = .true.
      figure%x_label = "averaging time τ, "//time_unit(record)
      figure%y_label = "Allan deviation, "//to_unicode(unit_name(record))
      if (.not. has_unit(record)) return
      unit = coefficient_unit(record%unit, 3, .not. record%rate_known)
      if (unit%name == record%unit%name) return
      figure%right_label = to_unicode(unit%name)
      figure%right_factor = record%unit%to_si*unit%from_si
   end subroutine name_axes

   !> The deviations of a curve, where there is one.
   subroutine set_curve(series, allan, label, color, style)
      type(series_type), intent(inout) :: series
      type(allan_result_type), intent(in) :: allan
      character(*), intent(in) :: label
      integer, intent(in) :: color
      !> A line without it
      character(*), intent(in), optional :: style

      if (.not. allan%available) return
      series%label = label
      series%color = color
      series%x = allan%curve%tau
      series%y = allan%curve%deviation
      if (present(style)) series%style = style
   end subroutine set_curve

   !> A term: its line where it is detected, its number in any case; many points, so that the line
   !> ends where it leaves the frame.
   subroutine set_term(series, allan, term)
      type(series_type), intent(inout) :: series
      type(allan_result_type), intent(in) :: allan
      integer, intent(in) :: term
      integer, parameter :: steps = 199
      integer :: i

      associate (stated => allan%stated%term(term), tau => allan%curve%tau)
         if (.not. stated%fitted) return
         series%style = "guide"
         series%color = 1 + term
         series%label = term_names(term)//if_known(stated%detected, " = ", " ")// &
            to_unicode(coefficient_text(stated)//" "//stated%unit)
         if (.not. stated%detected) return
         series%x = tau(1)*(tau(size(tau))/tau(1))**[(real(i, dp)/real(steps, dp), i=0, steps)]
         series%y = term_height(term)*allan%noise%coefficient(term)%value*series%x**term_slope(term)
      end associate
   end subroutine set_term

   !> Which points the minimum is among.
   pure function minimum_note() result(text)
      character(:), allocatable :: text

      text = "among points with at least "//number(least_edf, 3)//" degrees of freedom"
   end function minimum_note

end module gyroakf_report_figure_allan
