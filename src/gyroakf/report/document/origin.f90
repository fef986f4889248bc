! SPDX-License-Identifier: MIT
!> How a document was made: command, options and files, so that the run can be repeated.
module gyroakf_report_document_origin
   use gyroakf_io_checksum, only : checksum_type
   use gyroakf_record, only : text_type, add_text
   use gyroakf_report_json, only : json_type, open_object, close_object, open_array, close_array, put_member, put_null, put_json
   implicit none (type, external)
   private
   public :: origin_type, setting_type, input_file_type, put_origin

   !> An option of the program and its value
   type :: setting_type
      !> Without its dashes
      character(:), allocatable :: name
      !> As a value of JSON: a number, a text in quotes, true, false; null where it is not given and has no default
      character(:), allocatable :: value
      !> The user gave it; the others are defaults
      logical :: given = .false.
   end type setting_type

   !> A file that was read
   type :: input_file_type
      !> The option that named it, without its dashes; unallocated: the recording itself
      character(:), allocatable :: option
      !> As it was given
      character(:), allocatable :: path
      !> By which it is known again
      type(checksum_type) :: checksum
   end type input_file_type

   !> The run
   type :: origin_type
      !> run, inspect, allan, ...
      character(:), allocatable :: command
      !> [number of options] every option of the command, with its effective value
      type(setting_type), allocatable :: setting(:)
      !> [number of files] the recording first
      type(input_file_type), allocatable :: file(:)
   end type origin_type

contains

   !> The member "origin": null where nobody knows, as in the library.
   subroutine put_origin(json, origin)
      !> The document
      type(json_type), intent(inout) :: json
      !> The run; may be absent
      type(origin_type), intent(in), optional :: origin
      type(text_type), allocatable :: given(:)
      integer :: i

      if (.not. present(origin)) then
         call put_null(json, "origin")
         return
      end if
      call open_object(json, "origin")
      call put_member(json, "command", origin%command)
      allocate (given(0))
      call open_object(json, "options")
      do i = 1, size(origin%setting)
         call put_json(json, origin%setting(i)%name, origin%setting(i)%value)
         if (origin%setting(i)%given) call add_text(given, origin%setting(i)%name)
      end do
      call close_object(json)
      call put_member(json, "given", given)
      call open_array(json, "files")
      do i = 1, size(origin%file)
         call put_file(json, origin%file(i))
      end do
      call close_array(json)
      call close_object(json)
   end subroutine put_origin

   !> One file; a checksum that is not known is null.
   subroutine put_file(json, file)
      type(json_type), intent(inout) :: json
      type(input_file_type), intent(in) :: file

      call open_object(json)
      if (allocated(file%option)) then
         call put_member(json, "option", file%option)
      else
         call put_null(json, "option")
      end if
      call put_member(json, "path", file%path)
      if (file%checksum%known) then
         call put_member(json, "bytes", file%checksum%bytes)
         call put_member(json, "sha256", file%checksum%sha256)
      else
         call put_null(json, "bytes")
         call put_null(json, "sha256")
      end if
      call close_object(json)
   end subroutine put_file

end module gyroakf_report_document_origin
