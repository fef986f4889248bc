! SPDX-License-Identifier: MIT
!> What several suites expect: that numbers agree relatively, that the library refuses with a code.
module expectations
   use gyroakf_error, only : gyro_error => error_type
   use gyroakf_kinds, only : dp
   use testdrive, only : check, error_type
   implicit none (type, external)
   private
   public :: agree, check_refused

contains

   !> Fails unless actual agrees with expected, relatively.
   subroutine agree(error, actual, expected, allowed, what)
      !> Failure
      type(error_type), allocatable, intent(out) :: error
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
      !> Failure
      type(error_type), allocatable, intent(out) :: error
      !> What the library said
      type(gyro_error), allocatable, intent(in) :: problem
      !> What it should have said, one of `status`
      integer, intent(in) :: code

      call check(error, allocated(problem), "bad input was accepted")
      if (allocated(error)) return
      call check(error, problem%code, code, problem%message)
   end subroutine check_refused

end module expectations
