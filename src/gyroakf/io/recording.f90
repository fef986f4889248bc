! SPDX-License-Identifier: MIT
!> A recording that is open: what stands above its rows is known, the rows are read as far as the memory allows.
module gyroakf_io_recording
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_lines, only : close_lines, lines_type
   use gyroakf_io_place, only : integer_text
   use gyroakf_io_store, only : count_rows
   use gyroakf_io_table, only : begin_table, table_options, table_type
   use gyroakf_io_text_rows, only : read_rows
   implicit none (type, external)
   private
   public :: reader_options, recording_type, open_recording, next_rows, hold_rows, close_recording
   public :: bytes_needed, bytes_text, too_large, memory_advice, base_bytes

   !> How a recording is to be read
   type :: reader_options
      !> Hz; 0: from the time stamps or the header
      real(dp) :: rate_hz = 0.0_dp
      !> Of the values after `scale`: "deg/s" for all channels, or one for each, separated by commas; unallocated: from the
      !> header, or unknown
      character(:), allocatable :: unit
      !> "rate" (also where unallocated), "increment" (angle per sample) or "angle"
      character(:), allocatable :: input
      !> Every value is multiplied by it
      real(dp) :: scale = 1.0_dp
      !> Columns by number (from 1, all columns count) or name, as "2" or "gx,gy"; unallocated: all but the time column
      character(:), allocatable :: columns
      !> Number or name; "none" forbids; unallocated: found by its name
      character(:), allocatable :: time_column
      !> How samples get their place: "index" (also where unallocated), "nearest" or "linear"
      character(:), allocatable :: resample
      !> Where angles wrap, in units of the file: a number, "auto" (also where unallocated) or "none"
      character(:), allocatable :: wrap
      !> Every comma in the file is a decimal comma
      logical :: decimal_comma = .false.
      !> "auto" (also where unallocated), "text" or "csv"
      character(:), allocatable :: format
      !> Lines that cannot be read count as missing samples instead of being an error
      logical :: bad_lines_missing = .false.
      !> The part from <= time < to is kept; s from the start
      real(dp) :: from = 0.0_dp, to = huge(1.0_dp)
      !> Lines that are left out at the start of the file
      integer(int64) :: skip = 0
      !> Bytes that the process may use, 0 for no limit; and what the caller needs of them per sample, beside the record itself:
      !> for the channel that is worked on, and for every channel
      integer(int64) :: memory = 0, work_bytes = 0, channel_bytes = 0
      !> `memory` is what the machine has left, nobody gave it
      logical :: memory_found = .false.
      !> Where associated they are read instead of a file, and the path is a name for messages; they have to stay until the end
      integer(int8), pointer, contiguous :: bytes(:) => null()
   end type reader_options

   !> An open recording
   type :: recording_type
      character(:), allocatable :: path
      !> What it turned out to be, as in "text"
      character(:), allocatable :: format
      type(reader_options) :: options
      type(table_options) :: wanted
      type(lines_type) :: lines
      type(table_type) :: table
      !> Rows that its size suggests, 0 where that is not known (standard input, a FIFO)
      integer(int64) :: expected_rows = 0
   end type recording_type

   !> The program itself, its libraries and buffers
   integer(int64), parameter :: base_bytes = 24000000
   !> The record: 8 bytes a value, 1 for its mark where something is missing
   integer(int64), parameter :: value_bytes = 9, stamp_bytes = 8
   !> Values that are read before the progress is told again
   integer(int64), parameter :: slice_values = 1048576

contains

   !> Opens a recording and reads what stands above its rows.
   subroutine open_recording(path, options, recording, error)
      !> A path; "-" is standard input
      character(*), intent(in) :: path
      !> How
      type(reader_options), intent(in) :: options
      !> To be closed by [[close_recording]], after a failure too
      type(recording_type), intent(out) :: recording
      !> Allocated on failure: io, parse, invalid_argument, not_supported, no_memory
      type(error_type), allocatable, intent(out) :: error

      call check_options(options, error)
      if (allocated(error)) return
      recording%path = path
      recording%format = "text"
      recording%options = options
      if (allocated(options%columns)) recording%wanted%columns = options%columns
      if (allocated(options%time_column)) recording%wanted%time_column = options%time_column
      recording%wanted%bad_lines_missing = options%bad_lines_missing
      recording%wanted%skip = options%skip
      recording%wanted%decimal_comma = options%decimal_comma
      recording%wanted%bytes => options%bytes
      call begin_table(recording%lines, path, recording%wanted, recording%table, error)
      if (.not. allocated(error)) recording%expected_rows = rows_by_size(recording%lines)
   end subroutine open_recording

   !> Reads all rows, or as many as the memory allows: `table%whole` tells. None where the file's size alone forbids it.
   subroutine hold_rows(recording, error, progress)
      !> Open
      type(recording_type), intent(inout) :: recording
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: most

      most = huge(most)
      if (recording%options%memory > 0) then
         most = max(0_int64, recording%options%memory - base_bytes)/(bytes_needed(recording, 1_int64) - base_bytes)
         if (recording%expected_rows > most) return
         most = most + 1
      end if
      call next_rows(recording, most, error, progress)
   end subroutine hold_rows

   !> Reads rows into `table%store` until it has as many as wanted, or a few more, or there are no more: `table%whole` tells.
   !>
   !> The one place that reads rows, whatever the format.
   subroutine next_rows(recording, most, error, progress)
      !> Open; its store grows, and may be emptied between calls
      type(recording_type), intent(inout) :: recording
      !> So many rows in the store are enough
      integer(int64), intent(in) :: most
      !> Allocated on failure: io, parse, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: so_far, slice

      slice = most
      if (present(progress)) slice = max(1_int64, slice_values/max(1, recording%table%layout%stored))
      do
         call tell_progress("reading", recording%lines%source%delivered, recording%lines%source%length, error, progress)
         if (allocated(error)) return
         so_far = count_rows(recording%table%store)
         call read_rows(recording%lines, recording%wanted, so_far + min(most - so_far, slice), recording%table, error)
         if (allocated(error)) return
         if (recording%table%whole .or. count_rows(recording%table%store) >= most) return
      end do
   end subroutine next_rows

   !> Closes the file.
   subroutine close_recording(recording)
      !> Its rows stay
      type(recording_type), intent(inout) :: recording

      call close_lines(recording%lines)
   end subroutine close_recording

   !> Rows of a regular file from the length of its first lines, 0 where the size is not known.
   pure integer(int64) function rows_by_size(lines) result(rows)
      type(lines_type), intent(in) :: lines
      integer(int64) :: count_lines

      rows = 0
      if (lines%source%length <= 0 .or. lines%last < lines%at) return
      count_lines = count(lines%bytes(lines%at:lines%last) == 10, kind=int64)
      rows = int(real(lines%source%length, dp)*real(count_lines, dp)/real(lines%last - lines%at + 1, dp), int64)
   end function rows_by_size

   !> Bytes that the process needs to hold so many rows and work on them.
   pure integer(int64) function bytes_needed(recording, rows) result(bytes)
      !> Its columns are known
      type(recording_type), intent(in) :: recording
      !> How many
      integer(int64), intent(in) :: rows
      integer(int64) :: row_bytes

      associate (options => recording%options)
         row_bytes = size(recording%table%chosen)*(value_bytes + options%channel_bytes) &
                   + max(options%work_bytes, merge(stamp_bytes, 0_int64, recording%table%time > 0))
      end associate
      bytes = huge(bytes)
      if (rows < (huge(bytes) - base_bytes)/row_bytes) bytes = base_bytes + rows*row_bytes
   end function bytes_needed

   !> "FILE: about 12000000 rows need 276 MB (276000000 bytes), --memory allows 100 MB".
   function too_large(recording) result(text)
      !> Not whole
      type(recording_type), intent(in) :: recording
      character(:), allocatable :: text
      integer(int64) :: rows

      rows = max(recording%expected_rows, recording%table%rows)
      if (rows > recording%table%rows) then
         text = "about "//integer_text(rows)//" rows need "
      else
         text = "more than "//integer_text(rows)//" rows need more than "
      end if
      text = recording%table%name//": "//text//bytes_text(bytes_needed(recording, rows))//" ("// &
             integer_text(bytes_needed(recording, rows))//" bytes), "
      if (recording%options%memory_found) then
         text = text//bytes_text(recording%options%memory)//" of memory can be had"
      else
         text = text//"--memory allows "//bytes_text(recording%options%memory)
      end if
   end function too_large

   !> What to do about it, for a command that needs the whole record.
   function memory_advice(recording) result(text)
      !> Not whole
      type(recording_type), intent(in) :: recording
      character(:), allocatable :: text

      text = "give more memory"
      if (recording%options%memory_found) text = "use a machine with more memory, or insist with --memory SIZE"
      if (size(recording%table%chosen) > 1) text = text//"; take one channel at a time with --column"
      text = text//"; gyroakf allan, inspect and filter stream a recording of any length"
   end function memory_advice

   !> "276 MB".
   pure function bytes_text(bytes) result(text)
      !> How many
      integer(int64), intent(in) :: bytes
      character(:), allocatable :: text

      if (bytes >= 1000000000_int64) then
         text = format_real(real(bytes, dp)*1.0e-9_dp, 3)//" GB"
      else
         text = format_real(real(bytes, dp)*1.0e-6_dp, 3)//" MB"
      end if
   end function bytes_text

   !> Refuses options that make no sense, before the file is touched.
   subroutine check_options(options, error)
      type(reader_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      logical :: known

      if (ieee_is_nan(options%rate_hz)) then
         call fatal_error(error, status%invalid_argument, "the rate is not a number")
      else if (options%rate_hz < 0.0_dp .or. .not. ieee_is_finite(options%rate_hz)) then
         call fatal_error(error, status%invalid_argument, "the rate has to be positive, not "// &
                          format_real(options%rate_hz, 6)//" Hz")
      else if (.not. ieee_is_finite(options%scale)) then
         call fatal_error(error, status%invalid_argument, "the scale has to be finite")
      else if (abs(options%scale) < tiny(1.0_dp)) then
         call fatal_error(error, status%invalid_argument, "the scale must not be 0")
      else if (ieee_is_nan(options%from) .or. ieee_is_nan(options%to)) then
         call fatal_error(error, status%invalid_argument, "the part that is to be read has a limit that is not a number")
      else if (options%from < 0.0_dp .or. options%from >= options%to) then
         call fatal_error(error, status%invalid_argument, "the part from "//format_real(options%from, 6)//" s to "// &
                          format_real(options%to, 6)//" s is empty")
      else if (options%skip < 0) then
         call fatal_error(error, status%invalid_argument, "the number of lines to skip must not be negative")
      end if
      if (allocated(error)) return
      if (allocated(options%format)) then
         known = any(options%format == [character(4) :: "auto", "text", "csv"])
         if (.not. known) call fatal_error(error, status%not_supported, "the format '"//options%format// &
                                           "' is not supported; known are auto, text, csv")
      end if
      if (allocated(error)) return
      if (allocated(options%input)) then
         known = any(options%input == [character(9) :: "rate", "increment", "angle"])
         if (.not. known) call fatal_error(error, status%invalid_argument, "the input '"//options%input// &
                                           "' is not known; known are rate, increment, angle")
      end if
   end subroutine check_options

end module gyroakf_io_recording
