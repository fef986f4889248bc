! SPDX-License-Identifier: MIT
!> The drift of a recording that is larger than the memory, identified from its middle part and from block means of the whole as
!> [[identify_drift_model]] does it, and its smoother: a pass of its own, where the memory is enough to hold that part.
!>
!> On its way the pass writes the channels into a scratch file, over which the smoother goes from both ends; without one it ends
!> with the part.
module gyroakf_pipeline_streamed_drift
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : add_text, record_type, view_channel
   use gyroakf_filter_block_stream, only : block_means_type
   use gyroakf_filter_stored_smoother, only : smoother_bytes
   use gyroakf_io_recording, only : base_bytes, bytes_text, close_recording, open_recording, recording_type
   use gyroakf_io_record_stream, only : begin_record_stream, next_record_block, record_stream_type
   use gyroakf_pipeline_drift, only : find_drift
   use gyroakf_pipeline_filter_lane, only : begin_drift_lane, filter_lane_type
   use gyroakf_pipeline_kept_channels, only : begin_keeping, keep_samples, kept_channels_type
   use gyroakf_pipeline_result, only : pipeline_options, pipeline_result_type
   use gyroakf_pipeline_streamed, only : channel_bytes
   use gyroakf_pipeline_streamed_smoother, only : smooth_channel
   implicit none (type, external)
   private
   public :: identify_streamed

   !> Bytes a sample of the part: of every channel, and of the one that is worked on
   integer(int64), parameter :: kept_bytes = 9, work_bytes = 17

   !> The middle part of the record
   type :: part_type
      !> Samples before it, and in it
      integer(int64) :: before = 0, samples = 0
      !> [sample, channel]
      real(dp), allocatable :: value(:, :)
      !> [sample, channel]; allocated where something is missing in the record
      integer(int8), allocatable :: present(:, :)
   end type part_type

contains

   !> Identifies the drift of every channel and makes its filters; where the memory does not allow it the channels say so.
   subroutine identify_streamed(recording, record, columns, differences, means, options, lane, result, kept, error, progress, &
                                scratch)
      !> Its path and options are used
      type(recording_type), intent(in) :: recording
      !> What was read, without the samples
      type(record_type), intent(in) :: record
      !> Of the columns that are read those that hold numbers: [channel]
      integer, intent(in) :: columns(:)
      !> Variance of the differences: [channel]
      real(dp), intent(in) :: differences(:)
      !> Of the series less its mean: [channel]
      type(block_means_type), intent(in) :: means(:)
      !> Of the main job
      type(pipeline_options), intent(in) :: options
      !> Get the drift's filters: [channel]
      type(filter_lane_type), intent(inout) :: lane(:)
      !> Its channels are told the drift
      type(pipeline_result_type), intent(inout) :: result
      !> The channels, and beside those whose `available%drift_smoother` is set their smoothed drift; to be ended by the caller
      type(kept_channels_type), intent(out) :: kept
      !> no_memory, cancelled, and what reading can give
      type(error_type), allocatable, intent(out) :: error
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      !> Directory of a scratch file; without it there is no smoother
      character(*), intent(in), optional :: scratch
      type(part_type) :: part
      integer(int64) :: needed
      integer :: k

      part%samples = min(record%audit%samples, options%identification%most)
      part%before = (record%audit%samples - part%samples)/2
      needed = base_bytes + channel_bytes*size(lane) + max(part%samples*(kept_bytes*size(lane) + work_bytes), &
                                                           smoother_bytes(record%audit%samples))
      if (recording%options%memory < needed) then
         do k = 1, size(lane)
            call add_text(result%channel(k)%unavailable, "drift and its filters: to identify it from a part of the record "// &
                          "takes "//bytes_text(needed)//" of memory")
         end do
         return
      end if
      if (present(scratch)) call begin_keeping(kept, record%audit%samples, scratch)
      call hold_part(recording, record, columns, part, kept, error, progress)
      if (allocated(error)) return
      do k = 1, size(lane)
         call identify_channel(record, part, k, differences(k), means(k), options, lane(k), result, error)
         if (allocated(error)) return
      end do
      deallocate (part%value)
      if (allocated(part%present)) deallocate (part%present)
      call smooth_channels(kept, differences, options, result, error, progress)
   end subroutine identify_streamed

   !> The smoother of every channel that has a drift, or why there is none.
   subroutine smooth_channels(kept, differences, options, result, error, progress)
      type(kept_channels_type), intent(in) :: kept
      real(dp), intent(in) :: differences(:)
      type(pipeline_options), intent(in) :: options
      type(pipeline_result_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      integer :: k

      do k = 1, size(result%channel)
         if (.not. result%channel(k)%drift%found) cycle
         if (kept%works) then
            call smooth_channel(kept, k, differences(k), options, result%channel(k), error, progress)
            if (allocated(error)) return
         else if (allocated(kept%problem)) then
            call add_text(result%channel(k)%unavailable, "drift smoother: "//kept%problem)
         else
            call add_text(result%channel(k)%unavailable, "drift smoother: a streamed record needs a scratch file for it")
         end if
      end do
   end subroutine smooth_channels

   !> Reads the file again for the part, and all of it where the channels are kept.
   subroutine hold_part(recording, record, columns, part, kept, error, progress)
      type(recording_type), intent(in) :: recording
      type(record_type), intent(in) :: record
      integer, intent(in) :: columns(:)
      !> Its place is known
      type(part_type), intent(inout) :: part
      !> Gets the samples while it works
      type(kept_channels_type), intent(inout) :: kept
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(recording_type) :: again
      type(record_stream_type) :: stream
      type(record_type) :: block
      integer(int64) :: before
      integer :: failed

      allocate (part%value(part%samples, size(columns)), stat=failed)
      if (failed == 0 .and. record%audit%missing > 0) allocate (part%present(part%samples, size(columns)), stat=failed)
      if (failed /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the part of the record that tells the drift")
         return
      end if
      part%value = 0.0_dp
      call open_recording(recording%path, recording%options, again, error)
      if (.not. allocated(error)) call begin_record_stream(again, stream, record%sample_interval)
      do while (.not. allocated(error))
         before = stream%delivered
         if (before >= part%before + part%samples .and. .not. kept%works) exit
         call next_record_block(again, stream, block, error, progress)
         if (allocated(error) .or. stream%done) exit
         call keep_samples(kept, block, columns, before)
         call keep_block(block, columns, before, part)
      end do
      call close_recording(again)
   end subroutine hold_part

   !> Keeps what a block has of the part.
   subroutine keep_block(block, columns, before, part)
      type(record_type), intent(in) :: block
      integer, intent(in) :: columns(:)
      !> Samples before the block
      integer(int64), intent(in) :: before
      type(part_type), intent(inout) :: part
      integer(int64) :: first, last, shift
      integer :: k

      first = max(1_int64, part%before - before + 1)
      last = min(size(block%value, 1, kind=int64), part%before + part%samples - before)
      shift = before - part%before
      if (first > last) return
      do k = 1, size(columns)
         part%value(first + shift:last + shift, k) = block%value(first:last, columns(k))
         if (.not. allocated(part%present)) cycle
         part%present(first + shift:last + shift, k) = 1_int8
         if (allocated(block%present)) part%present(first + shift:last + shift, k) = block%present(first:last, columns(k))
      end do
   end subroutine keep_block

   !> The drift of one channel and its filters.
   subroutine identify_channel(record, part, k, difference_variance, means, options, lane, result, error)
      type(record_type), intent(in) :: record
      !> Its values lose the mean
      type(part_type), intent(inout) :: part
      integer, intent(in) :: k
      real(dp), intent(in) :: difference_variance
      !> Of the whole channel
      type(block_means_type), intent(in) :: means
      type(pipeline_options), intent(in) :: options
      type(filter_lane_type), intent(inout) :: lane
      type(pipeline_result_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: view
      integer(int64) :: i

      do i = 1, part%samples
         part%value(i, k) = part%value(i, k) - result%channel(k)%level%mean
      end do
      call view_channel(record, k, view)
      if (allocated(part%present)) then
         call find_drift(part%value(:, k), view%sample_interval, view%rate_known, view%unit, options, result%channel(k), &
                         error, part%present(:, k), means=means)
      else
         call find_drift(part%value(:, k), view%sample_interval, view%rate_known, view%unit, options, result%channel(k), &
                         error, means=means)
      end if
      if (allocated(error)) return
      call begin_drift_lane(lane, difference_variance, record%audit%samples, options, result%channel(k), error)
   end subroutine identify_channel

end module gyroakf_pipeline_streamed_drift
