! SPDX-License-Identifier: MIT
!> A program of another package: `fpm run` in example/consumer builds it with the library, or with pkg-config
!>
!>     gfortran app/main.f90 $(pkg-config --cflags --libs gyroakf)
program consumer
   use gyroakf, only : allan_curve_type, allan_options, compute_allan, dp, error_type, fit_noise, noise_options, noise_type, &
      & release_string
   implicit none (type, external)
   real(dp) :: rate(2000)
   integer :: i

   do i = 1, size(rate)
      rate(i) = modulo(0.6180339887498949_dp*real(i, dp)**2, 1.0_dp)
   end do
   call characterize(rate)

contains

   !> Prints the first point of the deviation curve and the coefficient of the white noise.
   subroutine characterize(rate)
      !> [n] samples, 0.01 s apart
      real(dp), intent(in) :: rate(:)
      type(error_type), allocatable :: error
      type(allan_curve_type) :: curve
      type(noise_type) :: noise

      call compute_allan(rate, 0.01_dp, allan_options(), curve, error)
      if (.not. allocated(error)) call fit_noise(curve, noise_options(), noise, error)
      if (allocated(error)) error stop error%message
      print "(a)", "gyroakf "//release_string
      print "(a, f8.6)", "deviation at 0.01 s ", curve%deviation(1)
      print "(a, f7.4)", "N ", noise%coefficient(2)%value
   end subroutine characterize

end program consumer
