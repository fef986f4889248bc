! SPDX-License-Identifier: MIT
!> Files that appear whole or not at all.
module test_writer
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use expectations, only : check, check_refused
   use testdrive, only : new_unittest, unittest_type, error_type
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_source, only : is_directory
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, put_real, complete_writer, commit_writer, &
      discard_writer, make_directory
   use json_reader, only : file_text
   use scratch_file, only : scratch_path
   implicit none (type, external)
   private
   public :: collect_writer

   character(*), parameter :: path = "test_writer_scratch.tmp"
   character(1), parameter :: lf = new_line("a")

   interface
      function c_rmdir(path) result(failed) bind(C, name="rmdir")
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: failed
      end function c_rmdir
   end interface

contains

   !> Names the tests.
   subroutine collect_writer(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("commit", test_commit), &
         new_unittest("discard", test_discard), &
         new_unittest("complete", test_complete), &
         new_unittest("long", test_long), &
         new_unittest("numbers", test_numbers), &
         new_unittest("leftovers", test_leftovers), &
         new_unittest("full-device", test_full_device), &
         new_unittest("nowhere", test_nowhere), &
         new_unittest("device", test_device), &
         new_unittest("make-directory", test_make_directory)]
   end subroutine collect_writer

   !> Writes a line into the scratch file.
   subroutine begin(writer, line)
      type(writer_type), intent(out) :: writer
      character(*), intent(in) :: line
      type(gyro_error), allocatable :: failed

      call open_writer(writer, path, failed)
      call put_line(writer, line)
   end subroutine begin

   subroutine remove(name)
      character(*), intent(in) :: name
      integer :: unit

      open (newunit=unit, file=name)
      close (unit, status="delete")
   end subroutine remove

   logical function exists(name)
      character(*), intent(in) :: name

      inquire (file=name, exist=exists)
   end function exists

   !> What a killed process left of the same file goes when it is begun again; not what may be another's: a process that is there
   !> (the first of the system), no process's number, another file's.
   subroutine test_leftovers(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: no_process = ".part2147483646"
      type(writer_type) :: writer
      integer :: unit, i
      logical :: left(6)

      associate (name => [character(48) :: path//no_process, path//".part1", path//".part21474836x", path//".part", &
                          "a_"//path//no_process, path(:len(path) - 1)//"_"//no_process])
         do i = 1, size(name)
            open (newunit=unit, file=trim(name(i)), status="replace")
            close (unit)
         end do
         call begin(writer, "done")
         do i = 1, size(name)
            left(i) = exists(trim(name(i)))
         end do
         call check(error, exists(writer%aside), "its own part is gone")
         call discard_writer(writer)
         do i = 1, size(name)
            call remove(trim(name(i)))
         end do
      end associate
      if (allocated(error)) return
      call check(error, .not. left(1), "the part of a process that is no more is still there")
      call check(error, all(left(2:)), "a file that is no leftover of this one is gone")
   end subroutine test_leftovers

   subroutine test_commit(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "one")
      call check(error, .not. exists(path) .and. exists(writer%aside))
      if (allocated(error)) return
      call commit_writer(writer, failed)
      call check(error, .not. allocated(failed) .and. .not. exists(writer%aside))
      if (allocated(error)) return
      call check(error, file_text(path), "one"//lf)
      call commit_writer(writer, failed)
      call discard_writer(writer)
      call check(error, .not. allocated(failed) .and. exists(path))
      call remove(path)
   end subroutine test_commit

   !> The file of an earlier run stays.
   subroutine test_discard(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "old")
      call commit_writer(writer, failed)
      call begin(writer, "new")
      call discard_writer(writer)
      call check(error, file_text(path), "old"//lf)
      call check(error, .not. exists(writer%aside))
      call remove(path)
   end subroutine test_discard

   !> Complete, but not there before the commit; a completed file can still be given up.
   subroutine test_complete(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "one")
      call complete_writer(writer, failed)
      call check(error, .not. allocated(failed) .and. .not. exists(path))
      if (allocated(error)) return
      call check(error, file_text(writer%aside), "one"//lf)
      call discard_writer(writer)
      call check(error, .not. exists(writer%aside) .and. .not. exists(path))
      if (allocated(error)) return
      call begin(writer, "two")
      call complete_writer(writer, failed)
      call commit_writer(writer, failed)
      call check(error, file_text(path), "two"//lf)
      call remove(path)
   end subroutine test_complete

   !> Longer than the buffer, in one piece and in many.
   subroutine test_long(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: text
      integer :: i

      call begin(writer, repeat("x", 200000))
      do i = 1, 40000
         call put(writer, "ab")
      end do
      call commit_writer(writer, failed)
      text = file_text(path)
      call check(error, text == repeat("x", 200000)//lf//repeat("ab", 40000))
      call remove(path)
   end subroutine test_long

   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed
      integer :: i

      call open_writer(writer, path, failed)
      do i = 1, 20000
         call put_real(writer, 0.25_dp, 15)
      end do
      call commit_writer(writer, failed)
      call check(error, file_text(path) == repeat("0.25", 20000))
      call remove(path)
   end subroutine test_numbers

   !> A write that fails is reported when the file is completed.
   subroutine test_full_device(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      if (.not. exists("/dev/full")) return
      call open_writer(writer, "/dev/full", failed)
      call put_line(writer, "one")
      call complete_writer(writer, failed)
      call check_refused(error, failed, status%io)
      call commit_writer(writer, failed)
      call check(error, .not. allocated(failed))
   end subroutine test_full_device

   subroutine test_nowhere(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call open_writer(writer, "no_such_directory/file.txt", failed)
      call check(error, allocated(failed))
      if (allocated(error)) return
      call check(error, failed%code == status%io .and. index(failed%message, "no_such_directory/file.txt") == 1)
      call open_writer(writer, ".", failed)
      call check(error, allocated(failed))
      if (allocated(error)) return
      call make_directory("/dev/null/x", failed)
      call check(error, allocated(failed))
   end subroutine test_nowhere

   !> A device is written to, not replaced.
   subroutine test_device(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call open_writer(writer, "/dev/null", failed)
      call check(error, writer%aside, "/dev/null")
      call put(writer, "x")
      call commit_writer(writer, failed)
      call check(error, .not. allocated(failed), "refused")
   end subroutine test_device

   subroutine test_make_directory(error)
      type(error_type), allocatable, intent(out) :: error
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: place
      integer(c_int) :: ignored

      place = scratch_path("directory")
      call make_directory(place//"/a/b/", failed)
      call check(error, is_directory(place//"/a/b") .and. .not. allocated(failed), "not made")
      if (allocated(error)) return
      call make_directory(place//"/a", failed)
      call check(error, .not. allocated(failed), "there already")
      if (allocated(error)) return
      ignored = c_rmdir(place//"/a/b"//c_null_char)
      ignored = c_rmdir(place//"/a"//c_null_char)
      ignored = c_rmdir(place//c_null_char)
      call make_directory("/dev/null/a", failed)
      call check(error, allocated(failed), "accepted")
   end subroutine test_make_directory

end module test_writer
