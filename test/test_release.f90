! SPDX-License-Identifier: MIT
!> Tests of the release constants: one version everywhere.
module test_release
   use gyroakf_release, only : release_major, release_minor, release_number, release_patch, release_string
   use expectations, only : test, error, check
   implicit none (type, external)
   private
   public :: suite_release

contains

   subroutine suite_release()
      call test("numbers", test_numbers)
      call test("manifest", test_manifest)
   end subroutine suite_release

   !> The text and the number are made of the same three parts.
   subroutine test_numbers()
      character(32) :: text

      write (text, '(i0, ".", i0, ".", i0)') release_major, release_minor, release_patch
      call check(error, release_string, trim(text))
      call check(error, release_number, 10000*release_major + 100*release_minor + release_patch)
   end subroutine test_numbers

   !> fpm.toml, read from the directory in which fpm runs the tests, has the same version.
   subroutine test_manifest()
      character(*), parameter :: key = "version = """
      character(256) :: line
      integer :: unit, stat

      open (newunit=unit, file="fpm.toml", status="old", action="read", iostat=stat)
      call check(error, stat == 0, "fpm.toml cannot be opened: run the tests from the root of the project")
      do
         read (unit, "(a)", iostat=stat) line
         if (stat /= 0) exit
         if (index(line, key) == 1) exit
      end do
      close (unit)
      if (stat /= 0) then
         call check(error, .false., "no version in fpm.toml")
      else
         call check(error, trim(line), key//release_string//"""", "fpm.toml and release_string differ")
      end if
   end subroutine test_manifest

end module test_release
