! SPDX-License-Identifier: MIT
!> The rows of a table in text, read into its store by several threads.
!>
!> A block of the file is cut into pieces of equal length. Each thread reads a piece of a regular
!> file into its place, and the whole lines within it; then the lines that lie on the borders are
!> read; then the rows of all these spans are joined in their order. What is read does not depend on
!> the number of threads, nor on where the pieces are cut.
module gyroakf_io_text_rows
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_commas, only : make_points
   use gyroakf_io_lines, only : check_length, end_last_line, lines_type, reserve_bytes, map_row, &
      turn_returns
   use gyroakf_io_marks, only : strip_lines
   use gyroakf_io_number, only : digits_ahead
   use gyroakf_io_place, only : integer_text, place_error
   use gyroakf_io_layout, only : layout_type, problem_type
   use gyroakf_io_row, only : read_row
   use gyroakf_io_source, only : has_places, read_block, read_piece, source_left
   use gyroakf_io_span, only : copy_rows, read_span, span_type
   use gyroakf_io_store, only : count_rows, next_chunk
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text, only : fields_type, line_end_from
   use gyroakf_progress, only : progress_type, report_progress
   implicit none (type, external)
   private
   public :: read_rows

   !> Bytes of a piece, which stays in a core's cache, and of a block: pieces for 32 threads
   integer(int64), parameter :: piece_size = 131072, block_size = 32*piece_size
   !> Bytes that a file may have grown by within a line, see [[end_last_line]]
   integer(int64), parameter :: reserve = 4096
   integer(int8), parameter :: line_feed = 10

   !> A block of bytes: pieces of new bytes behind those that are at hand
   type :: block_type
      !> First and last of the new bytes
      integer(int64) :: first = 1, last = 0
      !> True where the pieces are to be read by the threads, from this place of the source on
      logical :: by_pieces = .false.
      integer(int64) :: offset = 0
      !> Spans: 2k is within piece k, 2k - 1 lies before it and the last one behind the last piece
      integer :: pieces = 0
      type(span_type), allocatable :: span(:)
   end type block_type

contains

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_rows(lines, most, table, error, progress)
      type(lines_type), intent(inout) :: lines
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Its store grows
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback, in bytes read
      class(progress_type), intent(inout), optional :: progress
      type(block_type) :: block
      integer(int64) :: missing, row_bytes, wanted

      do
         missing = most - count_rows(table%store)
         if (missing <= 0) return
         call report_progress("reading", lines%source%delivered, lines%source%length, error, &
            progress)
         if (allocated(error)) return
         table%whole = lines%ended .and. lines%at > lines%filled
         if (table%whole) return
         row_bytes = 24
         if (table%rows > 0) row_bytes = max(2_int64, lines%source%delivered/table%rows)
         wanted = block_size
         if (missing < block_size/row_bytes) wanted = max(piece_size, missing*row_bytes)
         call begin_block(lines, wanted, block, error)
         if (.not. allocated(error)) call read_pieces(lines, table, block)
         if (.not. allocated(error) .and. block%by_pieces) call take_bytes(lines, block, error)
         if (.not. allocated(error)) call read_borders(lines, table, block)
         if (.not. allocated(error)) call join_spans(lines, missing, table, block, error)
         if (allocated(error)) return
      end do
   end subroutine read_rows

   !> Decides on the next block; reads it where that cannot be left to the threads.
   subroutine begin_block(lines, wanted, block, error)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: wanted
      type(block_type), intent(inout) :: block
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got

      block%by_pieces = .false.
      if (lines%last >= lines%at) then
         block%first = lines%at
      else
         call reserve_bytes(lines, wanted + reserve, error)
         if (allocated(error)) return
         block%first = lines%filled + 1
         block%by_pieces = has_places(lines%source)
         if (.not. block%by_pieces) then
            call read_block(lines%source, lines%bytes(block%first:lines%filled + wanted), got, &
               error)
            if (allocated(error)) return
            lines%filled = lines%filled + got
            lines%ended = got < wanted
            if (lines%ended) call end_last_line(lines, error)
         end if
      end if
      block%last = lines%filled
      block%offset = lines%source%delivered
      if (block%by_pieces) block%last = block%first - 1 + min(wanted, source_left(lines%source))
      block%pieces = int((block%last - block%first + piece_size)/piece_size)
      if (allocated(block%span)) then                                     ! they keep their memory
         if (size(block%span) <= 2*block%pieces) deallocate (block%span)
      end if
      if (.not. allocated(block%span)) allocate (block%span(2*block%pieces + 1))
   end subroutine begin_block

   subroutine read_pieces(lines, table, block)
      type(lines_type), intent(inout) :: lines
      type(table_type), intent(in) :: table
      type(block_type), intent(inout) :: block
      integer(int64) :: first, last
      integer :: k

      !$omp parallel do schedule(dynamic) private(first, last) if(block%pieces > 1)
      do k = 1, block%pieces
         first = block%first + (k - 1)*piece_size
         last = min(first + piece_size - 1, block%last)
         if (block%by_pieces) then
            call read_piece(lines%source, block%offset + first - block%first, &
               lines%bytes(first:last), block%span(2*k)%got, block%span(2*k)%failed)
            last = first - 1 + block%span(2*k)%got
         end if
         if (lines%only_returns) call turn_returns(lines%bytes(first:last))
         call find_lines(lines%bytes, first, last, block%span(2*k)%first, block%span(2*k)%last)
         call read_lines(lines%bytes, table%layout, block%span(2*k))
      end do
      !$omp end parallel do
   end subroutine read_pieces

   !> Reads the lines of a span, labels and brackets becoming blanks, decimal commas points.
   subroutine read_lines(bytes, layout, span)
      integer(int8), intent(inout), contiguous :: bytes(:)
      type(layout_type), intent(in) :: layout
      type(span_type), intent(inout) :: span

      if (layout%marked) call strip_lines(bytes, span%first, span%last, layout)
      if (layout%commas /= 0 .and. span%last >= span%first) call make_points(bytes, span%first, &
         span%last, layout%commas)
      call read_span(bytes, layout, span)
   end subroutine read_lines

   !> The lines behind the first line feed of a piece; the last ones are left out where they are
   !> nearer to its end than the search for digits looks ahead.
   pure subroutine find_lines(bytes, first, last, from, to)
      integer(int8), intent(in), contiguous :: bytes(:)
      integer(int64), intent(in) :: first, last
      integer(int64), intent(out) :: from, to

      to = last - digits_ahead
      do from = first, to
         if (bytes(from) == line_feed) exit
      end do
      from = from + 1
      do to = to, from, -1
         if (bytes(to) == line_feed) exit
      end do
   end subroutine find_lines

   !> What the threads read of the file becomes part of the lines.
   subroutine take_bytes(lines, block, error)
      type(lines_type), intent(inout) :: lines
      type(block_type), intent(in) :: block
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got, wanted
      integer :: k

      got = 0
      do k = 1, block%pieces
         if (block%span(2*k)%failed) call fatal_error(error, status%io, lines%source%name// &
            ": cannot be read")
         if (allocated(error)) return
         got = got + block%span(2*k)%got
         if (block%span(2*k)%got < piece_size) exit
      end do
      wanted = block%last - block%first + 1
      lines%source%delivered = lines%source%delivered + got
      lines%filled = lines%filled + got
      call check_length(lines, wanted, got, error)
      if (allocated(error)) return
      lines%ended = source_left(lines%source) == 0
      if (lines%ended) call end_last_line(lines, error)
   end subroutine take_bytes

   !> Reads the lines on the borders of pieces; only what may be the start of a line is left.
   subroutine read_borders(lines, table, block)
      type(lines_type), intent(inout) :: lines
      type(table_type), intent(in) :: table
      type(block_type), intent(inout) :: block
      integer(int64) :: at, feed
      integer :: k

      lines%bytes(lines%filled + 1:lines%filled + digits_ahead) = line_feed
      at = lines%at
      do k = 1, block%pieces
         associate (border => block%span(2*k - 1), within => block%span(2*k))
            border%first = at
            border%last = at - 1
            if (within%last < within%first) cycle
            border%last = within%first - 1
            at = within%last + 1
         end associate
      end do
      do feed = lines%filled, max(at, block%first), -1
         if (lines%bytes(feed) == line_feed) exit
      end do
      if (feed < max(at, block%first)) feed = at - 1
      block%span(2*block%pieces + 1)%first = at
      block%span(2*block%pieces + 1)%last = feed
      !$omp parallel do schedule(dynamic) if(block%pieces > 1)
      do k = 1, 2*block%pieces + 1, 2
         call read_lines(lines%bytes, table%layout, block%span(k))
      end do
      !$omp end parallel do
      lines%at = feed + 1
      lines%last = feed
   end subroutine read_borders

   !> Appends the rows of the spans to the store, up to the first line that cannot be read.
   subroutine join_spans(lines, missing, table, block, error)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: missing
      type(table_type), intent(inout) :: table
      type(block_type), intent(in) :: block
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rows, before(2*block%pieces + 1)
      integer :: k, i, failed

      rows = 0
      failed = 0
      do k = 1, 2*block%pieces + 1
         associate (span => block%span(k))
            before(k) = rows
            rows = rows + span%rows
            do i = 1, span%map%count
               call map_row(table%map, table%rows + span%map%row(i), &
                  lines%number - 1 + span%map%line(i))
            end do
            if (table%bad_lines == 0 .and. span%bad_lines > 0) table%first_bad_line = &
               lines%number - 1 + span%first_bad_line
            table%bad_lines = table%bad_lines + span%bad_lines
            if (table%headings == 0 .and. span%headings > 0) table%first_heading = &
               lines%number - 1 + span%first_heading
            table%headings = table%headings + span%headings
            table%rows = table%rows + span%rows
            lines%number = lines%number + span%lines
            if (span%problem_at > 0) then
               call explain_problem(lines, table, span%problem_at, error)
               return
            end if
            if (span%no_memory) failed = 1
         end associate
      end do
      if (rows == 0 .and. failed == 0) return
      if (failed == 0) call next_chunk(table%store, table%layout%stored, failed, rows, &
         expected_rows(lines, table, rows, missing))
      if (failed /= 0) call fatal_error(error, status%no_memory, table%name// &
         ": no memory for more than "//integer_text(table%rows)//" rows")
      if (allocated(error)) return
      associate (chunk => table%store%chunk(table%store%count))
         !$omp parallel do schedule(dynamic) if(block%pieces > 1)
         do k = 1, 2*block%pieces + 1
            call copy_rows(block%span(k), chunk%rows + before(k), chunk%value)
         end do
         !$omp end parallel do
         chunk%rows = chunk%rows + rows
      end associate
   end subroutine join_spans

   !> So many rows may be to come, those of this block included, but not many more than are wanted.
   pure integer(int64) function expected_rows(lines, table, rows, missing) result(expected)
      type(lines_type), intent(in) :: lines
      type(table_type), intent(in) :: table
      integer(int64), intent(in) :: rows, missing
      real(dp) :: left

      expected = table%rows
      if (has_places(lines%source)) then
         left = real(source_left(lines%source), dp)*real(table%rows, dp) &
                /real(max(lines%source%delivered, 1_int64), dp)
         expected = rows + int(1.02_dp*left, int64) + 64
      end if
      if (missing < expected) expected = max(rows, missing + missing/4)
      if (lines%ended) expected = rows
   end function expected_rows

   !> The message for a line that cannot be read, which is that with the number `lines%number`.
   subroutine explain_problem(lines, table, at, error)
      type(lines_type), intent(inout) :: lines
      type(table_type), intent(in) :: table
      integer(int64), intent(in) :: at
      type(error_type), allocatable, intent(out) :: error
      type(fields_type) :: fields
      type(problem_type) :: problem
      real(dp), allocatable :: row(:)
      integer(int64) :: last

      allocate (row(table%layout%stored))
      lines%at = at
      last = line_end_from(lines%bytes, at)
      call read_row(lines%bytes, at, last, table%layout, fields, row, problem, .true.)
      call place_error(error, table%name, lines%number, lines%bytes, at, last, problem%at, &
         problem%what, problem%advice)
   end subroutine explain_problem

end module gyroakf_io_text_rows
