! SPDX-License-Identifier: MIT
!> Part of a report on one channel: what was removed, and what that number means.
module gyroakf_report_removed
   use gyroakf_kinds, only : int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_preprocess_clean, only : clean_type
   use gyroakf_pipeline_result, only : channel_result_type, stage, stated_coefficient_type
   use gyroakf_pipeline_warnings, only : outlier_share
   use gyroakf_report_text_layout, only : count_text, number, percent, plural, put_item
   implicit none (type, external)
   private
   public :: put_alerts, cleaning_text

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
            text = percent(channel%clean%fraction)//" of the samples are rejected as outliers"
            if (raw%detected .or. cleaned%detected) text = text//": N = "//stated(raw)//" of the raw record, "//stated(cleaned)// &
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

   !> Outliers and trend in a line: "12 outliers (0.1 %) beyond 4.493 sigma (auto); cubic trend".
   pure function cleaning_text(clean) result(text)
      !> What was removed
      type(clean_type), intent(in) :: clean
      character(:), allocatable :: text

      text = "no outliers looked for"
      if (clean%method /= "none") text = plural(clean%removed, "outlier")//" ("//percent(clean%fraction)//") beyond "// &
         number(clean%threshold, 4)//" sigma ("//trim(clean%method)//")"
      if (clean%trend%degree >= 0) text = text//"; "//degree_name(clean%trend%degree)//" trend"
   end function cleaning_text

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
