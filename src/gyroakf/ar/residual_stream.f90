! SPDX-License-Identifier: MIT
!> Residuals of an AR model of a series that arrives in parts: their autocovariances and moments, as [[analyse_residuals]] of the
!> whole gives them.
module gyroakf_ar_residual_stream
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_chunks, only : block_length
   use gyroakf_ar_lag_stream, only : lag_stream_type, begin_lag_stream, feed_lag_stream, finish_lag_stream
   use gyroakf_ar_residual_block, only : residual_block
   use gyroakf_series_moments, only : moments_type, compute_moments, join_moments
   implicit none (type, external)
   private
   public :: residual_stream_type, begin_residual_stream, feed_residual_stream, finish_residual_stream

   !> What is remembered from part to part
   type :: residual_stream_type
      private
      !> Coefficients: [p]; mean of the series
      real(dp), allocatable :: phi(:)
      real(dp) :: mean = 0.0_dp
      !> The last p samples, oldest first, and their marks: [p]; how many there were
      real(dp), allocatable :: past(:)
      integer(int8), allocatable :: past_valid(:)
      integer(int64) :: seen = 0
      type(lag_stream_type) :: lags
      type(moments_type) :: moments
   end type residual_stream_type

contains

   !> Prepares for a series.
   subroutine begin_residual_stream(stream, max_lag, mean, phi, error)
      !> Fresh afterwards
      type(residual_stream_type), intent(out) :: stream
      !> Largest lag, >= 0
      integer, intent(in) :: max_lag
      !> Mean and coefficients of the model
      real(dp), intent(in) :: mean, phi(:)
      !> no_memory, invalid_argument
      type(error_type), allocatable, intent(out) :: error

      stream%mean = mean
      stream%phi = phi
      allocate (stream%past(size(phi)), stream%past_valid(size(phi)))
      stream%past = mean
      stream%past_valid = 0_int8
      call begin_lag_stream(stream%lags, max_lag, error, centre=0.0_dp)
   end subroutine begin_residual_stream

   !> Takes in the next part.
   subroutine feed_residual_stream(stream, x, valid)
      !> Of the beginning
      type(residual_stream_type), intent(inout) :: stream
      !> Next samples: [any number], finite
      real(dp), intent(in), contiguous :: x(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      integer(int64) :: first, last

      do first = 1, size(x, kind=int64), block_length
         last = min(first + block_length - 1, size(x, kind=int64))
         if (present(valid)) then
            call feed_block(stream, x(first:last), valid(first:last))
         else
            call feed_block(stream, x(first:last))
         end if
      end do
   end subroutine feed_residual_stream

   !> A part that fits the cache.
   subroutine feed_block(stream, x, valid)
      !> Of the beginning
      type(residual_stream_type), intent(inout) :: stream
      !> Next samples
      real(dp), intent(in) :: x(:)
      !> 1 present, 0 missing
      integer(int8), intent(in), optional :: valid(:)
      real(dp) :: samples(size(stream%phi) + size(x)), e(size(x)), flag(size(x))
      integer(int8) :: marks(size(stream%phi) + size(x)), rows(size(x))
      type(moments_type) :: next
      integer :: p, begin

      p = size(stream%phi)
      samples = [stream%past, x]
      marks(:p) = stream%past_valid
      marks(p + 1:) = 1_int8
      if (present(valid)) marks(p + 1:) = valid
      call residual_block(samples, stream%mean, stream%phi, 0.0_dp, int(p + 1, int64), e, flag, marks)
      stream%past = samples(size(x) + 1:)
      stream%past_valid = marks(size(x) + 1:)
      begin = int(min(max(p - stream%seen, 0_int64), size(x, kind=int64))) + 1      ! the first p samples have no residual
      stream%seen = stream%seen + size(x, kind=int64)
      rows = nint(flag, int8)
      if (begin > size(x)) return
      if (all(rows(begin:) == 1_int8)) then
         call feed_lag_stream(stream%lags, e(begin:))
         call compute_moments(e(begin:), next)
      else
         call feed_lag_stream(stream%lags, e(begin:), rows(begin:))
         call compute_moments(e(begin:), next, rows(begin:))
      end if
      call join_moments(stream%moments, next)
   end subroutine feed_block

   !> The sums of the whole.
   subroutine finish_residual_stream(stream, r, pairs, samples, moments)
      !> After the last sample
      type(residual_stream_type), intent(in) :: stream
      !> Autocovariances and pairs: [0:max_lag]
      real(dp), allocatable, intent(out) :: r(:)
      integer(int64), allocatable, intent(out) :: pairs(:)
      !> Residuals, missing ones included
      integer(int64), intent(out) :: samples
      !> Their moments
      type(moments_type), intent(out) :: moments
      real(dp) :: mean

      call finish_lag_stream(stream%lags, mean, r, pairs, samples)
      moments = stream%moments
   end subroutine finish_residual_stream

end module gyroakf_ar_residual_stream
