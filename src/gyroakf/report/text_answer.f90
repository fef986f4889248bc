! SPDX-License-Identifier: MIT
!> The head of a report: a row for each channel with its noise, and what a Kalman filter takes of
!> it.
module gyroakf_report_text_answer
   use gyroakf_kinds, only : dp
   use gyroakf_coefficient_units, only : coefficient_unit, coefficient_unit_type
   use gyroakf_io_writer, only : writer_type, put_line
   use gyroakf_record, only : record_type, text_type, view_channel
   use gyroakf_pipeline_result, only : allan_result_type, channel_result_type, &
      pipeline_result_type, stage, stated_coefficient_type
   use gyroakf_report_input, only : has_unit, unit_name, time_unit
   use gyroakf_report_text_layout, only : if_known, number, put_item, put_paragraph, &
      report_width, rounded
   use gyroakf_report_text_table, only : add_cell, add_row, column_widths, new_table, put_table, &
      table_type
   use gyroakf_units, only : quantity
   use gyroakf_report_verdicts, only : verdict_text
   implicit none (type, external)
   private
   public :: put_answer, make_answer, coefficient_text

   integer, parameter :: term_n = 2, term_k = 4

contains

   !> A table for each group of channels of one unit, and the numbers of a Kalman filter.
   subroutine put_answer(writer, record, result)
      type(writer_type), intent(inout) :: writer
      !> For units and rate
      type(record_type), intent(in) :: record
      !> Nothing is written where no Allan deviation was fitted
      type(pipeline_result_type), intent(in) :: result
      type(record_type) :: view
      type(text_type) :: unit(size(result%channel))
      integer :: first, last, i
      logical :: fitted(size(result%channel))

      do i = 1, size(fitted)
         fitted(i) = result%channel(i)%allan(stage%input)%fitted
         call view_channel(record, i, view)
         unit(i)%text = unit_name(view)
      end do
      last = 0
      do while (last < size(fitted))
         first = last + 1
         last = first
         do while (last < size(fitted))
            if (unit(last + 1)%text /= unit(first)%text) exit
            last = last + 1
         end do
         if (any(fitted(first:last))) call put_group(writer, record, &
                                                     result%channel(first:last), first)
      end do
      if (.not. any(fitted)) return
      call put_paragraph(writer, "+/-: standard error; <: 95 % limit, not detected; -: withheld")
   end subroutine put_answer

   !> The channels of one unit.
   subroutine put_group(writer, record, channel, first)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel(:)
      integer, intent(in) :: first
      type(table_type) :: table
      type(record_type) :: view
      integer, allocatable :: width(:)
      logical :: too_wide
      integer :: c

      call put_line(writer, "")
      call view_channel(record, first, view)
      call make_answer(view, channel, table)
      call column_widths(table, width)
      too_wide = 2 + sum(width) + size(width) - 1 > report_width
      if (too_wide) table%cell = table%cell(:, :7)
      call put_table(writer, table)
      if (too_wide) call put_verdicts()
      if (record%rate_known) call put_filter_numbers()

   contains

      !> The verdicts below a table that is too narrow for them: "gx, gy stationary; gz drifts:
      !> random walk".
      subroutine put_verdicts()
         character(:), allocatable :: text, names
         integer :: i

         text = ""
         do c = 1, size(channel)
            names = ""
            do i = 1, size(channel)
               if (verdict_text(channel(i)) /= verdict_text(channel(c))) cycle
               if (i < c) exit
               names = names//", "//channel(i)%name
            end do
            if (names == "") cycle
            text = text//if_known(text /= "", "; ")//if_known(size(channel) > 1, names(3:)//" ")// &
               trim(verdict_text(channel(c)))
         end do
         call put_item(writer, "Noise", text, verbatim=.true.)
      end subroutine put_verdicts

      !> N and K of the channel with the largest N, in SI, as a Kalman filter at the rate of the
      !> record takes them: of the record without outliers where some were removed.
      subroutine put_filter_numbers()
         character(:), allocatable :: text
         integer :: which(size(channel))

         which = [(merge(stage%outliers_removed, stage%input, &
                         channel(c)%allan(stage%outliers_removed)%available), c=1, size(channel))]
         c = maxloc([(channel(c)%allan(which(c))%stated%term(term_n)%value_si, &
                      c=1, size(channel))], dim=1)
         associate (n => channel(c)%allan(which(c))%stated%term(term_n), &
                    k => channel(c)%allan(which(c))%stated%term(term_k))
            if (.not. (n%detected .and. n%value_si > 0.0_dp)) return
            text = "N "//number(n%value_si, 3)//" "//n%unit_si//" ("// &
               number(n%value_si/sqrt(record%sample_interval), 3)//" "// &
               if_known(view%unit%quantity == quantity%acceleration, "m/s^2", "rad/s")// &
               " rms a sample)"
            if (k%fitted) text = text//", K "//if_known(k%detected, number(k%value_si, 3), "< "// &
                                                        number(k%upper_limit_si, 2))//" "//k%unit_si
            call put_item(writer, "Kalman filter", &
                          "at "//number(1.0_dp/record%sample_interval, 5)//" Hz in SI"// &
                          if_known(which(c) /= stage%input, ", without outliers")//": "//text// &
                          if_known(size(channel) > 1, " ("//channel(c)%name//", the largest N)"))
         end associate
      end subroutine put_filter_numbers

   end subroutine put_group

   !> A row for each channel of one unit, and another one where outliers matter.
   subroutine make_answer(record, channel, table)
      !> For the units of mean and tau
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel(:)
      type(table_type), intent(out) :: table
      type(coefficient_unit_type) :: unit(term_n:term_k)
      integer :: c

      do c = term_n, term_k
         unit(c) = coefficient_unit(record%unit, c, .not. record%rate_known)
      end do
      call new_table(table, 8, head=2)
      call add_row(table, "", "mean", "N", "B", "K", "minimum", "at tau", "noise")
      call add_row(table, "", if_known(has_unit(record), unit_name(record)), unit(term_n)%name, &
                   unit(3)%name, unit(term_k)%name, unit(3)%name, time_unit(record))
      do c = 1, size(channel)
         call add_series(channel(c)%name, channel(c)%raw%mean, channel(c)%allan(stage%input))
         call add_cell(table, trim(verdict_text(channel(c))))
         if (outliers_matter(channel(c))) call add_series(" no outliers", channel(c)%level%mean, &
            channel(c)%allan(stage%outliers_removed))
      end do

   contains

      !> Mean, N, B, K and the lowest Allan deviation of a series.
      subroutine add_series(name, mean, allan)
         character(*), intent(in) :: name
         real(dp), intent(in) :: mean
         type(allan_result_type), intent(in) :: allan

         associate (term => allan%stated%term, read_off => allan%read_off)
            call add_row(table, name, number(mean, 3), coefficient_text(term(term_n)), &
                         coefficient_text(term(3)), coefficient_text(term(term_k)), &
                         if_known(read_off%known, number(read_off%minimum, 3)), &
                         if_known(read_off%known, number(read_off%minimum_tau, 4)))
         end associate
      end subroutine add_series

   end subroutine make_answer

   !> Without the outliers another term is detected, or one is more than its standard error away.
   elemental logical function outliers_matter(channel)
      type(channel_result_type), intent(in) :: channel
      integer :: i

      outliers_matter = .false.
      if (.not. channel%allan(stage%outliers_removed)%available) return
      do i = term_n, term_k
         associate (a => channel%allan(stage%input)%stated%term(i), &
                    b => channel%allan(stage%outliers_removed)%stated%term(i))
            outliers_matter = outliers_matter .or. (a%detected .neqv. b%detected) .or. &
               (a%detected .and. b%detected .and. abs(a%value - b%value) > a%std_error)
         end associate
      end do
   end function outliers_matter

   !> "2.484 +/- 0.007", "< 130", "-".
   pure function coefficient_text(stated) result(text)
      !> In the stated unit
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: text

      text = "-"
      if (.not. stated%fitted) return
      text = "< "//number(stated%upper_limit, 3)
      if (stated%detected) text = rounded(stated%value, stated%std_error)
   end function coefficient_text

end module gyroakf_report_text_answer
