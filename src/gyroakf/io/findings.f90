! SPDX-License-Identifier: MIT
!> What the user should know of a recording: what each column measures, its range; what is odd.
module gyroakf_io_findings
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_column_class, only : class_names, find_unit
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_place, only : integer_text, integer_length
   use gyroakf_io_store, only : store_type
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, record_type
   use gyroakf_units, only : quantity, unit_type
   implicit none (type, external)
   private
   public :: add_findings, survey_columns

contains

   !> Lines of what is odd, and the warnings about it.
   subroutine add_findings(table, from, record)
      type(table_type), intent(in) :: table
      !> Where the record begins, s from the first row
      real(dp), intent(in) :: from
      type(record_type), intent(inout) :: record
      character(13), parameter :: what(3) = [character(13) :: "equal stamp", "backward step", "gap"]
      integer(int64) :: count(3)
      integer :: k

      count = [record%audit%duplicates, record%audit%backward_steps, record%audit%gaps]
      do k = 1, 3
         if (count(k) > 0) call add_text(record%warnings, "the time column shows "// &
            counted(count(k), trim(what(k)))//"; the first is in line "// &
            integer_text(record%audit%line_of_first(k)))
      end do
      if (record%audit%jumps > 0) call add_text(record%warnings, &
         "a jump of the time stamps is too long to be filled with missing samples; the parts "// &
         "before and after it are joined: analyze them apart with `from` and `to`")
      call explain_rates(record)
      associate (audit => record%audit)
         if (audit%repeated > 0) call add_text(record%warnings, counted(audit%repeated, "row")// &
            " with stamp and values of the row above: left out; the first is in line "// &
            integer_text(audit%line_of_repeat), note=.true.)
         if (audit%untimed > 0 .and. audit%has_stamps) call add_text(record%warnings, &
            counted(audit%untimed, "row")//" without a time: left out; the first is in line "// &
            integer_text(audit%line_of_untimed))
         if (audit%rollovers > 0) call add_text(record%warnings, "the time starts again after "// &
            format_real(audit%rollover_period, 12)//" s in "//counted(audit%rollovers, "place")// &
            " and is continued; the first is in line "//integer_text(audit%line_of_rollover), &
            note=.true.)
         if (audit%bursts > 0) call add_text(record%warnings, &
            "samples were delivered late and several at once in "// &
            counted(audit%bursts, "place")//", up to "//integer_text(audit%longest_burst)// &
            " at once; the first is in line "//integer_text(audit%line_of_burst))
         if (audit%rate_changes > 0) call add_text(record%warnings, "the rate changes from "// &
            format_real(audit%rate_before, 6)//" Hz to "//format_real(audit%rate_after, 6)// &
            " Hz in line "//integer_text(audit%line_of_change)// &
            trim(merge(", the first of several changes", "                              ", &
            audit%rate_changes > 1))//"; analyze the parts apart with `from` and `to`")
      end associate
      if (record%audit%jitter_max > 1.0_dp*record%sample_interval .and. record%rate_known .and. &
         .not. placed(record)) then
         call add_text(record%warnings, "the time stamps are up to "// &
            format_real(record%audit%jitter_max, 3)// &
            " s away from an even grid; the samples are taken as evenly spaced at the mean "// &
            "rate"//trim(merge(": `resample` nearest places them by their time stamps  ", &
            "; in bursts they are those of delivery, not of sampling", &
            record%audit%bursts == 0)))
      end if
      if (record%audit%still(1) > 0) call add_text(record%warnings, &
         "the values do not change from "//trim(moment(record%audit%still(1)))//" to "// &
         trim(moment(record%audit%still(2)))// &
         ": the sensor hung, or the file was padded; `from` and `to` select a part without it")
      if (table%headings > 0) call add_text(record%warnings, counted(table%headings, "line")// &
         trim(merge(" repeats", " repeat ", table%headings == 1))// &
         " the names of the columns, as in files that were put behind one another: left out; "// &
         "the first is line "//integer_text(table%first_heading), note=.true.)
      if (table%bad_lines > 0) call add_text(record%warnings, counted(table%bad_lines, "line")// &
         " could not be read and "//trim(merge("counts", "count ", table%bad_lines == 1))// &
         " as missing; the first is line "//integer_text(table%first_bad_line))

   contains

      !> "59.8 s", "sample 71762": when a sample was taken.
      character(40) function moment(sample) result(text)
         integer(int64), intent(in) :: sample

         text = "sample "//integer_text(sample)
         if (record%rate_known) text = format_real(max(0.0_dp, from) &
            + real(sample - 1, dp)*record%sample_interval, 7)//" s"
      end function moment

   end subroutine add_findings

   !> Double steps at even distances: two sample rates, one with lost samples, explain the stamps.
   subroutine explain_rates(record)
      type(record_type), intent(inout) :: record
      character(:), allocatable :: text

      associate (audit => record%audit)
         if (audit%beats > 0) text = "the time stamps make a double step in "// &
            counted(audit%beats, "place")// &
            ", as those of a clock do that is too coarse for the rate, or of lost samples; "// &
            trim(merge("the stamps place the samples, as was asked             ", &
            "the samples are taken as evenly spaced at the mean rate", placed(record)))
         if (audit%other_rate > 0.0_dp) then
            if (audit%beats == 0) text = "the time stamps make a double step at even "// &
               "distances: "//format_real(audit%stamp_rate, 6)//" Hz with lost samples is "// &
               "taken, but "//format_real(audit%other_rate, 6)//" Hz and a clock that counts "// &
               "in "//format_real(audit%resolution, 3)//" s explain them equally well"
            text = text//"; `rate_hz` "//format_real(audit%other_rate, 6)// &
               " takes the other explanation"
         end if
      end associate
      if (allocated(text)) call add_text(record%warnings, text)
   end subroutine explain_rates

   pure logical function placed(record)
      type(record_type), intent(in) :: record

      placed = allocated(record%resample)
      if (placed) placed = record%resample /= "index"
   end function placed

   !> "1 row", "2 rows".
   pure function counted(number, noun) result(text)
      integer(int64), intent(in) :: number
      character(*), intent(in) :: noun
      character(integer_length(number) + 1 + len(noun) + count([number /= 1])) :: text

      text = integer_text(number)//" "//noun
      if (number /= 1) text(len(text):) = "s"
   end function counted

   !> Fills `record%column`.
   subroutine survey_columns(table, keep, ranges, record)
      type(table_type), intent(in) :: table
      !> Columns that become channels: [chosen column]
      logical, intent(in) :: keep(:)
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
               if (len(column%unit) == 0 .and. allocated(unit%name) .and. &
                  unit%quantity /= quantity%angle) column%unit = unit%name
            end if
            if (len(column%unit) == 0 .and. size(table%header%units) == size(record%column)) then
               column%unit = table%header%units(j)%text
            end if
            column%class = trim(class_names(table%class(j)))
            slot = table%layout%slot(j)
            if (slot > 0 .and. table%time > 0) column%is_time = &
               slot == table%layout%slot(table%time)
            if (slot >= 1 .and. slot <= size(keep)) then
               if (keep(slot)) column%channel = count(keep(:slot))
            end if
            column%minimum = ieee_value(1.0_dp, ieee_quiet_nan)
            column%maximum = column%minimum
            column%step = column%minimum
            if (ranges .and. slot > 0) call find_range(table%store, slot, column%minimum, &
               column%maximum, column%step)
            if (column%is_time) column%minimum = column%minimum + real(table%layout%origin, dp)
            if (column%is_time) column%maximum = column%maximum + real(table%layout%origin, dp)
         end associate
      end do
   end subroutine survey_columns

   !> Range of a stored column, and the smallest step between rows, 0 where it is constant.
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

end module gyroakf_io_findings
