! SPDX-License-Identifier: MIT
!> The gamma function and its relatives: ln Gamma, digamma, trigamma, incomplete gamma ratios.
!>
!> The ratio $$P(a, x) = \frac{1}{\Gamma(a)}\int_0^x t^{a-1} e^{-t} dt$$ is computed by its power
!> series, its continued fraction, or Temme's uniform expansion where a is large and x near a.
!> Sources: Abramowitz & Stegun, Handbook of Mathematical Functions (1964), 6.3 to 6.5;
!> N. M. Temme, SIAM J. Math. Anal. 10 (1979) 757-766.
module gyroakf_gamma
   use, intrinsic :: iso_c_binding, only : c_double
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_is_finite, ieee_value, ieee_quiet_nan
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: ln_gamma, digamma, trigamma, incomplete_gamma, gamma_term, log1p

   interface
      !> ln(1 + x) of the C library, accurate for small x
      pure function log1p(x) bind(c, name="log1p")
         import :: c_double
         implicit none (type, external)
         real(c_double), intent(in), value :: x
         real(c_double) :: log1p
      end function log1p
   end interface

   real(dp), parameter :: pi = 3.1415926535897932384626433832795_dp
   real(dp), parameter :: sqrt_two_pi = 2.5066282746310005024157652848110_dp
   !> exp(-x) is zero for larger x
   real(dp), parameter :: largest_exponent = 745.2_dp
   !> Temme's expansion is used from this a on, where |eta| < 1
   real(dp), parameter :: smallest_temme = 20.0_dp
   integer, parameter :: most_terms = 2000

   !> Coefficients of eta/(lambda - 1) in powers of eta, eta^2/2 = lambda - 1 - ln(lambda);
   !> from the series of lambda(eta) in rational arithmetic
   real(dp), parameter :: temme(0:30) = [ &
      & 1.0_dp, -0.333333333333333333_dp, 0.0833333333333333333_dp, -0.0148148148148148148_dp, &
      & 0.00115740740740740741_dp, 0.0003527336860670194_dp, -0.000178755144032921811_dp, &
      & 0.0000391926317852243778_dp, -2.18544851067999216e-6_dp, -1.85406221071515996e-6_dp, &
      & 8.29671134095308601e-7_dp, -1.76659527368260793e-7_dp, 6.70785354340149858e-9_dp, &
      & 1.0261809784240308e-8_dp, -4.38203601845335319e-9_dp, 9.14769958223679023e-10_dp, &
      & -2.55141939949462498e-11_dp, -5.83077213255042507e-11_dp, 2.43619480206674162e-11_dp, &
      & -5.02766928011417559e-12_dp, 1.10043920319561348e-13_dp, 3.37176326240098538e-13_dp, &
      & -1.39238872241816207e-13_dp, 2.85348938070474432e-14_dp, -5.13911183424257262e-16_dp, &
      & -1.97522882943494428e-15_dp, 8.09952115670456133e-16_dp, -1.65225312163981618e-16_dp, &
      & 2.53054300974788842e-18_dp, 1.16869397385595766e-17_dp, -4.77003704982048476e-18_dp]

contains

   !> Logarithm of the gamma function.
   !>
   !> $$\ln\Gamma(x) = (x - \tfrac12)\ln x - x + \tfrac12\ln 2\pi +
   !>    \sum_k \frac{B_{2k}}{2k(2k-1)x^{2k-1}}$$ after $$\ln\Gamma(x) = \ln\Gamma(x+1) - \ln x$$
   !> up to x >= 10. Source: A&S 6.1.40. Absolute error about 1e-15 max(10, |ln Gamma|).
   !> The intrinsic `log_gamma` calls C's `lgamma`, which writes the sign of Gamma into a variable
   !> of the whole program, `signgam`.
   elemental real(dp) function ln_gamma(x)
      !> > 0
      real(dp), intent(in) :: x
      real(dp), parameter :: half_log_two_pi = 0.91893853320467274178_dp
      real(dp) :: y, product

      product = 1.0_dp
      y = x
      do while (y < 10.0_dp)
         product = product*y
         y = y + 1.0_dp
      end do
      ln_gamma = ((y - 0.5_dp)*log(y) - y) + half_log_two_pi + stirling_series(y)
      if (product > 1.0_dp .or. product < 1.0_dp) ln_gamma = ln_gamma - log(product)
   end function ln_gamma

   !> What Stirling's formula leaves out of ln Gamma(x), x >= 10.
   elemental real(dp) function stirling_series(x)
      real(dp), intent(in) :: x
      real(dp) :: b

      b = 1.0_dp/(x*x)
      stirling_series = (1.0_dp/12.0_dp - b*(1.0_dp/360.0_dp - b*(1.0_dp/1260.0_dp - &
         b*(1.0_dp/1680.0_dp - b*(1.0_dp/1188.0_dp - b*(691.0_dp/360360.0_dp - b/156.0_dp))))))/x
   end function stirling_series

   !> Digamma function, the derivative of ln Gamma.
   !>
   !> $$\psi(x) = \ln x - \frac{1}{2x} - \sum_k \frac{B_{2k}}{2k x^{2k}}$$ after
   !> $$\psi(x) = \psi(x+1) - 1/x$$ up to x >= 10. Source: A&S 6.3.5, 6.3.7, 6.3.18. Absolute
   !> error about 1e-15 max(1, |psi|).
   elemental real(dp) function digamma(x)
      !> Any value; 0, -1, -2, ... and NaN and -infinity give NaN
      real(dp), intent(in) :: x
      real(dp) :: y, b, shift

      digamma = ieee_value(x, ieee_quiet_nan)
      if (ieee_is_nan(x)) return
      if (x <= 0.0_dp) then
         if (.not. ieee_is_finite(x)) return
         if (abs(x - anint(x)) <= 0.0_dp) return
      end if
      shift = 0.0_dp
      y = x
      if (x < 0.0_dp) then
         y = 1.0_dp - x
         shift = -pi/tan(pi*(x - anint(x)))
      end if
      do while (y < 10.0_dp)
         shift = shift - 1.0_dp/y
         y = y + 1.0_dp
      end do
      b = 1.0_dp/(y*y)
      digamma = log(y) - 0.5_dp/y - b*(1.0_dp/12.0_dp - b*(1.0_dp/120.0_dp - &
         b*(1.0_dp/252.0_dp - b*(1.0_dp/240.0_dp - b*(1.0_dp/132.0_dp - &
         b*(691.0_dp/32760.0_dp - b/12.0_dp)))))) + shift
   end function digamma

   !> Derivative of digamma (Abramowitz & Stegun 6.4.6 and 6.4.12, to 1e-8).
   elemental real(dp) function trigamma(x)
      !> Argument, > 0
      real(dp), intent(in) :: x
      real(dp) :: y, q

      trigamma = 0
      y = x
      do while (y < 8)
         trigamma = trigamma + 1/y**2
         y = y + 1
      end do
      q = 1/y**2
      trigamma = trigamma + 1/y + q/2 + q/y*(1/6.0_dp - q*(1/30.0_dp - q*(1/42.0_dp - q/30)))
   end function trigamma

   !> Both incomplete gamma ratios, P(a, x) and Q(a, x) = 1 - P; the smaller one is computed.
   pure subroutine incomplete_gamma(a, x, p, q)
      !> Parameter > 0, else NaN, and upper limit of the integral
      real(dp), intent(in) :: a, x
      !> Lower and upper tail
      real(dp), intent(out) :: p, q
      real(dp) :: eta

      p = ieee_value(p, ieee_quiet_nan)
      q = p
      if (ieee_is_nan(x) .or. .not. ieee_is_finite(a)) return
      if (a <= 0.0_dp) return
      if (x <= 0.0_dp) then
         p = 0.0_dp
         q = 1.0_dp
      else if (.not. ieee_is_finite(x)) then
         p = 1.0_dp
         q = 0.0_dp
      else
         eta = 2.0_dp
         if (a >= smallest_temme) eta = sign(sqrt(2.0_dp*excess(a, x)), x - a)
         if (abs(eta) < 1.0_dp) then
            call uniform_expansion(a, eta, p, q)
         else if (x < a + 1.0_dp) then
            p = gamma_term(a, x)*series_sum(a, x)
            q = 1.0_dp - p
         else
            q = gamma_term(a, x)*a*continued_fraction(a, x)
            p = 1.0_dp - q
         end if
      end if
   end subroutine incomplete_gamma

   !> Temme's uniform expansion: Q = erfc(eta sqrt(a/2))/2 + R, P likewise with -eta, -R,
   !> R = exp(-a eta^2/2) S(eta)/(sqrt(2 pi a) Gamma*(a)), the coefficients of S by the backward
   !> recursion t(n-1) = f(n) + (n+1)/a t(n+1), and Gamma*(a) = 1 + t(1)/a.
   pure subroutine uniform_expansion(a, eta, p, q)
      real(dp), intent(in) :: a, eta
      real(dp), intent(out) :: p, q
      real(dp) :: t(0:31), s, rest
      integer :: n

      t(30:31) = 0.0_dp
      do n = 30, 1, -1
         t(n - 1) = temme(n) + real(n + 1, dp)/a*t(n + 1)
      end do
      s = t(29)
      do n = 28, 0, -1
         s = t(n) + eta*s
      end do
      rest = exp(-0.5_dp*a*eta*eta)*s/(sqrt_two_pi*sqrt(a)*(1.0_dp + t(1)/a))
      q = 0.5_dp*erfc(eta*sqrt(0.5_dp*a)) + rest
      p = 0.5_dp*erfc(-eta*sqrt(0.5_dp*a)) - rest
   end subroutine uniform_expansion

   !> lambda - 1 - ln(lambda), lambda = x/a, without cancellation near lambda = 1.
   pure real(dp) function excess(a, x)
      real(dp), intent(in) :: a, x
      real(dp) :: mu, r, r2, s
      integer :: k

      mu = (x - a)/a
      if (mu < -0.5_dp) then
         excess = mu - log(max(x/a, tiny(x)))
      else if (mu > 1.0_dp) then
         excess = mu - log1p(mu)
      else
         r = mu/(2.0_dp + mu)
         r2 = r*r
         s = 0.0_dp
         do k = 35, 3, -2
            s = s*r2 + 1.0_dp/real(k, dp)
         end do
         excess = r*(mu - 2.0_dp*r2*s)
      end if
   end function excess

   !> x^a exp(-x)/Gamma(a + 1).
   pure real(dp) function gamma_term(a, x) result(term)
      !> Both > 0
      real(dp), intent(in) :: a, x
      real(dp) :: exponent

      if (a < 10.0_dp) then
         term = 0.0_dp
         if (x < 2.0_dp*largest_exponent) then
            term = x**a*exp(-0.5_dp*x)/gamma(a + 1.0_dp)*exp(-0.5_dp*x)
         end if
         return
      end if
      exponent = a*excess(a, x)
      term = 0.0_dp
      if (exponent < largest_exponent) then
         term = exp(-exponent)*exp(-stirling_series(a))/(sqrt_two_pi*sqrt(a))
      end if
   end function gamma_term

   !> 1 + x/(a+1) + x^2/((a+1)(a+2)) + ... (A&S 6.5.29).
   pure real(dp) function series_sum(a, x) result(total)
      real(dp), intent(in) :: a, x
      real(dp) :: term
      integer :: n

      total = 1.0_dp
      term = 1.0_dp
      do n = 1, most_terms
         term = term*(x/(a + real(n, dp)))
         total = total + term
         if (term <= 0.1_dp*epsilon(total)*total) exit
      end do
   end function series_sum

   !> Continued fraction of Gamma(a, x) exp(x) x^(-a) (A&S 6.5.31, contracted), by Lentz' method.
   pure real(dp) function continued_fraction(a, x) result(h)
      real(dp), intent(in) :: a, x
      real(dp) :: b, c, d, an, factor
      integer :: n

      b = x + 1.0_dp - a
      c = 1.0_dp/tiny(a)**0.5_dp
      d = 1.0_dp/b
      h = d
      do n = 1, most_terms
         an = -real(n, dp)*(real(n, dp) - a)
         b = b + 2.0_dp
         d = 1.0_dp/(b + an*d)
         c = b + an/c
         factor = c*d
         h = h*factor
         if (abs(factor - 1.0_dp) <= epsilon(h)) exit
      end do
   end function continued_fraction

end module gyroakf_gamma
