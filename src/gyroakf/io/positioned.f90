! SPDX-License-Identifier: MIT
!> Bytes of a regular file from any place, by POSIX's `pread`: several threads may read the same file at once.
module gyroakf_io_positioned
   use, intrinsic :: iso_c_binding, only : c_char, c_f_pointer, c_int, c_int64_t, c_loc, c_long, c_null_char, c_ptr, c_size_t
   use gyroakf_kinds, only : int8, int64
   implicit none (type, external)
   private
   public :: open_positioned, read_at, close_positioned

   !> A read that a signal interrupts is tried again so often
   integer, parameter :: most_tries = 100

   interface
      function c_open(path, flags) result(descriptor) bind(C, name="open")
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(in), value :: flags
         integer(c_int) :: descriptor
      end function c_open

      function c_pread(descriptor, buffer, count, offset) result(got) bind(C, name="pread")
         import :: c_int, c_int64_t, c_long, c_ptr, c_size_t
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         type(c_ptr), intent(in), value :: buffer
         integer(c_size_t), intent(in), value :: count
         integer(c_int64_t), intent(in), value :: offset
         integer(c_long) :: got
      end function c_pread

      function c_close(descriptor) result(failed) bind(C, name="close")
         import :: c_int
         implicit none (type, external)
         integer(c_int), intent(in), value :: descriptor
         integer(c_int) :: failed
      end function c_close
   end interface

contains

   !> Opens a regular file.
   integer function open_positioned(path) result(descriptor)
      !> It exists; negative result: it may not be read
      character(*), intent(in) :: path

      descriptor = int(c_open(path//c_null_char, 0_c_int))
   end function open_positioned

   !> Reads bytes until the room is full or the file ends.
   subroutine read_at(descriptor, offset, address, bytes, got)
      !> Of [[open_positioned]]
      integer, intent(in) :: descriptor
      !> The first byte, from 0
      integer(int64), intent(in) :: offset
      !> The room
      type(c_ptr), intent(in) :: address
      !> Its size
      integer(int64), intent(in) :: bytes
      !> Fewer than the room has where the file ends or cannot be read
      integer(int64), intent(out) :: got
      integer(int8), pointer, contiguous :: room(:)
      integer(c_long) :: piece
      integer :: tries

      call c_f_pointer(address, room, [bytes])
      got = 0
      tries = 0
      do while (got < bytes .and. tries < most_tries)
         piece = c_pread(int(descriptor, c_int), c_loc(room(got + 1)), int(bytes - got, c_size_t), &
                         int(offset + got, c_int64_t))
         if (piece == 0) exit
         tries = merge(0, tries + 1, piece > 0)
         got = got + max(piece, 0_c_long)
      end do
   end subroutine read_at

   !> Closes the file; harmless where it is closed.
   subroutine close_positioned(descriptor)
      !> -1 afterwards
      integer, intent(inout) :: descriptor
      integer(c_int) :: ignored

      if (descriptor >= 0) ignored = c_close(int(descriptor, c_int))
      descriptor = -1
   end subroutine close_positioned

end module gyroakf_io_positioned
