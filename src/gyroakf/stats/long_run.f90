! SPDX-License-Identifier: MIT
!> Sums over residuals for the KPSS test: cumulative sums, lagged products at small lags, and the
!> long-run variance at any bandwidth in one pass whose cost does not depend on the bandwidth.
module gyroakf_stats_long_run
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_autocovariance, only : add_lagged_products
   use gyroakf_stats_trend_residuals, only : residual_type, load_residuals
   implicit none (type, external)
   private
   public :: cumulative_type, sum_residuals, sum_bartlett, bartlett_variance, hobijn_lags, schwert_lags

   !> Sums of a stretch of residuals e_t and of their running sums S_t = e_1 + ... + e_t over the present t
   type :: cumulative_type
      !> Present residuals, their sum, sum of S_t, sum of S_t^2
      real(dp) :: count = 0.0_dp, total = 0.0_dp, running = 0.0_dp, squares = 0.0_dp
   end type cumulative_type

contains

   !> One pass: cumulative sums, and lagged products at the lags 0 .. q over present pairs.
   subroutine sum_residuals(residual, x, q, sums, products, error, valid, progress)
      !> The fit
      type(residual_type), intent(in) :: residual
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
      type(cumulative_type) :: part(chunk_count(residual%samples))
      real(dp), allocatable :: partial(:, :)
      integer(int64) :: n
      integer :: chunk, from, group, stat, bad

      n = residual%samples
      allocate (products(0:q), stat=stat)
      if (stat == 0) allocate (partial(0:q, chunk_count(n)), stat=stat)
      if (stat == 0) then
         partial = 0.0_dp
         group = chunk_group(chunk_count(n), present(progress))
         do from = 1, chunk_count(n), group
            call tell_progress("sums of the residuals", chunk_first(n, from) - 1, n, error, progress)
            if (allocated(error)) return
            !$omp parallel do if (n >= threads_from) default(shared) private(bad) schedule(dynamic) reduction(+:stat)
            do chunk = from, min(from + group - 1, chunk_count(n))
               call sum_chunk(residual, x, chunk_first(n, chunk), chunk_last(n, chunk), part(chunk), partial(:, chunk), bad, valid)
               stat = stat + bad
            end do
            !$omp end parallel do
         end do
      end if
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums over residuals")
         return
      end if
      products = 0.0_dp
      do chunk = 1, chunk_count(n)
         call join(sums, part(chunk))
         products = products + partial(:, chunk)
      end do
   end subroutine sum_residuals

   !> The sums of a chunk, block by block.
   subroutine sum_chunk(residual, x, first, last, sums, products, stat, valid)
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      !> Residuals of the chunk
      integer(int64), intent(in) :: first, last
      type(cumulative_type), intent(out) :: sums
      !> [0:q]
      real(dp), intent(inout), contiguous :: products(0:)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      integer(int8), intent(in), optional :: valid(:)
      type(cumulative_type) :: block
      real(dp), allocatable :: e(:)
      real(dp) :: flag(block_length)
      integer(int64) :: start
      integer :: i, length, q

      q = ubound(products, 1)
      allocate (e(1 - q:block_length), stat=stat)
      if (stat /= 0) return
      call load_residuals(residual, x, first - q, e(1 - q:0), valid)
      do start = first, last, block_length
         length = int(min(block_length, last - start + 1))
         call load_residuals(residual, x, start, e(1:length), valid, flag(:length))
         block = cumulative_type()
         do i = 1, length
            block%total = block%total + e(i)
            block%count = block%count + flag(i)
            block%running = block%running + flag(i)*block%total
            block%squares = block%squares + flag(i)*(block%total*block%total)
         end do
         call join(sums, block)
         call add_lagged_products(e(1:length), e(:length), length, q, products)
         do i = 1 - q, 0
            e(i) = e(length + i)
         end do
      end do
   end subroutine sum_chunk

   !> Appends a stretch: its running sums begin at the total of what was before.
   pure subroutine join(sums, next)
      type(cumulative_type), intent(inout) :: sums
      type(cumulative_type), intent(in) :: next

      sums%squares = sums%squares + (next%squares + sums%total*(2.0_dp*next%running + next%count*sums%total))
      sums%running = sums%running + (next%running + next%count*sums%total)
      sums%total = sums%total + next%total
      sums%count = sums%count + next%count
   end subroutine join

   !> Sum of all products with Bartlett's weights, by windows.
   !>
   !> $$\sum_{|i| \le l} \Big(1 - \frac{|i|}{l+1}\Big) \sum_t e_t e_{t-i} = \frac{1}{l+1} \sum_j \Big(\sum_{t=j-l}^{j} e_t\Big)^2$$
   !> with e_t = 0 outside the series and where a residual is missing: one pass, O(n) for any l, never negative.
   subroutine sum_bartlett(residual, x, lags, total, error, valid, progress)
      !> The fit
      type(residual_type), intent(in) :: residual
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> l, 0 .. number of residuals - 1
      integer(int64), intent(in) :: lags
      !> The sum
      real(dp), intent(out) :: total
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: part(chunk_count(residual%samples + lags))
      integer(int64) :: n
      integer :: chunk, from, group

      n = residual%samples + lags
      total = 0.0_dp
      group = chunk_group(chunk_count(n), present(progress))
      do from = 1, chunk_count(n), group
         call tell_progress("long-run variance", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel do if (n >= threads_from) default(shared) schedule(dynamic)
         do chunk = from, min(from + group - 1, chunk_count(n))
            call sum_windows(residual, x, chunk_first(n, chunk), chunk_last(n, chunk), lags + 1, part(chunk), valid)
         end do
         !$omp end parallel do
      end do
      total = sum(part)/real(lags + 1, dp)
   end subroutine sum_bartlett

   !> Squares of the sums of the windows that end at first .. last.
   subroutine sum_windows(residual, x, first, last, width, total, valid)
      type(residual_type), intent(in) :: residual
      real(dp), intent(in), contiguous :: x(:)
      !> Last members of the windows; may lie behind the series
      integer(int64), intent(in) :: first, last
      !> Members of a window
      integer(int64), intent(in) :: width
      real(dp), intent(out) :: total
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: next(block_length), past(block_length), before, change, squares
      integer(int64) :: start
      integer :: i, length

      total = 0.0_dp
      before = 0.0_dp                            ! the window that ends at first - 1
      do start = max(1_int64, first - width), min(first - 1, residual%samples), block_length
         length = int(min(block_length, first - start))
         call load_residuals(residual, x, start, next(:length), valid)
         before = before + sum(next(:length))
      end do
      do start = first, last, block_length
         length = int(min(block_length, last - start + 1))
         call load_residuals(residual, x, start, next(:length), valid)
         call load_residuals(residual, x, start - width, past(:length), valid)
         change = 0.0_dp
         squares = 0.0_dp
         do i = 1, length
            change = change + (next(i) - past(i))
            squares = squares + (before + change)*(before + change)
         end do
         before = before + change
         total = total + squares
      end do
   end subroutine sum_windows

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
   !> $$l = \lfloor 1.1447 \big((s_1/s_0)^2 n\big)^{1/3} \rfloor, \quad s_0 = g_0 + 2\sum_{i\le q} g_i, \quad
   !>   s_1 = 2\sum_{i\le q} i g_i$$
   !> with q = floor(n^(2/9)); at most n - 1. Source: Stat. Neerl. 58 (2004) 483-502, after Newey & West (1994).
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
