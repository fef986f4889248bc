! SPDX-License-Identifier: MIT
!> The part of a report that tells what is periodic in a channel.
module gyroakf_report_periodicity
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_series_lines, only : line_type
   use gyroakf_report_layout, only : put_heading, put_item, number, p_value_text, plural, count_text
   use gyroakf_report_table, only : table_type, new_table, set_cell, put_table
   use gyroakf_report_input, only : unit_name
   implicit none (type, external)
   private
   public :: put_periodicity

   !> Fisher's test decides at this level
   real(dp), parameter :: level = 0.01_dp
   !> Fewer periods in what was looked at are drift
   integer(int64), parameter :: fewest_periods = 5_int64
   !> Lines with less than this share of the variance are small, with more than that large
   real(dp), parameter :: small_share = 1.0e-3_dp, large_share = 0.05_dp

contains

   !> Fisher's test, lines, spectrum.
   subroutine put_periodicity(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit
      type(record_type), intent(in) :: record
      !> Its results
      type(channel_result_type), intent(in) :: channel

      if (.not. (channel%available%periodicity .or. channel%available%spectrum)) return
      call put_heading(writer, "Periodicity of the cleaned series")
      if (channel%available%periodicity) then
         call put_fisher(writer, channel)
         if (channel%periodicity%searched) call put_lines(writer, record, channel)
      end if
      if (channel%available%spectrum) call put_welch(writer, channel)
   end subroutine put_periodicity

   !> Fisher's test.
   subroutine put_fisher(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (fisher => channel%periodicity%fisher)
         text = verdict(channel)//": Fisher's g "//number(fisher%statistic, 3)//" at "//number(channel%fisher_frequency, 5)//" "// &
                trim(channel%frequency_unit)//", the largest of "//plural(fisher%ordinates, "ordinate")//", "// &
                p_value_text(fisher%p_value)//", of "//trim(channel%whitened)
      end associate
      if (channel%periodicity%samples < channel%periodicity%total - channel%periodicity%order) then
         text = text//"; it and the lines are of "//count_text(channel%periodicity%samples)//" of "// &
                count_text(channel%periodicity%total)//" samples, from the middle"
      end if
      call put_item(writer, "Fisher", text)
   end subroutine put_fisher

   !> What the largest ordinate is: chance, a line of the table, drift, or correlation.
   pure function verdict(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      integer :: i

      text = "no single period stands out"
      if (.not. channel%periodicity%fisher%p_value < level) return
      do i = 1, merge(size(channel%periodicity%line), 0, channel%periodicity%searched)
         associate (line => channel%periodicity%line(i))
            if (abs(line%frequency - channel%fisher_frequency) > 2.0_dp*line%width) cycle
            text = "a period stands out, that of the line at "//number(line%frequency, 5)//" "//trim(channel%frequency_unit)
            return
         end associate
      end do
      if (channel%periodicity%fisher%ordinate < fewest_periods) then
         text = "slow changes stand out, less than "//count_text(fewest_periods)//" periods in the record: drift, not a period"
      else if (channel%periodicity%searched) then
         text = "a peak stands out that is no line: correlation that a model does not describe"
      else
         text = "a period stands out, or correlation that a model does not describe"
      end if
   end function verdict

   !> A table of the lines, and what they amount to.
   subroutine put_lines(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      type(table_type) :: table
      integer :: i

      if (size(channel%periodicity%line) == 0) then
         call put_item(writer, "Lines", "none found")
         return
      end if
      text = plural(size(channel%periodicity%line, kind=int64), "line")//" with "//number(100*channel%line_share, 2)// &
             " % of the variance: "
      if (channel%line_share < small_share) then
         text = text//"small, seen because the record is long"
      else if (channel%line_share < large_share) then
         text = text//"vibration, or interference, that a model of the noise does not contain"
      else
         text = text//"strong vibration, or interference: find its source before the coefficients are used"
      end if
      call put_item(writer, "Lines", text//". A line at f may also be one at any |k fs +- f|, fs being the sample rate")
      call new_table(table, size(channel%periodicity%line) + 1, 6)
      call set_cell(table, 1, 2, "frequency, "//trim(channel%frequency_unit))
      call set_cell(table, 1, 3, "amplitude, "//unit_name(record))
      call set_cell(table, 1, 4, "share, %")
      call set_cell(table, 1, 5, "p")
      do i = 1, size(channel%periodicity%line)
         call fill_row(table, i + 1, channel%periodicity%line(i), channel)
      end do
      call put_table(writer, table, 1)
   end subroutine put_lines

   !> One line of the table.
   subroutine fill_row(table, row, line, channel)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: row
      type(line_type), intent(in) :: line
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = p_value_text(line%p_value)
      call set_cell(table, row, 2, number(line%frequency, 7)//" +/- "//number(line%frequency_error, 2))
      call set_cell(table, row, 3, number(line%amplitude, 4)//" +/- "//number(line%amplitude_error, 2))
      call set_cell(table, row, 4, number(100*line%share, 3))
      call set_cell(table, row, 5, text(3 + merge(2, 0, text(3:3) == "="):))
      if (line%harmonic > 0) then
         call set_cell(table, row, 6, count_text(int(line%harmonic, int64))//" x "// &
                       number(channel%periodicity%line(line%fundamental)%frequency, 5)//" "//trim(channel%frequency_unit))
      else if (.not. line%steady) then
         call set_cell(table, row, 6, "wanders over "//number(line%width, 2)//" "//trim(channel%frequency_unit))
      end if
   end subroutine fill_row

   !> The spectrum.
   subroutine put_welch(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (spectrum => channel%spectrum)
         text = "Welch: a density every "//number(spectrum%resolution, 4)//" "//trim(channel%frequency_unit)//", mean of "// &
                plural(spectrum%used, "segment")//" of "//count_text(spectrum%segment)//" samples ("//trim(spectrum%window)// &
                ", overlap "//number(100*spectrum%overlap, 3)//" %, "//count_text(nint(spectrum%degrees_of_freedom, int64))// &
                " degrees of freedom); --out writes it (spectrum.csv)"
         if (spectrum%used < spectrum%segments) text = text//"; "//count_text(spectrum%segments - spectrum%used)// &
            " left out, more than half missing"
      end associate
      call put_item(writer, "Spectrum", text)
   end subroutine put_welch

end module gyroakf_report_periodicity
