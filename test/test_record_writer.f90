! SPDX-License-Identifier: MIT
!> Records written as text, and columns as text and as numbers: layout, missing samples, long files,
!> cancelling, one thread as many.
module test_record_writer
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use expectations, only : failure => problem, test, error, check, check_refused, went_wrong, &
      & failed => problem
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : status, gyro_error => error_type
   use gyroakf_record, only : record_type, text_type, add_text
   use scratch_file, only : scratch_path, read_bytes, remove_file, file_exists
   use gyroakf_threads, only : thread_count, set_thread_count
   use gyroakf_progress, only : progress_type
   use progress_watch, only : watch_type
   use gyroakf_io_columns_writer, only : column_type, form_of, put_rows, row_layout_type, &
      & write_record
   use gyroakf_io_writer, only : commit_writer, discard_writer, open_writer, writer_type
   implicit none (type, external)
   private
   public :: suite_record_writer, suite_columns_writer

contains

   subroutine suite_record_writer()
      call test("layout", test_layout)
      call test("numbers", test_numbers)
      call test("long", test_long)
      call test("failures", test_failures)
   end subroutine suite_record_writer

   subroutine suite_columns_writer()
      call test("text", test_text)
      call test("numbers", test_numbers_columns)
      call test("threads", test_threads)
      call test("cancelled", test_cancelled)
      call test("form_by_name", test_form)
   end subroutine suite_columns_writer

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

   !> A time, an array with its marks, nothing.
   subroutine make_columns(columns, x, present)
      type(column_type), intent(out) :: columns(3)
      real(dp), intent(in), target :: x(:)
      integer(int8), intent(in), target :: present(:)

      columns(1) = column_type(step=0.1_dp, digits=15)
      columns(2)%value => x
      columns(2)%present => present
   end subroutine make_columns

   subroutine write_file(columns, rows, layout, failed, progress)
      type(column_type), intent(in) :: columns(:)
      integer(int64), intent(in) :: rows
      type(row_layout_type), intent(in) :: layout
      type(gyro_error), allocatable, intent(out) :: failed
      class(progress_type), intent(inout), optional :: progress
      type(writer_type) :: writer

      call open_writer(writer, path_columns(), failed)
      if (.not. allocated(failed)) call put_rows(writer, columns, rows, layout, failed, progress)
      if (allocated(failed)) call discard_writer(writer)
      if (.not. allocated(failed)) call commit_writer(writer, failed)
   end subroutine write_file

   function path_columns()
      character(:), allocatable :: path_columns

      path_columns = scratch_path("columns")
   end function path_columns

   subroutine test_text()
      real(dp), target :: x(4)
      integer(int8), target :: present(4)
      type(column_type) :: columns(3)
      type(row_layout_type) :: layout
      character(:), allocatable :: bytes

      x = [1.5_dp, 0.0_dp, 0.1_dp + 0.2_dp, -1.0e-7_dp]
      present = [1_int8, 0_int8, 1_int8, 1_int8]
      call make_columns(columns, x, present)
      call write_file(columns, 4_int64, layout, failed)
      bytes = read_bytes(path_columns())
      call remove_file(path_columns())
      call check(error, bytes, "0,1.5,nan"//new_line("a")//"0.1,nan,nan"//new_line("a")//"0.2,0.30000000000000004,nan"// &
                 new_line("a")//"0.3,-1e-07,nan"//new_line("a"))
   end subroutine test_text

   !> The bytes are the numbers, row after row, behind a header whose length is a multiple of 64.
   subroutine test_numbers_columns()
      integer, parameter :: n = 10000
      real(dp), target :: x(n)
      integer(int8), target :: present(n)
      type(column_type) :: columns(3)
      type(row_layout_type) :: layout
      character(:), allocatable :: bytes
      real(dp) :: back(3, n)
      integer :: i

      do i = 1, n
         x(i) = sin(real(i, dp))
      end do
      present = 1_int8
      present(7) = 0_int8
      call make_columns(columns, x, present)
      layout%form = "npy"
      call write_file(columns, int(n, int64), layout, failed)
      bytes = read_bytes(path_columns())
      call remove_file(path_columns())
      call check(error, len(bytes) - 24*n, 128)
      call check(error, index(bytes(:128), "'shape': (10000, 3), }") > 0)
      back = reshape(transfer(bytes(129:), back, 3*n), [3, n])
      call check(error, all(abs(back(2, 8:) - x(8:)) <= 0.0_dp) .and. ieee_is_nan(back(2, 7)) .and. all(ieee_is_nan(back(3, :))))
      call check(error, back(1, n), 0.1_dp*real(n - 1, dp))
   end subroutine test_numbers_columns

   !> One thread writes what three write.
   subroutine test_threads()
      integer, parameter :: n = 60000
      real(dp), target :: x(n)
      integer(int8), target :: present(n)
      type(column_type) :: columns(3)
      type(row_layout_type) :: layout
      character(:), allocatable :: one, three
      integer :: i, before

      do i = 1, n
         x(i) = sin(real(i, dp))*10.0_dp**mod(i, 30)
         present(i) = int(min(1, mod(i, 11)), int8)
      end do
      call make_columns(columns, x, present)
      before = thread_count()
      call set_thread_count(1)
      call write_file(columns, int(n, int64), layout, failed)
      one = read_bytes(path_columns())
      call set_thread_count(3)
      call write_file(columns, int(n, int64), layout, failed)
      call set_thread_count(before)
      three = read_bytes(path_columns())
      call remove_file(path_columns())
      call check(error, len(one) > 20*n .and. one == three, "the file depends on the number of threads")
   end subroutine test_threads

   subroutine test_cancelled()
      integer, parameter :: n = 400000
      real(dp), allocatable, target :: x(:)
      integer(int8), allocatable, target :: present(:)
      type(column_type) :: columns(3)
      type(row_layout_type) :: layout
      type(watch_type) :: watch

      allocate (x(n), present(n))
      x = 1.0_dp
      present = 1_int8
      call make_columns(columns, x, present)
      call set_thread_count(1)
      watch%last_call = 2
      call write_file(columns, int(n, int64), layout, failed, watch)
      call set_thread_count(2)
      call check(error, watch%ordered .and. watch%stage == "writing", "progress")
      call check_refused(failed, status%cancelled)
      call check(error, .not. file_exists(path_columns()), "half a file is left")
   end subroutine test_cancelled

   subroutine test_form()
      call check(error, form_of("a.npy")//form_of("a.f64")//form_of("npy")//form_of("-")//form_of("a.npy.txt"), &
                 "npy f64 texttexttext")
   end subroutine test_form

end module test_record_writer
