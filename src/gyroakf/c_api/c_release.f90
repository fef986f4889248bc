! SPDX-License-Identifier: MIT
!> C interface, the release and the texts of the statuses.
module gyroakf_c_api_c_release
   use, intrinsic :: iso_c_binding, only : c_ptr, c_int, c_char, c_null_char, c_loc
   use gyroakf_error, only : status_texts
   use gyroakf_release, only : release_number, release_string
   implicit none (type, external)
   private
   public :: gyroakf_version, gyroakf_version_string, gyroakf_status_string

   integer :: i
   integer, parameter :: last = ubound(status_texts, 1), width = len(status_texts) + 1

   ! C needs addresses, and a constant has none; nothing writes to these
   character(width, c_char), target, protected :: known_texts(0:last) = &
      & [character(width, c_char) :: (trim(status_texts(i))//c_null_char, i=0, last)]
   character(width, c_char), target, protected :: unknown_text = "unknown status"//c_null_char
   character(width, c_char), target, protected :: release_text = release_string//c_null_char

contains

   !> `int gyroakf_version(void)`
   pure integer(c_int) function gyroakf_version() bind(C)
      gyroakf_version = release_number
   end function gyroakf_version

   !> `const char *gyroakf_version_string(void)`
   type(c_ptr) function gyroakf_version_string() bind(C)
      gyroakf_version_string = c_loc(release_text)
   end function gyroakf_version_string

   !> `const char *gyroakf_status_string(int status)`
   type(c_ptr) function gyroakf_status_string(code) bind(C)
      integer(c_int), intent(in), value :: code

      gyroakf_status_string = c_loc(unknown_text)
      if (code >= 0 .and. code <= last) gyroakf_status_string = c_loc(known_texts(code))
   end function gyroakf_status_string

end module gyroakf_c_api_c_release
