! SPDX-License-Identifier: MIT
!> Power spectral density of an AR model.
module gyroakf_ar_spectrum
   use gyroakf_kinds, only : dp
   use gyroakf_ar_ar_types, only : ar_model_type
   implicit none (type, external)
   private
   public :: ar_spectrum

   real(dp), parameter :: two_pi = 6.283185307179586476925286766559_dp

contains

   !> Two-sided power spectral density of a model at a frequency.
   !>
   !> $$S(f) = \frac{s_p^2\,\Delta}{\bigl|1 - \sum_j \phi_j e^{-2\pi i f j \Delta}\bigr|^2}, \quad
   !> \int_{-1/(2\Delta)}^{1/(2\Delta)} S(f)\,df = \mathrm{Var}(x)$$ so that white noise of density
   !> N^2 has S = N^2; a one-sided density is twice this. Of a model that is not stationary the
   !> formula has no such meaning. Source: Marple, Digital Spectral Analysis (1987), 6.3.
   elemental real(dp) function ar_spectrum(model, frequency, interval) result(density)
      !> Fitted; u its unit
      type(ar_model_type), intent(in) :: model
      !> f in 1/s, any: the density has the period 1/interval and is even
      real(dp), intent(in) :: frequency
      !> Sample interval in s, > 0; 1 for a frequency in cycles a sample
      real(dp), intent(in) :: interval
      complex(dp) :: z, filter
      integer :: j

      filter = (0.0_dp, 0.0_dp)
      z = exp(cmplx(0.0_dp, -two_pi*modulo(frequency*interval, 1.0_dp), dp))
      do j = model%order, 1, -1
         filter = (filter + model%coefficient(j))*z
      end do
      filter = 1.0_dp - filter
      density = huge(density)
      if (abs(filter) <= sqrt(tiny(density))) return
      density = model%noise_variance*interval/(real(filter, dp)**2 + aimag(filter)**2)
   end function ar_spectrum

end module gyroakf_ar_spectrum
