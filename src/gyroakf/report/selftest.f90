! SPDX-License-Identifier: MIT
!> The result of the self-test as a table and as JSON.
module gyroakf_report_selftest
   use gyroakf_kinds, only : dp
   use gyroakf_io_writer, only : put_line, writer_type
   use gyroakf_release, only : release_string
   use gyroakf_report_document, only : schema_number
   use gyroakf_report_json, only : close_array, close_object, flush_json, json_type, open_array, open_object, put_member, put_null
   use gyroakf_report_layout, only : pad_left, pad_right, put_item, scientific
   use gyroakf_report_table, only : new_table, put_table, set_cell, table_type
   use gyroakf_selftest_types, only : selftest_check_type, selftest_type
   implicit none (type, external)
   private
   public :: report_selftest, write_selftest, selftest_sum

   !> Digits of a value, and of a value that differs where these do not show it
   integer, parameter :: digits = 7, all_digits = 17
   !> Columns of the table: two blanks before each, 80 characters in all
   integer, parameter :: name_width = 29, value_width = 13, verdict_width = 6

contains

   !> The table: a group after the other, and the sum.
   subroutine report_selftest(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of [[run_selftest]]
      type(selftest_type), intent(in) :: result
      integer :: first, last

      call put_line(writer, "gyroakf "//release_string//": self-test")
      first = 1
      do while (first <= result%count)
         last = first
         do while (last < result%count)
            if (result%check(last + 1)%group /= result%check(first)%group) exit
            last = last + 1
         end do
         call put_line(writer, "")
         call put_group(writer, result%check(first:last))
         first = last + 1
      end do
      call put_line(writer, "")
      call put_line(writer, selftest_sum(result))
   end subroutine report_selftest

   !> "98 checks, all agree", "98 checks, 2 FAILED".
   pure function selftest_sum(result) result(text)
      !> Of [[run_selftest]]
      type(selftest_type), intent(in) :: result
      character(:), allocatable :: text
      character(48) :: line

      if (result%failed > 0) then
         write (line, '(i0, " checks, ", i0, " FAILED")') result%count, result%failed
      else
         write (line, '(i0, " checks, all agree")') result%count
      end if
      text = trim(line)
   end function selftest_sum

   !> The checks of one group, then what is to be said of those that failed.
   subroutine put_group(writer, check)
      type(writer_type), intent(inout) :: writer
      type(selftest_check_type), intent(in) :: check(:)
      type(table_type) :: table
      integer :: i

      call new_table(table, size(check) + 1, 5)
      call set_cell(table, 1, 1, pad_right(trim(check(1)%group), name_width))
      call set_cell(table, 1, 2, pad_left("expected", value_width))
      call set_cell(table, 1, 3, pad_left("got", value_width))
      call set_cell(table, 1, 4, "tolerance")
      call set_cell(table, 1, 5, repeat(" ", verdict_width))
      do i = 1, size(check)
         call put_check(table, i + 1, check(i))
      end do
      call put_table(writer, table, 1)
      do i = 1, size(check)
         if (check(i)%passed) cycle
         if (check(i)%known) then
            call put_item(writer, "FAILED", trim(check(i)%name)//": "//scientific(check(i)%got, all_digits)//" instead of "// &
                          scientific(check(i)%expected, all_digits)//", they differ by "// &
                          scientific(abs(check(i)%got - check(i)%expected), 3))
         else
            call put_item(writer, "FAILED", trim(check(i)%name)//": "//trim(check(i)%problem))
         end if
      end do
   end subroutine put_group

   !> One row of the table.
   subroutine put_check(table, row, check)
      type(table_type), intent(inout) :: table
      integer, intent(in) :: row
      type(selftest_check_type), intent(in) :: check

      call set_cell(table, row, 1, trim(check%name))
      call set_cell(table, row, 5, trim(merge("ok    ", "FAILED", check%passed)))
      if (.not. check%known) then
         call set_cell(table, row, 3, "nothing")
         return
      end if
      call set_cell(table, row, 2, value_text(check%expected))
      call set_cell(table, row, 3, value_text(check%got))
      if (check%tolerance > 0.0_dp) then
         call set_cell(table, row, 4, scientific(check%tolerance, 2))
      else
         call set_cell(table, row, 4, "0")
      end if
   end subroutine put_check

   !> 0, 6, 1.2345678e-03.
   function value_text(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text
      character(16) :: whole

      text = scientific(value, digits)
      if (.not. abs(value) < 1.0e6_dp) return
      if (abs(value - anint(value)) > 0.0_dp) return
      write (whole, "(i0)") nint(value)
      text = trim(whole)
   end function value_text

   !> The JSON document, `doc/selftest.schema.json`.
   subroutine write_selftest(writer, result)
      !> Open
      type(writer_type), intent(inout) :: writer
      !> Of [[run_selftest]]
      type(selftest_type), intent(in) :: result
      type(json_type) :: json
      integer :: i

      call open_object(json)
      call put_member(json, "schema", schema_number)
      call put_member(json, "program", "gyroakf")
      call put_member(json, "version", release_string)
      call put_member(json, "checks", result%count)
      call put_member(json, "failed", result%failed)
      call open_array(json, "check")
      do i = 1, result%count
         associate (check => result%check(i))
            call open_object(json)
            call put_member(json, "group", trim(check%group))
            call put_member(json, "name", trim(check%name))
            call put_member(json, "passed", check%passed)
            if (check%known) then
               call put_member(json, "expected", check%expected)
               call put_member(json, "got", check%got)
               call put_member(json, "tolerance", check%tolerance)
               call put_null(json, "problem")
            else
               call put_null(json, "expected")
               call put_null(json, "got")
               call put_null(json, "tolerance")
               call put_member(json, "problem", trim(check%problem))
            end if
            call close_object(json)
         end associate
      end do
      call close_array(json)
      call close_object(json)
      call flush_json(json, writer)
   end subroutine write_selftest

end module gyroakf_report_selftest
