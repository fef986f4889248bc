! SPDX-License-Identifier: MIT
!> Allan curve and Table III (noise coefficients before and after) of a report.
module gyroakf_report_text_noise
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_units, only : quantity
   use gyroakf_io_writer, only : writer_type
   use gyroakf_allan_deviations, only : allan_curve_type
   use gyroakf_pipeline_result, only : channel_result_type, allan_result_type, stage
   use gyroakf_report_text_layout, only : count_text, if_known, number, put_heading
   use gyroakf_report_text_table, only : add_cell, add_row, new_table, put_table, table_type
   use gyroakf_report_input, only : unit_name, time_unit
   implicit none (type, external)
   private
   public :: put_curves_of, make_comparison

contains

   !> The deviation curves with their confidence limits, and the fitted model beside the first.
   subroutine put_curves_of(writer, record, allan, title)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the units
      type(record_type), intent(in) :: record
      !> Curve, and the fit where there is one
      type(allan_result_type), intent(in) :: allan
      !> Which series
      character(*), intent(in) :: title
      integer :: i

      if (.not. allan%available) return
      call put_curve(allan%curve, allan%fitted)
      if (.not. allocated(allan%other)) return
      do i = 1, size(allan%other)
         if (allocated(allan%other(i)%tau)) call put_curve(allan%other(i), .false.)
      end do

   contains

      subroutine put_curve(curve, fitted)
         type(allan_curve_type), intent(in) :: curve
         !> The model is shown
         logical, intent(in) :: fitted
         type(table_type) :: table
         integer :: i

         call put_heading(writer, title//": "//trim(curve%kind)//" in "//unit_name(record)// &
                          if_known(curve%kind == "tdev", " times tau")//", tau in "// &
                          time_unit(record)//", "//number(100*curve%confidence, 4)//" % limits")
         call new_table(table, merge(7, 6, fitted), left=0)
         call add_row(table, "tau", "deviation", "lower", "upper", "edf", "terms")
         if (fitted) call add_cell(table, "model")
         do i = 1, size(curve%tau)
            call add_row(table, number(curve%tau(i), 6), number(curve%deviation(i), 6), &
                         number(curve%lower(i), 4), number(curve%upper(i), 4), &
                         number(curve%edf(i), 4), count_text(curve%terms(i)))
            if (fitted) call add_cell(table, if_known(allan%noise%model(i) > 0.0_dp, &
                                                      number(allan%noise%model(i), 4), "-"))
         end do
         call put_table(writer, table)
      end subroutine put_curve

   end subroutine put_curves_of

   !> Table III: a row for each series, a column for each term.
   subroutine make_comparison(record, channel, table)
      !> For the names of the terms
      type(record_type), intent(in) :: record
      !> Curves and coefficients as far as they are available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      character(11), parameter :: series(6) = [character(11) :: "raw", "no outliers", "cleaned", &
                                               "KF", "AKF", "compensated"]
      character(:), allocatable :: walks
      integer :: term, which

      call new_table(table, 6, head=2)
      table%number = "III"
      table%caption = "Noise coefficients from the Allan deviation"
      select case (record%unit%quantity)
      case (quantity%angular_rate); walks = "N angle random walk, B bias instability, K rate random walk"
      case (quantity%acceleration); walks = "N velocity random walk, B bias instability, K random walk"
      case default; walks = "N white noise, B bias instability, K rate random walk"
      end select
      table%note = "Q quantization, "//walks//", R ramp. +/-: one standard error; <: not detected, one-sided "// &
         "95 % limit."
      call add_row(table, "", "Q", "N", "B", "K", "R")
      call add_row(table, "")
      which = findloc(channel%allan%fitted, .true., dim=1)
      do term = 1, 5
         if (which > 0) call add_cell(table, broken(channel%allan(which)%stated%term(term)%unit))
      end do
      do which = stage%input, stage%compensated
         if (.not. channel%allan(which)%available) cycle
         if (which == stage%cleaned .and. .not. channel%available%cleaned) cycle
         call add_row(table, trim(series(which)))
         do term = 1, 5
            call add_cell(table, compared_text(channel%allan(which), term))
         end do
      end do
      associate (left => channel%allan(stage%compensated))
         if (left%fitted) table%note = table%note//" compensated: in-sample, from the first "// &
            count_text(int(left%noise%points, int64))//" octaves."
      end associate
      if (.not. any(channel%reduction_known .or. channel%reduction_at_least > 0.0_dp)) return
      table%note = table%note//" reduction: from cleaned to AKF."
      call add_row(table, "reduction")
      do term = 1, 5
         if (channel%reduction_known(term)) then
            call add_cell(table, number(channel%reduction_percent(term), 3)//" %")
         else
            call add_cell(table, if_known(channel%reduction_at_least(term) > 0.0_dp, "> "// &
                                          number(channel%reduction_at_least(term), 3)//" %", "-"))
         end if
      end do
   end subroutine make_comparison

   !> A unit in two lines where it is wide, the second one from its last factor on.
   pure function broken(text) result(lines)
      character(*), intent(in) :: text
      character(:), allocatable :: lines
      integer :: i

      lines = text
      if (len(text) <= 12) return
      i = scan(text, "*/", back=.true.)
      if (i > 1) lines = text(:i - 1)//new_line("a")//text(i:)
   end function broken

   !> The value and under it its error, or the limit.
   pure function compared_text(allan, term) result(text)
      type(allan_result_type), intent(in) :: allan
      integer, intent(in) :: term
      character(:), allocatable :: text

      text = "-"
      associate (stated => allan%stated%term(term))
         if (allan%fitted .and. stated%state == "withheld") text = "withheld"
         if (.not. (allan%fitted .and. stated%fitted)) return
         if (stated%detected) text = number(stated%value, 4)//new_line("a")//"+/- "// &
            number(stated%std_error, 2)
         if (.not. stated%detected) text = "< "//number(stated%upper_limit, 3)
      end associate
   end function compared_text

end module gyroakf_report_text_noise
