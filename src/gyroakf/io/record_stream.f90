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
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_values, gap_type
   use gyroakf_io_clock, only : may_be_time, set_rate
   use gyroakf_io_columns, only : name_of
   use gyroakf_io_recording, only : recording_type
   use gyroakf_io_shape, only : fill_gaps, keep_rows, largest_value, make_rates, mark_missing, wrap_of
   use gyroakf_io_stream_end, only : end_record_stream
   use gyroakf_io_stream_state, only : most_marks, record_stream_type
   use gyroakf_io_stream_window, only : audit_window, held_back, hold_back, read_window
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: record_stream_type, begin_record_stream, next_record_block, end_record_stream

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
      call audit_values(block%value, block%present, block%audit, error)
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

end module gyroakf_io_record_stream
