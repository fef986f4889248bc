! SPDX-License-Identifier: MIT
!> The correlation at every lag as a table: correlation.csv.
module gyroakf_report_correlation_table
   use gyroakf_kinds, only : int64
   use gyroakf_io_writer, only : writer_type, put, put_line, put_real
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_csv, only : quoted
   use gyroakf_report_text_layout, only : count_text
   implicit none (type, external)
   private
   public :: write_correlation

   !> Enough for every number of a file that was written with 15 digits
   integer, parameter :: digits = 15

contains

   !> A line per channel and lag: autocorrelation, partial autocorrelation (nan where it does not exist), the 95 % limit of white
   !> noise and Bartlett's, Ljung-Box over the lags so far with its p, present pairs.
   subroutine write_correlation(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Channels whose correlation is there
      type(pipeline_result_type), intent(in) :: result
      integer :: c, k

      call put_line(writer, "channel,lag,acf,pacf,limit,ljung_box,p_value,bartlett_limit,pairs")
      do c = 1, size(result%channel)
         if (.not. result%channel(c)%available%correlation) cycle
         associate (correlation => result%channel(c)%correlation)
            do k = 1, correlation%lags
               call put(writer, quoted(result%channel(c)%name)//","//count_text(int(k, int64))//",")
               call put_real(writer, correlation%acf(k), digits)
               if (k <= correlation%partial_lags) then
                  call put(writer, ",")
                  call put_real(writer, correlation%pacf(k), digits)
               else
                  call put(writer, ",nan")
               end if
               call put(writer, ",")
               call put_real(writer, correlation%limit(k), digits)
               call put(writer, ",")
               call put_real(writer, correlation%ljung_box(k), digits)
               call put(writer, ",")
               call put_real(writer, correlation%ljung_box_p(k), digits)
               call put(writer, ",")
               call put_real(writer, correlation%bartlett(k), digits)
               call put_line(writer, ","//count_text(correlation%pairs(k)))
            end do
         end associate
      end do
   end subroutine write_correlation

end module gyroakf_report_correlation_table
