! SPDX-License-Identifier: MIT
!> The POSIX calls that read and write files: interfaces, and the loops that no call spares.
module gyroakf_io_system
   use, intrinsic :: iso_c_binding, only : c_char, c_f_pointer, c_int, c_loc, c_long, c_ptr, &
      c_short, c_size_t
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: c_open, c_read, c_close, c_poll, poll_type
   public :: c_creat, c_write, c_rename, c_unlink, c_getpid, c_mkdir
   public :: move_bytes

   !> `struct pollfd` of poll.h
   type, bind(C) :: poll_type
      integer(c_int) :: descriptor
      integer(c_short) :: events, happened
   end type poll_type

   !> A call that fails is tried again so often: after a signal, or of a non-blocking descriptor
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

   !> Reads from a place in a file, by several threads at a time, or writes to its end, in pieces.
   subroutine move_bytes(descriptor, address, bytes, moved, failed, offset)
      !> Open; of a regular file where it is read
      integer(c_int), intent(in) :: descriptor
      type(c_ptr), intent(in) :: address
      integer(int64), intent(in) :: bytes
      !> Fewer than `bytes` only at the end of a file that is read, and where the system refuses
      integer(int64), intent(out) :: moved
      !> True where the system refuses: a full disk, a closed pipe
      logical, intent(out) :: failed
      !> Bytes before the first that is read; the buffer is written if absent
      integer(int64), intent(in), optional :: offset
      integer(int8), pointer, contiguous :: buffer(:)
      integer(c_long) :: piece
      integer :: tries

      moved = 0
      failed = .false.
      if (bytes == 0) return
      call c_f_pointer(address, buffer, [bytes])
      tries = 0
      do while (moved < bytes .and. .not. failed)
         if (present(offset)) then
            piece = c_pread(descriptor, c_loc(buffer(moved + 1)), int(bytes - moved, c_size_t), &
               int(offset + moved, c_long))
            if (piece == 0) return
         else
            piece = c_write(descriptor, c_loc(buffer(moved + 1)), int(bytes - moved, c_size_t))
         end if
         tries = merge(0, tries + 1, piece > 0)
         moved = moved + max(piece, 0_c_long)
         failed = tries > most_tries
      end do
   end subroutine move_bytes

end module gyroakf_io_system
