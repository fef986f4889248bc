! SPDX-License-Identifier: MIT
!> histogram.csv: the distribution of the samples as a table for plots.
module gyroakf_report_text_histogram
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_stats_histogram, only : histogram_type
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_text_layout, only : count_text
   implicit none (type, external)
   private
   public :: write_histogram

   integer, parameter :: digits = 15

contains

   !> A line per channel and bin: edges, samples, samples of the fitted normal distribution, and both as densities at the centre.
   !>
   !> The first line of a channel counts what is below the bins (its lower edge is nan), the last what is above.
   subroutine write_histogram(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Histograms
      type(pipeline_result_type), intent(in) :: result
      integer :: c

      call put_line(writer, "channel,lower,upper,count,expected,density,normal_density")
      do c = 1, size(result%channel)
         if (result%channel(c)%available%histogram) then
            call put_bins(writer, quoted(result%channel(c)%name), result%channel(c)%histogram)
         end if
      end do
   end subroutine write_histogram

   !> The lines of a channel.
   subroutine put_bins(writer, name, histogram)
      type(writer_type), intent(inout) :: writer
      !> Of the channel, quoted
      character(*), intent(in) :: name
      type(histogram_type), intent(in) :: histogram
      integer :: i

      call put(writer, name//",nan")
      call put_number(writer, histogram%edge(0))
      call put(writer, ","//count_text(histogram%below))
      call put_number(writer, histogram%expected_below)
      call put_line(writer, ",nan,nan")
      do i = 1, size(histogram%count)
         call put(writer, name)
         call put_number(writer, histogram%edge(i - 1))
         call put_number(writer, histogram%edge(i))
         call put(writer, ","//count_text(histogram%count(i)))
         call put_number(writer, histogram%expected(i))
         call put_number(writer, histogram%density(i))
         call put_number(writer, histogram%normal_density(i))
         call put_line(writer, "")
      end do
      call put(writer, name)
      call put_number(writer, histogram%edge(size(histogram%count)))
      call put(writer, ",nan,"//count_text(histogram%above))
      call put_number(writer, histogram%expected_above)
      call put_line(writer, ",nan,nan")
   end subroutine put_bins

   !> A comma and a number.
   subroutine put_number(writer, value)
      type(writer_type), intent(inout) :: writer
      real(dp), intent(in) :: value

      call put(writer, ",")
      call put_real(writer, value, digits)
   end subroutine put_number

end module gyroakf_report_text_histogram
