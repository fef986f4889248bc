! SPDX-License-Identifier: MIT
!> Some whole lines of a table, read into rows of their own: what a thread does.
!>
!> Nothing here builds a text or keeps a state, so that any number of spans can be read at a time;
!> who joins them says what is wrong with the first bad line.
module gyroakf_io_span
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_io_lines, only : line_map_type, map_row
   use gyroakf_io_selection, only : is_wanted
   use gyroakf_io_row, only : read_row
   use gyroakf_io_rows, only : layout_type, parse_rows, problem_type
   use gyroakf_io_text, only : begins_with_semicolon, fields_type, first_visible, is_no_row, &
      last_visible, line_end_from, line_feed_from
   implicit none (type, external)
   private
   public :: span_type, read_span

   !> What was met among some lines
   type :: tally_type
      !> Rows that were read, lines that were left behind
      integer(int64) :: rows = 0, lines = 0
      !> Lines that count as missing, and the first of them, counted from the start of the span
      integer(int64) :: bad_lines = 0, first_bad_line = 0
      !> Lines that repeat the names of the columns, and the first of them
      integer(int64) :: headings = 0, first_heading = 0
      !> First byte of a line that could not be read, the last one looked at; 0 for none
      integer(int64) :: problem_at = 0
      !> True where there was no memory for the rows
      logical :: no_memory = .false.
   end type tally_type

   !> Rows of some lines; its arrays are used again for the next lines
   type, extends(tally_type) :: span_type
      !> The lines are in first:last, last being a line feed; there are none where last < first
      integer(int64) :: first = 1, last = 0
      !> [row, stored column]; NaN where missing
      real(dp), allocatable :: value(:, :)
      !> Where rows stood, both counted from the start of the span
      type(line_map_type) :: map
      !> Work space: the fields and the numbers of one line
      type(fields_type) :: fields
      real(dp), allocatable :: row(:)
   end type span_type

contains

   !> Reads the lines of a span.
   subroutine read_span(bytes, layout, span)
      !> Holds the lines, and more bytes behind them
      integer(int8), intent(in), contiguous :: bytes(:)
      type(layout_type), intent(in) :: layout
      !> `first` and `last` tell the lines; the rest is filled
      type(span_type), intent(inout) :: span
      integer(int64) :: at, before, feed
      logical :: odd

      span%tally_type = tally_type()
      span%map%count = 0
      at = span%first
      do while (at <= span%last)
         call reserve_rows(layout, at, span)
         if (span%no_memory) return
         before = span%rows
         if (layout%where_column > 0) then
            call skip_unwanted(bytes, at, feed, layout, span, odd)
            if (at > span%last) exit
            if (.not. odd) call parse_rows(bytes, at, feed, layout, span%value, span%rows, odd)
         else
            call parse_rows(bytes, at, span%last, layout, span%value, span%rows, odd)
         end if
         span%lines = span%lines + span%rows - before
         if (odd) call take_odd_line(bytes, at, layout, span)
         if (span%problem_at > 0) return
      end do
   end subroutine read_span

   !> Moves to the next row that `layout%where_column` selects, and finds its end.
   subroutine skip_unwanted(bytes, at, feed, layout, span, odd)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: at
      integer(int64), intent(out) :: feed
      type(layout_type), intent(in) :: layout
      type(span_type), intent(inout) :: span
      logical, intent(out) :: odd

      odd = .false.
      do while (at <= span%last)
         feed = line_feed_from(bytes, at)
         odd = .not. is_wanted(bytes, at, feed - 1, layout)
         if (layout%strict .or. .not. odd) return
         span%lines = span%lines + 1
         call map_row(span%map, span%rows + 1, span%lines + 1)
         at = feed + 1
      end do
   end subroutine skip_unwanted

   !> Reserves at least one row more, by the length of the lines, then by the rows so far.
   pure subroutine reserve_rows(layout, at, span)
      type(layout_type), intent(in) :: layout
      integer(int64), intent(in) :: at
      type(span_type), intent(inout) :: span
      real(dp), allocatable :: longer(:, :)
      integer(int64) :: capacity, row_bytes
      integer :: failed

      failed = 0
      if (allocated(span%value)) then
         if (span%rows < size(span%value, 1, kind=int64)) return
         row_bytes = (at - span%first)/max(span%rows, 1_int64)
         capacity = span%rows + 8 + (span%last - at)/max(row_bytes, 1_int64)
      else
         allocate (span%row(layout%stored), stat=failed)
         capacity = 8 + (span%last - at)/max(20, 7*layout%columns)
      end if
      if (failed == 0) allocate (longer(capacity, layout%stored), stat=failed)
      span%no_memory = failed /= 0
      if (span%no_memory) return
      if (span%rows > 0) longer(:span%rows, :) = span%value(:span%rows, :)
      call move_alloc(longer, span%value)
   end subroutine reserve_rows

   subroutine take_odd_line(bytes, at, layout, span)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(inout) :: at
      type(layout_type), intent(in) :: layout
      type(span_type), intent(inout) :: span
      type(problem_type) :: problem
      integer(int64) :: feed, last
      logical :: no_row

      feed = line_feed_from(bytes, at)
      last = line_end_from(bytes, at)
      no_row = is_no_row(bytes, at, last)
      if (is_heading(bytes, at, last, layout)) then
         if (span%headings == 0) span%first_heading = span%lines + 1
         span%headings = span%headings + 1
         no_row = .true.
      else if (.not. no_row .or. &
         (layout%semicolons .and. begins_with_semicolon(bytes, at, last))) then
         call read_row(bytes, at, last, layout, span%fields, span%row, problem, .false.)
         no_row = no_row .and. problem%found
      end if
      if (no_row) then
         call map_row(span%map, span%rows + 1, span%lines + 2)
      else
         if (problem%found .and. .not. layout%bad_lines_missing) then
            span%problem_at = at
            return
         end if
         if (problem%found) then
            span%row(:) = ieee_value(1.0_dp, ieee_quiet_nan)
            span%bad_lines = span%bad_lines + 1
            if (span%first_bad_line == 0) span%first_bad_line = span%lines + 1
         end if
         span%rows = span%rows + 1
         span%value(span%rows, :) = span%row
      end if
      at = feed + 1
      span%lines = span%lines + 1
   end subroutine take_odd_line

   !> True for a line that repeats the names of the columns, as in joined files.
   pure logical function is_heading(bytes, first, last, layout)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      type(layout_type), intent(in) :: layout
      integer(int64) :: from, to

      is_heading = .false.
      if (.not. allocated(layout%heading)) return
      from = first_visible(bytes, first, last)
      to = last_visible(bytes, first, last)
      if (to - from + 1 /= size(layout%heading)) return
      is_heading = all(bytes(from:to) == layout%heading)
   end function is_heading

end module gyroakf_io_span
