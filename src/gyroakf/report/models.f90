! SPDX-License-Identifier: MIT
!> Table I (AR models) of a report.
module gyroakf_report_models
   use gyroakf_kinds, only : dp, int64
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : channel_result_type
   use gyroakf_report_input, only : unit_name
   use gyroakf_report_text_layout, only : scientific, fixed, count_text
   use gyroakf_report_text_table, only : table_type, new_table, set_exact, set_cell, set_row
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   implicit none (type, external)
   private
   public :: make_ar_table, upper_case

contains

   !> Table I: a row for each order, with every criterion.
   subroutine make_ar_table(record, channel, table)
      !> For the unit
      type(record_type), intent(in) :: record
      !> `ar` is available
      type(channel_result_type), intent(in) :: channel
      !> Described
      type(table_type), intent(out) :: table
      character(:), allocatable :: key
      integer :: i, row

      call new_table(table, size(channel%ar%table) + 1, 8, left=0)
      table%name = "ar"
      table%number = "I"
      table%caption = "AR models ("//method_name(channel%ar%method)//", n = "//count_text(channel%ar%compared_rows)// &
                      ", variances in ("//unit_name(record)//")^2); * is the order chosen by "// &
                      upper_case(trim(channel%ar%criterion))
      call set_row(table, 1, [character(8) :: "order", "variance", "AIC", "AICc", "BIC", "HQIC", "FPE", "AIC/n"])
      do i = lbound(channel%ar%table, 1), ubound(channel%ar%table, 1)
         row = i - lbound(channel%ar%table, 1) + 2
         associate (line => channel%ar%table(i))
            call set_cell(table, row, 1, merge("* ", "  ", line%order == channel%ar%order)// &
                          count_text(int(line%order, int64)))
            call set_cell(table, row, 2, scientific(line%noise_variance, 5))
            call set_cell(table, row, 3, criterion(line%aic))
            call set_cell(table, row, 4, criterion(line%aicc))
            call set_cell(table, row, 5, criterion(line%bic))
            call set_cell(table, row, 6, criterion(line%hqic))
            call set_cell(table, row, 7, scientific(line%fpe, 5))
            call set_cell(table, row, 8, fixed(line%aic_per_observation, 6))
            key = "ar.table."//count_text(int(row - 2, int64))//"."
            call set_exact(table, row, 2, key//"noise_variance", line%noise_variance)
            call set_exact(table, row, 3, key//"aic", line%aic)
            call set_exact(table, row, 4, key//"aicc", line%aicc)
            call set_exact(table, row, 5, key//"bic", line%bic)
            call set_exact(table, row, 6, key//"hqic", line%hqic)
            call set_exact(table, row, 7, key//"fpe", line%fpe)
            call set_exact(table, row, 8, key//"aic_per_observation", line%aic_per_observation)
         end associate
      end do
   end subroutine make_ar_table

   !> Decimals down to what a difference has to have, limited by the width of a column.
   pure function criterion(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text

      text = "-"
      if (.not. ieee_is_finite(value)) return
      if (abs(value) < 1e5_dp) then
         text = fixed(value, 2)
      else if (abs(value) < 1e6_dp) then
         text = fixed(value, 1)
      else
         text = fixed(value, 0)
      end if
   end function criterion

   pure function method_name(method) result(name)
      character(*), intent(in) :: method
      character(:), allocatable :: name

      select case (method)
      case ("yw"); name = "Yule-Walker"
      case ("burg"); name = "Burg"
      case ("ols"); name = "least squares"
      case default; name = trim(method)
      end select
   end function method_name

   !> aic -> AIC, aicc -> AICc.
   pure function upper_case(criterion) result(name)
      !> As the options have it
      character(*), intent(in) :: criterion
      character(:), allocatable :: name

      select case (criterion)
      case ("aicc"); name = "AICc"
      case ("aic"); name = "AIC"
      case ("bic"); name = "BIC"
      case ("hqic"); name = "HQIC"
      case ("fpe"); name = "FPE"
      case default; name = criterion
      end select
   end function upper_case

end module gyroakf_report_models
