! SPDX-License-Identifier: MIT
!> The section of a report on the periodic components of a channel.
module gyroakf_report_text_periodicity
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_text_layout, only : put_heading, put_item, number, p_value_text, plural, count_text
   implicit none (type, external)
   private
   public :: put_periodicity

   !> Fisher's test decides at this level
   real(dp), parameter :: level = 0.01_dp
   !> Fewer periods in what was looked at are drift
   integer(int64), parameter :: fewest_periods = 5_int64

contains

   !> Fisher's test and spectrum.
   subroutine put_periodicity(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Its results
      type(channel_result_type), intent(in) :: channel

      if (.not. (channel%available%periodicity .or. channel%available%spectrum)) return
      call put_heading(writer, "Periodicity of the cleaned series")
      if (channel%available%periodicity) call put_fisher(writer, channel)
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
         text = text//"; the middle "//count_text(channel%periodicity%samples)//" of "// &
                count_text(channel%periodicity%total)//" samples"
      end if
      call put_item(writer, "Fisher", text)
   end subroutine put_fisher

   !> What the largest ordinate is: chance, drift, a period, or correlation.
   pure function verdict(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = "no single period stands out"
      if (.not. channel%periodicity%fisher%p_value < level) return
      if (channel%periodicity%fisher%ordinate < fewest_periods) then
         text = "slow changes stand out, less than "//count_text(fewest_periods)//" periods in the record: drift, not a period"
      else
         text = "a period stands out, or correlation that a model does not describe"
      end if
   end function verdict

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

end module gyroakf_report_text_periodicity
