! SPDX-License-Identifier: MIT
!> The noise terms of IEEE Std 952 and what each adds to the Allan variance.
!>
!> $$ \sigma^2(\tau) = \frac{3 Q^2}{\tau^2} + \frac{N^2}{\tau} + \frac{2 \ln 2}{\pi} B^2 + \frac{K^2 \tau}{3} +
!>    \frac{R^2 \tau^2}{2} $$
!>
!> Two-sided spectra of the rate: N^2; B^2/(2 pi f); K^2/(2 pi f)^2; (2 pi f)^2 Q^2 below the folding
!> frequency; R is the slope of a straight line. Everything is linear in the squares of the
!> coefficients.
module gyroakf_allan_noise_model
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: term_count, term_letters, term_quantization, term_white, term_flicker, term_walk, term_ramp
   public :: noise_model_type, term_shape, model_variance, unit_model

   !> Number of terms
   integer, parameter :: term_count = 5
   !> Their letters, in the order of every array of coefficients
   character(term_count), parameter :: term_letters = "QNBKR"
   !> Their places
   integer, parameter :: term_quantization = 1, term_white = 2, term_flicker = 3, term_walk = 4, term_ramp = 5
   !> (2 ln 2)/pi
   real(dp), parameter :: flicker_floor = 0.44127120030530273_dp

   !> A mixture
   type :: noise_model_type
      !> Q^2 N^2 B^2 K^2 R^2 for a sample interval of 1. The square of Q is negative where it stands
      !> for what a filter in the sensor took from the variances
      real(dp) :: squares(term_count) = 0.0_dp
   end type noise_model_type

   !> Allan variance of a mixture, given as five squares or as a model
   interface model_variance
      module procedure variance_of_squares, variance_of_model
   end interface model_variance

contains

   !> The same mixture in a unit in which the largest of its squares is near 1, for what depends on
   !> their ratios alone: products of small squares vanish, those of large ones overflow.
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
      case (term_quantization); term_shape = 3/tau**2
      case (term_white); term_shape = 1/tau
      case (term_flicker); term_shape = flicker_floor
      case (term_walk); term_shape = tau/3
      case default; term_shape = tau**2/2
      end select
   end function term_shape

   !> Allan variance of the five terms.
   pure real(dp) function variance_of_squares(squares, tau) result(variance)
      !> Squared coefficients Q^2 N^2 B^2 K^2 R^2
      real(dp), intent(in) :: squares(term_count)
      !> Averaging time, > 0
      real(dp), intent(in) :: tau
      integer :: term

      variance = sum([(squares(term)*term_shape(term, tau), term=1, term_count)])
   end function variance_of_squares

   !> Allan variance of a model.
   pure real(dp) function variance_of_model(model, m) result(variance)
      !> The mixture
      type(noise_model_type), intent(in) :: model
      !> Averaging factor, >= 1
      real(dp), intent(in) :: m

      variance = variance_of_squares(model%squares, m)
   end function variance_of_model

end module gyroakf_allan_noise_model
