! SPDX-License-Identifier: MIT
!> Length and SHA-256 of a file, by which it is known again: those of `wc -c` and `sha256sum`.
module gyroakf_io_checksum
   use gyroakf_kinds, only : int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_io_source, only : close_source, has_places, is_directory, open_source, read_block, source_type
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_sha256, only : add_bytes, finish_sha256, sha256_type
   implicit none (type, external)
   private
   public :: checksum_type, sum_file

   !> What a file is known by
   type :: checksum_type
      !> False of what can be read only once (standard input, a pipe), and of a file that is not there or empty
      logical :: known = .false.
      !> Its length
      integer(int64) :: bytes = 0
      !> 64 hexadecimal digits, lower case
      character(64) :: sha256 = ""
   end type checksum_type

   !> Bytes read at a time
   integer(int64), parameter :: room_bytes = 1048576_int64

contains

   !> Reads a file once, from its first byte to its last.
   !>
   !> A file that cannot be opened is left to who reads it: that is no error here.
   subroutine sum_file(path, checksum, error, progress)
      !> "-" is standard input, which is not touched; nor is a pipe
      character(*), intent(in) :: path
      !> Not known where there is nothing that can be read twice
      type(checksum_type), intent(out) :: checksum
      !> io: cannot be read to its end; cancelled, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      integer(int8), allocatable :: room(:)
      type(source_type) :: source
      type(sha256_type) :: hash
      integer(int64) :: got, length
      integer :: stat

      if (path == "-" .or. is_directory(path)) return
      length = 0
      inquire (file=path, size=length)
      if (length <= 0) return                                  ! opening a pipe would wait for who writes it
      allocate (room(room_bytes), stat=stat)
      if (stat /= 0) call fatal_error(error, status%no_memory, "no memory for the checksum of "//path)
      if (allocated(error)) return
      call open_source(source, path, error)
      if (allocated(error) .or. .not. has_places(source)) then
         if (allocated(error)) deallocate (error)
         call close_source(source)
         return
      end if
      do
         call read_block(source, room, got, error)
         if (allocated(error) .or. got == 0) exit
         call add_bytes(hash, room(:got))
         checksum%bytes = checksum%bytes + got
         call tell_progress("making the checksum", checksum%bytes, source%length, error, progress)
         if (allocated(error)) exit
      end do
      call close_source(source)
      if (allocated(error)) return
      call finish_sha256(hash, checksum%sha256)
      checksum%known = .true.
   end subroutine sum_file

end module gyroakf_io_checksum
