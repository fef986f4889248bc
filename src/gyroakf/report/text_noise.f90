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
   use gyroakf_report_text_table, only : add_row, new_table, put_table, table_type
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
      real(dp) :: none(0)
      integer :: i

      if (.not. allan%available) return
      if (allan%fitted) then
         call put_curve(writer, record, allan%curve, title, allan%noise%model)
      else
         call put_curve(writer, record, allan%curve, title, none)
      end if
      if (.not. allocated(allan%other)) return
      do i = 1, size(allan%other)
         if (allocated(allan%other(i)%tau)) then
           call put_curve(writer, record, allan%other(i), title, none)
         end if
      end do
   end subroutine put_curves_of

   !> One curve.
   subroutine put_curve(writer, record, curve, title, model)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(allan_curve_type), intent(in) :: curve
      character(*), intent(in) :: title
      !> Fitted deviation; of size 0 where there is none
      real(dp), intent(in) :: model(:)
      type(table_type) :: table
      character(:), allocatable :: fitted
      integer :: i

      call put_heading(writer, title//": "//trim(curve%kind)//" in "//unit_name(record)// &
                       if_known(curve%kind == "tdev", " times tau")//", tau in "// &
                       time_unit(record)//", "//number(100*curve%confidence, 4)//" % limits")
      call new_table(table, size(curve%tau) + 1, merge(7, 6, size(model) > 0), left=0)
      call add_row(table, "tau", "deviation;lower;upper;edf;terms;model")
      fitted = ""
      do i = 1, size(curve%tau)
         if (size(model) > 0) fitted = if_known(model(i) > 0.0_dp, number(model(i), 4), "-")
         call add_row(table, number(curve%tau(i), 6), number(curve%deviation(i), 6)//";"// &
                      number(curve%lower(i), 4)//";"//number(curve%upper(i), 4)//";"// &
                      number(curve%edf(i), 4)//";"//count_text(curve%terms(i))//";"//fitted)
      end do
      call put_table(writer, table)
   end subroutine put_curve

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
      character(:), allocatable :: units, cells
      integer :: term, which

      call new_table(table, 2, 6, head=2)
      table%name = "coefficients"
      table%number = "III"
      table%caption = "Noise coefficients from the Allan deviation"
      table%note = terms_text(record)//" +/-: one standard error; <: not detected, one-sided "// &
         "95 % limit."
      units = ""
      do term = 1, 5
         units = units//broken(coefficient_unit_name(channel, term))//";"
      end do
      call add_row(table, "", "Q;N;B;K;R")
      call add_row(table, "", units)
      do which = stage%input, stage%compensated
         if (.not. channel%allan(which)%available) cycle
         if (which == stage%cleaned .and. .not. channel%available%cleaned) cycle
         cells = ""
         do term = 1, 5
            cells = cells//compared_text(channel%allan(which), term)//";"
         end do
         call add_row(table, trim(series(which)), cells)
      end do
      associate (left => channel%allan(stage%compensated))
         if (left%fitted) table%note = table%note//" compensated: in-sample, from the first "// &
            count_text(int(left%noise%points, int64))//" octaves."
      end associate
      if (.not. any(channel%reduction_known .or. channel%reduction_at_least > 0.0_dp)) return
      table%note = table%note//" reduction: from cleaned to AKF."
      cells = ""
      do term = 1, 5
         cells = cells//reduction_text(channel, term)//";"
      end do
      call add_row(table, "reduction", cells)
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

   !> How much less the adaptive filter leaves.
   pure function reduction_text(channel, term) result(text)
      type(channel_result_type), intent(in) :: channel
      integer, intent(in) :: term
      character(:), allocatable :: text

      text = "-"
      if (channel%reduction_known(term)) then
         text = number(channel%reduction_percent(term), 3)//" %"
      else if (channel%reduction_at_least(term) > 0.0_dp) then
         text = "> "//number(channel%reduction_at_least(term), 3)//" %"
      end if
   end function reduction_text

   !> Unit of a term, from the first series that has one.
   pure function coefficient_unit_name(channel, term) result(name)
      type(channel_result_type), intent(in) :: channel
      integer, intent(in) :: term
      character(:), allocatable :: name
      integer :: which

      name = ""
      do which = stage%compensated, stage%input, -1
         if (channel%allan(which)%fitted) name = channel%allan(which)%stated%term(term)%unit
      end do
   end function coefficient_unit_name

   !> "Q quantization, N angle random walk, ..."
   pure function terms_text(record) result(text)
      !> For the quantity
      type(record_type), intent(in) :: record
      character(:), allocatable :: text

      select case (record%unit%quantity)
      case (quantity%angular_rate)
         text = "N angle random walk, B bias instability, K rate random walk"
      case (quantity%acceleration)
         text = "N velocity random walk, B bias instability, K random walk"
      case default
         text = "N white noise, B bias instability, K rate random walk"
      end select
      text = "Q quantization, "//text//", R ramp."
   end function terms_text

end module gyroakf_report_text_noise
