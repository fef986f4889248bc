! SPDX-License-Identifier: MIT
!> The self-test passes, and a wrong value fails it; one version everywhere.
module test_selftest
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : fatal_error, status
   use gyroakf_io_writer, only : commit_writer, open_writer, writer_type
   use gyroakf_report_selftest_report, only : report_selftest, selftest_sum
   use gyroakf_selftest, only : add_check, run_selftest, selftest_type
   use json_reader, only : file_text
   use scratch_file, only : scratch_path, remove_file
   use expectations, only : failure => problem, test, error, check, went_wrong
   use gyroakf_release, only : release_major, release_minor, release_number, release_patch, &
      & release_string
   implicit none (type, external)
   private
   public :: suite_selftest, suite_release

contains

   subroutine suite_selftest()
      call test("all_agree", test_all_agree)
      call test("every_check_can_fail", test_can_fail)
      call test("wrong_value_fails", test_wrong_value)
      call test("report", test_report)
   end subroutine suite_selftest

   subroutine suite_release()
      call test("numbers", test_numbers)
      call test("manifest", test_manifest)
   end subroutine suite_release

   subroutine test_all_agree()
      type(selftest_type) :: result
      integer :: i

      call run_selftest(result)
      do i = 1, size(result%check)
         call check(error, result%check(i)%passed, trim(result%check(i)%group)//": "//trim(result%check(i)%name))
      end do
      call check(error, result%failed, 0)
      call check(error, size(result%check), 32)
   end subroutine test_all_agree

   !> A value that is wrong in its sixth digit fails every check, and no name is cut.
   subroutine test_can_fail()
      type(selftest_type) :: result
      integer :: i

      call run_selftest(result)
      do i = 1, size(result%check)
         associate (of => result%check(i))
            call check(error, of%tolerance <= 1.0e-6_dp*abs(of%expected), "tolerance of "//of%name)
            call check(error, len_trim(of%name) < len(of%name) .and. len_trim(of%group) < len(of%group), of%name)
         end associate
         if (allocated(error)) return
      end do
   end subroutine test_can_fail

   !> Right and wrong values, and what is not there.
   subroutine make_result(result)
      type(selftest_type), intent(out) :: result

      allocate (result%check(0))
      call add_check(result, "a group", "right", [1.0_dp, 2.0_dp], [1.0_dp, 2.0_dp + 1.0e-11_dp], .false.)
      call add_check(result, "a group", "wrong", [1.0_dp, 2.0_dp], [1.0_dp, 2.0_dp + 3.0e-11_dp], .false.)
      call add_check(result, "a group", "printed", [91.22945_dp], [91.229454_dp], .true.)
      call add_check(result, "a group", "misprinted", [91.22945_dp], [91.229456_dp], .true.)
      call add_check(result, "a group", "zero", [0.0_dp], [1.0e-300_dp], .false.)
      call add_check(result, "a group", "no number", [1.0_dp], [ieee_value(1.0_dp, ieee_quiet_nan)], .false.)
      call add_check(result, "a group", "too few", [1.0_dp, 2.0_dp], [1.0_dp], .false.)
      call fatal_error(failure, status%singular, "the matrix is singular")
      call add_check(result, "a group", "failed", [1.0_dp], [1.0_dp], .false., failure)
   end subroutine make_result

   subroutine test_wrong_value()
      type(selftest_type) :: result

      call make_result(result)
      call check(error, all(result%check%passed .eqv. [.true., .false., .true., .false., .false., .false., .false., .false.]), &
                 "which ones")
      call check(error, result%check(2)%expected, 2.0_dp)
      call check(error, selftest_sum(result), "8 checks, 6 FAILED")
   end subroutine test_wrong_value

   subroutine test_report()
      type(selftest_type) :: result
      type(writer_type) :: writer
      character(:), allocatable :: text

      call make_result(result)
      call open_writer(writer, scratch_path("selftest.txt"), failure)
      call report_selftest(writer, result)
      call commit_writer(writer, failure)
      if (went_wrong(failure, "the report is written")) return
      text = file_text(scratch_path("selftest.txt"))
      call remove_file(scratch_path("selftest.txt"))
      call check(error, index(text, "9.122945e+01  ok") > 0 .and. index(text, "9.122946e+01  FAILED") > 0, text)
      call check(error, index(text, "the matrix is singular") > 0 .and. index(text, "8 checks, 6 FAILED") > 0, text)
   end subroutine test_report

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

end module test_selftest
