! SPDX-License-Identifier: MIT
!> Tests of the self-test: it passes, and it notices what is wrong.
module test_selftest
   use, intrinsic :: ieee_arithmetic, only : ieee_positive_inf, ieee_quiet_nan, ieee_value
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : gyro_error => error_type, fatal_error, status
   use gyroakf_io_writer, only : commit_writer, open_writer, writer_type
   use gyroakf_progress, only : progress_type
   use gyroakf_report_selftest, only : report_selftest, selftest_sum, write_selftest
   use gyroakf_selftest, only : run_selftest, selftest_type
   use gyroakf_selftest_types, only : add_check, add_failure, add_worst, begin_group, within_tolerance
   use json_reader, only : check_schema, file_text, json_item, json_real, json_text_at, read_json
   use scratch_file, only : scratch_path, remove_file
   use testdrive, only : check, error_type, new_unittest, unittest_type
   implicit none (type, external)
   private
   public :: collect_selftest

   !> Ends the call when it is told for the second time
   type, extends(progress_type) :: quitter_type
      integer :: calls = 0
   contains
      procedure :: advance => count_call
   end type quitter_type

contains

   !> The tests of this suite.
   subroutine collect_selftest(testsuite)
      !> The tests
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         & new_unittest("all_agree", test_all_agree), &
         & new_unittest("every_check_can_fail", test_can_fail), &
         & new_unittest("wrong_value_fails", test_wrong_value), &
         & new_unittest("worst_pair", test_worst), &
         & new_unittest("no_value_fails", test_no_value), &
         & new_unittest("report", test_report), &
         & new_unittest("document", test_document), &
         & new_unittest("cancelled", test_cancelled)]
   end subroutine collect_selftest

   subroutine test_all_agree(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(gyro_error), allocatable :: failure
      integer :: i

      call run_selftest(result, failure)
      call check(error, .not. allocated(failure), "the self-test ends")
      if (allocated(error)) return
      do i = 1, result%count
         call check(error, result%check(i)%passed, trim(result%check(i)%group)//": "//trim(result%check(i)%name))
         if (allocated(error)) return
      end do
      call check(error, result%failed, 0)
      if (allocated(error)) return
      call check(error, result%count > 100, "a hundred checks are made")
   end subroutine test_all_agree

   !> Every tolerance is so small that a value that is wrong in its first digits would be noticed: relative 1e-2, of values that
   !> are estimated 0.35 (four standard errors), absolute 1e-9 where the value is 0.
   subroutine test_can_fail(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(gyro_error), allocatable :: failure
      real(dp) :: share
      integer :: i

      call run_selftest(result, failure)
      do i = 1, result%count
         associate (check => result%check(i))
            share = 1.0e-2_dp*abs(check%expected)
            if (index(check%group, "identified") > 0) share = 0.35_dp*abs(check%expected)
            if (.not. abs(check%expected) > 0.0_dp) share = 1.0e-9_dp
         end associate
         call check(error, result%check(i)%tolerance <= share, "tolerance of "//result%check(i)%name)
         if (allocated(error)) return
         call check(error, len_trim(result%check(i)%name) < len(result%check(i)%name), "whole name of "//result%check(i)%name)
         if (allocated(error)) return
      end do
   end subroutine test_can_fail

   subroutine test_wrong_value(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result

      call begin_group(result, "a group")
      call add_check(result, "right", 1.0_dp, 1.0_dp + 0.9e-6_dp, 1.0e-6_dp)
      call add_check(result, "wrong", 1.0_dp, 1.0_dp + 1.1e-6_dp, 1.0e-6_dp)
      call add_check(result, "the same", 2.0_dp, 2.0_dp, 0.0_dp)
      call add_check(result, "not the same", 2.0_dp, 2.0_dp + 1.0e-15_dp, 0.0_dp)
      call check(error, result%count == 4 .and. result%failed == 2, "two of four fail")
      if (allocated(error)) return
      call check(error, all(result%check(:4)%passed .eqv. [.true., .false., .true., .false.]), "which ones")
      if (allocated(error)) return
      call check(error, all(result%check(:4)%group == "a group"), "the group")
      if (allocated(error)) return
      call check(error, .not. any(within_tolerance(1.0_dp, [ieee_value(1.0_dp, ieee_quiet_nan), &
                                                            ieee_value(1.0_dp, ieee_positive_inf)], huge(1.0_dp))), "not finite")
      if (allocated(error)) return
      call check(error, selftest_sum(result), "4 checks, 2 FAILED")
   end subroutine test_wrong_value

   subroutine test_worst(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      real(dp) :: got(3)

      got = [1.0_dp, 2.01_dp, 300.1_dp]
      call add_worst(result, "the second", [1.0_dp, 2.0_dp, 300.0_dp], got, 1.0e-3_dp)
      call check(error, result%check(1)%expected, 2.0_dp)
      if (allocated(error)) return
      call check(error, result%failed, 1)
      if (allocated(error)) return
      call add_worst(result, "too few", [1.0_dp, 2.0_dp], got(:1), 1.0_dp)
      call check(error, result%failed, 2)
      if (allocated(error)) return
      got(1) = ieee_value(1.0_dp, ieee_quiet_nan)
      call add_worst(result, "not a number", [1.0_dp, 2.01_dp, 300.1_dp], got, 1.0_dp)
      call check(error, result%failed, 3)
      if (allocated(error)) return
      got(1) = 1.0_dp
      call add_worst(result, "all agree", [1.0_dp, 2.01_dp, 300.1_dp], got, 0.0_dp)
      call check(error, result%failed, 3)
   end subroutine test_worst

   subroutine test_no_value(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(gyro_error), allocatable :: failure
      integer :: i

      call fatal_error(failure, status%singular, "there is none")
      do i = 1, 300                                          ! more than fit the list at first
         call add_failure(result, "a value", failure)
      end do
      call check(error, result%count == 300 .and. result%failed == 300, "all fail")
      if (allocated(error)) return
      call check(error, .not. result%check(300)%known .and. result%check(300)%problem == "there is none", "why")
   end subroutine test_no_value

   !> Three checks of two groups, two of them failed
   subroutine make_result(result)
      type(selftest_type), intent(out) :: result
      type(gyro_error), allocatable :: failure

      call fatal_error(failure, status%singular, "the matrix is singular")
      call begin_group(result, "first group")
      call add_check(result, "a right one", 0.25_dp, 0.25_dp, 1.0e-12_dp)
      call add_check(result, "a wrong one", 0.25_dp, 0.25_dp + 2.0e-12_dp, 1.0e-12_dp)
      call begin_group(result, "second group")
      call add_failure(result, "one without a value", failure)
   end subroutine make_result

   subroutine test_report(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failure
      character(:), allocatable :: text

      call make_result(result)
      call open_writer(writer, scratch_path("selftest.txt"), failure)
      call report_selftest(writer, result)
      call commit_writer(writer, failure)
      call check(error, .not. allocated(failure), "the report is written")
      if (allocated(error)) return
      text = file_text(scratch_path("selftest.txt"))
      call remove_file(scratch_path("selftest.txt"))
      call check(error, index(text, "   2.500000e-01   2.500000e-01    1.0e-12      ok") > 0, text)
      if (allocated(error)) return
      call check(error, index(text, "   2.500000e-01   2.500000e-01    1.0e-12  FAILED") > 0, text)
      if (allocated(error)) return
      call check(error, index(text, "by 2.00e-12") > 0, text)
      if (allocated(error)) return
      call check(error, index(text, "one without a value: the matrix is singular") > 0, text)
      if (allocated(error)) return
      call check(error, index(text, "3 checks, 2 FAILED") > 0, text)
   end subroutine test_report

   subroutine test_document(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(writer_type) :: writer
      type(gyro_error), allocatable :: failure
      type(json_item), allocatable :: schema(:), document(:)
      character(:), allocatable :: wrong
      logical :: valid

      call make_result(result)
      call open_writer(writer, scratch_path("selftest.json"), failure)
      call write_selftest(writer, result)
      call commit_writer(writer, failure)
      call read_json(file_text(scratch_path("selftest.json")), document, valid)
      call remove_file(scratch_path("selftest.json"))
      call check(error, valid .and. .not. allocated(failure), "the document is JSON")
      if (allocated(error)) return
      call read_json(file_text("doc/selftest.schema.json"), schema, valid)
      call check(error, valid, "doc/selftest.schema.json is no JSON")
      if (allocated(error)) return
      wrong = ""
      call check_schema(schema, "", document, "", wrong)
      call check(error, wrong, "")
      if (allocated(error)) return
      call check(error, json_real(document, "/failed"), 2.0_dp)
      if (allocated(error)) return
      call check(error, json_text_at(document, "/check/1/passed"), "false")
      if (allocated(error)) return
      call check(error, json_real(document, "/check/1/got"), 0.25_dp + 2.0e-12_dp)
      if (allocated(error)) return
      call check(error, json_text_at(document, "/check/2/problem"), '"the matrix is singular"')
   end subroutine test_document

   subroutine test_cancelled(error)
      type(error_type), allocatable, intent(out) :: error
      type(selftest_type) :: result
      type(gyro_error), allocatable :: failure
      type(quitter_type) :: quitter

      call run_selftest(result, failure, quitter)
      call check(error, allocated(failure), "the self-test is ended")
      if (allocated(error)) return
      call check(error, failure%code, status%cancelled)
   end subroutine test_cancelled

   subroutine count_call(self, stage, done, total, cancel)
      class(quitter_type), intent(inout) :: self
      character(*), intent(in) :: stage
      integer(int64), intent(in) :: done, total
      logical, intent(out) :: cancel

      self%calls = self%calls + 1
      cancel = self%calls == 2 .and. stage == "testing" .and. done < total
   end subroutine count_call

end module test_selftest
