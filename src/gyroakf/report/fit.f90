! SPDX-License-Identifier: MIT
!> How the noise terms were fitted: which were chosen, how well they describe the curve, what does not.
module gyroakf_report_fit
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : allan_result_type, not_described
   use gyroakf_report_text_layout, only : put_item, number, count_text
   implicit none (type, external)
   private
   public :: put_fit

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
         if (.not. noise%described) then
            call put_item(writer, "Fit", not_described)
            call put_item(writer, "Slopes", slopes_text(allan, record))
            return
         end if
         call put_item(writer, "Fit", "terms "//chosen_text(allan)//"; "//count_text(int(noise%points, int64))// &
            & " octaves, chi-square per degree of freedom "//number(noise%chi2_reduced, 3)//" ("// &
            & count_text(int(noise%chi2_freedom, int64))//"), p "//probability_text(noise%chi2_probability))
         if (noise%left_out > 0) call put_item(writer, "Excluded", "octaves below tau = "//number(noise%tau_first, 4)// &
            & unit_of_time(record)//": a filter in the sensor, a line or correlated noise bends the curve there; Q is withheld")
         if (noise%cut_off > 0) call put_item(writer, "Excluded", "octaves above tau = "//number(noise%tau_last, 4)// &
            & unit_of_time(record)//": no sum of the terms follows the curve there; K and R are withheld")
         if (noise%unquantized%state == "value") call put_item(writer, "Quantization", "the step of the samples is "// &
            & number(noise%lsb_ratio, 2)//" standard deviations of the noise; N without quantization "// &
            & number(allan%stated%unquantized%value, 4)//" +/- "//number(allan%stated%unquantized%std_error, 2)//" "// &
            & allan%stated%unquantized%unit)
         if (noise%unquantized%state == "withheld") call put_item(writer, "Quantization", "the step of the samples is "// &
            & lsb_text(noise%lsb_ratio)//" standard deviations of the noise: N is that of the record as quantized, N without "// &
            & "quantization is withheld")
         if (noise%floor > 0) call put_item(writer, "Misfit", "the curve departs from the terms by about "// &
            & number(50*noise%floor, 2)//" %; errors and limits allow for it")
      end associate
   end subroutine put_fit

   !> "-0.50 from 0.1 to 1 s, ...": slopes of the logarithm of the deviation against that of tau, factors of eight in tau or more.
   pure function slopes_text(allan, record) result(text)
      type(allan_result_type), intent(in) :: allan
      type(record_type), intent(in) :: record
      character(:), allocatable :: text
      character(5) :: slope
      integer :: i, k

      text = ""
      i = 1
      associate (tau => allan%curve%tau, deviation => allan%curve%deviation)
         do k = 2, size(tau)
            if (tau(k) < 7.9_dp*tau(i)) cycle
            write (slope, "(sp, f5.2)") log(deviation(k)/deviation(i))/log(tau(k)/tau(i))
            text = text//slope//" from "//number(tau(i), 3)//" to "//number(tau(k), 3)//unit_of_time(record)//", "
            i = k
         end do
      end associate
      text = text//"of log deviation against log tau: -1 is quantization, -1/2 white noise, 0 bias instability, +1/2 random walk"
   end function slopes_text

   !> "2.4"; "many" from 1000 on.
   pure function lsb_text(ratio) result(text)
      real(dp), intent(in) :: ratio
      character(:), allocatable :: text

      text = "many"
      if (ratio < 1e3_dp) text = number(ratio, 2)
   end function lsb_text

   !> "N B", or that there are none.
   pure function chosen_text(allan) result(text)
      type(allan_result_type), intent(in) :: allan
      character(:), allocatable :: text
      character(5), parameter :: letters = "QNBKR"
      integer :: term

      text = ""
      do term = 1, 5
         if (allan%noise%squares(term) > 0) text = text//" "//letters(term:term)
      end do
      if (len(text) == 0) text = " none"
      text = text(2:)
   end function chosen_text

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
