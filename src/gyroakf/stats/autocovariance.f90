! SPDX-License-Identifier: MIT
!> Autocovariances of a series: the one implementation for AR models, the Ljung-Box test,
!> correlograms and the identification of a drift.
!>
!> Every lag comes from a single pass over the series. Whoever passes over it for another purpose
!> makes them on the way:
!>
!>     call plan_autocovariance(shared, max_lag, moments%mean, moments%remainder)
!>     call test_adf(x, options, result, error, valid, shared)   ! a pass that fills it
!>     call need_autocovariance(x, shared, error, valid)         ! a pass of its own where none did
!>     call ljung_box_of(shared%r(0:20), n, 0, test, error, shared%pairs(0:20))
module gyroakf_stats_autocovariance
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_lagged_products, only : add_lagged_products, detrended_block
   use gyroakf_stats_moments, only : first_present
   use gyroakf_stats_trend, only : trend_type, set_level
   implicit none (type, external)
   private
   public :: autocovariance_type, compute_autocovariance, plan_autocovariance, &
      & need_autocovariance, find_level
   public :: check_series, add_lag_block, close_autocovariance

   !> Autocovariances that several need
   type :: autocovariance_type
      !> Largest lag, -1: nothing is asked for
      integer :: max_lag = -1
      !> Mean of the present samples and what it lost when it was rounded
      real(dp) :: mean = 0.0_dp, remainder = 0.0_dp
      !> Length of the series
      integer(int64) :: samples = 0
      !> Biased autocovariances, [0:max_lag]; not allocated until a pass has filled them
      real(dp), allocatable :: r(:)
      !> Present pairs at each lag: [0:max_lag]
      integer(int64), allocatable :: pairs(:)
   end type autocovariance_type

   !> Sum and number of the present samples about a level
   type, extends(chunk_sums_type) :: level_sums_type
      type(trend_type) :: level
   contains
      procedure :: add => add_level
   end type level_sums_type

   !> Lagged products about the same
   type, extends(level_sums_type) :: lag_sums_type
   contains
      procedure :: add => add_lags
   end type lag_sums_type

contains

   !> Autocovariances of a series at the lags 0 .. max_lag.
   !>
   !> $$r_k = \frac{1}{n} \sum_{t=k}^{n-1} (x_t - \bar x)(x_{t-k} - \bar x)$$ the biased form, whose
   !> Toeplitz matrix is positive definite. With missing samples the mean is that of the present
   !> ones and $$r_k = \frac{n-k}{n}\,\frac{1}{m_k}\sum (x_t - \bar x)(x_{t-k} - \bar x)$$ over the
   !> m_k pairs that are present, 0 where there is none; not always positive definite. Source:
   !> Brockwell & Davis, Time Series: Theory and Methods (1991), 7.2; Parzen (1963) for gaps.
   subroutine compute_autocovariance(x, max_lag, mean, r, error, valid, pairs, progress)
      !> Series: [n], any unit u, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag, 0 .. n-1
      integer, intent(in) :: max_lag
      !> Mean of the present samples, u
      real(dp), intent(out) :: mean
      !> Autocovariances: [0:max_lag], u^2; r(0) is 0 for a constant series, which is no error
      real(dp), allocatable, intent(out) :: r(:)
      !> invalid_argument, too_few_samples, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Number of present pairs at each lag: [0:max_lag]
      integer(int64), allocatable, intent(out), optional :: pairs(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(autocovariance_type) :: shared
      type(trend_type) :: level
      integer(int64) :: count

      mean = 0.0_dp
      call check_series(size(x, kind=int64), max_lag, error, valid)
      if (.not. allocated(error)) call find_level(x, level, count, error, valid)
      if (allocated(error)) return
      mean = level%legendre(0) + level%remainder
      call plan_autocovariance(shared, max_lag, level%legendre(0), level%remainder)
      call need_autocovariance(x, shared, error, valid, progress)
      call move_alloc(shared%r, r)
      if (present(pairs)) call move_alloc(shared%pairs, pairs)
   end subroutine compute_autocovariance

   !> Refuses a lag or a mask that does not fit the series.
   subroutine check_series(n, max_lag, error, valid)
      !> Length of the series
      integer(int64), intent(in) :: n
      !> Largest lag
      integer, intent(in) :: max_lag
      !> invalid_argument, too_few_samples
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      character(120) :: text

      if (max_lag < 0) then
         write (text, '("the largest lag must not be negative, it is ", i0)') max_lag
         call fatal_error(error, status%invalid_argument, trim(text))
      else if (n < int(max_lag, int64) + 1) then
         write (text, "(3(a, i0))") "lag ", max_lag, " needs at least ", int(max_lag, int64) + 1, &
            & " samples, there are ", n
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (present(valid)) then
         if (size(valid, kind=int64) /= n) call fatal_error(error, status%invalid_argument, &
            & "the mask and the series differ in length")
      end if
   end subroutine check_series

   !> Mean of the present samples as the sum of two numbers, the first present one and the mean
   !> distance from it: subtracting both in turn keeps the digits of a series with a large offset.
   subroutine find_level(x, level, count, error, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> The two as a trend of degree 0
      type(trend_type), intent(out) :: level
      !> Number of present samples
      integer(int64), intent(out) :: count
      !> too_few_samples, non_finite, no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(level_sums_type) :: sums
      real(dp) :: total(2)

      call set_level(level, first_present(x, valid), 0.0_dp)
      sums%level = level
      call sum_chunks(sums, x, size(x, kind=int64), "mean", total, error, valid)
      count = nint(total(2), int64)
      if (allocated(error)) return
      if (count < 1) call fatal_error(error, status%too_few_samples, &
         & "every sample of the series is missing")
      if (allocated(error)) return
      level%remainder = total(1)/total(2)
      if (.not. ieee_is_finite(level%legendre(0) + level%remainder)) call fatal_error(error, &
         & status%non_finite, "the series has a value that is not finite")
   end subroutine find_level

   !> Sum and number of the present samples of a chunk.
   subroutine add_level(self, x, n, chunk, total, stat, valid)
      class(level_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: y(block_length), flag(block_length)
      integer(int64) :: begin
      integer :: m

      stat = 0
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         call detrended_block(x, self%level, begin, y(:m), flag(:m), valid)
         total(1) = total(1) + sum_of(y(:m))
         total(2) = total(2) + sum_of(flag(:m))
      end do
   end subroutine add_level

   !> Sum of a block.
   pure real(dp) function sum_of(values) result(total)
      real(dp), intent(in), contiguous :: values(:)
      integer :: i

      total = 0.0_dp
      !$omp simd reduction(+:total)
      do i = 1, size(values)
         total = total + values(i)
      end do
   end function sum_of

   !> Says what is wanted.
   pure subroutine plan_autocovariance(shared, max_lag, mean, remainder)
      !> Nothing is filled
      type(autocovariance_type), intent(out) :: shared
      !> Largest lag, >= 0; less than the length of the series
      integer, intent(in) :: max_lag
      !> Mean of the present samples and what it lost when it was rounded
      real(dp), intent(in) :: mean, remainder

      shared%max_lag = max_lag
      shared%mean = mean
      shared%remainder = remainder
   end subroutine plan_autocovariance

   !> Fills what no pass has filled before; one pass.
   subroutine need_autocovariance(x, shared, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Planned before; remains as it is where it is filled
      type(autocovariance_type), intent(inout) :: shared
      !> invalid_argument (nothing planned, size of valid), too_few_samples, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(lag_sums_type) :: sums
      real(dp), allocatable :: total(:)
      integer(int64) :: n
      integer :: stat

      if (allocated(shared%r)) return
      n = size(x, kind=int64)
      call check_series(n, shared%max_lag, error, valid)
      if (allocated(error)) return
      allocate (total(2*(shared%max_lag + 1)), stat=stat)
      call check_memory(stat, "the lagged sums", error)
      if (allocated(error)) return
      call set_level(sums%level, shared%mean, shared%remainder)
      call sum_chunks(sums, x, n, "autocovariances", total, error, valid, progress)
      if (.not. allocated(error)) call close_autocovariance(shared, n, total)
   end subroutine need_autocovariance

   !> Lagged products of a chunk.
   subroutine add_lags(self, x, n, chunk, total, stat, valid)
      class(lag_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: begin

      stat = 0
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         call add_lag_block(x, self%level, begin, &
            & min(begin + block_length - 1, chunk_last(n, chunk)), total, stat, valid)
         if (stat /= 0) return
      end do
   end subroutine add_lags

   !> Adds the products of a block's samples with themselves and their past; counts the pairs.
   subroutine add_lag_block(x, level, first, last, total, stat, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Mean of the series
      type(trend_type), intent(in) :: level
      !> 1-based first and last sample of the block, some thousand of them
      integer(int64), intent(in) :: first, last
      !> Sums of products at the lags 0 .. max_lag, then pairs: [2 (max_lag + 1)]
      real(dp), intent(inout), contiguous :: total(:)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: y(:), here(:)
      integer :: m, k, lags

      lags = size(total)/2 - 1
      m = int(last - first) + 1
      allocate (y(1 - lags:m), stat=stat)
      if (stat == 0) allocate (here(1 - lags:m), stat=stat)
      if (stat /= 0) return
      call detrended_block(x, level, first - lags, y, here, valid)
      call add_lagged_products(y(1:), y, m, lags, total(:lags + 1))
      if (present(valid)) then
         call add_lagged_products(here(1:), here, m, lags, total(lags + 2:))
      else
         do k = 0, lags
            total(lags + 2 + k) = total(lags + 2 + k) &
               & + real(max(0_int64, last - max(first, int(k, int64) + 1) + 1), dp)
         end do
      end if
   end subroutine add_lag_block

   !> Autocovariances from the sums.
   subroutine close_autocovariance(shared, n, total)
      !> Filled
      type(autocovariance_type), intent(inout) :: shared
      !> Length of the series
      integer(int64), intent(in) :: n
      !> As of [[add_lag_block]]
      real(dp), intent(in) :: total(:)
      real(dp) :: pairs
      integer :: k

      shared%samples = n
      allocate (shared%r(0:shared%max_lag), shared%pairs(0:shared%max_lag))
      do k = 0, shared%max_lag
         pairs = total(shared%max_lag + 2 + k)
         shared%r(k) = total(k + 1)
         if (pairs > 0.0_dp) shared%r(k) = &
            & total(k + 1)*((real(n, dp) - real(k, dp))/pairs)/real(n, dp)
         shared%pairs(k) = nint(pairs, int64)
      end do
   end subroutine close_autocovariance

end module gyroakf_stats_autocovariance
