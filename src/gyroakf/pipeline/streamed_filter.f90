! SPDX-License-Identifier: MIT
!> The filters over a recording that is larger than the memory: one pass for the model, one for the drift, one that filters.
!>
!> The first pass sums moments, autocovariances, differences and blocks; the AR model and the filters are made of them. Where the
!> memory allows it a second looks for the drift in the middle part and keeps the channels in a scratch file, over which the
!> smoother goes from both ends. The last filters block by block, hands the series on and measures what the filters
!> did. All of them give what [[run_pipeline]] gives of the record in memory, but for rounding.
module gyroakf_pipeline_streamed_filter
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : record_type
   use gyroakf_io_recording, only : base_bytes, bytes_text, close_recording, open_recording, recording_type, say_too_large
   use gyroakf_io_record_stream, only : begin_record_stream, end_record_stream, next_record_block, record_stream_type
   use gyroakf_io_record_summary, only : find_interval
   use gyroakf_series_differences, only : variance_of_differences
   use gyroakf_ar_lag_stream, only : finish_lag_stream
   use gyroakf_ar_model, only : fit_ar_of
   use gyroakf_filter_block_stream, only : block_means_type, finish_block_stream
   use gyroakf_pipeline_channel_sums, only : begin_channel_sums, channel_sums_type, feed_channel_sums
   use gyroakf_pipeline_filter_lane, only : begin_lane, feed_lane, filter_lane_type, finish_lane, free_block
   use gyroakf_pipeline_kept_channels, only : end_keeping, kept_channels_type
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_pipeline_series_sink, only : series_sink_type
   use gyroakf_pipeline_streamed, only : channel_bytes, scale_moments
   use gyroakf_pipeline_streamed_drift, only : identify_streamed
   use gyroakf_pipeline_streamed_smoother, only : read_smoothed
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: filter_streamed, check_filter

contains

   !> Filters the rest of a recording: AR model, Kalman and adaptive Kalman filter of every channel.
   subroutine filter_streamed(recording, options, record, result, error, sink, progress, scratch)
      !> Open, some rows may be held already; a file, for it is read again
      type(recording_type), intent(inout) :: recording
      !> Filters only, no cleaning
      type(pipeline_options), intent(in) :: options
      !> What was read, without the samples
      type(record_type), intent(out) :: record
      !> One entry per channel; without the drift and its filters where they take more memory
      type(pipeline_result_type), intent(out) :: result
      !> no_memory (options that need the whole record, a pipe), too_few_samples, cancelled, and what reading can give
      type(error_type), allocatable, intent(out) :: error
      !> Takes the series, if somebody wants them
      class(series_sink_type), intent(inout), optional :: sink
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      !> Directory with room for 16 bytes a sample and channel, in a file that is gone when the work ends, however it ends; without
      !> it, and where it cannot be written, there is no drift smoother
      character(*), intent(in), optional :: scratch
      type(kept_channels_type) :: kept
      type(filter_lane_type), allocatable :: lane(:)
      real(dp), allocatable :: differences(:)
      type(block_means_type), allocatable :: means(:)
      integer, allocatable :: columns(:)

      call check_filter(recording, options, error)
      if (allocated(error)) return
      call first_pass(recording, options, record, result, lane, columns, differences, means, error, progress)
      if (allocated(error)) return
      call identify_streamed(recording, record, columns, differences, means, options, lane, result, kept, error, progress, scratch)
      if (.not. allocated(error)) call second_pass(recording, record, columns, kept, lane, result, error, sink, progress)
      call end_keeping(kept)
      if (allocated(error)) return
      call finish_lanes(lane, result, error)
   end subroutine filter_streamed

   !> What cannot be done block by block says what it would need; [[filter_streamed]] asks it first.
   subroutine check_filter(recording, options, error)
      !> Open
      type(recording_type), intent(in) :: recording
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> no_memory
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what, large
      integer(int64) :: least

      call say_too_large(recording, large)
      what = ""
      if (options%clean%method /= "none") what = "--outliers"
      if (options%clean%degree >= 0) what = "--detrend"
      if (options%identification%source /= "record") what = "--drift-source "//trim(options%identification%source)
      if (options%identification%degree > 0) what = "--drift-degree"
      if (options%ar%method /= "yw") what = "--ar-method "//trim(options%ar%method)
      least = base_bytes + channel_bytes*size(recording%table%chosen)
      if (what /= "") then
         call fatal_error(error, status%no_memory, large//new_line("a")//"without "//what//" the recording is "// &
                          "filtered as it is read; or give more memory")
      else if (recording%expected_rows == 0) then
         call fatal_error(error, status%no_memory, large//new_line("a")//"a recording as large as this is "// &
                          "filtered in two passes, and standard input or a pipe comes only once: write it to a file first, "// &
                          "or give more memory")
      else if (recording%options%memory < least) then
         call fatal_error(error, status%no_memory, large//new_line("a")//"to stream it takes "//bytes_text(least))
      end if
   end subroutine check_filter

   !> Sums over the recording, the model and the filters of every channel.
   subroutine first_pass(recording, options, record, result, lane, columns, differences, means, error, progress)
      type(recording_type), intent(inout) :: recording
      type(pipeline_options), intent(in) :: options
      type(record_type), intent(out) :: record
      type(pipeline_result_type), intent(inout) :: result
      !> Filters, ready for the first sample
      type(filter_lane_type), allocatable, intent(out) :: lane(:)
      !> Of the columns that are read those that hold numbers
      integer, allocatable, intent(out) :: columns(:)
      !> Variance of the differences: [channel]
      real(dp), allocatable, intent(out) :: differences(:)
      !> Of the series less its mean: [channel]
      type(block_means_type), allocatable, intent(out) :: means(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(record_stream_type) :: stream
      type(channel_sums_type), allocatable :: sums(:)
      real(dp) :: interval, factor
      integer :: c, k

      call find_interval(recording, interval, error, progress)
      if (allocated(error)) return
      if (interval > 0.0_dp) then
         call begin_record_stream(recording, stream, interval)
      else
         call begin_record_stream(recording, stream)
      end if
      call sum_blocks(recording, stream, options, sums, error, progress)
      if (allocated(error)) return
      call end_record_stream(recording, stream, record, error)
      if (allocated(error)) return
      factor = 1.0_dp                                   ! increments were divided by the interval known at the beginning
      if (stream%input /= "rate") factor = stream%interval/record%sample_interval
      columns = pack([(c, c=1, size(stream%holds))], stream%holds)
      result%duration = real(record%audit%samples, dp)*record%sample_interval
      allocate (result%channel(size(columns)), lane(size(columns)), differences(size(columns)), means(size(columns)))
      do k = 1, size(columns)
         result%channel(k)%name = record%channel(k)%text
         call model_channel(sums(columns(k)), record%audit%samples, factor, options, result, k, error)
         if (allocated(error)) return
         call finish_block_stream(sums(columns(k))%blocks, factor, result%channel(k)%level%mean, means(k), error)
         if (allocated(error)) return
         differences(k) = factor**2*variance_of_differences(sums(columns(k))%differences)
         call begin_lane(lane(k), differences(k), record%audit%samples, options, result%channel(k), error)
         if (allocated(error)) return
      end do
   end subroutine first_pass

   !> Feeds every block to the sums of every channel.
   subroutine sum_blocks(recording, stream, options, sums, error, progress)
      type(recording_type), intent(inout) :: recording
      type(record_stream_type), intent(inout) :: stream
      type(pipeline_options), intent(in) :: options
      type(channel_sums_type), allocatable, intent(out) :: sums(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(record_type) :: block
      integer :: c

      allocate (sums(size(recording%table%chosen)))
      do c = 1, size(sums)
         call begin_channel_sums(sums(c), max(0, options%ar%max_order, options%ar%order), error)
         if (allocated(error)) return
      end do
      do
         call next_record_block(recording, stream, block, error, progress)
         if (allocated(error) .or. stream%done) return
         do c = 1, size(sums)
            call feed_channel_sums(sums(c), block, c, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine sum_blocks

   !> Moments and the AR model of one channel.
   subroutine model_channel(sums, samples, factor, options, result, k, error)
      type(channel_sums_type), intent(in) :: sums
      !> Of the record
      integer(int64), intent(in) :: samples
      !> The series is so many times what was summed
      real(dp), intent(in) :: factor
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(inout) :: result
      !> The channel
      integer, intent(in) :: k
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: r(:)
      integer(int64), allocatable :: pairs(:)
      real(dp) :: mean

      associate (channel => result%channel(k))
         call scale_moments(sums%moments, factor, channel%raw)
         channel%cleaned = channel%raw
         channel%level = channel%raw
         channel%clean%mean = channel%raw%mean
         channel%clean%variance = channel%raw%variance
         call finish_lag_stream(sums%lags, mean, r, pairs)
         r = factor**2*r
         call fit_ar_of(r, samples, pairs, factor*mean, options%ar, channel%ar, error)
         if (is_fatal(error)) return
         channel%available%ar = .not. allocated(error)
         call note_failure(channel, "AR model", error)
      end associate
   end subroutine model_channel

   !> Reads the file again and filters it.
   subroutine second_pass(recording, record, columns, kept, lane, result, error, sink, progress)
      !> Done; its path and options are used
      type(recording_type), intent(in) :: recording
      type(record_type), intent(in) :: record
      integer, intent(in) :: columns(:)
      !> Holds the smoothed drift
      type(kept_channels_type), intent(in) :: kept
      type(filter_lane_type), intent(inout) :: lane(:)
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      class(series_sink_type), intent(inout), optional :: sink
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: again
      type(record_stream_type) :: stream

      call open_recording(recording%path, recording%options, again, error)
      if (.not. allocated(error)) then
         call begin_record_stream(again, stream, record%sample_interval, "filtering")
         call filter_blocks(again, stream, record, columns, kept, lane, result, error, sink, progress)
      end if
      call close_recording(again)
      if (allocated(error)) return
      if (stream%delivered /= record%audit%samples) call fatal_error(error, status%io, recording%path// &
         ": has changed while it was read"//new_line("a")//"wait until its recording has ended")
   end subroutine second_pass

   !> Feeds every block to the filters of every channel, and hands the series on.
   subroutine filter_blocks(again, stream, record, columns, kept, lane, result, error, sink, progress)
      type(recording_type), intent(inout) :: again
      type(record_stream_type), intent(inout) :: stream
      type(record_type), intent(in) :: record
      integer, intent(in) :: columns(:)
      !> Holds the smoothed drift
      type(kept_channels_type), intent(in) :: kept
      type(filter_lane_type), intent(inout) :: lane(:)
      type(pipeline_result_type), intent(in) :: result
      type(error_type), allocatable, intent(out) :: error
      class(series_sink_type), intent(inout), optional :: sink
      class(progress_type), intent(inout), optional :: progress
      type(record_type) :: block
      type(pipeline_result_type) :: part
      integer(int64) :: before
      integer :: k

      allocate (part%channel(size(lane)))
      do k = 1, size(lane)
         part%channel(k)%name = result%channel(k)%name
         part%channel(k)%available = result%channel(k)%available
      end do
      do
         before = stream%delivered
         call next_record_block(again, stream, block, error, progress)
         if (allocated(error) .or. stream%done) return
         if (size(block%value, 1) == 0) cycle
         if (stream%delivered > record%audit%samples) return           ! the file has grown
         do k = 1, size(lane)
            if (allocated(block%present)) then
               call feed_lane(lane(k), block%value(:, columns(k)), part%channel(k), error, block%present(:, columns(k)))
            else
               call feed_lane(lane(k), block%value(:, columns(k)), part%channel(k), error)
            end if
            if (allocated(error)) return
         end do
         if (present(sink)) then
            do k = 1, size(lane)
               if (.not. result%channel(k)%available%drift_smoother) cycle
               call read_smoothed(kept, k, before, block%value(:, columns(k)), result%channel(k), part%channel(k), error)
               if (allocated(error)) return
            end do
            call keep_columns(block, columns)
            block%channel = record%channel
            call sink%take(block, part, before, record%audit%samples, error)
            if (allocated(error)) return
         end if
         do k = 1, size(lane)                 ! blocks differ in length: nothing stays between them, the heap grows else
            call free_block(lane(k), part%channel(k))
         end do
      end do
   end subroutine filter_blocks

   !> Leaves the columns that hold numbers.
   subroutine keep_columns(block, columns)
      type(record_type), intent(inout) :: block
      integer, intent(in) :: columns(:)

      if (size(columns) == size(block%value, 2)) return
      block%value = block%value(:, columns)
      if (allocated(block%present)) block%present = block%present(:, columns)
   end subroutine keep_columns

   !> What the filters did.
   subroutine finish_lanes(lane, result, error)
      type(filter_lane_type), intent(inout) :: lane(:)
      type(pipeline_result_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      do k = 1, size(lane)
         call finish_lane(lane(k), result%channel(k), error)
         if (allocated(error)) return
      end do
   end subroutine finish_lanes

end module gyroakf_pipeline_streamed_filter
