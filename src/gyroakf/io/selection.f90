! SPDX-License-Identifier: MIT
!> Rows of several sensors in one table: found by a column that alternates, selected by its value.
module gyroakf_io_selection
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_column_class, only : class_of, column_class
   use gyroakf_error, only : error_type
   use gyroakf_io_column_choice, only : find_column
   use gyroakf_io_columns, only : column_names_type, label_of
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_row, only : agrees, split_row
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text, only : bytes_text, fields_type, is_no_row, line_feed_from, text_bytes
   use gyroakf_record, only : add_text, text_type
   implicit none (type, external)
   private
   public :: first_rows, find_interleaved, find_kinds_of_records, is_wanted, set_condition

   !> Rows at the start that are looked at, and the most sensors in them
   integer, parameter :: most_rows = 64, most_sensors = 8
   !> Tables of more columns are not looked at
   integer, parameter :: most_columns = 256
   !> Fields at the start that are looked at
   integer, parameter :: most_fields = 1000000

contains

   !> True for a row that meets the layout's condition. Thread-safe.
   pure logical function is_wanted(bytes, first, last, layout)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> With `where_column` and `where_value`
      type(layout_type), intent(in) :: layout
      type(fields_type) :: fields

      call split_row(bytes, first, last, layout, fields)
      is_wanted = agrees(bytes, fields, layout)
   end function is_wanted

   !> Takes in COLUMN=VALUE.
   subroutine set_condition(text, names, columns, layout, error)
      character(*), intent(in) :: text
      type(column_names_type), intent(in) :: names
      integer, intent(in) :: columns
      !> `where_column`, `where_value` and `where_number` are set
      type(layout_type), intent(inout) :: layout
      !> Allocated where there is no such column: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      integer :: mark, found

      mark = index(text, "=", back=.true.)
      call find_column(text(:mark - 1), names, columns, layout%where_column, error)
      layout%where_value = text_bytes(text(mark + 1:))
      layout%where_number = huge(1.0_dp)
      call parse_number(text(mark + 1:), layout%where_number, found)
      if (found /= number%ok) layout%where_number = ieee_value(1.0_dp, ieee_quiet_nan)
   end subroutine set_condition

   !> Looks for a column that alternates between few values while the time stamps repeat.
   subroutine find_interleaved(field, table, what)
      type(text_type), intent(in) :: field(:, :)
      !> Its columns are known; `kinds` is set where there are several sensors
      type(table_type), intent(inout) :: table
      !> The message; unallocated where there is one sensor
      character(:), allocatable, intent(out) :: what
      character(:), allocatable :: column
      integer :: j, k, sensors

      if (size(field, 2) > most_columns .or. size(field, 1) < 8) return
      do j = 1, size(field, 2)
         if (j == table%time .or. &
            any(table%class(j) == [column_class%rate, column_class%acceleration])) cycle
         sensors = 0
         do k = max(1, table%time), merge(table%time, size(field, 2), table%time > 0)
            if (k /= j) sensors = max(sensors, alternating(field(:, j), field(:, k), &
               table%time > 0))
         end do
         if (sensors == 0) cycle
         what = label_of(table%names, j)//" alternates between "//integer_text(sensors)// &
            " values while the time stamps repeat: "//integer_text(sensors)//" sensors in one table"
         column = ""
         if (table%names%known) column = table%names%name(j)%text
         if (len(column) == 0 .or. scan(column, " =()[]$*?#;&|<>'""") > 0) column = integer_text(j)
         do k = 1, sensors
            call add_text(table%kinds, column//"="//field(k, j)%text)
         end do
         return
      end do
   end subroutine find_interleaved

   !> Looks for a column of words that repeat, with only times and counters before it: rows that
   !> hold another word than the first row are wrong then. Words behind the samples describe a row.
   subroutine find_kinds_of_records(field, texts, table)
      type(text_type), intent(in) :: field(:, :)
      !> Columns of words: [column]
      logical, intent(in) :: texts(:)
      !> `where_column`, `where_value` and `strict` of its layout are set
      type(table_type), intent(inout) :: table
      type(error_type), allocatable :: failed
      integer, allocatable :: class(:)
      integer :: rows, i, j, k, words

      rows = size(field, 1)
      do j = 1, merge(size(texts), 0, size(texts) <= most_columns)
         if (.not. texts(j)) cycle
         if (table%names%known) then
            class = [(class_of(table%names%name(k)%text, ""), k=1, j)]
            if (all(class(j) /= [column_class%unknown, column_class%counter])) cycle
            if (.not. all(texts(:j - 1) .or. class(:j - 1) == column_class%time .or. &
               class(:j - 1) == column_class%counter)) return
         else if (j > 2) then
            return
         end if
         words = count([(.not. any([(field(i, j)%text == field(k, j)%text, k=1, i - 1)]), i=1, &
            rows)])
         if (2*words > rows) cycle
         call set_condition(integer_text(j)//"="//field(1, j)%text, column_names_type(), &
            table%layout%columns, table%layout, failed)
         table%layout%strict = .not. allocated(failed)
         return
      end do
   end subroutine find_kinds_of_records

   !> The fields of the first rows that have enough and are wanted.
   pure subroutine first_rows(bytes, first, last, layout, field, stat)
      !> Holds rows from first on, up to the line feed at last
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      !> `columns`, `joined` and the condition are known
      type(layout_type), intent(in) :: layout
      !> [row, column]; fewer rows than 64 where there are many columns
      type(text_type), allocatable, intent(out) :: field(:, :)
      integer, intent(out) :: stat
      type(text_type), allocatable :: all_fields(:, :)
      type(fields_type) :: fields
      integer(int64) :: at, to
      integer :: rows, j
      logical :: wanted

      allocate (all_fields(max(8, min(most_rows, most_fields/max(1, layout%columns))), &
         layout%columns), stat=stat)
      if (stat /= 0) return
      rows = 0
      at = first
      do while (at <= last .and. rows < size(all_fields, 1))
         to = line_feed_from(bytes, at)
         if (.not. is_no_row(bytes, at, to - 1)) then
            call split_row(bytes, at, to - 1, layout, fields)
            wanted = layout%where_column == 0
            if (.not. wanted) wanted = agrees(bytes, fields, layout)
            if (wanted .and. fields%count >= layout%columns) then
               rows = rows + 1
               do j = 1, layout%columns
                  all_fields(rows, j)%text = bytes_text(bytes, fields%first(j), fields%last(j))
               end do
            end if
         end if
         at = to + 1
      end do
      allocate (field(rows, layout%columns), stat=stat)
      if (stat == 0) field(:, :) = all_fields(:rows, :)
   end subroutine first_rows

   !> The number of values that a column repeats while stamps repeat in most rows; 0 if it does not.
   pure integer function alternating(field, stamp, known) result(period)
      type(text_type), intent(in) :: field(:), stamp(:)
      logical, intent(in) :: known
      integer :: i, equal, n

      n = size(field)
      equal = 0
      period = 0
      do i = 2, n
         if (stamp(i)%text /= stamp(i - 1)%text) cycle
         if (field(i)%text == field(i - 1)%text) return
         equal = equal + 1
      end do
      if (4*equal < n) return
      do period = 2, min(most_sensors, n/3)
         if (10*count([(field(i)%text == field(i - period)%text, i=period + 1, n)]) >= 9*(n &
            - period)) exit
      end do
      if (period > min(most_sensors, n/3)) period = 0
      if (.not. known .and. &
         any([(stamp(i)%text == stamp(i - period)%text, i=period + 1, n)])) period = 0
   end function alternating

end module gyroakf_io_selection
