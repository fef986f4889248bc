! SPDX-License-Identifier: MIT
!> Overlapping Allan deviation of a record, and the coefficients Q N B K R that its curve shows.
program example_allan_deviation
   use gyroakf, only : dp, error_type, reader_options, read_record, record_type, allan_options, allan_curve_type, &
      compute_allan, noise_options, noise_type, fit_noise, coefficient_unit_type, coefficient_unit, term_names
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(allan_curve_type) :: curve
   type(noise_type) :: noise
   type(coefficient_unit_type) :: unit
   integer :: i

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, allan_options(), curve, error)
   if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
   if (allocated(error)) error stop error%message
   print "(f9.1, 3es12.4)", (curve%tau(i), curve%deviation(i), curve%lower(i), curve%upper(i), i=1, size(curve%tau))
   do i = 1, 5
      unit = coefficient_unit(record%unit, i)
      print "(a, 2es12.4, 1x, a)", term_names(i), [noise%coefficient(i)%value, noise%coefficient(i)%std_error] &
         *record%unit%to_si*unit%from_si, unit%name
   end do
end program example_allan_deviation
