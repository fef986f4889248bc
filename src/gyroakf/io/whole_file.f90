! SPDX-License-Identifier: MIT
!> A file of modest size as one text.
module gyroakf_io_whole_file
   use gyroakf_kinds, only : int64
   use gyroakf_error, only : error_type, fatal_error, status
   implicit none (type, external)
   private
   public :: read_whole_file

   !> Bytes; what is larger is no text that a page takes in
   integer(int64), parameter :: most_bytes = 100000000_int64

contains

   !> Reads all bytes of a file.
   subroutine read_whole_file(path, text, error)
      !> A regular file, 100 MB at most
      character(*), intent(in) :: path
      !> Its bytes
      character(:), allocatable, intent(out) :: text
      !> io, no_memory
      type(error_type), allocatable, intent(out) :: error
      integer(int64) :: bytes
      integer :: unit, failed

      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", action="read", iostat=failed)
      if (failed == 0) then
         inquire (unit=unit, size=bytes)
         if (bytes < 0 .or. bytes > most_bytes) failed = 1
         if (failed == 0) then
            allocate (character(bytes) :: text, stat=failed)
            if (failed /= 0) then
               close (unit)
               call fatal_error(error, status%no_memory, "no memory to read "//path)
               return
            end if
            read (unit, iostat=failed) text
         end if
         close (unit)
      end if
      if (failed /= 0) call fatal_error(error, status%io, path//": cannot be read")
   end subroutine read_whole_file

end module gyroakf_io_whole_file
