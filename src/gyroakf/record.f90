! SPDX-License-Identifier: MIT
!> A recording in memory: the value of every channel at evenly spaced instants.
!>
!> Missing samples are marked in `present` and keep their place; `value` is finite everywhere.
module gyroakf_record
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_units, only : unit_type
   implicit none (type, external)
   private
   public :: record_type, audit_type, column_type, text_type, add_text, sample_count, unit_of, &
      view_channel

   !> A string of its own length, for lists
   type :: text_type
      character(:), allocatable :: text
      !> In a list of warnings: a note states what was done; a warning, what can make a number wrong
      logical :: note = .false.
      !> In a list of failures: the status of the error
      integer :: code = 0
   end type text_type

   !> What was found while reading
   type :: audit_type
      !> Samples per channel, missing ones included; those that are missing, in all channels
      integer(int64) :: samples = 0, missing = 0
      !> Places where the stamps show that samples were lost for good; those of them that are too
      !> long to be filled with missing samples
      integer(int64) :: gaps = 0, jumps = 0
      !> Double steps at even distances, no gaps: losses or the beat of a coarse clock
      integer(int64) :: beats = 0
      !> A rate that explains the stamps as well as `stamp_rate`, by losses or beats, Hz; 0: none
      real(dp) :: other_rate = 0.0_dp
      !> Stamps equal to the one before; smaller than it
      integer(int64) :: duplicates = 0, backward_steps = 0
      !> Lines that could not be read and were marked missing
      integer(int64) :: bad_lines = 0
      !> True where the file has a time column
      logical :: has_stamps = .false.
      !> (n - 1)/(t_n - t_1) in Hz; 0 without stamps
      real(dp) :: stamp_rate = 0.0_dp
      !> Largest distance of a stamp from the even grid, s
      real(dp) :: jitter_max = 0.0_dp
      !> Line of the first duplicate, backward step and gap: [3], 0 where there is none
      integer(int64), allocatable :: line_of_first(:)
      !> Smallest and largest value: [channel], of the record's unit
      real(dp), allocatable :: minimum(:), maximum(:)
      !> Smallest non-zero step between neighbors: [channel], of the record's unit; 0 for none
      real(dp), allocatable :: quantization(:)
      !> First and last sample of a stretch in which no channel changes though they do elsewhere; 0:
      !> none
      integer(int64) :: still(2) = 0
      !> Rows that repeat the one above, left out; the line of the first, 0 where there is none
      integer(int64) :: repeated = 0, line_of_repeat = 0
      !> Rows without a time that were left out, and the line of the first
      integer(int64) :: untimed = 0, line_of_untimed = 0
      !> Restarts of the clock (GPS week, 2^32 us), continued; line of the first; period, s
      integer(int64) :: rollovers = 0, line_of_rollover = 0
      real(dp) :: rollover_period = 0.0_dp
      !> Bursts: samples delivered at once, and late; the largest; the line of the first
      integer(int64) :: bursts = 0, longest_burst = 0, line_of_burst = 0
      !> Changes of the rate for good; the line of the first, and the rates before and behind it, Hz
      integer(int64) :: rate_changes = 0, line_of_change = 0
      real(dp) :: rate_before = 0.0_dp, rate_after = 0.0_dp
      !> Rates of the first and the second half of the samples, Hz; 0 without stamps
      real(dp) :: rate_first = 0.0_dp, rate_second = 0.0_dp
      !> The stamps count in this, s; 0 where it is not seen (below 1e-4 of the interval)
      real(dp) :: resolution = 0.0_dp
      !> Standard deviation of the distances of the stamps from the even grid, s
      real(dp) :: jitter_rms = 0.0_dp
      !> Of samples placed by their stamps: slots of the grid without one, samples that were
      !> dropped, the largest shift, s, and the part of white noise's variance that interpolation
      !> leaves
      integer(int64) :: empty_slots = 0, dropped = 0
      real(dp) :: largest_shift = 0.0_dp, white_noise = 1.0_dp
   end type audit_type

   !> A column of the file
   type :: column_type
      !> Name and unit as the file has them; "" where it has none
      character(:), allocatable :: name, unit
      !> As in "angular rate"
      character(:), allocatable :: class
      !> The channel that it became, 0 for none
      integer :: channel = 0
      !> True where it is the time, or a part of it
      logical :: is_time = .false.
      !> Range and smallest step as the file has them; NaN where not asked for or not read
      real(dp) :: minimum = 0.0_dp, maximum = 0.0_dp, step = 0.0_dp
   end type column_type

   !> A recording
   type :: record_type
      !> The file's name, "-" for standard input
      character(:), allocatable :: path
      !> As in "text", "npy", "i16le"
      character(:), allocatable :: format
      !> How the file stores its numbers, as in "float32"; "" for text
      character(:), allocatable :: stored_type
      !> The samples: [sample, channel]; finite everywhere, 0 where missing
      real(dp), allocatable :: value(:, :)
      !> 1 present, 0 missing: [sample, channel]; allocated only where something is missing
      integer(int8), allocatable :: present(:, :)
      !> Names: [channel]
      type(text_type), allocatable :: channel(:)
      !> All columns of the file: [column]
      type(column_type), allocatable :: column(:)
      !> s; 1 (per sample) where `rate_known` is false
      real(dp) :: sample_interval = 1.0_dp
      !> True where somebody gave the rate or the stamps show it
      logical :: rate_known = .false.
      !> "option", "header", "timestamps" or "none"
      character(:), allocatable :: rate_source
      !> Of the values; unknown where the channels have units of their own
      type(unit_type) :: unit
      !> Of each channel: [channel]; allocated only where they differ (gyros, accelerometers)
      type(unit_type), allocatable :: channel_unit(:)
      !> "option", "header" or "none"
      character(:), allocatable :: unit_source
      !> How samples got their place: "index", also where unallocated, "nearest" or "linear"
      character(:), allocatable :: resample
      !> What was found while reading
      type(audit_type) :: audit
      !> For the user, one sentence each
      type(text_type), allocatable :: warnings(:)
   end type record_type

contains

   !> Appends a text to a list (of warnings, of names); the list may be unallocated.
   pure subroutine add_text(list, text, note)
      !> Grows by one
      type(text_type), allocatable, intent(inout) :: list(:)
      !> The new last entry
      character(*), intent(in) :: text
      !> It is a note (default: it is not)
      logical, intent(in), optional :: note
      type(text_type), allocatable :: longer(:)
      integer :: i, n

      n = 0
      if (allocated(list)) n = size(list)
      allocate (longer(n + 1))
      do i = 1, n
         call move_alloc(list(i)%text, longer(i)%text)
         longer(i)%note = list(i)%note
         longer(i)%code = list(i)%code
      end do
      longer(n + 1)%text = text
      if (present(note)) longer(n + 1)%note = note
      call move_alloc(longer, list)
   end subroutine add_text

   !> Samples of each channel, missing ones included.
   pure integer(int64) function sample_count(record)
      !> Any
      type(record_type), intent(in) :: record

      sample_count = record%audit%samples
      if (allocated(record%value)) sample_count = size(record%value, 1, kind=int64)
   end function sample_count

   !> Unit of a channel.
   pure type(unit_type) function unit_of(record, channel)
      type(record_type), intent(in) :: record
      !> From 1
      integer, intent(in) :: channel

      unit_of = record%unit
      if (allocated(record%channel_unit)) unit_of = record%channel_unit(channel)
   end function unit_of

   !> One channel's record without its samples: rate, source and the unit that is the channel's.
   pure subroutine view_channel(record, channel, view)
      !> The whole
      type(record_type), intent(in) :: record
      !> From 1
      integer, intent(in) :: channel
      !> Path, format, rate and unit; no samples, no audit, no warnings
      type(record_type), intent(out) :: view

      if (allocated(record%path)) view%path = record%path
      if (allocated(record%format)) view%format = record%format
      if (allocated(record%stored_type)) view%stored_type = record%stored_type
      if (allocated(record%rate_source)) view%rate_source = record%rate_source
      if (allocated(record%unit_source)) view%unit_source = record%unit_source
      view%sample_interval = record%sample_interval
      view%rate_known = record%rate_known
      view%unit = unit_of(record, channel)
   end subroutine view_channel

end module gyroakf_record
