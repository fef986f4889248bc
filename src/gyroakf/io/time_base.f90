! SPDX-License-Identifier: MIT
!> The place of every sample in time: unit and span of the stamps, audit, rate, gaps or a grid.
module gyroakf_io_time_base
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, gap_type
   use gyroakf_io_columns, only : label_of
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_left_out_rows, only : leave_rows_out, place_with
   use gyroakf_io_lines, only : line_of
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_resample, only : resample
   use gyroakf_io_shape, only : fill_gaps, wrap_of
   use gyroakf_io_stamps, only : infer_scale, named_scale, unpack_clock, unwrap_days
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, audit_type, record_type
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: use_stamps, set_rate, place_samples

contains

   !> Turns the stamps into seconds from the first, keeps the rows asked for and audits them.
   subroutine use_stamps(options, table, stamps, record, gaps, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      !> Afterwards those of the rows that are kept
      real(dp), allocatable, intent(inout) :: stamps(:)
      type(record_type), intent(inout) :: record
      type(gap_type), intent(out) :: gaps
      !> no_memory, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      integer(int64), allocatable :: dropped(:)
      real(dp) :: scale, origin, given, rate
      integer(int64) :: rows, first
      integer :: k
      logical :: clock

      record%audit%bad_lines = table%bad_lines
      if (size(stamps) == 0) then
         call audit_stamps(stamps, record%audit, gaps, error)
         return
      end if
      ! a time of day without a date begins again at midnight
      associate (slot => table%layout%slot)
         clock = abs(table%layout%kind(table%time)) == stamp_kind%clock .and. &
            count(slot == slot(table%time)) == 1
         if (table%layout%kind(table%time) == stamp_kind%number .and. &
            .not. allocated(options%time_unit)) then
            call unpack_clock(stamps, clock)
            if (clock) call add_text(record%warnings, label_of(table%names, table%time)// &
               " is read as hhmmss", note=.true.)
         end if
         if (clock) call unwrap_days(stamps)
      end associate
      call drop_absurd(stamps)
      rows = size(stamps, kind=int64)
      call leave_rows_out(stamps, record%value, record%audit, dropped, error)
      if (allocated(error)) return
      if (size(stamps) == 0) then
         call add_text(record%warnings, label_of(table%names, table%time)//" holds no time in "// &
                       integer_text(record%audit%untimed)//" of "//integer_text(rows)// &
                       " rows and is not used: `rate_hz` gives the sample rate")
      else
         scale = 1.0_dp
         if (.not. clock) call find_scale(options, table, stamps, record, scale)
         origin = stamps(1)
         stamps = (stamps - origin)*scale
      end if
      given = merge(options%rate_hz, table%header%rate_hz, options%rate_hz > 0.0_dp)
      call keep_span(options, given, stamps, record%value, first, rate, error)
      if (allocated(error)) return
      call audit_stamps(stamps, record%audit, gaps, error, given)
      if (allocated(error)) return
      if (record%audit%stamp_rate <= 0.0_dp) record%audit%stamp_rate = rate
      associate (audit => record%audit)
         audit%line_of_first = [(line_of(table%map, place_with(dropped, audit%line_of_first(k), &
            first)), k=1, 3)]
         audit%line_of_rollover = line_of(table%map, &
            place_with(dropped, audit%line_of_rollover, first))
         audit%line_of_burst = line_of(table%map, place_with(dropped, audit%line_of_burst, first))
         audit%line_of_change = line_of(table%map, place_with(dropped, audit%line_of_change, first))
         audit%line_of_repeat = line_of(table%map, audit%line_of_repeat)
         audit%line_of_untimed = line_of(table%map, audit%line_of_untimed)
      end associate
   end subroutine use_stamps

   !> Keeps the rows of the span that is asked for, so that what is found is found in it.
   subroutine keep_span(options, given, stamps, value, first, rate, error)
      type(reader_options), intent(in) :: options
      real(dp), intent(in) :: given
      real(dp), allocatable, intent(inout) :: stamps(:), value(:, :)
      integer(int64), intent(out) :: first
      real(dp), intent(out) :: rate
      type(error_type), allocatable, intent(out) :: error
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp), allocatable :: t(:)
      real(dp) :: interval, scale
      integer(int64) :: last
      integer :: failed

      first = 1
      rate = 0.0_dp
      if (size(stamps) == 0 .or. (options%from <= 0.0_dp .and. options%to >= huge(1.0_dp))) return
      allocate (t(size(stamps)), stat=failed)
      call check_memory(failed, "the time stamps of a span", error)
      if (allocated(error)) return
      t(:) = stamps
      call audit_stamps(t, audit, gaps, error, given)
      if (allocated(error) .or. audit%stamp_rate <= 0.0_dp) return
      interval = 1.0_dp/audit%stamp_rate
      scale = 1.0_dp
      if (options%rate_hz > 0.0_dp) scale = audit%stamp_rate/options%rate_hz
      first = count(scale*t < options%from - 1.0e-6_dp*interval, kind=int64) + 1
      last = count(scale*t < options%to - 1.0e-6_dp*interval, kind=int64)
      if (first > size(t)) then
         call fatal_error(error, status%too_few_samples, "the record ends at "// &
            format_real(scale*(t(size(t)) + interval), 6)//" s, before `from` "// &
            format_real(options%from, 6))
      else if (first > last) then
         call fatal_error(error, status%too_few_samples, "no sample lies between `from` and `to`")
      end if
      if (allocated(error)) return
      if (options%input == "angle") last = min(last + 1, size(t, kind=int64))
      rate = audit%stamp_rate
      stamps = stamps(first:last) - stamps(first)
      value = value(first:last, :)
   end subroutine keep_span

   !> Fills gaps, or puts the samples on the grid by their stamps.
   subroutine place_samples(options, table, stamps, gaps, record, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      !> As audited
      real(dp), intent(in), contiguous :: stamps(:)
      !> Filled unless the samples are resampled
      type(gap_type), intent(in) :: gaps
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what
      real(dp) :: wrap

      record%resample = options%resample
      if (options%resample == "index") then
         call fill_gaps(gaps, record, error)
         return
      end if
      what = ""
      if (.not. record%audit%has_stamps) then
         what = options%resample//" needs time stamps, and "//table%name// &
            " has none that are known: name their column with `time_column`"
      else if (.not. record%audit%stamp_rate > 0.0_dp) then
         what = options%resample//" needs time stamps that rise, those of "//table%name//" do not"
      else if (options%resample == "linear" .and. options%input == "increment") then
         what = "linear between increments would not keep the angle that they add up to: "// &
            "use `resample` nearest or index"
      end if
      if (what /= "") then
         call fatal_error(error, status%invalid_argument, "`resample` "//what)
         return
      end if
      wrap = 0.0_dp
      if (options%input == "angle") wrap = wrap_of(options, table)
      call resample(stamps, options%resample, wrap, record, error)
   end subroutine place_samples

   !> The rate: an option, else the stamps unless 1 % off the header's, else the header.
   subroutine set_rate(options, table, record, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what
      real(dp) :: rate, stamped
      logical :: differ

      rate = 0.0_dp
      record%rate_source = "none"
      stamped = record%audit%stamp_rate
      if (options%rate_hz > 0.0_dp) then
         rate = options%rate_hz
         record%rate_source = "option"
      else if (table%header%rate_hz > 0.0_dp) then
         rate = table%header%rate_hz
         record%rate_source = "header"
      end if
      differ = .false.
      if (rate > 0.0_dp .and. stamped > 0.0_dp) differ = abs(stamped - rate) > 0.01_dp*rate
      if (differ) call add_text(record%warnings, "the rate "//format_real(rate, 6)// &
         " Hz of the "//record%rate_source//" and the time stamps' "//format_real(stamped, 6)// &
         " Hz differ; the "//record%rate_source//"'s is used")
      if (stamped > 0.0_dp .and. record%rate_source /= "option" .and. .not. differ) then
         rate = stamped
         record%rate_source = "timestamps"
      end if
      record%rate_known = rate > 0.0_dp
      if (record%rate_known) record%sample_interval = 1.0_dp/rate
      if (record%rate_known) return
      what = ""
      if (options%input /= "rate") what = "`input` "//options%input//" needs"
      if (options%from > 0.0_dp .or. options%to < huge(rate)) what = "`from` and `to` need"
      if (what /= "") call fatal_error(error, status%invalid_argument, what//" the rate, and "// &
         table%name//" does not tell it: give `rate_hz` or `time_column`")
   end subroutine set_rate

   !> Seconds in the unit of the stamps; a warning says where it is guessed.
   subroutine find_scale(options, table, stamps, record, scale)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      real(dp), intent(in), contiguous :: stamps(:)
      type(record_type), intent(inout) :: record
      real(dp), intent(out) :: scale
      character(2), parameter :: words(4) = ["s ", "ms", "us", "ns"]
      character(:), allocatable :: word
      real(dp) :: given, step
      logical :: sure
      integer :: kind, rows

      scale = 0.0_dp
      rows = int(min(size(stamps, kind=int64), 1000_int64))
      step = (stamps(rows) - stamps(1))/max(1, rows - 1)
      kind = abs(table%layout%kind(table%time))
      if (kind /= stamp_kind%number .and. kind /= stamp_kind%long) then
         scale = 1.0_dp
      else if (allocated(options%time_unit)) then
         scale = time_scale(lower(options%time_unit))
      else if (table%names%known) then
         scale = named_scale(table%names%name(table%time)%text, &
                             table%names%unit(table%time)%text, step)
      end if
      if (scale <= 0.0_dp) then
         given = merge(options%rate_hz, table%header%rate_hz, options%rate_hz > 0.0_dp)
         call infer_scale(stamps, given, scale, sure, real(table%layout%origin, dp))
         word = trim(words(1 - nint(log10(scale)/3.0_dp)))
         if (.not. sure) call add_text(record%warnings, "the time in "// &
            label_of(table%names, table%time)//" names no unit and is taken as "//word// &
            " by its step; `time_unit` "//word//" or a name such as time_"//word//" settles it"// &
            trim(merge(", `time_column` none leaves it out where it counts rows", repeat(" ", 55), &
            abs(step - 1.0_dp) < 1.0e-9_dp)))
      end if
   end subroutine find_scale

   !> Too large for a time and for products of times: missing; too small for quotients: 0.
   pure subroutine drop_absurd(stamps)
      real(dp), intent(inout), contiguous :: stamps(:)
      real(dp), parameter :: largest_stamp = 1.0e30_dp, smallest_stamp = 1.0e-30_dp
      integer(int64) :: i

      do i = 1, size(stamps, kind=int64)
         if (ieee_is_nan(stamps(i))) cycle
         if (abs(stamps(i)) > largest_stamp) then
            stamps(i) = ieee_value(1.0_dp, ieee_quiet_nan)
         else if (abs(stamps(i)) < smallest_stamp) then
            stamps(i) = 0.0_dp
         end if
      end do
   end subroutine drop_absurd

end module gyroakf_io_time_base
