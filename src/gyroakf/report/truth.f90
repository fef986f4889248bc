! SPDX-License-Identifier: MIT
!> Part of a report: the filters against the true drift.
module gyroakf_report_truth
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_writer, only : writer_type
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_pipeline_truth_result, only : method_score_type
   use gyroakf_report_layout, only : count_text, number, put_heading, put_item
   use gyroakf_report_table, only : new_table, put_table, set_cell, table_type
   implicit none (type, external)
   private
   public :: put_truth

contains

   !> RMSE and the errors of the angle of every method; nothing without a truth.
   subroutine put_truth(writer, record, channel)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> Its unit
      type(record_type), intent(in) :: record
      !> Scored
      type(channel_result_type), intent(in) :: channel
      character(6), parameter :: head(8) = [character(6) :: "", "RMSE", "10", "60", "300", "+10", "+60", "+300"]
      type(table_type) :: table
      integer :: i, j

      if (.not. channel%truth%known .or. channel%truth%count == 0) return
      call put_heading(writer, "Against the true drift")
      call new_table(table, channel%truth%count + 1, size(head))
      do j = 1, size(head)
         if (j < 3) call set_cell(table, 1, j, trim(head(j)))
         if (j >= 3) call set_cell(table, 1, j, trim(head(j))//" "//trim(merge("s      ", "samples", record%rate_known)))
      end do
      do i = 1, channel%truth%count
         call put_row(table, i + 1, channel%truth%method(i))
      end do
      call put_table(writer, table, 1)
      associate (score => channel%truth%method(1)%score)
         call put_item(writer, "", "RMSE in "//rate_unit(record)//" over "//count_text(score%samples)//" samples. Then the "// &
            "root mean square error of the angle in "//trim(channel%truth%angle_unit)//" after that time, over "// &
            count_text(score%attitude_windows(1))//", "//count_text(score%attitude_windows(2))//" and "// &
            count_text(score%attitude_windows(3))//" windows: the rate corrected as the estimate runs, and (+) the estimate "// &
            "before the window carried on by its model while nothing is measured. * uses later samples too.")
      end associate
      if (channel%truth%average_samples > 0) call put_item(writer, "", "The averages are over "// &
         count_text(channel%truth%average_samples)//" samples, where the Allan deviation is lowest.")
   end subroutine put_truth

   !> One method.
   subroutine put_row(table, row, method)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: row
      type(method_score_type), intent(in) :: method
      integer :: i

      call set_cell(table, row, 1, title_of(method%name)//trim(merge(" *", "  ", method%offline)))
      call set_cell(table, row, 2, number(method%score%rmse, 4))
      do i = 1, 3
         call set_cell(table, row, 2 + i, "-")
         call set_cell(table, row, 5 + i, "-")
         if (method%score%attitude_windows(i) > 0) call set_cell(table, row, 2 + i, number(method%score%attitude_error(i), 3))
         if (method%score%predicted_windows(i) > 0) call set_cell(table, row, 5 + i, number(method%score%predicted_error(i), 3))
      end do
   end subroutine put_row

   !> Unit of the rate.
   pure function rate_unit(record) result(unit)
      type(record_type), intent(in) :: record
      character(:), allocatable :: unit

      unit = ""
      if (allocated(record%unit%name)) unit = record%unit%name
      if (unit == "") unit = "units of the input"
   end function rate_unit

   !> What a method is called.
   pure function title_of(name) result(title)
      character(*), intent(in) :: name
      character(:), allocatable :: title

      select case (name)
      case ("none"); title = "as it is"
      case ("trend"); title = "trend, mean alone"
      case ("kf"); title = "KF (paper)"
      case ("akf"); title = "AKF (paper)"
      case ("drift_kf"); title = "drift KF"
      case ("drift_akf"); title = "drift AKF"
      case ("drift_smoother"); title = "drift smoother"
      case ("innovation_window"); title = "innovation window"
      case ("variational_bayes"); title = "variational Bayes"
      case ("moving_average"); title = "moving average"
      case ("centred_average"); title = "centred average"
      case default; title = trim(name)
      end select
   end function title_of

end module gyroakf_report_truth
