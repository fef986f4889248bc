! SPDX-License-Identifier: MIT
!> The tables of a channel: what they hold.
module test_tables
   use expectations, only : test, error, check
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_text_table, only : table_type
   use gyroakf_report_tables, only : make_ar_table, make_comparison, make_filter_table, make_tests_table
   use report_fixture, only : fill_drift, make_record, make_result
   implicit none (type, external)
   private
   public :: suite_tables

   character(1), parameter :: lf = new_line("a")

contains

   subroutine suite_tables()
      call test("descriptions", test_descriptions)
      call test("nothing", test_nothing)
   end subroutine suite_tables

   !> All four, each with a head, a caption, and the cells of a row.
   subroutine test_descriptions()
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(table_type) :: tables(4)
      character(3), parameter :: numbers(4) = [character(3) :: "", "I", "II", "III"]
      integer :: i

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_drift(record, result%channel(1))
      call make_tests_table(result%channel(1), tables(1))
      call make_ar_table(record, result%channel(1), tables(2))
      call make_filter_table(record, result%channel(1), tables(3))
      call make_comparison(record, result%channel(1), tables(4))
      do i = 1, 4
         call check(error, tables(i)%number, trim(numbers(i)))
         call check(error, len(tables(i)%caption) > 0 .and. size(tables(i)%cell, 1) > tables(i)%head)
      end do
      call check(error, tables(1)%cell(2, 1)%text//" "//tables(1)%cell(2, 3)%text//" "//tables(1)%cell(2, 6)%text, &
                 "augmented Dickey-Fuller -71.5 yes")
      call check(error, tables(3)%cell(2, 3)%text, "(deg/s)^2")
      call check(error, tables(4)%cell(3, 3)%text, "0.948"//lf//"+/- 0.012")
   end subroutine test_descriptions

   subroutine test_nothing()
      type(pipeline_result_type) :: empty
      type(table_type) :: table

      allocate (empty%channel(1))
      call make_tests_table(empty%channel(1), table)
      call check(error, size(table%cell, 1), table%head)
   end subroutine test_nothing

end module test_tables
