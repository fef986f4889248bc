! SPDX-License-Identifier: MIT
!> A table of numbers: header, names, rows, and which columns are kept.
module gyroakf_io_table
   use gyroakf_kinds, only : int64
   use gyroakf_column_class, only : column_class, is_time_name
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_column_choice, only : analyzed_columns, choose_columns, classes_of, &
      find_column, in_order
   use gyroakf_io_columns, only : column_names_type, count_names, label_of, most_columns
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_header, only : header_type
   use gyroakf_io_rows, only : layout_type
   use gyroakf_io_lines, only : line_map_type
   use gyroakf_io_place, only : integer_text, line_error
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_stamps, only : fraction_of
   use gyroakf_io_store, only : store_type
   use gyroakf_record, only : text_type
   implicit none (type, external)
   private
   public :: table_type, begin_numbers, choose, set_slots

   !> A table as it was read
   type :: table_type
      !> For messages: the path or `<stdin>`
      character(:), allocatable :: name
      !> What the comment lines say
      type(header_type) :: header
      !> Names of all columns
      type(column_names_type) :: names
      !> The last comment that may be names: it is where its words are as many as the columns
      type(column_names_type) :: supposed
      !> All columns of the file, and which are kept
      type(layout_type) :: layout
      !> The columns that hold the record, in the order wanted; the time's, 0 for none
      integer, allocatable :: chosen(:)
      integer :: time = 0
      !> The column of fractions of the time's seconds, 0 for none; whether in nanoseconds
      integer :: fraction = 0
      logical :: nano = .true.
      !> What each column measures, one of the components of column_class: [column]
      integer, allocatable :: class(:)
      !> True where the columns were asked for; where the first one, which was not, has no name and
      !> may be the time, is kept behind them
      logical :: asked = .false., with_first = .false.
      !> The rows that are at hand
      type(store_type) :: store
      !> How many were read so far, and whether these are all
      integer(int64) :: rows = 0
      logical :: whole = .false.
      !> Where the rows stood
      type(line_map_type) :: map
      !> Lines that could not be read
      integer(int64) :: bad_lines = 0, first_bad_line = 0
      !> Lines that repeat the names of the columns
      integer(int64) :: headings = 0, first_heading = 0
      !> The stored integer type of every value: 8, 16, 32 or 64 bits; 0 for text and floating point
      integer :: integer_bits = 0
      !> COLUMN=VALUE of each of several sensors, for --where; unallocated where there are none
      type(text_type), allocatable :: kinds(:)
      !> What the user should know
      type(text_type), allocatable :: warnings(:)
   end type table_type

contains

   !> Decides on the columns of a table without text.
   subroutine begin_numbers(name, columns, options, table, error, names)
      !> Of the file, for messages
      character(*), intent(in) :: name
      integer(int64), intent(in) :: columns
      type(reader_options), intent(in) :: options
      type(table_type), intent(out) :: table
      !> Allocated on failure: invalid_argument, parse
      type(error_type), allocatable, intent(out) :: error
      !> Of the columns; they have none if absent
      type(column_names_type), intent(in), optional :: names

      table%name = name
      if (present(names)) table%names = names
      if (columns < 1 .or. columns > most_columns) call fatal_error(error, status%parse, name// &
         ": "//integer_text(columns)//" columns are not from 1 to "//integer_text(most_columns))
      if (allocated(error)) return
      table%layout%columns = int(columns)
      allocate (table%layout%kind(columns), source=stamp_kind%number)
      call choose(options, [logical ::], .false., table, error)
      if (.not. allocated(error)) call set_slots(0, table)
   end subroutine begin_numbers

   !> Decides which columns are kept.
   subroutine choose(options, texts, first_rises, table, error)
      type(reader_options), intent(in) :: options
      !> Columns of words: [column], or of size 0; the first one rises in the first rows
      logical, intent(in) :: texts(:), first_rises
      !> Its names and layout are known; the time, `class` and `chosen` are set
      type(table_type), intent(inout) :: table
      !> Where no column is left: parse; where none is what was asked for: invalid_argument
      type(error_type), allocatable, intent(out) :: error
      !> What is taken for the time where no name is one
      integer, parameter :: stamps(3) = [stamp_kind%moment, stamp_kind%clock, stamp_kind%date]
      character(:), allocatable :: word
      integer :: i, n

      n = table%layout%columns
      if (allocated(options%time_column)) then
         if (options%time_column /= "none") call find_column(options%time_column, table%names, n, &
            table%time, error)
         if (allocated(error)) return
      else
         do i = count_names(table%names), 1, -1
            if (is_time_name(table%names%name(i)%text, table%names%unit(i)%text)) table%time = i
         end do
         do i = 1, merge(size(stamps), 0, table%time == 0)
            if (table%time == 0) table%time = findloc(table%layout%kind, stamps(i), dim=1)
         end do
      end if
      if (table%time > 0 .and. table%names%known) call fraction_of(table%names%name, table%time, &
         table%fraction, table%nano)
      if (.not. allocated(table%header%units)) allocate (table%header%units(0))
      table%class = classes_of(table%names, table%header%units, texts, n)
      if (table%fraction > 0) table%class(table%fraction) = column_class%time
      i = table%layout%where_column
      if (i > 0 .and. .not. table%layout%strict) table%class(i) = max(table%class(i), &
         column_class%flag)
      table%asked = allocated(options%columns)
      if (table%asked) then
         call choose_columns(options%columns, table%names, n, table%chosen, error)
         if (allocated(error)) return
         i = findloc(is_stamp(table%layout%kind(table%chosen)), .true., dim=1)
         if (i > 0) call fatal_error(error, status%invalid_argument, &
            label_of(table%names, table%chosen(i))//" holds dates or times of day, not values")
         if (allocated(error)) return
         table%with_first = first_rises .and. table%time == 0 .and. .not. (table%names%known .or. &
            allocated(options%time_column) .or. options%rate_hz > 0 .or. &
            options%input == "angle" .or. any(table%chosen == 1))
         if (table%with_first) table%chosen = [table%chosen, 1]
      else
         call choose_by_class(options, table)
      end if
      if (allocated(error)) return
      if (size(table%chosen) > 0) return
      word = "every column holds dates or times of day"
      if (table%time > 0) word = "there is no column besides the time in "// &
         label_of(table%names, table%time)
      call line_error(error, table%name, max(1_int64, table%names%line), word, &
         "a record needs a column of numbers besides the time")
   end subroutine choose

   !> The columns that are kept where none was asked for: those that are analyzed; and where the
   !> time is not known, what may be it or a counter.
   subroutine choose_by_class(options, table)
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      logical :: number(table%layout%columns), kept(table%layout%columns)
      integer :: i

      number = [(i /= table%time .and. i /= table%fraction, i=1, size(number))] .and. &
         .not. is_stamp(table%layout%kind)
      kept(:) = .false.
      kept(pack([(i, i=1, size(kept))], number)) = analyzed_columns(pack(table%class, number), &
         options%input /= "rate")
      associate (class => table%class)
         if (options%survey) then
            kept = number .and. class /= column_class%text .and. class /= column_class%time
         else if (table%time == 0 .and. .not. allocated(options%time_column)) then
            kept = kept .or. &
               (number .and. (class == column_class%unknown .or. class == column_class%counter))
            if (table%names%known) kept = kept .or. &
               (number .and. [(table%names%name(i)%text == "T", i=1, size(kept))])
         else if (.not. any(class == column_class%rate)) then
            kept = kept .or. (number .and. class == column_class%counter)
         end if
         table%chosen = pack([(i, i=1, size(kept))], kept)
         table%chosen = table%chosen(in_order(class(table%chosen)))
      end associate
   end subroutine choose_by_class

   elemental logical function is_stamp(kind)
      integer, intent(in) :: kind

      is_stamp = kind /= stamp_kind%number .and. kind /= stamp_kind%long
   end function is_stamp

   !> Where the columns are kept: the chosen ones in their order, then the time, unless it is one of
   !> them. A date and a time of day in two columns are kept in one place.
   subroutine set_slots(partner, table)
      !> The column beside the time's that is kept with it, 0 for none
      integer, intent(in) :: partner
      type(table_type), intent(inout) :: table
      integer :: i

      allocate (table%layout%slot(table%layout%columns))
      table%layout%slot(:) = 0
      do i = 1, size(table%chosen)
         table%layout%slot(table%chosen(i)) = i
      end do
      table%layout%stored = size(table%chosen)
      if (table%time == 0) return
      if (table%layout%slot(table%time) > 0) return
      table%layout%stored = table%layout%stored + 1
      table%layout%slot(table%time) = table%layout%stored
      if (partner > 0) table%layout%slot(partner) = table%layout%stored
   end subroutine set_slots

end module gyroakf_io_table
