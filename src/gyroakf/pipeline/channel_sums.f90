! SPDX-License-Identifier: MIT
!> Everything that the first pass over a recording sums of a channel: moments, autocovariances, differences, blocks.
module gyroakf_pipeline_channel_sums
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_series_differences, only : difference_stream_type, feed_differences
   use gyroakf_series_moments, only : compute_moments, join_moments, moments_type
   use gyroakf_ar_lag_stream, only : begin_lag_stream, feed_lag_stream, lag_stream_type
   use gyroakf_filter_block_stream, only : block_stream_type, feed_block_stream
   implicit none (type, external)
   private
   public :: channel_sums_type, begin_channel_sums, feed_channel_sums

   !> Sums of one channel so far
   type :: channel_sums_type
      type(moments_type) :: moments
      type(lag_stream_type) :: lags
      type(difference_stream_type) :: differences
      type(block_stream_type) :: blocks
   end type channel_sums_type

contains

   !> Prepares the sums of a channel.
   subroutine begin_channel_sums(sums, lags, error)
      !> Fresh afterwards
      type(channel_sums_type), intent(out) :: sums
      !> The longest lag of the autocovariances
      integer, intent(in) :: lags
      !> invalid_argument, no_memory
      type(error_type), allocatable, intent(out) :: error

      call begin_lag_stream(sums%lags, lags, error)
   end subroutine begin_channel_sums

   !> Adds the samples that a block has of a channel.
   subroutine feed_channel_sums(sums, block, c, error)
      !> Of the channel
      type(channel_sums_type), intent(inout) :: sums
      !> May be empty
      type(record_type), intent(in) :: block
      !> Its column
      integer, intent(in) :: c
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: part

      if (size(block%value, 1) == 0) return
      if (allocated(block%present)) then
         call compute_moments(block%value(:, c), part, block%present(:, c))
         call feed_lag_stream(sums%lags, block%value(:, c), block%present(:, c))
         call feed_differences(sums%differences, block%value(:, c), block%present(:, c))
         call feed_block_stream(sums%blocks, block%value(:, c), error, block%present(:, c))
      else
         call compute_moments(block%value(:, c), part)
         call feed_lag_stream(sums%lags, block%value(:, c))
         call feed_differences(sums%differences, block%value(:, c))
         call feed_block_stream(sums%blocks, block%value(:, c), error)
      end if
      call join_moments(sums%moments, part)
   end subroutine feed_channel_sums

end module gyroakf_pipeline_channel_sums
