! SPDX-License-Identifier: MIT
!> Covariances of overlapping Allan variances of a mixture of Q, N, B, K and R, in closed form and quadrature.
!>
!> With z_m(k) = x_{k+2m} - 2 x_{k+m} + x_k, M_m = n - 2m + 1 terms, and Gaussian noise,
!>
!> $$ \mathrm{Cov}(\hat\sigma^2_m, \hat\sigma^2_n) = \frac{1}{4 m^2 n^2 M_m M_n}
!>    \sum_{i,j} \left( 2 R_{mn}(j-i)^2 + 4 \mu_m \mu_n R_{mn}(j-i) \right) $$
!>
!> where R_mn is the covariance of z_m and z_n and mu_m = R m^2 the mean of z_m, the ramp's. R_mn is a second difference
!> of step m and one of step n of the phase's generalised autocovariance
!>
!> $$ s_x(t) = -\frac{N^2 |t|}{2} + \frac{B^2}{2\pi} t^2 \ln|t| + \frac{K^2 |t|^3}{12} \quad\text{and}\quad Q^2 \delta(t) $$
!>
!> (C. A. Greenhall, IEEE Trans. UFFC 47, 2000, for the generalised autocovariances). As a function of the distance u of the
!> centres of the two differences it is even, and smooth between the kinks 0, n - m, m, n, n + m. The sum over the lags is
!> Gauss quadrature between the kinks, or term by term where they are close: its cost does not depend on
!> the length of the record. All lengths are in samples here, and so are the units of the coefficients.
module gyroakf_allan_covariance
   use gyroakf_kinds, only : dp, int64
   use gyroakf_allan_noise_model, only : term_count, term_flicker, term_quantisation, term_ramp, term_walk, term_white
   implicit none (type, external)
   private
   public :: allan_covariance, allan_variance_covariances

   !> Pi
   real(dp), parameter :: pi = 3.141592653589793_dp
   !> Segments up to this length are summed term by term
   real(dp), parameter :: direct_max = 24.0_dp
   !> Nodes and weights of Gauss and Legendre on 0 .. 1
   integer, parameter :: node_count = 6
   real(dp), parameter :: node(node_count) = [0.033765242898423986_dp, 0.16939530676686776_dp, 0.38069040695840156_dp, &
      & 0.61930959304159844_dp, 0.83060469323313224_dp, 0.96623475710157601_dp]
   real(dp), parameter :: weight(node_count) = [0.085662246189585178_dp, 0.18038078652406930_dp, 0.23395696728634552_dp, &
      & 0.23395696728634552_dp, 0.18038078652406930_dp, 0.085662246189585178_dp]
   !> Kinks and further ends of segments at most
   integer, parameter :: ends_max = 12

   !> Two averaging factors and what lies between them
   type :: pair_type
      !> Shorter and longer factor, in samples
      real(dp) :: m = 1.0_dp, n = 1.0_dp
      !> Terms of the longer factor
      real(dp) :: terms = 1.0_dp
      !> Squared coefficients in samples
      real(dp) :: squares(term_count) = 0.0_dp
   end type pair_type

contains

   !> Covariance matrix of the Allan variances.
   pure subroutine allan_variance_covariances(samples, m, squares, covariance)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2: [k]
      integer(int64), intent(in) :: m(:)
      !> Squared coefficients for a sample interval of 1: Q^2, N^2, B^2, K^2, R^2
      real(dp), intent(in) :: squares(term_count)
      !> The matrix: [k, k]
      real(dp), intent(out) :: covariance(:, :)

      integer :: i, j

      do j = 1, size(m)
         do i = 1, j
            covariance(i, j) = allan_covariance(samples, m(i), m(j), squares)
            covariance(j, i) = covariance(i, j)
         end do
      end do
   end subroutine allan_variance_covariances

   !> Covariance of the Allan variances at two averaging factors; the variance if they are equal.
   pure real(dp) function allan_covariance(samples, m1, m2, squares) result(covariance)
      !> Rate samples in the record
      integer(int64), intent(in) :: samples
      !> Averaging factors, 1 <= m <= samples/2
      integer(int64), intent(in) :: m1, m2
      !> Squared coefficients for a sample interval of 1
      real(dp), intent(in) :: squares(term_count)

      type(pair_type) :: pair
      real(dp) :: sum_squares, sum_plain, other_terms

      pair%m = real(min(m1, m2), dp)
      pair%n = real(max(m1, m2), dp)
      pair%terms = real(samples - 2*max(m1, m2) + 1, dp)
      pair%squares = squares
      other_terms = real(samples - 2*min(m1, m2) + 1, dp)
      sum_squares = 0
      sum_plain = 0
      call add_smooth(pair, sum_squares, sum_plain)
      if (squares(term_quantisation) > 0) call add_quantisation(pair, sum_squares, sum_plain)
      ! the mean of z is R m^2, R n^2
      covariance = (2*sum_squares/(pair%m*pair%n)**2 + 4*squares(term_ramp)*sum_plain)/(4*pair%terms*other_terms)
   end function allan_covariance

   !> The part of the sums that is smooth between the kinks.
   pure subroutine add_smooth(pair, sum_squares, sum_plain)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> Sums over all lags of R^2 and of R, to add to
      real(dp), intent(inout) :: sum_squares, sum_plain

      real(dp) :: ends(ends_max), last
      integer :: i, count

      if (all(pair%squares([term_white, term_flicker, term_walk]) <= 0)) return
      call segment_ends(pair, ends, count)
      last = pair%terms + (pair%n - pair%m)
      do i = 1, count - 1
         if (ends(i) >= last) exit
         call add_segment(pair, ends(i), min(ends(i + 1), last), sum_squares, sum_plain)
      end do
   end subroutine add_smooth

   !> Kinks of R, ascending; with flicker noise also places inside long segments and in the tail.
   pure subroutine segment_ends(pair, ends, count)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> The places, from 0
      real(dp), intent(out) :: ends(ends_max)
      !> How many
      integer, intent(out) :: count

      real(dp) :: m, n, middle

      m = pair%m
      n = pair%n
      ends = 0
      if (pair%squares(term_flicker) > 0 .and. n > 8*m) then
         middle = anint(sqrt(m*n/2))
         ends(2:8) = [m, middle, anint(n/2), n - middle, n - m, n, n + m]
         count = 8
      else
         ends(2:5) = [min(m, n - m), max(m, n - m), n, n + m]
         count = 5
      end if
      if (pair%squares(term_flicker) > 0) then
         ends(count + 1:count + 3) = (n + m)*[2, 4, 16]
         count = count + 3
      end if
   end subroutine segment_ends

   !> Adds both signs of the lags between two places (half the terms at the places themselves).
   pure subroutine add_segment(pair, first, last, sum_squares, sum_plain)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> The places, whole numbers
      real(dp), intent(in) :: first, last
      !> Sums to add to
      real(dp), intent(inout) :: sum_squares, sum_plain

      real(dp) :: length, u, r, factor
      integer :: i

      length = last - first
      if (length <= 0) return
      if (length <= direct_max) then
         do i = 0, nint(length)
            u = first + i
            factor = lag_count(pair, u)*merge(1.0_dp, 2.0_dp, i == 0 .or. i == nint(length))
            r = smooth_covariance(pair, u)
            sum_squares = sum_squares + factor*r**2
            sum_plain = sum_plain + factor*r
         end do
      else
         do i = 1, node_count
            u = first + node(i)*length
            factor = 2*weight(i)*length*lag_count(pair, u)
            r = smooth_covariance(pair, u)
            sum_squares = sum_squares + factor*r**2
            sum_plain = sum_plain + factor*r
         end do
      end if
   end subroutine add_segment

   !> Number of pairs of terms whose centres are u apart (one sign).
   pure real(dp) function lag_count(pair, u)
      !> Factors
      type(pair_type), intent(in) :: pair
      !> Distance, >= 0
      real(dp), intent(in) :: u

      lag_count = max(0.0_dp, pair%terms - max(0.0_dp, u - (pair%n - pair%m)))
   end function lag_count

   !> Covariance of the two second differences, without quantisation noise.
   pure real(dp) function smooth_covariance(pair, u) result(r)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> Distance of the centres, >= 0
      real(dp), intent(in) :: u

      r = inner_difference(pair, u + pair%n) - 2*inner_difference(pair, u) + inner_difference(pair, abs(u - pair%n))
   end function smooth_covariance

   !> Second difference of step m of the generalised autocovariance, up to a constant.
   pure real(dp) function inner_difference(pair, t) result(d)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> Lag, >= 0
      real(dp), intent(in) :: t

      real(dp) :: m

      m = pair%m
      d = 0
      if (t < m) then
         d = d - pair%squares(term_white)*(m - t) + pair%squares(term_walk)/6*(m**3 + t**2*(3*m - t))
      else
         d = d + pair%squares(term_walk)/2*m**2*t
      end if
      if (pair%squares(term_flicker) > 0) d = d + pair%squares(term_flicker)/(2*pi)*m**2*flicker_difference(t/m)
   end function inner_difference

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

   !> What quantisation noise adds: R has a spike at each kink.
   pure subroutine add_quantisation(pair, sum_squares, sum_plain)
      !> Factors and coefficients
      type(pair_type), intent(in) :: pair
      !> Sums to add to
      real(dp), intent(inout) :: sum_squares, sum_plain

      real(dp), parameter :: height(5) = [4.0_dp, 1.0_dp, -2.0_dp, -2.0_dp, 1.0_dp]
      real(dp) :: place(5), spike, r, factor
      integer :: i

      place = [0.0_dp, pair%n - pair%m, pair%m, pair%n, pair%m + pair%n]
      do i = 1, 5
         if (any(same_place(place(:i - 1), place(i)))) cycle
         spike = pair%squares(term_quantisation)*sum(height, mask=same_place(place, place(i)))
         factor = 2*lag_count(pair, place(i))
         if (i == 1) then                                   ! n = m: the differences meet from both sides
            factor = lag_count(pair, place(i))
            if (same_place(pair%n, pair%m)) spike = 6*pair%squares(term_quantisation)
         end if
         r = smooth_covariance(pair, place(i))
         sum_squares = sum_squares + factor*spike*(spike + 2*r)
         sum_plain = sum_plain + factor*spike
      end do
   end subroutine add_quantisation

   !> Whether two whole numbers are equal.
   elemental logical function same_place(a, b)
      !> The numbers
      real(dp), intent(in) :: a, b

      same_place = abs(a - b) < 0.5_dp
   end function same_place

end module gyroakf_allan_covariance
