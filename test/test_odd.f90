! SPDX-License-Identifier: MIT
!> Unusual contents of files; many were found by ci/fuzz.
module test_odd
   use expectations, only : unmet, failed => problem, test, error, check
   use gyroakf_kinds, only : dp, int8
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_record, only : record_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: suite_odd

   character(1), parameter :: nl = new_line("a")

contains

   subroutine suite_odd()
      call test("readable", test_readable)
      call test("names", test_names)
      call test("long-field", test_long_field)
      call test("impossible-rate", test_impossible_rate)
      call test("said", test_said)
      call test("columns", test_columns)
      call test("only-dates", test_only_dates)
      call test("tiny-stamps", test_tiny_stamps)
   end subroutine suite_odd

   !> Reads a content from memory.
   subroutine parse(content, options, record, message)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      !> "" where nothing failed
      character(:), allocatable, intent(out) :: message
      type(reader_options) :: mine
      integer(int8), allocatable, target :: bytes(:)

      mine = options
      bytes = transfer(content, [0_int8])
      mine%bytes => bytes
      call read_record("odd", mine, record, failed)
      message = ""
      if (allocated(failed)) message = failed%message
   end subroutine parse

   !> What is not UTF-8 is taken as Latin-1, what controls a terminal is not let through.
   subroutine test_readable()
      character(:), allocatable :: text

      text = "plain ~"
      call make_readable(text)
      call check(error, text, "plain ~")
      text = char(176)//"/s"//achar(27)//"[31m"//achar(127)//char(133)//char(206)//char(169)//char(206)
      call make_readable(text)
      call check(error, text, char(194)//char(176)//"/s?[31m??"//char(206)//char(169)//char(195)//char(142))
   end subroutine test_readable

   !> Names of columns are made readable before they get into messages and results; a unit of Latin-1 is known.
   subroutine test_names()
      type(record_type) :: record
      type(reader_options) :: options
      character(:), allocatable :: message

      call parse("g"//achar(27)//"x ["//char(176)//"/s]"//nl//repeat("1"//nl, 50), options, record, message)
      call check(error, message, "")
      call check(error, record%channel(1)%text//" "//record%unit%name, "g?x deg/s")
      options%columns = "gy"
      call parse("g"//achar(27)//"x"//nl//repeat("1"//nl, 50), options, record, message)
      call check(error, message, "there is no column 'gy'; the file has 'g?x'")
      call parse(repeat("{"//char(165)//": {x"//achar(27)//": 1}, y"//char(176)//": 2}"//nl, 50), reader_options(), record, message)
      call check(error, message, "")
      call check(error, record%channel(1)%text//","//record%channel(2)%text, &
                 char(194)//char(165)//" x?,y"//char(194)//char(176))
      call parse("'|"//nl//"1"//nl//"2"//nl, reader_options(), record, message)      ! a line of names without one
      call check(error, message, "")
   end subroutine test_names

   !> A long field without the start of a character in it.
   subroutine test_long_field()
      type(record_type) :: record
      character(:), allocatable :: message

      call parse("1 2"//nl//repeat(char(139), 200)//" 3"//nl, reader_options(), record, message)
      call check(error, message(:53), "odd:2:1: '"//repeat("?", 33)//"...' is no")
   end subroutine test_long_field

   !> A rate whose interval overflows is none.
   subroutine test_impossible_rate()
      type(record_type) :: record
      character(:), allocatable :: message
      character(18), parameter :: line(3) = [character(18) :: "# rate_hz: 4.9e-99", "# dt: 1e308", "# dt: 1e-300"]
      integer :: i

      do i = 1, size(line)
         call parse(trim(line(i))//nl//"1"//nl, reader_options(), record, message)
         call check(error, message//record%rate_source, "none", more=line(i))
         call check(error, index(record%warnings(1)%text, "is not a positive number") > 0)
      end do
      call parse("1", reader_options(rate_hz=1.0e-310_dp), record, message)
      call check(error, index(message, "the rate has to lie between 1e-30 and 1e30 Hz, and is 1e-310") == 1)
   end subroutine test_impossible_rate

   !> The message about a content, and what to do.
   subroutine test_said()
      character(1), parameter :: cr = achar(13)

      call said(char(226)//char(136)//char(146)//"1.5"//nl//"2"//nl, "odd:1:1: ", "the minus sign is not that of ASCII")
      call said('"1,234.5"'//nl//'"2"'//nl, "odd:1:2: '1,234.5' is not a number", "commas that group digits are not read")
      call said("1 2"//cr//nl//"3 4"//cr//"5 6"//nl, "odd:2:5: 4 columns", "a carriage return stands within the line")
      call said("time,x"//nl//"01/02/2024"//char(163)//",1"//nl, "odd:2:1: ", "'01/02/2024?' ")
   end subroutine test_said

   !> The message begins with the place and holds a text.
   subroutine said(content, place, text)
      character(*), intent(in) :: content, place, text
      type(record_type) :: record
      character(:), allocatable :: message

      call parse(content, reader_options(), record, message)
      call check(error, index(message, place), 1, more=message)
      call check(error, index(message, text) > 0, more=message)
   end subroutine said

   !> More columns than can be meant, with and without names; a name for each of many.
   subroutine test_columns()
      type(record_type) :: record
      character(:), allocatable :: message

      call said(repeat("1,", 65537)//nl, "odd:1:131073: 65538 columns, there may be 65536", "have line ends got lost?")
      call said(repeat("a,", 65537)//nl//repeat("1,", 65537), "odd:2:131073: 65538 columns", "have line ends got lost?")
      call parse(repeat("a,", 9999)//"b"//nl//repeat("1,", 9999)//"2"//nl, reader_options(), record, message)
      if (unmet(size(record%channel) == 10000 .and. message == "")) return
      call check(error, record%channel(10000)%text, "b")
   end subroutine test_columns

   !> Nothing but dates, which may not be the time either.
   subroutine test_only_dates()
      type(record_type) :: record
      type(reader_options) :: options
      character(:), allocatable :: message
      character(*), parameter :: content = "when"//nl//"2024-01-01T00:00:00Z"//nl//"2024-01-01T00:00:01Z"//nl

      options%time_column = "none"
      call parse(content, options, record, message)
      call check(error, index(message, "odd:1:1: every column holds dates or times of day"), 1, more=message)
      call said(content, "odd:1:1: there is no column besides the time in column 'when'", "besides the time")
   end subroutine test_only_dates

   !> Time stamps so close that the rate would overflow.
   subroutine test_tiny_stamps()
      type(record_type) :: record
      character(:), allocatable :: message

      call parse("t,g"//nl//"0,1"//nl//"1,"//nl//"4.9e-324,3"//nl, reader_options(), record, message)
      call check(error, message, "")
      call check(error, record%sample_interval > 1.0e-99_dp .and. record%sample_interval < 1.0e99_dp)
      call parse("t,g"//nl//"0,1"//nl//"4.9e-324,2"//nl//"9.9e-324,3"//nl, reader_options(), record, message)
      call check(error, message == "" .and. .not. record%rate_known)
   end subroutine test_tiny_stamps

end module test_odd
