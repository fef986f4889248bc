! SPDX-License-Identifier: MIT
!> The drift smoother of a recording that is larger than the memory, over its channels in a scratch file: what [[run_pipeline]]
!> gives of the record in memory, but for rounding.
module gyroakf_pipeline_streamed_smoother
   use gyroakf_kinds, only : dp, int8, int64
   use gyroakf_error, only : error_type
   use gyroakf_progress, only : progress_type
   use gyroakf_series_moments, only : compute_moments, join_moments, moments_type
   use gyroakf_filter_design, only : adaptive_drift
   use gyroakf_filter_measurement, only : is_sample
   use gyroakf_filter_stored_smoother, only : smooth_stored
   use gyroakf_pipeline_drift_filters, only : state_compensated, state_smoother
   use gyroakf_pipeline_kept_channels, only : kept_channel_type, kept_channels_type, take_channel
   use gyroakf_pipeline_result, only : channel_result_type, pipeline_options
   use gyroakf_pipeline_warnings, only : is_fatal, note_failure
   implicit none (type, external)
   private
   public :: smooth_channel, read_smoothed

   !> Samples that are measured at a time
   integer(int64), parameter :: measured = 65536

contains

   !> Smooths the drift of a channel; it stands beside its samples afterwards.
   subroutine smooth_channel(kept, k, difference_variance, options, channel, error, progress)
      !> Works
      type(kept_channels_type), intent(in) :: kept
      !> Number of the channel
      integer, intent(in) :: k
      !> Variance of the differences of the series
      real(dp), intent(in) :: difference_variance
      type(pipeline_options), intent(in) :: options
      !> Its drift is found; smoother and compensated series are described; a failure is noted
      type(channel_result_type), intent(inout) :: channel
      !> no_memory, cancelled and the like
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(kept_channel_type) :: store
      type(moments_type) :: drift, compensated

      call take_channel(kept, k, channel%level%mean, store)
      associate (model => channel%drift%model)
         call smooth_stored(model, channel%drift%slow(:model%count), adaptive_drift(options%drift, 0.5_dp*difference_variance), &
                            store, error, progress)
      end associate
      if (.not. allocated(error)) call measure(store, drift, compensated, error)
      if (is_fatal(error)) return
      channel%available%drift_smoother = .not. allocated(error)
      call note_failure(channel, "drift smoother", error)
      if (.not. channel%available%drift_smoother) return
      call state_smoother(drift, kept%samples, options, channel)
      call state_compensated(compensated, channel)
   end subroutine smooth_channel

   !> Moments of the smoothed drift and of what is left without it, over the present samples.
   subroutine measure(store, drift, compensated, error)
      !> Smoothed
      type(kept_channel_type), intent(in) :: store
      type(moments_type), intent(out) :: drift, compensated
      !> io
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: z(:), x(:)
      integer(int8), allocatable :: here(:)
      type(moments_type) :: part
      integer(int64) :: first, n

      do first = 1, store%samples, measured
         n = min(measured, store%samples - first + 1)
         if (allocated(z)) deallocate (z, x)
         allocate (z(n), x(n))
         call store%read_series(first, z, error)
         if (.not. allocated(error)) call store%read_beside(first, x, error)
         if (allocated(error)) return
         here = merge(1_int8, 0_int8, is_sample(z))
         where (here == 0_int8) z = x
         call compute_moments(x, part, here)
         call join_moments(drift, part)
         z = z - x
         call compute_moments(z, part, here)
         call join_moments(compensated, part)
      end do
   end subroutine measure

   !> The smoothed drift of some samples, its level included, and what is left of them without it.
   subroutine read_smoothed(kept, k, before, x, channel, part, error)
      !> Works
      type(kept_channels_type), intent(in) :: kept
      !> Number of the channel
      integer, intent(in) :: k
      !> Samples before these
      integer(int64), intent(in) :: before
      !> The samples: [any number]
      real(dp), intent(in), contiguous :: x(:)
      !> Its smoother is available
      type(channel_result_type), intent(in) :: channel
      !> Its `series_drift` and `series_compensated` are set
      type(channel_result_type), intent(inout) :: part
      !> io
      type(error_type), allocatable, intent(out) :: error
      type(kept_channel_type) :: store

      call take_channel(kept, k, channel%level%mean, store)
      if (allocated(part%series_drift)) deallocate (part%series_drift)
      allocate (part%series_drift(size(x, kind=int64)))
      call store%read_beside(before + 1, part%series_drift, error)
      if (allocated(error)) return
      part%series_compensated = x - channel%level%mean - part%series_drift
      part%series_drift = part%series_drift + channel%level%mean
   end subroutine read_smoothed

end module gyroakf_pipeline_streamed_smoother
