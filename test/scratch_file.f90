! SPDX-License-Identifier: MIT
!> Files that a test makes and removes, in the directory for temporary files.
module scratch_file
   use, intrinsic :: iso_c_binding, only : c_char, c_int, c_null_char
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_kinds, only : int64
   use gyroakf_record, only : record_type
   implicit none (type, external)
   private
   public :: scratch_path, write_bytes, read_bytes, read_content, remove_file, remove_folder, &
      & file_exists

   interface
      function c_getpid() result(process) bind(C, name="getpid")
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: process
      end function c_getpid

      function c_rmdir(path) result(failed) bind(C, name="rmdir")
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: failed
      end function c_rmdir

   end interface

contains

   !> A path of this process in $TMPDIR or /tmp.
   function scratch_path(name) result(path)
      !> Last part of the path
      character(*), intent(in) :: name
      character(:), allocatable :: path
      character(256) :: directory
      character(12) :: process
      integer :: length, failed

      call get_environment_variable("TMPDIR", directory, length, failed)
      if (failed /= 0 .or. length == 0) directory = "/tmp"
      write (process, "(i0)") c_getpid()
      path = trim(directory)//"/gyroakf_"//trim(process)//"_"//name
   end function scratch_path

   !> Makes a file with exactly these bytes.
   subroutine write_bytes(path, content)
      character(*), intent(in) :: path, content
      integer :: unit

      open (newunit=unit, file=path, access="stream", form="unformatted", status="replace", action="write")
      write (unit) content
      close (unit)
   end subroutine write_bytes

   !> All bytes of a file.
   function read_bytes(path) result(content)
      character(*), intent(in) :: path
      character(:), allocatable :: content
      integer :: unit
      integer(int64) :: length

      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", action="read")
      inquire (unit=unit, size=length)
      allocate (character(length) :: content)
      if (length > 0) read (unit) content
      close (unit)
   end function read_bytes

   !> Reads a content as a record in a file of this name.
   subroutine read_content(content, name, options, record, failed)
      character(*), intent(in) :: content, name
      type(reader_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(gyro_error), allocatable, intent(out) :: failed

      call write_bytes(scratch_path(name), content)
      call read_record(scratch_path(name), options, record, failed)
      call remove_file(scratch_path(name))
   end subroutine read_content

   !> Removes a file; harmless where there is none.
   subroutine remove_file(path)
      character(*), intent(in) :: path
      integer :: unit, failed

      open (newunit=unit, file=path, status="old", iostat=failed)
      if (failed == 0) close (unit, status="delete")
   end subroutine remove_file

   !> Removes a folder; it stays where it is not empty.
   subroutine remove_folder(path)
      character(*), intent(in) :: path
      integer(c_int) :: ignored

      ignored = c_rmdir(path//c_null_char)
   end subroutine remove_folder

   !> True where there is a file.
   logical function file_exists(path)
      character(*), intent(in) :: path

      inquire (file=path, exist=file_exists)
   end function file_exists

end module scratch_file
