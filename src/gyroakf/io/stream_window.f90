! SPDX-License-Identifier: MIT
!> The windows of a recording that is read in blocks: rows that wait, and what their time stamps show.
module gyroakf_io_stream_window
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, gap_type, join_windows
   use gyroakf_io_bursts, only : count_bursts
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_clock, only : drop_absurd, find_scale, is_clock
   use gyroakf_io_recording, only : next_rows, recording_type
   use gyroakf_io_repeats, only : are_chance, same_row
   use gyroakf_io_stamps, only : unwrap_days
   use gyroakf_io_store, only : chunk_rows
   use gyroakf_io_stream_state, only : most_marks, record_stream_type
   use gyroakf_record, only : audit_type
   implicit none (type, external)
   private
   public :: read_window, audit_window, hold_back, held_back

   !> Rows at the end of a window that are looked at again in the next, and delivered ones before them that are
   integer(int64), parameter :: held_back = 4096, context_rows = 4096

contains

   !> Appends the next chunk of rows to those that wait.
   subroutine read_window(recording, stream, ended, error)
      type(recording_type), intent(inout) :: recording
      type(record_stream_type), intent(inout) :: stream
      !> There are no more rows than these
      logical, intent(out) :: ended
      !> io, parse, no_memory
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: rows(:, :), stamps(:)
      integer(int64) :: old, new
      integer :: failed, channels

      ended = .true.
      associate (table => recording%table)
         if (stream%chunk > table%store%count) then
            table%store%count = 0
            stream%chunk = 1
            if (.not. table%whole) call next_rows(recording, chunk_rows, error)
            if (allocated(error)) return
         end if
         if (stream%chunk > table%store%count) return
         channels = size(table%chosen)
         associate (chunk => table%store%chunk(stream%chunk))
            old = size(stream%rows, 1, kind=int64)
            new = chunk%rows
            allocate (rows(old + new, channels), stat=failed)
            if (failed == 0) allocate (stamps(merge(old + new, 0_int64, table%time > 0)), stat=failed)
            if (failed /= 0) then
               call fatal_error(error, status%no_memory, "no memory for a block of "//table%name)
               return
            end if
            rows(:old, :) = stream%rows
            rows(old + 1:, :) = chunk%value(:new, :channels)
            if (table%time > 0) then
               stamps(:old) = stream%stamps
               stamps(old + 1:) = chunk%value(:new, table%layout%slot(table%time))
               if (is_clock(table)) call unwrap_days(stamps(old + 1:), stream%clock, stream%days)
            end if
            deallocate (chunk%value)
            chunk%rows = 0
         end associate
         call move_alloc(rows, stream%rows)
         call move_alloc(stamps, stream%stamps)
         if (table%time > 0) call drop_repeats(stream, old)
         stream%chunk = stream%chunk + 1
         ended = table%whole .and. stream%chunk > table%store%count
      end associate
   end subroutine read_window

   !> Takes rows out that repeat the one above, as [[audit_stamps]] does; numbers the others.
   subroutine drop_repeats(stream, old)
      type(record_stream_type), intent(inout) :: stream
      !> Rows that were there before
      integer(int64), intent(in) :: old
      integer(int64), allocatable :: number(:)
      real(dp), allocatable :: rows(:, :), stamps(:)
      logical, allocatable :: stays(:)
      integer(int64) :: i, n, kept
      integer :: j

      n = size(stream%stamps, kind=int64)
      allocate (number(n), stays(n))
      number(:old) = stream%number
      number(old + 1:) = [(stream%read_rows + i, i=1, n - old)]
      stream%read_rows = stream%read_rows + (n - old)
      stays = .true.
      do i = max(old, 1_int64) + 1, n
         if (ieee_is_nan(stream%stamps(i)) .or. ieee_is_nan(stream%stamps(i - 1))) cycle
         stays(i) = .not. same_row(stream%rows, i)
         if (abs(stream%stamps(i) - stream%stamps(i - 1)) > 0.0_dp) then
            stream%others = stream%others + 1
            if (.not. stays(i)) stream%chance = stream%chance + 1
            stays(i) = .true.
         else
            stream%equal = stream%equal + 1
            if (.not. stays(i)) stream%alike = stream%alike + 1
         end if
      end do
      kept = count(stays, kind=int64)
      if (are_chance(stream%equal, stream%alike, stream%others, stream%chance)) kept = n
      if (kept == n) then
         call move_alloc(number, stream%number)
         return
      end if
      associate (audit => stream%summary%audit)
         audit%repeated = audit%repeated + (n - kept)
         if (audit%line_of_repeat == 0) audit%line_of_repeat = number(findloc(stays, .false., dim=1, kind=int64))
      end associate
      allocate (rows(kept, size(stream%rows, 2)), stamps(kept))
      stamps(:) = pack(stream%stamps, stays)
      do j = 1, size(rows, 2)
         rows(:, j) = pack(stream%rows(:, j), stays)
      end do
      call move_alloc(rows, stream%rows)
      call move_alloc(stamps, stream%stamps)
      stream%number = pack(number, stays)
   end subroutine drop_repeats

   !> Where samples were lost, and which rows may be delivered.
   subroutine audit_window(recording, stream, from, to, gaps)
      type(recording_type), intent(in) :: recording
      type(record_stream_type), intent(inout) :: stream
      !> Rows that are delivered
      integer(int64), intent(in) :: from, to
      !> Counted from row `from`
      type(gap_type), intent(out) :: gaps
      type(audit_type) :: part
      type(cadence_type) :: cadence
      real(dp), allocatable :: t(:)
      integer(int64) :: before, start
      integer :: k, kept

      before = stream%counted - stream%context
      start = max(1_int64, from - 1)
      if (.not. stream%begun) then
         call find_scale(recording%options, recording%table, stream%stamps, stream%summary, stream%scale, stream%origin)
      else
         call drop_absurd(stream%stamps)
      end if
      t = (stream%stamps - stream%origin)*stream%scale
      call count_steps(t(start:to), stream%number(start:to), stream%summary%audit)
      call audit_stamps(t, part, gaps, cadence=cadence)
      kept = 0
      do k = 1, gaps%count
         if (gaps%before(k) > to) exit
         if (gaps%before(k) < from .or. gaps%before(k) < 2) cycle
         if (stream%summary%audit%line_of_first(3) == 0) stream%summary%audit%line_of_first(3) = stream%number(gaps%before(k))
         call note_single(stream, before + gaps%before(k), gaps%length(k))
         kept = kept + 1
         gaps%length(kept) = gaps%length(k)
         gaps%before(kept) = gaps%before(k) - (from - 1)
      end do
      gaps%count = kept
      associate (audit => stream%summary%audit)
         if (gaps%first_jump < from .or. gaps%first_jump > to) gaps%jumps = 0
         if (gaps%jumps > 0 .and. audit%line_of_first(3) == 0) audit%line_of_first(3) = stream%number(gaps%first_jump)
         audit%gaps = audit%gaps + kept + gaps%jumps
         audit%jumps = audit%jumps + gaps%jumps
         audit%beats = audit%beats + nint(real(part%beats, dp)*real(to - from + 1, dp)/real(max(size(t), 1), dp), int64)
         audit%jitter_max = max(audit%jitter_max, part%jitter_max)
         call join_clock(stream, part, before, t(start:to), stream%number(start:to), cadence)
         call remember(stream, t, from, to, gaps, kept)
         if (to > start) stream%elapsed = stream%elapsed + (t(to) - t(start))
         stream%filled = stream%filled + sum(gaps%length(:kept))
         if (.not. stream%begun) audit%stamp_rate = part%stamp_rate
      end associate
   end subroutine audit_window

   !> Adds what a window shows of bursts, of rates and of the clock; lets the lines of the first count all rows.
   subroutine join_clock(stream, part, before, t, number, cadence)
      type(record_stream_type), intent(inout) :: stream
      !> Of the window
      type(audit_type), intent(in) :: part
      !> Rows before the window
      integer(int64), intent(in) :: before
      !> Stamps of the rows that are delivered, behind the one before if there is one; and which rows of the recording they are
      real(dp), intent(in), contiguous :: t(:)
      integer(int64), intent(in), contiguous :: number(:)
      type(cadence_type), intent(in) :: cadence
      integer(int64) :: row

      associate (audit => stream%summary%audit)
         call count_bursts(t, cadence, stream%burst, audit, number)
         row = audit%line_of_change
         call join_windows(part, before, stream%last_change, audit)
         if (row == 0 .and. audit%line_of_change > 0) audit%line_of_change = stream%number(part%line_of_change)
      end associate
   end subroutine join_clock

   !> Remembers every so many stamps, for the rates of the halves.
   pure subroutine remember(stream, t, from, to, gaps, count_gaps)
      type(record_stream_type), intent(inout) :: stream
      !> Of the window, s
      real(dp), intent(in), contiguous :: t(:)
      !> Rows that are delivered
      integer(int64), intent(in) :: from, to
      !> Counted from row `from`, and how many of them count
      type(gap_type), intent(in) :: gaps
      integer, intent(in) :: count_gaps
      integer(int64) :: i, row, lost
      integer :: next

      next = 1
      lost = stream%filled
      do i = from, to
         if (next <= count_gaps) then
            if (gaps%before(next) == i - from + 1) then
               lost = lost + gaps%length(next)
               next = next + 1
            end if
         end if
         row = stream%counted + (i - from + 1)
         if (modulo(row - 1, stream%stride) /= 0) cycle
         if (stream%marks == most_marks) then
            stream%stride = 2*stream%stride
            stream%marks = most_marks/2
            stream%mark_row(:stream%marks) = stream%mark_row(1::2)
            stream%mark_place(:stream%marks) = stream%mark_place(1::2)
            stream%mark_time(:stream%marks) = stream%mark_time(1::2)
            if (modulo(row - 1, stream%stride) /= 0) cycle
         end if
         stream%marks = stream%marks + 1
         stream%mark_row(stream%marks) = row
         stream%mark_place(stream%marks) = row - 1 + lost
         stream%mark_time(stream%marks) = stream%elapsed + (t(i) - t(max(1_int64, from - 1)))
      end do
   end subroutine remember

   !> Notes the distance of a gap from the one before.
   pure subroutine note_single(stream, row, length)
      type(record_stream_type), intent(inout) :: stream
      !> The row behind the gap, and how many samples it lacks
      integer(int64), intent(in) :: row, length

      stream%only_singles = stream%only_singles .and. length == 1
      stream%singles = stream%singles + 1
      if (stream%singles > 1) then
         stream%nearest = min(stream%nearest, row - stream%last_single)
         stream%farthest = max(stream%farthest, row - stream%last_single)
      end if
      stream%last_single = row
   end subroutine note_single

   !> Counts equal and backward stamps.
   pure subroutine count_steps(t, number, audit)
      !> NaN where missing
      real(dp), intent(in) :: t(:)
      !> Which rows of the recording they are
      integer(int64), intent(in) :: number(:)
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i

      do i = 2, size(t, kind=int64)
         if (ieee_is_nan(t(i)) .or. ieee_is_nan(t(i - 1))) cycle
         if (t(i) > t(i - 1)) cycle
         if (t(i) < t(i - 1)) then
            audit%backward_steps = audit%backward_steps + 1
            if (audit%line_of_first(2) == 0) audit%line_of_first(2) = number(i)
         else
            audit%duplicates = audit%duplicates + 1
            if (audit%line_of_first(1) == 0) audit%line_of_first(1) = number(i)
         end if
      end do
   end subroutine count_steps

   !> Keeps the rows that are looked at again, and with stamps some that were delivered.
   subroutine hold_back(stream, ended, stamped, to)
      type(record_stream_type), intent(inout) :: stream
      logical, intent(in) :: ended, stamped
      !> The last row that was delivered
      integer(int64), intent(in) :: to
      real(dp), allocatable :: rows(:, :), stamps(:)
      integer(int64) :: first

      first = to + 1
      if (stamped .and. .not. ended) then
         ! a part of another rate that is too short to be seen as one would spoil the next window
         first = max(1_int64, to + 1 - context_rows, min(to, stream%last_change - (stream%counted - to)))
      end if
      stream%context = to + 1 - first
      allocate (rows(size(stream%rows, 1, kind=int64) - first + 1, size(stream%rows, 2)))
      rows(:, :) = stream%rows(first:, :)
      call move_alloc(rows, stream%rows)
      if (.not. stamped) return
      allocate (stamps(size(stream%stamps, kind=int64) - first + 1))
      stamps(:) = stream%stamps(first:)
      call move_alloc(stamps, stream%stamps)
      stream%number = stream%number(first:)
   end subroutine hold_back

end module gyroakf_io_stream_window
