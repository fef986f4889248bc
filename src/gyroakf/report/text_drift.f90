! SPDX-License-Identifier: MIT
!> The drift of a record in plain sentences: what it is made of, with errors, and what else was tried.
module gyroakf_report_text_drift
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type, drift_process_type
   use gyroakf_report_input, only : unit_name
   use gyroakf_report_text_layout, only : put_heading, put_item, number, rounded, fixed, count_text
   use gyroakf_report_text_table, only : table_type, new_table, set_cell, put_table
   implicit none (type, external)
   private
   public :: put_drift_model, model_text, time_unit

contains

   !> The section; nothing where no drift was looked for.
   subroutine put_drift_model(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the units
      type(record_type), intent(in) :: record
      !> The drift is filled where it is available
      type(channel_result_type), intent(in) :: channel
      integer :: i

      if (.not. channel%available%drift) return
      associate (drift => channel%drift)
         call put_heading(writer, "Drift: what is slower than "//number(channel%drift_tau, 3)//time_unit(record)// &
                          " (--drift-tau) in the record as read"//trim(merge(" without its outliers", "                     ", &
                                                                             channel%available%preprocess)))
         if (allocated(channel%drift_doubt)) then
            call put_item(writer, "Model", "no drift model describes this record: "//channel%drift_doubt)
            call put_item(writer, "Nearest", model_text(record, channel))
         else if (drift%found .and. channel%verdict%stationary) then
            call put_item(writer, "Model", model_text(record, channel)//": an approximation of the slow part of stationary noise")
         else
            call put_item(writer, "Model", model_text(record, channel)//trim(merge("                   ", &
                                                                                   ": there is no drift", drift%found)))
         end if
         do i = size(channel%drift_process), 1, -1
            call put_process(writer, record, channel%drift_process(i))
         end do
         if (drift%white_std > 0.0_dp) then
            call put_item(writer, "White noise", "standard deviation "// &
                          rounded(drift%white_std, channel%white_std_error)//" "//unit_name(record))
         else if (drift%source == "likelihood") then
            call put_item(writer, "White noise", "none: the likelihood does not tell it from 0")
         end if
         call put_item(writer, "Found by", source_text(channel))
         call put_candidates(writer, channel)
      end associate
   end subroutine put_drift_model

   !> Where the model comes from, and what is not known of it.
   pure function source_text(channel) result(text)
      !> The drift is available
      type(channel_result_type), intent(in) :: channel
      character(:), allocatable :: text

      associate (drift => channel%drift)
         select case (drift%source)
         case ("autocov"); text = "least squares on the autocovariances, for no likelihood has a maximum"
         case default
            text = "maximum likelihood from "
            if (drift%samples < drift%of_samples) text = text//"the middle "//count_text(drift%samples)//" of "
            text = text//count_text(drift%of_samples)//" samples"
            if (drift%block > 1) text = text//", slowest processes from means of "//count_text(drift%block)// &
               " samples over the whole record"
         end select
         if (.not. drift%errors_known .and. drift%model%count > 0) then
            text = text//"; its standard errors are not known"
            if (drift%source == "likelihood") text = text//", a variance is at its bound of zero"
         end if
      end associate
   end function source_text

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
      if (process%time > 0.0_dp) text = " of "//number(process%time, 3)//time_unit(record)
   end function of_time

   !> One process with its numbers.
   subroutine put_process(writer, record, process)
      type(writer_type), intent(inout) :: writer
      type(record_type), intent(in) :: record
      type(drift_process_type), intent(in) :: process
      character(:), allocatable :: text

      if (process%walk) then
         text = ""
         if (process%k%detected) text = "drift: K = "//rounded(process%k%value, process%k%std_error)//" "//process%k%unit//", "
         call put_item(writer, "Random walk", text//"steps of "//number(process%std, 3)//" "//unit_name(record)//" a sample")
         return
      end if
      text = "noise, too fast to be drift: "
      if (process%slow) text = "drift: "
      if (process%time > 0.0_dp) text = text//"correlation time "//rounded(process%time, process%time_error)// &
         time_unit(record)//", "
      call put_item(writer, "AR(1)", text//"phi = "//rounded(process%phi, process%phi_error)//", standard deviation "// &
                    number(process%std, 3)//" "//unit_name(record))
   end subroutine put_process

   !> What was compared.
   subroutine put_candidates(writer, channel)
      type(writer_type), intent(inout) :: writer
      type(channel_result_type), intent(in) :: channel
      character(16), parameter :: head(4) = [character(16) :: "", "with white noise", "AIC", "BIC"]
      type(table_type) :: table
      integer :: i

      if (.not. allocated(channel%drift%candidate)) return
      if (size(channel%drift%candidate) == 0) return
      call new_table(table, size(channel%drift%candidate) + 1, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      do i = 1, size(channel%drift%candidate)
         associate (candidate => channel%drift%candidate(i))
            if (i == channel%drift%chosen) call set_cell(table, i + 1, 1, "*")
            call set_cell(table, i + 1, 2, candidate_name(candidate%name))
            call set_cell(table, i + 1, 3, fixed(candidate%aic, 2))
            call set_cell(table, i + 1, 4, fixed(candidate%bic, 2))
         end associate
      end do
      call put_table(writer, table, 2)
      if (channel%drift%found) return
      i = minloc(channel%drift%candidate%aic, dim=1)
      if (i /= channel%drift%chosen) call put_item(writer, "", "a drift counts as found where it lowers AIC by clearly more "// &
         "than chance does; here it does not")
   end subroutine put_candidates

   !> A candidate in words.
   pure function candidate_name(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text

      select case (name)
      case ("walk"); text = "random walk"
      case ("ar1"); text = "AR(1)"
      case ("walk+ar1"); text = "random walk, AR(1)"
      case default; text = trim(name)
      end select
   end function candidate_name

   !> " s", or " samples".
   pure function time_unit(record) result(text)
      !> Its rate is known or not
      type(record_type), intent(in) :: record
      character(:), allocatable :: text

      text = " samples"
      if (record%rate_known) text = " s"
   end function time_unit

end module gyroakf_report_text_drift
