! SPDX-License-Identifier: MIT
!> The end of a recording that was read in blocks: rate, units, and what was found on the way.
module gyroakf_io_stream_end
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_bursts, only : end_bursts
   use gyroakf_io_channel_units, only : set_units
   use gyroakf_io_clock, only : set_rate, least_rows, make_time_warning
   use gyroakf_io_columns, only : label_of
   use gyroakf_io_findings, only : tell
   use gyroakf_io_lines, only : line_of
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_recording, only : recording_type
   use gyroakf_io_shape, only : make_rates, refuse_tiny
   use gyroakf_io_stream_state, only : record_stream_type
   use gyroakf_record, only : add_text, audit_type, record_type, text_type
   implicit none (type, external)
   private
   public :: end_record_stream

contains

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
      character(:), allocatable :: unit, text

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
         if (stream%rises .and. stream%counted > least_rows(table)) then
            call make_time_warning(table, text)
            call add_text(record%warnings, text)
         end if
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
         call refuse_tiny(record, error)
         if (allocated(error)) return
         call tell(table, record)
         call warn_of_beat(stream, record)
      end associate
   end subroutine end_record_stream

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

end module gyroakf_io_stream_end
