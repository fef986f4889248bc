! SPDX-License-Identifier: MIT
!> What is said of the AR model beside its coefficients: roots, normality of the residuals, spectrum.
module gyroakf_report_ar_details
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_ar_model, only : ar_model_type
   use gyroakf_ar_spectrum, only : ar_spectrum
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_result_type
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_text_layout, only : put_item, number, count_text, p_value_text
   implicit none (type, external)
   private
   public :: put_ar_roots, put_ar_normality, write_ar_spectrum

   !> So many roots are named in the report; the JSON document has all
   integer, parameter :: named_roots = 6
   !> Intervals between 0 and the Nyquist frequency in the file
   integer, parameter :: frequency_steps = 1024
   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: digits = 15

contains

   !> Intercept and roots.
   subroutine put_ar_roots(writer, model)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> The model that was chosen
      type(ar_model_type), intent(in) :: model
      character(:), allocatable :: text
      integer :: i

      if (model%method == "ols") call put_item(writer, "", "intercept "//number(model%intercept, 6)//" +/- "// &
                                               number(model%intercept_std_error, 2)//"; the errors have the divisor "// &
                                               count_text(model%rows)//", the rows fitted")
      if (allocated(model%root) .and. model%order > 0) then
         text = ""
         do i = 1, min(model%order, named_roots)
            if (model%root(i)%imaginary_part < 0.0_dp) cycle
            text = text//root_text(model, i)//"; "
         end do
         if (model%order > named_roots) text = text//"...; "
         call put_item(writer, "Roots", text//trim(merge("stationary    ", "NOT STATIONARY", model%stationary)))
      end if
   end subroutine put_ar_roots

   !> Normality of the residuals, where it was tested.
   subroutine put_ar_normality(writer, model)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> The model that was chosen
      type(ar_model_type), intent(in) :: model

      associate (test => model%residual_normality)
         if (test%kurtosis > 0.0_dp) call put_item(writer, "", "skewness "//number(test%skewness, 3)//", excess kurtosis "// &
            number(test%kurtosis - 3.0_dp, 3)//", Jarque-Bera "//number(test%statistic, 4)//", "//p_value_text(test%p_value))
      end associate
   end subroutine put_ar_normality

   !> A real root or a pair: modulus, time constant, and the period where it swings.
   function root_text(model, i) result(text)
      !> The model
      type(ar_model_type), intent(in) :: model
      !> Which of its roots
      integer, intent(in) :: i
      character(:), allocatable :: text

      associate (root => model%root(i))
         text = number(root%modulus, 4)
         if (root%imaginary_part > 0.0_dp) text = "pair "//text//" (period "//number(1.0_dp/root%frequency, 4)//" samples"
         if (root%imaginary_part <= 0.0_dp .and. root%real_part < 0.0_dp) text = "-"//text
         if (root%imaginary_part <= 0.0_dp) text = text//" ("
         if (root%imaginary_part > 0.0_dp) text = text//", "
         if (root%modulus >= 1.0_dp) then
            text = text//"grows)"
         else
            text = text//"decays in "//number(root%time_constant, 3)//" samples)"
         end if
      end associate
   end function root_text

   !> ar_spectrum.csv: the two-sided density of each channel's model from 0 to the Nyquist frequency, in the unit of the record
   !> squared times s; cycles a sample and samples where no rate is known. A model that is not stationary has none.
   subroutine write_ar_spectrum(writer, result, interval)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> With AR models
      type(pipeline_result_type), intent(in) :: result
      !> Sample interval, s; 1 without a rate
      real(dp), intent(in) :: interval
      real(dp) :: frequency
      integer :: c, i

      call put_line(writer, "channel,frequency,density")
      do c = 1, size(result%channel)
         if (.not. result%channel(c)%available%ar) cycle
         if (.not. result%channel(c)%ar%stationary) cycle
         do i = 0, frequency_steps
            frequency = real(i, dp)/(2.0_dp*real(frequency_steps, dp)*interval)
            call put(writer, quoted(result%channel(c)%name)//",")
            call put_real(writer, frequency, digits)
            call put(writer, ",")
            call put_real(writer, ar_spectrum(result%channel(c)%ar, frequency, interval), digits)
            call put_line(writer, "")
         end do
      end do
   end subroutine write_ar_spectrum

end module gyroakf_report_ar_details
