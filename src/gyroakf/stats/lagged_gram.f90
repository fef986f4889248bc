! SPDX-License-Identifier: MIT
!> Gram matrix of the Dickey-Fuller regression from one pass over the series.
!>
!> The regression of d_t = y_t - y_(t-1) on powers of the time, the level y_(t-1) and d_(t-1) .. d_(t-p)
!> needs (p + 4)^2/2 sums over the rows. Only C(0,j) = sum d_t d_(t-j) and a dozen more touch the
!> data; with a .. b the rows of a stretch without gaps the others follow exactly from its ends:
!> $$C_{i+1,j+1} = C_{ij} + d_{a-1-i} d_{a-1-j} - d_{b-i} d_{b-j}$$
!> $$\sum y_{t-1} d_{t-1-j} = \sum y_{t-1} d_{t-j} + C_{0j} + y_{a-1} d_{a-1-j} - y_b d_{b-j}$$
!> and the sums with powers of the time likewise. Time O(n p), memory O(p^2). y is the series less its
!> trend: the statistic does not feel that, but without it an offset would cost all digits. With fewer lags there are more rows:
!> they are added one by one at the beginning of every stretch, without another pass.
module gyroakf_stats_lagged_gram
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_trend, only : trend_type, subtract_trend
   use gyroakf_stats_shared_autocovariance, only : autocovariance_type
   use gyroakf_stats_lagged_rows, only : row_sums_type, sum_rows, time_of, level2, level_d, time0, time_level, time_d
   implicit none (type, external)
   private
   public :: gram_type, build_gram, shorten_gram

   !> Sums of products over the rows of the regression
   type :: gram_type
      !> Powers of the time (0 .. 3), lags of the difference
      integer :: terms = 0, lags = 0
      !> Rows: t for which y_t .. y_(t-lags-1) are present
      integer(int64) :: rows = 0
      !> Powers of the time, level, lags 1 .. lags, difference: [terms + lags + 2, same]; upper triangle
      real(dp), allocatable :: matrix(:, :)
   end type gram_type

   !> Stretches without gaps between two reports of progress
   integer(int64), parameter :: report_stretches = 1024

contains

   !> Builds the Gram matrix.
   subroutine build_gram(x, trend, terms, lags, gram, error, valid, shared, progress)
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
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Autocovariances that are made on the way
      type(autocovariance_type), intent(inout), optional :: shared
      !> Progress callback
      class(progress_type), intent(inout), optional :: progress
      type(row_sums_type) :: s
      real(dp) :: first_row(0:lags, 0:4)
      integer :: k, stat

      k = terms + lags + 2
      gram%terms = terms
      gram%lags = lags
      allocate (gram%matrix(k, k), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums of the unit-root regression")
         return
      end if
      call sum_rows(x, trend, terms, lags, s, error, valid, shared, progress)
      if (allocated(error)) return
      gram%matrix = 0.0_dp
      gram%rows = nint(s%other(time0), int64)
      first_row = 0.0_dp
      first_row(:, 0) = s%lagged
      first_row(0, 1) = s%other(level_d)
      first_row(0, 2:4) = s%other(time_d:time_d + 2)
      call extend(x, trend, terms, lags, first_row, gram%matrix, error, valid, progress)
      if (allocated(error)) return
      call fill(gram, first_row, s%other)
   end subroutine build_gram

   !> The matrix with fewer lags from that with more: its rows are those and the first ones of every stretch.
   subroutine shorten_gram(x, trend, lags, gram, error, valid, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Fewer lags
      integer, intent(in) :: lags
      !> With more lags; with `lags` afterwards
      type(gram_type), intent(inout) :: gram
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback, used where it takes a pass
      class(progress_type), intent(inout), optional :: progress
      type(gram_type) :: longer
      integer(int64) :: n, begin, finish
      real(dp) :: work
      integer :: k, terms

      n = size(x, kind=int64)
      k = gram%terms + lags + 2
      work = 0.5_dp*real(gram%lags - lags, dp)*real(k, dp)*real(k, dp)
      if (present(valid)) work = work*real(count_runs(valid), dp)
      call move_alloc(gram%matrix, longer%matrix)
      longer%lags = gram%lags
      if (work > real(n, dp)*real(k + 16, dp)) then                   ! many gaps: another pass is quicker
         terms = gram%terms
         call build_gram(x, trend, terms, lags, gram, error, valid, progress=progress)
         return
      end if
      allocate (gram%matrix(k, k))
      gram%matrix(:k - 1, :k - 1) = longer%matrix(:k - 1, :k - 1)
      gram%matrix(:k - 1, k) = longer%matrix(:k - 1, size(longer%matrix, 2))
      gram%matrix(k, :) = 0.0_dp
      gram%matrix(k, k) = longer%matrix(size(longer%matrix, 1), size(longer%matrix, 2))
      gram%lags = lags
      begin = 0
      do while (begin < n)
         finish = n - 1
         if (present(valid)) call next_run(valid, begin, finish)
         finish = min(finish, begin + longer%lags)
         if (finish - begin >= lags + 1) call add_rows(x, trend, begin, finish, gram)
         begin = finish + 1
         if (.not. present(valid)) exit
         do while (begin < n)
            if (valid(begin + 1) == 0_int8) exit
            begin = begin + 1
         end do
      end do
   end subroutine shorten_gram

   !> Number of stretches without gaps.
   pure integer(int64) function count_runs(valid)
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in) :: valid(:)
      integer(int64) :: i

      count_runs = 0
      do i = 2, size(valid, kind=int64)
         if (valid(i) /= 0_int8 .and. valid(i - 1) == 0_int8) count_runs = count_runs + 1
      end do
      if (size(valid, kind=int64) > 0) then
         if (valid(1) /= 0_int8) count_runs = count_runs + 1
      end if
   end function count_runs

   !> Adds the products of the rows begin + lags + 1 .. finish, one after the other.
   subroutine add_rows(x, trend, begin, finish, gram)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> 0-based; all samples from begin to finish are present
      integer(int64), intent(in) :: begin, finish
      !> The matrix
      type(gram_type), intent(inout) :: gram
      real(dp) :: y(0:finish - begin), row(size(gram%matrix, 1))
      integer :: t, j, p, base

      p = gram%lags
      base = gram%terms + 1
      y = x(begin + 1:finish + 1)
      call subtract_trend(trend, begin, y)
      do t = p + 1, int(finish - begin)
         do j = 1, gram%terms
            row(j) = time_of(begin + t, size(x, kind=int64))**(j - 1)
         end do
         row(base) = y(t - 1)
         do j = 1, p
            row(base + j) = y(t - j) - y(t - j - 1)
         end do
         row(base + p + 1) = y(t) - y(t - 1)
         do j = 1, size(row)
            gram%matrix(:j, j) = gram%matrix(:j, j) + row(:j)*row(j)
         end do
         gram%rows = gram%rows + 1
      end do
   end subroutine add_rows

   !> Extends the sums of lag 0 to all lags by the ends of every stretch without gaps.
   subroutine extend(x, trend, terms, lags, first_row, matrix, error, valid, progress)
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
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: edge(0:lags, 4), delta
      integer(int64) :: n, begin, finish, stretch
      integer :: j

      n = size(x, kind=int64)
      delta = 2.0_dp/real(n, dp)
      edge = 0.0_dp
      begin = 0
      stretch = 0
      do while (begin < n)
         stretch = stretch + 1
         if (mod(stretch, report_stretches) == 0) call tell_progress("unit-root test", begin, n, error, progress)
         if (allocated(error)) return
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

end module gyroakf_stats_lagged_gram
