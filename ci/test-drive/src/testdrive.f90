! SPDX-License-Identifier: MIT
!> A small unit test framework with the interface of test-drive.
!>
!> A test is a module procedure with one argument, the error; it passes if it leaves that
!> unallocated. A suite is a procedure that returns an array of tests.
module testdrive
   use, intrinsic :: iso_fortran_env, only : real32, real64, int32, int64, error_unit
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_is_finite
   implicit none (type, external)
   private
   public :: error_type, unittest_type, testsuite_type
   public :: new_unittest, new_testsuite, select_suite, select_test
   public :: run_testsuite, run_selected
   public :: check, test_failed, skip_test, get_argument

   !> `stat` of an error that reports a failure
   integer, parameter :: failure = 1
   !> `stat` of an error that reports a test that could not be run
   integer, parameter :: skipped = 77
   !> Starts a line that continues another
   character(*), parameter :: line_break = new_line("a")//"  "

   !> The failure of a check
   type :: error_type
      !> 0 if the error was taken note of
      integer :: stat = 0
      !> What failed
      character(:), allocatable :: message
   contains
      !> An error that nobody looked at ends the run
      final :: report_lost
   end type error_type

   abstract interface
      !> A test: passes if `error` is not allocated on return
      subroutine test_interface(error)
         import :: error_type
         implicit none (type, external)
         !> The failure
         type(error_type), allocatable, intent(out) :: error
      end subroutine test_interface
   end interface

   !> A named test
   type :: unittest_type
      !> Name, as it is given on the command line
      character(:), allocatable :: name
      !> The procedure
      procedure(test_interface), pointer, nopass :: test => null()
      !> The test passes if the procedure fails
      logical :: should_fail = .false.
   end type unittest_type

   abstract interface
      !> Returns the tests of a suite
      subroutine collect_interface(testsuite)
         import :: unittest_type
         implicit none (type, external)
         !> The tests
         type(unittest_type), allocatable, intent(out) :: testsuite(:)
      end subroutine collect_interface
   end interface

   !> A named suite
   type :: testsuite_type
      !> Name, as it is given on the command line
      character(:), allocatable :: name
      !> The procedure that returns its tests
      procedure(collect_interface), pointer, nopass :: collect => null()
   end type testsuite_type

   !> Fails unless a status is 0, a logical is true, a real is finite, or an actual value is the expected one
   interface check
      module procedure :: check_stat
      module procedure :: check_true
      module procedure :: check_finite_real32
      module procedure :: check_finite_real64
      module procedure :: check_real32
      module procedure :: check_real64
      module procedure :: check_int32
      module procedure :: check_int64
      module procedure :: check_logical
      module procedure :: check_character
   end interface check

   !> A value as text
   interface text
      module procedure :: text_real32
      module procedure :: text_real64
      module procedure :: text_int64
      module procedure :: text_logical
   end interface text

contains

   !> A test from its name and procedure.
   function new_unittest(name, test, should_fail) result(self)
      !> Name of the test
      character(*), intent(in) :: name
      !> The test: a module procedure
      procedure(test_interface) :: test
      !> The test passes if the procedure fails
      logical, intent(in), optional :: should_fail
      type(unittest_type) :: self

      self%name = name
      self%test => test
      if (present(should_fail)) self%should_fail = should_fail
   end function new_unittest

   !> A suite from its name and the procedure that returns its tests.
   function new_testsuite(name, collect) result(self)
      !> Name of the suite
      character(*), intent(in) :: name
      !> Returns the tests: a module procedure
      procedure(collect_interface) :: collect
      type(testsuite_type) :: self

      self%name = name
      self%collect => collect
   end function new_testsuite

   !> Position of the suite with this name, 0 if there is none.
   integer function select_suite(suites, name) result(position)
      !> The suites
      type(testsuite_type), intent(in) :: suites(:)
      !> The name
      character(*), intent(in) :: name

      do position = size(suites), 1, -1
         if (suites(position)%name == name) exit
      end do
   end function select_suite

   !> Position of the test with this name, 0 if there is none.
   integer function select_test(tests, name) result(position)
      !> The tests
      type(unittest_type), intent(in) :: tests(:)
      !> The name
      character(*), intent(in) :: name

      do position = size(tests), 1, -1
         if (tests(position)%name == name) exit
      end do
   end function select_test

   !> Runs every test of a suite, one after the other.
   subroutine run_testsuite(collect, unit, stat, parallel)
      !> Returns the tests
      procedure(collect_interface) :: collect
      !> Where the report is written
      integer, intent(in) :: unit
      !> Grows by the number of failed tests
      integer, intent(inout) :: stat
      !> Taken for the interface's sake: tests never run in parallel here
      logical, intent(in), optional :: parallel

      type(unittest_type), allocatable :: tests(:)
      integer :: i

      if (present(parallel)) continue
      call collect(tests)
      do i = 1, size(tests)
         write (unit, '(a, " (", i0, "/", i0, ")")') "  Starting "//tests(i)%name//" ...", i, size(tests)
         flush (unit)
         call run_unittest(tests(i), unit, stat)
      end do
   end subroutine run_testsuite

   !> Runs the test of a suite that has this name.
   subroutine run_selected(collect, name, unit, stat)
      !> Returns the tests
      procedure(collect_interface) :: collect
      !> Name of the test
      character(*), intent(in) :: name
      !> Where the report is written
      integer, intent(in) :: unit
      !> Grows by 1 if the test fails; -1 if there is no such test
      integer, intent(inout) :: stat

      type(unittest_type), allocatable :: tests(:)
      integer :: i

      call collect(tests)
      i = select_test(tests, name)
      if (i > 0) then
         call run_unittest(tests(i), unit, stat)
      else
         write (unit, '(a)') "No test '"//name//"'; there are:"
         do i = 1, size(tests)
            write (unit, '(a)') "  - "//tests(i)%name
         end do
         stat = -1
      end if
   end subroutine run_selected

   !> Runs one test and reports on it.
   subroutine run_unittest(test, unit, stat)
      !> The test
      type(unittest_type), intent(in) :: test
      !> Where the report is written
      integer, intent(in) :: unit
      !> Grows by 1 if the test fails
      integer, intent(inout) :: stat

      type(error_type), allocatable :: error
      character(:), allocatable :: verdict

      call test%test(error)
      if (was_skipped(error)) then
         verdict = "[SKIPPED]"
      else if (allocated(error) .eqv. test%should_fail) then
         verdict = merge("[EXPECTED FAIL]", "[PASSED]       ", test%should_fail)
      else
         verdict = merge("[UNEXPECTED PASS]", "[FAILED]         ", test%should_fail)
         stat = stat + 1
      end if
      write (unit, '(a)') "       ... "//test%name//" "//trim(verdict)
      if (allocated(error)) then
         write (unit, '(a)') "  Message: "//error%message
         error%stat = 0
      end if
      flush (unit)
   end subroutine run_unittest

   !> Whether a test asked to be skipped.
   pure logical function was_skipped(error)
      !> What the test returned
      type(error_type), allocatable, intent(in) :: error

      was_skipped = .false.
      if (allocated(error)) was_skipped = error%stat == skipped
   end function was_skipped

   !> Ends the run: an error vanishes that nobody has taken note of.
   subroutine report_lost(error)
      !> The error that is about to be finalised
      type(error_type), intent(inout) :: error

      if (error%stat == 0) return
      write (error_unit, '(a)') "A failed check was not returned from: if (allocated(error)) return"
      if (allocated(error%message)) write (error_unit, '(a)') error%message
      error stop 1
   end subroutine report_lost

   !> Fails the test.
   subroutine test_failed(error, message, more, and_more)
      !> The failure, allocated here
      type(error_type), allocatable, intent(out) :: error
      !> What failed
      character(*), intent(in) :: message
      !> A second line
      character(*), intent(in), optional :: more
      !> A third line
      character(*), intent(in), optional :: and_more

      allocate (error)
      error%stat = failure
      error%message = message
      if (present(more)) error%message = error%message//line_break//more
      if (present(and_more)) error%message = error%message//line_break//and_more
   end subroutine test_failed

   !> Says that the test cannot be run here.
   subroutine skip_test(error, message, more, and_more)
      !> Allocated here
      type(error_type), allocatable, intent(out) :: error
      !> Why not
      character(*), intent(in) :: message
      !> A second line
      character(*), intent(in), optional :: more
      !> A third line
      character(*), intent(in), optional :: and_more

      call test_failed(error, message, more, and_more)
      error%stat = skipped
   end subroutine skip_test

   !> An argument of the command line; not allocated if there is none.
   subroutine get_argument(idx, arg)
      !> Its number, from 1
      integer, intent(in) :: idx
      !> The argument
      character(:), allocatable, intent(out) :: arg

      integer :: length, stat

      call get_command_argument(idx, length=length, status=stat)
      if (stat /= 0) return
      allocate (character(length) :: arg)
      if (length > 0) call get_command_argument(idx, arg, status=stat)
      if (stat /= 0) deallocate (arg)
   end subroutine get_argument

   !> Fails with the message of the caller, or with the two values.
   subroutine mismatch(error, what, actual, expected, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> What kind of values they are
      character(*), intent(in) :: what
      !> The actual value
      character(*), intent(in) :: actual
      !> The expected value
      character(*), intent(in) :: expected
      !> Message of the caller
      character(*), intent(in), optional :: message
      !> Second line of the caller
      character(*), intent(in), optional :: more

      character(:), allocatable :: values

      values = "expected "//expected//" but got "//actual
      if (present(message)) then
         call test_failed(error, message, values, more)
      else
         call test_failed(error, what//" mismatch: "//values, more)
      end if
   end subroutine mismatch

   !> Fails unless the status is 0.
   subroutine check_stat(error, stat, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Status of an operation
      integer, intent(in) :: stat
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (stat /= 0) call mismatch(error, "status", text(int(stat, int64)), "0", message, more)
   end subroutine check_stat

   !> Fails unless the expression is true.
   subroutine check_true(error, expression, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> A condition
      logical, intent(in) :: expression
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (expression) return
      if (present(message)) then
         call test_failed(error, message, more)
      else
         call test_failed(error, "condition not fulfilled", more)
      end if
   end subroutine check_true

   !> Fails if the value is NaN or infinite.
   subroutine check_finite_real32(error, actual, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> A value
      real(real32), intent(in) :: actual
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (.not. ieee_is_finite(actual)) call mismatch(error, "value", text(actual), "a finite value", message, more)
   end subroutine check_finite_real32

   !> Fails if the value is NaN or infinite.
   subroutine check_finite_real64(error, actual, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> A value
      real(real64), intent(in) :: actual
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (.not. ieee_is_finite(actual)) call mismatch(error, "value", text(actual), "a finite value", message, more)
   end subroutine check_finite_real64

   !> Fails unless |actual - expected| <= thr, or <= thr |expected| with `rel`.
   subroutine check_real32(error, actual, expected, message, more, thr, rel)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      real(real32), intent(in) :: actual
      !> Value that is right
      real(real32), intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more
      !> Allowed difference, default the spacing of 1
      real(real32), intent(in), optional :: thr
      !> The difference is relative to the expected value
      logical, intent(in), optional :: rel

      real(real64) :: threshold

      threshold = real(epsilon(1.0_real32), real64)
      if (present(thr)) threshold = real(thr, real64)
      if (.not. is_close(real(actual, real64), real(expected, real64), threshold, rel)) then
         call mismatch(error, "real", text(actual), text(expected), message, more)
      end if
   end subroutine check_real32

   !> Fails unless |actual - expected| <= thr, or <= thr |expected| with `rel`.
   subroutine check_real64(error, actual, expected, message, more, thr, rel)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      real(real64), intent(in) :: actual
      !> Value that is right
      real(real64), intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more
      !> Allowed difference, default the spacing of 1
      real(real64), intent(in), optional :: thr
      !> The difference is relative to the expected value
      logical, intent(in), optional :: rel

      real(real64) :: threshold

      threshold = epsilon(1.0_real64)
      if (present(thr)) threshold = thr
      if (.not. is_close(actual, expected, threshold, rel)) then
         call mismatch(error, "real", text(actual), text(expected), message, more)
      end if
   end subroutine check_real64

   !> Whether two reals agree; NaN agrees with nothing, an infinity only with itself.
   pure logical function is_close(actual, expected, thr, rel)
      !> Value that was computed
      real(real64), intent(in) :: actual
      !> Value that is right
      real(real64), intent(in) :: expected
      !> Allowed difference
      real(real64), intent(in) :: thr
      !> The difference is relative to |expected|
      logical, intent(in), optional :: rel

      real(real64) :: difference, allowed

      is_close = .false.
      if (ieee_is_nan(actual) .or. ieee_is_nan(expected) .or. ieee_is_nan(thr)) return
      is_close = actual == expected
      if (is_close .or. .not. (ieee_is_finite(actual) .and. ieee_is_finite(expected))) return
      ! halves, so that the difference of two huge values does not overflow
      difference = abs(0.5_real64*actual - 0.5_real64*expected)
      allowed = 0.5_real64*thr
      if (present(rel)) then
         if (rel) allowed = thr*(0.5_real64*abs(expected))
      end if
      is_close = difference <= allowed
   end function is_close

   !> Fails unless two integers are equal.
   subroutine check_int32(error, actual, expected, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      integer(int32), intent(in) :: actual
      !> Value that is right
      integer(int32), intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      call check_int64(error, int(actual, int64), int(expected, int64), message, more)
   end subroutine check_int32

   !> Fails unless two integers are equal.
   subroutine check_int64(error, actual, expected, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      integer(int64), intent(in) :: actual
      !> Value that is right
      integer(int64), intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (actual /= expected) call mismatch(error, "integer", text(actual), text(expected), message, more)
   end subroutine check_int64

   !> Fails unless two logicals are equal.
   subroutine check_logical(error, actual, expected, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      logical, intent(in) :: actual
      !> Value that is right
      logical, intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (actual .neqv. expected) call mismatch(error, "logical", text(actual), text(expected), message, more)
   end subroutine check_logical

   !> Fails unless two strings are equal, blanks at their ends aside as everywhere in Fortran.
   subroutine check_character(error, actual, expected, message, more)
      !> The failure
      type(error_type), allocatable, intent(out) :: error
      !> Value that was computed
      character(*), intent(in) :: actual
      !> Value that is right
      character(*), intent(in) :: expected
      !> What failed
      character(*), intent(in), optional :: message
      !> A second line
      character(*), intent(in), optional :: more

      if (actual /= expected) call mismatch(error, "text", "'"//actual//"'", "'"//expected//"'", message, more)
   end subroutine check_character

   !> A real as text.
   pure function text_real32(value) result(string)
      !> The value
      real(real32), intent(in) :: value
      character(:), allocatable :: string

      character(32) :: buffer

      write (buffer, '(es16.8e2)') value
      string = trim(adjustl(buffer))
   end function text_real32

   !> A real as text.
   pure function text_real64(value) result(string)
      !> The value
      real(real64), intent(in) :: value
      character(:), allocatable :: string

      character(32) :: buffer

      write (buffer, '(es24.16e3)') value
      string = trim(adjustl(buffer))
   end function text_real64

   !> An integer as text.
   pure function text_int64(value) result(string)
      !> The value
      integer(int64), intent(in) :: value
      character(:), allocatable :: string

      character(32) :: buffer

      write (buffer, '(i0)') value
      string = trim(buffer)
   end function text_int64

   !> A logical as text.
   pure function text_logical(value) result(string)
      !> The value
      logical, intent(in) :: value
      character(:), allocatable :: string

      string = trim(merge("true ", "false", value))
   end function text_logical

end module testdrive
