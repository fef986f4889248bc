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
      !> Of the Markov process: correlation time, constants of its generalised autocovariance, its difference at lag m
      real(dp) :: time = 1.0_dp, slope = 0.0_dp, level = 0.0_dp, far = 0.0_dp
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
      lag%far = -lag%level*(1 - exp(-min(lag%m/time, 700.0_dp)))**2
   end function new_lag

   !> The covariances at distances of the centres.
   pure function lag_covariances(lag, u) result(r)
      !> Steps and processes
      type(lag_type), intent(in) :: lag
      !> Distances, >= 0
      real(dp), intent(in) :: u(:)
      !> One per process, 0 where it is not wanted: [distances, processes]
      real(dp) :: r(size(u), process_count)

      r = 0
      call add_inner_differences(lag, 1.0_dp, u, lag%n, r)
      call add_inner_differences(lag, -2.0_dp, u, 0.0_dp, r)
      call add_inner_differences(lag, 1.0_dp, u, -lag%n, r)
   end function lag_covariances

   !> Adds second differences of step m of the generalised autocovariances, up to a constant.
   pure subroutine add_inner_differences(lag, factor, u, shift, r)
      !> Steps and processes
      type(lag_type), intent(in) :: lag
      !> Multiplies them
      real(dp), intent(in) :: factor
      !> The lags are |u + shift|
      real(dp), intent(in) :: u(:), shift
      !> Added to: [lags, processes]
      real(dp), intent(inout) :: r(:, :)

      real(dp) :: t(size(u)), m
      integer :: i

      m = lag%m
      t = abs(u + shift)
      if (lag%wanted(process_white)) r(:, process_white) = r(:, process_white) + factor*min(0.0_dp, t - m)
      if (lag%wanted(process_flicker)) then
         r(:, process_flicker) = r(:, process_flicker) + factor*per_two_pi*m**2*flicker_differences(t, m)
      end if
      if (lag%wanted(process_walk)) then
         r(:, process_walk) = r(:, process_walk) + factor*(m**2*t/2 + max(0.0_dp, m - t)**3/6)
      end if
      if (.not. lag%wanted(process_markov)) return
      ! p^t (2 cosh x - 2), in a form that cannot overflow
      r(:, process_markov) = r(:, process_markov) + factor*lag%far*exp(-max(0.0_dp, min((t - m)/lag%time, 700.0_dp)))
      do i = 1, size(t)
         if (t(i) < m) r(i, process_markov) = r(i, process_markov) + factor*(near_markov_difference(lag, t(i)) - lag%far)
      end do
   end subroutine add_inner_differences

   !> (s+1)^2 ln(s+1) + (s-1)^2 ln|s-1| - 2 s^2 ln s, s = t/m, without cancellation at large s.
   pure function flicker_differences(t, m) result(g)
      !> Lags, >= 0, and step
      real(dp), intent(in) :: t(:), m
      real(dp) :: g(size(t))

      real(dp), dimension(size(t)) :: s, q, logarithm

      s = t/m
      logarithm = log(max(s, tiny(1.0_dp)))
      g = (s + 1)**2*log(s + 1) + (s - 1)**2*log(max(abs(s - 1), tiny(1.0_dp))) - 2*s**2*logarithm
      q = 1/max(s, 1.0_dp)**2
      where (s > 8) g = 2*logarithm + 3 - q*(1/6.0_dp + q*(1/30.0_dp + q*(1/84.0_dp + q/180.0_dp)))
   end function flicker_differences

   !> The same of the Markov process, at lags below the step.
   pure real(dp) function near_markov_difference(lag, t) result(d)
      !> Steps, constants of the process
      type(lag_type), intent(in) :: lag
      !> Lag, 0 <= t < m
      real(dp), intent(in) :: t

      real(dp) :: x, c

      x = lag%m/lag%time
      c = t/lag%time
      d = -lag%level*(markov_remainder(x + c) + markov_remainder(x - c) - 2*markov_remainder(c)) - 2*lag%slope*(lag%m - t)
   end function near_markov_difference

end module gyroakf_allan_lag_covariance
