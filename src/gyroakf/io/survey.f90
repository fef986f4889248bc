! SPDX-License-Identifier: MIT
!> All columns of a file: what they measure, their range, and what is done with them.
module gyroakf_io_survey
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_column_class, only : class_names, find_unit
   use gyroakf_io_store, only : store_type
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : record_type
   use gyroakf_units, only : quantity, unit_type
   implicit none (type, external)
   private
   public :: survey_columns

contains

   !> Fills `record%column`.
   subroutine survey_columns(table, keep, ranges, record)
      !> Its rows are in the store
      type(table_type), intent(in) :: table
      !> Columns that become channels: [chosen column]
      logical, intent(in) :: keep(:)
      !> Ranges and steps are wanted
      logical, intent(in) :: ranges
      type(record_type), intent(inout) :: record
      type(unit_type) :: unit
      integer :: j, slot

      allocate (record%column(table%layout%columns))
      do j = 1, size(record%column)
         associate (column => record%column(j))
            column%name = ""
            column%unit = ""
            if (table%names%known) then
               column%name = table%names%name(j)%text
               column%unit = table%names%unit(j)%text
               call find_unit(column%name, column%unit, unit)
               if (len(column%unit) == 0 .and. allocated(unit%name) .and. unit%quantity /= quantity%angle) column%unit = unit%name
            end if
            if (len(column%unit) == 0 .and. size(table%header%units) == size(record%column)) column%unit = &
               table%header%units(j)%text
            column%class = trim(class_names(table%class(j)))
            slot = table%layout%slot(j)
            if (slot > 0 .and. table%time > 0) column%is_time = slot == table%layout%slot(table%time)
            if (slot >= 1 .and. slot <= size(keep)) column%channel = merge(count(keep(:slot)), column%channel, keep(slot))
            column%minimum = ieee_value(1.0_dp, ieee_quiet_nan)
            column%maximum = column%minimum
            column%step = column%minimum
            if (ranges .and. slot > 0) call find_range(table%store, slot, column%minimum, column%maximum, column%step)
            if (column%is_time) column%minimum = column%minimum + real(table%layout%origin, dp)
            if (column%is_time) column%maximum = column%maximum + real(table%layout%origin, dp)
         end associate
      end do
   end subroutine survey_columns

   !> Smallest and largest value of a stored column, and the smallest step between rows, 0 where it is constant.
   pure subroutine find_range(store, slot, minimum, maximum, step)
      type(store_type), intent(in) :: store
      integer, intent(in) :: slot
      real(dp), intent(inout) :: minimum, maximum, step
      real(dp) :: before, change
      integer(int64) :: i
      integer :: k
      logical :: known

      known = .false.
      before = 0.0_dp
      change = huge(change)
      do k = 1, store%count
         do i = 1, store%chunk(k)%rows
            associate (x => store%chunk(k)%value(i, slot))
               if (ieee_is_nan(x)) cycle
               minimum = min(x, merge(minimum, x, known))
               maximum = max(x, merge(maximum, x, known))
               if (known .and. abs(x - before) > 0.0_dp) change = min(change, abs(x - before))
               known = .true.
               before = x
            end associate
         end do
      end do
      if (known) step = merge(change, 0.0_dp, change < huge(change))
   end subroutine find_range

end module gyroakf_io_survey
