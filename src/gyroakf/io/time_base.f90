! SPDX-License-Identifier: MIT
!> The place of every sample in time: stamps in seconds, the span that is asked for, the audit, gaps or a grid.
module gyroakf_io_time_base
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_audit, only : audit_stamps, gap_type
   use gyroakf_io_clock, only : find_scale, is_clock
   use gyroakf_io_columns, only : label_of
   use gyroakf_io_left_out_rows, only : leave_rows_out, place_with
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_reader_options, only : reader_options
   use gyroakf_io_resample, only : resample
   use gyroakf_io_shape, only : fill_gaps, find_span, wrap_of
   use gyroakf_io_stamps, only : unwrap_days
   use gyroakf_io_table, only : table_type
   use gyroakf_record, only : add_text, audit_type, record_type
   implicit none (type, external)
   private
   public :: use_stamps, place_samples

contains

   !> Turns the stamps into seconds from the first, keeps the rows that are asked for and audits them.
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
      real(dp) :: scale, origin, before, given
      integer(int64) :: rows, first
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
      rows = size(stamps, kind=int64)
      call leave_rows_out(stamps, record%value, record%audit, dropped, error)
      if (allocated(error)) return
      if (size(stamps) == 0) call add_text(record%warnings, label_of(table%names, table%time)//" holds no time in "// &
         integer_text(record%audit%untimed)//" of "//integer_text(rows)//" rows and is not used: --rate HZ gives the sample rate")
      given = merge(options%rate_hz, table%header%rate_hz, options%rate_hz > 0.0_dp)
      call keep_span(options, given, stamps, record%value, first, error)
      if (allocated(error)) return
      call audit_stamps(stamps, record%audit, gaps, given)
      associate (audit => record%audit)
         audit%line_of_first(1) = place_with(dropped, audit%line_of_first(1), first)
         audit%line_of_first(2) = place_with(dropped, audit%line_of_first(2), first)
         audit%line_of_first(3) = place_with(dropped, audit%line_of_first(3), first)
         audit%line_of_rollover = place_with(dropped, audit%line_of_rollover, first)
         audit%line_of_burst = place_with(dropped, audit%line_of_burst, first)
         audit%line_of_change = place_with(dropped, audit%line_of_change, first)
      end associate
   end subroutine use_stamps

   !> Keeps the rows of the span that is asked for, so that what is found is found in it.
   subroutine keep_span(options, given, stamps, value, first, error)
      type(reader_options), intent(in) :: options
      !> Sample rate that was given, Hz, 0 for none
      real(dp), intent(in) :: given
      real(dp), allocatable, intent(inout) :: stamps(:), value(:, :)
      !> The row of all that the first kept one is
      integer(int64), intent(out) :: first
      !> no_memory, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      type(audit_type) :: audit
      type(gap_type) :: gaps
      real(dp), allocatable :: t(:)
      real(dp) :: interval
      integer(int64) :: i, at, last, samples
      integer(int64) :: span(2)
      integer :: next, failed

      first = 1
      if (size(stamps) == 0 .or. .not. has_span(options)) return
      allocate (t(size(stamps)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the time stamps of a part of the record")
         return
      end if
      t(:) = stamps
      call audit_stamps(t, audit, gaps, given)
      if (audit%stamp_rate <= 0.0_dp) return
      interval = 1.0_dp/audit%stamp_rate
      if (options%rate_hz > 0.0_dp) interval = 1.0_dp/options%rate_hz
      samples = size(t, kind=int64) + sum(gaps%length(:gaps%count))
      call find_span(samples, interval, options%from, options%to, span, error)
      if (allocated(error)) return
      if (allocated(options%input)) then
         if (options%input == "angle") span(2) = span(2) + 1
      end if
      first = 0
      last = 0
      at = 0
      next = 1
      do i = 1, size(t, kind=int64)
         at = at + 1
         if (next <= gaps%count) then
            if (gaps%before(next) == i) then
               at = at + gaps%length(next)
               next = next + 1
            end if
         end if
         if (at > span(2)) exit
         if (at >= span(1) .and. first == 0) first = i
         last = i
      end do
      if (first == 0 .or. last < first) then
         call fatal_error(error, status%too_few_samples, "no sample lies between --from and --to")
         return
      end if
      stamps = stamps(first:last) - stamps(first)
      value = value(first:last, :)
   end subroutine keep_span

   !> True where a part of the record is asked for.
   pure logical function has_span(options)
      type(reader_options), intent(in) :: options

      has_span = options%from > 0.0_dp .or. options%to < huge(1.0_dp)
   end function has_span

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
      character(:), allocatable :: way
      real(dp) :: wrap

      way = "index"
      if (allocated(options%resample)) way = options%resample
      record%resample = way
      if (way == "index") then
         call fill_gaps(gaps, record, error)
         return
      end if
      call check_resample(options, table, record, error)
      if (allocated(error)) return
      wrap = 0.0_dp
      if (allocated(options%input)) then
         if (options%input == "angle") wrap = wrap_of(options, table)
      end if
      call resample(stamps, way, wrap, record, error)
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

end module gyroakf_io_time_base
