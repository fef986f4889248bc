! SPDX-License-Identifier: MIT
!> Runs the suites that the driver names, all of them or those asked for on the command line, and
!> counts the tests.
!>
!> The state is the module's: the main program holds nothing, and so nothing can leak there.
module suite_runner
   use, intrinsic :: iso_fortran_env, only : int64, output_unit
   use testdrive, only : get_argument, run_selected, run_testsuite, select_test, unittest_type
   implicit none (type, external)
   private
   public :: add, finish

   abstract interface
      !> Returns the tests of a suite
      subroutine collect_interface(testsuite)
         import :: unittest_type
         implicit none (type, external)
         type(unittest_type), allocatable, intent(out) :: testsuite(:)
      end subroutine collect_interface
   end interface

   !> Tests that ran
   integer :: total = 0
   !> Tests that failed
   integer :: failures = 0
   !> Suites that ran
   integer :: suites = 0

contains

   !> Runs a suite, unless the command line asks for another one.
   subroutine add(name, collect)
      !> Name of the suite
      character(*), intent(in) :: name
      !> Returns its tests
      procedure(collect_interface) :: collect

      type(unittest_type), allocatable :: tests(:)
      character(:), allocatable :: wanted_suite, wanted_test
      integer :: before
      integer(int64) :: start, now, rate

      call get_argument(1, wanted_suite)
      call get_argument(2, wanted_test)
      if (allocated(wanted_suite)) then
         if (wanted_suite /= name) return
      end if

      write (output_unit, "(a)") "# Testing: "//name
      flush (output_unit)
      suites = suites + 1
      before = failures
      call system_clock(start, rate)
      call collect(tests)
      if (.not. allocated(wanted_test)) then
         total = total + size(tests)
         call run_testsuite(collect, output_unit, failures, parallel=.false.)
      else if (select_test(tests, wanted_test) > 0) then
         total = total + 1
         call run_selected(collect, wanted_test, output_unit, failures)
      else
         call report_unknown(tests, wanted_test)
      end if
      call system_clock(now)
      write (output_unit, '("# ", a, ": ", i0, " failed,", f7.2, " s")') name, failures - before, &
         & real(now - start)/real(rate)
      flush (output_unit)
   end subroutine add

   !> Says that there is no such test, and which there are.
   subroutine report_unknown(tests, name)
      !> Tests of the suite
      type(unittest_type), intent(in) :: tests(:)
      !> What was asked for
      character(*), intent(in) :: name

      integer :: i

      write (output_unit, "(a)") "No test '"//name//"'; there are:"
      do i = 1, size(tests)
         write (output_unit, "(a)") "  "//tests(i)%name
      end do
      failures = failures + 1
      total = total + 1
   end subroutine report_unknown

   !> Prints the count as the last line; true if a test failed or nothing ran.
   logical function finish()
      if (suites == 0) then
         write (output_unit, "(a)") "No such suite"
         failures = failures + 1
         total = total + 1
      end if
      write (output_unit, '(i0, " passed, ", i0, " failed")') total - failures, failures
      flush (output_unit)
      finish = failures > 0
   end function finish

end module suite_runner
