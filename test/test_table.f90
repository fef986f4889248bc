! SPDX-License-Identifier: MIT
!> Tables of a report and of a channel, and the signs that a terminal shows in their texts.
module test_table
   use expectations, only : test, error, check
   use gyroakf_io_writer, only : writer_type
   use gyroakf_report_text_layout, only : put_heading, put_item, put_paragraph, report_width
   use gyroakf_report_number_text, only : to_unicode
   use gyroakf_report_text_table, only : add_cell, add_row, cell_line, new_table, put_table, &
      & table_type
   use report_fixture, only : begin_text, end_text, fill_drift, make_record, make_result
   use gyroakf_record, only : record_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_tables, only : make_ar_table, make_comparison, make_filter_table, &
      & make_tests_table
   implicit none (type, external)
   private
   public :: suite_table, suite_tables

   character(1), parameter :: lf = new_line("a")
   character(1), parameter :: escape = achar(27)

contains

   subroutine suite_table()
      call test("signs", test_signs)
      call test("signs-in-names", test_names)
      call test("signs-in-the-layout", test_layout)
      call test("colors", test_colors)
      call test("cells-of-two-lines", test_lines)
      call test("too-wide", test_too_wide)
      call test("long-names", test_long_names)
   end subroutine suite_table

   subroutine suite_tables()
      call test("descriptions", test_descriptions)
      call test("nothing", test_nothing)
   end subroutine suite_tables

   subroutine test_signs()
      call check(error, to_unicode("0.41 +/- 0.01 deg/sqrt(h), (deg/s)^2, deg/h^1.5, 2.5 sigma"), &
                 "0.41 ± 0.01 deg/√h, (deg/s)², deg/h^1.5, 2.5 σ")
      call check(error, to_unicode("sigma^2 = N^2/tau, tau <= 3, |rho| >= 2, |k fs +- f|, chi-square, 2 ln 2/pi, sqrt(2) N"), &
                 "σ² = N²/τ, τ ≤ 3, |ρ| ≥ 2, |k fs ± f|, χ², 2 ln 2/π, √2 N")
      call check(error, to_unicode("^2 x^23 x^2.5 sqrt() sqrt(a b) sqrt(x"), "^2 x^23 x^2.5 sqrt() sqrt(a b) sqrt(x")
      call check(error, to_unicode(""), "")
   end subroutine test_signs

   !> Longer names keep their letters.
   subroutine test_names()
      character(*), parameter :: names = "--drift-tau --fit-tau-min tau.csv my_sigma pig Z_tau sigma2 log.tau"

      call check(error, to_unicode(names), names)
      call check(error, to_unicode("the limit of tau."), "the limit of τ.")
   end subroutine test_names

   !> Widths are those of what is shown; what a user wrote is left alone; a value stays with its error.
   subroutine test_layout()
      type(writer_type) :: writer
      type(table_type) :: table
      character(:), allocatable :: text

      call new_table(table, 2)
      call add_row(table, "", "sigma^2")
      call add_row(table, "gx", "1 +/- 0.1")
      call begin_text(writer)
      writer%unicode = .true.
      call put_table(writer, table)
      call put_table(writer, table, verbatim=.true.)
      call put_heading(writer, "Channel tau", "=", verbatim=.true.)
      call put_heading(writer, "tau", "-")
      call put_paragraph(writer, repeat("x", 72)//" 1 +/- 2")
      call end_text(writer, text)
      call check(error, text, "           σ²"//lf//"  gx  1 ± 0.1"//lf//"        sigma^2"//lf//"  gx  1 +/- 0.1"//lf// &
                 lf//"Channel tau"//lf//"==========="//lf//lf//"τ"//lf//"-"//lf//"  "//repeat("x", 72)//" 1 ± 2"//lf)
   end subroutine test_layout

   !> Bold headings, a yellow warning, a red failure; without colors no byte of them.
   subroutine test_colors()
      type(writer_type) :: writer
      character(:), allocatable :: text
      integer :: i

      do i = 1, 2
         call begin_text(writer)
         writer%color = i == 1
         call put_heading(writer, "Title", "=")
         call put_item(writer, "Warning", "one")
         call put_item(writer, "Not available", "two")
         call put_item(writer, "Fit", "three")
         call end_text(writer, text)
         if (i == 1) call check(error, text, lf//escape//"[1mTitle"//escape//"[0m"//lf//escape//"[1m====="//escape//"[0m"//lf// &
            escape//"[33m  Warning         "//escape//"[0mone"//lf//escape//"[31m  Not available   "//escape//"[0mtwo"//lf// &
            "  Fit             three"//lf)
         if (i == 2) call check(error, index(text, escape), 0)
      end do
   end subroutine test_colors

   !> Widths are those of characters, not of bytes.
   subroutine test_lines()
      type(writer_type) :: writer
      type(table_type) :: table
      character(:), allocatable :: text

      call check(error, cell_line("a"//lf//"bc", 2)//"|"//cell_line("a"//lf//"bc", 1)//"|"// &
                 cell_line("a", 2)//"|"//cell_line("a", 1), "bc|a||a")
      call new_table(table, 3)
      call add_row(table, "", "x", "y;z")
      call add_row(table, char(194)//char(176), "12.5"//lf//"+/- 1")
      call add_cell(table, "7")
      call begin_text(writer)
      call put_table(writer, table)
      call end_text(writer, text)
      call check(error, text, "         x  y;z"//lf//"  "//char(194)//char(176)//"   12.5    7"//lf//"     +/- 1"//lf)
   end subroutine test_lines

   !> What does not fit goes on below, with the first column again.
   subroutine test_too_wide()
      type(writer_type) :: writer
      type(table_type) :: table
      character(:), allocatable :: text

      call new_table(table, 4)
      call add_row(table, "name", repeat("b", 30), repeat("c", 30), repeat("d", 30))
      call begin_text(writer)
      call put_table(writer, table)
      call end_text(writer, text)
      call check(error, text, "  name  "//repeat("b", 30)//"  "//repeat("c", 30)//lf//lf//"  name  "//repeat("d", 30)//lf)
      table%cell(1, 4)%text = repeat("d", 9)
      call begin_text(writer)
      call put_table(writer, table)
      call end_text(writer, text)
      call check(error, text, "  name "//repeat("b", 30)//" "//repeat("c", 30)//" "//repeat("d", 9)//lf)
   end subroutine test_too_wide

   !> A name as long as the line loses its end, between characters.
   subroutine test_long_names()
      type(writer_type) :: writer
      type(table_type) :: table
      character(:), allocatable :: text

      call new_table(table, 2)
      call add_row(table, repeat("é", report_width), "1")
      call begin_text(writer)
      call put_table(writer, table, verbatim=.true.)
      call end_text(writer, text)
      call check(error, text, "  "//repeat("é", 41)//"...  1"//lf)
   end subroutine test_long_names

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

end module test_table
