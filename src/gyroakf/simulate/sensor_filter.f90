! SPDX-License-Identifier: MIT
!> The filters of a sensor: sections of first or second order, one applied after the other.
!>
!> $$ H_1(s) = \frac{\omega}{s + \omega}, \quad
!>    H_2(s) = \frac{\omega^2}{s^2 + s \omega/Q + \omega^2} $$
!> by the bilinear transform, pre-warped so that the response at the frequency of the section is the
!> analog one. They are computed with trapezoidal integrators: the gain at 0 Hz is 1 however low the
!> frequency is.
module gyroakf_simulate_sensor_filter
   use gyroakf_kinds, only : dp, int64
   implicit none (type, external)
   private
   public :: section_type, make_section, settling_samples, apply_section

   !> One section
   type :: section_type
      !> Pre-warped frequency tan(pi f/rate), > 0
      real(dp) :: g = 1.0_dp
      !> Quality factor of a section of second order, >= 0.5; 0 is one of first order
      real(dp) :: q = 0.0_dp
   end type section_type

contains

   !> A section with its frequency pre-warped.
   elemental type(section_type) function make_section(hz, rate_hz, q)
      !> Cutoff or resonance frequency, Hz, 0 < hz < rate_hz/2
      real(dp), intent(in) :: hz
      !> Samples per second, > 0
      real(dp), intent(in) :: rate_hz
      !> Quality factor, >= 0.5: sqrt(1/2) is a Butterworth filter; 0 makes a section of first order
      real(dp), intent(in) :: q
      real(dp), parameter :: pi = 3.14159265358979323846_dp

      make_section%g = tan(pi*(hz/rate_hz))
      make_section%q = q
   end function make_section

   !> Samples until 1e-12 of a transient is left: 28 time constants of the poles. It may be huge.
   elemental real(dp) function settling_samples(section)
      !> The section; one of first order settles as one of Q = 0.5
      type(section_type), intent(in) :: section

      associate (g => max(section%g, 1.0e-100_dp))
         settling_samples = 28.0_dp*max(section%q, 0.5_dp)*(g + 1.0_dp/g)
      end associate
   end function settling_samples

   !> Filters a series in place, from the steady state of its first value.
   pure subroutine apply_section(section, x)
      !> The section
      type(section_type), intent(in) :: section
      !> Series, of any unit: [n], n >= 1
      real(dp), intent(inout), contiguous :: x(:)
      real(dp) :: low, band, state, gain, v
      integer(int64) :: i

      state = x(1)
      if (section%q > 0.0_dp) then
         band = 0.0_dp
         gain = section%g/(1.0_dp + section%g*(section%g + 1.0_dp/section%q))
         do i = 1, size(x, kind=int64)
            v = gain*(x(i) - state) + band*gain/section%g
            low = state + section%g*v
            band = 2.0_dp*v - band
            state = 2.0_dp*low - state
            x(i) = low
         end do
      else
         gain = section%g/(1.0_dp + section%g)
         do i = 1, size(x, kind=int64)
            v = gain*(x(i) - state)
            low = state + v
            state = low + v
            x(i) = low
         end do
      end if
   end subroutine apply_section

end module gyroakf_simulate_sensor_filter
