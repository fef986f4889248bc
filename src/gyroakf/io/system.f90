! SPDX-License-Identifier: MIT
!> The calls of the system (POSIX) that read and write files: explicit interfaces, and the two loops that no call spares.
module gyroakf_io_system
   use, intrinsic :: iso_c_binding, only : c_char, c_f_pointer, c_int, c_loc, c_long, c_ptr, c_short, c_size_t
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: c_open, c_read, c_close, c_poll, poll_type
   public :: c_creat, c_write, c_rename, c_unlink, c_getpid, c_mkdir
   public :: read_at, write_all

   !> `struct pollfd` of poll.h
   type, bind(C) :: poll_type
      integer(c_int) :: descriptor
      integer(c_short) :: events, happened
   end type poll_type

   !> A call that fails is tried again so often: signals interrupt it, and a descriptor may be non-blocking
   integer, parameter :: most_tries = 1000

   abstract interface
      !> What is done with a path, with flags or a mode: a descriptor, or whether it failed
      function path_flag_call(path, flags) result(answer) bind(C)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: flags
         integer(c_int) :: answer
      end function path_flag_call

      !> Moves bytes between a buffer and a file that is open: how many
      function buffer_call(descriptor, buffer, count) result(moved) bind(C)
         import :: c_int, c_long, c_ptr, c_size_t
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         type(c_ptr), intent(in), value :: buffer
         integer(c_size_t), intent(in), value :: count
         integer(c_long) :: moved
      end function buffer_call
   end interface

   procedure(path_flag_call), bind(C, name="open") :: c_open
   procedure(path_flag_call), bind(C, name="creat") :: c_creat
   procedure(path_flag_call), bind(C, name="mkdir") :: c_mkdir
   procedure(buffer_call), bind(C, name="read") :: c_read
   procedure(buffer_call), bind(C, name="write") :: c_write

   interface
      function c_pread(descriptor, buffer, count, offset) result(got) bind(C, name="pread")
         import :: c_int, c_long, c_ptr, c_size_t
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         type(c_ptr), intent(in), value :: buffer
         integer(c_size_t), intent(in), value :: count
         integer(c_long), intent(in), value :: offset
         integer(c_long) :: got
      end function c_pread

      function c_close(descriptor) result(failed) bind(C, name="close")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: failed
      end function c_close

      function c_poll(descriptors, count, milliseconds) result(ready) bind(C, name="poll")
         import :: c_int, c_long, poll_type
         implicit none (type, external)
         type(poll_type), intent(inout) :: descriptors(*)
         integer(c_long), intent(in), value :: count
         integer(c_int), intent(in), value :: milliseconds
         integer(c_int) :: ready
      end function c_poll

      function c_unlink(path) result(failed) bind(C, name="unlink")
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: failed
      end function c_unlink

      function c_rename(old, new) result(failed) bind(C, name="rename")
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: old(*), new(*)
         integer(c_int) :: failed
      end function c_rename

      function c_getpid() result(process) bind(C, name="getpid")
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: process
      end function c_getpid
   end interface

contains

   !> Reads at a place until the buffer is full or the file ends; several threads may read one file at a time.
   subroutine read_at(descriptor, offset, address, bytes, got, failed)
      !> Of a regular file
      integer(c_int), intent(in) :: descriptor
      !> Bytes before the first that is read
      integer(int64), intent(in) :: offset
      !> The buffer, and its size
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: bytes
      !> Bytes read; fewer than `bytes` only at the end of the file and where the system refuses
      integer(int64), intent(out) :: got
      !> True where the system refuses
      logical, intent(out) :: failed
      integer(int8), pointer, contiguous :: buffer(:)
      integer(c_long) :: piece
      integer :: tries

      got = 0
      failed = .false.
      if (bytes == 0) return
      call c_f_pointer(address, buffer, [bytes])
      tries = 0
      do while (got < bytes .and. .not. failed)
         piece = c_pread(descriptor, c_loc(buffer(got + 1)), int(bytes - got, c_size_t), int(offset + got, c_long))
         if (piece == 0) return
         tries = merge(0, tries + 1, piece > 0)
         got = got + max(piece, 0_c_long)
         failed = tries > most_tries
      end do
   end subroutine read_at

   !> Writes bytes, which the system may take in pieces.
   subroutine write_all(descriptor, address, bytes, failed)
      !> Open
      integer(c_int), intent(in) :: descriptor
      !> The first byte, and how many
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: bytes
      !> True where the system takes no more: a full disk, a closed pipe
      logical, intent(out) :: failed
      integer(int8), pointer, contiguous :: piece(:)
      integer(int64) :: from
      integer(c_long) :: done
      integer :: tries

      failed = .false.
      if (bytes == 0) return
      call c_f_pointer(address, piece, [bytes])
      from = 1
      tries = 0
      do while (from <= bytes .and. .not. failed)
         done = c_write(descriptor, c_loc(piece(from)), int(bytes - from + 1, c_size_t))
         tries = merge(0, tries + 1, done > 0)
         from = from + max(done, 0_c_long)
         failed = tries > most_tries
      end do
   end subroutine write_all

end module gyroakf_io_system
