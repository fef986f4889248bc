! SPDX-License-Identifier: MIT
!> The pass over the series that a Dickey-Fuller regression takes: every sum over its rows that touches the data.
!>
!> On the way it makes the autocovariances that somebody else needs (gyroakf_stats_shared_autocovariance): both kernels run over
!> a block while it is in the cache. The partition of the sums follows from the length of the series alone.
module gyroakf_stats_lagged_rows
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last
   use gyroakf_stats_trend, only : trend_type, subtract_trend
   use gyroakf_stats_lagged_products, only : add_lagged_products
   use gyroakf_stats_shared_autocovariance, only : autocovariance_type, lag_buffer_type, open_lag_buffer, add_lag_block, &
      & close_autocovariance
   implicit none (type, external)
   private
   public :: row_sums_type, sum_rows, time_of, level2, level_d, time0, time_level, time_d

   !> Places of the sums that are not lagged products: squares of the level, level times difference, powers 0 .. 4 of the
   !> time, powers 0 .. 2 times level, powers 0 .. 2 times difference
   integer, parameter :: level2 = 1, level_d = 2, time0 = 3, time_level = 8, time_d = 11, sums = 13
   !> Chunks whose sums are held at a time; progress is reported between two lots
   integer, parameter :: lot = 16

   !> Sums over the rows of a regression
   type :: row_sums_type
      !> sum d_t d_(t-j): [0:lags]
      real(dp), allocatable :: lagged(:)
      !> The others, by place
      real(dp) :: other(sums) = 0.0_dp
   end type row_sums_type

   !> What a block holds: differences with their past, level before each row, weight 1 or 0
   type :: block_type
      !> Series less trend and its differences: [-lags:length], [1-lags:length]
      real(dp), allocatable :: y(:), d(:)
      !> Difference, level before it and weight of every row: [length]
      real(dp), allocatable :: a(:), level(:), weight(:)
      !> For the autocovariances
      type(lag_buffer_type) :: lag
   end type block_type

contains

   !> Sums over the rows t = lags + 1 .. n - 1 for which y_t .. y_(t-lags-1) are present, y the series less its trend.
   subroutine sum_rows(x, trend, terms, lags, result, error, valid, shared, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, 0 .. 3; lags, 0 .. n-2
      integer, intent(in) :: terms, lags
      !> The sums
      type(row_sums_type), intent(out) :: result
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Filled, where something is planned and nothing filled
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback
      class(progress_type), intent(inout), optional :: progress
      type(autocovariance_type) :: wanted
      real(dp), allocatable :: c(:, :), other(:, :), products(:, :), number(:, :), sum_products(:), sum_number(:)
      integer(int64) :: n
      integer :: first, chunk, chunks, stat

      n = size(x, kind=int64)
      chunks = chunk_count(n)
      if (present(shared)) then
         if (.not. allocated(shared%r) .and. int(shared%max_lag, int64) < n) wanted = shared
      end if
      allocate (other(sums, lot), products(0:wanted%max_lag, lot), number(0:wanted%max_lag, lot))
      allocate (sum_products(0:wanted%max_lag), sum_number(0:wanted%max_lag))
      allocate (result%lagged(0:lags), stat=stat)
      if (stat == 0) allocate (c(0:lags, lot), stat=stat)
      if (stat == 0) then
         result%lagged = 0.0_dp
         sum_products = 0.0_dp
         sum_number = 0.0_dp
         do first = 1, chunks, lot
            call tell_progress("unit-root test", chunk_first(n, first) - 1, n, error, progress)
            if (allocated(error)) return
            call sum_lot(x, trend, terms, lags, first, min(first + lot - 1, chunks), c, other, wanted, products, number, &
               & stat, valid)
            if (stat /= 0) exit
            do chunk = 1, min(lot, chunks - first + 1)
               result%lagged(:) = result%lagged + c(:, chunk)
               result%other(:) = result%other + other(:, chunk)
               sum_products(:) = sum_products + products(:, chunk)
               sum_number(:) = sum_number + number(:, chunk)
            end do
         end do
      end if
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums of the unit-root regression")
      else if (wanted%max_lag >= 0) then
         call close_autocovariance(shared, n, sum_products, sum_number)
      end if
   end subroutine sum_rows

   !> The sums of some chunks.
   subroutine sum_lot(x, trend, terms, lags, from, to, c, other, wanted, products, number, stat, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, lags; first and last chunk
      integer, intent(in) :: terms, lags, from, to
      !> sum d_t d_(t-j): [0:lags, chunk]
      real(dp), intent(inout), contiguous :: c(0:, :)
      !> The other sums: [sums, chunk]
      real(dp), intent(inout), contiguous :: other(:, :)
      !> Autocovariances that are made on the way
      type(autocovariance_type), intent(in) :: wanted
      !> Their products and pairs: [0:max_lag, chunk]
      real(dp), intent(inout), contiguous :: products(0:, :), number(0:, :)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(block_type) :: b
      integer :: chunk, k, bad
      logical :: ready

      stat = 0
      !$omp parallel if (size(x, kind=int64) >= threads_from) default(shared) private(b, k, bad, ready)
      call allocate_block(b, lags, ready)
      if (wanted%max_lag >= 0) call open_lag_buffer(b%lag, wanted%max_lag)
      bad = merge(0, 1, ready)
      !$omp atomic
      stat = stat + bad
      !$omp do schedule(dynamic)
      do chunk = from, to
         if (bad /= 0) cycle
         k = chunk - from + 1
         call sum_chunk(x, trend, terms, lags, chunk, b, c(:, k), other(:, k), wanted, products(:, k), number(:, k), valid)
      end do
      !$omp end do
      if (bad == 0) deallocate (b%y, b%d, b%a, b%level, b%weight)
      if (wanted%max_lag >= 0) deallocate (b%lag%value, b%lag%here)
      !$omp end parallel
   end subroutine sum_lot

   !> The sums of a chunk, block by block.
   subroutine sum_chunk(x, trend, terms, lags, chunk, b, c, other, wanted, products, number, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, lags, the chunk
      integer, intent(in) :: terms, lags, chunk
      !> Buffers
      type(block_type), intent(inout) :: b
      !> sum d_t d_(t-j): [0:lags]; the other sums
      real(dp), intent(out), contiguous :: c(0:), other(:)
      !> Autocovariances that are made on the way
      type(autocovariance_type), intent(in) :: wanted
      !> Their products and pairs: [0:max_lag]
      real(dp), intent(out), contiguous :: products(0:), number(0:)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, first, last, begin

      n = size(x, kind=int64)
      c = 0.0_dp
      other = 0.0_dp
      products = 0.0_dp
      number = 0.0_dp
      do first = chunk_first(n, chunk) - 1, chunk_last(n, chunk) - 1, block_length
         last = min(first + block_length - 1, chunk_last(n, chunk) - 1)
         if (wanted%max_lag >= 0) call add_lag_block(x, wanted, first + 1, last + 1, b%lag, products, number, valid)
         begin = max(first, int(lags, int64) + 1)
         if (begin > last) cycle
         call load(x, trend, lags, begin, last, b, valid)
         call add_lagged_products(b%a, b%d, int(last - begin) + 1, lags, c)
         call add_others(b, terms, begin, n, int(last - begin) + 1, other)
      end do
   end subroutine sum_chunk

   !> Allocates a block.
   pure subroutine allocate_block(b, lags, ready)
      !> The block
      type(block_type), intent(inout) :: b
      !> Lags
      integer, intent(in) :: lags
      !> .false. where memory is short
      logical, intent(out) :: ready
      integer :: stat

      allocate (b%y(-lags:block_length), stat=stat)
      if (stat == 0) allocate (b%d(1 - lags:block_length), stat=stat)
      if (stat == 0) allocate (b%a(block_length), stat=stat)
      if (stat == 0) allocate (b%level(block_length), stat=stat)
      if (stat == 0) allocate (b%weight(block_length), stat=stat)
      ready = stat == 0
   end subroutine allocate_block

   !> Fills a block with the rows first .. last and the past of their differences.
   pure subroutine load(x, trend, lags, first, last, b, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Lags
      integer, intent(in) :: lags
      !> 0-based rows, first > lags
      integer(int64), intent(in) :: first, last
      !> The block
      type(block_type), intent(inout) :: b
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: begin
      integer :: i, m, run

      begin = first - lags - 1
      m = int(last - first) + 1
      do i = -lags, m
         b%y(i) = x(begin + lags + 1 + i)
      end do
      call subtract_trend(trend, begin, b%y(:m))
      do i = 1 - lags, m
         b%d(i) = b%y(i) - b%y(i - 1)
      end do
      if (.not. present(valid)) then
         b%a(:m) = b%d(1:m)
         b%level(:m) = b%y(0:m - 1)
         b%weight(:m) = 1.0_dp
         return
      end if
      run = 0
      do i = -lags, m
         run = run + 1
         if (valid(begin + lags + 1 + i) == 0_int8) run = 0
         if (i < 1) cycle
         b%weight(i) = merge(1.0_dp, 0.0_dp, run >= lags + 2)
         b%a(i) = b%d(i)*b%weight(i)
         b%level(i) = b%y(i - 1)*b%weight(i)
      end do
   end subroutine load

   !> Adds a block's sums of the level and of the powers of the time.
   pure subroutine add_others(b, terms, first, n, m, s)
      !> The block
      type(block_type), intent(in) :: b
      !> Powers of the time, rows
      integer, intent(in) :: terms, m
      !> 0-based first row, length of the series
      integer(int64), intent(in) :: first, n
      !> The sums
      real(dp), intent(inout) :: s(:)
      real(dp) :: t, s1, s2, power(block_length)
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
            t = time_of(first + i - 1, n)
            power(i) = power(i)*t
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
