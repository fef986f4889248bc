! SPDX-License-Identifier: MIT
!> Covariances of two second differences of the phase, of each noise process of variance parameter 1.
!>
!> A difference of step m and one of step n, their centres u apart, have the covariance that is the second difference of
!> step n of the second difference of step m of the phase's generalised autocovariance
!>
!> $$ s_x(t) = -\frac{N^2 |t|}{2} + \frac{B^2}{2\pi} t^2 \ln|t| + \frac{K^2 |t|^3}{12}
!>    - s^2 \left( \frac{p}{(1-p)^2} p^{|t|} + \frac{1 + p}{2 (1 - p)} |t| \right) $$
!>
!> (C. A. Greenhall, IEEE Trans. UFFC 47, 2000, for generalised autocovariances; the last term is that of a sampled first-order
!> Markov process of variance s^2, p = exp(-1/T)). All lengths are in samples.
module gyroakf_allan_lag_covariance
   use gyroakf_kinds, only : dp
   use gyroakf_allan_noise_model, only : markov_levels, markov_remainder
   implicit none (type, external)
   private
   public :: process_count, process_white, process_flicker, process_walk, process_markov
   public :: lag_type, new_lag, lag_covariances

   !> The processes that are smooth between the kinks, and their places
   integer, parameter :: process_count = 4
   integer, parameter :: process_white = 1, process_flicker = 2, process_walk = 3, process_markov = 4
   !> 1/(2 pi)
   real(dp), parameter :: per_two_pi = 0.15915494309189535_dp

   !> Steps and processes
   type :: lag_type
      !> Shorter and longer step
      real(dp) :: m = 1.0_dp, n = 1.0_dp
      !> Which processes are wanted
      logical :: wanted(process_count) = .false.
      !> Of the Markov process: correlation time, constants of its generalised autocovariance
      real(dp) :: time = 1.0_dp, slope = 0.0_dp, level = 0.0_dp
   end type lag_type

contains

   !> Prepares for two steps.
   pure function new_lag(m, n, wanted, time) result(lag)
      !> Steps
      real(dp), intent(in) :: m, n
      !> Which processes
      logical, intent(in) :: wanted(process_count)
      !> Correlation time of the Markov process, > 0
      real(dp), intent(in) :: time
      type(lag_type) :: lag

      lag%m = min(m, n)
      lag%n = max(m, n)
      lag%wanted = wanted
      lag%time = time
      call markov_levels(time, lag%slope, lag%level)
   end function new_lag

   !> The covariances at a distance of the centres.
   pure function lag_covariances(lag, u) result(r)
      !> Steps and processes
      type(lag_type), intent(in) :: lag
      !> Distance, >= 0
      real(dp), intent(in) :: u
      !> One per process, 0 where it is not wanted
      real(dp) :: r(process_count)

      r = inner_differences(lag, u + lag%n) - 2*inner_differences(lag, u) + inner_differences(lag, abs(u - lag%n))
   end function lag_covariances

   !> Second differences of step m of the generalised autocovariances, up to a constant.
   pure function inner_differences(lag, t) result(d)
      !> Steps and processes
      type(lag_type), intent(in) :: lag
      !> Lag, >= 0
      real(dp), intent(in) :: t
      real(dp) :: d(process_count)

      real(dp) :: m

      m = lag%m
      d = 0
      if (t < m) then
         d(process_white) = t - m
         d(process_walk) = (m**3 + t**2*(3*m - t))/6
      else
         d(process_walk) = m**2*t/2
      end if
      if (lag%wanted(process_flicker)) d(process_flicker) = per_two_pi*m**2*flicker_difference(t/m)
      if (lag%wanted(process_markov)) d(process_markov) = markov_difference(lag, t)
      d = merge(d, 0.0_dp, lag%wanted)
   end function inner_differences

   !> (s+1)^2 ln(s+1) + (s-1)^2 ln|s-1| - 2 s^2 ln s without cancellation at large s.
   pure real(dp) function flicker_difference(s) result(g)
      !> Lag over step, >= 0
      real(dp), intent(in) :: s

      real(dp) :: q

      if (s > 8) then
         q = 1/s**2
         g = 2*log(s) + 3 - q*(1/6.0_dp + q*(1/30.0_dp + q*(1/84.0_dp + q/180.0_dp)))
      else
         g = (s + 1)**2*log(s + 1)
         if (abs(s - 1) > 0) g = g + (s - 1)**2*log(abs(s - 1))
         if (s > 0) g = g - 2*s**2*log(s)
      end if
   end function flicker_difference

   !> The same of the Markov process.
   pure real(dp) function markov_difference(lag, t) result(d)
      !> Steps, constants of the process
      type(lag_type), intent(in) :: lag
      !> Lag, >= 0
      real(dp), intent(in) :: t

      real(dp) :: x, c

      x = lag%m/lag%time
      c = t/lag%time
      if (t < lag%m) then
         d = -lag%level*(markov_remainder(x + c) + markov_remainder(x - c) - 2*markov_remainder(c)) - 2*lag%slope*(lag%m - t)
      else
         ! p^t (2 cosh x - 2), in a form that cannot overflow
         d = -lag%level*exp(-min(c - x, 700.0_dp))*(1 - exp(-min(x, 700.0_dp)))**2
      end if
   end function markov_difference

end module gyroakf_allan_lag_covariance
