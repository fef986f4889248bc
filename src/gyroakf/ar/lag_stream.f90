! SPDX-License-Identifier: MIT
!> Autocovariances of a series, or of the residuals of an AR model of it, that arrives in parts: one pass, all lags.
!>
!>     call begin_lag_stream(stream, max_lag, error)
!>     do                                                 ! the parts of the series, in order
!>        call feed_lag_stream(stream, x, valid)
!>     end do
!>     call finish_lag_stream(stream, mean, r, pairs)     ! as compute_autocovariance of the whole
!>
!> Values are taken about a shift near the mean; the sums of the earlier and of the later members of the pairs move them to
!> the mean at the end.
module gyroakf_ar_lag_stream
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_chunks, only : block_length
   use gyroakf_ar_autocovariance, only : add_lagged_products
   implicit none (type, external)
   private
   public :: lag_stream_type, begin_lag_stream, feed_lag_stream, finish_lag_stream

   !> What is remembered from part to part
   type :: lag_stream_type
      private
      integer :: max_lag = -1
      !> Values are taken about it; whether it is known
      real(dp) :: shift = 0.0_dp
      logical :: shifted = .false.
      !> Of the AR model whose residuals these are: [p]
      real(dp), allocatable :: phi(:)
      !> The last p values about the shift and their presence (1 or 0), newest first: [p]
      real(dp), allocatable :: past(:), past_here(:)
      !> Values that went by, of which the first p have no residual
      integer(int64) :: seen = 0
      !> Values or residuals, those present, their sum
      integer(int64) :: samples = 0, present = 0
      real(dp) :: total = 0.0_dp
      !> Over the pairs at each lag: how many, products, later and earlier members: [0:max_lag]
      real(dp), allocatable :: pairs(:), products(:), later(:), earlier(:)
      !> Values and presence of the last max_lag ones and of a block: [1-max_lag:block]
      real(dp), allocatable :: value(:), here(:)
   end type lag_stream_type

contains

   !> Prepares for a series.
   subroutine begin_lag_stream(stream, max_lag, error, phi, centre)
      !> Fresh afterwards
      type(lag_stream_type), intent(out) :: stream
      !> Largest lag, >= 0
      integer, intent(in) :: max_lag
      !> no_memory, invalid_argument
      type(error_type), allocatable, intent(out) :: error
      !> For the residuals of an AR model: its coefficients, [p], and its mean
      real(dp), intent(in), optional :: phi(:)
      real(dp), intent(in), optional :: centre
      integer :: stat, p

      if (max_lag < 0) then
         call fatal_error(error, status%invalid_argument, "the largest lag must not be negative")
         return
      end if
      p = 0
      if (present(phi)) p = size(phi)
      stream%max_lag = max_lag
      allocate (stream%pairs(0:max_lag), stream%products(0:max_lag), stream%later(0:max_lag), stream%earlier(0:max_lag))
      allocate (stream%phi(p), stream%past(p), stream%past_here(p), stream%here(1 - max_lag:block_length))
      allocate (stream%value(1 - max_lag:block_length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the lagged sums")
         return
      end if
      stream%value = 0.0_dp
      stream%here = 0.0_dp
      stream%pairs = 0.0_dp
      stream%products = 0.0_dp
      stream%later = 0.0_dp
      stream%earlier = 0.0_dp
      stream%past = 0.0_dp
      stream%past_here = 0.0_dp
      if (present(phi)) stream%phi(:) = phi
      stream%shifted = present(centre)
      if (present(centre)) stream%shift = centre
   end subroutine begin_lag_stream

   !> Takes in the next part of the series.
   subroutine feed_lag_stream(stream, x, valid)
      !> Of the beginning
      type(lag_stream_type), intent(inout) :: stream
      !> Next samples: [any number], finite
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: first, last
      integer :: n

      do first = 1, size(x, kind=int64), block_length
         last = min(first + block_length - 1, size(x, kind=int64))
         if (present(valid)) then
            call load(stream, x(first:last), n, valid(first:last))
         else
            call load(stream, x(first:last), n)
         end if
         if (n > 0) call add_block(stream, n)
      end do
   end subroutine feed_lag_stream

   !> Values about the shift, or the residuals that they leave, into the block.
   subroutine load(stream, x, n, valid)
      type(lag_stream_type), intent(inout) :: stream
      real(dp), intent(in), contiguous :: x(:)
      !> Values in the block
      integer, intent(out) :: n
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: e, flag, value, here
      integer :: i, j, p

      if (.not. stream%shifted) call find_shift(stream, x, valid)
      p = size(stream%phi)
      if (p == 0) then
         n = size(x)
         stream%here(1:n) = 1.0_dp
         if (present(valid)) stream%here(1:n) = real(valid, dp)
         do i = 1, n
            stream%value(i) = (x(i) - stream%shift)*stream%here(i)
         end do
         return
      end if
      n = 0
      do i = 1, size(x)
         here = 1.0_dp
         if (present(valid)) here = real(valid(i), dp)
         value = (x(i) - stream%shift)*here
         if (stream%seen >= p) then
            e = value - dot_product(stream%phi, stream%past)
            flag = here*product(stream%past_here)
            n = n + 1
            stream%value(n) = e*flag
            stream%here(n) = flag
         end if
         do j = p, 2, -1
            stream%past(j) = stream%past(j - 1)
            stream%past_here(j) = stream%past_here(j - 1)
         end do
         stream%past(1) = value
         stream%past_here(1) = here
         stream%seen = stream%seen + 1
      end do
   end subroutine load

   !> The mean of the first samples that are present; of a constant series its value to the last bit.
   subroutine find_shift(stream, x, valid)
      type(lag_stream_type), intent(inout) :: stream
      real(dp), intent(in), contiguous :: x(:)
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: first, rest
      integer :: i, count

      count = 0
      rest = 0.0_dp
      first = 0.0_dp
      do i = 1, size(x)
         if (present(valid)) then
            if (valid(i) == 0_int8) cycle
         end if
         if (count == 0) first = x(i)
         count = count + 1
         rest = rest + (x(i) - first)
      end do
      stream%shifted = count > 0
      if (count > 0) stream%shift = first + rest/real(count, dp)
   end subroutine find_shift

   !> Adds the block to the sums and keeps its end.
   subroutine add_block(stream, n)
      type(lag_stream_type), intent(inout) :: stream
      !> Values in the block
      integer, intent(in) :: n
      real(dp) :: block_total, edge
      integer :: k, lags

      lags = stream%max_lag
      block_total = sum(stream%value(1:n))
      stream%samples = stream%samples + n
      stream%present = stream%present + nint(sum(stream%here(1:n)), int64)
      stream%total = stream%total + block_total
      call add_lagged_products(stream%value(1:n), stream%value(:n), n, lags, stream%products)
      if (sum(stream%here(:n)) > real(n + lags, dp) - 0.5_dp) then
         edge = 0.0_dp                              ! nothing is missing here nor in the last values before
         do k = 0, lags
            if (k > 0) edge = edge + stream%value(1 - k) - stream%value(n - k + 1)
            stream%pairs(k) = stream%pairs(k) + real(n, dp)
            stream%later(k) = stream%later(k) + block_total
            stream%earlier(k) = stream%earlier(k) + (block_total + edge)
         end do
      else
         call add_lagged_products(stream%here(1:n), stream%here(:n), n, lags, stream%pairs)
         call add_lagged_products(stream%value(1:n), stream%here(:n), n, lags, stream%later)
         call add_lagged_products(stream%here(1:n), stream%value(:n), n, lags, stream%earlier)
      end if
      do k = 1 - lags, 0
         stream%value(k) = stream%value(n + k)
         stream%here(k) = stream%here(n + k)
      end do
   end subroutine add_block

   !> Mean and autocovariances, as [[compute_autocovariance]] and [[residual_autocovariance]] of the whole give them.
   subroutine finish_lag_stream(stream, mean, r, pairs, samples)
      !> After the last sample
      type(lag_stream_type), intent(in) :: stream
      !> Mean of the present values or residuals
      real(dp), intent(out) :: mean
      !> Autocovariances: [0:max_lag]; 0 at a lag without pairs
      real(dp), allocatable, intent(out) :: r(:)
      !> Pairs at each lag: [0:max_lag]
      integer(int64), allocatable, intent(out) :: pairs(:)
      !> Values or residuals, missing ones included
      integer(int64), intent(out), optional :: samples
      real(dp) :: rest, n
      integer :: k

      if (present(samples)) samples = stream%samples
      allocate (r(0:stream%max_lag), pairs(0:stream%max_lag))
      r = 0.0_dp
      pairs = nint(stream%pairs, int64)
      rest = 0.0_dp
      if (stream%present > 0) rest = stream%total/real(stream%present, dp)
      mean = rest
      if (size(stream%phi) == 0) mean = stream%shift + rest
      n = real(stream%samples, dp)
      do k = 0, stream%max_lag
         if (pairs(k) == 0) cycle
         r(k) = stream%products(k) - rest*(stream%later(k) + stream%earlier(k)) + stream%pairs(k)*rest**2
         r(k) = r(k)*((n - real(k, dp))/stream%pairs(k))/n
      end do
      r(0) = max(r(0), 0.0_dp)
   end subroutine finish_lag_stream

end module gyroakf_ar_lag_stream
