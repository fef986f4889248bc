! SPDX-License-Identifier: MIT
!> Special functions: normal and chi-square distributions, ln Gamma, digamma.
!>
!> All are elemental and thread-safe. The chi-square distribution is the incomplete gamma
!> function $$P(a, x) = \frac{1}{\Gamma(a)}\int_0^x t^{a-1} e^{-t} dt, \quad a = \nu/2,$$ computed by its power
!> series, its continued fraction, or Temme's uniform expansion where a is large and x near a.
!> Sources: Abramowitz & Stegun, Handbook of Mathematical Functions (1964), 6.3, 6.5, 26.2-26.4;
!> N. M. Temme, SIAM J. Math. Anal. 10 (1979) 757-766.
!>
!> Measured against 50-digit arithmetic, 0.1 to 1e7 degrees of freedom: 2e-14 relative down to tails
!> of 1e-30, 2e-13 down to 1e-300 (each tail is then as sensitive to its argument); quantiles 2e-14.
module gyroakf_special
   use, intrinsic :: iso_c_binding, only : c_double
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_is_finite, ieee_value, ieee_quiet_nan, &
      & ieee_positive_inf, ieee_negative_inf
   use gyroakf_kinds, only : dp
   implicit none (type, external)
   private
   public :: normal_cdf, log_normal_cdf, normal_quantile, chi_square_cdf, chi_square_survival, chi_square_quantile, digamma, &
      & trigamma, ln_gamma
   public :: log1p

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
   real(dp), parameter :: sqrt_half = 0.70710678118654752440084436210485_dp
   real(dp), parameter :: sqrt_two_pi = 2.5066282746310005024157652848110_dp
   !> exp(-x) is zero for larger x
   real(dp), parameter :: largest_exponent = 745.2_dp
   !> Temme's expansion is used from this a on, where |eta| < 1
   real(dp), parameter :: smallest_temme = 20.0_dp
   integer, parameter :: most_terms = 2000, most_steps = 100

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

   !> Standard normal distribution function.
   !>
   !> $$\Phi(x) = \tfrac12 \mathrm{erfc}(-x/\sqrt2)$$
   !> 1 - Phi(x) is `normal_cdf(-x)`, without cancellation, down to 1e-300. Source: A&S 26.2.29.
   elemental real(dp) function normal_cdf(x)
      !> Any value; NaN gives NaN
      real(dp), intent(in) :: x

      normal_cdf = 0.5_dp*erfc(-x*sqrt_half)
   end function normal_cdf

   !> Logarithm of the standard normal distribution function, relatively accurate in both tails (4e-15; 1e-16 x^2 where x > 6).
   !>
   !> $$\ln\Phi(x) = \ln(\tfrac12\mathrm{erfc}(-x/\sqrt2)) = -x^2/2 + \ln(\tfrac12 e^{x^2/2}\mathrm{erfc}(-x/\sqrt2))$$
   !> the second form where x < -1, and $$\ln(1 - \Phi(-x))$$ by log1p where x > 0. ln(1 - Phi(x)) is `log_normal_cdf(-x)`.
   elemental real(dp) function log_normal_cdf(x)
      !> Any value; below -1e154 it is -infinity, NaN gives NaN
      real(dp), intent(in) :: x
      real(dp), parameter :: lowest = -1.0e154_dp

      if (ieee_is_nan(x)) then
         log_normal_cdf = x
      else if (x > 0.0_dp) then
         log_normal_cdf = log1p(-0.5_dp*erfc(x*sqrt_half))
      else if (x >= -1.0_dp) then
         log_normal_cdf = log(0.5_dp*erfc(-x*sqrt_half))
      else if (x >= lowest) then
         log_normal_cdf = log(0.5_dp*erfc_scaled(-x*sqrt_half)) - 0.5_dp*x*x
      else
         log_normal_cdf = ieee_value(x, ieee_negative_inf)
      end if
   end function log_normal_cdf

   !> Quantile of the standard normal distribution: the x where normal_cdf(x) = p.
   !>
   !> Halley's iteration on ln Phi in the tails, on erf in the centre.
   elemental real(dp) function normal_quantile(p)
      !> Probability, 0 < p < 1; 0 and 1 give -/+ infinity, outside and NaN give NaN. The upper
      !> tail is best reached as `-normal_quantile(q)` with the small q
      real(dp), intent(in) :: p
      real(dp) :: q

      if (ieee_is_nan(p)) then
         normal_quantile = p
      else if (p < 0.0_dp .or. p > 1.0_dp) then
         normal_quantile = ieee_value(p, ieee_quiet_nan)
      else if (p <= 0.0_dp) then
         normal_quantile = ieee_value(p, ieee_negative_inf)
      else if (p >= 1.0_dp) then
         normal_quantile = ieee_value(p, ieee_positive_inf)
      else if (abs(p - 0.5_dp) < 0.3_dp) then
         normal_quantile = central_quantile(p - 0.5_dp)
      else
         q = merge(p, 1.0_dp - p, p < 0.5_dp)
         normal_quantile = sign(tail_quantile(q), p - 0.5_dp)
      end if
   end function normal_quantile

   !> The x > 0 with upper tail q <= 0.2: Halley on ln Q, from A&S 26.2.23.
   pure real(dp) function tail_quantile(q) result(x)
      !> Upper tail, 0 < q <= 0.2
      real(dp), intent(in) :: q
      real(dp) :: t, tail, slope, gap
      integer :: i

      t = sqrt(-2.0_dp*log(q))
      x = t - (2.515517_dp + t*(0.802853_dp + t*0.010328_dp)) &
         & /(1.0_dp + t*(1.432788_dp + t*(0.189269_dp + t*0.001308_dp)))
      do i = 1, 3
         tail = 0.5_dp*erfc(x*sqrt_half)
         if (.not. tail > tiny(q)) exit
         slope = -exp(-0.5_dp*x*x)/(sqrt_two_pi*tail)
         gap = log(tail/q)
         x = x - gap/slope/(1.0_dp - 0.5_dp*gap/slope*(-x - slope))
      end do
   end function tail_quantile

   !> The x with Phi(x) - 1/2 = r for |r| < 0.3, relative accuracy kept as r goes to 0.
   pure real(dp) function central_quantile(r) result(x)
      !> Probability less one half
      real(dp), intent(in) :: r
      real(dp) :: step
      integer :: i

      x = sqrt_two_pi*r*(1.0_dp + pi/3.0_dp*r*r)
      do i = 1, 5
         step = (0.5_dp*erf(x*sqrt_half) - r)*sqrt_two_pi*exp(0.5_dp*x*x)
         step = step/(1.0_dp + 0.5_dp*step*x)
         x = x - step
         if (abs(step) <= 1.0e-9_dp*abs(x)) exit
      end do
   end function central_quantile

   !> Distribution function of chi-square.
   !>
   !> $$F(x; \nu) = P(\nu/2, x/2)$$
   elemental real(dp) function chi_square_cdf(x, dof)
      !> Value; x <= 0 gives 0, infinity 1, NaN gives NaN
      real(dp), intent(in) :: x
      !> Degrees of freedom, any real number > 0; else NaN
      real(dp), intent(in) :: dof
      real(dp) :: q

      call incomplete_gamma(0.5_dp*dof, 0.5_dp*x, chi_square_cdf, q)
   end function chi_square_cdf

   !> Upper tail of chi-square, 1 - F(x; nu) without cancellation.
   elemental real(dp) function chi_square_survival(x, dof)
      !> Value; x <= 0 gives 1, infinity 0, NaN gives NaN
      real(dp), intent(in) :: x
      !> Degrees of freedom, any real number > 0; else NaN
      real(dp), intent(in) :: dof
      real(dp) :: p

      call incomplete_gamma(0.5_dp*dof, 0.5_dp*x, p, chi_square_survival)
   end function chi_square_survival

   !> Quantile of chi-square: the x where F(x; nu) = p.
   !>
   !> Halley's iteration for ln F (p <= 1/2) or ln(1 - F) as functions of ln x, kept between
   !> bounds that close in. Start: Wilson & Hilferty (A&S 26.4.17) or the first term of the series.
   elemental real(dp) function chi_square_quantile(p, dof)
      !> Probability of the lower tail, 0 <= p <= 1: 0 gives 0, 1 infinity, outside and NaN give NaN;
      !> 0 too where the quantile underflows (p = 1e-30 with 0.1 degrees of freedom)
      real(dp), intent(in) :: p
      !> Degrees of freedom, any real number > 0 (tested 0.1 .. 1e7); else NaN
      real(dp), intent(in) :: dof

      if (ieee_is_nan(p) .or. .not. ieee_is_finite(dof)) then
         chi_square_quantile = ieee_value(p, ieee_quiet_nan)
      else if (p < 0.0_dp .or. p > 1.0_dp .or. dof <= 0.0_dp) then
         chi_square_quantile = ieee_value(p, ieee_quiet_nan)
      else if (p <= 0.0_dp) then
         chi_square_quantile = 0.0_dp
      else if (p >= 1.0_dp) then
         chi_square_quantile = ieee_value(p, ieee_positive_inf)
      else
         chi_square_quantile = 2.0_dp*gamma_quantile(p, 0.5_dp*dof)
      end if
   end function chi_square_quantile

   !> The x where P(a, x) = p, for 0 < p < 1.
   pure real(dp) function gamma_quantile(p, a) result(x)
      !> Lower tail
      real(dp), intent(in) :: p
      !> Parameter > 0
      real(dp), intent(in) :: a
      real(dp) :: u, low, high, target, lower, upper, tail, gap, slope, curve, step, side
      integer :: i

      low = -huge(p)
      high = huge(p)
      side = merge(1.0_dp, -1.0_dp, p <= 0.5_dp)
      target = merge(p, 1.0_dp - p, p <= 0.5_dp)
      u = quantile_start(p, a)
      x = exp(u)
      do i = 1, most_steps
         if (.not. x > tiny(x)) exit
         call incomplete_gamma(a, x, lower, upper)
         tail = merge(lower, upper, p <= 0.5_dp)
         if (side*(tail - target) > 0.0_dp) then
            high = u
         else
            low = u
         end if
         step = 0.0_dp
         if (tail > tiny(tail)) then
            gap = log(tail/target)
            slope = side*a*gamma_term(a, x)/tail
            curve = slope*(a - x - slope)
            step = gap*slope/(slope*slope - 0.5_dp*gap*curve)
         end if
         if (abs(step) > 1.0_dp .or. tail <= tiny(tail)) step = sign(1.0_dp, side*(tail - target))
         if (u - step < low .or. u - step > high) step = u - 0.5_dp*(low + high)
         u = u - step
         x = x*exp(-step)
         if (abs(step) <= 1.0e-9_dp) exit
      end do
   end function gamma_quantile

   !> ln x to start from.
   pure real(dp) function quantile_start(p, a) result(u)
      !> Lower tail, 0 < p < 1
      real(dp), intent(in) :: p
      !> Parameter > 0
      real(dp), intent(in) :: a
      real(dp) :: root

      root = 1.0_dp - 1.0_dp/(9.0_dp*a) + normal_quantile(p)/(3.0_dp*sqrt(a))
      u = (log(p) + ln_gamma(a + 1.0_dp))/a
      if (a >= 0.5_dp .and. root > 0.3_dp) u = log(a) + 3.0_dp*log(root)
      u = min(max(u, -1.0e4_dp), log(a + 800.0_dp + 40.0_dp*sqrt(a)))
   end function quantile_start

   !> Both incomplete gamma ratios, P(a, x) and Q(a, x) = 1 - P; the smaller one is computed.
   pure subroutine incomplete_gamma(a, x, p, q)
      !> Parameter > 0
      real(dp), intent(in) :: a
      !> Upper limit of the integral
      real(dp), intent(in) :: x
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
      !> Parameter and the variable eta, |eta| < 1
      real(dp), intent(in) :: a, eta
      !> Lower and upper tail
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
      !> Both > 0
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
      real(dp) :: exponent, b, star

      if (a < 10.0_dp) then
         term = 0.0_dp
         if (x < 2.0_dp*largest_exponent) term = x**a*exp(-0.5_dp*x)/gamma(a + 1.0_dp)*exp(-0.5_dp*x)
         return
      end if
      exponent = a*excess(a, x)
      b = 1.0_dp/(a*a)
      star = (1.0_dp/12.0_dp - b*(1.0_dp/360.0_dp - b*(1.0_dp/1260.0_dp - b*(1.0_dp/1680.0_dp &
         & - b*(1.0_dp/1188.0_dp - b*(691.0_dp/360360.0_dp - b/156.0_dp))))))/a
      term = 0.0_dp
      if (exponent < largest_exponent) term = exp(-exponent)*exp(-star)/(sqrt_two_pi*sqrt(a))
   end function gamma_term

   !> 1 + x/(a+1) + x^2/((a+1)(a+2)) + ... (A&S 6.5.29).
   pure real(dp) function series_sum(a, x) result(total)
      !> Both > 0, x < a + 1
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
      !> Both > 0, x >= a + 1
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

   !> Logarithm of the gamma function.
   !>
   !> $$\ln\Gamma(x) = (x - \tfrac12)\ln x - x + \tfrac12\ln 2\pi + \sum_k \frac{B_{2k}}{2k(2k-1)x^{2k-1}}$$ after
   !> $$\ln\Gamma(x) = \ln\Gamma(x+1) - \ln x$$ up to x >= 10. Source: A&S 6.1.40. Absolute error about 1e-15 max(10, |ln Gamma|).
   !> The intrinsic `log_gamma` calls C's `lgamma`, which writes the sign of Gamma into a variable of the whole program, `signgam`.
   elemental real(dp) function ln_gamma(x)
      !> > 0
      real(dp), intent(in) :: x
      real(dp), parameter :: half_log_two_pi = 0.91893853320467274178_dp
      real(dp) :: y, b, product

      product = 1.0_dp
      y = x
      do while (y < 10.0_dp)
         product = product*y
         y = y + 1.0_dp
      end do
      b = 1.0_dp/(y*y)
      ln_gamma = ((y - 0.5_dp)*log(y) - y) + half_log_two_pi + (1.0_dp/12.0_dp - b*(1.0_dp/360.0_dp - b*(1.0_dp/1260.0_dp &
         & - b*(1.0_dp/1680.0_dp - b*(1.0_dp/1188.0_dp - b*(691.0_dp/360360.0_dp - b/156.0_dp))))))/y
      if (product > 1.0_dp .or. product < 1.0_dp) ln_gamma = ln_gamma - log(product)
   end function ln_gamma

   !> Digamma function, the derivative of ln Gamma.
   !>
   !> $$\psi(x) = \ln x - \frac{1}{2x} - \sum_k \frac{B_{2k}}{2k x^{2k}}$$ after $$\psi(x) = \psi(x+1) - 1/x$$ up to
   !> x >= 10. Source: A&S 6.3.5, 6.3.7, 6.3.18. Absolute error about 1e-15 max(1, |psi|).
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
      digamma = log(y) - 0.5_dp/y - b*(1.0_dp/12.0_dp - b*(1.0_dp/120.0_dp - b*(1.0_dp/252.0_dp - b*(1.0_dp/240.0_dp &
         & - b*(1.0_dp/132.0_dp - b*(691.0_dp/32760.0_dp - b/12.0_dp)))))) + shift
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

end module gyroakf_special
