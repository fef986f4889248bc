! SPDX-License-Identifier: MIT
!> The coefficients in SI with what they are the coefficients of, and N as a density in both conventions.
module gyroakf_report_text_conventions
   use gyroakf_units, only : term_names
   use gyroakf_io_writer, only : writer_type
   use gyroakf_pipeline_result, only : allan_result_type, stated_coefficient_type
   use gyroakf_report_text_layout, only : put_heading, put_item, number
   use gyroakf_report_text_table, only : table_type, new_table, set_cell, put_table
   implicit none (type, external)
   private
   public :: put_conventions

contains

   !> The table of coefficients in SI; nothing where rate or unit is not known.
   subroutine put_conventions(writer, allan, series)
      !> The report
      type(writer_type), intent(inout) :: writer
      !> With the fit
      type(allan_result_type), intent(in) :: allan
      !> Begins the heading: "As read", or "The same" below a table of the same series
      character(*), intent(in) :: series
      type(table_type) :: table
      character(10), parameter :: head(6) = [character(10) :: "", "definition", "unit", "value", "std. error", "limit"]
      integer :: i

      if (.not. (allan%fitted .and. allan%stated%in_units .and. any(allan%stated%term%fitted))) return
      call put_heading(writer, series//" in SI, and what each number is the coefficient of (tau in s)")
      call new_table(table, size(term_names) + 1, size(head))
      do i = 1, size(head)
         call set_cell(table, 1, i, trim(head(i)))
      end do
      do i = 1, size(term_names)
         associate (stated => allan%stated%term(i))
            call set_cell(table, i + 1, 1, term_names(i))
            call set_cell(table, i + 1, 2, in_lines(stated%definition))
            call set_cell(table, i + 1, 3, stated%unit_si)
            if (.not. stated%fitted) cycle
            if (stated%detected) call set_cell(table, i + 1, 4, number(stated%value_si, 4))
            if (.not. stated%detected) call set_cell(table, i + 1, 4, "-")
            if (stated%detected) call set_cell(table, i + 1, 5, number(stated%std_error_si, 3))
            call set_cell(table, i + 1, 6, number(stated%upper_limit_si, 4))
         end associate
      end do
      call put_table(writer, table, 3)
      if (.not. allan%stated%density(1)%fitted) return
      call put_heading(writer, "N as a density: data sheets mean the one or the other")
      call put_density(writer, "Two-sided", "N, also that of Kalibr", allan%stated%density(1))
      call put_density(writer, "One-sided", "sqrt(2) N, of some data sheets", allan%stated%density(2))
   end subroutine put_conventions

   !> A definition in two lines where it says two things.
   pure function in_lines(definition) result(text)
      character(*), intent(in) :: definition
      character(:), allocatable :: text
      integer :: i

      text = trim(definition)
      i = index(text, ", ")
      if (i > 0) text = text(:i)//new_line("a")//text(i + 2:)
      i = index(text, " = ", back=.true.)
      if (i > index(text, " = ")) text = text(:i - 1)//new_line("a")//text(i + 1:)
   end function in_lines

   !> A line for one convention.
   subroutine put_density(writer, label, meaning, density)
      type(writer_type), intent(inout) :: writer
      character(*), intent(in) :: label, meaning
      type(stated_coefficient_type), intent(in) :: density

      if (density%detected) then
         call put_item(writer, label, number(density%value, 4)//" "//density%unit//" = "//number(density%value_si, 4)//" "// &
                       density%unit_si//": "//meaning)
      else if (density%fitted) then
         call put_item(writer, label, "below "//number(density%upper_limit, 4)//" "//density%unit//" = "// &
                       number(density%upper_limit_si, 4)//" "//density%unit_si//": "//meaning)
      end if
   end subroutine put_density

end module gyroakf_report_text_conventions
