! SPDX-License-Identifier: MIT
!> Normality of a series: the Jarque-Bera test.
module gyroakf_series_normality
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_series_moments, only : moments_type
   implicit none (type, external)
   private
   public :: jarque_bera_type, test_jarque_bera

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

      if (moments%count < 2) then
         call fatal_error(error, status%too_few_samples, "the Jarque-Bera test needs at least 2 samples")
      else if (.not. (ieee_is_finite(moments%skewness) .and. ieee_is_finite(moments%kurtosis))) then
         call fatal_error(error, status%non_finite, "the moments of the series are not finite")
      else if (moments%kurtosis <= 0.0_dp) then
         call fatal_error(error, status%constant_input, "the series has no variance, normality cannot be tested")
      else
         result%skewness = moments%skewness
         result%kurtosis = moments%kurtosis
         result%statistic = real(moments%count, dp)/6.0_dp*(moments%skewness**2 + 0.25_dp*(moments%kurtosis - 3.0_dp)**2)
         result%p_value = exp(-0.5_dp*result%statistic)
      end if
   end subroutine test_jarque_bera

end module gyroakf_series_normality
