! SPDX-License-Identifier: MIT
!> The rows of a table in text, read into its store by several threads.
!>
!> A block of whole lines is cut into spans of about equal length, which the threads read; then the
!> rows of all spans are joined in their order. What is read does not depend on the number of
!> threads, nor on where the block is cut.
module gyroakf_io_text_rows
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_commas, only : make_points
   use gyroakf_io_rows, only : layout_type, problem_type
   use gyroakf_io_lines, only : lines_type, map_row, more_lines
   use gyroakf_io_marks, only : strip_lines
   use gyroakf_io_place, only : integer_text, place_error
   use gyroakf_io_row, only : read_row
   use gyroakf_io_source, only : has_places, source_left
   use gyroakf_io_span, only : read_span, span_type
   use gyroakf_io_store, only : count_rows, next_chunk
   use gyroakf_io_table, only : table_type
   use gyroakf_io_text, only : fields_type, line_end_from, line_feed_from
   use gyroakf_progress, only : progress_type, report_progress
   implicit none (type, external)
   private
   public :: read_rows

   !> Bytes of a span, which stays in a core's cache, and of a block: spans for 32 threads
   integer(int64), parameter :: span_size = 131072, block_size = 32*span_size

contains

   !> Reads rows into the store until it has as many as wanted, or a few more, or there are no more.
   subroutine read_rows(lines, most, table, error, progress)
      type(lines_type), intent(inout) :: lines
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      type(table_type), intent(inout) :: table
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Progress callback, in bytes read
      class(progress_type), intent(inout), optional :: progress
      type(span_type), allocatable :: span(:)
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
         if (missing < block_size/row_bytes) wanted = max(span_size, missing*row_bytes)
         call more_lines(lines, error, wanted)
         if (.not. allocated(error)) call cut_block(lines, span, error)
         if (allocated(error)) return
         call read_spans(lines%bytes, table%layout, span)
         call join_spans(lines, missing, table, span, error)
         if (allocated(error)) return
         lines%at = lines%last + 1
      end do
   end subroutine read_rows

   !> Cuts the lines that are at hand into spans; those of the block before keep their memory.
   subroutine cut_block(lines, span, error)
      type(lines_type), intent(in) :: lines
      type(span_type), allocatable, intent(inout) :: span(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: from, to
      integer :: k, spans, failed

      spans = int((lines%last - lines%at + span_size)/span_size)
      failed = 0
      if (allocated(span)) then
         if (size(span) < spans) deallocate (span)
      end if
      if (.not. allocated(span)) allocate (span(spans), stat=failed)
      call check_memory(failed, "rows of "//lines%source%name, error)
      if (allocated(error)) return
      from = lines%at
      do k = 1, size(span)
         to = min(lines%at + k*span_size - 1, lines%last)
         if (to >= from) to = line_feed_from(lines%bytes, to)
         span(k)%first = from
         span(k)%last = max(to, from - 1)
         from = span(k)%last + 1
      end do
   end subroutine cut_block

   !> Reads the lines of the spans, labels and brackets becoming blanks, decimal commas points.
   subroutine read_spans(bytes, layout, span)
      integer(int8), intent(inout), contiguous :: bytes(:)
      type(layout_type), intent(in) :: layout
      type(span_type), intent(inout) :: span(:)
      integer :: k

      if (layout%marked .or. layout%commas /= 0) then
         !$omp parallel do schedule(dynamic) if(size(span) > 1)
         do k = 1, size(span)
            if (span(k)%last < span(k)%first) cycle
            if (layout%marked) call strip_lines(bytes, span(k)%first, span(k)%last, layout)
            call make_points(bytes, span(k)%first, span(k)%last, layout%commas)
         end do
         !$omp end parallel do
      end if
      !$omp parallel do schedule(dynamic) if(size(span) > 1)
      do k = 1, size(span)
         call read_span(bytes, layout, span(k))
      end do
      !$omp end parallel do
   end subroutine read_spans

   !> Appends the rows of the spans to the store, up to the first line that cannot be read.
   subroutine join_spans(lines, missing, table, span, error)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: missing
      type(table_type), intent(inout) :: table
      type(span_type), intent(in) :: span(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rows, before(size(span))
      integer :: k, i, failed

      rows = 0
      failed = 0
      do k = 1, size(span)
         associate (this => span(k))
            before(k) = rows
            rows = rows + this%rows
            do i = 1, this%map%count
               call map_row(table%map, table%rows + this%map%row(i), &
                  lines%number - 1 + this%map%line(i))
            end do
            if (table%bad_lines == 0 .and. this%bad_lines > 0) table%first_bad_line = &
               lines%number - 1 + this%first_bad_line
            table%bad_lines = table%bad_lines + this%bad_lines
            if (table%headings == 0 .and. this%headings > 0) table%first_heading = &
               lines%number - 1 + this%first_heading
            table%headings = table%headings + this%headings
            table%rows = table%rows + this%rows
            lines%number = lines%number + this%lines
            if (this%problem_at > 0) then
               call explain_problem(lines, table, this%problem_at, error)
               return
            end if
            if (this%no_memory) failed = 1
         end associate
      end do
      if (rows == 0 .and. failed == 0) return
      if (failed == 0) call next_chunk(table%store, table%layout%stored, failed, rows, &
         expected_rows(lines, table, rows, missing))
      if (failed /= 0) call fatal_error(error, status%no_memory, table%name// &
         ": no memory for more than "//integer_text(table%rows)//" rows")
      if (allocated(error)) return
      associate (chunk => table%store%chunk(table%store%count))
         !$omp parallel do schedule(dynamic) if(size(span) > 1)
         do k = 1, size(span)
            associate (at => chunk%rows + before(k), n => span(k)%rows)
               if (n > 0) chunk%value(at + 1:at + n, :) = span(k)%value(:n, :)
            end associate
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
      integer :: failed

      allocate (row(table%layout%stored), stat=failed)
      call check_memory(failed, "a row of "//table%name, error)
      if (allocated(error)) return
      lines%at = at
      last = line_end_from(lines%bytes, at)
      call read_row(lines%bytes, at, last, table%layout, fields, row, problem, .true.)
      call place_error(error, table%name, lines%number, lines%bytes, at, last, problem%at, &
         problem%what, problem%advice)
   end subroutine explain_problem

end module gyroakf_io_text_rows
