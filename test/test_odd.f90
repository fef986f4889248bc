! SPDX-License-Identifier: MIT
!> Contents of files that nobody would write on purpose; many were found by ci/fuzz.
module test_odd
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int8
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_record, only : record_type
   use gyroakf_utf8, only : make_readable
   implicit none (type, external)
   private
   public :: collect_odd

   character(1), parameter :: nl = new_line("a")

contains

   !> Names the tests.
   subroutine collect_odd(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("readable", test_readable), &
         new_unittest("names", test_names), &
         new_unittest("long-field", test_long_field), &
         new_unittest("impossible-rate", test_impossible_rate)]
   end subroutine collect_odd

   !> Reads a content from memory.
   subroutine parse(content, options, record, message)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      !> "" where nothing failed
      character(:), allocatable, intent(out) :: message
      type(reader_options) :: mine
      type(gyro_error), allocatable :: failed
      integer(int8), allocatable, target :: bytes(:)

      mine = options
      bytes = transfer(content, [0_int8])
      mine%bytes => bytes
      call read_record("odd", mine, record, failed)
      message = ""
      if (allocated(failed)) message = failed%message
   end subroutine parse

   !> What is not UTF-8 is taken as Latin-1, what controls a terminal is not let through.
   subroutine test_readable(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text

      text = "plain ~"
      call make_readable(text)
      call check(error, text, "plain ~")
      if (allocated(error)) return
      text = char(176)//"/s"//achar(27)//"[31m"//achar(127)//char(133)//char(206)//char(169)//char(206)
      call make_readable(text)
      call check(error, text, char(194)//char(176)//"/s?[31m??"//char(206)//char(169)//char(195)//char(142))
   end subroutine test_readable

   !> Names of columns are made readable before they get into messages and results; a unit of Latin-1 is known.
   subroutine test_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(reader_options) :: options
      character(:), allocatable :: message

      call parse("g"//achar(27)//"x ["//char(176)//"/s]"//nl//repeat("1"//nl, 50), options, record, message)
      call check(error, message, "")
      if (allocated(error)) return
      call check(error, record%channel(1)%text//" "//record%unit%name, "g?x deg/s")
      if (allocated(error)) return
      options%columns = "gy"
      call parse("g"//achar(27)//"x"//nl//repeat("1"//nl, 50), options, record, message)
      call check(error, message, "there is no column 'gy'; the file has 'g?x'")
   end subroutine test_names

   !> A long field without the start of a character in it.
   subroutine test_long_field(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      character(:), allocatable :: message

      call parse("1 2"//nl//repeat(char(139), 200)//" 3"//nl, reader_options(), record, message)
      call check(error, message(:53), "odd:2:1: '"//repeat("?", 33)//"...' is no")
   end subroutine test_long_field

   !> A rate whose interval overflows is none.
   subroutine test_impossible_rate(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      character(:), allocatable :: message
      character(18), parameter :: line(3) = [character(18) :: "# rate_hz: 4.9e-99", "# dt: 1e308", "# dt: 1e-300"]
      integer :: i

      do i = 1, size(line)
         call parse(trim(line(i))//nl//"1"//nl, reader_options(), record, message)
         call check(error, message//record%rate_source, "none", more=line(i))
         if (allocated(error)) return
         call check(error, index(record%warnings(1)%text, "is not a positive number") > 0)
         if (allocated(error)) return
      end do
      call parse("1", reader_options(rate_hz=1.0e-310_dp), record, message)
      call check(error, index(message, "the rate has to lie between 1e-30 and 1e30 Hz, and is 1e-310") == 1)
   end subroutine test_impossible_rate

end module test_odd
