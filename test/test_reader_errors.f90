! SPDX-License-Identifier: MIT
!> What the reader refuses: code, place and words of every message.
module test_reader_errors
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_loc, c_null_ptr, c_ptr
   use expectations, only : failed => problem, test, error, check, went_wrong
   use gyroakf_kinds, only : dp, int64, int8
   use gyroakf_error, only : status
   use gyroakf_io_gzip, only : inflate_bytes, inflate_end, inflater_type
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_record, only : record_type
   use scratch_file, only : read_content, scratch_path
   implicit none (type, external)
   private
   public :: suite_reader_errors

   character(1), parameter :: nl = new_line("a")
   !> Two rows of two numbers, compressed by gzip
   integer, parameter :: packed_bytes(28) = [31, 139, 8, 0, 0, 0, 0, 0, 2, 3, 51, 84, 48, 226, 50, 86, 48, 225, 2, 0, 87, 0, 214, &
      97, 8, 0, 0, 0]
   character(*), parameter :: mend = "mend the line"

contains

   subroutine suite_reader_errors()
      call test("whole-message", test_whole_message)
      call test("bad-tokens", test_tokens)
      call test("number-of-columns", test_columns)
      call test("no-numbers", test_no_numbers)
      call test("no-text", test_no_text)
      call test("gzip", test_gzip)
      call test("gzip-large-buffer", test_gzip_buffer)
      call test("gzip-no-memory", test_gzip_memory)
      call test("decimal-commas", test_commas)
      call test("files", test_files)
      call test("unknown-columns", test_unknown_columns)
      call test("options", test_options)
      call test("options-and-file", test_options_file)
      call test("place-in-later-block", test_later_block)
   end subroutine suite_reader_errors

   !> The message for a content, without the path; "accepted" where there is none.
   function message(content, options, code) result(text)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      integer, intent(out) :: code
      character(:), allocatable :: text
      character(:), allocatable :: path
      type(record_type) :: record

      call read_content(content, "errors.txt", options, record, failed)
      text = "accepted"
      code = status%ok
      if (.not. allocated(failed)) return
      code = failed%code
      text = failed%message
      path = scratch_path("errors.txt")
      if (index(text, path) == 1) text = text(len(path) + 1:)
   end function message

   !> Checks that a content is refused with a message that begins so.
   subroutine expect(content, code, start)
      character(*), intent(in) :: content, start
      integer, intent(in) :: code
      character(:), allocatable :: text
      integer :: got

      text = message(content, reader_options(), got)
      call check(error, got, code, more=text)
      call check(error, text(:min(len(text), len(start))), start)
   end subroutine expect

   subroutine test_whole_message()
      call expect("# c"//nl//"1.5 2"//nl//"-1 x7,"//nl, status%parse, ":3:4: 'x7' is not a number"//nl//"-1 x7,"//nl// &
                  "   ^"//nl//mend)
   end subroutine test_whole_message

   subroutine test_tokens()
      character(12), parameter :: row(10) = [character(12) :: "1.5.2", "1e", "0x10", "--1", "1_000", "12:30:00", "1e999", &
         "-1e400", '"3', "nano"]
      character(40), parameter :: what(10) = [character(40) :: "'1.5.2' is not a number", "'1e' is not a number", &
         "'0x10' is not a number", "'--1' is not a number", "'1_000' is not a number", "'12:30:00' is not a number", &
         "the number '1e999' is too large", "the number '-1e400' is too large", "a quote that is not closed", &
         "'nano' is not a number"]
      integer :: i

      do i = 1, size(row)
         call expect("1"//nl//" "//trim(row(i))//nl, status%parse, ":2:2: "//trim(what(i)))
      end do
      call expect("1"//nl//char(194)//char(176)//nl, status%parse, ":2:1: '"//char(194)//char(176)//"' is not a number")
      call expect("1 2"//nl//char(195)//char(164)//" y"//nl, status%parse, ":2:1: ")
      call expect("1.O5"//nl//"2"//nl, status%parse, ":1:1: '1.O5' is not a number")
      call expect("1"//nl//repeat("y", 3000)//nl, status%parse, ":2:1: '"//repeat("y", 37)//"...' is not a number"//nl// &
                  repeat("y", 96)//"..."//nl//"^"//nl)
   end subroutine test_tokens

   subroutine test_columns()
      call expect("1 2"//nl//"3 4 5"//nl, status%parse, &
                  ":2:5: 3 columns where the rows above have 2"//nl//"3 4 5"//nl//"    ^")
      call expect("1,2"//nl//"3"//nl, status%parse, ":2:2: 1 column where the rows above have 2")
      call expect("1;2"//nl//"3;4;5;"//nl, status%parse, ":2:5: 4 columns where the rows above have 2")
      call expect("gx gy"//nl//"1 2 3"//nl, status%parse, ":2:4: 3 columns where line 1 has 2 names")
      call expect("1 2"//nl//"3 # 4"//nl, status%parse, ":2:6: 1 column")
      call expect("1 2"//nl//nl//nl//"3"//nl, status%parse, ":4:2: 1 column")
   end subroutine test_columns

   subroutine test_no_numbers()
      call expect("", status%parse, ":1:1: the file is empty")
      call expect(nl//nl, status%parse, ":2:1: the file holds no line of numbers")
      call expect("# a"//nl//"# b"//nl//"gx"//nl, status%parse, ":3:1: the file holds no line of numbers")
      call expect("# a"//nl//"nan"//nl//"NA"//nl, status%parse, ":2:1: column 1 holds no number")
      call expect("nan,nan"//nl//",,"//nl, status%parse, ":1:1: no column holds a number")
      call expect("t"//nl//"1"//nl//"2"//nl, status%parse, ":1:1: there is no column besides the time in column 't'")
      call expect("gx"//nl//"2"//nl//"gy"//nl//"2"//nl, status%parse, ":3:1: 'gy' is not a number")
   end subroutine test_no_numbers

   subroutine test_no_text()
      call expect("1"//nl//"2"//achar(0)//nl, status%parse, ":2:1: the content is not text but text with 1 NUL")
      call expect(char(255)//char(254)//"1"//achar(0), status%parse, ":1:1: the content is not text but text in UTF-16")
      call expect("BZh91AY", status%parse, ":1:1: the content is not text but compressed by bzip2")
      call expect(char(147)//"NUMPY"//achar(1), status%parse, ": byte 7: the file ends within the header of NumPy's format")
      call expect("PK"//achar(3)//achar(4), status%parse, ":1:1: the content is not text but a zip archive")
   end subroutine test_no_text

   !> gzip data in memory that are whole; in a file that are cut off, damaged, or followed by something else.
   subroutine test_gzip()
      character(*), parameter :: early = ": the compressed data end early after "
      character(*), parameter :: damaged = ": the compressed data are damaged after "
      character(size(packed_bytes)) :: packed_rows, other
      integer(int8), target :: bytes(size(packed_bytes))
      type(reader_options) :: options
      type(record_type) :: record
      integer :: kept

      packed_rows = transfer(achar(packed_bytes), packed_rows)
      bytes = transfer(packed_rows, bytes)
      options%bytes => bytes
      call read_record("memory", options, record, failed)
      if (went_wrong(failed, "refused")) return
      call check(error, all(nint(record%value) == reshape([1, 3, 2, 4], [2, 2])), "values")
      do kept = 4, len(packed_rows) - 1
         call expect(packed_rows(:kept), status%parse, early)
      end do
      call expect(packed_rows//packed_rows(:20), status%parse, early)
      other = packed_rows
      other(len(other) - 7:len(other) - 7) = "x"
      call expect(other, status%parse, damaged//"8 decompressed bytes"//nl//"copy the file again; gzip -t tests it")
      call expect(packed_rows//"1 2"//nl, status%parse, damaged//"8 decompressed bytes"//nl)
   end subroutine test_gzip

   !> Decompresses the rows into a buffer.
   subroutine inflate_rows(inflater, buffer, got, code, problem)
      type(inflater_type), intent(inout) :: inflater
      integer(int8), intent(inout), contiguous, target :: buffer(:)
      integer(int64), intent(out) :: got
      integer, intent(out) :: code
      character(*), intent(out) :: problem
      logical :: whole

      inflater%input = transfer(achar(packed_bytes), 0_int8, size(packed_bytes))
      call inflate_bytes(inflater, size(packed_bytes, kind=int64), buffer, got, whole, code, &
         & problem)
   end subroutine inflate_rows

   !> A buffer of more than 32 bits count: only the bytes that are written have a place in memory.
   subroutine test_gzip_buffer()
      type(inflater_type), target :: inflater
      integer(int8), target :: written(32)
      integer(int8), pointer, contiguous :: buffer(:)
      character(80) :: problem
      integer(int64) :: got
      integer(c_int) :: ended
      integer :: code

      call c_f_pointer(c_loc(written), buffer, [2_int64**32])
      call inflate_rows(inflater, buffer, got, code, problem)
      ended = inflate_end(inflater%stream)
      call check(error, ended, 0)
      call check(error, got == 8 .and. code == status%ok, trim(problem))
   end subroutine test_gzip_buffer

   !> Where zlib gets no memory.
   subroutine test_gzip_memory()
      type(inflater_type), target :: inflater
      integer(int8) :: buffer(32)
      character(80) :: problem
      integer(int64) :: got
      integer :: code

      inflater%stream%allocate = c_funloc(no_memory)
      call inflate_rows(inflater, buffer, got, code, problem)
      call check(error, code, status%no_memory, trim(problem))
   end subroutine test_gzip_memory

   !> Never has memory for zlib.
   type(c_ptr) function no_memory(opaque, items, bytes) bind(C)
      type(c_ptr), intent(in), value :: opaque
      integer(c_int), intent(in), value :: items, bytes

      no_memory = c_null_ptr
      if (items < 0 .and. bytes < 0) no_memory = opaque
   end function no_memory

   subroutine test_commas()
      call expect("a;b;c"//nl//"1,5;2,3"//nl, status%parse, ":2:2: this looks like a decimal comma")
      call expect("t;gx"//nl//"0;2"//nl//"1;2,5;"//nl//"1 2,5;3"//nl, status%parse, ":3:4: ")
      call expect("1,5"//nl//"2,25"//nl//"0,05"//nl, status%parse, ":3:2: this looks like a decimal comma")
      call expect("1,5"//nl//"2,25"//nl//"gx"//nl, status%parse, ":3:3: 1 column")
   end subroutine test_commas

   subroutine test_files()
      type(record_type) :: record

      call read_record("/nonexistent/a.txt", reader_options(), record, failed)
      call check(error, failed%code, status%io)
      call check(error, failed%message, "/nonexistent/a.txt: no such file"//nl//"check the path; - reads standard input")
      call read_record("/tmp", reader_options(), record, failed)
      call check(error, failed%code, status%io)
      call check(error, failed%message, "/tmp: is a directory"//nl//"give the file in it that holds the record")
   end subroutine test_files

   subroutine test_unknown_columns()
      type(reader_options) :: options
      character(*), parameter :: named = "t gx gy gz"//nl//"0 1 2 3"//nl//"1 2 3 4"//nl
      character(8), parameter :: asked(5) = [character(8) :: "gxx", "foo", "5", "0", "gx,2"]
      character(80), parameter :: expected(5) = [character(80) :: &
         "there is no column 'gxx', perhaps 'gx'; the file has 't' 'gx' 'gy' 'gz'", &
         "there is no column 'foo'; the file has 't' 'gx' 'gy' 'gz'", "there is no column 5: the file has columns 1 to 4", &
         "there is no column 0: the file has columns 1 to 4", "the column '2' is chosen twice"]
      integer :: i, code

      do i = 1, size(asked)
         options%columns = trim(asked(i))
         call check(error, message(named, options, code), trim(expected(i)))
         call check(error, code, status%invalid_argument)
      end do
      options%columns = "gx"
      call check(error, message("1 2"//nl, options, code), &
                 "there is no column 'gx': the file does not name its columns; give numbers, counted from 1")
   end subroutine test_unknown_columns

   !> Options that are wrong whatever the file holds.
   subroutine test_options()
      type(reader_options) :: options
      integer :: code

      call check(error, message("1", reader_options(rate_hz=-5.0_dp), code), &
                 "the rate has to lie between 1e-30 and 1e30 Hz, and is -5 Hz")
      call check(error, message("gx"//nl//"1"//nl//"-2e99", reader_options(), code), &
                 "sample 2 of 'gx' is -2e+99; at most 1e+60 can be analyzed")
      call check(error, message("1", reader_options(scale=0.0_dp), code), "the scale must not be 0")
      call check(error, message("1", reader_options(from=2.0_dp, to=1.0_dp), code), "the part from 2 s to 1 s is empty")
      options%format = "nyp"
      call check(error, message("1", options, code), "the format 'nyp' is not supported; known are auto, text, csv, npy, "// &
                 "f32, f64, i8, i16, i32, i64, u8, u16, u32, with be for big endian")
      call check(error, code, status%not_supported)
      options = reader_options()
      options%input = "delta"
      call check(error, message("1", options, code), "the input 'delta' is not known; known are rate, increment, angle")
      options = reader_options()
      options%unit = "deg/ss"
      call check(error, index(message("1", options, code), "unknown unit 'deg/ss', perhaps deg/s;"), 1)
   end subroutine test_options

   !> Options that do not fit the file or each other.
   subroutine test_options_file()
      type(reader_options) :: options
      integer :: code
      character(:), allocatable :: text

      options%input = "increment"
      text = message("1", options, code)
      call check(error, text(:35), "`input` increment needs the rate, a", more=text)
      options%rate_hz = 5.0_dp
      options%unit = "deg/s"
      call check(error, message("1", options, code), "`input` increment needs the unit of an angle (deg, rad, "// &
                 "arcsec), not deg/s; "// &
                 "increments of a velocity have m/s")
      options%input = "rate"
      options%unit = "deg"
      text = message("1", options, code)
      call check(error, text(:30), "the unit deg is that of an ang", more=text)
      text = message("1", reader_options(from=1.0_dp), code)
      call check(error, text(:28), "`from` and `to` need the rat", more=text)
      call check(error, message("1", reader_options(from=1.0_dp, rate_hz=2.0_dp), code), &
                 "the record ends at 0.5 s, before `from` 1")
      call check(error, code, status%too_few_samples)
   end subroutine test_options_file

   !> The line's number is right after many blocks, comments and blank lines.
   subroutine test_later_block()
      integer, parameter :: groups = 60000
      character(20*groups) :: content
      integer :: i

      do i = 1, groups
         content(20*i - 19:20*i) = "0.123456 1"//nl//"# c"//nl//nl//"1 2"//nl
      end do
      call expect(content//"1 2x"//nl, status%parse, ":240001:3: '2x' is not a number")
   end subroutine test_later_block

end module test_reader_errors
