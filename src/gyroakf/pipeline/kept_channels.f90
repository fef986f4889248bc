! SPDX-License-Identifier: MIT
!> The channels of a recording that is larger than the memory, kept in a scratch file so that they can be gone through backwards.
!>
!> Of each channel first all samples stand there, 8 bytes each, then room for as many numbers. Where the file cannot be made or
!> written the channels are not kept, and why is remembered: a filter goes on without its smoother.
module gyroakf_pipeline_kept_channels
   use gyroakf_kinds, only : dp, int64
   use gyroakf_error, only : error_type
   use gyroakf_record, only : record_type
   use gyroakf_filter_stored_smoother, only : stored_series_type
   use gyroakf_io_scratch, only : close_scratch, open_scratch, read_scratch, scratch_type, write_scratch
   implicit none (type, external)
   private
   public :: kept_channels_type, kept_channel_type, begin_keeping, keep_samples, take_channel, end_keeping

   !> What stands for a missing sample: it is no measurement
   real(dp), parameter :: missing = huge(1.0_dp)

   !> All channels
   type :: kept_channels_type
      !> They are kept
      logical :: works = .false.
      !> Why they are not
      character(:), allocatable :: problem
      type(scratch_type) :: scratch
      !> Samples of each
      integer(int64) :: samples = 0
   end type kept_channels_type

   !> One of them, as the smoother takes it; it lives as long as the others
   type, extends(stored_series_type) :: kept_channel_type
      type(scratch_type) :: scratch
      !> Numbers of the file before its own
      integer(int64) :: before = 0
      !> Subtracted from every sample
      real(dp) :: level = 0.0_dp
   contains
      procedure :: read_series
      procedure :: read_beside
      procedure :: write_beside
   end type kept_channel_type

contains

   !> Makes the scratch file.
   subroutine begin_keeping(kept, samples, directory)
      !> To be ended by [[end_keeping]]
      type(kept_channels_type), intent(out) :: kept
      !> Of each channel
      integer(int64), intent(in) :: samples
      !> That of the file
      character(*), intent(in) :: directory
      type(error_type), allocatable :: error

      kept%samples = samples
      call open_scratch(kept%scratch, directory, error)
      kept%works = .not. allocated(error)
      if (allocated(error)) kept%problem = error%message
   end subroutine begin_keeping

   !> Keeps what a block has of the channels.
   subroutine keep_samples(kept, block, columns, before)
      !> Nothing happens where it does not work
      type(kept_channels_type), intent(inout) :: kept
      !> May be empty
      type(record_type), intent(in) :: block
      !> Of its columns those that are kept: [channel]
      integer, intent(in) :: columns(:)
      !> Samples before the block
      integer(int64), intent(in) :: before
      type(error_type), allocatable :: error
      real(dp), allocatable :: x(:)
      integer(int64) :: n
      integer :: k

      n = min(size(block%value, 1, kind=int64), kept%samples - before)
      if (n < 1) return
      do k = 1, size(columns)
         if (.not. kept%works) return
         x = block%value(:n, columns(k))
         if (allocated(block%present)) then
            where (block%present(:n, columns(k)) == 0) x = missing
         end if
         call write_scratch(kept%scratch, 2*(k - 1)*kept%samples + before, x, error)
         if (allocated(error)) kept%problem = error%message
         kept%works = .not. allocated(error)
      end do
   end subroutine keep_samples

   !> One of the channels.
   subroutine take_channel(kept, k, level, channel)
      !> Works
      type(kept_channels_type), intent(in) :: kept
      !> Its number
      integer, intent(in) :: k
      !> Subtracted from every sample
      real(dp), intent(in) :: level
      type(kept_channel_type), intent(out) :: channel

      channel%samples = kept%samples
      channel%scratch = kept%scratch
      channel%before = 2*(k - 1)*kept%samples
      channel%level = level
   end subroutine take_channel

   !> Lets the file go; harmless where there is none.
   subroutine end_keeping(kept)
      type(kept_channels_type), intent(inout) :: kept

      call close_scratch(kept%scratch)
      kept%works = .false.
   end subroutine end_keeping

   !> Samples of a channel, less the level.
   subroutine read_series(self, first, values, error)
      class(kept_channel_type), intent(in) :: self
      integer(int64), intent(in) :: first
      real(dp), intent(out), contiguous :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call read_scratch(self%scratch, self%before + first - 1, values, error)
      if (.not. allocated(error)) values = values - self%level
   end subroutine read_series

   !> What stands beside them.
   subroutine read_beside(self, first, values, error)
      class(kept_channel_type), intent(in) :: self
      integer(int64), intent(in) :: first
      real(dp), intent(out), contiguous :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call read_scratch(self%scratch, self%before + self%samples + first - 1, values, error)
   end subroutine read_beside

   !> Puts numbers beside them.
   subroutine write_beside(self, first, values, error)
      class(kept_channel_type), intent(inout) :: self
      integer(int64), intent(in) :: first
      real(dp), intent(in), contiguous :: values(:)
      type(error_type), allocatable, intent(out) :: error

      call write_scratch(self%scratch, self%before + self%samples + first - 1, values, error)
   end subroutine write_beside

end module gyroakf_pipeline_kept_channels
