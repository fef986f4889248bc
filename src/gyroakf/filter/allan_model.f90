! SPDX-License-Identifier: MIT
!> The drift model that the coefficients of an Allan deviation stand for.
!>
!> For a sample interval dt, N, B and K per sample (those of the curve over the number of samples, dt = 1):
!> $$ r = N^2, \quad q_K = K^2 $$
!> are white noise and random walk, exactly. Flicker noise has no state of finite size; it is approximated by the Gauss-Markov
!> process whose Allan deviation is highest where the curve is flat, and as high as the floor, 0.6643 B: the highest point of a
!> process of driving noise q_c and correlation time T is 0.4365 q_c sqrt(T), at 1.8926 T. Its variance is then
!> $$ D = \tfrac12 q_c^2 T = \tfrac12 \left(\frac{0.6643\,B}{0.4365}\right)^2, \quad T = \tau_0/1.8926 $$
!> where tau_0 is the middle, on a logarithmic scale, of the averaging times from where N crosses the floor to where K does,
!> or to the longest one of the curve: sqrt(3) N/K where neither is cut.
!>
!> Source: IEEE Std 952-1997, annex C (the deviations of the terms, of the Markov process and its highest point); El-Sheimy, Hou &
!> Niu, IEEE Trans. Instrum. Meas. 57 (2008) 140-149; the approximation as in Xing & Gebre-Egziabher, AIAA GNC 2008-6921.
module gyroakf_filter_allan_model
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_filter_components, only : component_model_type
   implicit none (type, external)
   private
   public :: allan_terms_type, make_allan_model

   !> Deviation of flicker noise over B, sqrt(2 ln 2/pi)
   real(dp), parameter :: floor_share = 0.6642824702679601_dp
   !> Allan deviation of a Gauss-Markov process of q_c = T = 1 at its highest point, and where that is
   real(dp), parameter :: highest = 0.436542471073806_dp, highest_at = 1.89261785102_dp

   !> What an Allan curve says, per sample (tau counted in samples); u is the unit of the series
   type :: allan_terms_type
      !> Angle random walk N: white noise of standard deviation N; u
      real(dp) :: n = 0.0_dp
      !> Bias instability B; u
      real(dp) :: b = 0.0_dp
      !> Rate random walk K: steps of standard deviation K; u
      real(dp) :: k = 0.0_dp
      !> Longest averaging time of the curve, samples, > 0 where B is
      real(dp) :: longest = 0.0_dp
   end type allan_terms_type

contains

   !> The model; a term that is 0 has no part in it.
   subroutine make_allan_model(terms, model, error)
      !> Finite, >= 0
      type(allan_terms_type), intent(in) :: terms
      !> The process for B first, the random walk last; no process where neither B nor K is above 0
      type(component_model_type), intent(out) :: model
      !> invalid_argument
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: first, last, level, time

      if (.not. all([terms%n, terms%b, terms%k, terms%longest] >= 0.0_dp .and. &
                     [terms%n, terms%b, terms%k, terms%longest] <= huge(1.0_dp))) then
         call fatal_error(error, status%invalid_argument, "the coefficients of an Allan deviation must be finite and >= 0")
         return
      end if
      model%r = terms%n**2
      if (terms%b > 0.0_dp) then
         level = floor_share*terms%b
         first = max(1.0_dp, (terms%n/level)**2)
         last = max(first, terms%longest)
         if (terms%k > 0.0_dp) last = max(first, min(last, 3.0_dp*(level/terms%k)**2))
         time = sqrt(first)*sqrt(last)/highest_at
         model%count = 1
         model%phi(1) = exp(-1.0_dp/time)
         model%q(1) = 0.5_dp*(level/highest)**2*(1.0_dp - model%phi(1))*(1.0_dp + model%phi(1))
      end if
      if (terms%k > 0.0_dp) then
         model%count = model%count + 1
         model%phi(model%count) = 1.0_dp
         model%q(model%count) = terms%k**2
      end if
   end subroutine make_allan_model

end module gyroakf_filter_allan_model
