! SPDX-License-Identifier: MIT
!> A source of bytes as blocks of whole lines, and which line a row stood in.
module gyroakf_io_lines
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_number, only : digits_ahead
   use gyroakf_io_place, only : integer_text, line_error
   use gyroakf_io_text, only : line_end_from, line_feed_from
   use gyroakf_io_source, only : has_places, open_source, read_block, source_left, source_type
   implicit none (type, external)
   private
   public :: lines_type, open_lines, more_lines, next_line, line_map_type, map_row, line_of

   !> Bytes of the first block
   integer(int64), parameter :: block_size = 1048576
   !> Bytes of a line; a source without line ends (a device, binary data) shall not fill the memory
   integer(int64), parameter :: longest_line = 16000000
   !> Bytes that are read at once where a file has grown
   integer(int64), parameter :: tail_size = 4096
   !> Bytes behind the filled ones: a missing line feed, and what the search for digits looks at
   integer(int64), parameter :: behind = digits_ahead + 1
   integer(int8), parameter :: line_feed = 10, carriage_return = 13, &
      line_ends(2) = [line_feed, carriage_return]

   !> Lines of a source
   type :: lines_type
      !> Where they come from
      type(source_type) :: source
      !> The block
      integer(int8), allocatable :: bytes(:)
      !> First byte of the next line, and its last one without its end, see [[more_lines]]
      integer(int64) :: at = 1, to = 0
      !> The last line feed; at > last where there is no whole line
      integer(int64) :: last = 0
      !> Bytes that are filled
      integer(int64) :: filled = 0
      !> Number of the line at `at`
      integer(int64) :: number = 1
      !> True where the source has no more
      logical :: ended = .false.
      !> True where lines end with a carriage return alone
      logical :: only_returns = .false.
      !> The first block as it was read, whole lines of it
      integer(int8), allocatable :: head(:)
   end type lines_type

   !> Rows whose line does not follow from the row before
   type :: line_map_type
      integer :: count = 0
      integer(int64), allocatable :: row(:), line(:)
   end type line_map_type

contains

   !> Opens the source and reads the first block; a byte-order mark is left out.
   subroutine open_lines(lines, path, error, bytes)
      !> Its source is to be closed by [[close_source]]
      type(lines_type), intent(out) :: lines
      character(*), intent(in) :: path
      !> Allocated where it cannot be opened or read: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Where associated they are the content, and the path is a name for messages
      integer(int8), pointer, contiguous, intent(in), optional :: bytes(:)
      integer(int64) :: capacity
      integer :: failed

      call open_source(lines%source, path, error, bytes)
      if (allocated(error)) return
      capacity = block_size
      if (has_places(lines%source)) capacity = min(capacity, lines%source%length + 64)
      allocate (lines%bytes(capacity + behind), stat=failed)
      call check_memory(failed, "a block of "//path, error)
      if (allocated(error)) return
      call fill(lines, capacity, error)
      if (allocated(error)) return
      if (lines%filled >= 3) then
         if (all(lines%bytes(:3) == [-17_int8, -69_int8, -65_int8])) lines%at = 4
      end if
      lines%only_returns = any(lines%bytes(:lines%filled - 1) == carriage_return) &
                           .and. .not. any(lines%bytes(:lines%filled - 1) == line_feed)
      call find_last(lines, lines%at)
      allocate (lines%head(lines%last), stat=failed)
      call check_memory(failed, "the beginning of "//path, error)
      if (failed == 0) lines%head(:) = lines%bytes(:lines%last)
   end subroutine open_lines

   !> Provides one whole line at least; there is none (at > last) at the end of the source only.
   subroutine more_lines(lines, error, wanted)
      type(lines_type), intent(inout) :: lines
      !> Allocated where reading fails: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Bytes that are read at once
      integer(int64), intent(in), optional :: wanted
      integer(int64) :: rest, block

      block = block_size/2
      if (present(wanted)) block = wanted
      do while (lines%at > lines%last .and. .not. lines%ended)
         call reserve_bytes(lines, block, error)
         if (allocated(error)) return
         rest = lines%filled
         call fill(lines, block, error)
         if (allocated(error)) return
         call find_last(lines, rest + 1)
      end do
      if (lines%at <= lines%last) lines%to = line_end_from(lines%bytes, lines%at)
   end subroutine more_lines

   !> Moves the bytes from `at` on to the start; reserves `wanted` and as many more bytes behind.
   subroutine reserve_bytes(lines, wanted, error)
      !> Its `at` is 1 and its `last` 0 afterwards
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: wanted
      !> Allocated where there is no memory, no_memory, and where a line is too long, parse
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rest, needed
      integer(int8), allocatable :: longer(:)
      integer :: failed

      rest = lines%filled - lines%at + 1
      if (rest > longest_line) call line_error(error, lines%source%name, lines%number, &
         "a line of more than "//integer_text(longest_line/1000000)//" MB", &
         "give one row of numbers per sample, or `format` for raw numbers")
      if (allocated(error)) return
      needed = rest + max(wanted, 1_int64) + behind
      if (needed > size(lines%bytes, kind=int64)) then
         allocate (longer(needed + min(rest, longest_line - rest)), stat=failed)
         if (failed /= 0) call fatal_error(error, status%no_memory, lines%source%name// &
            ": no memory for a line of more than "//integer_text(rest)//" bytes")
         if (allocated(error)) return
         longer(:rest) = lines%bytes(lines%at:lines%filled)
         call move_alloc(longer, lines%bytes)
      else if (lines%at > 1) then
         lines%bytes(:rest) = lines%bytes(lines%at:lines%filled)
      end if
      lines%at = 1
      lines%last = 0
      lines%filled = rest
   end subroutine reserve_bytes

   !> Reads so many bytes behind those that are filled.
   subroutine fill(lines, wanted, error)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: wanted
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got, expected

      expected = min(wanted, source_left(lines%source))
      call read_block(lines%source, lines%bytes(lines%filled + 1:lines%filled + wanted), got, error)
      if (.not. allocated(error)) call check_length(lines, expected, got, error)
      if (allocated(error)) return
      lines%filled = lines%filled + got
      lines%ended = got < wanted .or. source_left(lines%source) == 0
      if (lines%ended) call end_last_line(lines, error)
   end subroutine fill

   !> A file that holds less than when it was opened was cut by somebody: an error, but for the
   !> first block (what is a file in name only may state any length).
   subroutine check_length(lines, expected, got, error)
      !> Its source delivered `got` bytes
      type(lines_type), intent(inout) :: lines
      !> Bytes that should have come
      integer(int64), intent(in) :: expected, got
      !> Allocated where the file became shorter: io
      type(error_type), allocatable, intent(out) :: error

      if (.not. has_places(lines%source) .or. got >= expected) return
      if (lines%source%delivered > got) then
         call fatal_error(error, status%io, lines%source%name// &
            ": the file became shorter while it was read: "// &
            integer_text(lines%source%delivered)//" of "//integer_text(lines%source%length)// &
            " bytes are left"//new_line("a")//"read it after writing has ended")
      end if
      lines%source%length = lines%source%delivered
   end subroutine check_length

   !> Gives the last line of the source a line feed; where the file has grown since it was opened,
   !> and had been cut within a line, the rest of this line first.
   subroutine end_last_line(lines, error)
      type(lines_type), intent(inout) :: lines
      !> Allocated where reading fails: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got, first, i

      if (lines%filled == 0) return
      do while (has_places(lines%source) .and. all(lines%bytes(lines%filled) /= line_ends))
         call reserve_bytes(lines, tail_size, error)
         if (allocated(error)) return
         first = lines%filled + 1
         lines%source%length = lines%source%length + tail_size
         call read_block(lines%source, lines%bytes(first:lines%filled + tail_size), got, error)
         if (allocated(error)) return
         do i = first, lines%filled + got
            if (any(lines%bytes(i) == line_ends)) exit
         end do
         lines%filled = min(i, lines%filled + got)
         lines%source%delivered = lines%source%delivered - got + (lines%filled - first + 1)
         lines%source%length = lines%source%delivered
         if (got < tail_size) exit
      end do
      if (lines%bytes(lines%filled) == line_feed) return
      lines%filled = lines%filled + 1
      lines%bytes(lines%filled) = line_feed
   end subroutine end_last_line

   !> Finds the last line feed; what is new begins at `from`.
   subroutine find_last(lines, from)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: from

      associate (fresh => lines%bytes(from:lines%filled))
         if (lines%only_returns) then
            where (fresh == carriage_return) fresh = line_feed
         end if
         lines%last = findloc(fresh, line_feed, dim=1, back=.true., kind=int64)
      end associate
      if (lines%last > 0) lines%last = lines%last + from - 1
      lines%bytes(lines%filled + 1:lines%filled + digits_ahead) = line_feed
   end subroutine find_last

   !> Leaves the line at `at` behind.
   pure subroutine next_line(lines)
      type(lines_type), intent(inout) :: lines

      lines%at = line_feed_from(lines%bytes, lines%at) + 1
      lines%number = lines%number + 1
   end subroutine next_line

   !> Notes that a row stands in a line, where that does not follow from the row before.
   subroutine map_row(map, row, line)
      type(line_map_type), intent(inout) :: map
      !> Both from 1, rising from call to call
      integer(int64), intent(in) :: row, line

      if (.not. allocated(map%row)) allocate (map%row(16), map%line(16))
      if (map%count > 0) then
         if (line - map%line(map%count) == row - map%row(map%count)) return
         if (map%row(map%count) == row) map%count = map%count - 1
      end if
      if (map%count == size(map%row)) then
         map%row = [map%row, map%row]
         map%line = [map%line, map%line]
      end if
      map%count = map%count + 1
      map%row(map%count) = row
      map%line(map%count) = line
   end subroutine map_row

   !> The line that a row stood in.
   pure integer(int64) function line_of(map, row)
      type(line_map_type), intent(in) :: map
      integer(int64), intent(in) :: row
      integer :: before

      line_of = row
      if (map%count == 0) return
      before = count(map%row(:map%count) <= row)
      if (before > 0) line_of = map%line(before) + row - map%row(before)
   end function line_of

end module gyroakf_io_lines
