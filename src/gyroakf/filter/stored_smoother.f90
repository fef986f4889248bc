! SPDX-License-Identifier: MIT
!> The smoother of [[gyroakf_filter_two_pass]] over a series that is larger than the memory: stored elsewhere, in a file say.
!>
!> Beside the series there is room for a number a sample. Four passes, block by block of about sqrt(n) samples: forward, and back,
!> for the variance of the white noise at each sample, which is stored; forward, keeping the state at the beginning of each block;
!> back, where a block's states are recomputed and its drift takes the place of the variances. Every number is that of
!> [[smooth_adaptive]], to the last bit; memory O(sqrt n).
module gyroakf_filter_stored_smoother
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type, fatal_error, status
   use gyroakf_progress, only : progress_type, tell_progress
   use gyroakf_filter_components, only : component_model_type, component_state_type, check_components, settling_type, &
      start_components
   use gyroakf_filter_kalman, only : filter_options, filter_type
   use gyroakf_filter_measurement, only : is_sample
   use gyroakf_filter_smoother, only : block_of
   use gyroakf_filter_smoother_step, only : advance_smoother, smooth_back, smoother_back_type, smoother_step_type
   use gyroakf_filter_weighing, only : start_weighing, weigh_behind, weigh_sample
   implicit none (type, external)
   private
   public :: stored_series_type, smooth_stored, smoother_bytes

   !> A series, and room for a number a sample
   type, abstract :: stored_series_type
      !> Samples
      integer(int64) :: samples = 0
   contains
      procedure(read_interface), deferred :: read_series
      procedure(read_interface), deferred :: read_beside
      procedure(write_interface), deferred :: write_beside
   end type stored_series_type

   abstract interface
      !> Gives numbers that stand one behind the other.
      subroutine read_interface(self, first, values, error)
         import :: dp, error_type, int64, stored_series_type
         implicit none (type, external)
         class(stored_series_type), intent(in) :: self
         !> Number of the first, from 1
         integer(int64), intent(in) :: first
         !> Of the series: what is no measurement ([[is_sample]]) is missing
         real(dp), intent(out), contiguous :: values(:)
         !> Ends the work
         type(error_type), allocatable, intent(out) :: error
      end subroutine read_interface

      !> Takes numbers that stand one behind the other.
      subroutine write_interface(self, first, values, error)
         import :: dp, error_type, int64, stored_series_type
         implicit none (type, external)
         class(stored_series_type), intent(inout) :: self
         !> Number of the first, from 1
         integer(int64), intent(in) :: first
         !> To be kept
         real(dp), intent(in), contiguous :: values(:)
         !> Ends the work
         type(error_type), allocatable, intent(out) :: error
      end subroutine write_interface
   end interface

   !> A block at work
   type :: block_type
      !> Samples of each but the last, and blocks
      integer(int64) :: length = 0, count = 0
      !> The series, and what stands beside it: [length]
      real(dp), allocatable :: z(:), beside(:)
   end type block_type

contains

   !> Bytes that the smoother takes.
   pure integer(int64) function smoother_bytes(samples) result(bytes)
      !> Of the series
      integer(int64), intent(in) :: samples
      type(smoother_step_type) :: step
      type(component_state_type) :: state
      integer(int64) :: length

      length = block_of(samples)
      bytes = length*(16 + storage_size(step)/8) + (samples/length + 1)*(storage_size(state)/8)
   end function smoother_bytes

   !> Smooths the drift out of a stored series; it stands beside the series afterwards.
   subroutine smooth_stored(model, slow, options, store, error, progress)
      !> As [[smooth_adaptive]]
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(filter_options), intent(in) :: options
      !> The series
      class(stored_series_type), intent(inout) :: store
      !> Those of [[smooth_adaptive]] and of the store
      type(error_type), allocatable, intent(out) :: error
      !> Told how far it is; may cancel
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      type(block_type) :: block
      integer :: stat

      call start_weighing(filter, model, slow, options, store%samples, error)
      if (.not. allocated(error)) call check_components(model, error)
      if (allocated(error)) return
      block%length = block_of(store%samples)
      block%count = (store%samples + block%length - 1)/block%length
      allocate (block%z(block%length), stat=stat)
      if (stat == 0) allocate (block%beside(block%length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for a block of the smoother")
         return
      end if
      call weigh_stored(filter, block, store, error, progress)
      if (.not. allocated(error)) call smooth_blocks(model, slow, block, store, error, progress)
   end subroutine smooth_stored

   !> The variance of the white noise at each sample from before and from behind, beside the series.
   subroutine weigh_stored(fresh, block, store, error, progress)
      !> As made
      type(filter_type), intent(in) :: fresh
      type(block_type), intent(inout) :: block
      class(stored_series_type), intent(inout) :: store
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(filter_type) :: filter
      integer(int64) :: b, k, m, first, seen

      filter = fresh
      do b = 1, block%count
         call read_block(store, b, .false., block, first, m, error)
         if (allocated(error)) return
         do k = 1, m
            call weigh_sample(filter, block%z(k), is_sample(block%z(k)), block%beside(k))
         end do
         call store%write_beside(first, block%beside(:m), error)
         if (.not. allocated(error)) call tell_progress("weighing the samples", first + m - 1, 2*store%samples, error, progress)
         if (allocated(error)) return
      end do
      seen = filter%measurements
      filter = fresh
      do b = block%count, 1, -1
         call read_block(store, b, .true., block, first, m, error)
         if (allocated(error)) return
         do k = m, 1, -1
            call weigh_behind(fresh, filter, seen, block%z(k), is_sample(block%z(k)), block%beside(k))
         end do
         call store%write_beside(first, block%beside(:m), error)
         if (.not. allocated(error)) call tell_progress("weighing the samples", 2*store%samples - first, 2*store%samples, error, &
                                                        progress)
         if (allocated(error)) return
      end do
   end subroutine weigh_stored

   !> The smoother forward and back; variances stand beside the series, afterwards the drift.
   subroutine smooth_blocks(model, slow, block, store, error, progress)
      type(component_model_type), intent(in) :: model
      logical, intent(in) :: slow(:)
      type(block_type), intent(inout) :: block
      class(stored_series_type), intent(inout) :: store
      !> too_few_samples (none is present), no_memory, cancelled
      type(error_type), allocatable, intent(out) :: error
      class(progress_type), intent(inout), optional :: progress
      type(component_state_type), allocatable :: start(:)
      type(smoother_step_type), allocatable :: step(:)
      type(component_state_type) :: state
      type(settling_type) :: settling                      ! where each sample has a variance of its own nothing settles
      type(smoother_back_type) :: back
      integer(int64) :: b, m, first, seen
      integer :: stat

      allocate (start(block%count), stat=stat)
      if (stat == 0) allocate (step(block%length), stat=stat)
      if (stat /= 0) then
         call fatal_error(error, status%no_memory, "no memory for the states of the smoother")
         return
      end if
      call start_components(model, state)
      seen = 0
      do b = 1, block%count
         call read_block(store, b, .true., block, first, m, error)
         if (allocated(error)) return
         start(b) = state
         call advance_smoother(model, block%z, 1_int64, m, state, settling, step, seen, white=block%beside)
         call tell_progress("smoothing", first + m - 1, 2*store%samples, error, progress)
         if (allocated(error)) return
      end do
      if (seen == 0) then
         call fatal_error(error, status%too_few_samples, "a drift is smoothed out of measurements, and there is none")
         return
      end if
      do b = block%count, 1, -1
         call read_block(store, b, .true., block, first, m, error)
         if (allocated(error)) return
         call advance_smoother(model, block%z, 1_int64, m, start(b), settling, step, seen, white=block%beside)
         call smooth_back(model, slow, step, 1_int64, m, back, block%beside)
         call store%write_beside(first, block%beside(:m), error)
         if (.not. allocated(error)) call tell_progress("smoothing", 2*store%samples - first, 2*store%samples, error, progress)
         if (allocated(error)) return
      end do
   end subroutine smooth_blocks

   !> Reads a block.
   subroutine read_block(store, b, both, block, first, m, error)
      class(stored_series_type), intent(in) :: store
      !> Its number
      integer(int64), intent(in) :: b
      !> What stands beside the series too
      logical, intent(in) :: both
      type(block_type), intent(inout) :: block
      !> Its first sample, and samples
      integer(int64), intent(out) :: first, m
      type(error_type), allocatable, intent(out) :: error

      first = (b - 1)*block%length + 1
      m = min(block%length, store%samples - first + 1)
      call store%read_series(first, block%z(:m), error)
      if (both .and. .not. allocated(error)) call store%read_beside(first, block%beside(:m), error)
   end subroutine read_block

end module gyroakf_filter_stored_smoother
