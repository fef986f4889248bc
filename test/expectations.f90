! SPDX-License-Identifier: MIT
!> Tests by name, and what they expect. A check after one that failed does nothing: the first failure of a test is
!> reported.
module expectations
   use, intrinsic :: iso_fortran_env, only : output_unit
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_kinds, only : dp, int64
   use testdrive, only : error_type, get_argument, new_unittest, run_testsuite, test_check => check, &
      unittest_type
   implicit none (type, external)
   private
   public :: test, error, problem, check, unmet, agree, check_refused, went_wrong
   public :: test_interface, is_wanted, total, failures

   abstract interface
      !> Runs the tests of a suite, or one test
      subroutine test_interface()
         implicit none (type, external)
      end subroutine test_interface

   end interface

   !> First failure of the test that runs
   type(error_type), allocatable :: error
   !> What the library said last in the test that runs
   type(gyro_error), allocatable :: problem
   !> Tests that ran, and those of them that failed
   integer :: total = 0, failures = 0
   !> The test that test-drive is to run
   character(:), allocatable :: due_name
   procedure(test_interface), pointer :: due => null()

   !> Fails unless an expression is true, or a value is the expected one
   interface check
      module procedure check_logical, check_real, check_integer, check_long, check_text
   end interface check

   !> Checks the same; whether the test has failed
   interface unmet
      module procedure unmet_logical, unmet_integer, unmet_long, unmet_text
   end interface unmet

contains

   !> Runs a test, unless the command line asks for another one.
   subroutine test(name, run)
      !> Name of the test
      character(*), intent(in) :: name
      !> The test, which leaves its first failure in `error`
      procedure(test_interface) :: run

      if (.not. is_wanted(2, name)) return
      total = total + 1
      if (allocated(problem)) deallocate (problem)
      due_name = name
      due => run
      call run_testsuite(collect, output_unit, failures, parallel=.false.)
   end subroutine test

   !> The test that is due, as a suite of test-drive.
   subroutine collect(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [new_unittest(due_name, run_due)]
   end subroutine collect

   subroutine run_due(failure)
      type(error_type), allocatable, intent(out) :: failure

      call due()
      if (allocated(error)) call move_alloc(error, failure)
   end subroutine run_due

   !> Whether an argument of the command line is this name, or is not there.
   logical function is_wanted(place, name)
      !> Which argument
      integer, intent(in) :: place
      !> What it may be
      character(*), intent(in) :: name

      character(:), allocatable :: wanted

      call get_argument(place, wanted)
      is_wanted = .true.
      if (allocated(wanted)) is_wanted = wanted == name
   end function is_wanted

   subroutine check_logical(error, expression, message, more)
      type(error_type), allocatable, intent(inout) :: error
      logical, intent(in) :: expression
      character(*), intent(in), optional :: message, more

      if (.not. allocated(error)) call test_check(error, expression, message, more)
   end subroutine check_logical

   subroutine check_real(error, actual, expected, message, more, thr, rel)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      !> Difference allowed, relative to the expected value with `rel`
      real(dp), intent(in), optional :: thr
      logical, intent(in), optional :: rel

      if (.not. allocated(error)) call test_check(error, actual, expected, message, more, thr, rel)
   end subroutine check_real

   subroutine check_integer(error, actual, expected, message, more)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      if (.not. allocated(error)) call test_check(error, actual, expected, message, more)
   end subroutine check_integer

   subroutine check_long(error, actual, expected, message, more)
      type(error_type), allocatable, intent(inout) :: error
      integer(int64), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      if (.not. allocated(error)) call test_check(error, actual, expected, message, more)
   end subroutine check_long

   subroutine check_text(error, actual, expected, message, more)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      if (.not. allocated(error)) call test_check(error, actual, expected, message, more)
   end subroutine check_text

   logical function unmet_logical(expression, message, more) result(unmet)
      logical, intent(in) :: expression
      character(*), intent(in), optional :: message, more

      call check(error, expression, message, more)
      unmet = allocated(error)
   end function unmet_logical

   logical function unmet_integer(actual, expected, message, more) result(unmet)
      integer, intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      call check(error, actual, expected, message, more)
      unmet = allocated(error)
   end function unmet_integer

   logical function unmet_long(actual, expected, message, more) result(unmet)
      integer(int64), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      call check(error, actual, expected, message, more)
      unmet = allocated(error)
   end function unmet_long

   logical function unmet_text(actual, expected, message, more) result(unmet)
      character(*), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more

      call check(error, actual, expected, message, more)
      unmet = allocated(error)
   end function unmet_text

   !> Fails unless actual agrees with expected, relatively.
   subroutine agree(actual, expected, allowed, what)
      !> Results, expected values, relative error allowed
      real(dp), intent(in) :: actual(:), expected(:), allowed
      character(*), intent(in), optional :: what
      character(200) :: text
      integer :: i

      call check(error, size(actual), size(expected), "number of values", what)
      if (allocated(error)) return
      do i = 1, size(expected)
         write (text, '("number ", i0, ": ", es24.16e3, " is not ", es24.16e3)') i, actual(i), expected(i)
         call check(error, abs(actual(i) - expected(i)) <= allowed*abs(expected(i)), trim(text), &
            & what)
         if (allocated(error)) return
      end do
   end subroutine agree

   !> Fails unless the library refused, with this code.
   subroutine check_refused(said, code)
      type(gyro_error), allocatable, intent(in) :: said
      !> What it should have said, one of `status`
      integer, intent(in) :: code

      call check(error, allocated(said), "bad input was accepted")
      if (allocated(error)) return
      call check(error, said%code, code, said%message)
   end subroutine check_refused

   !> Whether the test has failed; it fails where the library says that something is wrong.
   logical function went_wrong(said, what)
      type(gyro_error), allocatable, intent(in) :: said
      !> Which case it is
      character(*), intent(in), optional :: what

      if (allocated(said)) call check(error, .false., said%message, what)
      went_wrong = allocated(error)
   end function went_wrong

end module expectations
