! SPDX-License-Identifier: MIT
!> The error type, whose codes are part of the C interface; every status code of the library, and a
!> call that gives it.
!>
!> Two codes are not in the table: no procedure of the library gives `usage`, which is the program's for a wrong command line
!> (test/cli/part_usage.sh), nor `internal`, with which it ends where its self-test fails (test/cli/part_selftest.sh).
module test_status
   use, intrinsic :: ieee_arithmetic, only : ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, status, status_texts, exit_code, &
      & fatal_error
   use gyroakf_allan_deviations, only : allan_curve_type, allan_options, compute_allan
   use gyroakf_filter_kalman, only : filter_options, filter_type, new_filter
   use gyroakf_filter_steady_gain, only : steady_state
   use gyroakf_io_reader, only : read_record, reader_options
   use gyroakf_pipeline, only : pipeline_options, pipeline_result_type, run_pipeline
   use progress_watch, only : watch_type
   use gyroakf_record, only : record_type
   use gyroakf_series_adf, only : adf_options, adf_type, test_adf
   use gyroakf_simulate_simulate_record, only : simulate_options, simulate_record
   use scratch_file, only : remove_file, scratch_path, write_bytes
   use expectations, only : failure => problem, test, error, check, went_wrong, check_refused, &
      & problem
   implicit none (type, external)
   private
   public :: suite_status, suite_error

   !> The codes that the program alone gives
   integer, parameter :: of_the_program(2) = [status%internal, status%usage]

contains

   subroutine suite_status()
      call test("every_code", test_every_code)
   end subroutine suite_status

   subroutine suite_error()
      call test("codes", test_codes)
      call test("texts", test_texts)
      call test("exit_codes", test_exit_codes)
      call test("fatal", test_fatal)
   end subroutine suite_error

   subroutine test_every_code()
      integer :: code

      do code = lbound(status_texts, 1), ubound(status_texts, 1)
         if (any(code == of_the_program)) cycle
         call provoke(code, failure)
         if (code == status%ok) then
            if (went_wrong(failure, "nothing is wrong")) return
            cycle
         end if
         call check_refused(failure, code)
         call check(error, len(failure%message) > 10, "a message: "//trim(status_texts(code)))
      end do
   end subroutine test_every_code

   !> A call that gives this code.
   subroutine provoke(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure

      select case (code)
      case (status%ok, status%invalid_argument, status%too_few_samples, status%not_supported)
         call provoke_allan(code, failure)
      case (status%io, status%parse)
         call provoke_reading(code, failure)
      case (status%constant_input, status%singular)
         call provoke_test(code, failure)
      case (status%unstable, status%non_finite, status%not_converged)
         call provoke_filter(code, failure)
      case (status%no_memory, status%cancelled)
         call provoke_job(code, failure)
      case default
         continue
      end select
   end subroutine provoke

   !> Allan deviations of a straight line: done; with an interval of 0; of one sample; of an unknown kind.
   subroutine provoke_allan(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure
      type(allan_options) :: options
      type(allan_curve_type) :: curve
      real(dp) :: rate(1000)
      integer :: i

      rate = [(real(i, dp), i=1, size(rate))]
      if (code == status%not_supported) options%kind = "nodev"
      call compute_allan(rate(:merge(1, size(rate), code == status%too_few_samples)), &
                         merge(0.0_dp, 1.0_dp, code == status%invalid_argument), options, curve, failure)
   end subroutine provoke_allan

   !> A file that is not there; one that holds no numbers.
   subroutine provoke_reading(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure
      type(record_type) :: record
      character(:), allocatable :: path

      path = scratch_path("status.txt")
      if (code == status%parse) call write_bytes(path, "1.0"//new_line("a")//"one point two"//new_line("a"))
      call read_record(path, reader_options(), record, failure)
      call remove_file(path)
   end subroutine provoke_reading

   !> The Dickey-Fuller test of a constant, and of a sinusoid, which its own past predicts exactly.
   subroutine provoke_test(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure
      type(adf_type) :: result
      real(dp) :: x(200)
      integer :: i

      x = [(sin(real(i, dp)), i=1, size(x))]
      if (code == status%constant_input) x = 1.0_dp
      call test_adf(x, adf_options(lags=4), result, failure)
   end subroutine provoke_test

   !> A filter of a process that grows without end, one whose variance is no number, the gain of one that next to nothing drives.
   subroutine provoke_filter(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure
      type(filter_type) :: filter
      real(dp) :: q, gain(2), prior(2, 2)

      if (code == status%not_converged) then
         call steady_state([0.0_dp, 1.0_dp], 1.0e-300_dp, 1.0_dp, gain, prior, failure)
         return
      end if
      q = 1.0_dp
      if (code == status%non_finite) q = ieee_value(q, ieee_quiet_nan)
      call new_filter(filter, [merge(1.1_dp, 0.5_dp, code == status%unstable)], q, 1.0_dp, filter_options(), failure)
   end subroutine provoke_filter

   !> A record of more bytes than there are addresses; a job whose caller has had enough.
   subroutine provoke_job(code, failure)
      integer, intent(in) :: code
      type(gyro_error), allocatable, intent(out) :: failure
      type(simulate_options) :: options
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(watch_type) :: watch

      if (code == status%no_memory) options%samples = 10_int64**15
      call simulate_record(options, record, failure)
      if (allocated(failure)) return
      watch%last_call = 1
      call run_pipeline(record, pipeline_options(), result, failure, watch)
   end subroutine provoke_job

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

end module test_status
