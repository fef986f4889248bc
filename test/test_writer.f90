! SPDX-License-Identifier: MIT
!> Files that appear whole or not at all.
module test_writer
   use expectations, only : unmet, test, error, check, check_refused, went_wrong
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : gyro_error => error_type, status
   use gyroakf_io_source, only : is_directory
   use gyroakf_io_writer, only : writer_type, open_writer, put, put_line, put_real, complete_writer, commit_writer, &
      discard_writer, make_directory
   use scratch_file, only : file_exists, read_bytes, remove_file, remove_folder, scratch_path, write_bytes
   implicit none (type, external)
   private
   public :: suite_writer

   character(*), parameter :: path = "test_writer_scratch.tmp"
   character(1), parameter :: lf = new_line("a")

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

   !> What a killed process left of the same file goes when it is begun again; not what may be another's: a process that is there
   !> (the first of the system), no process's number, another file's.
   subroutine test_leftovers()
      character(*), parameter :: no_process = ".part2147483646"
      type(writer_type) :: writer
      integer :: i
      logical :: left(6)

      associate (name => [character(48) :: path//no_process, path//".part1", path//".part21474836x", path//".part", &
                          "a_"//path//no_process, path(:len(path) - 1)//"_"//no_process])
         do i = 1, size(name)
            call write_bytes(trim(name(i)), "")
         end do
         call begin(writer, "done")
         do i = 1, size(name)
            left(i) = file_exists(trim(name(i)))
         end do
         call check(error, file_exists(writer%aside), "its own part is gone")
         call discard_writer(writer)
         do i = 1, size(name)
            call remove_file(trim(name(i)))
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
      call check(error, .not. file_exists(path) .and. file_exists(writer%aside))
      call commit_writer(writer, failed)
      if (unmet(.not. allocated(failed) .and. .not. file_exists(writer%aside))) return
      call check(error, read_bytes(path), "one"//lf)
      call commit_writer(writer, failed)
      call discard_writer(writer)
      call check(error, .not. allocated(failed) .and. file_exists(path))
      call remove_file(path)
   end subroutine test_commit

   !> The file of an earlier run stays.
   subroutine test_discard()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "old")
      call commit_writer(writer, failed)
      call begin(writer, "new")
      call discard_writer(writer)
      call check(error, read_bytes(path), "old"//lf)
      call check(error, .not. file_exists(writer%aside))
      call remove_file(path)
   end subroutine test_discard

   !> Complete, but not there before the commit; a completed file can still be given up.
   subroutine test_complete()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      call begin(writer, "one")
      call complete_writer(writer, failed)
      if (unmet(.not. allocated(failed) .and. .not. file_exists(path))) return
      call check(error, read_bytes(writer%aside), "one"//lf)
      call discard_writer(writer)
      call check(error, .not. file_exists(writer%aside) .and. .not. file_exists(path))
      call begin(writer, "two")
      call complete_writer(writer, failed)
      call commit_writer(writer, failed)
      call check(error, read_bytes(path), "two"//lf)
      call remove_file(path)
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
      text = read_bytes(path)
      call check(error, text == repeat("x", 200000)//lf//repeat("ab", 40000))
      call remove_file(path)
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
      call check(error, read_bytes(path) == repeat("0.25", 20000))
      call remove_file(path)
   end subroutine test_numbers

   !> A write that fails is reported when the file is completed.
   subroutine test_full_device()
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failed

      if (.not. file_exists("/dev/full")) return
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

      place = scratch_path("directory")
      call make_directory(place//"/a/b/", failed)
      if (unmet(is_directory(place//"/a/b") .and. .not. allocated(failed), "not made")) return
      call make_directory(place//"/a", failed)
      if (went_wrong(failed, "there already")) return
      call remove_folder(place//"/a/b")
      call remove_folder(place//"/a")
      call remove_folder(place)
      call make_directory("/dev/null/a", failed)
      call check(error, allocated(failed), "accepted")
   end subroutine test_make_directory

end module test_writer
