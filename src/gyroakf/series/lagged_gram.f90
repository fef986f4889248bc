! SPDX-License-Identifier: MIT
!> Gram matrix of the Dickey-Fuller regression from one pass over the series.
!>
!> The regression of d_t = y_t - y_(t-1) on powers of the time, the level y_(t-1) and d_(t-1) .. d_(t-p)
!> needs (p + 4)^2/2 sums over the rows. Only C(0,j) = sum d_t d_(t-j) and a dozen more touch the
!> data; with a .. b the rows of a stretch without gaps the others follow exactly from its ends:
!> $$C_{i+1,j+1} = C_{ij} + d_{a-1-i} d_{a-1-j} - d_{b-i} d_{b-j}$$
!> $$\sum y_{t-1} d_{t-1-j} = \sum y_{t-1} d_{t-j} + C_{0j} + y_{a-1} d_{a-1-j} - y_b d_{b-j}$$
!> and the sums with powers of the time likewise. Time O(n p), memory O(p^2). y is the series less its
!> trend: the statistic does not feel that, but without it an offset would cost all digits.
module gyroakf_series_lagged_gram
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last
   use gyroakf_preprocess_trend, only : trend_type, subtract_trend
   use gyroakf_ar_autocovariance, only : add_lagged_products
   implicit none (type, external)
   private
   public :: gram_type, build_gram

   !> Sums of products over the rows of the regression
   type :: gram_type
      !> Powers of the time (0 .. 3), lags of the difference
      integer :: terms = 0, lags = 0
      !> Rows: t for which y_t .. y_(t-lags-1) are present
      integer(int64) :: rows = 0
      !> Powers of the time, level, lags 1 .. lags, difference: [terms + lags + 2, same]; upper triangle
      real(dp), allocatable :: matrix(:, :)
   end type gram_type

   !> Places of the sums that are not lagged products
   integer, parameter :: level2 = 1, level_d = 2, time0 = 3, time_level = 8, time_d = 11, sums = 13

   !> What a block holds: differences with their past, level before each row, weight 1 or 0
   type :: block_type
      !> Series less trend and its differences: [-lags:length], [1-lags:length]
      real(dp), allocatable :: y(:), d(:)
      !> Difference, level before it and weight of every row: [length]
      real(dp), allocatable :: a(:), level(:), weight(:)
   end type block_type

contains

   !> Builds the Gram matrix.
   subroutine build_gram(x, trend, terms, lags, gram, error, valid)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, 0 .. 3
      integer, intent(in) :: terms
      !> Lags of the difference, 0 .. n-2
      integer, intent(in) :: lags
      !> The matrix
      type(gram_type), intent(out) :: gram
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: c(:, :), other(:, :)
      real(dp) :: first_row(0:lags, 0:4), s(sums)
      integer :: k, chunks, stat

      k = terms + lags + 2
      chunks = chunk_count(size(x, kind=int64))
      gram%terms = terms
      gram%lags = lags
      allocate (gram%matrix(k, k), stat=stat)
      if (stat == 0) allocate (c(0:lags, chunks), stat=stat)
      if (stat == 0) allocate (other(sums, chunks), stat=stat)
      if (stat == 0) call sum_rows(x, trend, terms, lags, c, other, stat, valid)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums of the unit-root regression")
         return
      end if
      gram%matrix = 0.0_dp
      s = sum(other, 2)
      gram%rows = nint(s(time0), int64)
      first_row = 0.0_dp
      first_row(:, 0) = sum(c, 2)
      first_row(0, 1) = s(level_d)
      first_row(0, 2:4) = s(time_d:time_d + 2)
      call extend(x, trend, terms, lags, first_row, gram%matrix, valid)
      call fill(gram, first_row, s)
   end subroutine build_gram

   !> Scaled time of a sample.
   pure real(dp) function time_of(t, n)
      !> 0-based index, length of the series
      integer(int64), intent(in) :: t, n

      time_of = real(2*t - n, dp)/real(n, dp)
   end function time_of

   !> The pass over the series.
   subroutine sum_rows(x, trend, terms, lags, c, other, stat, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, lags
      integer, intent(in) :: terms, lags
      !> sum d_t d_(t-j): [0:lags, chunk]
      real(dp), intent(out) :: c(0:, :)
      !> The other sums: [sums, chunk]
      real(dp), intent(out) :: other(:, :)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      type(block_type) :: b
      integer(int64) :: n, first, last, step
      integer :: chunk, bad
      logical :: ready

      n = size(x, kind=int64)
      step = max(block_length, 4*int(lags, int64))
      stat = 0
      !$omp parallel if (n >= threads_from) default(shared) private(b, first, last, bad, ready)
      call allocate_block(b, lags, step, ready)
      bad = merge(0, 1, ready)
      !$omp atomic
      stat = stat + bad
      !$omp do schedule(dynamic)
      do chunk = 1, size(c, 2)
         c(:, chunk) = 0.0_dp
         other(:, chunk) = 0.0_dp
         if (bad /= 0) cycle
         do first = max(chunk_first(n, chunk) - 1, int(lags, int64) + 1), chunk_last(n, chunk) - 1, step
            last = min(first + step - 1, chunk_last(n, chunk) - 1)
            call load(x, trend, lags, first, last, b, valid)
            call add_lagged_products(b%a, b%d, int(last - first) + 1, lags, c(:, chunk))
            call add_others(b, terms, first, n, int(last - first) + 1, other(:, chunk))
         end do
      end do
      !$omp end do
      if (bad == 0) deallocate (b%y, b%d, b%a, b%level, b%weight)
      !$omp end parallel
   end subroutine sum_rows

   !> Allocates a block.
   subroutine allocate_block(b, lags, length, ready)
      !> The block
      type(block_type), intent(inout) :: b
      !> Lags
      integer, intent(in) :: lags
      !> Most rows
      integer(int64), intent(in) :: length
      !> .false. where memory is short
      logical, intent(out) :: ready
      integer :: stat

      allocate (b%y(-lags:length), stat=stat)
      if (stat == 0) allocate (b%d(1 - lags:length), stat=stat)
      if (stat == 0) allocate (b%a(length), stat=stat)
      if (stat == 0) allocate (b%level(length), stat=stat)
      if (stat == 0) allocate (b%weight(length), stat=stat)
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
      real(dp) :: t, s1, s2, power(m)
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
      power = b%weight(:m)
      do k = 0, max(0, 2*(terms - 1))
         s(time0 + k) = s(time0 + k) + sum(power)
         if (k < terms) then
            s(time_level + k) = s(time_level + k) + dot_product(power, b%level(:m))
            s(time_d + k) = s(time_d + k) + dot_product(power, b%a(:m))
         end if
         do i = 1, m
            t = time_of(first + i - 1, n)
            power(i) = power(i)*t
         end do
      end do
   end subroutine add_others

   !> Extends the sums of lag 0 to all lags by the ends of every stretch without gaps.
   subroutine extend(x, trend, terms, lags, first_row, matrix, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, lags
      integer, intent(in) :: terms, lags
      !> Columns: sum d_t d_(t-j), y_(t-1) d_(t-j), time^k d_(t-j), k = 0 .. 2; j = 0 known in all: [0:lags, 0:4]
      real(dp), intent(inout) :: first_row(0:, 0:)
      !> The corrections of sum d_(t-i) d_(t-j), in the place of lag i+1, j+1
      real(dp), intent(inout) :: matrix(:, :)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: edge(0:lags, 4), delta
      integer(int64) :: n, begin, finish
      integer :: j

      n = size(x, kind=int64)
      delta = 2.0_dp/real(n, dp)
      edge = 0.0_dp
      begin = 0
      do while (begin < n)
         finish = n - 1
         if (present(valid)) call next_run(valid, begin, finish)
         if (finish - begin >= lags + 1) call add_ends(x, trend, terms, lags, begin, finish, edge, matrix)
         begin = finish + 1
      end do
      do j = 0, lags - 1
         first_row(j + 1, 1) = first_row(j, 1) + first_row(j, 0) + edge(j, 1)
         first_row(j + 1, 2) = first_row(j, 2) + edge(j, 2)
         first_row(j + 1, 3) = first_row(j, 3) + delta*first_row(j, 2) + edge(j, 3)
         first_row(j + 1, 4) = first_row(j, 4) + delta*(2.0_dp*first_row(j, 3) + delta*first_row(j, 2)) + edge(j, 4)
      end do
   end subroutine extend

   !> The next stretch of present samples.
   pure subroutine next_run(valid, begin, finish)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in) :: valid(:)
      !> 0-based: where to look from; the first present sample, n where there is none
      integer(int64), intent(inout) :: begin
      !> Last sample of the stretch, begin - 1 where there is none
      integer(int64), intent(out) :: finish
      integer(int64) :: n

      n = size(valid, kind=int64)
      do while (begin < n)
         if (valid(begin + 1) /= 0_int8) exit
         begin = begin + 1
      end do
      finish = begin - 1
      do while (finish + 1 < n)
         if (valid(finish + 2) == 0_int8) exit
         finish = finish + 1
      end do
   end subroutine next_run

   !> Adds the ends of a stretch.
   pure subroutine add_ends(x, trend, terms, lags, begin, finish, edge, matrix)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, lags
      integer, intent(in) :: terms, lags
      !> 0-based first and last sample of the stretch; its rows are begin + lags + 1 .. finish
      integer(int64), intent(in) :: begin, finish
      !> Corrections of the sums with y_(t-1) and with the powers of the time
      real(dp), intent(inout) :: edge(0:, :)
      !> Corrections of sum d_(t-i) d_(t-j)
      real(dp), intent(inout) :: matrix(:, :)
      real(dp) :: head(0:lags), tail(0:lags + 1), d0(0:max(lags - 1, 0)), d1(0:max(lags - 1, 0)), t0, t1
      integer(int64) :: n
      integer :: i, j, base

      if (lags < 1) return
      n = size(x, kind=int64)
      base = terms + 1
      head = x(begin + 1:begin + lags + 1)
      call subtract_trend(trend, begin, head)
      tail = x(finish - lags:finish + 1)
      call subtract_trend(trend, finish - lags - 1, tail)
      do j = 0, lags - 1
         d0(j) = head(lags - j) - head(lags - j - 1)
         d1(j) = tail(lags + 1 - j) - tail(lags - j)
      end do
      t0 = time_of(begin + lags + 1, n)
      t1 = time_of(finish + 1, n)
      do j = 0, lags - 1
         edge(j, 1) = edge(j, 1) + head(lags)*d0(j) - tail(lags + 1)*d1(j)
         edge(j, 2) = edge(j, 2) + d0(j) - d1(j)
         edge(j, 3) = edge(j, 3) + t0*d0(j) - t1*d1(j)
         edge(j, 4) = edge(j, 4) + t0*t0*d0(j) - t1*t1*d1(j)
         do i = 0, j
            matrix(base + 1 + i, base + 1 + j) = matrix(base + 1 + i, base + 1 + j) + (d0(i)*d0(j) - d1(i)*d1(j))
         end do
      end do
   end subroutine add_ends

   !> Puts the sums in their places.
   subroutine fill(gram, first_row, s)
      !> The matrix; it holds the corrections of the lags
      type(gram_type), intent(inout) :: gram
      !> Columns: sum d_t d_(t-j), y_(t-1) d_(t-j), time^k d_(t-j): [0:lags, 0:4]
      real(dp), intent(in) :: first_row(0:, 0:)
      !> The other sums
      real(dp), intent(in) :: s(:)
      integer :: i, j, level, last, p

      p = gram%lags
      level = gram%terms + 1
      last = level + p + 1
      do j = 1, gram%terms
         do i = 1, j
            gram%matrix(i, j) = s(time0 + i + j - 2)
         end do
         gram%matrix(j, level) = s(time_level + j - 1)
         gram%matrix(j, level + 1:level + p) = first_row(1:p, j + 1)
         gram%matrix(j, last) = first_row(0, j + 1)
      end do
      gram%matrix(level, level) = s(level2)
      gram%matrix(level, level + 1:level + p) = first_row(1:p, 1)
      gram%matrix(level, last) = first_row(0, 1)
      do j = 1, p
         do i = 1, j
            if (i == 1) then
               gram%matrix(level + 1, level + j) = gram%matrix(level + 1, level + j) + first_row(j - 1, 0)
            else
               gram%matrix(level + i, level + j) = gram%matrix(level + i, level + j) + gram%matrix(level + i - 1, level + j - 1)
            end if
         end do
         gram%matrix(level + j, last) = first_row(j, 0)
      end do
      gram%matrix(last, last) = first_row(0, 0)
   end subroutine fill

end module gyroakf_series_lagged_gram
