! SPDX-License-Identifier: MIT
!> Tests of the error type: the numbers of the codes are part of the C interface.
module test_error
   use gyroakf_error, only : exit_code, fatal_error, status, status_texts
   use expectations, only : problem, test, error, check, went_wrong, check_refused
   implicit none (type, external)
   private
   public :: suite_error

contains

   subroutine suite_error()
      call test("codes", test_codes)
      call test("texts", test_texts)
      call test("exit_codes", test_exit_codes)
      call test("fatal", test_fatal)
   end subroutine suite_error

   !> The codes never change.
   subroutine test_codes()
      integer :: codes(0:14), i

      codes = [status%ok, status%invalid_argument, status%too_few_samples, status%io, status%parse, &
         & status%constant_input, status%singular, status%not_converged, status%unstable, &
         & status%non_finite, status%no_memory, status%not_supported, status%cancelled, &
         & status%internal, status%usage]
      do i = lbound(codes, 1), ubound(codes, 1)
         call check(error, codes(i), i, "code of a status changed")
      end do
   end subroutine test_codes

   !> Every code has a text of its own.
   subroutine test_texts()
      integer :: i, j

      call check(error, trim(status_texts(status%ok)), "ok")
      do i = status%ok, status%usage
         call check(error, status_texts(i) /= "", "a code has no text")
         do j = status%ok, i - 1
            call check(error, status_texts(i) /= status_texts(j), "two codes have one text: "//status_texts(i))
         end do
      end do
      call check(error, ubound(status_texts, 1), status%usage)
   end subroutine test_texts

   !> 0 done, 1 usage, 2 data or file, 3 numerical.
   subroutine test_exit_codes()
      integer, parameter :: expected(0:14) = [0, 2, 2, 2, 2, 2, 3, 3, 3, 2, 2, 2, 2, 3, 1]
      integer :: i

      do i = lbound(expected, 1), ubound(expected, 1)
         call check(error, exit_code(i), expected(i), "exit code for: "//trim(status_texts(i)))
      end do
   end subroutine test_exit_codes

   !> The error holds what it was given, also when it replaces another one.
   subroutine test_fatal()
      if (went_wrong(problem, "an error from nowhere")) return
      call fatal_error(problem, status%parse, "line 3: not a number")
      call fatal_error(problem, status%io, "cannot open")
      call check_refused(problem, status%io)
      call check(error, problem%message, "cannot open")
   end subroutine test_fatal

end module test_error
