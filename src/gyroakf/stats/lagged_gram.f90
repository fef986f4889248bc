! SPDX-License-Identifier: MIT
!> Gram matrix of a regression on lags (Dickey-Fuller, AR by least squares) from one pass.
!>
!> The regression of d_t = y_t - y_(t-1) on powers of the time, the level y_(t-1) and d_(t-1) ..
!> d_(t-p) (AR: of d_t = y_t on a constant and d_(t-1) .. d_(t-p)) needs (p + 4)^2/2 sums over the
!> rows. Only C(0,j) = sum d_t d_(t-j) and a dozen more touch the data; with a .. b the rows of a
!> stretch without gaps the others follow exactly from its ends: $$C_{i+1,j+1} = C_{ij} + d_{a-1-i}
!> d_{a-1-j} - d_{b-i} d_{b-j}$$ $$\sum y_{t-1} d_{t-1-j} = \sum y_{t-1} d_{t-j} + C_{0j} + y_{a-1}
!> d_{a-1-j} - y_b d_{b-j}$$ and the sums with powers of the time likewise. Time O(n p), memory
!> O(p^2). y is the series less its trend: the statistic does not feel that, but without it an
!> offset would cost all digits. With fewer lags there are more rows: they are added one by one at
!> the beginning of every stretch, without another pass.
module gyroakf_stats_lagged_gram
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_stats_trend, only : trend_type, subtract_trend
   use gyroakf_stats_autocovariance, only : autocovariance_type
   use gyroakf_stats_lagged_rows, only : sum_rows, sums, time_of, level2, level_d, time0, &
      & time_level, time_d
   implicit none (type, external)
   private
   public :: gram_type, build_gram, shorten_gram

   !> Sums of products over the rows of the regression
   type :: gram_type
      !> Powers of the time (0 .. 3), lags of the difference
      integer :: terms = 0, lags = 0
      !> Columns of the level: 1 with differences, 0 where the lags are those of the series itself
      integer :: levels = 1
      !> Rows: t for which y_t .. y_(t-lags-levels) are present
      integer(int64) :: rows = 0
      !> Powers of the time, level, lags 1 .. lags, d_t; upper triangle
      real(dp), allocatable :: matrix(:, :)
   end type gram_type

   !> Stretches without gaps between two reports of progress
   integer(int64), parameter :: report_stretches = 1024

contains

   !> Builds the Gram matrix.
   subroutine build_gram(x, trend, terms, levels, lags, gram, error, valid, shared, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Powers of the time, 0 .. 3; columns of the level, 1 with differences and 0 without
      integer, intent(in) :: terms, levels
      !> Lags, 0 .. n - 1 - levels
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
      real(dp) :: first_row(0:lags, 0:4), other(sums)

      gram%terms = terms
      gram%levels = levels
      call new_matrix(lags, gram, error)
      if (.not. allocated(error)) call sum_rows(x, trend, terms, lags, lags + levels, &
         & first_row(:, 0), other, error, valid, shared, progress)
      if (allocated(error)) return
      gram%rows = nint(other(time0), int64)
      first_row(:, 1:) = 0.0_dp
      first_row(0, 1) = other(level_d)
      first_row(0, 2:4) = other(time_d:time_d + 2)
      call extend(x, trend, gram, first_row, error, valid, progress)
      if (.not. allocated(error)) call fill(gram, first_row, other)
   end subroutine build_gram

   subroutine new_matrix(lags, gram, error)
      integer, intent(in) :: lags
      type(gram_type), intent(inout) :: gram
      type(error_type), allocatable, intent(out) :: error
      integer :: k, stat

      gram%lags = lags
      k = gram%terms + gram%levels + lags + 1
      allocate (gram%matrix(k, k), stat=stat)
      call check_memory(stat, "the sums of a regression on lags", error)
      if (.not. allocated(error)) gram%matrix = 0.0_dp
   end subroutine new_matrix

   !> The matrix with fewer lags: it has also the first rows of every stretch.
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
      integer :: k, last

      if (lags == gram%lags) return
      n = size(x, kind=int64)
      k = gram%terms + gram%levels + lags + 1
      work = 0.0_dp
      finish = -1
      do
         call next_run(n, begin, finish, valid)
         if (begin >= n) exit
         work = work + 0.5_dp*real(gram%lags - lags, dp)*real(k, dp)*real(k, dp)
      end do
      longer = gram_type(gram%terms, gram%lags, gram%levels)
      call move_alloc(gram%matrix, longer%matrix)
      if (work > real(n, dp)*real(k + 16, dp)) then           ! many gaps: another pass is quicker
         call build_gram(x, trend, longer%terms, longer%levels, lags, gram, error, valid, &
            & progress=progress)
         return
      end if
      call new_matrix(lags, gram, error)
      if (allocated(error)) return
      last = size(longer%matrix, 1)
      gram%matrix(:k - 1, :k - 1) = longer%matrix(:k - 1, :k - 1)
      gram%matrix(:k - 1, k) = longer%matrix(:k - 1, last)
      gram%matrix(k, k) = longer%matrix(last, last)
      finish = -1
      do
         call next_run(n, begin, finish, valid)
         if (begin >= n) exit
         call add_rows(x, trend, begin, min(finish, begin + longer%lags + gram%levels - 1), gram)
      end do
   end subroutine shorten_gram

   !> Adds the products of the rows begin + lags + 1 .. finish, one after the other.
   subroutine add_rows(x, trend, begin, finish, gram)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      !> 0-based; all samples from begin to finish are present
      integer(int64), intent(in) :: begin, finish
      type(gram_type), intent(inout) :: gram
      real(dp) :: y(0:finish - begin), row(size(gram%matrix, 1)), differ
      integer :: t, j, k

      k = size(row)
      differ = real(gram%levels, dp)
      y = x(begin + 1:finish + 1)
      call subtract_trend(trend, begin, y)
      do t = gram%lags + gram%levels, int(finish - begin)
         do j = 1, gram%terms
            row(j) = time_of(begin + t, size(x, kind=int64))**(j - 1)
         end do
         if (gram%levels > 0) row(gram%terms + 1) = y(t - 1)
         do j = 0, gram%lags
            row(merge(k - gram%lags + j - 1, k, j > 0)) = y(t - j) - differ*y(max(t - j - 1, 0))
         end do
         do j = 1, size(row)
            gram%matrix(:j, j) = gram%matrix(:j, j) + row(:j)*row(j)
         end do
         gram%rows = gram%rows + 1
      end do
   end subroutine add_rows

   !> Extends the sums of lag 0 to all lags by the ends of every stretch without gaps.
   subroutine extend(x, trend, gram, first_row, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      !> Its matrix gets the corrections of sum d_(t-i) d_(t-j), in the place of lag i+1, j+1
      type(gram_type), intent(inout) :: gram
      !> sum d_t d_(t-j), y_(t-1) d_(t-j), time^k d_(t-j), k = 0 .. 2; j = 0 known: [0:lags, 0:4]
      real(dp), intent(inout) :: first_row(0:, 0:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: edge(0:gram%lags, 4), delta
      integer(int64) :: n, begin, finish, stretch
      character(14) :: stage
      integer :: j

      n = size(x, kind=int64)
      stage = merge("unit-root test", "AR model      ", gram%levels > 0)
      delta = 2.0_dp/real(n, dp)
      edge = 0.0_dp
      finish = -1
      stretch = 0
      do
         stretch = stretch + 1
         if (mod(stretch, report_stretches) == 0) call report_progress(trim(stage), finish, n, &
            & error, progress)
         if (allocated(error)) return
         call next_run(n, begin, finish, valid)
         if (begin >= n) exit
         if (finish - begin >= gram%lags + gram%levels) call add_ends(x, trend, begin, finish, &
            & edge, gram)
      end do
      do j = 0, gram%lags - 1
         first_row(j + 1, 1) = first_row(j, 1) + first_row(j, 0) + edge(j, 1)
         first_row(j + 1, 2) = first_row(j, 2) + edge(j, 2)
         first_row(j + 1, 3) = first_row(j, 3) + delta*first_row(j, 2) + edge(j, 3)
         first_row(j + 1, 4) = first_row(j, 4) &
            & + delta*(2.0_dp*first_row(j, 3) + delta*first_row(j, 2)) + edge(j, 4)
      end do
   end subroutine extend

   !> The next stretch of present samples.
   pure subroutine next_run(n, begin, finish, valid)
      integer(int64), intent(in) :: n
      !> 0-based: its first sample, n where there is none
      integer(int64), intent(out) :: begin
      !> Last sample of the stretch before, -1 at first; then of this one
      integer(int64), intent(inout) :: finish
      integer(int8), intent(in), optional :: valid(:)

      begin = finish + 1
      finish = n - 1
      if (.not. present(valid)) return
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
   pure subroutine add_ends(x, trend, begin, finish, edge, gram)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      !> 0-based first and last sample of the stretch; its rows are begin + lags + levels .. finish
      integer(int64), intent(in) :: begin, finish
      !> Corrections of the sums with y_(t-1) and with the powers of the time
      real(dp), intent(inout) :: edge(0:, :)
      type(gram_type), intent(inout) :: gram
      real(dp), dimension(0:gram%lags + 1) :: head, tail
      real(dp), dimension(0:max(gram%lags - 1, 0)) :: d0, d1
      real(dp) :: t0, t1, differ
      integer :: j, lags, reach, base

      lags = gram%lags
      if (lags < 1) return
      reach = lags + gram%levels
      base = gram%terms + gram%levels
      differ = real(gram%levels, dp)
      head(:reach - 1) = x(begin + 1:begin + reach)
      call subtract_trend(trend, begin, head(:reach - 1))
      tail(:reach) = x(finish - reach + 1:finish + 1)
      call subtract_trend(trend, finish - reach, tail(:reach))
      do j = 0, lags - 1
         d0(j) = head(reach - 1 - j) - differ*head(max(reach - 2 - j, 0))
         d1(j) = tail(reach - j) - differ*tail(reach - 1 - j)
      end do
      t0 = time_of(begin + reach, size(x, kind=int64))
      t1 = time_of(finish + 1, size(x, kind=int64))
      do j = 0, lags - 1
         edge(j, :) = edge(j, :) + [head(reach - 1), 1.0_dp, t0, t0*t0]*d0(j) &
            & - [tail(reach), 1.0_dp, t1, t1*t1]*d1(j)
         associate (column => gram%matrix(base + 1:base + 1 + j, base + 1 + j))
            column = column + (d0(:j)*d0(j) - d1(:j)*d1(j))
         end associate
      end do
   end subroutine add_ends

   !> Puts the sums in their places.
   subroutine fill(gram, first_row, s)
      !> Its matrix holds the corrections of the lags
      type(gram_type), intent(inout) :: gram
      real(dp), intent(in) :: first_row(0:, 0:), s(:)
      integer :: j, level, base, last

      level = gram%terms + 1
      base = gram%terms + gram%levels
      last = base + gram%lags + 1
      do j = 1, gram%terms
         gram%matrix(:j, j) = s(time0 + j - 1:time0 + 2*(j - 1))
         gram%matrix(j, base + 1:) = cshift(first_row(:, j + 1), 1)
      end do
      if (gram%levels > 0) then
         gram%matrix(:gram%terms, level) = s(time_level:time_level + gram%terms - 1)
         gram%matrix(level, level) = s(level2)
         gram%matrix(level, base + 1:) = cshift(first_row(:, 1), 1)
      end if
      do j = 1, gram%lags
         associate (column => gram%matrix(base + 1:base + j, base + j))
            column(1) = column(1) + first_row(j - 1, 0)
            column(2:) = column(2:) + gram%matrix(base + 1:base + j - 1, base + j - 1)
         end associate
      end do
      gram%matrix(base + 1:, last) = cshift(first_row(:, 0), 1)
   end subroutine fill

end module gyroakf_stats_lagged_gram
