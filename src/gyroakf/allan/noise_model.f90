! SPDX-License-Identifier: MIT
!> The noise terms of IEEE Std 952 and what each adds to the Allan variance.
!>
!> $$ \sigma^2(\tau) = \frac{3 Q^2}{\tau^2} + \frac{N^2}{\tau} + \frac{2 \ln 2}{\pi} B^2 +
!>    \frac{K^2 \tau}{3} +
!>    \frac{R^2 \tau^2}{2} $$
!>
!> Two-sided spectra of the rate: N^2; B^2/(2 pi f); K^2/(2 pi f)^2; (2 pi f)^2 Q^2 below the
!> folding frequency; R is the slope of a straight line. Everything is linear in the squares of the
!> coefficients.
module gyroakf_allan_noise_model
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: term_count, terms, term_letters, term_quantization, term_white, term_flicker, &
      & term_walk, term_ramp
   public :: term_shape, model_variance

   !> Number of terms, their numbers and letters in the order of every array of coefficients
   integer, parameter :: term_count = 5, terms(term_count) = [1, 2, 3, 4, 5]
   character(term_count), parameter :: term_letters = "QNBKR"
   integer, parameter :: term_quantization = 1, term_white = 2, term_flicker = 3, term_walk = 4, &
      & term_ramp = 5
   !> (2 ln 2)/pi
   real(dp), parameter :: flicker_floor = 0.44127120030530273_dp

contains

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
   pure real(dp) function model_variance(squares, tau) result(variance)
      !> Squared coefficients Q^2 N^2 B^2 K^2 R^2
      real(dp), intent(in) :: squares(term_count)
      !> Averaging time, > 0
      real(dp), intent(in) :: tau

      variance = sum(squares*term_shape(terms, tau))
   end function model_variance

end module gyroakf_allan_noise_model
