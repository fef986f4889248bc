! SPDX-License-Identifier: MIT
!> Lagged sums of a series: the one implementation for AR models, Ljung-Box, ADF and identification.
!>
!> Every lag comes from a single pass over the series: blocks with the mean removed are copied into
!> a buffer that stays in the cache, eight lags at a time run over it. Memory O(max_lag) per thread.
!> Partial sums follow a fixed partition (gyroakf_chunks), not the threads.
module gyroakf_stats_autocovariance
   use, intrinsic :: ieee_arithmetic, only : ieee_is_finite
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length, threads_from, chunk_count, chunk_first, chunk_last, chunk_group
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_stats_lagged_products, only : add_lagged_products
   use gyroakf_stats_residual_block, only : residual_block
   implicit none (type, external)
   private
   public :: compute_autocovariance, add_lagged_products, series_mean

contains

   !> Autocovariances of a series at the lags 0 .. max_lag.
   !>
   !> $$r_k = \frac{1}{n} \sum_{t=k}^{n-1} (x_t - \bar x)(x_{t-k} - \bar x)$$
   !> the biased form, whose Toeplitz matrix is positive definite. With missing samples the mean is that of
   !> the present ones and $$r_k = \frac{n-k}{n}\,\frac{1}{m_k}\sum (x_t - \bar x)(x_{t-k} - \bar x)$$ over the
   !> m_k pairs that are present, 0 where there is none; positive definiteness is then not guaranteed.
   !> Source: Brockwell & Davis, Time Series: Theory and Methods (1991), 7.2; Parzen (1963) for gaps.
   subroutine compute_autocovariance(x, max_lag, mean, r, error, valid, pairs, progress)
      !> Series: [n], any unit u, finite; not modified
      real(dp), intent(in), contiguous :: x(:)
      !> Largest lag, 0 .. n-1
      integer, intent(in) :: max_lag
      !> Mean of the present samples, u
      real(dp), intent(out) :: mean
      !> Autocovariances: [0:max_lag], u^2; r(0) is 0 where the series is constant, which is no error
      real(dp), allocatable, intent(out) :: r(:)
      !> invalid_argument (max_lag < 0, size of valid), too_few_samples, non_finite, no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Number of present pairs at each lag: [0:max_lag]
      integer(int64), allocatable, intent(out), optional :: pairs(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp) :: shift, rest
      integer(int64) :: count

      mean = 0.0_dp
      call check_series(x, max_lag, error, valid)
      if (allocated(error)) return
      call series_mean(x, shift, rest, count, valid)
      mean = shift + rest
      if (count < 1) then
         call fatal_error(error, status%too_few_samples, "every sample of the series is missing")
      else if (.not. ieee_is_finite(mean)) then
         call fatal_error(error, status%non_finite, "the series has a value that is not finite")
      else
         call covariances(x, shift, rest, max_lag, r, error, valid, pairs, progress)
      end if
   end subroutine compute_autocovariance

   !> Refuses a lag or a mask that does not fit the series.
   subroutine check_series(x, max_lag, error, valid)
      !> Series
      real(dp), intent(in) :: x(:)
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
      else if (size(x, kind=int64) < int(max_lag, int64) + 1) then
         write (text, '("lag ", i0, " needs at least ", i0, " samples, there are ", i0)') max_lag, &
            & int(max_lag, int64) + 1, size(x, kind=int64)
         call fatal_error(error, status%too_few_samples, trim(text))
      else if (present(valid)) then
         if (size(valid, kind=int64) /= size(x, kind=int64)) then
            call fatal_error(error, status%invalid_argument, "the mask and the series differ in length")
         end if
      end if
   end subroutine check_series

   !> Mean of the present samples as the sum of two numbers, the first present sample and the mean
   !> distance from it. Subtracting both in turn keeps the digits that their sum would round off where
   !> the series has a large offset.
   subroutine series_mean(x, shift, rest, count, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> First present sample, 0 where there is none
      real(dp), intent(out) :: shift
      !> Mean of x - shift
      real(dp), intent(out) :: rest
      !> Number of present samples
      integer(int64), intent(out) :: count
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: i

      shift = 0.0_dp
      do i = 1, size(x, kind=int64)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         shift = x(i)
         exit
      end do
      call mean_about(x, shift, rest, count, valid)
   end subroutine series_mean

   !> Mean of x - centre.
   subroutine mean_about(x, centre, mean, count, valid)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: centre
      !> Mean, 0 where there is none
      real(dp), intent(out) :: mean
      !> How many there are
      integer(int64), intent(out) :: count
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: total(chunk_count(size(x, kind=int64))), number(chunk_count(size(x, kind=int64)))
      real(dp) :: e(block_length), flag(block_length), no_phi(0)
      integer(int64) :: n, first, length
      integer :: chunk

      n = size(x, kind=int64)
      !$omp parallel do if (n >= threads_from) default(shared) private(e, flag, first, length) schedule(dynamic)
      do chunk = 1, chunk_count(n)
         total(chunk) = 0.0_dp
         number(chunk) = 0.0_dp
         do first = chunk_first(n, chunk), chunk_last(n, chunk), block_length
            length = min(block_length, chunk_last(n, chunk) - first + 1)
            call residual_block(x, centre, no_phi, 0.0_dp, first, e(:length), flag(:length), valid)
            total(chunk) = total(chunk) + sum_of(e(:length))
            number(chunk) = number(chunk) + sum_of(flag(:length))
         end do
      end do
      !$omp end parallel do
      count = nint(sum(number), int64)
      mean = 0.0_dp
      if (count > 0) mean = sum(total)/real(count, dp)
   end subroutine mean_about

   !> Sum of a block.
   pure real(dp) function sum_of(values) result(total)
      !> Values
      real(dp), intent(in), contiguous :: values(:)
      integer :: i

      total = 0.0_dp
      !$omp simd reduction(+:total)
      do i = 1, size(values)
         total = total + values(i)
      end do
   end function sum_of

   !> The pass over the series: lagged sums of every chunk, added in order, and divided.
   subroutine covariances(x, centre, offset, max_lag, r, error, valid, pairs, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      !> Subtracted from every sample first: near the mean of the series
      real(dp), intent(in) :: centre
      !> Subtracted last
      real(dp), intent(in) :: offset
      !> Largest lag
      integer, intent(in) :: max_lag
      !> Autocovariances: [0:max_lag]
      real(dp), allocatable, intent(out) :: r(:)
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Pairs: [0:max_lag]
      integer(int64), allocatable, intent(out), optional :: pairs(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: partial(:, :), number(:, :)
      real(dp) :: m
      integer(int64) :: n
      integer :: chunk, chunks, k, stat

      n = size(x, kind=int64)
      chunks = chunk_count(n)
      allocate (r(0:max_lag), stat=stat)
      if (stat == 0) allocate (partial(0:max_lag, chunks), stat=stat)
      if (stat == 0) allocate (number(0:max_lag, merge(chunks, 0, present(valid))), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the lagged sums")
         return
      end if
      if (present(pairs)) allocate (pairs(0:max_lag))
      call sum_chunks(x, centre, offset, max_lag, partial, number, stat, error, valid, progress)
      if (allocated(error)) return
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the buffers of the lagged sums")
         return
      end if
      do k = 0, max_lag
         r(k) = 0.0_dp
         m = real(n - k, dp)
         if (present(valid)) m = sum(number(k, :))
         do chunk = 1, chunks
            r(k) = r(k) + partial(k, chunk)
         end do
         if (m > 0.0_dp) r(k) = r(k)*(real(n - k, dp)/m)/real(n, dp)
         if (present(pairs)) pairs(k) = nint(m, int64)
      end do
   end subroutine covariances

   !> Lagged sums of every chunk.
   subroutine sum_chunks(x, centre, offset, max_lag, partial, number, stat, error, valid, progress)
      !> Series: [n]
      real(dp), intent(in), contiguous :: x(:)
      real(dp), intent(in) :: centre, offset
      !> Largest lag
      integer, intent(in) :: max_lag
      !> Sums of products: [0:max_lag, chunk]
      real(dp), intent(out) :: partial(0:, :)
      !> Pairs: [0:max_lag, chunk], no column without gaps
      real(dp), intent(out) :: number(0:, :)
      !> Not 0 where memory is short
      integer, intent(out) :: stat
      !> cancelled
      type(error_type), allocatable, intent(out) :: error
      !> 1 present, 0 missing: [n]
      integer(int8), intent(in), optional :: valid(:)
      !> Progress callback; may cancel
      class(progress_type), intent(inout), optional :: progress
      real(dp), allocatable :: e(:), flag(:)
      real(dp) :: no_phi(0)
      integer(int64) :: n, first, step
      integer :: chunk, bad, length, from, group

      n = size(x, kind=int64)
      step = max(block_length, 2*int(max_lag, int64))
      stat = 0
      group = chunk_group(size(partial, 2), present(progress))
      do from = 1, size(partial, 2), group
         call tell_progress("autocovariances", chunk_first(n, from) - 1, n, error, progress)
         if (allocated(error)) return
         !$omp parallel if (n >= threads_from) default(shared) private(e, flag, first, length, bad)
         allocate (e(1 - max_lag:step), stat=bad)
         if (bad == 0) allocate (flag(1 - max_lag:step), stat=bad)
         !$omp atomic
         stat = stat + bad
         !$omp do schedule(dynamic)
         do chunk = from, min(from + group - 1, size(partial, 2))
            if (bad /= 0) cycle
            partial(:, chunk) = 0.0_dp
            if (present(valid)) number(:, chunk) = 0.0_dp
            do first = chunk_first(n, chunk), chunk_last(n, chunk), step
               length = int(min(step, chunk_last(n, chunk) - first + 1))
               call residual_block(x, centre, no_phi, offset, first - max_lag, e(:length), flag(:length), valid)
               call add_lagged_products(e(1:), e, length, max_lag, partial(:, chunk))
               if (present(valid)) call add_lagged_products(flag(1:), flag, length, max_lag, number(:, chunk))
            end do
         end do
         !$omp end do
         if (allocated(e)) deallocate (e)
         if (allocated(flag)) deallocate (flag)
         !$omp end parallel
      end do
   end subroutine sum_chunks

end module gyroakf_stats_autocovariance
