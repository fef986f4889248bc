! SPDX-License-Identifier: MIT
!> A recording from a file, from standard input or from a FIFO.
!>
!> What the file says about rate, unit and columns is honoured, an option overrides it, and where nobody says anything
!> nothing is assumed. Everything that was decided on the way is in the record: `rate_source`, `unit_source`, `warnings`.
module gyroakf_io_reader
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, audit_values, gap_type
   use gyroakf_io_channel_units, only : set_units
   use gyroakf_io_columns, only : label_of, name_of
   use gyroakf_io_lines, only : line_of
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_stamps, only : infer_scale, named_scale, unwrap_days
   use gyroakf_io_resample, only : resample
   use gyroakf_io_shape, only : cut, fill_gaps, make_rates, mark_missing, warn_of_wraps, wrap_of
   use gyroakf_io_store, only : take_columns
   use gyroakf_io_recording, only : close_recording, hold_rows, memory_advice, open_recording, reader_options, &
      recording_type, too_large
   use gyroakf_io_table, only : table_type
   use gyroakf_io_date, only : stamp_kind
   use gyroakf_io_decimal, only : format_real
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : add_text, record_type
   implicit none (type, external)
   private
   public :: reader_options, read_record, complete_record
   public :: largest_value, drop_absurd, find_scale, is_clock, set_rate, tell, least_rows, may_be_time, time_warning

   !> A rate beyond it is an error: the fourth powers of the statistics would overflow
   real(dp), parameter :: largest_value = 1.0e60_dp

contains

   !> Reads a recording.
   subroutine read_record(path, options, record, error, progress)
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> How
      type(reader_options), intent(in) :: options
      !> The recording
      type(record_type), intent(out) :: record
      !> Allocated on failure: io, parse, invalid_argument, not_supported, too_few_samples, non_finite,
      !> no_memory (also where more than `options%memory` would be needed), cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: recording

      call open_recording(path, options, recording, error)
      if (.not. allocated(error)) call hold_rows(recording, error, progress)
      call close_recording(recording)
      if (.not. allocated(error) .and. .not. recording%table%whole) then
         call fatal_error(error, status%no_memory, too_large(recording)//new_line("a")//memory_advice(recording))
      end if
      if (.not. allocated(error)) call complete_record(recording, record, error)
   end subroutine read_record

   !> Makes a record of the rows that are held.
   subroutine complete_record(recording, record, error)
      !> Whole; its rows are moved out
      type(recording_type), intent(inout) :: recording
      !> The recording
      type(record_type), intent(out) :: record
      !> Allocated on failure: parse, invalid_argument, too_few_samples, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      type(gap_type) :: gaps
      real(dp), allocatable :: stamps(:)
      character(:), allocatable :: input, unit
      real(dp) :: wrap

      associate (options => recording%options, table => recording%table)
         input = "rate"
         if (allocated(options%input)) input = options%input
         unit = ""
         if (allocated(options%unit)) unit = options%unit
         record%path = recording%path
         record%format = recording%format
         record%stored_type = recording%stored_type
         call move_alloc(table%warnings, record%warnings)
         call take_values(table, record, stamps, error)
         if (.not. allocated(error)) call warn_of_time(options, table, record)
         if (.not. allocated(error)) call use_stamps(options, table, stamps, record, gaps)
         if (.not. allocated(error)) call set_rate(options, table, record, error)
         if (.not. allocated(error)) call place_samples(options, table, stamps, gaps, record, error)
         if (.not. allocated(error)) call mark_missing(record, largest_value/max(1.0_dp, abs(options%scale)), error)
         if (.not. allocated(error)) call set_units(unit, input, table, record, error)
         wrap = wrap_of(options, table)
         if (.not. allocated(error) .and. input == "angle" .and. wrap <= 0.0_dp) then
            if (.not. allocated(options%wrap)) call warn_of_wraps(record)
         end if
         if (.not. allocated(error)) call make_rates(record, input, options%scale, error, wrap)
         if (.not. allocated(error)) call cut(record, options%from, options%to, error)
         if (allocated(error)) return
         call audit_values(record%value, record%present, record%audit)
         call tell(table, record)
      end associate
   end subroutine complete_record

   !> Moves the columns that hold numbers into the record.
   subroutine take_values(table, record, stamps, error)
      type(table_type), intent(inout) :: table
      type(record_type), intent(inout) :: record
      real(dp), allocatable, intent(out) :: stamps(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: j, failed, time_slot
      integer, allocatable :: slots(:)

      time_slot = 0
      if (table%time > 0) time_slot = table%layout%slot(table%time)
      allocate (slots(0))
      call find_numbers(table, slots, record, error)
      if (allocated(error)) return
      call take_columns(table%store, time_slot, slots, record%value, stamps, failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the record of "//table%name)
         return
      end if
      allocate (record%channel(size(slots)))
      do j = 1, size(slots)
         record%channel(j)%text = name_of(table%names, table%chosen(slots(j)))
      end do
      table%chosen = table%chosen(slots)
   end subroutine take_values

   !> Which of the stored columns hold a number at all; blank ones are left out unless they were asked for.
   subroutine find_numbers(table, slots, record, error)
      type(table_type), intent(in) :: table
      integer, allocatable, intent(inout) :: slots(:)
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      logical :: holds(size(table%chosen))
      integer :: i, j

      holds = .false.
      do j = 1, size(holds)
         do i = 1, table%store%count
            associate (chunk => table%store%chunk(i))
               holds(j) = .not. all(ieee_is_nan(chunk%value(:chunk%rows, j)))
            end associate
            if (holds(j)) exit
         end do
         if (holds(j)) cycle
         if (table%asked .or. size(holds) == 1) then
            call fatal_error(error, status%parse, table%name//":"//integer_text(line_of(table%map, 1_int64))//":1: "// &
                             label_of(table%names, table%chosen(j))//" holds no number"//new_line("a")//"choose another --column")
            return
         end if
         call add_text(record%warnings, label_of(table%names, table%chosen(j))//" holds no number and is left out")
      end do
      slots = pack([(j, j=1, size(holds))], holds)
      if (size(slots) > 0) return
      call fatal_error(error, status%parse, table%name//":"//integer_text(line_of(table%map, 1_int64))// &
                       ":1: no column holds a number"//new_line("a")//"give one row of numbers per sample")
   end subroutine find_numbers

   !> True where a first channel that rises all the way is worth a word: it may be a time, or a counter.
   pure logical function may_be_time(options, table)
      !> What is wanted
      type(reader_options), intent(in) :: options
      !> Its columns are chosen
      type(table_type), intent(in) :: table

      may_be_time = table%layout%columns >= 2 .and. .not. (table%asked .or. allocated(options%time_column))
      if (may_be_time .and. allocated(options%input)) may_be_time = options%input /= "angle"
   end function may_be_time

   !> More rows than so many have to rise: two without names, more with names, for a channel that has one may rise by chance.
   pure integer(int64) function least_rows(table)
      !> Of any format
      type(table_type), intent(in) :: table

      least_rows = merge(20, 2, table%names%known)
   end function least_rows

   !> What is said of it.
   function time_warning(table) result(text)
      !> Of any format
      type(table_type), intent(in) :: table
      character(:), allocatable :: text
      character(:), allocatable :: number

      number = integer_text(int(table%chosen(1), int64))
      text = label_of(table%names, table%chosen(1))//" rises from row to row and looks like "
      if (table%time > 0) then
         text = text//"a counter; it is read as a channel, --column leaves it out"
      else
         text = text//"time; it is read as a channel, --time-column "//number//" takes it for the time"
      end if
   end function time_warning

   !> A first channel that rises all the way may be a time: it is not taken for one, but said.
   subroutine warn_of_time(options, table, record)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      integer(int64) :: i, n
      logical :: rises

      if (.not. may_be_time(options, table)) return
      n = size(record%value, 1, kind=int64)
      rises = n > least_rows(table)
      do i = 2, n
         if (.not. rises) return
         rises = .not. (ieee_is_nan(record%value(i, 1)) .or. ieee_is_nan(record%value(i - 1, 1)))
         if (rises) rises = record%value(i, 1) > record%value(i - 1, 1)
      end do
      if (rises) call add_text(record%warnings, time_warning(table))
   end subroutine warn_of_time

   !> Turns the stamps into seconds from the first and audits them.
   subroutine use_stamps(options, table, stamps, record, gaps)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      real(dp), intent(inout), contiguous :: stamps(:)
      type(record_type), intent(inout) :: record
      type(gap_type), intent(out) :: gaps
      real(dp) :: scale, origin, before
      integer :: days

      record%audit%bad_lines = table%bad_lines
      if (size(stamps) == 0) then
         call audit_stamps(stamps, record%audit, gaps)
         return
      end if
      before = ieee_value(before, ieee_quiet_nan)
      days = 0
      if (is_clock(table)) call unwrap_days(stamps, before, days)
      call find_scale(options, table, stamps, record, scale, origin)
      stamps = (stamps - origin)*scale
      call audit_stamps(stamps, record%audit, gaps, record%value)
   end subroutine use_stamps

   !> Fills gaps, or puts the samples on the grid by their stamps.
   subroutine place_samples(options, table, stamps, gaps, record, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      !> As audited
      real(dp), intent(in), contiguous :: stamps(:)
      !> Only its repeated rows remain where the samples are resampled
      type(gap_type), intent(inout) :: gaps
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: way
      real(dp) :: wrap
      integer :: kept

      way = "index"
      if (allocated(options%resample)) way = options%resample
      record%resample = way
      if (way == "index") then
         call fill_gaps(gaps, record, error)
         return
      end if
      call check_resample(options, table, record, error)
      if (allocated(error)) return
      kept = count(gaps%length(:gaps%count) < 0)
      gaps%before(:kept) = pack(gaps%before(:gaps%count), gaps%length(:gaps%count) < 0)
      gaps%length(:kept) = -1
      gaps%count = kept
      call fill_gaps(gaps, record, error)
      if (allocated(error)) return
      wrap = 0.0_dp
      if (allocated(options%input)) then
         if (options%input == "angle") wrap = wrap_of(options, table)
      end if
      call resample(stamps(:size(record%value, 1)), way, wrap, record, error)
   end subroutine place_samples

   !> What resampling needs.
   subroutine check_resample(options, table, record, error)
      !> `resample` is not "index"
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      !> Audited
      type(record_type), intent(in) :: record
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error

      if (.not. record%audit%has_stamps) then
         call fatal_error(error, status%invalid_argument, "--resample "//options%resample//" needs time stamps, and "// &
                          table%name//" has none that are known: name their column with --time-column")
      else if (.not. record%audit%stamp_rate > 0.0_dp) then
         call fatal_error(error, status%invalid_argument, "--resample "//options%resample//" needs time stamps that rise, "// &
                          "those of "//table%name//" do not")
      end if
      if (allocated(error) .or. .not. allocated(options%input)) return
      if (options%resample == "linear" .and. options%input == "increment") call fatal_error(error, status%invalid_argument, &
         "--resample linear between increments would not keep the angle that they add up to: use --resample nearest or index")
   end subroutine check_resample

   !> The unit of the stamps and the first of them; what is no time becomes missing.
   subroutine find_scale(options, table, stamps, record, scale, origin)
      !> For the rate
      type(reader_options), intent(in) :: options
      !> For names, units and the header's rate
      type(table_type), intent(in) :: table
      !> As read
      real(dp), intent(inout), contiguous :: stamps(:)
      !> Gets a warning where the unit is guessed
      type(record_type), intent(inout) :: record
      !> Seconds in the unit of the stamps
      real(dp), intent(out) :: scale
      !> The first stamp
      real(dp), intent(out) :: origin
      real(dp) :: given
      logical :: sure
      integer(int64) :: i
      integer :: kind

      call drop_absurd(stamps)
      scale = 0.0_dp
      kind = time_kind(table)
      if (kind /= stamp_kind%number .and. kind /= stamp_kind%long) then
         scale = 1.0_dp
      else if (table%names%known) then
         scale = named_scale(table%names%name(table%time)%text, table%names%unit(table%time)%text)
      end if
      if (scale <= 0.0_dp) then
         given = merge(options%rate_hz, table%header%rate_hz, options%rate_hz > 0.0_dp)
         call infer_scale(stamps, given, scale, sure, real(table%layout%origin, dp))
         if (.not. sure) call add_text(record%warnings, "the time in "//label_of(table%names, table%time)// &
            " names no unit and is taken as "//unit_word(scale)//" by its step; a name such as time_"//unit_word(scale)// &
            " or the option --rate settles it")
      end if
      do i = 1, size(stamps, kind=int64)
         if (.not. ieee_is_nan(stamps(i))) exit
      end do
      origin = 0.0_dp
      if (i <= size(stamps, kind=int64)) origin = stamps(i)
   end subroutine find_scale

   !> What the time column holds.
   pure integer function time_kind(table)
      !> Of any format
      type(table_type), intent(in) :: table

      time_kind = stamp_kind%number
      if (table%time > 0 .and. allocated(table%layout%kind)) time_kind = abs(table%layout%kind(table%time))
   end function time_kind

   !> True where the time is a time of day, without a date, which begins again at midnight.
   pure logical function is_clock(table)
      !> Of any format
      type(table_type), intent(in) :: table

      is_clock = time_kind(table) == stamp_kind%clock
      if (is_clock) is_clock = count(table%layout%slot == table%layout%slot(table%time)) == 1
   end function is_clock

   !> What is too large for a time, and for products of times, is missing; what is too small for their quotients is 0.
   pure subroutine drop_absurd(stamps)
      !> As read
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

   !> The word for a unit of time.
   pure function unit_word(scale) result(word)
      real(dp), intent(in) :: scale
      character(:), allocatable :: word

      word = "s"
      if (scale < 0.5_dp) word = "ms"
      if (scale < 0.5e-3_dp) word = "us"
      if (scale < 0.5e-6_dp) word = "ns"
   end function unit_word

   !> The rate: an option, else the stamps, else the header; stamps that contradict the header by more than 1 % do not count.
   subroutine set_rate(options, table, record, error)
      type(reader_options), intent(in) :: options
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
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
      if (differ) call add_text(record%warnings, "the rate "//format_real(rate, 6)//" Hz of the "//record%rate_source// &
         " and the time stamps' "//format_real(stamped, 6)//" Hz differ; the "//record%rate_source//"'s is used")
      if (stamped > 0.0_dp .and. record%rate_source /= "option" .and. .not. differ) then
         rate = stamped
         record%rate_source = "timestamps"
      end if
      record%rate_known = rate > 0.0_dp
      if (record%rate_known) record%sample_interval = 1.0_dp/rate
      if (record%rate_known) return
      if (allocated(options%input)) then
         if (options%input /= "rate") call fatal_error(error, status%invalid_argument, "--input "//options%input// &
            " needs the rate, and "//table%name//" does not tell it: give --rate HZ or --dt S, or --time-column")
      end if
      if (options%from > 0.0_dp .or. options%to < huge(1.0_dp)) call fatal_error(error, status%invalid_argument, &
         "--from and --to need the rate, and "//table%name//" does not tell it: give --rate HZ or --dt S, or --time-column")
   end subroutine set_rate

   !> Lines of what is odd, and the warnings about it.
   subroutine tell(table, record)
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record
      character(13), parameter :: what(3) = [character(13) :: "equal stamp", "backward step", "gap"]
      integer(int64) :: count(3)
      integer :: k

      count = [record%audit%duplicates, record%audit%backward_steps, record%audit%gaps]
      do k = 1, 3
         if (record%audit%line_of_first(k) > 0) record%audit%line_of_first(k) = line_of(table%map, record%audit%line_of_first(k))
         if (count(k) > 0) call add_text(record%warnings, "the time column shows "//integer_text(count(k))//" "//trim(what(k))// &
            trim(merge("s", " ", count(k) > 1))//"; the first is in line "//integer_text(record%audit%line_of_first(k)))
      end do
      if (record%audit%jumps > 0) call add_text(record%warnings, "a jump of the time stamps is too long to be filled with "// &
         "missing samples; the parts before and after it are joined: analyse them apart with --from and --to")
      if (record%audit%beats > 0) call add_text(record%warnings, "the time stamps make a double step in "// &
         counted(record%audit%beats, "place")//", as those of a clock do that is too coarse for the rate, or of lost samples; "// &
         trim(merge("the stamps place the samples, as was asked             ", &
                    "the samples are taken as evenly spaced at the mean rate", placed(record))))
      call tell_odd(table, record)
      if (record%audit%jitter_max > 1.0_dp*record%sample_interval .and. record%rate_known .and. .not. placed(record)) then
         call add_text(record%warnings, "the time stamps are up to "//format_real(record%audit%jitter_max, 3)// &
                       " s away from an even grid; the samples are taken as evenly spaced at the mean rate")
      end if
      if (table%headings > 0) call add_text(record%warnings, counted(table%headings, "line")// &
         trim(merge(" repeats", " repeat ", table%headings == 1))//" the names of the columns, as in files that were put "// &
         "behind one another: left out; the first is line "//integer_text(table%first_heading))
      if (table%bad_lines > 0) call add_text(record%warnings, counted(table%bad_lines, "line")// &
         " could not be read and "//trim(merge("counts", "count ", table%bad_lines == 1))//" as missing; the first is line "// &
         integer_text(table%first_bad_line))
   end subroutine tell

   !> True where the stamps place the samples.
   pure logical function placed(record)
      type(record_type), intent(in) :: record

      placed = allocated(record%resample)
      if (placed) placed = record%resample /= "index"
   end function placed

   !> Repeated rows, bursts, a rate that changes.
   subroutine tell_odd(table, record)
      type(table_type), intent(in) :: table
      type(record_type), intent(inout) :: record

      associate (audit => record%audit)
         if (audit%line_of_repeat > 0) audit%line_of_repeat = line_of(table%map, audit%line_of_repeat)
         if (audit%line_of_burst > 0) audit%line_of_burst = line_of(table%map, audit%line_of_burst)
         if (audit%line_of_change > 0) audit%line_of_change = line_of(table%map, audit%line_of_change)
         if (audit%repeated > 0) call add_text(record%warnings, counted(audit%repeated, "row")//" with stamp and values of the "// &
            "row above: left out; the first is in line "//integer_text(audit%line_of_repeat))
         if (audit%bursts > 0) call add_text(record%warnings, "samples were delivered late and several at once in "// &
            counted(audit%bursts, "place")//", up to "//integer_text(audit%longest_burst)//" at once; the first is in line "// &
            integer_text(audit%line_of_burst))
         if (audit%rate_changes > 0) call add_text(record%warnings, "the rate changes from "//format_real(audit%rate_before, 6)// &
            " Hz to "//format_real(audit%rate_after, 6)//" Hz in line "//integer_text(audit%line_of_change)// &
            trim(merge(", the first of several changes", "                              ", audit%rate_changes > 1))// &
            "; analyse the parts apart with --from and --to")
      end associate
   end subroutine tell_odd

   !> "1 row", "2 rows".
   pure function counted(number, noun) result(text)
      integer(int64), intent(in) :: number
      character(*), intent(in) :: noun
      character(:), allocatable :: text

      text = integer_text(number)//" "//noun
      if (number /= 1) text = text//"s"
   end function counted

end module gyroakf_io_reader
