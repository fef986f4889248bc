! SPDX-License-Identifier: MIT
!> Normality of a series from its moments: the Jarque-Bera test and the sizes of the effect.
!>
!> A long record of any sensor fails every test: the tests tell what is more than chance, skewness
!> and excess kurtosis tell how much it is. [[judge_normality]] puts both together.
module gyroakf_stats_normality
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_stats_moments, only : moments_type
   implicit none (type, external)
   private
   public :: jarque_bera_type, test_jarque_bera
   public :: skewness_error, kurtosis_error, judge_normality

   !> Below both a departure is small: the share beyond 3 sigma differs by half at most
   real(dp), parameter :: negligible_skewness = 0.1_dp, negligible_kurtosis = 0.2_dp

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
      !> Standard errors of skewness and kurtosis for as many independent normal samples
      real(dp) :: skewness_error = 0.0_dp, kurtosis_error = 0.0_dp
   end type jarque_bera_type

contains

   !> Jarque-Bera test from the moments of a series.
   !>
   !> $$JB = \frac{n}{6}\Big(S^2 + \frac{(K-3)^2}{4}\Big), \quad p = e^{-JB/2}$$ p is exact for
   !> chi-square with 2 degrees of freedom; JB has that distribution for large n. With 1e6 samples
   !> every real sensor fails: look at skewness and kurtosis. The samples are taken as
   !> independent. Source: Jarque & Bera, Int. Stat. Rev. 55 (1987) 163-172.
   subroutine test_jarque_bera(moments, result, error)
      !> Moments of at least two samples, with variance
      type(moments_type), intent(in) :: moments
      !> The test
      type(jarque_bera_type), intent(out) :: result
      !> too_few_samples (fewer than 2), constant_input, non_finite
      type(error_type), allocatable, intent(out) :: error

      if (moments%count < 2) then
         call fatal_error(error, status%too_few_samples, &
            & "the Jarque-Bera test needs at least 2 samples")
      else if (.not. all(ieee_is_finite( &
         & [moments%variance, moments%skewness, moments%kurtosis]))) then
         call fatal_error(error, status%non_finite, "the moments of the series are not finite")
      else if (moments%kurtosis <= 0.0_dp) then
         call fatal_error(error, status%constant_input, &
            & "the series has no variance, normality cannot be tested")
      end if
      if (allocated(error)) return
      result%skewness = moments%skewness
      result%kurtosis = moments%kurtosis
      result%skewness_error = skewness_error(moments%count)
      result%kurtosis_error = kurtosis_error(moments%count)
      result%statistic = real(moments%count, dp)/6.0_dp &
         & *(moments%skewness**2 + 0.25_dp*(moments%kurtosis - 3.0_dp)**2)
      result%p_value = exp(-0.5_dp*result%statistic)
   end subroutine test_jarque_bera

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
      kurtosis_error = sqrt(24.0_dp*(m/(m + 1.0_dp))*((m - 2.0_dp)/(m + 1.0_dp))*((m - 3.0_dp)/(m &
         & + 3.0_dp))/(m + 5.0_dp))
   end function kurtosis_error

   !> The verdict in a word, from the sizes of the effect with a p-value beside them.
   !>
   !> | word | significant at 5 % | skewness and excess kurtosis |
   !> |---|---|---|
   !> | `normal` | no | both within the limits |
   !> | `nearly` | yes | both within the limits 0.1 and 0.2: the record is long |
   !> | `undecided` | no | beyond: the record is too short to tell |
   !> | `not` | yes | beyond |
   pure function judge_normality(skewness, kurtosis, p_value) result(verdict)
      !> Skewness, and kurtosis (3 for a normal distribution)
      real(dp), intent(in) :: skewness, kurtosis
      !> p-value of a test of normality
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

end module gyroakf_stats_normality
