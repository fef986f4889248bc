! SPDX-License-Identifier: MIT
!> Whiteness of a series: the Ljung-Box test.
module gyroakf_stats_whiteness
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_progress, only : progress_type
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_special, only : chi_square_survival
   use gyroakf_stats_autocovariance, only : compute_autocovariance
   implicit none (type, external)
   private
   public :: ljung_box_type, test_ljung_box, ljung_box_of

   !> Result of the Ljung-Box test
   type :: ljung_box_type
      !> Q
      real(dp) :: statistic = 0.0_dp
      !> Probability of a larger Q under the null hypothesis, whiteness
      real(dp) :: p_value = 1.0_dp
      !> Lags used; 0: the test was not made
      integer :: lags = 0
      !> Parameters fitted before, subtracted from the degrees of freedom
      integer :: fitted = 0
      !> Largest |rho_k|, k = 1 .. lags: the size of the effect, which n does not inflate
      real(dp) :: largest_rho = 0.0_dp
      !> The lag that has it, the first of equals
      integer :: largest_lag = 0
   end type ljung_box_type

contains

   !> Ljung-Box test of a series.
   !>
   !> $$Q = n(n+2) \sum_{k=1}^{h} \frac{\hat\rho_k^2}{n-k} \sim \chi^2(h - \text{fitted})$$ with the
   !> biased autocovariances. With missing samples rho_k is the mean over the m_k present pairs, of
   !> variance 1/m_k, and $$Q = \frac{n+2}{n} \sum_k m_k \hat\rho_k^2,$$ n the present samples; both
   !> agree without gaps. Source: Ljung & Box, Biometrika 65 (1978) 297-303; Stoffer & Toloi, Stat.
   !> Prob. Lett. 13 (1992) 391-396.
   subroutine test_ljung_box(x, lags, fitted, result, error, valid, progress)
      !> Series: [n], n > lags; finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Number of lags h, > fitted
      integer, intent(in) :: lags
      !> Parameters of the model whose residuals these are, >= 0
      integer, intent(in) :: fitted
      !> The test
      type(ljung_box_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean

      call check_lags(lags, fitted, error)
      if (.not. allocated(error)) call compute_autocovariance(x, lags, mean, r, error, valid, &
         & pairs, progress)
      if (.not. allocated(error)) call ljung_box_of(r, size(x, kind=int64), fitted, result, error, &
         & pairs)
   end subroutine test_ljung_box

   !> Ljung-Box test from autocovariances, for whoever accumulates them on the way.
   subroutine ljung_box_of(r, n, fitted, result, error, pairs)
      !> Biased autocovariances: [0:h], h > fitted
      real(dp), intent(in) :: r(0:)
      !> Length of the series that they come from, > h
      integer(int64), intent(in) :: n
      !> Parameters fitted before, >= 0
      integer, intent(in) :: fitted
      !> The test
      type(ljung_box_type), intent(out) :: result
      !> invalid_argument, too_few_samples, constant_input
      type(error_type), allocatable, intent(out) :: error
      !> Present pairs at each lag: [0:h]
      integer(int64), intent(in) :: pairs(0:)
      real(dp) :: rho, used
      integer :: k, h
      character(120) :: text

      h = ubound(r, 1)
      call check_lags(h, fitted, error)
      if (allocated(error)) return
      used = real(pairs(0), dp)
      if (n <= int(h, int64) .or. used < 2.0_dp) then
         write (text, "(3(a, i0))") "the Ljung-Box test with ", h, " lags needs more than ", h, &
            & " samples, there are ", n
         call fatal_error(error, status%too_few_samples, trim(text))
         return
      else if (.not. r(0) > 0.0_dp) then
         call fatal_error(error, status%constant_input, &
            & "the series has no variance, whiteness cannot be tested")
         return
      end if
      do k = 1, h
         rho = r(k)/r(0)*(real(n, dp)/real(n - k, dp))
         result%statistic = result%statistic + real(pairs(k), dp)*rho*rho*((used + 2.0_dp)/used)
         if (abs(r(k)/r(0)) <= result%largest_rho) cycle
         result%largest_rho = abs(r(k)/r(0))
         result%largest_lag = k
      end do
      result%lags = h
      result%fitted = fitted
      result%p_value = chi_square_survival(result%statistic, real(h - fitted, dp))
   end subroutine ljung_box_of

   !> Refuses a number of lags that leaves no degree of freedom.
   subroutine check_lags(lags, fitted, error)
      integer, intent(in) :: lags, fitted
      type(error_type), allocatable, intent(out) :: error
      character(160) :: text

      if (fitted >= 0 .and. lags > fitted) return
      write (text, "(2(a, i0), a)") "the Ljung-Box test needs more lags than fitted parameters: ", &
         & lags, " lags, ", fitted, " parameters"
      call fatal_error(error, status%invalid_argument, trim(text))
   end subroutine check_lags

end module gyroakf_stats_whiteness
