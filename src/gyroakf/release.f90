! SPDX-License-Identifier: MIT
!> The release of the library: one place for Fortran, C and the command line.
module gyroakf_release
   implicit none (type, external)
   private
   public :: release_major, release_minor, release_patch, release_string, release_number

   integer, parameter :: release_major = 0
   integer, parameter :: release_minor = 1
   integer, parameter :: release_patch = 0

   !> "major.minor.patch", equal to `version` in fpm.toml (a test compares them)
   character(*), parameter :: release_string = "0.1.0"

   !> 10000 major + 100 minor + patch, as `gyroakf_version()` returns it
   integer, parameter :: release_number = 10000*release_major + 100*release_minor + release_patch

end module gyroakf_release
