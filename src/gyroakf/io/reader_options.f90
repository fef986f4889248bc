! SPDX-License-Identifier: MIT
!> How a recording is to be read.
module gyroakf_io_reader_options
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite, ieee_is_nan
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_decimal, only : format_real
   use gyroakf_io_element, only : element_type, parse_element
   use gyroakf_io_header, only : largest_rate, smallest_rate
   use gyroakf_io_number, only : number, parse_number
   use gyroakf_spelling, only : lower
   use gyroakf_units, only : time_scale
   implicit none (type, external)
   private
   public :: reader_options, check_options

   !> How a recording is to be read
   type :: reader_options
      !> Hz; 0: from the time stamps or the header
      real(dp) :: rate_hz = 0.0_dp
      !> Of the scaled values: "deg/s", or one for each channel, "deg/s,g"; unallocated: from the
      !> header
      character(:), allocatable :: unit
      !> "rate" (also where unallocated), "increment" (angle per sample) or "angle"
      character(:), allocatable :: input
      !> Every value is multiplied by it
      real(dp) :: scale = 1.0_dp
      !> Columns by number (from 1) or name, as "2" or "gx,gy"; unallocated: all but the time column
      character(:), allocatable :: columns
      !> Number or name; "none" forbids; unallocated: found by its name
      character(:), allocatable :: time_column
      !> Of numbers in the time column: "s", "ms", "us", "ns", "min", "h", perhaps behind a whole
      !> number, as in "100us"; unallocated: by its name, else by its values
      character(:), allocatable :: time_unit
      !> COLUMN=VALUE: only these rows are read; unallocated: all rows
      character(:), allocatable :: where
      !> How samples get their place: "index" (also where unallocated) at the mean rate, lost ones
      !> filled in; "nearest" on the slot of the grid nearest to their stamp; "linear" interpolated
      character(:), allocatable :: resample
      !> Where angles wrap, in units of the file: a number, "auto" (or unallocated) or "none"
      character(:), allocatable :: wrap
      !> Every comma in the file is a decimal comma
      logical :: decimal_comma = .false.
      !> "auto" (also where unallocated), "text", "csv", "npy", or raw numbers: "f32", "f64", "i8",
      !> "i16", "i32", "i64", "u8", ..., with "be" behind it where they are big endian
      character(:), allocatable :: format
      !> Columns that are not analyzed are read for [[record_type:column]], too
      logical :: survey = .false.
      !> Lines that cannot be read count as missing samples instead of being an error
      logical :: bad_lines_missing = .false.
      !> The part from <= time < to is kept; s from the start
      real(dp) :: from = 0.0_dp, to = huge(1.0_dp)
      !> Lines of text, or bytes of raw numbers, that are left out at the start of the file
      integer(int64) :: skip = 0
      !> Raw numbers: interleaved columns; 0: not given, 1
      integer(int64) :: channels = 0
      !> Bytes that the process may use, 0 for no limit; and what the caller needs of them per
      !> sample, beside the record itself: for the channel that is worked on, and for every channel
      integer(int64) :: memory = 0, work_bytes = 0, channel_bytes = 0
      !> The same for `part_samples` of the channel that is worked on, or all if they are fewer
      integer(int64) :: part_bytes = 0, part_samples = 0
      !> `memory` is what the machine has left, not an option
      logical :: memory_found = .false.
      !> Where associated they are read instead of a file, whose path is a name for messages then
      integer(int8), pointer, contiguous :: bytes(:) => null()
   end type reader_options

contains

   !> Refuses options that make no sense, before the file is touched.
   subroutine check_options(options, error)
      type(reader_options), intent(in) :: options
      type(error_type), allocatable, intent(out) :: error
      type(element_type) :: element
      logical :: known
      integer :: found
      real(dp) :: modulus
      character(:), allocatable :: wrong

      if (allocated(options%wrap)) then
         call parse_number(options%wrap, modulus, found)
         known = any(options%wrap == ["auto", "none"]) .or. modulus > 0.0_dp
         if (.not. known .or. found == number%overflow) wrong = "angles cannot wrap at '"// &
            options%wrap//"'; known are auto, none and positive numbers"
      end if
      if (allocated(options%input)) then
         known = any(options%input == [character(9) :: "rate", "increment", "angle"])
         if (.not. known) wrong = "the input '"//options%input// &
            "' is not known; known are rate, increment, angle"
      end if
      if (allocated(options%time_unit)) then
         known = time_scale(lower(options%time_unit)) > 0.0_dp
         if (.not. known) wrong = "the unit of time '"//options%time_unit// &
            "' is not known; known are s, ms, us, ns, min, h and multiples such as 100us"
      end if
      if (allocated(options%where)) then
         if (index(options%where, "=") < 2) wrong = "'"//options%where//"' is no COLUMN=VALUE"
      end if
      if (options%channels < 0) wrong = "the number of channels must not be negative"
      if (options%skip < 0) wrong = "the number of lines to skip must not be negative"
      if (ieee_is_nan(options%from) .or. ieee_is_nan(options%to)) then
         wrong = "the part that is to be read has a limit that is not a number"
      else if (options%from < 0.0_dp .or. options%from >= options%to) then
         wrong = "the part from "//format_real(options%from, 6)//" s to "// &
            format_real(options%to, 6)//" s is empty"
      end if
      if (.not. ieee_is_finite(options%scale)) then
         wrong = "the scale has to be finite"
      else if (abs(options%scale) < tiny(1.0_dp)) then
         wrong = "the scale must not be 0"
      end if
      if (ieee_is_nan(options%rate_hz)) then
         wrong = "the rate is not a number"
      else if (options%rate_hz < 0.0_dp .or. options%rate_hz > largest_rate .or. &
               (options%rate_hz > 0.0_dp .and. options%rate_hz < smallest_rate)) then
         wrong = "the rate has to lie between 1e-30 and 1e30 Hz, and is "// &
            format_real(options%rate_hz, 6)//" Hz"
      end if
      if (allocated(wrong)) call fatal_error(error, status%invalid_argument, wrong)
      if (allocated(error)) return
      if (allocated(options%resample)) then
         known = any(options%resample == [character(7) :: "index", "nearest", "linear"])
         if (.not. known) wrong = "to resample by '"//options%resample// &
            "' is not supported; known are index, nearest, linear"
      end if
      if (allocated(options%format)) then
         call parse_element(options%format, element, known)
         known = known .or. any(options%format == [character(4) :: "auto", "text", "csv", "npy"])
         if (.not. known) wrong = "the format '"//options%format// &
            "' is not supported; known are auto, text, csv, npy, f32, "// &
            "f64, i8, i16, i32, i64, u8, u16, u32, with be for big endian"
      end if
      if (allocated(wrong)) call fatal_error(error, status%not_supported, wrong)
   end subroutine check_options

end module gyroakf_io_reader_options
