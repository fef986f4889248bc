! SPDX-License-Identifier: MIT
!> The tables for papers: what they hold, LaTeX.
module test_tables
   use expectations, only : check
   use testdrive, only : new_unittest, unittest_type, error_type
   use gyroakf_record, only : record_type
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : pipeline_result_type
   use gyroakf_report_latex, only : flat_text, latex_text, write_latex
   use gyroakf_report_text_table, only : table_type
   use gyroakf_report_tables, only : make_tables
   use report_fixture, only : begin_text, end_text, fill_drift, make_record, make_result
   implicit none (type, external)
   private
   public :: collect_tables

   character(1), parameter :: lf = new_line("a")

contains

   !> Names the tests.
   subroutine collect_tables(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)

      testsuite = [ &
         new_unittest("descriptions", test_descriptions), &
         new_unittest("nothing", test_nothing), &
         new_unittest("flat", test_flat), &
         new_unittest("latex-text", test_latex_text), &
         new_unittest("latex-escapes", test_latex_escapes), &
         new_unittest("latex", test_latex)]
   end subroutine collect_tables

   !> A record with everything, its channel named by the user.
   subroutine make_all(record, result, name)
      type(record_type), intent(out) :: record
      type(pipeline_result_type), intent(out) :: result
      character(*), intent(in) :: name

      call make_record(record, .true.)
      call make_result(record, result)
      call fill_drift(record, result%channel(1))
      result%channel(1)%name = name
   end subroutine make_all

   !> All four, each named, with a head, a caption, and cells for every column.
   subroutine test_descriptions(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result
      type(table_type), allocatable :: tables(:)
      character(12), parameter :: names(4) = [character(12) :: "tests", "ar", "filters", "coefficients"]
      character(3), parameter :: numbers(4) = [character(3) :: "", "I", "II", "III"]
      integer :: i

      call make_all(record, result, "gx")
      call make_tables(record, result%channel(1), tables)
      call check(error, size(tables), 4)
      if (allocated(error)) return
      do i = 1, 4
         call check(error, tables(i)%name, trim(names(i)))
         call check(error, tables(i)%number, trim(numbers(i)))
         call check(error, len(tables(i)%caption) > 0 .and. size(tables(i)%cell, 1) > tables(i)%head)
         if (allocated(error)) return
      end do
      call check(error, tables(1)%cell(2, 1)%text//" "//tables(1)%cell(2, 3)%text//" "//tables(1)%cell(2, 6)%text, &
                 "augmented Dickey-Fuller -71.5 yes")
      call check(error, tables(3)%cell(2, 3)%text, "(deg/s)^2")
      call check(error, tables(4)%cell(3, 3)%text, "0.948"//lf//"+/- 0.012")
   end subroutine test_descriptions

   subroutine test_nothing(error)
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: record
      type(pipeline_result_type) :: result, empty
      type(table_type), allocatable :: tables(:)

      call make_record(record, .false.)
      call make_result(record, result)
      allocate (empty%channel(1))
      allocate (empty%channel(1)%allan(6))
      call make_tables(record, empty%channel(1), tables)
      call check(error, size(tables), 0)
   end subroutine test_nothing

   subroutine test_flat(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, flat_text("1"//lf//"+/- 2")//"|"//flat_text("input unit"//lf//"*sqrt(sample)")//"|"//flat_text(""), &
                 "1 +/- 2|input unit*sqrt(sample)|")
   end subroutine test_flat

   subroutine test_latex_text(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, latex_text("-1.818e-04"), "$-$1.818$\times10^{-4}$")
      call check(error, latex_text("1e+05 2e-10 3e+00"), "1$\times10^{5}$ 2$\times10^{-10}$ 3")
      call check(error, latex_text("0.948"//lf//"+/- 0.012"), "0.948 $\pm$ 0.012")
      call check(error, latex_text("deg/sqrt(h), deg/h^1.5, (deg/s)^2"), &
                 "deg/$\sqrt{\mathrm{h}}$, deg/h$^{1.5}$, (deg/s)$^{2}$")
      call check(error, latex_text("> 85 %, |rho|, < 2"), "$>$ 85 \%, $|$$\rho$$|$, $<$ 2")
      call check(error, latex_text("-")//latex_text("--akf a-b 2-3"), "---{}-akf a-b 2-3")
   end subroutine test_latex_text

   subroutine test_latex_escapes(error)
      type(error_type), allocatable, intent(out) :: error

      call check(error, latex_text("a_b & c% $d #e {f} ~g ^h \i"//lf//char(7), verbatim=.true.), &
                 "a\_b \& c\% \$d \#e \{f\} \textasciitilde{}g \textasciicircum{}h \textbackslash{}i ?")
      call check(error, latex_text("tau", verbatim=.true.)//latex_text("é"), "taué")
   end subroutine test_latex_escapes

   !> Begins and ends in pairs, as many cells in every row as the table has columns, no special character left.
   subroutine test_latex(error)
      type(error_type), allocatable, intent(out) :: error
      type(writer_type) :: writer
      type(record_type) :: record
      type(pipeline_result_type) :: result
      character(:), allocatable :: text, line
      integer :: first, last, columns, rows

      call make_all(record, result, "g_x & 50% #1")
      call begin_text(writer)
      call write_latex(writer, record, result)
      call end_text(writer, text)
      call check(error, occurrences(text, "\begin{table}") == 4 .and. occurrences(text, "\end{table}") == 4 .and. &
                 occurrences(text, "\begin{tabular}") == 4 .and. occurrences(text, "\end{tabular}") == 4 .and. &
                 occurrences(text, "\midrule") == 4 .and. occurrences(text, "; channel g\_x \& 50\% \#1}") == 4)
      call check(error, modulo(occurrences(text, "$"), 2) == 0 .and. occurrences(text, "{") == occurrences(text, "}"))
      first = 1
      columns = 0
      rows = 0
      do while (first <= len(text) .and. .not. allocated(error))
         last = first + index(text(first:), lf) - 2
         line = text(first:last)
         first = last + 2
         if (index(line, "\begin{tabular}{") > 0) columns = len(line) - index(line, "}{") - 2
         if (len(line) < 2) cycle
         if (line(len(line) - 1:) /= "\\") cycle
         rows = rows + 1
         call check(error, occurrences(line, " & "), columns - 1)
         call check(error, occurrences(line, "_") + occurrences(line, "#"), 0)
         call check(error, occurrences(line, "%"), occurrences(line, "\%"))
      end do
      if (.not. allocated(error)) call check(error, rows > 20)
   end subroutine test_latex

   !> How often a part is in a text.
   pure integer function occurrences(text, part)
      character(*), intent(in) :: text, part
      integer :: i

      occurrences = 0
      do i = 1, len(text) - len(part) + 1
         if (text(i:i + len(part) - 1) == part) occurrences = occurrences + 1
      end do
   end function occurrences

end module test_tables
