! SPDX-License-Identifier: MIT
!> Tests of the special functions. The numbers were computed with 50-digit arithmetic (mpmath 1.3,
!> series and continued fraction of the incomplete gamma function) and rounded to 17 digits.
module test_special
   use, intrinsic :: ieee_arithmetic, only : ieee_is_nan, ieee_is_finite, ieee_value, ieee_quiet_nan, ieee_positive_inf
   use gyroakf_kinds, only : dp
   use gyroakf_special, only : chi_square_cdf, chi_square_quantile, chi_square_survival, digamma, normal_cdf, &
      & normal_quantile, ln_gamma
   use expectations, only : agree, test, error, check
   implicit none (type, external)
   private
   public :: suite_special

   !> Relative error allowed: a few hundred units in the last place
   real(dp), parameter :: tolerance = 1.0e-13_dp
   !> Below 1e-30 a tail moves by 2 |ln tail| times the rounding of its argument
   real(dp), parameter :: deep_tolerance = 5.0e-13_dp

contains

   subroutine suite_special()
      call test("normal_cdf", test_normal_cdf)
      call test("normal_quantile", test_normal_quantile)
      call test("normal_round_trip", test_normal_round_trip)
      call test("chi_square_small", test_chi_square_small)
      call test("chi_square_large", test_chi_square_large)
      call test("chi_square_two", test_chi_square_two)
      call test("chi_square_seams", test_chi_square_seams)
      call test("chi_square_quantile", test_chi_square_quantile)
      call test("quantile_round_trip", test_quantile_round_trip)
      call test("ln_gamma", test_ln_gamma)
      call test("digamma", test_digamma)
      call test("edges", test_edges)
   end subroutine suite_special

   !> ln Gamma: exact values, and the intrinsic, whose errors are of the same size.
   subroutine test_ln_gamma()
      real(dp), parameter :: at(4) = [0.5_dp, 5.0_dp, 11.0_dp, 101.0_dp]
      real(dp) :: x, expected(4)
      integer :: i

      expected = [0.5_dp*log(acos(-1.0_dp)), log(24.0_dp), log(3628800.0_dp), 363.73937555556349014_dp]
      call check(error, all(abs(ln_gamma(at) - expected) <= 1.0e-15_dp*max(10.0_dp, expected)), "exact values")
      do i = -60, 60
         x = 1.37_dp**i
         call check(error, abs(ln_gamma(x) - log_gamma(x)) <= 1.0e-15_dp*max(10.0_dp, abs(log_gamma(x))), "beside the intrinsic")
      end do
   end subroutine test_ln_gamma

   subroutine test_normal_cdf()
      call agree(normal_cdf([-37.5_dp, -20.0_dp, -5.0_dp, -1.0_dp, 0.5_dp, 3.0_dp, 8.0_dp, 0.0_dp]), &
         & [4.6053530095819548e-308_dp, 2.7536241186062337e-89_dp, 2.8665157187919391e-7_dp, &
         & 0.15865525393145705_dp, 0.6914624612740131_dp, 0.99865010196836991_dp, 0.99999999999999938_dp, 0.5_dp], &
         & deep_tolerance)
   end subroutine test_normal_cdf

   subroutine test_normal_quantile()
      call agree(normal_quantile([1.0e-300_dp, 1.0e-20_dp, 0.001_dp, 0.1585_dp, 0.25_dp, 0.5000001_dp, 0.75_dp, &
         & 0.999_dp, 1.0_dp - 2.0_dp**(-40)]), &
         & [-37.047096299361199_dp, -9.2623400897984076_dp, -3.0902323061678135_dp, -1.0006418287624493_dp, &
         & -0.67448975019608174_dp, 2.5066282733116483e-7_dp, 0.67448975019608174_dp, 3.0902323061678133_dp, &
         & 7.0477002566644087_dp], 1.0e-14_dp)
   end subroutine test_normal_quantile

   !> cdf(quantile(p)) = p over the whole range; the center is exactly 0.
   subroutine test_normal_round_trip()
      real(dp) :: p(200)
      integer :: i

      p = [(10.0_dp**(-0.005_dp - 1.5_dp*real(i, dp)), i = 0, 199)]
      call agree(normal_cdf(normal_quantile(p)), p, deep_tolerance)
      call check(error, abs(normal_quantile(0.5_dp)) <= 0.0_dp, "the median is 0")
   end subroutine test_normal_round_trip

   subroutine test_chi_square_small()
      real(dp), parameter :: x(9) = [0.25_dp, 0.001_dp, 3.5_dp, 1.0_dp, 0.02_dp, 60.0_dp, 39.5_dp, 10.0_dp, 130.0_dp]
      real(dp), parameter :: dof(9) = [0.5_dp, 0.5_dp, 1.0_dp, 3.0_dp, 3.3_dp, 12.0_dp, 41.0_dp, 41.0_dp, 41.0_dp]

      call agree(chi_square_cdf(x, dof), [0.64015720608308411_dp, 0.16495975076841284_dp, &
         & 0.93863117086059783_dp, 0.1987480430987992_dp, 0.00033536248647043492_dp, 0.99999997742651254_dp, &
         & 0.4626418101319085_dp, 1.6828453408631519e-7_dp, 0.99999999996525969_dp], tolerance)
      call agree(chi_square_survival(x, dof), [0.35984279391691589_dp, 0.83504024923158716_dp, &
         & 0.061368829139402173_dp, 0.8012519569012008_dp, 0.99966463751352957_dp, 2.2573487463962842e-8_dp, &
         & 0.5373581898680915_dp, 0.99999983171546591_dp, 3.4740307146208071e-11_dp], tolerance)
   end subroutine test_chi_square_small

   subroutine test_chi_square_large()
      call agree(chi_square_cdf([1000.0_dp, 700.0_dp, 99500.0_dp], [1000.0_dp, 1000.0_dp, 1.0e5_dp]), &
         & [0.50594714617076036_dp, 2.8903599395611956e-14_dp, 0.13169564297235348_dp], tolerance)
      call agree(chi_square_survival([1000.0_dp, 1500.0_dp, 99500.0_dp, 10042094.5_dp], &
         & [1000.0_dp, 1000.0_dp, 1.0e5_dp, 1.0e7_dp]), &
         & [0.49405285382923964_dp, 1.0454640385979657e-22_dp, 0.86830435702764652_dp, 2.7387946678993527e-21_dp], tolerance)
      call agree(chi_square_cdf([86739.5_dp], [1.0e5_dp]), [2.8519681411424337e-212_dp], deep_tolerance)
      call agree(chi_square_survival([106308.5_dp, 1400.0_dp], [1.0e5_dp, 2.0_dp]), &
         & [9.4483403242464563e-44_dp, 9.8596765437597709e-305_dp], deep_tolerance)
   end subroutine test_chi_square_large

   !> Two degrees of freedom: exp(-x/2) exactly.
   subroutine test_chi_square_two()
      real(dp) :: x(60)
      integer :: i

      x = [(0.05_dp*1.2_dp**i, i = 0, 59)]
      x = min(x, 1380.0_dp)
      call agree(chi_square_survival(x, 2.0_dp), exp(-0.5_dp*x), tolerance)
   end subroutine test_chi_square_two

   !> Where one method hands over to another the function is continuous: neighbors by the
   !> recurrence Q(a+1, x) = Q(a, x) + x^a exp(-x)/Gamma(a+1), across a = 10 and a = 20.
   subroutine test_chi_square_seams()
      real(dp) :: a, x, term
      integer :: i, j

      do j = 0, 14
         a = 9.25_dp + 0.75_dp*real(j, dp)
         do i = 1, 30
            x = a*(0.1_dp + 0.1_dp*real(i, dp))
            term = exp(a*log(x) - x - log_gamma(a + 1.0_dp))
            call agree([chi_square_survival(2.0_dp*x, 2.0_dp*a + 2.0_dp)], &
               & [chi_square_survival(2.0_dp*x, 2.0_dp*a) + term], tolerance)
         end do
      end do
   end subroutine test_chi_square_seams

   subroutine test_chi_square_quantile()
      call agree(chi_square_quantile([0.02_dp, 0.9_dp, 0.1585_dp, 0.95_dp, 1.0e-10_dp, 0.975_dp], &
         & [0.1_dp, 0.1_dp, 1.0_dp, 2.0_dp, 3.3_dp, 10.0_dp]), &
         & [1.2257081808202556e-34_dp, 0.15263422781837701_dp, 0.039990068795612911_dp, 5.9914645471079802_dp, &
         & 2.2107259849912338e-6_dp, 20.483177350807394_dp], tolerance)
      call agree(chi_square_quantile([0.1585_dp, 0.8415_dp, 1.0e-30_dp, 0.999_dp, 0.1585_dp, 0.8415_dp], &
         & [24.7_dp, 998.5_dp, 998.5_dp, 1.0e5_dp, 1.0e7_dp, 1.0e7_dp]), &
         & [17.764122633332471_dp, 1043.2024480472505_dp, 569.33100952547352_dp, 101387.69553252945_dp, &
         & 9995524.9947046991_dp, 10004475.007007399_dp], tolerance)
   end subroutine test_chi_square_quantile

   !> cdf(quantile(p)) = p, from 0.1 to 1e7 degrees of freedom, as far as the rounding of x allows:
   !> d ln F = z sqrt(dof/2) d ln x in the tails, z = 7.
   subroutine test_quantile_round_trip()
      real(dp), parameter :: p(9) = [1.0e-12_dp, 1.0e-3_dp, 0.1_dp, 0.3_dp, 0.5_dp, 0.7_dp, 0.9_dp, 0.999_dp, 1.0_dp - 1.0e-12_dp]
      real(dp) :: dof, x(9)
      integer :: i

      do i = 0, 40
         dof = 10.0_dp**(-1.0_dp + 0.2_dp*real(i, dp))
         x = chi_square_quantile(p, dof)
         call agree(chi_square_cdf(x, dof), p, tolerance + 2.0e-15_dp*sqrt(dof))
         call agree(chi_square_survival(x, dof), 1.0_dp - p, tolerance + 2.0e-15_dp*sqrt(dof))
      end do
   end subroutine test_quantile_round_trip

   subroutine test_digamma()
      call agree(digamma([0.001_dp, 0.5_dp, 1.0_dp, 2.5_dp, 10.0_dp, 123.25_dp, 5.0e6_dp, -10.2_dp]), &
         & [-1000.5755719318103_dp, -1.9635100260214235_dp, -0.57721566490153286_dp, 0.70315664064524319_dp, &
         & 2.2517525890667211_dp, 4.8101525319648189_dp, 15.424948370398371_dp, 6.6946384504175168_dp], 1.0e-14_dp)
      call agree([digamma(-0.5_dp)], [0.036489973978576521_dp], tolerance)
   end subroutine test_digamma

   !> What happens at and beyond the edges of the domain.
   subroutine test_edges()
      real(dp) :: nan, inf

      nan = ieee_value(nan, ieee_quiet_nan)
      inf = ieee_value(inf, ieee_positive_inf)
      call check(error, ieee_is_nan(normal_quantile(nan)) .and. ieee_is_nan(normal_quantile(1.5_dp)) &
         & .and. ieee_is_nan(chi_square_quantile(0.5_dp, 0.0_dp)) .and. ieee_is_nan(chi_square_quantile(-0.1_dp, 1.0_dp)) &
         & .and. ieee_is_nan(chi_square_cdf(1.0_dp, -1.0_dp)) .and. ieee_is_nan(chi_square_cdf(nan, 1.0_dp)) &
         & .and. ieee_is_nan(chi_square_quantile(0.5_dp, nan)) .and. ieee_is_nan(digamma(-3.0_dp)) &
         & .and. ieee_is_nan(digamma(0.0_dp)), "outside of the domain is NaN")
      call check(error, .not. (ieee_is_finite(normal_quantile(0.0_dp)) .or. ieee_is_finite(normal_quantile(1.0_dp)) &
         & .or. ieee_is_finite(chi_square_quantile(1.0_dp, 3.0_dp))), "the ends are infinite")
      call check(error, chi_square_cdf(-1.0_dp, 3.0_dp), 0.0_dp, thr=tiny(inf))
      call check(error, chi_square_survival(inf, 3.0_dp), 0.0_dp, thr=tiny(inf))
      call check(error, chi_square_survival(1.0e300_dp, 3.0e4_dp), 0.0_dp, thr=tiny(inf))
      call check(error, chi_square_cdf(1.0e-300_dp, 3.0e4_dp), 0.0_dp, thr=tiny(inf))
   end subroutine test_edges

end module test_special
