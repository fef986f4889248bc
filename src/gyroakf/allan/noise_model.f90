! SPDX-License-Identifier: MIT
!> The noise terms of IEEE Std 952 and what each adds to the Allan variance.
!>
!> $$ \sigma^2(\tau) = \frac{3 Q^2}{\tau^2} + \frac{N^2}{\tau} + \frac{2 \ln 2}{\pi} B^2 + \frac{K^2 \tau}{3} +
!>    \frac{R^2 \tau^2}{2} $$
!>
!> Two-sided spectra of the rate: N^2; B^2/(2 pi f); K^2/(2 pi f)^2; (2 pi f)^2 Q^2 below the folding frequency;
!> R is the slope of a straight line. Two more terms have a time of their own: a first-order Markov process of standard deviation
!> s and correlation time T, and a sinusoid of amplitude W and frequency f. They are those of sampled data (m samples of
!> interval 1, p = exp(-1/T)), and become the standard's where T and 1/f are many samples:
!>
!> $$ \sigma_M^2(m) = s^2 \frac{m (1 - p^2) - p (3 - 4 p^m + p^{2m})}{m^2 (1 - p)^2}, \quad
!>    \sigma_S^2(m) = W^2 \frac{\sin^4 \pi f m}{m^2 \sin^2 \pi f} $$
!>
!> (N. F. Zhang, "Allan variance of time series models for measurement data", Metrologia 45, 2008, for the first).
!> Everything is linear in the squares of the amplitudes.
module gyroakf_allan_noise_model
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: term_count, term_letters, term_quantisation, term_white, term_flicker, term_walk, term_ramp
   public :: column_count, term_markov, term_sinusoid, noise_model_type
   public :: term_shape, model_shape, model_variance, markov_levels, markov_remainder, unit_model

   !> Number of terms that are powers of the averaging time, and with the Markov process and the sinusoid
   integer, parameter :: term_count = 5, column_count = 7
   !> Their letters, in the order of every array of coefficients
   character(column_count), parameter :: term_letters = "QNBKRMS"
   !> Their places
   integer, parameter :: term_quantisation = 1, term_white = 2, term_flicker = 3, term_walk = 4, term_ramp = 5, &
      & term_markov = 6, term_sinusoid = 7
   !> (2 ln 2)/pi
   real(dp), parameter :: flicker_floor = 0.44127120030530273_dp
   real(dp), parameter :: pi = 3.141592653589793_dp

   !> A mixture, for a sample interval of 1
   type :: noise_model_type
      !> Q^2 N^2 B^2 K^2 R^2, variance of the Markov process, square of the sinusoid's amplitude
      real(dp) :: squares(column_count) = 0.0_dp
      !> Correlation time of the Markov process in samples, > 0
      real(dp) :: correlation_time = 1.0_dp
      !> Frequency of the sinusoid in cycles per sample, > 0, < 1/2
      real(dp) :: frequency = 0.25_dp
   end type noise_model_type

   !> Allan variance of a mixture: of the five squares at any time, or of a model at a number of samples
   interface model_variance
      module procedure variance_of_squares, variance_of_model
   end interface model_variance

contains

   !> The same mixture in a unit in which the largest of its squares is near 1, for what depends on their ratios alone: products of
   !> squares of small coefficients vanish, those of large ones overflow.
   pure type(noise_model_type) function unit_model(model) result(scaled)
      !> The mixture
      type(noise_model_type), intent(in) :: model
      real(dp) :: largest

      scaled = model
      largest = maxval(model%squares)
      if (largest > 0.0_dp) scaled%squares = scale(model%squares, -exponent(largest))
   end function unit_model

   !> What a term with coefficient 1 adds to the Allan variance.
   elemental real(dp) function term_shape(term, tau)
      !> 1 .. 5 for Q N B K R
      integer, intent(in) :: term
      !> Averaging time, > 0
      real(dp), intent(in) :: tau

      select case (term)
      case (term_quantisation); term_shape = 3/tau**2
      case (term_white); term_shape = 1/tau
      case (term_flicker); term_shape = flicker_floor
      case (term_walk); term_shape = tau/3
      case default; term_shape = tau**2/2
      end select
   end function term_shape

   !> What a term of a model adds for a square of 1.
   elemental real(dp) function model_shape(model, term, m)
      !> For its correlation time and frequency
      type(noise_model_type), intent(in) :: model
      !> 1 .. 7
      integer, intent(in) :: term
      !> Averaging factor
      real(dp), intent(in) :: m

      select case (term)
      case (term_markov); model_shape = markov_shape(model%correlation_time, m)
      case (term_sinusoid); model_shape = (sin(pi*model%frequency*m)**2/(m*sin(pi*model%frequency)))**2
      case default; model_shape = term_shape(term, m)
      end select
   end function model_shape

   !> Allan variance of a Markov process of variance 1.
   elemental real(dp) function markov_shape(time, m)
      !> Correlation time in samples, and averaging factor
      real(dp), intent(in) :: time, m

      real(dp) :: slope, level, x, f

      call markov_levels(time, slope, level)
      x = m/time
      f = 4*markov_remainder(x) - markov_remainder(2*x)     ! 4 exp(-x) - exp(-2x) - 3 + 2x
      markov_shape = 2*slope/m + level*f/m**2
   end function markov_shape

   !> The two constants of the generalised autocovariance of the phase,
   !> -level (exp(-|t|/T) - 1 + |t|/T) - slope |t|, of a sampled Markov process of variance 1.
   elemental subroutine markov_levels(time, slope, level)
      !> Correlation time in samples
      real(dp), intent(in) :: time
      !> (1 + p)/(2 (1 - p)) - level/T, and p/(1 - p)^2
      real(dp), intent(out) :: slope, level

      real(dp) :: h

      h = 1/time
      level = 1/(4*sinh(min(h, 600.0_dp)/2)**2)
      if (h < 0.02_dp) then
         slope = h/6 - h**3/180 + h**5/5040
      else
         slope = 1/(2*tanh(h/2)) - level*h
      end if
   end subroutine markov_levels

   !> exp(-x) - 1 + x without cancellation.
   elemental real(dp) function markov_remainder(x)
      !> Argument, >= 0
      real(dp), intent(in) :: x

      integer :: k
      real(dp), parameter :: reciprocal(16) = [(1.0_dp/k, k=1, 16)]

      if (x > 0.5_dp) then
         markov_remainder = exp(-min(x, 700.0_dp)) - 1 + x
      else
         markov_remainder = 1
         do k = 16, 3, -1
            markov_remainder = 1 - x*reciprocal(k)*markov_remainder
         end do
         markov_remainder = x**2/2*markov_remainder
      end if
   end function markov_remainder

   !> Allan variance of the five terms.
   pure real(dp) function variance_of_squares(squares, tau) result(variance)
      !> Squared coefficients Q^2 N^2 B^2 K^2 R^2
      real(dp), intent(in) :: squares(term_count)
      !> Averaging time, > 0
      real(dp), intent(in) :: tau

      integer :: term

      variance = 0
      do term = 1, term_count
         variance = variance + squares(term)*term_shape(term, tau)
      end do
   end function variance_of_squares

   !> Allan variance of a model.
   pure real(dp) function variance_of_model(model, m) result(variance)
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> Averaging factor, >= 1
      real(dp), intent(in) :: m

      integer :: term

      variance = variance_of_squares(model%squares(:term_count), m)
      do term = term_count + 1, column_count
         if (model%squares(term) > 0) variance = variance + model%squares(term)*model_shape(model, term, m)
      end do
   end function variance_of_model

end module gyroakf_allan_noise_model
