! SPDX-License-Identifier: MIT
!> Distribution of the integral of a squared Brownian bridge, of the first and of the second level:
!> the limits of the KPSS statistic about a level and about a line.
module gyroakf_stats_bridge
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: bridge_survival

   real(dp), parameter :: pi = 3.14159265358979323846_dp
   !> Nodes of the quadrature between two zeros; twice as many change nothing
   integer, parameter :: nodes = 40
   !> Intervals at most: exp(-x s^2/2) has vanished long before for the smallest x
   integer, parameter :: most_intervals = 40
   !> Below it the probability is 1 to rounding
   real(dp), parameter :: smallest(2) = [0.01_dp, 0.006_dp]

contains

   !> Probability that the integral exceeds x, by Smirnov's formula.
   !>
   !> $$P = \frac{2}{\pi} \sum_{k \ge 1} (-1)^{k+1} \int_{s_{2k-1}}^{s_{2k}} \frac{e^{-x s^2/2}}{s
   !> \sqrt{-D(s)}} ds$$ where s_1 < s_2 < ... are the zeros of D: sin(s)/s for the first level, 12
   !> (2 - 2 cos s - s sin s)/s^4 for the second. Absolute error below 1e-14, relative error below
   !> 1e-12. Sources: Anderson & Darling, Ann. Math. Stat. 23 (1952) 193-212; MacNeill, Ann. Stat. 6
   !> (1978) 422-433.
   pure real(dp) function bridge_survival(x, level) result(p)
      !> Any value; p is 1 for x <= 0
      real(dp), intent(in) :: x
      !> 1 or 2
      integer, intent(in) :: level
      real(dp) :: term, sign
      integer :: k

      p = 1.0_dp
      if (x <= smallest(level)) return
      p = 0.0_dp
      sign = 2.0_dp/pi
      do k = 1, most_intervals
         term = sign*integral(x, level, k)
         p = p + term
         sign = -sign
         if (abs(term) <= 1.0e-3_dp*epsilon(p)*abs(p)) exit
      end do
      p = min(max(p, 0.0_dp), 1.0_dp)
   end function bridge_survival

   !> The integral between zeros 2k-1 and 2k, with s = middle + half cos(angle).
   pure real(dp) function integral(x, level, k) result(total)
      real(dp), intent(in) :: x
      integer, intent(in) :: level, k
      real(dp) :: first, last, middle, half, angle, s
      integer :: i

      first = real(2*k - 1, dp)*pi
      last = real(2*k, dp)*pi
      if (level == 2) then
         first = real(2*k, dp)*pi
         last = second_zero(k)
      end if
      middle = 0.5_dp*(first + last)
      half = 0.5_dp*(last - first)
      total = 0.0_dp
      do i = 1, nodes
         angle = (real(i, dp) - 0.5_dp)*pi/real(nodes, dp)
         s = middle + half*cos(angle)
         total = total + sin(angle)*exp(-0.5_dp*x*s*s)/(s*sqrt(abs(determinant(s, level))))
      end do
      total = total*half*pi/real(nodes, dp)
   end function integral

   !> D(s).
   pure real(dp) function determinant(s, level)
      real(dp), intent(in) :: s
      integer, intent(in) :: level
      real(dp) :: half

      if (level == 1) then
         determinant = sin(s)/s
      else
         half = 0.5_dp*s
         determinant = 48.0_dp*sin(half)*(sin(half) - half*cos(half))/s**4
      end if
   end function determinant

   !> Zero of tan(u) = u, u = s/2, next to 2 pi k, by Newton's method on sin(u) - u cos(u).
   pure real(dp) function second_zero(k) result(s)
      integer, intent(in) :: k
      real(dp) :: u
      integer :: i

      u = (real(k, dp) + 0.5_dp)*pi
      u = u - 1.0_dp/u
      do i = 1, 6
         u = u - (sin(u) - u*cos(u))/(u*sin(u))
      end do
      s = 2.0_dp*u
   end function second_zero

end module gyroakf_stats_bridge
