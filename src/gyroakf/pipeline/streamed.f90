! SPDX-License-Identifier: MIT
!> Allan curves and coefficients of a recording that is larger than the memory: one pass, block by block.
module gyroakf_pipeline_streamed
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type
   use gyroakf_record, only : add_text, record_type, view_channel
   use gyroakf_io_recording, only : base_bytes, bytes_text, recording_type, say_too_large
   use gyroakf_io_record_stream, only : begin_record_stream, end_record_stream, next_record_block, record_stream_type
   use gyroakf_io_record_summary, only : find_interval
   use gyroakf_series_moments, only : compute_moments, join_moments, moments_type
   use gyroakf_allan_stream, only : allan_stream_type, begin_allan_stream, feed_allan_stream, finish_allan_stream
   use gyroakf_pipeline_coefficients, only : fit_curve
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options, pipeline_result_type, stage, stage_names
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure, warn_fit
   implicit none (type, external)
   private
   public :: run_streamed, scale_moments, channel_bytes

   !> What the blocks of a channel take
   integer(int64), parameter :: channel_bytes = 4000000

   !> One channel in the stream
   type :: lane_type
      type(allan_stream_type) :: allan
      type(moments_type) :: moments
   end type lane_type

contains

   !> Reads the rest of a recording and analyses it: the curve of the series as read, its coefficients, moments.
   subroutine run_streamed(recording, options, record, result, error, progress)
      !> Open, some rows may be held already
      type(recording_type), intent(inout) :: recording
      !> Allan analysis only, no cleaning, no further kinds
      type(pipeline_options), intent(in) :: options
      !> What was read, without the samples
      type(record_type), intent(out) :: record
      !> One entry per channel
      type(pipeline_result_type), intent(out) :: result
      !> no_memory (options that need the whole record), too_few_samples, cancelled, and what reading can give
      type(error_type), allocatable, intent(out) :: error
      !> Is told the bytes that were read
      class(progress_type), intent(inout), optional :: progress
      type(record_stream_type) :: stream
      real(dp) :: interval
      type(lane_type), allocatable :: lane(:)

      call check_streamable(recording, options, error)
      if (allocated(error)) return
      call find_interval(recording, interval, error, progress)
      if (allocated(error)) return
      if (interval > 0.0_dp) then
         call begin_record_stream(recording, stream, interval)
      else
         call begin_record_stream(recording, stream)
      end if
      call read_lanes(recording, stream, options, lane, error, progress)
      if (.not. allocated(error)) call end_record_stream(recording, stream, record, error)
      if (.not. allocated(error)) call finish_lanes(stream, lane, options, record, result, error)
   end subroutine run_streamed

   !> What cannot be done block by block says what it would need.
   subroutine check_streamable(recording, options, error)
      type(recording_type), intent(in) :: recording
      type(pipeline_options), intent(in) :: options
      !> not_supported, no_memory
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: what, large
      integer(int64) :: least

      call say_too_large(recording, large)
      what = ""
      if (options%clean%method /= "none") what = "--outliers"
      if (options%clean%degree >= 0) what = "--detrend"
      if (allocated(options%other_kinds)) what = "--kinds"
      if (options%dynamic_segments > 0) what = "--dynamic"
      if (allocated(options%allan%taus)) then
         if (options%allan%taus == "all") what = "--taus all"
      end if
      if (what /= "") then
         call fatal_error(error, status%no_memory, large//new_line("a")//"without "//what//" the recording is "// &
                          "streamed; or give more memory")
         return
      end if
      least = base_bytes + channel_bytes*size(recording%table%chosen)
      if (recording%options%memory < least) call fatal_error(error, status%no_memory, large//new_line("a")// &
         "to stream it takes "//bytes_text(least))
   end subroutine check_streamable

   !> Feeds every block to every channel.
   subroutine read_lanes(recording, stream, options, lane, error, progress)
      type(recording_type), intent(inout) :: recording
      type(record_stream_type), intent(inout) :: stream
      type(pipeline_options), intent(in) :: options
      type(lane_type), allocatable, intent(out) :: lane(:)
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(record_type) :: block
      integer :: c

      allocate (lane(size(recording%table%chosen)))
      do
         call next_record_block(recording, stream, block, error, progress)
         if (allocated(error) .or. stream%done) return
         do c = 1, size(lane)
            if (.not. allocated(lane(c)%allan%rate)) then
               call begin_allan_stream(lane(c)%allan, stream%interval, options%allan, error)
               if (allocated(error)) return
            end if
            call feed_lane(block, c, lane(c), error)
            if (allocated(error)) return
         end do
      end do
   end subroutine read_lanes

   !> One block of one channel.
   subroutine feed_lane(block, c, lane, error)
      type(record_type), intent(in) :: block
      integer, intent(in) :: c
      type(lane_type), intent(inout) :: lane
      type(error_type), allocatable, intent(out) :: error
      type(moments_type) :: part

      if (size(block%value, 1) == 0) return
      if (allocated(block%present)) then
         call compute_moments(block%value(:, c), part, block%present(:, c))
         call feed_allan_stream(lane%allan, block%value(:, c), error, block%present(:, c))
      else
         call compute_moments(block%value(:, c), part)
         call feed_allan_stream(lane%allan, block%value(:, c), error)
      end if
      call join_moments(lane%moments, part)
   end subroutine feed_lane

   !> Curves, coefficients, moments of the channels that hold numbers.
   subroutine finish_lanes(stream, lane, options, record, result, error)
      type(record_stream_type), intent(in) :: stream
      type(lane_type), intent(inout) :: lane(:)
      type(pipeline_options), intent(in) :: options
      type(record_type), intent(in) :: record
      type(pipeline_result_type), intent(inout) :: result
      type(error_type), allocatable, intent(out) :: error
      type(record_type) :: view
      real(dp) :: factor
      integer :: c, k

      factor = 1.0_dp                                   ! increments were divided by the interval known at the beginning
      if (stream%input /= "rate") factor = stream%interval/record%sample_interval
      result%duration = real(record%audit%samples, dp)*record%sample_interval
      allocate (result%channel(count(stream%holds)))
      k = 0
      do c = 1, size(lane)
         if (.not. stream%holds(c)) cycle
         k = k + 1
         call view_channel(record, k, view)
         associate (channel => result%channel(k))
            channel%name = record%channel(k)%text
            call scale_moments(lane(c)%moments, factor, channel%raw)
            channel%cleaned = channel%raw
            channel%clean%mean = channel%raw%mean
            channel%clean%variance = channel%raw%variance
            call finish_allan_stream(lane(c)%allan, channel%allan(stage%input)%curve, error, record%sample_interval)
            if (is_fatal(error)) return
            channel%allan(stage%input)%available = .not. allocated(error)
            call note_failure(channel, "Allan deviation ("//trim(stage_names(stage%input))//")", error)
            if (.not. channel%allan(stage%input)%available) cycle
            call scale_curve(channel%allan(stage%input)%curve%deviation, channel%allan(stage%input)%curve%lower, &
                             channel%allan(stage%input)%curve%upper, factor)
            call fit_curve(record%rate_known, view%unit, options, stage%input, channel, error)
            if (allocated(error)) return
            channel%allan(stage%cleaned) = channel%allan(stage%input)
            call add_text(channel%unavailable, "comparison of the record's halves: it needs the whole record in memory")
            call warn_fit(channel)
         end associate
      end do
   end subroutine finish_lanes

   !> Times a factor.
   pure subroutine scale_curve(deviation, lower, upper, factor)
      real(dp), intent(inout) :: deviation(:), lower(:), upper(:)
      real(dp), intent(in) :: factor

      deviation = factor*deviation
      lower = factor*lower
      upper = factor*upper
   end subroutine scale_curve

   !> Moments of a series times a factor > 0.
   pure subroutine scale_moments(moments, factor, scaled)
      type(moments_type), intent(in) :: moments
      real(dp), intent(in) :: factor
      type(moments_type), intent(out) :: scaled

      scaled = moments
      scaled%mean = factor*moments%mean
      scaled%variance = factor**2*moments%variance
      scaled%std = factor*moments%std
      scaled%minimum = factor*moments%minimum
      scaled%maximum = factor*moments%maximum
   end subroutine scale_moments

end module gyroakf_pipeline_streamed
