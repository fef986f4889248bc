! SPDX-License-Identifier: MIT
!> Units: what is written in files, what coefficients are stated in, and which convention each number has.
program example_units
   implicit none (type, external)

   call show("dps")
   call show("milli-g")

contains

   subroutine show(text)
      use gyroakf, only : error_type, unit_type, parse_unit, coefficient_unit_type, coefficient_unit, density_unit, &
         coefficient_definition, term_names
      character(*), intent(in) :: text
      type(error_type), allocatable :: error
      type(unit_type) :: unit
      type(coefficient_unit_type) :: u
      integer :: term

      call parse_unit(text, unit, error)
      if (allocated(error)) error stop error%message
      print "(a, g0.9)", "1 "//text//" = 1 "//unit%name//" in SI: ", unit%to_si
      do term = 1, 5
         u = coefficient_unit(unit, term)
         print "(2x, a, es15.8, a)", term_names(term)//": 1 "//u%si_name//" = ", u%from_si, " "//u%name//", "// &
            coefficient_definition(term)
      end do
      u = density_unit(unit)
      print "(2x, a, es15.8, a)", "N: 1 "//u%si_name//" = ", u%from_si, " "//u%name
   end subroutine show

end program example_units
