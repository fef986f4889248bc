! SPDX-License-Identifier: MIT
!> Sums over residuals for the KPSS test: cumulative sums, lagged products at small lags, and the
!> long-run variance at any bandwidth in one pass whose cost does not depend on the bandwidth.
module gyroakf_stats_long_run
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_chunks, only : block_length, chunk_count, chunk_first, chunk_last
   use gyroakf_chunk_sums, only : chunk_sums_type, sum_chunks
   use gyroakf_progress, only : progress_type
   use gyroakf_stats_lagged_products, only : add_lagged_products, detrended_block
   use gyroakf_stats_trend, only : trend_type
   implicit none (type, external)
   private
   public :: cumulative_type, sum_residuals, sum_bartlett, bartlett_variance, hobijn_lags, &
      & schwert_lags

   !> Sums of residuals e_t and of their running sums S_t = e_1 + ... + e_t over the present t
   type :: cumulative_type
      !> Present residuals, their sum, sum of S_t, sum of S_t^2
      real(dp) :: count = 0.0_dp, total = 0.0_dp, running = 0.0_dp, squares = 0.0_dp
   end type cumulative_type

   !> Lagged products of the residuals of a trend: [0:q]
   type, extends(chunk_sums_type) :: product_sums_type
      type(trend_type) :: trend
      !> Cumulative sums of every chunk
      type(cumulative_type), allocatable :: part(:)
   contains
      procedure :: add => add_products
   end type product_sums_type

   !> Squares of the sums of windows
   type, extends(chunk_sums_type) :: window_sums_type
      type(trend_type) :: trend
      !> Members of a window
      integer(int64) :: width = 1
   contains
      procedure :: add => add_windows
   end type window_sums_type

contains

   !> One pass: cumulative sums, and lagged products at the lags 0 .. q over present pairs.
   subroutine sum_residuals(trend, x, q, sums, products, error, valid, progress)
      !> The fit
      type(trend_type), intent(in) :: trend
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag of the products, >= 0 and small: some tens
      integer, intent(in) :: q
      !> The sums
      type(cumulative_type), intent(out) :: sums
      !> Sums of e_t e_(t-k): [0:q]
      real(dp), allocatable, intent(out) :: products(:)
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(product_sums_type) :: pass
      integer :: chunk, stat

      allocate (products(0:q), stat=stat)
      if (stat == 0) allocate (pass%part(chunk_count(size(x, kind=int64))), stat=stat)
      call check_memory(stat, "the sums over residuals", error)
      if (allocated(error)) return
      pass%trend = trend
      call sum_chunks(pass, x, size(x, kind=int64), "sums of the residuals", products, error, &
         & valid, progress)
      do chunk = 1, size(pass%part)
         call join(sums, pass%part(chunk))
      end do
   end subroutine sum_residuals

   !> The sums of a chunk, block by block.
   subroutine add_products(self, x, n, chunk, total, stat, valid)
      class(product_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      type(cumulative_type) :: block
      real(dp), allocatable :: e(:), flag(:)
      integer(int64) :: begin
      integer :: i, m, q

      q = size(total) - 1
      allocate (e(1 - q:block_length), stat=stat)
      if (stat == 0) allocate (flag(1 - q:block_length), stat=stat)
      do begin = chunk_first(n, chunk), chunk_last(n, chunk), block_length
         if (stat /= 0) return
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         call detrended_block(x, self%trend, begin - q, e(:m), flag(:m), valid)
         block = cumulative_type()
         do i = 1, m
            block%total = block%total + e(i)
            block%count = block%count + flag(i)
            block%running = block%running + flag(i)*block%total
            block%squares = block%squares + flag(i)*(block%total*block%total)
         end do
         call join(self%part(chunk), block)
         call add_lagged_products(e(1:m), e(:m), m, q, total)
      end do
   end subroutine add_products

   !> Appends a stretch: its running sums begin at the total of what was before.
   pure subroutine join(sums, next)
      type(cumulative_type), intent(inout) :: sums
      type(cumulative_type), intent(in) :: next

      sums%squares = sums%squares &
         & + (next%squares + sums%total*(2.0_dp*next%running + next%count*sums%total))
      sums%running = sums%running + (next%running + next%count*sums%total)
      sums%total = sums%total + next%total
      sums%count = sums%count + next%count
   end subroutine join

   !> Sum of all products with Bartlett's weights, by windows.
   !>
   !> $$\sum_{|i| \le l} \Big(1 - \frac{|i|}{l+1}\Big) \sum_t e_t e_{t-i} = \frac{1}{l+1} \sum_j
   !> \Big(\sum_{t=j-l}^{j} e_t\Big)^2$$ with e_t = 0 outside the series and where a residual
   !> is missing: one pass, O(n) for any l, never negative.
   subroutine sum_bartlett(trend, x, lags, total, error, valid, progress)
      !> The fit
      type(trend_type), intent(in) :: trend
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> l, 0 .. number of residuals - 1
      integer(int64), intent(in) :: lags
      !> The sum
      real(dp), intent(out) :: total
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(window_sums_type) :: pass
      real(dp) :: squares(1)

      pass%trend = trend
      pass%width = lags + 1
      call sum_chunks(pass, x, size(x, kind=int64) + lags, "long-run variance", squares, error, &
         & valid, progress)
      total = squares(1)/real(lags + 1, dp)
   end subroutine sum_bartlett

   !> Squares of the sums of the windows that end at the places of a chunk.
   subroutine add_windows(self, x, n, chunk, total, stat, valid)
      class(window_sums_type), intent(inout) :: self
      real(dp), intent(in), contiguous :: x(:)
      integer(int64), intent(in) :: n
      integer, intent(in) :: chunk
      real(dp), intent(inout), contiguous :: total(:)
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      real(dp), dimension(block_length) :: next, past, flag
      real(dp) :: before, change, squares
      integer(int64) :: begin, first
      integer :: i, m

      stat = 0
      first = chunk_first(n, chunk)
      before = 0.0_dp                            ! the window that ends at first - 1
      do begin = max(1_int64, first - self%width), min(first - 1, size(x, kind=int64)), block_length
         m = int(min(block_length, first - begin))
         call detrended_block(x, self%trend, begin, next(:m), flag(:m), valid)
         before = before + sum(next(:m))
      end do
      do begin = first, chunk_last(n, chunk), block_length
         m = int(min(block_length, chunk_last(n, chunk) - begin + 1))
         call detrended_block(x, self%trend, begin, next(:m), flag(:m), valid)
         call detrended_block(x, self%trend, begin - self%width, past(:m), flag(:m), valid)
         change = 0.0_dp
         squares = 0.0_dp
         do i = 1, m
            change = change + (next(i) - past(i))
            squares = squares + (before + change)*(before + change)
         end do
         before = before + change
         total(1) = total(1) + squares
      end do
   end subroutine add_windows

   !> The same sum from the products at the lags 0 .. l, where they are known.
   pure real(dp) function bartlett_variance(products, lags) result(total)
      !> Sums of e_t e_(t-k): [0:q], q >= lags
      real(dp), intent(in) :: products(0:)
      !> l
      integer, intent(in) :: lags
      integer :: k

      total = 0.0_dp
      do k = lags, 1, -1
         total = total + 2.0_dp*(1.0_dp - real(k, dp)/real(lags + 1, dp))*products(k)
      end do
      total = total + products(0)
   end function bartlett_variance

   !> Bandwidth of Hobijn, Franses and Ooms for Bartlett's weights.
   !>
   !> $$l = \lfloor 1.1447 \big((s_1/s_0)^2 n\big)^{1/3} \rfloor, \quad s_0 = g_0 + 2\sum_{i\le q}
   !> g_i, \quad
   !>   s_1 = 2\sum_{i\le q} i g_i$$
   !> with q = floor(n^(2/9)); at most n - 1. Source: Stat. Neerl. 58 (2004) 483-502, after Newey &
   !> West (1994).
   pure integer(int64) function hobijn_lags(products, n) result(lags)
      !> Sums of e_t e_(t-k): [0:q]
      real(dp), intent(in) :: products(0:)
      !> Number of residuals that are present, >= 1
      integer(int64), intent(in) :: n
      real(dp) :: s0, s1, wanted
      integer :: k

      s0 = products(0)
      s1 = 0.0_dp
      do k = 1, ubound(products, 1)
         s0 = s0 + 2.0_dp*products(k)
         s1 = s1 + 2.0_dp*real(k, dp)*products(k)
      end do
      lags = n - 1
      if (abs(s0) <= tiny(s0)) return
      if (abs(s1) >= abs(s0)*real(n, dp)) return
      wanted = 1.1447_dp*((s1/s0)**2)**(1.0_dp/3.0_dp)*real(n, dp)**(1.0_dp/3.0_dp)
      if (wanted < real(n - 1, dp)) lags = int(wanted, int64)
   end function hobijn_lags

   !> floor(12 (n/100)^(1/4)), at most n - 1. Source: Schwert, J. Bus. Econ. Stat. 7 (1989) 147-159.
   pure integer(int64) function schwert_lags(n) result(lags)
      !> Number of residuals, >= 1
      integer(int64), intent(in) :: n

      lags = min(int(12.0_dp*sqrt(sqrt(real(n, dp)/100.0_dp)), int64), n - 1)
   end function schwert_lags

end module gyroakf_stats_long_run
