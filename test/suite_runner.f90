! SPDX-License-Identifier: MIT
!> Runs the suites that the driver names, all of them or those asked for on the command line, and
!> counts the tests.
!>
!> The state is the module's: the main program holds nothing, and so nothing can leak there.
module suite_runner
   use, intrinsic :: iso_fortran_env, only : int64, output_unit
   use expectations, only : failures, is_wanted, test_interface, total
   implicit none (type, external)
   private
   public :: add, finish

   !> Suites that ran
   integer :: suites = 0

contains

   !> Runs a suite, unless the command line asks for another one.
   subroutine add(name, suite)
      !> Name of the suite
      character(*), intent(in) :: name
      !> Runs its tests
      procedure(test_interface) :: suite

      integer :: failures_before, total_before
      integer(int64) :: start, now, rate

      if (.not. is_wanted(1, name)) return
      write (output_unit, "(a)") "# Testing: "//name
      flush (output_unit)
      suites = suites + 1
      failures_before = failures
      total_before = total
      call system_clock(start, rate)
      call suite()
      call system_clock(now)
      if (total == total_before) call complain("No such test")
      write (output_unit, '("# ", a, ": ", i0, " failed,", f7.2, " s")') name, &
         & failures - failures_before, real(now - start)/real(rate)
      flush (output_unit)
   end subroutine add

   !> What was asked for is not there: a failure.
   subroutine complain(message)
      !> What is not there
      character(*), intent(in) :: message

      write (output_unit, "(a)") message
      failures = failures + 1
      total = total + 1
   end subroutine complain

   !> Prints the count as the last line; true if a test failed or nothing ran.
   logical function finish()
      if (suites == 0) call complain("No such suite")
      write (output_unit, '(i0, " passed, ", i0, " failed")') total - failures, failures
      flush (output_unit)
      finish = failures > 0
   end function finish

end module suite_runner
