! SPDX-License-Identifier: MIT
!> What every autocovariance is made of: sums of lagged products of one block; stretches of a series
!> less its trend, and the residuals that an AR model leaves of them. A stretch may begin before the
!> series and end behind it; what is not there is 0.
module gyroakf_stats_lagged_products
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_stats_trend, only : trend_type, subtract_trend
   implicit none (type, external)
   private
   public :: add_lagged_products, detrended_block, residual_block, add_pair_sums, &
      covariances_of_pairs

contains

   !> Adds $$\sum_{t=1}^{n} a_t b_{t-k}$$ to s_k for k = 0 .. lags; eight lags share the loads of a.
   pure subroutine add_lagged_products(a, b, n, lags, s)
      !> Length and largest lag
      integer, intent(in) :: n, lags
      !> First factor: [n]
      real(dp), intent(in) :: a(n)
      !> Second factor with its past: [1-lags:n]
      real(dp), intent(in) :: b(1 - lags:n)
      !> The sums: [0:lags]
      real(dp), intent(inout) :: s(0:lags)
      real(dp) :: s0, s1, s2, s3, s4, s5, s6, s7
      integer :: k, t

      do k = 0, lags - 7, 8
         s0 = 0.0_dp; s1 = 0.0_dp; s2 = 0.0_dp; s3 = 0.0_dp
         s4 = 0.0_dp; s5 = 0.0_dp; s6 = 0.0_dp; s7 = 0.0_dp
         !$omp simd reduction(+:s0, s1, s2, s3, s4, s5, s6, s7)
         do t = 1, n
            s0 = s0 + a(t)*b(t - k)
            s1 = s1 + a(t)*b(t - k - 1)
            s2 = s2 + a(t)*b(t - k - 2)
            s3 = s3 + a(t)*b(t - k - 3)
            s4 = s4 + a(t)*b(t - k - 4)
            s5 = s5 + a(t)*b(t - k - 5)
            s6 = s6 + a(t)*b(t - k - 6)
            s7 = s7 + a(t)*b(t - k - 7)
         end do
         s(k:k + 7) = s(k:k + 7) + [s0, s1, s2, s3, s4, s5, s6, s7]
      end do
      do k = 8*((lags + 1)/8), lags
         s0 = 0.0_dp
         !$omp simd reduction(+:s0)
         do t = 1, n
            s0 = s0 + a(t)*b(t - k)
         end do
         s(k) = s(k) + s0
      end do
   end subroutine add_lagged_products

   !> Adds the sums over the pairs (t, t - k) of which both samples are present.
   pure subroutine add_pair_sums(e, flag, m, max_lag, s)
      !> Samples of a block, and largest lag
      integer, intent(in) :: m, max_lag
      !> Samples with their past, 0 where missing; 1 where there is one, else 0: [1-max_lag:m]
      real(dp), intent(in), contiguous :: e(1 - max_lag:), flag(1 - max_lag:)
      !> Products, number, later members, earlier members: [0:max_lag, 4]
      real(dp), intent(inout) :: s(0:max_lag, 4)
      real(dp) :: earlier
      integer :: k

      call add_lagged_products(e(1:), e, m, max_lag, s(:, 1))
      if (sum(flag) > real(m + max_lag, dp) - 0.5_dp) then
         earlier = sum(e(1:m))
         s(:, 2) = s(:, 2) + real(m, dp)
         s(:, 3) = s(:, 3) + earlier
         do k = 0, max_lag
            if (k > 0) earlier = earlier + (e(1 - k) - e(m - k + 1))
            s(k, 4) = s(k, 4) + earlier
         end do
      else
         call add_lagged_products(flag(1:), flag, m, max_lag, s(:, 2))
         call add_lagged_products(e(1:), flag, m, max_lag, s(:, 3))
         call add_lagged_products(flag(1:), e, m, max_lag, s(:, 4))
      end if
   end subroutine add_pair_sums

   !> Biased autocovariances about a mean, with gaps the means over the pairs times (n - k)/n.
   pure subroutine covariances_of_pairs(s, mean, n, r, pairs)
      !> Of `add_pair_sums`: [0:max_lag, 4]; the mean
      real(dp), intent(in) :: s(0:, :), mean
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Autocovariances, 0 at a lag without pairs; pairs: [0:max_lag]
      real(dp), intent(out) :: r(0:)
      integer(int64), intent(out) :: pairs(0:)
      integer :: k

      pairs = nint(s(:, 2), int64)
      r = 0.0_dp
      do k = 0, ubound(r, 1)
         if (pairs(k) < 1) cycle
         r(k) = s(k, 1) - mean*(s(k, 3) + s(k, 4)) + s(k, 2)*mean**2
         r(k) = r(k)*(real(n - k, dp)/s(k, 2))/real(n, dp)
      end do
   end subroutine covariances_of_pairs

   !> Samples of a stretch less the trend; 0 where one is missing.
   pure subroutine detrended_block(x, trend, first, y, flag, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Place of the first sample, 1-based
      integer(int64), intent(in) :: first
      !> Samples, 1 where there is one and 0 elsewhere: [m]
      real(dp), intent(out), contiguous :: y(:), flag(:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: from, to, i

      from = min(max(first, 1_int64), first + size(y))
      to = max(min(first + size(y) - 1, size(x, kind=int64)), from - 1)
      y(:from - first) = 0.0_dp
      flag(:from - first) = 0.0_dp
      do i = from, to
         y(i - first + 1) = x(i)
         flag(i - first + 1) = 1.0_dp
      end do
      y(to - first + 2:) = 0.0_dp
      flag(to - first + 2:) = 0.0_dp
      call subtract_trend(trend, from - 1, y(from - first + 1:to - first + 1))
      if (.not. present(valid)) return
      do i = from, to
         flag(i - first + 1) = merge(1.0_dp, 0.0_dp, valid(i) /= 0_int8)
         y(i - first + 1) = merge(y(i - first + 1), 0.0_dp, valid(i) /= 0_int8)
      end do
   end subroutine detrended_block

   !> Residuals of a stretch; 0 where there is none.
   !>
   !> $$e_t = y_t - c - \sum_j \phi_j y_{t-j}$$ for the t whose p predecessors exist and are
   !> present, y the series less its trend.
   subroutine residual_block(x, trend, phi, constant, first, e, flag, stat, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Coefficients phi: [p]; constant c
      real(dp), intent(in) :: phi(:), constant
      !> Place of the first one, 1-based
      integer(int64), intent(in) :: first
      !> Residuals, 1 where there is one and 0 elsewhere: [m]
      real(dp), intent(out), contiguous :: e(:), flag(:)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: y(:), here(:)
      integer :: i, j, m, p, run

      m = size(e)
      p = size(phi)
      allocate (y(1 - p:m), stat=stat)
      if (stat == 0) allocate (here(1 - p:m), stat=stat)
      if (stat /= 0) return
      call detrended_block(x, trend, first - p, y, here, valid)
      e(:) = y(1:m) - constant
      do j = 1, p
         do i = 1, m
            e(i) = e(i) - phi(j)*y(i - j)
         end do
      end do
      flag = 1.0_dp
      if (.not. present(valid) .and. first > p) return
      run = 0
      do i = 1 - p, m
         run = run + 1
         if (here(i) < 0.5_dp) run = 0
         if (i < 1) cycle
         flag(i) = merge(1.0_dp, 0.0_dp, run > p)
         e(i) = e(i)*flag(i)
      end do
   end subroutine residual_block

end module gyroakf_stats_lagged_products
