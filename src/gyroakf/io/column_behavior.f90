! SPDX-License-Identifier: MIT
!> Columns that are a time or a counter by what they do from row to row, whatever their names.
module gyroakf_io_column_behavior
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_columns, only : label_of
   use gyroakf_io_column_choice, only : analyzed_columns
   use gyroakf_io_place, only : integer_text
   use gyroakf_column_class, only : column_class, may_hold_time
   use gyroakf_io_store, only : store_type
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: find_time_and_counters, find_first_time

   !> Behavior of a column: rises from row to row, unevenly; rises evenly, perhaps with equal values
   !> or a rollover; holds whole numbers that rise by 1 in most rows, or is a counter by name that
   !> never falls: these may start again; holds one value
   integer, parameter :: other = 0, rising = 1, even_time = 2, counter = 3, constant = 4
   !> A column rises by chance in fewer rows
   integer(int64), parameter :: least_rises = 20

contains

   !> Takes the first column that behaves like a time for it where there is none; finds counters.
   subroutine find_time_and_counters(table, time_known, input, keep, warnings)
      !> Its rows are read, its columns were not asked for; `time` and `class` may be set
      type(table_type), intent(inout) :: table
      !> The time column was given, or is not wanted
      logical, intent(in) :: time_known
      !> "rate", "increment" or "angle": angles may rise evenly and count, and are not looked at
      character(*), intent(in) :: input
      !> Columns that are channels: [chosen column]
      logical, intent(out) :: keep(:)
      type(text_type), allocatable, intent(inout) :: warnings(:)
      integer :: kind(size(keep)), j
      logical :: may(size(keep))

      kind(:) = other
      may(:) = .true.
      do j = 1, size(keep)
         if (table%names%known) then
            associate (names => table%names, column => table%chosen(j))
               may(j) = may_hold_time(names%name(column)%text, names%unit(column)%text) &
                        .or. names%name(column)%text == "T"
            end associate
         end if
         if (.not. may(j) .or. input == "angle") cycle
         kind(j) = behavior_of(table%store, j, table%class(table%chosen(j)) == column_class%counter)
      end do
      do j = 1, size(keep)
         if (table%time > 0 .or. time_known) exit
         if (kind(j) /= even_time .or. size(keep) < 2) cycle
         call take_time(table, j, warnings)
      end do
      associate (class => table%class)
         do j = 1, size(keep)
            if (kind(j) == counter) then
               class(table%chosen(j)) = column_class%counter
            else if (class(table%chosen(j)) == column_class%counter .and. input /= "angle") then
               class(table%chosen(j)) = merge(column_class%flag, column_class%unknown, &
                  kind(j) == constant)
            end if
         end do
         keep(:) = .false.
         keep(pack([(j, j=1, size(keep))], table%chosen /= table%time)) = &
            analyzed_columns(pack(class(table%chosen), table%chosen /= table%time), input /= "rate")
      end associate
      if (.not. any(keep)) keep(:) = table%chosen /= table%time
      if (input == "rate" .and. &
         all(pack(table%class(table%chosen), keep) == column_class%angle)) then
         call add_text(warnings, "the columns hold angles by their names and are read as "// &
            "rates; `input` angle takes their differences")
      end if
      if (kind(1) /= rising .and. kind(1) /= even_time) return
      if (.not. keep(1) .or. count(keep) < 2 .or. .not. may(1)) return
      call add_text(warnings, label_of(table%names, table%chosen(1))// &
                    " rises from row to row and looks like "// &
                    trim(merge("a further time", "time          ", table%time > 0))// &
                    "; it is read as a channel, `time_column` "// &
                    integer_text(table%chosen(1))//" takes it for the time")
   end subroutine find_time_and_counters

   !> The first column, kept behind those that were asked for, is the time or nothing.
   subroutine find_first_time(table, keep, warnings)
      type(table_type), intent(inout) :: table
      !> Columns that are channels: [chosen column]
      logical, intent(inout) :: keep(:)
      type(text_type), allocatable, intent(inout) :: warnings(:)

      keep(size(keep)) = .false.
      if (behavior_of(table%store, size(keep), .false.) /= even_time) return
      call take_time(table, size(keep), warnings)
   end subroutine find_first_time

   !> Takes a chosen column for the time.
   subroutine take_time(table, j, warnings)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: j
      type(text_type), allocatable, intent(inout) :: warnings(:)

      table%time = table%chosen(j)
      table%class(table%time) = column_class%time
      call add_text(warnings, label_of(table%names, table%time)//" rises evenly from row to "// &
         "row and is taken for the time; `time_column` none forbids it")
   end subroutine take_time

   !> What a column does; one that falls otherwise than by starting again is left after a few rows.
   pure integer function behavior_of(store, column, named_counter) result(found)
      type(store_type), intent(in) :: store
      integer, intent(in) :: column
      logical, intent(in) :: named_counter
      integer(int64) :: i, rises, ones, even, falls, rows
      integer :: k
      real(dp) :: before, lowest, highest, step, usual
      logical :: whole

      found = other
      before = ieee_value(before, ieee_quiet_nan)
      rises = 0
      ones = 0
      even = 0
      falls = 0
      rows = 0
      usual = 0.0_dp
      lowest = huge(lowest)
      highest = -huge(highest)
      whole = .true.
      do k = 1, store%count
         do i = 1, store%chunk(k)%rows
            associate (x => store%chunk(k)%value(i, column))
               if (ieee_is_nan(x)) cycle
               if (abs(x) > 1.0e30_dp) return
               rows = rows + 1
               lowest = min(lowest, x)
               highest = max(highest, x)
               whole = whole .and. abs(x - anint(x)) <= 0.0_dp
               if (.not. ieee_is_nan(before)) then
                  step = x - before
                  if (step > 0.0_dp) then
                     rises = rises + 1
                     if (abs(step - 1.0_dp) <= 0.0_dp) ones = ones + 1
                     if (step >= 0.2_dp*usual .and. step <= 5.0_dp*usual) even = even + 1
                     if (rises > 20) step = min(step, 5.0_dp*usual)         ! a pause
                     usual = usual + (step - usual)/real(min(rises, 100_int64), dp)
                  else if (step < 0.0_dp) then
                     falls = falls + 1
                     if (falls > 1 + rows/8 .or. rises == 0) return
                     if (-step < 0.5_dp*(highest - lowest)) return
                  end if
               end if
               before = x
            end associate
         end do
      end do
      if (rows > 0 .and. lowest >= highest) found = constant
      if (rises < least_rises .or. 20*rises < rows) return
      found = rising
      if (whole .and. (2*ones >= rises .or. named_counter)) then
         found = counter
      else if (falls > 1 + rows/2000) then
         found = other
      else if (5*even >= 4*rises) then
         found = even_time
      end if
   end function behavior_of

end module gyroakf_io_column_behavior
