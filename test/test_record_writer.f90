! SPDX-License-Identifier: MIT
!> Records written as text.
module test_record_writer
   use expectations, only : failure => problem, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : status
   use gyroakf_record, only : record_type, text_type, add_text
   use gyroakf_io_columns_writer, only : write_record
   use scratch_file, only : scratch_path, read_bytes, remove_file
   implicit none (type, external)
   private
   public :: suite_record_writer

contains

   subroutine suite_record_writer()
      call test("layout", test_layout)
      call test("numbers", test_numbers)
      call test("long", test_long)
      call test("failures", test_failures)
   end subroutine suite_record_writer

   !> Header keys, columns, missing samples
   subroutine test_layout()
      type(record_type) :: record
      type(text_type), allocatable :: header(:)
      character(:), allocatable :: text

      call add_text(header, "made by hand")
      record%rate_known = .true.
      record%sample_interval = 0.01_dp
      record%unit%name = "deg/s"
      call add_text(record%channel, "gx")
      call add_text(record%channel, "gy")
      allocate (record%value(2, 2), record%present(2, 2))
      record%value(:, 1) = [1.5_dp, 0.0_dp]
      record%value(:, 2) = [-2.0_dp, 1.0e-7_dp]
      record%present = 1
      record%present(2, 1) = 0
      call write_record(path(), record, header, 6, failure)
      if (went_wrong(failure)) return
      call read_back(text)
      call check(error, text, "# made by hand|# rate_hz: 100|# unit: deg/s|# columns: gx gy|1.5 -2|nan 1e-07|")
   end subroutine test_layout

   !> As C's %.9g; nothing known but the values
   subroutine test_numbers()
      type(record_type) :: record
      type(text_type), allocatable :: header(:)
      character(:), allocatable :: text

      allocate (header(0), record%value(12, 1))
      record%value(:, 1) = [0.0_dp, 1.0_dp, -1.0_dp, 0.1_dp, 123456789.4_dp, 1234567891.0_dp, 999999999.9_dp, 0.0001_dp, &
         & 0.00009999999999_dp, 1.0_dp/3, -huge(1.0_dp), tiny(1.0_dp)]
      call write_record(path(), record, header, 9, failure)
      if (went_wrong(failure)) return
      call read_back(text)
      call check(error, text, "0|1|-1|0.1|123456789|1.23456789e+09|1e+09|0.0001|0.0001|0.333333333|"// &
         & "-1.79769313e+308|2.22507386e-308|")
   end subroutine test_numbers

   !> More than one block of output, at 17 digits: every value is read back to the last bit.
   subroutine test_long()
      type(record_type) :: record
      type(text_type), allocatable :: header(:)
      real(dp) :: again(20000)
      integer :: i, unit

      allocate (header(0), record%value(20000, 1))
      record%value(:, 1) = [(sin(real(i, dp))*10.0_dp**mod(i, 30), i=1, 20000)]
      call write_record(path(), record, header, 17, failure)
      if (went_wrong(failure)) return
      open (newunit=unit, file=path(), status="old")
      read (unit, *) again
      close (unit, status="delete")
      call check(error, maxval(abs(again - record%value(:, 1))) <= 0)
   end subroutine test_long

   subroutine test_failures()
      type(record_type) :: record
      type(text_type), allocatable :: header(:)
      integer :: i
      integer, parameter :: digits(2) = [-1, 18]

      allocate (header(0), record%value(1, 1))
      record%value(1, 1) = 0
      do i = 1, 2
         call write_record(path(), record, header, digits(i), failure)
         call check_refused(failure, status%invalid_argument)
      end do
      call write_record("no/such/directory/x.txt", record, header, 9, failure)
      call check_refused(failure, status%io)
      call check(error, index(failure%message, "no/such/directory/x.txt") > 0)
   end subroutine test_failures

   !> Where the tests write
   function path()
      character(:), allocatable :: path

      path = scratch_path("record.txt")
   end function path

   !> The file's text, a bar for every end of line; the file is deleted
   subroutine read_back(text)
      character(:), allocatable, intent(out) :: text
      integer :: i

      text = read_bytes(path())
      call remove_file(path())
      do i = 1, len(text)
         if (text(i:i) == achar(10)) text(i:i) = "|"
      end do
   end subroutine read_back

end module test_record_writer
