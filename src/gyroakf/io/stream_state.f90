! SPDX-License-Identifier: MIT
!> What is remembered of a recording that is read in blocks.
module gyroakf_io_stream_state
   use gyroakf_kinds, only : dp, int64
   use gyroakf_io_bursts, only : burst_type
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: record_stream_type, most_marks

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
      !> What was found so far; for the modules of the stream, as all below
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

end module gyroakf_io_stream_state
