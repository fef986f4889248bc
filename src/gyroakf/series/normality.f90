! SPDX-License-Identifier: MIT
!> Normality of a series from its moments: Jarque-Bera, D'Agostino's K2, and the sizes of the effect.
!>
!> A long record of any sensor fails every test: the tests tell what is more than chance, skewness and excess kurtosis
!> tell how much it is. [[judge_normality]] puts both together.
module gyroakf_series_normality
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : log1p, expm1
   use gyroakf_series_moments, only : moments_type
   implicit none (type, external)
   private
   public :: jarque_bera_type, test_jarque_bera, dagostino_type, test_dagostino
   public :: skewness_error, kurtosis_error, judge_normality
   public :: negligible_skewness, negligible_kurtosis, least_dagostino, good_dagostino

   !> Below both, a departure from the normal distribution is small: the share beyond 3 sigma differs by half at most
   real(dp), parameter :: negligible_skewness = 0.1_dp, negligible_kurtosis = 0.2_dp
   !> Fewer samples than the first are refused, below the second K2 is rough
   integer(int64), parameter :: least_dagostino = 8, good_dagostino = 20

   !> Result of the Jarque-Bera test
   type :: jarque_bera_type
      !> JB
      real(dp) :: statistic = 0.0_dp
      !> Probability of a larger JB under the null hypothesis, normality; asymptotic
      real(dp) :: p_value = 1.0_dp
      !> Skewness, 0 for a normal distribution: the size of the effect, which n does not inflate
      real(dp) :: skewness = 0.0_dp
      !> Kurtosis, 3 for a normal distribution
      real(dp) :: kurtosis = 0.0_dp
   end type jarque_bera_type

   !> Result of D'Agostino's test
   type :: dagostino_type
      !> K2 = z_skewness^2 + z_kurtosis^2
      real(dp) :: statistic = 0.0_dp
      !> Probability of a larger K2 under the null hypothesis, normality
      real(dp) :: p_value = 1.0_dp
      !> Skewness and kurtosis as standard normal deviates
      real(dp) :: z_skewness = 0.0_dp, z_kurtosis = 0.0_dp
      !> Standard deviations of skewness and kurtosis of so many independent normal samples
      real(dp) :: skewness_error = 0.0_dp, kurtosis_error = 0.0_dp
      !> Samples
      integer(int64) :: samples = 0
   end type dagostino_type

contains

   !> Jarque-Bera test from the moments of a series.
   !>
   !> $$JB = \frac{n}{6}\Big(S^2 + \frac{(K-3)^2}{4}\Big), \quad p = e^{-JB/2}$$
   !> p is exact for chi-square with 2 degrees of freedom; JB has that distribution for large n. With 1e6
   !> samples every real sensor fails: look at skewness and kurtosis. The samples are taken as
   !> independent. Source: Jarque & Bera, Int. Stat. Rev. 55 (1987) 163-172.
   subroutine test_jarque_bera(moments, result, error)
      !> Moments of at least two samples, with variance
      type(moments_type), intent(in) :: moments
      !> The test
      type(jarque_bera_type), intent(out) :: result
      !> too_few_samples (fewer than 2), constant_input, non_finite
      type(error_type), allocatable, intent(out) :: error

      call check_moments(moments, 2_int64, "the Jarque-Bera test needs at least 2 samples", error)
      if (allocated(error)) return
      result%skewness = moments%skewness
      result%kurtosis = moments%kurtosis
      result%statistic = real(moments%count, dp)/6.0_dp*(moments%skewness**2 + 0.25_dp*(moments%kurtosis - 3.0_dp)**2)
      result%p_value = exp(-0.5_dp*result%statistic)
   end subroutine test_jarque_bera

   !> Refuses moments that cannot be tested.
   subroutine check_moments(moments, least, few, error)
      type(moments_type), intent(in) :: moments
      !> Samples that are needed
      integer(int64), intent(in) :: least
      !> What is said where there are fewer
      character(*), intent(in) :: few
      !> too_few_samples, constant_input, non_finite
      type(error_type), allocatable, intent(out) :: error

      if (moments%count < least) then
         call fatal_error(error, status%too_few_samples, few)
      else if (.not. (ieee_is_finite(moments%variance) .and. ieee_is_finite(moments%skewness) .and. &
                      ieee_is_finite(moments%kurtosis))) then
         call fatal_error(error, status%non_finite, "the moments of the series are not finite")
      else if (moments%kurtosis <= 0.0_dp) then
         call fatal_error(error, status%constant_input, "the series has no variance, normality cannot be tested")
      end if
   end subroutine check_moments

   !> D'Agostino's omnibus test K2 from the moments of a series.
   !>
   !> $$K^2 = Z_1(S)^2 + Z_2(K)^2, \quad p = e^{-K^2/2}$$
   !> Z1 and Z2 bring skewness and kurtosis to standard normal deviates, so that p is good from 20 samples on, where
   !> Jarque-Bera needs thousands; from 8 to 19 samples Z2 is rough. The samples are taken as independent. All differences
   !> that vanish for large n are formed without cancellation.
   !> Source: D'Agostino, Belanger & D'Agostino, Amer. Statistician 44 (1990) 316-321; Z1: D'Agostino, Biometrika 57
   !> (1970) 679-681; Z2: Anscombe & Glynn, Biometrika 70 (1983) 227-234.
   subroutine test_dagostino(moments, result, error)
      !> Moments of at least 8 samples, with variance
      type(moments_type), intent(in) :: moments
      !> The test
      type(dagostino_type), intent(out) :: result
      !> too_few_samples (fewer than 8), constant_input, non_finite
      type(error_type), allocatable, intent(out) :: error
      character(24) :: digits

      write (digits, "(i0)") moments%count
      call check_moments(moments, least_dagostino, "D'Agostino's test needs at least 8 samples, there are "//trim(digits), error)
      if (allocated(error)) return
      result%samples = moments%count
      result%z_skewness = skewness_deviate(moments%skewness, real(moments%count, dp))
      result%z_kurtosis = kurtosis_deviate(moments%kurtosis, real(moments%count, dp))
      result%statistic = result%z_skewness**2 + result%z_kurtosis**2
      result%p_value = exp(-0.5_dp*result%statistic)
      result%skewness_error = skewness_error(moments%count)
      result%kurtosis_error = kurtosis_error(moments%count)
   end subroutine test_dagostino

   !> Z1: with B the kurtosis of the skewness of n normal samples and w = sqrt(2 (B - 1)) - 2.
   pure real(dp) function skewness_deviate(skewness, n) result(z)
      !> Skewness
      real(dp), intent(in) :: skewness
      !> Samples, >= 8
      real(dp), intent(in) :: n
      real(dp) :: excess, w, y

      excess = 36.0_dp*(((n - 5.0_dp)*n - 19.0_dp)*n + 35.0_dp)/((n - 2.0_dp)*(n + 5.0_dp)*(n + 7.0_dp)*(n + 9.0_dp))
      w = 2.0_dp*excess/(sqrt(4.0_dp + 2.0_dp*excess) + 2.0_dp)
      y = skewness*sqrt((n + 1.0_dp)/(n - 2.0_dp)*(n + 3.0_dp)/6.0_dp)
      z = asinh(y*sqrt(0.5_dp*w))/sqrt(0.5_dp*log1p(w))
   end function skewness_deviate

   !> Z2: the cube root of Wilson and Hilferty, with A degrees of freedom.
   pure real(dp) function kurtosis_deviate(kurtosis, n) result(z)
      !> Kurtosis
      real(dp), intent(in) :: kurtosis
      !> Samples, >= 8
      real(dp), intent(in) :: n
      real(dp), parameter :: least = 1.0e-30_dp
      real(dp) :: x, q, a, d, spread, root

      x = ((kurtosis - 3.0_dp) + 6.0_dp/(n + 1.0_dp))/sqrt(24.0_dp*n/(n + 1.0_dp)*((n - 2.0_dp)/(n + 1.0_dp))*((n - 3.0_dp) &
         & /((n + 3.0_dp)*(n + 5.0_dp))))
      q = 6.0_dp*((n - 5.0_dp)*n + 2.0_dp)/((n + 7.0_dp)*(n + 9.0_dp))*sqrt(6.0_dp*((n + 3.0_dp)/(n - 2.0_dp)) &
         & *((n + 5.0_dp)/(n - 3.0_dp))/n)
      a = 6.0_dp + 8.0_dp/q*(2.0_dp/q + sqrt(1.0_dp + 4.0_dp/(q*q)))
      spread = sqrt(2.0_dp/(9.0_dp*a))
      d = x*sqrt(2.0_dp/(a - 4.0_dp))
      if (d > -0.5_dp) then
         z = (-expm1((log1p(-2.0_dp/a) - log1p(d))/3.0_dp) - 2.0_dp/(9.0_dp*a))/spread
      else
         d = sign(max(abs(1.0_dp + d), least), 1.0_dp + d)
         root = sign(((1.0_dp - 2.0_dp/a)/abs(d))**(1.0_dp/3.0_dp), d)
         z = -abs(1.0_dp - 2.0_dp/(9.0_dp*a) - root)/spread
      end if
   end function kurtosis_deviate

   !> Standard deviation of the skewness of n independent normal samples.
   !>
   !> $$\sqrt{\frac{6(n-2)}{(n+1)(n+3)}}$$ Source: Fisher, Proc. R. Soc. A 130 (1930) 16-28.
   elemental real(dp) function skewness_error(n)
      !> Samples; 0 below 3
      integer(int64), intent(in) :: n
      real(dp) :: m

      m = real(max(n, 2_int64), dp)
      skewness_error = sqrt(6.0_dp*(m - 2.0_dp)/(m + 1.0_dp)/(m + 3.0_dp))
   end function skewness_error

   !> Standard deviation of the kurtosis of n independent normal samples.
   !>
   !> $$\sqrt{\frac{24n(n-2)(n-3)}{(n+1)^2(n+3)(n+5)}}$$ Source: as [[skewness_error]].
   elemental real(dp) function kurtosis_error(n)
      !> Samples; 0 below 4
      integer(int64), intent(in) :: n
      real(dp) :: m

      m = real(max(n, 3_int64), dp)
      kurtosis_error = sqrt(24.0_dp*(m/(m + 1.0_dp))*((m - 2.0_dp)/(m + 1.0_dp))*((m - 3.0_dp)/(m + 3.0_dp))/(m + 5.0_dp))
   end function kurtosis_error

   !> The verdict in a word, from the sizes of the effect with a p-value beside them.
   !>
   !> | word | significant at 5 % | skewness and excess kurtosis |
   !> |---|---|---|
   !> | `normal` | no | both within the limits |
   !> | `nearly` | yes | both within the limits 0.1 and 0.2: a small departure, seen because the record is long |
   !> | `undecided` | no | beyond: the record is too short to tell |
   !> | `not` | yes | beyond |
   pure function judge_normality(skewness, kurtosis, p_value) result(verdict)
      !> Skewness, and kurtosis (3 for a normal distribution)
      real(dp), intent(in) :: skewness, kurtosis
      !> Of the test that is believed most, usually the smallest
      real(dp), intent(in) :: p_value
      character(9) :: verdict
      real(dp), parameter :: level = 0.05_dp
      logical :: small

      small = abs(skewness) < negligible_skewness .and. abs(kurtosis - 3.0_dp) < negligible_kurtosis
      if (p_value < level) then
         verdict = merge("nearly", "not   ", small)
      else
         verdict = merge("normal   ", "undecided", small)
      end if
   end function judge_normality

end module gyroakf_series_normality
