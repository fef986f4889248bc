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
!> in the next window: lost samples get their place, equal and backward stamps are counted, the largest distance from an
!> even grid is that within a window. The mean rate is that of the whole recording; it is known at its end, `interval` is
!> that of the first window until then.
module gyroakf_io_record_stream
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, audit_values, gap_type, join_windows
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
   integer(int64), parameter :: held_back = 4096, context_rows = 128

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
         stream%chunk = stream%chunk + 1
         ended = table%whole .and. stream%chunk > table%store%count
      end associate
   end subroutine read_window

   !> Where samples were lost, and which rows may be delivered.
   subroutine audit_window(recording, stream, from, to, gaps)
      type(recording_type), intent(in) :: recording
      type(record_stream_type), intent(inout) :: stream
      !> Rows that are delivered; `from` moves behind rows that repeat the last one of the block before
      integer(int64), intent(inout) :: from
      integer(int64), intent(in) :: to
      !> Counted from row `from`
      type(gap_type), intent(out) :: gaps
      type(audit_type) :: part
      real(dp), allocatable :: t(:)
      logical, allocatable :: repeats(:)
      integer(int64) :: before, start, skipped
      integer :: k, kept, lost

      before = stream%counted - stream%context
      start = max(1_int64, from - 1)
      if (.not. stream%begun) then
         call find_scale(recording%options, recording%table, stream%stamps, stream%summary, stream%scale, stream%origin)
      else
         call drop_absurd(stream%stamps)
      end if
      t = (stream%stamps - stream%origin)*stream%scale
      call audit_stamps(t, part, gaps, stream%rows)
      call find_repeats(gaps, size(t, kind=int64), repeats)
      call count_steps(stream%stamps(start:to), repeats(start:to), before + start - 1, stream%summary%audit)
      skipped = from
      do while (from <= to)
         if (.not. repeats(from)) exit
         from = from + 1
      end do
      skipped = from - skipped
      stream%counted = stream%counted + skipped
      kept = 0
      lost = 0
      do k = 1, gaps%count
         if (gaps%before(k) > to) exit
         if (gaps%before(k) < from .or. gaps%before(k) < 2) cycle
         if (gaps%length(k) > 0) then
            if (stream%summary%audit%line_of_first(3) == 0) stream%summary%audit%line_of_first(3) = before + gaps%before(k)
            call note_single(stream, before + gaps%before(k), gaps%length(k))
            lost = lost + 1
         end if
         kept = kept + 1
         gaps%length(kept) = gaps%length(k)
         gaps%before(kept) = gaps%before(k) - (from - 1)
      end do
      gaps%count = kept
      associate (audit => stream%summary%audit)
         if (gaps%first_jump < from .or. gaps%first_jump > to) gaps%jumps = 0
         if (gaps%jumps > 0 .and. audit%line_of_first(3) == 0) audit%line_of_first(3) = before + gaps%first_jump
         audit%gaps = audit%gaps + lost + gaps%jumps
         audit%jumps = audit%jumps + gaps%jumps
         audit%beats = audit%beats + nint(real(part%beats, dp)*real(to - from + 1, dp)/real(max(size(t), 1), dp), int64)
         audit%jitter_max = max(audit%jitter_max, part%jitter_max)
         call join_windows(part, before, from, to, audit)
         if (to > start) stream%elapsed = stream%elapsed + (t(to - count(repeats(:to))) - t(start - count(repeats(:start))))
         stream%filled = stream%filled + sum(gaps%length(:kept)) - skipped
         audit%repeated = audit%repeated + skipped + (kept - lost)
         if (audit%line_of_repeat == 0 .and. any(repeats(start:to))) then
            audit%line_of_repeat = before + start - 1 + findloc(repeats(start:to), .true., dim=1, kind=int64)
         end if
         if (.not. stream%begun) audit%stamp_rate = part%stamp_rate
      end associate
   end subroutine audit_window

   !> Which rows repeat the one above.
   subroutine find_repeats(gaps, rows, repeats)
      type(gap_type), intent(in) :: gaps
      integer(int64), intent(in) :: rows
      logical, allocatable, intent(out) :: repeats(:)
      integer :: k

      allocate (repeats(rows))
      repeats = .false.
      do k = 1, gaps%count
         if (gaps%length(k) < 0) repeats(gaps%before(k)) = .true.
      end do
   end subroutine find_repeats

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
   pure subroutine count_steps(t, repeats, before, audit)
      !> NaN where missing
      real(dp), intent(in) :: t(:)
      !> Rows that repeat the one above
      logical, intent(in) :: repeats(:)
      !> Rows before them
      integer(int64), intent(in) :: before
      type(audit_type), intent(inout) :: audit
      integer(int64) :: i

      do i = 2, size(t, kind=int64)
         if (ieee_is_nan(t(i)) .or. ieee_is_nan(t(i - 1)) .or. repeats(i)) cycle
         if (t(i) > t(i - 1)) cycle
         if (t(i) < t(i - 1)) then
            audit%backward_steps = audit%backward_steps + 1
            if (audit%line_of_first(2) == 0) audit%line_of_first(2) = before + i
         else
            audit%duplicates = audit%duplicates + 1
            if (audit%line_of_first(1) == 0) audit%line_of_first(1) = before + i
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
      if (stamped .and. .not. ended) first = max(1_int64, to + 1 - context_rows)
      stream%context = to + 1 - first
      allocate (rows(size(stream%rows, 1, kind=int64) - first + 1, size(stream%rows, 2)))
      rows(:, :) = stream%rows(first:, :)
      call move_alloc(rows, stream%rows)
      if (.not. stamped) return
      allocate (stamps(size(stream%stamps, kind=int64) - first + 1))
      stamps(:) = stream%stamps(first:)
      call move_alloc(stamps, stream%stamps)
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
