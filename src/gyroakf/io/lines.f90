! SPDX-License-Identifier: MIT
!> A source of bytes as blocks of whole lines, and which line a row stood in.
module gyroakf_io_lines
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_number, only : digits_ahead
   use gyroakf_io_source, only : close_source, open_source, read_block, source_type
   implicit none (type, external)
   private
   public :: lines_type, open_lines, more_lines, line_end, next_line, close_lines, line_map_type, map_row, line_of

   !> Bytes read at once; a longer line makes the room grow
   integer(int64), parameter :: block_size = 524288
   integer(int8), parameter :: line_feed = 10, carriage_return = 13

   !> Lines of a source
   type :: lines_type
      !> Where they come from
      type(source_type) :: source
      !> The block
      integer(int8), allocatable :: bytes(:)
      !> First byte of the next line
      integer(int64) :: at = 1
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
   end type lines_type

   !> Rows whose line does not follow from the row before
   type :: line_map_type
      integer :: count = 0
      integer(int64), allocatable :: row(:), line(:)
   end type line_map_type

contains

   !> Opens the source and reads the first block; a byte-order mark is left out.
   subroutine open_lines(lines, path, error, bytes)
      !> To be closed by [[close_lines]]
      type(lines_type), intent(out) :: lines
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> Allocated where it cannot be opened or read: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Where associated they are the content, and the path is a name for messages
      integer(int8), pointer, contiguous, intent(in), optional :: bytes(:)
      integer(int64) :: room
      integer :: failed

      call open_source(lines%source, path, error, bytes)
      if (allocated(error)) return
      room = block_size
      if (lines%source%length > 0 .or. associated(lines%source%bytes)) room = min(room, lines%source%length + 64)
      allocate (lines%bytes(room + digits_ahead), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a block of "//path)
         return
      end if
      call fill(lines, error)
      if (allocated(error)) return
      if (lines%filled >= 3) then
         if (all(lines%bytes(:3) == [-17_int8, -69_int8, -65_int8])) lines%at = 4
      end if
      lines%only_returns = any(lines%bytes(:lines%filled - 1) == carriage_return) &
                           .and. .not. any(lines%bytes(:lines%filled - 1) == line_feed)
      call find_last(lines, lines%at)
   end subroutine open_lines

   !> Makes sure that at least one whole line is at hand; there is none (at > last) at the end of the source only.
   subroutine more_lines(lines, error)
      !> An open source
      type(lines_type), intent(inout) :: lines
      !> Allocated where reading fails: io, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: rest
      integer(int8), allocatable :: longer(:)
      integer :: failed

      do while (lines%at > lines%last .and. .not. lines%ended)
         rest = lines%filled - lines%at + 1
         if (rest > size(lines%bytes, kind=int64)/2) then
            allocate (longer(2*size(lines%bytes, kind=int64)), stat=failed)
            if (failed /= 0) then
               call fatal_error(error, status%no_memory, "no memory for a line of "//lines%source%name)
               return
            end if
            longer(:rest) = lines%bytes(lines%at:lines%filled)
            call move_alloc(longer, lines%bytes)
         else
            call move_down(lines%bytes, lines%at, rest)
         end if
         lines%at = 1
         lines%last = 0
         lines%filled = rest
         call fill(lines, error)
         if (allocated(error)) return
         call find_last(lines, rest + 1)
      end do
   end subroutine more_lines

   !> Moves bytes to the start; they may overlap.
   pure subroutine move_down(bytes, from, count)
      integer(int8), intent(inout), contiguous :: bytes(:)
      integer(int64), intent(in) :: from, count
      integer(int64) :: i

      do i = 1, count
         bytes(i) = bytes(from + i - 1)
      end do
   end subroutine move_down

   !> Reads behind what is filled; gives the last line of the source a line feed.
   subroutine fill(lines, error)
      type(lines_type), intent(inout) :: lines
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got, room

      room = size(lines%bytes, kind=int64) - digits_ahead - lines%filled - 1
      call read_block(lines%source, lines%bytes(lines%filled + 1:lines%filled + room), got, error)
      if (allocated(error)) return
      lines%filled = lines%filled + got
      lines%ended = got < room
      if (.not. lines%ended .or. lines%filled == 0) return
      if (lines%bytes(lines%filled) == line_feed) return
      lines%filled = lines%filled + 1
      lines%bytes(lines%filled) = line_feed
   end subroutine fill

   !> Finds the last line feed; what is new begins at `from`.
   subroutine find_last(lines, from)
      type(lines_type), intent(inout) :: lines
      integer(int64), intent(in) :: from
      integer(int64) :: i

      if (lines%only_returns) then
         do i = from, lines%filled
            if (lines%bytes(i) == carriage_return) lines%bytes(i) = line_feed
         end do
      end if
      do i = lines%filled, from, -1
         if (lines%bytes(i) == line_feed) exit
      end do
      lines%last = merge(i, 0_int64, i >= from)
      lines%bytes(lines%filled + 1:lines%filled + digits_ahead) = line_feed
   end subroutine find_last

   !> The last byte of the line at `at`, without its end (line feed, carriage return).
   pure integer(int64) function line_end(lines)
      !> With a whole line at hand
      type(lines_type), intent(in) :: lines

      line_end = lines%at
      do while (lines%bytes(line_end) /= line_feed)
         line_end = line_end + 1
      end do
      line_end = line_end - 1
      if (line_end < lines%at) return
      if (lines%bytes(line_end) == carriage_return) line_end = line_end - 1
   end function line_end

   !> Leaves the line at `at` behind.
   pure subroutine next_line(lines)
      !> With a whole line at hand
      type(lines_type), intent(inout) :: lines

      do while (lines%bytes(lines%at) /= line_feed)
         lines%at = lines%at + 1
      end do
      lines%at = lines%at + 1
      lines%number = lines%number + 1
   end subroutine next_line

   !> Closes the source.
   subroutine close_lines(lines)
      !> Closed afterwards
      type(lines_type), intent(inout) :: lines

      call close_source(lines%source)
   end subroutine close_lines

   !> Notes that a row stands in a line, where that does not follow from the row before.
   subroutine map_row(map, row, line)
      !> Grows where it has to
      type(line_map_type), intent(inout) :: map
      !> Both from 1, rising from call to call
      integer(int64), intent(in) :: row, line
      integer(int64), allocatable :: longer(:)

      if (.not. allocated(map%row)) allocate (map%row(16), map%line(16))
      if (map%count > 0) then
         if (line - map%line(map%count) == row - map%row(map%count)) return
         if (map%row(map%count) == row) map%count = map%count - 1
      end if
      if (map%count == size(map%row)) then
         allocate (longer(2*map%count))
         longer(:map%count) = map%row
         call move_alloc(longer, map%row)
         allocate (longer(2*map%count))
         longer(:map%count) = map%line
         call move_alloc(longer, map%line)
      end if
      map%count = map%count + 1
      map%row(map%count) = row
      map%line(map%count) = line
   end subroutine map_row

   !> The line that a row stood in.
   pure integer(int64) function line_of(map, row)
      !> Of the file
      type(line_map_type), intent(in) :: map
      !> From 1
      integer(int64), intent(in) :: row
      integer :: i

      line_of = row
      do i = map%count, 1, -1
         if (map%row(i) > row) cycle
         line_of = map%line(i) + row - map%row(i)
         return
      end do
   end function line_of

end module gyroakf_io_lines
