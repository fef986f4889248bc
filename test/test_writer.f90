! SPDX-License-Identifier: MIT
!> Files that appear whole or not at all.
module test_writer
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use expectations, only : unmet, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_source, only : is_directory
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, put_real, complete_writer, commit_writer, &
      discard_writer, make_directory
   use json_reader, only : file_text
   use scratch_file, only : scratch_path
   implicit none (type, external)
   private
   public :: suite_writer

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

   subroutine suite_writer()
      call test("commit", test_commit)
      call test("discard", test_discard)
      call test("complete", test_complete)
      call test("long", test_long)
      call test("numbers", test_numbers)
      call test("leftovers", test_leftovers)
      call test("full-device", test_full_device)
      call test("nowhere", test_nowhere)
      call test("device", test_device)
      call test("make-directory", test_make_directory)
   end subroutine suite_writer

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
   subroutine test_leftovers()
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

   subroutine test_commit()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "one")
      call check(error, .not. exists(path) .and. exists(writer%aside))
      call commit_writer(writer, failed)
      if (unmet(.not. allocated(failed) .and. .not. exists(writer%aside))) return
      call check(error, file_text(path), "one"//lf)
      call commit_writer(writer, failed)
      call discard_writer(writer)
      call check(error, .not. allocated(failed) .and. exists(path))
      call remove(path)
   end subroutine test_commit

   !> The file of an earlier run stays.
   subroutine test_discard()
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
   subroutine test_complete()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "one")
      call complete_writer(writer, failed)
      if (unmet(.not. allocated(failed) .and. .not. exists(path))) return
      call check(error, file_text(writer%aside), "one"//lf)
      call discard_writer(writer)
      call check(error, .not. exists(writer%aside) .and. .not. exists(path))
      call begin(writer, "two")
      call complete_writer(writer, failed)
      call commit_writer(writer, failed)
      call check(error, file_text(path), "two"//lf)
      call remove(path)
   end subroutine test_complete

   !> Longer than the buffer, in one piece and in many.
   subroutine test_long()
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

   subroutine test_numbers()
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
   subroutine test_full_device()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      if (.not. exists("/dev/full")) return
      call open_writer(writer, "/dev/full", failed)
      call put_line(writer, "one")
      call complete_writer(writer, failed)
      call check_refused(failed, status%io)
      call commit_writer(writer, failed)
      call check(error, .not. allocated(failed))
   end subroutine test_full_device

   subroutine test_nowhere()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call open_writer(writer, "no_such_directory/file.txt", failed)
      if (unmet(allocated(failed))) return
      call check(error, failed%code == status%io .and. index(failed%message, "no_such_directory/file.txt") == 1)
      call open_writer(writer, ".", failed)
      if (unmet(allocated(failed))) return
      call make_directory("/dev/null/x", failed)
      call check(error, allocated(failed))
   end subroutine test_nowhere

   !> A device is written to, not replaced.
   subroutine test_device()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call open_writer(writer, "/dev/null", failed)
      call check(error, writer%aside, "/dev/null")
      call put(writer, "x")
      call commit_writer(writer, failed)
      call check(error, .not. allocated(failed), "refused")
   end subroutine test_device

   subroutine test_make_directory()
      type(gyro_error), allocatable :: failed
      character(:), allocatable :: place
      integer(c_int) :: ignored

      place = scratch_path("directory")
      call make_directory(place//"/a/b/", failed)
      if (unmet(is_directory(place//"/a/b") .and. .not. allocated(failed), "not made")) return
      call make_directory(place//"/a", failed)
      if (went_wrong(failed, "there already")) return
      ignored = c_rmdir(place//"/a/b"//c_null_char)
      ignored = c_rmdir(place//"/a"//c_null_char)
      ignored = c_rmdir(place//c_null_char)
      call make_directory("/dev/null/a", failed)
      call check(error, allocated(failed), "accepted")
   end subroutine test_make_directory

end module test_writer
