! SPDX-License-Identifier: MIT
!> Coefficients read off the curve as a data sheet does it, beside those of the fit.
program example_read_off
   use gyroakf, only : dp, error_type, reader_options, read_record, record_type, allan_options, allan_curve_type, compute_allan, &
      noise_options, noise_type, fit_noise, read_off_type, read_off, term_names
   implicit none (type, external)
   type(error_type), allocatable :: error
   type(record_type) :: record
   type(allan_curve_type) :: curve
   type(noise_type) :: noise
   type(read_off_type) :: read
   integer :: i

   call read_record("example/data/mems_gyro_x.txt", reader_options(), record, error)
   if (.not. allocated(error)) call compute_allan(record%value(:, 1), record%sample_interval, allan_options(), curve, error)
   if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
   if (.not. allocated(error)) call read_off(curve, read, error)
   if (allocated(error)) error stop error%message
   do i = 1, 5
      print "(a, es12.4, 2x, a)", term_names(i), noise%coefficient(i)%value, segment(i)
   end do
   print "(a, es12.4, a, f0.1, a)", "lowest", read%minimum, " at ", read%minimum_tau, " s"

contains

   !> What is read, and where.
   function segment(i) result(text)
      integer, intent(in) :: i
      character(60) :: text

      text = "no segment"
      if (read%found(i)) write (text, "(a, es11.4, 2(a, f0.1), a)") "read ", read%value(i), " between ", read%from_tau(i), &
         " and ", read%to_tau(i), " s"
   end function segment
end program example_read_off
