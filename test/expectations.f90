! SPDX-License-Identifier: MIT
!> What the suites expect. A check after one that failed does nothing: the first failure is the one that is told.
module expectations
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_kinds, only : dp, int64
   use testdrive, only : error_type, test_check => check
   implicit none (type, external)
   private
   public :: check, agree, check_refused

   !> Fails unless an expression is true, or a value is the expected one
   interface check
      module procedure check_logical, check_real, check_integer, check_long, check_text
   end interface check

contains

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

   !> Fails unless actual agrees with expected, relatively.
   subroutine agree(error, actual, expected, allowed, what)
      type(error_type), allocatable, intent(inout) :: error
      !> What came out, what should, the relative error allowed
      real(dp), intent(in) :: actual(:), expected(:), allowed
      !> Name
      character(*), intent(in) :: what
      character(120) :: text
      integer :: i

      call check(error, size(actual), size(expected), what//": number of values")
      if (allocated(error)) return
      do i = 1, size(expected)
         write (text, '(2a, i0, ": ", es23.16, " is not ", es23.16)') what, " number ", i, actual(i), expected(i)
         call check(error, abs(actual(i) - expected(i)) <= allowed*abs(expected(i)), trim(text))
         if (allocated(error)) return
      end do
   end subroutine agree

   !> Fails unless the library refused, with this code.
   subroutine check_refused(error, problem, code)
      type(error_type), allocatable, intent(inout) :: error
      !> What the library said
      type(gyro_error), allocatable, intent(in) :: problem
      !> What it should have said, one of `status`
      integer, intent(in) :: code

      call check(error, allocated(problem), "bad input was accepted")
      if (allocated(error)) return
      call check(error, problem%code, code, problem%message)
   end subroutine check_refused

end module expectations
