! SPDX-License-Identifier: MIT
!> Sums over the complete rows of an AR regression: the t for which x_t .. x_(t-p) are present.
!>
!> The Gram matrix of a row needs (p + 1)^2 sums; only C(0,j) touch the data. With the rows a .. b of a stretch without gaps
!> the others follow exactly from its ends,
!> $$C_{i+1,j+1} = C_{ij} + x_{a-1-i} x_{a-1-j} - x_{b-i} x_{b-j},$$
!> so that all orders up to p come from one pass in O(n p) time and O(p^2) memory. x is the series about its mean.
module gyroakf_ar_complete_rows
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_chunks, only : chunk_group, block_length, threads_from, chunk_count, chunk_first, chunk_last
   use gyroakf_stats_autocovariance, only : add_lagged_products
   implicit none (type, external)
   private
   public :: row_gram_type, build_row_gram, load_rows

   !> Sums over the rows
   type :: row_gram_type
      !> Lags p, rows
      integer :: lags = 0
      integer(int64) :: rows = 0
      !> sum x_(t-i) x_(t-j): [0:lags, 0:lags], both triangles; sum x_(t-j): [0:lags]
      real(dp), allocatable :: matrix(:, :), total(:)
   end type row_gram_type

contains

   !> Builds the Gram matrix.
   subroutine build_row_gram(x, shift, rest, lags, gram, error, valid, progress)
      !> Series: [n], finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted in turn: the mean as series_mean gives it
      real(dp), intent(in) :: shift, rest
      !> Lags p, >= 0
      integer, intent(in) :: lags
      !> The sums; no rows where nothing is long enough
      type(row_gram_type), intent(out) :: gram
      !> no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: partial(:, :), edge(:)
      integer :: chunks, j, stat

      chunks = chunk_count(size(x, kind=int64))
      gram%lags = lags
      allocate (gram%matrix(0:lags, 0:lags), stat=stat)
      if (stat == 0) allocate (gram%total(0:lags), stat=stat)
      if (stat == 0) allocate (edge(0:lags), stat=stat)
      if (stat == 0) allocate (partial(0:lags + 2, chunks), stat=stat)
      if (stat == 0) call sum_rows(x, shift, rest, lags, partial, stat, error, valid, progress)
      if (allocated(error)) return
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the sums of the AR regression")
         return
      end if
      gram%matrix = 0.0_dp
      edge = 0.0_dp
      call add_edges(x, shift, rest, gram, edge, valid)
      gram%matrix(0, :) = sum(partial(0:lags, :), 2)
      gram%total(0) = sum(partial(lags + 1, :))
      gram%rows = nint(sum(partial(lags + 2, :)), int64)
      do j = 1, lags
         gram%total(j) = gram%total(j - 1) + edge(j)
         gram%matrix(1:j, j) = gram%matrix(1:j, j) + gram%matrix(0:j - 1, j - 1)
      end do
      do j = 0, lags
         gram%matrix(j + 1:, j) = gram%matrix(j, j + 1:)
      end do
   end subroutine build_row_gram

   !> The pass: products of x_t with all lags, sum of x_t, number of rows.
   subroutine sum_rows(x, shift, rest, lags, partial, stat, error, valid, progress)
      !> Series, subtracted in turn, lags
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      integer, intent(in) :: lags
      !> Products: [0:lags], sum, rows; [0:lags + 2, chunk]
      real(dp), intent(out) :: partial(0:, :)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: y(:), a(:), weight(:)
      integer(int64) :: n, first, step
      integer :: chunk, bad, m, from, group

      n = size(x, kind=int64)
      step = max(block_length, 4*int(lags, int64))
      stat = 0
      group = chunk_group(size(partial, 2), present(progress))
      do from = 1, size(partial, 2), group
         call tell_progress("rows of the AR model", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel if (n >= threads_from) default(shared) private(y, a, weight, first, bad, m)
         allocate (y(1 - lags:step), stat=bad)
         if (bad == 0) allocate (a(step), stat=bad)
         if (bad == 0) allocate (weight(step), stat=bad)
         !$omp atomic
         stat = stat + bad
         !$omp do schedule(dynamic)
         do chunk = from, min(from + group - 1, size(partial, 2))
            partial(:, chunk) = 0.0_dp
            if (bad /= 0) cycle
            do first = max(chunk_first(n, chunk), int(lags, int64) + 1), chunk_last(n, chunk), step
               m = int(min(step, chunk_last(n, chunk) - first + 1))
               call load_rows(x, shift, rest, lags, first, m, y, weight, valid)
               a(:m) = y(1:m)*weight(:m)
               call add_lagged_products(a, y, m, lags, partial(0:lags, chunk))
               partial(lags + 1, chunk) = partial(lags + 1, chunk) + sum(a(:m))
               partial(lags + 2, chunk) = partial(lags + 2, chunk) + sum(weight(:m))
            end do
         end do
         !$omp end do
         if (allocated(y)) deallocate (y)
         if (allocated(a)) deallocate (a)
         if (allocated(weight)) deallocate (weight)
         !$omp end parallel
      end do
   end subroutine sum_rows

   !> Samples first-lags .. first+m-1 about the mean, 0 where missing, and which of them end a complete row.
   pure subroutine load_rows(x, shift, rest, lags, first, m, y, weight, valid)
      !> Series, subtracted in turn
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> Lags, first row (1-based, > lags), how many rows there could be
      integer, intent(in) :: lags, m
      integer(int64), intent(in) :: first
      !> Samples with their past; 1 where a complete row ends, 0 elsewhere: [m]
      real(dp), intent(inout) :: y(1 - lags:), weight(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer :: i, run

      do i = 1 - lags, m
         y(i) = (x(first + i - 1) - shift) - rest
      end do
      weight(:m) = 1.0_dp
      if (.not. present(valid)) return
      run = 0
      do i = 1 - lags, m
         run = run + 1
         if (valid(first + i - 1) == 0_int8) then
            run = 0
            y(i) = 0.0_dp
         end if
         if (i >= 1) weight(i) = merge(1.0_dp, 0.0_dp, run > lags)
      end do
   end subroutine load_rows

   !> What the ends of every stretch without gaps change from a lag to the next.
   subroutine add_edges(x, shift, rest, gram, edge, valid)
      !> Series, subtracted in turn
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> Its matrix gets the changes of the products
      type(row_gram_type), intent(inout) :: gram
      !> Changes of the sums: [0:lags]
      real(dp), intent(inout) :: edge(0:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: n, begin, finish

      n = size(x, kind=int64)
      if (.not. present(valid)) then
         if (n > gram%lags) call add_ends(x, shift, rest, 1_int64, n, gram, edge)
         return
      end if
      finish = 0
      do
         begin = finish + 1
         do while (begin <= n)
            if (valid(begin) /= 0_int8) exit
            begin = begin + 1
         end do
         if (begin > n) exit
         finish = begin
         do while (finish < n)
            if (valid(finish + 1) == 0_int8) exit
            finish = finish + 1
         end do
         if (finish - begin >= gram%lags) call add_ends(x, shift, rest, begin, finish, gram, edge)
      end do
   end subroutine add_edges

   !> The ends of one stretch.
   pure subroutine add_ends(x, shift, rest, begin, finish, gram, edge)
      !> Series, subtracted in turn
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: shift, rest
      !> First and last sample of the stretch, 1-based
      integer(int64), intent(in) :: begin, finish
      !> Gets the changes
      type(row_gram_type), intent(inout) :: gram
      real(dp), intent(inout) :: edge(0:)
      real(dp) :: head(gram%lags), tail(gram%lags)
      integer :: i, j

      do j = 1, gram%lags
         head(j) = (x(begin + gram%lags - j) - shift) - rest
         tail(j) = (x(finish - j + 1) - shift) - rest
      end do
      do j = 1, gram%lags
         edge(j) = edge(j) + (head(j) - tail(j))
         do i = 1, j
            gram%matrix(i, j) = gram%matrix(i, j) + (head(i)*head(j) - tail(i)*tail(j))
         end do
      end do
   end subroutine add_ends

end module gyroakf_ar_complete_rows
