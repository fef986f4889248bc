! SPDX-License-Identifier: MIT
!> A recording in blocks, for those who need not have it whole: the same rows, marks, units and audit as of [[read_record]].
!>
!>     call begin_record_stream(recording, stream)
!>     do
!>        call next_record_block(recording, stream, block, error)     ! block%value, block%present
!>        if (stream%done) exit
!>     end do
!>     call end_record_stream(recording, stream, record, error)       ! all but the samples
!>
!> What the time stamps show is found in windows of some 70,000 rows, the last few thousand of which are looked at again
!> in the next window: repeated rows are left out, lost samples get their place, equal and backward stamps and bursts are
!> counted. The mean rate is that of the whole recording; it is known at its end, `interval` is that of the first window
!> until then.
!>
!> What cannot be as in memory: the largest and the usual distance from an even grid are those within a window; the medians
!> that judge steps are a window's (stamps at the edge of what counts as late, as a burst, as a chance repeat may be judged
!> otherwise); a rate that creeps by less than 0.5 % within a window is not named as a change; the rates of the halves come from
!> every 2^k-th stamp.
module gyroakf_io_record_stream
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, audit_values, burst_type, count_bursts, end_bursts, gap_type, join_windows, &
      same_row
   use gyroakf_io_cadence, only : cadence_type
   use gyroakf_io_channel_units, only : set_units
   use gyroakf_io_columns, only : label_of, name_of
   use gyroakf_io_lines, only : line_of
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader, only : drop_absurd, find_scale, is_clock, largest_value, least_rows, may_be_time, &
      set_rate, tell, time_warning
   use gyroakf_io_recording, only : next_rows, recording_type
   use gyroakf_io_store, only : chunk_rows
   use gyroakf_io_stamps, only : unwrap_days
   use gyroakf_io_shape, only : fill_gaps, keep_rows, make_rates, mark_missing, wrap_of
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_record, only : add_text, audit_type, record_type, text_type
   implicit none (type, external)
   private
   public :: record_stream_type, begin_record_stream, next_record_block, end_record_stream

   !> Rows at the end of a window that are looked at again in the next, and delivered ones before them that are
   integer(int64), parameter :: held_back = 4096, context_rows = 4096
   !> Stamps that are remembered for the rates of the halves
   integer, parameter :: most_marks = 4096

   !> What is remembered from block to block
   type :: record_stream_type
      !> The end was reached: the last block was empty
      logical :: done = .false.
      !> s, 1 where no rate is known; that of the first window where it comes from the stamps
      real(dp) :: interval = 1.0_dp
      !> Channels that hold a number at all: [channel]
      logical, allocatable :: holds(:)
      !> Samples of the blocks so far, and of the whole recording including what --from and --to leave out
      integer(int64) :: delivered = 0, samples = 0
      !> What was found so far; for the procedures of this module, as all below
      type(record_type) :: summary
      !> "rate", "increment" or "angle"
      character(:), allocatable :: input
      !> A window was read; the chunk that is next
      logical :: begun = .false.
      integer :: chunk = 1
      !> Rows that wait for the next window; the first `context` of them were delivered already
      real(dp), allocatable :: rows(:, :), stamps(:)
      integer(int64) :: context = 0
      !> Which rows of the recording they are: repeated ones are left out; and how many were read
      integer(int64), allocatable :: number(:)
      integer(int64) :: read_rows = 0
      !> Rows of equal stamps, those of them that have equal values, other rows, those of them that do
      integer(int64) :: equal = 0, alike = 0, others = 0, chance = 0
      !> The burst that goes on, the row of the last change of the rate
      type(burst_type) :: burst
      integer(int64) :: last_change = 0
      !> Every so many rows are remembered: row, place on the grid, time from the first stamp: [mark]
      integer(int64) :: stride = 1
      integer(int64), allocatable :: mark_row(:), mark_place(:)
      real(dp), allocatable :: mark_time(:)
      integer :: marks = 0
      !> Rows that were delivered, lost samples that were filled in, time from the first stamp to the last delivered
      integer(int64) :: counted = 0, filled = 0
      real(dp) :: elapsed = 0.0_dp
      !> Gaps of a single sample: how many, the row of the last, smallest and largest distance; and whether all gaps are such
      integer(int64) :: singles = 0, last_single = 0, nearest = huge(1_int64), farthest = 0
      logical :: only_singles = .true.
      !> Unit of the stamps and the first of them
      real(dp) :: scale = 1.0_dp, origin = 0.0_dp
      !> The last time of day, and the midnights so far
      real(dp) :: clock = -1.0_dp
      integer :: days = 0
      !> Part of the samples that is wanted
      integer(int64) :: first = 1, last = huge(1_int64)
      !> The last row, for the differences of angles: [1, channel]
      real(dp), allocatable :: angle(:, :)
      !> The interval was given at the beginning
      logical :: settled = .false.
      !> What is told of the progress
      character(:), allocatable :: stage
      !> The last sample of every channel, and whether it was there: [channel]
      real(dp), allocatable :: edge(:)
      logical, allocatable :: edge_there(:)
      !> The first column rises so far, its last value
      logical :: rises = .true.
      real(dp) :: risen = -huge(1.0_dp)
   end type record_stream_type

contains

   !> Prepares for the blocks.
   subroutine begin_record_stream(recording, stream, interval, stage)
      !> Open; rows may be held already
      type(recording_type), intent(inout) :: recording
      !> Fresh afterwards
      type(record_stream_type), intent(out) :: stream
      !> s; where it is known from an earlier pass: blocks are then those of the record in memory, whatever the first window
      !> says of the rate
      real(dp), intent(in), optional :: interval
      !> What is told of the progress; "reading" if absent
      character(*), intent(in), optional :: stage
      integer :: channels, j

      channels = size(recording%table%chosen)
      stream%settled = present(interval)
      if (present(interval)) stream%interval = interval
      stream%stage = "reading"
      if (present(stage)) stream%stage = stage
      stream%input = "rate"
      if (allocated(recording%options%input)) stream%input = recording%options%input
      allocate (stream%holds(channels), stream%rows(0, channels), stream%stamps(0), stream%summary%channel(channels))
      allocate (stream%number(0))
      if (recording%table%time > 0) allocate (stream%mark_row(most_marks), stream%mark_place(most_marks), &
                                              stream%mark_time(most_marks))
      allocate (stream%edge(channels), stream%edge_there(channels))
      stream%holds = .false.
      stream%edge_there = .false.
      do j = 1, channels
         stream%summary%channel(j)%text = name_of(recording%table%names, recording%table%chosen(j))
      end do
      associate (audit => stream%summary%audit)
         allocate (audit%minimum(channels), audit%maximum(channels), audit%quantisation(channels), audit%line_of_first(3))
         audit%minimum = huge(1.0_dp)
         audit%maximum = -huge(1.0_dp)
         audit%quantisation = huge(1.0_dp)
         audit%line_of_first = 0
         audit%has_stamps = recording%table%time > 0
      end associate
      stream%rises = may_be_time(recording%options, recording%table)
   end subroutine begin_record_stream

   !> The next samples, as [[read_record]] would have them.
   subroutine next_record_block(recording, stream, block, error, progress)
      !> Of the beginning
      type(recording_type), intent(inout) :: recording
      !> Of the beginning
      type(record_stream_type), intent(inout) :: stream
      !> `value` [sample, channel], which may be empty, and `present` where something is missing
      type(record_type), intent(out) :: block
      !> io, parse, invalid_argument, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      type(gap_type) :: gaps
      integer(int64) :: n, from, to
      logical :: ended

      call read_window(recording, stream, ended, error)
      if (allocated(error)) return
      n = size(stream%rows, 1, kind=int64)
      stream%done = n == 0
      from = stream%context + 1
      to = n
      if (recording%table%time > 0) then
         if (.not. ended) to = max(stream%context, n - held_back)
         call audit_window(recording, stream, from, to, gaps)
      end if
      if (.not. stream%begun) call take_rate(recording, stream, error)
      if (allocated(error)) return
      stream%begun = .true.
      call watch_rows(stream, from, to)
      block%value = stream%rows(from:to, :)
      block%channel = stream%summary%channel
      block%sample_interval = stream%interval
      call hold_back(stream, ended, recording%table%time > 0, to)
      if (recording%table%time > 0) call fill_gaps(gaps, block, error)
      if (.not. allocated(error)) call finish_block(recording, stream, block, error)
      if (allocated(error) .or. .not. present(progress)) return
      call tell_progress(stream%stage, recording%lines%source%delivered, recording%lines%source%length, error, progress)
   end subroutine next_record_block

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
      if (real(stream%alike, dp)*real(max(stream%others, 1_int64), dp) <= &
          10.0_dp*real(stream%equal, dp)*real(stream%chance, dp)) kept = n
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

   !> The rates of the halves from the stamps that are remembered.
   pure subroutine rates_of_halves(stream, audit)
      type(record_stream_type), intent(in) :: stream
      type(audit_type), intent(inout) :: audit
      real(dp) :: middle, share, time, place
      integer :: k

      if (stream%marks < 2 .or. stream%elapsed <= 0.0_dp) return
      middle = real((stream%counted + 1)/2, dp)
      do k = 2, stream%marks - 1
         if (real(stream%mark_row(k), dp) >= middle) exit
      end do
      share = (middle - real(stream%mark_row(k - 1), dp))/real(stream%mark_row(k) - stream%mark_row(k - 1), dp)
      time = stream%mark_time(k - 1) + share*(stream%mark_time(k) - stream%mark_time(k - 1))
      place = real(stream%mark_place(k - 1), dp) + share*real(stream%mark_place(k) - stream%mark_place(k - 1), dp)
      if (time > 0.0_dp) audit%rate_first = place/time
      if (stream%elapsed > time) audit%rate_second = (real(stream%counted - 1 + stream%filled, dp) - place)/(stream%elapsed - time)
   end subroutine rates_of_halves

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

   !> Single samples lost at even distances may be the beat of the samples with a coarse clock: [[audit_stamps]] of the whole
   !> recording would not fill them in.
   subroutine warn_of_beat(stream, record)
      type(record_stream_type), intent(in) :: stream
      type(record_type), intent(inout) :: record

      if (stream%singles < 4 .or. .not. stream%only_singles) return
      if (stream%farthest - stream%nearest > max(4_int64, stream%nearest/5)) return
      call add_text(record%warnings, "the gaps are single samples at even distances: a clock too coarse for the rate, or lost "// &
                    "samples; each was filled with a missing sample, --time-column none with --rate takes the rows as evenly "// &
                    "spaced")
   end subroutine warn_of_beat

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

   !> The interval of the first window, and the part that is wanted in samples.
   subroutine take_rate(recording, stream, error)
      type(recording_type), intent(in) :: recording
      type(record_stream_type), intent(inout) :: stream
      !> invalid_argument, not_supported
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: probe

      if (allocated(recording%options%resample)) then
         if (recording%options%resample /= "index") then
            call fatal_error(error, status%not_supported, "--resample "//recording%options%resample//" needs the record in "// &
                             "memory, and it is larger than --memory allows: give more memory, a part by --from and --to, or "// &
                             "--resample index")
            return
         end if
      end if
      probe%audit%stamp_rate = stream%summary%audit%stamp_rate
      call set_rate(recording%options, recording%table, probe, error)
      if (allocated(error)) return
      if (.not. stream%settled) stream%interval = probe%sample_interval
      if (recording%options%from > 0.0_dp) stream%first = 1 + ceiling(recording%options%from/stream%interval - 1.0e-6_dp, int64)
      if (recording%options%to < 1.0e15_dp*stream%interval) then
         stream%last = ceiling(recording%options%to/stream%interval - 1.0e-6_dp, int64)
      end if
   end subroutine take_rate

   !> Which columns hold numbers, and whether the first one rises.
   subroutine watch_rows(stream, from, to)
      type(record_stream_type), intent(inout) :: stream
      integer(int64), intent(in) :: from, to
      integer(int64) :: i
      integer :: j

      do j = 1, size(stream%holds)
         if (stream%holds(j)) cycle
         stream%holds(j) = .not. all(ieee_is_nan(stream%rows(from:to, j)))
      end do
      do i = from, to
         if (.not. stream%rises) exit
         stream%rises = .not. ieee_is_nan(stream%rows(i, 1))
         if (.not. stream%rises) exit
         stream%rises = stream%rows(i, 1) > stream%risen
         stream%risen = stream%rows(i, 1)
      end do
      stream%counted = stream%counted + (to - from + 1)
   end subroutine watch_rows

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

   !> Marks what is missing, makes rates, cuts, counts.
   subroutine finish_block(recording, stream, block, error)
      type(recording_type), intent(in) :: recording
      type(record_stream_type), intent(inout) :: stream
      type(record_type), intent(inout) :: block
      !> non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: n, first, last

      if (stream%input == "angle" .and. size(block%value, 1) > 0) call join_angles(stream, block)
      if (size(block%value, 1) == 0) return
      call mark_missing(block, largest_value/max(1.0_dp, abs(recording%options%scale)), error, stream%samples)
      if (allocated(error)) return
      if (stream%input == "angle" .and. size(block%value, 1) < 2) then
         block%value = block%value(:0, :)
         if (allocated(block%present)) deallocate (block%present)
         return
      end if
      call make_rates(block, stream%input, recording%options%scale, error, wrap_of(recording%options, recording%table))
      if (allocated(error)) return
      n = size(block%value, 1, kind=int64)
      first = max(1_int64, stream%first - stream%samples)
      last = min(n, stream%last - stream%samples)
      stream%samples = stream%samples + n
      if (first > last) then
         block%value = block%value(:0, :)
         if (allocated(block%present)) deallocate (block%present)
         return
      end if
      if (first > 1 .or. last < n) call keep_rows(block, first, last, error)
      if (allocated(error)) return
      call audit_values(block%value, block%present, block%audit)
      call join_audit(stream, block)
      stream%delivered = stream%delivered + (last - first + 1)
   end subroutine finish_block

   !> Puts the last angle of the block before in front.
   subroutine join_angles(stream, block)
      type(record_stream_type), intent(inout) :: stream
      type(record_type), intent(inout) :: block
      real(dp), allocatable :: longer(:, :)
      integer(int64) :: n

      n = size(block%value, 1, kind=int64)
      if (allocated(stream%angle)) then
         allocate (longer(n + 1, size(block%value, 2)))
         longer(1, :) = stream%angle(1, :)
         longer(2:, :) = block%value
         call move_alloc(longer, block%value)
         n = n + 1
      end if
      stream%angle = block%value(n:n, :)
   end subroutine join_angles

   !> Adds what a block shows.
   subroutine join_audit(stream, block)
      type(record_stream_type), intent(inout) :: stream
      type(record_type), intent(in) :: block
      integer(int64) :: n
      integer :: j
      logical :: any_there

      n = size(block%value, 1, kind=int64)
      associate (audit => stream%summary%audit)
         audit%missing = audit%missing + block%audit%missing
         do j = 1, size(block%value, 2)
            any_there = .true.
            if (allocated(block%present)) any_there = any(block%present(:, j) == 1)
            if (any_there) then
               audit%minimum(j) = min(audit%minimum(j), block%audit%minimum(j))
               audit%maximum(j) = max(audit%maximum(j), block%audit%maximum(j))
               call join_step(block%audit%quantisation(j), audit%quantisation(j))
            end if
            if (stream%edge_there(j) .and. is_there(block, 1_int64, j)) then
               call join_step(abs(block%value(1, j) - stream%edge(j)), audit%quantisation(j))
            end if
            stream%edge(j) = block%value(n, j)
            stream%edge_there(j) = is_there(block, n, j)
         end do
      end associate
   end subroutine join_audit

   !> The smaller of two steps, of which 0 is none.
   pure subroutine join_step(step, smallest)
      real(dp), intent(in) :: step
      real(dp), intent(inout) :: smallest

      if (step > 0.0_dp) smallest = min(smallest, step)
   end subroutine join_step

   !> True where a sample is present.
   pure logical function is_there(block, i, j)
      type(record_type), intent(in) :: block
      integer(int64), intent(in) :: i
      integer, intent(in) :: j

      is_there = .true.
      if (allocated(block%present)) is_there = block%present(i, j) == 1
   end function is_there

   !> The record without its samples: rate, units, what was found.
   subroutine end_record_stream(recording, stream, record, error)
      !> Of the beginning
      type(recording_type), intent(inout) :: recording
      !> Done; its `holds` tells which channels are in the record
      type(record_stream_type), intent(inout) :: stream
      !> `value` is empty, `audit%samples` tells the number of samples
      type(record_type), intent(out) :: record
      !> parse (no number), invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      type(text_type), allocatable :: found(:)
      character(:), allocatable :: unit

      call end_bursts(stream%burst, stream%summary%audit)
      record = stream%summary
      call move_alloc(record%warnings, found)
      record%path = recording%path
      record%format = recording%format
      record%stored_type = recording%stored_type
      record%streamed = .true.
      associate (table => recording%table, options => recording%options)
         call add_list(table%warnings, record%warnings)
         call check_numbers(recording, stream, record, error)
         if (allocated(error)) return
         if (stream%rises .and. stream%counted > least_rows(table)) call add_text(record%warnings, time_warning(table))
         call add_list(found, record%warnings)
         record%audit%bad_lines = table%bad_lines
         record%audit%samples = stream%delivered
         record%audit%stamp_rate = 0.0_dp
         if (stream%elapsed > 0.0_dp) record%audit%stamp_rate = real(stream%counted - 1 + stream%filled, dp)/stream%elapsed
         call rates_of_halves(stream, record%audit)
         call set_rate(options, table, record, error)
         if (.not. allocated(error)) call check_part(options%from, stream, record, error)
         if (allocated(error)) return
         unit = ""
         if (allocated(options%unit)) unit = options%unit
         allocate (record%value(0, size(table%chosen)))
         call set_units(unit, stream%input, table, record, error)
         if (allocated(error)) return
         if (stream%input /= "rate") call make_rates(record, "increment", 1.0_dp, error)
         if (allocated(error)) return
         call scale_ranges(stream, record)
         call tell(table, record)
         call warn_of_beat(stream, record)
      end associate
   end subroutine end_record_stream

   !> Appends a list, which may be unallocated, to a list.
   subroutine add_list(list, longer)
      type(text_type), allocatable, intent(in) :: list(:)
      type(text_type), allocatable, intent(inout) :: longer(:)
      integer :: i

      if (.not. allocated(list)) return
      do i = 1, size(list)
         call add_text(longer, list(i)%text)
      end do
   end subroutine add_list

   !> Rates were made with the interval of the first window: the ranges are those with the mean one.
   pure subroutine scale_ranges(stream, record)
      type(record_stream_type), intent(in) :: stream
      type(record_type), intent(inout) :: record
      real(dp) :: factor

      if (stream%input == "rate") return
      factor = stream%interval/record%sample_interval
      record%audit%minimum = factor*record%audit%minimum
      record%audit%maximum = factor*record%audit%maximum
      record%audit%quantisation = factor*record%audit%quantisation
   end subroutine scale_ranges

   !> Leaves out columns without a number, as [[read_record]] does.
   subroutine check_numbers(recording, stream, record, error)
      type(recording_type), intent(inout) :: recording
      type(record_stream_type), intent(in) :: stream
      type(record_type), intent(inout) :: record
      !> parse
      type(error_type), allocatable, intent(out) :: error
      integer, allocatable :: slots(:)
      integer :: j

      associate (table => recording%table)
         do j = 1, size(stream%holds)
            if (stream%holds(j)) cycle
            if (table%asked .or. count(stream%holds) == 0) then
               call fatal_error(error, status%parse, table%name//":"//integer_text(line_of(table%map, 1_int64))//":1: "// &
                                label_of(table%names, table%chosen(j))//" holds no number"//new_line("a")// &
                                "choose another --column")
               return
            end if
            call add_text(record%warnings, label_of(table%names, table%chosen(j))//" holds no number and is left out")
            record%audit%missing = record%audit%missing - stream%delivered
         end do
         slots = pack([(j, j=1, size(stream%holds))], stream%holds)
         record%channel = record%channel(slots)
         record%audit%minimum = record%audit%minimum(slots)
         record%audit%maximum = record%audit%maximum(slots)
         record%audit%quantisation = record%audit%quantisation(slots)
         where (record%audit%quantisation >= huge(1.0_dp)) record%audit%quantisation = 0.0_dp
         where (record%audit%minimum > record%audit%maximum)
            record%audit%minimum = 0.0_dp
            record%audit%maximum = 0.0_dp
         end where
         table%chosen = table%chosen(slots)
      end associate
   end subroutine check_numbers

   !> Something is left of the part that was asked for.
   subroutine check_part(from, stream, record, error)
      real(dp), intent(in) :: from
      type(record_stream_type), intent(in) :: stream
      type(record_type), intent(in) :: record
      !> too_few_samples
      type(error_type), allocatable, intent(out) :: error

      if (stream%delivered > 0) return
      if (from > 0.0_dp) then
         call fatal_error(error, status%too_few_samples, "no sample lies between --from and --to")
      else
         call fatal_error(error, status%too_few_samples, record%path//": there are no samples")
      end if
   end subroutine check_part

end module gyroakf_io_record_stream
