! SPDX-License-Identifier: MIT
!> Columns as text and as numbers: layout, missing samples, long files, cancelling, one thread as many.
module test_columns_writer
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan
   use gyroakf_threads, only : thread_count, set_thread_count
   use expectations, only : failed => problem, test, error, check, check_refused
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_progress, only : progress_type
   use gyroakf_io_columns_writer, only : column_type, form_of, put_rows, row_layout_type
   use gyroakf_io_writer, only : commit_writer, discard_writer, open_writer, writer_type
   use scratch_file, only : file_exists, read_bytes, remove_file, scratch_path
   implicit none (type, external)
   private
   public :: suite_columns_writer

   !> Cancels the second time
   type, extends(progress_type) :: impatient_type
      integer :: calls = 0
   contains
      procedure :: advance => lose_patience
   end type impatient_type

contains

   subroutine suite_columns_writer()
      call test("text", test_text)
      call test("numbers", test_numbers)
      call test("threads", test_threads)
      call test("cancelled", test_cancelled)
      call test("form_by_name", test_form)
   end subroutine suite_columns_writer

   subroutine lose_patience(self, stage, done, total, cancel)
      class(impatient_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%calls = self%calls + 1
      cancel = self%calls > 1 .and. done <= total .and. stage == "writing"
   end subroutine lose_patience

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

      call open_writer(writer, path(), failed)
      if (.not. allocated(failed)) call put_rows(writer, columns, rows, layout, failed, progress)
      if (allocated(failed)) call discard_writer(writer)
      if (.not. allocated(failed)) call commit_writer(writer, failed)
   end subroutine write_file

   function path()
      character(:), allocatable :: path

      path = scratch_path("columns")
   end function path

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
      bytes = read_bytes(path())
      call remove_file(path())
      call check(error, bytes, "0,1.5,nan"//new_line("a")//"0.1,nan,nan"//new_line("a")//"0.2,0.30000000000000004,nan"// &
                 new_line("a")//"0.3,-1e-07,nan"//new_line("a"))
   end subroutine test_text

   !> The bytes are the numbers, row after row, behind a header whose length is a multiple of 64.
   subroutine test_numbers()
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
      bytes = read_bytes(path())
      call remove_file(path())
      call check(error, len(bytes) - 24*n, 128)
      call check(error, index(bytes(:128), "'shape': (10000, 3), }") > 0)
      back = reshape(transfer(bytes(129:), back, 3*n), [3, n])
      call check(error, all(abs(back(2, 8:) - x(8:)) <= 0.0_dp) .and. ieee_is_nan(back(2, 7)) .and. all(ieee_is_nan(back(3, :))))
      call check(error, back(1, n), 0.1_dp*real(n - 1, dp))
   end subroutine test_numbers

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
      one = read_bytes(path())
      call set_thread_count(3)
      call write_file(columns, int(n, int64), layout, failed)
      call set_thread_count(before)
      three = read_bytes(path())
      call remove_file(path())
      call check(error, len(one) > 20*n .and. one == three, "the file depends on the number of threads")
   end subroutine test_threads

   subroutine test_cancelled()
      integer, parameter :: n = 400000
      real(dp), allocatable, target :: x(:)
      integer(int8), allocatable, target :: present(:)
      type(column_type) :: columns(3)
      type(row_layout_type) :: layout
      type(impatient_type) :: impatient

      allocate (x(n), present(n))
      x = 1.0_dp
      present = 1_int8
      call make_columns(columns, x, present)
      call set_thread_count(1)
      call write_file(columns, int(n, int64), layout, failed, impatient)
      call set_thread_count(2)
      call check_refused(failed, status%cancelled)
      call check(error, .not. file_exists(path()), "half a file is left")
   end subroutine test_cancelled

   subroutine test_form()
      call check(error, form_of("a.npy")//form_of("a.f64")//form_of("npy")//form_of("-")//form_of("a.npy.txt"), &
                 "npy f64 texttexttext")
   end subroutine test_form

end module test_columns_writer
