! SPDX-License-Identifier: MIT
!> Part of a report on one channel: what was removed, and what that number means.
module gyroakf_report_removed
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_preprocess_clean, only : clean_type
   use gyroakf_pipeline_result, only : channel_result_type, stage, stated_coefficient_type
   use gyroakf_pipeline_warnings, only : outlier_share
   use gyroakf_report_text_layout, only : put_heading, put_item, number, scientific, count_text, plural
   use gyroakf_report_input, only : unit_name
   implicit none (type, external)
   private
   public :: put_alerts, put_removed, cleaning_text

   !> The variance before the cut is shown where it is larger by this factor
   real(dp), parameter :: cut_matters = 1.001_dp

contains

   !> The first lines of a channel, where more than 1 % of its samples are outliers or the sensor moves.
   subroutine put_alerts(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> With the coefficients of both series, where these were asked for
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (raw => channel%allan(stage%input)%stated%term(2), cleaned => channel%allan(stage%outliers_removed)%stated%term(2))
         if (channel%clean%fraction > outlier_share) then
            text = number(100*channel%clean%fraction, 3)//" % of the samples are rejected as outliers"
            if (raw%detected .or. cleaned%detected) text = text//": N = "//stated(raw)//" as read, "//stated(cleaned)// &
               & " without them"
            call put_item(writer, "Outliers", text)
         end if
      end associate
      if (.not. allocated(channel%clean%motion)) return
      if (size(channel%clean%motion) > 0) call put_item(writer, "Motion", "motion or vibration in "// &
         & plural(size(channel%clean%motion, 2, kind=int64), "place")//", of samples "// &
         & count_text(channel%clean%motion(1, 1))//" to "//count_text(channel%clean%motion(2, 1))//" first: nothing is "// &
         & "rejected there, see the warnings")
   end subroutine put_alerts

   !> "0.9687 deg/sqrt(h)".
   pure function stated(term) result(text)
      type(stated_coefficient_type), intent(in) :: term
      character(:), allocatable :: text

      text = "(not stated)"
      if (term%detected) text = number(term%value, 4)//" "//term%unit
   end function stated

   !> Outliers and trend.
   subroutine put_removed(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit
      type(record_type), intent(in) :: record
      !> `clean` is filled
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      integer :: i

      call put_heading(writer, "Removed")
      if (.not. channel%available%preprocess) then
         call put_item(writer, "Nothing", "the record is taken as it is")
         return
      end if
      if (channel%clean%method == "none") then
         call put_item(writer, "Outliers", "not looked for")
      else
         call put_item(writer, "Outliers", outlier_text(channel%clean)//"; marked missing")
         call put_item(writer, "By chance", chance_text(channel%clean))
         if (channel%clean%removed > 0 .and. channel%clean%corrected_variance > cut_matters*channel%clean%variance) then
            text = scientific(channel%clean%variance, 5)//" is left; of normal noise, whose tails are cut off too, it was "
            call put_item(writer, "Variance", text//scientific(channel%clean%corrected_variance, 5)// &
                          " before (in ("//unit_name(record)//")^2)")
         end if
      end if
      if (channel%clean%trend%degree < 0 .or. .not. allocated(channel%clean%trend%power)) then
         call put_item(writer, "Trend", "none removed")
         return
      end if
      text = ""
      do i = 0, channel%clean%trend%degree
         text = text//", c"//count_text(int(i, int64))//" = "// &
                scientific(channel%clean%trend%power(lbound(channel%clean%trend%power, 1) + i), 6)
      end do
      call put_item(writer, "Trend", degree_name(channel%clean%trend%degree)//" in the sample index i = 0, 1, ... : "// &
                    text(3:)//" ("//unit_name(record)//")")
   end subroutine put_removed

   !> "12 samples (0.1 %) beyond 4.098 sigma (rule: auto, 3 rounds)".
   pure function outlier_text(clean) result(text)
      !> What was removed
      type(clean_type), intent(in) :: clean
      character(:), allocatable :: text

      text = plural(clean%removed, "sample")//" ("//number(100*clean%fraction, 3)//" %) beyond "//number(clean%threshold, 4)// &
             " sigma (rule: "//trim(clean%method)//", "
      if (clean%half_width > 0) text = text//"windows of "//count_text(int(2*clean%half_width + 1, int64))//" samples, "
      text = text//plural(int(clean%passes, int64), "round")//")"
   end function outlier_text

   !> Outliers and trend in a line: "12 outliers (0.1 %) beyond 4.493 sigma (auto); cubic trend".
   pure function cleaning_text(clean) result(text)
      !> What was removed
      type(clean_type), intent(in) :: clean
      character(:), allocatable :: text

      text = "no outliers looked for"
      if (clean%method /= "none") text = plural(clean%removed, "outlier")//" ("//number(100*clean%fraction, 3)//" %) beyond "// &
         number(clean%threshold, 4)//" sigma ("//trim(clean%method)//")"
      if (clean%trend%degree >= 0) text = text//"; "//degree_name(clean%trend%degree)//" trend"
   end function cleaning_text

   !> How many samples without outliers the rule would have marked.
   pure function chance_text(clean) result(text)
      !> What was removed
      type(clean_type), intent(in) :: clean
      character(:), allocatable :: text

      if (clean%blind) then
         text = "none: of so few samples no one can be that far from their mean, whatever it is"
         return
      end if
      text = "the rule marks about "//number(clean%expected, 3)//" of as many samples of white normal noise"
      if (clean%removed > 0 .and. 2*clean%expected > real(clean%removed, dp)) text = text//": most of those are no outliers"
   end function chance_text

   !> The trend in words.
   pure function degree_name(degree) result(name)
      !> 0 or more
      integer, intent(in) :: degree
      character(:), allocatable :: name

      select case (degree)
      case (0); name = "constant"
      case (1); name = "straight line"
      case (2); name = "parabola"
      case (3); name = "cubic"
      case default; name = "polynomial of degree "//count_text(int(degree, int64))
      end select
   end function degree_name

end module gyroakf_report_removed
