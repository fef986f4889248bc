! SPDX-License-Identifier: MIT
!> spectrum.csv, Welch's spectrum of the cleaned series of every channel, and ar_spectrum.csv, that of its AR model.
module gyroakf_report_spectrum_file
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_ar_spectrum, only : ar_spectrum
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_csv, only : quoted
   implicit none (type, external)
   private
   public :: write_spectrum, has_spectrum, write_ar_spectrum

   !> Significant digits
   integer, parameter :: digits = 10
   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: model_digits = 15
   !> Intervals between 0 and the Nyquist frequency in ar_spectrum.csv
   integer, parameter :: frequency_steps = 1024

contains

   !> One channel at least has a spectrum.
   pure logical function has_spectrum(result)
      !> What came out
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      has_spectrum = .false.
      if (.not. allocated(result%channel)) return
      do c = 1, size(result%channel)
         has_spectrum = has_spectrum .or. result%channel(c)%available%spectrum
      end do
   end function has_spectrum

   !> A line per channel and frequency: frequency in Hz (cycles per sample without a rate), two-sided density with its limits and
   !> one-sided density in the unit of the input squared over that of the frequency, degrees of freedom.
   subroutine write_spectrum(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Spectra
      type(pipeline_result_type), intent(in) :: result
      integer :: c, k

      call put_line(writer, "channel,frequency,density_two_sided,lower,upper,density_one_sided,edf")
      do c = 1, size(result%channel)
         if (.not. result%channel(c)%available%spectrum) cycle
         associate (spectrum => result%channel(c)%spectrum)
            do k = lbound(spectrum%frequency, 1), ubound(spectrum%frequency, 1)
               call put(writer, quoted(result%channel(c)%name))
               call put_number(writer, spectrum%frequency(k))
               call put_number(writer, spectrum%density(k))
               call put_number(writer, spectrum%lower(k))
               call put_number(writer, spectrum%upper(k))
               call put_number(writer, spectrum%one_sided(k))
               call put_number(writer, spectrum%edf(k))
               call put_line(writer, "")
            end do
         end associate
      end do
   end subroutine write_spectrum

   !> A comma and a number.
   subroutine put_number(writer, value)
      type(writer_type), intent(inout) :: writer
      real(dp), intent(in) :: value

      call put(writer, ",")
      call put_real(writer, value, digits)
   end subroutine put_number

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
            call put_real(writer, frequency, model_digits)
            call put(writer, ",")
            call put_real(writer, ar_spectrum(result%channel(c)%ar, frequency, interval), model_digits)
            call put_line(writer, "")
         end do
      end do
   end subroutine write_ar_spectrum

end module gyroakf_report_spectrum_file
