! SPDX-License-Identifier: MIT
!> Generalised autocovariance of the phase of a noise mixture, and of its running sums.
!>
!> For a sample interval of 1, up to even powers of the lag, which no difference of the phase sees,
!>
!> $$ s_x(t) = -\frac{N^2 |t|}{2} + \frac{B^2}{2\pi} t^2 \ln|t| + \frac{K^2 |t|^3}{12} -
!>    s^2 \left( \frac{p}{(1 - p)^2}\, p^{|t|} + \frac{1 + p}{2 (1 - p)} |t| \right) $$
!>
!> where s^2 is the variance of a sampled first-order Markov process and p = exp(-1/T) (C. A. Greenhall, IEEE Trans. UFFC 47,
!> 2000); quantisation noise adds Q^2 at t = 0 only. The mean of m phases has the autocovariance
!>
!> $$ \frac{1}{m^2} \left( S(t + m) - 2 S(t) + S(t - m) \right), \quad S(t + 1) - 2 S(t) + S(t - 1) = s_x(t) $$
!>
!> with S in closed form: exact for everything but flicker noise, where it leaves out terms of relative size 0.03/m^3.
module gyroakf_allan_phase_covariance
   use gyroakf_kinds, only : dp
   use gyroakf_allan_noise_model, only : markov_levels, noise_model_type, term_flicker, term_markov, term_quantisation, term_walk, &
      & term_white
   implicit none (type, external)
   private
   public :: phase_covariance, sum_covariance

   !> -zeta'(-2), the constant that the sum of s^2 ln s over s = 1 .. t has beside powers of t
   real(dp), parameter :: flicker_linear = 0.030448457058393271_dp
   !> 2 pi
   real(dp), parameter :: two_pi = 6.283185307179586_dp

contains

   !> s_x(t) without quantisation noise.
   elemental real(dp) function phase_covariance(model, t) result(s)
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> Lag in samples
      real(dp), intent(in) :: t

      real(dp) :: lag, slope, level

      lag = abs(t)
      s = lag*(model%squares(term_walk)*lag**2/12 - model%squares(term_white)/2)
      if (model%squares(term_flicker) > 0 .and. lag > 0) s = s + model%squares(term_flicker)/two_pi*lag**2*log(lag)
      if (model%squares(term_markov) > 0) then
         call markov_levels(model%correlation_time, slope, level)
         s = s - model%squares(term_markov)*(slope*lag + level*remainder(lag/model%correlation_time, 3))
      end if
   end function phase_covariance

   !> S(t), quantisation noise included.
   elemental real(dp) function sum_covariance(model, t) result(s)
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> Lag in samples
      real(dp), intent(in) :: t

      real(dp) :: lag, cube, slope, level, rate, full

      lag = abs(t)
      cube = (lag**3 - lag)/6
      s = model%squares(term_quantisation)*lag/2 - model%squares(term_white)*cube/2 &
         & + model%squares(term_walk)/12*(lag**5/20 - cube/2 - lag/20)
      if (model%squares(term_flicker) > 0 .and. lag > 0) s = s &
         & + model%squares(term_flicker)/two_pi*(lag**2*(lag**2 - 1)*log(lag)/12 + flicker_linear*lag)
      if (model%squares(term_markov) > 0) then
         rate = 1/model%correlation_time
         call markov_levels(model%correlation_time, slope, level)
         full = slope + level*rate
         s = s - model%squares(term_markov)*(level**2*remainder(lag*rate, 5) + (level*slope - full/6)*lag &
            & + (full - level**2*rate**3)*lag**3/6)
      end if
   end function sum_covariance

   !> exp(-x) less the first terms of its series, without cancellation.
   elemental real(dp) function remainder(x, terms)
      !> Argument, >= 0
      real(dp), intent(in) :: x
      !> How many terms
      integer, intent(in) :: terms

      real(dp) :: term
      integer :: k

      remainder = 0
      term = 1
      if (x > 2) remainder = exp(-min(x, 700.0_dp))
      do k = 0, merge(terms - 1, 24, x > 2)
         if (x > 2) then
            remainder = remainder - term
         else if (k >= terms) then
            remainder = remainder + term
         end if
         term = -term*x/(k + 1)
      end do
   end function remainder

end module gyroakf_allan_phase_covariance
