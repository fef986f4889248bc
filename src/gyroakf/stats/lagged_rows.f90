! SPDX-License-Identifier: MIT
!> The pass over the series of a regression on lags: every sum that touches the data.
!>
!> The rows of a Dickey-Fuller regression hold differences of the series, and its level before;
!> those of an AR regression the series itself. On the way the pass makes the autocovariances that
!> somebody else needs: both kernels run over a block while it is in the cache.
module gyroakf_stats_lagged_rows
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_chunks, only : block_length, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_stats_trend, only : trend_type, set_level
   use gyroakf_stats_lagged_products, only : add_lagged_products, detrended_block
   use gyroakf_stats_autocovariance, only : autocovariance_type, add_lag_block, close_autocovariance
   implicit none (type, external)
   private
   public :: sum_rows, sums, time_of, level2, level_d, time0, time_level, time_d

   !> Places of the sums that are not lagged products: squares of the level, level times difference,
   !> powers 0 .. 4 of the time, powers 0 .. 2 times level, powers 0 .. 2 times difference
   integer, parameter :: level2 = 1, level_d = 2, time0 = 3, time_level = 8, time_d = 11, sums = 13

   !> What is summed: the sums of the rows, lagged ones first, then those of the autocovariances
   type, extends(chunk_sums_type) :: row_pass_type
      !> Subtracted from the series for the rows, and for the autocovariances
      type(trend_type) :: trend, level
      !> Powers of the time, lags, past samples of a row, largest lag of autocovariances or -1
      integer :: terms = 0, lags = 0, reach = 0, max_lag = -1
   contains
      procedure :: add => add_rows
   end type row_pass_type

   !> What a block holds
   type :: block_type
      !> Series less trend and its presence: [-lags:length]; differences: [1-lags:length]
      real(dp), allocatable :: y(:), here(:), d(:)
      !> Difference, level before it and weight (1 or 0) of every row: [length]
      real(dp), dimension(block_length) :: a, level, weight
   end type block_type

contains

   !> Sums over the rows t for which y_t .. y_(t-reach) are present, y the series less its trend.
   subroutine sum_rows(x, trend, terms, lags, reach, lagged, other, error, valid, shared, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, 0 .. 3; lags; past samples of a row: lags, + 1 for differences
      integer, intent(in) :: terms, lags, reach
      !> sum d_t d_(t-j), d the difference or the series itself: [0:lags]; the other sums, by place
      real(dp), intent(out) :: lagged(0:), other(sums)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Filled, where something is planned and nothing filled
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback
      class(progress_type), intent(inout), optional :: progress
      type(row_pass_type) :: pass
      real(dp), allocatable :: total(:)
      integer(int64) :: n
      integer :: stat

      n = size(x, kind=int64)
      pass%trend = trend
      pass%terms = terms
      pass%lags = lags
      pass%reach = reach
      if (present(shared)) then
         if (.not. allocated(shared%r) .and. int(shared%max_lag, int64) < n) then
            pass%max_lag = shared%max_lag
            call set_level(pass%level, shared%mean, shared%remainder)
         end if
      end if
      allocate (total(lags + 1 + sums + 2*(pass%max_lag + 1)), stat=stat)
      call check_memory(stat, "the sums of a regression on lags", error)
      if (allocated(error)) return
      call sum_chunks(pass, x, n, trim(merge("unit-root test      ", "rows of the AR model", &
         & reach > lags)), total, error, valid, progress)
      if (allocated(error)) return
      lagged = total(:lags + 1)
      other = total(lags + 2:lags + 1 + sums)
      if (pass%max_lag >= 0) call close_autocovariance(shared, n, total(lags + 2 + sums:))
   end subroutine sum_rows

   !> The sums of a chunk, block by block.
   subroutine add_rows(self, x, n, chunk, total, stat, valid)
      class(row_pass_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      type(block_type) :: b
      integer(int64) :: begin
      integer :: m, others

      others = self%lags + 2
      m = int(block_length)
      allocate (b%y(-self%lags:m), stat=stat)
      if (stat == 0) allocate (b%here(-self%lags:m), stat=stat)
      if (stat == 0) allocate (b%d(1 - self%lags:m), stat=stat)
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         if (stat /= 0) return
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         call load(self, x, begin, m, b, valid)
         call add_lagged_products(b%a, b%d, m, self%lags, total(:others - 1))
         call add_others(b, self%terms, begin - 1, n, m, total(others:others + sums - 1))
         if (self%max_lag >= 0) call add_lag_block(x, self%level, begin, begin + m - 1, &
            & total(others + sums:), stat, valid)
      end do
   end subroutine add_rows

   !> Fills a block with the rows that end at m samples, and with the past of their differences.
   pure subroutine load(pass, x, first, m, b, valid)
      type(row_pass_type), intent(in) :: pass
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: first
      integer, intent(in) :: m
      type(block_type), intent(inout) :: b
      integer(int8), intent(in), optional :: valid(:)
      integer :: i, run

      call detrended_block(x, pass%trend, first - pass%lags - 1, b%y(:m), b%here(:m), valid)
      if (pass%reach > pass%lags) then
         do i = 1 - pass%lags, m
            b%d(i) = b%y(i) - b%y(i - 1)
         end do
      else
         b%d(:m) = b%y(1 - pass%lags:m)
      end if
      if (.not. present(valid) .and. first > pass%reach) then
         b%a(:m) = b%d(1:m)
         b%level(:m) = b%y(0:m - 1)
         b%weight(:m) = 1.0_dp
         return
      end if
      run = 0
      do i = -pass%lags, m
         run = run + 1
         if (b%here(i) < 0.5_dp) run = 0
         if (i < 1) cycle
         b%weight(i) = merge(1.0_dp, 0.0_dp, run > pass%reach)
         b%a(i) = b%d(i)*b%weight(i)
         b%level(i) = b%y(i - 1)*b%weight(i)
      end do
   end subroutine load

   !> Adds a block's sums of the level and of the powers of the time.
   pure subroutine add_others(b, terms, first, n, m, s)
      type(block_type), intent(in) :: b
      integer, intent(in) :: terms, m
      integer(int64), intent(in) :: first, n
      real(dp), intent(inout) :: s(:)
      real(dp) :: s1, s2, power(block_length)
      integer :: i, k

      s1 = 0.0_dp
      s2 = 0.0_dp
      !$omp simd reduction(+:s1, s2)
      do i = 1, m
         s1 = s1 + b%level(i)*b%level(i)
         s2 = s2 + b%level(i)*b%a(i)
      end do
      s(level2) = s(level2) + s1
      s(level_d) = s(level_d) + s2
      power(:m) = b%weight(:m)
      do k = 0, max(0, 2*(terms - 1))
         s(time0 + k) = s(time0 + k) + sum(power(:m))
         if (k < terms) then
            s(time_level + k) = s(time_level + k) + dot_product(power(:m), b%level(:m))
            s(time_d + k) = s(time_d + k) + dot_product(power(:m), b%a(:m))
         end if
         do i = 1, m
            power(i) = power(i)*time_of(first + i - 1, n)
         end do
      end do
   end subroutine add_others

   !> Scaled time of a sample.
   pure real(dp) function time_of(t, n)
      !> 0-based index, length of the series
      integer(int64), intent(in) :: t, n

      time_of = real(2*t - n, dp)/real(n, dp)
   end function time_of

end module gyroakf_stats_lagged_rows
