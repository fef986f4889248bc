! SPDX-License-Identifier: MIT
!> The regression of the Dickey-Fuller test in the report: coefficients, and lags that could not be tried.
module gyroakf_report_text_adf_table
   use gyroakf_kinds, only : int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_series_adf, only : adf_type
   use gyroakf_report_text_layout, only : put_item, number, scientific, count_text, plural
   use gyroakf_report_text_table, only : table_type, new_table, set_cell, put_table
   implicit none (type, external)
   private
   public :: put_adf_details

contains

   !> Says where fewer lags were tried than asked for, and shows the coefficients where they were asked for.
   subroutine put_adf_details(writer, adf)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> The test
      type(adf_type), intent(in) :: adf
      character(12), parameter :: head(4) = [character(12) :: "", "coefficient", "std. error", "t"]
      type(table_type) :: table
      integer :: i

      if (adf%lag_chosen .and. adf%max_lags < adf%wanted_lags) then
         call put_item(writer, "", "the series is too short, or has too many gaps, for "// &
                       plural(int(adf%wanted_lags, int64), "lag")//": at most "//count_text(int(adf%max_lags, int64))// &
                       " were tried")
      end if
      if (.not. allocated(adf%table)) return
      call put_item(writer, "ADF regression", "of the differences; time = 1, 2, ... from the first row (sample "// &
                    count_text(int(adf%lag + 2, int64))//"); residual variance "//scientific(adf%noise_variance, 6))
      call new_table(table, size(adf%table) + 1, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      do i = 1, size(adf%table)
         call set_cell(table, i + 1, 1, trim(adf%table(i)%name))
         call set_cell(table, i + 1, 2, scientific(adf%table(i)%value, 6))
         call set_cell(table, i + 1, 3, scientific(adf%table(i)%std_error, 4))
         call set_cell(table, i + 1, 4, number(adf%table(i)%t, 5))
      end do
      call put_table(writer, table, 1)
   end subroutine put_adf_details

end module gyroakf_report_text_adf_table
