! SPDX-License-Identifier: MIT
!> A recording from a file, standard input or a FIFO, or of samples that are in memory already.
!>
!> What the file says about rate, unit and columns is used, an option overrides it, and where
!> neither says anything nothing is assumed. Everything that was decided on the way is in the
!> record: `rate_source`, `unit_source`, `warnings`.
module gyroakf_io_reader
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, check_sample_interval, error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_values, gap_type
   use gyroakf_io_channel_units, only : set_units
   use gyroakf_io_column_behavior, only : find_first_time, find_time_and_counters
   use gyroakf_io_columns, only : has_name, label_of
   use gyroakf_io_findings, only : add_findings, survey_columns
   use gyroakf_io_column_choice, only : list_left_out
   use gyroakf_io_lines, only : line_of
   use gyroakf_io_place, only : integer_text, line_error
   use gyroakf_io_standstill, only : find_still
   use gyroakf_io_shape, only : cut, largest_value, make_rates, mark_missing, refuse_tiny, &
      warn_of_wraps, wrap_of
   use gyroakf_io_store, only : take_columns
   use gyroakf_io_recording, only : close_recording, hold_rows, open_recording, reader_options, &
      recording_type, say_too_large
   use gyroakf_io_table, only : table_type
   use gyroakf_io_time_base, only : place_samples, set_rate, use_stamps
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_record, only : add_text, record_type
   implicit none (type, external)
   private
   public :: reader_options, read_record, complete_record, finish_record

contains

   !> Reads a recording.
   subroutine read_record(path, options, record, error, progress)
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      !> Allocated on failure: io, parse, invalid_argument, not_supported, too_few_samples,
      !> non_finite, no_memory (also where more than `options%memory` would be needed), cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: recording
      character(:), allocatable :: large

      call open_recording(path, options, recording, error)
      if (.not. allocated(error)) call hold_rows(recording, error, progress)
      call close_recording(recording)
      if (.not. allocated(error) .and. .not. recording%table%whole) then
         call say_too_large(recording, large)
         call fatal_error(error, status%no_memory, large)
      end if
      if (.not. allocated(error)) call complete_record(recording, record, error, progress)
   end subroutine read_record

   !> Makes a record of the rows that are held.
   subroutine complete_record(recording, record, error, progress)
      !> Whole; its rows are moved out
      type(recording_type), intent(inout) :: recording
      type(record_type), intent(out) :: record
      !> On failure: parse, invalid_argument, too_few_samples, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(gap_type) :: gaps
      real(dp), allocatable :: stamps(:)
      real(dp) :: wrap
      integer :: i

      associate (options => recording%options, table => recording%table)
         record%path = recording%path
         record%format = recording%format
         if (recording%stored_type /= "") record%stored_type = recording%stored_type
         call move_alloc(table%warnings, record%warnings)
         if (options%unit == "" .and. allocated(table%header%unit_warnings)) then
            do i = 1, size(table%header%unit_warnings)
               call add_text(record%warnings, table%header%unit_warnings(i)%text)
            end do
         end if
         call take_values(options, table, record, stamps, error)
         if (.not. allocated(error)) call use_stamps(options, table, stamps, record, gaps, error)
         if (.not. allocated(error)) call set_rate(options, table, record, error)
         if (.not. allocated(error)) call report_progress("completing the record", 0_int64, &
            0_int64, error, progress)
         if (.not. allocated(error)) call place_samples(options, table, stamps, gaps, record, error)
         if (.not. allocated(error)) call mark_missing(record, &
            largest_value/max(1.0_dp, abs(options%scale)), error, progress)
         if (.not. allocated(error)) call set_units(options%unit, options%input, table, record, &
            error)
         wrap = wrap_of(options, table)
         if (.not. allocated(error) .and. options%input == "angle" .and. wrap <= 0.0_dp) then
            if (.not. allocated(options%wrap)) call warn_of_wraps(record)
         end if
         if (.not. allocated(error)) call report_progress("completing the record", 0_int64, &
            0_int64, error, progress)
         if (.not. allocated(error)) call make_rates(record, options%input, options%scale, error, &
            wrap)
         if (.not. allocated(error) .and. .not. record%audit%stamp_rate > 0.0_dp) then
            call cut(record, options%from, options%to, error)
         end if
         if (.not. allocated(error)) call audit_values(record%value, record%present, record%audit, &
            error, progress)
         if (.not. allocated(error)) call refuse_tiny(record, error)
         if (allocated(error)) return
         call find_still(record%value, record%present, record%audit%still)
         call add_findings(table, options%from, record)
      end associate
   end subroutine complete_record

   subroutine take_values(options, table, record, stamps, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(inout) :: table
      type(record_type), intent(inout) :: record
      real(dp), allocatable, intent(out) :: stamps(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: j, failed, time_slot
      integer, allocatable :: slots(:)
      logical, allocatable :: keep(:), blank(:), left(:)

      allocate (keep(size(table%chosen)), source=.true.)
      if (.not. table%asked) call find_time_and_counters(table, allocated(options%time_column), &
         options%input, keep, record%warnings)
      if (table%with_first) call find_first_time(table, keep, record%warnings)
      time_slot = 0
      if (table%time > 0) time_slot = table%layout%slot(table%time)
      blank = keep
      call find_numbers(table, keep, record, error)
      if (allocated(error)) return
      blank(:) = blank .and. .not. keep
      call survey_columns(table, keep, options%survey, record)
      left = [(record%column(j)%channel == 0 .and. .not. record%column(j)%is_time, j=1, &
         size(record%column))]
      left(pack(table%chosen, blank)) = .false.
      if (.not. table%asked) call list_left_out(table%names, table%class, left, record%warnings)
      slots = pack([(j, j=1, size(keep))], keep)
      call take_columns(table%store, time_slot, slots, record%value, stamps, failed)
      call check_memory(failed, "the record of "//table%name, error)
      if (allocated(error)) return
      allocate (record%channel(size(slots)))
      do j = 1, size(slots)
         record%channel(j)%text = "column"//integer_text(table%chosen(slots(j)))
         if (has_name(table%names, table%chosen(slots(j)))) record%channel(j)%text = &
            table%names%name(table%chosen(slots(j)))%text
      end do
      table%chosen = table%chosen(slots)
   end subroutine take_values

   !> Which of the stored columns hold a number; blank ones that were not asked for are left out.
   subroutine find_numbers(table, keep, record, error)
      type(table_type), intent(in) :: table
      logical, intent(inout) :: keep(:)
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      logical :: holds(size(table%chosen))
      integer :: i, j

      holds = .false.
      do j = 1, size(holds)
         if (.not. keep(j)) cycle
         do i = 1, table%store%count
            associate (chunk => table%store%chunk(i))
               holds(j) = .not. all(ieee_is_nan(chunk%value(:chunk%rows, j)))
            end associate
            if (holds(j)) exit
         end do
         if (holds(j)) cycle
         if (table%asked .or. size(holds) == 1) call line_error(error, table%name, &
            line_of(table%map, 1_int64), label_of(table%names, table%chosen(j))// &
            " holds no number", "choose another column")
         if (allocated(error)) return
         call add_text(record%warnings, label_of(table%names, table%chosen(j))// &
            " holds no number and is left out", note=.true.)
      end do
      keep(:) = keep .and. holds
      if (any(keep)) return
      call line_error(error, table%name, line_of(table%map, 1_int64), "no column holds a number", &
         "give one row of numbers per sample")
   end subroutine find_numbers

   !> Makes a recording of values and names: marks what is missing, sets rate and units, audits.
   subroutine finish_record(sample_interval, unit, record, error, progress)
      !> s, > 0, finite
      real(dp), intent(in) :: sample_interval
      !> "deg/s" for all channels, or one for each, separated by commas; "": unknown
      character(*), intent(in) :: unit
      !> Its `value` is there, NaN where missing, and the names of its `channel`; the rest is filled
      type(record_type), intent(inout) :: record
      !> invalid_argument (the interval, a unit that is unknown or none of a rate), non_finite (a
      !> value beyond 1e60), no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(table_type) :: nothing

      call check_sample_interval(sample_interval, error)
      if (allocated(error)) return
      record%path = "<memory>"
      record%format = "array"
      record%stored_type = "float64"
      record%sample_interval = sample_interval
      record%rate_known = .true.
      record%rate_source = "option"
      record%unit%name = ""
      record%unit_source = "none"
      if (unit /= "") call set_units(unit, "rate", nothing, record, error)
      if (.not. allocated(error)) call mark_missing(record, largest_value, error, progress)
      if (.not. allocated(error)) call audit_values(record%value, record%present, record%audit, &
         error, progress)
      if (.not. allocated(error)) call refuse_tiny(record, error)
      if (allocated(error)) return
      allocate (record%audit%line_of_first(3), source=0_int64)
   end subroutine finish_record

end module gyroakf_io_reader
