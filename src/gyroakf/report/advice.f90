! SPDX-License-Identifier: MIT
!> The end of the report on a channel: what to make of its numbers, in plain sentences.
module gyroakf_report_advice
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type, text_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_filter_filter_series, only : filter_result_type
   use gyroakf_pipeline_result, only : channel_result_type, drift_process_type
   use gyroakf_report_text_layout, only : put_heading, put_point, put_items, number, count_text
   use gyroakf_report_input, only : has_unit, time_unit
   implicit none (type, external)
   private
   public :: put_advice, put_warnings

contains

   !> The sentences.
   subroutine put_advice(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For units and what is assumed
      type(record_type), intent(in) :: record
      !> All of it
      type(channel_result_type), intent(in) :: channel

      call put_heading(writer, "What to make of it")
      call put_attenuation(writer, channel)
      if (channel%available%ar .and. channel%ar%order > 0) then
         call put_point(writer, "AR("//count_text(int(channel%ar%order, int64))//") predicts "// &
                           number(channel%predictable_percent, 3)//" % of the variance one sample ahead"//squared(channel)// &
                           ": that is the largest reduction such a model can honestly give. A larger one is smoothing, "// &
                           "which acts on a rotation alike.")
      end if
      if (adapts_both(channel%akf)) call put_point(writer, "The adaptive filter estimates Q and R together. The variance "// &
         "of the innovations cannot tell them apart, so the gain wanders and depends on the start values; --akf robust "// &
         "estimates R alone.")
      call put_drift(writer, record, channel)
      call put_unresolved(writer, channel)
      if (.not. record%rate_known .or. .not. has_unit(record)) call put_point(writer, "Angle units are withheld: "// &
         "give "//missing_options(record)//" for deg/sqrt(h), deg/h and the other usual units.")
   end subroutine put_advice

   !> Warnings, and stages without a result; the filters' own warnings stand with their details.
   subroutine put_warnings(writer, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Its lists
      type(channel_result_type), intent(in) :: channel

      call put_items(writer, "Warning", channel%warnings)
      call put_items(writer, "Not available", channel%unavailable)
   end subroutine put_warnings

   !> The share of a true rotation that passes.
   subroutine put_attenuation(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      if (.not. channel%available%kf) return
      text = "Of a constant true rotation the Kalman filter passes "//number(channel%kf_figures%passed_percent, 3)//" %"
      if (channel%available%akf) text = text//" and the adaptive filter, at its mean gain over the last third, "// &
                                        number(channel%akf_figures%passed_percent, 3)//" %"
      call put_point(writer, text//". Their small variance is mostly this attenuation: bias instability, random walk and "// &
                        "a turn of the vehicle shrink alike. Do not hand these outputs to a navigation computation that "// &
                        "has to see the vehicle turn.")
   end subroutine put_attenuation

   !> Whether a drift was identified, and what it is good for.
   subroutine put_drift(writer, record, channel)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      if (.not. channel%available%drift) return
      if (.not. channel%drift%found) then
         call put_point(writer, "No drift slower than "//number(channel%drift_tau, 3)//" "//time_unit(record)// &
                        " was identified under the noise of the record: there is nothing that a filter could follow and subtract.")
         return
      end if
      if (allocated(channel%drift_doubt)) then
         text = "No drift model describes this record: "//channel%drift_doubt//"; what the drift filters follow is not known "// &
                "to be drift."
      else if (channel%verdict%stationary) then
         text = "The noise is stationary; what the drift filters follow is its slow part, as "//model_text(record, channel)//"."
      else
         text = "The drift filters model the record as "//model_text(record, channel)//"."
      end if
      if (channel%available%drift_kf) text = text//" The drift KF can follow this while the sensor is known to be at rest; "// &
         "of a constant rotation it takes "//number(channel%drift_kf_figures%passed_percent, 3)//" % for drift, so what is "// &
         "subtracted while the vehicle turns is the turn: at rest estimate, in motion only predict."
      call put_point(writer, text)
      if (channel%available%drift_smoother) call put_point(writer, "Off line the smoothed drift can be subtracted: that "// &
         "leaves "//number(100*channel%compensated_ratio, 4)//" % of the variance. It is in-sample, the best case, not a "// &
         "promise for the next record.")
   end subroutine put_drift

   !> Coefficients that this record cannot resolve.
   subroutine put_unresolved(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(5), parameter :: terms = "QNBKR"
      character(:), allocatable :: names
      integer :: term

      if (.not. channel%allan(1)%fitted) return
      names = ""
      do term = 1, 5
         if (channel%allan(1)%stated%term(term)%fitted .and. .not. channel%allan(1)%stated%term(term)%detected) then
            names = names//", "//terms(term:term)
         end if
      end do
      if (len(names) == 0) return
      call put_point(writer, "This record does not resolve "//names(3:)//": Table III has upper limits of 95 % "// &
                     "confidence; a longer record resolves more.")
   end subroutine put_unresolved

   !> " (phi^2)" for an AR(1).
   pure function squared(channel) result(text)
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      text = ""
      if (channel%ar%order == 1) text = " (phi^2)"
   end function squared

   !> The filter adapts Q and R at once.
   pure logical function adapts_both(filter)
      type(filter_result_type), intent(in) :: filter
      integer :: i, found

      found = 0
      if (allocated(filter%estimate)) then
         do i = 1, size(filter%estimate)
            if (filter%estimate(i)%text == "Q" .or. filter%estimate(i)%text == "R") found = found + 1
         end do
      end if
      adapts_both = found == 2
   end function adapts_both

   !> Which options would help.
   pure function missing_options(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text

      text = ""
      if (.not. record%rate_known) text = "--rate HZ"
      if (.not. has_unit(record)) then
         if (len(text) > 0) text = text//" and "
         text = text//"--unit UNIT"
      end if
   end function missing_options

   !> "random walk + AR(1) of 9.0 s + white noise".
   pure function model_text(record, channel) result(text)
      !> For the unit of time
      type(record_type), intent(in) :: record
      !> The drift is available
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text
      integer :: i

      text = ""
      do i = size(channel%drift_process), 1, -1
         if (channel%drift_process(i)%walk) then
            text = text//"random walk + "
         else
            text = text//"AR(1)"//of_time(record, channel%drift_process(i))//" + "
         end if
      end do
      text = text//"white noise"
   end function model_text

   !> " of 9.0 s"; nothing where the coefficient is not positive.
   pure function of_time(record, process) result(text)
      type(record_type), intent(in) :: record
      type(drift_process_type), intent(in) :: process
      character(:), allocatable :: text

      text = ""
      if (process%time > 0.0_dp) text = " of "//number(process%time, 3)//" "//time_unit(record)
   end function of_time

end module gyroakf_report_advice
