! SPDX-License-Identifier: MIT
!> spectrum.csv: Welch's spectrum of the cleaned series of every channel.
module gyroakf_report_spectrum_file
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_csv, only : quoted
   implicit none (type, external)
   private
   public :: write_spectrum, has_spectrum

   !> Significant digits
   integer, parameter :: digits = 10

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

end module gyroakf_report_spectrum_file
