! SPDX-License-Identifier: MIT
!> Factor of a Dickey-Fuller regression: of its Gram matrix, of its rows where that lost digits.
!>
!> The columns are scaled to length 1; the last one is the difference y. The regression with the
!> first i columns leaves \(\sum_{j>i} R_{jk}^2\), k the last column, without cancellation.
module gyroakf_series_adf_factor
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : check_memory, error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, report_progress
   use gyroakf_lapack, only : dpotrf, dgeqrf
   use gyroakf_stats_trend, only : trend_type, subtract_trend
   use gyroakf_stats_lagged_gram, only : gram_type
   use gyroakf_stats_lagged_rows, only : time_of
   implicit none (type, external)
   private
   public :: factor_regression

   !> A diagonal element of the factor of the scaled matrix below this has lost half of its digits
   real(dp), parameter :: smallest_pivot = 1.0e-7_dp
   !> The same of the rows themselves: nothing is left
   real(dp), parameter :: no_pivot = 1.0e-12_dp
   !> What is left is rounding of the samples: so many times epsilon of the largest
   real(dp), parameter :: rounding_factor = 8.0_dp
   !> Rows times columns squared that the orthogonal factor may take: about half a minute
   real(dp), parameter :: most_work = 5.0e10_dp

contains

   !> The factor of the columns in an order, from the Gram matrix or the rows.
   subroutine factor_regression(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from it
      type(trend_type), intent(in) :: trend
      !> Terms, lags and products of the columns
      type(gram_type), intent(in) :: gram
      !> Place in the matrix of each column, the difference last: [columns]
      integer, intent(in) :: order(:)
      !> Rounding of a sample
      real(dp), intent(in) :: rounding
      !> The factor in the upper triangle, with a positive diagonal: [columns, columns]
      real(dp), allocatable, intent(out) :: r(:, :)
      !> Lengths of the columns
      real(dp), intent(out) :: scale(:)
      !> singular, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback, used where the factor comes from the rows
      class(progress_type), intent(inout), optional :: progress
      integer :: i, j, k
      logical :: ready

      k = size(order)
      allocate (r(k, k), stat=i)
      call check_memory(i, "the factor of the unit-root regression", error)
      if (allocated(error)) return
      r = 0.0_dp
      do j = 1, k
         do i = 1, j
            r(i, j) = gram%matrix(min(order(i), order(j)), max(order(i), order(j)))
         end do
      end do
      call factor_gram(r, scale, ready)
      if (.not. ready) call factor_rows(x, trend, gram, order, rounding, r, scale, error, valid, &
         & progress)
   end subroutine factor_regression

   !> Cholesky factor of the matrix scaled to a unit diagonal, in place.
   subroutine factor_gram(matrix, scale, ready)
      real(dp), intent(inout), contiguous :: matrix(:, :)
      real(dp), intent(out) :: scale(:)
      logical, intent(out) :: ready
      integer :: j, k, info

      k = size(matrix, 1)
      do j = 1, k
         scale(j) = sqrt(max(matrix(j, j), 0.0_dp))
      end do
      ready = all(scale > 0.0_dp)
      if (.not. ready) return
      do j = 1, k
         matrix(:j, j) = matrix(:j, j)/scale(j)/scale(:j)
      end do
      call dpotrf("U", k, matrix, k, info)
      ready = info == 0
      do j = 1, k
         if (ready) ready = matrix(j, j) >= smallest_pivot
      end do
   end subroutine factor_gram

   !> The factor from the rows, by orthogonal transformations block by block (LAPACK dgeqrf on what
   !> came before and the next rows): twice the digits, and times the columns the work.
   subroutine factor_rows(x, trend, gram, order, rounding, r, scale, error, valid, progress)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      type(gram_type), intent(in) :: gram
      integer, intent(in) :: order(:)
      real(dp), intent(in) :: rounding
      real(dp), intent(out) :: r(:, :)
      real(dp), intent(in) :: scale(:)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      class(progress_type), intent(inout), optional :: progress
      integer(int64) :: n, first, last
      real(dp) :: mean(size(r, 1)), lost
      integer :: i, k

      n = size(x, kind=int64)
      k = size(r, 1)
      mean = 0.0_dp
      if (gram%terms > 0) mean(gram%terms + 1:) = gram%matrix(1, order(gram%terms + 1:)) &
         & /gram%matrix(1, 1)
      if (.not. all(scale > 0.0_dp) .or. real(n, dp)*real(k, dp)**2 > most_work) call fail(error)
      if (allocated(error)) return
      r = 0.0_dp
      do first = gram%lags + 1, n - 1, max(256, 2*k)
         call report_progress("unit-root test", first, n, error, progress)
         if (allocated(error)) return
         last = min(first + max(256, 2*k) - 1, n - 1)
         call join_rows(x, trend, gram, order, first, last, scale, mean, r, error, valid)
         if (allocated(error)) return
      end do
      ! columns less their means were factored; the constant, the first of them, takes these back
      r(1, 2:) = r(1, 2:) + r(1, 1)*scale(1)*mean(2:)/scale(2:)
      do i = 1, k
         if (r(i, i) < 0.0_dp) r(i, i:) = -r(i, i:)
         if (i < k .and. r(i, i) < no_pivot) call fail(error)
         if (allocated(error)) return
      end do
      ! what the rounding of the samples leaves of the last column, or that of the transformations
      lost = max(rounding, epsilon(1.0_dp)*scale(k))
      if (r(k, k)*scale(k) <= rounding_factor*lost*sqrt(real(gram%rows, dp))) call fail(error)
   end subroutine factor_rows

   subroutine fail(error)
      type(error_type), allocatable, intent(out) :: error

      call fatal_error(error, status%singular, "the ADF regression is singular: the series is " &
         & //"predicted perfectly by its own past or by its trend; try fewer lags")
   end subroutine fail

   !> The factor of some rows below a factor.
   subroutine join_rows(x, trend, gram, order, first, last, scale, mean, r, error, valid)
      real(dp), intent(in), contiguous :: x(:)
      type(trend_type), intent(in) :: trend
      type(gram_type), intent(in) :: gram
      integer, intent(in) :: order(:)
      !> 0-based rows, first > lags
      integer(int64), intent(in) :: first, last
      !> Lengths of the columns; means, taken out so that a common part costs no digits
      real(dp), intent(in) :: scale(:), mean(:)
      real(dp), intent(inout) :: r(:, :)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in), optional :: valid(:)
      real(dp), allocatable :: a(:, :), y(:), row(:), tau(:), work(:)
      integer :: t, j, k, m, p, run, base, info

      k = size(r, 1)
      p = gram%lags
      base = gram%terms + 1
      allocate (y(-p - 1:int(last - first)), row(k), tau(k), work(64*k))
      allocate (a(k + int(last - first) + 1, k), stat=info)
      call check_memory(info, "rows of the unit-root regression", error)
      if (allocated(error)) return
      y(:) = x(first - p:last + 1)
      call subtract_trend(trend, first - p - 1, y)
      a(:k, :) = r
      m = k
      run = 0
      do t = -p - 1, int(last - first)
         run = run + 1
         if (present(valid)) then
            if (valid(first + t + 1) == 0_int8) run = 0
         end if
         if (t < 0 .or. run < p + 2) cycle
         row(:gram%terms) = [(time_of(first + t, size(x, kind=int64))**(j - 1), j=1, gram%terms)]
         row(base) = y(t - 1)
         row(base + 1:) = [(y(t - j) - y(t - j - 1), j=1, p), y(t) - y(t - 1)]
         m = m + 1
         a(m, :) = (row(order) - mean)/scale
      end do
      call dgeqrf(m, k, a, size(a, 1), tau, work, size(work), info)
      do j = 1, k
         r(:j, j) = a(:j, j)
      end do
   end subroutine join_rows

end module gyroakf_series_adf_factor
