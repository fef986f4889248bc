! SPDX-License-Identifier: MIT
!> Reading recordings: every feature of the text format, and every message.
module test_reader
   use testdrive, only : new_unittest, unittest_type, error_type, check
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_reader, only : reader_options, read_record
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: collect_reader

   character(1), parameter :: nl = new_line("a")

contains

   !> Names the tests.
   subroutine collect_reader(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("separators", test_separators)]
   end subroutine collect_reader

   !> Writes the content to a scratch file and reads it.
   subroutine read_text(content, options, record, failed)
      character(*), intent(in) :: content
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable, intent(out) :: failed
      character(*), parameter :: path = "test_reader.scratch"
      integer :: unit

      open (newunit=unit, file=path, access="stream", form="unformatted", status="replace", action="write")
      write (unit) content
      close (unit)
      call read_record(path, options, record, failed)
      open (newunit=unit, file=path, status="old")
      close (unit, status="delete")
   end subroutine read_text

   subroutine test_separators(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(gyro_error), allocatable :: failed

      call read_text("1.0 2,3;4"//nl//" -1.5"//achar(9)//"2.5 , 3e0 ;4 "//achar(13)//nl, reader_options(), record, failed)
      call check(error, .not. allocated(failed), "refused")
      if (allocated(error)) return
      call check(error, all(abs(record%value(1, :) - [1, 2, 3, 4]) <= 0.0_dp))
      if (allocated(error)) return
      call check(error, all(abs(record%value(2, :) - [-1.5_dp, 2.5_dp, 3.0_dp, 4.0_dp]) <= 0.0_dp))
   end subroutine test_separators

end module test_reader
