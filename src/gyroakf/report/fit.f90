! SPDX-License-Identifier: MIT
!> How the noise terms were fitted: which were chosen, how well they describe the curve, what does not.
module gyroakf_report_fit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : allan_result_type, stated_coefficient_type
   use gyroakf_report_text_layout, only : put_item, number, count_text
   implicit none (type, external)
   private
   public :: put_fit, put_visible

contains

   !> The lines below a table of coefficients.
   subroutine put_fit(writer, record, allan)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit of time
      type(record_type), intent(in) :: record
      !> With the fit
      type(allan_result_type), intent(in) :: allan

      if (.not. allan%fitted) return
      associate (noise => allan%noise)
         call put_item(writer, "Fit", "terms "//chosen_text(allan)//"; "//count_text(int(noise%points, int64))// &
            & " points, chi-square per degree of freedom "//number(noise%chi2_reduced, 3)//" ("// &
            & count_text(int(noise%chi2_freedom, int64))//"), p "//probability_text(noise%chi2_probability))
         if (noise%left_out > 0) call put_item(writer, "Left out", count_text(int(noise%left_out, int64))// &
            & " points before tau = "//number(noise%tau_first, 4)//unit_of_time(record)// &
            & ": a low-pass filter or correlated noise bends the curve down there; N is that of longer times "// &
            & "(--terms QNBKR fits all points)")
         if (allan%stated%markov%fitted) call put_item(writer, "Markov process", "driving noise q_c = "// &
            & value_and_error(allan%stated%markov)//", correlation time "//number(noise%correlation_time, 4)//" +/- "// &
            & number(noise%correlation_time_error, 2)//unit_of_time(record))
         if (allan%stated%sinusoid%fitted) call put_item(writer, "Sinusoid", "amplitude "// &
            & value_and_error(allan%stated%sinusoid)//", frequency "//number(noise%frequency, 5)//" +/- "// &
            & number(noise%frequency_error, 2)//trim(merge(" Hz        ", " per sample", record%rate_known)))
         if (noise%misfit > 0) call put_item(writer, "Misfit", "the curve is not a sum of these terms: it departs by about "// &
            & number(50*noise%misfit, 2)//" %, most at tau = "//conspicuous_text(allan)//unit_of_time(record)// &
            & "; errors and limits allow for it")
         if (noise%misfit <= 0 .and. .not. noise%acceptable) call put_item(writer, "Misfit", &
            & "chance does not explain how the curve departs from these terms, most at tau = "//conspicuous_text(allan)// &
            & unit_of_time(record)//"; the errors do not allow for it")
      end associate
   end subroutine put_fit

   !> How long a record would show what this one does not.
   subroutine put_visible(writer, record, allan)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> For the unit of time
      type(record_type), intent(in) :: record
      !> Of the record as read
      type(allan_result_type), intent(in) :: allan
      character(5), parameter :: letters = "QNBKR"
      character(:), allocatable :: text
      integer :: term

      if (.not. allan%fitted) return
      do term = 1, 5
         associate (stated => allan%stated%term(term))
            if (stated%visible_duration <= 0) cycle
            text = "a value of half the limit, "//number(stated%visible_value, 3)//" "//stated%unit
            if (stated%visible_duration >= huge(1.0_dp)) then
               text = text//", would not show in any record of practical length"
            else if (stated%visible_duration <= allan%curve%sample_interval*real(allan%curve%samples, dp)) then
               text = text//", would have shown in this record"
            else
               text = text//", would show in a record of "//duration_text(record, stated%visible_duration)
            end if
            call put_item(writer, "To see "//letters(term:term), text)
         end associate
      end do
   end subroutine put_visible

   !> "N B", or that there are none.
   pure function chosen_text(allan) result(text)
      type(allan_result_type), intent(in) :: allan
      character(:), allocatable :: text
      character(5), parameter :: letters = "QNBKR"
      integer :: term

      text = ""
      do term = 1, 5
         if (allan%noise%mixture%squares(term) > 0) text = text//" "//letters(term:term)
      end do
      if (allan%noise%markov%detected) text = text//" Markov"
      if (allan%noise%sinusoid%detected) text = text//" sinusoid"
      if (len(text) == 0) text = " none"
      text = text(2:)
   end function chosen_text

   !> First and last averaging time that miss the model.
   pure function conspicuous_text(allan) result(text)
      type(allan_result_type), intent(in) :: allan
      character(:), allocatable :: text
      integer :: first, last

      text = "no single place"
      if (.not. allocated(allan%noise%conspicuous)) return
      first = findloc(allan%noise%conspicuous, .true., dim=1)
      last = findloc(allan%noise%conspicuous, .true., dim=1, back=.true.)
      if (first == 0) return
      text = number(allan%noise%tau(first), 4)
      if (last > first) text = text//" ... "//number(allan%noise%tau(last), 4)
   end function conspicuous_text

   !> "0.12 +/- 0.01 deg/h".
   pure function value_and_error(stated) result(text)
      type(stated_coefficient_type), intent(in) :: stated
      character(:), allocatable :: text

      text = number(stated%value, 4)//" +/- "//number(stated%std_error, 2)//" "//stated%unit
   end function value_and_error

   !> Seconds, minutes, hours, days or years.
   pure function duration_text(record, duration) result(text)
      type(record_type), intent(in) :: record
      real(dp), intent(in) :: duration
      character(:), allocatable :: text

      if (.not. record%rate_known) then
         text = rounded(duration)//" samples"
      else if (duration < 120) then
         text = rounded(duration)//" s"
      else if (duration < 7200) then
         text = rounded(duration/60)//" min"
      else if (duration < 172800) then
         text = rounded(duration/3600)//" h"
      else if (duration < 730*86400.0_dp) then
         text = rounded(duration/86400)//" days"
      else
         text = rounded(duration/(365.25_dp*86400))//" years"
      end if
   end function duration_text

   !> Two digits, those before the point all: 4.3, 110, never 1.1e+02.
   pure function rounded(x) result(text)
      real(dp), intent(in) :: x
      character(:), allocatable :: text

      text = number(x, 2)
      if (x >= 99.5_dp .and. x < 1e15_dp) text = number(anint(x, dp), 15)
   end function rounded

   !> " s" or " samples".
   pure function unit_of_time(record) result(text)
      type(record_type), intent(in) :: record
      character(:), allocatable :: text

      text = " samples"
      if (record%rate_known) text = " s"
   end function unit_of_time

   !> A probability.
   pure function probability_text(p) result(text)
      real(dp), intent(in) :: p
      character(:), allocatable :: text

      text = "= "//number(p, 2)
      if (p < 1e-4_dp) text = "< 1e-4"
   end function probability_text

end module gyroakf_report_fit
