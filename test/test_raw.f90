! SPDX-License-Identifier: MIT
!> Raw numbers: words for types, interleaved columns, headers, lengths that do not fit; and the scan of what was read.
module test_raw
   use, intrinsic :: ieee_arithmetic, only : ieee_positive_inf, ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only : c_int, c_loc
   use expectations, only : failed => problem, test, error, check, went_wrong, check_refused
   use gyroakf_kinds, only : dp, int64, int8
   use gyroakf_error, only : status
   use gyroakf_io_element, only : element_name, element_type, element_word, parse_element
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_io_recording, only : close_recording, next_rows, open_recording, recording_type
   use gyroakf_stats_extremes, only : all_sound, scan_extremes
   use gyroakf_io_system, only : move_bytes
   use gyroakf_record, only : record_type
   use scratch_file, only : read_content, remove_file, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: suite_raw

contains

   subroutine suite_raw()
      call test("words", test_words)
      call test("doubles", test_doubles)
      call test("channels", test_channels)
      call test("name", test_name)
      call test("stored-integer", test_stored_integer)
      call test("refused", test_refused)
      call test("from-memory", test_memory)
      call test("refused-by-system", test_refused_by_system)
      call test("sound", test_sound)
      call test("extremes", test_extremes)
   end subroutine suite_raw

   !> Words of types and back; others are refused.
   subroutine test_words()
      character(6), parameter :: word(10) = [character(6) :: "f64", "f32be", "i8", "i16le", "u64be", "f16", "u8be", "i32", &
         "u32", "i64"]
      character(6), parameter :: full(10) = [character(6) :: "f64le", "f32be", "i8", "i16le", "u64be", "f16le", "u8", &
         "i32le", "u32le", &
                                            "i64le"]
      character(6), parameter :: wrong(8) = [character(6) :: "", "f8", "i12", "f64b", "be", "f128", "u16xe", "text"]
      type(element_type) :: element
      logical :: known
      integer :: i

      do i = 1, size(word)
         call parse_element(trim(word(i)), element, known)
         call check(error, known, trim(word(i)))
         call check(error, trim(element_word(element)), trim(full(i)))
      end do
      call check(error, element_name(element), "int64")
      do i = 1, size(wrong)
         call parse_element(trim(wrong(i)), element, known)
         call check(error, .not. known, trim(wrong(i)))
      end do
   end subroutine test_words

   !> More doubles than a block: the very bits come back, infinities and NaN as missing.
   subroutine test_doubles()
      integer, parameter :: n = 700001
      character(:), allocatable :: content
      real(dp), allocatable :: value(:)
      type(reader_options) :: options
      type(record_type) :: record
      integer :: i

      allocate (value(n))
      do i = 1, n
         value(i) = sin(real(i, dp))
      end do
      value(77) = ieee_value(1.0_dp, ieee_positive_inf)
      value(n) = ieee_value(1.0_dp, ieee_quiet_nan)
      allocate (character(8*n) :: content)
      content(:) = transfer(value, content)
      options%format = merge("f64le", "f64be", transfer(1, "a") == achar(1))
      call read_content(content, "x.dat", options, record, failed)
      if (went_wrong(failed)) return
      call check(error, record%audit%missing, 2_int64)
      value([77, n]) = 0.0_dp
      call check(error, all(abs(record%value(:, 1) - value) <= 0.0_dp))
      call check(error, record%format, options%format)
   end subroutine test_doubles

   !> Interleaved big endian integers behind a header, with the time in the first column.
   subroutine test_channels()
      type(reader_options) :: options
      type(record_type) :: record
      character(:), allocatable :: content
      integer :: i

      content = "head"
      do i = 1, 300
         content = content//achar(i/256)//achar(modulo(i, 256))//achar(255)//achar(256 - modulo(i, 50) - 1)//achar(1)//achar(0)
      end do
      options%format = "i16be"
      options%channels = 3
      options%skip = 4
      options%time_column = "1"
      options%columns = "3,2"
      call read_content(content, "x.dat", options, record, failed)
      if (went_wrong(failed)) return
      call check(error, all(nint(record%value(:, 1)) == 256) .and. all(nint(record%value(:, 2)) == [(-modulo(i, 50) - 1, &
         i=1, 300)]))
      call check(error, record%rate_source, "timestamps")
   end subroutine test_channels

   !> Without a format the end of the name counts, with a warning; text stays text.
   subroutine test_name()
      type(record_type) :: record

      call read_content(achar(1)//achar(0)//achar(3)//achar(0), "x.i16", reader_options(), record, &
         & failed)
      if (went_wrong(failed)) return
      call check(error, all(nint(record%value(:, 1)) == [1, 3]) .and. record%format == "i16le")
      call check(error, index(record%warnings(1)%text, "as the name .i16 says") > 0)
      call read_content("1"//new_line("a")//"3"//new_line("a"), "x.i16", reader_options(), record, &
         & failed)
      if (went_wrong(failed)) return
      call check(error, all(nint(record%value(:, 1)) == [1, 3]) .and. record%format == "text")
   end subroutine test_name

   !> The table tells the integer type that is stored.
   subroutine test_stored_integer()
      character(3), parameter :: word(4) = ["u16", "i32", "f32", "i8 "]
      integer, parameter :: bits(4) = [16, 32, 0, 8]
      type(recording_type) :: recording
      type(reader_options) :: options
      integer :: k

      call write_bytes(scratch_path("x.dat"), "12345678")
      do k = 1, 4
         options%format = trim(word(k))
         call open_recording(scratch_path("x.dat"), options, recording, failed)
         if (went_wrong(failed)) return
         call check(error, &
            recording%table%integer_bits == bits(k))
         call next_rows(recording, 1_int64, failed)
         call check(error, .not. allocated(failed) .and. recording%table%whole)
         call close_recording(recording)
         if (allocated(error)) return
      end do
      call remove_file(scratch_path("x.dat"))
   end subroutine test_stored_integer

   !> Lengths that do not fit, options that do not apply.
   subroutine test_refused()
      type(reader_options) :: options

      options%format = "f32"
      call expect("123456789", options, status%parse, "byte 8: 1 bytes are left after 2 rows of 4 bytes (1 x float32)")
      options%channels = 2
      call expect("1234", options, status%parse, "byte 0: 4 bytes are left after 0 rows of 8 bytes")
      options%skip = 4
      call expect("1234", options, status%parse, "`skip` leaves nothing")
      options%skip = 0
      options%channels = huge(1_int64)
      call expect("1234", options, status%parse, "columns are not from 1 to 65536")
      options = reader_options()
      call expect("1"//achar(0)//"2"//achar(1), options, status%parse, "`format` f64, f32")
      options%channels = 2
      call expect("1 2", options, status%invalid_argument, "`channels` is for raw numbers")
   end subroutine test_refused

   !> A file that has to be refused.
   subroutine expect(content, options, code, fragment)
      character(*), intent(in) :: content, fragment
      type(reader_options), intent(in) :: options
      integer, intent(in) :: code
      type(record_type) :: record

      call read_content(content, "x.dat", options, record, failed)
      call check_refused(failed, code)
      call check(error, index(failed%message, fragment) > 0, failed%message)
   end subroutine expect

   !> Bytes in memory instead of a file.
   subroutine test_memory()
      type(reader_options) :: options
      type(record_type) :: record
      integer(int8), target :: bytes(4)

      bytes = int([1, 0, 3, 0], int8)
      options%bytes => bytes
      options%format = "u16"
      call read_record("(memory)", options, record, failed)
      if (went_wrong(failed)) return
      call check(error, all(nint(record%value(:, 1)) == [1, 3]))
   end subroutine test_memory

   !> NaN, infinities and large values anywhere are seen.
   subroutine test_sound()
      integer, parameter :: n = 600001
      integer, parameter :: place(5) = [1, 2, 65537, 65536*3, n]
      real(dp), allocatable :: x(:)
      integer :: k

      allocate (x(n))
      x = -1.0_dp
      call check(error, all_sound(x, 1.0_dp) .and. .not. all_sound(x, 0.999_dp) .and. all_sound(x(:0), 0.0_dp))
      do k = 1, size(place)
         x(place(k)) = ieee_value(1.0_dp, ieee_quiet_nan)
         call check(error, .not. all_sound(x, huge(1.0_dp)))
         x(place(k)) = -ieee_value(1.0_dp, ieee_positive_inf)
         call check(error, .not. all_sound(x, huge(1.0_dp)))
         x(place(k)) = 0.0_dp
      end do
   end subroutine test_sound

   !> Extremes and step against the plain loop, for lengths about those of lanes and blocks.
   subroutine test_extremes()
      integer, parameter :: length(14) = [1, 2, 7, 8, 9, 10, 16, 17, 65535, 65536, 65537, 65545, 131072, 600001]
      real(dp), allocatable :: x(:)
      real(dp) :: low, high, step, expected, change
      integer :: k, i

      do k = 1, size(length)
         allocate (x(length(k)))
         x(:) = [(real(modulo(modulo(i, 1009)*856, 1009)*3, dp), i=1, length(k))]
         expected = huge(expected)
         do i = 2, length(k)
            change = abs(x(i) - x(i - 1))
            if (change > 0.0_dp) expected = min(expected, change)
         end do
         if (length(k) == 1) expected = 0.0_dp
         call scan_extremes(x, low, high, step)
         call check(error, abs(low - minval(x)) + abs(high - maxval(x)) + abs(step - expected) <= 0.0_dp)
         deallocate (x)
      end do
   end subroutine test_extremes

   !> A descriptor that is none: the system refuses, which is no end of a file.
   subroutine test_refused_by_system()
      real(dp), target :: buffer(4)
      integer(int64) :: got
      logical :: failed

      call move_bytes(-1_c_int, c_loc(buffer), 32_int64, got, failed, 0_int64)
      call check(error, failed .and. got == 0)
   end subroutine test_refused_by_system

end module test_raw
