! SPDX-License-Identifier: MIT
!> A file of numbers for the time of a job: it has no name from the moment it is there, so that nothing is left of it however the
!> job ends.
module gyroakf_io_scratch
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_loc, c_null_char
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_system, only : c_close, c_mkstemp, c_unlink, read_at, write_at
   implicit none (type, external)
   private
   public :: scratch_type, open_scratch, write_scratch, read_scratch, close_scratch

   !> Bytes a number
   integer(int64), parameter :: width = storage_size(1.0_dp)/8

   !> An open file
   type :: scratch_type
      private
      integer(c_int) :: descriptor = -1
      !> Where it is, for messages
      character(:), allocatable :: directory
   end type scratch_type

contains

   !> Makes the file.
   subroutine open_scratch(scratch, directory, error)
      !> To be closed by [[close_scratch]]
      type(scratch_type), intent(out) :: scratch
      !> That of a file system with enough room
      character(*), intent(in) :: directory
      !> io: it cannot be made
      type(error_type), allocatable, intent(out) :: error
      character(kind=c_char) :: path(len(directory) + 24)
      character(*), parameter :: name = "/.gyroakf-XXXXXX"
      integer(c_int) :: ignored
      integer :: i

      scratch%directory = directory
      do i = 1, len(directory)
         path(i) = directory(i:i)
      end do
      do i = 1, len(name)
         path(len(directory) + i) = name(i:i)
      end do
      path(len(directory) + len(name) + 1) = c_null_char
      scratch%descriptor = c_mkstemp(path)
      if (scratch%descriptor < 0) then
         call fatal_error(error, status%io, directory//": a scratch file cannot be made there: name another directory by TMPDIR")
         return
      end if
      ignored = c_unlink(path)
   end subroutine open_scratch

   !> Writes numbers at a place.
   subroutine write_scratch(scratch, before, values, error)
      !> Open
      type(scratch_type), intent(in) :: scratch
      !> Numbers before the first of these
      integer(int64), intent(in) :: before
      !> Any numbers
      real(dp), intent(in), contiguous, target :: values(:)
      !> io: the disk is full
      type(error_type), allocatable, intent(out) :: error
      logical :: failed

      if (size(values) == 0) return
      call write_at(scratch%descriptor, width*before, c_loc(values), width*size(values, kind=int64), failed)
      if (failed) call fatal_error(error, status%io, scratch%directory// &
         ": a scratch file cannot be written there: is the disk full? Name another directory by TMPDIR")
   end subroutine write_scratch

   !> Reads numbers from a place that was written.
   subroutine read_scratch(scratch, before, values, error)
      !> Open
      type(scratch_type), intent(in) :: scratch
      !> Numbers before the first of these
      integer(int64), intent(in) :: before
      !> As written
      real(dp), intent(out), contiguous, target :: values(:)
      !> io: the disk fails, or nothing was written there
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: got
      logical :: failed

      if (size(values) == 0) return
      call read_at(scratch%descriptor, width*before, c_loc(values), width*size(values, kind=int64), got, failed)
      if (failed .or. got < width*size(values, kind=int64)) call fatal_error(error, status%io, scratch%directory// &
         ": a scratch file cannot be read back")
   end subroutine read_scratch

   !> Closes the file, which frees its room on the disk; harmless where it is not open.
   subroutine close_scratch(scratch)
      !> Not open afterwards
      type(scratch_type), intent(inout) :: scratch
      integer(c_int) :: ignored

      if (scratch%descriptor >= 0) ignored = c_close(scratch%descriptor)
      scratch%descriptor = -1
   end subroutine close_scratch

end module gyroakf_io_scratch
